// The live page: controls, clocks and plots around motion.js. Enters: model, parts and packed of live.html; leaves: the page.
const $ = id => document.getElementById(id);
const clamp = (x, lo, hi) => Math.min(hi, Math.max(lo, x));
const ENDED = 2, LATE = 3; // of Motion.advance
const short = x => !Number.isFinite(x) ? "?" : x && (Math.abs(x) >= 1e6 || Math.abs(x) < 1e-3) ? (+x.toPrecision(4)).toExponential().replace("e+", "e") : String(+x.toPrecision(4));
const named_unit = unit => unit == "1" ? "" : unit;

// motion: what is shown; twin: from a start 1e-9 aside; finer: with more digits, for the estimate of the error. track: rows {t, x} of the columns.
let lag, motion, twin, finer, program, scene, items, bytes, more = {}, wasm, playing = false, before = 0, track = [], columns = [];
let spent = 0, passed = 0, slow = 0, piece = 1, horizon = null, doubtful = 0, scale = [];
const section = {x: [], y: []};
const settings = {method: "", fine: 1e-9, values: {}, start: {}};
const span = {t0: 0, t1: 20};
let over = 0, landed = 0; // the direction in which the motion does not go on: it failed; an event of the model ended it, also with other values
let pace = 1, unit = 1, unitName = "s"; // seconds of the motion in one of watching; the unit of time that is shown

const isOf = name => more.programs.filter(p => p.scene == name);
const wanted = () => [...document.querySelectorAll("#effects input:checked")].map(e => e.value);
const sameSet = (a, b) => a.length == b.length && a.every(x => b.includes(x));

function say(text, kind = "fault") { $("said").textContent = text; $("said").className = kind; }
function tell(text) { $("status").textContent = text; }
const wrong = e => e instanceof WebAssembly.RuntimeError ? "the program is damaged (" + e.message + ")" : e.message;

// ---- motions
const own_method = () => lag.text(lag.f.lag_scene_method(scene)) || "";
const takesSteps = () => !!lag.word(settings.method || own_method(), at => lag.f.page_takes_steps(at));
function options(values, t, finer = 1) {
  const steps = takesSteps(), fine = settings.fine/finer;
  return {method: settings.method, tol: steps ? 0 : Math.max(fine, 1e-15), step: steps ? fine : 0, until: span.t1, t, values: {...settings.values, ...values}};
}
function end_beside() {
  for (const other of [twin, finer]) if (other) other.free();
  twin = finer = null;
}
// The twin and the finer motion begin beside the motion.
function begin_beside() {
  end_beside();
  const now = state(), first = Object.keys(now)[0];
  if ($("twin").checked && first) twin = new Motion(lag, scene, options({...now, [first]: now[first] + 1e-9*(Math.abs(now[first]) || 1)}, motion.t));
  if ($("estimate").checked) finer = new Motion(lag, scene, options(now, motion.t, takesSteps() ? 4 : 10));
  for (const other of [twin, finer]) if (other) { other.advance(other.t); other.direction = motion.direction; }
  look_at();
}
// Reads what is shown of the motion and the twin.
function look_at() { for (const m of [motion, twin]) if (m) { m.now = m.values; m.row = m.outputs; } }
// A new motion from `values`, at time t; the old one stays where that is refused.
function begin(values, t = NaN) {
  try {
    const next = new Motion(lag, scene, options(values, t));
    try { next.advance(next.t); } catch (e) { next.free(); throw e; }
    if (motion) motion.free();
    motion = next;
    horizon = null;
    over = doubtful = spent = passed = slow = 0;
    say("");
    begin_beside();
  } catch (e) { say(wrong(e)); return false; }
  return true;
}
const state = () => Object.fromEntries(Object.entries(motion.state).filter(([name]) => names.state.includes(name)));
// Goes on from the present state with what has changed.
function go_on() {
  const done = !motion || begin(state(), motion.t);
  if (done && motion) { section.x = []; section.y = []; draw(); }
  return done;
}
function restart() {
  clear();
  if (begin(settings.start)) { record(); draw(); starts(); }
}
function clear() {
  track = [];
  scale = [];
  landed = 0;
  section.x = []; section.y = [];
}

const names = {outputs: [], state: []};
function choose() {
  const all = isOf($("scene").value), found = all.find(p => sameSet(p.effects, wanted())) || all[0];
  if (found == program) return;
  end_beside();
  const changed = !!program;
  program = found;
  $("doc").textContent = found.doc;
  lag = new Lag(wasm);
  scene = lag.open(bytes.subarray(found.at, found.at + found.n))[0];
  motion = null;
  items = lag.items(scene, "p").map((item, i) => ({...item, sign: lag.f.page_sign(scene, i)}));
  const s = lag.span(scene);
  span.t0 = s.t0; span.t1 = s.t1 != s.t0 ? s.t1 : s.t0 + 20;
  piece = Math.abs(span.t1 - span.t0);
  [unit, unitName] = unitFor(piece, 2, 0.02);
  pace = piece >= 1 && piece <= 90 ? 1 : unit*nice(piece/unit/20);
  controls();
  methods();
  if (changed) { // values of what is off now
    const known = new Set([...items.map(item => item.name), ...names.state]);
    for (const of of [settings.values, settings.start]) for (const name in of) if (!known.has(name)) delete of[name];
  }
  look();
}

// ---- controls
function row_of(name, unit, attributes) {
  const row = document.createElement("div"), label = document.createElement("label"), input = document.createElement("input"), out = document.createElement("output");
  row.className = "slider";
  Object.assign(input, {type: "range", min: 0, max: 200, step: 1, ...attributes});
  label.htmlFor = input.id; label.textContent = name;
  input.setAttribute("aria-label", name + (unit ? " in " + unit : ""));
  row.append(label, input, out);
  return {row, input, show: v => { out.value = short(v) + (unit ? " " + unit : ""); input.setAttribute("aria-valuetext", out.value); }};
}
// The slider of parameter i, whose value in the scene is `value`: in proportion where it is declared > 0.
function slider(item, i, value) {
  const log = value > 0 && item.sign == 1, most = 2*Math.abs(value) || 1, [lo, hi] = log ? [value/10, value*10] : [item.sign > 0 ? 0 : -most, item.sign < 0 ? 0 : most];
  const to = x => log ? lo*(hi/lo)**(x/200) : lo + (hi - lo)*x/200, from = v => clamp(200*(log ? Math.log(v/lo)/Math.log(hi/lo) : (v - lo)/(hi - lo)), 0, 200);
  const {row, input, show} = row_of(item.name, named_unit(item.unit), {id: "value" + i}), now = () => settings.values[item.name] ?? value;
  const set = v => { input.value = from(v); show(v); };
  set(now());
  input.oninput = () => {
    const was = settings.values[item.name], v = to(+input.value);
    settings.values[item.name] = v;
    if (!motion || begin(state(), motion.t)) { show(v); light(item.name); draw(); }
    else {
      if (was === undefined) delete settings.values[item.name]; else settings.values[item.name] = was;
      set(now());
      say($("said").textContent + "; " + item.name + " = " + short(v) + ": " + word("range"));
    }
    share();
  };
  input.ondblclick = () => { delete settings.values[item.name]; set(value); go_on(); share(); };
  return row;
}
// Columns that can be plotted: outputs, components of the state, charges, and the distance of the twin.
function find_columns(probe) {
  const outputs = probe.names("page_output").slice(0, probe.count - lag.f.page_drawn(scene));
  names.outputs = outputs;
  names.state = probe.components.map(n => n.name);
  columns = outputs.map((o, i) => ({...o, unit: named_unit(o.unit), of: m => m.row[i]}));
  const known = new Set(outputs.map(o => o.name)), half = names.state.length >> 1;
  probe.components.forEach((c, i) => { if (i % half < 60 && !known.has(c.name)) columns.push({...c, unit: named_unit(c.unit), of: m => m.now[i]}); });
  for (let k = 0, found; k < 12 && (found = probe.charge_name(k)); k++)
    if (!known.has(found[0])) {
      columns.push({name: found[0], unit: found[1], of: m => lag.f.page_charge(m.sim, k, 0)});
      columns.push({name: word("drift") + " " + found[0], unit: "", of: m => lag.f.page_charge(m.sim, k, 1)});
    }
  columns.push({name: word("distance"), unit: "", of: () => twin ? Math.hypot(...motion.now.map((x, i) => x - twin.now[i])) : NaN});
}
function fill(id, list, at) {
  const kept = $(id).selectedOptions[0]?.text;
  $(id).textContent = "";
  for (const [text, value] of list) $(id).add(new Option(text, value));
  $(id).value = (list.find(([text]) => text == kept) || [0, at])[1];
}
function controls() {
  const probe = new Motion(lag, scene, {until: span.t1}), p = lag.parameters(probe.sim, items.length);
  find_columns(probe);
  probe.free();
  $("values").replaceChildren(...items.map((item, i) => slider(item, i, (p[i] - item.offset)/item.factor)));
  const list = columns.map((c, i) => [c.name, i]), first = names.state[0], at = name => columns.findIndex(c => c.name == name);
  const x = Math.max(0, at(first)), rate = at(first + "'");
  fill("over", list, 0);
  fill("px", list, x);
  fill("py", list, rate >= 0 ? rate : Math.min(1, columns.length - 1));
  fill("section", [[word("none"), -1], ...list.map(([text, i]) => [text + word("rises"), i])], -1);
}
// Numbers of the start, for keyboards: what dragging sets.
function starts() {
  if (!motion) return;
  const now = {...state(), ...settings.start};
  $("start").replaceChildren(...motion.components.slice(0, 24).map(({name, unit}) => {
    const label = document.createElement("label"), input = document.createElement("input");
    Object.assign(input, {type: "number", step: "any", value: +now[name].toPrecision(6)});
    input.setAttribute("aria-label", word("start") + " " + name + (unit ? " in " + unit : ""));
    input.onchange = () => {
      const was = settings.start;
      settings.start = {...state(), ...was, [name]: +input.value};
      clear();
      if (begin(settings.start)) { record(); draw(); share(); }
      else { settings.start = was; input.value = +now[name].toPrecision(6); }
    };
    label.append(name + (unit ? " [" + unit + "]" : ""), input);
    return label;
  }));
}
function methods() {
  const kept = settings.method;
  fill("method", [[own_method() || word("automatic"), ""], ...lag.methods(scene).map(m => [m, m])], "");
  $("method").value = kept;
  settings.method = $("method").value;
  fine();
}
// The slider of accuracy: a tolerance 1e-3 to 1e-14, or a step of 1/50 to 1/50000 of the span; at first the scene's own, but
// or that of `lagc run`, but no tolerance below 1e-10: motions are watched.
function fine() {
  const steps = takesSteps(), most = Math.abs(span.t1 - span.t0)/50, x = +$("fine").value/100;
  const own = settings.method || settings.moved ? 0 : steps ? lag.f.page_step(scene) : Math.max(1e-10, lag.f.page_tolerance(scene) || 1e-9);
  settings.fine = own > 0 ? own : steps ? most*10**(-3*x) : 10**(-3 - 11*x);
  if (own > 0) $("fine").value = 100*(steps ? Math.log10(most/own)/3 : (-3 - Math.log10(own))/11);
  $("finename").textContent = word(steps ? "stepsize" : "tolerance");
  $("finevalue").value = short(settings.fine) + (steps ? " s" : "");
  $("fine").setAttribute("aria-valuetext", $("finevalue").value);
}
function effects() {
  const box = $("effects"), all = isOf($("scene").value), own = all[0].effects;
  box.textContent = "";
  for (const name of new Set(all.flatMap(p => p.effects))) {
    const label = document.createElement("label"), input = document.createElement("input");
    input.type = "checkbox"; input.value = name; input.checked = own.includes(name);
    input.onchange = () => {
      const now = motion && motion.state, t = motion && motion.t;
      choose();
      if (now && begin(Object.fromEntries(Object.entries(now).filter(([n]) => names.state.includes(n))), t)) { clear(); record(); draw(); } else restart();
      share();
    };
    label.append(input, name);
    box.append(label);
  }
}

// ---- equations
function light(name) {
  if (!$("equations").open) return;
  const want = typeset(more.letters[name] || "").join(""), probe = document.createElement("div");
  probe.innerHTML = "<math>" + want + "</math>";
  const same = probe.firstChild.innerHTML;
  for (const e of document.querySelectorAll(".lit")) e.classList.remove("lit");
  for (const e of $("listing").querySelectorAll("mi, msub, mover")) if (e.outerHTML == same) e.closest("math").classList.add("lit");
}
function equations() {
  if ($("listing").firstChild) return;
  $("listing").innerHTML = more.latex ? typeset_listing(more.latex, word("headings")) : "";
  if (!more.latex) $("listing").textContent = word("long");
}

// ---- the motion over time
function record() {
  look_at();
  const row = {t: motion.t, x: motion.row, y: columns.map(c => c.of(motion)), twin: twin && columns.map(c => c.of(twin))}, last = track.at(-1);
  estimate();
  track.push(row);
  if (track.length > 4000) track.splice(0, 1000);
  const k = +$("section").value;
  if (k >= 0 && last && Math.abs(row.t - last.t) > 0) cross(k, last, row, (row.t - last.t)*(span.t1 - span.t0) < 0 ? -1 : 1);
}
// A point of the section where column k rises through 0 between two rows; an angle, through a multiple of a turn.
function cross(k, a, b, dir) {
  const turn = columns[k].unit == "rad" ? 2*Math.PI : columns[k].unit == "deg" ? 360 : 0, [from, to] = dir > 0 ? [a, b] : [b, a];
  const f = turn ? turn*Math.ceil((from.y[k] + 1e-300)/turn) : 0, [p, q] = [from.y[k] - f, to.y[k] - f];
  if (!(p < 0 && q >= 0)) return;
  const s = p/(p - q), within = (x, c) => columns[c].unit == "rad" ? x - 2*Math.PI*Math.round(x/2/Math.PI) : x, at = c => within(from.y[c] + s*(to.y[c] - from.y[c]), c);
  section.x.push(at(+$("px").value)); section.y.push(at(+$("py").value));
  if (section.x.length > 20000) { section.x.splice(0, 5000); section.y.splice(0, 5000); }
}
// The error: the distance of the finer motion, by the largest value of each component so far. Past 0.1, ten rows long, no digit is left.
let error = 0;
function estimate() {
  error = 0;
  motion.now.forEach((x, i) => { scale[i] = Math.max(scale[i] || 0, Math.abs(x)); });
  if (!finer) return;
  const all = Math.max(...scale)*1e-3 || 1;
  finer.values.forEach((x, i) => { error = Math.max(error, Math.abs(x - motion.now[i])/Math.max(scale[i], all)); });
  doubtful = error > 0.1 ? doubtful + 1 : 0;
  if (horizon === null && doubtful >= 10) horizon = track.at(-9)?.t ?? motion.t;
}
// A motion beside that takes far longer than the motion is given up.
function beside(t) {
  for (const other of [twin, finer]) if (other && other.advance(t, 0.1) == LATE) {
    $(other == twin ? "twin" : "estimate").checked = false;
    begin_beside();
    say(word("dear"), "note");
    return;
  }
}
const heading = () => $("back").checked ? -1 : 1, stands = () => [over, landed].includes(heading());
// Goes on by so many seconds of watching, in pieces that take a few milliseconds; past the time that drawing leaves of a frame, the rest is left out.
function pass(seconds) {
  if (!motion || stands()) return;
  const dir = heading(), from = motion.t, asked = seconds*pace*+$("speed").value, goal = from + dir*asked, began = performance.now();
  const parts = clamp(Math.round(60*asked/pace), 1, 8), budget = clamp(15 - drawing, 5, 25);
  try {
    if (motion.direction && motion.direction != dir) begin(state(), motion.t);
    motion.direction = dir;
    for (let done = false; !done && (goal - motion.t)*dir > 0;) {
      const a = performance.now(), step = Math.min(piece, asked/parts), rest = Math.abs(goal - motion.t), status = motion.advance(rest <= 1.01*step ? goal : motion.t + dir*step, budget/1000), ended = status == ENDED;
      beside(motion.t);
      record();
      const took = performance.now() - a;
      if (took > 8) piece = Math.max(Math.min(piece, step)/2, 1e-7*Math.abs(span.t1 - span.t0));
      else if (took < 3) piece = Math.min(2*piece, Math.abs(span.t1 - span.t0));
      if (ended) { say(word("ended") + " " + short(motion.t) + " s. " + word("again"), "note"); landed = dir; pause(); }
      done = ended || performance.now() - began > budget;
    }
  } catch (e) {
    const why = wrong(e);
    say((/^at t = /.test(why) ? "" : word("failed") + " " + short(motion.t) + " s: ") + why + ". " + word("again"));
    record();
    over = dir;
    pause();
  }
  spent += performance.now() - began;
  passed += Math.abs(motion.t - from)/pace;
  slow = 0.9*slow + 0.1*(Math.abs(goal - motion.t) > 0.01*asked);
  if (slow > 0.5 && finer) { $("estimate").checked = false; end_beside(); begin_beside(); horizon = null; say(word("dear"), "note"); }
}
function tick(now) {
  if (!motion) pause(); // no start was accepted
  if (!playing) return;
  pass(clamp(now - before, 0, 100)/1000);
  before = now;
  draw();
  if (playing) requestAnimationFrame(tick);
}
function play() {
  if (playing || !motion) return;
  if (stands()) restart();
  playing = true;
  before = performance.now();
  named_play();
  tell(word("playing"));
  requestAnimationFrame(tick);
}
function pause() {
  playing = false;
  named_play();
  tell($("play").textContent + ", " + word("now") + " " + short(motion ? motion.t : 0) + " s: " + columns.slice(0, 3).map((c, i) => titled(i) + " = " + short(track.at(-1)?.y[i])).join(", "));
  draw();
}
const named_play = () => { $("play").textContent = word(playing ? "pause" : "play"); };

// ---- drawing
const titled = i => columns[i] ? columns[i].name + (columns[i].unit ? " [" + columns[i].unit + "]" : "") : "";
function plots() {
  const recent = track.slice(-1500), of = i => recent.map(r => r.y[i]), a = +$("over").value, px = +$("px").value, py = +$("py").value;
  if (!recent.length || !columns.length || document.body.classList.contains("plain")) return;
  plot_series(recent.map(r => r.t/unit), of(a), twin && recent.map(r => r.twin ? r.twin[a] : NaN), titled(a), unitName, horizon === null ? null : horizon/unit, motion.direction || 1);
  plot_phase(of(px), of(py), titled(px), titled(py), +$("section").value >= 0 ? section : null);
}
function report() {
  const e = motion.charge(0), named = motion.charge_name(0), cost = motion.cost, lines = [];
  if (Number.isFinite(e.now)) lines.push(word("energy") + " " + short(e.now) + (named && named[1] ? " " + named[1] : "") + ", " + word("drift") + " " + (Number.isFinite(e.drift) ? e.drift.toExponential(1) : "?"));
  lines.push((settings.method || own_method() ? "" : word("chosen")) + motion.method + ", " + cost.steps + " " + word("steps") + ", " + cost.calls + " " + word("calls") +
    (passed ? ", " + short(spent/passed) + " " + word("cost") : ""));
  if (horizon !== null) lines.push(word("lost") + " " + short(horizon) + " s");
  else if (finer) lines.push(word("error") + " " + (error < 1e-16 ? "1e-16" : error.toExponential(0)));
  if (twin) lines.push(word("apart") + " " + Math.hypot(...motion.now.map((x, i) => x - twin.now[i])).toExponential(1));
  if (slow > 0.5) lines.push(word("slower"));
  $("report").textContent = lines.join("\n");
}
function numbers() {
  if (!$("now").open || !track.length) return;
  $("numbers").replaceChildren(...columns.slice(0, 30).map((c, i) => {
    const row = document.createElement("div"), name = document.createElement("dt"), value = document.createElement("dd");
    name.textContent = c.name;
    value.textContent = short(track.at(-1).y[i]) + (c.unit ? " " + c.unit : "");
    row.append(name, value);
    return row;
  }));
}
let told = 0, plotted = 0, drawing = 0; // drawing: what the picture takes [ms], a mean
// The picture each frame; while it plays, plots ten times a second, words five times.
function draw() {
  const now = performance.now();
  if (!motion || !track.length) return;
  if (machine) machine.horizon = horizon;
  if (picture) {
    picture.draw(track);
    drawing += (performance.now() - now - drawing)/8;
    follow(now);
  }
  if (playing && now - plotted < 95) return;
  plotted = now;
  plots();
  $("time").value = "t = " + (motion.t/unit).toFixed(Math.abs(span.t1 - span.t0)/unit < 2 ? 4 : 2) + " " + unitName +
    (pace == 1 ? "" : " (1 s " + word("shows") + " " + short(pace*+$("speed").value/unit) + " " + unitName + ")");
  if (playing && now - told < 195) return;
  told = now;
  report();
  numbers();
}

// ---- sharing: the state of the controls is the address's fragment
function share() {
  const said = {scene: $("scene").value, effects: wanted(), method: settings.method, fine: settings.moved ? +$("fine").value : undefined, values: settings.values, start: settings.start, lang: language};
  try { history.replaceState(null, "", "#" + encodeURIComponent(JSON.stringify(said))); } catch { /* a frame without an address */ }
}
function shared() {
  try { return JSON.parse(decodeURIComponent(location.hash.slice(1))); } catch { return null; }
}
function save(name, type, text) {
  const a = document.createElement("a");
  a.href = typeof text == "string" && type ? URL.createObjectURL(new Blob([text], {type})) : text;
  a.download = name;
  a.click();
}
async function copy(text, said) {
  try { await navigator.clipboard.writeText(text); say(word(said), "note"); } catch { say(text, "note"); }
}
// The picture on its background.
function picture_url() {
  const from = $("picture"), to = document.createElement("canvas"), pen = to.getContext("2d");
  to.width = from.width; to.height = from.height;
  pen.fillStyle = ink("--back"); pen.fillRect(0, 0, to.width, to.height);
  pen.drawImage(from, 0, 0);
  return to.toDataURL();
}

// ---- the machine, drawn as in `lagc animate` (io/page.html). run: {shapes, rows: [{t, x}] of a trial run, for its extent}
function machineOf(run) {
  const shapes = run.shapes, deep = shapes.some(s => s.a[2] >= 0 || s.b[2] >= 0 || s.turn[3] >= 0);
  const solid = shapes.filter(s => ["ball", "disc", "box", "body"].includes(s.kind));
  const moves = c => c >= 0 && run.rows.some(r => r.x[c] != run.rows[0].x[c]), carried = s => s.a.some(moves);
  const bodies = [solid.filter(carried), shapes.filter(s => s.kind == "path"), solid].find(l => l.length) || [];
  let rows = run.rows, at = rows.length - 1;
  const last = at, value = (c, k = at, other = 0) => c < 0 ? other : rows[Math.floor(k)].x[c];
  const place = (of, k = at) => of.map(c => value(c, k)), timeOf = k => rows[Math.floor(k)].t;
  const frameOf = t => { let k = rows.length - 1; while (k > 0 && (rows[k].t - t)*run.tick > 0) k--; return k; };
@DRAWING@
  return {
    deep, eye, bodies, toCanvas, place,
    // Of a place and where the pointer took it: how places project to lengths on the screen, and where the pointer's places lie there.
    screen(p, from) {
      const [c, s, r, u] = [Math.cos(eye.turn), Math.sin(eye.turn), Math.sin(eye.rise), Math.cos(eye.rise)], there = toCanvas(p);
      const project = deep ? q => [q[1]*c - q[0]*s, q[2]*u - (q[0]*c + q[1]*s)*r] : q => [q[0], q[1]], at = project(p);
      return [project, to => [at[0] + (to[0] - there[0])/scaleX, at[1] - (to[1] - there[1])/scaleY]];
    },
    inPlane: (x, y) => [(x - left)/scaleX, (top_ - y)/scaleY],
    draw(of) {
      rows = of;
      at = rows.length - 1;
      drawMachine();
    },
  };
}
let picture = null, machine = null;
// A trial run over the span, for at most a fifth of a second, 20 rows at least for slow machines, gives the extent of the picture.
function look() {
  const rows = [], began = performance.now(), parts = 300, step = (span.t1 - span.t0)/parts;
  try {
    const trial = new Motion(lag, scene, options(settings.start, NaN));
    for (let k = 0; k <= parts && (k < 20 || performance.now() - began < 200); k++) {
      if (trial.advance(span.t0 + k*step, 0.2)) k = parts;
      rows.push({t: trial.t, x: trial.outputs});
    }
    trial.free();
  } catch (e) { if (!rows.length) { say(wrong(e)); return; } }
  const eye = picture && picture.eye, shapes = lag.shapes(scene);
  machine = {shapes, rows, tick: 1, speed: pace, horizon: null, free: false, unit: ""};
  picture = machineOf(machine);
  if (eye) Object.assign(picture.eye, eye);
}
// Another extent, twice a second, where a body has left the picture that nobody has moved or zoomed.
let looked = 0;
function follow(now) {
  const eye = picture.eye, outside = b => { const [x, y] = picture.toCanvas(picture.place(b.a)), c = $("picture"); return x < 0 || y < 0 || x > c.clientWidth || y > c.clientHeight; };
  if (!playing || now - looked < 500 || eye.zoom != 1 || eye.x || eye.y) return;
  looked = now;
  if (!picture.bodies.some(outside)) return;
  machine.rows = [...machine.rows, ...track];
  picture = machineOf(machine);
  Object.assign(picture.eye, eye);
  machine.rows = [...machine.rows.filter((_, k) => k % 2 == 0).slice(-2000), track.at(-1)];
}

// ---- the page
function wire() {
  $("play").onclick = () => playing ? pause() : play();
  $("step").onclick = () => { pause(); pass(1/60); draw(); };
  $("reset").onclick = restart;
  $("scene").onchange = () => { settings.moved = false; settings.values = {}; settings.start = {}; effects(); choose(); restart(); share(); };
  $("method").onchange = () => {
    const was = settings.method, use = name => { $("method").value = settings.method = name; fine(); };
    use($("method").value);
    if (!go_on()) use(was); // refused: the one before goes on
    share();
  };
  $("fine").oninput = () => { settings.moved = true; fine(); go_on(); share(); };
  $("twin").onchange = $("estimate").onchange = () => { slow = 0; horizon = null; if (motion) { begin_beside(); draw(); } };
  for (const id of ["over", "px", "py", "section"]) $(id).onchange = () => { if (id != "over") section.x = [], section.y = []; draw(); };
  $("link").onclick = () => { share(); copy(location.href, "copied"); };
  $("embed").onclick = () => { share(); copy('<iframe width="480" height="360" src="' + location.href.replace(/(\?[^#]*)?(#|$)/, "?controls=0$2") + '"></iframe>', "framed"); };
  $("png").onclick = () => save("motion.png", "", picture_url());
  $("csv").onclick = () => save("motion.csv", "text/csv", ["t [s]", ...columns.map((_, i) => titled(i))].map(s => s.includes(",") ? '"' + s + '"' : s).join(",") + "\n" + track.map(r => [r.t, ...r.y].join(",")).join("\n") + "\n");
  $("lag").onclick = () => save("model.lag", "text/plain", model.source);
  $("print").onclick = () => print();
  $("equations").ontoggle = equations;
  $("now").ontoggle = numbers;
  $("language").onchange = () => { speak($("language").value); named_play(); $("listing").textContent = ""; if ($("equations").open) equations(); if (lag) { controls(); methods(); draw(); starts(); share(); } };
  addEventListener("hashchange", () => location.reload());
  addEventListener("beforeprint", () => { document.documentElement.classList.add("paper"); draw(); });
  addEventListener("afterprint", () => { document.documentElement.classList.remove("paper"); draw(); });
  document.onkeydown = e => {
    const tag = e.target.tagName;
    if (e.ctrlKey || e.altKey || e.metaKey || tag == "SELECT" || tag == "INPUT" || tag == "SUMMARY") return;
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
// Without WebAssembly: what `lagc animate` recorded.
function show_recording(run) {
  for (const e of document.querySelectorAll("aside, #effects, #now, #step, #scene")) e.hidden = true;
  say(word(run ? "no_wasm" : "no_record"));
  if (!run) return;
  const held = [], moving = [], rows = [];
  for (let c = 0; 2*c < run.cols.length; c++) held.push(run.cols[2*c + 1] ? moving.push(c) - 1 : -1);
  for (let k = 0, t = run.t0; k < run.frames; t += run.tick*run.dt[k++])
    rows.push({t, x: held.map((h, c) => h < 0 ? run.cols[2*c] : run.cols[2*c] + run.cols[2*c + 1]*run.v[moving.length*k + h])});
  const shapes = run.shapes.map(([kind, role, text, count, a, b, size, turn]) => ({kind, role, text, count, a, b, size, turn}));
  picture = machineOf({shapes, rows, tick: Math.sign(run.tick), speed: run.speed, horizon: run.horizon, free: false, unit: run.unit});
  let at = 0, last = performance.now();
  const show = () => { const n = rows.filter(r => (r.t - run.t0)*Math.sign(run.tick) <= at).length; picture.draw(rows.slice(0, Math.max(1, n))); $("time").value = "t = " + rows[Math.max(0, n - 1)].t.toFixed(2) + " s"; };
  const step = now => {
    if (!playing) return;
    at = (at + (now - last)/1000*run.speed*+$("speed").value) % Math.abs(run.t1 - run.t0);
    last = now;
    show();
    requestAnimationFrame(step);
  };
  $("play").onclick = () => { playing = !playing; named_play(); last = performance.now(); requestAnimationFrame(step); };
  $("reset").onclick = () => { at = 0; show(); };
  show();
  $("play").click();
}
// Takes a model: its scenes, with one chosen, its effects, equations and text.
async function offer(chosen) {
  bytes = model.raw !== undefined ? bytes_of(model.raw) : unpacked(bytes_of(parts));
  more = JSON.parse(new TextDecoder().decode(bytes.subarray(model.more[0], model.more[0] + model.more[1])));
  $("source").textContent = model.source;
  $("scene").textContent = "";
  for (const name of new Set(more.programs.map(p => p.scene))) $("scene").add(new Option(name, name));
  if (isOf(chosen).length) $("scene").value = chosen;
  effects();
}
// Another model from its start, in the same scene where it has that; after the page has begun.
async function load(other) {
  await begun;
  const chosen = $("scene").value, before = program && bytes.subarray(program.at, program.at + program.n);
  model = other;
  await offer(chosen);
  if ($("equations").open) equations();
  const same = motion && isOf($("scene").value).find(p => p.n == before.length && before.every((x, i) => x == bytes[p.at + i]));
  if (same) { // a playground's first scene comes before the others
    for (const box of document.querySelectorAll("#effects input")) box.checked = same.effects.includes(box.value);
    program = same;
    return;
  }
  Object.assign(settings, {method: "", values: {}, start: {}, moved: false});
  choose();
  restart();
}
async function main() {
  const said = shared(), query = new URLSearchParams(location.search);
  speak(query.get("lang") || said?.lang || navigator.language.slice(0, 2));
  $("language").value = language;
  if (query.get("controls") == "0") document.body.classList.add("plain");
  named_play();
  await offer(said?.scene);
  if (typeof WebAssembly == "undefined") return show_recording(more.recording);
  wasm = await WebAssembly.compile(unpacked(bytes_of(packed)));
  $("fine").value = 55;
  if (said) {
    for (const of of ["values", "start"]) settings[of] = Object.fromEntries(Object.entries(said[of] || {}).map(([n, v]) => [n, typeof v == "number" ? v : NaN]));
    settings.method = said.method || "";
    settings.moved = said.fine !== undefined;
    $("fine").value = said.fine ?? 55;
    for (const box of document.querySelectorAll("#effects input")) box.checked = [said.effects].flat().includes(box.value);
  }
  choose();
  wire();
  restart();
  if (!motion && said) { // the address asks for what the model refuses
    const why = $("said").textContent;
    Object.assign(settings, {values: {}, start: {}, method: ""});
    program = null;
    choose();
    restart();
    say(why + ". " + word("address"));
  }
  const odd = said ? [said.scene, said.method, said.effects ?? []].flat().filter(x => x && ![$("scene").value, settings.method, ...wanted()].includes(x)) : [];
  if (odd.length && motion && !$("said").textContent) say(odd.join(", ") + "? " + word("address"));
  $("equations").open = innerWidth > 720 && more.latex && more.latex.length < 3000;
  if (said && Number.isFinite(said.t) && motion) { // shows that time, paused
    if (Math.abs(said.t - motion.t) > 100*Math.abs(span.t1 - span.t0)) say("t = " + short(said.t) + " s: " + word("far"));
    else try {
      for (let k = 1, from = motion.t, until = performance.now() + 5000; k <= 200; k++) {
        const late = motion.advance(from + (said.t - from)*k/200, (until - performance.now())/1000) == LATE;
        beside(motion.t);
        record();
        if (late) { say(word("failed") + " " + short(motion.t) + " s: " + word("slower")); k = 200; }
      }
    } catch (e) { say(wrong(e)); }
    pause();
    document.body.dataset.state = JSON.stringify(motion.state);
  } else if (!matchMedia("(prefers-reduced-motion: reduce)").matches) play();
  else pause();
}
// The page for other scripts: window.lagc.motion.state, .set("g", 3.7), .play(), .pause(), .reset(), .pass(seconds).
window.lagc = {
  get motion() { return motion; }, get picture() { return picture; }, get playing() { return playing; }, get horizon() { return horizon; }, get columns() { return columns; },
  get track() { return track; }, get section() { return section; }, play, pause, reset: restart, load,
  pass(seconds) { pass(seconds); draw(); },
  set(name, value) { settings.values[name] = value; go_on(); },
};
const begun = main().catch(e => say(e.message));
