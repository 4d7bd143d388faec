/* C text of the support functions, and the frame of a function around the body of a Prog. */
#include "emit/cfunction.h"

#include <string.h>

#include "base/num.h"

/* In all texts below LAG_ and lag_ stand for the prefix in upper and lower case. */
/* Test of a positive pivot. NaN passes in a simulator, which finds and names the expression without a value; a program around a
 * header gets a status for it. */
static const char *const positive =
  "#ifndef LAG_POSITIVE\n"
  "#define LAG_POSITIVE(d) LAG_PIVOT(!((d) <= LAG_C(0.0))) /* NaN passes: the caller finds its cause */\n"
  "#endif\n";
static const char *const positive_of_header =
  "#ifdef LAG_COMPLEX /* has no order */\n"
  "#define LAG_POSITIVE(d) LAG_PIVOT((d) != LAG_C(0.0))\n"
  "#elif !defined(LAG_POSITIVE)\n"
  "#define LAG_POSITIVE(d) LAG_PIVOT((d) > LAG_C(0.0))\n"
  "#endif\n";

/* Gauss elimination with partial pivoting (Golub & Van Loan, Matrix Computations, 4th ed.,
 * algorithm 3.4.1). Rows are exchanged under a mask, so that each lane of a vector has its own pivots. */
static const char *const solver =
  "\n/* M x = b by elimination with partial pivoting: M[n*n] row-major is destroyed, b becomes x. Returns whether M is regular, or has\n"
  " * elements that are no numbers: then x has none. */\n"
  "static LAG_MASK lag_solve(int n, LAG_REAL *M, LAG_REAL *b) {\n"
  "  LAG_MASK regular = LAG_C(0.0) == LAG_C(0.0);\n"
  "  for (int k = 0; k < n; k++) {\n"
  "    for (int i = k + 1; i < n; i++) { /* the largest element of column k is moved to row k */\n"
  "      const LAG_REAL here = LAG_FN(fabs)(M[i*n + k]);\n"
  "      const LAG_MASK larger = LAG_OR(here > LAG_FN(fabs)(M[k*n + k]), here != here);\n"
  "      if (!LAG_ANY(larger)) continue;\n"
  "      for (int j = k; j <= n; j++) {\n"
  "        LAG_REAL *const upper = j < n ? &M[k*n + j] : &b[k], *const lower = j < n ? &M[i*n + j] : &b[i];\n"
  "        const LAG_REAL was = *upper;\n"
  "        *upper = LAG_SELECT(larger, *lower, was);\n"
  "        *lower = LAG_SELECT(larger, was, *lower);\n"
  "      }\n"
  "    }\n"
  "    regular = LAG_AND(regular, LAG_NOT(LAG_FN(fabs)(M[k*n + k]) <= LAG_C(0.0)));\n"
  "    if (!LAG_ANY(regular)) break;\n"
  "    for (int i = k + 1; i < n; i++) {\n"
  "      const LAG_REAL factor = M[i*n + k]/M[k*n + k];\n"
  "      for (int j = k + 1; j < n; j++) M[i*n + j] -= factor*M[k*n + j];\n"
  "      b[i] -= factor*b[k];\n"
  "    }\n"
  "  }\n"
  "  for (int k = n - 1; k >= 0; k--) {\n"
  "    for (int j = k + 1; j < n; j++) b[k] -= M[k*n + j]*b[j];\n"
  "    b[k] /= M[k*n + k];\n"
  "  }\n"
  "  return regular;\n"
  "}\n";

/* Splines. Lanes in different intervals are evaluated one interval after the other. */
static const char *const interval =
  "\n/* The interval of the first lane: of n rows of this width, which begin with a time. */\n"
  "static int lag_interval(LAG_REAL t, int n, int width, const LAG_LANE *row) {\n"
  "  int k = 0;\n"
  "  for (int end = n - 1; end - k > 1;) {\n"
  "    const int mid = (k + end)/2;\n"
  "    if (LAG_ANY(t < LAG_C(0.0) + row[width*mid])) end = mid;\n"
  "    else k = mid;\n"
  "  }\n"
  "  return k;\n"
  "}\n";

static const char *const cubic =
  "\n#define LAG_ROW(t, y, m) {(LAG_LANE)(t), (LAG_LANE)(y), (LAG_LANE)(m)}\n"
  "\n/* The cubic between two rows of time, value and second derivative; outside of them the nearest value. */\n"
  "static LAG_REAL lag_cubic(LAG_REAL t, const LAG_LANE *a, const LAG_LANE *b) {\n"
  "  const LAG_LANE h = b[0] - a[0];\n"
  "  const LAG_REAL part = (t - a[0])/h, zero = LAG_C(0.0), one = LAG_C(1.0);\n"
  "  const LAG_REAL x = LAG_SELECT(part < zero, zero, LAG_SELECT(part > one, one, part)), rest = one - x;\n"
  "  return rest*a[1] + x*b[1]\n"
  "       - x*rest*(h*h/(LAG_LANE)6)*((one + rest)*a[2] + (one + x)*b[2]);\n"
  "}\n"
  "\n/* The curve through n rows. Between the first and the last row it has two continuous derivatives. */\n"
  "static LAG_REAL lag_spline(LAG_REAL t, int n, const LAG_LANE (*row)[3]) {\n"
  "  int k = lag_interval(t, n, 3, row[0]);\n"
  "  LAG_REAL y = lag_cubic(t, row[k], row[k + 1]);\n"
  "  for (k++; k < n - 1; k++) { /* lanes that are further on */\n"
  "    const LAG_MASK later = t >= LAG_C(0.0) + row[k][0];\n"
  "    if (!LAG_ANY(later)) break;\n"
  "    y = LAG_SELECT(later, lag_cubic(t, row[k], row[k + 1]), y);\n"
  "  }\n"
  "  return y;\n"
  "}\n";

static const char *const quintic =
  "\n#define LAG_JET(t, y, d, m) {(LAG_LANE)(t), (LAG_LANE)(y), (LAG_LANE)(d), (LAG_LANE)(m)}\n"
  "\n/* Derivative 0, 1 or 2 of the quintic between two rows of time, value, first and second derivative; outside of them the nearest value, and 0. */\n"
  "static LAG_REAL lag_quintic(LAG_REAL t, int order, const LAG_LANE *a, const LAG_LANE *b) {\n"
  "  const LAG_LANE h = b[0] - a[0], m = h*a[2], s = h*h*a[3], half = (LAG_LANE)1/(LAG_LANE)2;\n"
  "  const LAG_LANE A = b[1] - a[1] - m - half*s, B = h*b[2] - m - s, C = h*h*b[3] - s;\n"
  "  const LAG_LANE c3 = (LAG_LANE)10*A - (LAG_LANE)4*B + half*C, c4 = (LAG_LANE)7*B - (LAG_LANE)15*A - C, c5 = (LAG_LANE)6*A - (LAG_LANE)3*B + half*C;\n"
  "  const LAG_REAL part = (t - a[0])/h, zero = LAG_C(0.0), one = LAG_C(1.0);\n"
  "  const LAG_REAL x = LAG_SELECT(part < zero, zero, LAG_SELECT(part > one, one, part));\n"
  "  if (order == 0) return a[1] + x*(m + x*(half*s + x*(c3 + x*(c4 + x*c5))));\n"
  "  const LAG_REAL d = order == 1 ? (m + x*(s + x*((LAG_LANE)3*c3 + x*((LAG_LANE)4*c4 + x*((LAG_LANE)5*c5)))))/h\n"
  "                                : (s + x*((LAG_LANE)6*c3 + x*((LAG_LANE)12*c4 + x*((LAG_LANE)20*c5))))/(h*h);\n"
  "  return LAG_SELECT(part < zero, zero, LAG_SELECT(part > one, zero, d));\n"
  "}\n"
  "\n/* A derivative of the curve through n rows, which has four that are continuous. */\n"
  "static LAG_REAL lag_curve(LAG_REAL t, int n, const LAG_LANE (*row)[4], int order) {\n"
  "  int k = lag_interval(t, n, 4, row[0]);\n"
  "  LAG_REAL y = lag_quintic(t, order, row[k], row[k + 1]);\n"
  "  for (k++; k < n - 1; k++) { /* lanes that are further on */\n"
  "    const LAG_MASK later = t >= LAG_C(0.0) + row[k][0];\n"
  "    if (!LAG_ANY(later)) break;\n"
  "    y = LAG_SELECT(later, lag_quintic(t, order, row[k], row[k + 1]), y);\n"
  "  }\n"
  "  return y;\n"
  "}\n";

void csupport_expand(const char *text, const char *prefix, const char *lower, StrBuf *out) {
  for (const char *s = text; *s;) {
    int upper = strncmp(s, "LAG_", 4) == 0, is_lower = strncmp(s, "lag_", 4) == 0;
    if (upper || is_lower) {
      sb_printf(out, "%s_", upper ? prefix : lower);
      s += 4;
    } else {
      sb_putc(out, *s++);
    }
  }
}

void csupport_logic(const char *prefix, StrBuf *out) {
  embedded_section("logic", prefix, "", out);
  csupport_expand(strcmp(prefix, "LAG") == 0 ? positive : positive_of_header, prefix, "", out);
}
void csupport_solver(const char *prefix, const char *lower, StrBuf *out) { csupport_expand(solver, prefix, lower, out); }
void csupport_splines(const Prog *inputs, const char *prefix, const char *lower, StrBuf *out) {
  int some[2] = {0};
  for (uint32_t i = 0; i < inputs->tables.n; i++) some[inputs->tables.at[i].curve->jet != NULL] = 1;
  if (some[0] || some[1]) csupport_expand(interval, prefix, lower, out);
  if (some[0]) csupport_expand(cubic, prefix, lower, out);
  if (some[1]) csupport_expand(quintic, prefix, lower, out);
}

/* Whether the program uses the parameter `name`: reads, writes, or needs it as workspace. */
static int is_used(const Prog *p, const CStyle *st, const char *name) {
  if (strcmp(name, "w") == 0) return p->solves.n > 0;
  for (int k = 0; k < ARR_COUNT; k++)
    if (st->in[k] && strcmp(name, st->in[k]) == 0 && prog_reads(p, (IrArray)k)) return 1;
  for (uint32_t k = 0; k < p->stores.n; k++)
    if (strcmp(st->out[p->stores.at[k].array], name) == 0) return 1;
  return 0;
}

static void write_unused(const Prog *p, const CStyle *st, StrBuf *out) {
  int some = 0;
  for (int i = 0; st->own[i]; i++)
    if (!is_used(p, st, st->own[i])) sb_printf(out, "%s(void)%s;", some++ ? " " : "  ", st->own[i]);
  if (some) sb_putc(out, '\n');
}

const char *cfunction_status(const Prog *p, const CStyle *style) {
  return arena_printf(p->arena, "%s_%s", style->prefix, prog_has_pivots(p) ? "PIVOTS_STATUS" : "OK");
}

void cfunction(const Prog *p, const CStyle *style, const CFunction *f, StrBuf *out) {
  sb_putc(out, '\n');
  if (f->comment) sb_printf(out, "/* %s */\n", comment_text(p->arena, f->comment));
  sb_printf(out, "%s {\n", f->head);
  write_unused(p, style, out);
  if (f->own_work && p->solves.n) sb_printf(out, "  %s_REAL w[%u];\n", style->prefix, prog_work_size(p));
  cwrite_body(p, style, p->arena, out);
  if (f->returns) sb_printf(out, "  return %s;\n", cfunction_status(p, style));
  sb_puts(out, "}\n");
}

const char *shortest_double(Arena *a, double x) {
  char text[32];
  if (x > -1e9 && x < 1e9 && (double)(int)x == x) return arena_printf(a, "%d", (int)x); /* 10, not 1e+01 */
  num_format_double(text, x);
  return arena_strdup(a, text);
}

void cwrite_guarded(const char *condition, const char *body, StrBuf *out) {
  body += strspn(body, "\n ");
  int one = strchr(body, '\n') == body + strlen(body) - 1 && strncmp(body, "const ", 6) != 0;
  if (one) sb_printf(out, "  %s%s", condition, body);
  else sb_printf(out, "  %s{\n", condition);
  while (!one && *body) {
    size_t n = strcspn(body, "\n");
    if (n) sb_printf(out, "    %.*s\n", (int)n, body);
    body += n;
    body += strspn(body, "\n ");
  }
  if (!one) sb_puts(out, "  }\n");
}
