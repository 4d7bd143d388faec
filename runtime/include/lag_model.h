/* lag_model.h: what emitted C and the runtime agree on. Includes only <stddef.h>.
 *
 * A model is a const struct of names, sizes and functions, emitted by lagc. Its state is q[nq]
 * (generalised coordinates), v[nq] (their time derivatives) and z[nz] (states that are no
 * coordinate); p[np + nderived] are its parameters, the last of them made of the others by derive; u[nu] its inputs, w[nw] work space for its functions.
 * All values are in SI units. No function allocates, keeps state, or writes past the sizes here.
 * Arrays passed to one call do not overlap.
 *
 * A function returns 0 when all went well, > 0 when a smaller step may help (the value left the
 * model's domain), < 0 when nothing will. */
#ifndef LAG_MODEL_H
#define LAG_MODEL_H

#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

#define LAG_ABI 7

/* The scalar that a model is compiled for: double, float, long double or __float128; or, where LAG_LANES is 4 or 8, vectors of
 * so many doubles: many states, or sets of parameters, at once. Then a status < 0 has bit k of its negative set when lane k
 * is singular; the other lanes are right. */
#ifndef LAG_REAL
#ifdef LAG_LANES
typedef double lag_lanes __attribute__((vector_size(8 * LAG_LANES)));
#define LAG_REAL lag_lanes
#else
#define LAG_REAL double
#define LAG_REAL_IS_DOUBLE 1
#endif
#endif

/* The highest order of Taylor series that a program has room for. */
#ifndef LAG_TAYLOR_ORDER
#define LAG_TAYLOR_ORDER 40
#endif

enum {
  LAG_OK = 0,
  LAG_ERETRY = 1,     /* outside the domain here: a smaller step may help */
  LAG_ESINGULAR = -1  /* the mass matrix is singular at this state, or not positive definite as elsewhere; with LAG_FIRST_ORDER, the two-form */
};

/* Facts about a model, with the inputs that it gives itself, that the compiler proved. */
enum {
  LAG_CONSERVES_ENERGY = 1, /* no t in L, no force, no dissipation, no input */
  LAG_CONSTANT_MASS = 2,    /* d2L/dq'2 depends on no coordinate, velocity or time */
  LAG_AUTONOMOUS = 4,       /* the right-hand side does not contain t */
  LAG_SMOOTH = 8,           /* no if, abs, sign, min, max, and no table */
  LAG_SEPARABLE = 16,       /* constant mass matrix, accelerations that do not depend on velocities, no states */
  LAG_TIMELESS = 32,        /* t enters by the formulas and tables of inputs, if at all */
  LAG_LOSES_ENERGY = 64,    /* not conserved, but with constant inputs the energy, less the work of forces, which are constant,
                             * never grows: the dissipation is quadratic in q' and nowhere negative, for the signs declared */
  LAG_FIRST_ORDER = 128,    /* L = theta(q, t) v - H is linear in all velocities: coordinates are among z, nq is 0, and their rates solve
                             * omega zd = dH/dq + ... with the two-form omega = dtheta in place of a mass matrix */
  LAG_CONSTANT_FORM = 256,  /* and omega depends on no coordinate, state or time, and no force on velocities */
  LAG_MASSLESS = 512        /* the mass matrix is singular; constraints say how what has no inertia moves */
};

/* A named quantity. unit is as declared ("deg"), or as found from the equations, "" when none; x units are
 * x*factor + offset in SI. */
typedef struct lag_var {
  const char *name;
  const char *unit;
  double factor;
  int periodic; /* an angle: 2 pi later is the same place */
  int sign;     /* of a parameter: 1 "> 0", 2 ">= 0", -1 "< 0", -2 "<= 0", 0 any */
  double offset; /* 273.15 of degC; otherwise 0 */
} lag_var;

typedef struct lag_event {
  const char *name;
  int direction; /* 1 rising, -1 falling, 0 both */
} lag_event;

/* The curve of an input that has a table: a cubic between each two of n rows, times increasing. In emitted code
 * alone; the runtime ends steps at the rows. */
typedef struct lag_table {
  int input; /* its index */
  int n;
  const double (*row)[3]; /* time, value, second derivative */
} lag_table;

/* Place of an entry of a sparse matrix. */
typedef struct lag_entry {
  int row, col;
} lag_entry;

/* A derivative of event `event`: of its function (row < 0), or of the value that its actions give to component `row` of (q, v, z);
 * by component `col`, or by the time where col is 2 nq + nz. */
typedef struct lag_jump {
  int event, row, col;
} lag_jump;

/* The linearisation of a model, exact: emitted where something needs it (lagc --with linear).
 *
 * The residuals r[nq + nz] vanish along a motion: r_i = f_i - sum_j M_ij a_j for coordinates i, r_(nq + k) =
 * flow_k - z_k' for states. Their derivatives by y = (q, v, z), at fixed a and z', say all: the accelerations
 * change by da = M^-1 (dr/dy) dy, the rates by their rows of dr/dy. At an equilibrium a is 0, and -dr/dq, -dr/dv are
 * the matrices of stiffness and of damping and gyroscopic forces. See lag_jacobian() in lag.h. */
typedef struct lag_linear {
  int ndr;
  const lag_entry *dr;   /* [ndr] row < nq + nz, col < 2 nq + nz; row by row, columns ascending; others are zero */
  int nmass;
  const lag_entry *mass; /* [nmass] of M's lower triangle, col <= row; M is symmetric */
  int ops;               /* operations of one call, counted */

  /* dr[ndr] and M[nmass] at a state, with the accelerations a[nq] there (or others: 0 gives df/dy). */
  int (*eval)(LAG_REAL t, const LAG_REAL *q, const LAG_REAL *v, const LAG_REAL *z, const LAG_REAL *p,
              const LAG_REAL *u, const LAG_REAL *a, LAG_REAL *dr, LAG_REAL *M, LAG_REAL *w);

  /* What events do to small changes: d[njump], the derivatives that are listed. Those of g that are not are zero, and so are those of
   * a value that is set; each that is set has the entry of its own component. Events that depend on inputs are not listed. */
  int njump;
  const lag_jump *jump;
  int (*jumps)(LAG_REAL t, const LAG_REAL *q, const LAG_REAL *v, const LAG_REAL *z, const LAG_REAL *p,
               const LAG_REAL *u, LAG_REAL *d, LAG_REAL *w);
} lag_linear;

/* One scalar constraint. */
typedef struct lag_constraint {
  const char *name; /* "rod", "rod[2]", "grip.x" */
  int holonomic;    /* the model states c(q, t) = 0; else r(q, v, t) = 0, linear in v */
  const char *unit; /* of c, or of r; "" when none */
  int line;         /* of the model's text where it stands; 0: not known, as in C that `lagc emit` writes */
} lag_constraint;

/* The constraints of a model, n in all, of which the first nholonomic are on positions: c(q, t) = 0; or, where the model states
 * r = 0 and that is dc/dt, c(q, t) as it is at the start. On the level of velocities all are
 * r = A(q, t) v + b(q, t) = 0, where r = dc/dt of those. accel obeys them: its accelerations are those of
 * M a = f + A^T lambda, dr/dt = 0. They leave c and r as they are, so a step's error is to be taken back by the functions below.
 *
 * A change d[nq] of the state with A d = g, and the least for d^T M d, is that of M d = A^T mu. Constraints may be redundant,
 * and then g belongs to those that are not; M may be singular where A fixes what it leaves open. */
typedef struct lag_constraints {
  int n, nholonomic;
  const lag_constraint *of; /* [n] */
  int njacobian;
  const lag_entry *jacobian; /* [njacobian] of A, row < n, col < nq; row by row, columns ascending; others are zero */
  int nmass;
  const lag_entry *mass;     /* [nmass] of M's lower triangle, col <= row */

  /* c[nholonomic] and r[n]. */
  int (*residuals)(LAG_REAL t, const LAG_REAL *q, const LAG_REAL *v, const LAG_REAL *z, const LAG_REAL *p,
                   const LAG_REAL *u, LAG_REAL *c, LAG_REAL *r, LAG_REAL *w);

  /* A[njacobian] and M[nmass]. */
  int (*matrices)(LAG_REAL t, const LAG_REAL *q, const LAG_REAL *v, const LAG_REAL *z, const LAG_REAL *p,
                  const LAG_REAL *u, LAG_REAL *A, LAG_REAL *M, LAG_REAL *w);

  /* d[nq], and A^T mu as force[nq], for g[nholonomic] and the holonomic constraints alone, for positions; and for g[n] and all
   * of them, for velocities. A and M are those of the state given. */
  int (*position)(LAG_REAL t, const LAG_REAL *q, const LAG_REAL *v, const LAG_REAL *z, const LAG_REAL *p,
                  const LAG_REAL *u, const LAG_REAL *g, LAG_REAL *d, LAG_REAL *force, LAG_REAL *w);
  int (*velocity)(LAG_REAL t, const LAG_REAL *q, const LAG_REAL *v, const LAG_REAL *z, const LAG_REAL *p,
                  const LAG_REAL *u, const LAG_REAL *g, LAG_REAL *d, LAG_REAL *force, LAG_REAL *w);
} lag_constraints;

/* What is known of dQ/dt of a charge Q. */
enum {
  LAG_CONSERVED = 1,   /* it is 0 */
  LAG_BALANCED = 2,    /* it is what lag_charges.powers gives */
  LAG_BY_FORMULAS = 4, /* the latter while inputs follow the model's formulas */
  LAG_JUMPS = 8        /* it jumps where L does, or L is not invariant there; of no other kind then */
};

typedef struct lag_charge {
  const char *name, *unit; /* unit of SI; "" when none */
  unsigned flags;
} lag_charge;

/* Charges in the sense of Noether: what symmetries of L conserve, and forces, or constraints, change. The first is the energy, that of
 * translations of time, whose value lag_model.energy gives. */
typedef struct lag_charges {
  int n;
  const lag_charge *of; /* [n] */

  /* out[2 (n - 1)]: of each charge but the energy its value, and the sum of the sizes of its terms, which drifts are compared with.
   * NULL where n is 1. */
  int (*values)(LAG_REAL t, const LAG_REAL *q, const LAG_REAL *v, const LAG_REAL *z, const LAG_REAL *p,
                const LAG_REAL *u, LAG_REAL *out, LAG_REAL *w);

  /* out[n]: dQ/dt of each, 0 where it is not known. NULL: all are conserved. */
  int (*powers)(LAG_REAL t, const LAG_REAL *q, const LAG_REAL *v, const LAG_REAL *z, const LAG_REAL *p,
                const LAG_REAL *u, LAG_REAL *out, LAG_REAL *w);
} lag_charges;

/* Where a force jumps with the velocities, as dry friction does: a function whose value is 0 there. */
typedef struct lag_switch {
  const char *surface, *text; /* "x'", "sign(x')" */
  int line;                   /* of the model's text; 0: not known */
  int nonnegative;            /* 1: the function does not change its sign, as |v| */
} lag_switch;

/* A gap that stays at least 0. While it is closed it is a constraint: the model multiplies that by an input, which is 1 then and else
 * 0. The runtime closes it where impacts follow each other ever faster, or one leaves no speed, and opens it where its multiplier
 * becomes negative. */
typedef struct lag_contact {
  int input, constraint; /* places in u and in the constraints */
  int impact, release;   /* events: the gap closes, its multiplier falls below 0. act(impact) is Newton's law for this gap alone, others as u says */
} lag_contact;

/* One of the second derivatives that lag_model.second computes: of L by two of q, v, where of LAG_QQ and LAG_VV only
 * row >= col is given and the row of LAG_VQ is that of v; or of the generalised force `row` by q or v. */
enum { LAG_QQ, LAG_VQ, LAG_VV, LAG_FQ, LAG_FV };
typedef struct lag_second {
  int part, row, col;
} lag_second;

/* The Taylor coefficients of a model's motion, x^(k)(t) T^k / k!, by automatic differentiation of its program.
 *
 * Coefficient k of y_i, y = [q|v|z], is x[k*columns + i]; behind those of y stand those of the rates of v and z. first
 * makes those of order 0 for about the cost of accel, rest those of the orders 1 to n <= order from what first has left in
 * x and w[nw]. T > 0 is the unit of time; a power of 2 changes no bits. (The rates have no order n.) */
typedef struct lag_taylor {
  int order;   /* the highest */
  int columns, width, nw;
  int cost_first, cost_next, sums; /* operations of order 0 and of another order, and the sums of k - 1 products in order k */

  /* follows[nu]: 1 where the input follows its formula, 0 where it stays as u says. Returns as accel does. */
  int (*first)(LAG_REAL t, const LAG_REAL *q, const LAG_REAL *v, const LAG_REAL *z, const LAG_REAL *p,
               const LAG_REAL *u, const LAG_REAL *follows, LAG_REAL *x, LAG_REAL *w);
  void (*rest)(int n, LAG_REAL T, LAG_REAL *x, LAG_REAL *w);

  /* y[width], of which the first 2 nq + nz count, is what the orders from 1 to n add up to at t + s T; dy its derivative
   * by s. */
  void (*at)(int n, LAG_REAL s, const LAG_REAL *x, LAG_REAL *y, LAG_REAL *dy);
} lag_taylor;

typedef struct lag_model {
  int abi;           /* LAG_ABI */
  size_t real_size;  /* sizeof(LAG_REAL) */
  const char *name;
  const char *doc;
  const char *effects; /* names of the effects in this variant, separated by spaces */
  const char *digest;  /* of what the functions compute; NULL: not known. A saved state belongs to one */
  unsigned flags;
  int ops;           /* operations of one call of accel, counted */
  int nq, nz, np, nu, nev, nw;
  const lag_var *q;  /* [nq]; the velocity of q has the same name with a prime, unit per second */
  const lag_var *z;  /* [nz] */
  const lag_var *p;  /* [np] */
  const lag_var *u;  /* [nu] */
  const lag_event *ev; /* [nev] */

  /* p[np ... np + nderived - 1] from p[0 ... np - 1]: what depends on parameters alone. A scene's params calls it; who changes p
   * afterwards does. NULL where nderived is 0. */
  int nderived;
  void (*derive)(LAG_REAL *p);

  /* u[nu] at time t, where the model gives them a formula. */
  int (*inputs)(LAG_REAL t, const LAG_REAL *p, LAG_REAL *u);

  /* Accelerations a[nq] from M(q) a = f(t, q, v), and rates zd[nz]. */
  int (*accel)(LAG_REAL t, const LAG_REAL *q, const LAG_REAL *v, const LAG_REAL *z,
               const LAG_REAL *p, const LAG_REAL *u, LAG_REAL *a, LAG_REAL *zd, LAG_REAL *w);

  /* e[0] = energy p.v - L, e[1] = |p.v| + |L|, the scale against which its drift is judged. */
  int (*energy)(LAG_REAL t, const LAG_REAL *q, const LAG_REAL *v, const LAG_REAL *z,
                const LAG_REAL *p, const LAG_REAL *u, LAG_REAL *e, LAG_REAL *w);

  /* g[nev]: the event functions. */
  int (*events)(LAG_REAL t, const LAG_REAL *q, const LAG_REAL *v, const LAG_REAL *z,
                const LAG_REAL *p, const LAG_REAL *u, LAG_REAL *g, LAG_REAL *w);

  /* Applies the actions of event k: q1, v1, z1 hold the state after it (on entry: a copy of the
   * state before it). *stop is set to 1 when the event ends the run. */
  int (*act)(int k, LAG_REAL t, const LAG_REAL *q, const LAG_REAL *v, const LAG_REAL *z,
             const LAG_REAL *p, const LAG_REAL *u, LAG_REAL *q1, LAG_REAL *v1, LAG_REAL *z1,
             int *stop, LAG_REAL *w);

  int ntables;
  const lag_table *tables; /* [ntables] the inputs that have a table */

  const lag_constraints *constraints; /* NULL: none */
  int ncontacts;
  const lag_contact *contacts;        /* [ncontacts] */
  const lag_charges *charges;         /* NULL: none but the energy, of which no balance is known if it is not conserved */

  /* The rest is NULL in a program that was not emitted for a method that needs it (lagc build --method NAME). */

  /* Lq[nq] = dL/dq, the momenta Lv[nq] = dL/dv, and Q[nq], the generalised forces that are in no L. */
  int (*variation)(LAG_REAL t, const LAG_REAL *q, const LAG_REAL *v, const LAG_REAL *z,
                   const LAG_REAL *p, const LAG_REAL *u, LAG_REAL *Lq, LAG_REAL *Lv, LAG_REAL *Q, LAG_REAL *w);

  /* h[nsecond]: their derivatives, the entries that second_at lists; the others are zero. */
  int (*second)(LAG_REAL t, const LAG_REAL *q, const LAG_REAL *v, const LAG_REAL *z,
                const LAG_REAL *p, const LAG_REAL *u, LAG_REAL *h, LAG_REAL *w);
  const lag_second *second_at;
  int nsecond;

  /* NULL, too, where a value of the model is not analytic (if, abs, sign, min, max). */
  const lag_taylor *taylor;

  const lag_linear *linear;

  int nswitch;
  const lag_switch *switches; /* [nswitch] */
  /* out[nswitch]: the switching functions. */
  int (*switch_values)(LAG_REAL t, const LAG_REAL *q, const LAG_REAL *v, const LAG_REAL *z, const LAG_REAL *p,
                       const LAG_REAL *u, LAG_REAL *out, LAG_REAL *w);

  const char *math; /* whose sin and cos it calls; NULL: not known */
  const char *fixed; /* names of parameters that are numbers in this program, separated by spaces; NULL: none */
} lag_model;

/* An option of a method: step = 1e-3, quadrature = trapezoid (then text is set). */
typedef struct lag_option {
  const char *name;
  double value;
  const char *text; /* or NULL */
} lag_option;

typedef struct lag_monitor {
  const char *name;
  int output;    /* index into outputs, or -1 - k for charge k: -1 is the energy */
  double limit;  /* the run fails when the drift exceeds it */
  int absolute;  /* 1: when the value itself does, in its declared unit */
} lag_monitor;

typedef struct lag_scene {
  const char *name;
  const char *doc;
  const lag_model *model;

  /* Parameters in order of declaration, of which those with fixed[i] != 0, i < np, keep what p[i] holds; then derived ones. */
  void (*params)(LAG_REAL *p, const unsigned char *fixed);

  /* The state at the start of the span. */
  void (*start)(const LAG_REAL *p, LAG_REAL *q, LAG_REAL *v, LAG_REAL *z);

  /* Of a model with constraints: given[i] is 1 where the start sets component i of [q|v|z], 2 where i belongs to a rotation of
   * which it says nothing; the others give way first, then those of 2; NULL: it sets none. exactly: a start that the constraints contradict is refused. */
  const unsigned char *given;
  int exactly;

  double t0, t1;      /* span */
  int has_span;       /* 0: the scene gives none; t1 is then a default of 10 */
  const char *method; /* or NULL: the runtime's choice */
  int noptions;
  const lag_option *options;
  double tolerance;   /* 0: the runtime's default */

  /* What a row of output holds besides t: out[nout]. */
  int nout;
  const lag_var *outputs;
  const unsigned char *forces; /* [nout] 1: it contains multipliers or accelerations; NULL: none does */
  double every;       /* 0: the runtime's choice */
  int (*observe)(LAG_REAL t, const LAG_REAL *q, const LAG_REAL *v, const LAG_REAL *z,
                 const LAG_REAL *p, const LAG_REAL *u, LAG_REAL *out, LAG_REAL *w);
  int nmonitors;
  const lag_monitor *monitors;

  /* Closed forms to compare with: out[nexact] at time t of a motion that began with q0, v0, z0. Of observe alone, u has
   * nu + nexact elements: the closed forms stand behind the inputs. */
  int nexact;
  const int *exact_of; /* [nexact] which component of [q|v|z] it is */
  int (*exact)(LAG_REAL t, const LAG_REAL *q0, const LAG_REAL *v0, const LAG_REAL *z0, const LAG_REAL *p,
               const LAG_REAL *u, LAG_REAL *out);
} lag_scene;

/* A compiled .lag file: all of its scenes. Several scenes may share one model. */
typedef struct lag_program {
  const char *name;
  const char *doc;
  const char *source;  /* the .lag file's path as given to lagc */
  const char *effects; /* names of all effects that the file declares, separated by spaces */
  int nscenes;
  const lag_scene *const *scenes;
  const char *build;   /* compiler and flags that it was compiled with; NULL: not known */
} lag_program;

#ifdef __cplusplus
}
#endif

#endif
