// How far the shafts have turned, in degrees, by their names on the page.

const RAD = Math.PI / 180;
const HALVINGS = 50;
const FIRST_CRANK_DEG = 60;

function degreesAt(scene, deg) {
  const angles = scene.shaft_angles(deg * RAD).map((angle) => angle / RAD);
  const crank = angles[angles.length - 1];
  // Whatever the lobes, the crank comes round as often as it does on circular gears.
  const turns = scene.driven_angle(scene.loop) / scene.loop;
  const between = angles.slice(1, -1).map((angle, i) => [i ? `between-${i + 1}` : "between", angle]);
  return { driving: deg, ...Object.fromEntries(between), driven: crank, uniform: turns * deg };
}

// The driving angle at which a shaft has turned so far: angles grow together.
function drivingOf(scene, shaft, target) {
  let low = 0;
  let high = scene.loop / RAD;
  for (let step = 0; step < HALVINGS; step += 1) {
    const middle = (low + high) / 2;
    if (degreesAt(scene, middle)[shaft] <= target) low = middle;
    else high = middle;
  }
  return low;
}

// Driving angle in degrees at which the crank first stands well off its dead centre, so that it is seen beside the rod.
function firstPose(scene, cycle) {
  const degrees = Array.from({ length: 90 }, (_, i) => (i * cycle) / 90);
  return degrees.find((deg) => scene.driven_angle(deg * RAD) >= FIRST_CRANK_DEG * RAD) ?? 0;
}

// The driving angle in degrees, set by hand or carried on by time; `onChange` hears of every new one.
// `cycle` are the degrees of a cycle, and gears that swing turn to and fro.

function createClock(onChange) {
  const state = { deg: 0, cycle: 360, swings: false, pace: 0, playing: false, last: null, sense: 1 };

  // A machine with another cycle has its angle within it.
  function fit(cycle, swings) {
    Object.assign(state, { cycle, swings });
    set(state.deg);
  }

  function set(deg) {
    if (!Number.isFinite(deg)) return;
    // Both ends of the cycle can be chosen; beyond them it begins anew.
    state.deg = deg < 0 || deg > state.cycle ? wrapped(deg, state.cycle) : deg;
    onChange(state.deg, state.playing);
  }

  // Gears that turn less than once go back from each end; all others go on.
  function go(step) {
    const cycle = state.cycle;
    if (!state.swings) return set(wrapped(state.deg + step, cycle));
    const along = wrapped((state.sense > 0 ? state.deg : 2 * cycle - state.deg) + step, 2 * cycle);
    state.sense = along < cycle ? 1 : -1;
    set(along < cycle ? along : 2 * cycle - along);
  }

  function tick(now) {
    if (!state.playing) return;
    if (state.last !== null) go((state.pace * (now - state.last)) / 1000);
    state.last = now;
    requestAnimationFrame(tick);
  }

  function play() {
    if (state.playing) return;
    state.playing = true;
    state.last = null;
    onChange(state.deg, true);
    requestAnimationFrame(tick);
  }

  function pause() {
    state.playing = false;
    onChange(state.deg, false);
  }

  // Time during which the page is out of sight does not count.
  function rest() {
    state.last = null;
  }

  return {
    fit,
    set,
    play,
    pause,
    rest,
    toggle: () => (state.playing ? pause() : play()),
    setPace: (degPerSecond) => (state.pace = degPerSecond),
    deg: () => state.deg,
    cycle: () => state.cycle,
  };
}
