// The playground: an editor whose text lagc compiles in a worker, and a live page (live.html) in a frame. Enters: packed
// modules, the live page and examples of playground.html; leaves: the page.
const $ = id => document.getElementById(id);
const PAUSE = 150, LIMITS = {derive: 20000, picture: 20000, check: 20000, page: 20000, noether: 6000}; // [ms]
const COMMANDS = ["derive", "picture", "check", "page", "noether"]; // the first scene is seen before all

async function through(stream, bytes) {
  return new Uint8Array(await new Response(new Blob([bytes]).stream().pipeThrough(stream)).arrayBuffer());
}

// ---- the worker: one text at a time; a command that takes too long ends with its worker
let lagc, worker, asked = 0, timer = 0, doing = null;
function newWorker() {
  worker = new Worker(workerAddress);
  worker.onmessage = ({data}) => heard(data);
  worker.onerror = e => { e.preventDefault(); endWorker("the compiler stopped: " + e.message); };
  worker.postMessage({module: lagc});
}
const workerAddress = URL.createObjectURL(new Blob([workerText], {type: "text/javascript"}));
function endWorker(why) {
  const {id, command, rest, text} = doing;
  clearTimeout(timer);
  worker.terminate();
  doing = null;
  newWorker();
  if (id != asked) return;
  show(command, {failed: why}, NaN);
  if (command != "derive" && rest.length) send(text, rest);
  else settled();
}
function send(text, commands) {
  doing = {id: asked, text, command: commands[0], rest: commands.slice(1)};
  watch(commands[0]);
  worker.postMessage({id: asked, text, commands});
}
function watch(command) {
  clearTimeout(timer);
  timer = setTimeout(() => endWorker("it takes longer than " + LIMITS[command]/1000 + " s in a page; lagc itself is faster"), LIMITS[command]);
}
function heard({id, command, begins, ends, answer, time}) {
  if (id != asked || !doing) return;
  if (begins) { doing.command = begins; doing.rest = COMMANDS.slice(COMMANDS.indexOf(begins) + 1); watch(begins); return; }
  if (ends) { clearTimeout(timer); doing = null; settled(); return; }
  show(command, answer, time);
  if (command == "derive" && !(answer.check && answer.check.ok)) { // only what else is wrong is worth asking
    asked++;
    send(doing.text, ["check"]);
  }
}

// ---- what is shown
const words = {derive: "equations", picture: "motion", page: "other scenes", check: "checks", noether: "symmetries"};
let messages = [], failures = [], began = 0;
function show(command, result, time) {
  const ok = !result.failed && result.check.ok, put = (id, text) => { $(id).textContent = text; $(id).parentElement.hidden = !text; };
  if (command == "derive") failures = [];
  if (result.failed) failures.push({severity: "error", line: null, message: words[command] + ": " + result.failed});
  if (result.failed) say(messages);
  else if (command == "derive" || command == "check") say(result.check.messages, result.check.messages_not_shown);
  if (command == "derive") {
    document.body.classList.toggle("stale", !ok);
    $("took").value = ok ? "equations in " + Math.round(performance.now() - began) + " ms" : "";
    if (ok) equations(result.text);
  } else if ((command == "picture" || command == "page") && ok) move(JSON.parse(result.text));
  else if (command == "check") put("proofs", result.failed ? "" : result.check.report.join("\n").replaceAll("model.lag:", "line "));
  else if (command == "noether") put("symmetries", ok ? result.text.trim() : "");
}
function settled() { document.body.dataset.settled = asked; $("busy").hidden = true; }
function equations(listing) {
  const lines = listing.split("\n").filter(line => !line.startsWith("% accelerations"));
  const long = "<p>The formulas have " + Math.ceil(listing.length/1000) + " thousand characters: <code>lagc derive</code> prints them.</p>";
  try { $("equations").innerHTML = listing.length < 30000 ? typeset(lines.join("\n")) : long; }
  catch { $("equations").innerHTML = long; } // too deep for the browser
}
// Messages as lagc prints them; each leads to its place.
function say(list, more = 0) {
  messages = list;
  const box = $("messages");
  box.textContent = "";
  const lines = $("text").value.split("\n");
  for (const m of [...failures, ...list]) {
    const item = document.createElement("li"), here = m.line && m.file == "model.lag", words = document.createElement(here ? "button" : "p"), line = here && lines[m.line - 1];
    item.className = m.severity;
    words.textContent = (here ? "" : m.line ? m.file + ":" : "") + (m.line ? m.line + ":" + m.column + " " : "") + m.severity + ": " + m.message;
    if (here) { words.type = "button"; words.onclick = () => select(m); }
    item.append(words);
    if (typeof line == "string") {
      const pre = document.createElement("pre"), n = m.end_line == m.line ? Math.max(1, m.end_column - m.column) : 1;
      const letters = Array.from(line), from = Math.max(0, m.column - 70), end = m.column + 70;
      pre.textContent = (from ? "…" : "") + letters.slice(from, end).join("") + (end < letters.length ? "…" : "") + "\n" + (from ? " " : "") +
        letters.slice(from, m.column - 1).map(c => c == "\t" ? c : " ").join("") + "^" + "~".repeat(Math.min(n, 70) - 1);
      item.append(pre);
    }
    for (const text of [m.help, m.note && m.note.message + (m.note.line ? " (line " + m.note.line + ")" : "")])
      if (text) { const p = document.createElement("p"); p.textContent = text; item.append(p); }
    box.append(item);
  }
  if (more) { const item = document.createElement("li"); item.textContent = more + " more messages"; box.append(item); }
  mark();
}
// Offsets of a message's place in the text.
function placeOf(m) {
  const lines = $("text").value.split("\n"), at = (line, column) => {
    let sum = 0;
    for (let k = 0; k < line - 1; k++) sum += (lines[k] ?? "").length + 1;
    return sum + Array.from(lines[line - 1] ?? "").slice(0, column - 1).join("").length;
  };
  const from = at(m.line, m.column);
  return [from, Math.max(from + 1, at(m.end_line, m.end_column))];
}
function select(m) {
  const [from, to] = placeOf(m);
  $("text").focus();
  $("text").setSelectionRange(from, to);
}
// The text once more behind the editor, with its places of errors underlined.
function mark() {
  const text = $("text").value, back = $("back");
  back.textContent = "";
  let done = 0;
  const places = messages.filter(m => m.line && m.file == "model.lag" && m.severity != "note").map(m => [...placeOf(m), m.severity]).sort((a, b) => a[0] - b[0]);
  for (const [from, to, severity] of places) {
    if (from < done) continue;
    const mark = document.createElement("mark");
    mark.className = severity;
    mark.textContent = text.slice(from, to).replace(/^\n?$/, " \n");
    back.append(text.slice(done, from), mark);
    done = Math.min(text.length, to);
  }
  back.append(text.slice(done) + "\n");
  scroll();
}
function scroll() { $("back").scrollTop = $("text").scrollTop; $("back").scrollLeft = $("text").scrollLeft; }

// ---- the motion: the live page in a frame, begun once, with a model after the other
function move(model) {
  const live = $("motion").contentWindow.lagc;
  if (live && live.load) { live.load(model); return; }
  if ($("motion").srcdoc) { setTimeout(move, 50, model); return; } // still begins
  const put = {"@MODEL@": JSON.stringify(model).replaceAll("<", "\\u003c"), "@MODULE@": packedLag, "@BYTES@": ""};
  $("motion").srcdoc = livePage.replaceAll("@TITLE@", "motion").replace("</style>", "header h1, #link, #lag, details { display: none; }</style>")
    .replace(/@MODEL@|@MODULE@|@BYTES@/g, mark => put[mark]);
}
function fit() {
  const page = $("motion").contentDocument;
  if (page && page.body) new ResizeObserver(() => { $("motion").style.height = page.body.offsetHeight + "px"; }).observe(page.body);
}

// ---- typing and sharing
let waits = 0;
function typed() {
  clearTimeout(waits);
  mark();
  waits = setTimeout(compile, PAUSE);
}
function compile() {
  const text = $("text").value;
  asked++;
  began = performance.now();
  $("busy").hidden = false;
  if (doing) { // the worker takes the new text after the command that it does; a long one ends
    clearTimeout(timer);
    worker.terminate();
    newWorker();
  }
  send(text, COMMANDS);
  share();
}
// A text in the address, where there is room for it.
async function share() {
  const packed = await through(new CompressionStream("deflate-raw"), new TextEncoder().encode($("text").value));
  const room = packed.length < 50000;
  try { history.replaceState(null, "", room ? "#" + btoa(Array.from(packed, b => String.fromCharCode(b)).join("")).replaceAll("+", "-").replaceAll("/", "_").replaceAll("=", "") : "#"); }
  catch { return false; } // some browsers allow few changes a second
  return room;
}
async function shared() {
  try {
    const bytes = Uint8Array.from(atob(location.hash.slice(1).replaceAll("-", "+").replaceAll("_", "/")), c => c.charCodeAt(0));
    return bytes.length ? new TextDecoder().decode(await through(new DecompressionStream("deflate-raw"), bytes)) : null;
  } catch { return null; }
}
function save() {
  const a = document.createElement("a"), name = /^\s*model\s+(\w+)/m.exec($("text").value);
  a.href = URL.createObjectURL(new Blob([$("text").value], {type: "text/plain"}));
  a.download = (name ? name[1] : "model") + ".lag";
  a.click();
  setTimeout(() => URL.revokeObjectURL(a.href), 1000);
}
// Another text, which the editor's undo takes back; long ones take browsers minutes that way.
function open(text) {
  const focused = document.activeElement;
  $("text").focus();
  $("text").select();
  if (text.length > 20000 || !document.execCommand("insertText", false, text)) $("text").value = text;
  $("text").setSelectionRange(0, 0);
  $("text").scrollTop = 0;
  if (focused && focused != document.body) focused.focus();
  clearTimeout(waits);
  say([]);
  compile();
}
async function main() {
  if (typeof WebAssembly == "undefined") throw new Error("this browser has no WebAssembly, with which the page computes");
  for (const {name, title} of examples) $("examples").add(new Option(name.replaceAll("_", " ") + (title ? ": " + title : ""), name));
  lagc = await WebAssembly.compile(await through(new DecompressionStream("gzip"), bytes_of(packedLagc)));
  newWorker();
  $("text").oninput = typed;
  $("text").onscroll = scroll;
  $("motion").onload = fit;
  $("examples").onchange = () => open(examples.find(e => e.name == $("examples").value).text);
  $("save").onclick = save;
  $("link").onclick = async () => {
    if (!await share()) { $("took").value = "the text is too long for a link: save it"; return; }
    try { await navigator.clipboard.writeText(location.href); $("took").value = "the link is in the clipboard"; }
    catch { $("took").value = "the link is in the address bar"; }
  };
  onhashchange = async () => { const text = await shared(); if (text !== null && text != $("text").value) open(text); };
  open(await shared() ?? examples[0].text);
}
main().catch(e => { $("messages").textContent = e.message; });
