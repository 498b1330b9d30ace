// The page put together: one angle, and everything that shows it.

function start() {
  const data = JSON.parse(document.getElementById("data").textContent);
  const scene = createScene(document.querySelector("svg.scene"), data.scene);
  const figures = data.charts.map((chart) => document.querySelector(`figure[data-key="${chart.key}"]`));
  const charts = data.charts.map((chart, number) => createChart(figures[number], chart));
  const readouts = createReadouts(data.charts);
  const clock = createClock(show);
  const controls = createControls(clock);

  function valuesAt(deg) {
    const degrees = degreesAt(scene, deg);
    return data.charts.map((chart) => valuesOf(chart, data.grids, degrees[chart.angle]));
  }

  function show(deg, playing) {
    const degrees = degreesAt(scene, deg);
    const values = valuesAt(deg);
    scene.show(deg * RAD);
    controls.show(deg, playing);
    readouts.show(values, degrees);
    charts.forEach((chart, number) => chart.show(degrees[data.charts[number].angle], values[number]));
  }

  data.charts.forEach((chart, number) =>
    followPointer(figures[number].querySelector(".plot"), () => chart, (deg) =>
      clock.set(chart.angle === "driving" ? deg : drivingOf(scene, chart.angle, deg)),
    ),
  );
  listenToViews(() => scene);
  createFinder(() => scene, clock);
  createSolids();
  clock.fit(data.cycle_deg, data.swings);

  // For whoever looks at the page by script: angles in rad.
  window.ncgear = Object.freeze({
    show: (phi1) => clock.set(phi1 / RAD),
    drivingAngle: () => clock.deg() * RAD,
    drivenAngle: scene.driven_angle,
    valuesAt: (phi1) => Object.fromEntries(valuesAt(phi1 / RAD).map((found, n) => [data.charts[n].key, found])),
  });
}

start();
