// Dragging, turning and zooming of the picture by mouse, fingers and keys. Used by live.js, whose motion it begins anew.

// Coordinates of the list that move the body: halves of it are moved together, each coordinate by its own amount.
function movers(list, moves) {
  if (!list.length || !moves(list)) return [];
  const half = list.length >> 1;
  return half ? [...movers(list.slice(0, half), moves), ...movers(list.slice(half), moves)] : list;
}
// The coordinates that bring the body nearest to the pointer with the least change, at rest. project: a place to two lengths of the
// screen. Least squares after Levenberg and Marquardt; where no coordinate moves the body towards the pointer, as with rods in one line, they
// are first bent a little.
function dragged(body, project, to) {
  const free = names.state.filter(n => !n.includes("'") && names.state.includes(n + "'")), start = state();
  for (const n of free) start[n + "'"] = 0;
  const at = values => {
    const m = new Motion(lag, scene, {...options(values, motion.t), method: motion.method});
    try { m.advance(m.t); const x = m.outputs, p = project(body.a.map(c => c < 0 ? 0 : x[c])); return {r: [to[0] - p[0], to[1] - p[1]], state: m.state}; } finally { m.free(); }
  };
  const far = x => Math.hypot(...x.r);
  let here = at(start), best = here, damping = 1e-6, bent = 0;
  const near = 1e-5*(Math.hypot(...to) + far(here)) + 1e-300, keep = s => Object.fromEntries(Object.entries(s).filter(([n]) => names.state.includes(n)));
  if (!body.movers) { // from a place where nothing is special, as the angle about a point at the origin
    const bend = (base, part) => (n, i) => { base[n] += part*(0.3 + 0.618*i % 1)*(Math.abs(base[n]) || 1); }, generic = keep(here.state);
    free.forEach(bend(generic, 1e-3));
    const seen = list => { const next = {...generic}; list.forEach(bend(next, 1e-4)); try { return at(next).r.join(); } catch { return NaN; } }, there = seen([]);
    body.movers = movers(free, list => seen(list) != there);
  }
  const began = performance.now();
  for (let turn = 0; turn < 16 && far(here) > near && performance.now() - began < 60; turn++) {
    const base = keep(here.state), J = body.movers.map(n => {
      const h = 1e-6*(Math.abs(base[n]) || 1), r = performance.now() - began < 200 ? at({...base, [n]: base[n] + h}).r : here.r;
      return [(here.r[0] - r[0])/h, (here.r[1] - r[1])/h];
    });
    let a = 0, b = 0, d = 0, done = false;
    for (const [x, y] of J) { a += x*x; b += x*y; d += y*y; }
    for (let k = 0; k < 4 && !done; k++) {
      const soft = damping*(a + d) + 1e-150, det = (a + soft)*(d + soft) - b*b, u = ((d + soft)*here.r[0] - b*here.r[1])/det, v = ((a + soft)*here.r[1] - b*here.r[0])/det;
      const next = {...base};
      body.movers.forEach((n, i) => { next[n] += J[i][0]*u + J[i][1]*v; });
      const there = at(next);
      done = far(there) < (1 - 1e-9)*far(here);
      if (done) { here = there; damping = Math.max(1e-9, damping/10); } else damping = Math.min(1, 30*damping);
    }
    if (far(here) < far(best)) best = here;
    if (done) continue;
    if (bent++) break;
    const next = {...base}; // at a place where the body cannot move that way at first
    body.movers.forEach((n, i) => { next[n] += (i % 2 ? -0.05 : 0.05)*(Math.abs(base[n]) > 1 ? Math.abs(base[n]) : 1); });
    here = at(next);
    damping = 1e-6;
  }
  return keep((far(here) < far(best) ? here : best).state);
}
function pointers() {
  const canvas = $("picture"), spot = e => { const r = canvas.getBoundingClientRect(); return [e.clientX - r.left, e.clientY - r.top]; };
  const fingers = new Map();
  let held = null, project, target, from = null, resumes = false, asked = null;
  canvas.onpointerdown = e => {
    if (e.isTrusted) canvas.setPointerCapture(e.pointerId);
    fingers.set(e.pointerId, from = spot(e));
    if (!picture || !lag || fingers.size > 1) return;
    const far = b => { const [x, y] = picture.toCanvas(picture.place(b.a)); return Math.hypot(x - from[0], y - from[1]); };
    held = picture.bodies.filter(b => b.a.some(c => c >= 0)).sort((a, b) => far(a) - far(b)).find(b => far(b) < (e.pointerType == "touch" ? 40 : 25)) || null;
    if (!held) return;
    held.movers = null;
    [project, target] = picture.screen(picture.place(held.a), from);
    resumes = playing;
    pause();
  };
  const move = () => {
    const now = asked;
    asked = null;
    if (!held || !now) return;
    try {
      const t = motion.t, shown = $("said").textContent;
      if (begin(dragged(held, project, target(now)), t)) { clear(); record(); draw(); } else if (!shown) tell($("said").textContent);
    } catch (x) { say(wrong(x)); }
  };
  canvas.onpointermove = e => {
    const was = fingers.get(e.pointerId);
    if (!was || !picture) return;
    const now = spot(e), other = [...fingers.keys()].find(k => k != e.pointerId);
    if (held) { // once a frame
      if (!e.isTrusted) { asked = now; move(); } else { if (!asked) requestAnimationFrame(move); asked = now; }
    } else if (other !== undefined) {
      const o = fingers.get(other), far = p => Math.hypot(p[0] - o[0], p[1] - o[1]) || 1;
      picture.eye.zoom = clamp(picture.eye.zoom*far(now)/far(was), 0.1, 50);
    } else view(now[0] - was[0], now[1] - was[1], e.shiftKey);
    fingers.set(e.pointerId, now);
    if (!held) draw();
  };
  canvas.onpointerup = canvas.onpointercancel = e => {
    fingers.delete(e.pointerId);
    if (held) { move(); settings.start = state(); starts(); share(); if (resumes) play(); }
    held = null;
  };
  canvas.onwheel = e => { if (!picture) return; picture.eye.zoom = clamp(picture.eye.zoom*Math.exp(-e.deltaY/500), 0.1, 50); e.preventDefault(); draw(); };
  canvas.onkeydown = e => {
    const by = {ArrowLeft: [-15, 0], ArrowRight: [15, 0], ArrowUp: [0, -15], ArrowDown: [0, 15]}[e.key], zoom = {"+": 1.15, "-": 1/1.15}[e.key];
    if (!picture || e.ctrlKey || e.altKey || e.metaKey || !(by || zoom)) return;
    if (by) view(...by, e.shiftKey); else picture.eye.zoom = clamp(picture.eye.zoom*zoom, 0.1, 50);
    e.preventDefault();
    e.stopPropagation();
    draw();
  };
}
// Turns a picture in space, moves one in the plane.
function view(dx, dy, shift) {
  const eye = picture.eye;
  if (picture.deep && !shift) { eye.turn -= dx/150; eye.rise = clamp(eye.rise + dy/150, -1.57, 1.57); } else { eye.x += dx; eye.y += dy; }
}
