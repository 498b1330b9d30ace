// The drawing of the pitch curve: its outline, points that are dragged, the nearest pair where teeth are refused.

// Points on each side of a dragged one that go along, by the square of a cosine, so that no corner arises.
const ALONG = 3;

// Room around the outline, radius of a point and width of a line, as shares of the outline's size.
const ROOM = 0.08;
const POINT = 0.011;

// Decimals of a millimetre to which points are dragged.
const HUNDREDTHS = 100;

// `acts.change(changes)` hears of every place on the way, `acts.keep()` of its end, `acts.set(changes)` takes a pair.
function createDrawing(figure, nearest, acts) {
  const plot = figure.querySelector(".plot");
  const state = { points: [], dots: [], grasped: null, late: null, n: 0, fitted: null };

  const pathOf = (points) => `M${points.map(([x, y]) => `${x} ${-y}`).join("L")}Z`;

  function take(content, { n }) {
    // While a point is dragged the points are where the hand has them.
    if (state.grasped !== null) {
      Object.assign(state, { n, late: [content, { n }] });
      state.outline?.setAttribute("d", pathOf(content.outline));
      return;
    }
    Object.assign(state, { n, points: content.points.map((point) => [...point]), ofFile: content.of_file, late: null });
    figure.hidden = false;
    const focused = state.dots.indexOf(document.activeElement);
    const [xs, ys] = [0, 1].map((axis) => content.outline.map((point) => point[axis]));
    const [left, right, low, high] = [Math.min(...xs), Math.max(...xs), Math.min(...ys), Math.max(...ys)];
    const size = Math.max(right - left, high - low);
    const room = ROOM * size;
    const box = [left - room, -high - room, right - left + 2 * room, high - low + 2 * room];
    plot.replaceChildren();
    state.svg = svgElement("svg", { viewBox: box.join(" "), role: "group", "aria-label": "The drawing" }, plot);
    state.outline = svgElement("path", { class: "outline", d: pathOf(content.outline) }, state.svg);
    const [x, y] = content.axis;
    svgElement("path", { class: "axis", d: `M${x - room / 2} ${-y}h${room}M${x} ${-y - room / 2}v${room}` }, state.svg);
    state.dots = state.points.map((point, i) => dotOf(point, i, POINT * size));
    if (focused >= 0) state.dots[focused]?.focus({ preventScroll: true });
    if (state.fitted) show();
  }

  function dotOf([x, y], i, radius) {
    const name = `point ${i + 1}`;
    const dot = svgElement("circle", { r: radius, cx: x, cy: -y, tabindex: 0, role: "slider", "aria-label": name }, state.svg);
    dot.setAttribute("aria-valuenow", x);
    dot.setAttribute("aria-valuetext", `${x} mm, ${y} mm`);
    dot.addEventListener("pointerdown", (event) => {
      event.preventDefault();
      dot.focus();
      dot.setPointerCapture(event.pointerId);
      state.grasped = { from: placeOf(event), points: state.points.map((point) => [...point]) };
    });
    dot.addEventListener("pointermove", (event) => {
      if (!dot.hasPointerCapture(event.pointerId) || state.grasped === null) return;
      const to = placeOf(event);
      move(i, state.grasped.points, to[0] - state.grasped.from[0], to[1] - state.grasped.from[1]);
    });
    for (const end of ["pointerup", "pointercancel"]) dot.addEventListener(end, settle);
    dot.addEventListener("keydown", (event) => {
      const step = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[event.key];
      if (!step) return;
      event.preventDefault();
      move(i, state.points.map((point) => [...point]), radius * step[0], radius * step[1]);
    });
    dot.addEventListener("keyup", (event) => event.key.startsWith("Arrow") && acts.keep());
    return dot;
  }

  function placeOf(event) {
    const at = new DOMPoint(event.clientX, event.clientY).matrixTransform(state.svg.getScreenCTM().inverse());
    return [at.x, -at.y];
  }

  // A point goes by a step, and its neighbours along with it.
  function move(i, before, across, up) {
    const [changes, count] = [{}, before.length];
    for (let k = -ALONG; k <= ALONG; k += 1) {
      const [j, share] = [(i + k + count) % count, Math.cos((Math.PI / 2) * (k / (ALONG + 1))) ** 2];
      [across, up].forEach((step, axis) => {
        state.points[j][axis] = Math.round((before[j][axis] + share * step) * HUNDREDTHS) / HUNDREDTHS;
        changes[`motion.points.${"xy"[axis]}_mm.${j}`] = state.points[j][axis];
      });
      state.dots[j].setAttribute("cx", state.points[j][0]);
      state.dots[j].setAttribute("cy", -state.points[j][1]);
    }
    state.outline.setAttribute("d", pathOf(state.points));
    // The points of a file come into the text with the first one that is dragged.
    const [x_mm, y_mm] = [0, 1].map((axis) => state.points.map((point) => point[axis]));
    acts.change(state.ofFile ? { "motion.points.file": null, "motion.points.x_mm": x_mm, "motion.points.y_mm": y_mm } : changes);
  }

  function settle() {
    if (state.grasped === null) return;
    state.grasped = null;
    acts.keep();
    if (state.late) take(...state.late);
  }

  // The nearest pair that can be made to the drawing of a text.
  function fit(content, { n, from }) {
    state.fitted = { ...content, n, from };
    show();
  }

  function show() {
    for (const one of state.svg?.querySelectorAll(".fitted") ?? []) one.remove();
    if (state.svg && state.fitted) {
      const [[ax, ay], [bx, by]] = state.fitted.greatest;
      svgElement("path", { class: "fitted", d: pathOf(state.fitted.curve) }, state.svg);
      svgElement("path", { class: "fitted", d: `M${ax} ${-ay}L${bx} ${-by}` }, state.svg);
    }
    nearest.replaceChildren();
    if (!state.fitted) return;
    const button = made("button", { type: "button", class: "small" }, "take this pair");
    button.addEventListener("click", () => acts.set(state.fitted.changes));
    nearest.append(`${state.fitted.words}. `, button);
  }

  // The nearest pair goes where the chain that has told it tells it no more.
  function drop(from, n) {
    if (from === "motion" && n > state.n) figure.hidden = true;
    if (state.fitted?.from === from && state.fitted.n < n) {
      state.fitted = null;
      show();
    }
  }

  return { take, fit, drop };
}

// `onDrop(file, page)` hears of each file that is dropped onto the page.
function listenToDrops(onDrop) {
  const holdsFiles = (event) => event.dataTransfer?.types.includes("Files");
  document.addEventListener("dragover", (event) => holdsFiles(event) && event.preventDefault());
  document.addEventListener("drop", (event) => {
    if (!holdsFiles(event)) return;
    event.preventDefault();
    const [file] = event.dataTransfer.files;
    if (file) onDrop(file, pageName());
  });
}
