// The pairs in 3D, each in a frame of its own, unpacked and started when its button is pressed.

function hasWebGL() {
  const canvas = document.createElement("canvas");
  return Boolean(canvas.getContext("webgl2") || canvas.getContext("webgl"));
}

async function unpacked(text) {
  const bytes = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
  return new Response(stream).text();
}

function createSolids() {
  for (const part of document.querySelectorAll(".solid")) {
    const button = part.querySelector("button");
    if (!button) continue;
    button.addEventListener("click", async () => {
      if (!hasWebGL() || !window.DecompressionStream) {
        part.querySelector("output").textContent =
          "This browser shows nothing in 3D: WebGL is missing or off. ncgear build writes pair.glb for other viewers.";
        return;
      }
      button.disabled = true;
      const frame = document.createElement("iframe");
      frame.title = part.dataset.title;
      frame.setAttribute("sandbox", "allow-scripts");
      frame.srcdoc = await unpacked(part.querySelector("script").textContent);
      part.append(frame);
      button.remove();
      part.querySelector("output").textContent = "Dragging turns the gears, the wheel zooms, the right button moves them.";
    });
  }
}
