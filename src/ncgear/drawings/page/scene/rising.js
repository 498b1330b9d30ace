// Places in tables over an angle that rises, and repeats after a period.

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
