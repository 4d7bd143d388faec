// node playground_typed.js BROWSER PROFILE PAGE: types a mistake into the page of run_playground.sh and repairs it, by keys of the DevTools protocol;
// prints what the page says, `NAME: FACT` a line.
const {spawn} = require("child_process");
const [program, profile, page] = process.argv.slice(2);
const browser = spawn(program, ["--headless", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage", "--remote-debugging-pipe", "--user-data-dir=" + profile, "about:blank"],
  {stdio: ["ignore", "ignore", "ignore", "pipe", "pipe"]});
const waiting = new Map(), faults = [];
let session, sent = 0, got = "";
browser.stdio[4].on("data", bytes => {
  const parts = (got += bytes).split("\0");
  got = parts.pop();
  for (const {id, result, error, method, params} of parts.map(JSON.parse)) {
    if (id) waiting.get(id)(error ? Promise.reject(new Error(error.message)) : result);
    else if (method == "Runtime.exceptionThrown") faults.push(params.exceptionDetails.text);
    else if (method == "Log.entryAdded" && params.entry.level == "error") faults.push(params.entry.text);
  }
});
const call = (method, params = {}) => new Promise(done => {
  waiting.set(++sent, done);
  browser.stdio[3].write(JSON.stringify({id: sent, method, params, sessionId: session}) + "\0");
});
const value = async text => (await call("Runtime.evaluate", {expression: text, awaitPromise: true})).result.value;
const until = async text => { for (let k = 0; !await value(text); k++) { if (k > 1200) throw new Error("never " + text); await new Promise(next => setTimeout(next, 50)); } };
const key = async (name, more) => { for (const type of ["keyDown", "keyUp"]) await call("Input.dispatchKeyEvent", {type, key: name, ...more, ...(type == "keyUp" ? {text: undefined} : {})}); };
// Waits until the text that is typed now is answered.
const settled = async () => { await until('document.body.dataset.settled == asked && $("busy").hidden'); };
const change = async (from, to, keys) => {
  const before = await value("asked");
  await value(`{ const at = $("text").value.indexOf("${from}") + ${to}; $("text").focus(); $("text").setSelectionRange(at, at); }`);
  await keys();
  await until("asked > " + before);
  await settled();
};
async function main() {
  const {targetId} = await call("Target.createTarget", {url: "about:blank"});
  session = (await call("Target.attachToTarget", {targetId, flatten: true})).sessionId;
  for (const domain of ["Runtime", "Log", "Page"]) await call(domain + ".enable");
  await call("Page.addScriptToEvaluateOnNewDocument", {source: // the module of the motion is compiled after its model is there
    "if (window != top) { const {compile} = WebAssembly; WebAssembly.compile = async bytes => { await new Promise(done => setTimeout(done, 3000)); return compile(bytes); }; }"});
  await call("Page.navigate", {url: "file://" + page});
  await until('typeof asked != "undefined" && asked');
  await settled();
  await change("k*x^2", 3, () => key("x", {text: "x"}));
  console.log("mistake: " + await value('$("messages").innerText.split("\\n")[0] + "; " + $("back").querySelector("mark").textContent'));
  await change("k*xx^2", 4, () => key("Backspace", {windowsVirtualKeyCode: 8, code: "Backspace"}));
  console.log("repaired: " + await value('messages.map(m => m.line).join() + "; " + $("proofs").textContent.split("\\n").at(-1)'));
  await until('($("motion").contentWindow.lagc || {}).motion && $("motion").contentWindow.lagc.motion.t > 0.1');
  console.log("off: " + await value('(m => Math.abs(m.state.x - Math.cos(2*m.t)))($("motion").contentWindow.lagc.motion)'));
  console.log("faults: " + faults.join("; "));
}
main().catch(e => console.log("error: " + e.message)).finally(() => { session = undefined; call("Browser.close"); setTimeout(() => browser.kill(), 5000).unref(); });
browser.on("exit", () => process.exit());
