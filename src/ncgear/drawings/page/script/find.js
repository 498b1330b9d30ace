// The buttons that choose what the picture shows; `sceneNow` gives the scene that is shown at the moment.

function listenToViews(sceneNow) {
  for (const choice of document.querySelectorAll('input[name="view"]')) {
    choice.addEventListener("change", () => sceneNow().view(choice.value));
  }
  const zooms = {
    nearer: () => sceneNow().zoom(1.5),
    farther: () => sceneNow().zoom(1 / 1.5),
    whole: () => sceneNow().reset(),
  };
  for (const [id, zoom] of Object.entries(zooms)) document.getElementById(id).addEventListener("click", zoom);
}

// Teeth looked up: by the links in the page's words and tables, or by gear and number beside the scene that `sceneNow`
// gives; `fit` takes the gears and the views of another scene, in which no tooth is marked, and hides what it has not.

function createFinder(sceneNow, clock) {
  const [gear, number, told, numbers] = ["find-gear", "find-tooth", "found", "numbers"].map((id) =>
    document.getElementById(id),
  );
  if (!gear) return { fit() {} };

  function find(name, tooth) {
    clock.pause();
    sceneNow().mark(name, tooth);
    document.querySelector('input[name="view"][value="mesh"]').checked = true;
    clock.set(sceneNow().tooth_angle(name, tooth) / RAD);
    gear.value = name;
    number.max = sceneNow().teeth[name];
    number.value = tooth;
    told.textContent = `tooth ${tooth} of the ${gear.selectedOptions[0].text} gear at \u03c6\u2081 = ${clock.deg().toFixed(2)}\u00b0`;
  }

  // An empty field, or one without such a tooth, takes the mark away.
  function findTyped() {
    number.max = sceneNow().teeth[gear.value];
    if (number.value && number.checkValidity()) return find(gear.value, number.valueAsNumber);
    sceneNow().unmark();
    told.textContent = number.value ? `the ${gear.selectedOptions[0].text} gear has teeth 1 to ${number.max}` : "";
  }

  for (const link of document.querySelectorAll("a.tooth")) {
    link.addEventListener("click", (event) => {
      event.preventDefault();
      find(link.dataset.gear, Number(link.dataset.tooth));
      document.getElementById("machine").scrollIntoView({ block: "start" });
    });
  }
  gear.addEventListener("change", findTyped);
  number.addEventListener("change", findTyped);
  numbers.addEventListener("change", () => sceneNow().numbers(numbers.checked));

  function fit() {
    const names = Object.keys(sceneNow().teeth);
    const chosen = gear.value;
    gear.replaceChildren(...names.map((name) => new Option(name.replace("-", " of stage "), name)));
    if (names.includes(chosen)) gear.value = chosen;
    sceneNow().numbers(numbers.checked);
    told.textContent = "";
    if (number !== document.activeElement) number.value = "";
    gear.closest(".find").hidden = !names.length;
    for (const choice of document.querySelectorAll('input[name="view"]')) {
      choice.parentNode.hidden = !sceneNow().views.includes(choice.value);
      choice.checked = choice.value === sceneNow().looking().view;
    }
  }

  return { fit };
}
