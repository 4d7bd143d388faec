/* Charges of symmetries in an emitted model: their values, their rates of change, and the table lag_charge. */
#include "emit/emit_impl.h"

#include <string.h>

static void table(const File *f) {
  static const char *const flags[CHARGE_FLAGS] = {
#define CHARGE_FLAG(name) "LAG_" #name,
#include "ir/flags.def"
#undef CHARGE_FLAG
  };
  sb_puts(f->out, "\nstatic const lag_charge charge_table[] = {\n");
  for (uint32_t i = 0; i < f->u->charges.n; i++) {
    const IrCharge *c = &f->u->charges.at[i];
    sb_printf(f->out, "  {%s, %s, ", c_string(f->a, c->name), c_string(f->a, c->unit));
    int some = 0;
    for (uint32_t k = 0; k < CHARGE_FLAGS; k++)
      if (c->flags >> k & 1) sb_printf(f->out, "%s%s", some++ ? " | " : "", flags[k]);
    sb_printf(f->out, "%s},\n", some ? "" : "0");
  }
  sb_puts(f->out, "};\n");
}

void emit_charges(const File *f) {
  static const char *const own[] = {"t", "q", "v", "z", "p", "u", "out", "w", NULL}, *const written[] = {"out"};
  const IrUnit *u = f->u;
  if (!u->charges.n) return;
  if (u->charge_values) {
    const char *head = arena_printf(f->a, "static int charge_values(%s, LAG_REAL *out, LAG_REAL *w)", emit_state_args);
    emit_function(f, u->charge_values, "The charges of symmetries, and the scales of their drifts.", head, own, written);
  }
  if (u->charge_powers) {
    const char *head = arena_printf(f->a, "static int charge_powers(%s, LAG_REAL *out, LAG_REAL *w)", emit_state_args);
    emit_function(f, u->charge_powers, "Rates of change of the energy and of these charges.", head, own, written);
  }
  table(f);
  sb_printf(f->out, "\nstatic const lag_charges charges = {\n  .n = %u, .of = charge_table, .values = %s, .powers = %s,\n};\n", u->charges.n,
            u->charge_values ? "charge_values" : "NULL", u->charge_powers ? "charge_powers" : "NULL");
}
