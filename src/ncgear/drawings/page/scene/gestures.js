// What pointers, wheel and keys over the scene do; `act` zooms, drags and resets.

// Per pixel that the wheel goes, and per press of a key.
const WHEEL = 1.0015;
const KEY_ZOOM = 1.25;

// Pointers that are down, and what moving one of them means: one drags, two zoom and drag.
function listenToPointers(svg, act) {
  const down = new Map();
  svg.addEventListener("pointerdown", (event) => {
    down.set(event.pointerId, event);
    svg.setPointerCapture(event.pointerId);
  });
  for (const name of ["pointerup", "pointercancel"]) {
    svg.addEventListener(name, (event) => down.delete(event.pointerId));
  }
  svg.addEventListener("pointermove", (event) => {
    const before = down.get(event.pointerId);
    if (!before) return;
    const other = [...down.values()].find((one) => one.pointerId !== event.pointerId);
    if (other) pinch(act, before, event, other);
    act.drag((event.clientX - before.clientX) / down.size, (event.clientY - before.clientY) / down.size);
    down.set(event.pointerId, event);
  });
}

function pinch(act, before, now, other) {
  const factor = spread(now, other) / spread(before, other);
  act.zoomAt(factor, (now.clientX + other.clientX) / 2, (now.clientY + other.clientY) / 2);
}

function spread(one, other) {
  return Math.max(1, Math.hypot(one.clientX - other.clientX, one.clientY - other.clientY));
}

function listenToWheel(svg, act) {
  const onWheel = (event) => {
    if (!event.ctrlKey && document.activeElement !== svg) return;
    event.preventDefault();
    act.zoomAt(WHEEL ** -event.deltaY, event.clientX, event.clientY);
  };
  svg.addEventListener("wheel", onWheel, { passive: false });
  svg.addEventListener("dblclick", act.reset);
}

function listenToKeys(svg, act) {
  const keys = { "+": () => act.zoom(KEY_ZOOM), "-": () => act.zoom(1 / KEY_ZOOM), 0: act.reset };
  svg.addEventListener("keydown", (event) => {
    if (keys[event.key]) keys[event.key]();
  });
}
