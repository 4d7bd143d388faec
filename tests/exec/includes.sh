#!/bin/sh
# Who may include whom. Data flows one way, from text to C, and each folder of src/ sees only what lies before it;
# the compiler and the runtime meet in runtime/numeric only; GSL is met in one folder. src/README.md has the reasons.
. tests/tap.sh

# FOLDER: the folders whose headers it may include. `mech/eqns.h` etc.: these files only.
allowed='
src/base      base/ numeric/ kernels/steppers.def
src/sym       sym/ base/ numeric/functions.def
src/syntax    syntax/ base/ numeric/functions.def
src/model     model/ syntax/ sym/ base/ numeric/functions.def
src/mech      mech/ model/ sym/ base/ numeric/
src/phase_space phase_space/ mech/ model/ sym/ base/ numeric/
src/symmetry  symmetry/ phase_space/ mech/ model/ sym/ base/ numeric/
src/claims    claims/ symmetry/ phase_space/ mech/ model/ sym/ base/ numeric/
src/report    report/ symmetry/ phase_space/ mech/ model/ sym/ base/
src/ir        ir/ base/ numeric/functions.def
src/series    series/ ir/ base/
src/lower     lower/ series/ ir/ symmetry/charges.h mech/ model/ sym/ base/
src/self_check      self_check/ lower/lower.h ir/ mech/ model/ syntax/ base/ numeric/functions.def
src/emit      emit/ ir/ base/ numeric/functions.def numeric/program_code.def kernels/steppers.def
src/fmu       fmu/ emit/ ir/ base/ kernels/steppers.def
src/toolchain toolchain/ base/ numeric/functions.def numeric/program_code.def
src/commands  app/options.def kernels/steppers.def commands/ toolchain/ fmu/ emit/ self_check/ lower/ ir/ report/ claims/ symmetry/ phase_space/ mech/ model/ sym/ syntax/ base/
src/playground playground/ commands/ fmu/fmu_archive.h toolchain/files.h toolchain/process.h report/equation_listing.h model/model.h base/
src           commands/ toolchain/gallery.h syntax/ base/
grammar       syntax/scan.h syntax/parse_state.h
runtime/numeric   numeric/
runtime/kernels   kernels/ numeric/gauss_points.h lag_lanes.h lag_math.h
runtime/core      core/ kernels/ numeric/ lag.h lag_model.h lag_math.h
runtime/constraints constraints/ core/core.h core/rhs.h kernels/ numeric/ lag.h lag_model.h lag_kkt.h
runtime/contacts  contacts/ core/core.h core/rhs.h kernels/ numeric/ lag.h lag_model.h
runtime/methods   methods/ core/rhs.h kernels/ numeric/ lag.h lag_model.h lag_math.h lag_support.h
runtime/lanes     lanes/ kernels/ numeric/ methods/adaptive_rk.h methods/taylor.h methods/verlet.h core/core.h lag.h lag_model.h lag_math.h
runtime/analysis  analysis/ core/ kernels/ numeric/ lag.h lag_model.h
runtime/evaluator evaluator/ numeric/ lag.h lag_model.h lag_math.h lag_support.h lag_tree.h lag_kkt.h
runtime/io        io/ app/options.def numeric/ lag.h lag_model.h
runtime/sweep     sweep/ lanes/lane_choice.h lanes/lane_runs.h analysis/measure.h io/posix.h io/csv_file.h numeric/ lag.h lag_model.h
runtime/app       app/ sweep/ core/ io/ analysis/ numeric/ lag.h lag_model.h
runtime/gsl       gsl/ lag.h lag_model.h
runtime/page      evaluator/evaluator.h lag.h
runtime/png       lag.h
runtime/hdf5      lag.h
runtime/mpi       lag.h
runtime/matlab    lag.h mex.h
'
# FILE: further headers that it may include.
besides='
runtime/include/lag.h  lag_libraries.h lag_method.h lag_model.h
runtime/include/lag_method.h  lag_model.h
runtime/include/lag_math.h  lag_lanes.h lag_sincos.h
runtime/include/lag_support.h  lag_lanes.h
runtime/include/lag_tree.h  lag_lanes.h
runtime/include/lag_band.h  lag_lanes.h
runtime/include/lag_kkt.h  lag_band.h lag_lanes.h
'
# The inside of a folder, shared by its own files only.
private='evaluator/bytes.h evaluator/program.h evaluator/read_program.h evaluator/evaluated_model.h analysis/measure_nodes.h sweep/run_chunks_impl.h syntax/ast_build.h syntax/parse_state.h syntax/token_filter.h syntax/scan.h syntax/token.h syntax/mistake_advice.h model/builder.h
  model/scope.h model/declarations.h sym/expr_impl.h sym/ops.def symmetry/noether_theorem_impl.h lower/lower_impl.h ir/nest_impl.h emit/header_impl.h emit/emit_impl.h fmu/fmu_archive_impl.h methods/tableau.h methods/embedded_trial.h lanes/embedded_step.h
  methods/steps.h methods/step_interpolant.h methods/discrete_lagrangian.h methods/implicit_symplectic.h
  methods/step_control.h'

# Every #include as `FILE HEADER`; <stdio.h> keeps its brackets.
list=$TMP/list
find src grammar runtime -name '*.[chly]' | LC_ALL=C sort | xargs awk '
  match($0, /^[ \t]*#[ \t]*include[ \t]*/) {
    header = substr($0, RLENGTH + 1)
    if (header ~ /^<[^>]*>/) sub(/>.*/, ">", header)
    else if (header ~ /^"[^"]*"/) { sub(/^"/, "", header); sub(/".*/, "", header) }
    else next
    print FILENAME, header
  }' >"$list"

# Files generated from lag.y and lag.l are included by src/syntax only.
empty "generated parser headers: src/syntax only" \
  "$(awk '$2 ~ /lag\.(tab|lex)\.[ch]>?$/ && $1 !~ /^src\/syntax\// { print $1 " includes " $2 }' "$list")"

empty "folders include only what lies before them" "$(awk -v allowed="$allowed" -v besides="$besides" '
  BEGIN {
    n = split(allowed, lines, "\n")
    for (i = 1; i <= n; i++) {
      k = split(lines[i], w, " ")
      for (j = 2; j <= k; j++) ok[w[1], w[j]] = 1
      if (k) known[w[1]] = 1
    }
    n = split(besides, lines, "\n")
    for (i = 1; i <= n; i++) {
      k = split(lines[i], w, " ")
      for (j = 2; j <= k; j++) ok[w[1], w[j]] = 1
    }
  }
  $2 ~ /^</ || $2 ~ /^lag\.(tab|lex)\.[ch]$/ { next }
  {
    folder = $1; sub(/\/[^\/]*$/, "", folder)
    where = $2; if (!sub(/\/.*/, "/", where)) where = $2
    if (ok[folder, where] || ok[folder, $2] || ok[$1, $2]) next
    print $1 " includes " $2 (known[folder] || folder ~ /include$/ ? "" : " (a folder without a rule)")
  }' "$list")"

# self_check/ reads the meanings of names from the declarations of the model that it compares; nothing behind model/ sees its Builder.
empty "the inside of a folder stays inside" "$(awk -v private="$private" '
  BEGIN { n = split(private, w); for (i = 1; i <= n; i++) inside[w[i]] = 1 }
  inside[$2] && $1 !~ /^grammar\// {
    home = $2; sub(/\/.*/, "", home)
    folder = $1; sub(/\/[^\/]*$/, "", folder); sub(/.*\//, "", folder)
    if (folder != home && !(folder == "self_check" && $2 == "model/declarations.h")) print $1 " includes " $2
  }' "$list")"

# Circles: an edge from each module to each that it includes, where X.c, X.h and X_impl.h are one module; tsort names the circles that it finds.
empty "no circles between files, but for a header and its implementation" "$(awk '
  $2 ~ /^[<]/ { next }
  {
    from = $1; sub(/^(src|runtime\/include|runtime|grammar)\//, "", from); sub(/(_impl)?\.[a-z]+$/, "", from)
    to = $2; sub(/(_impl)?\.[a-z]+$/, "", to)
    if (from != to) print from, to
  }' "$list" | tsort 2>&1 >/dev/null)"

empty "GSL: runtime/gsl only" "$(awk '$2 ~ /gsl/ && $1 !~ /^runtime\/gsl\// { print $1 " includes " $2 }' "$list")"

empty "librsvg and cairo: runtime/png only" "$(awk '$2 ~ /rsvg|cairo/ && $1 !~ /^runtime\/png\// { print $1 " includes " $2 }' "$list")"
empty "HDF5: runtime/hdf5 only" "$(awk '$2 ~ /hdf5/ && $1 !~ /^runtime\/hdf5\// { print $1 " includes " $2 }' "$list")"

empty "MPI: runtime/mpi only" "$(awk '$2 == "<mpi.h>" && $1 !~ /^runtime\/mpi\// { print $1 " includes " $2 }' "$list")"

empty "minizip: src/fmu/zip.c only" "$(awk '$2 ~ /minizip|zlib/ && $1 != "src/fmu/zip.c" { print $1 " includes " $2 }' "$list")"

empty "liblzma: src/commands/pack.c only" "$(awk '$2 == "<lzma.h>" && $1 != "src/commands/pack.c" { print $1 " includes " $2 }' "$list")"

empty "lag_model.h includes only <stddef.h>" \
  "$(awk '$1 == "runtime/include/lag_model.h" && $2 != "<stddef.h>" { print $1 " includes " $2 }' "$list")"

# ISO C11 everywhere; POSIX where a program meets its system.
c11='assert complex ctype errno fenv float inttypes iso646 limits locale math setjmp signal stdalign stdarg stdatomic
  stdbool stddef stdint stdio stdlib stdnoreturn string tgmath threads time uchar wchar wctype'
posix='src/base/source_file\.c src/toolchain/.*\.c runtime/app/.*\.c runtime/io/.*\.[ch] runtime/sweep/.*\.c runtime/evaluator/lag_run\.c runtime/numeric/clock_windows\.c runtime/matlab/.*\.c'
empty "system headers: ISO C11; POSIX in base/source_file, toolchain, runtime/app, io, sweep and matlab" "$(awk -v c11="$c11" -v posix="$posix" '
  BEGIN {
    n = split(c11, w); for (i = 1; i <= n; i++) standard["<" w[i] ".h>"] = 1
    m = split(posix, where)
  }
  $2 ~ /^</ && $2 !~ /gsl|minizip|zlib|<lzma.h>|rsvg|cairo|hdf5|<mpi.h>/ && !standard[$2] {
    for (i = 1; i <= m; i++) if ($1 ~ "^" where[i] "$") next
    if ($1 == "runtime/include/lag_lanes.h" && $2 ~ /omp|sched/) next # with OpenMP alone
    print $1 " includes " $2
  }' "$list")"

empty "no folder above: \"../\" in no #include" "$(awk '$2 ~ /\.\./ { print $1 " includes " $2 }' "$list")"

# ---- headers compile alone ----
alone() {
  for h in $(find "$1" -name "*.h" ! -name embedded_step.h ! -name embedded_trial.h ! -name contact_step.h ! -name coupled_friction.h ! -name galerkin_step.h ! -name joint_friction.h \
    ! -name moreau_step.h ! -name slipping_forces.h | LC_ALL=C sort); do # these stand behind an instance's definitions
    shift_flags=$2
    # shellcheck disable=SC2086 # flags
    $3 $shift_flags -fsyntax-only -Wall -Wextra -Werror -include "$h" -x "$4" /dev/null || echo "$h"
  done 2>&1
}
alone_empty() { empty "$1" "$(alone "$2" "$3" "$4" "$5")"; }
slow alone_empty "headers of the compiler compile alone" src "-std=c11 -D_POSIX_C_SOURCE=200809L -Isrc -Iruntime -I$BUILD/gen" "$CC" c
slow alone_empty "headers of the runtime compile alone" runtime "-std=c11 -Wno-psabi -D_POSIX_C_SOURCE=200809L -Iruntime/include -Iruntime" "$CC" c
if [ -n "$CXX" ]; then
  empty "the public headers are C++ too" "$(alone runtime/include "-std=c++11 -Iruntime/include" "$CXX" c++)"
else
  skip "the public headers are C++ too" "no C++ compiler"
fi

# ---- emitted code: a model needs lag_model.h, <math.h> and the headers of its functions; a header only <math.h> ----
includes_of() {
  for m in models/*.lag; do
    one_of 4 && { [ "$1" != header ] || has_header "$m"; } || continue
    # shellcheck disable=SC2086 # some words
    "$LAGC" $1 "$m" -o "$TMP/emitted" 2>/dev/null || echo "lagc $1 $m: exit status $?"
    sed -n 's/^[ \t]*#[ \t]*include[ \t]*//p' "$TMP/emitted" | grep -v -x -e "$2" | sed "s|^|lagc $1 $m includes |"
  done 2>&1
}
if [ -x "$LAGC" ] && ls models/*.lag >/dev/null 2>&1; then
  empty "lagc emit: lag_model.h, <math.h> and headers of functions" \
    "$(includes_of emit '"lag_model.h"\|<math.h>\|"lag_\(lanes\|math\|support\|kkt\).h"')"
  empty "lagc emit --standalone: lag_model.h and <math.h>; with OpenMP, what threads need" \
    "$(includes_of "emit --standalone" '"lag_model.h"\|<math.h>\|<omp.h>\|<sched.h>')"
  empty "lagc header: <math.h>" "$(includes_of header '<math.h>')"
fi
# A name is found by `find -name` and in a message of the compiler.
empty "no two files of one name" "$(git ls-files 'src/*.[ch]' 'runtime/*.[ch]' 2>/dev/null | sed 's|.*/||' | sort | uniq -d)"

tap_end
