// Numbers as text, in the cells that wait for them.

const ANGLE_DECIMALS = 2;

function shown(value, decimals) {
  const text = value.toFixed(decimals);
  // A rounded zero has no sign, and a minus is as wide as a digit.
  return /^-[0.]*$/.test(text) ? text.slice(1) : text.replace("-", "\u2212");
}

function createReadouts(charts) {
  const cells = charts.flatMap((chart, number) =>
    [...document.querySelectorAll(`[data-now="${chart.key}"]`)].map((cell) => ({
      cell,
      number,
      line: Number(cell.dataset.line),
      decimals: chart.decimals,
    })),
  );
  const angles = [...document.querySelectorAll("[data-angle]")];

  return {
    show(values, degrees) {
      for (const { cell, number, line, decimals } of cells) cell.textContent = shown(values[number][line], decimals);
      for (const cell of angles) cell.textContent = shown(degrees[cell.dataset.angle], ANGLE_DECIMALS);
    },
  };
}

// Buttons, sliders and keys that run the clock, and what they show of it.

const STEP_DEG = 1;
const LEAP_DEG = 10;

function createControls(clock) {
  const [button, scrub, angle, pace] = ["play", "scrub", "angle", "pace"].map((id) => document.getElementById(id));

  button.addEventListener("click", clock.toggle);
  scrub.addEventListener("input", () => clock.set(scrub.valueAsNumber));
  angle.addEventListener("input", () => clock.set(angle.valueAsNumber));
  // The field keeps what is being typed; once it is left, 725 of 720 degrees, or nothing, becomes the angle shown.
  angle.addEventListener("change", () => (angle.value = clock.deg().toFixed(2)));
  pace.addEventListener("change", () => clock.setPace(Number(pace.value)));
  clock.setPace(Number(pace.value));
  document.addEventListener("keydown", (event) => onKey(event, clock));
  document.addEventListener("visibilitychange", clock.rest);

  return {
    show(deg, playing) {
      scrub.max = clock.cycle();
      scrub.value = deg;
      scrub.setAttribute("aria-valuetext", `${deg.toFixed(1)} degrees`);
      if (document.activeElement !== angle || playing) angle.value = deg.toFixed(2);
      button.toggleAttribute("data-playing", playing);
      button.querySelector(".word").textContent = playing ? "Pause" : "Play";
    },
  };
}

function keyActions(clock, step) {
  return {
    " ": clock.toggle,
    ArrowRight: () => clock.set(clock.deg() + step),
    ArrowUp: () => clock.set(clock.deg() + step),
    ArrowLeft: () => clock.set(clock.deg() - step),
    ArrowDown: () => clock.set(clock.deg() - step),
    Home: () => clock.set(0),
    End: () => clock.set(clock.cycle()),
  };
}

// Whether the element with the focus has a use of its own for a key.
function isTaken(key, target) {
  if (target.id === "scrub") return false;
  if (target.closest("select, input")) return true;
  if (key === " ") return target.closest("button, a, summary") !== null;
  return key === "ArrowUp" || key === "ArrowDown" || target.closest("pre, .scroll") !== null;
}

function onKey(event, clock) {
  if (event.altKey || event.ctrlKey || event.metaKey || isTaken(event.key, event.target)) return;
  const action = keyActions(clock, event.shiftKey ? LEAP_DEG : STEP_DEG)[event.key];
  if (!action) return;
  event.preventDefault();
  action();
}
