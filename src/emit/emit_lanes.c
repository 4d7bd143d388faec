/* Models compiled once more for vectors of 4 and 8 doubles, each lane with a run of its own: the files, the table of
 * their scenes, and the convolution sums of Taylor series. */
#include "emit/emit_impl.h"
#include "emit/emit_model.h"
#include "emit/emit_lanes_text.h"

/* Where a file is compiled for lanes. Clang passes vectors of 8 doubles as the file's flags say, whatever the
 * function's target. */
static const char *lanes_condition(int lanes) {
  return lanes == 8 ? "defined(__GNUC__) && defined(__x86_64__) && !defined(__clang__)" : "defined(__GNUC__)";
}

void emit_lanes(const ProgramSet *u, const char *name, const char *text, int lanes, StrBuf *out) {
  sb_printf(out, "/* %s for vectors of %d doubles. */\n#if %s\n", text, lanes, lanes_condition(lanes));
  if (lanes == 8) sb_puts(out, "#pragma GCC target(\"avx512f,avx512dq\")\n");
  sb_printf(out, "#define LAG_LANES %d\n#define %s %s_lanes_%d\n", lanes, name, name, lanes);
  for (uint32_t k = 0; k < u->scenes.n; k++)
    sb_printf(out, "#define %s_%s %s_%s_lanes_%d\n", name, scene_id(u, k), name, scene_id(u, k), lanes);
  sb_printf(out, "#include \"%s\"\n#endif\n", text);
}

void emit_lane_scenes(const ProgramSet *const *units, const char *const *names, uint32_t n, int lanes, StrBuf *out) {
  sb_printf(out, "#if %s\n", lanes_condition(lanes));
  for (uint32_t i = 0; i < n; i++)
    for (uint32_t k = 0; k < units[i]->scenes.n; k++)
      sb_printf(out, "extern const lag_scene %s_%s_lanes_%d;\n", names[i], scene_id(units[i], k), lanes);
  sb_printf(out, "static const lag_scene *const lanes_%d[] = {\n", lanes);
  for (uint32_t i = 0; i < n; i++)
    for (uint32_t k = 0; k < units[i]->scenes.n; k++)
      sb_printf(out, "  &%s_%s_lanes_%d,\n", names[i], scene_id(units[i], k), lanes);
  sb_printf(out, "};\n#else\nstatic const lag_scene *const *const lanes_%d = NULL;\n#endif\n\n", lanes);
}

enum { WRITTEN_MOST = 24 }; /* sums that are written out, where the step of an order is inlined, too */
enum { ARRAY_A = 2, ARRAY_B = 3 }; /* outputs of Series.next */

/* The columns of the factors of a sum. */
typedef struct {
  uint32_t a, b;
} Factors;

/* Columns of the sums, those of squares from first_square on; factor[n]: the store of the coefficient in column n. */
typedef struct {
  Factors *of;
  const Store **factor;
  uint32_t n;
} FactorColumns;

static int writes_sums(const Series *s) {
  return s->sums + s->squares <= WRITTEN_MOST && ops_total(prog_count(s->next)) <= TAYLOR_INLINE_MAX;
}

static uint32_t column_of(FactorColumns *c, const Store *st) {
  for (uint32_t i = 0; i < c->n; i++)
    if (c->factor[i]->slot == st->slot) return i;
  c->factor[c->n] = st;
  return c->n++;
}

static FactorColumns factor_columns(const Series *s) {
  Arena *a = s->first->arena;
  FactorColumns c = {ARENA_ARRAY(a, Factors, s->width), ARENA_ARRAY(a, const Store *, s->width + s->first_square), 0};
  vec_each(const Store, st, s->next->stores) {
    if (st->array == ARRAY_A) c.of[st->index].a = column_of(&c, st);
    if (st->array == ARRAY_A && st->index >= s->first_square) c.of[st->index].b = c.of[st->index].a;
    if (st->array == ARRAY_B) c.of[st->index].b = column_of(&c, st);
  }
  return c;
}

uint32_t emit_lane_factors(const Series *s) {
  uint32_t n = writes_sums(s) ? factor_columns(s).n : s->width + s->first_square;
  return n ? n : 1;
}

static uint32_t sum_count(const Series *s) { return s->sums + s->squares; }
static uint32_t sum_at(const Series *s, uint32_t k) { return k < s->sums ? k : s->first_square + k - s->sums; }

/* taylor_far of all sums: pairs that share a factor, then the others. */
static void written_far(const Series *s, StrBuf *out) {
  FactorColumns c = factor_columns(s);
  uint32_t n = sum_count(s);
  char *done = ARENA_ARRAY(s->first->arena, char, n + 1);
  for (int any = 0; any < 2; any++)
    for (uint32_t i = 0; i < n; i++) {
      Factors f = c.of[sum_at(s, i)], other = f;
      uint32_t k = i + 1;
      for (; k < n && !done[i]; k++) {
        other = c.of[sum_at(s, k)];
        if (!done[k] && (any || f.a == other.a || f.b == other.b)) break;
      }
      if (done[i] || (k == n && !any)) continue;
      if (k == n) k = i, other = f;
      done[i] = done[k] = 1;
      sb_printf(out, "    taylor_far(k, f, %u, %u, %u, %u, %u, %u, s, far);\n", sum_at(s, i), f.a, f.b, sum_at(s, k),
                other.a, other.b);
    }
}

static void looped_far(uint32_t from, uint32_t n, const char *b, StrBuf *out) {
  if (n > 1)
    sb_printf(out, "    for (int g = %u; g < %u; g += 2) taylor_far(k, f, g, g, %sg, g + 1, g + 1, %sg + 1, s, far);\n",
              from, from + n / 2 * 2, b, b);
  if (n % 2)
    sb_printf(out, "    taylor_far(k, f, %u, %u, %s%u, %u, %u, %s%u, s, far);\n", from + n - 1, from + n - 1, b,
              from + n - 1, from + n - 1, from + n - 1, b, from + n - 1);
}

/* s := the sums of an order by an expression in k, f and the columns $a and $b of sum $g. */
static void each_sum(const Series *s, const char *text, StrBuf *out) {
  int written = writes_sums(s);
  FactorColumns c = written ? factor_columns(s) : (FactorColumns){0};
  for (uint32_t i = 0; i < (written ? sum_count(s) : 2); i++) {
    uint32_t g = sum_at(s, i), from = i ? s->first_square : 0, n = i ? s->squares : s->sums;
    if (!written && !n) continue;
    if (!written) sb_printf(out, "    for (int g = %u; g < %u; g++) s[g] = ", from, from + n);
    else sb_printf(out, "    s[%u] = ", g);
    for (const char *at = text; *at; at++)
      if (*at != '$') sb_putc(out, *at);
      else if (*++at == 'g') sb_printf(out, written ? "%u" : "g", g);
      else if (written) sb_printf(out, "%u", *at == 'a' ? c.of[g].a : c.of[g].b);
      else sb_puts(out, *at == 'a' || i ? "g" : "TAYLOR_SUMS + g");
    sb_puts(out, ";\n");
  }
}

void emit_lane_sums(const Series *s, StrBuf *out) {
  int written = writes_sums(s);
  sb_puts(out, sums);
  sb_puts(out, "\n/* The step from order k to k + 1; returns 1/(k + 1). */\n"
               "static TAYLOR_INLINE LAG_REAL taylor_order(int k, LAG_REAL T, LAG_REAL per_k, const LAG_REAL *s, "
               "LAG_REAL *x, taylor_work *w) {\n"
               "  LAG_REAL *const row = x + k*TAYLOR_COLUMNS;\n"
               "  const LAG_REAL per_next = LAG_C(1.0)/(LAG_LANE)(k + 1);\n");
  if (written) sb_puts(out, "  LAG_REAL a[TAYLOR_SUMS], b[TAYLOR_SQUARES];\n");
  sb_printf(
      out,
      "  taylor_next(LAG_C(0.0) + (LAG_LANE)k, per_k, T*per_next, s, w->c, row, row, row + TAYLOR_COLUMNS, %s%s);\n",
      written ? "a, b" : "w->f[k], w->f[k] + TAYLOR_SUMS", s->room ? ", w->m" : "");
  FactorColumns c = written ? factor_columns(s) : (FactorColumns){0};
  for (uint32_t i = 0; i < c.n; i++)
    sb_printf(out, "  w->f[k][%u] = %c[%u];\n", i, c.factor[i]->array == ARRAY_A ? 'a' : 'b', c.factor[i]->index);
  if (s->uses_time) sb_printf(out, "  row[TAYLOR_COLUMNS + %u] = LAG_C(0.0);\n", 3*s->nq + 2*s->nz);
  sb_puts(out, "  return per_next;\n}\n");
}

/* Orders 1 and 2, whose sums have no and one term; then three orders a turn, as their sums are begun together. */
void emit_lane_orders(const Series *s, StrBuf *out) {
  static const char *const order = "per_k = taylor_order(k, T, per_k, s, x, w);\n";
  int written = writes_sums(s);
  sb_printf(out, "  const taylor_rows f = (taylor_rows)w->f;\n  %s\n",
            written ? "LAG_REAL s[TAYLOR_SUMS], far[2][TAYLOR_SUMS];"
                    : "LAG_REAL *const s = w->s, (*const far)[TAYLOR_SUMS] = w->far;");
  sb_printf(out, "  int k = 1;\n"
                 "  (void)f; (void)far;\n"
                 "  for (int i = 0; i < TAYLOR_SUMS; i++) s[i] = LAG_C(0.0);\n"
                 "  for (; k < n && k < 3; k++) {\n    %s", order);
  each_sum(s, "f[1][$a]*f[1][$b]", out);
  sb_puts(out, "  }\n  for (; k < n; k++) {\n");
  if (written) written_far(s, out);
  else looped_far(0, s->sums, "TAYLOR_SUMS + ", out), looped_far(s->first_square, s->squares, "", out);
  sb_printf(out, "    %s    if (++k == n) break;\n", order);
  each_sum(s, "taylor_near_1(k, f, $a, $b, far[0][$g])", out);
  sb_printf(out, "    %s    if (++k == n) break;\n", order);
  each_sum(s, "taylor_near_2(k, f, $a, $b, far[1][$g])", out);
  sb_printf(out, "    %s  }\n", order);
}
