// node playground_answers.js LAGC.wasm: each line of standard input, `COMMAND FILE`, is answered by a line of JSON, as the page's worker has it.
const fs = require("fs"), {answer} = require("../../src/playground/answer.js");
const lagc = new WebAssembly.Module(fs.readFileSync(process.argv[2]));
for (const line of fs.readFileSync(0, "utf8").trim().split("\n")) {
  const [command, file] = line.split(" ");
  try { console.log(JSON.stringify(answer(lagc, command, fs.readFileSync(file, "utf8")))); } catch (e) { console.log(JSON.stringify({failed: e.message})); }
}
