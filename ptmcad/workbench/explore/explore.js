"use strict";
// The map that follows the sliders, and the solutions at a point of it.

const REST = 160; // milliseconds without a change after which areas and smooth curves are asked for
const ROUNDS = 8; // of a certified map that is refined while the hand rests
const state = document.getElementById("state");
const byId = (id) => document.getElementById(id);
const view = {
  values: Object.fromEntries(DATA.sliders.map((slider) => [slider.name, slider.value])),
  shown: null,     // the answer that is drawn
  of: null,        // the values that it is of
  refused: "",
  framed: false,
  rounds: 0,
  timer: 0,
  share: [0.56, 0.46], // the point, as shares of the window from the left and from below
  fixed: false,
  poses: null,
  draws: [],       // for whoever measures: [asked, drawn, fine]
};

const sameValues = (one, other) => one !== null && DATA.sliders.every(({ name }) => one[name] === other[name]);
const told = (values) => DATA.sliders.filter(({ free }, k) => free || k === 0 || view.values[DATA.sliders[k].name] !== DATA.sliders[k].value
  || values[DATA.sliders[k].name] !== DATA.sliders[k].value).map(({ name, symbol }) => `${symbol} = ${values[name]}`).join(", ") || "the slice of the record";

const maps = new Latest("map", (status, data, { question, asked }) => {
  if (status !== 200) {
    view.refused = data.error || "The question was refused.";
    tell();
    return;
  }
  view.refused = "";
  drawMap(data, question);
  view.draws.push([asked, performance.now(), question.fine]);
  tell();
  const refine = data.certified && !data.settled && view.rounds < ROUNDS;
  if (sameValues(question.values, view.values) && (!question.fine || refine)) rest(question.fine ? 10 : REST);
});

function wantMap(fine) {
  maps.want({ values: { ...view.values }, fine, framed: !view.framed });
  tell();
}

// Where the hand rests: areas and smooth curves, or what is undetermined further narrowed; and the point's solutions.
function rest(after) {
  clearTimeout(view.timer);
  view.timer = setTimeout(() => {
    if (maps.under || maps.next) return;
    view.rounds += 1;
    wantMap(true);
    if (!view.poses || !sameValues(view.poses.values, view.values)) wantPoint();
  }, after);
}

function changed(name, text) {
  view.values[name] = text;
  view.rounds = 0;
  clearTimeout(view.timer);
  byId("poses").classList.add("late");
  byId("recorded").hidden = true;
  wantMap(false);
}

function drawMap(data, question) {
  byId("patterns").innerHTML = data.patterns;
  const lines = (kind, width) => data.regions.map((region) => svg("path", { class: kind, "stroke-width": width, d: region.d }));
  const rims = data.certified ? [...lines("rim", DATA.rim), ...lines("core", DATA.core)] : [];
  byId("fills").replaceChildren(...data.regions.flatMap((region, number) => {
    const parts = [svg("path", { class: "fill", fill: region.face, d: region.d, "data-region": number })];
    if (region.hatch) parts.push(svg("path", { class: "fill", fill: `url(#map-${region.hatch})`, d: region.d }));
    return parts;
  }), ...rims);
  byId("strong").setAttribute("d", data.strong);
  byId("thin").setAttribute("d", data.thin);
  byId("labels").replaceChildren(...data.labels.map(([text, x, y]) => svg("text", { class: "count", x, y, dy: ".36em" }, text)));
  if (data.frame) {
    byId("frame").innerHTML = data.frame.svg;
    byId("map").setAttribute("viewBox", data.frame.view);
    byId("placed").setAttribute("transform", data.frame.place);
    view.framed = true;
  }
  view.shown = data;
  view.of = question.values;
  byId("regions").replaceChildren(...data.regions.map((region) => {
    const item = html("li");
    const swatch = svg("svg", { class: "swatch", viewBox: "0 0 30 18", "aria-hidden": "true" });
    swatch.append(svg("rect", { width: 30, height: 18, fill: region.face }));
    if (region.hatch) swatch.append(svg("rect", { width: 30, height: 18, fill: `url(#${region.hatch})` }));
    item.append(swatch, html("span", "", `${region.words}${region.area ? `, area ${region.area}` : ""}`));
    return item;
  }));
  where();
}

// What is shown, for which values, and what is under way.
function tell() {
  const late = view.of === null || !sameValues(view.of, view.values);
  byId("map").classList.toggle("late", late && view.of !== null && !view.refused);
  state.className = view.refused ? "refused" : late ? "late" : "";
  const changed = DATA.sliders.some(({ name, value }) => view.values[name] !== value); // a title may name the values at first
  document.querySelector("h1").textContent = changed ? `${DATA.name}: ${told(view.values)}` : DATA.title;
  state.replaceChildren();
  if (view.shown) {
    const { certified, undetermined, regions, settled } = view.shown;
    const many = `${regions.length} region${regions.length === 1 ? "" : "s"}`;
    const kind = !certified ? "exact" : `${settled ? "certified" : "coarse"}, ${Number(undetermined).toPrecision(2)} % undetermined`;
    state.append("Shown: ", html("b", "", told(view.of)), ` (${kind}, ${many}). `);
  }
  if (view.refused) state.append(`${told(view.values)}: ${view.refused}`);
  else if (late) state.append("Computing ", html("b", "", told(view.values)), " …");
  else if (maps.under && maps.under.question.fine && view.shown) state.append(view.shown.certified ? "Refining …" : "Areas …");
}

// Sliders: positions are whole multiples of a round step, so that every value is a short decimal.

const decimals = (step) => (step.includes("e-") ? Number(step.split("e-")[1]) : (step.split(".")[1] || "").length);

function buildSlider(slider) {
  const [step, digits] = [Number(slider.step), decimals(slider.step)];
  const [first, last] = [Math.ceil(slider.low / step - 1e-9), Math.floor(slider.high / step + 1e-9)];
  const label = html("div", slider.free ? "axis free" : "axis");
  const [range, text] = [html("input"), html("input")];
  Object.assign(range, { type: "range", min: first, max: last, step: 1, value: Math.round(fraction(slider.value) / step), name: slider.name });
  Object.assign(text, { type: "text", value: slider.value, inputMode: "text", autocomplete: "off", spellcheck: false, maxLength: 80 });
  range.setAttribute("aria-label", slider.symbol);
  range.setAttribute("aria-valuetext", slider.value);
  text.setAttribute("aria-label", `${slider.symbol}, exactly`);
  label.title = `from ${slider.ends[0]} to ${slider.ends[1]}`;
  range.addEventListener("input", () => {
    text.value = (Number(range.value) * step).toFixed(digits);
    text.classList.remove("wrong");
    range.setAttribute("aria-valuetext", text.value);
    changed(slider.name, text.value);
  });
  text.addEventListener("change", () => {
    const value = fraction(text.value.trim());
    const right = value >= slider.low - 1e-9 && value <= slider.high + 1e-9;
    text.classList.toggle("wrong", !right);
    if (!right) {
      say(`${slider.symbol} is a number ${label.title}`);
      return;
    }
    range.value = Math.round(value / step);
    changed(slider.name, text.value.trim());
  });
  label.append(html("span", "", slider.symbol), range, text);
  slider.set = (value) => {
    text.value = value;
    text.classList.remove("wrong");
    range.value = Math.round(fraction(value) / step);
    view.values[slider.name] = value;
  };
  return label;
}

// A decimal or a fraction as a number, for places on the screen alone; the server reads the text itself.
function fraction(text) {
  const match = /^([-+]?[\d.]+(?:e[-+]?\d+)?)(?:\/(\d+))?$/i.exec(text);
  return match ? Number(match[1]) / Number(match[2] || 1) : NaN;
}

// The point.

const points = new Latest("point", (status, data, { question }) => {
  view.poses = { status, data, values: question.values, at: question.at };
  drawPoint();
});

function atText(share, axis) {
  const span = axis.high - axis.low;
  const digits = Math.max(0, 3 - Math.floor(Math.log10(span)));
  const unit = 10 ** -digits;
  const value = Math.min(axis.high - span / 4000, Math.max(axis.low + span / 4000, axis.low + span * share));
  return (Math.round(value / unit) * unit).toFixed(Math.min(digits, 20));
}

const pointText = () => Object.fromEntries(DATA.axes.map((axis, k) => [axis.name, atText(view.share[k], axis)]));

function wantPoint() {
  points.want({ values: { ...view.values }, at: pointText() });
}

function movePoint(share) {
  view.share = share.map((value) => Math.min(1, Math.max(0, value)));
  const [x, y] = view.share;
  probe.setAttribute("transform", `translate(${(x * DATA.side).toFixed(2)} ${((1 - y) * DATA.side).toFixed(2)})`);
  where();
  wantPoint();
}

// The drawn region at the point; none in what is undetermined.
function regionAt([x, y]) {
  const spot = byId("map").createSVGPoint();
  [spot.x, spot.y] = [x * DATA.side * DATA.grid, (1 - y) * DATA.side * DATA.grid];
  const found = [...document.querySelectorAll("#fills [data-region]")].find((path) => path.isPointInFill(spot));
  return found && view.shown ? view.shown.regions[Number(found.dataset.region)] : null;
}

function where() {
  const region = regionAt(view.share);
  const at = pointText();
  byId("where").replaceChildren(
    html("b", "", DATA.axes.map(({ name, symbol }) => `${symbol} = ${at[name]}`).join(", ")), html("br"),
    region ? `In the map: ${region.words}${region.area ? `, area ${region.area}` : ""}.` : "In the map: undetermined, or on a curve.");
}

function drawPoint() {
  const box = byId("poses");
  const { status, data, values } = view.poses;
  box.classList.toggle("late", !sameValues(values, view.values));
  box.replaceChildren();
  if (status !== 200) {
    box.append(html("p", "banner", data.error || "The question was refused."));
    return;
  }
  const note = data.status === "on variety" ? ", on a curve where solutions meet" : "";
  box.append(html("p", "exactly", `Solved there: ${data.words}${note}${data.remark ? ` (${data.remark})` : ""}.`));
  if (!DATA.drawable) {
    for (const pose of data.equilibria) box.append(html("p", "", `${pose.kind}: ${numbers(pose).join(", ")}`));
    return;
  }
  if (!data.equilibria.length) return;
  const frame = frameOf(data);
  const grid = html("div", "grid-of-poses few");
  for (const pose of data.equilibria) {
    const figure = html("figure", `pose ${pose.kind}`);
    const caption = html("figcaption");
    caption.append(html("b", "", pose.kind), ...numbers(pose).flatMap((text) => [html("br"), text]));
    figure.append(drawPose(data, pose, frame), caption);
    grid.append(figure);
  }
  box.append(grid);
}

const numbers = (pose) => [...pose.unknowns.map((text, n) => `${MECHANISM.unknowns[n]} = ${text}`), ...(pose.energy ? [`U = ${pose.energy}`] : [])];

const probe = (() => {
  const group = svg("g", { class: "probe", tabindex: "0", role: "application", "aria-label": "Point on the map: arrow keys move it, with shift further" });
  group.append(svg("circle", { class: "grip", r: 26 }), svg("circle", { class: "ring", r: 11 }), svg("circle", { class: "dot", r: 2.5 }));
  byId("probe-place").append(group);
  return group;
})();

function shareAt(event) {
  const box = document.querySelector("#frame .frame");
  if (!box) return null;
  const { left, top, width, height } = box.getBoundingClientRect();
  return [(event.clientX - left) / width, 1 - (event.clientY - top) / height];
}

const inside = (share) => share !== null && share.every((value) => value >= 0 && value <= 1);
let held = false;
byId("map").addEventListener("pointerdown", (event) => {
  const share = shareAt(event);
  if (event.button !== 0 || !inside(share)) return;
  held = event.pointerType !== "mouse" || probe.contains(event.target);
  if (event.pointerType === "mouse") view.fixed = !view.fixed;
  if (held) byId("map").setPointerCapture(event.pointerId);
  movePoint(share);
});
byId("map").addEventListener("pointermove", (event) => {
  const share = shareAt(event);
  if (inside(share) && (held || (event.pointerType === "mouse" && !view.fixed))) movePoint(share);
});
for (const kind of ["pointerup", "pointercancel"]) byId("map").addEventListener(kind, () => { held = false; });
probe.addEventListener("touchstart", (event) => { if (event.cancelable) event.preventDefault(); }, { passive: false });
probe.addEventListener("keydown", (event) => {
  const arrow = { ArrowLeft: [0, -1], ArrowRight: [0, 1], ArrowDown: [1, -1], ArrowUp: [1, 1] }[event.key];
  if (!arrow || event.ctrlKey || event.metaKey || event.altKey) return;
  const next = [...view.share];
  next[arrow[0]] += arrow[1] * (event.shiftKey ? 0.05 : 0.005);
  view.fixed = true;
  movePoint(next);
  event.preventDefault();
});

// The figure as a record, a command, and files.

byId("record").addEventListener("click", async () => {
  const { status, data } = await ask("record", { values: { ...view.values } });
  if (!status) return;
  byId("recorded").hidden = false;
  byId("yaml").textContent = data.record || data.error;
  byId("command").textContent = data.command || "";
  byId("alone").textContent = data.alone || "";
  byId("alone-box").hidden = !data.alone;
  byId("file-name").value = data.name || DATA.name;
  byId("saved").textContent = "";
});
byId("download").addEventListener("click", () => {
  const link = html("a");
  link.href = URL.createObjectURL(new Blob([byId("yaml").textContent], { type: "text/yaml" }));
  link.download = `${byId("command").textContent.split(" ").pop() || "record.yaml"}`;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
});
byId("save").addEventListener("submit", async (event) => {
  event.preventDefault();
  byId("saved").textContent = "Drawing …";
  const formats = [...document.querySelectorAll("#save input[type=checkbox]:checked")].map((box) => box.value);
  const { status, data } = await ask("save", { values: { ...view.values }, name: byId("file-name").value, formats });
  byId("saved").textContent = status === 200 ? `Saved ${data.files.join(", ")}.` : data.error || "";
});
byId("reset").addEventListener("click", () => {
  for (const slider of DATA.sliders) slider.set(slider.value);
  changed(DATA.sliders[0].name, DATA.sliders[0].value);
});

byId("reset").hidden = !DATA.sliders.length;
byId("sliders").append(...DATA.sliders.map(buildSlider));
movePoint(view.share);
wantMap(false);
