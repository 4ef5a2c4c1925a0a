// How each form of shape looks: what lies under, bodies and beams, symbols above. A drawer takes pixels, a colour, the shape and the time.

function filled(list, colour) {
  pen.globalAlpha *= 0.14; pen.fillStyle = colour;
  pen.beginPath(); list.forEach(([x, y], k) => (k ? pen.lineTo(x, y) : pen.moveTo(x, y))); pen.fill();
  pen.globalAlpha /= 0.14;
}
const disc = ([x, y], r, fill, stroke = ink.ink) => {
  pen.setLineDash([]); pen.lineWidth = 1.5; pen.beginPath(); pen.arc(x, y, r, 0, 7);
  pen.fillStyle = fill; pen.fill(); pen.strokeStyle = stroke; pen.stroke();
};
const heading = ([a, b]) => Math.atan2(b[1] - a[1], b[0] - a[0]);
/** A rectangle about a point, turned. */
function block([x, y], angle, wide, tall, fill) {
  pen.save(); pen.translate(x, y); pen.rotate(angle); pen.setLineDash([]);
  pen.fillStyle = fill; pen.strokeStyle = ink.ink; pen.lineWidth = 1.5;
  pen.fillRect(-wide / 2, -tall / 2, wide, tall); pen.strokeRect(-wide / 2, -tall / 2, wide, tall);
  pen.restore();
}
function zigzag([a, b]) {
  const [x, y] = [b[0] - a[0], b[1] - a[1]], length = Math.hypot(x, y) || 1, n = [-y / length, x / length], out = [a];
  const at = (s, w) => [a[0] + s * x + w * n[0], a[1] + s * y + w * n[1]];
  out.push(at(0.15, 0));
  for (let k = 0; k < 14; k++) out.push(at(0.15 + 0.7 * (k + 0.5) / 14, k % 2 ? -6 : 6));
  return [...out, at(0.85, 0), b];
}
function hatch([x, y]) {
  line([[x, y], [x - 8, y + 12], [x + 8, y + 12], [x, y]], ink.ink, 1.3);
  line([[x - 12, y + 12], [x + 12, y + 12]], ink.ink, 1.3);
  for (const k of [-8, -2, 4, 10]) line([[x + k, y + 12], [x + k - 5, y + 18]], ink.ink, 1);
}
/** A tip at b of what comes from a. */
function tip(a, b, colour, long = 9) {
  const angle = Math.atan2(b[1] - a[1], b[0] - a[0]), at = (turn) => [b[0] - long * Math.cos(angle + turn), b[1] - long * Math.sin(angle + turn)];
  pen.fillStyle = colour; pen.beginPath(); pen.moveTo(...b); pen.lineTo(...at(0.42)); pen.lineTo(...at(-0.42)); pen.closePath(); pen.fill();
}
function arc([x, y], r, colour) {
  pen.setLineDash([]); pen.strokeStyle = colour; pen.lineWidth = 1.8; pen.beginPath(); pen.arc(x, y, r, 0.9, 5.4); pen.stroke();
  const end = [x + r * Math.cos(0.9), y + r * Math.sin(0.9)];
  tip([end[0] + 5, end[1] - 4], end, colour, 8);
}
function arrow([p], colour, shape, t) {
  if (!forces[shape.item]) return;
  const f = between(forces[shape.item], d, t), u = 70 * dot(looking[0], f), v = -70 * dot(looking[1], f);
  if (Math.hypot(u, v) < 1) return;
  const from = [p[0] - u, p[1] - v];
  line([from, p], ink.c1, 2); tip(from, p, ink.c1);
}

const UNDER = {
  guide: (p) => line(p, ink.quiet, 1, [9, 3, 2, 3]),
  hull: (p, colour) => filled(p, colour),
  disc: (p, colour) => filled(p.slice(1), colour),
  ground: ([p]) => hatch(p),
};
const OUTLINES = {
  beam: (p, colour) => line(p, colour, 3),
  rod: (p, colour) => line(p, colour, 5),
  arm: (p, colour) => line(p, colour, 2),
  hull: (p, colour) => line(p, colour, 1.5),
  axes: (p, colour) => line(p, colour, 2),
  disc: (p, colour) => { line(p.slice(1), colour, 2); line(p.slice(0, 2), colour, 1.5); },
  spring: (p) => line(zigzag(p), ink.ink, 1.3),
  link: (p) => line(p, ink.ink, 1.5, [7, 3]),
  particle: ([p], colour) => disc(p, 6, colour, ink.paper),
};
const SYMBOLS = {
  centre: ([p], colour) => disc(p, 2.5, colour, colour),
  pin: (p) => {
    if (d === 3) line([p[0].map((x, i) => 2 * x - p[1][i]), p[1]], ink.ink, 2.5);
    disc(p[0], 4.5, ink.paper);
  },
  ball: ([p]) => disc(p, 5, ink.quiet),
  universal: ([[x, y]]) => {
    disc([x, y], 5.5, ink.paper);
    for (const side of [-4, 4]) line([[x - 4, y - side], [x + 4, y + side]], ink.ink, 1.3);
  },
  clamp: (p) => block(p[0], heading(p), 7, 16, ink.quiet),
  slider: (p) => block(p[0], heading(p), 20, 11, ink.paper),
  follower: (p) => block(p[0], heading(p), 11, 8, ink.paper),
  planar: (p) => block(p[0], heading(p), 14, 14, ink.paper),
  sleeve: ([p]) => disc(p, 6, "transparent"),
  prescribed: ([p]) => block(p, Math.PI / 4, 9, 9, ink.paper),
  edge: (p) => {
    const [[x, y]] = p, [u, v] = [12 * Math.cos(heading(p)), 12 * Math.sin(heading(p))];
    line([[x - u, y - v], [x + u, y + v]], ink.ink, 3);
  },
  motor: ([p]) => arc(p, 12, ink.c4),
  torque: ([p]) => arc(p, 15, ink.c1),
  "torsion spring": ([p]) => { arc(p, 9, ink.ink); },
  force: arrow,
};
