// node playground_facts.js ANSWERS: of the answers of run_playground.sh, in its order, what it compares, `NAME: FACT` a line.
const fs = require("fs"), {formula, typeset} = require("../../src/playground/mathml.js");
const answers = fs.readFileSync(process.argv[2], "utf8").trim().split("\n").map(JSON.parse), [, mistake, pendulum, kepler, deep, parts] = answers;
const place = m => m.line + ":" + m.column + " " + m.message;
// MathML as short as a formula: powers as ^, spaces between factors, names without elements.
const short = html => html.replace(/<msup>(.*?)<mn>(.)<\/mn><\/msup>/g, "$1^$2").replace(/<mspace[^>]*>/g, " ").replace(/<\/?m(row|i|o|n|over)( [^>]*)?>/g, "").replaceAll(" displaystyle=\"true\"", "");
console.log("place: " + place(mistake.check.messages[0]) + "; " + mistake.check.messages[0].help);
console.log("equation: " + short(/equations of motion<\/h3><table>(.*?)<\/table>/.exec(typeset(pendulum.text))[1]));
console.log("markup: " + formula("\\mathrm{a<b>&}"));
console.log("symmetries: " + kepler.text.match(/spin = .*|^Q1: [a-z]+/mg).join(", "));
console.log("deep: " + deep.check.messages[0].message);
console.log("file: " + place(parts.check.messages[0]));
console.log("library: " + short(formula(/p_.*/.exec(answers[9].text)[0].replace("&=", "="))).replace(/<msub>(.)(.)<\/msub>/, "$1_$2").replace("=", " = "));
answers.forEach((a, i) => { if (a.text.startsWith("{")) console.log("page" + (i + 1) + ": let model = " + a.text.replaceAll("\n", "") + ";"); });
const {bytes_of} = require("../../runtime/page/motion.js"), first = answers.slice(12).map(a => JSON.parse(a.text));
console.log("picture: " + first.map(m => JSON.parse(Buffer.from(bytes_of(m.raw)).subarray(m.more[0], m.more[0] + m.more[1])).programs.length + " " + m.whole).join(", "));
