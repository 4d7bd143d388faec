/* Parts of an emitted header that `--with outputs,adjoint` asks for: Jacobians of outputs, steps in reverse. */
#include "emit/header_impl.h"

/* Derivatives of outputs and formulas, with their positions. */
static void output_partials(const Header *h) {
  static const char *const d[] = {"d", NULL};
  const char *head = arena_printf(h->a, "static int %s_partials_outputs(%s, %s_REAL *d)", h->lower,
                                  header_state_args(h, 1, ""), h->upper);
  sb_printf(h->out, "\nstatic const unsigned short %s_by_outputs_at[][2] = {%s};\n", h->lower,
            header_positions(h, LIST(h->u->outputs_at)));
  header_state_function(h, h->u->outputs, NULL, header_wrapped(h, head), d, d, 1);
}

/* Lines marked a: outputs contain accelerations or rates of states; i: and there are inputs. */
static const char *const output_jacobian_body =
  " | {\n"
  " |  LAG_REAL d[NALL];\n"
  "a|  LAG_REAL A[LAG_NY*LAG_NY];\n"
  "i|  LAG_REAL B[LAG_NY*LAG_NU];\n"
  " |  int status = lag_partials_outputs(ARGS, d);\n"
  "a|  if (status == LAG_OK) status = lag_linearize(ARGSMATRICES);\n"
  " |  for (int i = 0; i < LAG_NOUT*LAG_NY; i++) C[i] = LAG_C(0.0);\n"
  "u|  for (int i = 0; i < LAG_NOUT*LAG_NU; i++) D[i] = LAG_C(0.0);\n"
  " |  for (int k = 0; k < NENTRIES && status == LAG_OK; k++) {\n"
  " |    const int row = lag_by_outputs_at[k][0], col = lag_by_outputs_at[k][1];\n"
  " |    if (row >= LAG_NOUT) break;\n"
  " |    if (col < LAG_NY) C[row*LAG_NY + col] += d[k];\n"
  "u|    else if (col < LAG_NY + LAG_NU) D[row*LAG_NU + col - LAG_NY] += d[k];\n"
  "a|    else if (col < PARAMETERS) {\n"
  "a|      const int rate = col - RATES;\n"
  "a|      for (int j = 0; j < LAG_NY; j++) C[row*LAG_NY + j] += d[k]*A[rate*LAG_NY + j];\n"
  "i|      for (int j = 0; j < LAG_NU; j++) D[row*LAG_NU + j] += d[k]*B[rate*LAG_NU + j];\n"
  "a|    }\n"
  " |  }\n"
  " |  return status;\n"
  " |}\n";

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
static const char *const adjoint_step_body =
  " | {\n"
  " |  const LAG_REAL half = LAG_C(0.5), part[] = {LAG_C(0.0), half, half, LAG_C(1.0)};\n"
  " |  LAG_REAL y[4][LAG_NY], k[4][LAG_NY], last[LAG_NY], sum[LAG_NY];\n"
  " |  int status = LAG_OK;\n"
  "u|  LAG_REAL now[LAG_NU];\n"
  " |  lag_gather(s, y[0]);\n"
  " |  for (int i = 0; i < LAG_NY; i++) last[i] = sum[i] = LAG_C(0.0);\n"
  " |  for (int r = 0; r < 4; r++) {\n"
  " |    for (int i = 0; i < LAG_NY && r; i++) y[r][i] = y[0][i] + part[r]*h*k[r - 1][i];\n"
  " |    LAG_TRY(lag_rates(p, s->t + part[r]*h, y[r]INPUTS, k[r]));\n"
  " |  }\n"
  " |  for (int r = 3; r >= 0; r--) {\n"
  " |    const LAG_REAL t = s->t + part[r]*h, b = h/LAG_C(6.0)*(r % 3 ? LAG_C(2.0) : LAG_C(1.0));\n"
  " |    LAG_REAL weight[LAG_NY], by_up[BOTH], d[NALL];\n"
  "u|    const LAG_REAL *const held = lag_held(p, t, u, 0, 0, now);\n"
  " |    for (int i = 0; i < LAG_NY; i++) weight[i] = b*x[i] + (r < 3 ? part[r + 1]*h*last[i] : LAG_C(0.0));\n"
  " |    LAG_TRY(lag_reverse(AT, k[r] + NCOORDS, weight + NCOORDS, last, by_up, d));\n"
  "q|    for (int i = 0; i < LAG_NQ; i++) last[LAG_NQ + i] += weight[i];\n"
  " |    for (int i = 0; i < LAG_NY; i++) sum[i] += last[i];\n"
  " |    for (int i = 0; i < LAG_NP; i++) g[i] += by_up[NINPUTS + i];\n"
  "f|    for (int i = 0; i < NFORMULAS && !u; i++) g[lag_formulas_at[i][1]] += by_up[lag_formulas_at[i][0]]*d[i];\n"
  " |  }\n"
  " |  for (int i = 0; i < LAG_NY; i++) x[i] += sum[i];\n"
  " |  return status;\n"
  " |}\n";

static void adjoint_step(const Header *h) {
  static const char *const own[] = {"a", "g", "by_y", "by_up", "d", NULL}, *const out[] = {"by_y", "by_up", "d"};
  const ProgramSet *u = h->u;
  const char *R = h->upper;
  uint32_t n = u->formulas_at.n;
  header_internal_function(h, u->adjoint, "reverse",
                           arena_printf(h->a,
                                        "const %s_REAL *a, const %s_REAL *g, %s_REAL *by_y, %s_REAL *by_up, "
                                        "%s_REAL *d",
                                        R, R, R, R, R),
                           own, out);
  if (n)
    sb_printf(h->out, "\nstatic const unsigned short %s_formulas_at[][2] = {%s};\n", h->lower,
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
