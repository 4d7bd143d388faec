/* C of the Taylor recurrences: order 0, the step from order k to k + 1, the convolution sums over rows of
 * coefficients, and the evaluation of the series. In model files each row operation also with vectors of four
 * doubles (AVX2); in headers plain C, whose names begin with the header's prefix. Order of operations, and so the
 * bits, are the same. */
#include "emit/emit_impl.h"
#include "emit/emit_taylor_text.h"

#include <string.h>

enum { LANES = 4 };    /* row lengths are multiples of this */
enum { CALL = 25 };    /* extra cost of a function call, in operations */
/* most sums of one kind that stay in registers from one order to the next: see register_sums */
enum { REGISTER_SUMS_MAX = 12 };
enum { LOOP_FROM = 9 }; /* statements that differ in an index only become a loop from this number on */

static const char *const arrays[ARR_COUNT] = {
  "t", "q", "v", "z", "p", "u", [ARR_FREE] = "follows", [ARR_COEF] = "y", [ARR_SUMS] = "s", [ARR_STEP] = "c",
  [ARR_ORDER] = "order", [ARR_PER_ORDER] = "per_order", [ARR_UP] = "up",
};

/* Pair g of a row held in pairs, or in fours. */
static const char *const part =
    "static TAYLOR_INLINE taylor_pair taylor_part(const taylor_pair *x, int g) { return x[g]; }\n";
static const char *const along_rows_comment =
    "\n/* Along rows of numbers.\n"
    " *   taylor_sums      s = a[1] b[k-1] + ... + a[k-1] b[1]. What order k - 1 has just made comes last, and in "
    "pairs, as it was\n"
    " *                    stored: a processor hands on what it has just stored only to loads of no more than that.\n"
    " *   taylor_squares   the same where b is a: twice the first half, and the middle\n"
    " *   taylor_rest      orders 1 to n\n"
    " *   taylor_at        y = x[1] s + ... + x[n] s^n for q, v and z, and dy its derivative by s: even and odd powers "
    "by\n"
    " *                    Horner's rule, side by side: u e(u) + s o(u), u = s^2. Both have room for TAYLOR_WIDTH. */";

static const char *const along_rows_of_header =
    "\n/* Along rows of coefficients. taylor_sums: s = a[1] b[k-1] + ... + a[k-1] b[1]; taylor_squares: the same where "
    "b is a; taylor_rest: orders 1 to n;\n"
    " * taylor_at: y = x[1] s + ... + x[n] s^n, by even and odd powers, and dy its derivative by s. */";

/* out: text to be written, with the names of model files; it goes to `file`, in headers with the prefix. */
typedef struct {
  const Series *s;
  const CStyle *base;
  const char *lower; /* prefix of a header in lower case; NULL: a model file */
  int lanes;         /* a model file that is compiled for lanes */
  Arena *a;
  StrBuf *out, *file;
} TaylorWriter;

static int is_letter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
}

/* Moves the text to the file. Names of headers: lag_, taylor_ and their capitals begin with the prefix, pairs are
 * numbers. */
static void flush(const TaylorWriter *w) {
  const char *text = sb_text(w->out), *prefix = w->base->prefix;
  if (!w->lower) sb_puts(w->file, text);
  for (const char *s = text; w->lower && *s;) {
    int starts = s == text || !is_letter(s[-1]);
    if (!starts) sb_putc(w->file, *s++);
    else if (strncmp(s, "taylor_pair", 11) == 0) sb_printf(w->file, "%s_REAL", prefix), s += 11;
    else if (strncmp(s, "TAYLOR_INLINE ", 14) == 0) s += 14;
    else if (strncmp(s, "LAG_", 4) == 0) sb_printf(w->file, "%s_", prefix), s += 4;
    else if (strncmp(s, "lag_", 4) == 0) sb_printf(w->file, "%s_", w->lower), s += 4;
    else if (strncmp(s, "TAYLOR_", 7) == 0) sb_printf(w->file, "%s_", prefix), sb_puts(w->file, "TAYLOR_"), s += 7;
    else if (strncmp(s, "taylor_", 7) == 0) sb_printf(w->file, "%s_", w->lower), sb_puts(w->file, "taylor_"), s += 7;
    else sb_putc(w->file, *s++);
  }
  w->out->n = 0;
}

static void body(const TaylorWriter *w, const Prog *p, const CStyle *style) {
  flush(w);
  cwrite_body(p, style, w->a, w->file);
}

static CStyle style_for(const TaylorWriter *w, const char *const *own, const char *const *written) {
  CStyle st = *w->base;
  st.in = arrays;
  st.out = written;
  st.own = own;
  return st;
}

/* Whether the sums are few enough that the coefficients of the last order stay in registers. */
int taylor_sums_fit_registers(const Series *s) {
  return s->first_square <= s->group && s->width - s->first_square <= s->group &&
         s->sums <= REGISTER_SUMS_MAX && s->squares <= REGISTER_SUMS_MAX &&
         ops_total(prog_count(s->next)) <= TAYLOR_INLINE_MAX;
}

static int sums_fit_registers(const TaylorWriter *w) { return !w->lanes && taylor_sums_fit_registers(w->s); }

static uint32_t even(uint32_t n) { return (n + 1) / 2 * 2; }

static void work(const TaylorWriter *w) {
  const Series *s = w->s;
  uint32_t width = (2 * s->nq + s->nz + LANES - 1) / LANES * LANES;
  sb_printf(w->out,
            "enum { TAYLOR_COLUMNS = %u, TAYLOR_WIDTH = %u, TAYLOR_GROUP = %u, TAYLOR_SQUARES = %u, TAYLOR_SUMS = %u, "
            "TAYLOR_CONSTANTS = %u",
            s->columns, width, s->group, s->first_square, s->width, s->constants ? s->constants : 1);
  if (sums_fit_registers(w))
    sb_printf(w->out, "%sTAYLOR_STATE = %u, TAYLOR_PAIRED = %u, TAYLOR_SQUARED = %u, TAYLOR_PER_PAIR = %s",
              w->lower ? ",\n       " : " };\nenum { ", even(2 * s->nq + s->nz), even(s->sums), even(s->squares),
              w->lower ? "1" : "sizeof(taylor_pair)/sizeof(LAG_REAL)");
  sb_puts(w->out, " };\n");
  const char *some = w->lower ? " + 1" : ""; /* C99 has no empty arrays */
  if (w->lanes)
    sb_printf(w->out, "enum { TAYLOR_FACTORS = %u };\ntypedef struct {\n"
      "  LAG_REAL f[LAG_TAYLOR_ORDER][TAYLOR_FACTORS]; /* by order: the factors of the sums */\n"
      "  LAG_REAL s[TAYLOR_SUMS], far[2][TAYLOR_SUMS];\n", emit_lane_factors(s));
  else
    sb_printf(w->out, "typedef struct {\n"
    "  LAG_REAL a[LAG_TAYLOR_ORDER][TAYLOR_SUMS%s]; /* by order: the factors of the sums */\n"
    "  LAG_REAL b[LAG_TAYLOR_ORDER][TAYLOR_SQUARES%s];\n"
    "  LAG_REAL s[TAYLOR_SUMS%s];\n", some, some, some);
  sb_puts(w->out, "  LAG_REAL c[TAYLOR_CONSTANTS];              /* constants computed by order 0 */\n");
  if (s->room) sb_printf(w->out, "  LAG_REAL m[%u];\n", s->room);
  sb_puts(w->out, "} taylor_work;\n");
}

static void copy(const TaylorWriter *w, const char *name, uint32_t n, uint32_t from) {
  for (uint32_t i = 0; i < n && n < LOOP_FROM; i++) sb_printf(w->out, "  x[%u] = %s[%u];\n", from + i, name, i);
  if (n >= LOOP_FROM)
    sb_printf(w->out,
              from ? "  for (int i = 0; i < %u; i++) x[i + %u] = %s[i];\n"
                   : "  for (int i = 0; i < %u; i++) x[i%.0u] = %s[i];\n",
              n, from, name);
}

/* The first parameter of a model's functions; headers have none. */
static const char *self_parameter(const TaylorWriter *w) { return w->lower ? "" : "const void *self, "; }
static const char *self_unused(const TaylorWriter *w) { return w->lower ? "" : "  (void)self;\n"; }
static const char *work_type(const TaylorWriter *w) { return w->lower ? "taylor_work" : "LAG_REAL"; }

static void first(const TaylorWriter *w) {
  static const char *const own[] = {"self", "t", "q", "v", "z", "p", "u", "follows", "x", "c", "w", "work", NULL};
  static const char *const written[] = {"x", "c"};
  const Series *s = w->s;
  CStyle st = style_for(w, own, written);
  sb_printf(w->out, "\n/* Order 0: %s. */\n", op_count_text(s->first, w->a));
  sb_printf(
      w->out,
      "static int taylor_first(%sLAG_REAL t, const LAG_REAL *q, const LAG_REAL *v, const LAG_REAL *z,%sconst %s *p,%s"
      "const LAG_REAL *u, const LAG_REAL *follows, LAG_REAL *x, %s *work) {\n"
      "  LAG_REAL *const c = ((taylor_work *)(void *)work)->c;\n%s",
      self_parameter(w), w->lower ? " " : "\n    ", w->lower ? "lag_params" : "LAG_REAL", w->lower ? "\n    " : " ",
      work_type(w), self_unused(w));
  if (s->room) sb_puts(w->out, "  LAG_REAL *const w = ((taylor_work *)(void *)work)->m;\n");
  sb_puts(w->out, "  (void)t; (void)q; (void)v; (void)z; (void)p; (void)u; (void)follows; (void)c;\n");
  copy(w, "q", s->nq, 0);
  copy(w, "v", s->nq, s->nq);
  copy(w, "z", s->nz, 2 * s->nq);
  body(w, s->first, &st);
  sb_printf(w->out, "  return %s;\n}\n", cfunction_status(s->first, &st));
}

static void next(const TaylorWriter *w) {
  static const char *const own[] = {"x", "x1", "y", "a", "b", "s", "c", "order", "per_order", "up", "w", NULL};
  static const char *const written[] = {"x", "x1", "a", "b"};
  const Series *s = w->s;
  CStyle st = style_for(w, own, written);
  if (!w->lower && !w->lanes) {
    st.paired = 1u << 0 | 1u << 1 | 1u << 2 | 1u << 3;
    st.padded = 1u << 2 | 1u << 3 | (unsigned)sums_fit_registers(w) << 1;
  }
  st.is_regular = 1; /* as at order 0 */
  st.apart = 1; /* y may be x: it reads the state and t, and writes the rates */
  sb_printf(w->out, "\n/* Order k > 0, besides the sums: %s. Each name stands for coefficient k of its value. */\n",
            op_count_text(s->next, w->a));
  sb_printf(w->out, "static %svoid taylor_next(",
            !w->lower && ops_total(prog_count(s->next)) <= TAYLOR_INLINE_MAX ? "TAYLOR_INLINE " : "");
  sb_puts(w->out,
          "LAG_REAL order, LAG_REAL per_order, LAG_REAL up, const LAG_REAL *s, const LAG_REAL *c, const LAG_REAL *y,\n"
          "    LAG_REAL *x, LAG_REAL *x1, LAG_REAL *a, LAG_REAL *b");
  sb_puts(w->out, s->room ? ", LAG_REAL *w) {\n" : ") {\n");
  sb_puts(w->out, "  (void)order; (void)per_order; (void)up; (void)s; (void)c; (void)y; (void)a; (void)b;\n");
  body(w, s->next, &st);
  sb_puts(w->out, "}\n");
}

/* Appends the head of the loop `~N` at text, indented as in its line (begin: of the template); returns the length of
 * N. */
static size_t unrolled(const TaylorWriter *w, const char *begin, const char *text) {
  size_t column = 0, n = strspn(text + 1, "ABCDEFGHIJKLMNOPQRSTUVWXYZ");
  while (text - column > begin && *(text - column - 1) == ' ') column++;
  if (!w->lower) sb_printf(w->out, "TAYLOR_UNROLL\n%*s", (int)column, "");
  sb_printf(w->out, "for (int g = 0; g < (int)%.*s; g++)", (int)n, text + 1);
  return n;
}

/* Appends a template with its marks filled in. The loop over orders is unrolled where there is a single group of
 * sums. */
static void fill(const TaylorWriter *w, const char *text, const char *suffix, const char *type, const char *attribute) {
  StrBuf *out = w->out;
  for (const char *begin = text; *text; text++)
    if (*text == '$') sb_puts(out, suffix);
    else if (*text == '#' && text[1] == ' ') sb_puts(out, type);
    else if (*text == '#' && text[1] == ')') sb_puts(out, type);
    else if (*text == '@') sb_puts(out, attribute);
    else if (*text == '^' && text[1] == ' ') sb_puts(out, self_unused(w));
    else if (*text == '^' && text[1] == 'i') sb_puts(out, self_parameter(w));
    else if (w->lower && strncmp(text, "  TAYLOR_UNROLL_4\n", 18) == 0) text += 17;
    else if (w->lower && strncmp(text, "taylor_part$(far, g)", 20) == 0) sb_puts(out, "far[g]"), text += 19;
    else if (*text == '~') text += unrolled(w, begin, text);
    else if (*text == '%' && text[1] == ' ')
      sb_puts(out, !w->lower && w->s->first_square == w->s->group ? "    TAYLOR_UNROLL_4\n" : "");
    else sb_putc(out, *text);
}

/* Column of order 0 that holds the rate of column i of the state. */
static uint32_t rate_column(const Series *s, uint32_t i) { return i < s->nq ? s->nq + i : s->nq + s->nz + i; }

/* Writes x[to + i] of order 1 = T times x[from + i] of order 0, for i < n. */
static void rate(const TaylorWriter *w, uint32_t to, uint32_t from, uint32_t n) {
  if (n)
    sb_printf(w->out, "  for (int i = %u; i < %u; i++) x[TAYLOR_COLUMNS + i] = T*x[i + %u];\n", to, to + n, from - to);
}

/* Clears the padding of the last groups. Up to 15 sums are stored in pairs, an odd last one together with a zero. */
static void clear_padding(const TaylorWriter *w) {
  const Series *s = w->s;
  uint32_t filled = s->sums < 16 && !w->lower ? even(s->sums) : s->sums;
  if (filled < s->first_square)
    sb_printf(w->out, "  for (int k = 1; k < n; k++) /* what fills the last group */\n"
                      "    for (int i = %u; i < TAYLOR_SQUARES; i++) w->a[k][i] = w->b[k][i] = LAG_C(0.0);\n", filled);
  if (s->first_square + s->squares < s->width)
    sb_printf(w->out,
              "  for (int k = 0; k < n; k++)\n"
              "    for (int i = %u; i < TAYLOR_SUMS; i++) w->a[k][i] = LAG_C(0.0);\n",
              s->first_square + s->squares);
}

/* Loop over orders with rows in memory. */
static void orders_in_memory(const TaylorWriter *w, const char *suffix) {
  const Series *s = w->s;
  sb_puts(w->out, "  for (int k = 1; k < n; k++) {\n"
                  "    LAG_REAL *const row = x + k*TAYLOR_COLUMNS;\n"
                  "    const LAG_REAL per_next = LAG_C(1.0)/(LAG_LANE)(k + 1);\n");
  if (s->sums) sb_printf(w->out, "    taylor_sums%s(k, w);\n", suffix);
  if (s->squares) sb_printf(w->out, "    taylor_squares%s(k, w);\n", suffix);
  sb_printf(w->out,
            "    taylor_next(LAG_C(0.0) + (LAG_LANE)k, per_k, T*per_next, w->s, w->c, row, row, row + TAYLOR_COLUMNS, "
            "w->a[k], w->b[k]%s);\n",
            s->room ? ", w->m" : "");
}

/* Loop over orders with the state and the factors of sums in registers: the arrays of pairs y1, a and b, which
 * compilers keep in registers because no single element is addressed; y and s are copies whose elements are. */
static void orders_in_registers(const TaylorWriter *w, const char *suffix) {
  const Series *s = w->s;
  uint32_t state = 2 * s->nq + s->nz;
  int reads_row = s->uses_time; /* t stands behind the state, in the row */
  fill(w,
       "  enum { STATE = TAYLOR_STATE/TAYLOR_PER_PAIR, PAIRS = TAYLOR_PAIRED/TAYLOR_PER_PAIR, SQUARES = "
       "TAYLOR_SQUARES/TAYLOR_PER_PAIR,\n"
       "    ALL = TAYLOR_SQUARED",
       "", "", "");
  sb_puts(w->out, w->lower ? " > 0" : ""); /* C++ compilers warn of a number as a condition */
  fill(w, " ? SQUARES + TAYLOR_SQUARED/TAYLOR_PER_PAIR : PAIRS };\n"
          "  const taylor_pair zero = {0};\n"
          "  taylor_pair y1[STATE], a[ALL + 1], b[PAIRS + 1];\n"
          "  ~ALL a[g] = zero;\n"
          "  ~PAIRS b[g] = zero;\n", "", "", "");
  for (uint32_t i = 0; i < state; i += 2) {
    if (w->lower) {
      sb_printf(w->out, "  y1[%u] = T*x[%u];\n", i, rate_column(s, i));
      if (i + 1 < state) sb_printf(w->out, "  y1[%u] = T*x[%u];\n", i + 1, rate_column(s, i + 1));
      else sb_printf(w->out, "  y1[%u] = LAG_C(0.0);\n", i + 1);
      continue;
    }
    sb_printf(w->out, "  LAG_PAIR(y1, %u, T*x[%u], ", i, rate_column(s, i));
    if (i + 1 < state) sb_printf(w->out, "T*x[%u]);\n", rate_column(s, i + 1));
    else sb_puts(w->out, "LAG_C(0.0));\n");
  }
  fill(w, "  ~STATE ((taylor_pair *)(x + TAYLOR_COLUMNS))[g] = y1[g];\n"
          "  for (int k = 1; k < n; k++) {\n"
          "    LAG_REAL *const row = x + k*TAYLOR_COLUMNS;\n"
          "    const LAG_REAL per_next = LAG_C(1.0)/(LAG_LANE)(k + 1);\n"
          "    taylor_pair s[ALL + 1], sum[ALL + 1];\n", "", "", "");
  if (!reads_row) fill(w, "    taylor_pair y[STATE];\n"
                          "    ~STATE y[g] = y1[g];\n", "", "", "");
  if (s->sums) sb_printf(w->out, "    taylor_sums%s(k, w, a, b, sum);\n", suffix);
  if (s->squares) sb_printf(w->out, "    taylor_squares%s(k, w, a + SQUARES, sum + SQUARES);\n", suffix);
  fill(w, "    ~ALL s[g] = sum[g];\n", "", "", "");
  sb_printf(w->out,
            "    taylor_next(LAG_C(0.0) + (LAG_LANE)k, per_k, T*per_next, (const LAG_REAL *)s, w->c, %s, row, "
            "(LAG_REAL *)y1, (LAG_REAL *)a, (LAG_REAL *)b%s);\n",
            reads_row ? "row" : "(const LAG_REAL *)y", s->room ? ", w->m" : "");
  fill(w, "    ~STATE ((taylor_pair *)(row + TAYLOR_COLUMNS))[g] = y1[g];\n"
          "    ~ALL ((taylor_pair *)w->a[k])[g] = a[g];\n"
          "    ~PAIRS ((taylor_pair *)w->b[k])[g] = b[g];\n", "", "", "");
}

static void rest(const TaylorWriter *w, const char *suffix, const char *attribute) {
  const Series *s = w->s;
  uint32_t nq = s->nq, nz = s->nz, t = 3 * nq + 2 * nz;
  sb_printf(w->out, "\n%sstatic void taylor_rest%s(%sint n, LAG_REAL T, LAG_REAL *x, %s *work) {\n"
                    "  taylor_work *const w = (taylor_work *)(void *)work;\n"
                    "  LAG_REAL per_k = LAG_C(1.0);\n%s",
            attribute, suffix, self_parameter(w), work_type(w), self_unused(w));
  if (s->uses_time) sb_printf(w->out, "  x[TAYLOR_COLUMNS + %u] = T;\n", t);
  if (!w->lanes) clear_padding(w);
  if (sums_fit_registers(w)) {
    orders_in_registers(w, suffix);
  } else {
    rate(w, 0, nq, nq);
    rate(w, nq, 2 * nq + nz, nq + nz);
    if (w->lanes) emit_lane_orders(s, w->out);
    else orders_in_memory(w, suffix);
  }
  if (s->uses_time && !w->lanes) sb_printf(w->out, "    row[TAYLOR_COLUMNS + %u] = LAG_C(0.0);\n", t);
  sb_puts(w->out, w->lanes ? "}\n" : "    per_k = per_next;\n  }\n}\n");
}

/* Rates along a curve of states, for small motion: seldom called, so its sums are plain. */
static void along(const TaylorWriter *w) {
  const Series *s = w->s;
  sb_puts(w->out, "\n/* Rates along a curve of states, whose coefficients are given. */\n"
                  "static void taylor_along(const void *self, int n, LAG_REAL *x, LAG_REAL *work) {\n"
                  "  taylor_work *const w = (taylor_work *)(void *)work;\n"
                  "  (void)self;\n"
                  "  for (int k = 1; k < n; k++) {\n"
                  "    LAG_REAL *const row = x + k*TAYLOR_COLUMNS;\n"
                  "    for (int i = 0; i < TAYLOR_SUMS; i++) {\n"
                  "      w->s[i] = LAG_C(0.0);\n"
                  "      for (int j = 1; j < k; j++)\n"
                  "        w->s[i] += w->a[j][i]*(i < TAYLOR_SQUARES ? w->b[k - j][i] : w->a[k - j][i]);\n"
                  "    }\n");
  sb_printf(w->out,
            "    const LAG_REAL order = LAG_C(0.0) + (LAG_LANE)k, per_k = LAG_C(1.0)/order,\n"
            "                   per_next = LAG_C(1.0)/(order + LAG_C(1.0));\n"
            "    taylor_next(order, per_k, per_next, w->s, w->c, row, row, x + n*TAYLOR_COLUMNS, w->a[k], w->b[k]%s);\n"
            "  }\n"
            "}\n",
            s->room ? ", w->m" : "");
}

/* Writes the row operations: sums, squares, all orders, evaluation of the series. */
static void row_operations(const TaylorWriter *w, const char *suffix, const char *type, const char *attribute) {
  int near = sums_fit_registers(w);
  if (w->lanes) emit_lane_sums(w->s, w->out);
  else if (w->s->sums) fill(w, near ? register_sums : sums, suffix, type, attribute);
  if (w->s->squares && !w->lanes) fill(w, near ? register_squares : squares, suffix, type, attribute);
  rest(w, suffix, attribute);
  fill(w, at, suffix, type, attribute);
}

static int is_wide(const Series *s) { return s->group > LANES || 2 * s->nq + s->nz > 2 * LANES; }

static void choose_width(StrBuf *out) {
  sb_puts(out,
    "\nstatic void taylor_rest_any(const void *self, int n, LAG_REAL T, LAG_REAL *x, LAG_REAL *work) {\n"
    "#ifdef TAYLOR_WIDE\n"
    "  if (__builtin_cpu_supports(\"avx2\")) {\n"
    "    taylor_rest_wide(self, n, T, x, work);\n"
    "    return;\n"
    "  }\n"
    "#endif\n"
    "  taylor_rest(self, n, T, x, work);\n"
    "}\n"
    "\nstatic void taylor_at_any(const void *self, int n, LAG_REAL s, const LAG_REAL *x, LAG_REAL *y, LAG_REAL *dy) {\n"
    "#ifdef TAYLOR_WIDE\n"
    "  if (__builtin_cpu_supports(\"avx2\")) {\n"
    "    taylor_at_wide(self, n, s, x, y, dy);\n"
    "    return;\n"
    "  }\n"
    "#endif\n"
    "  taylor_at(self, n, s, x, y, dy);\n"
    "}\n");
}

/* The lag_taylor of a model file. */
static void table(const TaylorWriter *w, int wide) {
  const Series *s = w->s;
  sb_puts(w->out, "\nstatic const lag_taylor taylor = {\n"
                  "  .order = LAG_TAYLOR_ORDER, .columns = TAYLOR_COLUMNS, .width = TAYLOR_WIDTH, .nw = "
                  "(int)(sizeof(taylor_work)/sizeof(LAG_REAL)),\n");
  TaylorCosts c = taylor_costs(s);
  if (w->lanes) sb_puts(w->out, "  .lanes = 1,\n");
  sb_printf(w->out, "  .cost_first = %u, .cost_next = %u, .sums = %u,\n", c.first, c.next, c.sums);
  sb_printf(w->out, "  .first = taylor_first, .rest = taylor_rest%s, .at = taylor_at%s,%s\n};\n", wide ? "_any" : "",
            wide ? "_any" : "", w->lanes ? "" : " .along = taylor_along,");
}

TaylorCosts taylor_costs(const Series *s) {
  OpCount c = prog_count(s->first);
  return (TaylorCosts){ops_as_int(ops_total(c) + CALL * c.fn), ops_as_int(ops_total(prog_count(s->next))),
                       s->sums + s->squares / 2};
}

static void emit_types(TaylorWriter w) {
  work(&w);
  flush(&w);
}

void emit_taylor_types(const Series *s, const CStyle *base, const char *lower, StrBuf *out) {
  StrBuf text = strbuf(s->first->arena);
  emit_types((TaylorWriter){.s = s, .base = base, .lower = lower, .a = s->first->arena, .out = &text, .file = out});
}

static void emit_functions(TaylorWriter w) {
  first(&w);
  next(&w);
  if (!w.lanes) sb_puts(w.out, w.lower ? along_rows_of_header : along_rows_comment);
  row_operations(&w, "", "taylor_pair", "");
  if (!w.lower && !w.lanes) along(&w);
  flush(&w);
}

void emit_taylor_functions(const Series *s, const CStyle *base, const char *lower, StrBuf *out) {
  StrBuf text = strbuf(s->first->arena);
  emit_functions((TaylorWriter){.s = s, .base = base, .lower = lower, .a = s->first->arena, .out = &text, .file = out});
}

void emit_taylor(const Series *s, const CStyle *base, int lanes, StrBuf *out) {
  StrBuf text = strbuf(s->first->arena);
  TaylorWriter w = {.s = s, .base = base, .lanes = lanes, .a = s->first->arena, .out = &text, .file = out};
  int wide = is_wide(s) && !lanes;
  sb_puts(&text, lanes ? lane_head : head);
  if (wide) sb_puts(&text, wide_head);
  if (sums_fit_registers(&w)) sb_puts(&text, part);
  sb_putc(&text, '\n');
  flush(&w);
  emit_types(w);
  emit_functions(w);
  if (wide) {
    sb_puts(&text, "\n#ifdef TAYLOR_WIDE\n/* The same four at a time. */");
    if (sums_fit_registers(&w)) sb_printf(&text, "\n%s", wide_part);
    row_operations(&w, "_wide", "taylor_four", "TAYLOR_WIDE ");
    sb_puts(&text, "#endif\n");
    choose_width(&text);
  }
  table(&w, wide);
  flush(&w);
}
