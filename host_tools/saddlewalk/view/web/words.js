"use strict";
// A tick in words and numbers.

const SIGNS = {
  stable: ["M50 4A46 46 0 1 0 50 96A46 46 0 1 0 50 4Z", "✓"],
  caution: ["M50 6 98 92H2Z", "!"],
  unstable: ["M31 4H69L96 31V69L69 96H31L4 69V31Z", "!"],
  fell: ["M31 4H69L96 31V69L69 96H31L4 69V31Z", "×"],
  unknown: ["M14 4H86Q96 4 96 14V86Q96 96 86 96H14Q4 96 4 86V14Q4 4 14 4Z", "?"],
};
const METER = { low: -0.3, high: 1.5 };
const SILENT_S = 1.0;
const NOT_AVAILABLE = "n/a";

const element = (id) => document.getElementById(id);

function setText(node, words) {
  if (node.textContent !== words) node.textContent = words;
}

function number(value, digits, unit = "") {
  return Number.isFinite(value) ? `${value.toFixed(digits)}${unit && ` ${unit}`}` : NOT_AVAILABLE;
}

function signed(value, digits, unit = "") {
  return Number.isFinite(value) && value >= 0 ? `+${number(value, digits, unit)}` : number(value, digits, unit);
}

function age(microseconds) {
  if (!Number.isFinite(microseconds)) return "never";
  return microseconds < 1e7 ? `${(microseconds / 1e3).toFixed(0)} ms ago` : `${(microseconds / 1e6).toFixed(0)} s ago`;
}

const bits = (value, names) => names.filter((_, bit) => (Math.round(value || 0) >> bit) & 1);

// [level, sentence] of a tick; null: nothing was heard.
function announced(read, hello, silentS) {
  if (!read) return ["unknown", hello.live ? "No message from the firmware yet." : "Loading …"];
  if (silentS > SILENT_S) return ["unknown", `No message from the firmware for ${silentS.toFixed(0)} s.`];
  if (read("truth.fallen") === 1) return ["fell", "The wearer is on the ground."];
  const level = hello.levels[read("verdict.level")] || "unknown";
  return [level, hello.reasons[read("verdict.reason")] || hello.without_reason[level] || ""];
}

function showLevel([level, sentence]) {
  element("verdict").dataset.level = level;
  setText(element("level"), level);
  setText(element("reason"), sentence);
  const [shape, mark] = SIGNS[level] || SIGNS.unknown;
  element("sign-shape").setAttribute("d", shape);
  setText(element("sign-mark"), mark);
}

function showMargin(read, known) {
  const margin = known ? read("balance.margin") : NaN;
  const caution = known ? read("balance.caution_below") : NaN;
  setText(element("margin"), number(margin, 3));
  const place = (value) => (100 * (Math.min(Math.max(value, METER.low), METER.high) - METER.low)) / (METER.high - METER.low);
  element("meter-unstable").style.width = `${place(0)}%`;
  element("meter-caution").style.left = `${place(0)}%`;
  element("meter-caution").style.width = `${Math.max(place(caution) - place(0), 0) || 0}%`;
  element("meter-mark").style.left = `${place(margin) || 0}%`;
  element("meter-mark").style.visibility = Number.isFinite(margin) ? "visible" : "hidden";
  setText(element("margin-words"), Number.isFinite(margin) ? `unstable at 0, caution below ${caution.toFixed(3)}` : "not known");
}

function gait(read, hello) {
  if (read("plan.valid") !== 1) return "none";
  const mode = hello.modes[read("plan.mode")] || NOT_AVAILABLE;
  const strike = read("plan.time_to_heel_strike_s");
  return `${mode}, step ${read("plan.step_count")}` + (strike < hello.time_max_s ? `, heel strike in ${strike.toFixed(2)} s` : "");
}

function recovery(read) {
  if (read("verdict.compared") !== 1) return NOT_AVAILABLE;
  const margin = read("verdict.recovery_margin_m");
  if (read("verdict.recovery_found") !== 1) return `none within reach, ${(-margin).toFixed(2)} m short`;
  const side = SIDES[read("verdict.recovery_foot")];
  return `${side} foot, ${margin.toFixed(2)} m of reach to spare`;
}

// Scores and verdicts mean nothing of a body on the ground.
function upright(read) {
  const fallen = read("truth.fallen") === 1;
  return (name) => (fallen && /^(scores|verdict|balance)\./.test(name) ? NaN : read(name));
}

// [key, label, value]; key: what a test reads.
function numbersOf(row, hello) {
  const read = upright(row);
  return [
    ["plan", "Plan", gait(read, hello)],
    ["s_pend", "S_pend", number(read("scores.s_pend"), 2)],
    ["s_jump", "S_jump", number(read("scores.s_jump"), 2)],
    ["s_sw", "S_SW", number(read("scores.s_sw"), 2)],
    ["mos_com", "CoM in the base of support", signed(read("scores.mos_com_m"), 3, "m")],
    ["mos_xcom", "XCoM in the base of support", signed(read("scores.mos_xcom_m"), 3, "m")],
    ["ebos_xcom", "XCoM in the expected one", signed(read("verdict.ebos_xcom_m"), 3, "m")],
    ["recovery", "Recovery step", recovery(read)],
    ["excess_stop", "Energy beyond standing", signed(read("verdict.excess_stop_j"), 1, "J")],
    ["speed", "Forward speed", number(read("com_vx_m_s"), 2, "m/s")],
    ["height", "Height of the CoM", number(read("com_z_m"), 3, "m")],
  ];
}

function commands(read, hello) {
  const source = read("status.command_source");
  if (!source) return "nobody";
  const who = hello.commander ? `, ${hello.commander}` : "";
  return `${hello.sources[source] || source}${who}, ${age(read("input.command_age_us"))}`;
}

function link(state, name, hello) {
  return `${name} ${hello.links[state] || NOT_AVAILABLE}`;
}

// [key, label, value, bad]
function healthOf(read, hello) {
  const faults = bits(read("health.faults"), hello.faults);
  const missing = (part) => faults.some((fault) => fault.startsWith(part));
  const down = [read("status.can_link"), read("status.lcm_link")].some((state) => state > 1);
  const rejected = read("status.rejected");
  const dropped = read("status.dropped");
  const late = read("health.late_ticks");
  const rows = [
    ["commander", "Who commands", commands(read, hello), faults.includes("COMMAND_STALE")],
    ["com_age", "CoM measured", age(read("input.com_age_us")), missing("COM_") && !faults.every((f) => f === "COMMAND_STALE")],
    ["left_age", "Left foot measured", age(read("input.left_age_us")), missing("LEFT_")],
    ["right_age", "Right foot measured", age(read("input.right_age_us")), missing("RIGHT_")],
    ["period", "Tick", `every ${number(read("status.period_us") / 1e3, 1, "ms")}, ${number(read("health.latency_us") / 1e3, 2, "ms")} late, worst ${number(read("status.latency_max_us") / 1e3, 2, "ms")}`, false],
    ["late", "Ticks late, missed", `${number(late, 0)}, ${number(read("status.missed_ticks"), 0)}`, late > 0],
    ["links", "Bus", `${link(read("status.can_link"), `CAN by ${hello.transports[read("status.can_transport")] || NOT_AVAILABLE}`, hello)}, ${link(read("status.lcm_link"), "LCM", hello)}`, down],
    ["rejected", "Frames and commands rejected", number(rejected, 0), rejected > 0],
    ["dropped", "Messages dropped", number(dropped, 0), dropped > 0],
    ["faults", "Faults", faults.join(" ").replaceAll("_", " ").toLowerCase() || "none", faults.length > 0],
  ];
  if (bits(read("health.limits"), hello.limits).includes("SAFE_STOP")) {
    rows.push(["safe_stop", "Safe stop", "inputs are missing, the walk ends", true]);
  }
  return rows;
}

// Rows of a table, which are kept and only change their words.
function fill(table, rows) {
  rows.forEach(([key, label, value, bad], index) => {
    let row = table.rows[index];
    if (!row) {
      row = table.insertRow();
      row.insertCell();
      row.insertCell();
    }
    row.dataset.key = key;
    row.className = bad ? "bad" : "";
    setText(row.cells[0], label);
    setText(row.cells[1], value);
  });
  while (table.rows.length > rows.length) table.deleteRow(-1);
}
