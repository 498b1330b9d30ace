// The charts: drawn as in the report, with lines that follow at once, lines that were kept, and handles.

function createBoard(place, handles, onPick) {
  const charts = new Map();
  const state = { handles: [], held: null, degrees: null, drawn: {} };

  // A new chart stands after the one that its chain has drawn of the same text before; the motion's come first.
  function created(key, { from, n }) {
    const figure = document.createElement("figure");
    figure.className = "chart";
    figure.dataset.key = key;
    figure.innerHTML =
      '<figcaption><span class="name"></span><span class="extremes"></span><span class="key"></span></figcaption><div class="plot"></div>';
    const last = state.drawn[from];
    if (last?.n === n) last.figure.after(figure);
    else if (from === "motion") place.prepend(figure);
    else place.append(figure);
    const one = { figure, plot: figure.querySelector(".plot"), chart: null, live: null, cursor: null };
    followPointer(one.plot, () => one.chart, (deg) => onPick(one.chart, deg));
    charts.set(key, one);
    return one;
  }

  // A chart as the server has drawn it for the text of a number.
  function draw(content, { from, n }) {
    const one = charts.get(content.key) ?? created(content.key, { from, n });
    Object.assign(one, { late: null, from, n });
    state.drawn[from] = one;
    if (handles.dragging()) {
      one.late = content;
      return;
    }
    Object.assign(one, { chart: content, live: null, seen: n });
    const focused = one.plot.contains(document.activeElement) ? document.activeElement.dataset.handle : null;
    one.plot.innerHTML = content.svg;
    one.figure.classList.remove("pale");
    one.figure.querySelector(".name").textContent = content.name;
    one.figure.querySelector(".extremes").textContent = content.extremes;
    one.figure.querySelector(".key").replaceChildren(...content.labels.map((line, i) => keyOf(content, line, i)));
    one.cursor = createChart(one.figure, content);
    one.cells = [...one.figure.querySelectorAll("[data-value]")];
    overlay(one);
    if (focused) handles.focus(one.plot, focused);
    point(one);
  }

  function keyOf(content, line, number) {
    const made = document.createElement("span");
    made.className = `line ${line.role}`;
    made.innerHTML = '<i aria-hidden="true"></i><span></span> <b data-value></b>';
    made.querySelector("span").textContent = line.label;
    made.querySelector("b").dataset.value = number;
    return made;
  }

  function overlay(one) {
    const svg = one.plot.querySelector("svg");
    if (!svg) return;
    drawLines(svg, one.chart, one.live?.lines, "live");
    drawLines(svg, one.chart, state.held?.get(one.chart.key), "held");
    handles.put(svg, one.chart, state.handles);
  }

  // Lines that follow a motion of the text of a number before its charts are drawn.
  function follow(motion, n) {
    state.handles = motion.handles;
    lines(motion.charts, n);
  }

  function lines(followed, n) {
    for (const live of followed) {
      for (const line of live.lines) line.x = live.x;
      const one = charts.get(live.key);
      if (!one?.chart || one.seen >= n) continue;
      one.live = live;
      one.figure.classList.add("pale");
      overlay(one);
    }
  }

  // What was drawn while something was dragged is shown at its end.
  function settle() {
    for (const one of [...charts.values()]) if (one.late) draw(one.late, one);
  }

  function valuesAt(one) {
    return valuesOf(one.chart, one.chart.grids, state.degrees[one.chart.angle]);
  }

  function point(one) {
    if (!one.chart) return;
    one.figure.classList.toggle("unplaced", !state.degrees);
    if (!state.degrees) return;
    const values = valuesAt(one);
    one.cursor.show(state.degrees[one.chart.angle], values);
    for (const cell of one.cells) cell.textContent = shown(values[Number(cell.dataset.value)], one.chart.decimals);
  }

  function show(degrees) {
    state.degrees = degrees;
    for (const one of charts.values()) point(one);
  }

  // Keeps the lines of the design as it is now, or lets go of them.
  function hold(followed) {
    const own = (live) => live.lines.filter((line) => line.role === "own");
    state.held = followed && new Map(followed.map((live) => [live.key, own(live)]));
    for (const one of charts.values()) if (one.chart) overlay(one);
  }

  // The charts of a chain that it has not drawn of the text of a number go.
  function drop(from, n) {
    for (const [key, one] of charts) {
      if (one.from !== from || one.n >= n) continue;
      one.figure.remove();
      charts.delete(key);
    }
  }

  function showStale(stale) {
    for (const one of charts.values()) one.figure.classList.toggle("stale", stale(one.from, one.n));
  }

  const chart = (key) => charts.get(key)?.chart;
  return { draw, drop, follow, lines, settle, show, hold, showStale, chart };
}
