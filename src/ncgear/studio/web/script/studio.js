// The page put together: one design, and everything that shows it or changes it.

function start() {
  const at = (id) => document.getElementById(id);
  const state = { newest: 0, refused: {}, failed: {}, motion: null, power: [], held: false, begun: false };
  const link = createLink(hear, (on, taken) => {
    document.body.classList.toggle("offline", !on);
    if (taken) say("This page goes on in another tab; load it anew to go on here.");
    else if (!on) say("The server does not answer; the page connects anew as soon as it does.");
    else if (at("said").textContent.startsWith("The server")) say("");
  });

  // What was said is about what was done before.
  function send(message) {
    if (!document.body.classList.contains("offline")) say("");
    link.send(message);
  }

  const machine = createMachine(at("stage"), at("held-stage"));
  const clock = createClock(show);
  const controls = createControls(clock);
  const acts = {
    change: (changes) => {
      send({ do: "change", changes });
      form.follow(changes);
    },
    keep: () => {
      send({ do: "keep" });
      board.settle();
    },
    set: (changes) => send({ do: "set", changes }),
    reveal: (key) => form.reveal(key),
  };
  const handles = createHandles(acts);
  const drawing = createDrawing(at("drawing"), at("nearest"), acts);
  const board = createBoard(at("charts"), handles, pick);
  const form = createForm(at("form"), at("find"), acts);
  const told = createTold(acts);
  const finder = createFinder(machine.scene, clock);
  const making = createMaking(at("jobs"), send);
  const saving = createSaving(at("question"), send);

  function show(deg, playing) {
    machine.show(deg * RAD);
    controls.show(deg, playing);
    const scene = machine.scene();
    if (scene) board.show(degreesAt(scene, deg));
  }

  function pick(chart, deg) {
    clock.set(chart.angle === "driving" ? deg : drivingOf(machine.scene(), chart.angle, deg));
  }

  function say(text) {
    at("said").textContent = text;
  }

  function hear(message) {
    const { is, n, content } = message;
    if (is === "refused") state.failed[message.from] = n;
    if (n !== undefined) {
      // Answers to a text that is not shown any more come too late.
      if (is === "refused" && n < state.newest) return;
      state.newest = Math.max(state.newest, n);
    }
    const answers = { state: takeState, motion: takeMotion, power: takePower, scene: takeScene, bare: takeBare, figures: told.take, teeth: told.take };
    Object.assign(answers, { verdict: told.verdict, strength: told.take, best: told.best, chart: board.draw });
    Object.assign(answers, { drawing: drawing.take, fitted: drawing.fit });
    Object.assign(answers, { job: making.show, said: say, question: saving.ask, lacking: takeLacking });
    if (is === "refused") takeRefusal(message);
    else if (answers[is]) answers[is](content, message);
    if (["motion", "scene", "strength", "done"].includes(is)) settled(message);
    if (is === "done" && state.failed[message.from] !== n) ended(message);
    showStale();
    if (is === "done") document.body.dataset[`done${message.from[0].toUpperCase()}${message.from.slice(1)}`] = n;
  }

  function takeState(content, message) {
    saving.leave();
    at("name").textContent = content.file;
    at("saved").textContent = content.saved ? "saved" : "not saved";
    at("save").disabled = content.saved;
    at("undo").disabled = !content.undo;
    at("redo").disabled = !content.redo;
    if (document.activeElement !== at("text")) at("text").value = content.text;
    at("difference").textContent = content.difference || "Nothing.";
    if (content.form) form.show(content.form);
    for (const one of document.querySelectorAll("[data-run]")) one.hidden = !content.commands.includes(one.dataset.run);
    making.showAll(content.jobs);
    document.body.dataset.asked = message.n;
  }

  // Keys without a field are groups.
  function takeLacking(content) {
    const groups = form.lack(content);
    if (groups.length) say(groups.map((path) => `${path} cannot be left out: ${content[path]}`).join(" "));
  }

  function takeMotion(content, { n }) {
    state.motion = content;
    machine.follow(content, n);
    board.follow(content, n);
    at("points").hidden = !content.handles.length;
    document.querySelector("#curves > .hint").hidden = !content.charts.length;
    setPaces(content.paces);
    clock.fit(content.loop / RAD, content.swings);
  }

  // Power that counts gears comes with them.
  function takePower(content, { n }) {
    state.power = content;
    board.lines(content, n);
  }

  function takeScene(content, { n }) {
    machine.take(content, n);
    finder.fit();
    clock.set(state.begun ? clock.deg() : firstPose(machine.scene(), clock.cycle()));
    state.begun = true;
  }

  // Without teeth the mechanism alone is shown, unless there is an earlier machine to be seen behind the refusal.
  function takeBare(content, message) {
    if (!machine.scene()) takeScene(content, message);
  }

  function setPaces(paces) {
    const select = at("pace");
    const chosen = Math.max(select.selectedIndex, 0);
    select.replaceChildren(...paces.map((pace) => made("option", { value: pace.deg_s }, pace.name)));
    select.selectedIndex = Math.min(chosen, paces.length - 1);
    clock.setPace(Number(select.value));
  }

  function takeRefusal(message) {
    state.refused[message.from] = { ...message.content, n: message.n };
    showRefusals();
  }

  // The same refusal of several chains is told once.
  function showRefusals() {
    const found = Object.values(state.refused);
    const each = found.flatMap((one) => [one, ...one.others.map((other) => ({ ...one, ...other }))]);
    const once = each.filter((one, i) => each.findIndex((other) => other.problem === one.problem && other.key === one.key) === i);
    told.refusals(once);
    form.mark(new Map(once.map((one) => [one.key, one.problem])));
  }

  // What an earlier text has achieved is pale while the text that is shown is refused.
  function showStale() {
    const stale = (from, n) => (state.refused[from]?.n ?? -Infinity) > n;
    const motion = told.showStale(stale);
    board.showStale(stale);
    const before = { motion, machine: machine.showStale(Math.max(-Infinity, ...Object.values(state.refused).map((one) => one.n))) };
    for (const one of document.querySelectorAll("[data-now]")) one.textContent = before[one.dataset.now] ? "before" : "now";
  }

  // What is answered to its end, or up to its picture while a newer change waits, is not refused any more.
  function settled({ from, n }) {
    if (state.refused[from]?.n < n) {
      delete state.refused[from];
      showRefusals();
    }
  }

  // What a chain has answered to its end, unrefused, is all that there is of it: what it told of earlier texts goes.
  function ended({ from, n }) {
    board.drop(from, n);
    told.drop(from, n);
    drawing.drop(from, n);
  }

  function hold() {
    state.held = !state.held && machine.hold();
    if (!state.held) machine.release();
    board.hold(state.held ? [...state.power, ...state.motion.charts] : null);
    told.hold(state.held);
    at("hold").setAttribute("aria-pressed", String(state.held));
    at("hold").textContent = state.held ? "Stop comparing" : "Keep to compare";
    clock.set(clock.deg());
  }

  at("undo").addEventListener("click", () => send({ do: "undo" }));
  at("redo").addEventListener("click", () => send({ do: "redo" }));
  at("save").addEventListener("click", saving.save);
  at("hold").addEventListener("click", hold);
  at("take").addEventListener("click", () => {
    at("text").blur();
    send({ do: "text", text: at("text").value });
  });
  document.addEventListener("keydown", (event) => {
    if (!(event.ctrlKey || event.metaKey) || event.altKey) return;
    const typing = event.target.closest("textarea, input[type=search], :not(.number, .integer) > input[type=text]");
    const key = event.key.toLowerCase();
    if (key === "s") saving.save();
    else if (key === "z" && !typing) send({ do: event.shiftKey ? "redo" : "undo" });
    else if (key === "y" && !typing) send({ do: "redo" });
    else return;
    event.preventDefault();
  });
  listenToDrops((file, page) => {
    const asked = `drop?page=${encodeURIComponent(page)}&name=${encodeURIComponent(file.name)}`;
    say(`${file.name} is being read ...`);
    fetch(asked, { method: "POST", body: file }).then(
      async (answer) => answer.ok || say(await answer.text()),
      () => say(`${file.name} cannot be read.`),
    );
  });
  listenToViews(() => machine.scene() ?? { view() {}, zoom() {}, reset() {} });

  // For whoever looks at the page by script: angles in rad.
  window.ncgear = Object.freeze({
    show: (phi1) => clock.set(phi1 / RAD),
    drivenAngle: (phi1) => machine.scene().driven_angle(phi1),
    motion: () => state.motion,
    chart: board.chart,
    send: send,
  });
}

start();
