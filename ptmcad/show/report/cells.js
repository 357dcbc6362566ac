// The map's cells: pointing shows what a cell is, choosing draws its poses; keyboard, pointer and touch alike.

const cells = {
  areas: new Map(), // number of the cell -> its areas: one in the map, perhaps more in the views of thin regions
  current: -1,      // the one that Tab reaches
  chosen: -1,
  redraw: null,     // of the landscape that is shown
};
const readout = document.getElementById("readout");
const panel = document.getElementById("poses");
const sampleDot = document.querySelector("#map .sample");

// A cell's sample, and what the areas are to those who do not see them.
const sampleOf = (cell) => cell.sample.map((text, k) => `${DATA.names[k]} = ${text}`);

for (const area of document.querySelectorAll(".cell")) {
  const number = Number(area.dataset.cell);
  const cell = DATA.cells[number];
  const label = `Cell ${number} of region ${cell.region}: ${cell.counts}; sample ${sampleOf(cell).join(", ")}`;
  for (const [name, value] of Object.entries({ tabindex: "-1", role: "button", "aria-pressed": "false", "aria-label": label })) {
    area.setAttribute(name, value);
  }
  if (!cells.areas.has(number)) cells.areas.set(number, []);
  cells.areas.get(number).push(area);
}

function line(parent, label, text) {
  const p = html("div");
  if (label) p.append(html("b", "", `${label} `));
  p.append(text);
  parent.append(p);
}

function show(number) {
  readout.replaceChildren();
  const cell = DATA.cells[number];
  readout.classList.toggle("idle", !cell);
  for (const area of document.querySelectorAll(".cell.seen")) area.classList.remove("seen");
  if (!cell) {
    line(readout, "", DATA.cells.length ? "No cell is pointed at." : "No cells are known yet.");
    sampleDot.setAttribute("visibility", "hidden");
    return;
  }
  const index = cell.index ? ` (${DATA.index} ${cell.index.join("-")})` : "";
  line(readout, `Cell ${number}, region ${cell.region}:`, `${cell.counts}${index}`);
  line(readout, "Sample:", sampleOf(cell).join(", "));
  const region = DATA.regions[cell.region];
  line(readout, "Area of the region:", region.area);
  for (const area of cells.areas.get(number) || []) area.classList.add("seen");
  sampleDot.setAttribute("cx", cell.at[0]);
  sampleDot.setAttribute("cy", cell.at[1]);
  sampleDot.setAttribute("visibility", "visible");
}

function settle() {
  show(document.activeElement.classList.contains("cell") ? cells.current : cells.chosen);
}

function moveTo(number, focus) {
  const own = cells.areas.get(number);
  if (!own) return;
  for (const area of cells.areas.get(cells.current) || []) area.setAttribute("tabindex", "-1");
  cells.current = number;
  own[0].setAttribute("tabindex", "0");
  if (focus) own[0].focus({ preventScroll: false });
}

function press(number, pressed) {
  for (const area of cells.areas.get(number) || []) area.setAttribute("aria-pressed", String(pressed));
  for (const chip of document.querySelectorAll(`.chip[data-cell="${number}"]`)) chip.setAttribute("aria-pressed", String(pressed));
}

function close() {
  if (cells.chosen < 0) return;
  const last = cells.chosen;
  press(last, false);
  cells.chosen = -1;
  cells.redraw = null;
  const within = panel.contains(document.activeElement);
  panel.replaceChildren(html("p", "hint", "No cell is chosen."));
  if (within) moveTo(last, true);
  settle();
  say("Closed.");
}

function choose(number, bringIntoView) {
  const cell = DATA.cells[number];
  if (!cell) return;
  press(cells.chosen, false);
  cells.chosen = number;
  press(number, true);
  moveTo(number, false);
  show(number);
  if (FOLLOW) moveProbe(shareOf(cell.point), true, number);
  fillPanel(number, cell);
  say(`Cell ${number}: ${cell.counts}. ${DATA.drawable ? "Its poses are drawn." : "Its solutions are listed."}`);
  // the point's own poses stand above the cell's: what was clicked is at the top of both
  const pane = FOLLOW ? document.getElementById("live") : panel;
  const top = pane.getBoundingClientRect().top;
  if (bringIntoView && (top < 0 || top > window.innerHeight - 120)) pane.scrollIntoView({ block: "start" });
}

function fillPanel(number, cell) {
  const head = html("div", "poses-head");
  const title = html("h3", "", `Cell ${number}: ${cell.counts}`);
  const button = html("button", "", "Close");
  button.type = "button";
  button.id = "close";
  button.addEventListener("click", close);
  head.append(title, button);
  const given = [...sampleOf(cell), ...cell.parameters.map(([name, text]) => `${name} = ${text}`)];
  panel.replaceChildren(head, html("p", "hint", `At the sample: ${given.join(", ")}.`));
  cells.redraw = null;
  if (!cell.equilibria.length) {
    const why = DATA.drawable ? "The result stores no poses for this cell." : cell.counts.startsWith("0 ") ? "There is no solution here."
      : "The result stores no solutions for this cell.";
    panel.append(html("p", "", why));
    return;
  }
  if (!DATA.drawable) {
    panel.append(html("p", "hint", "A system has no points, bars or springs to draw: its solutions in numbers, every digit "
      + "certified to one unit of the last place."), springTable(cell));
    if (DATA.landscape && FOLLOW) {
      const energy = drawLandscape(cell, () => {});
      cells.redraw = energy.redraw;
      panel.append(html("h3", "", landscapeTitle(cell)), energy.box, landscapeLegend());
    }
    return;
  }
  const frame = frameOf(cell);
  const figures = [];
  const grid = html("div", "grid-of-poses");
  const pointed = (k, on) => {
    figures[k].classList.toggle("seen", on);
    for (const mark of landscape ? landscape.marks[k] : []) mark.classList.toggle("seen", on);
  };
  for (const pose of cell.equilibria) {
    const figure = html("figure", `pose ${pose.kind}`);
    const caption = html("figcaption");
    caption.append(html("b", "", pose.kind), html("br"), ...pose.unknowns.flatMap((text, n) => [`${MECHANISM.unknowns[n]} = ${text}`, html("br")]),
      pose.energy ? `U = ${pose.energy} ${unitOf("energy")}`.trim() : "");
    figure.append(drawPose(cell, pose, frame), caption);
    const k = figures.length;
    figure.addEventListener("pointerenter", () => pointed(k, true));
    figure.addEventListener("pointerleave", () => pointed(k, false));
    figures.push(figure);
    grid.append(figure);
  }
  const without = cell.moments.length ? " U is the energy of springs and loads, without the " + DATA.work + "." : "";
  panel.append(grid, html("p", "hint", legendOfParts() + without));
  if (cell.total === null || cell.equilibria.length < cell.total) panel.append(html("p", "hint", "The result stores the stable poses alone."));
  const landscape = DATA.landscape && FOLLOW ? drawLandscape(cell, pointed) : null;
  cells.redraw = landscape && landscape.redraw;
  const numbers = html("details");
  numbers.append(html("summary", "", "Poses in numbers (every digit certified to one unit of the last place)"), springTable(cell));
  if (landscape) panel.append(html("h3", "", landscapeTitle(cell)), landscape.box, landscapeLegend());
  else if (FOLLOW && FOLLOW.energy !== null) panel.append(html("p", "hint", "The energy is drawn here over two angles only; ptmcad solve --landscape draws it over any one or two unknowns."));
  panel.append(numbers);
}

function legendOfParts() {
  const points = (numbers) => numbers.map((point) => MECHANISM.points[point]).join(" and ");
  const { rods, springs, loaded, pinned, sliding, rising } = MECHANISM;
  const parts = [];
  if (rods.length) parts.push(`thick lines: the rods ${rods.map(nameOf).join(" and ")}`);
  if (springs.length) parts.push("zigzag: springs");
  const [drawn, others] = [true, false].map((known) => TORSION.filter(({ at }) => at.length > 0 === known));
  if (drawn.length) parts.push(`spirals: torsion springs on ${drawn.map(({ name, at }) => `${name} at ${MECHANISM.points[at[0]]}`).join(" and ")}`);
  if (others.length) parts.push(`torsion springs on ${others.map(({ name }) => name).join(" and ")} are not drawn`);
  if (loaded.length) parts.push(`arrows: the loads at ${points(loaded)}`);
  const held = [];
  if (pinned.length) held.push(`${points(pinned)} ${pinned.length > 1 ? "are" : "is"} pinned`);
  const slides = [...sliding, ...rising];
  if (slides.length) held.push(`${points(slides)} ${slides.length > 1 ? "sit on sliders" : "sits on the slider"}`);
  const text = parts.join("; ");
  return `${text.charAt(0).toUpperCase()}${text.slice(1)}. ${held.length ? `${held.join(", ")}. ` : ""}`
    + `All poses are drawn to one scale; ${DATA.told ? "a strong frame means stable" : DATA.untold}.`;
}
theme.changed.push(() => { if (cells.redraw) cells.redraw(); });

// The next cell in a direction: along a stack, or in the neighbouring stack the one whose sample is nearest in height.
// Without stacks, the one whose sample is nearest in that direction; what lies aside counts double.
function neighbour(number, key) {
  const cell = DATA.cells[number];
  if (cell.stack === null) {
    const [axis, sign] = { ArrowLeft: [0, -1], ArrowRight: [0, 1], ArrowUp: [1, -1], ArrowDown: [1, 1] }[key];
    const cost = (n) => {
      const ahead = sign * (DATA.cells[n].at[axis] - cell.at[axis]);
      return ahead > 0 ? ahead + 2 * Math.abs(DATA.cells[n].at[1 - axis] - cell.at[1 - axis]) : Infinity;
    };
    const ahead = DATA.cells.map((_, n) => n).filter((n) => cells.areas.has(n) && cost(n) < Infinity);
    return ahead.length ? ahead.reduce((best, n) => (cost(n) < cost(best) ? n : best)) : undefined;
  }
  const along = DATA.base === 0 ? { ArrowLeft: -1, ArrowRight: 1 } : { ArrowDown: -1, ArrowUp: 1 };
  const across = DATA.base === 0 ? { ArrowDown: -1, ArrowUp: 1 } : { ArrowLeft: -1, ArrowRight: 1 };
  if (key in across) return DATA.stacks[cell.stack][cell.level + across[key]];
  const others = DATA.stacks[cell.stack + along[key]];
  if (!others) return undefined;
  const height = (n) => DATA.cells[n].at[1 - DATA.base];
  return others.reduce((best, n) => (Math.abs(height(n) - height(number)) < Math.abs(height(best) - height(number)) ? n : best));
}

for (const [number, areas] of cells.areas) {
  for (const area of areas) {
    area.addEventListener("pointerenter", () => show(number));
    area.addEventListener("pointerleave", settle);
    area.addEventListener("focus", () => { moveTo(number, false); show(number); });
    area.addEventListener("blur", settle);
    area.addEventListener("click", () => choose(number, true));
    area.addEventListener("keydown", (event) => {
      if (event.ctrlKey || event.metaKey || event.altKey) return;
      if (event.key === "Enter" || event.key === " ") {
        choose(number, false);
      } else if (/^Arrow(Left|Right|Up|Down)$/.test(event.key)) {
        const next = neighbour(number, event.key);
        if (next !== undefined) moveTo(next, true);
      } else if (event.key === "Home" || event.key === "End") {
        moveTo(event.key === "Home" ? 0 : DATA.cells.length - 1, true);
      } else {
        return;
      }
      event.preventDefault();
    });
  }
}
for (const chip of document.querySelectorAll(".chip")) {
  chip.type = "button";
  chip.dataset.cell = chip.textContent;
  chip.setAttribute("aria-label", `Show cell ${chip.dataset.cell}`);
  chip.addEventListener("click", () => choose(Number(chip.dataset.cell), true));
}
document.addEventListener("keydown", (event) => { if (event.key === "Escape") close(); });
moveTo(0, false);
show(-1);
