/* Embedding of the runtime's texts: the sections that a unit needs, with its prefix. A section is what
 * stands between its marker, a line that begins with `---- NAME ----` in a comment, and the next. */
#include "emit/cfunction.h"

#include <string.h>

#include "emit/band_matrix_kernel.h" /* static const char *const NAME_kernel[]: lines of runtime/kernels/NAME.h */
#include "emit/compensated_sum_kernel.h"
#include "emit/composition_kernel.h"
#include "emit/dense_output_kernel.h"
#include "emit/impulses_kernel.h"
#include "emit/lag_kkt.h"             /* static const char *const NAME[]: and of runtime/include/NAME.h */
#include "emit/lag_math.h"
#include "emit/lag_sincos.h"
#include "emit/locate_kernel.h"
#include "emit/runge_kutta_kernel.h"
#include "emit/scalar_kernel.h"
#include "emit/splitting_kernel.h"
#include "emit/step_size_kernel.h"
#include "emit/taylor_order_kernel.h"
#include "emit/taylor_size_kernel.h"
#include "emit/runge_kutta_tables_kernel.h"

#define LINES(text) {text, sizeof text / sizeof *text}
static const struct {
  const char *const *line;
  size_t n;
} embedded[] = {LINES(lag_math),  LINES(lag_sincos), LINES(lag_kkt), LINES(scalar_kernel), LINES(compensated_sum_kernel), LINES(composition_kernel), LINES(splitting_kernel),
                LINES(runge_kutta_tables_kernel), LINES(runge_kutta_kernel), LINES(step_size_kernel), LINES(taylor_order_kernel), LINES(taylor_size_kernel), LINES(dense_output_kernel), LINES(band_matrix_kernel), LINES(impulses_kernel), LINES(locate_kernel)};

static const char mark[] = "/* ---- ";
static int is_marker(const char *line, const char *name) {
  return strncmp(line, mark, sizeof mark - 1) == 0 && strncmp(line + sizeof mark - 1, name, strlen(name)) == 0;
}

void embedded_section(const char *name, const char *prefix, const char *lower, StrBuf *out) {
  const char *whole = arena_printf(out->arena, "%s ----", name);
  for (size_t text = 0; text < sizeof embedded / sizeof *embedded; text++) {
    const char *const *line = embedded[text].line;
    size_t n = embedded[text].n, i = 0;
    while (i < n && !is_marker(line[i], whole)) i++;
    for (i++; i < n && !is_marker(line[i], ""); i++) csupport_expand(line[i], prefix, lower, out);
  }
}

void math_kkt_solver(const ProgramSet *u, const char *prefix, const char *lower, StrBuf *out) {
  static const uint32_t large = 62; /* LAG_BAND_LEAST of lag_kkt.h: smaller systems have no band solver */
  static const char *const names[] = {"numbers", "band", "kkt"};
  int banded = u->q.n + u->constraints.of.n >= large;
  for (size_t i = 0; u->constraints.of.n && i < sizeof names / sizeof *names; i++)
    if (i != 1 || banded) embedded_section(names[i], prefix, lower, out);
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
  embedded_section("lanes", prefix, lower, out);
}

void math_functions(const ProgramSet *u, const char *prefix, const char *lower, StrBuf *out) {
  int sincos = !u->libm && calls_sincos(u), e = !u->libm && unit_calls(u, "exp"), l = !u->libm && unit_calls(u, "log");
  if (u->libm) sb_printf(out, "#define %s_OWN 0\n", prefix);
  else embedded_section("own", prefix, lower, out);
  embedded_section("libm", prefix, lower, out);
  if (sincos) embedded_section("sincos", prefix, lower, out);
  if (e) embedded_section("exp", prefix, lower, out);
  if (l) embedded_section("log", prefix, lower, out);
  if (u->lanes && (e || l)) sb_printf(out, "#ifndef LAG_LANES\n%s%s#endif\n", e ? "#define exp lag_exp\n" : "", l ? "#define log lag_log\n" : "");
  if (unit_calls(u, "floor")) embedded_section("floor", prefix, lower, out);
  sb_puts(out, "/* ---- the model ---- */\n");
}

void math_power(const char *prefix, const char *lower, StrBuf *out) { embedded_section("power", prefix, lower, out); }

const char *math_prefix(const ProgramSet *u, const char *lower) { return u->libm ? NULL : lower; }

const char *math_source_text(const ProgramSet *u) {
  if (u->libm) return "Functions: the C library's.";
  if (!calls_sincos(u)) return "Functions: the C library's; over lanes exp and log are below.";
  return "Functions: sin and cos are below, to less than 1 unit in the last place; the others are the C library's.";
}
