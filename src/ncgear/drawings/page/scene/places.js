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

// Where every body is at a driving angle: links from tables over the crank's angle, gears in closed form.

// Links by name, and the pins, each at the origin of a link.
function linkageAt(linkage, phi2) {
  const places = {};
  for (const [name, { x, y, angle }] of Object.entries(linkage.links)) {
    places[name] = { x: angleAt(x, phi2).value, y: angleAt(y, phi2).value, angle: angleAt(angle, phi2).value };
  }
  for (const [pin, link] of Object.entries(linkage.pins)) places[pin] = { ...places[link], angle: 0 };
  return places;
}

function gearAt(gear, shafts) {
  const angle = gear.start + gear.sense * shafts[gear.shaft].value;
  return { x: gear.axis[0], y: gear.axis[1], angle };
}

// x = -s r1 from the driving axis towards the driven one, r1/a = w/(1 - s w), w the ratio of the shafts' speeds.
function pitchPointAt(pair, shafts) {
  const w = shafts[pair.shaft + 1].slope / shafts[pair.shaft].slope;
  const share = (-pair.sense * w) / (1 - pair.sense * w);
  const [[x1, y1], [x2, y2]] = pair.axes;
  return { x: x1 + share * (x2 - x1), y: y1 + share * (y2 - y1), angle: 0 };
}

// Where every body is, by name.
function placesAt(data, phi1) {
  const shafts = shaftsAt(data.shafts, phi1);
  const places = linkageAt(data.linkage, shafts[shafts.length - 1].value);
  for (const gear of data.gears) places[gear.name] = gearAt(gear, shafts);
  data.pairs.forEach((pair, i) => (places[`pitch-point-${i + 1}`] = pitchPointAt(pair, shafts)));
  return places;
}

// How deep the material is before the slider and behind it: on each way the slider leaves one as it has pressed it.
function depthsAt(data, displacement, phi2) {
  const { chamber, linkage } = data;
  const working = wrapped(phi2, 2 * Math.PI) < linkage.working;
  const pressed = working ? Math.max(displacement, chamber.begins) : linkage.stroke;
  const behind = working ? 0 : Math.max(0, Math.min(displacement, chamber.behind));
  return { material: chamber.end - chamber.face - linkage.nearest - pressed, "material-behind": behind };
}
