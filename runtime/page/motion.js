"use strict";
// Motions computed in the page: liblag as WebAssembly, and one program of `lagc`. Used by live.html, and by tests in node.

// Bytes of a text of `lagc page`: two of 91 characters for 13 bits, the low ones first; one at the end for 6.
function bytes_of(text) {
  const value = new Uint8Array(128), bytes = new Uint8Array((text.length*13 >> 4) + 1);
  for (let c = 33, k = 0; c < 127; c++) if (!'"<\\'.includes(String.fromCharCode(c))) value[c] = k++;
  let bits = 0, have = 0, n = 0;
  for (let i = 0; i < text.length; i += 2) {
    const pair = i + 1 < text.length, first = value[text.charCodeAt(i)];
    bits |= (pair ? first*91 + value[text.charCodeAt(i + 1)] : first) << have;
    for (have += pair ? 13 : 6; have >= 8; have -= 8, bits >>>= 8) bytes[n++] = bits & 255;
  }
  return bytes.subarray(0, n);
}
// The bytes that src/commands/pack.h packed: their number, then a stream of LZMA1 with lc = 0, lp = 0, pb = 2.
function unpacked(s) {
  if (s[4]) return s.subarray(5); // lagc without liblzma
  const view = new DataView(s.buffer, s.byteOffset), out = new Uint8Array(view.getUint32(0, true)), rep = [0, 0, 0, 0];
  const [REP, LONG, LITERAL, SLOT, LOW, ALIGN, COPIED, REPEATED, END] = [48, 96, 144, 912, 1168, 1296, 1312, 1634, 1956], p = new Uint16Array(END).fill(1024);
  let at = 9, range = 2**32 - 1, code = view.getUint32(5), state = 0, position;
  const fill = () => { while (range < 2**24) { range *= 256; code = code*256 + (s[at++] | 0); } };
  const bit = k => {
    const bound = (range >>> 11)*p[k], b = code < bound ? 0 : 1;
    if (b) { code -= bound; range -= bound; p[k] -= p[k] >> 5; } else { range = bound; p[k] += 2048 - p[k] >> 5; }
    fill();
    return b;
  };
  const tree = (k, bits) => { let x = 1; for (let i = 0; i < bits; i++) x = 2*x + bit(k + x); return x - (1 << bits); };
  const reverse = (k, bits) => { let x = 0; for (let i = 0, m = 1; i < bits; i++) { const b = bit(k + m); m = 2*m + b; x |= b << i; } return x; };
  const length = k => 2 + (!bit(k) ? tree(k + 2 + 8*position, 3) : !bit(k + 1) ? 8 + tree(k + 34 + 8*position, 3) : 16 + tree(k + 66, 8));
  const distance = n => {
    const slot = tree(SLOT + 64*Math.min(n - 2, 3), 6), bits = (slot >> 1) - 1;
    if (slot < 4) return slot;
    let x = (2 | slot & 1) << bits;
    if (slot < 14) return x + reverse(LOW + x - slot, bits);
    for (let i = bits - 1; i >= 4; i--) {
      range = Math.floor(range/2);
      if (code >= range) { code -= range; x += 1 << i; }
      fill();
    }
    return x + reverse(ALIGN, 4);
  };
  for (let i = 0; i < out.length;) {
    position = i & 3;
    if (!bit(4*state + position)) {
      let x = 1, same = state >= 7;
      const there = same ? out[i - rep[0] - 1] : 0;
      for (let k = 7; k >= 0; k--) {
        const t = there >> k & 1, b = bit(LITERAL + x + (same ? 256 + 256*t : 0));
        x = 2*x + b;
        same &&= b == t;
      }
      out[i++] = x;
      state = state < 4 ? 0 : state < 10 ? state - 3 : state - 6;
      continue;
    }
    const again = bit(REP + state), far = state < 7;
    let n = 0;
    if (!again) { n = length(COPIED); rep.unshift(distance(n)); rep.pop(); state = far ? 7 : 10; }
    else {
      let k = 0;
      if (bit(REP + 12 + state)) k = !bit(REP + 24 + state) ? 1 : !bit(REP + 36 + state) ? 2 : 3;
      else if (!bit(LONG + 4*state + position)) n = 1;
      rep.unshift(...rep.splice(k, 1));
      state = n ? (far ? 9 : 11) : far ? 8 : 11;
      n ||= length(REPEATED);
    }
    for (const from = rep[0] + 1; n--; i++) out[i] = out[i - from];
  }
  return out;
}

// An instance of the module with a program. Memory may grow with each call, so that views are made where they are used.
class Lag {
  constructor(module) {
    const imports = {};
    for (const {module: from, name} of WebAssembly.Module.imports(module))
      (imports[from] ||= {})[name] = name == "clock_time_get" ? (_, __, to) => {
        new DataView(this.f.memory.buffer).setBigUint64(to, BigInt(Math.round(performance.now()*1e6)), true);
        return 0;
      } : () => 52; // "not supported" of WASI: there are no files
    this.f = new WebAssembly.Instance(module, imports).exports;
    this.f._initialize();
  }
  text(at) {
    if (!at) return null;
    const bytes = new Uint8Array(this.f.memory.buffer);
    return new TextDecoder().decode(bytes.slice(at, bytes.indexOf(0, at)));
  }
  // Calls use(address) with bytes in the module's memory.
  lend(bytes, use) {
    const at = this.f.malloc(bytes.length || 1);
    new Uint8Array(this.f.memory.buffer).set(bytes, at);
    try { return use(at); } finally { this.f.free(at); }
  }
  word(text, use) { return this.lend(new TextEncoder().encode(text + "\0"), use); }
  // The program of these bytes; an error tells why it is none.
  open(bytes) {
    const program = this.lend(bytes, at => this.f.page_program(at, bytes.length));
    if (!program) throw new Error(this.text(this.f.page_why()));
    const scenes = [];
    for (let i = 0, scene; (scene = this.f.lag_library_scene(program, i)); i++) scenes.push(scene);
    return scenes;
  }
  // Names and units of a scene's items of a kind, as lag_item has them, with factor and offset to SI.
  items(scene, kind) {
    const all = [], room = this.f.malloc(24);
    for (let i = 0, at; (at = this.f.lag_item(scene, kind.charCodeAt(0), i, room, room + 8, room + 16)); i++) {
      const view = new DataView(this.f.memory.buffer);
      all.push({name: this.text(at), unit: this.text(view.getUint32(room, true)), factor: view.getFloat64(room + 8, true),
        offset: view.getFloat64(room + 16, true)});
    }
    this.f.free(room);
    return all;
  }
  // Times of the start and the end of a scene's span [s]; the same where it has none.
  span(scene) {
    const room = this.f.malloc(24);
    this.f.lag_scene_span(scene, room, room + 8, room + 16);
    const [t0, t1] = new Float64Array(this.f.memory.buffer, room, 2);
    this.f.free(room);
    return {t0, t1};
  }
  // The scene's drawing: shapes as lag_shape of lag_model.h, with numbers of outputs.
  shapes(scene) {
    const all = [];
    for (let i = 0, at; (at = this.f.page_shape(scene, i)); i++) {
      const [kind, role, text, ...n] = this.text(at).split("\t"), k = n.map(Number);
      all.push({kind, role, text, count: k[0], a: k.slice(1, 4), b: k.slice(4, 7), size: k.slice(7, 10), turn: k.slice(10, 14)});
    }
    return all;
  }
  // The n parameters of a simulation, in SI.
  parameters(sim, n) { return Array.from(new Float64Array(this.f.memory.buffer, this.f.lag_sim_p(sim), n)); }
  methods(scene) { return this.items(scene, "m").map(m => m.name); }
}

// A motion of a scene. settings: {method, tol, step, until, values: {name: value in its unit}, t: time of the start [s]}.
class Motion {
  constructor(lag, scene, settings = {}) {
    const {method = "", tol = 0, step = 0, until = 1, values = {}, t = NaN} = settings;
    this.lag = lag;
    this.sim = lag.f.page_begin(scene, t);
    if (!this.sim) throw new Error("out of memory");
    for (const name in values) this.must(lag.word(name, at => lag.f.lag_sim_set(this.sim, at, values[name])));
    this.must(lag.word(method, at => lag.f.page_set_method(this.sim, at, tol, step, until)));
    this.room = lag.f.malloc(8*Math.max(1, this.count = lag.f.lag_sim_noutputs(this.sim)));
  }
  must(status) {
    if (status < 0) throw new Error(this.message);
    return status;
  }
  get message() { return this.lag.text(this.lag.f.lag_sim_message(this.sim)); }
  get method() { return this.lag.text(this.lag.f.page_method(this.sim)); }
  get t() { return this.lag.f.lag_sim_time(this.sim); }
  // Integrates to t, for so many seconds at most. Returns 0, or 2 where an event ended the motion before, 3 where the time did; throws where it failed.
  advance(t, seconds = Infinity) { return this.must(this.lag.f.page_advance(this.sim, t, seconds)); }
  names(which) { // page_output or page_state
    const all = [];
    for (let i = 0, at; (at = this.lag.f[which](this.sim, i)); i++) all.push(this.lag.text(at).split("\t"));
    return all.map(([name, unit]) => ({name, unit}));
  }
  get outputs() {
    this.lag.f.lag_sim_outputs(this.sim, this.room);
    return Array.from(new Float64Array(this.lag.f.memory.buffer, this.room, this.count));
  }
  // Names and units of the state's components, and their present values.
  get components() { return this.named ||= this.names("page_state"); }
  get values() { return this.components.map((_, i) => this.lag.f.lag_sim_state_value(this.sim, i)); }
  // {name: value} of the present state, as a start of another motion takes it.
  get state() {
    const now = {}, values = this.values;
    this.components.forEach(({name}, i) => { now[name] = values[i]; });
    return now;
  }
  // Charge k: 0 is the energy. name: [name, unit], null past the last.
  charge_name(k) { const of = this.lag.text(this.lag.f.page_charge_name(this.sim, k)); return of && of.split("\t"); }
  charge(k) { const f = what => this.lag.f.page_charge(this.sim, k, what); return {now: f(0), drift: f(1), absolute: f(2), work: f(3)}; }
  get cost() { return {steps: this.lag.f.page_count(this.sim, 0), calls: this.lag.f.page_count(this.sim, 1), constraint: this.lag.f.page_count(this.sim, 3)}; }
  free() {
    this.lag.f.page_end(this.sim);
    this.lag.f.free(this.room);
    this.sim = 0;
  }
}
if (typeof module != "undefined") module.exports = {Lag, Motion, bytes_of, unpacked};
