// node page_events.js BROWSER FOLDER: pages of FOLDER under real mouse, touch and key events; results as TAP.
const {Browser} = require("./browser.js");
const [path, folder] = process.argv.slice(2), b = new Browser(path, folder + "/profile");
let n = 0, bad = 0;
const is = (name, yes, more = "") => { n++; if (!yes) bad++; console.log(`${yes ? "ok" : "not ok"} ${n} - ${name}` + (yes ? "" : "\n# " + JSON.stringify(more))); };
const page = (name, more, options) => b.open(`file://${folder}/${name}.html${more || ""}`, options).then(() => b.until("window.lagc && lagc.motion && lagc.motion.t > 0"));
const place = (i = -1) => b.value(`(() => { const r = document.getElementById("picture").getBoundingClientRect(), p = lagc.picture, q = p.toCanvas(p.place(p.bodies.at(${i}).a)); return [r.left + q[0], r.top + q[1]]; })()`);
const said = () => b.value('document.getElementById("said").textContent'), apart = (p, q) => Math.hypot(p[0] - q[0], p[1] - q[1]);
const moved = ([x, y], [dx, dy]) => [x + dx, y + dy], state = name => b.value(`lagc.motion.state[${JSON.stringify(name)}]`);

async function pendulum() {
  await page("pendulum");
  const at = await place();
  await b.drag(at, [160, -80]);
  is("a dragged bob stays on its circle, and time stands", Math.abs(await state("th")) > 0.2 && !(await b.value("lagc.playing")), await state("th"));
  await b.release(moved(at, [160, -80]));
  is("let go, it swings", await b.until(`Math.abs(lagc.motion.state["th'"]) > 0.05`));
  const g = 'document.querySelectorAll(".slider output")[2].value', before = await b.value(g);
  await b.value('document.getElementById("equations").open = true');
  await b.until('document.querySelectorAll("#listing math").length > 5');
  await b.value('document.getElementById("value2").focus()');
  await b.key("ArrowRight", 39);
  is("a key moves the slider of g", await b.value(g) != before, await b.value(g));
  is("terms with g are lit", await b.value('[...document.querySelectorAll("math.lit")].every(m => m.textContent.includes("g")) && document.querySelectorAll("math.lit").length > 1'));
  const programs = await b.value("more.programs.length"), energy = () => b.value("lagc.motion.charge(0).now");
  await b.click("#effects input");
  const e = await energy(), t = await b.value("lagc.motion.t");
  await b.until(`lagc.motion.t > ${t} + 0.5`);
  is("friction is switched on: the energy falls", programs > 1 && await energy() < e - 1e-4, [e, await energy()]);
  await b.value('(s => { s.value = 150; s.oninput(); })(document.querySelector("#values .slider:last-child input"))');
  await b.click("#effects input");
  await b.click("#effects input");
  await b.click("#effects input");
  is("an effect whose slider has moved is switched off and on", await said() == "" && await b.value("!!lagc.motion") && await b.value("lagc.columns.length > 0"), await said());
  const drift = async (method, fine) => {
    await b.value(`(() => { const m = document.getElementById("method"), f = document.getElementById("fine"); m.value = "${method}"; m.onchange(); f.value = ${fine}; f.oninput(); lagc.reset(); lagc.play(); })()`);
    await b.until("lagc.motion.t > 1.5");
    return b.value("lagc.motion.charge(0).drift");
  };
  const rough = await drift("symplectic_euler", 30), sharp = await drift("taylor", 80);
  is("from symplectic Euler to taylor the drift falls by more than 1e6", rough > 1e-4 && sharp < 1e-6*rough, [rough, sharp]);
  await b.value("document.activeElement.blur()");
  await b.key(" ", 32, " ");
  const stopped = await b.value("lagc.motion.t");
  await b.key("ArrowRight", 39);
  is("space pauses, the right arrow steps", !(await b.value("lagc.playing")) && Math.abs(await b.value("lagc.motion.t") - stopped - 1/60) < 1e-9);
  await b.key("Home", 36);
  is("Home begins again", await b.value("lagc.motion.t") == 0);
  await b.value('lagc.set("l", -1)');
  is("a parameter out of range is refused with a reason, and the motion stays", (await said()).includes("l") && await b.value("lagc.motion.t") == 0, await said());
  await b.value('(s => { s.value = "de"; s.onchange(); })(document.getElementById("language"))');
  is("German", await b.value('document.body.innerText.includes("Genauigkeit und Aufwand") && document.documentElement.lang == "de"'));
}
async function others() {
  await page("pendulum");
  is("a frame has one row, also a late one", await b.value("lagc.pause(), (n => { lagc.pass(1.02/60); return lagc.track.length - n; })(lagc.track.length)") == 1);
  await page("double_pendulum");
  await b.value("lagc.pause(); lagc.reset()");
  let at = await place();
  await b.drag(at, [-150, 0]);
  is("rods in one line bend under the pointer", apart(await place(), moved(at, [-150, 0])) < 3, [at, await place()]);
  await b.release(moved(at, [-150, 0]));
  await b.value('(() => { const s = document.getElementById("speed"); s.value = "20"; const c = document.getElementById("section"); c.value = lagc.columns.findIndex(c => c.name == "th2"); c.onchange(); lagc.reset(); lagc.play(); })()');
  await b.until("lagc.section.x.length > 5");
  is("a section grows", true);
  const asks = async what => { await b.open(`file://${folder}/pendulum.html#` + encodeURIComponent(what)); await b.until("window.lagc && lagc.motion && lagc.track.length > 1"); return said(); };
  is("an address that asks for what the model refuses", /m = -1.*left out/.test(await asks('{"values": {"m": -1}, "effects": 7, "lang": "__proto__"}')), await said());
  await asks('{"values": {"m": 2}}');
  await b.value(`location.hash = encodeURIComponent('{"values": {"m": 3}}')`);
  is("an address that is typed over", await b.until('document.getElementById("value0").getAttribute("aria-valuetext") == "3 kg"', 20).catch(() => false));
  await page("slider_crank");
  await b.value("lagc.pause()");
  at = await place();
  await b.drag(at, [-30, 5]);
  is("a dragged piston stays on its rail, and its rod keeps its length", Math.abs((await place())[0] - at[0] + 30) < 3 && await b.value("lagc.motion.cost.constraint") < 1e-9, [at, await place()]);
  await page("loose"); // 100 bodies: only the coordinates of the one that is held are solved for
  await b.value("lagc.pause()");
  await b.value("counted = 0; Motion = class extends Motion { constructor(...all) { super(...all); counted++; } }; 0");
  at = await place();
  await b.drag(at, [20, 15], 1);
  is("a body of a family follows the pointer", apart(await place(), moved(at, [20, 15])) < 3, [at, await place()]);
  is("by some motions, not one for each coordinate", await b.value("counted") < 150, await b.value("counted"));
  await page("kepler", "", {width: 360, height: 740, touch: true, dark: true});
  await b.value("lagc.pause()");
  at = await place();
  await b.touch("touchStart", [at]);
  for (let k = 1; k <= 5; k++) await b.touch("touchMove", [moved(at, [-8*k, 6*k])]);
  await b.value("new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)))");
  is("a finger drags the planet", apart(await place(), moved(at, [-40, 30])) < 4, [at, await place()]);
  await b.touch("touchEnd", []);
  is("nothing is wider than a phone", await b.value("document.documentElement.scrollWidth <= innerWidth"), await b.value("document.documentElement.scrollWidth"));
  await page("pendulum", "?controls=0&lang=de");
  is("controls=0 leaves the picture", await b.value('getComputedStyle(document.querySelector("aside")).display') == "none");
  await b.open(`file://${folder}/pendulum.html`, {before: "delete window.WebAssembly;"});
  await b.until('/^t = [0-9.]*[1-9]/.test(document.getElementById("time").value)');
  is("without WebAssembly a message, and a recording that moves", (await said()).includes("WebAssembly"), await said());
  await b.open(`file://${folder}/pendulum.html`, {still: true});
  await b.until("window.lagc && lagc.motion && lagc.track.length > 0");
  is("with reduced motion a page waits", !(await b.value("lagc.playing")));
  await page("wall");
  await b.until('document.getElementById("said").textContent != ""');
  is("a motion that fails says when and why", /t = 1.*Reset/.test(await said()) && !(await b.value("lagc.playing")), await said());
  await b.click("#reset");
  is("reset begins again", await b.value("lagc.motion.t") == 0 && await said() == "", await said());
}
// A ball that falls, its motion ended by an event; no doc, no tolerance, a parameter >= 0.
async function edges() {
  await page("drop");
  is("a model without a title has its name", await b.value("document.title") == "drop" && await b.value('document.querySelector("h1").textContent') == "drop");
  is("without a tolerance, that of lagc run", await b.value('document.getElementById("finevalue").value') == "1e-9", await b.value('document.getElementById("finevalue").value'));
  await b.value('(s => { s.value = 0; s.oninput(); })(document.getElementById("value2"))');
  is("a parameter >= 0 has a slider from 0", await b.value('document.getElementById("value2").getAttribute("aria-valuetext")') == "0 kg/s" && await said() == "", await said());
  await b.until("!lagc.playing && lagc.motion.t > 0.4"); // y = 1 - g t^2/2 = 0
  const ended = await b.value("lagc.motion.t");
  await b.value("lagc.pass(0.5)");
  is("a motion that an event ended does not go on", Math.abs(ended - Math.sqrt(2/9.81)) < 1e-3 && await b.value("lagc.motion.t") == ended && (await said()).includes("ends"), ended);
  await b.value('lagc.set("g", 9.9); lagc.pass(0.5)');
  is("nor with another value", await b.value("lagc.motion.t") == ended);
  await b.click("#play");
  is("play begins it again", await b.until("lagc.playing && lagc.motion.t > 0.02 && lagc.motion.t < 0.44", 5).catch(() => false));
  await b.until("!lagc.playing");
  await b.click("#back");
  await b.click("#play");
  is("backwards it leaves its end", await b.until("lagc.motion.t < 0.3", 5).catch(() => false));
  await page("slider_crank");
  await b.value('lagc.pause(), (m => { m.value = "gauss"; m.onchange(); })(document.getElementById("method"))');
  is("a method that is refused is not taken", /constraints/.test(await said()) && await b.value('document.getElementById("method").value') == "" && await b.value("lagc.motion.method") == "dop853", await said());
  await b.click("#twin");
  is("a twin of a motion that stands", /aside by \d/.test(await b.value('document.getElementById("report").textContent')), await b.value('document.getElementById("report").textContent'));
  await page("drop");
  await b.value("lagc.reset(), lagc.play()");
  await b.until("lagc.motion.t > 0.1");
  const rows = await b.value(`new Promise(done => { const {createObjectURL} = URL; URL.createObjectURL = text => { URL.createObjectURL = createObjectURL; text.text().then(done); return "#"; }; document.getElementById("csv").click(); })`);
  is("CSV quotes a name with a comma, as lagc run does", rows.startsWith('t [s],"hypot(y, 1 [m]) [m]",y [m],'), rows.slice(0, 200));
  await page("pendulum", "#" + encodeURIComponent('{"values": {"g": 1e20}}'));
  const took = await b.value("(t => { lagc.pass(1/60); return performance.now() - t; })(performance.now())");
  is("a motion of 1e10 turns a second leaves the page alive", took < 2000, took);
  await b.open(`file://${folder}/pendulum.html#` + encodeURIComponent('{"values": {"m": [2]}, "t": 1}'));
  await b.until("window.lagc && lagc.motion && lagc.track.length > 1");
  is("values of an address are numbers", /m = nan.*left out/.test(await said()), await said());
  await b.open(`file://${folder}/pendulum.html#` + encodeURIComponent('{"method": "nosuch", "scene": "none", "t": 1}'));
  await b.until("window.lagc && lagc.motion && lagc.track.length > 1");
  is("a method and a scene that are not there are told", /none, nosuch. .*left out/.test(await said()), await said());
}
async function site(models) {
  await b.open(`file://${folder}/site/index.html`);
  await b.until('document.querySelectorAll("#topics li").length > 1 && document.querySelectorAll("#course li").length > 1');
  for (const m of models) {
    await b.open(`file://${folder}/site/index.html`);
    await b.until(`document.querySelector('a[href="${m}.html"]')`);
    await b.click(`a[href="${m}.html"]`);
    await b.until("window.lagc && lagc.motion && lagc.motion.t > 0");
    is("the site leads to " + m + ", which moves", true);
  }
}
pendulum().then(others).then(edges).then(() => site(process.argv.slice(4)))
  .catch(e => is("all steps", false, e.message))
  .finally(() => { is("no complaint in the console", !b.faults.length, b.faults); console.log("1.." + n); b.close(); });
