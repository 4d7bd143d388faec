/* Emitted header: names with the header's prefix, the head comment with an example of use, and the frame of the
 * file. */
#include "emit/emit_model.h"

#include <string.h>

#include "emit/emit_header_text.h"
#include "ir/row_share.h"
#include "emit/header_impl.h"
#include "kernels/steppers.def"

/* --- names --- */

static const char *cased(Arena *a, const char *s, int upper) {
  char *t = arena_strdup(a, s);
  for (char *c = t; *c; c++) {
    if (upper && *c >= 'a' && *c <= 'z') *c = (char)(*c - 'a' + 'A');
    if (!upper && *c >= 'A' && *c <= 'Z') *c = (char)(*c - 'A' + 'a');
  }
  return t;
}

#define LAST_STAGE(name, NAME, kind, dense, order, line, words) #NAME "_LAST "
static const char header_names[] =
    "REAL API STATIC IMPLEMENTATION IMPLEMENTED H_INCLUDED MASK LANE LANES LIBM OWN COMPLEX ABS BITS IS_float "
    "IS_double IS_long FMA NO_FMA INLINE TRY WHERE FAILED STATUS EUNMET PIVOTS PIVOTS_STATUS OK ABI WITH_NAMES "
    "ESINGULAR ESTEP NQ NZ NY NC NHOLONOMIC NP NU NEV NOUT NNZ NNZ_IDA ENEWTON ENAN EZENO ETOLERANCE ESIZE IS_FINITE "
    "ECONTACT DEGREE LOCATE_ROWS LOCATE_UNSEEN LOCATE_ROUGH LOCATE_FINEST PRESSING_SIZE THE_MODEL LAWS MODEL "
    "MAX_DRIFTS "
    LAG_RUNGE_KUTTA_METHODS(LAST_STAGE)
    "NCONTACTS NSURFACES NSLOPES OPEN SLIPS STICKS RULE_FREE NNEWTON NBAND QQ VQ VV FQ FV MOST_CORRECTIONS "
    "PREDICTOR_DEGREE VARIATIONAL_ORDER TAYLOR_ORDER TAYLOR_COLUMNS TAYLOR_WIDTH TAYLOR_GROUP TAYLOR_SQUARES "
    "TAYLOR_SUMS TAYLOR_CONSTANTS TAYLOR_STATE TAYLOR_PAIRED TAYLOR_SQUARED TAYLOR_PER_PAIR SERIES_MODEL "
    "SERIES_FLOOR SERIES_BEGIN SERIES_REST SERIES_AT START_MODEL THE_START START_ALLOWED START_RATES HOLD_MODEL "
    "THE_HOLD HOLD_RESIDUALS HOLD_CHANGE HOLD_ROUNDING HOLD_MET";

/* Enumerator PREFIX_STEM_NAME, unique in the header. */
static const char *enumerator(Header *h, const char *stem, const char *name) {
  const char *id = cased(h->a, cname_letters(h->a, name), 1);
  return cnames_take(&h->taken, arena_printf(h->a, "%s_%s%s", h->upper, stem, id));
}

static const char **enumerators(Header *h, const char *stem, const IrVar *v, uint32_t n) {
  const char **names = ARENA_ARRAY(h->a, const char *, n + 1);
  for (uint32_t i = 0; i < n; i++) names[i] = enumerator(h, stem, v[i].name);
  return names;
}

static const char **event_enumerators(Header *h) {
  const char **names = ARENA_ARRAY(h->a, const char *, h->u->events.n + 1);
  for (uint32_t i = 0; i < h->u->events.n; i++) names[i] = enumerator(h, "EV_", h->u->events.at[i].name);
  return names;
}

static const char **contact_enumerators(Header *h) {
  uint32_t n = program_set_contacts(h->u);
  const char **names = ARENA_ARRAY(h->a, const char *, n + 1);
  for (uint32_t i = 0; i < n; i++) names[i] = enumerator(h, "CONTACT_", header_contact_name(h, i));
  return names;
}

/* Switches that a motion may stick on, which alone have an index, and behind them guides. */
static const char **surface_enumerators(Header *h) {
  uint32_t n = h->u->switches.n, guides = header_guides(h->u), contacts = program_set_contacts(h->u);
  const char **names = ARENA_ARRAY(h->a, const char *, n + guides + 1);
  for (uint32_t i = 0; i < guides; i++)
    names[n + i] = enumerator(h, "SURFACE_", header_contact_name(h, contacts + i));
  for (uint32_t i = 0; i < n && i < h->u->nmodes; i++)
    if (h->u->switches.at[i].jumps) names[i] = enumerator(h, "SURFACE_", h->u->switches.at[i].surface);
  return names;
}

/* Its functions that are no part of its interface. */
static const char functions[] =
    "solve cubic spline quintic curve interval params state step input_fn sincos sincos2 sincos4 sin cos lanes "
    "lanes_mask compensated_sum rates gather scatter held";

static Header header_new(const ProgramSet *u, const char *name, HeaderParts parts, StrBuf *out) {
  Header h = {.u = u, .parts = parts, .scene = &u->scenes.at[0], .a = u->arena, .out = out, .file = name};
  const char *id = parts.prefix ? parts.prefix : cname_letters(h.a, name);
  if (id[0] == '_' || (id[0] >= '0' && id[0] <= '9')) id = arena_printf(h.a, "x%s", id);
  h.upper = cased(h.a, id, 1);
  h.lower = cased(h.a, id, 0);
  h.event_ids = cnames_of_events(u);
  h.taken = cnames_new(h.a);
  cnames_reserve_words(&h.taken, arena_printf(h.a, "%s_", h.upper), header_names);
  h.q = enumerators(&h, "", u->q.at, u->q.n);
  h.z = enumerators(&h, "", u->z.at, u->z.n);
  h.p = enumerators(&h, "P_", u->p.at, u->p.n);
  h.in = enumerators(&h, "IN_", u->u.at, u->u.n);
  h.ev = event_enumerators(&h);
  h.contacts = contact_enumerators(&h);
  h.surfaces = surface_enumerators(&h);
  h.outputs = enumerators(&h, "OUT_", h.scene->plain.at, h.scene->plain.n);
  CNames members = cnames_new(h.a);
  const char **fields = ARENA_ARRAY(h.a, const char *, u->p.n + 1);
  for (uint32_t i = 0; i < u->p.n; i++) fields[i] = cnames_take(&members, u->p.at[i].name);
  h.fields = fields;
  cnames_reserve_words(&h.taken, arena_printf(h.a, "%s_", h.lower), functions);
  cnames_reserve(&h.taken, "singular");
  h.globals = cnames_list(&h.taken);
  return h;
}

/* --- the head --- */

/* Appends the equations from text; the paragraph above them and the operation count stand in the head already. */
static void comment_lines(const Header *h, const char *text) {
  enum { MOST_LINES = 80, MOST_COLUMNS = 300 };
  const char *body = strstr(text, "\n\n"), *safe = comment_text(h->a, body ? body + 1 : text);
  uint32_t lines = 0, left = 0;
  for (; *safe; lines++) {
    size_t n = strcspn(safe, "\n"), shown = n > MOST_COLUMNS ? MOST_COLUMNS : n;
    while (shown > 0 && shown < n && (safe[shown] & 0xc0) == 0x80) shown--; /* between characters of UTF-8 */
    if (lines >= MOST_LINES) left += n > 0;
    else if (strncmp(safe, "accelerations:", 14) != 0)
      sb_printf(h->out, " *%s%.*s%s\n", n ? " " : "", (int)shown, safe, shown < n ? " ..." : "");
    safe += n + (safe[n] == '\n');
  }
  if (left) sb_printf(h->out, " * ... and %u lines more: `lagc derive` shows them.\n", left);
}

/* Rows of the table of contacts: events by which they strike and open, input by which they are closed; beginnings of
 * times of the last strike. */
static HeaderWord contact_rows(const Header *h) {
  uint32_t n = h->u->contacts.n;
  StrBuf b = strbuf(h->a);
  for (uint32_t k = 0; k < n; k++) {
    const IrContact *c = &h->u->contacts.at[k];
    sb_printf(&b, "\n *     {%s, %s, %s}%s", h->ev[c->impact], h->ev[c->release],
              h->in[c->input], k + 1 < n ? "," : "};");
  }
  sb_printf(&b, "\n *   double at[%u] = {", n);
  for (uint32_t k = 0; k < n; k++) sb_puts(&b, k ? ", -1" : "-1");
  return (HeaderWord){"CONTACTS", sb_text(&b)};
}

/* "s.t, s.q, s.v, &p, u", without arrays that the model lacks. */
static const char *arguments_of(const Header *h) {
  return arena_printf(h->a, "s.t%s%s, &p%s", h->u->q.n ? ", s.q, s.v" : "", h->u->z.n ? ", s.z" : "",
                      h->u->u.n ? ", u" : "");
}

/* Step of the example loop: with Moreau's method that of the scene. */
static const char *step_of(const Header *h) {
  const IrScene *s = h->scene;
  double step = (s->t1 - s->t0) / 1e4;
  for (uint32_t i = 0; i < s->options.n && s->method && strcmp(s->method, "moreau") == 0; i++)
    if (header_has_method(h, "moreau") && strcmp(s->options.at[i].name, "step") == 0) step = s->options.at[i].value;
  return shortest_double(h->a, step);
}

static const char *loop_of(const Header *h) {
  if (header_has_method(h, "moreau")) return program_set_contacts(h->u) ? moreau_loop : friction_loop;
  if (h->u->contacts.n) return contact_loop;
  if (program_set_kick(h->u)) return kick_loop;
  return h->parts.parts & PART_EVENTS ? event_loop : plain_loop;
}

static void write_usage(const Header *h) {
  const IrScene *s = h->scene;
  uint32_t kick = 0;
  while (kick < h->u->events.n && h->u->events.at[kick].direction != EVENT_KICK) kick++;
  const HeaderWord words[] = {
      {"THE_END", shortest_double(h->a, s->t1)}, {"THE_STEP", step_of(h)},
      {"NO_U", h->u->u.n ? ", NULL" : ""}, {"ALSO_Z", h->u->z.n ? ", s.z" : ""}, {"ALSO_U", h->u->u.n ? ", u" : ""},
      {"NCONTACTS", arena_printf(h->a, "%u", h->u->contacts.n)}, contact_rows(h),
      {"CONTACT", h->contacts && h->u->contacts.n ? h->contacts[0] : ""},
      {"OF_STATE", arguments_of(h)}, {"KICK", kick < h->u->events.n ? h->ev[kick] : ""},
      {"SINCE", s->t0 == 0 ? "" : arena_printf(h->a, "%s + ", shortest_double(h->a, s->t0))},
      {"FIRST", h->u->q.n   ? arena_printf(h->a, "s.q[%s]", h->q[0])
                : h->u->z.n ? arena_printf(h->a, "s.z[%s]", h->z[0])
                            : "s.t"},
      {"THREADS", !unit_shares(h->u, 0) ? "" :
       arena_printf(h->a, "\n *   %s_THREADS how many threads share long sums, compiled with OpenMP (-fopenmp), with "
                    "the same digits; by default\n *             as OMP_NUM_THREADS says", h->upper)},
      {NULL, NULL}};
  sb_puts(h->out, " *\n * In every file that uses it, and in one of them (C or C++) after #define as here:\n");
  sb_printf(h->out, " *   #define %s_IMPLEMENTATION\n *   #include \"%s.h\"\n *\n", h->upper, h->file);
  header_printf(h, " *   lag_params p;\n *   lag_state s;\n");
  sb_printf(h->out, " *   %s_defaults(&p); // as in scene %s\n *   %s_start(&p, &s);\n", h->lower, s->name, h->lower);
  header_template(h, loop_of(h), words);
  header_template(h, settings, words);
}

static void write_head(const Header *h, const char *equations) {
  const ProgramSet *u = h->u;
  sb_printf(h->out, "/* %s.h: %s\n * SPDX-License-Identifier: 0BSD\n *\n", comment_text(h->a, h->file),
            comment_text(h->a, u->doc[0] ? u->doc : u->name));
  sb_printf(h->out, " * Made by lagc from the model %s, scene %s; effects in use: %s.\n", u->name, h->scene->name,
            u->effects[0] ? u->effects : "none");
  if (u->fixed[0]) sb_printf(h->out, " * Parameters that are numbers here: %s.\n", u->fixed_values);
  sb_printf(h->out, " * One evaluation of the equations of motion: %s.\n", op_count_text(u->accel, h->a));
  sb_printf(h->out, " * %s\n", math_source_text(u));
  sb_printf(h->out,
            " * C99 or C++, <math.h>%s only (link with -lm); no allocation, no state kept between calls. All values "
            "are in SI units.\n",
            header_libraries(h));
  sb_puts(h->out, " * This text may be used for any purpose without conditions (0BSD).\n");
  if (header_surfaces(u) && !u->contacts.n)
    sb_puts(h->out, header_has_method(h, "moreau")
                        ? arena_printf(h->a,
                                       " * Dry friction: %s_moreau_step sticks and slips; other steps decide at each "
                                       "state, and go to and fro where a body sticks.\n",
                                       h->lower)
                        : " * Dry friction: steps decide at each state, and go to and fro where a body sticks; `lagc "
                          "header --with moreau` adds a step that sticks.\n");
  if (header_guides(u)) header_printf(h, " * Guides: lag_moreau_step has their friction; other steps slide without.\n");
  if (header_has_method(h, "moreau") && program_set_contacts(u))
    header_printf(h, " * Contacts: lag_moreau_step follows them; other steps ignore them.\n");
  else if (program_set_contacts(u))
    header_printf(h, " * Contacts: a step ignores them. The loop below calls lag_events, lag_act and lag_hold; one "
                     "without these falls through.\n");
  if (program_set_kick(u))
    header_printf(
        h, " * Kicks: a step ignores them. The loop below ends steps at the times of kicks, and calls lag_act.\n");
  if (u->events.n && !program_set_kick(u) && !u->contacts.n && !(h->parts.parts & PART_EVENTS))
    sb_puts(h->out, " * Events: a step ignores them; `lagc header --with events` adds a step that ends at them.\n");
  write_usage(h);
  if (equations) comment_lines(h, equations);
  sb_puts(h->out, " */\n");
}

void emit_header(const ProgramSet *u, const char *name, HeaderParts parts, const char *equations, StrBuf *out) {
  Header h = header_new(u, name, parts, out);
  write_head(&h, equations);
  sb_printf(out, "#ifndef %s_H_INCLUDED\n#define %s_H_INCLUDED\n\n", h.upper, h.upper);
  header_declarations(&h);
  sb_printf(out,
            "\n#endif\n\n#if (defined(%s_IMPLEMENTATION) || defined(%s_STATIC)) && !defined(%s_IMPLEMENTED)\n#define "
            "%s_IMPLEMENTED\n\n",
            h.upper, h.upper, h.upper, h.upper);
  header_implementation(&h);
  sb_puts(out, "\n#endif\n");
}
