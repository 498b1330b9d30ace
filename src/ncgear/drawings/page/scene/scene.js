/*
 * The moving scene of a report.
 *
 *   const scene = createScene(svgElement, data);
 *
 * svgElement is the <svg class="scene"> that scene_svg.py writes, data what scene_data of data.py tells of it.
 *
 *   scene.show(phi1)          put every body where it is at the driving angle phi1, in rad, of any number of turns
 *   scene.view(name)          look at "machine", "gears" or "mesh" (which follows the pitch point); without gears
 *                             there is "machine" alone, and scene.views tells which there are
 *   scene.driven_angle(phi1)  how far the crank's shaft has turned, in rad, in its own sense
 *   scene.shaft_angles(phi1)  how far each shaft has turned, in rad, the driving one first, the crank's last
 *   scene.zoom(factor)        magnify about the middle of the view; scene.reset() undoes zooming and dragging
 *   scene.place(name, phi1)   {x, y, angle} of a body in mm and rad, y upwards: "crank", "rod", "slider", "driving"
 *   scene.looking()           view, zoom and place of the picture, which scene.lookAs(...) of another scene takes over
 *   scene.follow(shafts)      turn by the tables of another law, while its gears are not there yet
 *   scene.numbers(on)         show the numbers of all teeth, or hide them
 *   scene.tooth_angle(name, n)  driving angle in [0, loop] at which tooth n of the gear of that name ("driving") is
 *                             on the line of centres
 *   scene.mark(name, n)       mark that tooth, and look at the mesh of its pair; scene.unmark() takes the mark away
 *   scene.teeth               number of teeth of each gear by its name
 *   scene.loop                driving angle in rad after which every body is back in its pose
 *
 * Angles are those of the law to 1e-6 rad; they are interpolated by Hermite's cubics from a table, all other places
 * follow from them in closed form.  Over the scene two fingers, a wheel with Ctrl, or a wheel once the scene has the
 * focus, zoom; dragging moves the view; a double click and the key 0 undo both; + and - zoom by keyboard.
 */

const DEGREES = 180 / Math.PI;
const LEAST_ZOOM = 0.5;
const MOST_ZOOM = 200;

function placed(place) {
  return `translate(${place.x} ${place.y}) rotate(${place.angle * DEGREES})`;
}

function showMaterial(groups, data, places, phi2) {
  if (!data.chamber) return;
  const depths = depthsAt(data, places[data.linkage.output].x - data.linkage.nearest, phi2);
  const strips = { material: data.chamber.end - depths.material, "material-behind": data.chamber.start };
  for (const [name, at] of Object.entries(strips)) {
    if (!groups[name]) continue;
    // What is pushed along keeps its length.
    const length = (name === "material" && data.chamber.pushed) || depths[name];
    groups[name].setAttribute("transform", `translate(${at} ${data.chamber.level}) scale(${length} 1)`);
  }
}

// The box (left, top, width, height) that a view shows; the view of the mesh follows the pitch point.
function boxOf(data, state) {
  const [left, bottom, width, height] = data.views[state.view];
  const center = { x: left + width / 2, y: bottom + height / 2 };
  const follows = state.view === "mesh" ? state.places[`pitch-point-${state.pair}`] : { x: 0, y: 0 };
  const [w, h] = [width / state.zoom, height / state.zoom];
  const x = center.x + follows.x + state.dx;
  const y = center.y + follows.y + state.dy;
  return [x - w / 2, -y - h / 2, w, h];
}

// Millimetres of the scene to a pixel of the screen.
function pixelSize(svg) {
  const matrix = svg.getScreenCTM();
  return matrix && matrix.a > 0 ? 1 / matrix.a : 1;
}

function bounded(zoom) {
  return Math.min(MOST_ZOOM, Math.max(LEAST_ZOOM, zoom));
}

// The bodies' groups by name; ids are looked for in the scene alone.
function groupsOf(svg) {
  const groups = {};
  for (const group of svg.querySelectorAll('g[id^="scene-"]')) groups[group.id.slice("scene-".length)] = group;
  return groups;
}

function createScene(svg, data) {
  const groups = groupsOf(svg);
  const state = { view: "machine", pair: data.pairs.length, zoom: 1, dx: 0, dy: 0, places: placesAt(data, 0) };
  const teeth = createTeeth(svg, groups, data);

  function look() {
    svg.setAttribute("viewBox", boxOf(data, state).join(" "));
    svg.classList.toggle("moved", state.zoom > 1);
  }

  function show(phi1) {
    state.places = placesAt(data, phi1);
    for (const name of Object.keys(state.places)) groups[name].setAttribute("transform", placed(state.places[name]));
    showMaterial(groups, data, state.places, driven_angle(phi1));
    teeth.show(state.places);
    if (state.view === "mesh") look();
  }

  function driven_angle(phi1) {
    return angleAt(data.shafts[data.shafts.length - 1], phi1).value;
  }

  function view(name) {
    if (!data.views[name]) throw new Error(`no view ${name}; there are ${Object.keys(data.views).join(", ")}`);
    svg.classList.remove(...Object.keys(data.views).map((one) => `view-${one}`));
    svg.classList.add(`view-${name}`);
    Object.assign(state, { view: name, pair: data.pairs.length });
    reset();
  }

  // A gear, the number of its pair from 1, and its mate.
  function geared(name) {
    const place = data.gears.findIndex((gear) => gear.name === name);
    if (place < 0) throw new Error(`no gear ${name}; there are ${data.gears.map((gear) => gear.name).join(", ")}`);
    return { gear: data.gears[place], mate: data.gears[place ^ 1], pair: (place >> 1) + 1 };
  }

  function tooth_angle(name, number) {
    const { gear, mate } = geared(name);
    return drivingAngleOf(data.shafts, gear.shaft, turnOfTooth(gear, mate, number), data.loop);
  }

  function mark(name, number) {
    const { gear, pair } = geared(name);
    view("mesh");
    state.pair = pair;
    teeth.mark(gear, number, state.places);
    look();
  }

  function reset() {
    Object.assign(state, { zoom: 1, dx: 0, dy: 0 });
    look();
  }

  // What is looked at, for another scene of the same machine.
  function looking() {
    return { view: state.view, zoom: state.zoom, dx: state.dx, dy: state.dy };
  }

  function lookAs(other) {
    view(data.views[other.view] ? other.view : "machine");
    Object.assign(state, { zoom: other.zoom, dx: other.dx, dy: other.dy });
    look();
  }

  // The shafts turn by another law, of which the gears know nothing yet.
  function follow(shafts) {
    data.shafts = shafts;
  }

  function zoom(factor) {
    state.zoom = bounded(state.zoom * factor);
    look();
  }

  function drag(right, down) {
    const size = pixelSize(svg);
    state.dx -= right * size;
    state.dy += down * size;
    look();
  }

  // What lies under a point of the screen stays there.
  function zoomAt(factor, clientX, clientY) {
    const box = svg.getBoundingClientRect();
    const [right, down] = [clientX - box.left - box.width / 2, clientY - box.top - box.height / 2];
    drag(-right, -down);
    zoom(factor);
    drag(right, down);
  }

  const act = { zoom, zoomAt, drag, reset };
  listenToPointers(svg, act);
  listenToWheel(svg, act);
  listenToKeys(svg, act);
  view("machine");
  show(0);
  const place = (name, phi1) => placesAt(data, phi1)[name];
  const shaft_angles = (phi1) => shaftsAt(data.shafts, phi1).map((shaft) => shaft.value);
  const views = Object.keys(data.views);
  const numbers = (on) => teeth.numbers(on, state.places);
  const of_teeth = { numbers, tooth_angle, mark, unmark: teeth.unmark };
  const counts = Object.fromEntries(data.gears.map((gear) => [gear.name, gear.teeth.at.length]));
  const of_picture = { view, views, zoom, reset, looking, lookAs };
  return { show, follow, driven_angle, shaft_angles, place, ...of_picture, ...of_teeth, teeth: counts, loop: data.loop };
}
