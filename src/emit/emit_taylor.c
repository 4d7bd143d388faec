#include "emit/emit_taylor.h"

#include <string.h>

#include "emit/cfunction.h"

enum { LANES = 4 }; /* sums are made in groups of so many, side by side: a C compiler turns them into vectors */

static const char *const arrays[ARR_COUNT] = {
  "t", "q", "v", "z", "p", "u", [ARR_FREE] = "follows", [ARR_COEF] = "x", [ARR_SUMS] = "s", [ARR_STEP] = "c",
  [ARR_ORDER] = "k", [ARR_PER_ORDER] = "per_k",
};

static const char *const head =
  "\n/* --- Taylor coefficients along the motion: of a value x(t), x^(k)(t) T^k/k! for orders k = 0, 1, ... --- */\n"
  "\n"
  "#ifndef LAG_TAYLOR_ORDER\n#define LAG_TAYLOR_ORDER 40\n#endif\n";

static const char *const sums =
  "\n/* s = a[1] b[k-1] + ... + a[k-1] b[1], with what order k - 1 has made as the last terms: a processor need not wait for\n"
  " * it to begin. */\n"
  "static void taylor_sums(int k, taylor_work *w) {\n"
  "  for (int i = 0; i < TAYLOR_SUMS; i += 4) {\n"
  "    LAG_REAL s0 = LAG_C(0.0), s1 = s0, s2 = s0, s3 = s0;\n"
  "    for (int j = 2; j < k - 1; j++) {\n"
  "      const LAG_REAL *const a = w->a[j] + i, *const b = w->b[k - j] + i;\n"
  "      s0 += a[0]*b[0];\n"
  "      s1 += a[1]*b[1];\n"
  "      s2 += a[2]*b[2];\n"
  "      s3 += a[3]*b[3];\n"
  "    }\n"
  "    for (int n = 0, j = 1; n < 2 && j < k; n++, j = k > 2 ? k - 1 : k) {\n"
  "      const LAG_REAL *const a = w->a[j] + i, *const b = w->b[k - j] + i;\n"
  "      s0 += a[0]*b[0];\n"
  "      s1 += a[1]*b[1];\n"
  "      s2 += a[2]*b[2];\n"
  "      s3 += a[3]*b[3];\n"
  "    }\n"
  "    w->s[i] = s0;\n"
  "    w->s[i + 1] = s1;\n"
  "    w->s[i + 2] = s2;\n"
  "    w->s[i + 3] = s3;\n"
  "  }\n"
  "}\n";

typedef struct {
  const Series *s;
  const char *const *globals;
  Arena *a;
  StrBuf *out;
} Writer;

static CStyle style_for(const Writer *w, const char *const *own, const char *const *written) {
  return (CStyle){.prefix = "LAG", .in = arrays, .out = written, .own = own, .globals = w->globals, .factor = "lag_factor", .substitute = "lag_substitute"};
}

static uint32_t at_least(uint32_t n, uint32_t least) { return n > least ? n : least; }

static void work(const Writer *w) {
  const Series *s = w->s;
  uint32_t whole = (s->sums + LANES - 1) / LANES * LANES;
  sb_printf(w->out, "enum { TAYLOR_COLUMNS = %u, TAYLOR_SUMS = %u, TAYLOR_CONSTANTS = %u };\n", s->columns, at_least(whole, LANES), at_least(s->constants, 1));
  sb_puts(w->out, "typedef struct {\n"
    "  LAG_REAL x[LAG_TAYLOR_ORDER + 1][TAYLOR_COLUMNS]; /* by order: q, v, z, v', z' */\n"
    "  LAG_REAL a[LAG_TAYLOR_ORDER + 1][TAYLOR_SUMS];    /* by order: what sums are made of */\n"
    "  LAG_REAL b[LAG_TAYLOR_ORDER + 1][TAYLOR_SUMS];\n"
    "  LAG_REAL s[TAYLOR_SUMS];\n"
    "  LAG_REAL c[TAYLOR_CONSTANTS];                     /* what order 0 leaves for all others */\n");
  if (s->room) sb_printf(w->out, "  LAG_REAL m[%u];\n", s->room);
  sb_puts(w->out, "} taylor_work;\n");
}

static void copy(const Writer *w, const char *name, uint32_t n, uint32_t from) {
  if (n == 1) sb_printf(w->out, "  x[%u] = %s[0];\n", from, name);
  else if (n && from) sb_printf(w->out, "  for (int i = 0; i < %u; i++) x[%u + i] = %s[i];\n", n, from, name);
  else if (n) sb_printf(w->out, "  for (int i = 0; i < %u; i++) x[i] = %s[i];\n", n, name);
}

static void first(const Writer *w) {
  static const char *const own[] = {"t", "q", "v", "z", "p", "u", "follows", "x", "c", "w", "work", NULL};
  static const char *const written[] = {"x", "c"};
  const Series *s = w->s;
  CStyle st = style_for(w, own, written);
  sb_printf(w->out, "\n/* Order 0: %s. */\n", ops_text(s->first, w->a));
  sb_puts(w->out, "static int taylor_first(LAG_REAL t, const LAG_REAL *q, const LAG_REAL *v, const LAG_REAL *z, const LAG_REAL *p,\n"
                  "    const LAG_REAL *u, const LAG_REAL *follows, LAG_REAL *work) {\n"
                  "  taylor_work *const w_ = (taylor_work *)(void *)work;\n"
                  "  LAG_REAL *const x = w_->x[0], *const c = w_->c;\n");
  if (s->room) sb_puts(w->out, "  LAG_REAL *const w = w_->m;\n");
  sb_puts(w->out, "  (void)t; (void)q; (void)v; (void)z; (void)p; (void)u; (void)follows; (void)c;\n");
  copy(w, "q", s->nq, 0);
  copy(w, "v", s->nq, s->nq);
  copy(w, "z", s->nz, 2 * s->nq);
  cwrite_body(s->first, &st, w->a, w->out);
  sb_puts(w->out, "  return LAG_OK;\n}\n");
}

static void next(const Writer *w) {
  static const char *const own[] = {"x", "a", "b", "s", "c", "k", "per_k", "w", NULL}, *const written[] = {"x", "a", "b"};
  const Series *s = w->s;
  CStyle st = style_for(w, own, written);
  sb_printf(w->out, "\n/* Order k > 0, besides the sums: %s. Each name stands for coefficient k of its value. */\n", ops_text(s->next, w->a));
  sb_puts(w->out, "static void taylor_next(LAG_REAL k, LAG_REAL per_k, const LAG_REAL *s, const LAG_REAL *c, LAG_REAL *x, LAG_REAL *a,\n"
                  "    LAG_REAL *b");
  sb_puts(w->out, s->room ? ", LAG_REAL *w) {\n" : ") {\n");
  sb_puts(w->out, "  (void)k; (void)per_k; (void)s; (void)c; (void)a; (void)b;\n");
  cwrite_body(s->next, &st, w->a, w->out);
  sb_puts(w->out, "}\n");
}

/* x[to + i] of order k := r times x[from + i] of order k - 1, for i < n. */
static void rate(const Writer *w, uint32_t to, uint32_t from, uint32_t n, const char *comment) {
  if (!n) return;
  sb_printf(w->out, "    for (int i = %u; i < %u; i++) x[i] = r*was[i + %u]; /* %s */\n", to, to + n, from - to, comment);
}

static void rest(const Writer *w) {
  const Series *s = w->s;
  uint32_t nq = s->nq, nz = s->nz, t = 3 * nq + 2 * nz;
  sb_puts(w->out, "\n/* Orders 1 to n. */\n"
                  "static void taylor_rest(int n, LAG_REAL T, LAG_REAL *work) {\n"
                  "  taylor_work *const w = (taylor_work *)(void *)work;\n"
                  "  for (int k = 1; k <= n; k++) {\n"
                  "    LAG_REAL *const x = w->x[k], *const was = w->x[k - 1];\n"
                  "    const LAG_REAL per_k = LAG_C(1.0)/(LAG_REAL)k, r = T*per_k;\n");
  rate(w, 0, nq, nq, "q' = v");
  rate(w, nq, 2 * nq + nz, nq + nz, nz ? "v', z'" : "v'");
  if (s->uses_time) sb_printf(w->out, "    x[%u] = k == 1 ? T : LAG_C(0.0); /* t */\n", t);
  sb_puts(w->out, "    if (k == n) return;\n");
  if (s->sums) sb_puts(w->out, "    taylor_sums(k, w);\n");
  sb_printf(w->out, "    taylor_next((LAG_REAL)k, per_k, w->s, w->c, x, w->a[k], w->b[k]%s);\n  }\n}\n", s->room ? ", w->m" : "");
}

void emit_taylor(const Series *s, const char *const *globals, StrBuf *out) {
  Writer w = {s, globals, s->first->arena, out};
  sb_puts(out, head);
  work(&w);
  if (s->room) csupport_factor("LAG", "lag", out);
  first(&w);
  if (s->sums) sb_puts(out, sums);
  next(&w);
  rest(&w);
  sb_puts(out, "\nstatic const lag_taylor taylor = {\n"
    "  .order = LAG_TAYLOR_ORDER, .columns = TAYLOR_COLUMNS, .nw = (int)(sizeof(taylor_work)/sizeof(LAG_REAL)),\n"
    "  .first = taylor_first, .rest = taylor_rest,\n};\n");
}
