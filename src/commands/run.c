/* `lagc run`, `plot`, `animate`, `modes`, `lyapunov`, `cost`: the simulator in the cache, started with what the
 * command line says. */
#include "commands/commands.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "commands/budget.h"
#include "commands/command_table.h"
#include "commands/cost_reference.h"
#include "commands/known_run.h"
#include "commands/simulator.h"
#include "toolchain/simulator_cache.h"

static double seconds_now(void) {
  struct timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  return (double)now.tv_sec + 1e-9*(double)now.tv_nsec;
}

/* simulator_of_units for `lagc cost`. Says so before it compiles if that leaves under a third of the time asked. */
static int build_cost_simulator(Compiler *c, const Units *units, double asked, double used, const char **path) {
  const double bytes_a_second = 80e3; /* of C by gcc 12 -O2 at 3 GHz */
  Toolchain tools;
  ProgramKind kind;
  int status = simulator_tools(c, units, NULL, &tools, &kind);
  if (status != STATUS_OK) return status;
  Texts texts = simulator_texts(c, units, kind);
  const char *cache = cache_folder(c->arena);
  double seconds = 0;
  for (uint32_t i = 0; i < texts.n; i++) seconds += (double)strlen(texts.at[i].text) / bytes_a_second;
  const char *entry = toolchain_entry(c->arena, &tools, texts.at, texts.n);
  int there = cache && cache_has(arena_printf(c->arena, "%s/%s", cache, entry));
  if (!there && used + seconds > asked * 2 / 3 && !options_pass_flag(&c->o, "--quiet"))
    fprintf(stderr,
            "lagc cost: the model is compiled first, which takes about %.0f s; the times are measured then, in %.2g s "
            "more (--seconds %g). A second call takes the compiled model from the cache\n",
            ceil(seconds), asked / 3, asked);
  return simulator_make(c, &tools, &texts, NULL, path);
}

/* Makes the simulator of `lagc cost`, beside it the reference where three fifths of the time, or a fifth after the
 * build, suffice, and tells it how much is left: at least a third. */
static int make_cost_simulator(Compiler *c, const Units *units, double begin, const char **path) {
  double asked = c->o.seconds ? strtod(c->o.seconds, NULL) : 10;
  CostReference reference;
  cost_reference_begin(c, 0.4*asked, &reference);
  int status = build_cost_simulator(c, units, asked, seconds_now() - begin, path),
      given = cost_reference_end(&reference, fmax(0.6 * asked - (seconds_now() - begin), 0.2 * asked));
  double left = asked - (seconds_now() - begin);
  c->picture.argv.n--; /* the NULL at the end */
  vec_push(c->arena, &c->picture.argv, arena_strdup(c->arena, "--seconds"));
  vec_push(c->arena, &c->picture.argv,
           !(asked > 0) ? arena_strdup(c->arena, c->o.seconds)
                        : arena_printf(c->arena, "%.3g", left > asked / 3 ? left : asked / 3));
  if (c->given_words[0]) {
    vec_push(c->arena, &c->picture.argv, arena_strdup(c->arena, "--given"));
    vec_push(c->arena, &c->picture.argv, arena_strdup(c->arena, c->given_words));
  }
  if (given) {
    vec_push(c->arena, &c->picture.argv, arena_strdup(c->arena, "--against"));
    vec_push(c->arena, &c->picture.argv, arena_strdup(c->arena, "-"));
  }
  vec_push(c->arena, &c->picture.argv, NULL);
  return status;
}

/* "drawn by guess: 2 rods, ball at x1, y1, ball at x2, y2; ..." */
static const char *drawing_words(Arena *a, const Scene *sc) {
  enum { MOST = 4 };
  StrBuf s = strbuf(a);
  sb_puts(&s, "guessed drawing:");
  for (uint32_t i = 0, n = 0; i < sc->shapes.n && n <= MOST; i++, n++) {
    const Shape *x = &sc->shapes.at[i];
    if (n == MOST) sb_printf(&s, ", ... (%u shapes)", sc->shapes.n);
    else sb_printf(&s, "%s %s%s%s", n ? "," : "", shape_word(x->kind), x->text ? " at " : "", x->text ? x->text : "");
  }
  sb_puts(&s, "; `draw` statements in the model, or --points 'X,Y X,Y', say otherwise");
  return sb_text(&s);
}

/* Whether there is something to draw; says so where it was guessed, or not. */
static int has_drawing(Compiler *c) {
  const Scene *sc = &c->run->m->scene;
  if (!c->picture.drawing) return 1;
  if (!sc->shapes.n)
    return usage_error("nothing to draw: the model has no `draw`, no x,y, no x1,y1 x2,y2 ... and no vector among its "
                       "coordinates; write `draw ball at (X, Y)` in it, or --points 'X,Y X,Y'"), 0;
  if (sc->guessed && !c->picture.note && !options_pass_flag(&c->o, "--quiet"))
    c->picture.note = drawing_words(c->arena, sc);
  return 1;
}

/* run, plot, animate, modes, lyapunov, cost: builds the simulator and becomes it by exec. */
int command_run(Compiler *c) {
  const char *path;
  double begin = seconds_now();
  int status = simulator_prepare(c);
  if (status != STATUS_OK) return status;
  if (c->o.budget) return cost_budget(c);
  Units units = {0};
  if (!simulator_lower(c, &units)) return STATUS_MODEL;
  if (!has_drawing(c)) return STATUS_USAGE;
  EvaluatedRun e;
  status = simulator_evaluate(c, &units, &e);
  if (status != STATUS_OK) return status;
  if (e.evaluator) return known_run_evaluate(c, &e, &units);
  status = c->o.command == CMD_COST ? make_cost_simulator(c, &units, begin, &path)
                                    : simulator_of_units(c, &units, NULL, &path);
  return status == STATUS_OK ? known_run_keep_and_start(c, path) : status;
}
