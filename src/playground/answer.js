"use strict";
// lagc in the page: one answer of its module to a text, for workers and for node.

// {check, text} of a command (check, derive, noether, page) on the text of a model; throws where memory runs out.
// A new instance for each answer: its memory goes with it.
function answer(module, command, text) {
  let f;
  const clock = (_, __, to) => {
    new DataView(f.memory.buffer).setBigUint64(to, BigInt(Math.round(performance.now()*1e6)), true);
    return 0;
  };
  const imports = {};
  for (const {module: from, name} of WebAssembly.Module.imports(module))
    (imports[from] ||= {})[name] = name == "clock_time_get" ? clock
      : name == "fail" ? () => { throw new Error("the model needs more memory than the page has"); }
      : () => 8; // "bad file descriptor" of WASI: there are no files
  f = new WebAssembly.Instance(module, imports).exports;
  f._initialize();
  const put = words => {
    const bytes = new TextEncoder().encode(words.replaceAll("\0", "\ufffd") + "\0"), at = f.malloc(bytes.length);
    new Uint8Array(f.memory.buffer).set(bytes, at);
    return at;
  };
  const at = f.playground_answer(put(command), put(text)), memory = new Uint8Array(f.memory.buffer);
  return JSON.parse(new TextDecoder().decode(memory.subarray(at, memory.indexOf(0, at))));
}
if (typeof module != "undefined") module.exports = {answer};
