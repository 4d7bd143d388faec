#!/bin/sh
# One fact, one judgement: what check, derive, noether, modes, run and emitted flags say of one model must agree. A contradiction
# is a fault, and so is a conserved energy that drifts in a run. verdicts/ has models whose verdicts are known by hand.
. tests/tap.sh
models=tests/exec/verdicts
# Each command takes a second or two: what takes a hundred is a fault, too, and is named at the end.
lagc() {
  timeout 100 "$LAGC" "$@"
  set -- "$?" "$@"
  [ "$1" != 124 ] || echo "$2 $3" >>"$TMP/late"
  return "$1"
}
export XDG_CACHE_HOME="${XDG_CACHE_HOME:-$TMP}"

# word FILE: conserved, changes or undecided, of the sentence about the energy; nothing where there is none.
word() {
  sed -n 's/.*not decided whether the energy.*/undecided/p; t
    s/.*energy is conserved.*/conserved/p; s/.*energy changes.*/changes/p' "$1" | head -n 1
}
# sentence FILE: from "energy" or "not decided" to the end of its line
sentence() {
  sed -n 's/^.*\(not decided whether the energy.*\)$/\1/p; t
    s/^.*\(energy is conserved.*\|energy changes.*\)$/\1/p' "$1" | head -n 1
}
# same WHAT A B
same() { [ "$2" = "$3" ] || echo "$1: $2 | $3"; }

# cyclic FILE: the lines on cyclic coordinates, one for each member of a family
cyclic() {
  awk '/^cyclic/ { if (!match($0, /  for [a-z] in [0-9]+\.\.[0-9]+$/)) { print; next }
    rest = substr($0, 1, RSTART - 1); split(substr($0, RSTART + 11), end, "[.][.]")
    for (k = end[1] + 0; k <= end[2] + 0; k++) { line = rest; gsub(/\[[a-z]\]/, "[" k "]", line); print line } }' "$1"
}

# symmetries: those that noether lists, against check
symmetries() {
  lagc noether "$m" "$s" >"$o/noether" 2>/dev/null
  lagc noether "$m" "$s" --format json >"$o/json" 2>/dev/null
  same "check and noether" "$(sentence "$o/check")" "$(sentence "$o/noether")"
  same "check and noether's JSON" "$said" "$(sed -n '1s/.*"energy": "\([a-z ]*\)".*/\1/p' "$o/json" | sed 's/not decided/undecided/')"
  same "cyclic in check and noether" "$(grep '^cyclic' "$o/check")" "$(grep '^cyclic' "$o/noether")"
  same "cyclic in check and JSON" "$(cyclic "$o/check" | sed -n 's/^cyclic coordinate: \([^;]*\);.*/\1/p' | paste -sd ' ' -)" "$(sed -n '1s/.*"cyclic": \[\(.*\)\],$/\1/p' "$o/json" | tr -d '",')"
  cyclic "$o/check" | sed -n 's/^cyclic coordinate: \([^;]*\);.* is conserved.*/\1/p' | while read -r x; do
    grep -F "\"delta\": {\"$x\": \"1\"}, \"delta_t\": \"0\"" "$o/json" | grep '"is": "changes"' | sed "s/^/p_$x conserved in check, not in noether: /"
  done
}

# quick MODEL SCENE: contradictions between check, derive, noether and emitted C, without a simulator
quick() {
  m=$1 s=$2 o=$TMP/words
  mkdir -p "$o"
  lagc check --allow-numeric "$m" "$s" >"$o/check" 2>/dev/null
  said=$(word "$o/check")
  [ -n "$said" ] || return 0
  lagc derive "$m" "$s" >"$o/derive" 2>/dev/null
  lagc emit "$m" "$s" >"$o/c" 2>/dev/null
  same "check and derive" "$(sentence "$o/check")" "$(sentence "$o/derive")"
  [ "$(sed -n '1s/^\([0-9]*\) coordinate.*/\1/p' "$o/check")0" -gt "${SLOW:+9}30" ] || symmetries # the search takes a second with more than 3 coordinates
  rate=$(grep -c '^  d[EH]/dt = ' "$o/derive")
  grep -q 'L jumps' "$o/check" || case $said:$rate in
  conserved:0 | changes:[1-9]* | undecided:*) ;;
  *) echo "check: $said; derive prints $rate rates" ;;
  esac
  grep -q "L depends on an input" "$o/check" && [ "$said" != undecided ] && echo "unknown rate, yet $said"
  flags=$(sed -n 's/^ *\.flags = \(LAG_[A-Z_| ]*\),$/\1/p' "$o/c")
  case $flags in
  *LAG_CONSERVES_ENERGY*) same "emitted flag" conserved "$said" ;;
  *) grep -q 'while inputs follow' "$o/check" || [ "$said" != conserved ] || echo "no flag of a conserved energy" ;;
  esac
  charge=$(sed -n 's/^  {"energy", "[^"]*", \(LAG_.*\|0\)},$/\1/p' "$o/c")
  case $charge in
  *LAG_CONSERVED*) same "emitted charge" conserved "$said" ;;
  ?*) [ "$said" != conserved ] || echo "the emitted charge is not conserved" ;;
  esac
  mass=$(sed -n 's/.*mass matrix \([a-z]*\).*/\1/p' "$o/check" | head -n 1)
  case $mass:$flags in
  constant:*LAG_CONSTANT_MASS* | :*) ;;
  constant:* | *:*LAG_CONSTANT_MASS*) echo "M is $mass, flags are $flags" ;;
  esac
}

# value NAME FILE: of JSON
value() { sed -n "s/.*\"$1\": \\([^,}]*\\)[,}].*/\\1/p" "$2" | head -n 1; }

# full MODEL SCENE: run and modes, too; a conserved energy drifts by less than 1e-5 in a run with a tolerance of 1e-9
full() {
  quick "$1" "$2"
  [ -n "$said" ] || return 0
  timeout 20 "$LAGC" run "$m" "$s" --method dop853 --tol 1e-9 --until "${3:-0.5}" --json >"$o/run" 2>/dev/null ||
    return 0 # events or constraints may end it, or the scene is of nanoseconds
  lagc modes "$m" "$s" >"$o/modes" 2>&1
  is=$(sed -n 's/.*"charges": {"energy": {"is": "\([a-z ]*\)".*/\1/p' "$o/run")
  drift=$(value energy_drift "$o/run")
  case $said:$is in
  conserved:conserved | changes:balanced | changes:"not known" | undecided:balanced | undecided:"not known") ;;
  *) echo "check says $said, run $is" ;;
  esac
  case $is:$drift in
  conserved:null) echo "conserved without a drift" ;;
  conserved:*)
    close_to "$drift" 0 1e-5 >/dev/null || close_to "$(value energy_drift_absolute "$o/run")" 0 1e-12 >/dev/null ||
      echo "conserved, and drifts by $drift"
    ;;
  *:null) ;;
  *) echo "a drift of an energy that is $is" ;;
  esac
  here=$(grep -o 'which is 0 in this scene' "$o/check")
  case $said:$here:$(tr '\n' ' ' <"$o/modes") in
  changes:which*"conserved at these values"*) ;;
  changes:which*"no energy is known"* | *::*"conserved at these values"*) echo "check says ${here:-nothing of values}, modes: $(grep -m1 energy "$o/modes")" ;;
  changes:*"which is conserved"* | undecided:*"which is conserved"* | conserved:*"no energy is known"*)
    echo "check says $said, modes: $(grep -m1 energy "$o/modes")"
    ;;
  esac
  case $flags:$(cat "$o/modes") in *LAG_AUTONOMOUS*:*"t stands in its equations"*) echo "modes sees t in equations without it" ;; esac
}

# ---- verdicts that are known
# is_said MODEL WORD: check's verdict, and no contradiction
is_said() {
  faults=$(quick "$models/$1.lag" "$(sed -n 's/^scene \([a-z]*\).*/\1/p' "$models/$1.lag" | head -n 1)")
  is "$1: $3" "$2" "$(word "$TMP/words/check")"
  empty "$1: all say so" "$faults"
}
is_said bead_on_parabola conserved "t drops out of L"
is_said turntable conserved "t drops out of L: as multiplied out by hand"
is_said two_bodies_turning conserved "t drops out below roots"
is_said magnetic_force conserved "q r' x B does no work"
is_said coriolis_force conserved "one force does no work, the other has a potential"
is_said no_force conserved "forces that are 0"
is_said moving_rod conserved "a multiplier that is 0"
is_said normal_force conserved "a force normal to the constraint"
is_said constant_force conserved "a constant force"
is_said kepler_by_force conserved "Newton's force"
is_said well_by_force conserved "exp(u) du/dx"
is_said shaken changes "a constraint that does work"
is_said mean_field undecided "forces that couple 60 coordinates have a potential, which is not looked for"
check "mean_field: and check says so" grep -q "no potential of theirs is looked for: if they have one, give it as .potential." "$TMP/words/check"
check "mean_field: its cyclic coordinates in one line" grep -q "cyclic coordinate: a\[i\]; .* for i in 1..60" "$TMP/words/check"
# verdicts: the words of models with these lines in the place of LINES, as "word lines" pairs, "; " between lines; `word:` where check differs
verdicts() {
  while read -r wanted lines; do
    printf 'model m\ncoord x, y\nparam k = 2 > 0, w = 0.5 > 0\n%s\nscene s { start x = 0.4, y = -0.3; span 1 }\n' "$(echo "$lines" | sed 's/; /\n/g')" >"$TMP/m.lag"
    lagc check "$TMP/m.lag" s >"$TMP/said" 2>/dev/null
    [ "$(word "$TMP/said")" = "$wanted" ] || echo "$lines: $(head -n 1 "$TMP/said")"
  done
}
free="lagrangian = (x'^2 + y'^2)/2 - y^2"
# Each conserved: a force of its own coordinate has a potential, whose form is a table's (Gradshteyn, Ryzhik, chapter 2), or two have one together
sed "s|^|conserved $free; |" >"$TMP/table" <<'END'
force x = -k*tanh(x/w)
force x = -atan(k*x)
force x = -x*abs(x)
force x = -k*sign(x)*sqrt(abs(x))
force x = sin(x)/(2 + cos(x))
force x = 1/(2 + x)
force x = -x/(2 + x)
force x = -1/(1 + x + x^2)
force x = 1/cosh(x)^2
force x = -log(3 + x)
force x = -k*max(0, x - w)^1.5
force x = if(x > w, -k*(x - w), if(x < -w, -k*(x + w), 0))
force x = -min(x, w)
force x = -x/(1 + abs(x))
force x = -k*x*(1 - w/hypot(x, 1))
force x = -asin(x/3) - cbrt(x) - tan(x/4)
force x = -k*abs(x - y)*(x - y); force y = k*abs(x - y)*(x - y)
force x = -tanh(x - y) - x^3; force y = tanh(x - y)
force x = -x*hypot(x, y); force y = -y*hypot(x, y)
END
# no closed form, and yet a potential; a force with a hole in its domain has one near each place
sed "s|^|undecided $free; |" >>"$TMP/table" <<'END'
force x = -cos(sin(x))
force x = -exp(-x^2); force y = -tanh(y)/(1 + y^2)
force x = -y/(x^2 + y^2); force y = x/(x^2 + y^2)
END
# a total time derivative of f(x, t) in L: t x^2/2, sin(w t) x y, t^2 e^x; what is none; H with forces
cat >>"$TMP/table" <<END
conserved $free + t*x*x' + x^2/2
conserved $free + w*cos(w*t)*x*y + sin(w*t)*(x'*y + x*y')
conserved $free + t^2*x'*exp(x) + 2*t*exp(x) + sin(3*t); force x = -x^3
conserved $free + t*x*x'
changes $free + t*x*y'
changes $free + t*x
changes $free; force x = cos(t)
changes $free; force x = -x'
changes $free; force x = y
changes $free - cos(th) + th'^2/2; coord th periodic; force th = 1/(2 + sin(th))
undecided $free - cos(th) + th'^2/2; coord th periodic; force th = sin(sin(th))
undecided $free; param b = 0; force x = cos(b*x)
conserved $free; param b = 2 > 0; force x = cos(b*x)
undecided $free - cos(th) + th'^2/2; coord th periodic; force th = abs(sin(th)) - 2/pi
undecided $free - cos(th) + th'^2/2; coord th periodic; force th = if(sin(th) > 0, 1, -1)
undecided $free - cos(th) + th'^2/2; coord th periodic; force th = 1/(1.00001 + cos(th)) - 1/sqrt(1.00001^2 - 1)
changes $free - cos(th) + th'^2/2; coord th periodic; force th = if(sin(th) > 1/2, 1, -1)
changes $free; force x = -sign(y)
changes $free; force x = if(y > 0, x, 2*x)
changes $free; force x = -floor(y)
changes momentum p of x, q of y; hamiltonian = (p^2 + q^2)/2 + y^2; force x = -sign(p)
conserved momentum p of x, q of y; hamiltonian = (p^2 + q^2)/2 + y^2; force x = -x^3 - tanh(x - y); force y = tanh(x - y)
changes momentum p of x, q of y; hamiltonian = (p^2 + q^2)/2 + y^2; force x = -x'
changes momentum p of x, q of y; hamiltonian = (p^2 + q^2)/2 + y^2; force x = y
END
empty "potentials of forces, and total time derivatives" "$(verdicts <"$TMP/table")"
printf '%s\n' "model chain" "const N = 100" "coord x[N]" "lagrangian = sum(i in 1..N, x[i]'^2/2)" "force x[1] = tanh(x[2] - x[1])" \
  "for i in 2..N-1 { force x[i] = tanh(x[i+1] - x[i]) - tanh(x[i] - x[i-1]) }" "force x[N] = -tanh(x[N] - x[N-1])" "scene s { start x[1] = 1; span 1 }" >"$TMP/chain.lag"
lagc check "$TMP/chain.lag" >"$TMP/said" 2>/dev/null
is "a long chain of forces" conserved "$(word "$TMP/said")"
is_said curl changes "a force with a curl"
is_said drag_of_zero changes "a drag whose coefficient is 0 in the scene"
of_values=$(lagc check $models/drag_of_zero.lag free | grep -o 'which is 0.*')
is "and what is 0 with the scene's values" "which is 0 in this scene, where c = 0, F = 0" "$of_values"
is "with one of two that is not 0" "" "$(lagc check $models/drag_of_zero.lag pushed | grep -o 'which is 0.*')"
empty "modes agree" "$(for s in free pushed damped; do full $models/drag_of_zero.lag $s; done)"
check "a minimum of an energy that these values conserve" grep -q '^stable: the energy, which is conserved at these values' "$(full $models/drag_of_zero.lag free; echo "$TMP/words/modes")"
is_said torque changes "a torque on an angle has no potential with one value"
is_said two_branches undecided "zero on one branch of a constraint alone"
is "the symmetries of the turntable are those of its expanded form" "8 8" "$(for f in turntable turntable_expanded; do lagc noether $models/$f.lag | sed -n 's/^found: \([0-9]*\).*/\1/p'; done | paste -sd ' ' -)"
empty "run and modes, a constant force" "$(full $models/constant_force.lag hang 1)"
check "it is stable" grep -q '^stable: the energy, which is conserved, has a minimum here' "$TMP/words/modes"
printf "model m\ncoord x, y\ninput u = 0\nlagrangian = x'^2/4 + (1 + x^2)*y'^2/2 - 2*x^2*y^2 + u\nscene s { start x = 0.6, y = -0.3, x' = 0.4; span 1 }\n" >"$TMP/follows.lag"
empty "run and modes, an input that follows its formula" "$(full "$TMP/follows.lag" s 1)"
printf "model m\ncoord x\nparam F = 0\ninput u = 0, f = F*t\nlagrangian = x'^2/2 - x^2/2\nforce x = (u + f)*(1 + x')\nscene s { start x = 1; span 1 }\n" >"$TMP/idle.lag"
empty "run and modes, inputs that are 0 in a force" "$(full "$TMP/idle.lag" s 1)"
is "check names what is 0" "which is 0 in this scene, where u = 0, f = 0" "$(lagc check "$TMP/idle.lag" | grep -o 'which is 0.*')"
# A gyroscope's force leaves the minimum of the energy: modes of the rest, found either way.
printf "model m\ncoord x, y\nlagrangian = (x'^2 + y'^2)/2 + 2*(x*y' - y*x') - x^2/2 - y^2\nscene s { start x = 1; span 1 }\n" >"$TMP/gyro.lag"
is "modes and modes --steady, a rest" "stable stable" "$(for o in "" --steady; do lagc modes "$TMP/gyro.lag" $o | sed -n 's/^\(stable\|undecided\).*/\1/p'; done | paste -sd ' ' -)"
empty "run and modes, a rotating wire" "$(full $models/bead_on_parabola.lag slow 1)"
check "it is stable" grep -q '^stable: the energy, which is conserved, has a minimum here' "$TMP/words/modes"
h() { # h H LINE: the verdict of modes on a model with this Hamiltonian
  printf '%s\n' "model h" "coord x, y" "momentum p of x, q of y" "hamiltonian = $1" "$2" "scene s { start x = 0.1; span 1 }" >"$TMP/h.lag"
  lagc modes "$TMP/h.lag" 2>/dev/null | sed -n 's/^\([a-z]*stable\|undecided\)[: ].*\(minimum\|maximum\) .*/\1 \2/p; t; s/^\([a-z]*stable\|undecided\).*/\1/p'
}
is "modes of H: a minimum, with a force, a maximum, neither" "stable minimum|stable minimum|stable maximum|undecided" \
  "$(h "(p^2 + q^2 + x^2)/2 + y^2 + x*y/2" "")|$(h "(p^2 + q^2)/2 + y^2" "force x = -x*hypot(1, x)")|$(h "-(p^2 + q^2 + x^2)/2 - y^2 - x^4" "")|$(h "(p^2 + x^2)/2 - (q^2 + 2*y^2)/2" "")"
lagc check $models/rows_of_motion.lag >"$TMP/rows" 2>/dev/null
is "rows of the equations of motion, and combinations, are proved; a false one is not" "9 1" \
  "$(grep -c ': proved$' "$TMP/rows") $(grep -c ' (wrong): refuted$' "$TMP/rows")"
for m in row_sums row_sums_dense; do lagc check $models/$m.lag 2>/dev/null; done >"$TMP/rows"
is "sums of all rows of long chains are proved; false ones are not" "5 3" "$(grep -c ': proved$' "$TMP/rows") $(grep -c ': refuted$' "$TMP/rows")"

# ---- the gallery, and random models: a few of them quickly; in `make test-long` a third of the random ones, in `make test-all` all, with runs and
# modes of the gallery and of a tenth
scenes() { sed -n 's/^scene \([A-Za-z_0-9]*\).*/\1/p' "$1"; }
how=quick
[ -z "${SLOW:-}" ] || how=full
few=1 count=4
[ -z "${SLOW:-}" ] || few=3 count=500
for m in models/*.lag; do
  one_of 24 || continue
  for s in $(scenes "$m" | head -n $few); do empty "$(basename "$m") $s" "$($how "$m" "$s")"; done
done
"${CC%% *}" -O1 -w -o "$TMP/generate" tests/random/generate.c tests/random/model.c && "$TMP/generate" 36 1 $count "$TMP"
for m in "$TMP"/r*.lag; do
  [ -z "${SLOW:-}" ] || one_of 12 || continue
  how=quick
  case $m in *0.lag) [ -z "${SLOW:-}" ] || how=full ;; esac
  empty "random model $(basename "$m" .lag) of seed 36" "$($how "$m" one 0.05)"
done
empty "no command takes 100 s" "$(cat "$TMP/late" 2>/dev/null)"
tap_end
