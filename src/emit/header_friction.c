/* Steps of an emitted header with dry friction, by Moreau's method. Enters: accelerations with held modes
 * (ir/program_set.h), switching functions. Leaves: what the state says of surfaces, prototypes and functions of the
 * steps. Holds: a body that sticks at the end of a step has no velocity of slipping there, to rounding; each step
 * has the digits of the runtime's, whose text it carries (kernels/joint_friction.h). header_moreau.c: contacts. */
#include "emit/header_impl.h"
#include "emit/header_friction_text.h"

uint32_t header_surfaces(const ProgramSet *u) {
  uint32_t n = 0;
  for (uint32_t k = 0; k < u->nmodes; k++) n += u->switches.at[k].jumps != 0;
  return n;
}

uint32_t header_guides(const ProgramSet *u) { return program_set_guides(u); }

const char *header_friction_lacks(const ProgramSet *u) {
  uint32_t n = header_surfaces(u) + program_set_guides(u);
  for (uint32_t k = 0; k < u->switches.n; k++) {
    const IrSwitch *s = &u->switches.at[k];
    if (s->jumps && (k >= u->nmodes || s->nonnegative))
      return "dry friction along coordinates, and not against the direction of a velocity";
  }
  return n ? NULL : "contacts or dry friction; rk4, rk45 and dop853 step every model without them";
}

/* Guides stand behind contacts. */
static const IrContact *guide_at(const Header *h, uint32_t i) {
  return &h->u->contacts.at[program_set_contacts(h->u) + i];
}

/* Position of each guide among constraints and inputs, components of its force. */
static const char *guide_table(const Header *h) {
  StrBuf b = strbuf(h->a);
  for (uint32_t i = 0; i < header_guides(h->u); i++) {
    const IrContact *c = guide_at(h, i);
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
              comment_text(h->a, h->u->constraints.of.at[guide_at(h, i)->constraint].name));
  header_printf(h, "  LAG_NSURFACES = %u\n};\n", n);
}

void header_friction_members(const Header *h) {
  const char *surfaces = program_set_contacts(h->u) ? "holds" : "touch";
  const char *member = arena_printf(h->a, "  LAG_REAL %s[LAG_NSURFACES]; /* in the last _moreau_step: LAG_SLIPS, "
                                          "LAG_STICKS; LAG_OPEN before the first */\n", surfaces);
  header_printf(h, "%s", member);
  header_printf(h, "  LAG_REAL mode[LAG_NSURFACES];  /* mean of the sign of the quantity in that step: friction in "
                   "parts of its size */\n");
  if (header_guides(h->u)) header_printf(h, "  LAG_REAL rubs; /* the largest friction of a guide so far */\n");
}

/* A function of the state with modes behind the inputs, also where there are no inputs. */
static void held_function(const Header *h, const Prog *p, const char *name, const char *params,
                          const char *const *out) {
  if (!h->u->u.n) params = arena_printf(h->a, "const LAG_REAL *u, %s", params);
  header_internal_function(h, p, name, NULL, params, out);
}

/* Lines for models without coordinates, with surfaces of switches, with and without guides, with guides alone,
 * with static friction, of switches, without. */
static void write_part(const Header *h, const char *text, const HeaderWord *words) {
  int switches = header_surfaces(h->u) > 0, guides = header_guides(h->u) > 0, held = h->u->switch_grips != NULL,
      grips = guides || held;
  int meets = program_set_contacts(h->u) > 0;
  const LineChoice choices[] = {{'n', !h->u->q.n}, {'m', switches}, {'j', guides}, {'k', !guides}, {'x', !switches},
                                {'g', grips},      {'s', held},     {'o', !grips}, {'c', meets},
                                {'l', h->u->guide_loads != NULL},                 {0, 0}};
  header_template(h, header_chosen(h, text, choices), words);
}

/* Status of calls for switches and for guides. */
static const char *both_status(int switches, int guides) {
  return !guides ? "status" : !switches ? "held" : "status != LAG_OK ? status : held";
}

/* Functions around the programs that know modes. */
static void define_held(const Header *h) {
  static const char *const rates_out[] = {"a", "zd"};
  held_function(h, h->u->held_accel, "held_accel", header_rates(h), rates_out);
  held_function(h, h->u->switch_values, "switch_values", "LAG_REAL *all", NULL);
  if (h->u->switch_grips) held_function(h, h->u->switch_grips, "switch_grips", "LAG_REAL *all", NULL);
  if (h->parts.follows && h->scene->observe_held)
    held_function(h, h->scene->observe_held, "held_observe", "LAG_REAL *out", NULL);
}

/* Rates and slips; of models with guides rates with their friction. */
static void define_rates(const Header *h, const HeaderWord *words) {
  int some = header_guides(h->u) > 0, meets = program_set_contacts(h->u) > 0;
  if (some) {
    header_internal_function(h, h->u->contact_laws, "contact_laws", NULL, "LAG_REAL *law", NULL);
    if (!meets) header_section(h, "friction");
    write_part(h, slips, words);
    write_part(h, pressing, words);
    if (!meets) header_section(h, "band_matrix");
    header_section(h, "slipping");
    write_part(h, guided, words);
  }
  write_part(h, rates, words);
  if (some) return;
  write_part(h, slips, words);
  if (!meets) header_section(h, "friction");
}

void header_friction_define(const Header *h) {
  const ProgramSet *u = h->u;
  const char *z = u->z.n ? ", y + 2*LAG_NQ" : "", *x = u->z.n ? ", x + 2*LAG_NQ" : "";
  int switches = header_surfaces(u) > 0, guides = header_guides(u) > 0, meets = program_set_contacts(u) > 0;
  const HeaderWord words[] = {
      {"AT_SURFACES", surface_table(h)},
      {"AT_GUIDES", guide_table(h)},
      {"NGUIDES", arena_printf(h->a, "%u", header_guides(u))},
      {"NALL", arena_printf(h->a, "%u", u->contacts.n)},
      {"LOADS", u->guide_loads ? "rubs + LAG_NSLOPES" : "0"},
      {"NBEFORE", arena_printf(h->a, "%u", program_set_contacts(u))},
      {"NOTED", meets ? "friction_note" : "moreau_note"},
      {"HOLDS", meets ? "holds" : "touch"},
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
  if (!meets) header_section(h, "mean");
  write_part(h, instance, words);
  header_section(h, "surfaces");
  write_part(h, note, words);
  if (meets) return;
  write_part(h, step, words);
  header_section(h, "kick");
}
