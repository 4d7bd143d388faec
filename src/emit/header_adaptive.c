/* Control of the adaptive steps of an emitted header, for one state and for the lanes of vectors. Enters: trial
 * steps with error estimates (header_steps.c). Holds: sizes as runtime/methods/adaptive_rk.c chooses them; a lane
 * has the digits of a state alone. */
#include "emit/header_impl.h"

static const char *const type =
    "\n/* Memory of an adaptive method; _adaptive_begin fills it, and again after a jump of the state. LAG_ESTEP: no "
    "step is short enough. */\n"
    "typedef struct lag_adaptive {\n"
    "  LAG_REAL tolerance, absolute; /* error of a step, component by component: absolute + tolerance*|y|, in SI */\n"
    "  LAG_REAL longest; /* step; 0: no limit */\n"
    "  LAG_REAL step;    /* to try next; 0: chosen by the method */\n"
    "  LAG_REAL memory;  /* of the controller */\n"
    "} lag_adaptive;\n\n"
    "LAG_API void lag_adaptive_begin(lag_adaptive *w, LAG_REAL tolerance);\n";

static const char *const move =
  " |\n"
  " |/* LAG_ENAN where the state is not finite. */\n"
  " |static int lag_check(const lag_state *s) {\n"
  " |  LAG_MASK finite = lag_finite(&s->t, 1);\n"
  "q|  finite = LAG_AND(LAG_AND(finite, lag_finite(s->q, LAG_NQ)), lag_finite(s->v, LAG_NQ));\n"
  "z|  finite = LAG_AND(finite, lag_finite(s->z, LAG_NZ));\n"
  " |  return LAG_STATUS(LAG_NOT(finite), LAG_ENAN);\n"
  " |}\n"
  " |\n"
  " |#ifdef LAG_LANES\n"
  " |/* The lanes of `taken` go from *s to *end. */\n"
  " |static void lag_move(LAG_MASK taken, lag_state *s, const lag_state *end) {\n"
  " |  s->t = LAG_SELECT(taken, end->t, s->t);\n"
  "q|  for (int i = 0; i < LAG_NQ; i++) {\n"
  "q|    s->q[i] = LAG_SELECT(taken, end->q[i], s->q[i]);\n"
  "q|    s->v[i] = LAG_SELECT(taken, end->v[i], s->v[i]);\n"
  "q|  }\n"
  "z|  for (int i = 0; i < LAG_NZ; i++) s->z[i] = LAG_SELECT(taken, end->z[i], s->z[i]);\n"
  " |  for (int i = 0; i <= LAG_NY; i++) s->lost[i] = LAG_SELECT(taken, end->lost[i], s->lost[i]);\n"
  " |}\n"
  " |#define LAG_MOVE(taken, s, end) lag_move(taken, s, end)\n"
  " |#else\n"
  " |#define LAG_MOVE(taken, s, end) do { if (taken) *(s) = *(end); } while (0)\n"
  " |#endif\n";

/* The first step. */
static const char *const begin =
    " |\n"
    " |/* A trial step of an adaptive method. */\n"
    " |typedef int lag_trial(const lag_params *p, const lag_state *s, LAG_REAL hHELD, LAG_REAL (*k)[LAG_NY], lag_state "
    "*end,\n"
    " |    const lag_adaptive *w, LAG_REAL *error);\n"
    " |\n"
    " |static LAG_REAL lag_norm(const lag_adaptive *w, const LAG_REAL *x, const LAG_REAL *y) {\n"
    " |  LAG_REAL sum = LAG_C(0.0);\n"
    " |  for (int i = 0; i < LAG_NY; i++) {\n"
    " |    const LAG_REAL r = x[i]/(w->absolute + w->tolerance*LAG_FN(fabs)(y[i]));\n"
    " |    sum += r*r;\n"
    " |  }\n"
    " |  return LAG_FN(sqrt)(sum/(LAG_LANE)LAG_NY);\n"
    " |}\n"
    " |\n"
    " |/* The first step to try. */\n"
    " |static LAG_REAL lag_first_step(const lag_params *p, const lag_adaptive *w, int order, LAG_REAL dir, LAG_REAL t, "
    "const LAG_REAL *yHELD,\n"
    " |    LAG_REAL (*k)[LAG_NY]) {\n"
    " |  const LAG_REAL d1 = lag_norm(w, k[0], y), h0 = lag_first_euler_step(lag_norm(w, y, y), d1, w->longest);\n"
    " |  LAG_REAL x[LAG_NY];\n"
    " |  for (int i = 0; i < LAG_NY; i++) x[i] = y[i] + dir*h0*k[0][i];\n"
    " |  const LAG_MASK failed = LAG_FAILED(lag_rates(p, t + dir*h0, xPASS, k[1]));\n"
    " |  if (!LAG_ANY(LAG_NOT(failed))) return h0*LAG_C(1e-3);\n"
    " |  for (int i = 0; i < LAG_NY; i++) k[1][i] -= k[0][i];\n"
    " |  return LAG_SELECT(failed, h0*LAG_C(1e-3), lag_first_size(order, h0, d1, lag_norm(w, k[1], y)/h0));\n"
    " |}\n";

/* A step of one state, or a try of several, each with its own size: memory is negative where the last try was
 * rejected. */
static const char *const adapt =
    " |\n"
    " |static int lag_adapt(lag_trial *trial, const lag_controller *c, const lag_params *p, lag_state *s, lag_adaptive "
    "*w, LAG_REAL untilHELD,\n"
    " |    LAG_REAL (*k)[LAG_NY]) {\n"
    " |  const LAG_REAL zero = LAG_C(0.0), one = LAG_C(1.0), dir = LAG_SELECT(until < s->t, -one, one), gap = "
    "dir*(until - s->t);\n"
    " |  const LAG_MASK busy = until != s->t;\n"
    " |  LAG_REAL y[LAG_NY], error;\n"
    " |  int status = LAG_OK;\n"
    " |  LAG_TRY(LAG_STATUS(LAG_NOT(LAG_AND(w->tolerance >= zero, LAG_AND(w->absolute >= zero, w->tolerance + "
    "w->absolute > zero))), LAG_ETOLERANCE));\n"
    " |  if (!LAG_ANY(busy)) return LAG_OK;\n"
    " |  lag_gather(s, y);\n"
    " |  LAG_TRY(lag_rates(p, s->t, yPASS, k[0]));\n"
    " |  const LAG_MASK first = LAG_AND(LAG_AND(busy, LAG_NOT(w->step > zero)), LAG_NOT(LAG_FAILED(status)));\n"
    " |  if (LAG_ANY(first)) w->step = LAG_SELECT(first, lag_first_step(p, w, c->order, dir, s->t, yPASS, k), "
    "w->step);\n"
    " |  for (;;) {\n"
    " |    const LAG_REAL wanted = LAG_SELECT(LAG_AND(w->longest > zero, w->longest < w->step), w->longest, w->step);\n"
    " |    const LAG_MASK clipped = LAG_NOT(wanted*(one + LAG_C(1e-4)) < gap); /* of NaN, too */\n"
    " |    const LAG_REAL h = LAG_SELECT(clipped, gap, wanted);\n"
    " |    lag_state end = *s;\n"
    " |    end.t = lag_compensated_sum(s->t, dir*h, &end.lost[0]);\n"
    " |    end.t = LAG_SELECT(clipped, until, end.t);\n"
    " |    end.lost[0] = LAG_SELECT(clipped, zero, end.lost[0]);\n"
    " |    const LAG_MASK moves = LAG_AND(h*c->least > zero, LAG_OR(end.t > s->t, end.t < s->t));\n"
    " |    LAG_TRY(LAG_STATUS(LAG_NOT(moves), LAG_ESTEP));\n"
    " |    LAG_TRY(trial(p, s, dir*hPASS, k, &end, w, &error));\n"
    " |    const LAG_MASK good = LAG_AND(busy, LAG_NOT(LAG_FAILED(status))), taken = LAG_AND(good, LAG_AND(error >= "
    "zero, error <= one));\n"
    " |    LAG_REAL memory = w->memory, next = LAG_SELECT(taken, h*lag_growth(c, error, memory < zero, &memory), "
    "zero);\n"
    " |    next = LAG_SELECT(LAG_AND(clipped, LAG_NOT(next > wanted)), wanted, next);\n"
    " |    w->step = LAG_SELECT(taken, next, LAG_SELECT(good, h*lag_shrinkage(c, error), w->step));\n"
    " |    w->memory = LAG_SELECT(taken, memory, LAG_SELECT(good, -one, w->memory));\n"
    " |    LAG_MOVE(taken, s, &end);\n"
    " |#ifdef LAG_LANES\n"
    " |    return LAG_WHERE(busy, status);\n"
    " |#else\n"
    " |    if (taken) return LAG_OK;\n"
    " |#endif\n"
    " |  }\n"
    " |}\n";

static const char *const adaptive_begin =
  " | {\n"
  " |  w->tolerance = w->absolute = tolerance;\n"
  " |  w->longest = LONGEST;\n"
  " |  w->step = w->memory = LAG_C(0.0);\n"
  " |}\n";

void header_adaptive_declare(const Header *h) { csupport_expand(type, h->upper, h->lower, h->out); }

void header_move(const Header *h) { header_template(h, move, NULL); }

void header_adaptive_define(const Header *h, const char *longest) {
  const HeaderWord words[] = {{"LONGEST", longest}, {NULL, NULL}};
  header_template(h, begin, NULL);
  header_template(h, adapt, NULL);
  csupport_expand("\nLAG_API void lag_adaptive_begin(lag_adaptive *w, LAG_REAL tolerance)", h->upper, h->lower, h->out);
  header_template(h, adaptive_begin, words);
}
