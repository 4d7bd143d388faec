/* lag_method.h: methods of integration; part of lag.h, whose conventions hold. A method is a const lag_method; what it
 * integrates is a lag_problem. */
#ifndef LAG_METHOD_H
#define LAG_METHOD_H

#include "lag_model.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A function of the caller for an input: its value in SI at time t. */
typedef double lag_input_fn(void *context, double t);

typedef struct lag_signal {
  lag_input_fn *fn; /* NULL: the model's formula, table, or a constant */
  void *context;
} lag_signal;

/* Contacts of a run by a method with LAG_METHOD_IMPULSES. */
typedef struct lag_contact_stats {
  double steps;    /* steps in which contacts acted */
  double touching; /* the most that took part in one step */
  double impacts;  /* gaps that closed faster than forces alone make them close in a step */
  double sweeps;   /* iterations over all contacts that take part, in all steps */
  double depth;    /* the deepest gap, >= 0 [SI] */
  /* energy that contacts brought in, where they do work at all, step by step; rounding apart it is 0 [J] */
  double gained;
  /* Of the last step: work along gaps and of friction; whether charges do not contain it yet, time from which on
   * dense output does; length. */
  double work, rubbed, due, from, length;
} lag_contact_stats;

/* Adds `factor` times derivative `from` of lag_linear.by_params to element `to` of a Jacobian with columns by
 * parameters. */
typedef struct lag_parameter_term {
  int from, to;
  double factor;
} lag_parameter_term;

/* Columns of a tangent by parameters: n of them, each with its column of Y; how derivatives of residuals by all
 * parameters add to those by these; steps h[n], and parameters at k h from their values, k = -3 ... 3,
 * shifted[n][7][np + nderived]. */
typedef struct lag_parameter_columns {
  int n, nterms;
  const int *column;
  const lag_parameter_term *term; /* [nterms] */
  const double *h, *shifted;
} lag_parameter_columns;

/* The problem that a method integrates: the model as y' = f(t, y), and the method's counts. */
typedef struct lag_problem {
  const lag_model *model;
  int n, nq, nz;       /* n = 2 nq + nz */
  const double *p;     /* [np + nderived] parameters */
  double *u;           /* [nu + nmodes] inputs and modes of switches, filled by lag_rhs */
  /* [nu + nmodes] constants that replace inputs, NaN where an input is not replaced; modes, 0 where the motion
   * slides, which methods with LAG_METHOD_IMPULSES set where forces jump */
  double *hold;
  const lag_signal *signal; /* [nu] functions that replace inputs */
  double *work;        /* [nw] */
  double *held;        /* [lag_constraint_scratch_size] scratch of the constraint functions below */
  double *ranks;       /* [lag_rank_scratch_size] scratch of the functions that judge ranks of constraints */
  const double *begin; /* [n] start of the run, the scale of quantities that are 0 now; NULL: not known */
  const double *kept;  /* [nholonomic] value at which c is held, NaN: free so far; NULL: all at 0 */
  int nslide;          /* switches on whose surface the motion slides, */
  int *sliding;        /* [nmodes] and their numbers; their modes are found at each state */
  double *slide;       /* scratch of lag_sliding_values */
  double *rub;         /* scratch of friction of contacts */
  int redundant;       /* 1: constraints are redundant; f is evaluated on the constraints only, see lag_rhs */
  const double *opt;   /* values of the method's options, [method->noptions] */
  const void *variant; /* method->variant */
  double tol;          /* tolerance, absolute and relative */
  double dir;          /* 1 or -1: the direction of time */
  double longest;      /* largest step of embedded methods and radau [s]; 0: no limit */
  double span;         /* length of the scene's span, 0 when it has none; not the end of this run */
  double rhs_calls;    /* counted by lag_rhs */
  double rejected;     /* counted by the method */
  double systems;      /* nonlinear systems solved, */
  double iterations;   /* and Newton corrections made: counted by the method */
  double bad_t;        /* set before a failure: time, */
  int bad_index;       /* component of y' (-1: unknown), */
  const char *detail;  /* explanation or NULL; a string that lives as long as this object, */
  char words[320];     /* for example composed here */
  double kick;         /* time of the next kick, at which a step ends if it would reach it; HUGE_VAL: none */
  /* contacts met by impulses; NULL: the method is another, or there are none. In the next three, too */
  lag_contact_stats *contacts;
  double *contact_impulse;     /* [ncontacts] impulse of each in the last step, */
  double *contact_change;      /* [nq] and the change of velocities by all of them */
  double *guide_load;          /* [3 nguides] forces of guides by impulses of contacts in the last step */
  double *contact_key;         /* [lag_family_rows_of] of families of contacts: whose impulses these are, ascending */
  double *contact_room;        /* scratch */
  struct lag_family_rows *family; /* in it: families of contacts (methods/moreau_families.c); NULL: not laid out */
  /* [n + 2] size of each component in this run, and last of the time: powers of 1024; tolerances are parts of it */
  double *size;
  const lag_parameter_columns *by; /* of the run's tangent; NULL: none */
} lag_problem;

/* The model's facts (LAG_AUTONOMOUS, ...) less those that an input function of the caller takes away. */
unsigned lag_facts(const lag_problem *pb);

/* pb->u := the inputs at t: the model's formulas, constants of pb->hold or functions of pb->signal. Returns the
 * model's status. */
int lag_inputs(lag_problem *pb, double t);
/* The same, and modes of switches on whose surface the motion slides and friction of contacts that slip, at the
 * state y[n]. */
int lag_inputs_at(lag_problem *pb, double t, const double *y);

/* dy[n] = f(t, y[n]). Returns the model's status; does not look for NaN. Where constraints are redundant, f is
 * evaluated at the projection of y (lag_project): stages of a step lie off the constraints; there redundant rows
 * become independent, and their accelerations would be rounding divided by rounding. On the constraints this f is
 * the same, and near them as smooth. */
int lag_rhs(lag_problem *pb, double t, const double *y, double *dy);

/* Distance from t to the next row of an input's table in direction pb->dir; HUGE_VAL where there is none. The third
 * derivative of the right-hand side jumps at a row, and a long step may skip rows: so an adaptive method ends its
 * step at *row if its own end would lie beyond. STEPS_TO methods get it as t_stop. */
double lag_next_row(const lag_problem *pb, double t, double *row);

/* Lq = dL/dq, Lv = dL/dv and Q, the forces outside L, all [nq]; and h[model->nsecond], their derivatives. For models
 * that have these functions; nz = 0. Return the model's status. */
int lag_variation(lag_problem *pb, double t, const double *q, const double *v, double *Lq, double *Lv, double *Q);
int lag_second_derivatives(lag_problem *pb, double t, const double *q, const double *v, double *h);

/* Derivatives of f, for models emitted with their linearisation (model->linear; lagc --with linear). All matrices
 * are dense and row-major; work[lag_linear_work()] is scratch, 0 doubles for a model with neither linearisation nor
 * constraints. Both return the model's status, or LAG_EMETHOD (and pb->detail) without linearisation; LAG_ESINGULAR
 * when M is singular. Neither looks for NaN; after an error the matrices are undefined. */
size_t lag_linear_work(const lag_model *model);

/* J[(nq + nz) * n]: derivatives by y of the accelerations and of the rates of states, that is the rows of df/dy
 * below the first nq; with the nq rows [0 | 1 | 0] above it J is df/dy. Exact without constraints; with constraints
 * finite differences, correct to half of the digits, which suffices for a simplified Newton's method. Calls lag_rhs,
 * and leaves f(t, y) in the first n of work. */
int lag_jacobian(lag_problem *pb, double t, const double *y, double *J, double *work);
/* The same as a tangent needs: with constraints exact by the emitted reverse mode; without it, and within slides, by
 * central differences of order 6, correct to 11 digits or so, in six calls of lag_rhs a column. With `by`, NULL: none,
 * J[(nq + nz) * (n + by->n)] has columns by these parameters, too, behind the others in each row. */
int lag_fine_jacobian(lag_problem *pb, const lag_parameter_columns *by, double t, const double *y, double *J,
                      double *work);

/* dr[(nq + nz) * n]: derivatives of the residuals r = (f - M a, flow) by y at given accelerations a[nq] (NULL: 0);
 * M[nq * nq]: the mass matrix. J above is M^-1 dr in its first nq rows. */
int lag_linearise(lag_problem *pb, double t, const double *y, const double *a, double *dr, double *M, double *work);

/* ---- Constraints: for models that have them (model->constraints, in lag_model.h). Functions return the model's
 * status. */

/* Sizes of pb->held and pb->ranks in doubles; 0 without constraints. */
size_t lag_constraint_scratch_size(const lag_model *model);
size_t lag_rank_scratch_size(const lag_model *model);

/* c[nholonomic], less the value at which it is held, and r[n] of the state y[n] at t. */
int lag_residuals(lag_problem *pb, double t, const double *y, double *c, double *r);

/* The least change d[nq] in the mass metric with A d = g, and force[nq] = M d = A^T mu; A and M at y, t. holonomic:
 * for g[nholonomic] and these constraints alone; else for g[n] and all. */
int lag_least_change(lag_problem *pb, double t, const double *y, int holonomic, const double *g, double *d,
                     double *force);

/* Projects y[n] onto the constraints at t: positions by Newton's iteration, each correction the least in the mass
 * metric, until the residual is rounding; then velocities. lost[n], or NULL: the compensation of the sum of steps in
 * y (methods/steps.h), which is updated. > 0: no solution near y, a smaller step may help; pb->detail names the
 * worst constraint, y and lost are undefined. Does nothing without constraints.
 *
 * E. Hairer, C. Lubich, G. Wanner, Geometric Numerical Integration, 2nd ed. (2006), IV.4, DOI 10.1007/3-540-30666-8:
 * projection keeps the order of a method. */
int lag_project(lag_problem *pb, double t, double *y, double *lost);
/* lag_project after a step from y0; > 0 also where the projection would move y farther than the step did: a
 * constraint jumps there, or the step is too long. */
int lag_project_step(lag_problem *pb, double t, const double *y0, double *y, double *lost);
/* The test of lag_project_step. A step from y0 to y displaced the coordinates by led[nq], and the projection then by
 * moved[nq]. Returns the first coordinate whose correction is more than twice the larger of its own led and of that
 * of coordinates of its unit that share a constraint with it; -1: none. Corrections below a millionth of the
 * coordinate's largest distance from 0 are rounding near a singular position, and pass. */
int lag_projection_leap(const lag_problem *pb, const double *y0, const double *y, const double *moved,
                        const double *led);
/* pb->detail := the constraint on positions that y breaks most at t, and that meeting it moves coordinate i by
 * `moved`. Returns LAG_ERETRY. */
int lag_report_leap(lag_problem *pb, double t, const double *y, int i, double moved);

/* Independence of the weakest constraint at y, t, from 1 to 0: the part of its gradient that is orthogonal to those
 * before it, times the ratio of its derivatives to its terms. *weakest: its index, or -1. Constraints that are
 * always redundant are left out. (constraints/constraint_rank.c) */
double lag_independence(lag_problem *pb, double t, const double *y, int *weakest);

/* The largest |x[j]| over the coordinates (or velocities) j with the unit of coordinate i: the scale of its rounding
 * where x[i] itself is small. */
double lag_unit_magnitude(const lag_problem *pb, const double *x, int i);
/* Typical magnitude of component i of q (holonomic) or of v: the largest of that unit; of an angle at least 1. In a
 * run that began at 0 it is at least 1e-6, and 1 if all values are 0, since nothing else sets a scale. Of a velocity
 * at least that of a motion through such a distance in the time of the run, as at rest the velocity itself is
 * rounding. */
double lag_typical_magnitude(const lag_problem *pb, const double *y, int holonomic, int i);
/* Projects a small change e[n] of the state y onto the tangent space of the constraints: lag_project to first order,
 * but for the change of A with the positions. */
int lag_project_tangent(lag_problem *pb, double t, const double *y, double *e);

/* size[nholonomic] (holonomic), or size[n] of the rates: the sum of |terms| of c, or r, at y, t. */
int lag_constraint_terms(lag_problem *pb, double t, const double *y, int holonomic, double *size);

/* The worst constraint: index of the c (holonomic) or r that is largest relative to its terms at y, t; *size, if not
 * NULL: that ratio in units of DBL_EPSILON. -1: no constraint, or no values. */
int lag_worst_constraint(lag_problem *pb, double t, const double *y, int holonomic, double *size);

/* Whether the residuals of y at t, c (holonomic) or r, are rounding: at most 2^10 DBL_EPSILON times their terms. */
int lag_constraint_is_met(lag_problem *pb, double t, const double *y, int holonomic, const double *residual);

/* text := the line of a constraint, " (line 7)", or "" where the emitted C does not say. Returns text. */
const char *lag_line_text(const lag_constraint *c, char text[32]);
/* pb->detail := "constraint rod (line 7) is off by 0.01 m" and `words`; for a residual of NaN "is not met".
 * holonomic: a residual of c, else of r. */
void lag_report_residual(lag_problem *pb, int k, int holonomic, double residual, const char *words);

/* The step [s] of a method with equal steps: the option, or where that is 0 a 10000th of the scene's span. */
double lag_step_size(const lag_problem *pb, double option);
/* Whether impulses by a tolerance are worth their steps: in a pile impacts follow each other, and motions part. */
int lag_few_contacts(const lag_model *m);

/* Index of the first element of x[n] that is not finite, -1 when all are. */
int lag_not_finite(int n, const double *x);

/* Hermite interpolation y[n] between two states: quintic in q, from q, v and a at both ends; cubic in v and z. y0,
 * f0 = f(y0), y1, f1 are [n]; h = t1 - t0; s = (t - t0)/h in [0, 1]. With f of order p >= 4 the result has order 4.
 * */
void lag_hermite(int nq, int nz, double h, double s, const double *y0, const double *f0, const double *y1,
                 const double *f1, double *y);

/* Properties of a method. */
enum {
  LAG_METHOD_ADAPTIVE = 1,     /* adaptive steps, from the tolerance; else steps are of equal size */
  LAG_METHOD_SYMPLECTIC = 2,
  LAG_METHOD_SYMMETRIC = 4,
  LAG_METHOD_KEPLER = 16,      /* needs lag_model.kepler */
  LAG_METHOD_VARIATION = 8,    /* needs derivatives of L: lag_model.variation and second */
  LAG_METHOD_STEPS_TO = 32,    /* dense() is inaccurate: must step exactly to each time of output */
  LAG_METHOD_NO_SAVE = 64,     /* work holds pointers: its state cannot be saved */
  LAG_METHOD_NO_STATES = 128,  /* refuses models with states (nz > 0) */
  LAG_METHOD_SPLITS = 512,     /* explicit splitting for models with LAG_SEPARABLE, which then need no derivatives */
  LAG_METHOD_TAYLOR = 256,     /* needs Taylor coefficients: lag_model.taylor */
  LAG_METHOD_JACOBIAN = 2048,  /* needs the linearisation: lag_model.linear */
  LAG_METHOD_CONSTRAINTS = 4096, /* steps end on the constraints of a model that has them */
  /* takes models of first order (nq = 0), with the linearisation in place of derivatives of L */
  LAG_METHOD_FLOWS = 8192,
  LAG_METHOD_IMPULSES = 16384, /* meets contacts by impulses in each step: their events are not located */
  LAG_METHOD_NEWTON = 1024     /* solves equations by Newton's method; with SPLITS only where it does not split */
};

/* An option of a method. With choices (NULL-terminated) the value is the index of a choice. */
typedef struct lag_method_option {
  const char *name;
  const char *doc;
  double value;    /* default */
  double min, max; /* allowed values, */
  const char *const *choices;
  double every; /* in steps of this from min; 0: all. */
  double most;  /* The largest with constraints; 0: max */
} lag_method_option;

/* An integrator. Its state is one block of work_size doubles (only doubles, unless NO_SAVE: then the state
 * of a run can be written and read back bit by bit), which begins at a multiple of LAG_WORK_ALIGN bytes. */
enum { LAG_WORK_ALIGN = 64 };

typedef struct lag_method {
  const char *name;
  int order, dense_order;      /* order of the steps, and between them, with default options */
  int order_least, order_most; /* range of orders that options choose; else 0 */
  const char *doc;  /* one line, then the source of the algorithm */
  unsigned flags;
  int noptions;
  const lag_method_option *options;

  /* Order of the steps with these option values; NULL: order. */
  int (*order_of)(const double *opt);

  /* NULL when the method can integrate this model with these option values; else why not, and what to write. May
   * itself be NULL. */
  const char *(*refuses)(const lag_model *model, const double *opt);

  /* Doubles of work that init needs with the options pb->opt. */
  size_t (*work_size)(const lag_problem *pb);

  size_t head; /* doubles at the beginning of work that init finds zeroed; 0: all of it */

  /* Prepares work. opt[noptions] are the values of the options. < 0: see pb->detail. */
  int (*init)(void *work, lag_problem *pb, const double *opt);

  /* One accepted step from (*t, y[n]), of the method's own size in direction pb->dir, never past t_stop for a
   * STEPS_TO method (others ignore t_stop). 0: *t, y are the new state. < 0: unchanged. Does not allocate. */
  int (*step)(void *work, lag_problem *pb, double *t, double *y, double t_stop);

  /* y[n] at t within the last step. May call the model; the next step does not depend on whether it was called. */
  void (*dense)(void *work, lag_problem *pb, double t, double *y);

  /* Forgets earlier steps: the caller is about to step from another state. */
  void (*reset)(void *work, lag_problem *pb);

  /* Frees what init allocated; NULL when it allocates nothing. */
  void (*fini)(void *work);

  /* Y[n * k] := D Y, with D = dy(t)/dy0 for a step that begins where the last step began and ends at t, at fixed
   * step size (for taylor: the derivative of the flow, to the tolerance). scratch has tangent_size(pb, k) doubles.
   * 0, or < 0 as step. Later steps do not depend on whether it was called. NULL: the method has no tangent. */
  size_t (*tangent_size)(const lag_problem *pb, int k);
  int (*tangent)(void *work, lag_problem *pb, double t, int k, double *Y, double *scratch);

  /* Reverse mode of a step from (t0, y0) of length dt: x[n] := (dy1/dy0)^T x, g[nu + np] += (dy1/du, dy1/dp)^T x,
   * inputs counted where they are held. span: the dt of the last step up to t. scratch[adjoint_size]. NULL: none.
   * keep: x[kept] := what else adjoint needs of the last step; it finds it behind y0. NULL: nothing. */
  double (*span)(const void *work, const lag_problem *pb, double t);
  size_t (*adjoint_size)(const lag_problem *pb);
  int (*adjoint)(lag_problem *pb, double t0, double dt, const double *y0, double *x, double *g, double *scratch);
  size_t (*kept)(const lag_problem *pb);
  void (*keep)(void *work, const lag_problem *pb, double *x);

  /* constants by which it differs from other methods with the same functions; these read lag_problem.variant */
  const void *variant;
  /* the smallest tolerance that the digits of its coefficients support; 0: coefficients have all digits of the
   * scalar */
  double finest;
} lag_method;

/* Classical Runge-Kutta method of order 4, fixed step. */
extern const lag_method lag_rk4;
/* Euler's method of order 1, fixed step: for comparison. */
extern const lag_method lag_euler;
/* Dormand-Prince 5(4), adaptive: the default. */
extern const lag_method lag_rk45;
/* Dormand-Prince 8(5,3), adaptive, for tolerances below about 1e-6. */
extern const lag_method lag_dop853;
/* Symplectic, fixed step: symplectic Euler, Stoermer-Verlet, and compositions of order 4, 6, 8. Explicit for
 * separable models. */
extern const lag_method lag_symplectic_euler, lag_verlet, lag_verlet4, lag_verlet6, lag_verlet8;
/* Symplectic, fixed step, implicit, for any L: from a discrete Lagrangian, and Gauss collocation, of order 2 to 8. */
extern const lag_method lag_variational, lag_gauss;
/* Time-stepping with contacts and friction by impulses, fixed step: for many contacts, or impacts that accumulate. */
extern const lag_method lag_moreau;
/* Wisdom and Holman's splitting, symplectic, fixed step: for planets, lag_model.kepler. */
extern const lag_method lag_wisdom_holman;
/* Radau IIA of order 5, implicit, adaptive: for stiff models; needs the linearisation. */
extern const lag_method lag_radau;
/* The model's own Taylor series, adaptive, for tolerances below about 1e-9; needs lag_model.taylor. */
extern const lag_method lag_taylor_method;
/* The methods of liblag.a, the default first. */
extern const lag_method *const lag_methods[];
extern const int lag_nmethods;
/* The methods of liblag_gsl.a (link with -llag_gsl -lgsl -lgslcblas). */
extern const lag_method *const lag_gsl_methods[];
extern const int lag_gsl_nmethods;

#ifdef __cplusplus
}
#endif

#endif
