/* lag_model.h: the interface between emitted C and the runtime. Includes only <stddef.h>.
 *
 * A model is a const struct of names, sizes and functions, emitted by lagc. Its state is q[nq] (generalised
 * coordinates), v[nq] (their time derivatives) and z[nz] (other states); p[np + nderived] are its parameters, of
 * which derive computes the last nderived from the others; u[nu] its inputs, and modes of switches behind them;
 * w[nw] work space for its functions. All values are in SI units. No function allocates, keeps state, or writes past
 * the sizes here. Arrays passed to one call do not overlap. Every function's first argument, self, is the structure
 * that holds it, or a copy: emitted C ignores it, and a model that liblag evaluates finds its programs there.
 *
 * A function returns 0 when all went well, > 0 when a smaller step may help (the value left the model's domain), < 0
 * for a failure that no step size cures. */
#ifndef LAG_MODEL_H
#define LAG_MODEL_H

#if defined(__FAST_MATH__) || defined(__ASSOCIATIVE_MATH__) || \
    (defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__) || defined(_M_FP_FAST)
#error "models need NaN and exact sums: compile them without -ffast-math, -Ofast and /fp:fast"
#endif

#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

#define LAG_ABI 23

/* The scalar of a model: double, float, long double or __float128; or, where LAG_LANES is 4 or 8, vectors of so many
 * doubles, one state or one set of parameters a lane. The status < 0 of such a call has bit k of its negative set
 * where lane k is singular; the other lanes are right. */
#ifndef LAG_REAL
#ifdef LAG_LANES
typedef double lag_lanes __attribute__((vector_size(8 * LAG_LANES)));
#define LAG_REAL lag_lanes
#else
#define LAG_REAL double
#define LAG_REAL_IS_DOUBLE 1
#endif
#endif

/* The scalar of one lane. */
#ifndef LAG_LANE
#ifdef LAG_LANES
#define LAG_LANE double
#else
#define LAG_LANE LAG_REAL
#endif
#endif

/* The highest order of Taylor series for which a program has room. */
#ifndef LAG_TAYLOR_ORDER
#define LAG_TAYLOR_ORDER 40
#endif

/* The first arguments of functions of a state. */
#define LAG_STATE \
  const void *self, LAG_REAL t, const LAG_REAL *q, const LAG_REAL *v, const LAG_REAL *z, const LAG_REAL *p, \
    const LAG_REAL *u

enum {
  LAG_OK = 0,
  LAG_ERETRY = 1,     /* outside the domain here: a smaller step may help */
  /* the mass matrix is singular at this state, or not positive definite as elsewhere; with LAG_FIRST_ORDER, the
   * two-form */
  LAG_ESINGULAR = -1
};

/* Facts that the compiler has proved of a model with its own formulas and tables of inputs. */
enum {
  LAG_CONSERVES_ENERGY = 1, /* dE/dt = 0 along all motions, for any inputs */
  LAG_CONSTANT_MASS = 2,    /* d2L/dq'2 depends on no coordinate, velocity or time */
  LAG_AUTONOMOUS = 4,       /* the right-hand side does not contain t */
  LAG_SMOOTH = 8,           /* no if, abs, sign, min, max, atan2 with a cut, and no table */
  /* constant mass matrix, accelerations that do not depend on velocities, no states; with LAG_FIRST_ORDER a
   * Hamiltonian T(p) + V(q, t): nz is even, z = [q|p], the rates of q are functions of p alone and those of p of q
   * and t */
  LAG_SEPARABLE = 16,
  LAG_TIMELESS = 32,        /* t enters only by the formulas and tables of inputs, if at all */
  LAG_LOSES_ENERGY = 64,    /* not proved to be conserved; with constant inputs, the energy less the work of forces that
                             * are constant, do no work or have a potential never grows: the dissipation is quadratic in
                             * q' and nowhere negative, for the signs declared */
  /* L = theta(q, t) v - H is linear in all velocities: coordinates are among z, nq is 0, and their rates solve omega
   * zd = dH/dq + ... with the two-form omega = dtheta in place of a mass matrix */
  LAG_FIRST_ORDER = 128,
  /* the same, and omega depends on no coordinate, state or time, and no force on velocities */
  LAG_CONSTANT_FORM = 256,
  LAG_MASSLESS = 512,       /* the mass matrix is singular; constraints determine the coordinates without inertia */
  /* the Hamiltonian is T(p) + V(q, t), z = [q|p]; LAG_SEPARABLE, too, if forces depend on q and t alone */
  LAG_SUM_HAMILTONIAN = 1024
};

/* A named quantity. unit is as declared ("deg"), or as inferred from the equations, "" when none; x units are
 * x*factor + offset in SI. */
typedef struct lag_var {
  const char *name, *unit;
  double factor;
  int periodic; /* 1: an angle, of period 2 pi */
  int sign;     /* of a parameter: 1 "> 0", 2 ">= 0", -1 "< 0", -2 "<= 0", 0 any */
  double offset; /* 273.15 of degC; otherwise 0 */
} lag_var;

/* Direction of an event that happens at the times t0 + k T, k = 1, 2, ...: its function is the period T [s], of
 * parameters alone. */
#define LAG_KICK 2
typedef struct lag_event {
  const char *name;
  int direction; /* 1 rising, -1 falling, 0 both, LAG_KICK */
} lag_event;

/* The table of an input: n rows with increasing times, joined by splines. Used by emitted code; the runtime only
 * ends steps at the rows. */
typedef struct lag_table {
  int input; /* index of the input */
  int n, width;
  const LAG_LANE *row; /* [n * width] time, value, second derivative; or time, value, first and second derivative */
} lag_table;

/* Row and column of an entry of a sparse matrix. */
typedef struct lag_entry {
  int row, col;
} lag_entry;

/* A derivative of event `event`: of its function (row < 0), or of the value that its actions set for component `row`
 * of (q, v, z); by component `col`, or by time where col is 2 nq + nz. */
typedef struct lag_jump {
  int event, row, col;
} lag_jump;

/* Derivatives d[n] of the residuals of lag_linear by parameters, or by inputs (col), at accelerations a[nq]; others are
 * zero. */
typedef struct lag_partials {
  int n;
  const lag_entry *at; /* [n] */
  int (*eval)(LAG_STATE, const LAG_REAL *a, LAG_REAL *d, LAG_REAL *M, LAG_REAL *w);
} lag_partials;

/* Reverse mode: for weights g[nq + nz] of the accelerations and of the rates of states, and accelerations a[nq], the
 * sums of g_i times their derivatives: by_y[2 nq + nz], by_up[nu + np] by inputs and parameters, each as if it were
 * free; and the derivatives d[n] of the inputs' formulas (row) by parameters (col). About three calls of accel. With
 * constraints the multipliers follow the weights in g. */
typedef struct lag_adjoint {
  int n;
  const lag_entry *at; /* [n] */
  int (*eval)(LAG_STATE, const LAG_REAL *a, const LAG_REAL *g, LAG_REAL *by_y, LAG_REAL *by_up, LAG_REAL *d,
              LAG_REAL *w);

  /* With constraints only. rates: as accel, and the multipliers l. project: the transpose of the projection of small
   * changes onto the constraints, in the metric M: by_y[2 nq + nz] for x[2 nq + nz], by_up and d as above. */
  int (*rates)(LAG_STATE, LAG_REAL *a, LAG_REAL *zd, LAG_REAL *l, LAG_REAL *w);
  int (*project)(LAG_STATE, const LAG_REAL *x, LAG_REAL *by_y, LAG_REAL *by_up, LAG_REAL *d, LAG_REAL *w);
} lag_adjoint;

/* The exact linearisation of a model, emitted where a method or command needs it (lagc --with linear).
 *
 * The residuals r[nq + nz] vanish along a motion: r_i = f_i - sum_j M_ij a_j for coordinates i, r_(nq + k) = flow_k
 * - z_k' for states. From their derivatives by y = (q, v, z), at fixed a and z', follow the accelerations' changes,
 * da = M^-1 (dr/dy) dy, and the rates', their rows of dr/dy. At an equilibrium a is 0, and -dr/dq, -dr/dv are the
 * stiffness matrix and the matrix of damping and gyroscopic forces. See lag_jacobian() in lag.h. */
typedef struct lag_linear {
  int ndr;
  const lag_entry *dr;   /* [ndr] row < nq + nz, col < 2 nq + nz; row by row, columns ascending; others are zero */
  int nmass;
  const lag_entry *mass; /* [nmass] entries of M's lower triangle, col <= row; M is symmetric */
  int ops;               /* operations of one call */

  /* dr[ndr] and M[nmass] at a state, for the accelerations a[nq] there (or for others: a = 0 gives df/dy). */
  int (*eval)(LAG_STATE, const LAG_REAL *a, LAG_REAL *dr, LAG_REAL *M, LAG_REAL *w);

  /* Derivatives for the saltation matrices of events: d[njump], as listed in jump. Derivatives of g that are not
   * listed are zero, and so are those of a value that is set; each value that is set has the entry of its own
   * component. Events that depend on inputs are not listed. */
  int njump;
  const lag_jump *jump;
  int (*jumps)(LAG_STATE, LAG_REAL *d, LAG_REAL *w);

  /* For sensitivities; NULL: not emitted (lagc --with sensitivities), or there are none. */
  const lag_partials *by_params, *by_inputs;
  const lag_adjoint *adjoint; /* NULL: not emitted (lagc --with derivatives) */
} lag_linear;

/* One scalar constraint. */
typedef struct lag_constraint {
  const char *name; /* "rod", "rod[2]", "grip.x" */
  int holonomic;    /* 1: stated as c(q, t) = 0; 0: as r(q, v, t) = 0, linear in v */
  const char *unit; /* unit of c, or of r; "" when none */
  int line;         /* line of the model's text; 0: not known, as in C that `lagc emit` writes */
} lag_constraint;

/* The constraints of a model, n in all. The first nholonomic are on positions: c(q, t) = 0; or, where the model
 * states r = 0 and r is the rate of c(q, t), that c keeps its value at the start. On velocities all are r = A(q, t)
 * v + b(q, t) = 0, with r = dc/dt of the first nholonomic. accel obeys them: its accelerations satisfy M a = f + A^T
 * lambda, dr/dt = 0. They do not correct an error in c and r; the functions below do, after a step.
 *
 * A change d[nq] of the state with A d = g and least d^T M d satisfies M d = A^T mu. Constraints may be redundant,
 * if g is consistent with them; M may be singular along directions that A fixes. */
typedef struct lag_constraints {
  int n, nholonomic;
  const lag_constraint *of; /* [n] */
  int njacobian;
  /* [njacobian] entries of A, row < n, col < nq; row by row, columns ascending; others are zero */
  const lag_entry *jacobian;
  int nmass;
  const lag_entry *mass;     /* [nmass] entries of M's lower triangle, col <= row */

  /* c[nholonomic] and r[n]. */
  int (*residuals)(LAG_STATE, LAG_REAL *c, LAG_REAL *r, LAG_REAL *w);

  /* A[njacobian] and M[nmass]. */
  int (*matrices)(LAG_STATE, LAG_REAL *A, LAG_REAL *M, LAG_REAL *w);

  /* d[nq] and force[nq] = A^T mu. position: for g[nholonomic] and the holonomic constraints alone; velocity: for
   * g[n] and all constraints. A and M are taken at the state given. */
  int (*position)(LAG_STATE, const LAG_REAL *g, LAG_REAL *d, LAG_REAL *force, LAG_REAL *w);
  int (*velocity)(LAG_STATE, const LAG_REAL *g, LAG_REAL *d, LAG_REAL *force, LAG_REAL *w);

  const lag_adjoint *adjoint; /* NULL: not emitted, as in lag_linear, which models with constraints do not have */
} lag_constraints;

/* Knowledge of the rate dQ/dt of a charge Q. */
enum {
  LAG_CONSERVED = 1,   /* dQ/dt = 0 */
  LAG_BALANCED = 2,    /* dQ/dt is what lag_charges.powers gives */
  LAG_BY_FORMULAS = 4, /* LAG_BALANCED, while inputs follow the model's formulas */
  LAG_JUMPS = 8        /* Q jumps where L does, or L is not invariant there; then no other flag is set */
};

typedef struct lag_charge {
  const char *name, *unit; /* unit of SI; "" when none */
  unsigned flags;
} lag_charge;

/* Noether charges: conserved by a symmetry of L, changed by forces or constraints. The first is the energy, the
 * charge of translations in time; lag_model.energy gives its value. */
typedef struct lag_charges {
  int n;
  const lag_charge *of; /* [n] */

  /* out[2 (n - 1)]: for each charge but the energy, its value and the sum of its |terms|, the scale of its drift.
   * NULL where n is 1. */
  int (*values)(LAG_STATE, LAG_REAL *out, LAG_REAL *w);

  /* out[n]: dQ/dt of each charge, 0 where it is not known; with dry_friction out[n + 1], the last the power of dry
   * friction. NULL: all are conserved. */
  int (*powers)(LAG_STATE, LAG_REAL *out, LAG_REAL *w);
  int dry_friction;
} lag_charges;

/* A switching function g: where it is 0 the equations jump, or have a corner, as sign(g), abs(g) and if(g > 0, a, b)
 * do.
 *
 * The first nmodes switches of a model have a mode, in u behind the inputs: u[nu + k] is 1 for the branch of g > 0,
 * -1 for that of g < 0, at any state; between, where the motion slides on g = 0, the value of sign(g) that keeps it
 * there; with is_floor the value of floor(g). LAG_FREE: the state decides. So u has nu + nmodes elements. The other
 * switches are watched only. */
#define LAG_FREE 1e30
typedef struct lag_switch {
  const char *surface, *text; /* "x'", "sign(x')" */
  int line;                   /* line of the model's text; 0: not known */
  int jumps;                  /* 1: a force jumps there with the velocities or states, and a motion may slide */
  int is_floor;
  int is_timed;               /* 1: the function contains t, and may change fast in long steps of a slow motion */
  int nonnegative;            /* 1: the function is nowhere negative, as |v| */
} lag_switch;

/* A unilateral contact: a gap that stays at least 0. While it is closed the gap is a constraint; the model
 * multiplies that constraint by an input, 1 when closed and 0 when open. The runtime closes a contact if impacts
 * accumulate or an impact leaves no relative speed; it opens the contact when its multiplier becomes negative. A
 * constraint that holds while a condition is true has the same form: it closes and opens where the condition, whose
 * function the two events contain, changes. */
typedef struct lag_contact {
  int input, constraint; /* index in u, index in the constraints */
  /* events: the gap closes; its multiplier falls below 0. act(impact) is Newton's impact law for this gap alone,
   * with the other contacts as u says */
  int impact, release;
  /* A contact with friction is followed by its tangent. Its constraint is on the velocity of slipping, and is on
   * while the contact sticks; input `force` is the force along that velocity while it slips. impact: the function is
   * the velocity of slipping; release: the largest force of friction minus the size of the multiplier. */
  int is_tangent, force;
  int conditional;       /* 1: a constraint with a condition; act(impact) does nothing */
  /* of a tangent: the coefficient of restitution is Stronge's (0), Poisson's (1) or Newton's (2) */
  int law;
} lag_contact;

/* A read of a family's text: by row and turn, an index among coordinates or parameters. */
typedef struct lag_read {
  int first, by_row, by_turn;
} lag_read;

/* Contacts with one text for all members, rows 0 .. rows - 1 and, of each, turns skew*row .. skew*row + turns +
 * more*row - 1; indices: 1 or 2, i = i0 + row, j = j0 + turn.
 * values: out = gap, its rate, restitution, friction, tangential restitution, static friction; slips; derivatives of
 * the rate, then of the slips, by the member's velocities. Its q, v are those at `coords`, its z parameters at
 * `params`. reach: the distance beyond which no gap is closed, and sides of the box (0: open), of parameters alone;
 * NULL: all members are looked at. place: coordinates of the member of a turn; that of a row is turn i0 + row - j0. */
enum { LAG_FAMILY_VALUES = 6 }; /* before the slips */
typedef struct lag_contact_family {
  const char *name;
  int indices, i0, j0, rows, skew, turns, more;
  int ncoords, nparams;
  const lag_read *coords, *params; /* [ncoords], [nparams] */
  int tangents;
  int (*values)(LAG_STATE, LAG_REAL *out, LAG_REAL *w);
  int (*reach)(LAG_STATE, LAG_REAL *out, LAG_REAL *w);
  int nplaces;
  lag_read place[3];
  const void *programs; /* of an evaluated model; else NULL */
} lag_contact_family;

/* The families of a model, which moreau follows; inertia: M[nmass] at the entries `mass` of its lower triangle. */
typedef struct lag_contact_families {
  int n;
  const lag_contact_family *of; /* [n] */
  int nmass;
  const lag_entry *mass;        /* [nmass] */
  int (*inertia)(LAG_STATE, LAG_REAL *M, LAG_REAL *w);
} lag_contact_families;

/* A guide: its tangent, with friction by the force of constraints that always hold. */
typedef struct lag_guide {
  int tangent, parts; /* index in the contacts; components of its force */
  int turn;           /* event: the force of one component changes its side; -1: there are more */
} lag_guide;

/* An entry of lag_model.second: the second derivative of L by two of q, v, where of LAG_QQ and LAG_VV only row >=
 * col is given and the row of LAG_VQ belongs to v; or the derivative of generalised force `row` by q or v. */
enum { LAG_QQ, LAG_VQ, LAG_VV, LAG_FQ, LAG_FV };
typedef struct lag_second {
  int part, row, col;
} lag_second;

/* Taylor coefficients of a motion, x^(k)(t) T^k / k!, by automatic differentiation of the model's program.
 *
 * Coefficient k of y_i, y = [q|v|z], is x[k*columns + i]; behind those of y stand those of the rates of v and z.
 * `first` computes order 0 for about the cost of accel; `rest` orders 1 to n <= order from the x and w[nw] that
 * `first` has left. T > 0 is the unit of time; a power of 2 changes no bits. (The rates have no order n.) */
typedef struct lag_taylor {
  int order;   /* the highest order */
  int lanes;   /* 1: compiled for lanes, or with the sums that lanes have */
  int columns, width, nw;
  /* operations of order 0, operations of each other order, and sums of k - 1 products in order k */
  int cost_first, cost_next, sums;

  /* follows[nu]: 1 where the input follows its formula, 0 where it is constant, as in u. Returns as accel does. */
  int (*first)(LAG_STATE, const LAG_REAL *follows, LAG_REAL *x, LAG_REAL *w);
  void (*rest)(const void *self, int n, LAG_REAL T, LAG_REAL *x, LAG_REAL *w);

  /* y[width] := the sum of orders 1 to n at t + s T, of which only the first 2 nq + nz elements are meant; dy := its
   * derivative by s. */
  void (*at)(const void *self, int n, LAG_REAL s, const LAG_REAL *x, LAG_REAL *y, LAG_REAL *dy);

  /* The rates, orders 1 to n - 1, along a curve of states: x holds order 0 as of `first`, then coefficients of y that
   * need not be those of a motion, and 0 elsewhere. Row n of x is overwritten. NULL: compiled for lanes. */
  void (*along)(const void *self, int n, LAG_REAL *x, LAG_REAL *w);
} lag_taylor;

/* A size: at least 0, more than 0 where open, at most 1 where it is a part. */
typedef struct lag_size {
  const char *what, *text; /* "this friction has a size", "mu*m*g" */
  int open, part;
} lag_size;

/* Bodies in Cartesian coordinates with terms -k/r of the potential, between pairs or, with `fixed`, from the origin.
 * values: out[2 n] = mass of each body; then of each the sum of k_ij s_j over the other bodies j, with s_j in the place
 * of the first coordinate of body j, and with `fixed` k of the body. */
typedef struct lag_kepler {
  int n, dim, fixed; /* bodies; dimensions, 2 or 3 */
  const int *at;     /* [n * dim] coordinates, body by body */
  int (*values)(LAG_STATE, LAG_REAL *out, LAG_REAL *w);
} lag_kepler;

typedef struct lag_model {
  int abi;           /* LAG_ABI */
  size_t real_size;  /* sizeof(LAG_REAL) */
  const char *name;
  const char *doc;
  const char *effects; /* names of the effects in this variant, separated by spaces */
  const char *digest;  /* digest of the equations; NULL: not known. A saved state belongs to one digest */
  unsigned flags;
  int ops;           /* operations of one call of accel */
  int nq, nz, np, nu, nev, nw;
  const lag_var *q;  /* [nq]; the velocity of q has the same name with a prime, unit per second */
  const lag_var *z;  /* [nz] */
  const lag_var *p;  /* [np] */
  const lag_var *u;  /* [nu]; the rate of an input, where the motion depends on it, stands behind it with a prime */
  const lag_event *ev; /* [nev] */

  /* Derived parameters: p[np ... np + nderived - 1] from p[0 ... np - 1]. A scene's params calls derive; so must
   * code that changes p afterwards. NULL where nderived is 0. */
  int nderived;
  void (*derive)(const void *self, LAG_REAL *p);

  /* u[nu] at time t, of the inputs to which the model gives a formula. */
  int (*inputs)(const void *self, LAG_REAL t, const LAG_REAL *p, LAG_REAL *u);

  /* Accelerations a[nq] from M(q) a = f(t, q, v), and rates zd[nz]. */
  int (*accel)(LAG_STATE, LAG_REAL *a, LAG_REAL *zd, LAG_REAL *w);

  /* e[0] = energy p.v - L, e[1] = |p.v| + |L|, the scale against which its drift is judged. */
  int (*energy)(LAG_STATE, LAG_REAL *e, LAG_REAL *w);

  /* g[nev]: the event functions. */
  int (*events)(LAG_STATE, LAG_REAL *g, LAG_REAL *w);

  /* Applies the actions of event k: q1, v1, z1 hold the state after it (on entry: a copy of the
   * state before it). *stop is set to 1 when the event ends the run. */
  int (*act)(const void *self, int k, LAG_REAL t, const LAG_REAL *q, const LAG_REAL *v, const LAG_REAL *z,
             const LAG_REAL *p, const LAG_REAL *u, LAG_REAL *q1, LAG_REAL *v1, LAG_REAL *z1, int *stop, LAG_REAL *w);

  /* out[nsizes]: the sizes, of parameters alone, that a run checks when it begins. NULL where nsizes is 0. */
  int nsizes;
  const lag_size *sizes; /* [nsizes + nmoving] */
  int (*size_values)(LAG_STATE, LAG_REAL *out, LAG_REAL *w);
  /* out[nmoving]: the sizes of states, inputs and time, that a run checks at each step. NULL where nmoving is 0. */
  int nmoving;
  int (*moving_sizes)(LAG_STATE, LAG_REAL *out, LAG_REAL *w);

  int ntables;
  const lag_table *tables; /* [ntables] */

  const lag_constraints *constraints; /* NULL: none */
  int ncontacts;
  const lag_contact *contacts;        /* [ncontacts] */
  const lag_contact_families *families; /* NULL: none */
  const lag_charges *charges;         /* NULL: only the energy, without a known balance if it is not conserved */
  const lag_kepler *kepler;           /* NULL: L has no Kepler part */

  /* The members below are NULL in a program that was not emitted for a method that needs them (lagc build --method
   * NAME). */

  /* Lq[nq] = dL/dq, the momenta Lv[nq] = dL/dv, and Q[nq], the generalised forces outside L. */
  int (*variation)(LAG_STATE, LAG_REAL *Lq, LAG_REAL *Lv, LAG_REAL *Q, LAG_REAL *w);

  /* h[nsecond]: second derivatives of L and derivatives of Q, the entries listed in second_at; the others are zero. */
  int (*second)(LAG_STATE, LAG_REAL *h, LAG_REAL *w);
  const lag_second *second_at;
  int nsecond;

  /* Inverse dynamics: the generalised forces out[nq] = M a - f that the accelerations a[nq] need besides those of the
   * model; multipliers count as 0. NULL: not emitted (lagc build --with derivatives). */
  int (*inverse)(LAG_STATE, const LAG_REAL *a, LAG_REAL *out, LAG_REAL *w);

  const lag_taylor *taylor; /* NULL also where a value of the model is not analytic (if, abs, sign, min, max) */
  const lag_linear *linear;

  int nswitch;
  const lag_switch *switches; /* [nswitch] */
  /* out[nswitch]: the switching functions. */
  int (*switch_values)(LAG_STATE, LAG_REAL *out, LAG_REAL *w);
  int nmodes;
  /* out[nmodes]: rates dg/dt of the first nmodes, along the motion. NULL where nmodes is 0. */
  int (*switch_rates)(LAG_STATE, LAG_REAL *out, LAG_REAL *w);
  /* out[nmodes]: the largest mode of a sliding motion, for static friction above that of motion; less than 1 counts
   * as 1. NULL: 1. */
  int (*switch_grips)(LAG_STATE, LAG_REAL *out, LAG_REAL *w);

  /* out[3 ncontacts]: of a tangent its coefficient of friction and its tangential restitution, of a contact with
   * friction that of static friction and 0, of others 0; and the multiplier of its constraint. NULL: no contact has
   * friction. */
  int (*contact_laws)(LAG_STATE, LAG_REAL *out, LAG_REAL *w);

  int nguides;
  const lag_guide *guides; /* [nguides]; behind out[3 ncontacts] of contact_laws, for each, its static friction and 3
                            * components of its force, linear in the multipliers */
  /* As constraints->velocity; load[3 nguides]: components of the forces of guides by force = A^T mu. NULL: no contact
   * stands beside guides. */
  int (*guide_loads)(LAG_STATE, const LAG_REAL *g, LAG_REAL *d, LAG_REAL *force, LAG_REAL *load, LAG_REAL *w);

  const char *math; /* library of sin and cos that the program calls; NULL: not known */
  const char *fixed; /* names of parameters that are numbers in this program, separated by spaces; NULL: none */
  const void *programs; /* of a model that liblag evaluates */
} lag_model;

#ifndef LAG_LANES
/* The action variable of a coordinate, J = 1/(2 pi) closed integral of p dq along H(q, p) = constant, all else held.
 * q, p: components of [q|v|z], the momentum in the place of its velocity where the model gives L. curve: out[4] = H,
 * dH/dp, d2H/dp2, dH/dq at such a state; momenta: out[nq]; NULL: momenta are states. */
typedef struct lag_action_curve {
  int nq, nz, q, p, periodic;
  int (*curve)(LAG_STATE, LAG_REAL *out, LAG_REAL *w);
  int (*momenta)(LAG_STATE, LAG_REAL *out, LAG_REAL *w);
} lag_action_curve;

/* J of the curve through a state; NaN: it has none there. y[2 nq + nz] is work space. Of liblag; emitted `observe`
 * calls it. */
LAG_REAL lag_action(const lag_action_curve *c, LAG_REAL t, const LAG_REAL *q, const LAG_REAL *v, const LAG_REAL *z,
                    const LAG_REAL *p, const LAG_REAL *u, LAG_REAL *y, LAG_REAL *w);
#endif

/* An option of a method: step = 1e-3; or quadrature = trapezoid, with text set. */
typedef struct lag_option {
  const char *name;
  double value;
  const char *text; /* or NULL */
} lag_option;

typedef struct lag_monitor {
  const char *name;
  int output;    /* index into outputs, or -1 - k for charge k: -1 is the energy */
  double limit;  /* the run fails when the drift exceeds it */
  int absolute;  /* 1: the limit is on the value itself, in its declared unit */
} lag_monitor;

/* A number that one keeps of a run: compiled words in the notation of runtime/analysis/measure.h. */
typedef struct lag_measure {
  const char *name, *text;
} lag_measure;

/* A shape of a drawing. Numbers are indices of the scene's outputs, in SI, -1: not given. a, b: places, x y z, or x y
 * of a picture in a plane; size: width or radius, or the sides of a box; turn: an angle, or the rotation w x y z.
 *
 * kind    a, b                       size              count
 * rod     ends                       width
 * spring  ends (no a: held at the left, no b: at the right)
 *                                    radius            coils
 * damper  ends                       radius
 * disc    centre                     radius            spokes
 * box     centre                     sides, 2 or 3
 * body    centre (none: the origin)  3 sides, or none
 * ball    centre                     radius
 * wall    ends
 * ground  a place on it; turn: its slope
 * curve   a point                                      points from here on, each a shape, of one curve
 * path    the place whose path is drawn
 * arrow   its foot; b: its vector                      1: b is no length, and scaled to the picture
 * text    its place */
typedef struct lag_shape {
  const char *kind;
  const char *role; /* its colour: body, link, spring, support, force, velocity, path, text, second, star, ghost */
  const char *text; /* the text; the place as the model writes it; or NULL */
  int a[3], b[3], size[3], turn[4], count;
} lag_shape;

typedef struct lag_scene {
  const char *name;
  const char *doc;
  const lag_model *model;

  /* Sets parameters in order of declaration, then derived ones; p[i] with fixed[i] != 0, i < np, keeps its value. */
  void (*params)(const void *self, LAG_REAL *p, const unsigned char *fixed);

  /* The state at the start of the span. */
  void (*start)(const void *self, const LAG_REAL *p, LAG_REAL *q, LAG_REAL *v, LAG_REAL *z);

  /* For a model with constraints: given[i] is 1 where the start sets component i of [q|v|z], 2 where i belongs to a
   * rotation that the start does not set, else 0. Components with 0 give way to the constraints first, then those
   * with 2; NULL: none is set. exactly: a start that contradicts the constraints is refused. */
  const unsigned char *given;
  int exactly;

  double t0, t1;      /* span */
  int has_span;       /* 0: the scene gives no span; t1 is then a default of 10 */
  const char *method; /* or NULL: the runtime's choice */
  int noptions;
  const lag_option *options;
  double tolerance;   /* 0: the runtime's default */

  /* Columns of a row of output besides t: out[nout]. */
  int nout;
  const lag_var *outputs;
  const unsigned char *forces; /* [nout] 1: the output contains multipliers or accelerations; NULL: none does */
  double every;       /* 0: the runtime's choice */
  int (*observe)(LAG_STATE, LAG_REAL *out, LAG_REAL *w);
  int nmonitors;
  const lag_monitor *monitors;

  /* Closed forms to compare with: out[nexact] at time t of a motion that began at q0, v0, z0. For observe alone, u
   * has nexact elements more: closed forms stand behind the inputs and modes. */
  int nexact;
  const int *exact_of; /* [nexact] the component of [q|v|z] that each closed form describes */
  int (*exact)(const void *self, LAG_REAL t, const LAG_REAL *q0, const LAG_REAL *v0, const LAG_REAL *z0,
               const LAG_REAL *p, const LAG_REAL *u, LAG_REAL *out);

  int nmeasures;
  const lag_measure *measures; /* [nmeasures] */
  const void *programs;        /* of a scene that liblag evaluates */

  /* The drawing, in programs for `lagc animate` and `lagc page`; the last ndrawn outputs belong to it alone. */
  int ndrawn, nshapes;
  const lag_shape *shapes; /* [nshapes] */
} lag_scene;

/* A compiled .lag file: all of its scenes. Several scenes may share one model. */
typedef struct lag_program {
  const char *name;
  const char *doc;
  const char *source;  /* the .lag file's path as given to lagc */
  const char *effects; /* names of all effects that the file declares, separated by spaces */
  int nscenes;
  const lag_scene *const *scenes;
  const char *build;   /* compiler and flags of this program; NULL: not known */
  /* [nscenes] the scenes with their models compiled for vectors of 4 and 8 doubles (LAG_LANES); or NULL */
  const lag_scene *const *lanes_4, *const *lanes_8;
} lag_program;

#ifdef __cplusplus
}
#endif

#endif
