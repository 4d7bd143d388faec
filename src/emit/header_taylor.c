/* Steps of an emitted header by Taylor series, of one state and of the lanes of vectors. Enters: the unit's
 * recurrences. Leaves: the memory of the method, its prototypes and functions, an instance of the runtime's kernels.
 * Holds: each step has the digits of runtime/methods/taylor.c, which explains the control of steps; a step that the
 * caller's time ends is shorter; a lane has the digits of a state alone. No step uses values of the step before
 * except sizes, so that the state, parameters and inputs may have changed. */
#include "emit/emit_impl.h"
#include "emit/header_impl.h"
#include "emit/header_taylor_text.h"

static CStyle base(const Header *h) {
  return (CStyle){.prefix = h->upper,
                  .params = h->fields,
                  .globals = h->globals,
                  .solve = arena_printf(h->a, "%s_solve", h->lower),
                  .math = math_prefix(h->u, h->lower)};
}

static const char *prototype(const Header *h) {
  return arena_printf(h->a, "int lag_taylor_step(const lag_params *p, lag_state *s, lag_taylor *w, LAG_REAL until%s)",
                      h->u->u.n ? ", const LAG_REAL *u" : "");
}

/* Numbers in the struct at order 40. */
static uint32_t numbers(const Series *s, uint32_t ny) {
  enum { ORDER = 40 };
  return 9 + (ORDER + 2)*s->columns + 3*ny + ORDER*(s->width + s->first_square) + s->width + s->constants + s->room;
}

void header_taylor_declare(const Header *h) {
  const Series *s = h->u->taylor;
  const CStyle st = base(h);
  const HeaderWord words[] = {
      {"NUMBERS", arena_printf(h->a, "%u", numbers(s, 2 * h->u->q.n + h->u->z.n))},
      {"MORE", arena_printf(h->a, "%s%s", h->u->u.n ? header_held_inputs : "", header_adaptive_lanes)},
      {NULL, NULL}};
  header_printf(
      h,
      "\n/* The highest order of Taylor series. */\n#ifndef LAG_TAYLOR_ORDER\n#define LAG_TAYLOR_ORDER 40\n#endif\n");
  emit_taylor_types(s, &st, h->lower, h->out);
  sb_putc(h->out, '\n');
  header_template(h, memory, words);
  sb_printf(h->out, "%s\n", header_wrapped(h, "LAG_API %s;", prototype(h)));
}

void header_taylor_overloads(const Header *h) { sb_puts(h->out, overloads); }

void header_taylor_define(const Header *h, const char *longest) {
  const CStyle st = base(h);
  const TaylorCosts c = taylor_costs(h->u->taylor);
  int inputs = h->u->u.n > 0;
  const HeaderWord words[] = {{"LONGEST", longest},
                              {"SUMS", arena_printf(h->a, "%u", c.sums)}, {"NEXT", arena_printf(h->a, "%u", c.next)},
                              {"FIRST", arena_printf(h->a, "%u", c.first)},
                              {"HOLDS", inputs ? ", const LAG_REAL *u" : ""},
                              {"INPUTS", inputs ? "u ? u : now, follows" : "0, 0"}, {"GIVEN", inputs ? ", u" : ""},
                              {"USES", inputs ? "(void)p, (void)u, " : "(void)p, "},
                              {NULL, NULL}};
  header_printf(
      h, "\n/* Taylor coefficients along the motion: of a value x(t), x^(k)(t) T^k/k! for orders k = 0, 1, ... */");
  emit_taylor_functions(h->u->taylor, &st, h->lower, h->out);
  header_template(h, vectors, words);
  header_sections(h, "taylor_order, taylor_size");
  header_template(h, begin, words);
  header_template(h, parts, words);
  header_section(h, "taylor_step");
  header_template(h, attempt, words);
  sb_puts(h->out, header_wrapped(h, "LAG_API %s", prototype(h)));
  header_template(h, step, words);
}
