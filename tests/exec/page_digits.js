// node page_digits.js LAG.wasm MOTION.js PAGE.html SCENE T: the outputs of the page's motion at T, after a row of nine times before. T "part": a sixteenth of the span.
// ENERGY=1: then the drift of the energy, relative and in its unit.
const fs = require("fs");
const [wasm, script, page, scene, T] = process.argv.slice(2);
const {Lag, Motion, bytes_of, unpacked} = require(require("path").resolve(script));
const [, text, parts] = /let model = (\{[^]*?\});\n(?:const parts = "([^"]*))?/.exec(fs.readFileSync(page, "utf8")), model = JSON.parse(text), packed = bytes_of(parts || "");
const all = model.raw !== undefined ? bytes_of(model.raw) : unpacked(packed); // raw: of a playground
const {programs} = JSON.parse(new TextDecoder().decode(all.subarray(model.more[0], model.more[0] + model.more[1])));
const lag = new Lag(new WebAssembly.Module(fs.readFileSync(wasm)));
const found = programs.find(p => p.scene == scene), bytes = Uint8Array.from(all.subarray(found.at, found.at + found.n));
if (process.env.DAMAGE) bytes[+process.env.DAMAGE % bytes.length] ^= 1 << +process.env.DAMAGE % 8;
if (T == "programs") console.log(programs.length);
else try {
  const it = lag.open(bytes)[0], motion = new Motion(lag, it, {method: "dop853", tol: 1e-10}), n = motion.count - lag.f.page_drawn(it);
  const {t0, t1} = lag.span(it), end = T == "part" ? t0 + (t1 - t0)/16 : +T;
  for (let k = 1; k <= 10; k++) motion.advance(t0 + (end - t0)*k/10);
  const {drift, absolute} = motion.charge(0);
  console.log([motion.t, ...motion.outputs.slice(0, n), ...(process.env.ENERGY ? [drift, absolute] : [])].join(","));
} catch (e) { console.log("error: " + e.message); }
