// Lines on the scales of a drawn chart: those that follow while something is dragged, and those that were kept.

const SVG = "http://www.w3.org/2000/svg";

function svgElement(name, attributes, parent) {
  const made = document.createElementNS(SVG, name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  parent.append(made);
  return made;
}

function linePath(line, chart) {
  const points = line.x.map((x, i) => {
    const [across, up] = [between(x, chart.angle_deg, chart.x), between(line.y[i], chart.values, chart.y)];
    return `${across.toFixed(1)} ${up.toFixed(1)}`;
  });
  return `M${points.join("L")}`;
}

// Draws lines into a group of their own, which takes the place of the one before.
function drawLines(svg, chart, lines, name) {
  svg.querySelector(`g.${name}`)?.remove();
  if (!lines) return;
  const group = svgElement("g", { class: name, "clip-path": "none" }, svg);
  for (const line of lines) {
    svgElement("path", { class: `over ${line.role}`, d: linePath(line, chart) }, group);
  }
}
