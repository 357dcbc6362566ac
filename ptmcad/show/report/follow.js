// Solutions away from the samples, in floating point: the model's operations with first and second derivatives, Newton's
// method from certified solutions, and descent to the next minimum. Nothing here knows a mechanism by name.

const FOLLOW = DATA.follow;

// Parameters at a point of the map, a rational function of the two axes each.
function parametersAt([x, y]) {
  const sum = (terms) => terms.reduce((total, [i, j, c]) => total + c * x ** i * y ** j, 0);
  return FOLLOW.parameters.map(([above, below]) => sum(above) / sum(below));
}

// The values of all operations, without derivatives.
function valuesAt(parameters, at) {
  const { operations } = FOLLOW;
  const v = new Float64Array(operations.length);
  for (let k = 0; k < operations.length; k += 1) {
    const one = operations[k];
    const kind = one[0];
    const a = one[1];
    if (kind === "*") v[k] = v[a] * v[one[2]];
    else if (kind === "+") v[k] = v[a] + v[one[2]];
    else if (kind === "-") v[k] = v[a] - v[one[2]];
    else if (kind === "=") v[k] = a;
    else if (kind === "p") v[k] = parameters[a];
    else if (kind === "u") v[k] = at[a];
    else if (kind === "c") v[k] = Math.cos(at[a]);
    else if (kind === "s") v[k] = Math.sin(at[a]);
    else v[k] = Math.sqrt(v[a]);
  }
  return v;
}

// Value, gradient and Hessian of all operations: [v, d, h], where h has the rows one after the other.
function jetsAt(parameters, at) {
  const n = FOLLOW.unknowns;
  const v = valuesAt(parameters, at);
  const d = [];
  const h = [];
  const zero = new Float64Array(n);
  const flat = new Float64Array(n * n);
  const unit = (k, slope, second) => {
    const first = new Float64Array(n);
    const curve = new Float64Array(n * n);
    first[k] = slope;
    curve[k * n + k] = second;
    d.push(first);
    h.push(curve);
  };
  const each = (size, entry) => Float64Array.from({ length: size }, (_, k) => entry(k));
  FOLLOW.operations.forEach(([kind, a, b], k) => {
    if (kind === "=" || kind === "p") {
      d.push(zero);
      h.push(flat);
    } else if (kind === "u") unit(a, 1, 0);
    else if (kind === "c") unit(a, -Math.sin(at[a]), -v[k]);
    else if (kind === "s") unit(a, Math.cos(at[a]), -v[k]);
    else if (kind === "r") {
      const [slope, second] = [0.5 / v[k], -0.25 / (v[k] * v[a])];
      d.push(each(n, (i) => slope * d[a][i]));
      h.push(each(n * n, (i) => slope * h[a][i] + second * d[a][Math.floor(i / n)] * d[a][i % n]));
    } else if (kind === "*") {
      d.push(each(n, (i) => v[a] * d[b][i] + v[b] * d[a][i]));
      h.push(each(n * n, (i) => {
        const [row, column] = [Math.floor(i / n), i % n];
        return v[a] * h[b][i] + v[b] * h[a][i] + d[a][row] * d[b][column] + d[a][column] * d[b][row];
      }));
    } else {
      const sign = kind === "+" ? 1 : -1;
      d.push(each(n, (i) => d[a][i] + sign * d[b][i]));
      h.push(each(n * n, (i) => h[a][i] + sign * h[b][i]));
    }
  });
  return [v, d, h];
}

// What vanishes at a solution and its derivatives, by rows; with the values.
function equationsAt(parameters, at) {
  const n = FOLLOW.unknowns;
  const [values, d, h] = jetsAt(parameters, at);
  const source = FOLLOW.force === null ? FOLLOW.energy : FOLLOW.force;
  if (source === null) {
    return { values, residuals: FOLLOW.equations.map((k) => values[k]), jacobian: FOLLOW.equations.map((k) => [...d[k]]) };
  }
  const residuals = [...d[source]];
  const jacobian = residuals.map((_, row) => [...h[source].slice(row * n, row * n + n)]);
  for (const [unknown, k] of FOLLOW.moments) {
    residuals[unknown] -= values[k];
    jacobian[unknown] = jacobian[unknown].map((entry, column) => entry - d[k][column]);
  }
  return { values, residuals, jacobian };
}

// Gaussian elimination with the largest pivot of each column; null where the matrix is singular.
function solveLinear(matrix, right) {
  const n = right.length;
  const rows = matrix.map((row, k) => [...row, right[k]]);
  for (let k = 0; k < n; k += 1) {
    let pivot = k;
    for (let i = k + 1; i < n; i += 1) if (Math.abs(rows[i][k]) > Math.abs(rows[pivot][k])) pivot = i;
    if (!(Math.abs(rows[pivot][k]) > 0)) return null;
    [rows[k], rows[pivot]] = [rows[pivot], rows[k]];
    for (let i = 0; i < n; i += 1) {
      if (i === k) continue;
      const factor = rows[i][k] / rows[k][k];
      for (let j = k; j <= n; j += 1) rows[i][j] -= factor * rows[k][j];
    }
  }
  return rows.map((row, k) => row[n] / row[k]);
}

// The eigenvalues of a symmetric matrix by Jacobi's rotations.
function eigenvalues(symmetric) {
  const a = symmetric.map((row) => [...row]);
  const n = a.length;
  for (let sweep = 0; sweep < 30; sweep += 1) {
    for (let p = 0; p < n; p += 1) {
      for (let q = p + 1; q < n; q += 1) {
        if (a[p][q] === 0) continue;
        const angle = 0.5 * Math.atan2(2 * a[p][q], a[q][q] - a[p][p]);
        const [c, s] = [Math.cos(angle), Math.sin(angle)];
        for (const row of a) [row[p], row[q]] = [c * row[p] - s * row[q], s * row[p] + c * row[q]];
        const [one, two] = [[...a[p]], [...a[q]]];
        for (let k = 0; k < n; k += 1) [a[p][k], a[q][k]] = [c * one[k] - s * two[k], s * one[k] + c * two[k]];
      }
    }
  }
  return a.map((row, k) => row[k]);
}

const turned = (angle) => angle - 2 * Math.PI * Math.ceil(angle / (2 * Math.PI) - 1 / 2 - 1e-9); // half a turn is 180 degrees, not -180

function distance(one, two) {
  return Math.max(...one.map((value, k) => Math.abs(k < FOLLOW.angles ? turned(value - two[k]) : value - two[k])));
}

// Newton's method: a solution with its kind, or null where it does not converge within so many steps.
function newton(parameters, start, most = 16) {
  let at = [...start];
  for (let k = 0; k < most; k += 1) {
    const { values, residuals, jacobian } = equationsAt(parameters, at);
    const step = solveLinear(jacobian, residuals);
    if (!step) return null;
    const length = Math.hypot(...step);
    if (!(length < Infinity)) return null;
    if (length <= 1e-9 * (1 + Math.hypot(...at))) return { at, values, jacobian, ...kindOf(values, jacobian) };
    at = at.map((value, n) => value - step[n] / Math.max(1, length));
  }
  return null;
}

function kindOf(values, jacobian) {
  const counts = FOLLOW.conditions.every((k) => values[k] > 0);
  if (FOLLOW.energy === null) {
    const told = FOLLOW.stability.length > 0;
    const stable = told && FOLLOW.stability.every((k) => values[k] > 0);
    return { counts, index: null, kind: !told ? "solution" : stable ? "stable" : "unstable" };
  }
  const index = eigenvalues(jacobian).filter((value) => value < 0).length;
  return { counts, index, kind: FOLLOW.kinds[index] };
}

// The certified solutions at a cell's sample as unknowns.
function startsOf(cell) {
  return cell.equilibria.map(({ at }) => Array.from({ length: FOLLOW.unknowns }, (_, k) => (
    k < FOLLOW.angles ? Math.atan2(at[2 * k + 1], at[2 * k]) : at[FOLLOW.angles + k])));
}

const differentFrom = (others, at) => others.every((other) => distance(other.at, at) > 1e-6);

// Whether solutions are all of a cell's, as far as its exact counts tell: their number, and how many have each index.
function agree(found, cell) {
  const stable = found.filter((one) => one.kind === "stable").length;
  if (cell.stable !== null && stable !== cell.stable) return false;
  if (FOLLOW.stableOnly) return cell.stable !== null && found.length === stable;
  if (cell.total === null || found.length !== cell.total) return false;
  return !cell.index || FOLLOW.energy === null || cell.index.every((many, k) => found.filter((one) => one.index === k).length === many);
}

// From guesses to different solutions that count.
function refined(point, guesses) {
  const parameters = parametersAt(point);
  const found = [];
  for (const guess of guesses) {
    const one = newton(parameters, guess);
    if (one && one.counts && !(FOLLOW.stableOnly && one.kind !== "stable") && differentFrom(found, one.at)) found.push(one);
  }
  return found;
}

// Along a straight line of the map with solutions that are known at its start; steps are halved where some are lost.
function led(from, to, guesses, cell) {
  let [known, done, step] = [guesses, 0, 0.25];
  let found = [];
  while (done < 1) {
    const next = Math.min(1, done + step);
    found = refined([0, 1].map((k) => from[k] + (to[k] - from[k]) * next), known);
    const ok = found.length === guesses.length && (next < 1 || agree(found, cell));
    if (ok) [known, done, step] = [found.map(({ at }) => at), next, step * 2];
    else if (step > 1 / 64) step /= 2;
    else return found;
  }
  return found;
}

// What has been found in each region, to begin from: the newest first.
const REMEMBERED = 60;
const memory = DATA.regions.map(() => []);

function remember(region, point, found) {
  memory[region].unshift({ point, guesses: found.map(({ at }) => at) });
  memory[region].length = Math.min(memory[region].length, REMEMBERED);
}

function apart(one, two) {
  return Math.hypot(...FOLLOW.window.map(([low, high], k) => (one[k] - two[k]) / (high - low)));
}

// All solutions at a point of a cell: { found, all }, where `all` says that the exact counts are met.
function solutionsAt(point, number) {
  const cell = DATA.cells[number];
  const same = (other) => other.region === cell.region && other.equilibria.length > 0;
  const samples = DATA.cells.filter(same).map((other) => ({ point: other.point, guesses: startsOf(other), own: other === cell }));
  const near = (list) => list.sort((a, b) => apart(a.point, point) - apart(b.point, point));
  const own = samples.filter((start) => start.own);
  const others = [...near([...memory[cell.region]]).slice(0, 4), ...own, ...near(samples.filter((start) => !start.own)).slice(0, 3)];
  let best = [];
  if (agree(best, cell)) return { found: best, all: true };
  for (const start of others) {
    const found = led(start.point, point, start.guesses, cell);
    if (agree(found, cell)) {
      remember(cell.region, point, found);
      return { found, all: true };
    }
    if (found.length > best.length) best = found;
  }
  return { found: best, all: false };
}

// The energy less the moments' work, in which a mechanism descends; moments are taken as steady.
function heightAt(parameters, at) {
  const values = valuesAt(parameters, at);
  return values[FOLLOW.energy] - FOLLOW.moments.reduce((sum, [unknown, k]) => sum + values[k] * at[unknown], 0);
}

// Along the steepest descent by implicit steps, which stay in narrow valleys, to a minimum: the places on the way, the last
// one by Newton's method; null where none is reached.
const STRIDE = 0.05;
function descent(parameters, start) {
  const way = [start];
  let [at, time, height] = [start, 1e-3, heightAt(parameters, start)];
  for (let k = 0; k < 3000; k += 1) {
    const { residuals, jacobian } = equationsAt(parameters, at);
    const shifted = jacobian.map((row, n) => row.map((entry, m) => entry + (n === m ? 1 / time : 0)));
    const downhill = eigenvalues(shifted).every((value) => value > 0);
    const step = downhill ? solveLinear(shifted, residuals) : null;
    const length = step ? Math.hypot(...step) : Infinity;
    const next = step ? at.map((value, n) => value - step[n]) : at;
    const below = step ? heightAt(parameters, next) : Infinity;
    if (!(length <= STRIDE) || below > height + 1e-12 * (1 + Math.abs(height))) {
      time /= 3;
      if (time < 1e-15) return null;
      continue;
    }
    [at, height] = [next, below];
    if (Math.hypot(...at.map((value, n) => value - way[way.length - 1][n])) > STRIDE / 3) way.push(at);
    if (length < STRIDE / 2) time *= 2;
    if (length < 1e-7 && eigenvalues(jacobian).every((value) => value * time > 100)) {
      const end = newton(parameters, at);
      return end && end.kind === "stable" ? { way: [...way, end.at], end } : null;
    }
  }
  return null;
}

// A stable pose along a straight line of the map. Where it vanishes, the descent from there, and on with the next pose.
// Returns { at, snaps }, each snap with its point, the pose before, the way and the pose after; at is null where lost.
function followed(from, to, start) {
  const point = (share) => [0, 1].map((k) => from[k] + (to[k] - from[k]) * share);
  const longest = Math.min(1, 0.02 / Math.max(1e-9, apart(from, to)));
  let [at, done, step] = [start, 0, longest];
  const snaps = [];
  while (done < 1) {
    const next = Math.min(1, done + step);
    const one = newton(parametersAt(point(next)), at);
    if (one && one.kind === "stable" && distance(one.at, at) < 0.15) {
      [at, done, step] = [one.at, next, Math.min(longest, step * 2)];
      continue;
    }
    if (step * apart(from, to) > 1e-5) {
      step /= 2;
      continue;
    }
    const parameters = parametersAt(point(next));
    const fall = descent(parameters, at);
    if (!fall || snaps.length > 8) return { at: null, snaps };
    snaps.push({ point: point(next), before: at, way: fall.way, after: fall.end.at, levels: fall.way.map((place) => heightAt(parameters, place)) });
    [at, done, step] = [fall.end.at, next, longest];
  }
  return { at, snaps };
}
