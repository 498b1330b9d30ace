// Angles of the shafts by Hermite's cubics, from tables over an angle that rises and repeats after a period.

function wrapped(x, period) {
  return x - period * Math.floor(x / period);
}

// The last index, short of the end's, at which the rising numbers do not exceed x.
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

// Value and slope of a table of angles at x; each period begins where the one before it ended.
function angleAt(table, x) {
  const turns = Math.floor(x / table.period);
  const local = x - turns * table.period;
  const i = placeOf(table.at, local);
  const width = table.at[i + 1] - table.at[i];
  const t = width > 0 ? (local - table.at[i]) / width : 0;
  const rise = table.value[i + 1] - table.value[i];
  const [start, end] = [table.slope[i] * width, table.slope[i + 1] * width];
  const [square, cubic] = [3 * rise - 2 * start - end, start + end - 2 * rise];
  return {
    value: turns * table.rise + table.value[i] + t * (start + t * (square + t * cubic)),
    slope: width > 0 ? (start + t * (2 * square + 3 * t * cubic)) / width : table.slope[i],
  };
}

// Angles of all shafts and their slopes by phi1: all tables but the last are those of the shafts between.
function shaftsAt(tables, phi1) {
  const shafts = [{ value: phi1, slope: 1 }];
  for (const table of tables.slice(0, -1)) {
    const before = shafts[shafts.length - 1];
    const own = angleAt(table, before.value);
    shafts.push({ value: own.value, slope: own.slope * before.slope });
  }
  shafts.push(angleAt(tables[tables.length - 1], phi1));
  return shafts;
}
