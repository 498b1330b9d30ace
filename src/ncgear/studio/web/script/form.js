// The values of the design: every key with its name, unit, meaning and range, all of it told by the server.

// Width of a window in pixels up to which all stands in one column.
const NARROW = 800;

// Letters of a text beyond which it stands below its name, on the whole width.
const LONG_TEXT = 18;

// Pixels of dragging a name sideways for one step of its value.
const PIXELS_A_STEP = 4;

function made(tag, attributes, ...children) {
  const element = document.createElement(tag);
  for (const [key, value] of Object.entries(attributes)) {
    if (value === true) element.setAttribute(key, "");
    else if (value !== false && value !== null && value !== undefined) element.setAttribute(key, value);
  }
  element.append(...children.filter((child) => child !== null));
  return element;
}

function numbersIn(text) {
  const parts = text.replace(/^\s*\[|\]\s*$/g, "").split(/[\s,;]+/).filter(Boolean);
  const numbers = parts.map(numberIn);
  return numbers.every(Number.isFinite) ? numbers : null;
}

// A decimal number as a design file has it; NaN for any other text, such as 0x3.
const numberIn = (text) => (/^[+-]?(\d+\.?\d*|\.\d+)(e[+-]?\d+)?$/i.test(text) ? Number(text) : NaN);

function textOf(value) {
  if (value === null || value === undefined) return "";
  return Array.isArray(value) ? value.join(", ") : String(value);
}

const isNumber = (row) => row.kind === "number" || row.kind === "integer";

// Lists and texts break into lines where they are long.
const isText = (row) => ["text", "numbers", "other"].includes(row.kind);

// What an input holds, in the form of the file; undefined for what is none.
function valueOf(row, input) {
  const text = input.type === "checkbox" ? String(input.checked) : input.value.trim();
  if (text === "") return null;
  if (row.kind === "truth") return text === "true";
  if (row.kind === "numbers") return numbersIn(text) ?? undefined;
  if (row.kind === "choice") return (row.choices ?? []).find((choice) => String(choice) === text);
  if (row.kind === "other") return text === "true" || text === "false" ? text === "true" : Number.isFinite(numberIn(text)) ? numberIn(text) : text;
  if (row.kind === "text") return text;
  const number = numberIn(text);
  return Number.isFinite(number) ? number : undefined;
}

// `acts.change(changes)` hears of every value on the way, `acts.set(changes)` of the one that is meant.
function createForm(place, find, acts) {
  // `faults` are of the text, `own` what was typed and is not taken, both in words by the keys' paths.
  const state = { shape: "", open: new Set(), inputs: new Map(), faults: new Map(), own: new Map() };

  function show(rows) {
    const shape = JSON.stringify(rows, (key, value) => (["value", "step"].includes(key) ? undefined : value));
    if (shape !== state.shape) build(rows, shape);
    state.own.clear();
    fill(rows);
  }

  function build(rows, shape) {
    const { open } = state;
    // On a phone all groups begin closed, so that every one of them is in reach; one that comes back is as it was.
    if (!state.shape && innerWidth > NARROW) ["motion", "gears", "operation", "linkage", "train", "train.gears"].forEach((path) => open.add(path));
    for (const one of place.querySelectorAll("details")) open[one.open ? "add" : "delete"](one.dataset.path);
    const focused = document.activeElement?.closest?.("[data-path]")?.dataset.path;
    state.shape = shape;
    state.inputs = new Map();
    place.replaceChildren(...rows.map((row) => element(row)));
    for (const one of place.querySelectorAll("details")) one.open = open.has(one.dataset.path);
    if (focused) state.inputs.get(focused)?.input.focus({ preventScroll: true });
    filter();
  }

  function fill(rows) {
    for (const row of rows) {
      if (row.rows) fill(row.rows);
      const known = state.inputs.get(row.path);
      if (known) fillOne(known, row);
    }
  }

  function fillOne(known, row) {
    known.row = row;
    const { input } = known;
    if (input === document.activeElement && known.typing) return;
    say(known);
    if (input.type === "checkbox") input.checked = row.value === true;
    else put(known, textOf(row.value));
  }

  function put(known, text) {
    known.input.value = text;
    fit(known.input);
  }

  // A field is as wide as what it holds, or as the hint that stands in it.
  function fit(input) {
    input.style.setProperty("--letters", (input.value || (input.placeholder ?? "")).length);
  }

  function element(row) {
    return row.kind === "group" || row.kind === "groups" ? groupElement(row) : rowElement(row);
  }

  function groupElement(row) {
    const name = made("span", { class: "group-name" }, row.label);
    if (!row.given && row.begin !== null && row.begin !== undefined) {
      const add = made("button", { type: "button", class: "small" }, "add");
      add.setAttribute("aria-label", `add ${row.path}`);
      add.addEventListener("click", () => acts.set({ [row.path]: row.begin }));
      return made("div", { class: "absent", "data-path": row.path, title: row.meaning }, name, add);
    }
    const summary = made("summary", { title: row.meaning }, name);
    const [given, more] = [row.rows.filter((one) => one.given), row.rows.filter((one) => !one.given)];
    const group = made("details", { "data-path": row.path }, summary, ...given.map(element));
    if (more.length) {
      const rest = made("details", { class: "more", "data-path": `${row.path} more` }, made("summary", {}, `${more.length} more`));
      rest.append(...more.map(element));
      group.append(rest);
    }
    if (row.kind === "group" && row.path.includes(".")) group.append(removal(row));
    return group;
  }

  function removal(row) {
    const button = made("button", { type: "button", class: "small" }, `leave ${row.label} out`);
    button.setAttribute("aria-label", `leave ${row.path} out`);
    button.addEventListener("click", () => acts.set({ [row.path]: null }));
    return button;
  }

  function rowElement(row) {
    const id = `key-${row.path}`;
    const label = made("label", { for: id }, row.label);
    const unit = made("span", { class: "unit" }, row.unit);
    const input = inputOf(row, id);
    const help = made("p", { class: "help", id: `${id}-help` }, `${row.meaning}. ${row.allowed}. Left out: ${row.default}.`);
    input.setAttribute("aria-describedby", help.id);
    input.setAttribute("aria-label", [row.label, row.unit].filter(Boolean).join(" in "));
    const fault = made("p", { class: "fault", "aria-live": "polite" });
    const known = { row, input, fault, typing: false };
    state.inputs.set(row.path, known);
    listen(known, label);
    const out = row.given && !row.needed ? outButton(row) : null;
    const long = isText(row) && textOf(row.value).length > LONG_TEXT ? " long" : "";
    return made("div", { class: `value ${row.kind}${long}`, "data-path": row.path }, label, input, unit, out, fault, help);
  }

  // What is wrong with a key, beside it, and the way back where what was typed is not taken.
  function say(known) {
    const { path, value } = known.row;
    const own = state.own.get(path);
    const text = own ?? state.faults.get(path) ?? "";
    const back = own && known.row.given ? [" ", backButton(known, `put ${isNumber(known.row) ? textOf(value) : "it"} back`)] : [];
    known.fault.replaceChildren(text, ...back);
    known.input.setAttribute("aria-invalid", String(text !== ""));
    known.input.closest(".value")?.classList.toggle("refused", text !== "");
  }

  function backButton(known, words) {
    const button = made("button", { type: "button", class: "small" }, words);
    button.addEventListener("click", () => {
      state.own.delete(known.row.path);
      fillOne(known, known.row);
      known.input.focus();
    });
    return button;
  }

  // Keys that were emptied but must be given; their fields stay empty. Says which of them have no field.
  function lack(problems) {
    for (const [path, problem] of Object.entries(problems)) {
      const known = state.inputs.get(path);
      if (!known) continue;
      const { needed, allowed } = known.row;
      state.own.set(path, `nothing given; ${needed ? `needed: ${allowed}` : problem.replace("missing; ", "")}`);
      known.input.placeholder = "needed";
      put(known, "");
      say(known);
    }
    return Object.keys(problems).filter((path) => !state.inputs.has(path));
  }

  function outButton(row) {
    const button = made("button", { type: "button", class: "out" }, "\u00d7");
    button.setAttribute("aria-label", `leave ${row.path} out`);
    button.title = "leave out";
    button.addEventListener("click", () => acts.set({ [row.path]: null }));
    return button;
  }

  function inputOf(row, id) {
    if (row.kind === "truth") return made("input", { id, type: "checkbox" });
    if (row.kind === "choice") {
      const none = row.given ? [] : [made("option", { value: "" }, row.hint ? `(${row.hint})` : "")];
      const choices = row.choices.map((choice) => made("option", { value: String(choice) }, String(choice).replaceAll("_", " ")));
      return made("select", { id }, ...none, ...choices);
    }
    const more = { id, placeholder: row.hint, autocomplete: "off", spellcheck: "false" };
    if (isText(row)) return made("textarea", { ...more, rows: 1 });
    // A browser's own field of numbers drops the comma of a number that is pasted, and what is left is taken.
    return made("input", { ...more, type: "text", inputmode: isNumber(row) && row.least >= 0 ? "decimal" : "text" });
  }

  function listen(known, label) {
    const { input } = known;
    const told = (act) => {
      const value = valueOf(known.row, input);
      const { path, allowed } = known.row;
      state.own.delete(path);
      if (value === undefined) state.own.set(path, `not understood: ${allowed}`);
      say(known);
      if (value !== undefined) act({ [path]: value });
    };
    // What was emptied and has to be given goes along: another key may be given in its place now.
    const meant = (changes) => acts.set({ ...Object.fromEntries(emptied().map((path) => [path, null])), ...changes });
    input.addEventListener("input", () => {
      known.typing = true;
      fit(input);
      if (isNumber(known.row) && Number.isFinite(valueOf(known.row, input))) told(acts.change);
    });
    input.addEventListener("keydown", (event) => {
      const steps = { ArrowUp: 1, ArrowDown: -1 }[event.key];
      if (!steps || !isNumber(known.row) || !turned(known, valueOf(known.row, input), steps)) return;
      event.preventDefault();
      known.typing = known.turned = true;
      told(acts.change);
    });
    if (input.tagName === "TEXTAREA") {
      input.addEventListener("keydown", (event) => event.key === "Enter" && !event.shiftKey && (event.preventDefault(), input.blur()));
    }
    input.addEventListener("change", () => {
      known.typing = false;
      told(meant);
    });
    // A browser tells no change of what the arrow keys have turned.
    const turnedEnough = () => {
      known.typing = false;
      if (known.turned) told(meant);
      known.turned = false;
    };
    input.addEventListener("keyup", turnedEnough);
    input.addEventListener("blur", turnedEnough);
    if (isNumber(known.row)) turnBy(label, known, told, meant);
  }

  const emptied = () => [...state.own.keys()].filter((path) => state.inputs.get(path)?.input.value === "");

  // Puts a number some steps further; whether there is one.
  function turned(known, from, steps) {
    if (!Number.isFinite(from)) return false;
    const { step, least, most } = known.row;
    const value = Math.min(Math.max(from + steps * step, least ?? -Infinity), most ?? Infinity);
    put(known, String(Number(value.toPrecision(12))));
    return true;
  }

  // A name that is dragged sideways turns its number.
  function turnBy(label, known, told, meant) {
    let from = null;
    label.classList.add("turns");
    label.addEventListener("pointerdown", (event) => {
      from = { x: event.clientX, value: valueOf(known.row, known.input), moved: false };
      label.setPointerCapture(event.pointerId);
    });
    label.addEventListener("pointermove", (event) => {
      if (!from) return;
      const steps = Math.round((event.clientX - from.x) / PIXELS_A_STEP);
      if ((!steps && !from.moved) || !turned(known, from.value, steps)) return;
      from.moved = true;
      told(acts.change);
    });
    label.addEventListener("pointerup", () => {
      if (from?.moved) told(meant);
      from = null;
    });
    label.addEventListener("click", (event) => event.preventDefault());
  }

  // Shows only keys whose name or meaning has the words that are looked for.
  function filter() {
    const words = find.value.trim().toLowerCase();
    place.classList.toggle("found", words !== "");
    for (const one of place.querySelectorAll(".value, .absent")) {
      const text = `${one.dataset.path} ${one.querySelector(".help")?.textContent ?? one.title}`.toLowerCase();
      one.classList.toggle("hit", words !== "" && text.includes(words));
    }
    for (const one of place.querySelectorAll("details")) {
      if (words) one.open = one.querySelector(".hit") !== null;
      one.classList.toggle("hit", words !== "" && one.querySelector(".hit") !== null);
    }
  }

  // What is dragged elsewhere shows its number here.
  function follow(changes) {
    for (const [path, value] of Object.entries(changes)) {
      const known = state.inputs.get(path);
      if (known && known.input !== document.activeElement && isNumber(known.row)) put(known, String(Number(value.toPrecision(7))));
    }
  }

  // Says what refusals say of keys beside these, by the keys' paths.
  function mark(faults) {
    state.faults = faults;
    for (const known of state.inputs.values()) say(known);
  }

  function reveal(path) {
    const group = [...place.querySelectorAll("details")].find((one) => one.dataset.path === path);
    const shown = state.inputs.get(path)?.input ?? group?.querySelector("summary");
    if (!shown) return;
    for (let one = shown.closest("details"); one; one = one.parentElement.closest("details")) one.open = true;
    shown.scrollIntoView({ block: "center" });
    shown.focus();
  }

  find.addEventListener("input", filter);
  return { show, follow, mark, lack, reveal };
}
