#!/bin/sh
# Sweeps on several processes, by Open MPI: the same bytes as of one process, after kills and signals of ranks too; what is refused.
. tests/tap.sh
export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 OMPI_MCA_rmaps_base_oversubscribe=1 LAG_TEST=$TMP
cat >"$TMP/osc.lag" <<'END'
model osc
coord x [m]
param s = 1 [1/(m^2*s^2)] >= 0
lagrangian = x'^2/2 - s/4*x^4
scene swing { start x = 1; span 40; tolerance 1e-13; method taylor }
END
osc=$TMP/osc.lag
sweep() { "$LAGC" sweep "$osc" x=0.1..1.9:40 s=0.1..3:25 --measure 'period(x)' --measure x --quiet "$@"; }
no() { # WORDS OPTIONS: refused, and nothing is written
  words=$1
  shift
  says 2 "$words" sweep -o "$TMP/no.csv" "$@" && [ -z "$(ls "$TMP" | grep '^no\.')" ]
}

# A lagc without MPI: the archive is not beside it.
mkdir -p "$TMP/home/lib" "$TMP/home/include" && cp "$BUILD/liblag.a" "$TMP/home/lib" && cp runtime/include/*.h "$TMP/home/include"
LAG_HOME=$TMP/home check "without MPI" no "apt-get install libopenmpi-dev openmpi-bin" --mpi 2
started() { LAG_HOME=$TMP/home OMPI_COMM_WORLD_SIZE=2 no "need Open MPI"; }
check "started by mpirun" started
"$LAGC" build "$osc" -o "$TMP/sim"
check "a program of its own" says 2 "built without MPI; \`lagc sweep --mpi 2\`" "$TMP/sim" --sweep x=1,2 --mpi 2 -o "$TMP/no.csv"
if [ ! -e "$BUILD/liblag_mpi.a" ] || ! command -v mpirun >/dev/null; then
  skip "ranks" "there is no Open MPI"
  tap_end
  exit
fi

check "no process" no "--mpi 0: a whole number" --mpi 0
check "part of one" no "--mpi 1.5: a whole number" --mpi 1.5
check "no number" no "--mpi: \"many\" is not a number" --mpi many
check "one" no "--mpi 1: one process is there without MPI" --mpi 1
check "joined parts" no "there are no runs to share" --mpi 2 --merge 2
check "as two processes" sweep --mpi 2 -o "$TMP/two.csv"
no_mpirun() { says 2 "apt-get install openmpi-bin" "$(command -v env)" PATH=/nowhere "$LAGC" sweep "$osc" x=1,2 --measure 'period(x)' --measure x --mpi 2 -o "$TMP/no.csv" && [ ! -e "$TMP/no.csv" ]; }
check "without mpirun" no_mpirun
twice() { OMPI_COMM_WORLD_SIZE=2 no "mpirun has started 2 processes already" --mpi 3; }
check "mpirun in mpirun" twice

# The same bytes.
check "as one process" sweep --threads 1 -o "$TMP/one.csv"
same() { cmp "$TMP/one.csv" "$TMP/two.csv" && [ "$(echo "$TMP"/two.csv*)" = "$TMP/two.csv" ]; }
check "two have the same bytes" same
as() { # OPTIONS: and their bytes
  rm -f "$TMP/two.csv"
  sweep -o "$TMP/two.csv" "$@" && same
}
check "three, with two threads each" as --mpi 3 --threads 2
for n in 2 3 4; do
  slow check "$n" as --mpi=$n
  slow check "$n, with three threads each" as --mpi $n --threads 3
done
by_mpirun() { rm -f "$TMP/two.csv" && mpirun -n "$1" "$LAGC" sweep "$osc" x=0.1..1.9:40 s=0.1..3:25 --measure 'period(x)' --measure x --quiet -o "$TMP/two.csv" && same; }
slow check "one by mpirun" by_mpirun 1
slow check "three by mpirun" by_mpirun 3
to_stdout() { sweep --mpi 2 -o - >"$TMP/two.csv" && same; }
slow check "to standard output" to_stdout
parts() {
  rm -f "$TMP/two.csv"
  for i in 1 2; do sweep -o "$TMP/two.csv" --mpi 2 --shard $i/2 || return 1; done
  sweep -o "$TMP/two.csv" --merge 2 && same
}
slow check "in parts" parts
slow check "joined by ranks" says 2 "there are no runs to share; start one process" mpirun -n 2 "$LAGC" sweep "$osc" x=1,2 --measure x -o "$TMP/no.csv" --merge 2
other() { says 2 "rank 1 has another sweep than rank 0" mpirun -n 1 "$LAGC" sweep "$osc" x=1,2 --measure x -o "$TMP/no.csv" : -n 1 "$LAGC" sweep "$osc" x=1,3 --measure x -o "$TMP/no.csv"; }
slow check "ranks with other values" other
# Ranks wait for the one that compiles: each run of the C compiler on the model leaves a line.
once() {
  printf '#!/bin/sh\ncase "$*" in *model_0.c*) echo >>"%s/compiled" ;; esac\nexec %s "$@"\n' "$TMP" "${CC:-cc}" >"$TMP/cc" && chmod +x "$TMP/cc"
  sed 's/osc/other/' "$osc" >"$TMP/other.lag"
  CC=$TMP/cc mpirun -n 4 "$LAGC" sweep "$TMP/other.lag" x=1,2,3,4 --measure x --quiet -o "$TMP/other.csv" && [ "$(wc -l <"$TMP/compiled")" = 1 ]
}
slow check "one of four compiles" once

# Warnings and notes come once: of the model, and of the run.
sed 's/^param s/param idle = 1, s/' "$osc" >"$TMP/idle.lag"
said_once() { "$@" "$LAGC" sweep "$TMP/idle.lag" x=1,2 --measure x --method rk4 --tol 1e-3 -o "$TMP/idle.csv" ${ranks:+--mpi $ranks} >/dev/null 2>"$TMP/err"; cat "$TMP/err"; [ "$(grep -c 'nothing uses' "$TMP/err") $(grep -c 'rk4 has a fixed step' "$TMP/err")" = "1 1" ]; }
ranks=2 check "one warning of two processes" said_once env
slow check "one of three by mpirun" said_once mpirun -n 3

# The script of the reference, as Slurm would start it.
slurm() {
  mkdir -p "$TMP/job/bin" && cp models/pendulum.lag "$TMP/job/pend.lag" && printf '#!/bin/sh\nexec "%s" "$@"\n' "$(realpath "$LAGC")" >"$TMP/job/bin/lagc" && chmod +x "$TMP/job/bin/lagc"
  awk '/^```sh sweep.slurm/ { on = 1; next } /^```/ { on = 0 } on' grammar/LANGUAGE.md >"$TMP/job/sweep.slurm"
  (cd "$TMP/job" && PATH=$PWD/bin:$PATH SLURM_NTASKS=2 sh sweep.slurm) && "$LAGC" sweep models/pendulum.lag 'th=5..175[deg]:2000' l=1,2 --measure 'period(th)' --quiet -o "$TMP/periods.csv" && cmp "$TMP/periods.csv" "$TMP/job/periods.csv"
}
slow check "a script for Slurm" slurm

# Kills and signals, when some chunks are there. The sweep takes seconds of one processor.
words="$osc x=0.1..1.9:100 s=0.1..3:50 --measure period(x) --until 600 --lanes 1 --quiet"
# shellcheck disable=SC2086 # words
long() { "$LAGC" sweep $words "$@"; }
rank_pid() { # RANK
  for f in $(grep -lzx "OMPI_COMM_WORLD_RANK=$1" /proc/[0-9]*/environ 2>/dev/null); do
    ! grep -qzx "LAG_TEST=$TMP" "$f" || echo "$f" | tr -dc 0-9
  done
}
begin() { # COMMAND...: $! when it is at work
  rm -f "$TMP"/two.csv*
  "$@" -o "$TMP/two.csv" 2>"$TMP/err" &
  i=0
  while [ "$(wc -c 2>/dev/null <"$TMP/two.csv.journal" || echo 0)" -lt 3000 ] && [ $i -lt 1200 ]; do
    sleep 0.05
    i=$((i + 1))
  done
}
kept() { # OPTIONS: goes on from the journal, which had some chunks
  [ "$(wc -c <"$TMP/two.csv.journal")" -gt 3000 ] && long -o "$TMP/two.csv" --resume "$@" && same
}
killed() { # SIGNAL RANK
  # shellcheck disable=SC2086
  begin "$LAGC" sweep $words --mpi 3
  kill -"$1" "$(rank_pid "$2")"
  ! wait $! && [ ! -e "$TMP/two.csv" ]
}
ended() { # shellcheck disable=SC2086
  begin "$LAGC" sweep $words --mpi 3
  kill -TERM $!
  wait $! && return 1
  cat "$TMP/err"
  grep -q 'interrupted; .*two.csv.journal keeps the runs made so far' "$TMP/err"
}
lost() { # SIGNAL: rank 1 loses its chunks; mpirun leaves the others
  # shellcheck disable=SC2086
  begin timeout 60 mpirun $2 -n 3 "$LAGC" sweep $words
  kill -"$1" "$(rank_pid 1)"
  i=0
  while [ "$1" = STOP ] && ! { [ -e "$TMP/two.csv" ] && grep -q "do not answer" "$TMP/err"; } && [ $i -lt 1100 ]; do
    sleep 0.05
    i=$((i + 1))
  done
  [ "$1" != STOP ] || kill -KILL "$(rank_pid 1)" # mpirun waits for it
  wait $!
  cat "$TMP/err"
  same && grep -q "1 of 3 processes do not answer" "$TMP/err"
}
orphaned() { # rank 0 is killed, and mpirun leaves the others: no file, and no status of success
  # shellcheck disable=SC2086
  begin timeout 100 mpirun --enable-recovery -n 3 "$LAGC" sweep $words
  kill -KILL "$(rank_pid 0)"
  ! wait $! && [ ! -e "$TMP/two.csv" ] && grep -q "rank 0 does not answer" "$TMP/err"
}
slow check "a longer sweep" long --threads 2 -o "$TMP/one.csv"
slow check "rank 1 is killed" killed KILL 1
slow check "the rest, by two" kept --mpi 2
slow check "rank 0 is killed" killed KILL 0
slow check "the rest, by one" kept
# mpirun kills ranks a second after it ends them: on a busy machine before rank 0 has spoken, or the sweep is over before the signal comes. One of three is seen.
once_ended() { ended || ended || OMPI_MCA_odls_base_sigkill_timeout=6 ended; }
slow check "mpirun is terminated" once_ended
slow check "the rest, by two" kept --mpi 2
slow check "a rank is terminated" killed TERM 1
slow check "and goes on" kept --mpi 2
slow check "a killed rank with --enable-recovery" lost KILL --enable-recovery
one_of 3 && slow check "rank 0 is killed with --enable-recovery" orphaned # the others wait for a minute
slow check "a rank that stands still" lost STOP ""
tap_end
