/* Steps of an emitted header by the variational integrator. Enters: the unit's derivatives of L. Leaves: the memory
 * of the method, its prototypes and functions. Holds: each step has the digits of the runtime's, whose text it carries
 * (kernels/galerkin_step.h, galerkin_rule.h, predictor.h); it has one rule and no constraints. */
#include "emit/header_impl.h"
#include "emit/header_variational_text.h"

/* One more than the half-bandwidth of the second derivatives, in the order in which coordinates are declared. */
static uint32_t band(const ProgramSet *u) {
  uint32_t most = 0;
  vec_each(const IrSecond, s, u->second_at) {
    uint32_t d = s->row > s->col ? s->row - s->col : s->col - s->row;
    most = d > most ? d : most;
  }
  return most + 1;
}

static const char *positions(const Header *h) {
  const ProgramSet *u = h->u;
  StrBuf b = strbuf(h->a);
  for (uint32_t k = 0; k < u->second_at.n; k++) {
    const IrSecond *s = &u->second_at.at[k];
    sb_printf(&b, "%s{%d, %u, %u}", !k ? "" : k % 8 ? ", " : ",\n    ", s->part, s->row, s->col);
  }
  return u->second_at.n ? sb_text(&b) : "{0, 0, 0}";
}

static void write(const Header *h, const char *text) {
  const ProgramSet *u = h->u;
  uint32_t n = u->second_at.n;
  const HeaderWord words[] = {
      {"BAND", arena_printf(h->a, "%u", band(u))},
      {"NSECOND", arena_printf(h->a, "%u", n ? n : 1)},
      {"NENTRIES", arena_printf(h->a, "%u", n)},
      {"SECOND_AT", positions(h)},
      {"STEP", u->u.n ? "static int lag_variational_advance" : "LAG_API int lag_variational_step"},
      {"AT_STATE", u->u.n ? ", lag_held(p, s->t, u, input, context, now)" : ""},
      {"AT_START", u->u.n ? ", lag_held(p, d->t, u, input, context, w->now)" : ""},
      {"AT_T", u->u.n ? ", lag_held(p, t, u, input, context, (w)->now)" : ""},
      {"INPUT", u->u.n ? ", const LAG_REAL *u" : ""},
      {NULL, NULL}};
  header_template(h, text, words);
}

void header_variational_declare(const Header *h) {
  write(h, orders);
  header_section(h, "rule");
  write(h, memory);
}

void header_variational_define(const Header *h) {
  header_internal_function(h, h->u->variation, "variation",
                           "dL/dq, the momenta dL/dq', and the generalised forces outside of L.",
                           "LAG_REAL *Lq, LAG_REAL *Lv, LAG_REAL *Q", NULL);
  header_internal_function(h, h->u->second, "second_derivatives", "Their nonzero derivatives.", "LAG_REAL *h", NULL);
  header_sections(h, "gauss points, rule: tables");
  write(h, begin);
  header_sections(h, "predictor, band_matrix, newton, discrete");
  write(h, steps);
}
