/* Consistent states: the state nearest to a requested one that obeys constraints c(x) = 0 or A x + b = 0, and why
 * there is none. One text for the start of a run (runtime/constraints) and for the compiler, which evaluates the
 * equations without emitted functions. */
#pragma once

/* Stages, in the order in which components may move: those that nobody set, then also rotations that nobody set,
 * then all. */
enum { LAG_MOVES_FIRST, LAG_MOVES_SECOND, LAG_MOVES_LAST };

typedef enum lag_start_kind {
  LAG_START_FOUND,
  LAG_START_NO_VALUE, /* the constraint has no value there; constraint -1: no constraint is known */
  LAG_START_BROKEN,   /* a state that must hold exactly violates the constraint */
  LAG_START_FLAT,     /* its derivatives vanish where it holds */
  LAG_START_STEEP,    /* its derivatives have no value where it holds */
  LAG_START_NONE      /* no state near the requested one was found that obeys it */
} lag_start_kind;

/* One level of constraints, on positions or on velocities. The caller sets all up to `asked`, and provides the
 * arrays behind. */
typedef struct lag_level lag_level;
struct lag_level {
  void *context;
  int n, rows, entries;  /* components; constraints; nonzero elements of their Jacobian A */
  const int *row, *col;  /* [entries] */
  int positions;         /* positions, else velocities, which obey a linear problem */
  int exactly;           /* a state that violates a constraint is refused */
  double rounding;       /* DBL_EPSILON of the numbers in which the constraints must hold */

  /* Callbacks evaluate the state w->x. Those that return int return 0 where values exist. */
  int (*residuals)(const lag_level *w, double *residual);
  int (*jacobian)(const lag_level *w, double *A);
  int (*terms)(const lag_level *w, double *size);                     /* size of the terms of each constraint */
  /* typical magnitude of each component, for another state x */
  void (*scales)(const lag_level *w, const double *x, double *reach);
  /* Solves M d - A^T l = pull M (asked - x), A d = -residual for the step d[nfree] of the free components. */
  int (*direction)(const lag_level *w, double pull, double *d);
  double (*distance)(const lag_level *w);         /* square of x - asked in the metric of M */
  int (*stage)(const lag_level *w, int i);        /* from which component i may move */
  int (*is_contact)(const lag_level *w, int k);   /* whether constraint k is a contact, which may have no derivatives */
  /* Velocities: closes the contact without a gap that x closes fastest although `asked` does not; 0: there is none.
   * NULL: the model has no contacts. */
  int (*close_gap)(const lag_level *w);

  double *x, *asked;                        /* [n] the state; as requested */
  double *best, *from, *d, *along, *reach, *nearest; /* [n] */
  double *other;                            /* [n] another solution of components that nobody set, if `ambiguous` */
  int ambiguous;
  /* [rows] at x; sizes of terms at the request, by which residuals are divided */
  double *residual, *size, *terms_here, *slope;
  double *has_terms;                        /* [rows] 1: the constraint has terms of finite size */
  double *A;                                /* [entries] */
  int *free, nfree, at, alike;              /* [n] components that may move; the stage at hand; 1: all cost alike */
};

/* Factor of component i in the metric of `direction` and `distance`, on each side of M: where components that
 * somebody set have to move, those that nobody set are no request, and cost next to nothing; unless no state is
 * found so. */
double lag_level_weight(const lag_level *w, int i);

/* Brings w->x, the requested state, onto the constraints: components that nobody set move first; then to the nearest
 * state in the mass metric, the nearest of those that are found from several places. Components that no constraint
 * contains stay. A state that obeys the constraints up to rounding stays. *constraint: the one at fault; w->x is
 * then the last state tried. Velocities that constraints ask for close no gap, if others obey them, too.
 *
 * Gauss-Newton steps, no longer than half of what is typical of a component, and damped until the residual falls (P.
 * Deuflhard, Newton Methods for Nonlinear Problems (2004), 4.3, DOI 10.1007/978-3-642-23899-4), from the request or
 * from states displaced from it; then Newton-like steps along the constraints. Velocities: one linear problem,
 * repeated for its rounding. */
lag_start_kind lag_consistent_state(lag_level *w, int *constraint);

/* d[n] := the move of the state w->x, found for w->asked before, as its residuals change by change[rows]: where the
 * request obeys the constraints, or the free components are as many as constraints; elsewhere the curvature of
 * constraints counts, and 0 is returned. */
int lag_state_change(lag_level *w, const double *change, double *d);

/* Moves w->x, positions on the constraints, to a state on them about a hundredth away; returns whether there is one. */
int lag_state_beside(lag_level *w);

/* loose[n] := 1 for components that the constraints hold nearby but not here: held and held_beside are the squared
 * projections of their directions on the rows of A at both states. */
void lag_loose_directions(int n, const double *held, const double *held_beside, double *loose);
