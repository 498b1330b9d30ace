// Teeth looked up: by the links in the page's words and tables, or by gear and number beside the scene.

function createFinder(scene, clock) {
  const [gear, number, told, numbers] = ["find-gear", "find-tooth", "found", "numbers"].map((id) =>
    document.getElementById(id),
  );
  if (!gear) return;

  function find(name, tooth) {
    clock.pause();
    scene.mark(name, tooth);
    document.querySelector('input[name="view"][value="mesh"]').checked = true;
    clock.set(scene.tooth_angle(name, tooth) / RAD);
    gear.value = name;
    number.max = scene.teeth[name];
    number.value = tooth;
    told.textContent = `tooth ${tooth} of the ${gear.selectedOptions[0].text} gear at \u03c6\u2081 = ${clock.deg().toFixed(2)}\u00b0`;
  }

  // An empty field, or one without such a tooth, takes the mark away.
  function findTyped() {
    number.max = scene.teeth[gear.value];
    if (number.value && number.checkValidity()) return find(gear.value, number.valueAsNumber);
    scene.unmark();
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
  numbers.addEventListener("change", () => scene.numbers(numbers.checked));
}
