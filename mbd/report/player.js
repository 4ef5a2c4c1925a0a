// Time, controls, keys, fingers and print; what tests and other scripts may use is window.mbdReport.

const $ = (id) => document.getElementById(id);
const clock = { t: tStart, playing: false, last: 0 };
const span = tEnd - tStart;
const graphs = makePlots();
const options = () => ({ trails: $("trails").value, ghosts: $("ghosts").checked, names: $("names").checked });
const digits = clamp(3 - Math.floor(Math.log10(span || 1)), 0, 9);
let waiting = false;

/** Everything at the time of the clock, once a frame of the screen. */
function show() {
  drawStage(clock.t, options());
  const said = `${clock.t.toFixed(digits)} s`.replace("-", "−");
  $("clock").textContent = "t = " + said;
  $("slider").value = clock.t;
  $("slider").setAttribute("aria-valuetext", said);
  for (const graph of graphs) graph.cursor(clock.t);
}
function soon() {
  if (waiting) return;
  waiting = true;
  requestAnimationFrame(() => { waiting = false; show(); });
}
function seek(t) { clock.t = clamp(t, tStart, tEnd); show(); }
function tick(now) {
  if (!clock.playing) return;
  const on = clock.t + Math.min(now - clock.last, 100) / 1000 * Number($("speed").value);
  clock.last = now;
  if (on >= tEnd && !$("loop").checked) { pause(); seek(tEnd); return; }
  seek(on > tEnd ? tStart + ((on - tStart) % (span || 1)) : on);
  requestAnimationFrame(tick);
}
function play() {
  if (clock.playing || !span) return;
  if (clock.t >= tEnd) clock.t = tStart;
  clock.playing = true; clock.last = performance.now();
  $("play").textContent = "pause"; $("play").setAttribute("aria-pressed", "true");
  requestAnimationFrame(tick);
}
function pause() {
  clock.playing = false;
  $("play").textContent = "play"; $("play").setAttribute("aria-pressed", "false");
}
const toggle = () => (clock.playing ? pause() : play());

/** Speeds around the one at which the run takes some seconds. */
function speeds() {
  const usual = Number((span > 4 && span < 20 ? 1 : roundStep(span / 8 || 1, 1)).toPrecision(1));
  const all = [0.1, 0.2, 0.5, 1, 2, 5, 10].map((k) => Number((k * usual).toPrecision(1)));
  if (!all.includes(1)) all.push(1);
  for (const value of all.sort((a, b) => a - b)) {
    const option = tag("option", `${short(value)}×`, $("speed"));
    option.value = value; option.selected = value === usual;
  }
  $("speed").title = "seconds of the run in a second";
}

function step(count) {
  const h = span / Math.max(times.length - 1, 1);
  pause(); seek(clock.t + count * h);
}
const look = (x, y) => { if (d === 3) orbit(x, y); else pan(x, y); soon(); };
const KEYS = {
  " ": toggle, ArrowLeft: () => step(-1), ArrowRight: () => step(1), PageDown: () => step(-10), PageUp: () => step(10),
  ArrowDown: () => step(-1), ArrowUp: () => step(1),
  Home: () => { pause(); seek(tStart); }, End: () => { pause(); seek(tEnd); },
  f: () => { fit(); soon(); }, "+": () => { zoom(1.25); soon(); }, "-": () => { zoom(0.8); soon(); },
};
const LOOKS = { ArrowLeft: [20, 0], ArrowRight: [-20, 0], ArrowUp: [0, 20], ArrowDown: [0, -20] };
document.addEventListener("keydown", (event) => {
  const own = event.target.closest("select, button, summary, input[type=checkbox]");
  if (event.ctrlKey || event.metaKey || event.altKey || (own && (event.key === " " || own.tagName === "SELECT"))) return;
  const inView = event.target === canvas || event.target === $("slider") || event.target === document.body || own;
  const moves = ["PageUp", "PageDown", "ArrowUp", "ArrowDown"].includes(event.key);
  if (!inView || (moves && event.target !== canvas && event.target !== $("slider"))) return; // the page scrolls
  if (event.shiftKey && LOOKS[event.key]) { look(...LOOKS[event.key]); event.preventDefault(); return; }
  if (KEYS[event.key]) { KEYS[event.key](); event.preventDefault(); }
});

const fingers = new Map();
canvas.addEventListener("pointerdown", (event) => {
  fingers.set(event.pointerId, [event.clientX, event.clientY]);
  try { canvas.setPointerCapture(event.pointerId); } catch { /* of a pointer that is gone */ }
});
for (const end of ["pointerup", "pointercancel"]) canvas.addEventListener(end, (event) => fingers.delete(event.pointerId));
canvas.addEventListener("pointermove", (event) => {
  const was = fingers.get(event.pointerId);
  if (!was) return;
  const is = [event.clientX, event.clientY], move = [is[0] - was[0], is[1] - was[1]];
  fingers.set(event.pointerId, is);
  if (fingers.size === 2) {
    const other = [...fingers].find(([id]) => id !== event.pointerId)[1], box = canvas.getBoundingClientRect();
    const spread = (p) => Math.hypot(p[0] - other[0], p[1] - other[1]) || 1;
    pan(move[0] / 2, move[1] / 2);
    zoom(spread(is) / spread(was), (is[0] + other[0]) / 2 - box.left, (is[1] + other[1]) / 2 - box.top);
    soon();
  } else if (event.shiftKey || event.button === 1) { pan(...move); soon(); } else look(...move);
});
canvas.addEventListener("wheel", (event) => {
  if (document.activeElement !== canvas && !event.ctrlKey) return; // the page scrolls
  event.preventDefault();
  const box = canvas.getBoundingClientRect();
  zoom(Math.exp(-0.0015 * event.deltaY), event.clientX - box.left, event.clientY - box.top);
  soon();
}, { passive: false });
canvas.addEventListener("dblclick", () => { fit(); soon(); });

$("play").addEventListener("click", toggle);
$("slider").addEventListener("input", () => { pause(); seek(Number($("slider").value)); });
for (const id of ["trails", "ghosts", "names"]) $(id).addEventListener("change", soon);
$("closer").addEventListener("click", () => { zoom(1.25); soon(); });
$("farther").addEventListener("click", () => { zoom(0.8); soon(); });
$("fit").addEventListener("click", () => { fit(); soon(); });

/** The followed points by symbol and name, beside the stage. */
function legend() {
  $("followed").replaceChildren();
  outputs.forEach((shape, k) => {
    const item = tag("li", shape.item + " ", $("followed")), icon = tag("canvas", "", item);
    icon.width = icon.height = 32;
    icon.style.cssText = "width:16px;height:16px;min-height:0;display:inline-block;vertical-align:middle";
    const brush = icon.getContext("2d");
    brush.scale(2, 2);
    follow([8, 8], k, brush, track(k));
  });
}
function refresh() { colours(); resize(); legend(); for (const graph of graphs) graph.render(); show(); }

let closed = [];
window.addEventListener("beforeprint", () => {
  closed = [...document.querySelectorAll("details:not([open])")];
  closed.forEach((each) => { each.open = true; });
});
window.addEventListener("afterprint", () => closed.forEach((each) => { each.open = false; }));
window.matchMedia("(prefers-color-scheme: dark)").addEventListener("change", refresh);

$("slider").min = tStart; $("slider").max = tEnd;
$("keys").textContent = "Space plays, arrow keys step (home, end: first, last), + − f: closer, farther, fit. " +
  (d === 3 ? "Drag to turn, shift and drag to move" : "Drag to move") + ", wheel (after a click) or two fingers to zoom. " +
  "Drag over a plot to move the time." +
  (run.between ? "" : " Only accepted steps are known of this run: it was loaded from a file without its functions of time.");
canvas.setAttribute("aria-label", `The mechanism in motion: ${bodies.slice(0, 8).join(", ")}`);
speeds();
refresh();
new ResizeObserver(() => {
  const box = canvas.getBoundingClientRect();
  if (box.width && (box.width !== size.width || box.height !== size.height)) refresh();
}).observe(canvas);

window.mbdReport = {
  seek, play, pause, fit: () => { fit(); show(); },
  time: () => clock.t, playing: () => clock.playing, start: tStart, end: tEnd, frames: times.length,
  /** Pixels on the canvas of a followed point now. */
  screen: (name) => { const shape = outputs.find((each) => each.item === name); return shape && screen(point(pose(clock.t), shape.at[0])); },
  /** Pixels on the canvas of a place [m]. */
  project: (place) => screen(place.map((x, i) => x - run.origin[i])),
  camera: () => ({ ...camera, width: size.width, height: size.height, origin: run.origin }),
};
