// Where every body is at a driving angle: closed forms of the shafts' angles.

// The vector loop: crank pin and slider pin from the crank's angle.
function linkageAt(linkage, phi2) {
  const crank = linkage.start - phi2;
  const pin = { x: linkage.crank * Math.cos(crank), y: linkage.crank * Math.sin(crank) };
  const rise = linkage.offset - pin.y;
  const along = Math.sqrt(linkage.rod ** 2 - rise ** 2);
  return {
    crank: { x: 0, y: 0, angle: crank },
    rod: { x: pin.x, y: pin.y, angle: Math.atan2(rise, along) },
    slider: { x: pin.x + along, y: linkage.offset, angle: 0 },
    "crank-pin": { x: pin.x, y: pin.y, angle: 0 },
    "slider-pin": { x: pin.x + along, y: linkage.offset, angle: 0 },
  };
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

// How deep the material is: on its way back the slider leaves it behind as it has pressed it.
function depthAt(data, displacement, phi2) {
  const { chamber, linkage } = data;
  const turned = wrapped(phi2, 2 * Math.PI);
  const pressed = turned < linkage.working ? Math.max(displacement, chamber.begins) : linkage.stroke;
  return chamber.end - chamber.face - linkage.nearest - pressed;
}
