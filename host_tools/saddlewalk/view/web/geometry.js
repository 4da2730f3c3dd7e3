"use strict";
// Places of the stick figure from what is measured: the CoM and the feet; and a canvas in metres.

// Of the body's height: D. A. Winter, Biomechanics and Motor Control of Human Movement.
const SEGMENTS = { thigh: 0.245, shank: 0.246, ankle: 0.039, trunk: 0.3, neck: 0.03, head: 0.065, hip: 0.04 };
const FOOT = { length: 0.26, width: 0.09, heel: 0.07 }; // m; heel: from its end to the ankle

// Where the knee of a leg from hip to ankle is, bent forward; a leg too short is straight.
function knee(hip, ankle, thigh, shank) {
  const dx = ankle.x - hip.x;
  const dz = ankle.z - hip.z;
  const distance = Math.hypot(dx, dz) || 1e-6;
  const reach = Math.min(distance, thigh + shank);
  const along = (thigh * thigh - shank * shank + reach * reach) / (2 * reach);
  const bent = Math.sqrt(Math.max(thigh * thigh - along * along, 0));
  return {
    x: hip.x + (dx * along) / distance - (dz * bent) / distance,
    z: hip.z + (dz * along) / distance + (dx * bent) / distance,
  };
}

// A foot {x, z, pitch} about its CoP: with the heel up it stands on its toe, with the toe up on its heel.
function footAt(foot, ankleHeight) {
  const behind = -FOOT.length / 2;
  const pivot = foot.pitch > 0 ? behind + FOOT.length : behind;
  const at = (along, up) => ({
    x: foot.x + pivot + (along - pivot) * Math.cos(foot.pitch) + up * Math.sin(foot.pitch),
    z: foot.z - (along - pivot) * Math.sin(foot.pitch) + up * Math.cos(foot.pitch),
  });
  return { heel: at(behind, 0), toe: at(behind + FOOT.length, 0), ankle: at(behind + FOOT.heel, ankleHeight) };
}

// The figure as points {x, z}, found from CoM and feet; feet: of each side {x, z, pitch}.
function figure(com, feet, height) {
  const hip = { x: com.x, z: com.z - SEGMENTS.hip * height };
  const legs = feet.map((foot) => {
    const { heel, toe, ankle } = footAt(foot, SEGMENTS.ankle * height);
    return { hip, heel, toe, ankle, knee: knee(hip, ankle, SEGMENTS.thigh * height, SEGMENTS.shank * height) };
  });
  return { ...trunk(hip, { x: 0, z: 1 }, height), legs };
}

// The figure of joints that are known: the legs' points, and the trunk's direction.
function jointed(legs, up, height) {
  const middle = (axis) => (legs[0].hip[axis] + legs[1].hip[axis]) / 2;
  return { ...trunk({ x: middle("x"), z: middle("z") }, up, height), legs };
}

function trunk(hip, up, height) {
  const at = (length) => ({ x: hip.x + up.x * length * height, z: hip.z + up.z * length * height });
  const { trunk, neck, head } = SEGMENTS;
  return { hip, shoulder: at(trunk), head: at(trunk + neck + head), radius: head * height };
}

// A canvas whose unit is the metre: x to the right and up as given, about a centre.
class Board {
  constructor(canvas) {
    this.canvas = canvas;
    this.context = canvas.getContext("2d");
  }

  begin(centreX, centreUp, metresWide) {
    const ratio = window.devicePixelRatio || 1;
    const width = this.canvas.clientWidth;
    const height = this.canvas.clientHeight;
    if (this.canvas.width !== Math.round(width * ratio) || this.canvas.height !== Math.round(height * ratio)) {
      this.canvas.width = Math.round(width * ratio);
      this.canvas.height = Math.round(height * ratio);
    }
    this.width = width;
    this.height = height;
    this.scale = width / metresWide;
    this.centre = { x: centreX, up: centreUp };
    this.context.setTransform(ratio, 0, 0, ratio, 0, 0);
    this.context.clearRect(0, 0, width, height);
  }

  px(x) { return this.width / 2 + (x - this.centre.x) * this.scale; }
  py(up) { return this.height / 2 - (up - this.centre.up) * this.scale; }
  metres(px, py) {
    return { x: this.centre.x + (px - this.width / 2) / this.scale, up: this.centre.up - (py - this.height / 2) / this.scale };
  }

  path(points, closed) {
    const c = this.context;
    c.beginPath();
    points.forEach(([x, up], index) => (index ? c.lineTo(this.px(x), this.py(up)) : c.moveTo(this.px(x), this.py(up))));
    if (closed) c.closePath();
  }

  line(points, colour, width, dash = [], closed = false) {
    const there = points.filter(([x, up]) => Number.isFinite(x) && Number.isFinite(up));
    if (there.length < 2) return;
    const c = this.context;
    this.path(there, closed);
    c.setLineDash(dash);
    c.strokeStyle = colour;
    c.lineWidth = width;
    c.lineJoin = c.lineCap = "round";
    c.stroke();
    c.setLineDash([]);
  }

  area(points, colour) {
    if (!points.every(([x, up]) => Number.isFinite(x) && Number.isFinite(up))) return;
    this.path(points, true);
    this.context.fillStyle = colour;
    this.context.fill();
  }

  dot(x, up, radius, colour, hollow = false) {
    if (!Number.isFinite(x) || !Number.isFinite(up)) return;
    const c = this.context;
    c.beginPath();
    c.arc(this.px(x), this.py(up), radius, 0, 2 * Math.PI);
    c.fillStyle = hollow ? "#fff" : colour;
    c.fill();
    c.strokeStyle = hollow ? colour : "#fff";
    c.lineWidth = 2;
    c.stroke();
  }

  diamond(x, up, radius, colour) {
    if (!Number.isFinite(x) || !Number.isFinite(up)) return;
    const c = this.context;
    const [px, py] = [this.px(x), this.py(up)];
    c.beginPath();
    c.moveTo(px - radius, py); c.lineTo(px, py - radius); c.lineTo(px + radius, py); c.lineTo(px, py + radius);
    c.closePath();
    c.fillStyle = colour;
    c.fill();
    c.strokeStyle = "#fff";
    c.lineWidth = 2;
    c.stroke();
  }

  // Points up, its tip at the place.
  triangle(x, up, size, colour) {
    if (!Number.isFinite(x) || !Number.isFinite(up)) return;
    const c = this.context;
    const [px, py] = [this.px(x), this.py(up)];
    c.beginPath();
    c.moveTo(px, py); c.lineTo(px + 0.6 * size, py + size); c.lineTo(px - 0.6 * size, py + size);
    c.closePath();
    c.fillStyle = colour;
    c.fill();
    c.strokeStyle = "#fff";
    c.lineWidth = 1.5;
    c.stroke();
  }

  text(words, x, up, colour, align = "center", dy = 0) {
    const c = this.context;
    c.font = "13px system-ui, 'DejaVu Sans', sans-serif";
    c.textAlign = align;
    c.lineWidth = 4;
    c.strokeStyle = "rgba(255,255,255,.9)";
    c.strokeText(words, this.px(x), this.py(up) + dy);
    c.fillStyle = colour;
    c.fillText(words, this.px(x), this.py(up) + dy);
  }

  arrow(fromX, fromUp, toX, toUp, colour) {
    this.line([[fromX, fromUp], [toX, toUp]], colour, 4);
    const angle = Math.atan2(toUp - fromUp, toX - fromX);
    const size = 12 / this.scale;
    const wing = (turn) => [toX - size * Math.cos(angle + turn), toUp - size * Math.sin(angle + turn)];
    this.line([wing(0.45), [toX, toUp], wing(-0.45)], colour, 4);
  }
}
