"use strict";
// Strips of the last seconds, by uPlot.

const WINDOW_S = 20;
const SERIES = {
  margin: [
    { name: "balance.margin", label: "margin", stroke: COLOURS.blue, width: 2 },
    { name: "balance.caution_below", label: "caution below", stroke: COLOURS.orange, width: 1.5, dash: [6, 4] },
  ],
  scores: [
    { name: "scores.s_pend", label: "S_pend", stroke: COLOURS.blue, width: 2 },
    { name: "scores.s_jump", label: "S_jump", stroke: COLOURS.orange, width: 2, dash: [7, 4] },
    { name: "scores.s_sw", label: "S_SW", stroke: COLOURS.left, width: 2, dash: [2, 3] },
  ],
  speed: [
    { name: "com_vx_m_s", label: "measured", stroke: COLOURS.blue, width: 2 },
    { name: "plan.speed_m_s", label: "planned", stroke: COLOURS.ink, width: 1.5, dash: [7, 4] },
    { name: "input.speed_m_s", label: "commanded", stroke: COLOURS.orange, width: 1.5, dash: [2, 3] },
  ],
};
const RANGES = { margin: [-0.4, 1.6], scores: [-0.5, 1.6], speed: [-0.3, 2.0] };

class Charts {
  constructor() {
    this.plots = new Map();
    this.lists = new Map();
    for (const key of Object.keys(SERIES)) this.make(key);
    window.addEventListener("resize", () => this.resize());
  }

  make(key) {
    const box = document.getElementById(`chart-${key}`);
    const [low, high] = RANGES[key];
    const plot = new uPlot(
      {
        width: box.clientWidth,
        height: 130,
        cursor: { show: false },
        legend: { show: false },
        scales: { x: { time: false }, y: { range: [low, high] } },
        axes: [
          { size: 28, values: (_, ticks) => ticks.map((t) => `${t} s`), grid: { stroke: COLOURS.line }, stroke: "#5b6876" },
          { size: 44, grid: { stroke: COLOURS.line }, stroke: "#5b6876" },
        ],
        series: [{}, ...SERIES[key].map((each) => ({ ...each, points: { show: false } }))],
        hooks: { drawClear: [(u) => this.shade(u, key)], draw: [(u) => this.mark(u)] },
      },
      [[], ...SERIES[key].map(() => [])],
      box,
    );
    const list = document.createElement("ul");
    list.className = "legend";
    legend(list, SERIES[key].map((each) => ["line", each.stroke, each.label, (each.dash || []).join(" ")]));
    box.append(list);
    this.plots.set(key, plot);
  }

  resize() {
    for (const [key, plot] of this.plots) {
      plot.setSize({ width: document.getElementById(`chart-${key}`).clientWidth, height: 130 });
    }
  }

  // Below 0, the limit of each of them but speed.
  shade(u, key) {
    if (key === "speed") return;
    const zero = u.valToPos(0, "y", true);
    u.ctx.save();
    u.ctx.fillStyle = "rgba(213,94,0,.12)";
    u.ctx.fillRect(u.bbox.left, zero, u.bbox.width, u.bbox.top + u.bbox.height - zero);
    u.ctx.restore();
  }

  // The moment that is shown.
  mark(u) {
    const x = u.valToPos(this.now, "x", true);
    u.ctx.save();
    u.ctx.strokeStyle = COLOURS.ink;
    u.ctx.lineWidth = 1.5;
    u.ctx.setLineDash([]);
    u.ctx.beginPath();
    u.ctx.moveTo(x, u.bbox.top);
    u.ctx.lineTo(x, u.bbox.top + u.bbox.height);
    u.ctx.stroke();
    u.ctx.restore();
  }

  // The window about a tick; a live one ends there.
  draw(ticks, tick, following, tickS) {
    const row = ticks.row(tick);
    if (!row) return;
    this.now = ticks.reader(row)("t_s");
    const ahead = following ? 0 : WINDOW_S / 2;
    const span = Math.ceil(WINDOW_S / tickS);
    const first = Math.max(ticks.first, tick - span);
    const end = Math.min(ticks.end, tick + Math.ceil(ahead / tickS) + 1);
    const times = [];
    const found = [];
    for (let i = first; i < end; i++) {
      const each = ticks.row(i);
      if (each) { times.push(ticks.reader(each)("t_s")); found.push(each); }
    }
    for (const [key, plot] of this.plots) {
      const columns = SERIES[key].map(({ name }) => {
        const column = ticks.column.get(name);
        return found.map((each) => (Number.isFinite(each[column]) ? each[column] : null));
      });
      plot.batch(() => {
        plot.setData([times, ...columns], false);
        plot.setScale("x", { min: this.now + ahead - WINDOW_S, max: this.now + ahead });
      });
    }
  }
}
