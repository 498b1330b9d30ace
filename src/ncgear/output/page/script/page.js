// The page put together: one angle, and everything that shows it.

const RAD = Math.PI / 180;

function degreesAt(data, deg) {
  const between = data.between ? drivenOf(data.between, deg) : 0;
  const uniform = (deg / data.law.period_deg) * data.law.driven_period_deg;
  return { driving: deg, between, driven: drivenOf(data.law, deg), uniform };
}

function start() {
  const data = JSON.parse(document.getElementById("data").textContent);
  const figures = data.charts.map((chart) => document.querySelector(`figure[data-key="${chart.key}"]`));
  const charts = data.charts.map((chart, number) => createChart(figures[number], chart));
  const readouts = createReadouts(data.charts);
  const clock = createClock(data.cycle_deg, show);
  const controls = createControls(clock, data.cycle_deg);

  function valuesAt(deg) {
    const degrees = degreesAt(data, deg);
    return data.charts.map((chart) => valuesOf(chart, data.grids, degrees[chart.angle]));
  }

  function show(deg, playing) {
    const degrees = degreesAt(data, deg);
    const values = valuesAt(deg);
    controls.show(deg, playing);
    readouts.show(values, degrees);
    charts.forEach((chart, number) => chart.show(degrees[data.charts[number].angle], values[number]));
  }

  function drivingAngleOf(chart, deg) {
    return chart.angle === "between" ? drivingOf(data.between, deg) : deg;
  }

  data.charts.forEach((chart, number) =>
    followPointer(figures[number].querySelector(".plot"), chart, (deg) => clock.set(drivingAngleOf(chart, deg))),
  );
  clock.set(0);

  // For whoever looks at the page by script: angles in rad.
  window.ncgear = Object.freeze({
    show: (phi1) => clock.set(phi1 / RAD),
    drivingAngle: () => clock.deg() * RAD,
    drivenAngle: (phi1) => drivenOf(data.law, phi1 / RAD) * RAD,
    valuesAt: (phi1) => Object.fromEntries(valuesAt(phi1 / RAD).map((found, n) => [data.charts[n].key, found])),
  });
}

start();
