// A browser driven over its pipe (--remote-debugging-pipe): real mouse, touch and key events. Used by page_events.js.
const {spawn} = require("child_process");

class Browser {
  constructor(path, profile) {
    this.child = spawn(path, ["--headless", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage", "--remote-debugging-pipe", "--user-data-dir=" + profile],
      {stdio: ["ignore", "ignore", "ignore", "pipe", "pipe"]});
    this.next = 1; this.waiting = new Map(); this.faults = []; let text = "";
    this.child.stdio[4].on("data", data => {
      const all = (text + data).split("\0");
      text = all.pop();
      for (const said of all.map(s => JSON.parse(s))) {
        const {id, method, params} = said;
        if (id) { this.waiting.get(id)(said); this.waiting.delete(id); }
        if (method == "Runtime.exceptionThrown") this.faults.push(params.exceptionDetails.exception?.description || params.exceptionDetails.text);
        if (method == "Runtime.consoleAPICalled" && /error|warning/.test(params.type)) this.faults.push(JSON.stringify(params.args));
        if (method == "Log.entryAdded" && /error|warning/.test(params.entry.level)) this.faults.push(params.entry.text);
      }
    });
  }
  send(method, params = {}) {
    const id = this.next++;
    this.child.stdio[3].write(JSON.stringify({id, method, params, sessionId: method.startsWith("Target.") ? undefined : this.session}) + "\0");
    return new Promise((done, failed) => this.waiting.set(id, said => said.error ? failed(new Error(method + ": " + said.error.message)) : done(said.result)));
  }
  // A page of this size in pixels; `before` runs ahead of its scripts.
  async open(url, {width = 1000, height = 900, touch = false, dark = false, still = false, before = ""} = {}) {
    const {targetId} = await this.send("Target.createTarget", {url: "about:blank"});
    this.session = (await this.send("Target.attachToTarget", {targetId, flatten: true})).sessionId;
    for (const domain of ["Page", "Runtime", "Log"]) await this.send(domain + ".enable");
    await this.send("Emulation.setDeviceMetricsOverride", {width, height, deviceScaleFactor: 1, mobile: touch});
    await this.send("Emulation.setTouchEmulationEnabled", {enabled: touch});
    await this.send("Emulation.setEmulatedMedia", {features: [{name: "prefers-color-scheme", value: dark ? "dark" : "light"}, {name: "prefers-reduced-motion", value: still ? "reduce" : "no-preference"}]});
    if (before) await this.send("Page.addScriptToEvaluateOnNewDocument", {source: before});
    await this.send("Page.navigate", {url});
  }
  async value(expression) {
    const ask = () => this.send("Runtime.evaluate", {expression, returnByValue: true, awaitPromise: true});
    // a page that is just being replaced by the next has no answer: that has one
    const {result, exceptionDetails} = await ask().catch(e => /navigated/.test(e.message) ? ask() : Promise.reject(e));
    if (exceptionDetails) throw new Error(expression + ": " + exceptionDetails.exception?.description);
    return result.value;
  }
  async until(expression, seconds = 60) {
    for (let k = 0; k < 20*seconds; k++) {
      if (await this.value(expression).catch(() => false)) return true; // the page may not be there yet
      await new Promise(done => setTimeout(done, 50));
    }
    throw new Error("never: " + expression);
  }
  async mouse(type, x, y) { await this.send("Input.dispatchMouseEvent", {type, x, y, button: "left", buttons: 1, clickCount: 1}); }
  async drag([x, y], [dx, dy], steps = 8) {
    await this.mouse("mousePressed", x, y);
    for (let k = 1; k <= steps; k++) await this.mouse("mouseMoved", x + dx*k/steps, y + dy*k/steps);
    await this.value("new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)))");
  }
  async release([x, y]) { await this.mouse("mouseReleased", x, y); }
  async click(selector) {
    const [x, y] = await this.value(`(e => { e.scrollIntoView({block: "center"}); const r = e.getBoundingClientRect(); return [r.left + r.width/2, r.top + r.height/2]; })(document.querySelector(${JSON.stringify(selector)}))`);
    await this.mouse("mousePressed", x, y);
    await this.release([x, y]);
  }
  async key(key, code = 0, text) {
    for (const type of ["keyDown", "keyUp"]) await this.send("Input.dispatchKeyEvent", {type, key, windowsVirtualKeyCode: code, text: type == "keyDown" ? text : undefined});
  }
  async touch(type, points) { await this.send("Input.dispatchTouchEvent", {type, touchPoints: points.map(([x, y], id) => ({x, y, id}))}); }
  close() { this.child.kill(); }
}
module.exports = {Browser};
