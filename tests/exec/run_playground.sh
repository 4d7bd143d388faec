#!/bin/sh
# lagc playground: lagc as WebAssembly gives the answers of lagc, in node: messages, proofs, formulas, programs whose motions have the digits of
# lagc run; texts that are too deep or too large; the page in a browser, typed in.
. tests/tap.sh
here=$(dirname "$LAGC")
lagc=$(cd "$here" && pwd)/lagc
if [ ! -f "$here/lagc.wasm.gz" ]; then
  skip "playground" "no Clang for WebAssembly: .ci/setup ci, then make page"
  tap_end
  exit
fi
check "the page" "$LAGC" playground -o "$TMP/play.html"
check "no file to write" sh -c '"$1" playground 2>&1 | grep -q "needs -o FILE.html"' sh "$LAGC"
cp models/pendulum.lag "$TMP/own.lag"
check "a model of one's own is not overwritten" sh -c '! "$1" playground "$2" -o "$2" 2>/dev/null && cmp -s "$2" models/pendulum.lag' sh "$LAGC" "$TMP/own.lag"
if ! command -v node >/dev/null 2>&1; then
  skip "answers of playgrounds" "no node"
  tap_end
  exit
fi

cat >"$TMP/oscillator.lag" <<'END'
model oscillator
coord x [m]
param m = 2 [kg] > 0, k = 8 [N/m] > 0
lagrangian = m*x'^2/2 - k*x^2/2
expect x'' = -k*x/m
expect x'' = -k*x/m*2
scene s { start x = 1 [m]; span 10 [s]; output x, x' every 0.1 [s] }
END
sed 's/k\*x^2/k*xx^2/' "$TMP/oscillator.lag" >"$TMP/mistake.lag"
printf 'model deep\ncoord x\nlagrangian = x'"'"'^2/2 - %s\n' "$(awk 'BEGIN { for (i = 0; i < 3000; i++) printf "sin("; printf "x"; for (i = 0; i < 3000; i++) printf ")" }')" >"$TMP/deep.lag"
printf 'include "other.lag"\nmodel m\ncoord x\nlagrangian = x'"'"'^2/2\n' >"$TMP/parts.lag"
printf 'model m\ninclude "bodies.lag"\ncoord th\nlagrangian = hoop(2, 3)*th'"'"'^2/2\n' >"$TMP/library.lag"
cat >"$TMP/functions.lag" <<'END'
model functions
coord x
potential = exp(x) + log(2 + x^2) + sinh(x) + cosh(x) + tanh(x) + (1 + x^2)^(1/3) + (1 + x^2)^1.5
kinetic = x'^2/2
scene s { start x = 1; span 10 }
END
cat >"$TMP/quotients.lag" <<'END'
model quotients
coord x
param k = 2 > 0, h = 3 > 0
let r = sqrt(x^2 + 1)
kinetic = x'^2/2
potential = -k/r - h/r^3
expect x'' = -k*x/r^3 - 3*h*x/r^5
scene s { start x = 1 }
END
node tests/exec/playground_answers.js "$here/lagc.wasm" >"$TMP/answers" <<END
check $TMP/oscillator.lag
check $TMP/mistake.lag
derive models/pendulum.lag
noether models/kepler.lag
check $TMP/deep.lag
check $TMP/parts.lag
page models/double_pendulum.lag
page models/bouncing_ball.lag
page $TMP/oscillator.lag
derive $TMP/library.lag
check $TMP/functions.lag
check $TMP/quotients.lag
picture models/pendulum.lag
picture $TMP/oscillator.lag
END
# as the command: `digits` are of long double, which differs
same() { # NUMBER FILE
  (cd "$TMP" && cp "$2" model.lag && "$lagc" check --json model.lag | sed 's/"digits": [0-9]*/"digits": 0/g') >"$TMP/native.json"
  node -e 'const fs = require("fs"), [n, file, native] = process.argv.slice(1), a = JSON.parse(fs.readFileSync(file, "utf8").split("\n")[n - 1]).check;
    for (const e of a.expectations) e.digits = 0;
    require("assert").deepStrictEqual(a, JSON.parse(fs.readFileSync(native, "utf8")))' "$1" "$TMP/answers" "$TMP/native.json"
}
check "proofs and refutations are those of lagc check --json" same 1 oscillator.lag
check "a mistake, too" same 2 mistake.lag
check "functions in all digits of long double" same 11 functions.lag
check "quotients, too: 1/(2 - 2^-112) is no 1" same 12 quotients.lag
node tests/exec/playground_facts.js "$TMP/answers" >"$TMP/facts"
fact() { sed -n "s/^$1: //p" "$TMP/facts"; }
is "at its place, with a way out" '4:27 unknown name `xx`; did you mean `x`?' "$(fact place)"
is "equations as MathML" "<tr><td><math>m l^2 θ¨</math></td><td><math>=−m l g sin θ</math></td></tr>" "$(fact equation)"
is "names are no markup" '<mi mathvariant="normal">a&lt;b&gt;&amp;</mi>' "$(fact markup)"
# The search has two seconds: on a busy machine it finds the declared symmetry and the energy.
is "symmetries: angular momentum and energy" "spin = x*y' - y*x', Q1: energy" "$(fact symmetries)"
is "the first scene alone, before all; one scene is all" "1 false, 1 true" "$(fact picture)"
is "a text too deep" "functions are nested 3000 deep here, and at most 2000 in one expression" "$(fact deep)"
is "no files" '1:9 cannot read `other.lag`: a page has no files but bodies.lag, learned_spring.json, quake.csv, road.csv, spring_record.csv' "$(fact file)"

is "but those of the library: a hoop of mass 2 and radius 3 has m*r^2 = 18" "p_θ = 18 θ˙" "$(fact library)"

# digits NUMBER FILE SCENE T: outputs at T of the program that the page compiled, moved in node, and of the run, as numbers.
digits() {
  fact "page$1" >"$TMP/page.html"; echo "const packed" >>"$TMP/page.html"
  there=$(timeout 60 node tests/exec/page_digits.js "$here/lag.wasm" runtime/page/motion.js "$TMP/page.html" "$3" "$4")
  "$LAGC" run "$2" "$3" --method dop853 --tol 1e-10 --until "$4" --every "$4" -o "$TMP/rows.csv" --compile never --quiet || return
  node -e 'const [a, b] = process.argv.slice(1).map(s => s.split(",").map(Number));
    if (!(a.length == b.length && a.length > 1 && a.every((x, i) => Object.is(x, b[i])))) { console.log(a, b); process.exit(1); }' "$there" "$(tail -1 "$TMP/rows.csv")"
}
check "a double pendulum has the digits of lagc run" digits 7 models/double_pendulum.lag swing 5
check "impacts of a ball" digits 8 models/bouncing_ball.lag drop 2
check "an oscillator" digits 9 "$TMP/oscillator.lag" s 3

for name in chromium chromium-browser google-chrome; do
  command -v $name >/dev/null 2>&1 && browser=$name
done
typed() {
  "$LAGC" playground "$TMP/oscillator.lag" -o "$TMP/play.html" || return
  timeout 300 node tests/exec/playground_typed.js "$browser" "$TMP/profile" "$TMP/play.html" >"$TMP/facts"
  sed "s/^/# /" "$TMP/facts"
  is "a mistake that is typed, at its place" '4:27 error: unknown name `xx`; xx' "$(fact mistake)"
  is "its repair: the false claim remains" '6; 1 of 2 expectations proved: for all states at which both sides have real values' "$(fact repaired)"
  near "the motion: x = cos 2t, at the page's tolerance of 1e-9" 1e-8 0 "$(fact off)" # ten times it, for errors that add up
  is "no errors of the script" "faults: " "$(grep '^faults' "$TMP/facts")"
}
if [ "${browser:-}" ]; then
  slow typed
elif [ "${SLOW:-}" ]; then
  skip "playground in a browser" "no chromium"
fi
tap_end
