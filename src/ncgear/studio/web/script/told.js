// What the design achieves, what is wrong with it, and its tables; each part as it comes.

function cell(tag, text, attributes = {}) {
  return made(tag, attributes, text);
}

function tableElement(table) {
  const head = table.columns.map(([name, unit]) => cell("th", unit ? `${name} in ${unit}` : name, { scope: "col" }));
  const rows = table.rows.flatMap((row) => {
    const [first, ...rest] = row.cells;
    const cells = rest.map((text, i) => cell("td", text, i === 0 && row.span > 1 ? { colspan: row.span } : {}));
    const note = row.note ? [made("tr", { class: "note" }, cell("td", row.note, { colspan: row.cells.length }))] : [];
    return [made("tr", {}, cell("th", first, { scope: "row" }), ...cells), ...note];
  });
  const inner = made("table", {}, made("caption", {}, table.title), made("thead", {}, made("tr", {}, ...head)), made("tbody", {}, ...rows));
  const notes = table.notes.map((note) => cell("p", note, { class: "note" }));
  const frame = made("div", { class: "table-frame", tabindex: 0, role: "group" }, inner, ...notes);
  frame.setAttribute("aria-label", table.title);
  return frame;
}

// The number at the beginning of a text, and what follows it; null for a text of more than one number.
function measured(text) {
  const [, number, unit] = /^([-\u2212]?[\d.]+(?:e[+-]?\d+)?)(?:\s(.*))?$/.exec(text) ?? [];
  return number === undefined ? null : { number: Number(number.replace("\u2212", "-")), unit: unit ?? "" };
}

// What a text says more or less than another one, in hundredths, or in its unit where the other one is nought.
function differenceOf(text, other) {
  if (text === other) return "the same";
  const [now, before] = [measured(text), measured(other)];
  if (!now || !before || now.unit !== before.unit) return "";
  const more = now.number - before.number;
  const share = (100 * more) / Math.abs(before.number);
  const told = before.number ? `${Math.abs(share) < 9.95 ? share.toFixed(1) : share.toFixed(0)} %` : `${digits(more)} ${now.unit}`;
  return `${more > 0 ? "+" : ""}${told}`.replace("-", "\u2212");
}

// `acts.set(changes)` takes a remedy, `acts.reveal(key)` shows a key of the form.
function createTold(acts) {
  const at = (id) => document.getElementById(id);
  const parts = { facts: [], teeth: [], safety: [], crank: "", verdict: null, verdictOf: -1, figuresOf: -1, tables: { motion: [], gears: [], strength: [] } };
  let held = null;

  // The peaks and the safeties first; beside them the crank, or the kept design in its place.
  function rowsOfFacts() {
    const compared = parts.facts.filter((one) => one.length > 2);
    const others = parts.facts.filter((one) => one.length <= 2);
    return [...compared, ...parts.safety, ...others, ...parts.teeth];
  }

  function showFacts() {
    const before = held && new Map(held.map(([name, text]) => [name, text]));
    const rows = rowsOfFacts().map(([name, text, ...crank]) => {
      const other = before?.get(name) ?? "";
      const beside = before ? [other, other && differenceOf(text, other)] : crank;
      const cells = [text, ...beside].map((one) => cell("td", one));
      return made("tr", {}, cell("th", name, { scope: "row" }), ...cells);
    });
    at("facts").tHead.rows[0].cells[2].textContent = before ? "kept" : parts.crank;
    at("facts").tBodies[0].replaceChildren(...rows);
    at("crank").textContent = parts.crank;
    at("legend").hidden = !before;
  }

  // The newest verdict counts: that of the motion until the teeth of the same design are judged.
  function verdict(content, message) {
    const newest = message.from === "motion" ? parts.verdictOf + 1 : parts.verdictOf;
    if (message.n < newest) return;
    Object.assign(parts, { verdict: content, verdictOf: message.n });
    const items = content.advices.map((advice) => {
      const before = `${advice.stage}${advice.matters ? "" : "Remark: "}`;
      const item = made("li", { class: advice.remedies.length ? "remediable" : "" });
      item.append(cell("p", `${before}${advice.what}`, { class: "what" }), cell("p", advice.meaning));
      item.append(...advice.remedies.map(remedyElement));
      return item;
    });
    const said = [content.good, content.not_judged].filter(Boolean).map((text) => cell("li", text));
    at("warnings").replaceChildren(...items, ...said);
  }

  function remedyElement(remedy) {
    const line = made("p", { class: "remedy" }, remedy.text);
    if (remedy.words.length) {
      line.append(": ", ...remedy.words.flatMap((word) => [cell("code", word), " "]));
      const take = made("button", { type: "button", class: "small" }, "try it");
      take.setAttribute("aria-label", `try ${remedy.words.join(", ")}`);
      take.addEventListener("click", () => acts.set(remedy.changes));
      line.append(" ", take);
    }
    if (remedy.command) line.append(" then ", cell("code", remedy.command));
    return line;
  }

  function showTables() {
    const { motion, gears, strength } = parts.tables;
    at("tables").lastElementChild.replaceChildren(...[...strength, ...motion, ...gears].map(tableElement));
  }

  function figures(content, message) {
    Object.assign(parts, { facts: content.facts, crank: content.crank, figuresOf: message.n });
    parts.tables.motion = content.tables;
    at("achieved").replaceChildren(...content.achieved.map((line) => cell("li", line)));
    showFacts();
    showTables();
  }

  function teeth(content) {
    parts.teeth = content.facts;
    parts.tables.gears = content.tables;
    showFacts();
    showTables();
  }

  function strength(content) {
    parts.safety = content.facts;
    parts.tables.strength = content.tables;
    showFacts();
    showTables();
  }

  // Parts of gears that do not exist are not shown as if they did.
  function withoutGears(after) {
    if (!["teeth", "verdict", "strength", "chart"].includes(after)) Object.assign(parts, { teeth: [] });
    parts.safety = [];
    Object.assign(parts.tables, { gears: [], strength: [] });
    showFacts();
    showTables();
  }

  function hold(on) {
    held = on ? rowsOfFacts() : null;
    showFacts();
  }

  function refusals(found) {
    const items = found.map((one) => {
      const place = one.line ? `line ${one.line}, ` : "";
      const item = made("div", { class: "refusal" });
      const read = one.key ? "This value is not right" : "This cannot be read";
      const what = one.wrong_input ? read : "There is no such machine";
      item.append(cell("p", what, { class: "what" }), cell("p", `${place}${one.key ? `${one.key}: ` : ""}${one.problem}`));
      if (one.key) {
        const go = made("button", { type: "button", class: "small" }, `go to ${one.key}`);
        go.addEventListener("click", () => acts.reveal(one.key));
        item.append(go);
      }
      return item;
    });
    at("refusals").replaceChildren(...items);
  }

  // What the best law would save stands on its button.
  function best(content) {
    at("best-saves").textContent = content ? `: ${content.words}` : "";
    at("best").title = content?.in_full ?? "";
  }

  // Makes pale what `stale(chain, n)` tells of an earlier text; gives whether the motion's figures are.
  function showStale(stale) {
    const motion = stale("motion", parts.figuresOf);
    for (const one of [at("facts"), at("achieved"), at("tables").lastElementChild]) one.classList.toggle("stale", motion);
    at("warnings").classList.toggle("stale", stale("motion", parts.verdictOf) || stale("contact", parts.verdictOf));
    if (motion) best(null);
    return motion;
  }

  return { showStale, best, figures, teeth, verdict, strength, withoutGears, hold, refusals };
}
