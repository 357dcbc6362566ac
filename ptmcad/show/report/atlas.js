// The chosen member large, its sliders, and areas, widths and optima against one parameter, the others being as chosen.

const SWEPT = DATA.swept, MEMBERS = DATA.members;
const byPlace = new Map(MEMBERS.map((member) => [member.p.join(), member]));
const buttons = new Map([...document.querySelectorAll("button.small")].map((button) => [Number(button.dataset.m), button]));
const state = { place: MEMBERS.length ? [...MEMBERS[0].p] : [], against: 0 };
const sheet = document.getElementById("sheet");

if (DATA.columns) {
  sheet.classList.add("table");
  sheet.style.gridTemplateColumns = `repeat(${DATA.columns}, clamp(1.75rem, calc((min(100vw, 76rem) - 2.5rem) / ${DATA.columns} - 3px), 6.5rem))`;
}

const digits = (value) => Number(value.toPrecision(6)).toString();

function fact(text, className) {
  document.getElementById("facts").append(html("p", className, text));
}

function showFacts(member) {
  const facts = document.getElementById("facts");
  facts.replaceChildren();
  fact(SWEPT.map((swept, k) => `${swept.name} = ${swept.texts[state.place[k]]}`).join(", "), "which");
  if (!member) return fact("The sweep has no member with these values: choose one on the sheet.");
  if (member.e !== undefined) return fact(`Member ${member.n} has no map. ${member.e}`);
  fact(`Member ${member.n}: ${member.r} ${member.r === 1 ? "region" : "regions"}, counted by ${DATA.counted}`);
  const areas = DATA.counts.map((count, k) => [count, member.a[k]]).filter(([, area]) => area);
  if (areas.length) fact(`Area: ${areas.map(([count, area]) => `${digits(area)} with ${count}`).join(", ")}`);
  if (member.w !== undefined)
    fact(`Widest operation range along ${DATA.along}: ${digits(member.w)}, ${member.s}`);
  else if (DATA.along) fact(`No operation range along ${DATA.along} is known`);
  const line = html("p"), link = html("a", "", member.f);
  link.href = member.f;
  line.append("Result: ", link);
  facts.append(line);
}

function show() {
  const member = byPlace.get(state.place.join());
  const large = document.getElementById("large");
  const button = member && buttons.get(member.n);
  const drawn = button && button.querySelector("svg");
  large.replaceChildren(...(drawn ? [...drawn.childNodes].map((node) => node.cloneNode(true)) : []));
  large.setAttribute("aria-label", member ? `Region map, ${button.getAttribute("aria-label")}` : "No map");
  for (const [number, other] of buttons) other.setAttribute("aria-pressed", String(!!member && number === member.n));
  SWEPT.forEach((swept, k) => {
    const input = document.getElementById(`slider-${k}`);
    input.value = state.place[k];
    input.setAttribute("aria-valuetext", swept.texts[state.place[k]]);
    document.getElementById(`value-${k}`).textContent = swept.texts[state.place[k]];
  });
  showFacts(member);
  drawCurves();
}

function makeSliders() {
  SWEPT.forEach((swept, k) => {
    const row = html("div", "slider"), label = html("label", "", swept.name), value = html("output");
    const input = html("input");
    Object.assign(input, { type: "range", min: 0, max: swept.texts.length - 1, step: 1, id: `slider-${k}` });
    label.htmlFor = input.id;
    value.id = `value-${k}`;
    input.addEventListener("input", () => {
      state.place[k] = Number(input.value);
      show();
    });
    row.append(label, input, value);
    document.getElementById("sliders").append(row);
    if (SWEPT.length < 2) return;
    const button = html("button", "", swept.name);
    button.type = "button";
    button.addEventListener("click", () => {
      state.against = k;
      show();
    });
    document.getElementById("against").append(button);
  });
  if (SWEPT.length > 1) document.getElementById("against").prepend(html("span", "hint", "Curves against"));
}

// members on the line of the chosen one, in the order of the parameter that varies
function line() {
  const k = state.against, found = [];
  for (let place = 0; place < SWEPT[k].texts.length; place++) {
    const at = [...state.place];
    at[k] = place;
    const member = byPlace.get(at.join());
    if (member) found.push([SWEPT[k].values[place], member, place]);
  }
  return found;
}

const WIDE = 560, HIGH = 190, LEFT_ROOM = 62, FOOT = 30, TOP = 12, RIM = 14;

// round numbers within a span, four at most
function ticks(low, high) {
  const rough = (high - low) / 4, power = 10 ** Math.floor(Math.log10(rough));
  const step = power * [1, 2, 2.5, 5, 10].find((factor) => factor * power >= rough);
  const found = [];
  for (let k = Math.ceil(low / step); k * step <= high; k++) found.push(k * step);
  return found;
}

function curve(title, series, members) {
  const points = series.flatMap(({ of }) => members.flatMap(([x, member]) => of(member).flat().map((y) => [x, y])));
  if (!points.length) return;
  const span = (values) => {
    const low = Math.min(...values), high = Math.max(...values), room = (high - low) * 0.05 || Math.abs(high) * 0.1 || 1;
    return [low - room, high + room];
  };
  const xs = SWEPT[state.against].values, [x0, x1] = xs.length > 1 ? [Math.min(...xs), Math.max(...xs)] : span(xs);
  const [y0, y1] = span(points.map(([, y]) => y));
  const across = (x) => LEFT_ROOM + (WIDE - LEFT_ROOM - RIM) * (x - x0) / (x1 - x0);
  const up = (y) => HIGH - FOOT - (HIGH - FOOT - TOP) * (y - y0) / (y1 - y0);
  const figure = html("figure", "curve"), caption = html("figcaption", "", `${title}, against ${SWEPT[state.against].name}`);
  const picture = svg("svg", { viewBox: `0 0 ${WIDE} ${HIGH}`, role: "img", "aria-label": `${title} against ${SWEPT[state.against].name}` });
  picture.append(svg("path", { class: "axis-line", d: `M${LEFT_ROOM} ${TOP}V${HIGH - FOOT}H${WIDE - RIM}` }));
  const short = (value) => Number(value.toPrecision(6)).toString();
  for (const y of ticks(y0, y1)) {
    picture.append(svg("path", { class: "axis-line", d: `M${LEFT_ROOM - 4} ${up(y).toFixed(1)}h4` }));
    picture.append(svg("text", { x: LEFT_ROOM - 7, y: (up(y) + 4).toFixed(1), "text-anchor": "end" }, short(y)));
  }
  for (const x of ticks(x0, x1)) {
    picture.append(svg("path", { class: "axis-line", d: `M${across(x).toFixed(1)} ${HIGH - FOOT}v4` }));
    picture.append(svg("text", { x: across(x).toFixed(1), y: HIGH - FOOT + 20, "text-anchor": "middle" }, short(x)));
  }
  const now = across(xs[state.place[state.against]]);
  picture.append(svg("path", { class: "now", d: `M${now.toFixed(1)} ${TOP}V${HIGH - FOOT}` }));
  series.forEach(({ name, of, joined }, s) => {
    let data = "", open = false;
    for (const [x, member] of members) {
      const values = of(member);
      if (joined && values.length) data += `${open ? "L" : "M"}${across(x).toFixed(1)} ${up(values[0]).toFixed(1)}`;
      open = joined && values.length > 0;
      for (const place of values.filter(Array.isArray))
        picture.append(svg("path", { class: `series s${s % 8}`, d: `M${across(x).toFixed(1)} ${up(place[0]).toFixed(1)}V${up(place.at(-1)).toFixed(1)}` }));
      for (const y of values.flat())
        picture.append(svg("circle", { class: `dot d${s % 8}`, cx: across(x).toFixed(1), cy: up(y).toFixed(1), r: 2.6 }));
    }
    picture.append(svg("path", { class: `series s${s % 8}`, d: data }));
    if (series.length > 1) {
      const key = html("span", "key", name), mark = svg("svg", { viewBox: "0 0 22 10", "aria-hidden": "true" });
      mark.append(svg("path", { class: `series s${s % 8}`, d: "M0 5H22" }));
      key.prepend(mark);
      caption.append(key);
    }
  });
  for (const [x, , place] of members) {
    const half = (WIDE - LEFT_ROOM - RIM) / Math.max(members.length - 1, 1) / 2;
    const hit = svg("rect", { class: "hit", x: (across(x) - half).toFixed(1), y: TOP, width: (2 * half).toFixed(1), height: HIGH - FOOT - TOP });
    hit.addEventListener("click", () => {
      state.place[state.against] = place;
      show();
    });
    picture.append(hit);
  }
  figure.append(caption, picture);
  document.getElementById("curves").append(figure);
}

function drawCurves() {
  document.getElementById("curves").replaceChildren();
  [...document.querySelectorAll("#against button")].forEach((button, k) => button.setAttribute("aria-pressed", String(k === state.against)));
  const members = line();
  curve("Area by count", DATA.counts.map((count, k) => ({
    name: `${DATA.counted}: ${count}`, joined: true,
    of: (member) => member.a && member.a[k] !== null ? [member.a[k]] : [],
  })), members);
  if (!DATA.along) return;
  curve(`Widest operation range along ${DATA.along}`, [{ name: "", joined: true, of: (member) => member.w === undefined ? [] : [member.w] }], members);
  curve(`Where the range is widest: ${DATA.over}`, [{ name: "", joined: false, of: (member) => member.at || [] }], members);
}

for (const [number, button] of buttons)
  button.addEventListener("click", () => {
    state.place = [...MEMBERS.find((member) => member.n === number).p];
    show();
    document.getElementById("map").scrollIntoView({ block: "start" });
  });

if (MEMBERS.length) {
  makeSliders();
  show();
}
