/* Steps of an emitted header by Taylor series, of one state and of the lanes of vectors. Enters: the unit's
 * recurrences. Leaves: the memory of the method, its prototypes and functions, an instance of the runtime's kernels.
 * Holds: each step has the digits of runtime/methods/taylor.c, which explains the control of steps; a step that the
 * caller's time ends is shorter; a lane has the digits of a state alone. No step uses values of the step before
 * except sizes, so that the state, parameters and inputs may have changed. */
#include "emit/emit_impl.h"
#include "emit/header_impl.h"

static const char *const memory =
    " |/* Memory of the Taylor method: sizeof(lag_taylor), here about NUMBERS numbers; a smaller LAG_TAYLOR_ORDER "
    "takes fewer. _taylor_begin\n"
    " | * fills it, and again after a jump of the state. */\n"
    " |typedef struct lag_taylor {\n"
    " |  LAG_REAL tolerance, absolute; /* error of a step, component by component: absolute + tolerance*|y|; "
    "tolerance: by _taylor_begin */\n"
    " |  LAG_REAL longest; /* step; 0: no limit */\n"
    " |  LAG_REAL unit;    /* of time in the coefficients; 0: found from the state */\n"
    " |  LAG_REAL noise;   /* error that is rounding, in tolerances */\n"
    " |  LAG_REAL step, last; /* step to try next, and the error of the last try; 0: by the series */\n"
    " |  LAG_REAL reach, epsilon; /* step as a part of the radius of convergence; rounding of the scalar */\n"
    " |  int order;        /* of the series */\n"
    " |  LAG_REAL x[LAG_TAYLOR_ORDER + 1][LAG_TAYLOR_COLUMNS], end[LAG_TAYLOR_COLUMNS]; /* the series; order 0 at the "
    "end of the step */\n"
    " |  LAG_REAL sum[LAG_TAYLOR_WIDTH], slope[LAG_TAYLOR_WIDTH], scale[LAG_TAYLOR_WIDTH];\n"
    " |  lag_taylor_work work;\n"
    " |} lag_taylor;\n"
    " |\n"
    " |/* order: of the series, at most LAG_TAYLOR_ORDER; 0: chosen from the tolerance (of lanes the least) and what "
    "an order costs. */\n"
    " |LAG_API void lag_taylor_begin(lag_taylor *w, LAG_REAL tolerance, int order);\n"
    " |\n"
    " |/* One step by a Taylor series, towards the time `until` and not beyond it. LAG_ESTEP: no step is short "
    "enough.MORE */\n";

static const char *const overloads =
  "#if defined(__cplusplus) && __cplusplus < 201103L && !defined(_LIBCPP_VERSION) && !defined(LAGC_OVERLOADS_2)\n"
  "#define LAGC_OVERLOADS_2 /* C++98 has these for double alone */\n"
  "namespace lagc_overloads_2 {\n"
  "inline float exp2(float x) { return ::exp2f(x); }\n"
  "inline long double exp2(long double x) { return ::exp2l(x); }\n"
  "inline float log2(float x) { return ::log2f(x); }\n"
  "inline long double log2(long double x) { return ::log2l(x); }\n"
  "}\n"
  "using lagc_overloads_2::exp2;\n"
  "using lagc_overloads_2::log2;\n"
  "#endif\n";

/* Functions of vectors that kernels/taylor_order.h calls; the largest of the lanes. */
static const char *const vectors =
  " |\n"
  " |#ifdef LAG_LANES\n"
  " |LAG_LANES_1(exp2) LAG_LANES_1(log2)\n"
  " |/* The largest of the lanes. */\n"
  " |static LAG_LANE lag_most(LAG_REAL x) {\n"
  " |  LAG_LANE most = x[0];\n"
  " |  for (int i = 1; i < LAG_LANES; i++) most = x[i] > most ? x[i] : most;\n"
  " |  return most;\n"
  " |}\n"
  " |#else\n"
  " |static LAG_LANE lag_most(LAG_REAL x) { return x; }\n"
  " |#endif\n";

static const char *const begin =
    " |\n"
    " |LAG_API void lag_taylor_begin(lag_taylor *w, LAG_REAL tolerance, int order) {\n"
    " |  w->tolerance = w->absolute = tolerance;\n"
    " |  w->longest = LONGEST;\n"
    " |  w->unit = w->noise = w->step = w->last = LAG_C(0.0);\n"
    " |  w->epsilon = LAG_C(0.0) + lag_epsilon();\n"
    " |  for (int k = 0; k <= LAG_TAYLOR_ORDER; k++)\n"
    " |    for (int i = 0; i < LAG_TAYLOR_COLUMNS; i++) w->x[k][i] = LAG_C(0.0);\n"
    " |  const int wide = sizeof(LAG_LANE) <= sizeof(double); /* sums are in vectors then */\n"
    " |  const lag_taylor_costs c = {wide ? LAG_COEF(400.0) : LAG_COEF(100.0), wide ? LAG_COEF(0.5) : LAG_COEF(1.0), "
    "LAG_COEF(1.0),\n"
    " |    wide ? LAG_COEF(0.2) : LAG_COEF(2.0), LAG_COEF(FIRST.0), LAG_COEF(NEXT.0), LAG_COEF(SUMS.0)};\n"
    " |  if (order <= 0) order = (int)lag_most(lag_taylor_best_order(&c, w->tolerance, w->epsilon, 1, "
    "LAG_TAYLOR_ORDER));\n"
    " |  w->order = order > 0 && order < LAG_TAYLOR_ORDER ? order : LAG_TAYLOR_ORDER;\n"
    " |  w->reach = LAG_FN(exp2)(-lag_taylor_bits(w->tolerance, w->epsilon)/(LAG_C(1.0) + (LAG_LANE)w->order));\n"
    " |}\n";

static const char *const parts =
    " |\n"
    " |/* x := order 0 at t and y. LAG_ESTEP: a rate is not finite. */\n"
    " |static int lag_taylor_order_0(const lag_params *p, LAG_REAL t, const LAG_REAL *y, LAG_REAL *x, lag_taylor_work "
    "*workHOLDS) {\n"
    "u|  LAG_REAL now[LAG_NU], follows[LAG_NU];\n"
    "u|  for (int i = 0; i < LAG_NU; i++) follows[i] = u ? LAG_C(0.0) : LAG_C(1.0);\n"
    "u|  if (!u) lag_inputs(t, p, now);\n"
    " |  int status = LAG_OK;\n"
    " |  LAG_TRY(lag_taylor_first(t, y, y + LAG_NQ, y + 2*LAG_NQ, p, INPUTS, x, work));\n"
    " |  LAG_TRY(LAG_STATUS(LAG_NOT(lag_finite(x + LAG_NY, LAG_NQ + LAG_NZ)), LAG_ESTEP));\n"
    " |  return status;\n"
    " |}\n"
    " |#define LAG_SERIES_MODEL const lag_params *p, lag_taylor *wHOLDS\n"
    " |#define LAG_SERIES_FLOOR(i) (USESw->absolute/w->tolerance)\n"
    " |#define LAG_SERIES_BEGIN(t, y, x) lag_taylor_order_0(p, t, y, x, &w->workGIVEN)\n"
    " |#define LAG_SERIES_REST(order, unit, x) (USESlag_taylor_rest(order, unit, x, &w->work))\n"
    " |#define LAG_SERIES_AT(order, s, x, sum, slope) lag_taylor_at(order, s, x, sum, slope)\n";

static const char *const attempt =
    " |/* A try of a step of the lanes in `busy`. *why: failure of the model at the end of a step that is tried again. "
    "*/\n"
    " |static int lag_taylor_attempt(const lag_params *p, lag_state *s, lag_taylor *w, LAG_REAL until, LAG_MASK busy, "
    "int *whyHOLDS) {\n"
    " |  const LAG_REAL zero = LAG_C(0.0), one = LAG_C(1.0), dir = LAG_SELECT(until < s->t, -one, one);\n"
    " |  const LAG_MASK again = w->step > zero;\n"
    " |  LAG_REAL y[LAG_NY], y1[LAG_NY], defect;\n"
    " |  lag_state end = *s;\n"
    " |  const lag_taylor_frame f = {w->order, LAG_TAYLOR_COLUMNS, LAG_NQ, LAG_NZ, w->x[0], w->end, w->sum, w->slope, "
    "w->scale,\n"
    " |                              s->lost + 1, y1, end.lost + 1};\n"
    " |  int status = LAG_OK;\n"
    " |  lag_gather(s, y);\n"
    " |  LAG_TRY(LAG_STATUS(LAG_NOT(LAG_AND(w->tolerance > zero, w->absolute >= zero)), LAG_ETOLERANCE));\n"
    " |  LAG_TRY(lag_taylor_order_0(p, s->t, y, w->x[0], &w->workGIVEN));\n"
    " |  const LAG_MASK live = LAG_AND(busy, LAG_NOT(LAG_FAILED(status))), guess = LAG_NOT(w->unit > zero);\n"
    " |  LAG_REAL unit = w->unit;\n"
    " |  if (LAG_ANY(guess)) unit = LAG_SELECT(guess, lag_taylor_unit(p, wGIVEN, &f, y), unit);\n"
    " |  LAG_TRY(LAG_STATUS(lag_taylor_expand(p, wGIVEN, &f, dir, live, &unit), LAG_ESTEP));\n"
    " |  w->unit = LAG_SELECT(live, unit, w->unit);\n"
    " |  LAG_REAL h = lag_taylor_size(p, wGIVEN, &f, y, w->unit, w->reach, w->longest);\n"
    " |  h = LAG_SELECT(again, w->step, h);\n"
    " |  const LAG_MASK clipped = LAG_NOT(h*(one + LAG_C(1e-4)) < dir*(until - s->t)); /* of NaN, too */\n"
    " |  end.t = LAG_SELECT(clipped, until, s->t + dir*h);\n"
    " |  const LAG_REAL dt = end.t - s->t, length = LAG_FN(fabs)(dt);\n"
    " |  const LAG_REAL least = LAG_SELECT(LAG_AND(clipped, LAG_NOT(again)), zero, "
    "LAG_C(4.0)*w->epsilon*LAG_FN(fabs)(s->t));\n"
    " |  w->step = LAG_SELECT(busy, zero, w->step);\n"
    " |  LAG_TRY(LAG_STATUS(LAG_NOT(LAG_AND(length > least, h >= LAG_C(2.2250738585072014e-308)/w->epsilon)), "
    "LAG_ESTEP));\n"
    " |  *why = lag_taylor_try(p, wGIVEN, &f, y, dir*w->unit, end.t, dt, &defect);\n"
    " |  const LAG_MASK good = LAG_AND(busy, LAG_NOT(LAG_FAILED(status)));\n"
    " |  const LAG_REAL error = LAG_SELECT(LAG_FAILED(*why), -one, defect/w->tolerance);\n"
    " |  const LAG_REAL last = LAG_SELECT(again, w->last, -one);\n"
    " |  const LAG_MASK taken = lag_taylor_takes(LAG_AND(good, error >= zero), error, last, &w->noise);\n"
    " |  const LAG_MASK shorter = LAG_AND(good, LAG_NOT(taken));\n"
    " |  w->unit = LAG_SELECT(LAG_AND(taken, LAG_NOT(clipped)), lag_power_below(length), w->unit);\n"
    " |  if (LAG_ANY(shorter)) {\n"
    " |    w->last = LAG_SELECT(shorter, error, w->last);\n"
    " |    w->step = LAG_SELECT(shorter, LAG_SELECT(clipped, length, h)*lag_taylor_shrinkage(w->order, error), "
    "w->step);\n"
    " |  }\n"
    " |  lag_scatter(y1, &end);\n"
    " |  LAG_MOVE(taken, s, &end);\n"
    " |  return LAG_WHERE(busy, status);\n"
    " |}\n"
    " |\n";

static const char *const step =
  " | {\n"
  " |  int why = LAG_OK;\n"
  " |#ifdef LAG_LANES\n"
  " |  const LAG_MASK busy = until != s->t;\n"
  " |  return LAG_ANY(busy) ? lag_taylor_attempt(p, s, w, until, busy, &whyGIVEN) : (int)LAG_OK;\n"
  " |#else\n"
  " |  for (const LAG_REAL t = s->t; until < t || !(until <= t);) {\n"
  " |    const int before = why, status = lag_taylor_attempt(p, s, w, until, 1, &whyGIVEN);\n"
  " |    if (status != LAG_OK) return before != LAG_OK ? before : status;\n"
  " |    if (s->t > t || s->t < t) return LAG_OK;\n"
  " |  }\n"
  " |  return LAG_OK;\n"
  " |#endif\n"
  " |}\n";

static CStyle base(const Header *h) {
  return (CStyle){.prefix = h->upper,
                  .params = h->fields,
                  .globals = h->globals,
                  .solve = arena_printf(h->a, "%s_solve", h->lower),
                  .math = math_prefix(h->u, h->lower)};
}

static const char *prototype(const Header *h) {
  const char *m = h->lower, *R = h->upper;
  return arena_printf(h->a, "int %s_taylor_step(const %s_params *p, %s_state *s, %s_taylor *w, %s_REAL until%s)", m, m,
                      m, m, R, h->u->u.n ? arena_printf(h->a, ", const %s_REAL *u", R) : "");
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
  csupport_expand(
      "\n/* The highest order of Taylor series. */\n#ifndef LAG_TAYLOR_ORDER\n#define LAG_TAYLOR_ORDER 40\n#endif\n",
      h->upper, h->lower, h->out);
  emit_taylor_types(s, &st, h->lower, h->out);
  sb_putc(h->out, '\n');
  header_template(h, memory, words);
  sb_printf(h->out, "%s\n", header_wrapped(h, arena_printf(h->a, "%s_API %s;", h->upper, prototype(h))));
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
  csupport_expand(
      "\n/* Taylor coefficients along the motion: of a value x(t), x^(k)(t) T^k/k! for orders k = 0, 1, ... */",
      h->upper, h->lower, h->out);
  emit_taylor_functions(h->u->taylor, &st, h->lower, h->out);
  header_template(h, vectors, words);
  header_section(h, "taylor_order");
  header_section(h, "taylor_size");
  header_template(h, begin, words);
  header_template(h, parts, words);
  header_section(h, "taylor_step");
  header_template(h, attempt, words);
  sb_printf(h->out, "%s", header_wrapped(h, arena_printf(h->a, "%s_API %s", h->upper, prototype(h))));
  header_template(h, step, words);
}
