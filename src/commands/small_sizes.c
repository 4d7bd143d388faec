/* Texts of large models from those of four small ones (small_sizes.h). */
#include "commands/small_sizes.h"

#include <stdlib.h>
#include <string.h>

#include "model/family_size.h"

enum { SIZES = 4, FROM = 2048, MOST = 1000000, MOST_DIGITS = 15 };

typedef struct {
  Compiler *c;
  int (*command)(Compiler *c);
  FamilySize size; /* asked for */
  int64_t n;       /* the small one that is tried, */
  int status;      /* and how that ended */
  StrBuf text, messages;
} SmallSizes;

/* --- numbers in texts --- */

#define DIGITS "0123456789"
static int is_digit(char c) { return c >= '0' && c <= '9'; }

/* Whether the digits at `at` are a whole number, alone or before a decimal point: neither the digits behind one nor an
 * exponent. */
static int is_whole(const char *text, const char *at) {
  if (*at == '0' && is_digit(at[1])) return 0;
  if (at > text && at[-1] == '.') return at - 1 > text && at[-2] == '.'; /* 1..300 is a range */
  const char *e = at > text && (at[-1] == '-' || at[-1] == '+') ? at - 1 : at;
  return !(e > text + 1 && (e[-1] == 'e' || e[-1] == 'E') && (is_digit(e[-2]) || e[-2] == '.'));
}

/* The number of these digits; -1: they are too many. */
static int64_t read_number(const char *digits) {
  return strspn(digits, DIGITS) <= MOST_DIGITS ? strtoll(digits, NULL, 10) : -1;
}

/* Whether two texts differ in whole numbers only. */
static int same_but_numbers(const StrBuf *a, const StrBuf *b) {
  const char *x = sb_text(a), *y = sb_text(b);
  while (*x && is_digit(*x) == is_digit(*y) && (is_digit(*x) || *x == *y))
    if (is_digit(*x)) x += strspn(x, DIGITS), y += strspn(y, DIGITS);
    else x++, y++;
  return *x == *y;
}

/* The value behind `steps` steps of a polynomial of degree 2 with these values at 0, 1, 2 and 3; -1: there is none. */
static int64_t follow(const int64_t *y, int64_t steps) {
  int64_t slope = y[1] - y[0], bend = y[2] - 2*y[1] + y[0];
  for (int k = 0; k < SIZES; k++)
    if (y[k] < 0) return -1;
  if (y[3] != y[0] + 3*slope + 3*bend) return -1;
  double value = (double)y[0] + (double)slope*(double)steps + (double)bend*(double)steps*(double)(steps - 1)/2;
  return value >= 0 && value < 1e15 ? y[0] + slope*steps + bend*(steps*(steps - 1)/2) : -1;
}

/* Appends the text that the four, which differ in numbers only, lead to; 0: they do not. */
static int extend(const StrBuf *of, int64_t steps, StrBuf *out) {
  const char *begin[SIZES], *at[SIZES];
  for (int k = 0; k < SIZES; k++) begin[k] = at[k] = sb_text(&of[k]);
  for (size_t n; *at[0];) {
    n = strcspn(at[0], DIGITS);
    sb_putn(out, at[0], n);
    for (int k = 0; k < SIZES; k++) at[k] += n;
    int64_t y[SIZES], value = 0;
    int same = 1;
    n = strspn(at[0], DIGITS);
    for (int k = 0; k < SIZES; k++) {
      same &= strspn(at[k], DIGITS) == n && memcmp(at[k], at[0], n) == 0;
      y[k] = is_whole(begin[k], at[k]) ? read_number(at[k]) : -1;
    }
    if (same) sb_putn(out, at[0], n);
    else if ((value = follow(y, steps)) < 0) return 0;
    else sb_printf(out, "%lld", (long long)value);
    for (int k = 0; k < SIZES; k++) at[k] += strspn(at[k], DIGITS);
  }
  return 1;
}

/* --- the small models --- */

/* Runs the command where the size is x->n, and keeps what it writes. */
static void run_at(Arena *scratch, void *data) {
  SmallSizes *x = data;
  SmallSize small = {
      .written = x->text, .times = (double)x->size.value / (double)x->n, .more = x->size.value - x->n};
  Compiler c = *x->c;
  const Source *model = &x->c->sources->files.at[0];
  c.arena = scratch;
  c.small = &small;
  memset(&c.o.defines, 0, sizeof c.o.defines);
  for (uint32_t i = 0; i < x->c->o.defines.n; i++) {
    const Define d = {.name = x->c->o.defines.at[i].name, .value = x->c->o.defines.at[i].value};
    if (strcmp(d.name, x->size.name) != 0) vec_push(scratch, &c.o.defines, d);
  }
  vec_push(scratch, &c.o.defines,
           ((Define){.name = x->size.name, .value = arena_printf(scratch, "%lld", (long long)x->n)}));
  compiler_begin(&c);
  c.sources->library = x->c->sources->library;
  source_add(c.sources, model->path, model->text, model->len);
  c.sources->files.at[0].is_file = model->is_file;
  x->status = compiler_parse(&c);
  if (x->status == STATUS_OK) x->status = x->command(&c);
  if (x->status == STATUS_OK && c.diags->errors) x->status = STATUS_MODEL;
  x->text = small.written;
  compiler_messages(&c, &x->messages);
}

/* The text and the messages of the size asked for, from those of small ones; 0: they do not lead there. */
static int extend_small(SmallSizes *x) {
  Arena *a = x->c->arena;
  StrBuf text[SIZES], messages[SIZES];
  const int64_t least = FAMILY_LEAST + x->size.value % FAMILY_STEP, steps = (x->size.value - least)/FAMILY_STEP;
  for (int k = 0; k < SIZES; k++) {
    x->n = least + k*FAMILY_STEP;
    x->text = strbuf(a), x->messages = strbuf(a);
    arena_with_scratch(a, run_at, x);
    text[k] = x->text, messages[k] = x->messages;
    if (x->status != STATUS_OK || !same_but_numbers(&text[0], &text[k]) ||
        !same_but_numbers(&messages[0], &messages[k]) || strstr(sb_text(&messages[k]), " is written out, "))
      return 0;
  }
  x->text = strbuf(a), x->messages = strbuf(a);
  return extend(text, steps, &x->text) && extend(messages, steps, &x->messages);
}

/* Whether the command writes a text without numbers that are measured: of errors, of a tree's forces at the start. */
static int is_of_text(const Compiler *c) {
  const Options *o = &c->o;
  const int checks = o->command == CMD_CHECK && !o->json && !o->verbose && !c->ast->fars.n;
  if (!checks && o->command != CMD_DERIVE && o->command != CMD_NOETHER && o->command != CMD_EMIT &&
      o->command != CMD_HEADER)
    return 0;
  return !o->dump && !o->fix && !o->bracket;
}

int small_sizes_run(Compiler *c, int (*command)(Compiler *c), int *status) {
  if (!is_of_text(c) || c->diags->list.n) return 0;
  SmallSizes x = {.c = c, .command = command, .size = family_size(c->ast, c->o.defines.at, c->o.defines.n, FROM)};
  if (!x.size.name || x.size.value > MOST) return 0;
  if (extend_small(&x)) {
    fputs(sb_text(&x.messages), stderr);
    *status = compiler_write_c(c, c->o.output, &x.text);
    return 1;
  }
  if (x.status == STATUS_USAGE) *status = x.status; /* and it was said why */
  return x.status == STATUS_USAGE;
}
