/* Embedding of the runtime's texts: the sections that a unit needs, with its prefix. A section is what
 * stands between its marker, a line that begins with `---- NAME ----` in a comment, and the next. */
#include "emit/cfunction.h"

#include <string.h>

#include "ir/row_share.h"
#include "emit/embedded_texts.h" /* static const char *const embedded_texts[]: lines of runtime/include, kernels */

static const char mark[] = "/* ---- ";
static int is_marker(const char *line, const char *name) {
  return strncmp(line, mark, sizeof mark - 1) == 0 && strncmp(line + sizeof mark - 1, name, strlen(name)) == 0;
}

void embedded_section(const char *name, const char *prefix, const char *lower, StrBuf *out) {
  const char *whole = arena_printf(out->arena, "%s ----", name);
  const char *const *line = embedded_texts;
  size_t n = sizeof embedded_texts / sizeof *line, i = 0;
  while (i < n && !is_marker(line[i], whole)) i++;
  for (i++; i < n && !is_marker(line[i], ""); i++) csupport_expand(line[i], prefix, lower, out);
}

static int calls(const Prog *p, const char *name) {
  for (uint32_t k = 0; k < prog_parts(p); k++)
    for (Slot s = 1; s < prog_part(p, k)->ins.n; s++)
      if ((prog_part(p, k)->ins.at[s].op == IR_FN1 || prog_part(p, k)->ins.at[s].op == IR_FN2) &&
          strcmp(prog_part(p, k)->ins.at[s].text, name) == 0)
        return 1;
  return 0;
}

int unit_calls(const ProgramSet *u, const char *name) {
  ProgList all = program_set_programs(u);
  int some = 0;
  for (uint32_t i = 0; i < all.n; i++) some |= calls(all.at[i], name);
  return some;
}

static int calls_sincos(const ProgramSet *u) { return unit_calls(u, "sin") || unit_calls(u, "cos"); }
static int calls_own(const ProgramSet *u) {
  return !u->libm && (calls_sincos(u) || unit_calls(u, "exp") || unit_calls(u, "log"));
}

/* Whether its linear systems are large enough for a band: LAG_BAND_LEAST of lag_kkt.h. */
static int has_band(const ProgramSet *u) { return u->q.n + u->constraints.of.n >= 62; }

/* Whether a sum runs over lists of neighbours (1), or is taken by a tree (2); headers have none. */
static int listed_sums(const MathText *m) {
  ProgList all = program_set_programs(m->u);
  int some = 0;
  for (uint32_t i = 0; i < all.n; i++)
    for (uint32_t k = 0; k < all.at[i]->nests.n; k++) {
      const Nest *n = &all.at[i]->nests.at[k];
      some |= (n->near.n ? 1 : 0) | (n->far.n ? 2 : 0);
    }
  return strcmp(m->prefix, "LAG") == 0 ? some : 0;
}

/* Whether a model has loops whose turns, or values that, may be computed side by side. */
static int has_turns(const MathText *m) {
  ProgList all = program_set_programs(m->u);
  int some = 0;
  for (uint32_t i = 0; i < all.n; i++) some |= all.at[i]->nests.n > 0 || ccubes_some(all.at[i]);
  return some && strcmp(m->prefix, "LAG") == 0;
}

static int has_near(const MathText *m) { return (listed_sums(m) & 1) != 0; }
static int has_tree(const MathText *m) { return (listed_sums(m) & 2) != 0; }

/* Bit 0: some input is a curve by cubics, bit 1: by quintics. */
static unsigned curves_of(const ProgramSet *u) {
  unsigned some = 0;
  for (uint32_t i = 0; i < u->inputs->tables.n; i++) some |= u->inputs->tables.at[i].curve->jet ? 2 : 1;
  return some;
}

/* The sections that a unit needs, or of those that have one the front: `NAME: front`. */
static void sections(const MathText *m, int front, StrBuf *out) {
  const ProgramSet *u = m->u;
  int own = !u->libm, kkt = u->constraints.of.n > 0;
  unsigned curves = curves_of(u);
  const struct {
    const char *name;
    int needed;
  } rows[] = {{"shares", front && has_turns(m)}, {"share", front && (has_turns(m) || unit_shares(u, 0))},
              {"turns", front && has_turns(m)}, {"lanes", !front}, {"own", own}, {"libm", 1},
              {"sincos", own && calls_sincos(u)},
              {"exp", own && unit_calls(u, "exp")}, {"log", own && unit_calls(u, "log")}, {"solver", m->solver},
              {"numbers", kkt}, {"band", kkt && has_band(u)}, {"kkt", kkt}, {"listed", kkt && has_band(u)},
              {"near", has_near(m)}, {"tree", has_tree(m)},
              {"interval", curves != 0}, {"cubic", curves & 1}, {"quintic", curves & 2}};
  for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
    const char *name = front ? arena_printf(out->arena, "%s: front", rows[i].name) : rows[i].name;
    if (rows[i].needed) embedded_section(name, m->prefix, m->lower, out);
  }
}

void math_lanes(const MathText *m, StrBuf *out) { embedded_section("lanes: front", m->prefix, m->lower, out); }

void math_front(const MathText *m, StrBuf *out) {
  embedded_section("logic", m->prefix, m->lower, out);
  if (m->u->libm) sb_printf(out, "#define %s_OWN 0\n", m->prefix);
  sections(m, 1, out);
}

void math_bodies(const MathText *m, StrBuf *out) { sections(m, 0, out); }

/* Over lanes exp and log are the runtime's, and a double has the same bits. */
static void exp_and_log_as_lanes(const ProgramSet *u, StrBuf *out) {
  static const char *const names[] = {"exp", "log"};
  for (int i = 0; u->lanes && !u->libm && i < 2; i++)
    if (unit_calls(u, names[i])) sb_printf(out, "#ifndef LAG_LANES\n#define %s lag_%s\n#endif\n", names[i], names[i]);
}

void math_of_model(const MathText *m, int alone, StrBuf *out) {
  const ProgramSet *u = m->u;
  int kkt = u->constraints.of.n > 0;
  if (u->lanes) sb_puts(out, "#define LAG_AS_LANES 1 /* the same bits as in a lane */\n");
  if (alone) {
    sb_puts(out, "\n");
    math_lanes(m, out);
    embedded_section("scalar", m->prefix, m->lower, out);
    embedded_section("positive", m->prefix, m->lower, out);
    math_front(m, out);
  } else {
    if (u->libm) sb_puts(out, "#define LAG_LIBM 1\n");
    if (kkt && !has_band(u)) sb_puts(out, "#define LAG_NO_BAND 1 /* so few unknowns have none */\n");
    sb_puts(out, calls_own(u) ? "#include \"lag_math.h\"\n" : "#include \"lag_lanes.h\"\n");
    if (m->solver || curves_of(u) || has_near(m)) sb_puts(out, "#include \"lag_support.h\"\n");
    if (has_tree(m)) sb_puts(out, "#include \"lag_tree.h\"\n");
    if (kkt) sb_puts(out, "#include \"lag_kkt.h\"\n");
  }
  exp_and_log_as_lanes(u, out);
  if (has_near(m)) sb_puts(out, "#ifndef LAG_LANES\n#define floor lag_floor\n#endif\n");
}

void math_power(const char *prefix, const char *lower, StrBuf *out) { embedded_section("power", prefix, lower, out); }

const char *math_prefix(const ProgramSet *u, const char *lower) { return u->libm ? NULL : lower; }

const char *math_source_text(const ProgramSet *u) {
  if (u->libm) return "Functions: the C library's.";
  if (!calls_sincos(u)) return "Functions: the C library's; over lanes exp and log are lagc's.";
  return "Functions: sin and cos are lagc's, to less than 1 unit in the last place; the others are the C library's.";
}
