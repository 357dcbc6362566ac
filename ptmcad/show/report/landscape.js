// The energy over both angles, a picture only: shaded bands, contours, the contour through each saddle, the equilibria.
// Where moments work it is the energy less their work, in which the equilibria are level, cut at 180 degrees.

const GRID = 120;
const BANDS = 16;
const PLOT = { side: 400, left: 84, bottom: 74, rim: 34 };

function energyTable(cell, steps) {
  const [one = 0, two = 0] = cell.moments;
  const parameters = parametersAt(cell.point);
  const angle = (k) => -Math.PI + 2 * Math.PI * k / steps;
  return Array.from({ length: steps + 1 }, (_, j) => Float64Array.from({ length: steps + 1 }, (__, i) => (
    valuesAt(parameters, [angle(i), angle(j)])[FOLLOW.energy] - one * angle(i) - two * angle(j))));
}

// Marching squares: one segment for each square that the level passes through, two in a saddle's square.
function contour(table, level, side) {
  const steps = table.length - 1;
  const unit = side / steps;
  let d = "";
  const cut = (a, b) => (level - a) / (b - a);
  for (let j = 0; j < steps; j += 1) {
    for (let i = 0; i < steps; i += 1) {
      const [p, q, r, s] = [table[j][i], table[j][i + 1], table[j + 1][i + 1], table[j + 1][i]];
      const ends = [];
      if ((p < level) !== (q < level)) ends.push([i + cut(p, q), j]);
      if ((q < level) !== (r < level)) ends.push([i + 1, j + cut(q, r)]);
      if ((s < level) !== (r < level)) ends.push([i + cut(s, r), j + 1]);
      if ((p < level) !== (s < level)) ends.push([i, j + cut(p, s)]);
      for (let k = 0; k + 1 < ends.length; k += 2) {
        const [[x, y], [u, v]] = [ends[k], ends[k + 1]];
        d += `M${(x * unit).toFixed(1)} ${(side - y * unit).toFixed(1)}L${(u * unit).toFixed(1)} ${(side - v * unit).toFixed(1)}`;
      }
    }
  }
  return d;
}

// What is drawn at an equilibrium, where the picture has it.
function levelOf(cell, pose) {
  const [c1, s1, c2, s2] = pose.at;
  const [one = 0, two = 0] = cell.moments;
  return pose.level - one * Math.atan2(s1, c1) - two * Math.atan2(s2, c2);
}

function landscapeTitle(cell) {
  return cell.moments.length ? "Energy less the moments' work over both angles, cut at ±180° and not periodic" : "Energy over both angles";
}

function shade(canvas, cell, low, high) {
  const pixels = canvas.width;
  const table = energyTable(cell, pixels - 1);
  const style = getComputedStyle(document.documentElement);
  const colour = (name) => style.getPropertyValue(name).split(",").map(Number);
  const [dark, light] = [colour("--low"), colour("--high")];
  const context = canvas.getContext("2d");
  const image = context.createImageData(pixels, pixels);
  for (let j = 0; j < pixels; j += 1) {
    for (let i = 0; i < pixels; i += 1) {
      const share = (table[pixels - 1 - j][i] - low) / (high - low);
      const band = Math.min(BANDS - 1, Math.max(0, Math.floor(share * BANDS))) / (BANDS - 1);
      const at = 4 * (j * pixels + i);
      for (let k = 0; k < 3; k += 1) image.data[at + k] = dark[k] + (light[k] - dark[k]) * band;
      image.data[at + 3] = 255;
    }
  }
  context.putImageData(image, 0, 0);
}

function markOf(kind) {
  return { stable: "M-8 0a8 8 0 1 0 16 0a8 8 0 1 0 -16 0Z", saddle: "M0 -9L9 0L0 9L-9 0Z", maximum: "M0 -9L9 7H-9Z" }[kind]
    || "M-7 -7H7V7H-7Z";
}

function drawLandscape(cell, pointed) {
  const { side, left, bottom, rim } = PLOT;
  const box = html("div", "landscape");
  const table = energyTable(cell, GRID);
  let [low, high] = [Infinity, -Infinity];
  for (const row of table) for (const value of row) { low = Math.min(low, value); high = Math.max(high, value); }
  const canvas = html("canvas");
  canvas.width = canvas.height = 256;
  canvas.setAttribute("aria-hidden", "true");
  const [w, h] = [left + side + rim, rim + side + bottom];
  Object.assign(canvas.style, {
    left: `${100 * left / w}%`, top: `${100 * rim / h}%`, width: `${100 * side / w}%`, height: `${100 * side / h}%`,
  });
  if (high > low) shade(canvas, cell, low, high);
  const kinds = cell.equilibria.map((pose) => pose.kind).join(", ");
  const picture = svg("svg", { viewBox: `0 0 ${w} ${h}`, role: "img", "aria-label": `${landscapeTitle(cell)}; marked: ${kinds}` });
  const plot = svg("g", { transform: `translate(${left} ${rim})` });
  for (let k = 1; k < BANDS && high > low; k += 1) {
    plot.append(svg("path", { class: "contour", d: contour(table, low + (high - low) * k / BANDS, side) }));
  }
  for (const pose of cell.equilibria) {
    if (pose.kind === "saddle") plot.append(svg("path", { class: "contour pass", d: contour(table, levelOf(cell, pose), side) }));
  }
  for (let k = -2; k <= 2; k += 1) {
    const at = side * (k + 2) / 4;
    const text = `${k < 0 ? "−" : ""}${Math.abs(k) * 90}°`;
    plot.append(svg("path", { class: "tick", d: `M${at} ${side}v6M0 ${side - at}h-6` }));
    plot.append(svg("text", { class: "number x", x: at, y: side + 12, dy: ".8em" }, text));
    plot.append(svg("text", { class: "number y", x: -10, y: side - at, dy: ".36em" }, text));
  }
  plot.append(svg("text", { class: "name", x: side / 2, y: side + bottom - 8 }, MECHANISM.unknowns[0]));
  plot.append(svg("text", { class: "name", x: 20 - left, y: side / 2 }, MECHANISM.unknowns[1]));
  plot.append(svg("rect", { class: "frame", width: side, height: side }));
  // an equilibrium at the picture's edge is also at the opposite edge: the angles go round
  const marks = cell.equilibria.map((pose, number) => {
    const [c1, s1, c2, s2] = pose.at;
    const x = (Math.atan2(s1, c1) / Math.PI + 1) / 2 * side;
    const y = (1 - Math.atan2(s2, c2) / Math.PI) / 2 * side;
    const shown = [];
    for (const u of [x - side, x, x + side]) {
      for (const v of [y - side, y, y + side]) {
        if (Math.min(u, v) < -6 || Math.max(u, v) > side + 6) continue;
        const mark = svg("path", {
          class: `equilibrium ${pose.kind}`, transform: `translate(${u.toFixed(1)} ${v.toFixed(1)})`, d: markOf(pose.kind),
        });
        mark.append(svg("title", {}, `${pose.kind}, energy ${pose.energy}`));
        mark.addEventListener("pointerenter", () => pointed(number, true));
        mark.addEventListener("pointerleave", () => pointed(number, false));
        plot.append(mark);
        shown.push(mark);
      }
    }
    return shown;
  });
  picture.append(plot);
  box.append(canvas, picture);
  const redraw = () => { if (high > low) shade(canvas, cell, low, high); };
  return { box, marks, redraw };
}

function landscapeLegend() {
  const list = html("ul", "legend");
  const entries = [["stable", "stable"], ["saddle", "saddle"], ["maximum", "maximum"]];
  for (const [kind, text] of entries) {
    const item = html("li");
    const mark = svg("svg", { class: "swatch", viewBox: "-15 -11 30 22", "aria-hidden": "true" });
    mark.append(svg("path", { class: `equilibrium ${kind}`, d: markOf(kind) }));
    item.append(mark, html("span", "", text));
    list.append(item);
  }
  const pass = html("li");
  const line = svg("svg", { class: "swatch line", viewBox: "0 0 30 18", "aria-hidden": "true" });
  line.append(svg("path", { class: "contour pass", d: "M0 9H30" }));
  pass.append(line, html("span", "", "level of a saddle"), html("small", "", "darker shade: lower"));
  list.append(pass);
  return list;
}
