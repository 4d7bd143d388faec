// Answers of lagc beside the page. In: {module}, then {id, text, commands}; out: {id, command, answer, time [ms]}.
// Between two commands a newer text takes the place of the older one.
let lagc, latest = 0;
onmessage = async ({data}) => {
  if (data.module) { lagc = data.module; return; }
  latest = data.id;
  let whole = false; // the first scene is all that there is
  for (const command of data.commands) {
    if (command == "page" && whole) continue;
    await new Promise(next => setTimeout(next));
    if (latest != data.id) return;
    postMessage({id: data.id, begins: command});
    const began = performance.now();
    let result;
    try { result = answer(lagc, command, data.text); } catch (e) { result = {failed: e.message}; }
    if (command == "picture") whole = /"whole": true/.test(result.text);
    postMessage({id: data.id, command, answer: result, time: performance.now() - began});
  }
  postMessage({id: data.id, ends: true});
};
