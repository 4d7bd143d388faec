/* Writer of check_json.h. Lists are kept apart until the end, since scenes, effects and claims are judged in turn. */
#include "commands/check_json.h"

#include <string.h>

#include "sym/print.h"
#include "symmetry/charges.h"

/* "name": "text", or null; a comma stands before it. */
static void put_member(StrBuf *out, const char *name, const char *text) {
  sb_printf(out, ", \"%s\": ", name);
  if (text) sb_json(out, text);
  else sb_puts(out, "null");
}

/* The place of a span as members: lines and columns from 1, columns in characters; null where a message is about no
 * text. */
static void put_span(StrBuf *out, const Sources *sources, Span span) {
  Place p = source_place(sources, span.end ? span.begin : 0), end = source_place(sources, span.end);
  if (!p.file)
    sb_puts(out, ", \"file\": null, \"line\": null, \"column\": null, \"end_line\": null, \"end_column\": null");
  else {
    put_member(out, "file", p.file->path);
    sb_printf(out, ", \"line\": %u, \"column\": %u, \"end_line\": %u, \"end_column\": %u", p.line, p.column,
              end.file ? end.line : p.line, end.file ? end.column : p.column);
  }
}

static StrBuf *begin(Compiler *c, JsonList list) {
  StrBuf *out = &c->json[list];
  if (!out->arena) *out = strbuf(c->arena);
  if (out->n) sb_puts(out, ", ");
  return out;
}

static StrBuf *begin_named(Compiler *c, JsonList list, const char *name) {
  StrBuf *out = begin(c, list);
  sb_puts(out, "{\"name\": ");
  sb_json(out, name);
  return out;
}

void check_json_facts(Compiler *c, const Eqns *e) {
  StrBuf *out = begin(c, JSON_FACTS);
  const Model *m = e->m;
  sb_printf(out, "\"coordinates\": %u, \"states\": %u, \"parameters\": %u, \"constraints\": %u, \"contacts\": %u",
            eqns_coordinates(e), m->states.n - e->first.n, m->params.n, m->constraints.n, m->contacts.n);
  put_member(out, "energy", e->ncharges ? charges_energy_word(e) : NULL);
  put_member(out, "energy_because", e->ncharges ? charges_energy_text(e) : NULL);
}

void check_json_report(Compiler *c, const StrBuf *lines) {
  for (const char *s = sb_text(lines), *next; *s; s = next + (*next == '\n')) {
    next = s + strcspn(s, "\n");
    sb_json(begin(c, JSON_REPORT), arena_strndup(c->arena, s, (size_t)(next - s)));
  }
}

void check_json_scene(Compiler *c, const char *kind, Name name, const Model *m, int ok) {
  StrBuf *out = begin_named(c, JSON_SCENES, name);
  put_member(out, "kind", kind);
  sb_printf(out, ", \"ok\": %s, \"effects\": [", ok ? "true" : "false");
  for (uint32_t i = 0; m && i < m->effects.n; i++) {
    sb_puts(out, i ? ", " : "");
    sb_json(out, m->effects.at[i]);
  }
  sb_puts(out, "]}");
}

void check_json_symmetries(Compiler *c, const Eqns *e, Name effect) {
  static const char *const verdicts[] = {"proved", "proved up to dF/dt", "false", "not decided"};
  for (uint32_t i = 1; i < e->ncharges; i++) {
    const Charge *x = &e->charges[i];
    if (x->of->effect != effect) continue;
    StrBuf *out = begin_named(c, JSON_SYMMETRIES, x->name);
    put_span(out, c->sources, x->of->span);
    put_member(out, "verdict",
               x->proof.broken     ? "false"
               : x->proof.by_value ? "holds in numbers"
                                   : verdicts[x->proof.is]);
    int known = x->proof.charge && x->proof.is <= INVARIANT_UP_TO_F;
    put_member(out, "charge", known ? expr_text(e->g, x->proof.charge) : NULL);
    sb_puts(out, "}");
  }
}

void check_json_expects(Compiler *c, const ExpectResults *all) {
  static const char *const verdicts[] = {"proved", "refuted", "agrees in numbers", "not decided"};
  for (uint32_t i = 0; i < all->n; i++) {
    const ExpectResult *x = &all->at[i];
    StrBuf *out = begin_named(c, JSON_EXPECTS, x->label);
    put_span(out, c->sources, x->span);
    put_member(out, "verdict", verdicts[x->verdict]);
    sb_printf(out, ", \"digits\": %d, \"states\": %d", x->digits, x->states);
    put_member(out, "missing", x->missing);
    put_member(out, "difference", x->difference);
    sb_puts(out, "}");
  }
}

void check_json_units(Compiler *c, const FoundUnit *at, uint32_t n) {
  for (uint32_t i = 0; i < n; i++) {
    StrBuf *out = begin(c, JSON_UNITS);
    sb_json(out, at[i].name);
    sb_puts(out, ": ");
    sb_json(out, at[i].unit);
  }
}

static void put_messages(StrBuf *out, const Diags *d) {
  static const char *const words[] = {"note", "warning", "error"};
  for (uint32_t i = 0; i < d->list.n && i < DIAG_MAX; i++) {
    const Diag *x = &d->list.at[i];
    sb_printf(out, "%s\n  {\"severity\": \"%s\"", i ? "," : "", words[x->severity]);
    put_span(out, d->sources, x->span);
    put_member(out, "message", diag_text(d, x));
    put_member(out, "help", x->help);
    if (x->note) {
      sb_puts(out, ", \"note\": {\"severity\": \"note\"");
      put_span(out, d->sources, x->note_span);
      put_member(out, "message", x->note);
      sb_putc(out, '}');
    } else sb_puts(out, ", \"note\": null");
    sb_putc(out, '}');
  }
}

void check_json_put(Compiler *c, StrBuf *out) {
  static const char *const names[] = {"facts", "scenes", "symmetries", "expectations", "units", "report"},
                           brackets[][3] = {"{}", "[]", "[]", "[]", "{}", "[]"};
  sb_puts(out, "{\"schema\": \"lagc-check-1\"");
  put_member(out, "file", c->o.file);
  sb_printf(out, ", \"ok\": %s", c->diags->errors ? "false" : "true");
  for (int k = 0; k < JSON_LISTS; k++)
    sb_printf(out, ",\n \"%s\": %c%s%c", names[k], brackets[k][0], c->json[k].n ? sb_text(&c->json[k]) : "",
              brackets[k][1]);
  sb_puts(out, ",\n \"messages\": [");
  put_messages(out, c->diags);
  sb_printf(out, "],\n \"messages_not_shown\": %u}\n", c->diags->list.n > DIAG_MAX ? c->diags->unshown + 1 : 0);
}

int check_json_print(Compiler *c) {
  StrBuf out = strbuf(c->arena);
  check_json_put(c, &out);
  return compiler_write(c, NULL, &out);
}
