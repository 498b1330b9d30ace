// Saving: what stands in its way is shown with the difference, and a person decides.

function createSaving(place, send) {
  const [problem, difference, over, anew, later] = ["p", "pre", ".save-over", ".anew", ".later"].map((one) => place.querySelector(one));

  function ask(content) {
    problem.textContent = `${content.problem}. Saved, this text would change there:`;
    difference.textContent = content.difference || "Nothing but the file itself.";
    place.hidden = false;
    later.focus();
  }

  function leave() {
    place.hidden = true;
  }

  over.addEventListener("click", () => send({ do: "save", over: true }));
  anew.addEventListener("click", () => send({ do: "anew" }));
  later.addEventListener("click", leave);
  return { ask, leave, save: () => send({ do: "save" }) };
}
