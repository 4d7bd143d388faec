/* Emitted header: names with the header's prefix, the head comment with an example of use, and the frame of the
 * file. */
#include "emit/emit_model.h"

#include <string.h>

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

#define LAST_STAGE(name, NAME, kind, dense, order, line, words) #NAME "_LAST",
static const char *const header_names[] = {"REAL",
                                           "API", "STATIC", "IMPLEMENTATION", "IMPLEMENTED", "H_INCLUDED", "MASK",
                                           "LANE", "LANES", "LIBM", "OWN", "COMPLEX", "ABS", "BITS", "IS_float",
                                           "IS_double", "IS_long", "FMA", "NO_FMA", "INLINE", "TRY", "WHERE", "FAILED",
                                           "STATUS", "EUNMET", "PIVOTS", "PIVOTS_STATUS", "OK", "ABI", "WITH_NAMES",
                                           "ESINGULAR", "ESTEP", "NQ", "NZ", "NY", "NC", "NHOLONOMIC", "NP", "NU",
                                           "NEV", "NOUT", "NNZ", "NNZ_IDA", "ENEWTON", "ENAN", "EZENO", "ETOLERANCE",
                                           "ESIZE", "IS_FINITE", "ECONTACT", "DEGREE", "LOCATE_ROWS", "LOCATE_UNSEEN",
                                           "LOCATE_ROUGH", "LOCATE_FINEST", "PRESSING_SIZE", "THE_MODEL", "LAWS",
                                           "MODEL", "MAX_DRIFTS", LAG_RUNGE_KUTTA_METHODS(LAST_STAGE) "NCONTACTS",
                                           "NSURFACES", "OPEN", "SLIPS", "STICKS", "RULE_FREE", "NNEWTON",
                                           "NBAND", "QQ", "VQ", "VV", "FQ", "FV",
                                           "MOST_CORRECTIONS", "PREDICTOR_DEGREE",
                                           "VARIATIONAL_ORDER", "TAYLOR_ORDER", "TAYLOR_COLUMNS", "TAYLOR_WIDTH",
                                           "TAYLOR_GROUP", "TAYLOR_SQUARES", "TAYLOR_SUMS", "TAYLOR_CONSTANTS",
                                           "TAYLOR_STATE", "TAYLOR_PAIRED", "TAYLOR_SQUARED",
                                           "TAYLOR_PER_PAIR", "SERIES_MODEL", "SERIES_FLOOR", "SERIES_BEGIN",
                                           "SERIES_REST", "SERIES_AT", "START_MODEL", "THE_START",
                                           "START_ALLOWED", "START_RATES", "HOLD_MODEL", "THE_HOLD", "HOLD_RESIDUALS",
                                           "HOLD_CHANGE", "HOLD_ROUNDING", "HOLD_MET"};

/* Enumerators PREFIX_NAME of the variables, unique in the header. */
static const char **enumerators(Header *h, CNames *taken, const char *stem, const IrVar *v, uint32_t n) {
  const char **names = ARENA_ARRAY(h->a, const char *, n + 1);
  for (uint32_t i = 0; i < n; i++) {
    const char *id = cased(h->a, cname_letters(h->a, v[i].name), 1);
    names[i] = cnames_take(taken, arena_printf(h->a, "%s_%s%s", h->upper, stem, id));
  }
  return names;
}

static const char **event_enumerators(Header *h, CNames *taken) {
  uint32_t n = h->u->events.n;
  IrVar *v = ARENA_ARRAY(h->a, IrVar, n + 1);
  for (uint32_t i = 0; i < n; i++) v[i].name = h->u->events.at[i].name;
  return enumerators(h, taken, "EV_", v, n);
}

static const char *contact_name(const Header *h, uint32_t i) {
  return h->u->constraints.of.at[h->u->contacts.at[i].constraint].name;
}

static const char **contact_enumerators(Header *h, CNames *taken) {
  uint32_t n = header_guides(h->u) ? 0 : h->u->contacts.n;
  IrVar *v = ARENA_ARRAY(h->a, IrVar, n + 1);
  for (uint32_t i = 0; i < n; i++) v[i].name = contact_name(h, i);
  return enumerators(h, taken, "CONTACT_", v, n);
}

/* Switches that a motion may stick on, which alone have an index, and behind them guides. */
static const char **surface_enumerators(Header *h, CNames *taken) {
  uint32_t n = h->u->switches.n, guides = header_guides(h->u);
  const char **names = ARENA_ARRAY(h->a, const char *, n + guides + 1);
  for (uint32_t i = 0; i < guides; i++) {
    IrVar v = {.name = contact_name(h, i)};
    names[n + i] = enumerators(h, taken, "SURFACE_", &v, 1)[0];
  }
  for (uint32_t i = 0; i < n; i++) {
    IrVar v = {.name = h->u->switches.at[i].surface};
    if (h->u->switches.at[i].jumps && i < h->u->nmodes) names[i] = enumerators(h, taken, "SURFACE_", &v, 1)[0];
  }
  return names;
}

/* Global names of the header, which names inside functions must not hide. */
static const char *const *globals_of(Header *h) {
  const char **all = ARENA_ARRAY(h->a, const char *, h->taken.taken.n + 32);
  uint32_t n = 0;
  for (uint32_t i = 0; i < h->taken.taken.n; i++) all[n++] = h->taken.taken.at[i].name;
  static const char *const functions[] = {"solve",   "cubic",  "spline",  "quintic",  "curve",      "interval",
                                          "params",  "state",  "step",    "input_fn", "sincos",     "sincos2",
                                          "sincos4", "sin",    "cos",     "lanes",    "lanes_mask", "compensated_sum",
                                          "rates",   "gather", "scatter", "held"};
  for (size_t i = 0; i < sizeof functions / sizeof *functions; i++)
    all[n++] = arena_printf(h->a, "%s_%s", h->lower, functions[i]);
  all[n++] = "singular";
  return all;
}

static Header header_new(const ProgramSet *u, const char *name, HeaderParts parts, StrBuf *out) {
  Header h = {.u = u, .parts = parts, .scene = &u->scenes.at[0], .a = u->arena, .out = out, .file = name};
  const char *id = parts.prefix ? parts.prefix : cname_letters(h.a, name);
  if (id[0] == '_' || (id[0] >= '0' && id[0] <= '9')) id = arena_printf(h.a, "x%s", id);
  h.upper = cased(h.a, id, 1);
  h.lower = cased(h.a, id, 0);
  h.event_ids = cnames_of_events(u);
  h.taken = cnames_new(h.a);
  for (size_t i = 0; i < sizeof header_names / sizeof *header_names; i++)
    cnames_reserve(&h.taken, arena_printf(h.a, "%s_%s", h.upper, header_names[i]));
  h.q = enumerators(&h, &h.taken, "", u->q.at, u->q.n);
  h.z = enumerators(&h, &h.taken, "", u->z.at, u->z.n);
  h.p = enumerators(&h, &h.taken, "P_", u->p.at, u->p.n);
  h.in = enumerators(&h, &h.taken, "IN_", u->u.at, u->u.n);
  h.ev = event_enumerators(&h, &h.taken);
  h.contacts = contact_enumerators(&h, &h.taken);
  h.surfaces = surface_enumerators(&h, &h.taken);
  h.outputs = enumerators(&h, &h.taken, "OUT_", h.scene->plain.at, h.scene->plain.n);
  CNames members = cnames_new(h.a);
  const char **fields = ARENA_ARRAY(h.a, const char *, u->p.n + 1);
  for (uint32_t i = 0; i < u->p.n; i++) fields[i] = cnames_take(&members, u->p.at[i].name);
  h.fields = fields;
  h.globals = globals_of(&h);
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

/* Example loop for a model with contacts: a step that would penetrate is undone and the impact applied; a contact
 * that strikes again at once stays closed until its force vanishes. */
static void write_contact_loop(const Header *h, const char *end, const char *step) {
  const char *m = h->upper, *f = h->lower;
  uint32_t n = h->u->contacts.n;
  sb_printf(h->out,
            " *   %s_REAL u[%s_NU], g[%s_NEV];\n *   const int contacts[%u][3] = { // strikes, opens, is closed\n", m,
            m, m, n);
  for (uint32_t k = 0; k < n; k++) {
    const IrContact *c = &h->u->contacts.at[k];
    sb_printf(h->out, " *     {%s, %s, %s}%s\n", h->ev[c->impact], h->ev[c->release], h->in[c->input],
              k + 1 < n ? "," : "};");
  }
  sb_printf(h->out, " *   double at[%u] = {", n);
  for (uint32_t k = 0; k < n; k++) sb_puts(h->out, k ? ", -1" : "-1");
  sb_printf(h->out,
            "}; // when it struck last\n *   int closed[%u] = {0}, stop = 0;\n *   while (s.t < %s && !stop) {\n *     "
            "const %s_state before = s;\n",
            n, end, f);
  sb_printf(h->out,
            " *     int struck = -1;\n *     %s_inputs(s.t, &p, u);\n *     for (int k = 0; k < %u; k++) "
            "u[contacts[k][2]] = closed[k];\n",
            f, n);
  sb_printf(h->out,
            " *     if (%s_rk4_step(&p, &s, %s, u) != %s_OK || %s_events(s.t, s.q, s.v%s, &p, u, g) != %s_OK) break;\n",
            f, step, m, f, h->u->z.n ? ", s.z" : "", m);
  sb_printf(h->out, " *     for (int k = 0; k < %u && struck < 0; k++) {\n", n);
  sb_puts(h->out, " *       if (closed[k] && g[contacts[k][1]] <= 0) closed[k] = 0; // nothing presses: it opens\n");
  sb_puts(h->out, " *       else if (!closed[k] && g[contacts[k][0]] < 0) struck = k; // its gap would become "
                  "negative\n *     }\n");
  sb_puts(h->out, " *     if (struck >= 0) {\n *       s = before;\n *       closed[struck] = at[struck] == "
                  "(double)s.t; // again at once: it stays closed\n *       at[struck] = (double)s.t;\n");
  sb_puts(h->out, " *       u[contacts[struck][2]] = closed[struck];\n");
  sb_printf(h->out,
            " *       if (closed[struck]) %s_hold(&p, &s, u);\n *       else %s_act(contacts[struck][0], &p, &s, u, "
            "&stop);\n *     }\n *   }\n",
            f, f);
}

/* Example loop with Moreau's method, by the step that the scene gives. */
static void write_moreau_loop(const Header *h, const char *end, const char *step) {
  const IrScene *s = h->scene;
  for (uint32_t i = 0; i < s->options.n && s->method && strcmp(s->method, "moreau") == 0; i++)
    if (strcmp(s->options.at[i].name, "step") == 0) step = shortest_double(h->a, s->options.at[i].value);
  if (!program_set_contacts(h->u)) {
    sb_printf(h->out, " *   while (s.t < %s)\n *     if (%s_moreau_step(&p, &s, %s%s) != %s_OK) break;\n", end,
              h->lower, step, h->u->u.n ? ", NULL" : "", h->upper);
    return;
  }
  sb_printf(h->out, " *   while (s.t < %s) {\n *     if (%s_moreau_step(&p, &s, %s, NULL) != %s_OK) break;\n", end,
            h->lower, step, h->upper);
  sb_printf(
      h->out,
      " *     if (s.struck[%s] > 0) printf(\"%%g  %%g\\n\", (double)s.t, (double)s.struck[%s]); // a sound\n *   }\n",
      h->contacts[0], h->contacts[0]);
}

/* "s.t, s.q, s.v, &p, u", without arrays that the model lacks. */
static const char *arguments_of(const Header *h) {
  return arena_printf(h->a, "s.t%s%s, &p%s", h->u->q.n ? ", s.q, s.v" : "", h->u->z.n ? ", s.z" : "",
                      h->u->u.n ? ", u" : "");
}

/* Example loop for a model with kicks: steps end at the times of the first, and its action is applied. */
static void write_kick_loop(const Header *h, const char *end) {
  const char *m = h->upper, *f = h->lower;
  uint32_t k = 0;
  while (h->u->events.at[k].direction != EVENT_KICK) k++;
  if (h->u->u.n) sb_printf(h->out, " *   %s_REAL u[%s_NU];\n *   %s_inputs(s.t, &p, u);\n", m, m, f);
  sb_printf(h->out, " *   %s_REAL g[%s_NEV];\n *   int stop = 0;\n", m, m);
  sb_printf(h->out, " *   %s_events(%s, g); // g[%s]: the time between two kicks\n", f, arguments_of(h), h->ev[k]);
  sb_printf(h->out, " *   for (int k = 1; s.t < %s && !stop; k++) {\n", end);
  sb_printf(h->out, " *     const double from = s.t, h = (%sk*g[%s] - from)/100;\n",
            h->scene->t0 == 0 ? "" : arena_printf(h->a, "%s + ", shortest_double(h->a, h->scene->t0)), h->ev[k]);
  sb_printf(h->out,
            " *     for (int i = 1; i <= 100; i++)\n *       if (%s_rk4_step(&p, &s, from + i*h - s.t%s) != %s_OK) "
            "return 1;\n",
            f, h->u->u.n ? ", NULL" : "", m);
  sb_printf(h->out, " *     %s_act(%s, &p, &s%s, &stop);\n *   }\n", f, h->ev[k], h->u->u.n ? ", u" : "");
}

/* Example loop for a model with events: a step ends at the first of them, and its action is applied. */
static void write_event_loop(const Header *h, const char *end, const char *step) {
  const char *m = h->upper, *f = h->lower;
  int inputs = h->u->u.n > 0;
  if (inputs) sb_printf(h->out, " *   %s_REAL u[%s_NU];\n", m, m);
  sb_printf(h->out, " *   int event, stop = 0;\n *   while (s.t < %s && !stop) {\n", end);
  sb_printf(h->out, " *     if (%s_step_until_event(&p, &s, %s%s, &event) != %s_OK) break;\n", f, step,
            inputs ? ", NULL" : "", m);
  if (inputs) sb_printf(h->out, " *     %s_inputs(s.t, &p, u);\n", f);
  sb_printf(h->out, " *     if (event >= 0) %s_act(event, &p, &s%s, &stop);\n *   }\n", f, inputs ? ", u" : "");
}

static void write_usage(const Header *h) {
  const char *m = h->upper, *f = h->lower;
  const char *in = h->u->u.n ? ", NULL" : "";
  sb_puts(h->out, " *\n * In every file that uses it, and in one of them (C or C++) after #define as here:\n");
  sb_printf(h->out, " *   #define %s_IMPLEMENTATION\n *   #include \"%s.h\"\n *\n", m, h->file);
  sb_printf(h->out, " *   %s_params p;\n *   %s_state s;\n", f, f);
  sb_printf(h->out, " *   %s_defaults(&p); // as in scene %s\n *   %s_start(&p, &s);\n", f, h->scene->name, f);
  const char *end = shortest_double(h->a, h->scene->t1),
             *step = shortest_double(h->a, (h->scene->t1 - h->scene->t0) / 1e4);
  if (header_has_method(h, "moreau")) write_moreau_loop(h, end, step);
  else if (h->u->contacts.n) write_contact_loop(h, end, step);
  else if (program_set_kick(h->u)) write_kick_loop(h, end);
  else if (h->parts.parts & PART_EVENTS) write_event_loop(h, end, step);
  else
    sb_printf(h->out, " *   while (s.t < %s)\n *     if (%s_rk4_step(&p, &s, %s%s) != %s_OK) break;\n", end, f, step,
              in, m);
  const char *first = h->u->q.n   ? arena_printf(h->a, "s.q[%s]", h->q[0])
                      : h->u->z.n ? arena_printf(h->a, "s.z[%s]", h->z[0])
                                  : "s.t";
  sb_printf(h->out, " *   printf(\"%%g\\n\", (double)%s);\n *\n", first);
  sb_printf(
      h->out,
      " * To define before the first include, the same in every file:\n"
      " *   %s_REAL    float, double (the default) or long double; another type, such as one that differentiates, by "
      "the name of its\n"
      " *             typedef, with %s_LIBM, and with %s_COMPLEX if it has no order\n"
      " *   %s_STATIC  functions are static inline, in every file that includes this\n"
      " *   %s_FN(x)   the function x for such a type: x##q for __float128, with %s_C(x) x##Q; C++ and compilers that "
      "know GNU's\n"
      " *             C choose themselves, others in C99 between float and double\n"
      " *   %s_LANES   4 or 8, with GCC or Clang: %s_REAL is a vector of so many doubles, each with a state and "
      "parameters\n"
      " *             of its own. A status is 0, or minus the sum of 2^k over the lanes k that failed; others are "
      "right\n"
      " *   %s_LIBM    the C library's functions in place of those below\n"
      " * Not with -ffast-math. GCC 12.2 of Debian 12 stores wrong numbers at -O2 with AVX-512 (as -march=native may "
      "mean): add\n"
      " * -fno-tree-slp-vectorize. -ffp-contract=off makes the same digits with every compiler, and -D%s_NO_FMA on "
      "every processor:\n"
      " * sines use fused multiply-add where __FMA__ is defined. (The C library's functions have their own digits.)\n",
      m, m, m, m, m, m, m, m, m, m);
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
  if (header_guides(u))
    sb_printf(h->out, " * Guides: %s_moreau_step has their friction; other steps slide without.\n", h->lower);
  else if (header_has_method(h, "moreau") && u->contacts.n)
    sb_printf(h->out, " * Contacts: %s_moreau_step follows them; other steps ignore them.\n", h->lower);
  else if (u->contacts.n)
    sb_printf(h->out,
              " * Contacts: a step ignores them. The loop below calls %s_events, %s_act and %s_hold; one without these "
              "falls through.\n",
              h->lower, h->lower, h->lower);
  if (program_set_kick(u))
    sb_printf(h->out,
              " * Kicks: a step ignores them. The loop below ends steps at the times of kicks, and calls %s_act.\n",
              h->lower);
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
