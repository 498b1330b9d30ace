// The pairs in 3D, each in a frame of its own, unpacked and started when its button is pressed.

function hasWebGL() {
  const canvas = document.createElement("canvas");
  return Boolean(canvas.getContext("webgl2") || canvas.getContext("webgl"));
}

async function unpacked(text) {
  const bytes = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
  return new Response(stream).text();
}

function createSolids() {
  for (const part of document.querySelectorAll(".solid")) {
    const button = part.querySelector("button");
    if (!button) continue;
    button.addEventListener("click", async () => {
      if (!hasWebGL() || !window.DecompressionStream) {
        part.querySelector("output").textContent =
          "This browser shows nothing in 3D: WebGL is missing or off. ncgear build writes pair.glb for other viewers.";
        return;
      }
      button.disabled = true;
      const frame = document.createElement("iframe");
      frame.title = part.dataset.title;
      frame.setAttribute("sandbox", "allow-scripts");
      frame.srcdoc = await unpacked(part.querySelector("script").textContent);
      part.append(frame);
      button.remove();
      part.querySelector("output").textContent = "Dragging turns the gears, the wheel zooms, the right button moves them.";
    });
  }
}

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
  clock.set(firstPose(scene, clock.cycle()));

  // For whoever looks at the page by script: angles in rad.
  window.ncgear = Object.freeze({
    show: (phi1) => clock.set(phi1 / RAD),
    drivingAngle: () => clock.deg() * RAD,
    drivenAngle: scene.driven_angle,
    valuesAt: (phi1) => Object.fromEntries(valuesAt(phi1 / RAD).map((found, n) => [data.charts[n].key, found])),
  });
}

start();
