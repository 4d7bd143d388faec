// node page_words.js RUNTIME/page LATEX...: contrast of the page's colours (WCAG 2.1, AA: 4.5 for text, 3 for borders and lines), words in all languages,
// and LaTeX typeset as balanced MathML. Prints faults.
const fs = require("fs"), [folder, ...texts] = process.argv.slice(2), read = f => fs.readFileSync(folder + "/" + f, "utf8");
const fault = s => console.log(s), html = read("live.html");
const luminance = hex => {
  const full = hex.length == 4 ? hex.replace(/[0-9a-f]/g, "$&$&") : hex, [r, g, b] = [1, 3, 5].map(k => parseInt(full.slice(k, k + 2), 16)/255).map(c => c <= 0.03928 ? c/12.92 : ((c + 0.055)/1.055)**2.4);
  return 0.2126*r + 0.7152*g + 0.0722*b;
};
const contrast = (a, b) => { const [x, y] = [luminance(a), luminance(b)].sort((p, q) => q - p); return (x + 0.05)/(y + 0.05); };
let light;
for (const [, text] of html.matchAll(/:root[^{]*\{([^}]*--back[^}]*)\}/g)) {
  const colour = {...light, ...Object.fromEntries([...text.matchAll(/--([a-z]+): *(#[0-9a-f]+)/g)].map(m => [m[1], m[2]]))};
  light ||= colour;
  for (const [front, back, least] of [["ink", "back", 4.5], ["soft", "back", 4.5], ["bad", "back", 4.5], ["ink", "fill", 4.5], ["ink", "lit", 4.5], ["axis", "back", 3], ["line", "back", 3], ["mark", "back", 3], ["rod", "back", 3], ["spring", "back", 3], ["force", "back", 3], ["velocity", "back", 3]])
    if (!(contrast(colour[front], colour[back]) >= least)) fault(`--${front} on --${back}: ${contrast(colour[front], colour[back]).toFixed(2)} of ${least}`);
}
const {words, typeset_listing} = new Function(read("words.js") + read("typeset.js") + "return {words, typeset_listing};")();
const used = new Set([...(html + read("live.js")).matchAll(/(?:data-(?:word|label)="|word\(")([a-z_]+)"/g)].map(m => m[1]));
for (const language in words) for (const key of new Set([...used, ...Object.keys(words.en)])) if (!words[language][key]) fault(`${language} has no word ${key}`);
for (const file of texts) {
  const out = typeset_listing(fs.readFileSync(file, "utf8")), open = [];
  for (const [, end, name] of out.matchAll(/<(\/?)([a-z0-9]+)[^>]*>/g)) if (!end) open.push(name); else if (open.pop() != name) { fault(file + ": </" + name + "> out of place"); break; }
  if (open.length || !out.includes("<math") || />(operatorname|mathrm|frac|sqrt)</.test(out) || /[\\{}]/.test(out.replace(/<mo>[{}]<\/mo>/g, ""))) fault(file + ": " + (out.match(/.{0,40}[\\{}].{0,40}/) || ["no equation"])[0]);
}
