#!/bin/sh
# Verdicts of lagc modes against runs of the same model from beside the equilibrium: an unstable mode grows as its shape and rate say, by a
# factor of 1000; a stable equilibrium keeps a disturbance near for 100 periods of its slowest mode, an asymptotically stable one loses it.
# Over the gallery, and over small random models with gyroscopic forces, friction and quartic terms.
. tests/tap.sh
needs_gsl
LAGC_OPTIMISE=-O0
export LAGC_OPTIMISE

# probe MODEL SCENE [STATES] <JSON of modes: a scene from beside the equilibrium; comments say what its run must show:
# `grows e c...`: components of the deviation at the end and how far they may be off; `stays e`, `decays e`: its largest size
probe() {
  awk -v like="$1" -v states=" $2 " 'BEGIN { RS = "{\"re\"" }
    NR == 1 { verdict = $0; sub(/.*"verdict": "/, "", verdict); sub(/".*/, "", verdict)
      sub(/.*"equilibrium": \{/, ""); sub(/\}.*/, ""); n = split($0, pair, /, /)
      for (i = 1; i <= n; i++) { split(pair[i], half, /: /); name[i] = half[1]; gsub(/"/, "", name[i]); at[i] = half[2] + 0 }
      next }
    { re = $0; sub(/^: /, "", re); sub(/,.*/, "", re); im = $0; sub(/.*"im": /, "", im); sub(/,.*/, "", im); re += 0; im += 0
      if (NR == 2 || re > most) { most = re; w = im; shape = $0; sub(/.*"shape": \{/, "", shape) }
      if (im > 0 && (!slow || im < slow)) slow = im
      if (re < 0 && (!decay || -re < decay)) decay = -re }
    END {
      if (verdict == "unstable") {
        eps = 1e-6; T = log(1000)/most; split(shape, row, /\], /)
        for (i = 1; i <= n; i++) { s = row[i]; sub(/.*\[/, "", s); split(s, p, /, /); a[i] = p[1] + 0; b[i] = p[2] + 0
          q[i] = eps*a[i]; v[i] = eps*(most*a[i] - w*b[i])
          want = want sprintf(" %.9g", at[i] + 1000*eps*(cos(w*T)*a[i] - sin(w*T)*b[i])) }
        print "# grows 2e-5" want
      } else if (verdict == "stable" || verdict == "asymptotically stable") {
        T = slow ? 100*2*3.14159265358979/slow : 0
        if (verdict != "stable" && T < 10/decay) T = 10/decay
        for (i = 1; i <= n; i++) q[i] = 1e-4*(1 - 2*(i % 2)*i/(n + 1))
        want = ""; for (i = 1; i <= n; i++) want = want sprintf(" %.9g", at[i])
        print "# " (verdict == "stable" ? "stays 1e-2" : "decays 1e-5") want
      } else exit 1
      printf "scene probe {\n  like %s\n  start ", like
      for (i = 1; i <= n; i++) { printf "%s%s = %.17g", (i > 1 ? ", " : ""), name[i], at[i] + q[i]
        if (index(states, " " name[i] " ") == 0) printf ", %s'"'"' = %.17g", name[i], v[i] }
      printf "\n  span %.17g\n  tolerance 1e-10\n  output ", T
      for (i = 1; i <= n; i++) printf "%s%s", (i > 1 ? ", " : ""), name[i]
      printf " every %.17g\n}\n", T/(verdict == "unstable" ? 1 : 300) }'
}
# shown KIND TOLERANCE VALUES... <rows: whether they show it
shown() {
  awk -F, -v want="$*" 'BEGIN { n = split(want, w, " ") } NR == 1 { next }
    { off = 0; for (i = 3; i <= n; i++) { d = $(i - 1) - w[i]; if (d < 0) d = -d; if (d > off) off = d } if (off > most) most = off }
    END { if (NR < 2 || (w[1] == "stays" ? most : off) > w[2] + 0) { print w[1] ": off by " (w[1] == "stays" ? most : off) ", allowed " w[2]; exit 1 } }'
}
holds() { # MODEL SCENE ARGS...
  model=$1 scene=$2
  shift 2
  "$LAGC" modes "$model" "$scene" "$@" --json >"$TMP/json" || return 1
  states=$(sed -n 's/^ *state //p' "$model" | sed 's/\[[^]]*\]//g; s/#.*//' | tr ',\n' '  ')
  { cat "$model"; probe "$scene" "$states" <"$TMP/json"; } >"$TMP/probe.lag"
  # shellcheck disable=SC2046
  "$LAGC" run "$TMP/probe.lag" probe "$@" --quiet -o - >"$TMP/rows" && shown $(sed -n 's/^# \(grows\|stays\|decays\)/\1/p' "$TMP/probe.lag") <"$TMP/rows"
}
verdict_of() { "$LAGC" modes "$@" --json | sed -n 's/.*"verdict": "\([^"]*\)".*/\1/p'; }
held() { ! one_of 4 || check "$*: $(verdict_of "models/$1.lag" "$2")" holds "models/$1.lag" "$2"; }
while read -r model scene; do held "$model" "$scene"; done <<'X'
pendulum small
lorenz butterfly
magnetic_pendulum basin
motor_pendulum lift
damped_oscillator under
cr3bp arenstorf
double_pendulum swing
bead_on_hoop slow
bead_on_hoop fast
bicycle straight
slider_crank idle
stick_slip squeak
bead_on_cycloid small
cartesian_pendulum swing
chain swing
edge_mode edge
foucault paris
fput recurrence
henon_heiles regular
lc_circuit beats
learned_spring record
skate_park smooth
spring free
spring_pendulum swing
string mode
driven_damped_pendulum swing
double_pendulum_real ideal
double_pendulum_real oiled
foucault_lab ideal
X

# random_model NUMBER: two coordinates with coupled masses, a gyroscopic force, a saddle or a well, friction in two of three, quartic terms
random_model() {
  awk -v seed="$1" 'function draw(a, b) { seed = (seed*16807) % 2147483647; return a + (b - a)*seed/2147483647 }
    BEGIN { seed = 1000 + 7919*seed; draw(0, 1); friction = draw(-0.2, 0.4); if (friction < 0) friction = 0
      print "model drawn\ncoord x, y"
      printf "lagrangian = (%.4f*x'"'^2 + %.4f*x'*y' + %.4f*y'"'^2)/2 + %.4f*(x*y'"'"' - y*x'"'"')/2", draw(0.5, 2), draw(-0.8, 0.8), draw(0.5, 2), draw(-1, 1)
      printf " - (%.4f*x^2 + %.4f*x*y + %.4f*y^2)/2 - (x^4 + y^4)/4\n", draw(-1, 4), draw(-1, 1), draw(-1, 4)
      printf "dissipation = %.4f*(x'"'^2 + y'"'^2)/2\nscene s { start x = 0.01, y = -0.02; span 20 }\n", friction }'
}
for k in $(awk -v n="$(depth 5 10 20)" 'BEGIN { for (k = 1; k <= n; k++) print k }'); do
  random_model "$k" >"$TMP/drawn.lag"
  case $(verdict_of "$TMP/drawn.lag" s) in # others say nothing that a run could refute
    unstable | stable | 'asymptotically stable') check "random model $k: $(verdict_of "$TMP/drawn.lag" s)" holds "$TMP/drawn.lag" s ;;
  esac
done

# Rows of lagc continue at the ends of branches: their growth from a push along th, and none where no direction grows
row_holds() { # ROW START MODEL SCENE RUN-ARGS...: at the row `growing,growth`
  growth=${1#*,} start=$2
  shift 2
  if [ "${growth}" = 0 ]; then set -- "$@" th="$start" --until 60; most=1e-2; else
    set -- "$@" th="$start" "th'=$(awk -v s="$growth" -v x="$start" 'BEGIN { printf "%.17g", s*x }')" --until "$(awk -v s="$growth" 'BEGIN { printf "%.17g", log(1000)/s }')"
    most=
  fi
  "$LAGC" run "$@" --tol 1e-11 --observe th --quiet -o - | awk -F, -v most="$most" 'NR == 1 { for (i = 1; i <= NF; i++) if ($i ~ /^th( |$)/) c = i; next }
    { x = $c + 0; if (x < 0) x = -x; if (x > far) far = x } END { if (most == "" ? x < 0.98e-3 || x > 1.02e-3 : far > most) { print "th " x ", at most " far; exit 1 } }'
}
last_row() { "$LAGC" continue "$@" -o - 2>/dev/null | awk -F, '{ row[NR] = $4 "," $6 } $(NF - 1) == "range" { print row[NR] }' | sed -n "${nth}p"; }
nth=1
check "the bead at w = 8 leaves as continue says" row_holds "$(last_row models/bead_on_hoop.lag slow th=0 w=3..8)" 1e-6 models/bead_on_hoop.lag slow w=8
check "the governor at spin = 20, ph' = 10" row_holds "$(last_row tests/exec/orbits/governor.lag spin --steady spin=4..20)" 1e-6 tests/exec/orbits/governor.lag spin "ph'=10"
nth=2
check "the bead at w = 1 stays" row_holds "$(last_row models/bead_on_hoop.lag slow th=0 w=1..8)" 1e-4 models/bead_on_hoop.lag slow w=1
check "the governor at ph' = 2 stays" row_holds "$(last_row tests/exec/orbits/governor.lag spin --steady spin=4..20)" 1e-4 tests/exec/orbits/governor.lag spin "ph'=2"
tap_end
