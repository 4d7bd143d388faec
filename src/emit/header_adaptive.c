/* Control of the adaptive steps of an emitted header, for one state and for the lanes of vectors. Enters: trial steps with error estimates (header_steps.c). Holds:
 * sizes as runtime/methods/embedded.c chooses them; a lane has the digits of a state alone. */
#include "emit/header_impl.h"

static const char *const type =
  "\n/* Memory of an adaptive method; _adaptive_begin fills it, and again after a jump of the state. LAG_ESTEP: no step is short enough. */\n"
  "typedef struct lag_adaptive {\n"
  "  LAG_REAL tolerance, absolute; /* error of a step, component by component: absolute + tolerance*|y| */\n"
  "  LAG_REAL longest; /* step; 0: no limit */\n"
  "  LAG_REAL step;    /* to try next; 0: chosen by the method */\n"
  "  LAG_REAL memory;  /* of the controller */\n"
  "} lag_adaptive;\n\n"
  "LAG_API void lag_adaptive_begin(lag_adaptive *w, LAG_REAL tolerance);\n";

const char *const header_held_inputs = "\n * u: the inputs, constant during the step; 0 for the model's formulas.";
const char *const header_adaptive_lanes =
  "\n * Over lanes: a try in each lane that is not at its `until`. One whose step is too long keeps its state, and has a shorter step in the next\n"
  " * call; the others go on. Status: minus the sum of 2^k over the lanes k that failed; until[k] = s->t[k] lets such a lane rest.";

/* Failures of functions within a step. The step of a lane that fails is not taken. */
static const char *const failures =
  " |\n"
  " |#ifdef LAG_LANES /* a lane that fails does not stop the others */\n"
  " |#define LAG_TRY(call) status = -(-status | -(call))\n"
  " |#define LAG_WHERE(lanes, status) -(-(status) & lag_lanes_bits(lanes))\n"
  " |#define LAG_STATUS(lanes, code) -lag_lanes_bits(lanes)\n"
  " |#define LAG_FAILED(status) lag_failed(status)\n"
  " |/* Lanes that a status names. */\n"
  " |static LAG_MASK lag_failed(int status) {\n"
  " |  LAG_MASK lanes = {0};\n"
  " |  for (int i = 0; i < LAG_LANES; i++) lanes[i] = -(-status >> i & 1);\n"
  " |  return lanes;\n"
  " |}\n"
  " |#else\n"
  " |#define LAG_TRY(call) do { status = (call); if (status != LAG_OK) return status; } while (0)\n"
  " |#define LAG_WHERE(lanes, status) (status)\n"
  " |#define LAG_STATUS(fails, code) ((fails) ? (int)(code) : (int)LAG_OK)\n"
  " |#define LAG_FAILED(status) ((status) != LAG_OK)\n"
  " |#endif\n";

static const char *const move =
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
  " |/* An adaptive method: a trial step, its order, the controller's exponent, safety and limits. */\n"
  " |typedef struct lag_controller {\n"
  " |  int (*trial)(const lag_params *p, const lag_state *s, LAG_REAL hHELD, LAG_REAL (*k)[LAG_NY], lag_state *end, const lag_adaptive *w, LAG_REAL *error);\n"
  " |  int order, ratio;\n"
  " |  LAG_REAL beta, safety, least, most;\n"
  " |} lag_controller;\n"
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
  " |/* The first step to try: E. Hairer, S. P. Norsett, G. Wanner, Solving Ordinary Differential Equations I, 2nd ed. (1993), II.4. */\n"
  " |static LAG_REAL lag_first_step(const lag_params *p, const lag_adaptive *w, int order, LAG_REAL dir, LAG_REAL t, const LAG_REAL *yHELD,\n"
  " |    LAG_REAL (*k)[LAG_NY]) {\n"
  " |  const LAG_REAL d0 = lag_norm(w, y, y), d1 = lag_norm(w, k[0], y), tiny = LAG_C(1e-5), zero = LAG_C(0.0);\n"
  " |  LAG_REAL x[LAG_NY], h0 = LAG_SELECT(LAG_OR(d0 < tiny, d1 < tiny), LAG_C(1e-6), LAG_C(0.01)*d0/d1);\n"
  " |  h0 = LAG_SELECT(LAG_AND(w->longest > zero, h0 > w->longest), w->longest, h0);\n"
  " |  for (int i = 0; i < LAG_NY; i++) x[i] = y[i] + dir*h0*k[0][i];\n"
  " |  const LAG_MASK failed = LAG_FAILED(lag_rates(p, t + dir*h0, xPASS, k[1]));\n"
  " |  if (!LAG_ANY(LAG_NOT(failed))) return h0*LAG_C(1e-3);\n"
  " |  for (int i = 0; i < LAG_NY; i++) k[1][i] -= k[0][i];\n"
  " |  const LAG_REAL d2 = lag_norm(w, k[1], y)/h0, d = LAG_SELECT(d1 > d2, d1, d2), most = LAG_C(100.0)*h0;\n"
  " |  LAG_REAL h = LAG_SELECT(LAG_C(1e-3)*h0 > LAG_C(1e-6), LAG_C(1e-3)*h0, LAG_C(1e-6));\n"
  " |  h = LAG_SELECT(d <= LAG_C(1e-15), h, LAG_FN(pow)(LAG_C(0.01)/d, LAG_C(1.0)/(LAG_LANE)order));\n"
  " |  h = LAG_SELECT(h < most, h, most);\n"
  " |  return LAG_SELECT(LAG_AND(LAG_NOT(failed), LAG_AND(h > zero, h - h == zero)), h, h0*LAG_C(1e-3));\n"
  " |}\n";

/* Tries of several states, each with its own size. */
static const char *const lanes =
  " |\n"
  " |#ifdef LAG_LANES\n"
  " |/* After a try of h: the sizes of the next steps of the lanes in `taken`, and of the next tries of those in `again`, whose memory is then negative.\n"
  " | * wanted: the size without `until`, which ended the steps in `clipped`. */\n"
  " |static void lag_resize(const lag_controller *c, lag_adaptive *w, LAG_REAL h, LAG_REAL error, LAG_MASK taken, LAG_MASK again, LAG_REAL wanted,\n"
  " |    LAG_MASK clipped) {\n"
  " |  const LAG_REAL zero = LAG_C(0.0), one = LAG_C(1.0), two = LAG_C(2.0), tiny = LAG_C(1e-24), floor_of_error = LAG_C(1e-8);\n"
  " |  const LAG_REAL least = lag_rough_power(floor_of_error, -c->beta/two), power = lag_rough_power(LAG_SELECT(error > tiny, error, tiny), -c->beta/two);\n"
  " |  const LAG_REAL most = LAG_SELECT(w->memory < zero, one, c->most);\n"
  " |  LAG_REAL f = c->safety, less = c->safety*lag_rough_power(error, -LAG_C(0.5)*(LAG_LANE)c->ratio*c->beta);\n"
  " |  f /= LAG_SELECT(w->memory > zero, w->memory, least);\n"
  " |  for (int i = 0; i < c->ratio; i++) f *= power;\n"
  " |  f = LAG_SELECT(most < f, most, f);\n"
  " |  f = h*LAG_SELECT(c->least > f, c->least, f);\n"
  " |  f = LAG_SELECT(LAG_AND(clipped, LAG_NOT(f > wanted)), wanted, f);\n"
  " |  less = LAG_SELECT(error >= zero, h*LAG_SELECT(c->least > less, c->least, less), h/two);\n"
  " |  w->step = LAG_SELECT(taken, f, LAG_SELECT(again, less, w->step));\n"
  " |  w->memory = LAG_SELECT(taken, LAG_SELECT(error > floor_of_error, power, least), LAG_SELECT(again, -one, w->memory));\n"
  " |}\n"
  " |\n"
  " |static int lag_adapt(const lag_controller *c, const lag_params *p, lag_state *s, lag_adaptive *w, LAG_REAL untilHELD,\n"
  " |    LAG_REAL (*k)[LAG_NY]) {\n"
  " |  const LAG_REAL zero = LAG_C(0.0), one = LAG_C(1.0), dir = LAG_SELECT(until < s->t, -one, one), gap = dir*(until - s->t);\n"
  " |  const LAG_MASK busy = until != s->t;\n"
  " |  LAG_REAL y[LAG_NY], error;\n"
  " |  lag_state end = *s;\n"
  " |  if (!LAG_ANY(busy)) return LAG_OK;\n"
  " |  lag_gather(s, y);\n"
  " |  int status = lag_rates(p, s->t, yPASS, k[0]);\n"
  " |  const LAG_MASK first = LAG_AND(LAG_AND(busy, LAG_NOT(w->step > zero)), LAG_NOT(LAG_FAILED(status)));\n"
  " |  if (LAG_ANY(first)) w->step = LAG_SELECT(first, lag_first_step(p, w, c->order, dir, s->t, yPASS, k), w->step);\n"
  " |  const LAG_REAL wanted = LAG_SELECT(LAG_AND(w->longest > zero, w->longest < w->step), w->longest, w->step);\n"
  " |  const LAG_MASK clipped = LAG_NOT(wanted*(one + LAG_C(1e-4)) < gap); /* of NaN, too */\n"
  " |  const LAG_REAL h = LAG_SELECT(clipped, gap, wanted);\n"
  " |  end.t = lag_sum(s->t, dir*h, &end.lost[0]);\n"
  " |  end.t = LAG_SELECT(clipped, until, end.t);\n"
  " |  end.lost[0] = LAG_SELECT(clipped, zero, end.lost[0]);\n"
  " |  LAG_TRY(c->trial(p, s, dir*hPASS, k, &end, w, &error));\n"
  " |  const LAG_MASK moves = LAG_AND(h*c->least > zero, LAG_OR(end.t > s->t, end.t < s->t)), failed = LAG_AND(busy, LAG_OR(LAG_NOT(moves), LAG_FAILED(status)));\n"
  " |  const LAG_MASK good = LAG_AND(busy, LAG_NOT(failed)), taken = LAG_AND(good, LAG_AND(error >= zero, error <= one));\n"
  " |  lag_resize(c, w, h, error, taken, LAG_AND(good, LAG_NOT(taken)), wanted, clipped);\n"
  " |  LAG_MOVE(taken, s, &end);\n"
  " |  return -lag_lanes_bits(failed);\n"
  " |}\n"
  " |#else\n";

/* Steps of one state. */
static const char *const adapt =
  " |static int lag_adapt(const lag_controller *c, const lag_params *p, lag_state *s, lag_adaptive *w, LAG_REAL untilHELD,\n"
  " |    LAG_REAL (*k)[LAG_NY]) {\n"
  " |  const LAG_REAL zero = LAG_C(0.0), one = LAG_C(1.0), floor_of_error = LAG_C(1e-8), dir = until < s->t ? -one : one;\n"
  " |  LAG_REAL y[LAG_NY];\n"
  " |  lag_gather(s, y);\n"
  " |  int status = lag_rates(p, s->t, yPASS, k[0]);\n"
  " |  if (status != LAG_OK) return status;\n"
  " |  if (!(w->step > zero)) w->step = lag_first_step(p, w, c->order, dir, s->t, yPASS, k);\n"
  " |  for (int retried = 0;; retried = 1) {\n"
  " |    const LAG_REAL wanted = w->longest > zero && w->longest < w->step ? w->longest : w->step, gap = dir*(until - s->t);\n"
  " |    const int clipped = !(wanted*(one + LAG_C(1e-4)) < gap); /* of NaN, too */\n"
  " |    lag_state end = *s;\n"
  " |    LAG_REAL error;\n"
  " |    w->step = clipped ? gap : wanted;\n"
  " |    end.t = lag_sum(s->t, dir*w->step, &end.lost[0]);\n"
  " |    if (clipped) end.t = until, end.lost[0] = zero;\n"
  " |    if (!(end.t > s->t) && !(end.t < s->t)) return LAG_ESTEP;\n"
  " |    status = c->trial(p, s, dir*w->stepPASS, k, &end, w, &error);\n"
  " |    if (status != LAG_OK) return status;\n"
  " |    if (error >= zero && error <= one) {\n"
  " |      const LAG_REAL least = lag_rough_power(floor_of_error, -c->beta/LAG_C(2.0));\n"
  " |      const LAG_REAL power = lag_rough_power(error > LAG_C(1e-24) ? error : LAG_C(1e-24), -c->beta/LAG_C(2.0));\n"
  " |      const LAG_REAL most = retried ? one : c->most;\n"
  " |      LAG_REAL f = c->safety;\n"
  " |      f /= w->memory > zero ? w->memory : least;\n"
  " |      for (int i = 0; i < c->ratio; i++) f *= power;\n"
  " |      f = most < f ? most : f;\n"
  " |      w->memory = error > floor_of_error ? power : least;\n"
  " |      w->step *= c->least > f ? c->least : f;\n"
  " |      if (clipped && !(w->step > wanted)) w->step = wanted;\n"
  " |      *s = end;\n"
  " |      return LAG_OK;\n"
  " |    }\n"
  " |    w->memory = zero;\n"
  " |    if (error >= zero) {\n"
  " |      const LAG_REAL f = c->safety*lag_rough_power(error, -LAG_C(0.5)*(LAG_REAL)c->ratio*c->beta);\n"
  " |      w->step *= c->least > f ? c->least : f;\n"
  " |    } else {\n"
  " |      w->step /= LAG_C(2.0);\n"
  " |    }\n"
  " |  }\n"
  " |}\n"
  " |#endif\n";

static const char *const adaptive_begin =
  " | {\n"
  " |  w->tolerance = w->absolute = tolerance;\n"
  " |  w->longest = LONGEST;\n"
  " |  w->step = w->memory = LAG_C(0.0);\n"
  " |}\n";

void header_adaptive_declare(const Header *h) { csupport_expand(type, h->upper, h->lower, h->out); }

void header_failures(const Header *h) { header_template(h, failures, NULL); }
void header_move(const Header *h) { header_template(h, move, NULL); }

void header_adaptive_define(const Header *h, const char *longest) {
  const HeaderWord words[] = {{"LONGEST", longest}, {NULL, NULL}};
  header_template(h, begin, NULL);
  header_template(h, lanes, NULL);
  header_template(h, adapt, NULL);
  csupport_expand("\nLAG_API void lag_adaptive_begin(lag_adaptive *w, LAG_REAL tolerance)", h->upper, h->lower, h->out);
  header_template(h, adaptive_begin, words);
}
