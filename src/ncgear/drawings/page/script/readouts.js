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
