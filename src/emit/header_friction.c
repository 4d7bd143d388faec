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

uint32_t header_guides(const ProgramSet *u) { return program_set_contacts(u) ? 0 : u->contacts.n; }

const char *header_friction_lacks(const ProgramSet *u) {
  uint32_t n = header_surfaces(u) + program_set_guides(u);
  if (program_set_contacts(u) && n)
    return "contacts or dry friction, not both: rk4, rk45 and dop853 decide at each state whether a body slips";
  for (uint32_t k = 0; k < u->switches.n; k++) {
    const IrSwitch *s = &u->switches.at[k];
    if (s->jumps && (k >= u->nmodes || s->nonnegative))
      return "dry friction along coordinates, and not against the direction of a velocity";
  }
  return n ? NULL : "contacts or dry friction; rk4, rk45 and dop853 step every model without them";
}

/* Position of each guide among constraints and inputs, components of its force. */
static const char *guide_table(const Header *h) {
  StrBuf b = strbuf(h->a);
  for (uint32_t i = 0; i < h->u->contacts.n; i++) {
    const IrContact *c = &h->u->contacts.at[i];
    sb_printf(&b, "%s{%u, %u, %u, %u}", i ? ", " : "", c->input, c->force, c->constraint, c->parts);
  }
  return sb_text(&b);
}

static const char *surface_table(const Header *h) {
  StrBuf b = strbuf(h->a);
  for (uint32_t k = 0; k < h->u->nmodes; k++)
    if (h->u->switches.at[k].jumps) sb_printf(&b, "%s%u", b.n ? ", " : "", k);
  return sb_text(&b);
}

void header_friction_indices(const Header *h) {
  uint32_t n = 0, switches = h->u->switches.n;
  sb_puts(h->out, "\n/* Surfaces, for touch and mode of the state: where the quantity in the name is 0 a body may "
                  "stick. */\nenum {\n");
  for (uint32_t k = 0; k < h->u->nmodes; k++)
    if (h->u->switches.at[k].jumps)
      sb_printf(h->out, "  %s = %u, /* %s */\n", h->surfaces[k], n++, comment_text(h->a, h->u->switches.at[k].surface));
  for (uint32_t i = 0; i < header_guides(h->u); i++)
    sb_printf(h->out, "  %s = %u, /* %s */\n", h->surfaces[switches + i], n++,
              comment_text(h->a, h->u->constraints.of.at[h->u->contacts.at[i].constraint].name));
  sb_printf(h->out, "  %s_NSURFACES = %u\n};\n", h->upper, n);
}

void header_friction_members(const Header *h) {
  csupport_expand("  LAG_REAL touch[LAG_NSURFACES]; /* in the last _moreau_step: LAG_SLIPS, LAG_STICKS; LAG_OPEN "
                  "before the first */\n"
                  "  LAG_REAL mode[LAG_NSURFACES];  /* mean of the sign of the quantity in that step: friction in "
                  "parts of its size */\n",
                  h->upper, h->lower, h->out);
  if (header_guides(h->u))
    csupport_expand("  LAG_REAL rubs; /* the largest friction of a guide so far */\n", h->upper, h->lower, h->out);
}

static const char *const values =
    " |\n"
    "m|static const unsigned short lag_surface_at[] = {AT_SURFACES}; /* mode of each surface */\n"
    "j|/* Guides: inputs that stick them and apply their friction, constraints of slips, components of forces. */\n"
    "j|static const struct { unsigned short sticks, force, slip, parts; } lag_guide_at[] = {AT_GUIDES};\n"
    " |\n"
    " |/* now := the inputs at time t, and modes behind them; those of corners are not held. */\n"
    " |static void lag_friction_inputs(PARAMSconst LAG_REAL *mode, LAG_REAL *now) {\n"
    "u|  const LAG_REAL *const x = lag_held(p, t, u, input, context, now);\n"
    "u|  for (int i = 0; i < LAG_NU && x != now; i++) now[i] = x[i];\n"
    "m|  for (int k = 0; k < NMODES; k++) now[LAG_NU + k] = LAG_C(1e30);\n"
    "m|  for (int j = 0; j < NSWITCHED; j++) now[LAG_NU + lag_surface_at[j]] = mode[j];\n"
    "j|  for (int g = 0; g < NGUIDES; g++) now[lag_guide_at[g].sticks] = now[lag_guide_at[g].force] = LAG_C(0.0);\n"
    "x|  (void)mode;\n"
    " |}\n";

static const char *const rates =
    " |\n"
    " |static int lag_friction_rates(const lag_params *p, LAG_REAL t, const LAG_REAL *yHELD, const LAG_REAL *mode, "
    "RUBSINLAG_REAL *k) {\n"
    " |  LAG_REAL now[LAG_NU + NMODES], finite = LAG_C(0.0);\n"
    " |  lag_friction_inputs(INPUTSmode, now);\n"
    "j|  const int found = lag_guide_friction(p, t, yPASS, mode, rubs, now);\n"
    "j|  if (found != LAG_OK) return found;\n"
    "q|  for (int i = 0; i < LAG_NQ; i++) k[i] = y[LAG_NQ + i];\n"
    " |  const int status = lag_ACCELERATIONS(STATE, p, now, DERIVED);\n"
    " |  for (int i = 0; i < LAG_NY; i++) finite += LAG_C(0.0)*k[i];\n"
    " |  return status != LAG_OK || finite == LAG_C(0.0) ? status : (int)LAG_ECONTACT;\n"
    " |}\n";

static const char *const slips =
    " |\n"
    " |/* g := the quantity of each surface for coordinates y and velocities and states x. */\n"
    " |static int lag_friction_slips(const lag_params *p, LAG_REAL t, const LAG_REAL *y, const LAG_REAL *xHELD, const "
    "LAG_REAL *mode, LAG_REAL *g) {\n"
    " |  LAG_REAL now[LAG_NU + NMODES]OF_ALL;\n"
    " |  lag_friction_inputs(INPUTSmode, now);\n"
    "m|  const int status = lag_switch_values(QUANTITY, p, now, all);\n"
    "m|  for (int j = 0; j < NSWITCHED; j++) g[j] = all[lag_surface_at[j]];\n"
    "j|  LAG_REAL gaps[LAG_NC], rate[LAG_NC];\n"
    "j|  for (int k = 0; k < NGUIDES; k++) now[lag_guide_at[k].sticks] = LAG_C(1.0);\n"
    "j|  const int held = lag_residuals(t, y, x + LAG_NQSTATES, p, now, gaps, rate);\n"
    "j|  for (int k = 0; k < NGUIDES; k++) g[NSWITCHED + k] = rate[lag_guide_at[k].slip];\n"
    "n|  (void)y;\n"
    " |  return SLIPPED;\n"
    " |}\n";

/* Forces that press guides, before the section of slipping forces, and their friction behind it. */
static const char *const pressing =
    "j|\n"
    "j|typedef struct lag_guided { const lag_params *p; const LAG_REAL *y; LAG_REAL t, *now; } lag_guided;\n"
    "j|\n"
    "j|/* mu[n], N[3 n], and hold[n], static friction, for frictions x. */\n"
    "j|static int lag_guide_pressing(const lag_guided *s, const LAG_REAL *x, LAG_REAL *mu, LAG_REAL *N, LAG_REAL "
    "*hold) {\n"
    "j|  const LAG_REAL *const y = s->y, t = s->t, *const now = s->now;\n"
    "j|  LAG_REAL law[7*NGUIDES];\n"
    "j|  for (int k = 0; k < NGUIDES; k++) s->now[lag_guide_at[k].force] = x[k];\n"
    "j|  const int status = lag_contact_laws(STATE, s->p, now, law);\n"
    "j|  for (int k = 0; k < NGUIDES; k++) {\n"
    "j|    mu[k] = law[3*k];\n"
    "j|    hold[k] = law[3*NGUIDES + 4*k];\n"
    "j|    for (int c = 0; c < 3; c++) N[3*k + c] = law[3*NGUIDES + 4*k + 1 + c];\n"
    "j|  }\n"
    "j|  return status;\n"
    "j|}\n"
    "j|\n"
    "j|#define LAG_MODEL const lag_guided *s\n"
    "j|#define LAG_THE_MODEL s\n"
    "j|#define LAG_PRESSING(w) lag_guide_pressing(s, (w)->x, (w)->mu, (w)->N, (w)->change)\n"
    "j|#define LAG_SLIPPING_FAILS(w, k, by) ((int)LAG_ECONTACT)\n";

static const char *const guided =
    "j|\n"
    "j|/* Frictions into the inputs now, with modes as held; where the state decides, their sign. */\n"
    "j|static int lag_guide_friction(const lag_params *p, LAG_REAL t, const LAG_REAL *yHELD, const LAG_REAL *mode, "
    "LAG_REAL *rubs, LAG_REAL *now) {\n"
    "j|  const lag_guided s = {p, y, t, now};\n"
    "j|  LAG_REAL room[LAG_SLIPPING_ROOM(NGUIDES)], slip[LAG_NSURFACES];\n"
    "j|  lag_slipping w;\n"
    "j|  int status = LAG_OK;\n"
    "j|  w.n = w.guides = NGUIDES, w.alone = 1, w.epsilon = lag_epsilon(), w.size = *rubs;\n"
    "j|  lag_slipping_place(&w, NGUIDES, room);\n"
    "j|  for (int k = 0; k < NGUIDES; k++) {\n"
    "j|    w.parts[k] = (LAG_REAL)lag_guide_at[k].parts;\n"
    "j|    w.mode[k] = mode[NSWITCHED + k];\n"
    "j|    if (!(w.mode[k] > LAG_C(1e29))) continue;\n"
    "j|    LAG_TRY(lag_friction_slips(p, t, y, yPASS, mode, slip));\n"
    "j|    w.mode[k] = slip[NSWITCHED + k] > LAG_C(0.0) ? LAG_C(1.0) : slip[NSWITCHED + k] < LAG_C(0.0) ? "
    "-LAG_C(1.0) : LAG_C(0.0);\n"
    "j|  }\n"
    "j|  LAG_TRY(lag_slipping_solve(&s, &w));\n"
    "j|  for (int k = 0; k < NGUIDES; k++) now[lag_guide_at[k].force] = w.x[k];\n"
    "j|  *rubs = w.size;\n"
    "j|  return status;\n"
    "j|}\n";

static const char *const instance =
    "g|\n"
    "g|/* bound := static friction, in parts of that of motion. */\n"
    "g|static int lag_friction_grips(const lag_params *p, LAG_REAL t, const LAG_REAL *yHELD, const LAG_REAL *mode, "
    "LAG_REAL *bound) {\n"
    "g|  LAG_REAL now[LAG_NU + NMODES]OF_GRIPS;\n"
    "g|  lag_friction_inputs(INPUTSmode, now);\n"
    "s|  const int status = lag_switch_grips(STATE, p, now, grip);\n"
    "s|  for (int j = 0; j < NSWITCHED; j++) bound[j] = grip[lag_surface_at[j]];\n"
    "j|  LAG_REAL none[NGUIDES], mu[NGUIDES], N[3*NGUIDES], hold[NGUIDES];\n"
    "j|  const lag_guided s = {p, y, t, now};\n"
    "j|  for (int k = 0; k < NGUIDES; k++) none[k] = LAG_C(0.0);\n"
    "j|  const int held = lag_guide_pressing(&s, none, mu, N, hold);\n"
    "j|  for (int k = 0; k < NGUIDES; k++) bound[NSWITCHED + k] = mu[k] > LAG_C(0.0) ? hold[k]/mu[k] : LAG_C(1.0);\n"
    "g|  return GRIPPED;\n"
    "g|}\n"
    " |\n"
    "j|#undef LAG_MODEL\n"
    "j|#undef LAG_THE_MODEL\n"
    " |#define LAG_MODEL const lag_params *pHELDRUBBED\n"
    " |#define LAG_THE_MODEL pPASSRUBS\n"
    " |#define LAG_JOINTS(w) LAG_NSURFACES\n"
    " |#define LAG_HOLD(w, j, value) (w)->mode[j] = value\n"
    "k|#define LAG_SLIPS(t, y, x, w, g) lag_friction_slips(p, t, y, xPASS, (w)->mode, g)\n"
    "j|#define LAG_SLIPS(t, y, x, w, g) ((void)rubs, lag_friction_slips(p, t, y, xPASS, (w)->mode, g))\n"
    "g|#define LAG_GRIPS(t, y, w, g) lag_friction_grips(p, t, yPASS, (w)->mode, g)\n"
    "o|#define LAG_GRIPS(t, y, w, g) 0\n"
    " |#define LAG_MODE_RATES(t, y, w, k) lag_friction_rates(p, t, yPASS, (w)->modeRUBS, k)\n"
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

/* Lines for models without coordinates, with surfaces of switches, with and without guides, with guides alone,
 * with static friction, of switches, without. */
static void write_part(const Header *h, const char *text, const HeaderWord *words) {
  int switches = header_surfaces(h->u) > 0, guides = header_guides(h->u) > 0, held = h->u->switch_grips != NULL,
      grips = guides || held;
  const LineChoice choices[] = {{'n', !h->u->q.n}, {'m', switches}, {'j', guides}, {'k', !guides}, {'x', !switches},
                                {'g', grips},      {'s', held},     {'o', !grips}, {0, 0}};
  header_template(h, header_chosen(h, text, choices), words);
}

/* Status of calls for switches and for guides. */
static const char *both_status(int switches, int guides) {
  return !guides ? "status" : !switches ? "held" : "status != LAG_OK ? status : held";
}

/* Functions around the programs that know modes. */
static void define_held(const Header *h) {
  static const char *const all[] = {"u", "all", NULL}, *const both[] = {"u", "a", "zd", NULL},
                           *const a[] = {"u", "a", NULL}, *const zd[] = {"u", "zd", NULL},
                           *const outputs[] = {"u", "out", NULL};
  const ProgramSet *u = h->u;
  const char *R = h->upper;
  const char *to = u->q.n && u->z.n ? "%s_REAL *a, %s_REAL *zd" : u->q.n ? "%s_REAL *a" : "%s_REAL *zd";
  held_function(h, u->held_accel, "held_accel", arena_printf(h->a, to, R, R),
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
}

/* Rates and slips; of models with guides rates with their friction. */
static void define_rates(const Header *h, const HeaderWord *words) {
  static const char *const law[] = {"law", NULL};
  int some = header_guides(h->u) > 0;
  if (some) {
    header_internal_function(h, h->u->contact_laws, "contact_laws", arena_printf(h->a, "%s_REAL *law", h->upper), law,
                             law);
    header_section(h, "friction");
    write_part(h, slips, words);
    write_part(h, pressing, words);
    header_section(h, "band_matrix");
    header_section(h, "slipping");
    write_part(h, guided, words);
  }
  write_part(h, rates, words);
  if (some) return;
  write_part(h, slips, words);
  header_section(h, "friction");
}

void header_friction_define(const Header *h) {
  const ProgramSet *u = h->u;
  const char *z = u->z.n ? ", y + 2*LAG_NQ" : "", *x = u->z.n ? ", x + 2*LAG_NQ" : "";
  int switches = header_surfaces(u) > 0, guides = header_guides(u) > 0;
  const HeaderWord words[] = {
      {"AT_SURFACES", surface_table(h)},
      {"AT_GUIDES", guide_table(h)},
      {"NGUIDES", arena_printf(h->a, "%u", header_guides(u))},
      {"NSWITCHED", guides ? arena_printf(h->a, "%u", header_surfaces(u)) : "LAG_NSURFACES"},
      {"NMODES", arena_printf(h->a, "%u", switches ? u->nmodes : 0)},
      {"NSWITCHES", arena_printf(h->a, "%u", u->switches.n)},
      {"PARAMS",
       u->u.n ? "const lag_params *p, LAG_REAL t, const LAG_REAL *u, lag_input_fn *input, void *context, " : ""},
      {"INPUTS", u->u.n ? "p, t, u, input, context, " : ""},
      {"STATES", u->z.n ? ", x + 2*LAG_NQ" : ""},
      {"STATE", arena_printf(h->a, "t%s%s", u->q.n ? ", y, y + LAG_NQ" : "", z)},
      {"QUANTITY", arena_printf(h->a, "t%s%s", u->q.n ? ", y, x + LAG_NQ" : "", x)},
      {"DERIVED", u->q.n && u->z.n ? "k + LAG_NQ, k + 2*LAG_NQ" : "k + LAG_NQ"},
      {"OF_ALL", switches ? arena_printf(h->a, ", all[%u]", u->switches.n) : ""},
      {"OF_GRIPS", u->switch_grips ? arena_printf(h->a, ", grip[%u]", u->nmodes) : ""},
      {"SLIPPED", both_status(switches, guides)},
      {"GRIPPED", both_status(u->switch_grips != NULL, guides)},
      {"ACCELERATIONS", u->held_accel ? "held_accel" : "accel"},
      {"RUBSIN", guides ? "LAG_REAL *rubs, " : ""},
      {"RUBBED", guides ? ", LAG_REAL *rubs" : ""},
      {"RUBS", guides ? ", rubs" : ""},
      {NULL, NULL}};
  if (switches) define_held(h);
  write_part(h, values, words);
  define_rates(h, words);
  header_section(h, "mean");
  write_part(h, instance, words);
  header_section(h, "surfaces");
  write_part(h, step, words);
  header_section(h, "kick");
  write_part(h, note, words);
}
