/* Emitted header: names with the header's prefix, the head comment with an example of use, and the frame of the file. */
#include "emit/emit_model.h"

#include <string.h>

#include "emit/header_impl.h"

/* --- names --- */

static const char *cased(Arena *a, const char *s, int upper) {
  char *t = arena_strdup(a, s);
  for (char *c = t; *c; c++) {
    if (upper && *c >= 'a' && *c <= 'z') *c = (char)(*c - 'a' + 'A');
    if (!upper && *c >= 'A' && *c <= 'Z') *c = (char)(*c - 'A' + 'a');
  }
  return t;
}

static const char *const header_names[] = {"REAL", "API", "STATIC", "IMPLEMENTATION", "IMPLEMENTED", "H_INCLUDED", "MASK", "LANE",
                                           "LANES", "LIBM", "OWN",
                                           "FMA", "INLINE", "PIVOTS", "PIVOTS_STATUS", "OK", "ESINGULAR", "NQ", "NZ", "NP", "NU", "NEV", "NOUT"};

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

/* Global names of the header, which names inside functions must not hide. */
static const char *const *globals_of(Header *h) {
  const char **all = ARENA_ARRAY(h->a, const char *, h->taken.taken.n + 20);
  uint32_t n = 0;
  for (uint32_t i = 0; i < h->taken.taken.n; i++) all[n++] = h->taken.taken.at[i].name;
  static const char *const functions[] = {"solve", "cubic", "spline", "params", "state", "step", "input_fn", "sincos", "sincos2", "sincos4", "sin", "cos",
                                          "lanes", "lanes_mask"};
  for (size_t i = 0; i < sizeof functions / sizeof *functions; i++) all[n++] = arena_printf(h->a, "%s_%s", h->lower, functions[i]);
  all[n++] = "singular";
  return all;
}

static Header header_new(const IrUnit *u, const char *name, StrBuf *out) {
  Header h = {.u = u, .scene = &u->scenes.at[0], .a = u->arena, .out = out, .file = name};
  const char *id = cname_letters(h.a, name);
  if (id[0] == '_' || (id[0] >= '0' && id[0] <= '9')) id = arena_printf(h.a, "x%s", id);
  h.upper = cased(h.a, id, 1);
  h.lower = cased(h.a, id, 0);
  h.taken = cnames_new(h.a);
  for (size_t i = 0; i < sizeof header_names / sizeof *header_names; i++)
    cnames_reserve(&h.taken, arena_printf(h.a, "%s_%s", h.upper, header_names[i]));
  h.q = enumerators(&h, &h.taken, "", u->q.at, u->q.n);
  h.z = enumerators(&h, &h.taken, "", u->z.at, u->z.n);
  h.p = enumerators(&h, &h.taken, "P_", u->p.at, u->p.n);
  h.in = enumerators(&h, &h.taken, "IN_", u->u.at, u->u.n);
  h.ev = event_enumerators(&h, &h.taken);
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
    else if (strncmp(safe, "accelerations:", 14) != 0) sb_printf(h->out, " *%s%.*s%s\n", n ? " " : "", (int)shown, safe, shown < n ? " ..." : "");
    safe += n + (safe[n] == '\n');
  }
  if (left) sb_printf(h->out, " * ... and %u lines more: `lagc derive` shows them.\n", left);
}

/* Example loop for a model with contacts: a step that would penetrate is undone and the impact applied; a contact that strikes again at once
 * stays closed until its force vanishes. */
static void write_contact_loop(const Header *h, const char *end, const char *step) {
  const char *m = h->upper, *f = h->lower;
  uint32_t n = h->u->contacts.n;
  sb_printf(h->out, " *   %s_REAL u[%s_NU], g[%s_NEV];\n *   const int contacts[%u][3] = { // strikes, opens, is closed\n", m, m, m, n);
  for (uint32_t k = 0; k < n; k++) {
    const IrContact *c = &h->u->contacts.at[k];
    sb_printf(h->out, " *     {%s, %s, %s}%s\n", h->ev[c->impact], h->ev[c->release], h->in[c->input], k + 1 < n ? "," : "};");
  }
  sb_printf(h->out, " *   double at[%u] = {", n);
  for (uint32_t k = 0; k < n; k++) sb_puts(h->out, k ? ", -1" : "-1");
  sb_printf(h->out, "}; // when it struck last\n *   int closed[%u] = {0}, stop = 0;\n *   while (s.t < %s && !stop) {\n *     const %s_state before = s;\n", n, end, f);
  sb_printf(h->out, " *     int struck = -1;\n *     %s_inputs(s.t, &p, u);\n *     for (int k = 0; k < %u; k++) u[contacts[k][2]] = closed[k];\n", f, n);
  sb_printf(h->out, " *     if (%s_rk4_step(&p, &s, %s, u) != %s_OK || %s_events(s.t, s.q, s.v%s, &p, u, g) != %s_OK) break;\n", f, step, m, f, h->u->z.n ? ", s.z" : "", m);
  sb_printf(h->out, " *     for (int k = 0; k < %u && struck < 0; k++) {\n", n);
  sb_puts(h->out, " *       if (closed[k] && g[contacts[k][1]] <= 0) closed[k] = 0; // nothing presses: it opens\n");
  sb_puts(h->out, " *       else if (!closed[k] && g[contacts[k][0]] < 0) struck = k; // its gap would become negative\n *     }\n");
  sb_puts(h->out, " *     if (struck >= 0) {\n *       s = before;\n *       closed[struck] = at[struck] == (double)s.t; // again at once: it stays closed\n *       at[struck] = (double)s.t;\n");
  sb_puts(h->out, " *       u[contacts[struck][2]] = closed[struck];\n");
  sb_printf(h->out, " *       if (closed[struck]) %s_hold(&p, &s, u);\n *       else %s_act(contacts[struck][0], &p, &s, u, &stop);\n *     }\n *   }\n", f, f);
}

static void write_usage(const Header *h) {
  const char *m = h->upper, *f = h->lower;
  const char *in = h->u->u.n ? ", NULL" : "";
  sb_puts(h->out, " *\n * In every file that uses it, and in one of them (C or C++) after #define as here:\n");
  sb_printf(h->out, " *   #define %s_IMPLEMENTATION\n *   #include \"%s.h\"\n *\n", m, h->file);
  sb_printf(h->out, " *   %s_params p;\n *   %s_state s;\n", f, f);
  sb_printf(h->out, " *   %s_defaults(&p); // as in scene %s\n *   %s_start(&p, &s);\n", f, h->scene->name, f);
  const char *end = shortest_double(h->a, h->scene->t1), *step = shortest_double(h->a, (h->scene->t1 - h->scene->t0) / 1e4);
  if (h->u->contacts.n) write_contact_loop(h, end, step);
  else sb_printf(h->out, " *   while (s.t < %s)\n *     if (%s_rk4_step(&p, &s, %s%s) != %s_OK) break;\n", end, f, step, in, m);
  const char *first = h->u->q.n ? arena_printf(h->a, "s.q[%s]", h->q[0]) : h->u->z.n ? arena_printf(h->a, "s.z[%s]", h->z[0]) : "s.t";
  sb_printf(h->out, " *   printf(\"%%g\\n\", (double)%s);\n *\n", first);
  sb_printf(h->out,
            " * To define before the first include, the same in every file:\n"
            " *   %s_REAL    float, double (the default) or long double\n"
            " *   %s_STATIC  functions are static inline, in every file that includes this\n"
            " *   %s_FN(x)   C99 with long double needs x##l here; C11 and C++ choose themselves\n"
            " *   %s_LANES   4 or 8, with GCC or Clang: %s_REAL is a vector of so many doubles, each with a state and parameters\n"
            " *             of its own. A status is 0, or minus the sum of 2^k over the lanes k that are singular; others are right\n"
            " *   %s_LIBM    the C library's functions in place of those below\n"
            " * Not with -ffast-math. GCC 12.2 of Debian 12 stores wrong numbers at -O2 with AVX-512 (as -march=native may mean): add\n"
            " * -fno-tree-slp-vectorize. -ffp-contract=off makes the same digits everywhere; contracted code is as good.\n", m, m, m, m, m, m);
}

static void write_head(const Header *h, const char *equations) {
  const IrUnit *u = h->u;
  sb_printf(h->out, "/* %s.h: %s\n *\n", comment_text(h->a, h->file), comment_text(h->a, u->doc[0] ? u->doc : u->name));
  sb_printf(h->out, " * Made by lagc from the model %s, scene %s; effects in use: %s.\n", u->name, h->scene->name, u->effects[0] ? u->effects : "none");
  if (u->fixed[0]) sb_printf(h->out, " * Parameters that are numbers here: %s.\n", u->fixed_values);
  sb_printf(h->out, " * One evaluation of the equations of motion: %s.\n", op_count_text(u->accel, h->a));
  sb_printf(h->out, " * %s\n", math_source_text(u));
  sb_puts(h->out, " * C99 or C++, <math.h> only; no allocation, no state kept between calls. All values are in SI units.\n");
  sb_puts(h->out, " * This text may be used for any purpose without conditions (0BSD).\n");
  if (u->contacts.n)
    sb_printf(h->out, " * Contacts: a step ignores them. The loop below calls %s_events, %s_act and %s_hold; one without these falls through.\n", h->lower, h->lower, h->lower);
  write_usage(h);
  if (equations) comment_lines(h, equations);
  sb_puts(h->out, " */\n");
}

void emit_header(const IrUnit *u, const char *name, const char *equations, StrBuf *out) {
  Header h = header_new(u, name, out);
  write_head(&h, equations);
  sb_printf(out, "#ifndef %s_H_INCLUDED\n#define %s_H_INCLUDED\n\n", h.upper, h.upper);
  header_declarations(&h);
  sb_printf(out, "\n#endif\n\n#if (defined(%s_IMPLEMENTATION) || defined(%s_STATIC)) && !defined(%s_IMPLEMENTED)\n#define %s_IMPLEMENTED\n\n",
            h.upper, h.upper, h.upper, h.upper);
  header_implementation(&h);
  sb_puts(out, "\n#endif\n");
}
