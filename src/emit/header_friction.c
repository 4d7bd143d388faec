/* Steps of an emitted header with dry friction, by Moreau's method. Enters: accelerations with held modes
 * (ir/program_set.h), switching functions. Leaves: what the state says of surfaces, prototypes and functions of the
 * steps. Holds: a body that sticks at the end of a step has no velocity of slipping there, to rounding; each step
 * has the digits of the runtime's (methods/moreau_joint_friction.c). Friction of contacts: header_moreau.c. */
#include "emit/header_impl.h"

uint32_t header_surfaces(const ProgramSet *u) {
  uint32_t n = 0;
  for (uint32_t k = 0; k < u->nmodes; k++) n += u->switches.at[k].jumps != 0;
  return n;
}

const char *header_friction_lacks(const ProgramSet *u) {
  uint32_t n = header_surfaces(u);
  if (u->contacts.n && n)
    return "contacts or dry friction, not both: rk4, rk45 and dop853 decide at each state whether a body slips";
  for (uint32_t k = 0; k < u->switches.n; k++) {
    const IrSwitch *s = &u->switches.at[k];
    if (s->jumps && (k >= u->nmodes || s->nonnegative))
      return "dry friction along coordinates, and not against the direction of a velocity";
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
  sb_puts(h->out, "\n/* Surfaces, for touch and mode of the state: where the quantity in the name is 0 a body may "
                  "stick. */\nenum {\n");
  for (uint32_t k = 0; k < h->u->nmodes; k++)
    if (h->u->switches.at[k].jumps)
      sb_printf(h->out, "  %s = %u, /* %s */\n", h->surfaces[k], n++, comment_text(h->a, h->u->switches.at[k].surface));
  sb_printf(h->out, "  %s_NSURFACES = %u\n};\n", h->upper, n);
}

void header_friction_members(const Header *h) {
  csupport_expand("  LAG_REAL touch[LAG_NSURFACES]; /* in the last _moreau_step: LAG_SLIPS, LAG_STICKS; LAG_OPEN "
                  "before the first */\n"
                  "  LAG_REAL mode[LAG_NSURFACES];  /* mean of the sign of the quantity in that step: friction in "
                  "parts of its size */\n",
                  h->upper, h->lower, h->out);
}

static const char *const values =
    " |\n"
    " |static const unsigned short lag_surface_at[] = {AT_SURFACES}; /* mode of each surface */\n"
    " |\n"
    " |/* Room of a step. d: rates for a mode of 1; response: change of a quantity by its own mode; bound: the largest "
    "mode. */\n"
    " |typedef struct lag_moreau_room {\n"
    " |  LAG_REAL d[LAG_NSURFACES][LAG_NY], mode[LAG_NSURFACES], response[LAG_NSURFACES], bound[LAG_NSURFACES], "
    "epsilon;\n"
    " |} lag_moreau_room;\n"
    " |\n"
    " |/* now := the inputs at time t, and modes behind them; those of corners are not held. */\n"
    " |static void lag_friction_inputs(PARAMSconst LAG_REAL *mode, LAG_REAL *now) {\n"
    "u|  const LAG_REAL *const x = lag_held(p, t, u, input, context, now);\n"
    "u|  for (int i = 0; i < LAG_NU && x != now; i++) now[i] = x[i];\n"
    " |  for (int k = 0; k < NMODES; k++) now[LAG_NU + k] = LAG_C(1e30);\n"
    " |  for (int j = 0; j < LAG_NSURFACES; j++) now[LAG_NU + lag_surface_at[j]] = mode[j];\n"
    " |}\n"
    " |\n"
    " |static int lag_friction_rates(const lag_params *p, LAG_REAL t, const LAG_REAL *yHELD, const LAG_REAL *mode, "
    "LAG_REAL *k) {\n"
    " |  LAG_REAL now[LAG_NU + NMODES], finite = LAG_C(0.0);\n"
    " |  lag_friction_inputs(INPUTSmode, now);\n"
    "q|  for (int i = 0; i < LAG_NQ; i++) k[i] = y[LAG_NQ + i];\n"
    " |  const int status = lag_held_accel(STATE, p, now, RATES);\n"
    " |  for (int i = 0; i < LAG_NY; i++) finite += LAG_C(0.0)*k[i];\n"
    " |  return status != LAG_OK || finite == LAG_C(0.0) ? status : (int)LAG_ECONTACT;\n"
    " |}\n"
    " |\n"
    " |/* g := the quantity of each surface for coordinates y and velocities and states x. */\n"
    " |static int lag_friction_slips(const lag_params *p, LAG_REAL t, const LAG_REAL *y, const LAG_REAL *xHELD, const "
    "LAG_REAL *mode, LAG_REAL *g) {\n"
    " |  LAG_REAL now[LAG_NU + NMODES], all[NSWITCHES];\n"
    " |  lag_friction_inputs(INPUTSmode, now);\n"
    " |  const int status = lag_switch_values(QUANTITY, p, now, all);\n"
    " |  for (int j = 0; j < LAG_NSURFACES; j++) g[j] = all[lag_surface_at[j]];\n"
    "n|  (void)y;\n"
    " |  return status;\n"
    " |}\n";

static const char *const solve =
    " |\n"
    " |/* End of a step at time t, from its middle y: velocities and states x change with the modes, by d for a mode "
    "of 1. */\n"
    " |typedef struct lag_friction_end {\n"
    " |  const lag_params *p;\n"
    " |  LAG_REAL t, h, (*d)[LAG_NY], *mode, *x;\n"
    " |  const LAG_REAL *y;\n"
    "u|  const LAG_REAL *u;\n"
    "u|  lag_input_fn *input;\n"
    "u|  void *context;\n"
    " |} lag_friction_end;\n"
    " |\n"
    " |static int lag_friction_slip(void *end, int k, LAG_REAL *slip) {\n"
    " |  const lag_friction_end *const a = (const lag_friction_end *)end;\n"
    " |  LAG_REAL g[LAG_NSURFACES];\n"
    " |  const int status = lag_friction_slips(a->p, a->t, a->y, a->xOF_END, a->mode, g);\n"
    " |  *slip = g[k];\n"
    " |  return status;\n"
    " |}\n"
    " |\n"
    " |static void lag_friction_change(void *end, int k, LAG_REAL mode) {\n"
    " |  const lag_friction_end *const a = (const lag_friction_end *)end;\n"
    " |  const LAG_REAL by = mode - a->mode[k];\n"
    " |  for (int i = LAG_NQ; i < LAG_NY; i++) a->x[i] += a->h*by*a->d[k][i];\n"
    " |  a->mode[k] = mode;\n"
    " |}\n"
    " |\n"
    " |/* Finds modes, and x: each quantity is 0 where its mode is within its bounds, else the mode is 1 or -1. */\n"
    " |static int lag_friction_solve(lag_friction_end *end, const LAG_REAL *response, const LAG_REAL *bound, LAG_REAL "
    "epsilon) {\n"
    " |  LAG_REAL sticks[LAG_NSURFACES], centre[LAG_NSURFACES] = {0}, size;\n"
    " |  const lag_surfaces s = {LAG_NSURFACES, lag_friction_slip, lag_friction_change, end, epsilon, response, bound, "
    "centre, end->mode, sticks};\n"
    " |  int row;\n"
    " |  const int status = lag_surface_sweeps(&s, &size, &row);\n"
    " |  return status == LAG_SURFACE_INFINITE || status == LAG_SURFACES_DISAGREE ? (int)LAG_ECONTACT : status;\n"
    " |}\n"
    " |\n"
    " |/* d, response: what a mode of 1 changes in a step, from the states at its middle, mid, and at its end, x. */\n"
    " |static int lag_friction_response(const lag_params *p, const lag_state *s, LAG_REAL h, const LAG_REAL *midHELD, "
    "const LAG_REAL *mode, const LAG_REAL *x, LAG_REAL (*d)[LAG_NY], LAG_REAL *response) {\n"
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
    " |/* Modes before the step and their bounds: static friction, in parts of that of motion, where a body sticks. "
    "*/\n"
    " |static int lag_friction_begin(const lag_params *p, const lag_state *s, const LAG_REAL *yHELD, lag_moreau_room "
    "*w) {\n"
    " |  LAG_REAL g[LAG_NSURFACES];\n"
    " |  int status = lag_friction_slips(p, s->t, y, yPASS, s->mode, g);\n"
    "g|  LAG_REAL now[LAG_NU + NMODES], grip[NMODES];\n"
    "g|  const LAG_REAL t = s->t;\n"
    "g|  lag_friction_inputs(INPUTSs->mode, now);\n"
    "g|  if (status == LAG_OK) status = lag_switch_grips(STATE, p, now, grip);\n"
    " |  for (int j = 0; j < LAG_NSURFACES && status == LAG_OK; j++) {\n"
    " |    w->mode[j] = s->mode[j];\n"
    " |    w->bound[j] = LAG_C(1.0);\n"
    "g|    const int rests = s->touch[j] == LAG_STICKS || g[j] == LAG_C(0.0);\n"
    "g|    if (rests && grip[lag_surface_at[j]] > LAG_C(1.0)) w->bound[j] = grip[lag_surface_at[j]];\n"
    " |  }\n"
    " |  return status;\n"
    " |}\n"
    " |\n"
    " |/* x: velocities and states at the end of a step from y; mid: its middle, at t. */\n"
    " |static int lag_moreau_kick(const lag_params *p, const lag_state *s, LAG_REAL t, LAG_REAL hHELD, const LAG_REAL "
    "*y, LAG_REAL *mid, LAG_REAL *x, lag_moreau_room *w) {\n"
    " |  const LAG_REAL half = LAG_C(0.5);\n"
    " |  LAG_REAL rate[LAG_NY], before = -LAG_C(1.0);\n"
    " |  lag_friction_end a = {p, s->t + h, h, w->d, w->mode, x, midTO_END};\n"
    " |  for (int turn = 0; turn < 100; turn++) {\n"
    " |    int status = lag_friction_rates(p, t, midPASS, w->mode, rate);\n"
    " |    for (int i = LAG_NQ; i < LAG_NY && status == LAG_OK; i++) x[i] = y[i] + h*rate[i];\n"
    " |    if (status == LAG_OK && turn == 0) status = lag_friction_response(p, s, h, midPASS, w->mode, x, w->d, "
    "w->response);\n"
    " |    if (status == LAG_OK) status = lag_friction_solve(&a, w->response, w->bound, w->epsilon);\n"
    " |    if (status != LAG_OK) return status;\n"
    " |    for (int j = 0; j < LAG_NSURFACES; j++) /* at rest forces cancel: rounding is that of friction */\n"
    " |      for (int i = LAG_NQ; i < LAG_NY; i++) rate[i] = LAG_FN(fabs)(rate[i]) + LAG_FN(fabs)(w->d[j][i]);\n"
    " |    const lag_moreau_ends ends = {h, y, x, rate};\n"
    " |    const LAG_REAL most = lag_moreau_mean(&ends, half, w->epsilon, LAG_NQ, LAG_NZ, mid);\n"
    " |    if (most <= LAG_C(8.0) || (turn > 0 && most <= LAG_C(1e4) && most >= half*before)) return LAG_OK;\n"
    " |    before = most;\n"
    " |  }\n"
    " |  return LAG_ENEWTON;\n"
    " |}\n"
    " |\n"
    " |static void lag_moreau_note(const lag_moreau_room *w, lag_state *s) {\n"
    " |  for (int j = 0; j < LAG_NSURFACES; j++) {\n"
    " |    const LAG_REAL part = LAG_FN(fabs)(w->mode[j]);\n"
    " |    s->mode[j] = w->mode[j];\n"
    " |    s->touch[j] = part < LAG_C(1.0) || part > LAG_C(1.0) ? (LAG_REAL)LAG_STICKS : (LAG_REAL)LAG_SLIPS;\n"
    " |  }\n"
    " |}\n";

/* A function of the state with modes behind the inputs, also where there are no inputs. */
static void held_function(const Header *h, const Prog *p, const char *name, const char *params,
                          const char *const *extra, const char *const *out) {
  if (!h->u->u.n) params = arena_printf(h->a, "const %s_REAL *u, %s", h->upper, params);
  header_internal_function(h, p, name, params, h->u->u.n ? extra + 1 : extra, out);
}

void header_friction_define(const Header *h) {
  static const char *const all[] = {"u", "all", NULL}, *const both[] = {"u", "a", "zd", NULL},
                           *const a[] = {"u", "a", NULL}, *const zd[] = {"u", "zd", NULL},
                           *const outputs[] = {"u", "out", NULL};
  const ProgramSet *u = h->u;
  const char *R = h->upper, *z = u->z.n ? ", y + 2*LAG_NQ" : "", *x = u->z.n ? ", x + 2*LAG_NQ" : "";
  const HeaderWord words[] = {
      {"AT_SURFACES", surface_table(h)},
      {"NMODES", arena_printf(h->a, "%u", u->nmodes)},
      {"NSWITCHES", arena_printf(h->a, "%u", u->switches.n)},
      {"PARAMS",
       u->u.n ? "const lag_params *p, LAG_REAL t, const LAG_REAL *u, lag_input_fn *input, void *context, " : ""},
      {"INPUTS", u->u.n ? "p, t, u, input, context, " : ""},
      {"STATE", arena_printf(h->a, "t%s%s", u->q.n ? ", y, y + LAG_NQ" : "", z)},
      {"QUANTITY", arena_printf(h->a, "t%s%s", u->q.n ? ", y, x + LAG_NQ" : "", x)},
      {"RATES", u->q.n && u->z.n ? "k + LAG_NQ, k + 2*LAG_NQ" : "k + LAG_NQ"},
      {"OF_END", u->u.n ? ", a->u, a->input, a->context" : ""},
      {"TO_END", u->u.n ? ", u, input, context" : ""},
      {NULL, NULL}};
  const char *const parts[] = {values, solve, step};
  const char *rates = u->q.n && u->z.n ? "%s_REAL *a, %s_REAL *zd" : u->q.n ? "%s_REAL *a" : "%s_REAL *zd";
  held_function(h, u->held_accel, "held_accel", arena_printf(h->a, rates, R, R),
                u->q.n && u->z.n ? both
                : u->q.n         ? a
                                 : zd,
                both + 1);
  held_function(h, u->switch_values, "switch_values", arena_printf(h->a, "%s_REAL *all", R), all, all + 1);
  if (u->switch_grips)
    held_function(h, u->switch_grips, "switch_grips", arena_printf(h->a, "%s_REAL *all", R), all, all + 1);
  if (h->parts.follows && h->scene->observe_held)
    held_function(h, h->scene->observe_held, "held_observe", arena_printf(h->a, "%s_REAL *out", R), outputs,
                  outputs + 1);
  embedded_section("friction", h->upper, h->lower, h->out);
  embedded_section("surfaces", h->upper, h->lower, h->out);
  embedded_section("mean", h->upper, h->lower, h->out);
  for (size_t i = 0; i < sizeof parts / sizeof *parts; i++) {
    const LineChoice choices[] = {{'n', !u->q.n}, {'g', u->switch_grips != NULL}, {0, 0}};
    header_template(h, header_chosen(h, parts[i], choices), words);
  }
}
