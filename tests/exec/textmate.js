// textmate.js GRAMMAR: a small reading of TextMate grammars (match, begin/end, captures, include), enough to say which
// scope each part of a line gets. Standard input has lines to judge; each is answered by its parts, `scope|text`, one a
// line, and an empty line. `TEXT` of several lines keeps its state from line to line. Exit status 2: the grammar is wrong.
'use strict';
const fs = require('fs');

const grammar = JSON.parse(fs.readFileSync(process.argv[2], 'utf8'));

// Oniguruma and ECMAScript agree on what this grammar uses: Unicode classes, look-ahead, look-behind of fixed length.
function regex(source, where) {
  if (/\\[GAzZhHKX]|\(\?[imx<]*[a-zA-Z]*[:)]|\[\[:|\(\?>|[*+?]\+/.test(source.replace(/\(\?(:|=|!|<=|<!)/g, '(')))
    fail(`${where}: ${source} uses what only some engines know`);
  try {
    return new RegExp(source, 'dgu');
  } catch (e) {
    return fail(`${where}: ${e.message}`);
  }
}
function fail(message) {
  console.error(message);
  process.exit(2);
}

const known = ['name', 'match', 'captures', 'begin', 'end', 'beginCaptures', 'endCaptures', 'contentName', 'patterns', 'include', 'comment'];
const compiled = new Map();
const used = new Set();
function prepare(rule, where) {
  for (const key of Object.keys(rule)) if (!known.includes(key)) fail(`${where}: unknown key ${key}`);
  if (rule.begin && !rule.end) fail(`${where}: begin without end`);
  for (const key of ['match', 'begin', 'end']) if (rule[key]) compiled.set(rule[key], regex(rule[key], where));
  if (rule.include) {
    const name = rule.include.slice(1);
    if (rule.include[0] !== '#' || !grammar.repository[name]) fail(`${where}: no ${rule.include}`);
    used.add(name);
  }
  (rule.patterns || []).forEach((p, i) => prepare(p, `${where}/${i}`));
}
grammar.patterns.forEach((p, i) => prepare(p, `patterns/${i}`));
for (const [name, rule] of Object.entries(grammar.repository)) prepare(rule, name);
for (const name of Object.keys(grammar.repository)) if (!used.has(name)) fail(`${name} is included by nobody`);
for (const key of ['scopeName', 'fileTypes', 'name']) if (!grammar[key]) fail(`no ${key}`);

function flat(patterns) {
  return patterns.flatMap((p) => {
    if (!p.include) return p.match || p.begin ? [p] : flat(p.patterns || []);
    const rule = grammar.repository[p.include.slice(1)];
    return rule.match || rule.begin ? [rule] : flat(rule.patterns);
  });
}

function find(source, line, at) {
  const r = compiled.get(source);
  r.lastIndex = at;
  return r.exec(line);
}

// Parts of a match: its captures, and what lies between them.
function put(parts, m, name, captures) {
  let at = m.index;
  const inner = Object.entries(captures || {})
    .filter(([k]) => m.indices[k])
    .map(([k, c]) => [m.indices[k][0], m.indices[k][1], c.name])
    .sort((a, b) => a[0] - b[0]);
  const end = m.index + m[0].length;
  for (const [b, e, scope] of inner) {
    parts.push([name, m.input.slice(at, b)], [scope, m.input.slice(b, e)]);
    at = e;
  }
  parts.push([name, m.input.slice(at, end)]);
}

const stack = [];
function tokens(line) {
  const parts = [];
  let at = 0;
  for (let guard = 0; at <= line.length && guard < 10000; guard++) {
    const top = stack[stack.length - 1];
    const inside = top ? top.contentName || top.name : undefined;
    let best = top ? find(top.end, line, at) : null;
    let rule = best ? 'end' : null;
    for (const p of flat(top ? top.patterns || [] : grammar.patterns)) {
      const m = find(p.match || p.begin, line, at);
      if (m && (!best || m.index < best.index)) [best, rule] = [m, p];
    }
    if (!best) break;
    parts.push([inside, line.slice(at, best.index)]);
    at = best.index + best[0].length;
    if (rule === 'end') {
      put(parts, best, top.name, top.endCaptures);
      stack.pop();
    } else if (rule.match) {
      put(parts, best, rule.name, rule.captures);
      if (!best[0].length) at++;
    } else {
      put(parts, best, rule.name, rule.beginCaptures);
      stack.push(rule);
    }
    if (at === line.length && !stack.length) break;
  }
  parts.push([undefined, line.slice(at)]);
  return parts.filter(([, text]) => text.trim());
}

for (const line of fs.readFileSync(0, 'utf8').split('\n').slice(0, -1)) {
  for (const [scope, text] of tokens(line)) console.log(`${(scope || '-').replace(/\.lag$/, '')}|${text.trim()}`);
  console.log('');
}
