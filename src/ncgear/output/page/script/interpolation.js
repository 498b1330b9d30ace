// Tables over an angle, all of one period: straight lines between samples.

function wrapped(x, period) {
  return x - period * Math.floor(x / period);
}

// The last place, but for the end's, at which rising numbers are not over x.
function placeOf(rising, x) {
  let low = 0;
  let high = rising.length - 1;
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (rising[middle] <= x) low = middle;
    else high = middle;
  }
  return low;
}

function straight(grid, values, deg) {
  const x = wrapped(deg, grid.period_deg);
  const place = placeOf(grid.deg, x);
  const width = grid.deg[place + 1] - grid.deg[place];
  const share = width > 0 ? (x - grid.deg[place]) / width : 0;
  return values[place] + share * (values[place + 1] - values[place]);
}
