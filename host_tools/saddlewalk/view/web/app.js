"use strict";
// The page: receives ticks, shows one of them, and moves on in time.

const RECONNECT_MS = 1000;
const state = {
  hello: null, ticks: null, socket: null,
  at: 0, // the tick that is shown, with a fraction
  playing: true, following: false,
  heardMs: 0, frameMs: 0, shown: -1, dirty: true, gaps: 0,
};
const above = new Above(element("above"));
const side = new Side(element("side"));
const charts = new Charts();
legend(element("above-legend"), ABOVE_LEGEND);
legend(element("side-legend"), SIDE_LEGEND);

function connect() {
  const token = new URLSearchParams(location.search).get("token");
  const socket = new WebSocket(`ws://${location.host}/ticks?token=${encodeURIComponent(token)}`);
  socket.binaryType = "arraybuffer";
  state.socket = socket;
  socket.onmessage = ({ data }) => (typeof data === "string" ? heardNews(JSON.parse(data)) : heardTicks(new Float32Array(data)));
  socket.onclose = () => {
    setText(element("source"), "The connection to saddlewalk has ended.");
    if (state.hello && state.hello.live) setTimeout(connect, RECONNECT_MS);
  };
}

function send(message) {
  if (state.socket.readyState === WebSocket.OPEN) state.socket.send(JSON.stringify(message));
}

function heardNews(news) {
  if (news.hello) begin(news.hello);
  else Object.assign(state.hello, news);
  const hello = state.hello;
  setText(element("source"), hello.source);
  element("controls").hidden = !hello.controls || Boolean(hello.ended);
  element("above").classList.toggle("pushable", !element("controls").hidden);
  state.dirty = true;
}

function begin(hello) {
  state.hello = hello;
  state.ticks = new Ticks(hello.names, hello.live, hello.first, hello.end);
  state.following = hello.live;
  state.playing = hello.live;
  state.at = hello.live ? 0 : hello.first;
  element("live").hidden = !hello.live;
  element("back").hidden = element("forward").hidden = false;
  want();
}

function heardTicks(numbers) {
  const { ticks } = state;
  if (state.hello.live && ticks.end > ticks.first && numbers[0] !== ticks.end) state.gaps++;
  ticks.add(numbers);
  state.heardMs = performance.now();
  state.dirty = true;
}

// Of a log, the rows about the tick that is shown.
function want() {
  const around = Math.ceil(WINDOW_S / state.hello.tick_s);
  for (const range of state.ticks.missing(state.at - around, state.at + around)) send({ want: range });
}

function clamp(tick) {
  return Math.min(Math.max(tick, state.ticks.first), Math.max(state.ticks.end - 1, state.ticks.first));
}

function goTo(tick) {
  state.following = false;
  state.playing = false;
  state.at = clamp(tick);
  state.dirty = true;
}

function play(playing) {
  if (!state.hello) return;
  state.playing = playing;
  if (!playing) state.following = false;
  if (playing && state.at >= state.ticks.end - 1) {
    if (state.hello.live) state.following = true;
    else state.at = state.ticks.first;
  }
  state.dirty = true;
}

function follow() {
  state.following = state.playing = true;
  state.dirty = true;
}

const still = window.matchMedia("(prefers-reduced-motion: reduce)");

// A live picture moves smoothly, one tick behind the words.
function advance(nowMs) {
  const { ticks, hello } = state;
  const passed = (nowMs - state.frameMs) / 1000 / hello.tick_s;
  state.frameMs = nowMs;
  if (state.following) {
    const newest = ticks.end - 1;
    const moved = still.matches ? 1 : Math.min((nowMs - state.heardMs) / 1000 / hello.tick_s, 1);
    state.at = Math.max(newest - 1 + moved, ticks.first);
  } else if (state.playing) {
    state.at = clamp(state.at + passed * Number(element("rate").value));
    if (state.at >= ticks.end - 1 && hello.live) state.following = true;
    else if (state.at >= ticks.end - 1) state.playing = false;
  }
}

function frame(nowMs) {
  requestAnimationFrame(frame);
  if (!state.hello) return;
  const before = state.at;
  advance(nowMs);
  const { ticks, hello } = state;
  want();
  const tick = state.following ? ticks.end - 1 : Math.floor(state.at);
  const row = ticks.end > ticks.first ? ticks.row(tick) : null;
  const silentS = hello.live && state.following && !hello.ended ? (nowMs - state.heardMs) / 1000 : 0;
  if (state.at !== before || state.dirty) {
    above.draw(ticks, state.at, hello);
    side.draw(ticks, state.at, hello);
  }
  if (tick !== state.shown || state.dirty || silentS > SILENT_S) showWords(row, tick, silentS);
  state.dirty = false;
}

function showWords(row, tick, silentS) {
  const { ticks, hello } = state;
  const read = row && ticks.reader(row);
  showLevel(announced(read, hello, row ? silentS : 0));
  const upright = row && read("truth.fallen") !== 1 && silentS <= SILENT_S;
  showMargin(read, upright);
  showPlayer(read);
  if (!row) return;
  state.shown = tick;
  document.body.dataset.tick = tick;
  setText(element("clock"), `tick ${read("tick")}`);
  fill(element("numbers-table"), numbersOf(read, hello));
  fill(element("health-table"), healthOf(read, hello));
  charts.draw(ticks, tick, state.following, hello.tick_s);
}

function showPlayer(read) {
  const { ticks, hello } = state;
  const slider = element("slider");
  slider.min = ticks.first;
  slider.max = Math.max(ticks.end - 1, ticks.first);
  slider.value = Math.round(state.at);
  const seconds = read ? read("t_s").toFixed(2) : "0.00";
  setText(element("time"), `${seconds} s`);
  slider.setAttribute("aria-valuetext", `${seconds} seconds`);
  setText(element("play"), state.playing ? "❚❚" : "▶");
  element("play").setAttribute("aria-label", state.playing ? "Pause" : "Play");
  element("live").setAttribute("aria-pressed", state.following);
  showLevels(hello, ticks);
}

// The levels of the whole walk above the slider.
const LEVEL_COLOURS = { unknown: "#aab4bf", stable: "#8cc7b3", caution: "#e69f00", unstable: "#d55e00" };
function showLevels(hello, ticks) {
  const canvas = element("levels");
  const width = Math.max(canvas.clientWidth, 1);
  if (canvas.width !== width) canvas.width = width;
  canvas.height = 8;
  const context = canvas.getContext("2d");
  const span = Math.max(ticks.end - ticks.first, 1);
  const bar = (level, first, end) => {
    const tall = { caution: 6, unstable: 8 }[level] || 4;
    context.fillStyle = LEVEL_COLOURS[level] || LEVEL_COLOURS.unknown;
    context.fillRect(((first - ticks.first) / span) * width, 8 - tall, Math.max(((end - first) / span) * width, 1), tall);
  };
  if (hello.spans) {
    for (const [level, first, end] of hello.spans) bar(hello.levels[level], first, end);
    return;
  }
  const column = ticks.column.get("verdict.level");
  let from = ticks.first;
  for (let i = ticks.first + 1; i <= ticks.end; i++) {
    const level = ticks.row(from)?.[column];
    if (i === ticks.end || ticks.row(i)[column] !== level) {
      bar(hello.levels[level], from, i);
      from = i;
    }
  }
}

element("play").onclick = () => play(!state.playing);
element("back").onclick = () => goTo(Math.ceil(state.at) - 1);
element("forward").onclick = () => goTo(Math.floor(state.at) + 1);
element("live").onclick = follow;
element("slider").oninput = () => goTo(Number(element("slider").value));

document.addEventListener("keydown", (event) => {
  if (!state.hello || event.ctrlKey || event.metaKey || event.altKey) return;
  if (event.target.matches("input[type=range], select, summary")) return;
  const second = Math.round(1 / state.hello.tick_s);
  const keys = {
    " ": () => play(!state.playing),
    ArrowLeft: () => goTo(Math.ceil(state.at) - (event.shiftKey ? second : 1)),
    ArrowRight: () => goTo(Math.floor(state.at) + (event.shiftKey ? second : 1)),
    Home: () => goTo(state.ticks.first),
    End: () => (state.hello.live ? follow() : goTo(state.ticks.end - 1)),
    l: () => state.hello.live && follow(),
  };
  if (event.key === " " && event.target.matches("button")) return;
  if (!keys[event.key]) return;
  event.preventDefault();
  keys[event.key]();
});

// ---- the emulated wearer

function showChoices() {
  setText(element("speed-out"), `${Number(element("speed").value).toFixed(1)} m/s`);
  setText(element("strength-out"), `${element("strength").value} N·s`);
}
element("speed").oninput = element("strength").oninput = showChoices;
showChoices();
element("walk").onclick = () => send({ speed: Number(element("speed").value) });
element("stop").onclick = () => send({ speed: 0 });
element("schedule").onclick = () => {
  send({ speed: null });
  send({ turn: null });
};
for (const button of document.querySelectorAll("[data-turn]")) {
  button.onclick = () => send({ turn: Number(button.dataset.turn) });
}
element("end").onclick = () => send({ end: true });
for (const button of document.querySelectorAll("[data-push]")) {
  const direction = button.dataset.push.split(",").map(Number);
  button.onclick = () => send({ push: direction.map((each) => each * Number(element("strength").value)) });
}

function fromCom(event) {
  const box = element("above").getBoundingClientRect();
  const at = above.board.metres(event.clientX - box.left, event.clientY - box.top);
  return { x: at.x - above.com.x, y: at.up - above.com.y };
}

element("above").addEventListener("pointerdown", (event) => {
  if (element("controls").hidden || !above.com) return;
  element("above").setPointerCapture(event.pointerId);
  above.drag = fromCom(event);
  state.dirty = true;
});
element("above").addEventListener("pointermove", (event) => {
  if (!above.drag) return;
  above.drag = fromCom(event);
  state.dirty = true;
});
element("above").addEventListener("pointerup", (event) => {
  if (!above.drag) return;
  const push = impulseOf(fromCom(event), above.heading);
  above.drag = null;
  state.dirty = true;
  if (Math.hypot(...push) >= 1) send({ push });
});
element("above").addEventListener("pointercancel", () => { above.drag = null; });

connect();
requestAnimationFrame(frame);
