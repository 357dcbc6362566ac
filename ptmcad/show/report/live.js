// The point on the map that is dragged, and a slider for each axis: the solutions there, the stable pose that one
// follows, and its fall where it vanishes.

const live = {
  box: document.getElementById("live"),
  map: document.getElementById("map"),
  share: [0.56, 0.46], // of the window, from the left and from below; its middle is often special, such as no load
  cell: -1,
  found: [],         // solutions, where they are all
  marble: null,      // the unknowns of the stable pose that is followed
  history: [],       // heights of it, with where it fell
  fall: null,        // the last one
  falling: 0,        // the animation's frame
  redraw: null,      // of the landscape that is shown
};
const HISTORY = 160;
const FALL_TIME = 900;
const calm = window.matchMedia("(prefers-reduced-motion: reduce)");

const shareOf = (point) => FOLLOW.window.map(([low, high], k) => (point[k] - low) / (high - low));
const pointOf = (share) => FOLLOW.window.map(([low, high], k) => low + (high - low) * share[k]);
const digits = (value, many = 6) => String(Number(value.toPrecision(many))).replace("-", "−");

// The cell of the map at a point; -1 in undetermined strips and on walls. A certified map's outlines are drawn within DATA.slack
// of their places: nearer to one of them nothing is claimed.
const ground = html("canvas").getContext("2d");
const outlines = [...live.map.querySelectorAll(".cell")].map((area) => {
  const path = area.href ? document.getElementById(area.href.baseVal.slice(1)) : area;
  return [Number(area.dataset.cell), new Path2D(path.getAttribute("d"))];
});
function cellAt([x, y]) {
  const [u, v] = [x * DATA.side * DATA.grid, (1 - y) * DATA.side * DATA.grid];
  Object.assign(ground, { lineWidth: 2 * DATA.slack * DATA.grid || 1, lineJoin: "round", lineCap: "round" });
  const found = outlines.find(([, path]) => ground.isPointInPath(path, u, v));
  return found && !(DATA.slack && outlines.some(([, path]) => ground.isPointInStroke(path, u, v))) ? found[0] : -1;
}

function buildProbe() {
  const group = svg("g", { class: "probe", tabindex: "0", role: "application",
    "aria-label": "Point on the map: arrow keys move it, with shift further" });
  group.append(svg("circle", { class: "grip", r: 26 }), svg("circle", { class: "ring", r: 11 }), svg("circle", { class: "dot", r: 2.5 }));
  live.map.querySelector(".frame").parentNode.append(group);
  let held = null;
  group.addEventListener("pointerdown", (event) => {
    if (event.button !== 0) return;
    const [x, y] = shareAt(event);
    held = [live.share[0] - x, live.share[1] - y];
    group.setPointerCapture(event.pointerId);
    group.classList.add("held");
    group.focus({ preventScroll: true });
    event.preventDefault();
  });
  group.addEventListener("pointermove", (event) => {
    if (!held) return;
    const [x, y] = shareAt(event);
    soon([x + held[0], y + held[1]]);
  });
  // touch-action alone does not keep browsers from scrolling where a part of a picture is held
  group.addEventListener("touchstart", (event) => event.preventDefault(), { passive: false });
  const release = () => { held = null; group.classList.remove("held"); };
  for (const kind of ["pointerup", "pointercancel", "lostpointercapture"]) group.addEventListener(kind, release);
  group.addEventListener("keydown", (event) => {
    const arrow = { ArrowLeft: [0, -1], ArrowRight: [0, 1], ArrowDown: [1, -1], ArrowUp: [1, 1] }[event.key];
    if (!arrow || event.ctrlKey || event.metaKey || event.altKey) return;
    const next = [...live.share];
    next[arrow[0]] += arrow[1] * (event.shiftKey ? 0.05 : 0.005);
    moveProbe(next);
    say(live.status.textContent);
    event.preventDefault();
  });
  return group;
}

function shareAt(event) {
  const box = live.map.querySelector(".frame").getBoundingClientRect();
  return [(event.clientX - box.left) / box.width, 1 - (event.clientY - box.top) / box.height];
}

let waiting = null;
function soon(share) {
  if (!waiting) requestAnimationFrame(() => { const next = waiting; waiting = null; moveProbe(next); });
  waiting = share;
}

function buildLive() {
  const head = html("h3", "", "A point of the map");
  live.sliders = FOLLOW.window.map(([low, high], k) => {
    const label = html("label", "axis");
    const input = html("input");
    Object.assign(input, { type: "range", min: 0, max: 1, step: 0.0025 });
    input.setAttribute("aria-label", DATA.axes[k]);
    const output = html("output");
    input.addEventListener("input", () => {
      const next = [...live.share];
      next[k] = Number(input.value);
      moveProbe(next);
    });
    label.append(html("span", "", DATA.axes[k]), input, output);
    label.title = `from ${digits(low)} to ${digits(high)}`;
    return { label, input, output };
  });
  live.status = html("p", "status");
  live.status.setAttribute("role", "status");
  live.body = html("div", "live-body");
  live.box.append(head, html("p", "hint", "Drag the ring on the map, move it with the arrow keys, or take a slider."),
    ...live.sliders.map(({ label }) => label), live.status, live.body);
  live.probe = buildProbe();
  live.map.addEventListener("click", (event) => {
    if (event.target.classList.contains("cell")) moveProbe(shareAt(event), true);
  });
}

// The point elsewhere: the followed pose goes along, and all solutions are found anew. At a sample its cell is known.
function moveProbe(share, quietly = false, known = -1) {
  const before = pointOf(live.share);
  live.share = share.map((value) => Math.min(0.9995, Math.max(0.0005, value)));
  live.cell = known >= 0 && live.share.every((value, k) => value === share[k]) ? known : cellAt(live.share);
  const point = pointOf(live.share);
  const [x, y] = live.share;
  live.probe.setAttribute("transform", `translate(${(x * DATA.side).toFixed(2)} ${((1 - y) * DATA.side).toFixed(2)})`);
  live.sliders.forEach(({ input, output }, k) => {
    input.value = live.share[k];
    output.textContent = digits(point[k]);
    input.setAttribute("aria-valuetext", digits(point[k]));
  });
  if (!quietly && live.marble) follow(before, point);
  solve(point);
  draw();
  document.dispatchEvent(new CustomEvent("probe", { detail: point }));
}

function follow(before, point) {
  const { at, snaps } = followed(before, point, live.marble);
  live.marble = at;
  if (!snaps.length) {
    if (live.fall && apart(live.fall.point, point) > 0.1) live.fall = null;
    if (at) note(heightAt(parametersAt(point), at));
    return;
  }
  live.fall = snaps[snaps.length - 1];
  for (const { levels } of snaps) {
    const stride = Math.max(1, Math.ceil(levels.length / 40));
    levels.forEach((level, k) => { if (k % stride === 0 || k === levels.length - 1) note(level, true); });
  }
  if (at) note(heightAt(parametersAt(point), at));
  startFall();
}

function note(height, falling = false) {
  live.history.push({ height, falling });
  live.history.splice(0, live.history.length - HISTORY);
}

function solve(point) {
  live.found = [];
  const cell = DATA.cells[live.cell];
  const where = point.map((value, k) => `${DATA.axes[k]} = ${digits(value)}`).join(", ");
  if (!cell) {
    live.marble = null;
    live.status.textContent = `${where}: on a boundary or where counts are not determined; nothing is drawn.`;
    return;
  }
  const exact = `exact count of this region: ${cell.counts}`;
  if (!cell.equilibria.length && (cell.stable !== 0 || !FOLLOW.stableOnly) && cell.total !== 0) {
    live.marble = null;
    live.status.textContent = `${where}: ${exact}. The result stores no solutions of this cell to begin from.`;
    return;
  }
  const { found, all } = solutionsAt(point, live.cell);
  if (!all) {
    live.marble = null;
    live.status.textContent = `${where}: ${exact}, but only ${found.length} different ones were found here in floating `
      + "point, or not of these kinds; none is drawn. Choose the cell for its certified sample.";
    return;
  }
  const levels = new Map(found.map((one) => [one, FOLLOW.energy === null ? 0 : one.values[FOLLOW.energy]]));
  live.found = found.sort((a, b) => (a.kind !== "stable") - (b.kind !== "stable") || (a.index || 0) - (b.index || 0)
    || levels.get(a) - levels.get(b));
  live.status.textContent = `${where}: floating point; ${exact}.`;
  if (FOLLOW.energy === null) return;
  // what was followed has to be one of them
  const mine = live.marble && live.found.find((one) => one.kind === "stable" && distance(one.at, live.marble) < 1e-4);
  if (!mine) {
    const lowest = live.found.find((one) => one.kind === "stable");
    live.marble = lowest ? lowest.at : null;
    live.history = [];
    live.fall = null;
    if (lowest) note(heightAt(parametersAt(point), lowest.at));
  }
}

const holdsMarble = (one) => live.marble !== null && one.kind === "stable" && distance(one.at, live.marble) < 1e-4;

// What the drawings of mechanism.js take: numbers for people, places, loads.
function drawn(one, kind = one.kind) {
  const { values, at } = one;
  return {
    kind, energy: FOLLOW.energy === null ? "" : digits(values[FOLLOW.energy]),
    unknowns: at.map((value, k) => (k < FOLLOW.angles ? `${(turned(value) * 180 / Math.PI).toFixed(2).replace("-", "−")}°` : digits(value))),
    nodes: FOLLOW.points.map(([x, y]) => [values[x], values[y]]),
  };
}

function sceneOf(solutions) {
  const [first] = solutions;
  const loads = first ? FOLLOW.loads.map(([x, y]) => [first.values[x], first.values[y]]) : [];
  return { loads, equilibria: solutions.map((one) => drawn(one)) };
}

function draw() {
  live.body.replaceChildren();
  live.redraw = null;
  drawLater();
  if (live.fall) live.body.append(fallView());
  if (!live.found.length) return;
  const scene = sceneOf(live.found);
  if (!DATA.drawable) {
    const list = html("ul");
    for (const pose of scene.equilibria) {
      list.append(html("li", "", `${pose.kind}: ${pose.unknowns.map((text, n) => `${MECHANISM.unknowns[n]} = ${text}`).join(", ")}`));
    }
    live.body.append(list);
  } else {
    const frame = frameOf(scene);
    const grid = html("div", "grid-of-poses few");
    scene.equilibria.forEach((pose, k) => {
      const one = live.found[k];
      const figure = html("figure", `pose ${pose.kind}`);
      const caption = html("figcaption");
      caption.append(html("b", "", pose.kind), html("br"), pose.unknowns.map((text, n) => `${MECHANISM.unknowns[n]} = ${text}`).join(", "));
      figure.append(drawPose(scene, pose, frame), caption);
      if (FOLLOW.energy !== null && one.kind === "stable") {
        const held = holdsMarble(one);
        figure.classList.toggle("followed", held);
        const button = html("button", "follow", held ? "Followed" : "Follow this pose");
        button.type = "button";
        button.setAttribute("aria-pressed", String(held));
        button.addEventListener("click", () => followPose(k));
        figure.append(button);
      }
      grid.append(figure);
    });
    live.body.append(grid);
  }
  if (live.history.length > 1 && !live.fall) live.body.append(energyCurve(live.history, live.history.length - 1, "Energy of the followed pose as the point moved"));
}

// The landscape at rest, with the marble in it: drawing it takes longer than a frame.
const REST = 350;
let resting = 0;
function drawLater() {
  clearTimeout(resting);
  if (!DATA.landscape || !live.found.length) return;
  resting = setTimeout(() => {
    if (!live.body.querySelector(".grid-of-poses")) return;
    const point = pointOf(live.share);
    const parameters = parametersAt(point);
    const first = live.found[0];
    const moments = FOLLOW.moments.length ? [0, 1].map((unknown) => FOLLOW.moments
      .reduce((sum, [own, k]) => (own === unknown ? sum + first.values[k] : sum), 0)) : [];
    const place = { moments, point, equilibria: live.found.map((one) => ({
      kind: one.kind, energy: digits(one.values[FOLLOW.energy]), level: one.values[FOLLOW.energy],
      at: one.at.flatMap((angle) => [Math.cos(angle), Math.sin(angle)]),
    })) };
    const figures = live.body.querySelectorAll(".grid-of-poses .pose");
    const view = drawLandscape(place, (k, on) => figures[k].classList.toggle("seen", on));
    view.marks.forEach((marks, k) => { if (holdsMarble(live.found[k])) for (const mark of marks) mark.classList.add("followed"); });
    live.redraw = view.redraw;
    if (live.fall && apart(live.fall.point, point) < 0.02) view.box.querySelector("g").append(fallPath(live.fall.way));
    live.body.append(html("h4", "", `${landscapeTitle(place)}, floating point; the red mark is the followed pose`), view.box);
  }, REST);
}
theme.changed.push(() => { if (live.redraw) live.redraw(); });

// The way of a fall over the landscape, in pieces where an angle passes 180 degrees.
function fallPath(way) {
  let d = "";
  let last = null;
  for (const [one, two] of way.map((at) => at.map(turned))) {
    const far = !last || Math.max(Math.abs(one - last[0]), Math.abs(two - last[1])) > Math.PI;
    d += `${far ? "M" : "L"}${((one / Math.PI + 1) / 2 * PLOT.side).toFixed(1)} ${((1 - two / Math.PI) / 2 * PLOT.side).toFixed(1)}`;
    last = [one, two];
  }
  return svg("path", { class: "level fallen", d });
}

function followPose(k) {
  stopFall();
  live.marble = live.found[k].at;
  live.history = [];
  live.fall = null;
  note(heightAt(parametersAt(pointOf(live.share)), live.marble));
  draw();
  const button = live.body.querySelectorAll(".grid-of-poses .pose")[k].querySelector(".follow");
  if (button) button.focus();
}

// Heights one after the other, with a marble on one of them.
function energyCurve(history, at, label) {
  const [width, height, rim] = [360, 120, 14];
  const levels = history.map((entry) => entry.height);
  const [low, high] = [Math.min(...levels), Math.max(...levels)];
  const place = (k) => [rim + (width - 2 * rim) * k / Math.max(1, history.length - 1),
    rim + (height - 2 * rim) * (high > low ? (high - levels[k]) / (high - low) : 0.5)];
  const picture = svg("svg", { class: "energy", viewBox: `0 0 ${width} ${height}`, role: "img",
    "aria-label": `${label}: from ${digits(levels[0])} to ${digits(levels[levels.length - 1])}` });
  const path = (from, to) => "M" + history.slice(from, to).map((_, k) => place(from + k).map((c) => c.toFixed(1)).join(" ")).join("L");
  picture.append(svg("path", { class: "level", d: path(0, history.length) }));
  const first = history.findIndex((entry) => entry.falling);
  const last = history.length - [...history].reverse().findIndex((entry) => entry.falling);
  if (first >= 0) picture.append(svg("path", { class: "level fallen", d: path(first, last) }));
  const [x, y] = place(at);
  picture.append(svg("circle", { class: "marble", cx: x.toFixed(1), cy: (y - 6).toFixed(1), r: 6 }));
  const figure = html("figure", "curve");
  figure.append(picture, html("figcaption", "", `${label}: ${digits(levels[at])}`));
  return figure;
}

// The fall: the pose that vanished, on its way to the one that it goes to.
function fallView() {
  const { point, way, before, after, levels } = live.fall;
  const box = html("div", "fall");
  const parameters = parametersAt(point);
  const poseAt = (at, kind) => drawn({ at, values: valuesAt(parameters, at) }, kind);
  const where = point.map((value, k) => `${DATA.axes[k]} = ${digits(value, 5)}`).join(", ");
  const names = (at) => poseAt(at, "").unknowns.map((text, n) => `${MECHANISM.unknowns[n]} = ${text}`).join(", ");
  box.append(html("p", "snap", `Snap at ${where}: the followed pose (${names(before)}) vanished; from there it descends to `
    + `${names(after)}, by ${digits(levels[0] - levels[levels.length - 1])} in energy (steepest descent, floating point).`));
  const stage = html("div", "stage");
  box.append(stage);
  const loadsOf = (values) => FOLLOW.loads.map(([x, y]) => [values[x], values[y]]);
  const scene = { loads: loadsOf(valuesAt(parameters, after)), equilibria: [poseAt(before, "stable"), poseAt(after, "stable")] };
  const frame = DATA.drawable ? frameOf(scene) : null;
  const history = levels.map((height) => ({ height, falling: true }));
  live.showFall = (share) => {
    const k = Math.round(share * (way.length - 1));
    stage.replaceChildren();
    if (frame) {
      const figure = html("figure", "pose stable");
      figure.append(drawPose(scene, poseAt(way[k], k === way.length - 1 ? "stable" : "falling"), frame));
      stage.append(figure);
    }
    stage.append(energyCurve(history, k, "Energy along the fall"));
  };
  live.showFall(live.falling ? 0 : 1);
  return box;
}

function stopFall() {
  cancelAnimationFrame(live.falling);
  live.falling = 0;
}

function startFall() {
  stopFall();
  if (calm.matches) return;
  let begun = null;
  const run = (now) => {
    if (begun === null) begun = now;
    const share = Math.min(1, (now - begun) / FALL_TIME);
    if (live.showFall && live.fall) live.showFall(share);
    live.falling = share < 1 ? requestAnimationFrame(run) : 0;
  };
  live.falling = requestAnimationFrame(run);
}

if (FOLLOW && DATA.cells.length) {
  buildLive();
  moveProbe(live.share, true);
}
