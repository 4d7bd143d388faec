#!/bin/sh
# Files that optional libraries write: pictures as PNG (librsvg), sweeps and their motions as HDF5; and what is said without them.
. tests/tap.sh
. tests/exec/lib_oscillator.sh
. tests/exec/lib_precision.sh
oscillator <<'END'
event far: x + 2.5 [m] falling { stop }
scene swing { start x = 1; span 1; tolerance 1e-10 }
scene halt { start x = 1; span 2; tolerance 1e-10 }
END
is_png() { [ "$(head -c 8 "$1" | od -An -tx1 | tr -d ' \n')" = 89504e470d0a1a0a ]; }
# Size in pixels, from the head: twice that of the SVG.
size() { od -An -tu1 -j 16 -N 8 "$1" | awk '{ print ($3*256 + $4) "x" ($7*256 + $8) }'; }
twice() { sed -n 's/.*<svg[^>]* width="\([0-9]*\)" height="\([0-9]*\)".*/\1 \2/p' "$1" | awk '{ print 2*$1 "x" 2*$2 }'; }
if [ -e "$BUILD/liblag_png.a" ]; then
  check "plot" "$LAGC" plot "$TMP/osc.lag" -o "$TMP/plot.png"
  check "is a PNG" is_png "$TMP/plot.png"
  check "the same as SVG" "$LAGC" plot "$TMP/osc.lag" -o "$TMP/plot.svg"
  is "has half its size" "$(twice "$TMP/plot.svg")" "$(size "$TMP/plot.png")"
  check "a map of a sweep" "$LAGC" sweep "$TMP/osc.lag" x=0..1:3 k=1..2:3 --measure x --svg "$TMP/map.png"
  check "is one" is_png "$TMP/map.png"
  check "nothing is left beside" [ "$(ls "$TMP" | grep -c 'png\.part\|part.*svg')" = 0 ]
  check "a folder that is not there" says 2 "cannot write" "$LAGC" plot "$TMP/osc.lag" -o "$TMP/no/plot.png"
  check "a program of its own" "$LAGC" build "$TMP/osc.lag" -o "$TMP/sim"
  check "says who writes them" says 2 "writes pictures as SVG" "$TMP/sim" --svg "$TMP/own.png"
else
  skip "PNG" "there is no librsvg"
fi
if [ -e "$BUILD/liblag_hdf5.a" ]; then
  sweep() { "$LAGC" sweep "$TMP/osc.lag" x=1,3 k=1..4:4 --measure 'X=x(0.5)' --measure k --quiet "$@"; }
  check "a sweep as HDF5" sweep -o "$TMP/one.h5" --threads 1
  check "on two threads" sweep -o "$TMP/two.h5" --threads 2
  check "the same bytes" cmp "$TMP/one.h5" "$TMP/two.h5"
  check "parts of it" sweep -o "$TMP/three.h5" --shard 1/2
  check "joined" sh -c '"$0" sweep "$1/osc.lag" x=1,3 k=1..4:4 --measure "X=x(0.5)" --measure k --quiet -o "$1/three.h5" --shard 2/2 && "$0" sweep "$1/osc.lag" x=1,3 k=1..4:4 --measure "X=x(0.5)" --measure k --quiet -o "$1/three.h5" --merge 2 && cmp "$1/one.h5" "$1/three.h5"' "$LAGC" "$TMP"
  if command -v h5dump >/dev/null; then
    numbers() { h5dump -y -w 0 -m %.15g -d "$1" "$TMP/one.h5" | sed -n '/DATA {/,/}/p' | sed '1d; /^ *}/,$d' | tr -d ' \n'; }
    is "the ranges are its axes" "1,3 1,2,3,4" "$(numbers x) $(numbers k)"
    near "x = 3, k = 4 is the last: 3 cos(1)" 1e-9 1.62090691760442 "$(h5dump -y -w 0 -m %.15g -d X -s 1,3 -c 1,1 "$TMP/one.h5" | sed -n '/DATA {/{n;p;}' | tr -d ' ')"
    check "with units" sh -c 'h5dump -a /x/units "$0" | grep -q "\"m\""' "$TMP/one.h5"
    check "a measure with the name of a range" sh -c 'h5dump -H "$0" | grep -q "DATASET \"k(end)\""' "$TMP/one.h5"
  else
    skip "h5dump" "hdf5-tools are not installed"
  fi
  # Motions: those of the CSV file, over the axes of the runs and one of rows; NaN after the end of a run that an event stops.
  motions() { "$LAGC" sweep "$TMP/osc.lag" halt x=1,3 k=1..4:4 --every 0.5 --quiet --motions "$@"; }
  check "motions as HDF5" motions "$TMP/one.motions.h5" --threads 1
  check "on two threads" motions "$TMP/two.motions.h5" --threads 2
  check "the same bytes" cmp "$TMP/one.motions.h5" "$TMP/two.motions.h5"
  check "the same as CSV" motions "$TMP/motions.csv"
  if command -v h5dump >/dev/null; then
    of_motion() { h5dump -y -w 1 -m %.17g -d "$1" "$TMP/one.motions.h5" | sed -n '/DATA {/,/}/p' | tr -d ', ' | sed '1d; /}/,$d'; }
    column() { sed 1d "$TMP/motions.csv" | cut -d, -f"$1"; }
    i=2
    for name in t x "x'" energy; do
      of_motion "$name" | grep -v nan | awk '{ printf "%.17g\n", $1 }' >"$TMP/h5.$i"
      is "$name" "$(column $i | awk '{ printf "%.17g\n", $1 }')" "$(cat "$TMP/h5.$i")"
      i=$((i + 1))
    done
    # 3 cos(w t) = -2.5 at t = 2.556/w: 1.81, 1.48 and 1.28 for k = 2, 3, 4; so two runs have four rows, all others five
    is "two starts, four constants, five rows and the end" "48 8 10" "$(of_motion x | wc -l) $(of_motion x | awk 'NR % 6 == 0 && /nan/' | wc -l) $(of_motion x | grep -c nan)"
    is "the starts are an axis" "1 3" "$(of_motion 'x(start)' | tr '\n' ' ' | sed 's/ $//')"
    check "with units" sh -c 'h5dump -a "/x'"'"'/units" "$0" | grep -q "\"m/s\"" && h5dump -a /t/units "$0" | grep -q "\"s\"" && h5dump -a /k/units "$0" | grep -q "1/s^2"' "$TMP/one.motions.h5"
    check "samples of a start" "$LAGC" sweep "$TMP/osc.lag" "x~uniform(0,1)" k=1,2 --samples 5 --motions "$TMP/s.motions.h5" --every 0.5 --quiet
    is "stand over the runs, motions over their rows, too" "2, 5 2, 5, 4" "$(for d in 'x(start)' x; do h5dump -H -d "$d" "$TMP/s.motions.h5" | sed -n 's/.*DATASPACE  SIMPLE { ( \([^)]*\) ) \/.*/\1/p' | head -n 1; done | tr '\n' ' ' | sed 's/ $//')"
  fi
  # Quantities called as the axes that count: all stand in the file, an axis beside its quantity under another name.
  printf 'model counts\ncoord row, run, sample\nparam k = 1\nlagrangian = (row'"'"'^2 + run'"'"'^2 + sample'"'"'^2 - k*(row^2 + run^2 + sample^2))/2\nscene s { start row = 1; span 1; output row, run, sample every 0.5 }\n' >"$TMP/counts.lag"
  counts() { # FILE NAMES ARGUMENTS: the names of the datasets
    file=$1 names=$2
    shift 2
    "$LAGC" sweep "$TMP/counts.lag" "$@" --quiet || return 1
    command -v h5dump >/dev/null || return 0
    h5dump -n "$file" | awk '$1 == "dataset" { sub("/", "", $2); print $2 }' | sort | tr '\n' ' ' >"$TMP/names"
    [ "$(cat "$TMP/names")" = "$names " ] || { cat "$TMP/names"; return 1; }
  }
  check "a quantity called row" counts "$TMP/n.h5" "k row row(axis) run sample t" k=1,2 --motions "$TMP/n.h5"
  check "and a quantity called run" counts "$TMP/n.h5" "k row row(axis) run run(axis) sample t" k=1,2 --zip --motions "$TMP/n.h5"
  check "and a sample called sample" counts "$TMP/n.h5" "row row(axis) run sample sample(axis) sample(start) t" 'sample~uniform(0,1)' --samples 3 --motions "$TMP/n.h5"
  check "so in rows" counts "$TMP/n.h5" "k run run(axis) status" k=1,2 --zip --measure run -o "$TMP/n.h5"
  if has_precision long; then
    check "rows of long precision" says 2 "files hold doubles" "$LAGC" sweep "$TMP/osc.lag" k=1,2 --precision long -o "$TMP/long.h5"
    check "motions of long precision" says 2 "files hold doubles" "$LAGC" sweep "$TMP/osc.lag" k=1,2 --precision long --motions "$TMP/long.h5"
  fi
  check "motions of another program" says 2 "writes CSV and NumPy" "$TMP/sim" --sweep x=1,2 --motions "$TMP/own.h5"
  check "samples" "$LAGC" sweep "$TMP/osc.lag" "x~uniform(0,1)" k=1,2 --samples 5 -o "$TMP/samples.h5" --quiet
  check "of another program" says 2 "writes CSV and NumPy" "$TMP/sim" --sweep x=1,2 -o "$TMP/own.h5"
else
  skip "HDF5" "there is no libhdf5"
fi
# A lagc without these libraries: the archives are not beside it.
without() {
  mkdir -p "$TMP/home/lib" "$TMP/home/include"
  cp "$BUILD/liblag.a" "$TMP/home/lib" && cp runtime/include/*.h "$TMP/home/include" || return 1
  LAG_HOME=$TMP/home says 2 "$@"
}
check "without librsvg" without "apt-get install librsvg2-dev" "$LAGC" plot "$TMP/osc.lag" -o "$TMP/none.png"
check "motions without HDF5" without "apt-get install libhdf5-dev" "$LAGC" sweep "$TMP/osc.lag" x=1,2 --motions "$TMP/none.h5"
check "without HDF5" without "apt-get install libhdf5-dev" "$LAGC" sweep "$TMP/osc.lag" x=1,2 -o "$TMP/none.h5"
tap_end
