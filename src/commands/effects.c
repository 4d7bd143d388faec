/* `lagc effects`: plans which sets of effects are compared with a scene's own set, runs one simulator of these variants, judges the measurements,
 * and searches the smallest sufficient set.
 *
 * A variant is the scene with another set of effects; a run of the program of variants measures them (runtime/app/effects.c). An effect is left
 * out together with those that require it, and added together with what it requires. */
#include "commands/commands.h"

#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "commands/simulator.h"
#include "ir/unit.h"
#include "lower/lower.h"
#include "model/effect.h"
#include "model/model.h"
#include "toolchain/process.h"

typedef uint64_t EffectSet; /* bit i: effect i of the file, in order of text */
enum { MOST_EFFECTS = 64, MOST_SEARCHED = 10 };

typedef VEC(EffectSet) EffectSets;

/* Measurements of one variant. */
typedef struct {
  int ops;
  double time, difference, weight; /* time of a call [s]; the others: runtime/analysis/effect_variants.h; NaN: not measured */
  const char *why;                 /* why its run failed, or NULL */
} EffectMeasurement;

/* One effect. The variants upper and lower differ by this effect alone; the variant apart is compared with the scene. */
typedef struct {
  uint32_t effect;
  int on;
  uint32_t upper, lower, apart;
  EffectSet together; /* effects left out, or added, with it */
  Name excluded_by;   /* effect of the scene that excludes it, so that nothing is measured; or NULL */
} EffectRow;

typedef struct {
  Arena *arena;
  const Ast *ast;
  EffectGraph graph;
  const Model *scene;
  EffectSet used;
  EffectSets variants; /* the first is the scene's own set */
  uint32_t base;       /* variant of the empty set */
  VEC(EffectRow) rows;

  const char *method;
  double span, error; /* length of the run [s]; error of integration, NaN: not known */
  EffectMeasurement *measured; /* [variants.n] */

  double accuracy;    /* --accuracy; 0: not given */
  EffectSet least;    /* smallest set within the accuracy */
  double least_difference;
  uint32_t tried;     /* number of sets that were run */
} EffectStudy;

/* --- sets --- */

static EffectSet one(uint32_t i) { return (EffectSet)1 << i; }

static uint32_t count(EffectSet set) {
  uint32_t n = 0;
  for (; set; set &= set - 1) n++;
  return n;
}

/* The effect and all effects that it requires, directly or not (up: all that require it). */
static EffectSet closure_of(const EffectStudy *s, uint32_t effect, int up) {
  uint8_t *in = ARENA_ARRAY(s->arena, uint8_t, s->graph.n);
  EffectSet set = 0;
  effect_reach(s->ast, &s->graph, effect, up, in);
  for (uint32_t i = 0; i < s->graph.n; i++) set |= in[i] ? one(i) : 0;
  return set;
}

static EffectList effects_of(const EffectStudy *s, EffectSet set) {
  VEC(Name) names = {0};
  for (uint32_t i = 0; i < s->graph.n; i++)
    if (set & one(i)) vec_push(s->arena, &names, s->graph.at[i].stmt->name);
  return (EffectList){names.at, names.n};
}

/* Whether the set contains the requirements of each of its effects. */
static int meets_requirements(const EffectStudy *s, EffectSet set) {
  for (uint32_t i = 0; i < s->graph.n; i++)
    for (uint32_t k = 0; set & one(i) && k < s->graph.at[i].requires.n; k++)
      if (!(set & one(s->graph.at[i].requires.at[k]))) return 0;
  return 1;
}

/* Finds two effects of the set that exclude each other, and returns the one that the scene uses; NULL: no conflict. */
static Name excluding_effect(const EffectStudy *s, EffectSet set) {
  for (uint32_t i = 0; i < s->graph.n; i++)
    for (uint32_t k = 0; set & one(i) && k < s->graph.at[i].excludes.n; k++) {
      uint32_t other = s->graph.at[i].excludes.at[k];
      if (set & one(other)) return s->graph.at[s->used & one(other) ? other : i].stmt->name;
    }
  return NULL;
}

/* --- variants --- */

static uint32_t variant(EffectStudy *s, EffectSet set) {
  for (uint32_t i = 0; i < s->variants.n; i++)
    if (s->variants.at[i] == set) return i;
  vec_push(s->arena, &s->variants, set);
  return s->variants.n - 1;
}

static void plan_row(EffectStudy *s, uint32_t effect) {
  EffectRow row = {.effect = effect, .on = (s->used & one(effect)) != 0};
  if (row.on) {
    EffectSet gone = closure_of(s, effect, 1) & s->used;
    row.together = gone & ~one(effect);
    row.upper = variant(s, s->used & ~row.together);
    row.lower = row.apart = variant(s, s->used & ~gone);
  } else {
    EffectSet added = closure_of(s, effect, 0) & ~s->used;
    row.together = added & ~one(effect);
    row.excluded_by = excluding_effect(s, s->used | added);
    row.upper = row.apart = row.excluded_by ? 0 : variant(s, s->used | added);
    row.lower = row.excluded_by ? 0 : variant(s, (s->used | added) & ~one(effect));
  }
  vec_push(s->arena, &s->rows, row);
}

/* Plans the study of a scene's model. NULL, with a diagnostic, when there are no effects, or too many. */
static EffectStudy *plan_study(const Model *scene) {
  EffectStudy *s = ARENA_NEW(scene->arena, EffectStudy);
  *s = (EffectStudy){.arena = scene->arena, .ast = scene->ast, .graph = effect_graph(scene->ast), .scene = scene, .error = NAN};
  if (!s->graph.n || s->graph.n > MOST_EFFECTS) {
    diag_error(scene->diags, scene->span, s->graph.n ? "the model has %u effects; `lagc effects` compares up to %d" : "the model has no effects to compare",
               s->graph.n, MOST_EFFECTS);
    diag_help(scene->diags, "declare an effect with `effect drag { ... }`, and turn it on with `use drag` in a scene");
    return NULL;
  }
  for (uint32_t i = 0; i < s->graph.n; i++)
    for (uint32_t k = 0; k < scene->effects.n; k++)
      if (scene->effects.at[k] == s->graph.at[i].stmt->name) s->used |= one(i);
  variant(s, s->used);
  s->base = variant(s, 0);
  for (uint32_t i = 0; i < s->graph.n; i++)
    if (s->used & one(i)) plan_row(s, i);
  for (uint32_t i = 0; i < s->graph.n; i++)
    if (!(s->used & one(i))) plan_row(s, i);
  return s;
}

/* --- measurements --- */

/* The text after `word` and a space at the beginning of the line; NULL: the line begins otherwise. */
static char *text_after(char *line, const char *word) {
  size_t n = strlen(word);
  return strncmp(line, word, n) == 0 && line[n] == ' ' ? line + n + 1 : NULL;
}

static int read_variant(char *text, EffectMeasurement *m, uint32_t n) {
  char *at = text;
  unsigned long i = strtoul(at, &at, 10);
  if (i >= n) return 0;
  m[i].ops = (int)strtol(at, &at, 10);
  m[i].time = strtod(at, &at);
  m[i].difference = strtod(at, &at);
  m[i].weight = strtod(at, &at);
  return 1;
}

/* Parses the output of a run of n variants; lines that are no measurements go to *rest. NULL: fewer than n were measured. */
static EffectMeasurement *read_measurements(EffectStudy *s, char *said, uint32_t n, const char **rest) {
  EffectMeasurement *m = ARENA_ARRAY(s->arena, EffectMeasurement, n);
  StrBuf other = strbuf(s->arena);
  uint32_t found = 0;
  for (char *line = said, *next; line && *line; line = next) {
    char *end = strchr(line, '\n'), *text;
    next = end ? end + 1 : NULL;
    if (end) *end = '\0';
    if ((text = text_after(line, "variant")) != NULL) found += (uint32_t)read_variant(text, m, n);
    else if ((text = text_after(line, "failed")) != NULL) {
      unsigned long i = strtoul(text, &text, 10);
      if (i < n) m[i].why = text + 1;
    }
    else if ((text = text_after(line, "method")) != NULL) s->method = text;
    else if ((text = text_after(line, "span")) != NULL) s->span = strtod(text, NULL);
    else if ((text = text_after(line, "error")) != NULL) s->error = strtod(text, NULL);
    else sb_printf(&other, "%s\n", line);
  }
  *rest = sb_text(&other);
  return found == n ? m : NULL;
}

/* A difference of two runs carries the error of each: hence twice. */
static double limit_of(const EffectStudy *s) { return s->accuracy > 0 ? s->accuracy : 2 * s->error; }

static const char *verdict_on(const EffectStudy *s, const EffectRow *row) {
  if (row->excluded_by) return "excluded";
  const EffectMeasurement *m = &s->measured[row->apart];
  int matters = m->why || !(m->difference <= limit_of(s));
  if (row->on) return matters ? "needed" : s->accuracy > 0 ? "below the accuracy" : "below the scene's accuracy";
  return matters ? "would matter" : "would not matter";
}

/* --- the smallest set --- */

/* Takes the set for the least so far if it meets the accuracy with fewer operations than the best one. */
static void keep_if_better(EffectStudy *s, EffectSet set, const EffectMeasurement *m, int *best_ops) {
  if (m->why || !(m->difference <= s->accuracy) || m->ops >= *best_ops) return;
  *best_ops = m->ops;
  s->least = set;
  s->least_difference = m->difference;
}

/* Adds all proper subsets of the scene's set that have k effects and contain their requirements. */
static void add_subsets(const EffectStudy *s, uint32_t k, EffectSets *sets) {
  for (EffectSet set = s->used; set; ) {
    set = (set - 1) & s->used; /* the next smaller subset */
    if (count(set) == k && meets_requirements(s, set)) vec_push(s->arena, sets, set);
  }
}

/* --- the `use` statement --- */

/* The `use` statement of the effect in the scene, or in the nearest scene along its chain of `like`; NULL: none. */
static const AstStmt *use_of(const EffectStudy *s, Name effect) {
  Name scene = s->scene->scene.name;
  for (uint32_t guard = 0; scene && guard < 1000; guard++) {
    const AstStmt *st = s->ast->first;
    while (st && !(st->kind == STMT_SCENE && st->name == scene)) st = st->next;
    scene = NULL;
    for (const AstStmt *x = st ? st->body : NULL; x; x = x->next) {
      if (x->kind == STMT_USE && x->name == effect) return x;
      if (x->kind == STMT_LIKE) scene = x->name;
    }
  }
  return NULL;
}

/* Appends the settings of a `use` statement as they were written: `(c = 2)` of `use drag(c = 2)`. */
static void add_values(const EffectStudy *s, const AstStmt *use, StrBuf *out) {
  if (!use || !use->body) return;
  const AstStmt *last = use->body;
  while (last->next) last = last->next;
  Place p = source_place(s->ast->sources, use->body->span.begin);
  if (!p.file) return;
  const char *from = p.file->text + (use->body->span.begin - p.file->base);
  sb_printf(out, "(%.*s)", (int)(last->span.end - use->body->span.begin), from);
}

/* The `use` statement of a set, with the scene's values: `use j2, drag(c = 2)`. */
static const char *use_statement(const EffectStudy *s, EffectSet set) {
  StrBuf b = strbuf(s->arena);
  EffectList names = effects_of(s, set);
  if (!names.n) return "use none";
  for (uint32_t i = 0; i < names.n; i++) {
    sb_printf(&b, "%s%s", i ? ", " : "use ", names.at[i]);
    add_values(s, use_of(s, names.at[i]), &b);
  }
  return sb_text(&b);
}

/* --- the report --- */

static Name name_of(const EffectStudy *s, const EffectRow *row) { return s->graph.at[row->effect].stmt->name; }

static int ops_of(const EffectStudy *s, const EffectRow *row) { return s->measured[row->upper].ops - s->measured[row->lower].ops; }

/* Operations as a fraction of the scene's right-hand side. */
static double operation_fraction(const EffectStudy *s, double part) { return part / s->measured[0].ops; }

static double time_share(const EffectStudy *s, const EffectRow *row) {
  return (s->measured[row->upper].time - s->measured[row->lower].time) / s->measured[0].time;
}

/* Operations common to several effects: the scene's, less the base's and each effect's own. */
static int shared_ops(const EffectStudy *s) {
  int ops = s->measured[0].ops - s->measured[s->base].ops;
  for (uint32_t i = 0; i < s->rows.n; i++)
    if (s->rows.at[i].on) ops -= ops_of(s, &s->rows.at[i]);
  return ops;
}

static const char *number(Arena *a, double x) { return isnan(x) ? "-" : isinf(x) ? "no number" : arena_printf(a, "%.2g", x); }

static const char *percent(Arena *a, double x) { return isfinite(x) ? arena_printf(a, "%.0f %%", 100 * x) : "-"; }

static const char *joined(const EffectStudy *s, EffectSet set) {
  StrBuf b = strbuf(s->arena);
  EffectList names = effects_of(s, set);
  for (uint32_t i = 0; i < names.n; i++) sb_printf(&b, "%s%s", i ? ", " : "", names.at[i]);
  return sb_text(&b);
}

static int name_width(const EffectStudy *s) {
  size_t width = strlen("shared");
  for (uint32_t i = 0; i < s->rows.n; i++) width = strlen(name_of(s, &s->rows.at[i])) > width ? strlen(name_of(s, &s->rows.at[i])) : width;
  return (int)width;
}

static void put_row(const EffectStudy *s, const EffectRow *row, int width, StrBuf *out) {
  Arena *a = s->arena;
  const char *sign = row->on ? "" : "+";
  sb_printf(out, "  %-*s  %-3s", width, name_of(s, row), row->on ? "on" : "off");
  if (row->excluded_by) {
    sb_printf(out, "  excluded by %s\n", row->excluded_by);
    return;
  }
  const EffectMeasurement *m = &s->measured[row->apart];
  sb_printf(out, " %6s %6s %6s  %9s %11s  %s", arena_printf(a, "%s%d", sign, ops_of(s, row)), percent(a, operation_fraction(s, ops_of(s, row))),
            percent(a, time_share(s, row)), number(a, m->weight), m->why ? "run fails" : number(a, m->difference), verdict_on(s, row));
  if (row->together) sb_printf(out, " (%s %s)", row->on ? "left out with" : "added with", joined(s, row->together));
  sb_putc(out, '\n');
}

static void put_total(const EffectStudy *s, const char *name, int ops, int width, StrBuf *out) {
  sb_printf(out, "  %-*s      %6d %6s", width, name, ops, percent(s->arena, operation_fraction(s, ops)));
}

static void put_failures(const EffectStudy *s, StrBuf *out) {
  for (uint32_t i = 0; i < s->rows.n; i++) {
    const EffectRow *row = &s->rows.at[i];
    if (!row->excluded_by && s->measured[row->apart].why)
      sb_printf(out, "%s %s the run fails: %s\n", row->on ? "without" : "with", name_of(s, row), s->measured[row->apart].why);
  }
}

static void put_least(const EffectStudy *s, StrBuf *out) {
  if (!(s->accuracy > 0)) return;
  if (s->least == s->used) {
    sb_printf(out, "no effect of the scene can be left out at an accuracy of %g: %u %s run\n", s->accuracy, s->tried,
              s->tried == 1 ? "other set was" : "other sets were");
    return;
  }
  EffectSet gone = s->used & ~s->least;
  sb_printf(out, "without %s the difference is %.2g, below %g, measured by runs; no smaller set is enough (%u %s run)\n  %s\n", joined(s, gone), s->least_difference,
            s->accuracy, s->tried, s->tried == 1 ? "set was" : "sets were", use_statement(s, s->least));
}

static void put_text(const EffectStudy *s, StrBuf *out) {
  int width = name_width(s);
  const EffectMeasurement *scene = &s->measured[0];
  sb_printf(out, "model %s, scene %s, %g s by %s\n", s->scene->name, s->scene->scene.name, s->span, s->method);
  sb_printf(out, "error of integration: %s\n\n", isnan(s->error) ? "not known" : number(s->arena, s->error));
  sb_printf(out, "  %-*s      %6s %6s %6s  %9s %11s\n", width, "effect", "ops", "", "time", "weight", "difference");
  for (uint32_t i = 0; i < s->rows.n; i++) put_row(s, &s->rows.at[i], width, out);
  put_total(s, "base", s->measured[s->base].ops, width, out);
  sb_printf(out, " %6s\n", percent(s->arena, s->measured[s->base].time / scene->time));
  if (s->used & (s->used - 1)) {
    put_total(s, "shared", shared_ops(s), width, out);
    sb_putc(out, '\n');
  }
  put_total(s, "scene", scene->ops, width, out);
  sb_printf(out, "         %.3g ns a call\n", scene->time * 1e9);
  put_failures(s, out);
  put_least(s, out);
}

/* --- JSON --- */

static void json_number(StrBuf *out, const char *name, double x) {
  char text[32];
  num_format_double(text, x);
  if (isfinite(x)) sb_printf(out, ", \"%s\": %s", name, text);
  else sb_printf(out, ", \"%s\": null", name);
}

static void json_text(StrBuf *out, const char *text) {
  sb_putc(out, '"');
  for (const char *c = text; *c; c++) {
    if (*c == '"' || *c == '\\') sb_putc(out, '\\');
    if ((unsigned char)*c < ' ') sb_printf(out, "\\u%04x", (unsigned)(unsigned char)*c);
    else sb_putc(out, *c);
  }
  sb_putc(out, '"');
}

static void json_names(const EffectStudy *s, EffectSet set, StrBuf *out) {
  EffectList names = effects_of(s, set);
  sb_putc(out, '[');
  for (uint32_t i = 0; i < names.n; i++) sb_printf(out, "%s\"%s\"", i ? ", " : "", names.at[i]);
  sb_putc(out, ']');
}

static void json_row(const EffectStudy *s, const EffectRow *row, StrBuf *out) {
  const EffectMeasurement *m = &s->measured[row->apart];
  sb_printf(out, "{\"name\": \"%s\", \"on\": %s, \"verdict\": \"%s\"", name_of(s, row), row->on ? "true" : "false", verdict_on(s, row));
  if (row->excluded_by) {
    sb_printf(out, ", \"excluded_by\": \"%s\"}", row->excluded_by);
    return;
  }
  sb_printf(out, ", \"operations\": %d", ops_of(s, row));
  json_number(out, "time_s", s->measured[row->upper].time - s->measured[row->lower].time);
  json_number(out, "weight", m->weight);
  json_number(out, "difference", m->difference);
  sb_puts(out, ", \"together_with\": ");
  json_names(s, row->together, out);
  if (m->why) {
    sb_puts(out, ", \"failed\": ");
    json_text(out, m->why);
  }
  sb_putc(out, '}');
}

static void put_json(const EffectStudy *s, StrBuf *out) {
  sb_printf(out, "{\"model\": \"%s\", \"scene\": \"%s\", \"method\": \"%s\"", s->scene->name, s->scene->scene.name, s->method);
  json_number(out, "span_s", s->span);
  json_number(out, "integration_error", s->error);
  json_number(out, "limit", limit_of(s));
  sb_printf(out, ", \"operations\": %d, \"base\": %d, \"shared\": %d", s->measured[0].ops, s->measured[s->base].ops, shared_ops(s));
  json_number(out, "time_s", s->measured[0].time);
  json_number(out, "base_time_s", s->measured[s->base].time);
  sb_puts(out, ", \"effects\": [");
  for (uint32_t i = 0; i < s->rows.n; i++) {
    if (i) sb_puts(out, ", ");
    json_row(s, &s->rows.at[i], out);
  }
  sb_putc(out, ']');
  if (s->accuracy > 0) {
    char accuracy[32];
    num_format_double(accuracy, s->accuracy);
    sb_printf(out, ", \"smallest\": {\"accuracy\": %s, \"effects\": ", accuracy);
    json_names(s, s->least, out);
    json_number(out, "difference", s->least_difference);
    sb_printf(out, ", \"sets_run\": %u, \"use\": ", s->tried);
    json_text(out, use_statement(s, s->least));
    sb_putc(out, '}');
  }
  sb_puts(out, "}\n");
}

/* --- the command --- */

/* The scene with another set of effects, as a unit of its own. */
static IrUnit *lower_variant(Compiler *c, EffectList effects, unsigned *wants) {
  Eqns *e = compiler_derive_wanted(c, &(ModelChoice){.scene = c->o.scene, .only = &effects, .given = c->given.at, .ngiven = c->given.n});
  if (!e) return NULL;
  IrUnit *u = compiler_new_unit(c, e);
  *wants |= derivatives_required(e, &c->o); /* all variants run by the method of the first */
  unit_require(u, e, *wants);
  unit_add_scene(u, e);
  unit_hoist(u);
  return compiler_agrees(e, u, 0) ? u : NULL;
}

/* Builds a program of these variants, runs it, and parses its measurements. */
static int run_variants(Compiler *c, EffectStudy *s, const EffectSets *sets, const char *what, EffectMeasurement **measured) {
  Toolchain tools;
  Units units = {0};
  unsigned wants = 0;
  const char *error = NULL, *path, *rest;
  char *said = NULL;
  for (uint32_t i = 0; i < sets->n; i++) {
    IrUnit *u = lower_variant(c, effects_of(s, sets->at[i]), &wants);
    if (!u) return STATUS_MODEL;
    vec_push(c->arena, &units, u);
  }
  if (!toolchain_find(c->arena, c->argv0, !c->o.no_gsl, &tools, &error)) return usage_error(error);
  if (strcmp(what, "runs") == 0) tools.optimise = "-O0"; /* same bits; compilation takes longer than the runs */
  Texts texts = simulator_texts(c, &units, tools.gsl);
  int status = simulator_make(c, &tools, &texts, NULL, &path);
  if (status != STATUS_OK) return status;
  char *const program = arena_strdup(c->arena, path), **argv = ARENA_ARRAY(c->arena, char *, c->picture.argv.n);
  memcpy(argv, c->picture.argv.at, c->picture.argv.n * sizeof *argv);
  argv[2] = arena_strdup(c->arena, what);
  status = process_run(c->arena, program, argv, &said);
  *measured = read_measurements(s, said, sets->n, &rest);
  fputs(rest, stderr);
  if (status == STATUS_OK && !*measured) return usage_error("the simulator of `lagc effects` printed no measurements");
  return status;
}

/* --accuracy: runs all sets of 0, 1, 2, ... effects that contain their requirements, beside the scene's own, until one meets the accuracy. */
static int find_least(Compiler *c, EffectStudy *s) {
  EffectMeasurement *measured = NULL;
  if (!num_parse_double(c->o.accuracy, &s->accuracy) || !(s->accuracy > 0)) return usage_error(arena_printf(c->arena, "--accuracy %s: a difference that does not matter, relative and positive; for example 1e-6", c->o.accuracy));
  if (!(s->error <= s->accuracy / 10)) {
    fprintf(stderr, "lagc: --accuracy %g: the error of integration, %.2g, is not well below it; add --tol with a smaller number, or --step\n", s->accuracy, s->error);
    return STATUS_RUN;
  }
  s->least = s->used;
  for (uint32_t k = 0, all = count(s->used); k < all && s->least == s->used; k++) {
    EffectSets sets = {0};
    int ops = INT_MAX, status;
    vec_push(c->arena, &sets, s->used);
    add_subsets(s, k, &sets);
    if (sets.n == 1) continue;
    if ((status = run_variants(c, s, &sets, "runs", &measured)) != STATUS_OK) return status;
    for (uint32_t i = 1; i < sets.n; i++) keep_if_better(s, sets.at[i], &measured[i], &ops);
    s->tried += sets.n - 1;
  }
  return STATUS_OK;
}

int command_effects(Compiler *c) {
  int status = simulator_prepare(c);
  Model *m = status == STATUS_OK ? model_build(c->ast, &(ModelChoice){.scene = c->o.scene, .defines = c->o.defines.at, .ndefines = c->o.defines.n}) : NULL;
  EffectStudy *s = m ? plan_study(m) : NULL;
  if (!s) return status == STATUS_OK ? STATUS_MODEL : status;
  if (c->o.accuracy && count(s->used) > MOST_SEARCHED)
    return usage_error(arena_printf(c->arena, "--accuracy: the scene has %u effects; all sets of up to %d are searched: leave some out", count(s->used), MOST_SEARCHED));
  status = run_variants(c, s, &s->variants, "report", &s->measured);
  if (status == STATUS_OK && c->o.accuracy) status = find_least(c, s);
  if (status != STATUS_OK) return status;
  StrBuf out = strbuf(c->arena);
  if (c->o.json) put_json(s, &out);
  else put_text(s, &out);
  return compiler_write(c, NULL, &out);
}
