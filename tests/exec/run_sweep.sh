#!/bin/sh
# lagc sweep: values of runs, measures against closed forms, the same bytes on any number of threads, in parts and after kills; what is refused.
. tests/tap.sh
. tests/exec/lib_precision.sh
cat >"$TMP/osc.lag" <<'END'
model osc "A damped oscillator that is driven"
coord x [m]
param m = 1 [kg] > 0, k = 4 [N/m] > 0, c = 0.4 [N*s/m] >= 0, F = 1 [N], w = 1 [rad/s], stiffer = 0 [N/m^3] >= 0
lagrangian = m/2*x'^2 - k/2*x^2 - stiffer/4*x^4
dissipation = c/2*x'^2
force x = F*cos(w*t)
event far: x - 2 [m] rising { stop }
scene steady { span 120; tolerance 1e-12; method taylor }
scene swing { start x = 1; F = 0; c = 0; span 40; tolerance 1e-13; method taylor }
scene fall { start x' = 1; k = 1e-9; F = 0; c = 0; span 1; tolerance 1e-10 }
END
osc=$TMP/osc.lag
swept() { "$LAGC" sweep "$@" >"$TMP/text" 2>"$TMP/err" </dev/null || { cat "$TMP/err"; return 1; }; }
# Other models than the oscillator are evaluated, which takes no compilation, where lanes do not matter.
sweep() { case $1 in "$osc") swept "$@" ;; *) swept "$@" --compile never ;; esac; }
# worst EXPR FILE: the largest |$2 - EXPR| of the rows; EXPR of $1, $2, ... and the functions below
worst() {
  awk -F , "function abs(x) { return x < 0 ? -x : x }
    function K(k,   a, b, c) { a = 1; b = sqrt(1 - k*k); while (abs(a - b) > 1e-15) { c = (a + b)/2; b = sqrt(a*b); a = c } return atan2(0, -1)/2/a }
    FNR > 1 { d = abs(\$2 - ($1)); if (!(d <= most)) most = d } END { printf \"%.3g\n\", most }" "$2"
}
# Closed forms. Allowed: 1e-9, as the issue asks; amplitudes by their maximum after the transient, exp(-c t/2m) = 2e-9 at t = 100.
check "the pendulum's period over its amplitude" swept models/pendulum.lag 'th=5..175[deg]:18' --measure 'period(th)' --tol 1e-13 --until 60 -o "$TMP/pendulum.csv"
near "is 4 K(sin(th/2)) sqrt(l/g)" 1e-9 0 "$(worst '4*K(sin($1/2))/sqrt(9.81)' "$TMP/pendulum.csv")"
check "resonance" sweep "$osc" steady w=0.5..3.5:13 --measure 'sqrt(x(120)^2 + (x'"'"'(120)/w)^2)' -o "$TMP/driven.csv"
near "has the amplitude F/|k - m w^2 + i c w|" 1e-9 0 "$(worst '1/sqrt((4 - $1*$1)^2 + (0.4*$1)^2)' "$TMP/driven.csv")"
check "and its phase" sweep "$osc" steady w=0.5..3.5:13 --measure 'x(120)' --measure 'x'"'"'(120)' -o "$TMP/phase.csv"
near "is that of the same number" 1e-9 0 "$(worst '((4 - $1*$1)*cos(120*$1) + 0.4*$1*sin(120*$1))/((4 - $1*$1)^2 + (0.4*$1)^2)' "$TMP/phase.csv")"
# Duffing, x'' + k x + s x^3 = 0 from x = A: T = 4 K(m)/sqrt(k + s A^2), m = k^2 = s A^2/(2 (k + s A^2)).
check "Duffing's period over its amplitude" sweep "$osc" swing x=0.1..1.9:10 stiffer=3 --measure 'period(x)' -o "$TMP/duffing.csv"
near "by elliptic integrals" 1e-9 0 "$(worst '4*K(sqrt(1.5*$1*$1/(4 + 3*$1*$1)))/sqrt(4 + 3*$1*$1)' "$TMP/duffing.csv")"
# Tops lie within steps, which are about as long as a quarter of a period, x = cos(2t) + v/2 sin(2t); quick expressions have some in each.
tops() { # EXPR EXPECTED [OPTIONS]
  what=$1 expected=$2
  shift 2
  sweep "$osc" swing "x'=-2..-0.1:8" --measure "a=$what" -o "$TMP/tops.csv" "$@" && tap_near 1e-9 0 "$(worst "$expected" "$TMP/tops.csv")"
}
check "the largest value" tops 'max(x) - min(x)' '2*sqrt(1 + $1*$1/4)'
check "the largest distance" tops 'drift(x - 1)' '1 + sqrt(1 + $1*$1/4)'
check "a quick sine" tops 'max(sin(6*x))' 1 --until 0.9
check "a quick period" tops 'period(sin(24*t))' 0.26179938779914943654
# Mean of x(1) = v over v in (0, 1): 1/2. Errors: random about 0.29/sqrt(N), Sobol 1/2N or so, hypercube 0.29/N^1.5.
mean_error() {
  sweep "$osc" fall "x'=0..1" --samples "$2" --sampling "$1" --measure x -o "$TMP/mean.csv" --json &&
    sed 's/.*"mean": \([^,]*\),.*/\1/' "$TMP/text" | awk -v n="$2" -v p="$3" '{ e = $1 - 0.5; if (e < 0) e = -e; printf "%.3f\n", e*n^p }'
}
at_most() { awk -v x="$2" -v most="$1" 'BEGIN { print x; exit !(x != "" && x <= most) }'; }
check "random samples: 1/sqrt(N)" at_most 1.2 "$(mean_error random 400 0.5)" # 4 deviations
check "and 16 times as many" at_most 1.2 "$(mean_error random 6400 0.5)"
check "Latin hypercube: 1/N^1.5" at_most 1.2 "$(mean_error lhs 400 1.5)"
if [ "${GSL:-yes}" = yes ]; then
  check "Sobol: 1/N" at_most 1 "$(mean_error sobol 400 1)"
  check "and 16 times as many" at_most 1 "$(mean_error sobol 6400 1)"
  check "Halton: log(N)/N" at_most 10 "$(mean_error halton 6400 1)"
else
  check "without GSL" says 2 "needs GSL" "$LAGC" sweep "$osc" fall "x'=0..1" --samples 9 --sampling sobol -o "$TMP/mean.csv"
fi

printf 'model ridge\ncoord x [m]\nparam w = 2 [rad/s]\nlagrangian = (x'"'"'^2 + w^2*x^2)/2*1 [kg]\nscene run { span 20; tolerance 1e-11 }\n' >"$TMP/ridge.lag"
check "Lyapunov exponents over a parameter" sweep "$TMP/ridge.lag" w=1..3:3 --measure lyapunov -o "$TMP/exponents.csv"
near "of x'' = w^2 x, up to the turning of the vector, exp(-4 w)/(18 s)" 1e-3 0 "$(worst '$1' "$TMP/exponents.csv")"
check "refused where lagc lyapunov refuses" says 2 "no derivative of its steps" "$LAGC" sweep "$TMP/ridge.lag" w=1..3:3 --measure lyapunov --method gsl-rk8pd -o "$TMP/no.csv"
# Rows.
check "units, formulas and lists" sweep "$osc" swing 'x=10..30[cm]:3' 'w=pi,2*pi' m=2 --measure x -o "$TMP/units.csv" --until 1e-9
is "head" "x [m],w [rad/s],x(end) [m],status" "$(head -n 1 "$TMP/units.csv")"
is "first row" "0.1,3.141592653589793" "$(sed -n 2p "$TMP/units.csv" | cut -d , -f 1,2)"
is "the last name runs first" "0.1 0.1 0.2 0.2 0.3 0.3" "$(awk -F , 'FNR > 1 { printf "%s%s", s, $1; s = " " }' "$TMP/units.csv")"
cat >"$TMP/pair.lag" <<'END'
model pair
const N = 2
coord x[N] [m], z [m]
param k[N] = 1 [N/m] > 0, T = 20 [degC]
input u [N] = 0
lagrangian = (x[1]'^2 + x[2]'^2 + z'^2)/2*1 [kg] - k[1]/2*x[1]^2 - k[2]/2*x[2]^2
force z = u
scene run { start x = 1, z' = 1; span 1; tolerance 1e-10 }
END
# Mean and deviation of T: 400 samples of a hypercube miss them by less than 0.01. The scene is left out.
spread() { # RANGE [MEASURE]
  rm -f "$TMP/pair.csv"
  sweep "$TMP/pair.lag" "$1" --samples 400 --sampling lhs --measure "${2:-T}" --json -o "$TMP/pair.csv" && sed 's/.*"mean": \([^,]*\), "deviation": \([^,]*\),.*/\1 \2/' "$TMP/text" | awk '{ printf "%.1f %.1f\n", $1, $2 }'
}
is "a deviation in kelvin is a difference" "22.0 3.0" "$(spread 'T~normal(22,3[K])')"
is "as in degrees" "22.0 3.0" "$(spread 'T~normal(22,3)[degC]')"
is "of a member" "22.0 3.0" "$(spread 'k[2]~normal(22,3)' 'k[2]')"
is "of a member, with a unit" "22.0 3.0" "$(spread 'k[2]~normal(22, 3000[N/km])' 'k[2]')"
mkdir "$TMP/sub"
printf 't,u\n0,1\n1,1\n' >"$TMP/gust.csv"
check "a table and a function with commas are no ranges" sweep "$TMP/pair.lag" u="$TMP/sub/../gust.csv" T=1,2 --measure z -o "$TMP/pair.csv"
is "the table counts" "1.500" "$(awk -F , 'FNR == 2 { printf "%.3f", $2 }' "$TMP/pair.csv")"
check "a table of what varies" says 2 "gust.csv: u varies; leave one out" "$LAGC" sweep "$TMP/pair.lag" u="$TMP/gust.csv" u=1,2 -o "$TMP/no.csv"
check "a measure called as an input or a constant" sweep "$TMP/pair.lag" T=1,2 --measure 'N=max(z)' -o "$TMP/named.csv"
check "as an input" sweep "$TMP/pair.lag" T=1,2 --measure 'u=max(z)' -o "$TMP/named.csv"
is "is a column" "T [degC],u [m],status" "$(head -n 1 "$TMP/named.csv")"
check "nor is a function" sweep "$TMP/pair.lag" 'u=1 [N]*max(1, t/10[s])' T=1,2 --measure z -o "$TMP/pair.csv"
is "it counts" "1.500" "$(awk -F , 'FNR == 2 { printf "%.3f", $2 }' "$TMP/pair.csv")"
# Constants: a compilation for each value. The lowest mode of N masses on N + 1 springs: T = pi sqrt(m/k)/sin(pi/2(N+1)).
cat >"$TMP/chain.lag" <<'END'
model chain
const N = 3
coord x[N] [m]
param m = 1 [kg] > 0, k = 1 [N/m] > 0
kinetic = sum(i in 1..N, m/2*x[i]'^2)
potential = k/2*(x[1]^2 + sum(i in 2..N, (x[i] - x[i-1])^2) + x[N]^2)
scene run { start x[i in 1..N] = 1 [m]*sin(pi*i/(N + 1)); span 100; tolerance 1e-12; measure last = period(x[N]) }
END
# off: the largest difference from the period of the lowest mode, and the number of runs
off() { awk -F , 'FNR > 1 { d = $3 - 4*atan2(1, 1)/sqrt($1)/sin(2*atan2(1, 1)/($2 + 1)); d = d < 0 ? -d : d; if (!(d <= most)) most = d; n++ } END { printf "%.3g %d\n", most, n }' "$TMP/chain.csv"; }
check "a constant is compiled for each value" swept "$TMP/chain.lag" k=1,4 N=2..8:4 --measure 'period(x[1])' -o "$TMP/chain.csv"
near "the periods are those of the lowest mode" 1e-9 0 "$(off | cut -d ' ' -f 1)"
is "in one grid" "k,N 1,2 1,4 1,6 1,8 4,2 4,4 4,6 4,8" "$(sed 's/ \[N\/m\]//' "$TMP/chain.csv" | cut -d , -f 1,2 | tr '\n' ' ' | sed 's/ $//')"
is "a measure of the scene is that of each size" "" "$(awk -F , 'FNR > 1 && ($3 - $4 > 1e-9 || $4 - $3 > 1e-9)' "$TMP/chain.csv")"
check "constant and parameter walked together" sweep "$TMP/chain.lag" k=1,4,9 N=8,4,2 --zip --measure 'period(x[1])' -o "$TMP/chain.csv"
near "three runs of their sizes" 1e-9 0 "$(off | cut -d ' ' -f 1)"
is "each with its values" "1,8 4,4 9,2" "$(sed 1d "$TMP/chain.csv" | cut -d , -f 1,2 | tr '\n' ' ' | sed 's/ $//')"
chain_part() { sweep "$TMP/chain.lag" N=2,4 k=1..2:20 'm~normal(1, 0.01)' --samples 5 --until 20 -o "$@"; }
chain_parts() { chain_part "$TMP/whole.csv" --threads 1 && chain_part "$TMP/parts.csv" --shard 1/2 && chain_part "$TMP/parts.csv" --shard 2/2 && chain_part "$TMP/parts.csv" --merge 2 && cmp "$TMP/whole.csv" "$TMP/parts.csv"; }
check "samples of each size, in parts" chain_parts
one_run() { sweep "$osc" swing x=1..1:1 --until 1 -o "$TMP/one_run.csv" && grep -q ': 1 run to t' "$TMP/text" && grep -q '^1 run in' "$TMP/text"; }
check "one run" one_run
check "walked together" sweep "$osc" swing x=0.1,0.2,0.3 w=1..3:3 --zip --measure x -o "$TMP/zip.csv" --until 0.1
is "three runs" "0.1,1 0.2,2 0.3,3" "$(awk -F , 'FNR > 1 { printf "%s%s,%s", s, $1, $2; s = " " }' "$TMP/zip.csv")"
printf '"x [m]",w\n0.5,1\n0.25,2\n' >"$TMP/rows.in.csv"
check "a velocity, with its unit" sweep "$osc" fall "x'=1,2" --measure x -o "$TMP/units.csv"
is "head" "x' [m/s],x [m],status" "$(head -n 1 "$TMP/units.csv")"
check "rows of a file" sweep "$osc" swing --rows "$TMP/rows.in.csv" --measure x -o "$TMP/rows.csv" --until 0.1
is "two runs" "0.5,1 0.25,2" "$(awk -F , 'FNR > 1 { printf "%s%s,%s", s, $1, $2; s = " " }' "$TMP/rows.csv")"
# Rows as spreadsheets and editors write them, of members of families.
# rows TEXT: the rows of the sweep over the file TEXT
rows() {
  printf "$1" >"$TMP/rows.in.csv"
  shift
  rm -f "$TMP/rows.csv"
  "$LAGC" sweep "$TMP/pair.lag" --rows "$TMP/rows.in.csv" --measure 'a=x[1](0)' --measure 'b=k[1]' --measure 'c=k[2]' --measure "d=x[2]'(0)" -o "$TMP/rows.csv" --quiet "$@" && sed 's/,ok$//' "$TMP/rows.csv" | tr '\n' ' '
}
is "a member of a family is no more than that" "k[2] [N/m],a [m],b [N/m],c [N/m],d [m/s],status 3,1,1,3,0 " "$(rows 'k[2]\n3\n')"
is "quotes, CRLF, blank lines, spaces, units" "k[2] [N/m],x[2]' [m/s],a [m],b [N/m],c [N/m],d [m/s],status 3,4,1,1,3,4 5,6,1,1,5,6 " "$(rows "\\357\\273\\277\\r\\n\"k[2] [N/m]\" , x[2]' [m/s]\\r\\n\"3\", 4 \\r\\n\\r\\n5,\"6\"")"
is "a family, in its unit" "k [N/m],a [m],b [N/m],c [N/m],d [m/s],status 3,1,3,3,0 " "$(rows 'k [N/m]\n3\n')"
check "a sampling that there is not" says 2 "write --sampling random|lhs|sobol|halton" "$LAGC" sweep "$TMP/pair.lag" 'k[1]=1..2' --samples 3 --sampling latin -o "$TMP/no.csv"
check "the file itself as output" says 2 "is the file of --rows" "$LAGC" sweep "$TMP/pair.lag" --rows "$TMP/rows.in.csv" -o "$TMP/rows.in.csv"
wide() { awk 'BEGIN { printf "%600s", "k"; for (i = 0; i < 300; i++) printf "%600s", ",x" i; print "\n1" }' >"$TMP/rows.in.csv"; says 2 "$1" "$LAGC" sweep "$TMP/pair.lag" --rows "$TMP/rows.in.csv" -o "$TMP/no.csv"; }
check "all of 301 columns count" wide "fewer fields than the 301 names"
bad_rows() {
  words=$1 text=$2
  printf "$text" >"$TMP/rows.in.csv"
  shift 2
  says 2 "$words" "$LAGC" sweep "$TMP/pair.lag" --rows "$TMP/rows.in.csv" -o "$TMP/no.csv" "$@" && [ ! -e "$TMP/no.csv" ]
}
check "another unit" bad_rows "k is in [kN/m] there, and in [N/m]" 'k [kN/m]\n1\n'
check "a field too many" bad_rows "rows.in.csv:3: there are more fields than the 1 names" 'k\n\n1,2\n'
check "no number" bad_rows 'rows.in.csv:2: "1x" is not a number' 'k\n1x\n'
check "a quote without end" bad_rows "rows.in.csv:2: a quote has no end" 'k\n"1\n'
check "semicolons" bad_rows "columns are separated by commas" 'k;u\n1;2\n'
check "a folder" says 2 "cannot be read" "$LAGC" sweep "$TMP/pair.lag" --rows "$TMP" -o "$TMP/no.csv"
check "a byte 0" bad_rows "this is no text" 'k\n1\0002\n'
check "a device without end" says 2 "this is no text" timeout 60 "$LAGC" sweep "$TMP/pair.lag" --rows /dev/zero -o "$TMP/no.csv"
endless() {
  mkfifo "$TMP/pipe"
  yes 1 >"$TMP/pipe" 2>/dev/null &
  says 2 "more than 256 MB" timeout 60 "$LAGC" sweep "$TMP/pair.lag" --rows "$TMP/pipe" -o "$TMP/no.csv"
}
check "text without end" endless
check "a value beside its column" bad_rows "k[1]=2: k varies; leave one out" 'k\n1\n' 'k[1]=2'

check "an event that stops a run, and its time" sweep "$osc" fall "x'=1,4" --measure 'hit(far)' --measure end -o "$TMP/stop.csv"
is "is a status, and no failure" "1,nan,1,ok 4,0.5,0.5,stopped" "$(awk -F , 'FNR > 1 { printf "%s%s,%.3g,%.3g,%s", s, $1, $2, $3, $4; s = " " }' "$TMP/stop.csv" | sed 's/-nan/nan/g')"
check "the report says how many have none, and why" grep -qx "1 has no hit(far), the first in row 1 (x'=1): far never happens" "$TMP/text"
check "as JSON" sweep "$osc" fall "x'=1,2,5" --measure 'hit(far)' --measure 'x(0.7)' -o "$TMP/stop.csv" --json
is "with numbers" "none 2 far never happens none 1 the run ends at t = 0.4 s, before 0.7 s" "$(grep -o '"none": [0-9]*, "none_why": "[^"]*"' "$TMP/text" | sed 's/"//g; s/, none_why://; s/none:/none/; s/0\.[34][90]*[0-9]* s,/0.4 s,/' | tr '\n' ' ' | sed 's/ $//')"
check "a part as JSON" sweep "$osc" fall "x'=1,2" -o "$TMP/json.csv" --shard 2/2 --json
is "names its journal" "part 2/2 journal $TMP/json.csv.2-of-2.journal made 1" "$(sed 's/.*\("part": .*\), "seconds".*/\1/; s/[",:]//g' "$TMP/text")"
cat >"$TMP/pole.lag" <<'END'
model pole
coord x
param h = 1
lagrangian = x'^2/2 - sqrt(x)*h
scene run { start x = 1; span 3; tolerance 1e-9 }
END
check "runs that fail are rows" sweep "$TMP/pole.lag" h=-1,2,4 --measure x -o "$TMP/pole.csv"
is "with their reason, and without values" ",ok nan,nan nan,nan" "$(awk -F , 'FNR > 1 { sub(/^[0-9].*/, "", $2); printf "%s%s,%s", s, $2, $NF; s = " " }' "$TMP/pole.csv")"
is "which are in no mean" "x 1" "$(awk '$1 == "x" { print $1, $2 }' "$TMP/text")"
check "the report names the first" grep -q '^2 failed, the first in row 2 (h=2): ' "$TMP/text"
check "to standard output" says 0 'x,x(end),status' "$LAGC" sweep "$TMP/pole.lag" x=1,2 --measure x --until 0.1 -o - --quiet
# The same bytes.
many=20
[ -z "${SLOW:-}" ] || many=40 # so long that 20 kills come before its end
grid="x=0.1..1.9:$many stiffer=0..3:25"
same() { cmp "$TMP/one.$1" "$TMP/two.$1"; }
for kind in csv npy; do
  # shellcheck disable=SC2086 # a list of words
  check "one thread, .$kind" sweep "$osc" swing $grid --measure 'period(x)' --measure x --until 5 --threads 1 -o "$TMP/one.$kind"
  # shellcheck disable=SC2086
  check "three threads" sweep "$osc" swing $grid --measure 'period(x)' --measure x --until 5 --threads 3 -o "$TMP/two.$kind"
  check "have the same bytes" same $kind
  rm "$TMP/two.$kind"
done
part() { # shellcheck disable=SC2086
  sweep "$osc" swing $grid --measure 'period(x)' --measure x --until 5 -o "$TMP/two.csv" "$@"
}
check "a part" part --shard 1/2
check "parts are missing" says 2 "2-of-2.journal is missing: make it by --shard 2/2" "$LAGC" sweep "$osc" swing $grid --measure 'period(x)' --measure x --until 5 -o "$TMP/two.csv" --merge 2
check "the other part" part --shard 2/2
check "joined" part --merge 2
check "are the whole" same csv
is "and nothing is left over" "$TMP/two.csv" "$(ls "$TMP"/two.csv*)"
# Motions: the rows that `lagc run` writes, with the number of the run.
motion() { "$LAGC" run "$osc" fall "x'=$1" --every 0.3 -o "$TMP/motion.one" --quiet && sed 1d "$TMP/motion.one" | sed "s/^/$2,/"; }
check "motions" sweep "$osc" fall "x'=1,4" --motions "$TMP/motions.csv" --every 0.3
is "have the columns of the scene" "run,t [s],x [m],x' [m/s],energy [J]" "$(head -n 1 "$TMP/motions.csv")"
{ motion 1 1; motion 4 2; } >"$TMP/motions.two"
check "are those of single runs, to the event that stops one" cmp "$TMP/motions.two" - <<END
$(sed 1d "$TMP/motions.csv")
END
check "a run that fails has rows up to there" sweep "$TMP/pole.lag" h=-1,4 --motions "$TMP/poles.csv" --every 0.5 -o "$TMP/pole.csv"
is "seven and two" "7 2" "$(awk -F , 'FNR > 1 { n[$1]++ } END { print n[1], n[2] }' "$TMP/poles.csv")" # x is 0 at t = sqrt(8)/3
motions() { file=$1; shift; sweep "$osc" swing x=0.1..1.9:40 --measure x --until 5 --every 0.01 --motions "$file" -o "$TMP/m.csv" "$@"; }
check "on one thread" motions "$TMP/one.csv" --threads 1
check "on three" motions "$TMP/two.csv" --threads 3
check "the same bytes" same csv
motion_parts() { motions "$TMP/two.csv" --shard 1/2 && motions "$TMP/two.csv" --shard 2/2 && motions "$TMP/two.csv" --merge 2; }
check "in parts" motion_parts
check "the same bytes" same csv
check "for NumPy" motions "$TMP/one.npy"
numpy() { python3 - "$TMP/one.npy" "$TMP/one.csv" <<'END'
import sys
try: import numpy
except ImportError: sys.exit(0)
a, b = numpy.load(sys.argv[1]), numpy.loadtxt(sys.argv[2], delimiter=",", skiprows=1)
assert a.dtype.names == ("run", "t", "x", "x'", "energy") and a.shape == (40*501,) and all((a[n] == b[:, i]).all() for i, n in enumerate(a.dtype.names))
END
}
check "the same numbers" numpy
check "rows without motions" says 2 "--every is for the rows of motions" "$LAGC" sweep "$osc" swing x=1,2 --every 0.1 -o "$TMP/no.csv"
check "too many rows" says 2 "is 1e+09 rows a run; write a larger --every" "$LAGC" sweep "$osc" fall x=1,2 --every 1e-9 --motions "$TMP/no.csv"
cat >"$TMP/comet.lag" <<'END'
model comet
coord r: vec2 [m]
param m = 2 [kg], k = 2 [N*m^2]
lagrangian = m/2*dot(r', r') + k/norm(r)
event near: dot(r, r') rising { }
scene s { start r = (1, 0), r.y' = 0.3 [m/s]; span 10 [s] }
END
lost() { "$LAGC" sweep "$TMP/comet.lag" m=2,2 --method verlet8 --step 0.05 --measure 'drift(energy)' -o - --quiet "$@" | sed -n '2p'; }
"$LAGC" run "$TMP/comet.lag" --method verlet8 --step 0.05 --quiet >/dev/null 2>&1
is "a run that is judged at its end: lagc run" 3 $?
is "a row of it" '2,nan,drift' "$(lost)"
is "one by one" '2,nan,drift' "$(lost --lanes 1)"
# Crossings of a section: once a period of the drive, w t = 2 pi n, where the driven oscillator has x = Re 1/(k - m w^2 + i c w).
strobe() { sweep "$osc" steady w=0.5..3.5:7 --section 'sin(w*t) rising' --skip 100 "$@"; }
check "crossings" strobe --measure 'max(x)' -o "$TMP/top.csv" --motions "$TMP/strobe.csv" --crossings 3
is "three of each run, as far as there are" "1 2,2 3,3 3,4 3,5 3,6 3,7 3" "$(awk -F , 'FNR > 1 { n[$1]++ } END { for (i = 1; i < 8; i++) printf "%d %d%s", i, n[i], i == 7 ? "" : "," }' "$TMP/strobe.csv")"
near "behind the transient" 1 1 "$(awk -F , 'FNR > 1 && $2 < 100 { early = 1 } END { print 1 - early }' "$TMP/strobe.csv")"
near "are where the closed form says, but for exp(-c t/2m) = 2e-9" 4e-9 0 "$(awk -F , 'FNR > 1 { w = $1/2; d = 4 - w*w; x = d/(d*d + 0.16*w*w) - $3; if (x*x > most) most = x*x } END { print sqrt(most) }' "$TMP/strobe.csv")"
near "and measures are taken behind it" 1e-9 0 "$(worst '1/sqrt((4 - $1*$1)^2 + (0.4*$1)^2)' "$TMP/top.csv")"
check "more are said" grep -q 'crosses\? the section more than 3 times: --crossings N keeps more' "$TMP/text"
strobe_same() { strobe --motions "$TMP/strobe.1.csv" --crossings 3 --threads 1 --lanes 1 && cmp "$TMP/strobe.csv" "$TMP/strobe.1.csv"; }
check "the same one by one" strobe_same
check "a diagram over the values" strobe --svg "$TMP/strobe.svg" --y "x'" --measure 'max(x)'
check "in classes of the measure" grep -q '>max(x) 0.12.*[.][.]' "$TMP/strobe.svg"
check "of what --y says" grep -q ">x' .m/s.<" "$TMP/strobe.svg"
check "--y without a section" says 2 "which --section draws over the values" "$LAGC" sweep "$osc" steady w=1,2 --y x -o "$TMP/no.csv"
check "crossings without a section" says 2 "crossings is for sections: add --section" "$LAGC" sweep "$osc" steady w=1,2 --crossings 3 -o "$TMP/no.csv"
check "and without a file" says 2 "the crossings need a file" "$LAGC" sweep "$osc" steady w=1,2 --section 'x rising' -o "$TMP/no.csv"
check "a diagram over two names" says 2 "crossings are drawn over the range of one name" "$LAGC" sweep "$osc" steady w=1,2 k=1,2 --section 'x rising' --svg "$TMP/no.svg"
check "a transient that is too long" says 2 "what is left out ends between them" "$LAGC" sweep "$osc" steady w=1,2 --skip 120 -o "$TMP/no.csv"
check "one file for rows and motions" says 2 "would be written twice" "$LAGC" sweep "$osc" swing x=1,2 -o "$TMP/no.csv" --motions "$TMP/no.csv"
check "outputs that depend on a constant" says 2 "the outputs depend on N" "$LAGC" sweep "$TMP/chain.lag" N=2,4 --motions "$TMP/no.csv"
# Kills. The program itself is killed, at random times, and goes on each time.
rm -f "$TMP/two.csv"
span=60 most=3
[ -z "${SLOW:-}" ] || span=1000 most=20
# program FILE [OPTIONS]: the sweep, by a simulator, or where HDF5 is written by lagc, which becomes one that can
program() {
  case $1 in
    *.h5) set -- "$LAGC" sweep "$osc" swing -o "$@" --measure 'period(x)' ;;
    *) set -- "$TMP/sim" swing --sweep -o "$@" --measure 'period(x);x period() [1 0 s]' ;; # as lagc compiles it
  esac
  # shellcheck disable=SC2086
  exec "$@" $grid --measure x --until $span --threads 1 --quiet
}
kills() { # FILE OPTIONS...
  i=0 resume= file=$1
  shift
  while [ $i -lt $most ] && { [ ! -e "$file" ] || [ -e "$file.journal" ]; }; do
    i=$((i + 1))
    program "$file" $resume "$@" &
    sleep "$(awk -v i=$i 'BEGIN { srand(i); printf "%.3f", 0.02 + 0.25*rand() }')"
    kill -9 $! 2>/dev/null
    wait $! 2>/dev/null
    [ ! -e "$file.journal" ] || resume=--resume
  done
  [ -z "${SLOW:-}" ] || [ $i = 20 ] || { echo "$i kills in place of 20"; return 1; }
  [ -e "$file" ] && [ ! -e "$file.journal" ] || (program "$file" $resume "$@")
}
check "a simulator" "$LAGC" build "$osc" -o "$TMP/sim"
for kind in csv npy; do
  one_of 2 || continue
  check "a sweep that is not killed" eval '(program "$TMP/one.$kind" --every $((span/60)) --motions "$TMP/whole.csv")'
  check "killed and resumed" kills "$TMP/two.$kind" --every $((span/60)) --motions "$TMP/killed.csv"
  check "the same bytes in .$kind" same $kind
  check "and of motions" cmp "$TMP/whole.csv" "$TMP/killed.csv"
done
if [ -n "${SLOW:-}" ] && [ -e "$BUILD/liblag_hdf5.a" ] && command -v h5diff >/dev/null; then
  check "one for HDF5" eval '(program "$TMP/one.h5")'
  check "killed and resumed" kills "$TMP/two.h5"
  empty "h5diff finds nothing" "$(h5diff "$TMP/one.h5" "$TMP/two.h5" 2>&1)"
  check "nor does cmp" same h5
fi
# A million short runs in less than a gigabyte of memory (2026-11-26: 20 MB with .npy, 33 MB with .csv, 62 MB with .h5 and samples), killed 20 times: the same bytes.
million() { # FILE OPTIONS; becomes the simulator
  ulimit -v 1000000
  exec "$TMP/sim" swing --sweep x=0.1..1.9:1000 stiffer=0..3:1000 --method rk4 --step 0.1 --until 1 --measure x --quiet -o "$@"
}
million_kills() {
  i=0 resume=
  while [ $i -lt 20 ] && [ ! -e "$1" ]; do
    i=$((i + 1))
    million "$1" $resume &
    sleep "$(awk -v i=$i 'BEGIN { srand(i); printf "%.3f", 0.15 + 0.2*rand() }')"
    kill -9 $!
    wait $! 2>/dev/null
    [ ! -e "$1.journal" ] || resume=--resume
  done
  [ $i = 20 ] && [ ! -e "$1" ] || { echo "done after $i kills"; return 1; }
  (million "$1" --resume)
}
for kind in csv npy; do
  slow check "a million runs, .$kind" eval '(million "$TMP/one.$kind")'
  slow check "killed 20 times" million_kills "$TMP/million.$kind"
  slow check "the same bytes" cmp "$TMP/one.$kind" "$TMP/million.$kind"
  rm -f "$TMP/million.$kind"
done
# A journal whose last record is cut, as by a full disk.
cut_journal() {
  # shellcheck disable=SC2086
  set -- "$TMP/sim" swing --sweep $grid --measure x --until 60 -o "$TMP/cut.csv" --quiet
  "$@" &
  sleep 0.1
  kill -9 $!
  wait $! 2>/dev/null
  [ -e "$TMP/cut.csv" ] && return 0
  size=$(wc -c <"$TMP/cut.csv.journal")
  [ "$size" -lt 200 ] || dd if=/dev/null of="$TMP/cut.csv.journal" bs=1 seek=$((size - 11)) 2>/dev/null
  "$@" --resume && "$@" --threads 1 -o "$TMP/whole.csv" && cmp "$TMP/cut.csv" "$TMP/whole.csv"
}
check "a record that was cut is made again" cut_journal
: >"$TMP/new.csv.journal"
check "nor does a kill before the first byte matter" "$LAGC" sweep "$osc" w=1,2 --until 1 -o "$TMP/new.csv" --resume
# A head that was cut: the part is begun anew, and the note says so. Cut bytes of another sweep stay.
cut_head() { # BYTES OPTIONS
  rm -f "$TMP"/head.csv*
  sweep "$osc" w=1,2 --until 1 -o "$TMP/head.csv" --shard 1/2 && cp "$TMP/head.csv.1-of-2.journal" "$TMP/head" || return 1
  head -c "$1" "$TMP/head" >"$TMP/head.csv.1-of-2.journal"
  shift
  sweep "$osc" "$@" --until 1 -o "$TMP/head.csv" --shard 1/2 --resume
}
anew() { cut_head "$1" w=1,2 && cmp "$TMP/head" "$TMP/head.csv.1-of-2.journal" && grep -q "the file has no run" "$TMP/err"; }
for n in 0 7 16 39; do check "a journal cut after $n bytes" anew $n; done
refused_head() { ! cut_head 30 w=1,3 && grep -q "this is another sweep" "$TMP/err" && [ "$(wc -c <"$TMP/head.csv.1-of-2.journal")" = 30 ]; }
check "one of another sweep" refused_head
# Every value of a sweep counts for --resume, not a sample of them; a long double has bytes without meaning.
edited() {
  change=$3
  awk 'BEGIN { print "x"; for (i = 1; i < 9000; i++) print i/9000 }' >"$TMP/edit.in.csv"
  set -- "$1" --sweep --rows "$TMP/edit.in.csv" --until "$2" -o "$TMP/edit.csv" --quiet
  "$@" &
  sleep 0.1
  kill -9 $!
  wait $! 2>/dev/null
  [ -e "$TMP/edit.csv" ] && return 0
  sed -i "777s/.*/$change/" "$TMP/edit.in.csv"
  "$@" --resume
}
check "a row that was edited" says 2 "this is another sweep" edited "$TMP/sim" 120 0.123456
if has_precision long; then
  rm -f "$TMP"/edit.csv*
  check "a simulator of long precision" "$LAGC" build "$osc" --precision long -o "$TMP/long_sim"
  check "resumes" edited "$TMP/long_sim" 1 '&'
fi
# An interrupt ends runs under way, which would take an hour, and those that are timed before the rest. Seconds until then: 5, on a busy machine.
ends() { # RUNS; --foreground: one signal, a second would end it at once
  rm -f "$TMP"/hour.csv*
  timeout --foreground --preserve-status -k 5 0.3 "$TMP/sim" swing --sweep x=0.1..1:"$1" --until 1e9 --measure x -o "$TMP/hour.csv" --quiet 2>"$TMP/err"
  [ $? = 143 ] && grep -q interrupted "$TMP/err"
}
check "an interrupt in long runs" ends 2
check "an interrupt in the first of many" ends 9999
# To a closed pipe: no journal is left.
closed() {
  "$TMP/sim" swing --sweep x=0..1:20000 --until 0.1 --measure x -o - --quiet 2>"$TMP/err" | head -n 1
  [ -z "$(find "${TMPDIR:-/tmp}" -maxdepth 1 -name 'lagc-sweep-*' -newer "$TMP/sim")" ]
}
check "a pipe that closes" closed
# Pictures: x(1) = x + v over a grid of 3 x 2: six cells of four values.
check "a map" sweep "$osc" fall x=0..1:3 "x'=0..0.5:2" --measure x --svg "$TMP/map.svg"
is "has all cells" 6 "$(grep -o 'M[0-9]* [0-9]*h[0-9]*v1h-[0-9]*z' "$TMP/map.svg" | sed 's/.*h-//; s/z//' | awk '{ n += $1 } END { print n }')"
is "in four colours" 4 "$(grep -c '<path fill="#' "$TMP/map.svg")"
is "the highest value in the upper right corner" 1 "$(grep '<path fill="#' "$TMP/map.svg" | tail -n 1 | grep -c 'd="M2 0h1v1h-1z"')"
check "curves" sweep "$osc" fall x=0..1:3 --measure x --measure "x'" --svg "$TMP/curves.svg" -o "$TMP/curves.csv"
check "with the name of what varies" grep -q '>x \[m\]<' "$TMP/curves.svg"
# A logarithmic axis: decades at equal distances; 1 in the middle of 0.001 .. 1000.
check "curves over equal ratios" sweep "$osc" swing k=1e-3..1e3:log:7 --measure x --until 1 --svg "$TMP/log.svg"
check "say so" grep -q '>k \[N/m\], logarithmic<' "$TMP/log.svg"
is "with labels at equal distances" "1e-3 0 1e-2 1 1e-1 2 1e0 3 1e1 4 1e2 5 1e3 6" "$(sed -n 's/.*<text x="\([0-9.]*\)" y="[0-9.]*" text-anchor="middle">10<tspan[^>]*>\([-0-9]*\)<.*/\1 1e\2/p' "$TMP/log.svg" | awk '{ if (!n++) a = $1; printf "%s%s %.0f", s, $2, 6*($1 - a)/626; s = " " }')"
check "a map over equal ratios" sweep "$osc" swing k=1..100:log:3 m=1..2:2 --measure k --until 1 --svg "$TMP/log.svg"
is "has columns of the same width" 6 "$(grep -o 'h[0-9]*v1h' "$TMP/log.svg" | sed 's/h\([0-9]*\)v.*/\1/' | awk '{ n += $1 } END { print n }')"
check "and says so" grep -q '>k \[N/m\], logarithmic<' "$TMP/log.svg"
# A matrix: each measure over each name, and over the measures before it.
matrix() { # PANELS POINTS ARGUMENTS
  panels=$1 points=$2
  shift 2
  sweep "$@" --svg "$TMP/matrix.svg" && [ "$(grep -c '<rect .*stroke="#999"' "$TMP/matrix.svg")" = "$panels" ] && [ "$(grep -o 'h0' "$TMP/matrix.svg" | wc -l)" = "$points" ]
}
check "three ranges: a matrix of 3 + 4 panels of 12 runs" matrix 7 84 "$osc" fall x=0..1:3 "x'=0..0.5:2" m=1,2 --measure x --measure "max(x')"
# the first panel is x(end) over x, both 0 in the first run: 0.06 of 1.12 ranges from the edge, 300*4/5 high or 206 wide
is "a dot where it belongs" yes "$(grep -m 1 -o 'd="M[0-9.]* [0-9.]*h0' "$TMP/matrix.svg" | awk -F '[M h]' '{ w = (1080 - 12*3)/4; if (w > 300) w = 300; x = 84 + 0.06/1.12*w; y = 70 + 0.8*w*(1 - 0.06/1.12); print ($2 - x < 0.2 && x - $2 < 0.2 && $3 - y < 0.2 && y - $3 < 0.2) ? "yes" : $2 " " $3 " not " x " " y }')"
check "samples: one panel" matrix 1 9 "$osc" fall "x~uniform(0,1)" --samples 9 --measure x
check "lists: a matrix" matrix 2 12 "$osc" fall x=1,3,4 m=1..2:2 --measure x
check "a constant in equal steps: a map" sweep "$TMP/chain.lag" N=2..4:3 k=1,2 --measure 'x[1]' --svg "$TMP/const.svg"
is "of six cells" 6 "$(grep -o 'h[0-9]*v1h' "$TMP/const.svg" | sed 's/h\([0-9]*\)v.*/\1/' | awk '{ n += $1 } END { print n }')"
check "many runs: some of them" sweep "$osc" fall "x~uniform(0,1)" --samples 9000 --measure x --until 0.01 --svg "$TMP/matrix.svg"
check "are said" grep -q 'about 5000 of 9000 runs' "$TMP/matrix.svg"
check "nine columns are too many" says 2 "a matrix of 9 names and measures is too small" "$LAGC" sweep "$osc" fall x=1,3,4 m=1..2:2 k=1,2 --measure x --measure a=x --measure b=x --measure c=x --measure d=x --measure e=x --svg "$TMP/no.svg"
# Histograms: 0, 0.1, 0.2 and 1 in two parts are three runs and one, in four three, none, none and one. A panel is 240 pixels high, of 1.05 times the most.
bars() { grep -o '<rect [^>]*fill-opacity' "$TMP/bars.svg" | sed 's/.* x="\([0-9.]*\)".* width="\([0-9.]*\)" height="\([0-9.]*\)".*/\1 \2 \3/' | awk '{ printf "%s%.0f+%.0f:%.2f", s, $1, $2, $3*3*1.05/240; s = " " }'; }
check "a histogram" sweep "$osc" swing x=0,0.1,0.2,1 --measure 'x(0)' --until 0.1 --histogram 2 --svg "$TMP/bars.svg"
is "counts runs" "84+313:3.00 397+313:1.00" "$(bars)"
check "in more parts" sweep "$osc" swing x=0,0.1,0.2,1 --measure 'x(0)' --until 0.1 --histogram 4 --svg "$TMP/bars.svg"
is "some of which are empty" "84+156:3.00 554+156:1.00" "$(bars)"
check "of two measures" sweep "$osc" swing x=1,2,3 "m=1,2" --measure x --measure 'log(x(0) - 1)' --until 0.1 --histogram 3 --svg "$TMP/bars.svg"
is "are two panels" 2 "$(grep -c '<rect .*stroke="#999"' "$TMP/bars.svg")"
check "runs without a value are said" grep -q '>2 of 6 runs have no value<' "$TMP/bars.svg"
check "a histogram of equal values" sweep "$osc" swing x=1,1,1 --measure 'x(0)' --until 0.1 --histogram 3 --svg "$TMP/bars.svg"
is "has one bar" 1 "$(bars | wc -w)"
check "without a picture" says 2 "needs a picture: --svg FILE.svg" "$LAGC" sweep "$osc" swing x=1,2 --histogram 3 --measure x -o "$TMP/no.csv"
check "of too many parts" says 2 "up to 500 bars" "$LAGC" sweep "$osc" swing x=1,2 --histogram 501 --measure x --svg "$TMP/no.svg"
check "of no part" says 2 "a whole number above 0, for example --histogram 40" "$LAGC" sweep "$osc" swing x=1,2 --histogram 0.5 --measure x --svg "$TMP/no.svg"
check "nothing is written" [ ! -e "$TMP/no.csv" ]

# Kirkwood's gap in ten thousand years (Wisdom 1982): asteroids within 0.01 au of 2.5024 au, the 3:1 resonance, cross Mars' orbit; those 0.03 au away keep an eccentricity below 0.2.
check "asteroids near 2.5 au" sweep models/asteroid.lag gap a=2.46,2.47,2.495,2.5,2.505,2.54 w=3.1416 --measure 'axis(1e4)' --measure 'max(ecc)' --histogram 8 --svg "$TMP/bars.svg" -o "$TMP/gap.csv"
is "three in the gap are removed" "2.495 2.5 2.505" "$(awk -F , 'FNR > 1 && $4 == "stopped" && $3 > 0.2999 { printf "%s%s", s, $1; s = " " }' "$TMP/gap.csv")"
is "those outside stay" "2.46 2.47 2.54" "$(awk -F , 'FNR > 1 && $4 == "ok" && $3 < 0.2 { printf "%s%s", s, $1; s = " " }' "$TMP/gap.csv")"
check "the histogram leaves out those removed" grep -q '>3 of 6 runs have no value<' "$TMP/bars.svg"

# The gallery's fractals, small. Energy forbids a turn where 2 cos th1 + cos th2 > 1; elsewhere some rods turn over. Magnets 2 and 3 are mirror images.
check "flips of the double pendulum" sweep models/double_pendulum.lag flip 'th1=-165..165[deg]:12' 'th2=-165..165[deg]:12' --measure 'hit(flip)' -o "$TMP/flips.csv"
flips() { awk -F , 'FNR > 1 { n++; lens = 2*cos($1) + cos($2) > 1; if (lens && $3 != "nan") print "turns", $0; turned += !lens && $3 > 0 } END { if (n != 144 || turned < 40) print n, turned }' "$TMP/flips.csv"; }
empty "none where energy forbids them" "$(sed 's/-nan/nan/' "$TMP/flips.csv" >"$TMP/f" && mv "$TMP/f" "$TMP/flips.csv" && flips)"
check "basins of the magnetic pendulum" sweep models/magnetic_pendulum.lag x=-1.5..1.5:7 y=-1.3..1.3:6 --measure magnet -o "$TMP/basins.csv"
mirrored() { awk -F , 'FNR > 1 { at[FNR - 2] = $3 } END { for (i = 0; i < 42; i++) { a = at[i]; b = at[i - i%6 + 5 - i%6]; seen[a]++; if (!(a == 1 && b == 1) && a + b != 5) print i, a, b } for (k = 1; k < 4; k++) if (!seen[k]) print "no " k }' "$TMP/basins.csv"; }
empty "y reflected exchanges magnets 2 and 3" "$(mirrored)"
check "are drawn as categories" sweep models/magnetic_pendulum.lag x=-1.5..1.5:7 y=-1.3..1.3:6 --measure magnet --svg "$TMP/basins.svg"
is "with a legend of three" "1 2 3" "$(grep -A 1 'width="14" height="14"' "$TMP/basins.svg" | sed -n 's/.*>\([0-9]*\)<\/text>/\1/p' | tr '\n' ' ' | sed 's/ $//')"

# Refused: nothing is written.
no() { refused 2 "$@"; }
wrong() { refused 1 "$@"; } # by the compiler
refused() {
  code=$1 words=$2
  shift 2
  rm -f "$TMP/no.csv"
  says "$code" "$words" "$LAGC" sweep "$@" -o "$TMP/no.csv" && [ ! -e "$TMP/no.csv" ] && [ ! -e "$TMP/no.csv.journal" ]
}
rows_refused() { { echo w; awk 'BEGIN { while (i++ < 800) printf "1" }'; echo; } >"$TMP/long.in.csv" && no '1" is not a number; rows have one for each name' "$osc" --rows "$TMP/long.in.csv"; }
no_points() { [ "${GSL:-yes}" != yes ] || no "1000000000000 points of 1 numbers take 8e+03 GB; lhs and random take none" "$osc" 'w~uniform(1,2)' --samples 1e12 --sampling sobol; }
check "an inverted range" no "the range is empty" "$osc" w=2..1:5
check "an empty range" no "the range is empty" "$osc" w=1..1:3
check "an empty distribution" no "the range is empty" "$osc" 'w~uniform(2,1)' --samples 3
check "a range of no values" no "the number of values is a whole number" "$osc" w=1..2:0
check "more values than a sweep has runs" no "up to 1e12 runs: take fewer values" "$osc" w=1..2:1e13
check "a list of 800 letters, whose reason is not cut off" no '1,...: a list is numbers and commas' "$osc" "w=$(awk 'BEGIN { while (i++ < 200) printf "1,2," }')x"
check "a name of 800 letters" no 'www...: a name is missing, or too long' "$osc" "$(awk 'BEGIN { while (i++ < 800) printf "w" }')=1,2"
check "a number of 800 digits" rows_refused
check "points for which there is no memory" no_points
check "two numbers of values" no "the number of values is a whole number" "$osc" w=1..2:11:5
check "an empty list" no "a list is numbers and commas" "$osc" w=,
check "a range without ends" no "a range is FIRST..LAST:NUMBER" "$osc" w=..
check "equal ratios from below 0" no "has positive ends" "$osc" w=-1..2:log:3
check "another distribution" no "a distribution is normal(MEAN, DEVIATION)" "$osc" 'w~gauss(1,2)' --samples 3
check "no samples" no "a whole number" "$osc" 'w~uniform(1,2)' --samples 0
check "too many samples" no "up to 1e12" "$osc" 'w~uniform(1,2)' --samples 1e13
check "a measure of nothing" no "--measure needs a value" "$osc" w=1,2 --measure ''
check "a unit of another kind" no "this value is in [s]" "$osc" 'w=1..2[s]:3'
check "a range without number" no "w=1..2: the number of values is missing: write w=1..2:11, w=1..2:log:11 in equal ratios, or add --samples 1000" "$osc" w=1..2
check "from 0: no equal ratios" no "write w=0..2:11, or add" "$osc" w=0..2
check "no range" no "nothing varies: no value has two dots or a comma" "$osc" w=1
check "a step in place of a number" no "a whole number above 0, as in 0..1:11, or, in equal ratios, 1..100:log:11" "$osc" w=1..2:0.5
check "the word log behind the number" no "in equal ratios, 1..100:log:11" "$osc" w=1..2:5:log
check "a unit without brackets" no "with a unit 0..180[deg]:19" models/pendulum.lag th=0..360deg:5
check "a list of them" no "1,2,5 or 0,90[deg]" models/pendulum.lag th=0deg,90deg
check "three dots" no "its first value, 1, is not below its last, 0.2" "$osc" w=1...2:5
check "a list in brackets, which are for units" no "w=[1,2,3]: a list is numbers and commas" "$osc" w=[1,2,3]
check "a range in a function's words" no "a range is 0..1:11" "$osc" 'w=linspace(0,1,11)'
check "a distribution behind =" no "NAME~normal(MEAN, DEVIATION)" "$osc" 'w=normal(1,2)' --samples 3
check "an empty value" no "w=: a value is missing; name and value are one word without spaces" "$osc" w= 1..2:5
check "an equals sign alone" no "=: a value is missing; name and value are one word" "$osc" w = 1..2:5
check "a list of three words" says 1 "a value is one word, name=value" "$LAGC" sweep "$osc" w=1 2 3 -o "$TMP/no.csv"
check "a measure beside its option" says 1 "an option's stands behind it" "$LAGC" sweep "$osc" w=1,2 --measure 'max(x)' 'min(x)' -o "$TMP/no.csv"
check "an option in place of a value" says 2 "--samples needs a value: --samples N" "$LAGC" sweep "$osc" 'w~normal(1,2)' --samples -o "$TMP/no.csv"
check "and of a file" says 2 "-o needs a value: -o FILE" "$LAGC" sweep "$osc" w=1,2 -o --measure x
check "a function without its argument" wrong '`max` is a function, `max(...)`' "$osc" w=1,2 --measure max
check "or with a space" wrong 'a function takes its argument in parentheses: `max(...)`' "$osc" w=1,2 --measure 'max x'
check "an event without parentheses" wrong 'a function takes its argument in parentheses: `hit(...)`' "$osc" w=1,2 --measure 'hit far'
check "a function that is not there" wrong "of a run there are max, min, mean, rms" "$osc" w=1,2 --measure 'final(x)'
check "a coordinate as event" wrong 'the model has `far`' "$osc" w=1,2 --measure 'count(x)'
check "a value at a time, with its name" wrong "--measure:1:4: error: expected an operator" "$osc" w=1,2 --measure 'x(t=2)'
check "no thread" no "--threads 0: a whole number above 0" "$osc" w=1,2 --threads 0
printf '1,2\n3,4\n' >"$TMP/bare.in.csv"
printf 'w,zeal\n3,4\n' >"$TMP/zeal.in.csv"
check "rows without names" no "bare.in.csv:1: 1 is no name: the first line has the names of the columns" "$osc" --rows "$TMP/bare.in.csv"
check "rows of an unknown name" no "zeal.in.csv: zeal: no such parameter" "$osc" --rows "$TMP/zeal.in.csv"
check "a range of other programs" no "write a range, NAME=FIRST..LAST:NUMBER" "$osc" w=1:2:5
check "a value as an option" no "a value of the model has no dashes: w=1" "$osc" --w 1
check "a name that is not there" no "did you mean stiffer" "$osc" stifer=1,2
check "wrong values alone" no "the model declares m > 0" "$osc" m=-2,-1
check "a measure that is not there" wrong "did you mean" "$osc" w=1,2 --measure 'perod(x)'
check "two ranges of one name" no "varies twice" "$osc" w=1,2 w=3,4
check "ranges of different length" no "the same number" "$osc" w=1,2 m=1,2,3 --zip
check "samples of a constant" no "compiled for each of its values: write plain numbers" "$TMP/chain.lag" 'N~uniform(1,9)' --samples 3
check "a constant with a unit" no "write plain numbers" "$TMP/chain.lag" 'N=2,3[m]'
check "an inverted range of a constant" no "write plain numbers" "$TMP/chain.lag" N=8..2:4
check "a constant by -D and a range" no "-D N=3: N varies" "$TMP/chain.lag" -D N=3 N=2,4
check "a thousand compilations" no "compiled for up to 256 values" "$TMP/chain.lag" N=1..1000:1000
check "a constant beside a range of another length" no "the same number" "$TMP/chain.lag" N=2,4,8 k=1,2 --zip
no_size() { "$LAGC" sweep "$TMP/chain.lag" N=2,2.5 -o "$TMP/no.csv" >"$TMP/out" 2>&1; [ $? = 1 ] && grep -q '^lagc: with N=2.5:' "$TMP/out" && grep -q "not a whole number" "$TMP/out" && [ ! -e "$TMP/no.csv" ]; }
check "a size that is no number of masses" no_size
check "another program" says 2 "built for other values" "$TMP/sim" swing --sweep --consts w w=1,2,3,4,5 -o "$TMP/no.csv"
check "a measure of one size alone" wrong "lagc: with N=2:" "$TMP/chain.lag" N=4,2 --measure 'x[3]'
# the last mass of each size, as the run of that size alone has it
last() { "$LAGC" run "$TMP/chain.lag" -D N="$1" --until 0.1 --measure "last=x[$1]" --json | sed 's/.*"last": \([^}]*\)}.*/\1/'; }
check "a measure of each size, x[N]" sweep "$TMP/chain.lag" N=4,2 --measure 'last=x[N]' --until 0.1 -o "$TMP/last.csv"
near "of 4" 1e-12 "$(last 4)" "$(sed -n 2p "$TMP/last.csv" | cut -d, -f2)"
near "and of 2" 1e-12 "$(last 2)" "$(sed -n 3p "$TMP/last.csv" | cut -d, -f2)"
check "a start of one size alone" no "with N=2: x[3]: no such parameter" "$TMP/chain.lag" N=4,2 'x[3]=1,2'
check "a start of a rotation" no "cannot vary: write a \`param\` into it" models/free_body.lag 'omega(R).x=1,2'
check "an empty place in a list" no "w=1,,2: a list is numbers and commas" "$osc" w=1,,2
check "a range and a value of one name" no "w=1: w varies; leave one out" "$osc" w=1 w=2,3
while IFS='|' read -r words of; do
  # shellcheck disable=SC2086 # a list of words
  check "refused: $of" says 2 "$words" "$LAGC" sweep models/pendulum.lag $of
done <<END
1e+13 runs are more than 1e+12: take fewer values|l=0.5..1:1000001 g=1..2:10000001 -o $TMP/no.csv
l has a distribution: write the number of samples|l~normal(1,0.1)
--shard 5/4: part i of n|l=0.5..1:3 --shard 5/4 -o $TMP/no.csv
a map of more than 262144 cells is too large|l=0.5..1:2001 g=1..2:2001 --svg $TMP/no.svg
END
check "a range of a member, and then of all" says 2 "write k first" "$LAGC" sweep "$TMP/pair.lag" 'k[1]=1,2' k=3,4 -o "$TMP/no.csv"
check "all, and then a member" sweep "$TMP/pair.lag" k=3,4 'k[1]=1,2' -o "$TMP/all.csv"
check "a range wider than numbers" no "wider than the largest number" "$osc" F=-1e308..1e308:3
check "a sampling of no samples" no "--sampling is for samples" "$osc" w=1,2 --sampling lhs
check "a seed of no samples" no "--seed is for samples" "$osc" w=1,2 --seed 3
check "a measure called as another column" no "two columns would be called w" "$osc" w=1,2 --measure 'w=x'
check "a measure called status" no "two columns would be called status" "$osc" w=1,2 --measure 'status=x'
check "threads that no machine has" no "--threads 100000: up to 1024" "$osc" w=1,2 --threads 100000
check "parts joined and made at once" no "leave one out" "$osc" w=1,2 --merge 2 --shard 1/2
folder() { says 2 "cannot write $TMP: Is a directory" "$LAGC" sweep "$osc" w=1,2 -o "$TMP" && [ ! -e "$TMP.journal" ]; }
check "a folder as output" folder
check "standard output is not resumed" says 2 "runs are kept beside a file only" "$LAGC" sweep "$osc" w=1,2 -o - --resume
check "runs for years" no "1000000000000 runs would take about" "$osc" w=1..2:1000000 m=1..2:1000000
check "runs for days, and more than 10 GB" no "GB on this machine: take fewer values, --shard i/n on many, or --yes" "$osc" w=1..2:30000 m=1..2:30000
check "more runs than can be counted" no "take fewer values" "$osc" w=1..2:1000000000 m=1..2:1000000
check "samples of nothing" no "no name has a distribution" "$osc" w=1,2 --samples 10
check "a constant span" no "nothing to compute" "$osc" w=1,2 --until 0
check "nothing to resume" no "nothing to go on with" "$osc" w=1,2 --resume
others() {
  # shellcheck disable=SC2086
  "$TMP/sim" swing --sweep $grid --measure x --until 60 -o "$TMP/other.csv" --quiet --shard 1/1 &
  sleep 0.1
  kill -9 $!
  wait $! 2>/dev/null
  [ -e "$TMP/other.csv" ] && return 0
  # shellcheck disable=SC2086
  says 2 "this is another sweep" "$TMP/sim" swing --sweep $grid --measure x --until 61 -o "$TMP/other.csv" --resume
}
check "resumed with another end" others
# A part leaves its journal. Resumed with other values, it stays as it is, and nothing is written.
kept() { sweep "$osc" w=1,2 'm~normal(1,0.1)' --samples 4 k=3 --measure x --until 1 -o "$TMP/kept.csv" --shard 1/2 "$@"; }
check "a part" kept
cp "$TMP/kept.csv.1-of-2.journal" "$TMP/kept"
other() { ! kept --resume "$@" && grep -q "this is another sweep" "$TMP/err" && [ ! -e "$TMP/kept.csv" ] && cmp "$TMP/kept" "$TMP/kept.csv.1-of-2.journal"; }
check "another parameter" other F=2
check "another start" other x=0.1
check "other samples" other --seed 2
check "another sampling" other --sampling lhs
check "another tolerance" other --tol 1e-5
check "another method" other --method rk4
check "another measure" other --measure 'max(x)'
check "motions, too" other --motions "$TMP/kept.motions"
again() { ! sweep "$osc" "$1" 'm~normal(1,0.1)' --samples 4 k=3 --measure x --until 1 -o "$TMP/kept.csv" --shard 1/2 --resume && grep -q "this is another sweep" "$TMP/err"; }
check "another range" again w=1,2.5
check "the same goes on" kept --resume
check "an output of another kind" says 2 "sweep writes CSV, NumPy where the name ends in .npy, or HDF5 where it ends in .h5" "$LAGC" sweep "$osc" w=1,2 -o "$TMP/no.xlsx"

# Many short runs: memory.
many() {
  printf 'model drift\ncoord x\nparam v = 1\nlagrangian = x'"'"'^2/2\nscene run { start x'"'"' = v; span 1; method rk4(step = 1) }\n' >"$TMP/drift.lag"
  "$LAGC" build "$TMP/drift.lag" -o "$TMP/drift" && ( ulimit -v 1000000; "$TMP/drift" --sweep v=0..1:1000 x=0..1:1000 --measure x -o "$TMP/many.csv" --quiet ) &&
    [ "$(wc -l <"$TMP/many.csv")" = 1000001 ] && tail -n 1 "$TMP/many.csv" | grep -qx '1,1,2,ok'
}
slow check "a million runs in less than 1 GB" many
tap_end
