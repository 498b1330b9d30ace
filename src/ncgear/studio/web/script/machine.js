// The machine running, and beside it the one that was kept; what is not computed anew yet is pale.

function createMachine(stage, heldStage) {
  const state = { scene: null, data: null, svg: "", n: 0, held: null, late: false, refused: false };
  const legend = stage.querySelector(".legend");

  function put(place, svg, data) {
    place.querySelector("svg.scene")?.remove();
    place.insertAdjacentHTML("beforeend", svg);
    return createScene(place.querySelector("svg.scene"), data);
  }

  // A whole machine of the text of a number, teeth and all.
  function take(content, n) {
    const looked = state.scene?.looking();
    stage.querySelector(".waiting")?.remove();
    Object.assign(state, { n, svg: content.svg, data: content.data, scene: put(stage, content.svg, content.data) });
    if (looked) state.scene.lookAs(looked);
    pale({ late: false });
  }

  // Another law: the shafts follow it at once, the teeth are those of the law before until theirs come.
  function follow(motion, n) {
    if (n <= state.n || !state.scene || state.data.shafts.length !== motion.shafts.length) return;
    state.scene.follow(motion.shafts);
    pale({ late: true });
  }

  function hold() {
    if (!state.scene) return false;
    const data = structuredClone(state.data);
    state.held = put(heldStage, state.svg, data);
    heldStage.hidden = false;
    return true;
  }

  function release() {
    heldStage.querySelector("svg.scene")?.remove();
    heldStage.hidden = true;
    state.held = null;
  }

  function show(phi1) {
    state.scene?.show(phi1);
    state.held?.show(phi1);
  }

  // Pale is what is not computed anew yet, and what is refused.
  function pale(why) {
    Object.assign(state, why);
    stage.classList.toggle("pale", state.late || state.refused);
  }

  // Tells whether the machine is of an earlier text than the newest that is refused, of number `refused`.
  function showStale(refused) {
    const [any, before] = [refused >= 0, state.scene !== null && state.n < refused];
    if (any) stage.querySelector(".waiting")?.remove();
    pale({ refused: any });
    legend.hidden = !(state.held || before);
    return before;
  }

  return { take, follow, hold, release, show, scene: () => state.scene, showStale };
}
