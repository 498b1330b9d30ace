// Cursors of the charts, which follow the angle, and the angle at a place on a chart.

// Straight lines between the samples of a table over an angle.
function straight(grid, values, deg) {
  const x = deg === grid.period_deg ? deg : wrapped(deg, grid.period_deg);
  const place = placeOf(grid.deg, x);
  const width = grid.deg[place + 1] - grid.deg[place];
  const share = width > 0 ? (x - grid.deg[place]) / width : 0;
  return values[place] + share * (values[place + 1] - values[place]);
}

function between(x, from, to) {
  return to[0] + ((x - from[0]) / (from[1] - from[0])) * (to[1] - to[0]);
}

function valuesOf(chart, grids, deg) {
  return chart.lines.map((line) => straight(grids[line.grid], line.values, deg));
}

function createChart(figure, chart) {
  const line = figure.querySelector(".cursor line");
  const dots = [...figure.querySelectorAll(".cursor circle")];

  function show(deg, values) {
    const x = between(deg, chart.angle_deg, chart.x);
    line.setAttribute("x1", x);
    line.setAttribute("x2", x);
    for (const dot of dots) {
      dot.setAttribute("cx", x);
      dot.setAttribute("cy", between(values[Number(dot.dataset.line)], chart.values, chart.y));
    }
  }

  return { show };
}

// From the screen to the units of an SVG element, as it stands at the moment.
const intoUnits = (svg) => svg.getScreenCTM().inverse();

// The place of a pointer in these units.
const placeIn = (units, event) => new DOMPoint(event.clientX, event.clientY).matrixTransform(units);

// `onPick` gets the angle, of the axis of the chart that is there at the moment, under the pointer while it is pressed.
function followPointer(plot, chartNow, onPick) {
  function pick(event) {
    const chart = chartNow();
    const deg = between(placeIn(intoUnits(plot.querySelector("svg")), event).x, chart.x, chart.angle_deg);
    onPick(Math.min(Math.max(deg, chart.angle_deg[0]), chart.angle_deg[1]));
  }

  plot.addEventListener("pointerdown", (event) => {
    if (event.button !== 0) return;
    plot.setPointerCapture(event.pointerId);
    pick(event);
  });
  plot.addEventListener("pointermove", (event) => {
    if (plot.hasPointerCapture(event.pointerId)) pick(event);
  });
}
