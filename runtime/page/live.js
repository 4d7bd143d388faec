// The live page: controls, clocks and plots around motion.js. Enters: model and packed of live.html; leaves: the page.
const $ = id => document.getElementById(id);
const bytesOf = text => Uint8Array.from(atob(text), c => c.charCodeAt(0));
const clamp = (x, lo, hi) => Math.min(hi, Math.max(lo, x));
const short = x => Number.isFinite(x) ? String(+x.toPrecision(4)) : "?";
const colours = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#8a7f00", "#888888"];

let lag, motion, twin, program, scene, items, playing = false, before = 0, track = [], spent = 0, passed = 0, wasm;
const settings = {method: "", fine: 1e-9, values: {}, start: {}};
const span = {t0: 0, t1: 20};

const isOf = name => model.programs.filter(p => p.scene == name);
const wanted = () => [...document.querySelectorAll("#effects input:checked")].map(e => e.value);
const sameSet = (a, b) => a.length == b.length && a.every(x => b.includes(x));

function say(text) { $("said").textContent = text; }

// ---- motions
const takesSteps = () => !!lag.word(settings.method, at => lag.f.page_takes_steps(at));
function options(values, t) {
  const steps = settings.method && takesSteps();
  return {method: settings.method, tol: steps ? 0 : settings.fine, step: steps ? settings.fine : 0, until: span.t1, t,
    values: {...settings.values, ...values}};
}
// A new motion from `values`, at time t; the old one stays where that is refused.
function begin(values, t = NaN) {
  try {
    const next = new Motion(lag, scene, options(values, t)), names = next.names("page_state");
    next.advance(next.t);
    if (motion) motion.free();
    motion = next;
    if (twin) { twin.free(); twin = null; }
    if ($("twin").checked) {
      const aside = {...motion.state}, first = names[0].name;
      aside[first] += 1e-9*(Math.abs(aside[first]) || 1);
      twin = new Motion(lag, scene, options(aside, motion.t));
    }
    spent = passed = 0;
    say("");
  } catch (e) { say(e.message); return false; }
  return true;
}
const state = () => {
  const known = new Set(names.state), now = {};
  for (const [name, x] of Object.entries(motion.state)) if (known.has(name)) now[name] = x;
  return now;
};
// Goes on from the present state with what has changed.
function go_on() { if (motion && begin(motion.state, motion.t)) draw(); }
function restart() {
  track = [];
  if (begin(settings.start)) { record(); draw(); }
}

const names = {outputs: [], state: []};
function choose() {
  const all = isOf($("scene").value), found = all.find(p => sameSet(p.effects, wanted())) || all[0];
  if (found != program) {
    program = found;
    lag = new Lag(wasm);
    scene = lag.open(bytesOf(found.bytes))[0];
    if (motion) motion = null;
    twin = null;
    items = lag.items(scene, "p").map((item, i) => ({...item, positive: lag.f.page_sign(scene, i) > 0}));
    const s = lag.span(scene);
    span.t0 = s.t0; span.t1 = s.t1 > s.t0 ? s.t1 : s.t0 + 20;
    sliders();
    methods();
    look();
  }
}

// ---- controls
function sliders() {
  const box = $("values");
  box.textContent = "";
  const probe = new Motion(lag, scene, {until: span.t1}), p = lag.parameters(probe.sim, items.length);
  names.outputs = probe.names("page_output").slice(0, probe.count - lag.f.page_drawn(scene)); names.state = probe.names("page_state").map(n => n.name);
  items.forEach((item, i) => {
    const value = (p[i] - item.offset)/item.factor, log = value > 0 && item.positive,
      [lo, hi] = log ? [value/10, value*10] : value ? [-2*Math.abs(value), 2*Math.abs(value)] : [-1, 1],
      to = x => log ? lo*(hi/lo)**(x/200) : lo + (hi - lo)*x/200, from = v => 200*(log ? Math.log(v/lo)/Math.log(hi/lo) : (v - lo)/(hi - lo));
    const row = document.createElement("div"), label = document.createElement("label"), input = document.createElement("input"), out = document.createElement("output");
    row.className = "slider";
    input.type = "range"; input.min = 0; input.max = 200; input.step = 1; input.id = "value" + i;
    label.htmlFor = input.id; label.textContent = item.name;
    input.setAttribute("aria-label", item.name + (item.unit ? " in " + item.unit : ""));
    const show = v => { out.value = short(v) + (item.unit ? " " + item.unit : ""); input.setAttribute("aria-valuetext", out.value); };
    const now = settings.values[item.name] ?? value;
    input.value = clamp(from(now), 0, 200);
    show(now);
    input.oninput = () => {
      const was = settings.values[item.name];
      settings.values[item.name] = to(+input.value);
      if (!motion || begin(motion.state, motion.t)) show(to(+input.value));
      else { settings.values[item.name] = was; if (was === undefined) delete settings.values[item.name]; input.value = from(was ?? value); }
      share();
    };
    input.ondblclick = () => { delete settings.values[item.name]; input.value = from(value); show(value); go_on(); share(); };
    row.append(label, input, out);
    box.append(row);
  });
  probe.free();
  for (const [id, k] of [["over", 0], ["px", 0], ["py", 1]]) {
    const kept = $(id).value;
    $(id).textContent = "";
    names.outputs.forEach((o, i) => $(id).add(new Option(o.name, i)));
    $(id).value = kept !== "" && kept < names.outputs.length ? kept : Math.min(k, names.outputs.length - 1);
  }
}
function methods() {
  const kept = settings.method;
  $("method").textContent = "";
  $("method").add(new Option("automatic", ""));
  for (const name of lag.methods(scene)) $("method").add(new Option(name, name));
  $("method").value = kept;
  fine();
}
// The slider of accuracy: a tolerance 1e-3 to 1e-14, or a step of 1/10 to 1e-5 of the span.
function fine() {
  const steps = settings.method && takesSteps(), x = +$("fine").value/100;
  settings.fine = steps ? (span.t1 - span.t0)/50*10**(-3*x) : 10**(-3 - 11*x);
  $("finename").textContent = steps ? "step" : "tolerance";
  $("finevalue").value = short(settings.fine) + (steps ? " s" : "");
}
function effects() {
  const box = $("effects"), all = isOf($("scene").value), own = all[0].effects;
  box.textContent = "";
  for (const name of new Set(all.flatMap(p => p.effects))) {
    const label = document.createElement("label"), input = document.createElement("input");
    input.type = "checkbox"; input.value = name; input.checked = own.includes(name);
    input.onchange = () => { const now = motion && motion.state, t = motion && motion.t; choose(); if (!now || !begin(keep(now), t)) restart(); share(); };
    label.append(input, name);
    box.append(label);
  }
}
const keep = now => Object.fromEntries(Object.entries(now).filter(([name]) => names.state.includes(name)));

// ---- the motion over time
function record() {
  const row = {t: motion.t, x: motion.outputs};
  track.push(row);
  if (track.length > 4000) track.splice(0, 1000);
}
// For at most `time` [ms], so that a motion that is computed slower is shown slower.
function pass(seconds, time = Infinity) {
  const dir = $("back").checked ? -1 : 1, from = motion.t, t = from + dir*seconds*+$("speed").value, began = performance.now();
  try {
    if (motion.direction && motion.direction != dir) begin(motion.state, motion.t);
    motion.direction = dir;
    const ended = motion.advance_for(t, time) > 0;
    if (twin) twin.advance_for(motion.t, time);
    if (ended) { say("an event ends the motion at t = " + short(motion.t) + " s"); pause(); }
  } catch (e) { say(e.message); pause(); }
  spent += performance.now() - began;
  passed += Math.abs(motion.t - from);
  record();
}
function tick(now) {
  if (!playing) return;
  pass(clamp(now - before, 0, 100)/1000, 40);
  before = now;
  draw();
  requestAnimationFrame(tick);
}
function play() {
  if (playing) return;
  playing = true;
  before = performance.now();
  $("play").textContent = "Pause";
  requestAnimationFrame(tick);
}
function pause() { playing = false; $("play").textContent = "Play"; draw(); }

// ---- drawing
function paper(id) {
  const canvas = $(id), pen = canvas.getContext("2d"), ratio = devicePixelRatio || 1, w = canvas.clientWidth, h = canvas.clientHeight;
  if (canvas.width != Math.round(w*ratio) || canvas.height != Math.round(h*ratio)) { canvas.width = Math.round(w*ratio); canvas.height = Math.round(h*ratio); }
  pen.setTransform(ratio, 0, 0, ratio, 0, 0);
  pen.clearRect(0, 0, w, h);
  return {pen, w, h};
}
const ink = name => getComputedStyle(document.documentElement).getPropertyValue(name);
const nice = raw => { const p = 10**Math.floor(Math.log10(raw)), f = raw/p; return p*(f < 1.5 ? 1 : f < 3.5 ? 2 : f < 7.5 ? 5 : 10); };
function frame(x, y, lo, hi, xname, yname, pen, w, h) {
  const left = 52, foot = 26, X = v => left + (w - left - 8)*(v - lo[0])/(hi[0] - lo[0] || 1), Y = v => h - foot - (h - foot - 8)*(v - lo[1])/(hi[1] - lo[1] || 1);
  pen.font = "12px system-ui, sans-serif";
  pen.lineWidth = 1;
  const stepx = nice((hi[0] - lo[0] || 1)/Math.max(2, w/110)), stepy = nice((hi[1] - lo[1] || 1)/4);
  for (let k = Math.ceil(lo[0]/stepx); k*stepx <= hi[0]; k++) {
    pen.strokeStyle = ink("--grid"); pen.beginPath(); pen.moveTo(X(k*stepx), 8); pen.lineTo(X(k*stepx), h - foot); pen.stroke();
    pen.fillStyle = ink("--soft"); pen.textAlign = "center"; pen.fillText(short(k*stepx), X(k*stepx), h - foot + 12);
  }
  for (let k = Math.ceil(lo[1]/stepy); k*stepy <= hi[1]; k++) {
    pen.strokeStyle = ink("--grid"); pen.beginPath(); pen.moveTo(left, Y(k*stepy)); pen.lineTo(w - 8, Y(k*stepy)); pen.stroke();
    pen.fillStyle = ink("--soft"); pen.textAlign = "right"; pen.fillText(short(k*stepy), left - 4, Y(k*stepy) + 4);
  }
  pen.fillStyle = ink("--ink"); pen.textAlign = "right"; pen.fillText(xname, w - 10, h - 3);
  pen.textAlign = "left"; pen.fillText(yname, left + 4, 18);
  pen.save();
  pen.beginPath(); pen.rect(left, 4, w - left - 4, h - foot - 2); pen.clip();
  pen.strokeStyle = colours[0]; pen.lineWidth = 1.5; pen.beginPath();
  for (let k = 0; k < x.length; k++) pen[k ? "lineTo" : "moveTo"](X(x[k]), Y(y[k]));
  pen.stroke();
  pen.fillStyle = colours[1]; pen.beginPath(); pen.arc(X(x.at(-1)), Y(y.at(-1)), 4, 0, 7); pen.fill();
  pen.restore();
}
// With room around it; roundings of a constant are none, and would need more ticks than doubles can count.
const range = list => { let lo = Math.min(...list), hi = Math.max(...list); if (!(hi - lo > 1e-13*Math.max(hi, -lo))) { lo -= 0.5; hi += 0.5; } const m = 0.05*(hi - lo); return [lo - m, hi + m]; };
const titled = i => names.outputs[i] ? names.outputs[i].name + (names.outputs[i].unit ? " [" + names.outputs[i].unit + "]" : "") : "";
function plots() {
  const recent = track.slice(-1500);
  if (!recent.length || !names.outputs.length) return;
  const of = i => recent.map(r => r.x[i]), t = recent.map(r => r.t), a = +$("over").value, px = +$("px").value, py = +$("py").value;
  for (const [id, x, y, xn, yn] of [["series", t, of(a), "t [s]", titled(a)], ["phase", of(px), of(py), titled(px), titled(py)]]) {
    const {pen, w, h} = paper(id), rx = range(x), ry = range(y);
    frame(x, y, [rx[0], ry[0]], [rx[1], ry[1]], xn, yn, pen, w, h);
  }
}
function report() {
  const e = motion.charge(0), cost = motion.cost, lines = [];
  if (Number.isFinite(e.now)) lines.push("energy " + short(e.now) + " J, drift " + (Number.isFinite(e.drift) ? e.drift.toExponential(1) : "?"));
  lines.push((settings.method ? "" : "chosen: ") + motion.method + ", " + cost.steps + " steps, " + cost.calls + " right-hand sides" +
    (passed ? ", " + short(spent/passed) + " ms of computing a second" : ""));
  if (twin) {
    const a = Object.values(motion.state), b = Object.values(twin.state);
    lines.push("the twin is " + Math.hypot(...a.map((x, i) => x - b[i])).toExponential(1) + " away");
  }
  $("report").textContent = lines.join("\n");
  $("time").value = "t = " + motion.t.toFixed(2) + " s";
}
function draw() {
  if (!motion || !track.length) return;
  if (picture) picture.draw(track);
  plots();
  report();
}

// ---- sharing: the state of the controls is the address's fragment
function share() {
  if (location.protocol == "about:") return; // the frame of a playground has no address
  const said = {scene: $("scene").value, effects: wanted(), method: settings.method, fine: +$("fine").value, values: settings.values, start: settings.start};
  history.replaceState(null, "", "#" + encodeURIComponent(JSON.stringify(said)));
}
function shared() {
  try { return JSON.parse(decodeURIComponent(location.hash.slice(1))); } catch { return null; }
}
function save(name, type, text) {
  const a = document.createElement("a");
  a.href = typeof text == "string" ? URL.createObjectURL(new Blob([text], {type})) : text;
  a.download = name;
  a.click();
}

// ---- the machine, drawn as in `lagc animate` (io/page.html). run: {shapes, rows: [{t, x}] of a trial run, for its extent}
function machineOf(run) {
  const shapes = run.shapes, deep = shapes.some(s => s.a[2] >= 0 || s.b[2] >= 0 || s.turn[3] >= 0);
  const solid = shapes.filter(s => ["ball", "disc", "box", "body"].includes(s.kind));
  const moves = c => c >= 0 && run.rows.some(r => r.x[c] != run.rows[0].x[c]), carried = s => s.a.some(moves);
  const bodies = [solid.filter(carried), shapes.filter(s => s.kind == "path"), solid].find(l => l.length) || [];
  const dark = matchMedia("(prefers-color-scheme: dark)");
  const bright = ["#4aa3df", "#ff8f3f", "#2cc295", "#e6a3cb", "#f2b632", "#7cc9f2", "#b8ac2e", "#aaaaaa"];
  let rows = run.rows, at = rows.length - 1;
  const last = at, value = (c, k = at, other = 0) => c < 0 ? other : rows[Math.floor(k)].x[c];
  const place = (of, k = at) => of.map(c => value(c, k)), timeOf = k => rows[Math.floor(k)].t;
  const frameOf = t => { let k = rows.length - 1; while (k > 0 && (rows[k].t - t)*run.tick > 0) k--; return k; };
@DRAWING@
  return {
    deep, eye, bodies, toCanvas, place,
    inPlane: (x, y) => [(x - left)/scaleX, (top_ - y)/scaleY],
    draw(of) {
      rows = of;
      at = rows.length - 1;
      drawMachine();
    },
  };
}
let picture = null;
// A trial run over the span, for at most a fifth of a second, gives the extent of the picture.
function look() {
  const rows = [], began = performance.now(), parts = 300;
  try {
    const trial = new Motion(lag, scene, options(settings.start, NaN));
    for (let k = 0; k <= parts && performance.now() - began < 200; k++) {
      if (trial.advance_for(span.t0 + k*(span.t1 - span.t0)/parts, 100) > 0) k = parts;
      rows.push({t: trial.t, x: trial.outputs});
    }
    trial.free();
  } catch (e) { if (!rows.length) { say(e.message); return; } }
  picture = machineOf({shapes: lag.shapes(scene), rows, tick: 1, speed: 1, horizon: null, free: false, unit: ""});
}

// ---- dragging: the coordinates that bring the body nearest to the pointer with the least change, at rest
function dragged(body, to) {
  const names_ = names.state.filter(n => !n.includes("'") && names.state.includes(n + "'")), now = motion.state, t = motion.t;
  for (const n of names_) now[n + "'"] = 0;
  const at = values => {
    const m = new Motion(lag, scene, options(values, t));
    try { m.advance(t); const x = m.outputs; return {p: [x[body.a[0]], x[body.a[1]]], state: m.state}; } finally { m.free(); }
  };
  let here = at(now);
  for (let turn = 0; turn < 4; turn++) {
    const r = [to[0] - here.p[0], to[1] - here.p[1]], J = names_.map(n => {
      const h = 1e-6*(Math.abs(here.state[n]) || 1), p = at({...here.state, [n]: here.state[n] + h}).p;
      return [(p[0] - here.p[0])/h, (p[1] - here.p[1])/h];
    });
    let a = 0, b = 0, d = 0;
    for (const [x, y] of J) { a += x*x; b += x*y; d += y*y; }
    const soft = 1e-9*(a + d) + 1e-300;
    a += soft; d += soft;
    const det = a*d - b*b, u = (d*r[0] - b*r[1])/det, v = (a*r[1] - b*r[0])/det;
    const next = {...here.state};
    names_.forEach((n, k) => { next[n] += J[k][0]*u + J[k][1]*v; });
    here = at(next);
  }
  return here.state;
}
function pointers() {
  const canvas = $("picture"), spot = e => { const r = canvas.getBoundingClientRect(); return [e.clientX - r.left, e.clientY - r.top]; };
  let held = null, from = null, resumes = false;
  canvas.onpointerdown = e => {
    if (e.isTrusted) canvas.setPointerCapture(e.pointerId);
    from = spot(e);
    if (!picture || picture.deep) return;
    const far = b => { const [x, y] = picture.toCanvas(picture.place(b.a)); return Math.hypot(x - from[0], y - from[1]); };
    held = picture.bodies.filter(b => b.a[0] >= 0 && b.a[1] >= 0).sort((a, b) => far(a) - far(b)).find(b => far(b) < 40) || null;
    resumes = playing;
    if (held) pause();
  };
  canvas.onpointermove = e => {
    if (!from || !picture) return;
    const now = spot(e);
    if (held) {
      try { if (begin(dragged(held, picture.inPlane(...now)), motion.t)) { track = []; record(); draw(); } } catch (x) { say(x.message); }
      return;
    }
    if (picture.deep && !e.shiftKey) {
      picture.eye.turn -= (now[0] - from[0])/150;
      picture.eye.rise = clamp(picture.eye.rise + (now[1] - from[1])/150, -1.57, 1.57);
    } else { picture.eye.x += now[0] - from[0]; picture.eye.y += now[1] - from[1]; }
    from = now;
    draw();
  };
  canvas.onpointerup = canvas.onpointercancel = () => {
    if (held) { settings.start = motion.state; share(); if (resumes) play(); }
    held = from = null;
  };
  canvas.onwheel = e => { picture.eye.zoom = clamp(picture.eye.zoom*Math.exp(-e.deltaY/500), 0.1, 50); e.preventDefault(); draw(); };
}

// ---- the page

async function unpack(text) {
  const stream = new Blob([bytesOf(text)]).stream().pipeThrough(new DecompressionStream("gzip"));
  return WebAssembly.compile(await new Response(stream).arrayBuffer());
}
function wire() {
  $("play").onclick = () => playing ? pause() : play();
  $("step").onclick = () => { pause(); pass(1/60, 1000); draw(); };
  $("reset").onclick = restart;
  $("scene").onchange = () => { settings.values = {}; effects(); choose(); restart(); share(); };
  $("method").onchange = () => { settings.method = $("method").value; fine(); go_on(); share(); };
  $("fine").oninput = () => { fine(); go_on(); share(); };
  $("twin").onchange = go_on;
  for (const id of ["over", "px", "py"]) $(id).onchange = draw;
  $("link").onclick = async () => {
    share();
    try { await navigator.clipboard.writeText(location.href); say("the link is in the clipboard"); }
    catch { say(location.href); }
  };
  $("png").onclick = () => save("motion.png", "", $("picture").toDataURL());
  $("csv").onclick = () => save("motion.csv", "text/csv", ["t [s]", ...names.outputs.map((_, i) => titled(i))].join(",") + "\n" +
    track.map(r => [r.t, ...r.x].join(",")).join("\n") + "\n");
  $("lag").onclick = () => save("model.lag", "text/plain", model.source);
  document.onkeydown = e => {
    const tag = e.target.tagName;
    if (e.ctrlKey || e.altKey || e.metaKey || tag == "SELECT" || tag == "INPUT") return;
    if (e.key == " " && tag != "BUTTON") $("play").click();
    else if (e.key == "ArrowRight") $("step").click();
    else if (e.key == "Home" || e.key == "r") restart();
    else return;
    e.preventDefault();
  };
  pointers();
  $("trace").onchange = draw;
  new ResizeObserver(draw).observe($("picture"));
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", draw);
}
// The model's scenes, with one chosen, its effects, equations and text.
function offer(chosen) {
  $("scene").textContent = "";
  for (const name of new Set(model.programs.map(p => p.scene))) $("scene").add(new Option(name, name));
  if (isOf(chosen).length) $("scene").value = chosen;
  effects();
  $("source").textContent = model.source;
  $("equations").querySelector("pre").textContent = model.equations;
}
// Another model from its start, in the same scene where it has that.
function load(other) {
  const chosen = $("scene").value;
  model = other;
  Object.assign(settings, {method: "", values: {}, start: {}});
  offer(chosen);
  choose();
  restart();
}
async function main() {
  if (typeof WebAssembly == "undefined") return say("this browser has no WebAssembly, with which the page computes");
  const said = shared();
  wasm = await unpack(packed);
  offer(said && said.scene);
  if (said) {
    settings.values = said.values || {};
    settings.start = said.start || {};
    settings.method = said.method || "";
    $("fine").value = said.fine ?? $("fine").value;
    for (const box of document.querySelectorAll("#effects input")) box.checked = (said.effects || []).includes(box.value);
  } else $("fine").value = 55;
  choose();
  wire();
  restart();
  if (said && Number.isFinite(said.t)) { // shows that time, paused
    try {
      for (let k = 1, from = motion.t; k <= 200; k++) { motion.advance(from + (said.t - from)*k/200); record(); }
    } catch (e) { say(e.message); }
    pause();
    document.body.dataset.state = JSON.stringify(motion.state);
  } else if (!matchMedia("(prefers-reduced-motion: reduce)").matches) play();
  else pause();
}
// The page for other scripts: window.lagc.motion.state, .set("g", 3.7), .play(), .pause(), .reset(), .pass(seconds).
window.lagc = {
  get motion() { return motion; }, get picture() { return picture; }, get playing() { return playing; }, play, pause, reset: restart, load,
  pass(seconds) { pass(seconds); draw(); },
  set(name, value) { settings.values[name] = value; go_on(); },
};
main().catch(e => say(e.message));
