/* Declarations of an emitted header: options, indices, structs, prototypes. */
#include <string.h>

#include "emit/header_impl.h"
#include "emit/late_text.h"
#include "emit/header_declarations_text.h"

/* --- indices --- */

/* Unit of a variable for a comment: " [deg]: 1 deg is 0.01745 in SI". */
static const char *unit_text(const Header *h, const IrUnit *u) {
  if (!u->text[0]) return "";
  if (u->offset != 0)
    return arena_printf(h->a, " [%s]: 0 %s is %s in SI", u->text, u->text, shortest_double(h->a, u->offset));
  if (u->factor == 1) return arena_printf(h->a, " [%s]", u->text);
  return arena_printf(h->a, " [%s]: 1 %s is %s in SI", u->text, u->text, shortest_double(h->a, u->factor));
}

static void size(const Header *h, const char *name, uint32_t n) { header_printf(h, "  LAG_%s = %u,\n", name, n); }

static void sizes(const Header *h) {
  const ProgramSet *u = h->u;
  sb_puts(h->out, "\n/* Sizes: coordinates, states, both with velocities, parameters, inputs, events, constraints, "
                  "outputs. */\nenum {\n");
  size(h, "NQ", u->q.n);
  size(h, "NZ", u->z.n);
  size(h, "NY", 2 * u->q.n + u->z.n);
  size(h, "NP", u->p.n);
  size(h, "NU", u->u.n);
  size(h, "NEV", u->events.n);
  if (u->constraints.of.n) size(h, "NC", u->constraints.of.n), size(h, "NHOLONOMIC", u->constraints.nholonomic);
  header_printf(h, "  LAG_NOUT = %u\n};\n", h->scene->plain.n);
}

static void indices(const Header *h, const char *comment, const char **names, const IrVar *v, uint32_t n) {
  if (!n) return;
  const char **line = ARENA_ARRAY(h->a, const char *, n);
  for (uint32_t i = 0; i < n; i++) {
    const char *text = arena_printf(h->a, "%s%s", v[i].name, unit_text(h, v[i].unit));
    line[i] = arena_printf(h->a, "  %s = %u%s /* %s */\n", names[i], i, i + 1 < n ? "," : "", comment_text(h->a, text));
  }
  sb_printf(h->out, "\n/* %s */\nenum {\n", comment);
  late_lines(h->out, line, n);
  sb_puts(h->out, "};\n");
}

static void event_indices(const Header *h) {
  uint32_t n = h->u->events.n;
  if (!n) return;
  sb_puts(h->out, "\n/* Events: where their function, from _events, changes sign. */\nenum {\n");
  for (uint32_t i = 0; i < n; i++) {
    const IrEvent *ev = &h->u->events.at[i];
    const char *way = ev->direction == EVENT_KICK ? "a kick; its function is the time between two"
                      : ev->direction > 0         ? "rising"
                      : ev->direction < 0         ? "falling"
                                                  : "crossing";
    sb_printf(h->out, "  %s = %u%s /* %s, %s%s */\n", h->ev[i], i, i + 1 < n ? "," : "", ev->name, way,
              ev->stop ? ", ends the run" : "");
  }
  sb_puts(h->out, "};\n");
}

/* --- structs --- */

static const char *sign_text(int sign) {
  return sign == 1 ? " > 0" : sign == 2 ? " >= 0" : sign == -1 ? " < 0" : sign == -2 ? " <= 0" : "";
}

static void params_struct(const Header *h) {
  const ProgramSet *u = h->u;
  long double *value = ARENA_ARRAY(h->a, long double, u->p.n + 1),
              *y = ARENA_ARRAY(h->a, long double, 2 * u->q.n + u->z.n + 1);
  scene_values(u, h->scene, value, y, ARENA_ARRAY(h->a, long double, u->u.n + 1));
  sb_printf(h->out, "\n/* Parameters, with the values of scene %s. */\ntypedef struct %s_params {\n", h->scene->name,
            h->lower);
  if (!h->u->p.n) sb_puts(h->out, "  char none; /* C has no empty struct */\n");
  for (uint32_t i = 0; i < h->u->p.n; i++) {
    const IrVar *v = &h->u->p.at[i];
    int converts = v->unit->factor != 1 || v->unit->offset != 0;
    const char *text = arena_printf(h->a, "%s%s, default %s%s", unit_text(h, v->unit), sign_text(v->sign),
                                    shortest_double(h->a, (double)value[i]), converts ? " (SI)" : "");
    if (*text == ' ' || *text == ',') text++;
    sb_printf(h->out, "  %s_REAL %s; /* %s */\n", h->upper, h->fields[i],
              comment_text(h->a, *text == ' ' ? text + 1 : text));
  }
  header_printf(h, "} lag_params;\n");
}

static void input_type(const Header *h) {
  if (!h->u->u.n) return;
  header_printf(h, "\n/* Sets those of the inputs u[LAG_NU] that it knows, at time t. */\ntypedef void "
                   "lag_input_fn(void *context, LAG_REAL t, LAG_REAL *u);\n");
}

static void state_struct(const Header *h) {
  header_printf(h, "\ntypedef struct lag_state {\n  LAG_REAL t; /* time [s] */\n");
  if (h->u->q.n)
    header_printf(h, "  LAG_REAL q[LAG_NQ]; /* coordinates */\n  LAG_REAL v[LAG_NQ]; /* their time derivatives */\n");
  if (h->u->z.n) header_printf(h, "  LAG_REAL z[LAG_NZ]; /* states */\n");
  header_printf(
      h,
      "  LAG_REAL lost[1 + LAG_NY]; /* rounding of t, q, v, z that the steps to here have lost; 0 at the start */\n");
  if (header_has_method(h, "moreau")) header_moreau_members(h);
  header_printf(h, "} lag_state;\n");
}

/* --- prototypes --- */

static const char *const docs[FN_COUNT] = {
    [FN_DEFAULTS] = "The parameters of the scene.",
    [FN_PARAM] = "A parameter by its index LAG_P_...; 0 when there is none. For tables and sliders.",
    [FN_START] = "The state at the start of the scene. LAG_ESIZE: it is as it was.",
    [FN_INPUTS] =
        "The inputs u[LAG_NU] at time t by the model's formulas and tables; a table holds its end values outside.",
    [FN_ACCEL] = "Accelerations a[LAG_NQ], rates zd[LAG_NZ] of the states: what an integrator needs.",
    [FN_ENERGY] = "e[0]: the energy p q' - L; e[1]: |p q'| + |L|, the scale of its drift.",
    [FN_CHARGES] =
        "out[2*k]: the charge of symmetry k; out[2*k + 1]: the magnitude of its terms, the scale of its drift.",
    [FN_POWERS] = "Rates of change per second: out[0] of the energy, out[k + 1] of the charge of symmetry k.",
    [FN_OBSERVE] = "Outputs of the scene: out[LAG_NOUT].",
    [FN_EVENTS] = "The event functions g[LAG_NEV].",
    [FN_ACT] = "Applies the action of an event to the state; *stop becomes 1 if the event ends the run.",
    [FN_HOLD] = "Moves a state beside the constraints onto them, to the nearest by the metric of the mass matrix; "
                "steps do so themselves.\n"
                " * LAG_EUNMET: no small change obeys them; begin nearer, or step shorter.",
    [FN_RK4_STEP] = "A step h by the classical Runge-Kutta method of order 4; on failure *s is as it was. Events, and "
                    "contacts, are the caller's.",
    [FN_UNTIL_EVENT] =
        "As _rk4_step, to the first event in the step: *event is its index, and *s the state just behind it, where "
        "_act applies; -1: none.\n"
        " * Crossings are found one by one, however short the time between them, as in `lagc run --method rk4`.\n"
        " * A function that is 0 at the start, or whose event has just acted, has the sign with which it leaves 0. Of\n"
        " * events at the same time the first is told.\n"
        " * LAG_ENAN: an event function is not a number; LAG_EZENO: events follow each other without time between "
        "them. *s is as it was then.",
    [FN_RHS] = "dydt[LAG_NY]: the rates of y = (q, v, z), for integrators of first order.",
    [FN_MASS] = "The mass matrix M[LAG_NQ*LAG_NQ], row by row.",
    [FN_BIAS] = "b[LAG_NQ] of M q'' + b = 0: Coriolis and centrifugal terms, weight and the forces of the model, with "
                "their signs changed.",
    [FN_INVERSE] = "The generalised forces M a + b that are needed besides those of the model for the accelerations a.",
    [FN_JAC] = "J[LAG_NY*LAG_NY], row by row: derivatives of the rates of y = (q, v, z) by y, at held inputs.",
    [FN_JVP] = "out[LAG_NY] = J x, without J.",
    [FN_VJP] = "out[LAG_NY] = J^T x, without J.",
    [FN_LINEARIZE] =
        "The linearisation: A[LAG_NY*LAG_NY] of the rates of y = (q, v, z) by y; B[LAG_NY*LAG_NU] by the inputs.",
    [FN_DPARAMS] = "P[LAG_NY*LAG_NP], row by row: derivatives of the rates of y = (q, v, z) by the parameters, each as "
                   "if it were free.",
    [FN_OUTPUT_JACOBIAN] = "C[LAG_NOUT*LAG_NY], row by row: derivatives of the outputs of _observe by y = (q, v, z); "
                           "D[LAG_NOUT*LAG_NU] by the inputs.",
    [FN_ADJOINT_STEP] =
        "The step of _rk4_step from *s, in reverse: for x[LAG_NY] = dJ/dy after the step x becomes dJ/dy before it,\n"
        " * and g[LAG_NP] grows by dJ/dp, each parameter as if it were free. Keep the states of a run, and go back.",
    [FN_CONSTRAINTS] =
        "Residuals of the constraints: c of those on positions, r of all on velocities (rates of the former first).",
    [FN_CONSTRAINT_JACOBIAN] =
        "A[LAG_NC*LAG_NQ], row by row: derivatives of r by the velocities; M q'' = f + A^T lambda.",
    [FN_MULTIPLIERS] = "The multipliers lambda[LAG_NC] of the constraints: their forces are A^T lambda.",
    [FN_RK4_STEP_WITH] =
        "The same with inputs that change during the step: input(context, t, u) finds the model's own in u.",
};

/* Numbered names of the symmetries: "0 spin, 1 momentum"; charge 0, the energy, is left out. */
static const char *charge_names(const Header *h) {
  StrBuf b = strbuf(h->a);
  for (uint32_t i = 1; i < h->u->charges.n; i++)
    sb_printf(&b, "%s%u %s", i > 1 ? ", " : "", i - 1, h->u->charges.at[i].name);
  return comment_text(h->a, sb_text(&b));
}

static void declare_function(const Header *h, HeaderFn f) {
  const ProgramSet *u = h->u;
  const char *doc = f != FN_ACCEL || (u->q.n && u->z.n) ? docs[f]
                    : u->q.n                            ? "Accelerations a[LAG_NQ]: what an integrator needs."
                                                        : "Rates zd[LAG_NZ] of the states: what an integrator needs.";
  if (f == FN_START && u->constraints.of.n)
    doc = "The state at the start of the scene, on the constraints, as `lagc run` finds it with the parameters of "
          "_defaults; with others, _hold\n"
          " * leads from there to the nearest one that obeys them.";
  if (f == FN_START && u->constraints.of.n)
    header_printf(h, "\nenum { LAG_EUNMET = -7 }; /* status: the constraints cannot be met near this state */\n");
  if (f == FN_UNTIL_EVENT) header_printf(h, "\nenum { LAG_EZENO = -5 };\n");
  sb_puts(h->out, "\n/* ");
  header_printf(h, "%s", doc);
  if (f == FN_CHARGES) sb_printf(h->out, "\n * Symmetries: %s.", charge_names(h));
  if ((f == FN_RK4_STEP || f == FN_UNTIL_EVENT || f == FN_RHS) && u->u.n)
    sb_puts(h->out,
            "\n * u: the inputs, constant during the step, as of a digital controller; 0 for the model's formulas.");
  sb_puts(h->out, " */\n");
  if (f == FN_UNTIL_EVENT) {
    header_printf(h, "#ifdef LAG_LANES\n");
    header_one_state(h, "step_until_event", "make steps, look at the signs of _events, and go to an event of a lane");
    sb_puts(h->out, "#else\n");
  }
  sb_printf(h->out, "%s\n%s", header_wrapped(h, "LAG_API %s;", header_prototype(h, f)),
            f == FN_UNTIL_EVENT ? "#endif\n" : "");
}

void header_declarations(const Header *h) {
  const ProgramSet *u = h->u;
  header_callbacks_include(h);
  header_printf(h, "%s", options);
  sizes(h);
  indices(h, "Coordinates: q[...], and their time derivatives v[...].", h->q, u->q.at, u->q.n);
  indices(h, "States: z[...].", h->z, u->z.at, u->z.n);
  indices(h, "Inputs: u[...]. NULL stands for the formulas of the model in steps, nowhere else.", h->in, u->u.at,
          u->u.n);
  const char *outputs =
      h->scene->plain.n < h->scene->outputs.n
          ? "Outputs: out[...]. Those with closed forms or action variables, which need a run, are left out."
          : "Outputs: out[...].";
  indices(h, outputs, h->outputs, h->scene->outputs.at, h->scene->plain.n);
  event_indices(h);
  indices(h, "Parameters, for _param.", h->p, u->p.at, u->p.n);
  if (header_has_method(h, "moreau")) header_moreau_indices(h);
  params_struct(h);
  state_struct(h);
  sb_puts(h->out, "\n#ifdef __cplusplus\nextern \"C\" {\n#endif\n");
  input_type(h);
  for (int f = 0; f < FN_COUNT; f++)
    if (header_has(h, (HeaderFn)f)) declare_function(h, (HeaderFn)f);
  header_steps_declare(h);
  header_name_tables(h);
  header_callbacks_declare(h);
  sb_puts(h->out, "\n#ifdef __cplusplus\n}\n#endif\n");
}
