#!/bin/sh
# Plasmas of some hundred particles: models/plasma.lag with 400 sheets, models/electron_cloud.lag with 100 charges, against closed forms that hold for any number.
. tests/tap.sh
number() { awk "BEGIN { pi = 4*atan2(1, 1); printf \"%.15g\", $1 }"; }
sheets() { scene=$1 measure=$2; shift 2; "$LAGC" run models/plasma.lag "$scene" -D N=400 --measure "m=$measure" "$@" --json | sed 's/.*"measures": {"m": \([^}]*\)}.*/\1/'; }
# Left out are 100 times the square of the seed, 1e-6 of the period; the growth by then is that of one wave but for 2e-4.
! one_of 3 || near "400 sheets: the plasma frequency" 1e-5 "$(number 'pi')" "$(sheets still 'period(C)' w=2 seed=1e-4)"
! one_of 3 || near "a wave of their beam, of their momentum" 1e-9 "$(number '200*1e-5*cos(10)*cos(10*sqrt(3/8))')" "$(sheets drifting 'C(10)' seed=1e-5 --until 10)"
! one_of 3 || near "two streams: the largest rate of growth" 7e-5 "$(number '1/sqrt(8)')" "$(sheets two_streams 'log(wave(45)/wave(25))/20' seed=1e-9 --until 45)"
# The centre of 100 charges drifts across the fields as one charge does.
near "100 charges: the drift of their centre" 1e-9 "$(number '-0.5*3 + 0.125*sin(12)')" \
  "$("$LAGC" run models/electron_cloud.lag crossed -D N=100 --until 3 --measure 'm=Y(3)-Y(0)' --json | sed 's/.*"measures": {"m": \([^}]*\)}.*/\1/')"
tap_end
