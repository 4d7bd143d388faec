/* The const lag_model of an emitted model file, and the tables that it names. */

#include "emit/emit_impl.h"
#include "emit/late_text.h"

static uint32_t work_size(const ProgramSet *u) {
  ProgList all = program_set_programs(u);
  uint32_t most = 0;
  for (uint32_t i = 0; i < all.n; i++)
    if (prog_work_size(all.at[i]) > most) most = prog_work_size(all.at[i]);
  return most;
}

static const char *or_null(uint32_t n, const char *name) { return n ? name : "NULL"; }

/* Table `curves`: input, number of rows, their width and array of each input that is a table; rates share those of
 * their input. */
static void emit_curves(const ProgramSet *u, StrBuf *out) {
  const Prog *p = u->inputs;
  if (!p->tables.n) return;
  sb_puts(out, "\nstatic const lag_table curves[] = {\n");
  for (uint32_t k = 0; k < p->stores.n; k++) {
    const Ins *i = &p->ins.at[p->stores.at[k].slot];
    if (i->op != IR_TABLE || p->tables.at[i->index].order) continue;
    const Spline *c = p->tables.at[i->index].curve;
    sb_printf(out, "  {%u, %u, %d, %s[0]},\n", p->stores.at[k].index, c->n, c->jet ? 4 : 3,
              model_rows_names(u)[i->index]);
  }
  sb_puts(out, "};\n");
}

static void second_table(const ProgramSet *u, StrBuf *out) {
  static const char *const parts[] = {"LAG_QQ", "LAG_VQ", "LAG_VV", "LAG_FQ", "LAG_FV"};
  if (!u->second_at.n) return;
  sb_puts(out, "\nstatic const lag_second second_table[] = {\n");
  vec_each(const IrSecond, s, u->second_at) sb_printf(out, "  {%s, %u, %u},\n", parts[s->part], s->row, s->col);
  sb_puts(out, "};\n");
}

static void event_table(const ProgramSet *u, StrBuf *out) {
  if (!u->events.n) return;
  sb_puts(out, "\nstatic const lag_event ev_table[] = {\n");
  for (uint32_t i = 0; i < u->events.n; i++)
    sb_printf(out, u->events.at[i].direction == EVENT_KICK ? "  {%s, LAG_KICK},\n" : "  {%s, %d},\n",
              c_string(u->arena, u->events.at[i].name), u->events.at[i].direction);
  sb_puts(out, "};\n");
}

/* Members that every model has. */
static void common_members(const ProgramSet *u, StrBuf *out) {
  static const char *const flags[UNIT_FLAGS] = {
#define MODEL_FLAG(name) "LAG_" #name,
#include "ir/flags.def"
#undef MODEL_FLAG
  };
  const char *model = c_string(u->arena, u->name), *doc = c_string(u->arena, u->doc),
             *effects = c_string(u->arena, u->effects);
  sb_printf(out,
            "  .abi = LAG_ABI, .real_size = sizeof(LAG_REAL),\n  .name = %s,\n  .doc = %s,\n  .effects = %s,\n  "
            ".digest = \"",
            model, doc, effects);
  late_digest(out);
  sb_puts(out, "\",\n  .flags = ");
  model_flags(u->flags, flags, UNIT_FLAGS, out);
  sb_puts(out, ",\n  .ops = ");
  late_int(out, ops_total(prog_count(u->accel)));
  sb_puts(out, ",\n");
  sb_printf(out, "  .nq = %u, .nz = %u, .np = %u, .nu = %u, .nev = %u, .nw = %u,\n", u->q.n, u->z.n, u->p.n, u->u.n,
            u->events.n, work_size(u));
  sb_printf(out, "  .q = %s, .z = %s, .p = %s, .u = %s, .ev = %s,\n", or_null(u->q.n, "q_table"),
            or_null(u->z.n, "z_table"), or_null(u->p.n, "p_table"), or_null(u->u.n, "u_table"),
            or_null(u->events.n, "ev_table"));
  if (u->nderived) sb_printf(out, "  .nderived = %u, .derive = derive,\n", u->nderived);
  sb_printf(out, "  .inputs = %s, .accel = accel, .energy = %s,\n  .events = %s, .act = %s,\n",
            or_null(u->u.n, "inputs"), u->energy ? "energy" : "NULL", or_null(u->events.n, "events"),
            or_null(u->events.n, "act"));
}

/* Members of models with tables, constraints, contacts, charges, switches, derivatives. */
static void further_members(const ProgramSet *u, StrBuf *out) {
  if (u->inputs->tables.n) sb_puts(out, "  .ntables = sizeof curves / sizeof *curves, .tables = curves,\n");
  if (u->constraints.of.n) sb_puts(out, "  .constraints = &constraints,\n");
  if (u->contacts.n) sb_printf(out, "  .ncontacts = %u, .contacts = contact_table,\n", u->contacts.n);
  if (u->families.n) sb_puts(out, "  .families = &families,\n");
  if (u->contact_laws) sb_puts(out, "  .contact_laws = contact_laws,\n");
  if (u->guide_loads) sb_puts(out, "  .guide_loads = guide_loads,\n");
  if (program_set_guides(u)) sb_printf(out, "  .nguides = %u, .guides = guide_table,\n", program_set_guides(u));
  if (u->sizes.n)
    sb_printf(out, "  .nsizes = %u, .sizes = size_table, .size_values = %s,\n", u->sizes.n - u->nmoving,
              u->size_values ? "size_values" : "NULL");
  if (u->nmoving) sb_printf(out, "  .nmoving = %u, .moving_sizes = moving_sizes,\n", u->nmoving);
  if (u->charges.n) sb_puts(out, "  .charges = &charges,\n");
  if (u->switches.n)
    sb_printf(out, "  .nswitch = %u, .switches = switch_table, .switch_values = switch_values,\n", u->switches.n);
  if (u->nmodes) sb_printf(out, "  .nmodes = %u, .switch_rates = switch_rates,\n", u->nmodes);
  if (u->switch_grips) sb_puts(out, "  .switch_grips = switch_grips,\n");
  if (u->variation)
    sb_printf(out, "  .variation = variation, .second = second,\n  .second_at = %s, .nsecond = %u,\n",
              or_null(u->second_at.n, "second_table"), u->second_at.n);
  if (u->kepler) sb_puts(out, "  .kepler = &kepler_part,\n");
  if (u->inverse) sb_puts(out, "  .inverse = inverse_dynamics,\n");
  if (u->taylor) sb_puts(out, "  .taylor = &taylor,\n");
  if (model_has_linear(u)) sb_puts(out, "  .linear = &linear,\n");
  sb_puts(out, "  .math = LAG_OWN ? \"sin and cos: lag_math.h\" : \"sin and cos: the C library's\",\n");
  if (u->fixed[0]) sb_printf(out, "  .fixed = %s,\n", c_string(u->arena, u->fixed));
}

void emit_model_struct(const ProgramSet *u, const char *name, StrBuf *fill, StrBuf *out) {
  table_vars("q_table", u->q.at, u->q.n, fill, u->arena, out);
  table_vars("z_table", u->z.at, u->z.n, fill, u->arena, out);
  table_vars("p_table", u->p.at, u->p.n, fill, u->arena, out);
  table_vars("u_table", u->u.at, u->u.n, fill, u->arena, out);
  event_table(u, out);
  emit_curves(u, out);
  second_table(u, out);
  sb_printf(out, "\nconst lag_model %s = {\n", name);
  common_members(u, out);
  further_members(u, out);
  sb_puts(out, "};\n");
}
