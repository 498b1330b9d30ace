// Round points on the charts that are dragged, or moved by the arrow keys.

// Steps of the arrow keys, as shares of the scales of the chart.
const NUDGE = 0.005;
const LEAP = 5;

// Radius of a handle with its stroke of 2.5: 16 pixels across.
const RADIUS = 6.75;

// Significant digits of what is dragged: a pixel of a chart is a hundredth or more of its value.
const DRAGGED_DIGITS = 3;

const AXES = { x: { scale: "angle_deg", place: "x" }, y: { scale: "values", place: "y" } };

function digits(value) {
  return Number(value.toPrecision(5)).toString().replace("-", "\u2212");
}

function spoken(handle, at) {
  return Object.entries(handle.moves)
    .map(([axis, move]) => `${digits(valueAt(move, at[axis] - handle[axis]))} ${move.unit}`.trim())
    .join(", ");
}

// Where nothing was moved the value keeps all its digits.
function valueAt(move, step) {
  return step ? Number((move.base + move.factor * step).toPrecision(DRAGGED_DIGITS)) : move.base;
}

// The changes of keys that a move to a value makes: its own key, and those that go along with it.
function changesOf(move, value) {
  const changes = move.key ? { [move.key]: move.text ? move.text.join(value) : value } : {};
  for (const one of move.along ?? []) {
    const gone = (base, place) => {
      if (one.power !== undefined) return base * (value / move.base) ** one.power;
      if (one.log !== undefined) return base + one.log[place] * Math.log(value / move.base);
      return base + one.sum * (value - move.base);
    };
    changes[one.key] = Array.isArray(one.base) ? one.base.map(gone) : gone(one.base, 0);
  }
  return changes;
}

function lastDigit(value) {
  return value ? 10 ** (Math.floor(Math.log10(Math.abs(value))) + 1 - DRAGGED_DIGITS) : 0;
}

// `acts.change(changes)` hears of every place on the way, `acts.keep()` of its end.
function createHandles(acts) {
  const state = { dragged: null };

  // An axis along which a handle was never moved leaves its key as it is; one that is back gives its value back.
  function changesAt(dot, handle, at) {
    const axes = Object.keys(handle.moves).filter((axis) => at[axis] !== handle[axis] || dot.moved?.has(axis));
    dot.moved = new Set(axes);
    return Object.assign({}, ...axes.map((axis) => changesOf(handle.moves[axis], valueAt(handle.moves[axis], at[axis] - handle[axis]))));
  }

  function move(dot, handle, at, chart) {
    const free = { x: "x" in handle.moves ? at.x : handle.x, y: "y" in handle.moves ? at.y : handle.y };
    place(dot, free, chart);
    dot.setAttribute("aria-valuetext", spoken(handle, free));
    tell(dot, handle, free, chart);
    const changes = changesAt(dot, handle, free);
    if (Object.keys(changes).length) acts.change(changes);
  }

  function place(dot, at, chart) {
    dot.setAttribute("cx", between(at.x, chart.angle_deg, chart.x));
    dot.setAttribute("cy", between(at.y, chart.values, chart.y));
  }

  // The value beside a handle, on the side of the chart where there is more room, and whole.
  function tell(dot, handle, at, chart) {
    const told = dot.parentNode.querySelector("text");
    const x = between(at.x, chart.angle_deg, chart.x);
    told.textContent = `${handle.name}: ${spoken(handle, at)}`;
    const [wide, whole] = [told.getComputedTextLength(), dot.ownerSVGElement.viewBox.baseVal.width];
    const beside = x > (chart.x[0] + chart.x[1]) / 2 ? x - 12 - wide : x + 12;
    told.setAttribute("x", Math.max(0, Math.min(beside, whole - wide)));
    told.setAttribute("y", Math.max(between(at.y, chart.values, chart.y) - 10, 12));
  }

  function untell(dot) {
    if (state.dragged === null) dot.parentNode?.querySelector("text")?.replaceChildren();
  }

  // Where the handle is when the pointer has taken it along from where it was grasped.
  function dragged(handle, from, to, chart) {
    const way = (axis, scale, place) => between(to[axis], place, scale) - between(from[axis], place, scale);
    return {
      x: handle.x + way("x", chart.angle_deg, chart.x),
      y: handle.y + way("y", chart.values, chart.y),
    };
  }

  function listen(dot, handle, svg, chart) {
    // Where the handle was grasped, and where the chart stood then: what comes above it meanwhile moves no handle.
    let grasped = null;
    dot.addEventListener("pointerdown", (event) => {
      event.stopPropagation();
      event.preventDefault();
      dot.focus();
      dot.setPointerCapture(event.pointerId);
      state.dragged = handle;
      const units = intoUnits(svg);
      grasped = { units, from: placeIn(units, event) };
    });
    dot.addEventListener("pointermove", (event) => {
      if (!dot.hasPointerCapture(event.pointerId)) return;
      event.stopPropagation();
      move(dot, handle, dragged(handle, grasped.from, placeIn(grasped.units, event), chart), chart);
    });
    for (const name of ["pointerup", "pointercancel"]) {
      dot.addEventListener(name, () => {
        if (state.dragged === null) return;
        state.dragged = null;
        acts.keep();
      });
    }
    dot.addEventListener("keydown", (event) => onArrow(event, dot, handle, chart));
    dot.addEventListener("keyup", (event) => event.key.startsWith("Arrow") && acts.keep());
  }

  function onArrow(event, dot, handle, chart) {
    const steps = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[event.key];
    if (!steps) return;
    event.preventDefault();
    event.stopPropagation();
    const share = NUDGE * (event.shiftKey ? LEAP : 1);
    dot.at = dot.at ?? { x: handle.x, y: handle.y };
    Object.keys(AXES).forEach((axis, i) => {
      const [low, high] = chart[AXES[axis].scale];
      const move = handle.moves[axis];
      // At least one step of the last digit that is kept, so that no press is lost.
      if (move) dot.at[axis] += steps[i] * Math.max(share * (high - low), Math.abs(lastDigit(move.base) / move.factor));
    });
    move(dot, handle, dot.at, chart);
  }

  // Puts the handles of a chart into its drawing; while one is dragged all stay as they are.
  function put(svg, chart, handles) {
    if (state.dragged) return;
    const focused = svg.contains(document.activeElement) ? document.activeElement.dataset.handle : null;
    svg.querySelector("g.handles")?.remove();
    const group = svgElement("g", { class: "handles" }, svg);
    for (const handle of handles.filter((one) => one.chart === chart.key)) {
      const name = `${handle.name} ${Object.values(handle.moves).map((move) => move.key).join(" ")}`;
      const dot = svgElement(
        "circle",
        { r: RADIUS, tabindex: 0, role: "slider", "aria-label": handle.name, "data-handle": name },
        group,
      );
      const main = handle.moves.y ?? handle.moves.x;
      dot.setAttribute("aria-valuenow", main.base);
      dot.setAttribute("aria-valuetext", spoken(handle, handle));
      for (const name of ["pointerenter", "focus"]) dot.addEventListener(name, () => state.dragged ?? tell(dot, handle, handle, chart));
      for (const name of ["pointerleave", "blur"]) dot.addEventListener(name, () => untell(dot));
      place(dot, handle, chart);
      listen(dot, handle, svg, chart);
    }
    svgElement("text", { class: "told", "aria-hidden": true }, group);
    if (focused) focus(svg, focused);
  }

  // Gives the focus back to a handle that was drawn anew.
  function focus(place, name) {
    [...place.querySelectorAll(".handles circle")].find((dot) => dot.dataset.handle === name)?.focus({ preventScroll: true });
  }

  return { put, focus, dragging: () => state.dragged !== null };
}
