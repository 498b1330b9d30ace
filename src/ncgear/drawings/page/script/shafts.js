// How far the shafts have turned, in degrees, by their names on the page.

const RAD = Math.PI / 180;
const HALVINGS = 50;

function degreesAt(scene, deg) {
  const angles = scene.shaft_angles(deg * RAD).map((angle) => angle / RAD);
  const crank = angles[angles.length - 1];
  // Whatever the lobes, the crank comes round as often as it does on circular gears.
  const turns = scene.driven_angle(scene.loop) / scene.loop;
  return { driving: deg, between: angles[1], driven: crank, uniform: turns * deg };
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
