/* Steps of an emitted header with dry friction, by Moreau's method. Enters: accelerations with held modes (ir/program_set.h), switching functions. Leaves: what the state says of surfaces, prototypes
 * and functions of the steps. Holds: a body that sticks at the end of a step has no velocity of slipping there, to rounding; each step has the digits of the runtime's (methods/moreau_joint_friction.c). Friction of contacts: header_moreau.c. */
#include "emit/header_impl.h"

uint32_t header_surfaces(const ProgramSet *u) {
  uint32_t n = 0;
  for (uint32_t k = 0; k < u->nmodes; k++) n += u->switches.at[k].jumps != 0;
  return n;
}

const char *header_friction_lacks(const ProgramSet *u) {
  uint32_t n = header_surfaces(u);
  if (u->contacts.n && n) return "contacts or dry friction, not both: rk4, rk45 and dop853 decide at each state whether a body slips";
  for (uint32_t k = 0; k < u->switches.n; k++) {
    const IrSwitch *s = &u->switches.at[k];
    if (s->jumps && (k >= u->nmodes || s->nonnegative)) return "dry friction along coordinates, and not against the direction of a velocity";
  }
  return n ? NULL : "contacts or dry friction; rk4, rk45 and dop853 step every model without them";
}

static const char *surface_table(const Header *h) {
  StrBuf b = strbuf(h->a);
  for (uint32_t k = 0; k < h->u->nmodes; k++)
    if (h->u->switches.at[k].jumps) sb_printf(&b, "%s%u", b.n ? ", " : "", k);
  return sb_text(&b);
}

void header_friction_indices(const Header *h) {
  uint32_t n = 0;
  sb_puts(h->out, "\n/* Surfaces, for touch and mode of the state: where the quantity in the name is 0 a body may stick. */\nenum {\n");
  for (uint32_t k = 0; k < h->u->nmodes; k++)
    if (h->u->switches.at[k].jumps) sb_printf(h->out, "  %s = %u, /* %s */\n", h->surfaces[k], n++, comment_text(h->a, h->u->switches.at[k].surface));
  sb_printf(h->out, "  %s_NSURFACES = %u\n};\n", h->upper, n);
}

void header_friction_members(const Header *h) {
  csupport_expand("  LAG_REAL touch[LAG_NSURFACES]; /* in the last _moreau_step: LAG_SLIPS, LAG_STICKS; LAG_OPEN before the first */\n"
                  "  LAG_REAL mode[LAG_NSURFACES];  /* mean of the sign of the quantity in that step: friction in parts of its size */\n", h->upper, h->lower, h->out);
}

static const char *const prototypes =
  " |\n"
  " |/* Forces of dry friction do not agree, or a value is not finite. */\n"
  " |enum { LAG_ECONTACT = -6 };\n"
  " |\n"
  " |/* A step h by Moreau's time-stepping: a body that would turn within the step sticks at its end, as long as static friction holds it; else it slips. Order 2\n"
  " | * but for steps in which a body begins or ends to stick. touch and mode of the state tell which; a copy of the state goes on with the same digits.\n"
  " | * LAG_ENEWTON: forces change too much in the step; a shorter one may help. On failure *s is as it was.\n"
  "u| * u: the inputs, constant during the step; 0 for the model's formulas.\n"
  " | */\n"
  " |LAG_API int lag_moreau_step(const lag_params *p, lag_state *s, LAG_REAL hINPUT);\n"
  "u|\n"
  "u|/* The same with inputs that change from step to step; they are taken at the middle of each. */\n"
  "u|LAG_API int lag_moreau_step_with(const lag_params *p, lag_state *s, LAG_REAL h, lag_input_fn *input, void *context);\n";

void header_friction_declare(const Header *h) {
  const HeaderWord words[] = {{"INPUT", h->u->u.n ? ", const LAG_REAL *u" : ""}, {NULL, NULL}};
  header_template(h, prototypes, words);
}

static const char *const values =
  " |\n"
  " |static const unsigned short lag_surface_at[] = {AT_SURFACES}; /* mode of each surface */\n"
  " |\n"
  " |/* now := the inputs at time t, and modes behind them; those of corners are not held. */\n"
  " |static void lag_friction_inputs(PARAMSconst LAG_REAL *mode, LAG_REAL *now) {\n"
  "u|  const LAG_REAL *const x = lag_held(p, t, u, input, context, now);\n"
  "u|  for (int i = 0; i < LAG_NU && x != now; i++) now[i] = x[i];\n"
  " |  for (int k = 0; k < NMODES; k++) now[LAG_NU + k] = LAG_C(1e30);\n"
  " |  for (int j = 0; j < LAG_NSURFACES; j++) now[LAG_NU + lag_surface_at[j]] = mode[j];\n"
  " |}\n"
  " |\n"
  " |static int lag_friction_rates(const lag_params *p, LAG_REAL t, const LAG_REAL *yHELD, const LAG_REAL *mode, LAG_REAL *k) {\n"
  " |  LAG_REAL now[LAG_NU + NMODES], finite = LAG_C(0.0);\n"
  " |  lag_friction_inputs(INPUTSmode, now);\n"
  "q|  for (int i = 0; i < LAG_NQ; i++) k[i] = y[LAG_NQ + i];\n"
  " |  const int status = lag_held_accel(STATE, p, now, RATES);\n"
  " |  for (int i = 0; i < LAG_NY; i++) finite += LAG_C(0.0)*k[i];\n"
  " |  return status != LAG_OK || finite == LAG_C(0.0) ? status : (int)LAG_ECONTACT;\n"
  " |}\n"
  " |\n"
  " |/* g := the quantity of each surface for coordinates y and velocities and states x. */\n"
  " |static int lag_friction_slips(const lag_params *p, LAG_REAL t, const LAG_REAL *y, const LAG_REAL *xHELD, const LAG_REAL *mode, LAG_REAL *g) {\n"
  " |  LAG_REAL now[LAG_NU + NMODES], all[NSWITCHES];\n"
  " |  lag_friction_inputs(INPUTSmode, now);\n"
  " |  const int status = lag_switch_values(QUANTITY, p, now, all);\n"
  " |  for (int j = 0; j < LAG_NSURFACES; j++) g[j] = all[lag_surface_at[j]];\n"
  "n|  (void)y;\n"
  " |  return status;\n"
  " |}\n";

static const char *const solve =
  " |\n"
  " |/* Finds modes, and x, velocities and states at the end at time t: each quantity is 0 where its mode is within its bounds, else the mode is 1 or -1. d: rates for\n"
  " | * a mode of 1; response: change of a quantity by its own mode. */\n"
  " |static int lag_friction_solve(const lag_params *p, LAG_REAL t, LAG_REAL h, const LAG_REAL *yHELD, LAG_REAL (*d)[LAG_NY], const LAG_REAL *response, const LAG_REAL *bound,\n"
  " |    LAG_REAL epsilon, LAG_REAL *mode, LAG_REAL *x) {\n"
  " |  const LAG_REAL zero = LAG_C(0.0), one = LAG_C(1.0);\n"
  " |  LAG_REAL g[LAG_NSURFACES], size = zero, before = zero;\n"
  " |  for (int sweep = 0; sweep < 10000; sweep++) {\n"
  " |    LAG_REAL change = zero;\n"
  " |    for (int j = 0; j < LAG_NSURFACES; j++) {\n"
  " |      const int status = lag_friction_slips(p, t, y, xPASS, mode, g);\n"
  " |      if (status != LAG_OK) return status;\n"
  " |      LAG_REAL to = response[j] < zero ? mode[j] - g[j]/response[j] : g[j] > zero ? one : g[j] < zero ? -one : zero;\n"
  " |      if (!(to - to == zero)) return LAG_ECONTACT;\n"
  " |      if (to > bound[j]) to = one;\n"
  " |      if (to < -bound[j]) to = -one;\n"
  " |      const LAG_REAL by = to - mode[j], moved = LAG_FN(fabs)(by*response[j]), slip = LAG_FN(fabs)(g[j]), own = LAG_FN(fabs)(response[j]);\n"
  " |      for (int i = LAG_NQ; i < LAG_NY; i++) x[i] += h*by*d[j][i];\n"
  " |      mode[j] = to;\n"
  " |      change = moved > change ? moved : change;\n"
  " |      size = slip > size ? slip : size;\n"
  " |      size = own > size ? own : size;\n"
  " |    }\n"
  " |    if (change <= LAG_C(64.0)*epsilon*size || (sweep > 0 && change <= LAG_C(1e7)*epsilon*size && change >= before/LAG_C(2.0))) return LAG_OK;\n"
  " |    before = change;\n"
  " |  }\n"
  " |  return LAG_ECONTACT;\n"
  " |}\n"
  " |\n"
  " |/* d, response: what a mode of 1 changes in a step, from the states at its middle, mid, and at its end, x. */\n"
  " |static int lag_friction_response(const lag_params *p, const lag_state *s, LAG_REAL h, const LAG_REAL *midHELD, const LAG_REAL *mode, const LAG_REAL *x, LAG_REAL (*d)[LAG_NY], LAG_REAL *response) {\n"
  " |  const LAG_REAL half = LAG_C(0.5);\n"
  " |  for (int j = 0; j < LAG_NSURFACES; j++) {\n"
  " |    LAG_REAL one[LAG_NSURFACES], up[LAG_NY], down[LAG_NY], g0[LAG_NSURFACES], g1[LAG_NSURFACES];\n"
  " |    for (int k = 0; k < LAG_NSURFACES; k++) one[k] = k == j ? LAG_C(1.0) : mode[k];\n"
  " |    int status = lag_friction_rates(p, s->t + half*h, midPASS, one, up);\n"
  " |    one[j] = -LAG_C(1.0);\n"
  " |    if (status == LAG_OK) status = lag_friction_rates(p, s->t + half*h, midPASS, one, down);\n"
  " |    for (int i = 0; i < LAG_NY && status == LAG_OK; i++) {\n"
  " |      d[j][i] = half*(up[i] - down[i]);\n"
  " |      up[i] = x[i] + h*d[j][i];\n"
  " |    }\n"
  " |    if (status == LAG_OK) status = lag_friction_slips(p, s->t + h, mid, xPASS, mode, g0);\n"
  " |    if (status == LAG_OK) status = lag_friction_slips(p, s->t + h, mid, upPASS, mode, g1);\n"
  " |    if (status != LAG_OK) return status;\n"
  " |    response[j] = g1[j] - g0[j];\n"
  " |  }\n"
  " |  return LAG_OK;\n"
  " |}\n";

static const char *const step =
  " |\n"
  " |/* Bounds of the modes: static friction, in parts of that of motion, where a body sticks. */\n"
  " |static int lag_friction_bounds(const lag_params *p, const lag_state *s, const LAG_REAL *yHELD, LAG_REAL *bound) {\n"
  " |  LAG_REAL g[LAG_NSURFACES];\n"
  " |  int status = lag_friction_slips(p, s->t, y, yPASS, s->mode, g);\n"
  "g|  LAG_REAL now[LAG_NU + NMODES], grip[NMODES];\n"
  "g|  const LAG_REAL t = s->t;\n"
  "g|  lag_friction_inputs(INPUTSs->mode, now);\n"
  "g|  if (status == LAG_OK) status = lag_switch_grips(STATE, p, now, grip);\n"
  " |  for (int j = 0; j < LAG_NSURFACES && status == LAG_OK; j++) {\n"
  " |    bound[j] = LAG_C(1.0);\n"
  "g|    const int rests = s->touch[j] == LAG_STICKS || g[j] == LAG_C(0.0);\n"
  "g|    if (rests && grip[lag_surface_at[j]] > LAG_C(1.0)) bound[j] = grip[lag_surface_at[j]];\n"
  " |  }\n"
  " |  return status;\n"
  " |}\n"
  " |\n"
  " |static int lag_moreau(const lag_params *p, lag_state *s, LAG_REAL hHELD) {\n"
  " |  const LAG_REAL half = LAG_C(0.5), epsilon = lag_epsilon();\n"
  " |  LAG_REAL y[LAG_NY], mid[LAG_NY], x[LAG_NY], rate[LAG_NY], d[LAG_NSURFACES][LAG_NY], mode[LAG_NSURFACES], bound[LAG_NSURFACES], response[LAG_NSURFACES], before = -LAG_C(1.0);\n"
  "w|  LAG_REAL now[LAG_NU];\n"
  " |  lag_state end = *s;\n"
  " |  int turn = 0, done = 0;\n"
  " |  lag_gather(s, y);\n"
  " |  for (int i = 0; i < LAG_NY; i++) mid[i] = x[i] = y[i];\n"
  "q|  for (int i = 0; i < LAG_NQ; i++) mid[i] = y[i] + (s->lost[1 + i] + half*h*y[LAG_NQ + i]);\n"
  " |  for (int j = 0; j < LAG_NSURFACES; j++) mode[j] = s->mode[j];\n"
  " |  int status = lag_friction_bounds(p, s, yPASS, bound);\n"
  " |  for (; turn < 100 && !done && status == LAG_OK; turn++) {\n"
  " |    status = lag_friction_rates(p, s->t + half*h, midPASS, mode, rate);\n"
  " |    for (int i = LAG_NQ; i < LAG_NY && status == LAG_OK; i++) x[i] = y[i] + h*rate[i];\n"
  " |    if (status == LAG_OK && turn == 0) status = lag_friction_response(p, s, h, midPASS, mode, x, d, response);\n"
  " |    if (status == LAG_OK) status = lag_friction_solve(p, s->t + h, h, midPASS, d, response, bound, epsilon, mode, x);\n"
  " |    if (status != LAG_OK) return status;\n"
  " |    for (int j = 0; j < LAG_NSURFACES; j++) /* at rest forces cancel: rounding is that of friction */\n"
  " |      for (int i = LAG_NQ; i < LAG_NY; i++) rate[i] = LAG_FN(fabs)(rate[i]) + LAG_FN(fabs)(d[j][i]);\n"
  " |    const LAG_REAL most = lag_moreau_between(h, half, epsilon, y, x, rate, mid);\n"
  " |    done = most <= LAG_C(8.0) || (turn > 0 && most <= LAG_C(1e4) && most >= half*before);\n"
  " |    before = most;\n"
  " |  }\n"
  " |  if (status != LAG_OK) return status;\n"
  " |  if (!done) return LAG_ENEWTON;\n"
  " |  end.t = lag_compensated_sum(s->t, h, &end.lost[0]);\n"
  " |  for (int i = 0; i < LAG_NY; i++) mid[i] = lag_compensated_sum(y[i], i < LAG_NQ ? half*h*(y[LAG_NQ + i] + x[LAG_NQ + i]) : x[i] - y[i], &end.lost[1 + i]);\n"
  " |  lag_scatter(mid, &end);\n"
  " |  for (int j = 0; j < LAG_NSURFACES; j++) {\n"
  " |    const LAG_REAL part = LAG_FN(fabs)(mode[j]);\n"
  " |    end.mode[j] = mode[j];\n"
  " |    end.touch[j] = part < LAG_C(1.0) || part > LAG_C(1.0) ? (LAG_REAL)LAG_STICKS : (LAG_REAL)LAG_SLIPS;\n"
  " |  }\n"
  "h|  status = lag_onto(p, &endAT_END, end.lost + 1);\n"
  " |  if (status == LAG_OK) status = lag_check(&end);\n"
  " |  if (status == LAG_OK) *s = end;\n"
  " |  return status;\n"
  " |}\n"
  " |\n"
  " |LAG_API int lag_moreau_step(const lag_params *p, lag_state *s, LAG_REAL hINPUT) {\n"
  " |  return lag_moreau(p, s, hNOW);\n"
  " |}\n"
  "u|\n"
  "u|LAG_API int lag_moreau_step_with(const lag_params *p, lag_state *s, LAG_REAL h, lag_input_fn *input, void *context) {\n"
  "u|  return lag_moreau(p, s, h, 0, input, context);\n"
  "u|}\n";

/* A function of the state with modes behind the inputs, also where there are no inputs. */
static void held_function(const Header *h, const Prog *p, const char *name, const char *params, const char *const *extra, const char *const *out) {
  if (!h->u->u.n) params = arena_printf(h->a, "const %s_REAL *u, %s", h->upper, params);
  header_internal_function(h, p, name, params, h->u->u.n ? extra + 1 : extra, out);
}

void header_friction_define(const Header *h) {
  static const char *const all[] = {"u", "all", NULL}, *const both[] = {"u", "a", "zd", NULL}, *const a[] = {"u", "a", NULL}, *const zd[] = {"u", "zd", NULL}, *const outputs[] = {"u", "out", NULL};
  const ProgramSet *u = h->u;
  const char *R = h->upper, *z = u->z.n ? ", y + 2*LAG_NQ" : "", *x = u->z.n ? ", x + 2*LAG_NQ" : "";
  int holds = header_has(h, FN_HOLD);
  const HeaderWord words[] = {{"AT_SURFACES", surface_table(h)}, {"NMODES", arena_printf(h->a, "%u", u->nmodes)}, {"NSWITCHES", arena_printf(h->a, "%u", u->switches.n)},
                              {"PARAMS", u->u.n ? "const lag_params *p, LAG_REAL t, const LAG_REAL *u, lag_input_fn *input, void *context, " : ""},
                              {"INPUTS", u->u.n ? "p, t, u, input, context, " : ""}, {"INPUT", u->u.n ? ", const LAG_REAL *u" : ""}, {"NOW", u->u.n ? ", u, 0, 0" : ""},
                              {"STATE", arena_printf(h->a, "t%s%s", u->q.n ? ", y, y + LAG_NQ" : "", z)}, {"QUANTITY", arena_printf(h->a, "t%s%s", u->q.n ? ", y, x + LAG_NQ" : "", x)},
                              {"RATES", u->q.n && u->z.n ? "k + LAG_NQ, k + 2*LAG_NQ" : "k + LAG_NQ"}, {"AT_END", u->u.n ? ", lag_held(p, end.t, u, input, context, now)" : ""}, {NULL, NULL}};
  const char *const parts[] = {values, solve, step};
  const char *rates = u->q.n && u->z.n ? "%s_REAL *a, %s_REAL *zd" : u->q.n ? "%s_REAL *a" : "%s_REAL *zd";
  held_function(h, u->held_accel, "held_accel", arena_printf(h->a, rates, R, R), u->q.n && u->z.n ? both : u->q.n ? a : zd, both + 1);
  held_function(h, u->switch_values, "switch_values", arena_printf(h->a, "%s_REAL *all", R), all, all + 1);
  if (u->switch_grips) held_function(h, u->switch_grips, "switch_grips", arena_printf(h->a, "%s_REAL *all", R), all, all + 1);
  if (h->parts.follows && h->scene->observe_held) held_function(h, h->scene->observe_held, "held_observe", arena_printf(h->a, "%s_REAL *out", R), outputs, outputs + 1);
  header_moreau_between(h);
  for (size_t i = 0; i < sizeof parts / sizeof *parts; i++) {
    const LineChoice choices[] = {{'n', !u->q.n}, {'g', u->switch_grips != NULL}, {'h', holds}, {'w', holds && u->u.n}, {0, 0}};
    header_template(h, header_chosen(h, parts[i], choices), words);
  }
}
