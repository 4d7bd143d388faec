/* Parts of an emitted header that `--with outputs,adjoint` asks for: Jacobians of outputs, steps in reverse. */
#include "emit/header_impl.h"
#include "emit/header_outputs_text.h"

/* Derivatives of outputs and formulas, with their positions. */
static void output_partials(const Header *h) {
  header_printf(h, "\nstatic const unsigned short lag_by_outputs_at[][2] = {%s};\n",
                header_positions(h, LIST(h->u->outputs_at)));
  header_internal_function(h, h->u->outputs, "partials_outputs", NULL, "LAG_REAL *d", NULL);
}

/* Lines marked a: outputs contain accelerations or rates of states; i: and there are inputs. */
static void output_jacobian(const Header *h) {
  const ProgramSet *u = h->u;
  uint32_t first = 2 * u->q.n + u->z.n + u->u.n, last = first + u->q.n + u->z.n;
  int some = 0;
  for (uint32_t k = 0; k < u->outputs_at.n; k++)
    some |= u->outputs_at.at[k].row < h->scene->plain.n && u->outputs_at.at[k].col >= first &&
            u->outputs_at.at[k].col < last;
  const LineChoice choices[] = {{'a', some}, {'i', some && u->u.n}, {0, 0}};
  const HeaderWord w[] = {header_number(h, "NALL", u->outputs_at.n ? u->outputs_at.n : 1),
                          header_number(h, "NENTRIES", u->outputs_at.n), header_number(h, "PARAMETERS", last),
                          header_number(h, "RATES", first - u->q.n), {"MATRICES", u->u.n ? ", A, B" : ", A"},
                          {NULL, NULL}};
  header_begin(h, FN_OUTPUT_JACOBIAN), header_template(h, header_chosen(h, output_jacobian_body, choices), w);
}

/* The classical method: y1 = y0 + h/6 (k1 + 2 k2 + 2 k3 + k4); backwards X_s = (df/dy)^T h (b_s x + a X_(s+1)). */
static void adjoint_step(const Header *h) {
  const ProgramSet *u = h->u;
  uint32_t n = u->formulas_at.n;
  header_internal_function(h, u->adjoint, "reverse", NULL,
                           "const LAG_REAL *a, const LAG_REAL *g, LAG_REAL *by_y, LAG_REAL *by_up, LAG_REAL *d", NULL);
  if (n)
    header_printf(h, "\nstatic const unsigned short lag_formulas_at[][2] = {%s};\n",
                  header_positions(h, LIST(u->formulas_at)));
  StrBuf at = strbuf(h->a);
  sb_printf(&at, "t%s", u->q.n ? ", y[r], y[r] + LAG_NQ" : "");
  if (u->z.n) sb_printf(&at, ", y[r] + %u", 2 * u->q.n);
  sb_printf(&at, ", p%s", u->u.n ? ", held" : "");
  const LineChoice choices[] = {{'f', n > 0}, {0, 0}};
  const HeaderWord w[] = {{"AT", sb_text(&at)}, {"INPUTS", u->u.n ? ", u, 0, 0" : ""},
                          header_number(h, "BOTH", u->u.n + u->p.n), header_number(h, "NALL", n ? n : 1),
                          header_number(h, "NCOORDS", u->q.n), header_number(h, "NINPUTS", u->u.n),
                          header_number(h, "NFORMULAS", n), {NULL, NULL}};
  header_begin(h, FN_ADJOINT_STEP), header_template(h, header_chosen(h, adjoint_step_body, choices), w);
}

void header_outputs_define(const Header *h) {
  if (h->parts.parts & (PART_OUTPUTS | PART_OUTPUT_JACOBIAN)) output_partials(h);
  if (header_has(h, FN_OUTPUT_JACOBIAN)) output_jacobian(h);
  if (header_has(h, FN_ADJOINT_STEP)) adjoint_step(h);
}
