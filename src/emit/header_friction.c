/* Steps of an emitted header with dry friction, by Moreau's method. Enters: accelerations with held modes
 * (ir/program_set.h), switching functions. Leaves: what the state says of surfaces, prototypes and functions of the
 * steps. Holds: a body that sticks at the end of a step has no velocity of slipping there, to rounding; each step
 * has the digits of the runtime's, whose text it carries (kernels/joint_friction.h). header_moreau.c: contacts. */
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
    " |  const int status = lag_held_accel(STATE, p, now, DERIVED);\n"
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

static const char *const instance =
    "g|\n"
    "g|/* bound := static friction, in parts of that of motion. */\n"
    "g|static int lag_friction_grips(const lag_params *p, LAG_REAL t, const LAG_REAL *yHELD, const LAG_REAL *mode, "
    "LAG_REAL *bound) {\n"
    "g|  LAG_REAL now[LAG_NU + NMODES], grip[NMODES];\n"
    "g|  lag_friction_inputs(INPUTSmode, now);\n"
    "g|  const int status = lag_switch_grips(STATE, p, now, grip);\n"
    "g|  for (int j = 0; j < LAG_NSURFACES; j++) bound[j] = grip[lag_surface_at[j]];\n"
    "g|  return status;\n"
    "g|}\n"
    " |\n"
    " |#define LAG_MODEL const lag_params *pHELD\n"
    " |#define LAG_THE_MODEL pPASS\n"
    " |#define LAG_JOINTS(w) LAG_NSURFACES\n"
    " |#define LAG_HOLD(w, j, value) (w)->mode[j] = value\n"
    " |#define LAG_SLIPS(t, y, x, w, g) lag_friction_slips(p, t, y, xPASS, (w)->mode, g)\n"
    "g|#define LAG_GRIPS(t, y, w, g) lag_friction_grips(p, t, yPASS, (w)->mode, g)\n"
    "o|#define LAG_GRIPS(t, y, w, g) 0\n"
    " |#define LAG_MODE_RATES(t, y, w, k) lag_friction_rates(p, t, yPASS, (w)->mode, k)\n"
    " |#define LAG_FRICTION_FAILS(t, j, words) ((int)LAG_ECONTACT)\n";

static const char *const step =
    " |\n"
    " |#define LAG_LAWS lag_joint_friction\n"
    " |#define LAG_KICK_RATES(t, y, w, k) LAG_MODE_RATES(t, y, w, k)\n"
    " |#define LAG_RESPONSES(s, w) lag_joints_respond(LAG_THE_MODEL, w, s)\n"
    " |#define LAG_OBEY(s, w) lag_joints_solve(LAG_THE_MODEL, w, s, 0, (w)->x)\n"
    " |#define LAG_STRUCK(w) 0\n"
    " |#define LAG_TERM_SIZE(w, i, rate) lag_joints_size(w, i, rate)\n"
    " |#define LAG_KICK_FAILS(t) ((int)LAG_ENEWTON)\n";

static const char *const note =
    " |\n"
    " |static void lag_moreau_note(const lag_joint_friction *w, lag_state *s) {\n"
    " |  for (int j = 0; j < LAG_NSURFACES; j++) {\n"
    " |    s->mode[j] = w->mode[j];\n"
    " |    s->touch[j] = w->sticks[j] > LAG_C(0.0) ? (LAG_REAL)LAG_STICKS : (LAG_REAL)LAG_SLIPS;\n"
    " |  }\n"
    " |}\n";

/* A function of the state with modes behind the inputs, also where there are no inputs. */
static void held_function(const Header *h, const Prog *p, const char *name, const char *params,
                          const char *const *extra, const char *const *out) {
  if (!h->u->u.n) params = arena_printf(h->a, "const %s_REAL *u, %s", h->upper, params);
  header_internal_function(h, p, name, params, h->u->u.n ? extra + 1 : extra, out);
}

/* Lines for models without coordinates, with static friction, without. */
static void write_part(const Header *h, const char *text, const HeaderWord *words) {
  int grips = h->u->switch_grips != NULL;
  const LineChoice choices[] = {{'n', !h->u->q.n}, {'g', grips}, {'o', !grips}, {0, 0}};
  header_template(h, header_chosen(h, text, choices), words);
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
      {"DERIVED", u->q.n && u->z.n ? "k + LAG_NQ, k + 2*LAG_NQ" : "k + LAG_NQ"},
      {NULL, NULL}};
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
  write_part(h, values, words);
  header_section(h, "friction");
  header_section(h, "mean");
  write_part(h, instance, words);
  header_section(h, "surfaces");
  write_part(h, step, words);
  header_section(h, "kick");
  write_part(h, note, words);
}
