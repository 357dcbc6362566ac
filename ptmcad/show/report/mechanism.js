// A pose as a drawing: supports, slider, rods, springs, torsion springs, loads. Lengths are in the mechanism's unit, y upwards.

// What is drawn, by the numbers of points: { unknowns, points, rods, springs, loaded, moving, pinned, sliding, rising, torsion }.
const MECHANISM = DATA.mechanism;
// Torsion springs { name, at }: the joint, and the point that the outer end turns to; empty where no joint is known.
const TORSION = MECHANISM.torsion || [];
const nameOf = (ends) => ends.map((point) => MECHANISM.points[point]).join("");

// Inner and outer radius of each spiral, as shares of the size: springs at one joint lie around each other.
const SPIRALS = TORSION.map(({ at }, k) => {
  const before = TORSION.slice(0, k).filter((other) => at.length && other.at[0] === at[0]).length;
  return [0.035 + 0.055 * before, 0.075 + 0.055 * before];
});

function spiral([x, y], [u, v], inner, outer) {
  const end = Math.hypot(u - x, v - y) > 0 ? Math.atan2(v - y, u - x) : Math.PI / 2;
  const steps = 42; // of 24 to a turn
  return Array.from({ length: steps + 1 }, (_, k) => {
    const radius = inner + (outer - inner) * k / steps;
    const angle = end - 2 * Math.PI * (steps - k) / 24;
    return [x + radius * Math.cos(angle), y + radius * Math.sin(angle)];
  });
}
// A name with the unit of what it is of, where the record declares it.
const unitOf = (what) => (DATA.units && DATA.units[what]) || "";
const inBrackets = (name, unit) => (unit ? `${name} (${unit})` : name);
const withUnit = (name, what) => inBrackets(name, unitOf(what));

function loadVectors(cell, size) {
  const most = Math.max(...cell.loads.map((f) => Math.hypot(f[0], f[1])));
  return cell.loads.map((f) => (most > 0 ? [f[0] / most * 0.22 * size, f[1] / most * 0.22 * size] : [0, 0]));
}

// One scale and one horizontal range for all poses of a cell, so that they can be compared: [left, width, size, tall].
// Where one of them is tall, all are as tall as that: a card has a height that it does not exceed, and what is shrunk
// to it is shrunk alike. The range is no narrower than nearly as tall, so that lines are as thick as in other pictures.
function frameOf(cell) {
  let [left, right, low, high] = [Infinity, -Infinity, Infinity, -Infinity];
  for (const pose of cell.equilibria) {
    for (const [x, y] of pose.nodes) {
      [left, right] = [Math.min(left, x), Math.max(right, x)];
      [low, high] = [Math.min(low, y), Math.max(high, y)];
    }
  }
  const size = Math.max(right - left, high - low) || 1;
  for (const pose of cell.equilibria) {
    loadVectors(cell, size).forEach(([fx], k) => {
      const tip = pose.nodes[MECHANISM.loaded[k]][0] + fx;
      [left, right] = [Math.min(left, tip), Math.max(right, tip)];
    });
  }
  const pad = 0.08 * size;
  const wound = size * Math.max(0, ...SPIRALS.map((radii) => radii[1] - 0.075));
  const tall = Math.max(0, ...cell.equilibria.map((pose) => verticalRange(cell, pose, size)[1]));
  const width = Math.max(right - left + 2 * (pad + wound), 0.9 * tall);
  return [(left + right - width) / 2, width, size, tall > 0.65 * width ? tall : 0];
}

// The vertical range of one pose, with its supports and loads: [bottom, height].
function verticalRange(cell, pose, size) {
  const loads = loadVectors(cell, size);
  const feet = [...MECHANISM.pinned, ...MECHANISM.sliding].map((point) => pose.nodes[point][1] - 0.1 * size);
  const wound = TORSION.flatMap(({ at }, k) => (at.length ? [1, -1].map((side) => pose.nodes[at[0]][1] + side * SPIRALS[k][1] * size) : []));
  const heights = [...feet, ...wound, ...pose.nodes.map((node) => node[1]), ...loads.map((f, k) => pose.nodes[MECHANISM.loaded[k]][1] + f[1])];
  const [low, high] = [Math.min(...heights), Math.max(...heights)];
  const pad = 0.06 * size;
  return [low - pad, high - low + 2 * pad];
}

function zigzag([x, y], [u, v], amplitude) {
  const length = Math.hypot(u - x, v - y);
  const across = length > 0 ? [-(v - y) / length, (u - x) / length] : [0, 0];
  const cuts = Math.max(8, 2 * Math.round(0.3 * length / amplitude)); // more on a long spring, so that teeth stay steep
  const points = [[x, y]];
  for (let k = 0; k <= cuts; k += 1) {
    const t = 0.15 + 0.7 * k / cuts;
    const side = k === 0 || k === cuts ? 0 : (k % 2 ? 1 : -1) * Math.min(amplitude, 0.15 * length);
    points.push([x + (u - x) * t + across[0] * side, y + (v - y) * t + across[1] * side]);
  }
  points.push([u, v]);
  return points;
}

function drawPose(cell, pose, frame) {
  const [left, width, size, tall] = frame;
  const [low, own] = verticalRange(cell, pose, size);
  const height = Math.max(own, tall);
  const bottom = low - (height - own) / 2;
  const unit = 240 / width;
  const at = ([x, y]) => [(x - left) * unit, (bottom + height - y) * unit];
  const path = (points) => "M" + points.map((p) => at(p).map((c) => c.toFixed(2)).join(" ")).join("L");
  const picture = svg("svg", {
    viewBox: `0 0 ${(width * unit).toFixed(1)} ${(height * unit).toFixed(1)}`, role: "img",
    "aria-label": `${pose.kind} pose, ${pose.unknowns.map((text, n) => `${MECHANISM.unknowns[n]} = ${text}`).join(", ")}`,
  });
  const nodes = pose.nodes;
  const right = left + width;
  const s = 0.045 * size;
  const line = (points, className) => picture.append(svg("path", { class: className, d: path(points) }));
  for (const y of new Set(MECHANISM.sliding.map((point) => nodes[point][1] - 1.5 * s))) {
    line([[left + 0.02 * size, y], [right - 0.02 * size, y]], "rail");
  }
  for (const [x, y] of MECHANISM.pinned.map((point) => nodes[point])) {
    line([[x, y], [x - s, y - 1.5 * s], [x + s, y - 1.5 * s], [x, y]], "ground");
    for (let k = -1; k <= 1; k += 1) line([[x + k * s, y - 1.5 * s], [x + (k - 0.7) * s, y - 2.2 * s]], "ground");
  }
  const block = (x, y, wide, tall) => {
    const [bx, by] = at([x - wide * s / 2, y + tall * s / 2]);
    picture.append(svg("rect", {
      class: "slider", x: bx.toFixed(2), y: by.toFixed(2), width: (wide * s * unit).toFixed(2), height: (tall * s * unit).toFixed(2),
    }));
  };
  const wheel = (x, y) => {
    const [cx, cy] = at([x, y]);
    picture.append(svg("circle", { class: "slider", cx: cx.toFixed(2), cy: cy.toFixed(2), r: (0.35 * s * unit).toFixed(2) }));
  };
  for (const [x, y] of MECHANISM.sliding.map((point) => nodes[point])) {
    block(x, y, 2.8, 1.6);
    for (const k of [-0.8, 0.8]) wheel(x + k * s, y - 1.15 * s);
  }
  for (const [x, y] of MECHANISM.rising.map((point) => nodes[point])) {
    line([[x - 1.5 * s, y - 2.4 * s], [x - 1.5 * s, y + 2.4 * s]], "rail");
    block(x, y, 1.6, 2.8);
    for (const k of [-0.8, 0.8]) wheel(x - 1.15 * s, y + k * s);
  }
  for (const [a, b] of MECHANISM.springs) line(zigzag(nodes[a], nodes[b], 0.03 * size), "spring");
  for (const [a, b] of MECHANISM.rods) line([nodes[a], nodes[b]], "bar");
  TORSION.forEach(({ at }, k) => {
    const turns = at.length ? spiral(nodes[at[0]], nodes[at[at.length - 1]], ...SPIRALS[k].map((share) => share * size)) : [];
    for (const className of at.length ? ["halo", "spring torsion"] : []) line(turns, className);
  });
  loadVectors(cell, size).forEach((f, k) => {
    const length = Math.hypot(f[0], f[1]);
    if (length === 0) return;
    const [x, y] = nodes[MECHANISM.loaded[k]];
    const [ex, ey] = [f[0] / length, f[1] / length];
    const h = Math.min(0.06 * size, 0.6 * length);
    const tip = [x + f[0], y + f[1]];
    line([[x, y], [tip[0] - ex * h, tip[1] - ey * h]], "load");
    const back = [tip[0] - ex * h, tip[1] - ey * h];
    const head = [tip, [back[0] - ey * h * 0.45, back[1] + ex * h * 0.45], [back[0] + ey * h * 0.45, back[1] - ex * h * 0.45]];
    picture.append(svg("path", { class: "load-head", d: path(head) + "Z" }));
  });
  nodes.forEach((node) => {
    const [cx, cy] = at(node);
    picture.append(svg("circle", { class: "node", cx: cx.toFixed(2), cy: cy.toFixed(2), r: 4.2 }));
  });
  return picture;
}

function springTable(cell) {
  const box = html("div", "scroll");
  box.tabIndex = 0;
  box.setAttribute("role", "region");
  box.setAttribute("aria-label", DATA.drawable ? "Poses in numbers" : "Solutions in numbers");
  const table = html("table", "stacked");
  const head = table.createTHead().insertRow();
  const energy = cell.equilibria.some((pose) => pose.energy) ? [withUnit("energy", "energy")] : [];
  const columns = [DATA.drawable ? "pose" : "solution",
    ...MECHANISM.unknowns.map((name, n) => inBrackets(name, unitOf("unknowns")[n])), ...energy,
    ...MECHANISM.moving.map((point) => withUnit(MECHANISM.points[point], "length"))];
  for (const name of MECHANISM.springs.map(nameOf)) columns.push(withUnit(`length ${name}`, "length"), withUnit(`force ${name}`, "force"));
  for (const { name } of TORSION) columns.push(`deflection ${name}`, withUnit(`moment ${name}`, "energy"));
  for (const text of columns) {
    const th = html("th", "", text);
    th.scope = "col";
    head.append(th);
  }
  const body = table.createTBody();
  for (const pose of cell.equilibria) {
    const row = body.insertRow();
    const entries = [pose.kind, ...pose.unknowns, ...(energy.length ? [pose.energy] : []), ...(pose.places || [])];
    (pose.lengths || []).forEach((length, k) => entries.push(length, pose.forces[k]));
    for (const pair of pose.deflections || []) entries.push(...pair);
    entries.forEach((text, k) => {
      const entry = row.insertCell();
      entry.dataset.label = columns[k];
      entry.append(html("div", "", text));
    });
  }
  box.append(table);
  return box;
}
