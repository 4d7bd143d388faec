// node page_digits.js LAG.wasm MOTION.js PAGE.html SCENE T: the outputs of the page's motion at T, after a row of nine times before.
const fs = require("fs");
const [wasm, script, page, scene, T] = process.argv.slice(2);
const {Lag, Motion} = require(require("path").resolve(script));
const model = JSON.parse(/let model = (\{[^]*?\});\nconst packed/.exec(fs.readFileSync(page, "utf8"))[1]);
const lag = new Lag(new WebAssembly.Module(fs.readFileSync(wasm)));
const bytes = Uint8Array.from(Buffer.from(model.programs.find(p => p.scene == scene).bytes, "base64"));
if (process.env.DAMAGE) bytes[+process.env.DAMAGE % bytes.length] ^= 1 << +process.env.DAMAGE % 8;
try {
  const it = lag.open(bytes)[0], motion = new Motion(lag, it, {method: "dop853", tol: 1e-10}), n = motion.count - lag.f.page_drawn(it);
  for (let k = 1; k <= 10; k++) motion.advance(T*k/10);
  console.log([motion.t, ...motion.outputs.slice(0, n)].join(","));
} catch (e) { console.log("error: " + e.message); }
