// The stage: a camera (pan and zoom; in space it goes around) and everything drawn by it on a canvas.

const canvas = document.getElementById("stage"), pen = canvas.getContext("2d");
const camera = { scale: 1, u: 0, v: 0, azimuth: run.view[0], elevation: run.view[1], moved: false };
const size = { width: 300, height: 150 };
const css = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
let ink = {};
const INKS = ["paper", "ink", "quiet", "line", "grid", "c0", "c1", "c2", "c3", "c4", "c5", "c6"];
const colours = () => { ink = Object.fromEntries(INKS.map((name) => [name, css("--" + name)])); };
const SOLIDS = ["c0", "c2", "c3", "c4", "c5"], TRACKS = ["c1", "c6", "c3", "c2", "c0", "c4"];
const DASHES = [[], [7, 3], [2, 3], [9, 3, 2, 3], [14, 4], [4, 2, 1, 2]];
const bodies = [...new Set(shapes.filter((s) => ["body", "cable", "beam", "particle"].includes(s.kind)).map((s) => s.item))];
const solid = (item) => ink[SOLIDS[Math.max(bodies.indexOf(item), 0) % SOLIDS.length]];
const track = (k) => ink[TRACKS[k % TRACKS.length]];

/** Two rows: to the right and up on the screen; a third one towards the eye. */
function axes() {
  if (d === 2) return [[1, 0], [0, 1]];
  const [ca, sa, ce, se] = [Math.cos(camera.azimuth), Math.sin(camera.azimuth), Math.cos(camera.elevation), Math.sin(camera.elevation)];
  return [[-sa, ca, 0], [-ca * se, -sa * se, ce], [ca * ce, sa * ce, se]].map((row) => {
    const turned = [0, 0, 0];
    [(run.up + 1) % 3, (run.up + 2) % 3, run.up].forEach((axis, k) => { turned[axis] = row[k]; });
    return turned;
  });
}
const dot = (a, b) => { let sum = 0; for (let i = 0; i < d; i++) sum += a[i] * b[i]; return sum; };
let looking = axes();

/** Pixels of a point about the origin of the data. */
const screen = (p) => [
  size.width / 2 + (dot(looking[0], p) - camera.u) * camera.scale,
  size.height / 2 - (dot(looking[1], p) - camera.v) * camera.scale,
];

const MARGIN = { left: 52, right: 24, top: 56, bottom: 40 };

/** Puts everything that ever is somewhere on the canvas. */
function fit() {
  looking = axes();
  let [u0, u1, v0, v1] = [Infinity, -Infinity, Infinity, -Infinity];
  for (let i = 0; i < points.length; i += d) {
    const p = points.subarray(i, i + d), u = dot(looking[0], p), v = dot(looking[1], p);
    u0 = Math.min(u0, u); u1 = Math.max(u1, u); v0 = Math.min(v0, v); v1 = Math.max(v1, v);
  }
  const room = 1e-3 * Math.hypot(...run.high.map((x, i) => x - run.low[i])) || 1;
  const wide = size.width - MARGIN.left - MARGIN.right, tall = size.height - MARGIN.top - MARGIN.bottom;
  camera.scale = Math.max(Math.min(wide / (u1 - u0 + room), tall / (v1 - v0 + room)), 1e-12);
  camera.u = (u0 + u1) / 2 - (MARGIN.left - MARGIN.right) / 2 / camera.scale;
  camera.v = (v0 + v1) / 2 + (MARGIN.top - MARGIN.bottom) / 2 / camera.scale;
  camera.moved = false;
}

/** Nearer by a factor, what is at the pixel (x, y) staying there. */
function zoom(factor, x = size.width / 2, y = size.height / 2) {
  const k = 1 / camera.scale - 1 / (camera.scale * factor);
  camera.u += (x - size.width / 2) * k;
  camera.v -= (y - size.height / 2) * k;
  camera.scale *= factor;
  camera.moved = true;
}
function pan(x, y) { camera.u -= x / camera.scale; camera.v += y / camera.scale; camera.moved = true; }
function orbit(x, y) {
  camera.azimuth -= 0.01 * x;
  camera.elevation = clamp(camera.elevation + 0.01 * y, -Math.PI / 2, Math.PI / 2);
  camera.moved = true;
}

function resize() {
  const box = canvas.getBoundingClientRect(), dense = window.devicePixelRatio || 1;
  size.width = box.width || 300; size.height = box.height || 150;
  canvas.width = Math.round(size.width * dense); canvas.height = Math.round(size.height * dense);
  pen.setTransform(canvas.width / size.width, 0, 0, canvas.height / size.height, 0, 0);
  if (!camera.moved) fit();
}

function line(list, colour, thick, dash = []) {
  pen.strokeStyle = colour; pen.lineWidth = thick; pen.setLineDash(dash);
  pen.beginPath();
  list.forEach(([x, y], k) => (k ? pen.lineTo(x, y) : pen.moveTo(x, y)));
  pen.stroke();
}
function word(text, x, y, align = "left", colour = ink.quiet) {
  pen.font = "12px system-ui, sans-serif"; pen.textAlign = align; pen.fillStyle = colour;
  pen.lineWidth = 3; pen.setLineDash([]); pen.strokeStyle = ink.paper; pen.strokeText(text, x, y);
  pen.fillText(text, x, y);
}

/** Lines and numbers of the plane, in metres. */
function grid() {
  const wide = size.width / camera.scale, tall = size.height / camera.scale, step = roundStep(wide, size.width / 80);
  const [u0, v0] = [camera.u - wide / 2 + run.origin[0], camera.v - tall / 2 + run.origin[1]];
  const at = (low, length) => { const out = []; for (let k = Math.ceil(low / step); k * step <= low + length; k++) out.push(k * step); return out; };
  const place = (x, y) => screen([x - run.origin[0], y - run.origin[1]]);
  const xs = at(u0, wide), ys = at(v0, tall);
  for (const x of xs) { const px = place(x, 0)[0]; line([[px, 0], [px, size.height]], ink.grid, 1); }
  for (const y of ys) { const py = place(0, y)[1]; line([[0, py], [size.width, py]], ink.grid, 1); }
  for (const x of xs) { const px = place(x, 0)[0]; if (px > 50 && px < size.width - 60) word(short(x), px, size.height - 8, "center"); }
  for (const y of ys) { const py = place(0, y)[1]; if (py > 36 && py < size.height - 26) word(short(y), 6, py + 4); }
  word("x [m]", size.width - 8, size.height - 8, "right", ink.ink);
  word("y [m]", 6, 18, "left", ink.ink);
}

/** In space: a floor below everything, the directions of the axes, and a length to compare with. */
function floor() {
  const [a, b] = [(run.up + 1) % 3, (run.up + 2) % 3], low = run.low[run.up] - run.origin[run.up];
  const reach = 0.6 * Math.max(...run.high.map((x, i) => x - run.low[i])) || 1;
  const at = (s, t) => { const p = [0, 0, 0]; p[a] = s; p[b] = t; p[run.up] = low; return screen(p); };
  for (const s of nice(-reach, reach, 8)) { line([at(s, -reach), at(s, reach)], ink.grid, 1); line([at(-reach, s), at(reach, s)], ink.grid, 1); }
  const corner = [40, size.height - 40];
  "xyz".split("").forEach((name, k) => {
    const [u, v] = [24 * looking[0][k], -24 * looking[1][k]];
    line([corner, [corner[0] + u, corner[1] + v]], ink.ink, 1.5);
    word(name, corner[0] + 1.35 * u, corner[1] + 1.35 * v + 4, "center", ink.ink);
  });
  const step = roundStep(160 / camera.scale, 2.5), end = size.width - 16;
  line([[end - step * camera.scale, size.height - 16], [end, size.height - 16]], ink.ink, 2);
  word(`${short(step)} m`, end, size.height - 24, "right", ink.ink);
}

const place = (now, shape) => shape.at.map((index) => screen(point(now, index)));

const GHOSTLY = ["beam", "rod", "arm", "hull", "disc"];
/** Shapes of several times before t, faint. */
function drawGhosts(t, count = 8) {
  pen.globalAlpha = 0.25;
  for (let k = 0; k < count; k++) {
    const then = tStart + (k / count) * (tEnd - tStart);
    if (then >= t) break;
    const now = pose(then);
    for (const shape of shapes) if (GHOSTLY.includes(shape.form)) OUTLINES[shape.form](place(now, shape), solid(shape.item));
  }
  pen.globalAlpha = 1;
}

/** Paths of the followed points. */
function drawTrails(t, which) {
  outputs.forEach((shape, k) => {
    const path = [], index = shape.at[0];
    for (let f = 0; f < times.length && (which === "whole" || times[f] <= t); f++) {
      path.push(screen(point(points.subarray(f * width, f * width + width), index)));
    }
    if (which !== "whole") path.push(screen(point(pose(t), index)));
    line(path, track(k), 1.5, DASHES[k % DASHES.length]);
  });
}

function drawStage(t, options) {
  looking = axes();
  pen.fillStyle = ink.paper; pen.fillRect(0, 0, size.width, size.height);
  pen.lineJoin = pen.lineCap = "round";
  if (d === 2) grid(); else floor();
  if (options.ghosts) drawGhosts(t);
  if (options.trails !== "none") drawTrails(t, options.trails);
  const now = pose(t), far = (shape) => (d === 3 ? dot(looking[2], point(now, shape.at[0])) : 0);
  const order = d === 3 ? [...shapes].sort((a, b) => far(a) - far(b)) : shapes;
  for (const pass of [UNDER, OUTLINES, SYMBOLS]) {
    for (const shape of order) if (pass[shape.form]) pass[shape.form](place(now, shape), solid(shape.item), shape, t);
  }
  outputs.forEach((shape, k) => follow(place(now, shape)[0], k));
  if (options.names) names(now);
}

/** The symbol of the k-th followed point. */
function follow([x, y], k, brush = pen, colour = track(k)) {
  brush.setLineDash([]);
  brush.beginPath();
  const r = 5;
  if (k % 4 === 0) brush.arc(x, y, r, 0, 7);
  else if (k % 4 === 1) brush.rect(x - r, y - r, 2 * r, 2 * r);
  else if (k % 4 === 2) { brush.moveTo(x, y - r - 1); brush.lineTo(x + r + 1, y + r); brush.lineTo(x - r - 1, y + r); brush.closePath(); }
  else { brush.moveTo(x, y - r - 2); brush.lineTo(x + r + 2, y); brush.lineTo(x, y + r + 2); brush.lineTo(x - r - 2, y); brush.closePath(); }
  brush.fillStyle = colour; brush.fill();
}

/** Names of items, of bodies and beams first; one that would cover another is left out. */
function names(now) {
  const seen = new Set(), taken = [];
  const labelled = shapes.filter((shape) => !["output", "guide"].includes(shape.form));
  for (const shape of [...labelled.filter((each) => bodies.includes(each.item)), ...labelled]) {
    if (seen.has(shape.item)) continue;
    seen.add(shape.item);
    const middle = shape.at[shape.form === "beam" ? shape.at.length >> 1 : 0], [x, y] = screen(point(now, middle));
    const two = shape.form === "rod" ? screen(point(now, shape.at[1])) : [x, y];
    const left = (x + two[0]) / 2 + 8, low = (y + two[1]) / 2 - 8;
    pen.font = "12px system-ui, sans-serif";
    const box = [left - 2, low - 11, left + pen.measureText(shape.item).width + 2, low + 3];
    if (taken.some((other) => box[0] < other[2] && other[0] < box[2] && box[1] < other[3] && other[1] < box[3])) continue;
    taken.push(box);
    word(shape.item, left, low, "left", ink.ink);
  }
}
