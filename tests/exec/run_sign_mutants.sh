#!/bin/sh
# A sign in a force: each sign of the forces in emitted accelerations is flipped in turn, those of single terms too. The charges of L then no longer fit the
# motion, and a monitor ends the run: of the energy, or of the symmetry that breaks. With friction and wind their balances do not fit.
. tests/tap.sh

cat >"$TMP/main.c" <<'END'
#include "lag.h"
#include <stdio.h>
int main(void)
{
  lag_sim *s = lag_sim_new(&SCENE);
  int rc = s ? lag_sim_advance(s, 5) : LAG_ENOMEM;
  puts(s ? lag_sim_message(s) : "");
  lag_sim_free(s);
  return rc == LAG_OK ? 0 : rc == LAG_EMONITOR ? 3 : 1;
}
END

# flip K <C: sign K of the forces f1 = ..., f2 = ... changed; K = 0: the number of signs alone. "-a + b" has two, "a" has one.
flip() {
  awk -v k="$1" '
    /^  const LAG_REAL f[0-9]+ = / {
      head = $0
      sub(/ = .*/, " = ", head)
      rest = substr($0, length(head) + 1)
      if (rest !~ /^-/) rest = "+" rest
      out = ""
      while (match(rest, /^[-+]| [-+] /)) {
        sign = substr(rest, RSTART, RLENGTH)
        if (++n == k) { if (sign ~ /-/) sub(/-/, "+", sign); else sub(/[+]/, "-", sign) }
        out = out substr(rest, 1, RSTART - 1) sign
        rest = substr(rest, RSTART + RLENGTH)
      }
      $0 = head out rest
    }
    k { print }
    END { if (!k) print n }'
}

# moves SCENE FILE: status of a run of the simulator from FILE.c
moves() {
  sed "s/^#include \"lag.h\"/&\nextern const lag_scene $1;/" "$TMP/main.c" >"$TMP/with.c"
  # shellcheck disable=SC2086 # a list
  "$CC" -std=c11 -O0 -w -ffp-contract=off -DSCENE="$1" -I"$INC" "$TMP/$2.c" "$TMP/with.c" $LIBLAG -lm -o "$TMP/$2" || return 9
  "$TMP/$2" >"$TMP/out"
}

# mutants MODEL SCENE SIGNS: each mutant is caught, and the emitted program passes
mutants() {
  what=$1_$2
  "$LAGC" emit "$TMP/$1.lag" "$2" -o "$TMP/right.c" >/dev/null
  is "$what: signs of forces" "$3" "$(flip 0 <"$TMP/right.c")"
  moves "$what" right
  is "$what: emitted as it is, the monitors are content" 0 $?
  sign=1
  while [ "$sign" -le "$3" ]; do
    if one_of 3; then
      flip "$sign" <"$TMP/right.c" >"$TMP/wrong.c"
      moves "$what" wrong
      is "$what: with sign $sign flipped a monitor ends the run" 3 $?
    fi
    sign=$((sign + 1))
  done
}

{ cat models/kepler.lag; echo 'scene watched { like orbit; monitor energy 1e-8, spin 1e-8 }'; } >"$TMP/kepler.lag"
{ cat models/spherical_pendulum.lag; echo 'scene watched { like swing; monitor energy 1e-8, spin 1e-8 }'; } >"$TMP/spherical_pendulum.lag"
cp tests/exec/models/planets.lag "$TMP/planets.lag"
mutants kepler watched 2
mutants spherical_pendulum watched 3
mutants planets quiet 12
mutants planets disturbed 21
tap_end
