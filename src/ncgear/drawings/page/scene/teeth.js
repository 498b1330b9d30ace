// Teeth by their numbers, from 1: where each stands, when it is at the mesh, and what shows it in the scene.

// Radius of a mark, as a multiple of the height of numbers.
const MARK_SIZE = 1.8;

// How far a gear's shaft has turned, in its own sense, when a tooth is on the line of centres; 0 to 2 pi.
function turnOfTooth(gear, mate, number) {
  const [x, y] = gear.teeth.at[number - 1];
  const meeting = Math.atan2(mate.axis[1] - gear.axis[1], mate.axis[0] - gear.axis[0]);
  return wrapped(gear.sense * (meeting + gear.facing - gear.start - Math.atan2(y, x)), 2 * Math.PI);
}

// The driving angle in [0, loop] at which a shaft has turned so far; the nearer end where it never does.
function drivingAngleOf(tables, shaft, turn, loop) {
  const most = shaftsAt(tables, loop)[shaft].value;
  if (turn > (most + 2 * Math.PI) / 2) return 0;
  let [low, high] = [0, loop];
  for (let step = 0; step < 60; step += 1) {
    const middle = (low + high) / 2;
    if (shaftsAt(tables, middle)[shaft].value <= turn) low = middle;
    else high = middle;
  }
  return low;
}

function added(group, name, attributes) {
  const made = document.createElementNS(group.namespaceURI, name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  group.append(made);
  return made;
}

// Numbers stand in their gear's group and are turned back, so that they can be read in every pose.  The mark lies over
// all bodies, and moves with its gear.
function createTeeth(svg, groups, data) {
  const labels = new Map();
  const state = { named: null };
  const over = added(svg.querySelector("g.world"), "g", { class: "marks" });

  function label(gear, number) {
    const key = `${gear.name} ${number}`;
    if (!labels.has(key)) {
      const text = added(groups[gear.name], "text", { class: "number", "font-size": gear.teeth.size });
      text.textContent = number;
      labels.set(key, { text, gear, place: gear.teeth.label[number - 1] });
    }
    return labels.get(key);
  }

  function show(places) {
    for (const { text, gear, place } of labels.values()) {
      const back = -places[gear.name].angle * DEGREES;
      text.setAttribute("transform", `translate(${place[0]} ${place[1]}) rotate(${back}) scale(1 -1)`);
    }
    if (state.named) over.setAttribute("transform", placed(places[state.named.gear.name]));
  }

  function numbers(on, places) {
    svg.classList.toggle("numbered", on);
    if (!on) return;
    for (const gear of data.gears) gear.teeth.at.forEach((_, i) => label(gear, i + 1));
    show(places);
  }

  function unmark() {
    if (state.named) state.named.text.classList.remove("named");
    state.named = null;
    over.replaceChildren();
  }

  function mark(gear, number, places) {
    unmark();
    const [x, y] = gear.teeth.at[number - 1];
    added(over, "circle", { class: "mark", cx: x, cy: y, r: MARK_SIZE * gear.teeth.size });
    state.named = label(gear, number);
    state.named.text.classList.add("named");
    show(places);
  }

  return { show, numbers, mark, unmark };
}
