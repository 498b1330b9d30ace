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

// `acts.set(changes)` takes a remedy, `acts.reveal(key)` shows a key of the form.
function createTold(acts) {
  const at = (id) => document.getElementById(id);
  const parts = { facts: [], teeth: [], verdict: null, verdictOf: -1, tables: { motion: [], gears: [], strength: [] } };
  let held = null;

  function showFacts() {
    const facts = [...parts.facts, ...parts.teeth];
    const before = held && new Map(held);
    const rows = facts.map(([name, value]) => {
      const cells = [cell("th", name, { scope: "row" }), cell("td", value)];
      if (before) cells.push(cell("td", before.get(name) ?? ""));
      return made("tr", {}, ...cells);
    });
    at("facts").tHead.hidden = !before;
    at("facts").tBodies[0].replaceChildren(...rows);
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

  function figures(content) {
    parts.facts = content.facts;
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
    parts.tables.strength = content;
    showTables();
  }

  // Parts of gears that do not exist are not shown as if they did.
  function withoutGears(after) {
    if (!["teeth", "verdict", "strength", "chart"].includes(after)) Object.assign(parts, { teeth: [] });
    Object.assign(parts.tables, { gears: [], strength: [] });
    showFacts();
    showTables();
  }

  function hold(on) {
    held = on ? [...parts.facts, ...parts.teeth] : null;
    showFacts();
  }

  function refusals(found) {
    const items = found.map((one) => {
      const place = one.line ? `line ${one.line}, ` : "";
      const item = made("div", { class: "refusal" });
      const what = one.wrong_input ? "This cannot be read" : "There is no such machine";
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

  return { figures, teeth, verdict, strength, withoutGears, hold, refusals };
}
