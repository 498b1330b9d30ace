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
