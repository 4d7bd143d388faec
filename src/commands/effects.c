/* `lagc effects`: runs one simulator of a scene's variants (effect_study.h), and judges and reports its
 * measurements. */
#include "commands/commands.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "commands/effect_study.h"
#include "commands/simulator.h"

/* A difference of two runs carries the error of each: hence twice. */
static double limit_of(const EffectStudy *s) { return s->accuracy > 0 ? s->accuracy : 2 * s->error; }

static const char *verdict_on(const EffectStudy *s, const EffectRow *row) {
  if (row->excluded_by) return "excluded";
  const EffectMeasurement *m = &s->measured[row->apart];
  int matters = m->why || !(m->difference <= limit_of(s));
  if (row->on) return matters ? "needed" : s->accuracy > 0 ? "below the accuracy" : "below the scene's accuracy";
  return matters ? "would matter" : "would not matter";
}

/* --- the report --- */

static Name name_of(const EffectStudy *s, const EffectRow *row) { return s->graph.at[row->effect].stmt->name; }

static int ops_of(const EffectStudy *s, const EffectRow *row) {
  return s->measured[row->upper].ops - s->measured[row->lower].ops;
}

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

static const char *number(Arena *a, double x) {
  return isnan(x) ? "-" : isinf(x) ? "no number" : arena_printf(a, "%.2g", x);
}

static const char *percent(Arena *a, double x) { return isfinite(x) ? arena_printf(a, "%.0f %%", 100 * x) : "-"; }

static int name_width(const EffectStudy *s) {
  size_t width = strlen("shared");
  for (uint32_t i = 0; i < s->rows.n; i++)
    width = strlen(name_of(s, &s->rows.at[i])) > width ? strlen(name_of(s, &s->rows.at[i])) : width;
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
  sb_printf(out, " %6s %6s %6s  %9s %11s  %s", arena_printf(a, "%s%d", sign, ops_of(s, row)),
            percent(a, operation_fraction(s, ops_of(s, row))), percent(a, time_share(s, row)), number(a, m->weight),
            m->why ? "run fails" : number(a, m->difference), verdict_on(s, row));
  if (row->together)
    sb_printf(out, " (%s %s)", row->on ? "left out with" : "added with", effect_names_joined(s, row->together));
  sb_putc(out, '\n');
}

static void put_total(const EffectStudy *s, const char *name, int ops, int width, StrBuf *out) {
  sb_printf(out, "  %-*s      %6d %6s", width, name, ops, percent(s->arena, operation_fraction(s, ops)));
}

static void put_failures(const EffectStudy *s, StrBuf *out) {
  vec_each(const EffectRow, row, s->rows) {
    if (!row->excluded_by && s->measured[row->apart].why)
      sb_printf(out, "%s %s the run fails: %s\n", row->on ? "without" : "with", name_of(s, row),
                s->measured[row->apart].why);
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
  sb_printf(
      out,
      "without %s the difference is %.2g, below %g, measured by runs; no smaller set is enough (%u %s run)\n  %s\n",
      effect_names_joined(s, gone), s->least_difference, s->accuracy, s->tried, s->tried == 1 ? "set was" : "sets were",
      effect_use_statement(s, s->least));
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
  sb_printf(out, "         %.3g ns a call%s\n", scene->time * 1e9, s->evaluated ? ", evaluated" : "");
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

static void json_names(const EffectStudy *s, EffectSet set, StrBuf *out) {
  EffectList names = effect_names(s, set);
  sb_putc(out, '[');
  for (uint32_t i = 0; i < names.n; i++) sb_printf(out, "%s\"%s\"", i ? ", " : "", names.at[i]);
  sb_putc(out, ']');
}

static void json_row(const EffectStudy *s, const EffectRow *row, StrBuf *out) {
  const EffectMeasurement *m = &s->measured[row->apart];
  sb_printf(out, "{\"name\": \"%s\", \"on\": %s, \"verdict\": \"%s\"", name_of(s, row), row->on ? "true" : "false",
            verdict_on(s, row));
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
    sb_json(out, m->why);
  }
  sb_putc(out, '}');
}

static void put_json(const EffectStudy *s, StrBuf *out) {
  sb_printf(out, "{\"model\": \"%s\", \"scene\": \"%s\", \"method\": \"%s\"", s->scene->name, s->scene->scene.name,
            s->method);
  json_number(out, "span_s", s->span);
  json_number(out, "integration_error", s->error);
  json_number(out, "limit", limit_of(s));
  sb_printf(out, ", \"operations\": %d, \"base\": %d, \"shared\": %d", s->measured[0].ops, s->measured[s->base].ops,
            shared_ops(s));
  json_number(out, "time_s", s->measured[0].time);
  json_number(out, "base_time_s", s->measured[s->base].time);
  sb_printf(out, ", \"evaluated\": %s", s->evaluated ? "true" : "false");
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
    sb_json(out, effect_use_statement(s, s->least));
    sb_putc(out, '}');
  }
  sb_puts(out, "}\n");
}

/* --- the command --- */

/* --accuracy: the smallest set. */
static int find_smallest(Compiler *c, EffectStudy *s) {
  char **argv = ARENA_ARRAY(c->arena, char *, c->picture.argv.n);
  memcpy(argv, c->picture.argv.at, c->picture.argv.n*sizeof *argv);
  argv[2] = arena_strdup(c->arena, "runs");
  if (!num_parse_double(c->o.accuracy, &s->accuracy) || !(s->accuracy > 0))
    return usage_error(arena_printf(
        c->arena, "--accuracy %s: a difference that does not matter, relative and positive; for example 1e-6",
        c->o.accuracy));
  if (s->error <= s->accuracy/10) return effect_find_least(c, s, argv);
  fprintf(stderr,
          "lagc: --accuracy %g: the error of integration, %.2g, is not well below it; add --tol with a smaller number, "
          "or --step\n",
          s->accuracy, s->error);
  return STATUS_RUN;
}

int command_effects(Compiler *c) {
  int status = simulator_prepare(c);
  Model *m = status == STATUS_OK ? compiler_model(c, &(ModelChoice){.scene = c->o.scene, .unfixed = 1}) : NULL;
  EffectStudy *s = m ? effect_study_plan(m) : NULL;
  if (!s) return status == STATUS_OK ? STATUS_MODEL : status;
  if (c->o.accuracy && effect_count(s->used) > EFFECTS_SEARCHED)
    return usage_error(arena_printf(
        c->arena, "--accuracy: the scene has %u effects; all sets of up to %d are searched: leave some out",
        effect_count(s->used), EFFECTS_SEARCHED));
  status = effect_sets_run(c, s, &s->variants, c->picture.argv.at, &s->measured);
  if (status == STATUS_OK && c->o.accuracy) status = find_smallest(c, s);
  if (status != STATUS_OK) return status;
  StrBuf out = strbuf(c->arena);
  if (c->o.json) put_json(s, &out);
  else put_text(s, &out);
  return compiler_write(c, NULL, &out);
}
