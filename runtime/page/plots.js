// The plots beside the picture: columns over time, a phase portrait, a section. Enters: rows {t, x} of live.js; leaves: drawings.
function paper(id) {
  const canvas = $(id), pen = canvas.getContext("2d"), ratio = devicePixelRatio || 1, w = canvas.clientWidth, h = canvas.clientHeight;
  if (canvas.width != Math.round(w*ratio) || canvas.height != Math.round(h*ratio)) { canvas.width = Math.round(w*ratio); canvas.height = Math.round(h*ratio); }
  pen.setTransform(ratio, 0, 0, ratio, 0, 0);
  pen.clearRect(0, 0, w, h);
  return {pen, w, h};
}
// Bounds of numbers with a margin; a range that rounding alone makes is widened.
function bounds(...lists) {
  let lo = Infinity, hi = -Infinity;
  for (const list of lists) for (const v of list) if (Number.isFinite(v)) { if (v < lo) lo = v; if (v > hi) hi = v; }
  if (!(lo <= hi)) return [-1, 1];
  const least = 1e-9*Math.max(Math.abs(lo), Math.abs(hi)) || 1, short = hi - lo < least ? (lo || hi ? 0.05*Math.max(Math.abs(lo), Math.abs(hi)) : 1) : 0, m = 0.06*(hi - lo) + short;
  return [lo - m, hi + m];
}
function ticks([lo, hi], n) {
  const step = nice((hi - lo)/n), all = [];
  for (let k = Math.ceil(lo/step), i = 0; k*step <= hi && i < 40; i++) all.push([(k + i)*step, label(+((k + i)*step).toPrecision(12), step)]);
  return all.filter(([v]) => v <= hi);
}
// Axes, and a function that gives a place on the canvas. lo, hi: ranges of x and y.
function axes({pen, w, h}, rx, ry, xname, yname) {
  const top = 26, foot = 34, down = ticks(ry, Math.max(2, (h - top - foot)/34)), across = ticks(rx, Math.max(2, w/110));
  pen.font = "12px system-ui, sans-serif";
  const left = Math.max(24, ...down.map(t => pen.measureText(t[1]).width)) + 10, right = w - 12;
  const X = v => left + (right - left)*(v - rx[0])/(rx[1] - rx[0]), Y = v => h - foot - (h - foot - top)*(v - ry[0])/(ry[1] - ry[0]);
  pen.lineWidth = 1;
  pen.strokeStyle = ink("--grid"); pen.fillStyle = ink("--soft");
  pen.beginPath();
  for (const [v] of across) { pen.moveTo(X(v), top); pen.lineTo(X(v), h - foot); }
  for (const [v] of down) { pen.moveTo(left, Y(v)); pen.lineTo(right, Y(v)); }
  pen.stroke();
  pen.textAlign = "center";
  for (const [v, s] of across) pen.fillText(s, clamp(X(v), left, right - pen.measureText(s).width/2), h - foot + 14);
  pen.textAlign = "right";
  for (const [v, s] of down) pen.fillText(s, left - 5, Y(v) + 4);
  pen.fillStyle = ink("--ink");
  pen.fillText(xname, right, h - 5);
  pen.textAlign = "left";
  pen.fillText(yname, 4, 14);
  pen.beginPath(); pen.rect(left - 1, top - 4, right - left + 8, h - foot - top + 8);
  return {X, Y, top, bottom: h - foot, left, right};
}
function curve(pen, X, Y, x, y, colour, wide = 1.5) {
  pen.strokeStyle = colour; pen.lineWidth = wide; pen.beginPath();
  let open = false, px = 0, py = 0;
  for (let k = 0; k < x.length; k++) {
    if (!Number.isFinite(y[k]) || !Number.isFinite(x[k])) { open = false; continue; }
    const u = X(x[k]), v = Y(y[k]);
    if (open && k < x.length - 1 && Math.abs(u - px) + Math.abs(v - py) < 0.8) continue; // less than a pixel
    open ? pen.lineTo(u, v) : pen.moveTo(u, v);
    [open, px, py] = [true, u, v];
  }
  pen.stroke();
}
function spot(pen, x, y, colour) { pen.fillStyle = colour; pen.beginPath(); pen.arc(x, y, 4, 0, 7); pen.fill(); }
// Rows of one column over time, the twin's beside it; grey past the horizon.
function plot_series(t, y, other, name, unit, horizon, dir) {
  const p = paper("series"), ry = bounds(y, other || []), a = axes(p, [Math.min(...[t[0], t.at(-1)]), Math.max(t[0], t.at(-1)) || 1e-12], ry, "t [" + unit + "]", name), {pen} = p;
  pen.save(); pen.clip();
  if (horizon !== null) {
    const x = clamp(a.X(horizon), a.left, a.right);
    pen.fillStyle = ink("--fill");
    dir > 0 ? pen.fillRect(x, a.top, a.right - x, a.bottom - a.top) : pen.fillRect(a.left, a.top, x - a.left, a.bottom - a.top);
  }
  if (other) curve(pen, a.X, a.Y, t, other, ink("--second"), 1);
  curve(pen, a.X, a.Y, t, y, ink("--line"));
  spot(pen, a.X(t.at(-1)), a.Y(y.at(-1)), ink("--mark"));
  pen.restore();
}
// A phase portrait whose trail fades, or the points of a section.
function plot_phase(x, y, xname, yname, points) {
  const p = paper("phase"), {pen} = p, all = points || {x, y}, a = axes(p, bounds(all.x, points ? [] : []), bounds(all.y), xname, yname);
  pen.save(); pen.clip();
  if (points) {
    pen.fillStyle = ink("--line");
    for (let k = 0; k < points.x.length; k++) pen.fillRect(a.X(points.x[k]) - 1.2, a.Y(points.y[k]) - 1.2, 2.4, 2.4);
  } else {
    const n = x.length, pieces = Math.min(12, n);
    for (let i = 0; i < pieces; i++) {
      pen.globalAlpha = 0.25 + 0.75*(i + 1)/pieces;
      curve(pen, a.X, a.Y, x.slice(Math.floor(n*i/pieces), Math.floor(n*(i + 1)/pieces) + 1), y.slice(Math.floor(n*i/pieces), Math.floor(n*(i + 1)/pieces) + 1), ink("--line"));
    }
    pen.globalAlpha = 1;
    spot(pen, a.X(x.at(-1)), a.Y(y.at(-1)), ink("--mark"));
  }
  pen.restore();
}
