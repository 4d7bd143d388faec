/* Tables of variables: entry by entry, or as runs of groups that differ in one number that counts up. */
#include "emit/emit_impl.h"
#include "emit/late_text.h"

#include <string.h>

#include "base/num.h"

void table_macros(StrBuf *out) {
  sb_puts(out, "\n/* f(i0) f(i1) ... f(i9), digits pasted: LAG_10(f, 12) is f(120) ... f(129). */\n");
  for (int block = 10; block <= LATE_RUNS_BLOCK; block *= 10) {
    sb_printf(out, "#define LAG_%d(f, i)", block);
    for (int digit = 0; digit < 10; digit++) {
      if (digit == 5) sb_puts(out, " \\\n ");
      if (block == 10) sb_printf(out, " f(i##%d)", digit);
      else sb_printf(out, " LAG_%d(f, i##%d)", block / 10, digit);
    }
    sb_putc(out, '\n');
  }
}

/* A number in a name, with the begin and end of its digits. */
typedef struct {
  size_t begin, end;
  uint32_t value;
} Number;

static int is_digit(char c) { return c >= '0' && c <= '9'; }

/* Whether two names differ in one number only, which grows by 1; *n: that number in x. */
static int counts_up(const char *x, const char *y, Number *n) {
  size_t i = 0;
  while (x[i] && x[i] == y[i]) i++;
  while (i > 0 && is_digit(x[i - 1])) i--;
  size_t j = i;
  *n = (Number){.begin = i};
  if (!is_digit(x[i]) || !is_digit(y[i]) || x[i] == '0') return 0;
  uint32_t next = 0;
  for (; is_digit(x[i]) && i - n->begin < 9; i++) n->value = n->value * 10 + (uint32_t)(x[i] - '0');
  for (; is_digit(y[j]) && j - n->begin < 9; j++) next = next * 10 + (uint32_t)(y[j] - '0');
  n->end = i;
  return next == n->value + 1 && strcmp(x + i, y + j) == 0;
}

static int same_but_name(const IrVar *x, const IrVar *y) {
  const IrUnit *a = x->unit, *b = y->unit;
  int same_unit = a == b || (strcmp(a->text, b->text) == 0 && !(a->factor < b->factor) && !(a->factor > b->factor) &&
                             !(a->offset < b->offset) && !(a->offset > b->offset));
  return same_unit && x->periodic == y->periodic && x->sign == y->sign;
}

/* Number of successive groups of `size` entries that differ only in one number that counts up; 1 if the second
 * differs otherwise. */
static uint32_t groups_at(const IrVar *v, uint32_t n, uint32_t size) {
  uint32_t groups = 1;
  for (Number first, now; (groups + 1) * size <= n; groups++)
    for (uint32_t k = 0; k < size; k++) {
      const IrVar *x = &v[(groups - 1) * size + k], *y = x + size;
      if (!counts_up(v[k].name, v[size + k].name, &first) || !counts_up(x->name, y->name, &now) || !same_but_name(x, y))
        return groups;
      Number lead;
      counts_up(v[0].name, v[size].name, &lead);
      if (first.begin != now.begin || now.value != lead.value + groups - 1) return groups;
    }
  return groups;
}

/* Size of the groups in a run that begins at the first entry, and their number *groups; 0 if there is no run. */
static uint32_t run_at(const IrVar *v, uint32_t n, uint32_t *groups) {
  for (uint32_t size = 1; size <= MOST_IN_GROUP && size * FEWEST_GROUPS <= n; size++)
    if ((*groups = groups_at(v, n, size)) >= FEWEST_GROUPS) return size;
  return 0;
}

int table_needs_macros(const IrVar *v, uint32_t n) {
  uint32_t groups;
  for (uint32_t i = 0; i + FEWEST_GROUPS <= n; i++)
    if (run_at(v + i, n - i, &groups)) return 1;
  return 0;
}

const char *table_number(Arena *a, double x, const char *digits) {
  const char *text = shortest_double(a, x);
  if (!strpbrk(text, ".e")) return text;
  return arena_printf(a, "LAG_NUMBER(%s)", digits && strlen(digits) > strlen(text) ? digits : text);
}

static const char *rest_of_entry(const IrVar *v, Arena *a) {
  const IrUnit *u = v->unit;
  const char *unit = c_string(a, u->text),
             *factor = table_number(a, u->factor, decimal_literal(a, u->ratio, u->pi_power));
  const char *offset = table_number(a, u->offset, NULL);
  return arena_printf(a, "%s, %s, %d, %d, %s},", unit, factor, v->periodic, v->sign, offset);
}

/* Text of an entry with this in place of its number. */
static const char *entry_of_i(const char *i, const IrVar *v, const IrVar *next, Arena *a) {
  Number n;
  counts_up(v->name, next->name, &n);
  const char *before = n.begin ? c_string(a, arena_strndup(a, v->name, n.begin)) : "",
             *after = v->name[n.end] ? c_string(a, v->name + n.end) : "";
  return arena_printf(a, "{%s %s %s, %s", before, i, after, rest_of_entry(v, a));
}

static void write_run(const IrVar *v, uint32_t size, uint32_t groups, Arena *a, StrBuf *out) {
  Number first;
  counts_up(v[0].name, v[size].name, &first);
  sb_puts(out, "#define LAG_EACH(i)");
  for (uint32_t k = 0; k < size; k++) sb_printf(out, " %s", entry_of_i("#i", &v[k], &v[size + k], a));
  late_runs(out, first.value, first.value + groups);
  sb_puts(out, "\n#undef LAG_EACH\n");
}

/* The call that fills a run of the table `to` when the program begins. */
static void fill_run(const char *to, const IrVar *v, uint32_t size, uint32_t groups, Arena *a, StrBuf *fill) {
  Number first;
  counts_up(v[0].name, v[size].name, &first);
  sb_printf(fill, "  lag_app_names(%s, %u, %u, (const lag_var[]){\n", to, first.value, groups);
  for (uint32_t k = 0; k < size; k++) sb_printf(fill, "    %s\n", entry_of_i("\"\\1\"", &v[k], &v[size + k], a));
  sb_printf(fill, "  }, %u);\n", size);
}

void table_vars(const char *name, const IrVar *v, uint32_t n, StrBuf *fill, Arena *a, StrBuf *out) {
  if (!n) return;
  int late = fill && table_needs_macros(v, n);
  if (late) sb_printf(out, "\nstatic lag_var %s[%u] = {\n", name, n);
  else sb_printf(out, "\nstatic const lag_var %s[] = {\n", name);
  for (uint32_t i = 0, groups = 0; i < n;) {
    uint32_t size = run_at(v + i, n - i, &groups);
    if (size && late) fill_run(arena_printf(a, "%s + %u", name, i), v + i, size, groups, a, fill);
    else if (size) write_run(v + i, size, groups, a, out);
    else
      sb_printf(out, "  %s{%s, %s\n", late ? arena_printf(a, "[%u] = ", i) : "", c_string(a, v[i].name),
                rest_of_entry(&v[i], a));
    if (i == 0 && size && late) sb_puts(out, "  {NULL, NULL, 0, 0, 0, 0},\n");
    i += size ? size * groups : 1;
  }
  sb_puts(out, "};\n");
}
