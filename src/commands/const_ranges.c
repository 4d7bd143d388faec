/* Constants that a sweep varies (const_ranges.h): their values, and the combinations that are compiled. */
#include "commands/const_ranges.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/num.h"
#include "base/strbuf.h"
#include "commands/range.h"

enum { MOST_VALUES = 256 };

/* Adds the values of FIRST..LAST:NUMBER, or FIRST..LAST:log:NUMBER; after: the text behind LAST. Returns 0 where
 * that is no such range. */
static int add_interval(Arena *a, ConstRange *c, double first, double last, const char *after) {
  int ratios = strncmp(after, ":log", 4) == 0;
  const char *number = after + (ratios ? 4 : 0);
  long n = *number == ':' ? strtol(number + 1, NULL, 10) : 0;
  if (n < 2 || !(last > first) || (ratios && !(first > 0))) return 0;
  for (long i = 0; i < n && i <= MOST_VALUES; i++) {
    char text[32];
    num_format_double(text, i == 0       ? first
                            : i == n - 1 ? last
                            : ratios     ? first * pow(last / first, (double)i / (double)(n - 1))
                                         : first + (double)i * (last - first) / (double)(n - 1));
    vec_push(a, &c->values, arena_strdup(a, text));
  }
  return 1;
}

static int read_values(Arena *a, const Range *r, ConstRange *c) {
  VEC(const char *) number = {0};
  for (uint32_t i = 0; i < r->numbers.n; i++) vec_push(a, &number, strchr(r->numbers.at[i], '=') + 1);
  for (uint32_t i = 0; i < number.n; i++)
    if (!text_is_number(number.at[i])) return 0;
  if (number.n == 2 && strncmp(r->between.at[1], "..", 2) == 0)
    return add_interval(a, c, strtod(number.at[0], NULL), strtod(number.at[1], NULL), r->between.at[2]);
  for (uint32_t i = 0; i < number.n; i++) vec_push(a, &c->values, number.at[i]);
  return number.n > 0 && !*r->between.at[number.n];
}

int const_range_take(Ast *ast, Options *o, uint32_t i, const char *name, const char **error) {
  Arena *a = ast->arena;
  const char *word = o->rest.at[i];
  ConstRange c = {.name = name};
  for (uint32_t k = 0; k < o->defines.n; k++)
    if (strcmp(o->defines.at[k].name, name) == 0)
      return fail_with(error,
                       arena_printf(a, "-D %s=%s: %s varies; leave one out", name, o->defines.at[k].value, name));
  if (strchr(word, '~') || !read_values(a, range_split(a, word), &c))
    return fail_with(error, arena_printf(a,
                                         "%s: `%s` is a constant, and compiled for each of its values: write plain "
                                         "numbers, for example %s=2,4,8 or %s=2..8:4",
                                         word, name, name, name));
  StrBuf list = strbuf(a);
  sb_printf(&list, "%s=", name);
  for (uint32_t k = 0; k < c.values.n; k++) sb_printf(&list, k ? ",%s" : "%s", c.values.at[k]);
  o->rest.at[i] = sb_text(&list);
  vec_push(a, &o->defines, ((Define){.name = name, .value = c.values.at[0]}));
  vec_push(a, &o->consts, c);
  return settings_defines(ast, o->defines.at, o->defines.n);
}

uint32_t const_range_variants(Arena *a, const Options *o, const char **error) {
  uint32_t n = 1;
  for (uint32_t k = 0; k < o->consts.n; k++) {
    uint32_t values = o->consts.at[k].values.n;
    if (options_pass_flag(o, "--zip") && k && values != n)
      return (uint32_t)fail_with(error, "--zip: ranges that are walked together have the same number of values");
    n = options_pass_flag(o, "--zip") ? values : n * values;
    if (n > MOST_VALUES)
      return (uint32_t)fail_with(
          error, arena_printf(a, "%s: a program is compiled for up to %d values of constants; make several sweeps",
                              o->consts.at[k].name, MOST_VALUES));
  }
  return n;
}

int const_range_define(Ast *ast, Options *o, uint32_t v) {
  int together = options_pass_flag(o, "--zip");
  for (uint32_t k = o->consts.n; k-- > 0;) {
    const ConstRange *c = &o->consts.at[k];
    Define *d = &o->defines.at[o->defines.n - o->consts.n + k];
    *d = (Define){.name = c->name, .value = c->values.at[v % c->values.n]};
    if (!together) v /= c->values.n;
  }
  return settings_defines(ast, o->defines.at, o->defines.n);
}

const char *const_range_names(Arena *a, const Options *o) {
  StrBuf b = strbuf(a);
  for (uint32_t k = 0; k < o->consts.n; k++) sb_printf(&b, k ? ",%s" : "%s", o->consts.at[k].name);
  return sb_text(&b);
}
