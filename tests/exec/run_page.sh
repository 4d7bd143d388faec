#!/bin/sh
# lagc page: its module computes the digits of lagc run, in node; the page opens and moves in a browser; hostile titles and bytes.
. tests/tap.sh
. tests/exec/lib_motion.sh
wasm=$(dirname "$LAGC")/lag.wasm
if [ ! -f "$wasm" ]; then
  skip "pages" "no Clang for WebAssembly: .ci/setup ci, then make page"
  tap_end
  exit
fi

# digits MODEL SCENE T [PART]: outputs at T, and the drift of the energy, of the page in node and of the run, as numbers; PART: alike to
# this part of the largest (the drifts are its rounding).
digits() {
  "$LAGC" page "models/$1.lag" "$2" -o "$TMP/page.html" || return
  there=$(ENERGY=1 timeout 30 node tests/exec/page_digits.js "$wasm" runtime/page/motion.js "$TMP/page.html" "$2" "$3")
  "$LAGC" run "models/$1.lag" "$2" --method dop853 --tol 1e-10 --until "${there%%,*}" --every "${there%%,*}" --no-monitors -o "$TMP/rows.csv" --json >"$TMP/run.json" || return
  here=$(tail -1 "$TMP/rows.csv")
  # a run tells no drift where other works than those of known forces are done
  node -e 'const {energy_drift, energy_drift_absolute} = JSON.parse(require("fs").readFileSync(process.argv[3])), of = s => s.split(",").map(Number);
    const a = of(process.argv[1]), b = [...of(process.argv[2]), energy_drift, energy_drift_absolute];
    const off = +process.argv[4]*Math.max(...a.slice(1, -2).map(Math.abs));
    if (!(a.length == b.length && a.length > 3 && a.every((x, i) => x === b[i] || b[i] === null || Math.abs(x - b[i]) <= off))) {
      console.log(a, b); process.exit(1); }' "$there" "$here" "$TMP/run.json" "${4-0}"
}
if command -v node >/dev/null 2>&1; then
  check "a double pendulum has the digits of lagc run" digits double_pendulum swing 5
  check "a slider-crank, held by constraints" digits slider_crank idle 1
  check "impacts of a ball" digits bouncing_ball drop 2
  check "dry friction, sticking and slipping" digits stick_slip squeak 2
  check "contacts with friction, whose choice of modes takes the most stack" digits capstan slips part
  slow check "a planet" digits kepler orbit 20
  slow check "a body that turns about all axes" digits free_body free 5
  # The gallery, but for exp, log, atan2, networks, .., whose last digit C libraries may differ in, and a tower, which only moreau moves.
  of_c='(exp|log|sinh|cosh|tanh|a(cos|sin|tan)[a-z0-9]*)[(]|^network'
  for m in $(grep -LE "$of_c" models/*.lag); do
    m=$(basename "$m" .lag)
    one_of 30 && [ "$m" != tower ] || continue
    check "$m has the digits of lagc run" digits "$m" "$(sed -n 's/^scene \([a-zA-Z0-9_]*\).*/\1/p' "models/$m.lag" | head -1)" part
  done
  # Of the others two C libraries part by a unit in the last place at each call: 2e-15 of the largest output at most, seen in toda.
  for m in $(grep -lE "$of_c" models/*.lag); do
    m=$(basename "$m" .lag)
    one_of 12 || continue
    check "$m has them but for the last digits of exp" digits "$m" "$(sed -n 's/^scene \([a-zA-Z0-9_]*\).*/\1/p' "models/$m.lag" | head -1)" part 1e-13
  done
  "$LAGC" page models/pendulum.lag small -o "$TMP/page.html"
  damaged() { # each damage is an error, or another number; never a trap
    for k in 3 40 201 350 777 1203; do
      DAMAGE=$k node tests/exec/page_digits.js "$wasm" runtime/page/motion.js "$TMP/page.html" small 1 || return
    done
  }
  check "damaged bytes are told" damaged
  for m in pendulum slider_crank brachistochrone; do "$LAGC" derive "models/$m.lag" --format latex >"$TMP/$m.tex"; done
  empty "contrast AA, words in each language, equations as MathML" "$(node tests/exec/page_words.js runtime/page "$TMP"/*.tex)"
  # 300 KB: 236 of the module, 27 of the script; the rest of 350 is for programs
  empty "pages of the gallery's small models are at most 300 KB" "$(wc -c "$TMP/page.html" | awk '$1 > 300e3')"
  slow check "pages of the largest programs are at most 350 KB" sh -c 'for m in bicycle electron_cloud foucault_lab; do "$1" page models/$m.lag -o "$2" && [ "$(wc -c <"$2")" -le 350000 ] || exit 1; done' sh "$LAGC" "$TMP/large.html"
  if command -v xz >/dev/null 2>&1; then
    # copies of all kinds: near, far, of remembered distances, longer than 273, of one byte
    { cat grammar/LANGUAGE.md runtime/page/motion.js; head -c 3000 /dev/zero; tail -c 70000 grammar/LANGUAGE.md; seq 3000; } >"$TMP/bytes"
    check "pages unpack what xz packs" sh -c 'xz -c --format=lzma --lzma1=lc=0,lp=0,pb=2 "$1/bytes" | node tests/exec/page_packed.js runtime/page/motion.js "$1/bytes"' sh "$TMP"
  fi
else
  skip "digits of pages" "no node"
fi

printf '%s\n' 'model m "A <b>ball</b> & </script><script>bad()</script>"' 'coord x' "lagrangian = x'^2/2 - x^2/2" '# </script>' 'scene s { start x = 1; span 5 }' 'effect drag { dissipation = x'"'"'^2 }' >"$TMP/m.lag"
check "a title with markup" "$LAGC" page "$TMP/m.lag" -o "$TMP/m.html"
is "stays text" "0 2 2" "$(grep -c '<script>bad' "$TMP/m.html") $(grep -c '</script>' "$TMP/m.html") $(grep -c '&lt;b>ball' "$TMP/m.html")"
if command -v node >/dev/null 2>&1; then
  is "a program for each set of effects" 2 "$(node tests/exec/page_digits.js "$wasm" runtime/page/motion.js "$TMP/m.html" s programs)"
fi
stored() { # by a lagc without liblzma: a note, and the same digits
  grep -q '^ZIP_FOUND := yes' "$BUILD/config.mk" && zip="-lminizip -lz"
  # shellcheck disable=SC2086 # libraries
  "${CC%% *}" -std=c11 -w -Isrc -c -o "$TMP/pack.o" src/commands/pack.c && "${CC%% *}" -o "$BUILD/lagc-stored" "$BUILD/obj/src/main.o" "$TMP/pack.o" "$BUILD/liblagc.a" ${zip-} -lm &&
    says 0 'apt-get install liblzma-dev' "$BUILD/lagc-stored" page models/pendulum.lag small -o "$TMP/long.html" && rm "$BUILD/lagc-stored" && [ "$(wc -c <"$TMP/long.html")" -gt "$(wc -c <"$TMP/page.html")" ] &&
    [ "$(node tests/exec/page_digits.js "$wasm" runtime/page/motion.js "$TMP/long.html" small 1)" = "$(node tests/exec/page_digits.js "$wasm" runtime/page/motion.js "$TMP/page.html" small 1)" ]
}
if [ -z "${COVERAGE:-}" ] && command -v node >/dev/null 2>&1; then check "a lagc that was built without liblzma" stored; fi
check "no file to write" sh -c '"$1" page models/pendulum.lag 2>&1 | grep -q "needs -o FILE.html"' sh "$LAGC"
echo "model m" >"$TMP/wrong.lag"
check "a wrong model" sh -c '! "$1" page "$2" -o "$3" 2>/dev/null && [ ! -e "$3" ]' sh "$LAGC" "$TMP/wrong.lag" "$TMP/none.html"

for name in chromium chromium-browser google-chrome; do
  command -v $name >/dev/null 2>&1 && browser=$name
done
if [ "${browser:-}" ]; then
  # dom PAGE FRAGMENT: the page after some seconds, once more where the module was not compiled by then
  dom() {
    for _ in 1 2 3 4; do
      once "$@" >"$TMP/once"
      grep -q data-state "$TMP/once" && break
    done
    cat "$TMP/once"
  }
  once() {
    "$browser" --headless --no-sandbox --disable-gpu --disable-dev-shm-usage --user-data-dir="$TMP/profile" --virtual-time-budget=8000 \
      --dump-dom "file://$1#$(node -e 'console.log(encodeURIComponent(process.argv[1]))' "$2")" 2>"$TMP/browser.log"
  }
  dom "$TMP/m.html" '{"scene":"s","effects":[],"t":3.5,"fine":90}' >"$TMP/dom"
  x=$(sed -n 's/.*data-state="{&quot;x&quot;:\([-.0-9e]*\),.*/\1/p' "$TMP/dom")
  check "a browser computes x = cos t" close_to "${x:-none}" "$(calc 'cos(3.5)')" 1e-9
  check "without a complaint" grep -q '<p id="said"[^>]*></p>' "$TMP/dom"
  dom "$TMP/m.html" '{"scene":"s","effects":["drag"],"t":3.5,"fine":90}' >"$TMP/dom"
  x=$(sed -n 's/.*data-state="{&quot;x&quot;:\([-.0-9e]*\),.*/\1/p' "$TMP/dom")
  # x'' + 2 x' + x = 0 from x = 1 at rest: (1 + t) exp(-t)
  check "with drag, (1 + t) exp(-t)" close_to "${x:-none}" "$(calc '4.5*exp(-3.5)')" 1e-9
  # The bob of a pendulum, dragged to a place beside its circle: it follows the direction.
  cat >"$TMP/drag" <<'END'
<script>
const drag = () => {
  if (!(window.lagc && lagc.motion && lagc.picture)) { setTimeout(drag, 100); return; }
  lagc.pause();
  const c = document.getElementById("picture"), r = c.getBoundingClientRect(), p = lagc.picture, bob = p.bodies[p.bodies.length - 1].a;
  const [x, y] = p.toCanvas(p.place(bob)), to = [x + 90, y - 60], send = (type, at) =>
    c.dispatchEvent(new PointerEvent(type, {pointerId: 1, clientX: r.left + at[0], clientY: r.top + at[1], bubbles: true}));
  send("pointerdown", [x, y]);
  for (let k = 1; k <= 10; k++) send("pointermove", [x + (to[0] - x)*k/10, y + (to[1] - y)*k/10]);
  const [px, py] = p.inPlane(...to), wanted = Math.atan2(px, -py);
  send("pointerup", to);
  const [bx, by] = p.place(bob), off = p.bodies.length == 1 ? lagc.motion.state.th - wanted : Math.hypot(bx - px, by - py);
  document.body.dataset.drag = Math.abs(off).toExponential(1);
  document.body.dataset.state = "";
};
drag();
</script>
END
  follows() { # MODEL SCENE
    "$LAGC" page "models/$1.lag" "$2" -o "$TMP/drag.html" && cat "$TMP/drag" >>"$TMP/drag.html" && dom "$TMP/drag.html" "{\"scene\":\"$2\",\"effects\":[]}" >"$TMP/dom"
    sed -n 's/.*data-drag="\([^"]*\)".*/\1/p' "$TMP/dom" | awk '{ print; ok = $1 < 1e-3 } END { exit !ok }'
  }
  check "a bob that is dragged follows the pointer" follows pendulum small
  events() { # pages under real events, and the site
    for m in pendulum double_pendulum slider_crank kepler; do "$LAGC" page "models/$m.lag" -o "$TMP/$m.html" || return; done
    printf '%s\n' 'model wall' 'state z' "flow z' = z^2" 'scene s { start z = 1; span 5 }' >"$TMP/wall.lag" # z = 1/(1 - t)
    printf '%s\n' 'model drop' 'coord y [m]' 'param m = 1 [kg] > 0, g = 9.81 [m/s^2] > 0, c = 0 [kg/s] >= 0' "kinetic = m/2*y'^2" 'potential = m*g*y' "dissipation = c/2*y'^2" \
      'event lands: y falling { stop }' 'scene s { start y = 1; span 5; output hypot(y, 1 [m]), y every 0.1 }' >"$TMP/drop.lag"
    printf '%s\n' 'model loose' 'coord x[100] [m], y[100] [m]' 'kinetic = sum(i in 1..100, 0.5 [kg]*(x[i]'"'"'^2 + y[i]'"'"'^2))' \
      'potential = sum(i in 1..100, 0.5 [N/m]*((x[i] - i*1 [m])^2 + y[i]^2))' 'draw ball[i in 1..100] at (x[i], y[i])' \
      'scene s { start x[i in 1..100] = i*1.01 [m]; span 5; tolerance 1e-6 }' >"$TMP/loose.lag"
    "$LAGC" page "$TMP/drop.lag" -o "$TMP/drop.html" && "$LAGC" page "$TMP/loose.lag" -o "$TMP/loose.html" || return
    "$LAGC" page "$TMP/wall.lag" -o "$TMP/wall.html" && .ci/site "$LAGC" "$TMP/site" pendulum lorenz string || return
    timeout 300 node tests/exec/page_events.js "$browser" "$TMP" pendulum lorenz
  }
  slow relay events
else
  skip "pages in a browser" "no chromium"
fi
tap_end
