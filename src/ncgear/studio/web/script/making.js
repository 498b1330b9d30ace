// Commands that write files: asked for, watched, cancelled; what they have found is taken over from here.

// The box of the picture of a frontier, and its margins.
const BOX = { width: 360, height: 220, left: 48, right: 12, top: 14, bottom: 34 };

function createMaking(place, send) {
  const items = new Map();
  const state = { zipWanted: false, running: new Map() };
  const zip = document.getElementById("zip");
  const commandOf = (button) => button.dataset.run ?? "build";
  const buttons = [...document.querySelectorAll("[data-run]"), zip];

  for (const button of buttons) {
    button.addEventListener("click", () => {
      // All files that a build makes are fetched as one zip once they are there.
      if (commandOf(button) === "build") state.zipWanted = button === zip;
      rest([commandOf(button)]);
      send({ do: "run", command: commandOf(button) });
    });
  }

  // Buttons rest while a command runs that writes where theirs would.
  function rest(asked = []) {
    const names = new Set([...asked, ...[...state.running.values()].flat()]);
    for (const button of buttons) button.disabled = names.has(commandOf(button));
  }

  function fetchZip(job) {
    state.zipWanted = false;
    const [folder] = job.files[0].split("/");
    made("a", { href: `zip/${encodeURIComponent(folder)}`, download: `${folder}.zip` }).click();
  }

  // All jobs of the page, as after something that was asked for has been refused.
  function showAll(jobs) {
    rest();
    jobs.forEach(show);
  }

  function show(job) {
    if (job.running) state.running.set(job.job, job.alike);
    else state.running.delete(job.job);
    rest();
    if (state.zipWanted && job.name === "build" && job.files?.length) fetchZip(job);
    else if (state.zipWanted && job.name === "build" && !job.running) state.zipWanted = false;
    const item = items.get(job.job) ?? made("li", {});
    const wasOpen = item.querySelector("details")?.open ?? false;
    item.replaceChildren(...parts(job));
    if (item.querySelector("details")) item.querySelector("details").open = wasOpen;
    if (!items.has(job.job)) {
      place.prepend(item);
      if (job.running) item.scrollIntoView({ block: "nearest" });
    }
    items.set(job.job, item);
  }

  function parts(job) {
    const state = job.running ? "runs" : job.cancelled ? "cancelled" : job.done ? "done" : "failed";
    const title = made("p", {}, made("strong", {}, job.words), ` ${state} `);
    if (job.running) title.append(button("cancel", () => send({ do: "cancel", job: job.job }), `cancel ${job.words}`));
    const found = [title];
    if (job.running) found.push(made("p", { class: "progress" }, job.progress || "starting"));
    if (job.done && job.name === "optimize") {
      found.push(made("p", {}, job.lines.find((line) => line.includes("limit")) ?? ""));
      title.append(button("take over", () => send({ do: "adopt", job: job.job }), "take over the best law"));
    }
    if (job.frontier) found.push(frontierElement(job.frontier));
    if (job.lines.length) {
      found.push(made("details", { open: !job.running && !job.done && !job.cancelled }, made("summary", {}, "what it says"), made("pre", { tabindex: 0 }, job.lines.join("\n"))));
    }
    if (job.files) found.push(filesElement(job.files));
    return found;
  }

  function button(words, act, name) {
    const one = made("button", { type: "button", class: "small" }, words);
    one.setAttribute("aria-label", name);
    one.addEventListener("click", act);
    return one;
  }

  function filesElement(files) {
    const links = files.map((file) => {
      const way = file.split("/").map(encodeURIComponent).join("/");
      return made("li", {}, made("a", { href: `export/${way}`, target: "_blank", rel: "noopener" }, file));
    });
    return made("details", {}, made("summary", {}, `${files.length} files`), made("ul", { class: "files" }, ...links));
  }

  // Power against acceleration; a point that is clicked becomes the design.
  function frontierElement(frontier) {
    const key = Object.keys(frontier.points[0].law).find((name) => name.startsWith("peak_acceleration"));
    const limitKey = Object.keys(frontier.points[0]).find((name) => name.startsWith("limit_acceleration"));
    const points = frontier.points.map((one) => ({ cap: one.power_cap_w, x: one.law.peak_power_w, y: one.law[key], limit: one[limitKey] }));
    const scales = { x: range(points.flatMap((one) => [one.x, one.cap])), y: range(points.flatMap((one) => [one.y, one.limit])) };
    const across = (x) => between(x, scales.x, [BOX.left, BOX.width - BOX.right]);
    const up = (y) => between(y, scales.y, [BOX.height - BOX.bottom, BOX.top]);
    const svg = document.createElementNS(SVG, "svg");
    svg.setAttribute("viewBox", `0 0 ${BOX.width} ${BOX.height}`);
    svg.setAttribute("class", "frontier");
    svg.setAttribute("role", "group");
    svg.setAttribute("aria-label", "peak power against peak acceleration; each point is a law");
    svgElement("path", { class: "axis", d: `M${BOX.left} ${BOX.top}V${BOX.height - BOX.bottom}H${BOX.width - BOX.right}` }, svg);
    svgElement("path", { class: "limit", d: `M${points.map((one) => `${across(one.cap)} ${up(one.limit)}`).join("L")}` }, svg);
    svgElement("text", { x: BOX.width / 2, y: BOX.height - 4, "text-anchor": "middle" }, svg).textContent = "peak power in W";
    svgElement("text", { x: 4, y: 10 }, svg).textContent = key.replace("peak_acceleration_cycle_", "peak acceleration in ").replace("peak_acceleration_", "peak acceleration in ").replaceAll("_", "/");
    for (const end of [0, 1]) {
      svgElement("text", { x: across(scales.x[end]), y: BOX.height - 18, "text-anchor": "middle" }, svg).textContent = digits(scales.x[end]);
      svgElement("text", { x: BOX.left - 4, y: up(scales.y[end]) + 4, "text-anchor": "end" }, svg).textContent = digits(scales.y[end]);
    }
    for (const one of points) {
      const dot = svgElement("circle", { cx: across(one.x), cy: up(one.y), r: 6, tabindex: 0, role: "button" }, svg);
      dot.setAttribute("aria-label", `take the law of ${digits(one.x)} W and ${digits(one.y)}`);
      svgElement("title", {}, dot).textContent = `${digits(one.x)} W: look for this law`;
      const take = () => send({ do: "point", power_w: one.cap });
      dot.addEventListener("click", take);
      dot.addEventListener("keydown", (event) => (event.key === "Enter" || event.key === " ") && (event.preventDefault(), take()));
    }
    return svg;
  }

  function range(values) {
    const [low, high] = [Math.min(...values), Math.max(...values)];
    return [Number(low.toPrecision(2)) > low ? low : Number(low.toPrecision(2)), high > low ? high : low + 1];
  }

  return { show, showAll };
}
