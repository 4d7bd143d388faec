/* The report of `lagc effects`, as text and as JSON. */
#include <math.h>
#include <string.h>

#include "commands/effects_study.h"

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

static const char *number(Arena *a, double x) {
  return isnan(x) ? "-" : isinf(x) ? "no number" : arena_printf(a, "%.2g", x);
}

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
            percent(a, time_share(s, row)), number(a, m->weight), m->why ? "run fails" : number(a, m->difference), effects_verdict(s, row));
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
    const char *claim = s->exhaustive ? "no effect of the scene can be left out" : "leaving out one effect after the other, none can go";
    sb_printf(out, "%s at an accuracy of %g: %u %s run\n", claim, s->accuracy, s->tried, s->tried == 1 ? "other set was" : "other sets were");
    return;
  }
  EffectSet gone = s->used & ~s->least;
  sb_printf(out, "without %s the difference is %.2g, below %g, measured by runs; %s (%u %s run)\n  %s\n", joined(s, gone), s->least_difference, s->accuracy,
            s->exhaustive ? "no smaller set is enough" : "found by leaving out one after the other", s->tried,
            s->tried == 1 ? "set was" : "sets were",
            effects_use(s, s->least));
}

void effects_text(const EffectStudy *s, StrBuf *out) {
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
  sb_printf(out, "{\"name\": \"%s\", \"on\": %s, \"verdict\": \"%s\"", name_of(s, row), row->on ? "true" : "false", effects_verdict(s, row));
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

void effects_json(const EffectStudy *s, StrBuf *out) {
  sb_printf(out, "{\"model\": \"%s\", \"scene\": \"%s\", \"method\": \"%s\"", s->scene->name, s->scene->scene.name, s->method);
  json_number(out, "span_s", s->span);
  json_number(out, "integration_error", s->error);
  json_number(out, "limit", effects_limit(s));
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
    sb_printf(out, ", \"sets_run\": %u, \"exhaustive\": %s, \"use\": ", s->tried, s->exhaustive ? "true" : "false");
    json_text(out, effects_use(s, s->least));
    sb_putc(out, '}');
  }
  sb_puts(out, "}\n");
}
