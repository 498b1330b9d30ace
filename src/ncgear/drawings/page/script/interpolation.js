// Straight lines between the samples of tables over an angle.

function straight(grid, values, deg) {
  const x = wrapped(deg, grid.period_deg);
  const place = placeOf(grid.deg, x);
  const width = grid.deg[place + 1] - grid.deg[place];
  const share = width > 0 ? (x - grid.deg[place]) / width : 0;
  return values[place] + share * (values[place + 1] - values[place]);
}
