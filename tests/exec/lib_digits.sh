# shellcheck shell=sh
# For tests of --precision: an oscillator and a pendulum with closed forms, and the values that their runs print.
. tests/tap.sh
. tests/exec/lib_precision.sh

cat >"$TMP/osc.lag" <<'END'
model osc
coord x
param k = 0.1
lagrangian = x'^2/2 - 10*k*x^2/2
scene go { start x = 1; span 10; output x, x' every 5 }
scene turns { like go; span 20*pi }
END
cat >"$TMP/pend.lag" <<'END'
model pend
coord th [deg] periodic
lagrangian = th'^2/2 + cos(th)
event down: th falling { stop }
scene go { start th = 90 [deg]; span 10 }
END
run() { "$LAGC" run "$@" 2>&1; }
value() { awk -v name="$1" '$1 == name { print $2; exit }'; }
begins() { case $2 in "$1"*) ;; *) printf 'expected: %s...\n     got: %s\n' "$1" "$2"; return 1 ;; esac; }
refuses() { # STATUS TEXT ARGUMENTS...
  wanted=$1 text=$2
  shift 2
  run "$@" >"$TMP/said"
  status=$?
  [ $status = "$wanted" ] && grep -qF -e "$text" "$TMP/said" || { echo "status $status"; cat "$TMP/said"; return 1; }
}

# cos 10 = -0.83907152907645245225886394782406483..., a quarter of the period of a pendulum that starts at a right angle
# pi/2/agm(1, sqrt(1/2)) = 1.85407467730137191843385034719526004...
cos10=-0.83907152907645245225886394782406
quad() { run "$@" --precision quad; }
