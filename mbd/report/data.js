// The run: decoding, and values between frames by cubics whose slopes are differences of neighbouring frames.

const run = JSON.parse(document.getElementById("run").textContent);
const floats = (text, kind) => new kind(Uint8Array.from(atob(text), (c) => c.charCodeAt(0)).buffer);
const times = floats(run.times, Float64Array);
const points = floats(run.points, Float32Array);
const d = run.dimension, width = run.count * d;
const tStart = times[0], tEnd = times[times.length - 1];
const forces = Object.fromEntries(Object.entries(run.forces).map(([name, text]) => [name, floats(text, Float32Array)]));
const shapes = run.shapes.map(([item, kind, form, at]) => ({ item, kind, form, at }));
const outputs = shapes.filter((shape) => shape.form === "output");
const clamp = (x, low, high) => Math.min(Math.max(x, low), high);

/** The frame k before t, so that times[k] <= t <= times[k + 1]. */
function before(list, t) {
  let low = 0, high = list.length - 1;
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (list[middle] <= t) low = middle; else high = middle;
  }
  return low;
}

/** Weights of frames k - 1 ... k + 2 at time t: the cubic with slopes by parabolas through three frames. */
function weights(t) {
  const last = times.length - 1;
  if (last < 1) return [[0, 1]];
  const k = before(times, t), h = times[k + 1] - times[k], x = (t - times[k]) / h;
  const found = new Map([[k, 0], [k + 1, 0]]);
  const add = (frame, weight) => found.set(frame, (found.get(frame) || 0) + weight);
  add(k, 1 - x * x * (3 - 2 * x));
  add(k + 1, x * x * (3 - 2 * x));
  if (last < 2) { add(k, x * (1 - x) * (2 * x - 1)); add(k + 1, x * (1 - x) * (1 - 2 * x)); return [...found]; }
  const slope = (at, factor) => {
    const i = clamp(at, 1, last - 1), a = times[i - 1], b = times[i], c = times[i + 1], s = times[at];
    add(i - 1, factor * (2 * s - b - c) / ((a - b) * (a - c)));
    add(i, factor * (2 * s - a - c) / ((b - a) * (b - c)));
    add(i + 1, factor * (2 * s - a - b) / ((c - a) * (c - b)));
  };
  slope(k, h * x * (1 - x) * (1 - x));
  slope(k + 1, -h * x * x * (1 - x));
  return [...found];
}

/** Values [stride] of an array of frames at time t. */
function between(array, stride, t) {
  const out = new Float64Array(stride);
  for (const [frame, weight] of weights(t)) {
    const first = frame * stride;
    for (let i = 0; i < stride; i++) out[i] += weight * array[first + i];
  }
  return out;
}

/** All points at time t, about the origin of the data. */
const pose = (t) => between(points, width, clamp(t, tStart, tEnd));
const point = (at, index) => at.subarray(index * d, index * d + d);

/** A number in few characters. */
function short(x, digits = 4) {
  if (!isFinite(x)) return "–";
  const size = Math.abs(x);
  const plain = !size || (size >= 1e-3 && size < 1e5);
  const text = plain ? String(Number(x.toPrecision(digits))) : x.toExponential(Math.max(digits - 2, 0));
  return text.replace("e+", "e").replaceAll("-", "−");
}

/** The least round number that divides a range into at most so many. */
function roundStep(range, most) {
  const raw = range / Math.max(most, 1), unit = 10 ** Math.floor(Math.log10(raw));
  return unit * [1, 2, 5, 10].find((m) => m * unit >= raw * (1 - 1e-9));
}

/** Round numbers between two, about so many. */
function nice(low, high, most) {
  const step = roundStep(high - low, most);
  const ticks = [];
  for (let k = Math.ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; k++) ticks.push(Number((k * step).toPrecision(12)));
  return ticks;
}
