"use strict";
// The core in WebAssembly, and what is drawn of it.

const PERIOD_US = 20000;
const TICK_S = 0.08;
const VERTICES = 16;
const STILL = { shift_x_m: 0, shift_y_m: 0, velocity_x_m_s: 0, velocity_y_m_s: 0 };
const SLIDERS = [
  ["body_height_m", "Height", 1.5, 2.0, 0.01, 1.79, 2, "m"],
  ["body_mass_kg", "Mass", 40, 130, 0.1, 63.3, 1, "kg"],
  ["speed_m_s", "Speed", 0.3, 1.8, 0.05, 1.2, 2, "m/s"],
  ["heel_strike_deg", "Foot angle at heel strike", 0, 25, 1, 10, 0, "°"],
  ["ticks", "Moment of the stride", 1, 14, 1, 5, 2, "s"],
];
const state = { ...STILL, ankle: 0, held: null };

// ---- the core

const wasm = new WebAssembly.Instance(
  new WebAssembly.Module(Uint8Array.from(atob(element("core").textContent), (c) => c.charCodeAt(0))),
).exports;

function textAt(place) {
  const bytes = new Uint8Array(wasm.memory.buffer, place);
  return new TextDecoder().decode(bytes.subarray(0, bytes.indexOf(0)));
}
const namesAt = (place) => textAt(place).split(" ");
const INPUTS = namesAt(wasm.input_names());
const ROW = namesAt(wasm.row_names());
const PROBE = namesAt(wasm.probe_names());

function setInputs() {
  new Float32Array(wasm.memory.buffer, wasm.inputs(), INPUTS.length).set(INPUTS.map((name) => state[name]));
}

// The planned walk: count rows, each a function name -> number.
function plan(count, periodUs) {
  setInputs();
  const there = wasm.plan(count, periodUs);
  const numbers = new Float32Array(wasm.memory.buffer, wasm.rows(), there * ROW.length).slice();
  return Array.from({ length: there }, (_, i) => (name) => numbers[i * ROW.length + ROW.indexOf(name)]);
}

// The verdict on the moment: a function name -> number, and two polygons.
function probe() {
  setInputs();
  if (!wasm.probe()) return null;
  const numbers = new Float32Array(wasm.memory.buffer, wasm.probed(), PROBE.length + 4 * VERTICES).slice();
  const polygonAt = (first) =>
    Array.from({ length: VERTICES }, (_, i) => [numbers[first + i], numbers[first + VERTICES + i]]);
  const read = (name) => numbers[PROBE.indexOf(name)];
  return { read, bos: polygonAt(PROBE.length), expected: polygonAt(PROBE.length + 2 * VERTICES) };
}

// ---- pictures

const above = new Board(element("above"));
const side = new Board(element("side"));
legend(element("above-legend"), [
  ["foot", COLOURS.left, "left foot (L)"], ["foot", COLOURS.right, "right foot (R)"],
  ["fill", COLOURS.sky, "base of support"], ["dash", COLOURS.blue, "expected at the next heel strike"],
  ["dot", COLOURS.blue, "CoM"], ["diamond", COLOURS.pink, "XCoM"], ["ring", COLOURS.ink, "planned CoM"],
  ["dash", COLOURS.ink, "planned landing"], ["fill", COLOURS.orange, "recovery step"],
]);

function drawAbove({ read, bos, expected }) {
  const wide = Math.max(1.5, Math.min(2.4, above.canvas.clientWidth / 300));
  above.begin(0.15, 0, wide);
  grid(above, 0.25, true);
  above.area(bos, "rgba(86,180,233,.28)");
  above.line(bos, COLOURS.sky, 1.5, [], true);
  above.line(expected, COLOURS.blue, 1.8, [3, 4], true);
  saddleAxes(read);
  SIDES.forEach((name) => {
    const place = [read(`${name}_x_m`), read(`${name}_y_m`)];
    const outline = sole(...place, name);
    if (read(`${name}_contact`)) above.area(outline, COLOURS[name]);
    above.line(outline, COLOURS[name], 2, [], true);
    above.text(name === "left" ? "L" : "R", ...place, COLOURS.ink, "center", 5);
  });
  const swing = SIDES[1 - read("support")];
  above.line(sole(read("landing_x_m"), read("landing_y_m"), swing), COLOURS.ink, 1.5, [5, 4], true);
  drawRecovery(read);
  const com = [read("com_x_m"), read("com_y_m")];
  const xcom = [read("xcom_x_m"), read("xcom_y_m")];
  above.dot(read("plan_com_x_m"), read("plan_com_y_m"), 6, COLOURS.ink, true);
  above.line([com, xcom], COLOURS.pink, 2);
  above.diamond(...xcom, 11, COLOURS.pink);
  above.dot(...com, 11, COLOURS.blue);
}

// x_S and y_S, through the saddle point midway between the feet.
function saddleAxes(read) {
  const left = [read("left_x_m"), read("left_y_m")];
  const right = [read("right_x_m"), read("right_y_m")];
  const middle = [(left[0] + right[0]) / 2, (left[1] + right[1]) / 2];
  const length = Math.hypot(left[0] - right[0], left[1] - right[1]) || 1;
  const y = [(left[0] - right[0]) / length, (left[1] - right[1]) / length];
  const axis = (d, words) => {
    above.line([middle, [middle[0] + 0.3 * d[0], middle[1] + 0.3 * d[1]]], COLOURS.soft, 1.5);
    above.text(words, middle[0] + 0.34 * d[0], middle[1] + 0.34 * d[1], COLOURS.soft, "center", 4);
  };
  axis([y[1], -y[0]], "x_S");
  axis(y, "y_S");
}

function drawRecovery(read) {
  if (!read("recovery_found") || read("level") === 1) return;
  const other = SIDES[1 - read("recovery_foot")];
  const place = [read(`${other}_x_m`) + read("recovery_x_m"), read(`${other}_y_m`) + read("recovery_y_m")];
  const outline = sole(...place, SIDES[read("recovery_foot")]);
  above.area(outline, "rgba(230,159,0,.45)");
  above.line(outline, COLOURS.orange, 3, [], true);
}

function drawSide({ read }) {
  const height = state.body_height_m;
  const tall = height * 1.12;
  side.begin(read("com_x_m"), tall / 2 - 0.1, (side.canvas.clientWidth / side.canvas.clientHeight) * tall);
  grid(side, 0.5, false);
  side.line([[-99, 0], [99, 0]], COLOURS.soft, 2);
  const feet = SIDES.map((name) => ({ x: read(`${name}_x_m`), z: read(`${name}_z_m`), pitch: read(`${name}_pitch_rad`) }));
  drawFigure(side, figure({ x: read("com_x_m"), z: read("com_z_m") }, feet, height));
  side.line([[read("com_x_m"), read("com_z_m")], [read("xcom_x_m"), read("com_z_m")]], COLOURS.pink, 2);
  side.diamond(read("xcom_x_m"), read("com_z_m"), 8, COLOURS.pink);
  side.dot(read("com_x_m"), read("com_z_m"), 8, COLOURS.blue);
}

const CHARTS = {
  height: [["com_z_m", "CoM", COLOURS.blue, ""]],
  feet: [["left_z_m", "left foot", COLOURS.left, ""], ["right_z_m", "right foot", COLOURS.right, "7 4"]],
  scores: [["s_pend", "S_pend", COLOURS.blue, ""], ["s_jump", "S_jump", COLOURS.orange, "7 4"], ["s_sw", "S_SW", COLOURS.left, "2 3"]],
};
const charts = new Map();

function makeChart(key) {
  const box = element(`chart-${key}`);
  const axis = { grid: { stroke: COLOURS.line }, stroke: "#5b6876" };
  const series = CHARTS[key].map(([, label, stroke, dash]) => ({ label, stroke, width: 2, dash: dash.split(" ").map(Number), points: { show: false } }));
  const options = {
    width: box.clientWidth, height: 120, legend: { show: false }, cursor: { show: false },
    scales: { x: { time: false } },
    axes: [{ ...axis, size: 28, values: (_, ticks) => ticks.map((t) => `${t} s`) }, { ...axis, size: 48 }],
    series: [{}, ...series],
  };
  charts.set(key, new uPlot(options, [[], ...series.map(() => [])], box));
  const list = document.createElement("ul");
  list.className = "legend";
  legend(list, CHARTS[key].map(([, label, stroke, dash]) => ["line", stroke, label, dash]));
  box.append(list);
}

function drawCharts(rows) {
  const times = rows.map((_, i) => (i * PERIOD_US) / 1e6);
  for (const [key, chart] of charts) chart.setData([times, ...CHARTS[key].map(([name]) => rows.map((row) => row(name)))]);
}

// ---- words

const VALID = { step: 2, s_sw: 4, mos_com: 8, mos_xcom: 16, stop: 64 };

function why(read) {
  const known = (bit, value) => ((read("valid") & bit) ? value : NOT_AVAILABLE);
  const able = (flag) => (read(flag) ? "the ankles can absorb it" : "more than the ankles can absorb");
  const words = WORDS.reasons[read("driver")] || "";
  return [
    ["driver", "Largest departure", read("margin_known") ? words || "none" : NOT_AVAILABLE],
    ["mos_com", "CoM in the base of support", known(VALID.mos_com, signed(read("mos_com_m"), 3, "m"))],
    ["mos_xcom", "XCoM in the base of support", known(VALID.mos_xcom, signed(read("mos_xcom_m"), 3, "m"))],
    ["ebos_xcom", "XCoM in the expected one", read("compared") ? signed(read("ebos_xcom_m"), 3, "m") : NOT_AVAILABLE],
    ["excess_stop", "Energy beyond standing", known(VALID.stop, `${signed(read("excess_stop_j"), 1, "J")}, ${able("can_stop")}`)],
    ["excess_track", "Energy beyond the plan", read("compared") ? `${signed(read("excess_track_j"), 1, "J")}, ${able("on_track")}` : NOT_AVAILABLE],
    ["s_pend", "S_pend", known(VALID.step, number(read("s_pend"), 2))],
    ["s_jump", "S_jump", known(VALID.step, number(read("s_jump"), 2))],
    ["s_sw", "S_SW", known(VALID.s_sw, number(read("s_sw"), 2))],
    ["recovery", "Recovery step", read("recovery_found") ? `${SIDES[read("recovery_foot")]} foot, ${read("recovery_margin_m").toFixed(2)} m of reach to spare` : `none within reach, ${(-read("recovery_margin_m")).toFixed(2)} m short`],
    ["velocity", "Velocity of the CoM", `${number(read("com_vx_m_s"), 2)}, ${number(read("com_vy_m_s"), 2)} m/s`],
  ];
}

function draw() {
  const rows = plan(110, PERIOD_US);
  const probed = probe();
  if (!probed || !rows.length) {
    const field = textAt(wasm.bad_field());
    showLevel(["unknown", `No walk can be planned for this body: ${field}.`]);
    return;
  }
  const { read } = probed;
  const level = WORDS.levels[read("level")];
  showLevel([level, WORDS.reasons[read("reason")] || WORDS.without_reason[level]]);
  const names = { "balance.margin": "margin", "balance.caution_below": "caution_below" };
  showMargin((name) => read(names[name]), read("margin_known") === 1);
  fill(element("numbers-table"), why(read));
  drawAbove(probed);
  drawSide(probed);
  drawCharts(rows);
  state.probed = probed;
}

// ---- what is moved

function makeSlider([name, label, min, max, step, value, digits, unit]) {
  state[name] = value;
  const row = document.createElement("label");
  row.innerHTML = `<span>${label} <output class="number"></output></span><input type="range" id="${name}" min="${min}" max="${max}" step="${step}" value="${value}">`;
  const [out, input] = [row.querySelector("output"), row.querySelector("input")];
  const show = () => {
    const shown = name === "ticks" ? state.ticks * TICK_S : state[name];
    out.textContent = `${shown.toFixed(digits)} ${unit}`;
  };
  input.oninput = () => { state[name] = Number(input.value); show(); draw(); };
  show();
  element("sliders").append(row);
}

// The velocity that takes the XCoM as far: it lies v / w ahead of the CoM.
function perMetre(read) {
  return read("com_vx_m_s") / (read("xcom_x_m") - read("com_x_m"));
}

function hold(event) {
  const { read } = state.probed;
  const at = { x: event.offsetX, y: event.offsetY };
  const distance = (name) => Math.hypot(above.px(read(`${name}_x_m`)) - at.x, above.py(read(`${name}_y_m`)) - at.y);
  const nearest = distance("com") <= distance("xcom") ? "com" : "xcom";
  if (distance(nearest) > 40) return;
  state.held = { what: nearest, from: above.metres(at.x, at.y), start: { ...state }, perMetre: perMetre(read) };
  above.canvas.setPointerCapture(event.pointerId);
}

function move(what, dx, dy, start, scale) {
  const [x, y] = what === "com" ? ["shift_x_m", "shift_y_m"] : ["velocity_x_m_s", "velocity_y_m_s"];
  const factor = what === "com" ? 1 : scale;
  state[x] = start[x] + factor * dx;
  state[y] = start[y] + factor * dy;
  draw();
}

above.canvas.addEventListener("pointerdown", hold);
above.canvas.addEventListener("pointermove", (event) => {
  if (!state.held) return;
  const { what, from, start, perMetre: scale } = state.held;
  const at = above.metres(event.offsetX, event.offsetY);
  move(what, at.x - from.x, at.up - from.up, start, scale);
});
for (const end of ["pointerup", "pointercancel"]) above.canvas.addEventListener(end, () => { state.held = null; });
above.canvas.addEventListener("keydown", (event) => {
  const ways = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
  const way = ways[event.key];
  if (!way) return;
  event.preventDefault();
  move(event.shiftKey ? "xcom" : "com", way[0] / 100, way[1] / 100, { ...state }, perMetre(state.probed.read));
});

SLIDERS.forEach(makeSlider);
Object.keys(CHARTS).forEach(makeChart);
element("ankle").onchange = () => { state.ankle = Number(element("ankle").value); draw(); };
element("reset").onclick = () => { Object.assign(state, STILL); draw(); };
window.addEventListener("resize", () => {
  for (const [key, chart] of charts) chart.setSize({ width: element(`chart-${key}`).clientWidth, height: 120 });
  draw();
});
setText(element("clock"), `core ${WORDS.version}`);
draw();
