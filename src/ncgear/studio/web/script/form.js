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
  const numbers = parts.map(Number);
  return numbers.every(Number.isFinite) ? numbers : null;
}

function textOf(value) {
  if (value === null || value === undefined) return "";
  return Array.isArray(value) ? value.join(", ") : String(value);
}

// What an input holds, in the form of the file; undefined for what is none.
function valueOf(row, input) {
  const text = input.type === "checkbox" ? String(input.checked) : input.value.trim();
  if (text === "") return null;
  if (row.kind === "truth") return text === "true";
  if (row.kind === "numbers") return numbersIn(text) ?? undefined;
  if (row.kind === "choice") return (row.choices ?? []).find((choice) => String(choice) === text);
  if (row.kind === "other") return text === "true" || text === "false" ? text === "true" : Number.isFinite(Number(text)) ? Number(text) : text;
  if (row.kind === "text") return text;
  const number = Number(text);
  return Number.isFinite(number) ? number : undefined;
}

// `acts.change(changes)` hears of every value on the way, `acts.set(changes)` of the one that is meant.
function createForm(place, find, acts) {
  const state = { shape: "", inputs: new Map(), faults: new Map() };

  function show(rows) {
    const shape = JSON.stringify(rows, (key, value) => (["value", "step"].includes(key) ? undefined : value));
    if (shape !== state.shape) build(rows, shape);
    fill(rows);
  }

  function build(rows, shape) {
    const open = new Set([...place.querySelectorAll("details[open]")].map((one) => one.dataset.path));
    // On a phone all groups begin closed, so that every one of them is in reach.
    if (!state.shape && innerWidth > NARROW) ["motion", "gears", "operation", "linkage"].forEach((path) => open.add(path));
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
    say(known, state.faults.get(row.path) ?? "");
    if (input.type === "checkbox") input.checked = row.value === true;
    else input.value = textOf(row.value);
    if (input.type === "number") input.step = row.kind === "integer" ? 1 : row.step;
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
    const long = row.kind === "text" && String(row.value ?? "").length > LONG_TEXT ? " long" : "";
    return made("div", { class: `value ${row.kind}${long}`, "data-path": row.path }, label, input, unit, out, fault, help);
  }

  // What is wrong with a key, beside it; nothing where the text is empty.
  function say(known, text) {
    known.fault.textContent = text;
    known.input.setAttribute("aria-invalid", String(text !== ""));
    known.input.closest(".value")?.classList.toggle("refused", text !== "");
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
    if (row.kind === "number" || row.kind === "integer") {
      return made("input", { id, type: "number", min: row.least, max: row.most, step: "any", placeholder: row.hint });
    }
    const more = { id, placeholder: row.hint, autocomplete: "off", spellcheck: "false" };
    return row.kind === "text" ? made("textarea", { ...more, rows: 1 }) : made("input", { ...more, type: "text" });
  }

  function listen(known, label) {
    const { input } = known;
    const told = (act) => {
      const value = valueOf(known.row, input);
      const emptied = value === null && known.row.given && known.row.needed;
      const fault = emptied ? "nothing given; needed" : value === undefined ? "not understood" : "";
      say(known, fault && `${fault}: ${known.row.allowed}`);
      if (!fault) act({ [known.row.path]: value });
    };
    const isNumber = () => input.type === "number";
    input.addEventListener("input", () => {
      known.typing = true;
      if (isNumber() && input.value !== "") told(acts.change);
    });
    if (input.tagName === "TEXTAREA") {
      input.addEventListener("keydown", (event) => event.key === "Enter" && !event.shiftKey && (event.preventDefault(), input.blur()));
    }
    input.addEventListener("change", () => {
      known.typing = false;
      told(acts.set);
    });
    input.addEventListener("blur", () => (known.typing = false));
    if (isNumber()) turnBy(label, known, told);
  }

  // A name that is dragged sideways turns its number.
  function turnBy(label, known, told) {
    let from = null;
    label.classList.add("turns");
    label.addEventListener("pointerdown", (event) => {
      from = { x: event.clientX, value: Number(known.input.value), moved: false };
      label.setPointerCapture(event.pointerId);
    });
    label.addEventListener("pointermove", (event) => {
      if (!from || known.input.value === "") return;
      const steps = Math.round((event.clientX - from.x) / PIXELS_A_STEP);
      if (!steps && !from.moved) return;
      from.moved = true;
      known.input.value = Number((from.value + steps * known.row.step).toPrecision(12));
      told(acts.change);
    });
    label.addEventListener("pointerup", () => {
      if (from?.moved) told(acts.set);
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
      if (known && known.input !== document.activeElement && known.input.type === "number") {
        known.input.value = Number(value.toPrecision(7));
      }
    }
  }

  // Says what refusals say of keys beside these, by the keys' paths.
  function mark(faults) {
    state.faults = faults;
    for (const [path, known] of state.inputs) say(known, faults.get(path) ?? "");
  }

  function reveal(path) {
    const known = state.inputs.get(path);
    if (!known) return;
    for (let one = known.input.closest("details"); one; one = one.parentElement.closest("details")) one.open = true;
    known.input.scrollIntoView({ block: "center" });
    known.input.focus();
  }

  find.addEventListener("input", filter);
  return { show, follow, mark, reveal };
}
