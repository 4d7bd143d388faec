/* Runs that begin at once: lag-run evaluates the programs as bytes. What runs longer is compiled beside it, as a
 * library that lag-run then changes over to, and that the cache keeps. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "commands/simulator.h"
#include "toolchain/process.h"
#include "toolchain/simulator_cache.h"

/* The reason why the run must be compiled; NULL: liblag can evaluate it. */
static const char *reason_to_compile(Compiler *c, const Toolchain *tools, ProgramKind kind) {
  if (kind & PROGRAM_WITH_PNG) return "has no pictures as PNG: give a name with .svg";
  if (kind & PROGRAM_WITH_HDF5) return "writes no HDF5: give a name with .csv or .npy";
  if (kind & PROGRAM_WITH_MPI) return "runs in one process: leave out --mpi and mpirun";
  if (tools->threads) return "computes in one thread: leave out --threads";
  return toolchain_evaluator(c->arena, tools) ? NULL : "needs lag-run beside liblag.a: run `make`";
}

/* The same program as a library for lag-run. */
typedef struct {
  Arena *arena;
  Toolchain tools;
  Texts texts;
} ModelLibrary;

static ModelLibrary library_of(Compiler *c, const Units *units, const Toolchain *tools) {
  ModelLibrary m = {c->arena, *tools, simulator_texts(c, units, PROGRAM_LIBRARY)};
  m.tools.soname = "model.so";
  m.tools.models = 1;
  m.tools.library = NULL;
  m.tools.gsl = 0;
  return m;
}

int simulator_derive_again(Compiler *c, Units *units) {
  c->picture = (RunRequest){0};
  return compiler_parse(c) == STATUS_OK && simulator_prepare(c) == STATUS_OK && simulator_lower(c, units);
}

typedef struct {
  Compiler *c;
  Units units; /* none: the run is known, and derived only now */
  Toolchain tools;
} Beside;

/* Compiles if the run goes on for a while, and tells lag-run the library's path. */
static void compile_beside(void *data, int run) {
  const double a_while = 0.5;
  Beside *b = data;
  const char *error;
  if (process_reader_ends(run, a_while)) return;
  if (!b->units.n && !simulator_derive_again(b->c, &b->units)) return;
  ModelLibrary m = library_of(b->c, &b->units, &b->tools);
  const char *path = toolchain_simulator(m.arena, &m.tools, m.texts.at, m.texts.n, &error);
  if (path) process_tell(run, path);
}

static const char *in_cache(Compiler *c, const char *name) {
  const char *cache = name ? cache_folder(c->arena) : NULL;
  const char *path = cache ? arena_printf(c->arena, "%s/%s", cache, name) : NULL;
  return path && cache_has(path) ? path : NULL;
}

const char *simulator_compiled(Compiler *c, const EvaluatedRun *e) { return in_cache(c, e->simulator); }

static void say_no_compiler(const Toolchain *tools, const char *how) {
  fprintf(stderr, "lagc: there is no C compiler `%s`: %s\n", tools->cc, how);
}

int simulator_hand_over(Compiler *c, const EvaluatedRun *e, const Units *units) {
  Beside b = {.c = c};
  const char *error, *library = in_cache(c, e->library);
  if (c->o.no_gsl) process_set("LAG_NO_GSL", "1");
  if (library) process_set("LAG_LIBRARY", library);
  int given = process_give("LAG_PROGRAM", &e->bytes);
  if (!given && !library) return usage_error("cannot write a temporary file: set TMPDIR");
  if (library || !e->library) return STATUS_OK;
  if (!toolchain_find(c->arena, c->argv0, 0, &b.tools, &error)) return usage_error(error);
  if (units) b.units = *units;
  if (toolchain_has_compiler(c->arena, &b.tools)) process_beside(compile_beside, &b, "LAG_COMPILED");
  else
    say_no_compiler(&b.tools,
                    "the model is evaluated, with the same digits, long runs at a third to a half of the speed");
  return STATUS_OK;
}

/* Whether `--compile` has this value; auto is its default. */
static int compiles(const Compiler *c, const char *how) {
  return strcmp(c->o.compile ? c->o.compile : "auto", how) == 0;
}

const char *simulator_evaluator(Compiler *c, const Toolchain *tools) {
  return compiles(c, "always") || options_more_digits(&c->o) ? NULL : toolchain_evaluator(c->arena, tools);
}

/* Whether the shortest run, with its second run and its sizes of rounding, takes longer to evaluate than to compile:
 * programs of so many operations are loops, which vectors run. */
static int is_long_from_start(const Units *units) {
  const uint64_t many = 5000000; /* 200 times 5e6 operations at 0.3 ns each: a compiler takes 0.3 s */
  uint64_t most = 0;
  for (uint32_t i = 0; i < units->n; i++) {
    uint64_t ops = ops_total(prog_count(units->at[i]->accel));
    most = ops > most ? ops : most;
  }
  return most >= many;
}

int simulator_evaluate(Compiler *c, const Units *units, EvaluatedRun *e) {
  int never = compiles(c, "never"), digits = options_more_digits(&c->o), sweeps = c->o.command == CMD_SWEEP;
  Toolchain tools;
  ProgramKind kind;
  *e = (EvaluatedRun){.bytes = strbuf(c->arena)};
  if (compiles(c, "always") || c->o.command == CMD_COST) return STATUS_OK;
  if (digits) return never ? usage_error("--compile never evaluates doubles only: leave --precision out") : STATUS_OK;
  int status = simulator_tools(c, units, NULL, &tools, &kind);
  const char *reason = status == STATUS_OK ? reason_to_compile(c, &tools, kind) : NULL;
  if (reason && never) return usage_error(arena_printf(c->arena, "--compile never %s", reason));
  if (reason || status != STATUS_OK) return status;
  if (!never && (sweeps || is_long_from_start(units)) && toolchain_has_compiler(c->arena, &tools)) return STATUS_OK;
  if (!never) {
    Texts texts = simulator_texts(c, units, kind);
    ModelLibrary m = library_of(c, units, &tools);
    e->simulator = toolchain_entry(c->arena, &tools, texts.at, texts.n);
    e->library = toolchain_entry(c->arena, &m.tools, m.texts.at, m.texts.n);
    if (strchr(tools.cc, ' ')) e->simulator = NULL; /* with its options sines may be fused: other bits */
    if (in_cache(c, e->simulator)) return STATUS_OK;
  }
  if (sweeps && !never) {
    e->simulator = e->library = NULL; /* nothing is compiled beside its many runs */
    say_no_compiler(&tools, "the runs are evaluated one by one, with the digits of `lagc run`, not in vector lanes");
  }
  e->evaluator = toolchain_evaluator(c->arena, &tools);
  e->bytes = simulator_bytes(c, units);
  return STATUS_OK;
}
