// Plots as SVG, a cursor at the time of the animation in each; dragging over one moves the time.

const NS = "http://www.w3.org/2000/svg";
const element = (name, attributes = {}, parent = null) => {
  const made = document.createElementNS(NS, name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  if (parent) parent.append(made);
  return made;
};
const tag = (name, text = "", parent = null, className = "") => {
  const made = document.createElement(name);
  made.textContent = text;
  if (className) made.className = className;
  if (parent) parent.append(made);
  return made;
};
const LINES = ["c0", "c1", "c2", "c3", "c4", "c5"];
const HEADINGS = {
  energy: "Energy and audit", audit: "Energy and audit", errors: "Estimated errors", outputs: "Outputs", reactions: "Reactions of joints",
};
/** The most that a logarithmic plot shows; what is smaller lies on its floor. */
const DECADES = 10;
const SUPER = "⁰¹²³⁴⁵⁶⁷⁸⁹";
const power = (k) => "10" + (k < 0 ? "⁻" : "") + [...String(Math.abs(k))].map((c) => SUPER[c]).join("");

class Plot {
  constructor(spec, parent) {
    this.spec = spec;
    this.x = spec.times ? floats(spec.times, Float64Array) : times;
    this.curves = spec.curves.map(([label, text], k) => ({
      label, values: floats(text, Float32Array), on: true,
      colour: `var(--${LINES[k % LINES.length]})`, dash: DASHES[k % DASHES.length].join(" "),
    }));
    this.box = tag("div", "", parent, "plot");
    this.name = spec.title + (spec.unit ? ` [${spec.unit}]` : "");
    tag("h3", this.name, this.box);
    this.legend = tag("div", "", this.box, "legend");
    this.curves.forEach((curve) => this.entry(curve));
    this.svg = element("svg", { role: "img" }, this.box);
    if (spec.note) tag("p", spec.note, this.box);
    if (!this.curves.length) { this.svg.remove(); return; }
    const scrub = (event) => { if (event.buttons || event.type === "pointerdown") seek(this.timeAt(event.clientX)); };
    this.svg.addEventListener("pointerdown", scrub);
    this.svg.addEventListener("pointermove", scrub);
  }

  entry(curve) {
    const button = tag("button", "", this.legend);
    button.type = "button";
    const sample = element("svg", { viewBox: "0 0 28 10", "aria-hidden": "true" });
    element("path", { d: "M0 5h28", "stroke-width": 2.4, "stroke-dasharray": curve.dash, style: `stroke:${curve.colour}` }, sample);
    button.append(sample);
    tag("span", curve.label, button);
    curve.shown = tag("span", "", button, "value");
    button.setAttribute("aria-pressed", "true");
    button.addEventListener("click", () => {
      curve.on = !curve.on;
      button.setAttribute("aria-pressed", curve.on);
      this.render(); this.cursor(clock.t);
    });
  }

  /** The span of what is shown: of a log plot in decades. */
  span() {
    let low = Infinity, high = -Infinity;
    for (const curve of this.curves) if (curve.on) for (const y of curve.values) {
      if (!isFinite(y) || (this.spec.log && y <= 0)) continue;
      low = Math.min(low, y); high = Math.max(high, y);
    }
    this.nothing = low > high;
    if (low > high) [low, high] = this.spec.log ? [1e-16, 1] : [0, 1];
    if (this.spec.log) {
      const top = Math.ceil(Math.log10(high) - 1e-9);
      return [clamp(Math.floor(Math.log10(low) + 1e-9), top - DECADES, top - 1), top];
    }
    const room = 0.05 * (high - low) || 0.05 * Math.abs(high) || 1;
    return [low - room, high + room];
  }

  render() {
    if (!this.curves.length) return;
    const wide = Math.max(this.box.clientWidth - 20, 240), tall = 220, { svg } = this;
    svg.replaceChildren();
    svg.setAttribute("viewBox", `0 0 ${wide} ${tall}`);
    const [low, high] = this.span(), log = this.spec.log;
    this.lowest = low;
    const ticks = log ? this.decades(low, high) : nice(low, high, 5);
    const labels = ticks.map((y) => (log ? power(y) : short(y, 6)));
    this.left = 14 + 7 * Math.max(...labels.map((label) => label.length));
    this.right = wide - 12; this.bottom = tall - 38;
    this.px = (t) => this.left + (this.right - this.left) * ((t - tStart) / (tEnd - tStart || 1));
    this.py = (y) => this.bottom - (this.bottom - 8) * (((log ? Math.log10(y) : y) - low) / (high - low));
    ticks.forEach((y, k) => {
      const at = this.py(log ? 10 ** y : y);
      element("path", { class: "grid", d: `M${this.left} ${at}H${this.right}` }, svg);
      element("text", { x: this.left - 6, y: at + 4, "text-anchor": "end" }, svg).textContent = labels[k];
    });
    const seconds = nice(tStart, tEnd || tStart + 1, Math.max(2, Math.floor((this.right - this.left) / 75)));
    for (const t of seconds) {
      element("path", { class: "grid", d: `M${this.px(t)} 8V${this.bottom}` }, svg);
      element("text", { x: this.px(t), y: this.bottom + 16, "text-anchor": "middle" }, svg).textContent = short(t, 6);
    }
    element("text", { x: (this.left + this.right) / 2, y: tall - 6, "text-anchor": "middle" }, svg).textContent = "t [s]";
    for (const at of Object.values(run.events).flat()) element("path", { class: "event", d: `M${this.px(at)} 8V${this.bottom}` }, svg);
    element("rect", { class: "frame", x: this.left, y: 8, width: this.right - this.left, height: this.bottom - 8 }, svg);
    for (const { on, values, dash, colour } of this.curves) {
      if (on) element("path", { class: "curve", d: this.path(values), "stroke-dasharray": dash, style: `stroke:${colour}` }, svg);
    }
    if (this.nothing) element("text", { x: (this.left + this.right) / 2, y: tall / 2, "text-anchor": "middle" }, svg).textContent = "zero throughout";
    this.mark = element("path", { class: "cursor" }, svg);
    const reach = ({ label, values }) => `${label} from ${short(Math.min(...values))} to ${short(Math.max(...values))}`;
    svg.setAttribute("aria-label", `${this.name} over t [s]: ${this.curves.map(reach).join(", ")}`);
  }

  decades(low, high) {
    const step = Math.max(1, Math.ceil((high - low) / 5)), out = [];
    for (let k = Math.ceil(low / step) * step; k <= high; k += step) out.push(k);
    return out;
  }

  path(values) {
    let out = "", pause = true;
    values.forEach((y, k) => {
      if (!isFinite(y)) { pause = true; return; }
      const height = this.spec.log ? this.py(Math.max(y, 10 ** this.lowest)) : this.py(y);
      out += `${pause ? "M" : "L"}${this.px(this.x[k]).toFixed(1)} ${height.toFixed(1)}`;
      pause = false;
    });
    return out;
  }

  timeAt(clientX) {
    const box = this.svg.getBoundingClientRect(), x = (clientX - box.left) * (this.svg.viewBox.baseVal.width / box.width);
    return tStart + clamp((x - this.left) / (this.right - this.left), 0, 1) * (tEnd - tStart);
  }

  cursor(t) {
    if (!this.mark) return;
    this.mark.setAttribute("d", `M${this.px(t)} 8V${this.bottom}`);
    for (const curve of this.curves) {
      const k = this.x.length > 1 ? before(this.x, t) : 0, next = Math.min(k + 1, this.x.length - 1);
      const x = clamp((t - this.x[k]) / (this.x[next] - this.x[k] || 1), 0, 1);
      curve.shown.textContent = short(curve.values[k] * (1 - x) + curve.values[next] * x);
    }
  }
}

/** All plots, under a heading for each group. */
function makePlots() {
  const made = [], places = {};
  for (const spec of run.plots) {
    const heading = HEADINGS[spec.group];
    if (!places[heading]) {
      tag("h2", heading, document.getElementById("plots"));
      places[heading] = tag("div", "", document.getElementById("plots"), "plots");
    }
    made.push(new Plot(spec, places[heading]));
  }
  return made;
}
