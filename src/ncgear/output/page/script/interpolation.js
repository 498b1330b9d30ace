// Tables over an angle, all of one period: place, straight lines between samples, and the law with its slope.

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

// Cubic Hermite piece between two samples: values and slopes are met at both.
function drivenOf(law, deg) {
  const turns = Math.floor(deg / law.period_deg);
  const x = deg - turns * law.period_deg;
  const place = placeOf(law.deg, x);
  const width = law.deg[place + 1] - law.deg[place];
  const t = width > 0 ? (x - law.deg[place]) / width : 0;
  const start = law.driven_deg[place];
  const rise = law.driven_deg[place + 1] - start;
  const bend = (1 - t) * (width * law.slope[place] - rise) - t * (width * law.slope[place + 1] - rise);
  return turns * law.driven_period_deg + start + t * rise + t * (1 - t) * bend;
}

// The driving angle of a driven one: between two samples, by halving.
function drivingOf(law, driven) {
  const turns = Math.floor(driven / law.driven_period_deg);
  const left = driven - turns * law.driven_period_deg;
  const place = placeOf(law.driven_deg, left);
  let low = law.deg[place];
  let high = law.deg[place + 1];
  for (let step = 0; step < 40; step += 1) {
    const middle = (low + high) / 2;
    if (drivenOf(law, middle) <= left) low = middle;
    else high = middle;
  }
  return turns * law.period_deg + low;
}
