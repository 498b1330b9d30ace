// What the design achieves, what is wrong with it, and its tables; each part as it comes.

function cell(tag, text, attributes = {}) {
  return made(tag, attributes, text);
}

function tableElement(table) {
  const head = table.columns.map(([name, unit]) => cell("th", unit ? `${name} in ${unit}` : name, { scope: "col" }));
  const rows = table.rows.flatMap((row) => {
    const [first, ...rest] = row.cells;
    const cells = rest.map((text, i) => cell("td", text, i === 0 && row.span > 1 ? { colspan: row.span } : {}));
    const note = row.note ? [made("tr", { class: "note" }, made("td", { colspan: row.cells.length }, made("span", {}, row.note)))] : [];
    return [made("tr", {}, cell("th", first, { scope: "row" }), ...cells), ...note];
  });
  const inner = made("table", {}, made("thead", {}, made("tr", {}, ...head)), made("tbody", {}, ...rows));
  const notes = table.notes.map((note) => cell("p", note, { class: "note" }));
  const scroll = made("div", { class: "scroll", tabindex: 0, role: "group", "aria-label": table.title }, inner);
  return made("figure", { class: "table-frame" }, cell("figcaption", table.title), scroll, ...notes);
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
  // What each part was told last, by which chain and of which text; the verdict comes from two chains.
  const parts = { figures: null, strength: null, teeth: null, verdict: null };
  const shows = new WeakMap();
  let held = null;

  // The peaks and the safeties first; beside them the crank, or the kept design in its place.
  function rowsOfFacts() {
    const rows = (part, chosen = () => true) => (part?.facts ?? []).filter(chosen).map((fact) => ({ part, fact }));
    const { figures, strength, teeth } = parts;
    const compared = (fact) => fact.length > 2;
    return [...rows(figures, compared), ...rows(strength), ...rows(figures, (fact) => !compared(fact)), ...rows(teeth)];
  }

  function showFacts() {
    const before = held && new Map(held.map(([name, text]) => [name, text]));
    const crank = parts.figures?.crank ?? "";
    const rows = rowsOfFacts().map(({ part, fact: [name, text, ...beside] }) => {
      const other = before?.get(name) ?? "";
      const cells = [text, ...(before ? [other, other && differenceOf(text, other)] : beside)].map((one) => cell("td", one));
      return of(part, made("tr", {}, cell("th", name, { scope: "row" }), ...cells));
    });
    at("facts").tHead.rows[0].cells[2].textContent = before ? "kept" : crank;
    at("facts").tBodies[0].replaceChildren(...rows);
    at("crank").textContent = crank;
    at("legend").hidden = !before;
  }

  // An element and the part that it shows, from whose age it is told whether it is of an earlier text.
  function of(part, element) {
    shows.set(element, part);
    return element;
  }

  // The newest verdict counts: that of the motion until the teeth of the same design are judged.
  function verdict(content, message) {
    if (parts.verdict && message.n < parts.verdict.n + (message.from === "motion")) return;
    parts.verdict = message;
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

  function show() {
    const { figures, strength, teeth } = parts;
    const tables = [strength, figures, teeth].flatMap((part) => (part?.tables ?? []).map((table) => of(part, tableElement(table))));
    at("tables").lastElementChild.replaceChildren(...tables);
    at("achieved").replaceChildren(...(figures?.achieved ?? []).map((line) => of(figures, cell("li", line))));
    showFacts();
  }

  function take(content, { is, from, n }) {
    parts[is] = { ...content, from, n };
    show();
  }

  // What a chain has told of earlier texts goes where it has not told it of the text of a number.
  function drop(from, n) {
    const gone = ["figures", "strength", "teeth"].filter((name) => parts[name]?.from === from && parts[name].n < n);
    for (const name of gone) parts[name] = null;
    if (gone.length) show();
  }

  function hold(on) {
    held = on ? rowsOfFacts().map(({ fact }) => fact) : null;
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
    for (const one of document.querySelectorAll("#facts tbody tr, #achieved li, #tables .table-frame")) {
      const { from, n } = shows.get(one);
      one.classList.toggle("stale", stale(from, n));
    }
    const judged = parts.verdict?.n ?? Infinity;
    at("warnings").classList.toggle("stale", stale("motion", judged) || stale("contact", judged));
    const motion = parts.figures !== null && stale("motion", parts.figures.n);
    at("facts").classList.toggle("before", motion);
    if (motion) best(null);
    return motion;
  }

  return { showStale, best, take, drop, verdict, hold, refusals };
}
