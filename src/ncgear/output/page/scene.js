"use strict";
/*
 * The moving scene of a report.
 *
 *   const scene = createScene(svgElement, data);
 *
 * svgElement is the <svg class="scene"> that ncgear.output.page.scene_svg writes, data what scene_data tells of it.
 *
 *   scene.show(phi1)          put every body where it is at the driving angle phi1, in rad, of any number of turns
 *   scene.view(name)          look at "machine", "gears" or "mesh" (which follows the pitch point); without gears
 *                             there is "machine" alone, and scene.views tells which there are
 *   scene.driven_angle(phi1)  how far the crank's shaft has turned, in rad, in its own sense
 *   scene.shaft_angles(phi1)  how far each shaft has turned, in rad, the driving one first, the crank's last
 *   scene.zoom(factor)        magnify about the middle of the view; scene.reset() undoes zooming and dragging
 *   scene.place(name, phi1)   {x, y, angle} of a body in mm and rad, y upwards: "crank", "rod", "slider", "driving"
 *   scene.loop                driving angle in rad after which every body is back in its pose
 *
 * Angles are those of the law to 1e-6 rad; they are interpolated by Hermite's cubics from a table, all other places
 * follow from them in closed form.  Over the scene two fingers, a wheel with Ctrl, or a wheel once the scene has the
 * focus, zoom; dragging moves the view; a double click and the key 0 undo both; + and - zoom by keyboard.
 */
const createScene = (() => {
  const DEGREES = 180 / Math.PI;
  const WHEEL = 1.0015;
  const KEY_ZOOM = 1.25;
  const LEAST_ZOOM = 0.5;
  const MOST_ZOOM = 200;

  /* The last index whose entry is at or below a value; entries rise. */
  function below(entries, value) {
    let low = 0;
    let high = entries.length - 1;
    while (high - low > 1) {
      const middle = (low + high) >> 1;
      if (entries[middle] <= value) low = middle;
      else high = middle;
    }
    return low;
  }

  /* Value and slope of a table of angles, which repeats but for its rise. */
  function angleAt(table, x) {
    const turns = Math.floor(x / table.period);
    const local = x - turns * table.period;
    const i = below(table.at, local);
    const width = table.at[i + 1] - table.at[i];
    const t = width > 0 ? (local - table.at[i]) / width : 0;
    const rise = table.value[i + 1] - table.value[i];
    const [start, end] = [table.slope[i] * width, table.slope[i + 1] * width];
    const [square, cubic] = [3 * rise - 2 * start - end, start + end - 2 * rise];
    return {
      value: turns * table.rise + table.value[i] + t * (start + t * (square + t * cubic)),
      slope: width > 0 ? (start + t * (2 * square + 3 * t * cubic)) / width : table.slope[i],
    };
  }

  /* Angles of all shafts and their speeds by phi1: the tables before the last tell the shafts between. */
  function shaftsAt(tables, phi1) {
    const shafts = [{ value: phi1, slope: 1 }];
    for (const table of tables.slice(0, -1)) {
      const before = shafts[shafts.length - 1];
      const own = angleAt(table, before.value);
      shafts.push({ value: own.value, slope: own.slope * before.slope });
    }
    shafts.push(angleAt(tables[tables.length - 1], phi1));
    return shafts;
  }

  /* The vector loop: crank pin and slider pin from the crank's angle. */
  function linkageAt(linkage, phi2) {
    const crank = linkage.start - phi2;
    const pin = { x: linkage.crank * Math.cos(crank), y: linkage.crank * Math.sin(crank) };
    const rise = linkage.offset - pin.y;
    const along = Math.sqrt(linkage.rod ** 2 - rise ** 2);
    return {
      crank: { x: 0, y: 0, angle: crank },
      rod: { x: pin.x, y: pin.y, angle: Math.atan2(rise, along) },
      slider: { x: pin.x + along, y: linkage.offset, angle: 0 },
      "crank-pin": { x: pin.x, y: pin.y, angle: 0 },
      "slider-pin": { x: pin.x + along, y: linkage.offset, angle: 0 },
    };
  }

  function gearAt(gear, shafts) {
    const angle = gear.start + gear.sense * shafts[gear.shaft].value;
    return { x: gear.axis[0], y: gear.axis[1], angle };
  }

  /* x = -s r1 from the driving axis towards the driven one, r1/a = w/(1 - s w), w the ratio of the shafts' speeds. */
  function pitchPointAt(pair, shafts) {
    const w = shafts[pair.shaft + 1].slope / shafts[pair.shaft].slope;
    const share = (-pair.sense * w) / (1 - pair.sense * w);
    const [[x1, y1], [x2, y2]] = pair.axes;
    return { x: x1 + share * (x2 - x1), y: y1 + share * (y2 - y1), angle: 0 };
  }

  /* Where every body is, by name. */
  function placesAt(data, phi1) {
    const shafts = shaftsAt(data.shafts, phi1);
    const places = linkageAt(data.linkage, shafts[shafts.length - 1].value);
    for (const gear of data.gears) places[gear.name] = gearAt(gear, shafts);
    data.pairs.forEach((pair, i) => (places[`pitch-point-${i + 1}`] = pitchPointAt(pair, shafts)));
    return places;
  }

  /* How deep the material is: on its way back the slider leaves it behind as it has pressed it. */
  function depthAt(data, displacement, phi2) {
    const { chamber, linkage } = data;
    const turned = phi2 - 2 * Math.PI * Math.floor(phi2 / (2 * Math.PI));
    const pressed = turned < linkage.working ? Math.max(displacement, chamber.begins) : linkage.stroke;
    return chamber.end - chamber.face - linkage.nearest - pressed;
  }

  function placed(place) {
    return `translate(${place.x} ${place.y}) rotate(${place.angle * DEGREES})`;
  }

  function showMaterial(group, data, places, phi2) {
    const depth = depthAt(data, places.slider.x - data.linkage.nearest, phi2);
    group.setAttribute("transform", `translate(${data.chamber.end - depth} ${data.linkage.offset}) scale(${depth} 1)`);
  }

  /* The box (left, top, width, height) that a view shows; of a moving one, about its point. */
  function boxOf(data, state) {
    const [left, bottom, width, height] = data.views[state.view];
    const center = { x: left + width / 2, y: bottom + height / 2 };
    const follows = state.view === "mesh" ? state.places[`pitch-point-${data.pairs.length}`] : { x: 0, y: 0 };
    const [w, h] = [width / state.zoom, height / state.zoom];
    const x = center.x + follows.x + state.dx;
    const y = center.y + follows.y + state.dy;
    return [x - w / 2, -y - h / 2, w, h];
  }

  /* Millimetres of the scene to a pixel of the screen. */
  function pixelSize(svg) {
    const matrix = svg.getScreenCTM();
    return matrix && matrix.a > 0 ? 1 / matrix.a : 1;
  }

  function bounded(zoom) {
    return Math.min(MOST_ZOOM, Math.max(LEAST_ZOOM, zoom));
  }

  /* Pointers that are down, and what moving one of them means: one drags, two zoom and drag. */
  function listenToPointers(svg, act) {
    const down = new Map();
    svg.addEventListener("pointerdown", (event) => {
      down.set(event.pointerId, event);
      svg.setPointerCapture(event.pointerId);
    });
    for (const name of ["pointerup", "pointercancel"]) {
      svg.addEventListener(name, (event) => down.delete(event.pointerId));
    }
    svg.addEventListener("pointermove", (event) => {
      const before = down.get(event.pointerId);
      if (!before) return;
      const other = [...down.values()].find((one) => one.pointerId !== event.pointerId);
      if (other) pinch(act, before, event, other);
      act.drag((event.clientX - before.clientX) / down.size, (event.clientY - before.clientY) / down.size);
      down.set(event.pointerId, event);
    });
  }

  function pinch(act, before, now, other) {
    const factor = spread(now, other) / spread(before, other);
    act.zoomAt(factor, (now.clientX + other.clientX) / 2, (now.clientY + other.clientY) / 2);
  }

  function spread(one, other) {
    return Math.max(1, Math.hypot(one.clientX - other.clientX, one.clientY - other.clientY));
  }

  function listenToWheel(svg, act) {
    const onWheel = (event) => {
      if (!event.ctrlKey && document.activeElement !== svg) return;
      event.preventDefault();
      act.zoomAt(WHEEL ** -event.deltaY, event.clientX, event.clientY);
    };
    svg.addEventListener("wheel", onWheel, { passive: false });
    svg.addEventListener("dblclick", act.reset);
  }

  function listenToKeys(svg, act) {
    const keys = { "+": () => act.zoom(KEY_ZOOM), "-": () => act.zoom(1 / KEY_ZOOM), 0: act.reset };
    svg.addEventListener("keydown", (event) => {
      if (keys[event.key]) keys[event.key]();
    });
  }

  /* The bodies' groups by name; ids are looked for in the scene alone. */
  function groupsOf(svg) {
    const groups = {};
    for (const group of svg.querySelectorAll('g[id^="scene-"]')) groups[group.id.slice("scene-".length)] = group;
    return groups;
  }

  return function createScene(svg, data) {
    const groups = groupsOf(svg);
    const state = { view: "machine", zoom: 1, dx: 0, dy: 0, places: placesAt(data, 0) };

    function look() {
      svg.setAttribute("viewBox", boxOf(data, state).join(" "));
      svg.classList.toggle("moved", state.zoom > 1);
    }

    function show(phi1) {
      state.places = placesAt(data, phi1);
      for (const name of Object.keys(state.places)) groups[name].setAttribute("transform", placed(state.places[name]));
      if (groups.material) showMaterial(groups.material, data, state.places, driven_angle(phi1));
      if (state.view === "mesh") look();
    }

    function driven_angle(phi1) {
      return angleAt(data.shafts[data.shafts.length - 1], phi1).value;
    }

    function view(name) {
      if (!data.views[name]) throw new Error(`no view ${name}; there are ${Object.keys(data.views).join(", ")}`);
      svg.classList.remove(...Object.keys(data.views).map((one) => `view-${one}`));
      svg.classList.add(`view-${name}`);
      state.view = name;
      reset();
    }

    function reset() {
      Object.assign(state, { zoom: 1, dx: 0, dy: 0 });
      look();
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

    /* What lies under a point of the screen stays there. */
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
    return { show, view, driven_angle, shaft_angles, zoom, reset, place, views, loop: data.loop };
  };
})();
