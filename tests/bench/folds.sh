#!/bin/sh
# Folds and bifurcations of three demos of AUTO-07p written as Lagrangians: lagc continue beside AUTO itself, where AUTO_DIR names a built one
# (github.com/auto-07p/auto-07p; its texts are taken from there, with constants of double precision). CPU seconds at an error of about 1e-10:
# of the whole command from the text, with nothing compiled before (AUTO compiles its Fortran, and runs under Python), and of what remains
# when all is compiled: AUTO by its own clock, lagc with parsing and derivation. Points: all that a branch has, located ones too.
set -eu
: "${LAGC:=build/lagc}" "${CC:=cc}" "${TMP:=$(mktemp -d)}"
[ -x "${AUTO_DIR:-}/bin/auto" ] || [ -x "${AUTO_DIR:-}/cmds/auto" ] || { echo 'there is no AUTO: AUTO_DIR names none'; exit 0; }
. tests/bench/lib_rows.sh
export AUTO_DIR OMP_NUM_THREADS=1 PATH="$AUTO_DIR/cmds:$AUTO_DIR/bin:$PATH"
tight="EPSL=1e-11,EPSU=1e-11,EPSS=1e-9,ITMX=20"

# auto_demo NAME <script: $TMP/auto, lines `KIND VALUE`, $TMP/clock, its seconds, $TMP/whole, those of the command, and $TMP/points
auto_demo() {
  rm -rf "$TMP/demo"
  cp -r "$AUTO_DIR/demos/$1" "$TMP/demo"
  sed -i 's/=\( *[0-9.]*\)$/=\1D0/; s/=\( *[0-9]*\.[0-9]*\)$/=\1D0/' "$TMP/demo/$1.f90"
  cat >"$TMP/demo/run.auto"
  (cd "$TMP/demo" && "$TMP/rusage" auto run.auto) >"$TMP/log" 2>&1
  sed -n 's/^RESULT //p' "$TMP/log" >"$TMP/auto"
  sed -n 's/^POINTS //p' "$TMP/log" >"$TMP/points"
  awk '/^rusage / { print $2 }' "$TMP/log" >"$TMP/whole"
  awk '/Total Time/ { sub(/D/, "E", $3); s += $3 } END { printf "%.3f", s }' "$TMP/log" >"$TMP/clock"
}
# beside DEMO KINDS ARGS...: rows of the points of these kinds, in the order of both, and of the time
beside() {
  demo=$1 kinds=$2
  shift 2
  "$LAGC" continue "$@" --compile always --json -o "$TMP/rows.csv" 2>/dev/null | sed 's/{"kind"/\n&/g' | sed -n "s/^{\"kind\": \"\($kinds\)\", \"parameter\": \([^,]*\),.*/\2 \1/p" >"$TMP/ours"
  while read -r value kind; do
    read -r _ theirs <&3 || break
    echo "| $demo | $kind | $value | $theirs | $(awk -v a="$value" -v b="$theirs" 'BEGIN { d = a - b; printf "%.1e", d < 0 ? -d : d }') |"
  done <"$TMP/ours" 3<"$TMP/auto"
  echo "| $demo | points | $(sed '/^#/d; 1d' "$TMP/rows.csv" | wc -l) | $(cat "$TMP/points") | |"
  echo "| $demo | CPU seconds, nothing compiled | $(seconds 3 env "XDG_CACHE_HOME=$TMP/none-$$" "$LAGC" continue "$@" --compile never) | $(cat "$TMP/whole") | |"
  echo "| $demo | CPU seconds, all compiled | $(seconds 3 "$LAGC" continue "$@" --compile always) | $(cat "$TMP/clock") | |"
}

echo '| demo | point | lagc | AUTO | difference |'
echo '| --- | --- | --- | --- | --- |'
auto_demo exp <<X
exp=run('exp',c='exp.1',NTST=20,$tight,UZR={},UZSTOP={},NMX=400)
print("POINTS %d" % sum(len(b) for b in exp))
for s in exp('LP'): print("RESULT LP %.14g" % s['lambda'])
X
beside "exp, over p" fold tests/exec/orbits/bratu.lag half p=0.5..4 --period 2 u=0.14 "u'=0"
auto_demo pen <<X
pen=run('pen',c='pen.1',NTST=20,$tight,UZSTOP={3:0.14})
two=run(pen('PD1'),c='pen.2',NTST=40,$tight,ILP=1,DSMAX=0.5,UZSTOP={11:17.5})
print("POINTS %d" % sum(len(b) for r in (pen, two) for b in r))
print("RESULT PD %.14g" % pen('PD1')['PAR(3)'])
for s in two('LP'): print("RESULT LP %.14g" % s['PAR(3)'])
X
beside "pen, over the torque" 'fold\|period doubling' tests/bench/models/pendulums.lag rotate I=0.4..0.14 --guess 1.57 --branches --most 110
auto_demo r3b <<X
lag=run('r3b',UZR={'mu':0.063})
L1=run(lag('UZ7'),c='r3b.L1',NTST=50,$tight,UZSTOP={'PERIOD':2.6})
H1=run(L1('BP1'),c='r3b.H1',NTST=50,$tight,ILP=1,ICP=['PERIOD','lambda','E','fm'])
print("POINTS %d" % sum(len(b) for r in (lag, L1, H1) for b in r))
print("RESULT MU %.14g" % L1('BP1')['mu'])
for s in H1('LP'): print("RESULT LP %.14g" % s['PERIOD'])
X
mu=$(sed -n 's/^MU //p' "$TMP/auto")
sed -i '/^MU/d' "$TMP/auto"
beside "r3b, halo orbits over the period" fold tests/exec/orbits/cr3bp_space.lag lyapunov "mu=$mu" x=0.6637384 z=0.1213414 "y'=0.32624754" --guess 2.5996 --hold y period=1.9..3.2 --most 84
