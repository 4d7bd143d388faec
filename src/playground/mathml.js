"use strict";
// The listing of `lagc derive --format latex` as HTML with MathML: the few LaTeX commands that src/sym/print.c writes.

const letters = {alpha: "α", beta: "β", gamma: "γ", delta: "δ", epsilon: "ε", zeta: "ζ", eta: "η", theta: "θ", iota: "ι",
  kappa: "κ", lambda: "λ", mu: "μ", nu: "ν", xi: "ξ", pi: "π", rho: "ρ", sigma: "σ", tau: "τ", upsilon: "υ", phi: "φ",
  chi: "χ", psi: "ψ", omega: "ω", Gamma: "Γ", Delta: "Δ", Theta: "Θ", Lambda: "Λ", Xi: "Ξ", Pi: "Π", Sigma: "Σ",
  Phi: "Φ", Psi: "Ψ", Omega: "Ω"};
const signs = {le: "≤", wedge: "∧", vee: "∨", neg: "¬", cdot: "·", sum: "∑"};
const accents = {dot: "˙", ddot: "¨", dddot: "⃛"};
const plain = text => text.replaceAll("&", "&amp;").replaceAll("<", "&lt;").replaceAll(">", "&gt;");
const row = pieces => pieces.length == 1 ? pieces[0] : "<mrow>" + pieces.join("") + "</mrow>";
const operator = text => "<mo>" + plain(text == "-" ? "−" : text) + "</mo>";
const isOperator = piece => /^<mo[ >]/.test(piece);

// One formula as MathML elements.
function formula(latex) {
  const tokens = latex.match(/\\[a-zA-Z]+|\\.|[0-9]+(?:\.[0-9]+)?(?:e[-+]?[0-9]+)?|\s+|[^]/gu) || [];
  let i = 0;
  const argument = () => {
    if (tokens[i] != "{") return atom();
    i++;
    const inner = row(list("}"));
    i++;
    return inner;
  };
  const words = () => {
    const from = ++i;
    while (i < tokens.length && tokens[i] != "}") i++;
    return plain(tokens.slice(from, i++).join(""));
  };
  function atom(tall) {
    const token = tokens[i++] ?? "", name = token[0] == "\\" ? token.slice(1) : "";
    if (token == "(") {
      const inner = list(")");
      i++;
      return row([tall ? operator("(") : '<mo stretchy="false">(</mo>', ...inner, tall ? operator(")") : '<mo stretchy="false">)</mo>']);
    }
    if (name == "left") return atom(true);
    if (name == "frac") { const top = argument(); return "<mfrac>" + top + argument() + "</mfrac>"; }
    if (name == "sqrt") return "<msqrt>" + argument() + "</msqrt>";
    if (name in accents) return '<mover accent="true">' + argument() + "<mo>" + accents[name] + "</mo></mover>";
    if (name == "mathrm" || name == "operatorname") return '<mi mathvariant="normal">' + words() + "</mi>";
    if (name == "text") return "<mtext>" + words() + "</mtext>";
    if (name in letters) return "<mi>" + letters[name] + "</mi>";
    if (name in signs) return operator(signs[name]);
    if (name) return '<mi mathvariant="normal">' + plain(name.replace("arc", "arc\u200a")) + "</mi>";
    if (/^[0-9]/.test(token)) return "<mn>" + token + "</mn>";
    return /^[-+=<>,|*/:]$/.test(token) ? operator(token) : "<mi>" + plain(token) + "</mi>";
  }
  const scripted = base => {
    const at = {};
    while (tokens[i] == "^" || tokens[i] == "_") at[tokens[i++]] = argument();
    return at["^"] && at._ ? "<msubsup>" + base + at._ + at["^"] + "</msubsup>" : at["^"] ? "<msup>" + base + at["^"] + "</msup>"
      : at._ ? "<msub>" + base + at._ + "</msub>" : base;
  };
  function list(end) {
    const pieces = [];
    for (let spaced = false; i < tokens.length && tokens[i] != end;) {
      if (/^\s/.test(tokens[i]) || tokens[i] == "&" || tokens[i] == "\\right") { spaced ||= tokens[i++] != "&"; continue; }
      const piece = scripted(atom());
      if (spaced && pieces.length && !isOperator(piece) && !isOperator(pieces.at(-1))) pieces.push('<mspace width=".17em"/>');
      pieces.push(piece);
      spaced = false;
    }
    return pieces;
  }
  return row(list(null));
}

// The listing: headings, and a table of left and right sides for each align.
function typeset(listing) {
  let out = "";
  for (const line of listing.split("\n").slice(1)) {
    if (line.startsWith("% ")) out += (/^% [a-zA-Z]+( [a-z]+)*$/.test(line) ? "<h3>" : "<p>") + plain(line.slice(2)) + (/^% [a-zA-Z]+( [a-z]+)*$/.test(line) ? "</h3>" : "</p>");
    else if (line.startsWith("\\begin")) out += "<table>";
    else if (line.startsWith("\\end")) out += "</table>";
    else if (line.trim()) {
      const [left, right = ""] = line.trim().replace(/\\\\$/, "").split("&= ");
      out += "<tr><td><math displaystyle=\"true\">" + formula(left) + "</math></td><td><math displaystyle=\"true\"><mo>=</mo>" + formula(right) + "</math></td></tr>";
    }
  }
  return out;
}
if (typeof module != "undefined") module.exports = {formula, typeset};
