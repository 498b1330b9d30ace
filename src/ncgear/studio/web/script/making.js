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
    if (job.machines) found.push(...machineElements(job));
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
    const points = frontier.points.map((one) => {
      const [x, y] = [one.law.peak_power_w, one.law[key]];
      const words = [`${digits(x)} W: look for this law`, `take the law of ${digits(x)} W and ${digits(y)}`];
      return { x, y, words, take: () => send({ do: "point", power_w: one.power_cap_w }) };
    });
    const limit = frontier.points.map((one) => ({ x: one.power_cap_w, y: one[limitKey] }));
    const upwards = key.replace(/peak_acceleration_(cycle_)?/, "peak acceleration in ").replaceAll("_", "/");
    return scatter(points, limit, ["peak power in W", upwards], "peak power against peak acceleration; each point is a law");
  }

  // Whole machines side by side, by power and size of the gears; a machine that is clicked becomes the design, and runs.
  function machineElements(job) {
    const shown = (one) => `${digits(one.peak_power_w)} W, ${one.teeth} teeth of ${one.module_mm} mm, ${one.face_width_mm} mm wide`;
    const points = job.machines.machines.map((one) => ({
      x: one.peak_power_w,
      y: one.gear_volume_mm3 / 1e6,
      words: [`${one.name}: ${shown(one)}`, `show ${one.name}: ${shown(one)}`],
      take: () => send({ do: "adopt", job: job.job, design: one.name }),
      one,
    }));
    const rows = points.map(({ one, words, take }) => {
      const beside = one.name === job.machines.recommended ? "recommended" : one.beside_recommended;
      return made("li", {}, button(one.name, take, words[1]), ` ${shown(one)}; ${beside}`);
    });
    const picture = scatter(points, [], ["peak power in W", "gears in dm3"], "peak power against size of the gears; each point is a machine");
    return [picture, made("ul", { class: "machines" }, ...rows)];
  }

  // Points that can be taken, over a dashed line of a limit.
  function scatter(points, limit, [along, upwards], name) {
    const all = [...points, ...limit];
    const scales = { x: range(all.map((one) => one.x)), y: range(all.map((one) => one.y)) };
    const across = (x) => between(x, scales.x, [BOX.left, BOX.width - BOX.right]);
    const up = (y) => between(y, scales.y, [BOX.height - BOX.bottom, BOX.top]);
    const svg = document.createElementNS(SVG, "svg");
    svg.setAttribute("viewBox", `0 0 ${BOX.width} ${BOX.height}`);
    svg.setAttribute("class", "frontier");
    svg.setAttribute("role", "group");
    svg.setAttribute("aria-label", name);
    svgElement("path", { class: "axis", d: `M${BOX.left} ${BOX.top}V${BOX.height - BOX.bottom}H${BOX.width - BOX.right}` }, svg);
    if (limit.length) svgElement("path", { class: "limit", d: `M${limit.map((one) => `${across(one.x)} ${up(one.y)}`).join("L")}` }, svg);
    svgElement("text", { x: BOX.width / 2, y: BOX.height - 4, "text-anchor": "middle" }, svg).textContent = along;
    svgElement("text", { x: 4, y: 10 }, svg).textContent = upwards;
    for (const end of [0, 1]) {
      svgElement("text", { x: across(scales.x[end]), y: BOX.height - 18, "text-anchor": "middle" }, svg).textContent = digits(scales.x[end]);
      svgElement("text", { x: BOX.left - 4, y: up(scales.y[end]) + 4, "text-anchor": "end" }, svg).textContent = digits(scales.y[end]);
    }
    for (const one of points) {
      const dot = svgElement("circle", { cx: across(one.x), cy: up(one.y), r: 6, tabindex: 0, role: "button" }, svg);
      dot.setAttribute("aria-label", one.words[1]);
      svgElement("title", {}, dot).textContent = one.words[0];
      dot.addEventListener("click", one.take);
      dot.addEventListener("keydown", (event) => (event.key === "Enter" || event.key === " ") && (event.preventDefault(), one.take()));
    }
    return svg;
  }

  function range(values) {
    const [low, high] = [Math.min(...values), Math.max(...values)];
    return [Number(low.toPrecision(2)) > low ? low : Number(low.toPrecision(2)), high > low ? high : low + 1];
  }

  return { show, showAll };
}
