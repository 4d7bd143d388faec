/* Families of contacts: the function of one member, tables of what it reads, and the mass matrix. */
#include "emit/emit_impl.h"

static void reads(const char *name, const IrRead *at, uint32_t n, StrBuf *out) {
  enum { A_LINE = 8 };
  if (!n) return;
  sb_printf(out, "\nstatic const lag_read %s[] = {", name);
  for (uint32_t i = 0; i < n; i++)
    sb_printf(out, "%s{%lld, %lld, %lld},", i % A_LINE ? " " : "\n  ", (long long)at[i].first, (long long)at[i].by_row,
              (long long)at[i].by_turn);
  sb_puts(out, "\n};\n");
}

static void family_functions(const ModelFile *f, const IrContactFamily *c, uint32_t i) {
  const char *name = comment_text(f->a, c->name);
  const char *values = "A contact of the family %s: gap, rate, restitution, frictions, slips, rows of A.",
             *reach = "The distance at which %s looks for neighbours, and the box.";
  state_function(f, c->values, arena_printf(f->a, "family_%u", i), arena_printf(f->a, values, name), "", "out");
  state_function(f, c->reach, arena_printf(f->a, "family_%u_reach", i), arena_printf(f->a, reach, name), "", "out");
  reads(arena_printf(f->a, "family_%u_coords", i), c->coords.at, c->coords.n, f->out);
  reads(arena_printf(f->a, "family_%u_params", i), c->params.at, c->params.n, f->out);
}

static void family_row(const ModelFile *f, const IrContactFamily *c, uint32_t i) {
  const char *of = arena_printf(f->a, "family_%u", i);
  sb_printf(f->out, "  {%s, %u, %lld, %lld, %lld, %lld, %lld, %lld, %u, %u, %s%s, %s%s, %u, %s, ",
            c_string(f->a, c->name), c->indices, (long long)c->i0, (long long)c->j0, (long long)c->rows,
            (long long)c->skew, (long long)c->turns, (long long)c->more, c->coords.n, c->params.n, of, "_coords",
            c->params.n ? of : "NULL", c->params.n ? "_params" : "", c->tangents, of);
  sb_printf(f->out, "%s%s, %u, {", c->reach ? of : "NULL", c->reach ? "_reach" : "", c->nplaces);
  for (uint32_t k = 0; k < c->nplaces || k == 0; k++) {
    const IrRead *x = &c->place[k];
    sb_printf(f->out, "%s{%lld, %lld, %lld}", k ? ", " : "", (long long)x->first, (long long)x->by_row,
              (long long)x->by_turn);
  }
  sb_puts(f->out, "}, NULL},\n");
}

void emit_families(const ModelFile *f) {
  const ProgramSet *u = f->u;
  if (!u->families.n) return;
  for (uint32_t i = 0; i < u->families.n; i++) family_functions(f, &u->families.at[i], i);
  state_function(f, u->family_inertia, "family_inertia", "Entries of the mass matrix.", "", "M");
  emit_entries("family_mass", u->family_mass.at, u->family_mass.n, f->out);
  sb_puts(f->out, "\nstatic const lag_contact_family family_table[] = {\n");
  for (uint32_t i = 0; i < u->families.n; i++) family_row(f, &u->families.at[i], i);
  sb_printf(f->out, "};\n\nstatic const lag_contact_families families = {%u, family_table, %u, family_mass, "
            "family_inertia};\n", u->families.n, u->family_mass.n);
}
