// The driving angle in degrees, set by hand or carried on by time; `onChange` hears of every new one.

function createClock(cycle, onChange) {
  const state = { deg: 0, pace: 0, playing: false, last: null };

  function set(deg) {
    if (!Number.isFinite(deg)) return;
    // Both ends of the cycle can be chosen; beyond them it begins anew.
    state.deg = deg < 0 || deg > cycle ? wrapped(deg, cycle) : deg;
    onChange(state.deg, state.playing);
  }

  function tick(now) {
    if (!state.playing) return;
    if (state.last !== null) set(wrapped(state.deg + (state.pace * (now - state.last)) / 1000, cycle));
    state.last = now;
    requestAnimationFrame(tick);
  }

  function play() {
    if (state.playing) return;
    state.playing = true;
    state.last = null;
    onChange(state.deg, true);
    requestAnimationFrame(tick);
  }

  function pause() {
    state.playing = false;
    onChange(state.deg, false);
  }

  // Time during which the page is out of sight does not count.
  function rest() {
    state.last = null;
  }

  return {
    set,
    play,
    pause,
    rest,
    toggle: () => (state.playing ? pause() : play()),
    setPace: (degPerSecond) => (state.pace = degPerSecond),
    deg: () => state.deg,
  };
}
