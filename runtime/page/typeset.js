// MathML of the LaTeX that `lagc derive --format latex` prints: a small dialect, whose signs are the cases below. typeset("g_{1}") gives the
// elements of a row; typeset_listing gives headings and tables of equations.
const greek = {alpha: "α", beta: "β", gamma: "γ", delta: "δ", epsilon: "ε", zeta: "ζ", eta: "η", theta: "θ", iota: "ι", kappa: "κ", lambda: "λ", mu: "μ", nu: "ν", xi: "ξ",
  pi: "π", rho: "ρ", sigma: "σ", tau: "τ", upsilon: "υ", phi: "φ", chi: "χ", psi: "ψ", omega: "ω", Gamma: "Γ", Delta: "Δ", Theta: "Θ", Lambda: "Λ", Xi: "Ξ", Pi: "Π",
  Sigma: "Σ", Phi: "Φ", Psi: "Ψ", Omega: "Ω", hbar: "ħ"};
const signs = {le: "≤", ge: "≥", wedge: "∧", vee: "∨", neg: "¬", cdot: "·", times: "×", sum: "∑", quad: " ", ",": " ", ";": " ", "{": "{", "}": "}", lfloor: "⌊", rfloor: "⌋",
  in: "∈", to: "→", ne: "≠", infty: "∞", partial: "∂", int: "∫", "&": "&", "%": "%", "_": "_", "#": "#", "$": "$", lbrace: "{", rbrace: "}", approx: "≈", ll: "≪", gg: "≫"};
const marks = {dot: "˙", ddot: "¨", dddot: "⃛", hat: "^", bar: "¯", tilde: "~"};
const plain = s => s.replace(/&/g, "&amp;").replace(/</g, "&lt;").replace(/>/g, "&gt;");
const upright = /<mi mathvariant="normal">[^<]{2}/;
function typeset(latex) {
  const token = latex.match(/\\[a-zA-Z]+\*?|\\.|[0-9]+(?:\.[0-9]+)?(?:e[-+]?[0-9]+)?|\s+|[^]/gu) || [];
  let k = 0;
  const row = all => all.length == 1 ? all[0] : "<mrow>" + all.join("") + "</mrow>";
  const blank = () => { while (k < token.length && /^\s/.test(token[k])) k++; };
  const raw = () => { // a group as text
    blank();
    if (token[k] != "{") return token[k++] || "";
    let depth = 1, text = "";
    for (k++; k < token.length; k++) {
      if (token[k] == "{") depth++;
      else if (token[k] == "}" && !--depth) { k++; break; }
      text += token[k];
    }
    return text.replace(/\\([^a-zA-Z])/g, "$1").replace(/\\[a-zA-Z]+/g, s => greek[s.slice(1)] || signs[s.slice(1)] || s.slice(1));
  };
  const group = () => { blank(); if (token[k] != "{") return one(); k++; const all = list("}"); k++; return row(all); };
  function one() {
    blank();
    const t = token[k++];
    if (t === undefined) return "";
    if (t == "{") { k--; return group(); }
    if (t == "(") { const all = list(")"); k++; return '<mrow><mo stretchy="false">(</mo>' + all.join("") + '<mo stretchy="false">)</mo></mrow>'; }
    if (/^[0-9]/.test(t)) return "<mn>" + t + "</mn>";
    if (t[0] != "\\") return /^\p{L}$/u.test(t) ? "<mi>" + t + "</mi>" : "<mo" + ("()[]|".includes(t) ? ' stretchy="false"' : "") + ">" + plain(t == "-" ? "−" : t == "'" ? "′" : t) + "</mo>";
    const name = t.slice(1);
    if (name == "frac") { const a = group(); return "<mfrac>" + a + group() + "</mfrac>"; }
    if (name == "sqrt") return "<msqrt>" + group() + "</msqrt>";
    if (name == "mathrm" || name == "operatorname" || name == "operatorname*") return "<mi mathvariant=\"normal\">" + plain(raw()) + "</mi>";
    if (name == "text" || name == "tag") return "<mtext>" + plain(raw()) + "</mtext>";
    if (name in marks) return '<mover accent="true">' + group() + "<mo>" + marks[name] + "</mo></mover>";
    if (name == "left") {
      const open = token[k++], all = list("\\right");
      k++;
      return "<mrow><mo>" + plain(open == "." ? "" : open.replace("\\", "")) + "</mo>" + all.join("") + "<mo>" + plain((token[k++] || "").replace(/^\.$|\\/, "")) + "</mo></mrow>";
    }
    if (name in greek) return "<mi>" + greek[name] + "</mi>";
    if (name in signs) return "<mo>" + plain(signs[name]) + "</mo>";
    return '<mspace width="0.17em"></mspace><mi mathvariant="normal">' + plain(name) + '</mi><mspace width="0.1em"></mspace>'; // \sin
  }
  function list(end) {
    const all = [];
    for (;;) {
      blank();
      if (k >= token.length || token[k] == end) return all;
      const base = one();
      let sub = null, sup = null;
      for (blank(); token[k] == "_" || token[k] == "^"; blank()) token[k++] == "_" ? sub = group() : sup = group();
      const big = base.includes("∑"), [b, p, both] = big ? ["munder", "mover", "munderover"] : ["msub", "msup", "msubsup"];
      if (all.length && upright.test(all.at(-1) + base) && !/^<m(o|space)/.test(base) && !/^<m(o|space)|<mspace[^>]*><\/mspace>$/.test(all.at(-1))) all.push('<mspace width="0.17em"></mspace>'); // names of several letters beside others
      all.push(sub && sup ? `<${both}>${base}${sub}${sup}</${both}>` : sub ? `<${b}>${base}${sub}</${b}>` : sup ? `<${p}>${base}${sup}</${p}>` : base);
    }
  }
  return list();
}
// Each term of a sum its own <math>, with its sign: lines break between them, and a slider lights them.
function terms(all) {
  const rows = [[]];
  for (const x of all) /^<mo>[+−=<≤]<\/mo>$/.test(x) && rows.at(-1).length ? rows.push([x]) : rows.at(-1).push(x);
  return rows.map(r => "<math displaystyle=\"true\"><mrow>" + (/^<mo/.test(r[0]) ? r[0] + '<mspace width="0.25em"></mspace>' + r.slice(1).join("") : r.join("")) + "</mrow></math>").join(" ");
}
function typeset_listing(latex, headings = {}) { // headings: the compiler's and another language's
  const out = [];
  for (const [, title, body] of latex.matchAll(/^% (.*)\n\\begin\{align\*\}\n([^]*?)\\end\{align\*\}/gm)) {
    out.push("<h3>" + plain(headings[title] || title) + "</h3>");
    for (const line of body.split(/\\\\\s*\n|\n\s*\n/))
      if (line.trim()) out.push('<div class="equation">' + line.split(/(?<!\\)&/).map(side => terms(typeset(side))).join(" ") + "</div>");
  }
  return out.join("");
}
