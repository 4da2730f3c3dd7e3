"use strict";
// The two pictures: from above and from the side.

const COLOURS = {
  ink: "#1d2733", soft: "#8b96a2", line: "#e6eaee", blue: "#0072b2", sky: "#56b4e9",
  left: "#009e73", right: "#d55e00", orange: "#e69f00", pink: "#b65492",
};
const TRAIL_S = 2.5;
const PUSH_SHOWN_S = 0.6;
const N_S_PER_METRE = 40; // of a dragged arrow
const FAR_M = 0.08; // a recovery step nearer to the planned landing is the planned one
const SIDES = ["left", "right"];

function polygon(read, name, vertices) {
  return Array.from({ length: vertices }, (_, i) => [read(`${name}_x_m.${i}`), read(`${name}_y_m.${i}`)]);
}

// Outline of a foot about its CoP; yaw: its heading.
function sole(x, y, side, yaw = 0) {
  const points = [];
  const inward = side === "left" ? -1 : 1;
  for (let i = 0; i < 24; i++) {
    const angle = (i / 24) * 2 * Math.PI;
    const forward = Math.cos(angle);
    const wide = 1 - 0.22 * (forward < 0 ? -forward : 0);
    const lean = forward > 0 ? 0.008 * inward * forward : 0;
    const [along, across] = [(FOOT.length / 2) * forward, lean + (FOOT.width / 2) * wide * Math.sin(angle)];
    points.push([
      x + along * Math.cos(yaw) - across * Math.sin(yaw),
      y + along * Math.sin(yaw) + across * Math.cos(yaw),
    ]);
  }
  return points;
}

function grid(board, step, horizontal) {
  const half = board.width / 2 / board.scale;
  const c = board.context;
  c.font = "11px system-ui, 'DejaVu Sans', sans-serif";
  c.fillStyle = COLOURS.soft;
  for (let k = Math.ceil((board.centre.x - half) / step); k * step < board.centre.x + half; k++) {
    const x = k * step;
    board.line([[x, board.centre.up - 9], [x, board.centre.up + 9]], COLOURS.line, 1);
    c.textAlign = "center";
    c.fillText(`${x.toFixed(step < 0.5 ? 2 : 1)} m`, board.px(x), board.height - 4);
  }
  if (!horizontal) return;
  const tall = board.height / 2 / board.scale;
  for (let k = Math.ceil((board.centre.up - tall) / step); k * step < board.centre.up + tall; k++) {
    board.line([[board.centre.x - 9, k * step], [board.centre.x + 9, k * step]], COLOURS.line, 1);
  }
}

class Above {
  constructor(canvas) {
    this.board = new Board(canvas);
    this.y = 0;
    this.drag = null; // {x, y} in metres, from the CoM
  }

  draw(ticks, tick, hello) {
    const read = between(ticks, tick);
    const board = this.board;
    if (!read) return;
    const wide = Math.min(3.2, Math.max(1.9, board.canvas.clientWidth / 260));
    const com = { x: read("com_x_m"), y: read("com_y_m") };
    const seen = Number.isFinite(com.x) ? com : { x: 0, y: 0 };
    this.com = com;
    this.heading = read("heading_rad");
    const lead = { x: 0.12 * wide * Math.cos(this.heading), y: 0.12 * wide * Math.sin(this.heading) };
    const y = seen.y + lead.y;
    if (Math.abs(y - this.y) > 0.25) this.y = y - Math.sign(y - this.y) * 0.25;
    board.begin(seen.x + lead.x, this.y, wide);
    grid(board, 0.5, true);
    this.past(ticks, tick);
    board.area(polygon(read, "bos", hello.vertices), "rgba(86,180,233,.28)");
    board.line(polygon(read, "bos", hello.vertices), COLOURS.sky, 1.5, [], true);
    board.line(polygon(read, "ebos", hello.vertices), COLOURS.blue, 1.8, [3, 4], true);
    SIDES.forEach((side) => this.foot(read, side));
    this.steps(read);
    board.dot(read("plan_com_x_m"), read("plan_com_y_m"), 6, COLOURS.ink, true);
    board.triangle(read("reference_cop_x_m"), read("reference_cop_y_m"), 7, COLOURS.blue);
    board.line([[com.x, com.y], [read("xcom_x_m"), read("xcom_y_m")]], COLOURS.pink, 1.5);
    board.diamond(read("xcom_x_m"), read("xcom_y_m"), 8, COLOURS.pink);
    board.dot(com.x, com.y, 8, COLOURS.blue);
    this.push(ticks, tick);
    this.dragged();
  }

  // Trails, and where the feet stood.
  past(ticks, tick) {
    const newest = ticks.row(Math.floor(tick));
    if (!newest) return;
    const now = ticks.reader(newest)("t_s");
    const coms = [];
    const xcoms = [];
    const stood = new Map();
    for (let i = Math.floor(tick); i >= ticks.first; i--) {
      const row = ticks.row(i);
      if (!row) break;
      const read = ticks.reader(row);
      if (now - read("t_s") > TRAIL_S) break;
      coms.push([read("com_x_m"), read("com_y_m")]);
      xcoms.push([read("xcom_x_m"), read("xcom_y_m")]);
      for (const side of SIDES) {
        if (read(`${side}_contact`) !== 1) continue;
        const [x, y] = [read(`${side}_x_m`), read(`${side}_y_m`)];
        stood.set(`${side}${x.toFixed(1)}${y.toFixed(1)}`, [x, y, side, read(`${side}_yaw_rad`)]);
      }
    }
    for (const [x, y, side, yaw] of stood.values()) {
      this.board.area(sole(x, y, side, yaw), side === "left" ? "rgba(0,158,115,.16)" : "rgba(213,94,0,.16)");
    }
    this.board.line(xcoms, COLOURS.pink, 1.2, [2, 4]);
    this.board.line(coms, COLOURS.blue, 2.2);
  }

  foot(read, side) {
    const [x, y] = [read(`${side}_x_m`), read(`${side}_y_m`)];
    if (!Number.isFinite(x)) return;
    const outline = sole(x, y, side, read(`${side}_yaw_rad`));
    if (read(`${side}_contact`) === 1) this.board.area(outline, COLOURS[side]);
    this.board.line(outline, COLOURS[side], 2, [], true);
    this.board.text(side === "left" ? "L" : "R", x, y, read(`${side}_contact`) === 1 ? COLOURS.ink : COLOURS[side], "center", 5);
  }

  // Where the plan lands, and where a recovery step would have to.
  steps(read) {
    const landing = [read("landing_x_m"), read("landing_y_m")];
    const swing = SIDES[1 - read("plan.support")] || "left";
    const yaw = read("landing_yaw_rad");
    if (Number.isFinite(landing[0])) this.board.line(sole(...landing, swing, yaw), COLOURS.ink, 1.5, [5, 4], true);
    if (!recoveryStands(read)) return;
    const place = [read("recovery_x_m"), read("recovery_y_m")];
    const outline = sole(...place, SIDES[read("verdict.recovery_foot")], Number.isFinite(yaw) ? yaw : this.heading);
    this.board.area(outline, "rgba(230,159,0,.45)");
    this.board.line(outline, COLOURS.orange, 3, [], true);
    this.board.text("recovery step", place[0], place[1], COLOURS.ink, "center", 34);
  }

  push(ticks, tick) {
    const last = Math.floor(tick);
    const impulse = [0, 0];
    const now = ticks.row(last) && ticks.reader(ticks.row(last))("t_s");
    for (let i = last; i >= ticks.first && ticks.row(i); i--) {
      const read = ticks.reader(ticks.row(i));
      if (now - read("t_s") > PUSH_SHOWN_S) break;
      impulse[0] += read("truth.push_x_n_s");
      impulse[1] += read("truth.push_y_n_s");
    }
    const size = Math.hypot(...impulse);
    if (size < 0.05 || !Number.isFinite(this.com.x)) return;
    const tail = [this.com.x - (0.4 * impulse[0]) / size, this.com.y - (0.4 * impulse[1]) / size];
    this.board.arrow(...tail, this.com.x, this.com.y, COLOURS.pink);
    this.board.text(`push ${size.toFixed(1)} N·s`, ...tail, COLOURS.ink, "center", impulse[1] > 0 ? 18 : -10);
  }

  dragged() {
    if (!this.drag) return;
    const [x, y] = impulseOf(this.drag, this.heading);
    this.board.arrow(this.com.x, this.com.y, this.com.x + this.drag.x, this.com.y + this.drag.y, COLOURS.pink);
    this.board.text(`${Math.hypot(x, y).toFixed(1)} N·s`, this.com.x + this.drag.x, this.com.y + this.drag.y, COLOURS.ink, "center", -12);
  }
}

// The push of a dragged arrow, in N s, forward and to the left in that heading.
function impulseOf(drag, heading) {
  const [c, s] = [Math.cos(heading), Math.sin(heading)];
  return [(drag.x * c + drag.y * s) * N_S_PER_METRE, (drag.y * c - drag.x * s) * N_S_PER_METRE];
}

// Places as seen from the side of the walked way: x along it, in the heading of the pelvis.
function alongTheWay(ticks, read) {
  const [c, s] = [Math.cos(read("heading_rad")), Math.sin(read("heading_rad"))];
  return (name) => {
    const across = name.replace(/_x_m$/, "_y_m");
    if (across === name || !ticks.column.has(across)) return read(name);
    const [dx, dy] = [read(name) - read("com_x_m"), read(across) - read("com_y_m")];
    return read("walked_m") + dx * c + dy * s;
  };
}

// There is a recovery step, and it is not the planned one.
function recoveryStands(read) {
  if (read("verdict.recovery_found") !== 1) return false;
  const apart = Math.hypot(read("recovery_x_m") - read("landing_x_m"), read("recovery_y_m") - read("landing_y_m"));
  return !(apart < FAR_M) && read("verdict.level") !== 1;
}

function drawFigure(board, body) {
  [1, 0].forEach((side) => {
    const leg = body.legs[side];
    const colour = COLOURS[SIDES[side]];
    board.line([leg.hip, leg.knee, leg.ankle].map((p) => [p.x, p.z]), colour, 6);
    board.line([leg.heel, leg.toe, leg.ankle, leg.heel].map((p) => [p.x, p.z]), colour, 4);
    for (const joint of [leg.hip, leg.knee, leg.ankle]) board.dot(joint.x, joint.z, 5, colour, true);
  });
  board.line([[body.hip.x, body.hip.z], [body.shoulder.x, body.shoulder.z]], COLOURS.ink, 7);
  board.dot(body.head.x, body.head.z, body.radius * board.scale, COLOURS.ink);
}

class Side {
  constructor(canvas) {
    this.board = new Board(canvas);
  }

  draw(ticks, tick, hello) {
    const inWorld = between(ticks, tick);
    if (!inWorld) return;
    const read = alongTheWay(ticks, inWorld);
    const board = this.board;
    const height = hello.body_height_m || 1.75;
    const tall = height * 1.12;
    const wide = (board.canvas.clientWidth / board.canvas.clientHeight) * tall;
    const x = Number.isFinite(read("com_x_m")) ? read("com_x_m") : 0;
    board.begin(x, tall / 2 - 0.1, wide);
    grid(board, 0.5, false);
    board.line([[x - 9, 0], [x + 9, 0]], COLOURS.soft, 2);
    this.planned(read, height);
    this.reference(read);
    this.measured(read, height);
  }

  // The pendulum to balance by: from its CoP to its CoM, at the planned height.
  reference(read) {
    const [cop, com, z] = [read("reference_cop_x_m"), read("reference_com_x_m"), read("plan_com_z_m")];
    this.board.line([[cop, 0], [com, z]], COLOURS.blue, 1.5, [2, 3]);
    this.board.triangle(cop, 0, 9, COLOURS.blue);
  }

  planned(read, height) {
    const com = { x: read("plan_com_x_m"), z: read("plan_com_z_m") };
    if (!Number.isFinite(com.x)) return;
    const feet = SIDES.map((side) => ({
      x: read(`plan_${side}_x_m`), z: read(`plan_${side}_z_m`), pitch: read(`plan_${side}_pitch_rad`),
    }));
    const body = figure(com, feet, height);
    const dash = [4, 5];
    for (const leg of body.legs) {
      this.board.line([leg.hip, leg.knee, leg.ankle].map((p) => [p.x, p.z]), COLOURS.soft, 1.5, dash);
      this.board.line([leg.heel, leg.toe].map((p) => [p.x, p.z]), COLOURS.soft, 1.5, dash);
    }
    this.board.line([[body.hip.x, body.hip.z], [body.shoulder.x, body.shoulder.z]], COLOURS.soft, 1.5, dash);
    this.board.dot(com.x, com.z, 6, COLOURS.ink, true);
  }

  measured(read, height) {
    const com = { x: read("com_x_m"), z: read("com_z_m") };
    if (!Number.isFinite(com.z)) return;
    const legs = this.joints(read);
    const up = { x: read("trunk_up_x"), z: read("trunk_up_z") };
    const body = legs ? jointed(legs, up, height) : figure(com, this.feet(read), height);
    drawFigure(this.board, body);
    this.board.dot(com.x, com.z, 8, COLOURS.blue);
  }

  // Of a body whose joints are known; else null.
  joints(read) {
    const legs = SIDES.map((side) => Object.fromEntries(
      ["hip", "knee", "ankle", "heel", "toe"].map((joint) => [
        joint, { x: read(`${side}_${joint}_x_m`), z: read(`${side}_${joint}_z_m`) },
      ]),
    ));
    return Number.isFinite(legs[0].hip.z) ? legs : null;
  }

  feet(read) {
    return SIDES.map((side) => {
      const planned = [read(`plan_${side}_z_m`), read(`plan_${side}_pitch_rad`)];
      const lifted = read(`${side}_contact`) !== 1 && Number.isFinite(planned[0]);
      const pitched = Number.isFinite(planned[0]);
      return { x: read(`${side}_x_m`), z: lifted ? planned[0] : 0, pitch: pitched ? planned[1] : 0 };
    });
  }
}

const SWATCHES = {
  fill: (colour) => `<rect x="4" y="1" width="18" height="10" fill="${colour}" fill-opacity=".35" stroke="${colour}"/>`,
  dash: (colour) => `<rect x="4" y="1" width="18" height="10" fill="none" stroke="${colour}" stroke-width="1.6" stroke-dasharray="3 3"/>`,
  foot: (colour) => `<ellipse cx="13" cy="6" rx="11" ry="5" fill="${colour}"/>`,
  dot: (colour) => `<circle cx="13" cy="6" r="5" fill="${colour}"/>`,
  triangle: (colour) => `<path d="M13 1 19 11H7Z" fill="${colour}"/>`,
  ring: (colour) => `<circle cx="13" cy="6" r="4.5" fill="#fff" stroke="${colour}" stroke-width="2"/>`,
  diamond: (colour) => `<path d="M7 6 13 0 19 6 13 12Z" fill="${colour}"/>`,
  line: (colour, dash) => `<path d="M1 6H25" stroke="${colour}" stroke-width="2.5" stroke-dasharray="${dash || ""}"/>`,
};

function legend(list, entries) {
  list.innerHTML = entries
    .map(([kind, colour, words, dash]) => `<li><svg viewBox="0 0 26 12" aria-hidden="true">${SWATCHES[kind](colour, dash)}</svg>${words}</li>`)
    .join("");
}

const ABOVE_LEGEND = [
  ["foot", COLOURS.left, "left foot (L)"], ["foot", COLOURS.right, "right foot (R)"],
  ["fill", COLOURS.sky, "base of support"], ["dash", COLOURS.blue, "expected at the next heel strike"],
  ["dot", COLOURS.blue, "CoM"], ["diamond", COLOURS.pink, "XCoM, where the body is heading"],
  ["ring", COLOURS.ink, "planned CoM"], ["dash", COLOURS.ink, "planned landing"],
  ["triangle", COLOURS.blue, "planned CoP, to balance by"],
  ["fill", COLOURS.orange, "recovery step"],
];
const SIDE_LEGEND = [
  ["line", COLOURS.left, "left leg"], ["line", COLOURS.right, "right leg"],
  ["dot", COLOURS.blue, "CoM, measured"], ["line", COLOURS.soft, "planned", "4 4"],
  ["triangle", COLOURS.blue, "planned CoP, to balance by"],
];
