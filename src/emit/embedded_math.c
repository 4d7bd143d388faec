/* Embedding of lag_math.h and lag_kkt.h: the sections that a unit needs, with its prefix. */
#include "emit/cfunction.h"

#include <string.h>

#include "emit/lag_kkt.h"  /* static const char *const lag_kkt[]: generated from runtime/include/lag_kkt.h */
#include "emit/lag_math.h" /* static const char *const lag_math[]: generated from runtime/include/lag_math.h */

/* Appends the section NAME: the lines between its marker `---- NAME ----` and the next marker. */
static void section_of(const char *const *line, size_t lines, const char *name, const char *prefix, const char *lower, StrBuf *out) {
  static const char mark[] = "/* ---- ";
  size_t n = strlen(name), i = 0;
  while (i < lines && !(strncmp(line[i], mark, sizeof mark - 1) == 0 && strncmp(line[i] + sizeof mark - 1, name, n) == 0)) i++;
  for (i++; i < lines && strncmp(line[i], mark, sizeof mark - 1) != 0; i++) csupport_expand(line[i], prefix, lower, out);
}

static void section(const char *name, const char *prefix, const char *lower, StrBuf *out) {
  section_of(lag_math, sizeof lag_math / sizeof *lag_math, name, prefix, lower, out);
}

void math_kkt_solver(const ProgramSet *u, const char *prefix, const char *lower, StrBuf *out) {
  static const uint32_t large = 62; /* LAG_BAND_LEAST of lag_kkt.h: smaller systems have no band solver */
  static const char *const names[] = {"numbers", "band", "kkt"};
  int banded = u->q.n + u->constraints.of.n >= large;
  for (size_t i = 0; u->constraints.of.n && i < sizeof names / sizeof *names; i++)
    if (i != 1 || banded) section_of(lag_kkt, sizeof lag_kkt / sizeof *lag_kkt, names[i], prefix, lower, out);
}

static int calls(const Prog *p, const char *name) {
  for (uint32_t k = 0; k < prog_parts(p); k++)
    for (Slot s = 1; s < prog_part(p, k)->ins.n; s++)
      if ((prog_part(p, k)->ins.at[s].op == IR_FN1 || prog_part(p, k)->ins.at[s].op == IR_FN2) && strcmp(prog_part(p, k)->ins.at[s].text, name) == 0)
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

void math_lanes(const char *prefix, const char *lower, StrBuf *out) {
  sb_puts(out, "/* ---- arithmetic, over doubles and over lanes of them; the model comes after it ---- */\n\n");
  section("lanes", prefix, lower, out);
}

void math_functions(const ProgramSet *u, const char *prefix, const char *lower, StrBuf *out) {
  int sincos = !u->libm && calls_sincos(u), e = !u->libm && unit_calls(u, "exp"), l = !u->libm && unit_calls(u, "log");
  if (u->libm) sb_printf(out, "#define %s_OWN 0\n", prefix);
  else section("own", prefix, lower, out);
  section("libm", prefix, lower, out);
  if (sincos) section("sincos", prefix, lower, out);
  if (e) section("exp", prefix, lower, out);
  if (l) section("log", prefix, lower, out);
  if (u->lanes && (e || l)) sb_printf(out, "#ifndef LAG_LANES\n%s%s#endif\n", e ? "#define exp lag_exp\n" : "", l ? "#define log lag_log\n" : "");
  if (unit_calls(u, "floor")) section("floor", prefix, lower, out);
  sb_puts(out, "/* ---- the model ---- */\n");
}

void math_power(const char *prefix, const char *lower, StrBuf *out) { section("power", prefix, lower, out); }

const char *math_prefix(const ProgramSet *u, const char *lower) { return u->libm ? NULL : lower; }

const char *math_source_text(const ProgramSet *u) {
  if (u->libm) return "Functions: the C library's.";
  if (!calls_sincos(u)) return "Functions: the C library's; over lanes exp and log are below.";
  return "Functions: sin and cos are below, to less than 1 unit in the last place; the others are the C library's.";
}
