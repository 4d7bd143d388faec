/* The reference motion of `lagc cost`: a child process builds a simulator with more digits and runs it, while the
 * caller builds the one that is measured. Errors of both grow alike along the motion, so long doubles leave it 2000
 * times more accurate than the best run in doubles. A whole reference is kept in the cache, by simulator, scene,
 * values and end; one that time has cut short is not. */
#include "commands/cost_reference.h"

#include <stdio.h>
#include <string.h>

#include "base/hash.h"
#include "commands/command_table.h"
#include "toolchain/simulator_cache.h"
#include "toolchain/outfile.h"
#include "toolchain/process.h"

typedef VEC(char *) Words;

/* The simulator's arguments: the scene, name=value and --until of the command line. Returns 0 if
 * none is needed: --against gives one. */
static int reference_words(Compiler *c, double seconds, Words *argv) {
  vec_push(c->arena, argv, c->picture.argv.at[0]);
  vec_push(c->arena, argv, arena_strdup(c->arena, "--reference"));
  for (uint32_t i = 0; i < c->o.rest.n; i++)
    if (strcmp(c->o.rest.at[i], "--against") == 0 || strncmp(c->o.rest.at[i], "--against=", 10) == 0) return 0;
  if (c->picture.error && strcmp(c->picture.error, "residual") == 0) return 0;
  OptionTexts words = simulator_values(c);
  for (uint32_t i = 0; i < words.n; i++) vec_push(c->arena, argv, arena_strdup(c->arena, words.at[i]));
  if (c->picture.error) {
    vec_push(c->arena, argv, arena_strdup(c->arena, "--error"));
    vec_push(c->arena, argv, arena_strdup(c->arena, c->picture.error));
  }
  vec_push(c->arena, argv, arena_strdup(c->arena, "--seconds"));
  vec_push(c->arena, argv, arena_printf(c->arena, "%g", seconds));
  vec_push(c->arena, argv, NULL);
  return 1;
}

/* The cache's file for what this simulator prints with these words, --seconds apart. */
static const char *cached_path(Arena *a, const char *simulator, const Words *argv) {
  uint64_t h = lag_fnv1a(LAG_FNV1A_START, simulator, strlen(simulator) + 1);
  for (uint32_t i = 0; i + 3 < argv->n; i++) h = lag_fnv1a(h, argv->at[i], strlen(argv->at[i]) + 1);
  return arena_printf(a, "%s.%08x", simulator, (unsigned)(h ^ h >> 32));
}

/* Copies all but the last `seal` bytes, fewer than a buffer has. */
static int copy(FILE *from, FILE *to, size_t seal) {
  char buffer[4096];
  size_t n, kept = 0;
  while ((n = fread(buffer + kept, 1, sizeof buffer - kept, from)) > 0) {
    n += kept;
    kept = n < seal ? n : seal;
    if (fwrite(buffer, 1, n - kept, to) != n - kept) return 0;
    memmove(buffer, buffer + n - kept, kept);
  }
  return !ferror(from);
}

static int copy_of_cached(const char *path, FILE *out) {
  FILE *f = cache_has_data(path) ? fopen(path, "r") : NULL;
  int ok = f && copy(f, out, CACHE_SEAL) && fflush(out) == 0;
  if (f) fclose(f);
  return ok;
}

static void keep(Arena *a, const char *path, FILE *out) {
  Outfile o;
  if (fseek(out, 0, SEEK_SET) != 0 || lag_outfile_open(&o, path) != 0) return;
  int whole = copy(out, o.f, 0) && fflush(o.f) == 0 && cache_seal(o.part);
  if (lag_outfile_close(&o, whole ? OUTFILE_KEEP : OUTFILE_DROP) == 0) cache_limit(a, path);
}

/* Appends what quadruple precision costs: the line `precision quad` of a reference by such a simulator, with a
 * second at most. Models that take long to compile have none. */
static void add_quad(Compiler *c, const Units *units, const Words *argv, FILE *out) {
  enum { MOST = 12, ROOM = 256 };
  char line[ROOM];
  const char *simulator = c->run_by && c->run->n + c->run->m->states.n > MOST ? NULL : simulator_quad(c, units);
  FILE *f = simulator ? tmpfile() : NULL;
  if (!f) return;
  argv->at[argv->n - 2] = arena_strdup(c->arena, "1"); /* --seconds */
  process_to_file(simulator, argv->at, f);
  rewind(f);
  fseek(out, 0, SEEK_END);
  while (fgets(line, sizeof line, f))
    if (strncmp(line, "precision quad ", 15) == 0) fputs(line, out);
  fclose(f);
  fflush(out);
}

/* Prints the reference to `out`. Returns the simulator's exit status. */
static int print_reference(Compiler *c, const Words *argv, FILE *out) {
  Units units = {0};
  c->o.command = CMD_BUILD; /* a simulator for one method: derivatives of others would take long to compile */
  c->o.method = "taylor";
  const char *simulator = simulator_lower(c, &units) ? simulator_precise(c, &units) : NULL;
  if (!simulator) return 1;
  const char *path = cached_path(c->arena, simulator, argv);
  if (copy_of_cached(path, out)) return 0;
  int status = process_to_file(simulator, argv->at, out);
  if (status == 0) add_quad(c, &units, argv, out);
  if (status == 0) keep(c->arena, path, out);
  return status;
}

typedef struct {
  Compiler *c;
  Words argv;
  FILE *out;
} ReferenceWork;

static int work_of_child(void *work) {
  ReferenceWork *w = work;
  return print_reference(w->c, &w->argv, w->out);
}

void cost_reference_begin(Compiler *c, double seconds, CostReference *r) {
  ReferenceWork w = {.c = c};
  *r = (CostReference){0};
  if (c->picture.argv.n < 2 || !reference_words(c, seconds, &w.argv)) return;
  r->out = w.out = tmpfile();
  r->process = r->out ? process_begin(work_of_child, &w) : -1;
  if (r->process > 0 || !r->out) return;
  fclose(r->out);
  r->out = NULL;
}

int cost_reference_end(CostReference *r, double seconds) {
  enum { CUT_SHORT = 3 };
  if (!r->out) return 0;
  int status = process_end(r->process, seconds),
      given = (status == 0 || status == CUT_SHORT) && process_read_from(r->out);
  fclose(r->out);
  return given;
}
