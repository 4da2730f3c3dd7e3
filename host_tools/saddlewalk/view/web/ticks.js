"use strict";
// Rows of ticks by number: of a live walk the newest, of a log those near the one that is shown.

const LIVE_TICKS = 7500;
const CHUNK = 512;
const CHUNKS = 12;

class Ticks {
  constructor(names, live, first, end) {
    this.names = names;
    this.column = new Map(names.map((name, index) => [name, index]));
    this.width = names.length;
    this.live = live;
    this.first = live ? end : first;
    this.end = end;
    this.ring = live ? new Float32Array(LIVE_TICKS * this.width) : null;
    this.chunks = new Map(); // by number, the least recently used first
    this.asked = new Set();
  }

  // A block as the server sends it: the number of its first row, then rows.
  add(numbers) {
    const first = numbers[0];
    const rows = numbers.subarray(1);
    const count = Math.floor(rows.length / this.width);
    if (!this.live) {
      this.keepChunk(Math.floor(first / CHUNK), rows);
      return;
    }
    if (this.end === this.first || first !== this.end) this.first = first;
    for (let i = 0; i < count; i++) {
      const slot = (first + i) % LIVE_TICKS;
      this.ring.set(rows.subarray(i * this.width, (i + 1) * this.width), slot * this.width);
    }
    this.end = first + count;
    this.first = Math.max(this.first, this.end - LIVE_TICKS);
  }

  keepChunk(number, rows) {
    this.asked.delete(number);
    this.chunks.set(number, rows);
    if (this.chunks.size > CHUNKS) this.chunks.delete(this.chunks.keys().next().value);
  }

  // The row of a tick; null while it is not here.
  row(tick) {
    if (tick < this.first || tick >= this.end) return null;
    if (this.live) {
      const slot = tick % LIVE_TICKS;
      return this.ring.subarray(slot * this.width, (slot + 1) * this.width);
    }
    const number = Math.floor(tick / CHUNK);
    const rows = this.chunks.get(number);
    if (!rows) return null;
    const place = tick - number * CHUNK;
    return rows.subarray(place * this.width, (place + 1) * this.width);
  }

  // Ranges of [first, end) that are not here and were not asked for yet.
  missing(first, end) {
    const ranges = [];
    if (this.live) return ranges;
    const last = Math.floor((Math.min(end, this.end) - 1) / CHUNK);
    for (let number = Math.max(0, Math.floor(first / CHUNK)); number <= last; number++) {
      if (this.chunks.has(number)) {
        const rows = this.chunks.get(number);
        this.chunks.delete(number);
        this.chunks.set(number, rows);
      } else if (!this.asked.has(number)) {
        this.asked.add(number);
        ranges.push([number * CHUNK, Math.min((number + 1) * CHUNK, this.end)]);
      }
    }
    return ranges;
  }

  reader(row) {
    return (name) => row[this.column.get(name)];
  }
}

// A function name -> number between two rows: positions move, all else is the earlier row's.
function between(ticks, tick) {
  const before = ticks.row(Math.floor(tick));
  const after = ticks.row(Math.floor(tick) + 1);
  if (!before) return null;
  const share = tick - Math.floor(tick);
  if (!after || share === 0) return ticks.reader(before);
  return (name) => {
    const column = ticks.column.get(name);
    const a = before[column];
    const b = after[column];
    const moves = /^(com|xcom|left|right|plan|reference|heading|walked)_(.*_)?(m|rad)$/.test(name);
    return moves && Math.abs(b - a) < 0.6 ? a + (b - a) * share : a;
  };
}
