/* What the files of core/ share: the simulation object, and the step of its life that each file does.
 * Holds: everything that a later run needs is in one block of doubles, `saved`, with no pointers in it;
 * so saving a run is writing that block.
 *
 * A run is a chain of steps [step_t0, step_t1] of the method. Within one, the run moves from `t` to
 * `limit`: the next event, or the end of the step. Where the caller stops does not enter. */
#ifndef LAG_CORE_CORE_H
#define LAG_CORE_CORE_H

#include <stddef.h>

#include "lag.h"

/* Scalars of a run that are saved. Counts are doubles, exact to 2^53. */
typedef struct Run {
  double begun;          /* the first advance was made */
  double dir;
  double t;              /* now */
  double have_step;      /* [step_t0, step_t1] is a step, not yet used up */
  double step_t0, step_t1;
  double from;           /* events are located from here on */
  double limit, pending; /* pending: events fire at limit */
  double steps, rejected, rhs_calls, systems, iterations, events;
  double watched;        /* up to here charges have been looked at */
  double balanced;       /* 1: the work of forces on charges is integrated */
  double c_peak, r_peak; /* the largest residual of a constraint, and of its rate, at ends of steps */
  double rank, beside;   /* constraints at the start that do not follow from others; where that is singular: a hundredth beside it */
  double apart, since_apart, unlooked; /* how independent constraints were when that was last asked, steps since then, and until then */
  double looks, coarse, period; /* of steps of equal size: how many were looked at, and were too long for a period [s] */
  double stall_since;    /* the time when the stall detector last looked at the pace of steps */
  double jolt, jolt_t;   /* the largest change of the energy in a step, but for smaller than twice the one before, and when that was */
  double strain, strain_of; /* the condition of the mass matrix there, and the coordinate of least inertia */
  double chatter, chatter_since; /* impacts at once after another one that left a gap open, and when these began */
  double row_origin, row_every, row_next;  /* of the rows of output; kept here for app/ */
} Run;

/* A charge along a run; only doubles, it is saved. Differences are those of Q - int P dt from `first`. */
enum { LAG_BINS = 32, LAG_NODES = 8 };
typedef struct Charge {
  double begin;      /* Q at the start */
  double first;      /* the same, moved by what events have done to it */
  double peak;       /* the largest difference */
  double scale;      /* median over the bins of the sum of the sizes of its terms; of few bins the largest */
  double before;     /* Q - int P dt - first at the last look */
  double through;    /* int |P| dt, step by step */
  double work, lost; /* int P dt, and what the sum has lost to rounding */
  double balanced;   /* 1: P is known, and integrated */
  double bins, width, in_bin; /* bins that are full; looks that fill one, looks in the open one */
  double t[LAG_BINS + 1], d[LAG_BINS + 1], m[LAG_BINS + 1]; /* averages of time, difference and sizes over each bin; the last: sums over the open one */
} Charge;

/* The numbers that this library is compiled for, as `lagc run --precision` calls them, and what gives more of them. The
 * Makefile says so for others than doubles; see precision.awk. */
#ifndef LAG_PRECISION
#define LAG_PRECISION "double"
#define LAG_MORE_PRECISION "; --precision quad has 34 digits"
#else
#define LAG_MORE_PRECISION ""
#endif

struct lag_sim {
  const lag_scene *scene;
  const lag_method *method;
  lag_problem pb;
  double *options;       /* [method->noptions] */
  double tol;
  int steps_equal;       /* lag_equal_step(s) > 0, for what asks at each step */
  unsigned char *fixed;  /* [np] set by the caller */
  lag_signal *signal;    /* [nu] set by the caller; not part of what is saved */
  double *start;         /* [n] NaN: as the scene says */
  double *scratch;       /* one block: u, work, y, g, g, outputs */
  double *sides;         /* [3 nswitch] scratch of stall_detector.c */
  double *paces;         /* [3 n] of force_pole.c: changes of the state in a second, over the last two steps, and their fading peak; NaN: not known */
  double *contact_room, *contact_was; /* [2 constraints], [contacts]: scratch of contact.c */
  double *u, *work, *ya, *yb, *yc, *g0, *g1, *out, *e, *spare;
  double *saved;         /* one block: Run, and the arrays below; in `room`, which is freed */
  char *room;
  size_t nsaved;
  Run *run;
  double *p, *derived, *hold; /* [np + nderived]; the last of them; [nu] */
  double *begin;         /* [n] at the start of the run */
  double *asked;         /* [n] the same before it was brought to the constraints */
  double *redundant;     /* [constraints] 1: at the start it follows from others */
  double *loose;         /* [nq] 1: beside a singular start its velocity is determined, and at it not */
  double *kept;          /* [constraints] what those on positions are held at */
  double *y;             /* [n] at step_t1 */
  double *y0;            /* [n] at step_t0 */
  double *now;           /* [n] at t */
  double *sign;          /* [nev] of g just after `from`: -1, 1, 0 not known yet */
  double *leaves;        /* [nev] of an event that has fired and has no sign yet: the sign of its rate then; 0 not known */
  double *noise;         /* [nev] |g| below this has no sign */
  double *root;          /* [nev] time of the next firing within the step, NaN none */
  double *sign_end;      /* [nev] sign at the end of the step */
  double *count;         /* [nev] */
  double *first, *last;  /* [nev] times, where count is not 0 */
  double *interval, *shorter; /* [nev] between the last two firings, and how many were each shorter than the one before */
  double *mon_first, *mon_peak; /* [nmonitors] of outputs */
  double *charge_block;
  Charge *charges;       /* the same: [lag_sim_ncharges] the energy first */
  double *charge_now, *charge_power, *charge_gain; /* scratch: value and scale of each; P; int P dt */
  double node[LAG_NODES], weight[LAG_NODES]; /* of the quadrature over a step, */
  int nodes;             /* which has so many */
  int balances;          /* lag_sim_balance was called */
  double *exact_peak;    /* [nexact] largest difference from the closed form */
  double *method_work;   /* [nwork], and as much behind it for a step that is tried again */
  size_t nwork;
  double *tangent, *tangent_jump, *tangent_scratch; /* [n * tangent_columns] at step_t0, or now where there is no step; NULL */
  int tangent_columns, tangent_at_event; /* at_event: it is what an event made of it at this time */
  double tangent_log;    /* sum of log |det S| over events (tangent.c); who reads it sets it back */
  int (*on_step)(void *, const lag_sim *);
  void *on_step_context;
  lag_event_fn *on_event;
  void *on_event_context;
  char message[512];
};

/* A part of the saved block behind Run, in the order in which they lie there, and what its numbers may be: saved.c refuses others. */
enum {
  LAG_SAVED_NUMBER, /* any */
  LAG_SAVED_FINITE,
  LAG_SAVED_HELD,   /* finite, or NaN: none */
  LAG_SAVED_FLAG,   /* 0, 1 */
  LAG_SAVED_SIGN,   /* -1, 0, 1 */
  LAG_SAVED_COUNT   /* whole, 0 to 2^53 */
};
enum { LAG_PARTS = 25 };
typedef struct lag_saved_part {
  double **at;
  size_t n;
  int kind;
} lag_saved_part;
/* setup.c: part[LAG_PARTS] := all of them. */
void lag_parts(lag_sim *sim, lag_saved_part *part);
/* Whether parameters have the signs that the model declares. */
int lag_signs_hold(const lag_sim *sim);
/* charges.c: whether the work of forces on charges can be integrated with this model and method. */
int lag_charges_balance(const lag_sim *sim);

/* A value in SI, in the declared unit of its variable. */
static inline double lag_declared(const lag_var *v, double si) { return (si - v->offset) / v->factor; }

/* setup.c: whether an option of this name is the size of a step; and what is wrong with x [s] as one of a run of this scene. NULL:
 * nothing. */
int lag_is_step(const char *option);
const char *lag_wrong_step(const lag_sim *s, double x);
/* The size of the steps of the run, where all have the same [s]; 0 where the method chooses it. */
double lag_equal_step(const lag_sim *s);

/* A number in a message, as %s. */
#define LAG_TEXT(x) lag_number_text((x), (char[64]){0})

/* message := the text; returns status. */
#if defined(__GNUC__)
__attribute__((format(printf, 3, 4)))
#endif
int lag_fail(lag_sim *sim, int status, const char *format, ...);

/* Why a step failed, with when and where. Returns status. */
int lag_explain(lag_sim *sim, int status);

/* sim.c: y[n] at t within the last step, on the constraints. LAG_OK, or a failure that is explained. */
int lag_between(lag_sim *sim, double t, double *y);

/* consistent.c: now[n], the start as it was set, becomes the nearest start that obeys the constraints; asked, redundant, loose, run->rank and
 * run->beside are set. */
int lag_consistent(lag_sim *sim);
/* agreement.c: constraints that follow from others at the start `now` agree soon after it, too; else a failure that names one. */
int lag_agreement(lag_sim *sim);
/* forces.c. observe: out[nout] of the scene, in SI, of the state y at t. Multipliers and accelerations near a position where constraints
 * become dependent are those that they tend to along the last step; NaN where there is none. LAG_OK, or what failed. */
int lag_observe(lag_sim *sim, double t, const double *y, double *out);
/* project.c: [2 n], how large terms of the rates and of the constraints were where these were last met. */
double *lag_kept_terms(const lag_problem *pb);
/* rank.c. A[n nq] := the derivatives of all constraints by the coordinates, row-major, at y at t, unit[nq] := their scales (lag_scales of
 * lag_kkt.h), and mass[nq nq], or NULL, := M. 0, or what the model returned; then they are undefined. */
int lag_constraint_rows(lag_problem *pb, double t, const double *y, double *A, double *unit, double *mass);
/* Of pb->ranks what that leaves: [n nq + nq + n]. */
double *lag_independence_room(const lag_problem *pb);
/* The part of row[n] of A that is independent of the orthonormal rows Q[r n], 0 to 1; more than `least`: its direction becomes row r of Q. -1: the
 * row is zero. row is destroyed; it may be row r of Q, or a later one. */
double lag_own_part(int n, int r, double least, const double *unit, double *Q, double *row);
/* weightless.c: about the condition of the mass matrix at y at t, scaled, on the directions that constraints allow; above 1e15 only that it is; NAN where it
 * is not known. *which: the coordinate that moves most along the direction of least inertia. */
double lag_mass_condition(lag_problem *pb, double t, const double *y, int *which);
/* The coordinate that moves most along the direction in which K[n n] is least, and *part: the last pivot against the first. K is destroyed; x[n] and
 * column[n] are scratch. */
int lag_weightless(int n, double *K, double *x, int *column, double *part);
/* pb.redundant, of what is found there or was saved. */
void lag_note_redundant(lag_sim *sim);

/* setup.c: the state at the start, of a run that has not begun. */
int lag_setup_start(lag_sim *sim);

/* events.c. arm: signs at the start of a step chain. locate (locate.c): the first event in (run->from, step_t1],
 * sets limit and pending. spread (locate.c): how much g[nev] differs from its values at limit within the last digits of the time,
 * which is what a step's dense output leaves open. fire: applies the events at limit. */
int lag_events_arm(lag_sim *sim);
int lag_events_locate(lag_sim *sim);
int lag_events_spread(lag_sim *sim, const double *at_event, double *spread);
int lag_events_fire(lag_sim *sim);
int lag_events_eval(lag_sim *sim, double t, const double *y, double *g);

/* landing.c: a step of the method from `now` at *t, into y and *t; of another size where it would end badly for constraints. What the
 * method returned; after a failure y and *t are as they were, or undefined. */
int lag_step_of_method(lag_sim *sim, double *t, double t_stop);

/* stall_detector.c: whether the step from `now` to y at t leads nowhere: LAG_ESTALL or LAG_ESTEP, and pb says why; or LAG_OK. */
int lag_stalls(lag_sim *sim, double t);

/* force_pole.c: whether the step from `now` to y at t, of equal size, leads over a pole of a derivative: LAG_EDOMAIN, and pb says of which; or LAG_OK. */
int lag_over_force_pole(lag_sim *sim, double t);
void lag_forget_paces(lag_sim *sim);

/* project.c. Constraints on velocities that keep a function of positions: until it is said what, positions are free; then they keep what it
 * is of y at t. Returns what the model returned. */
void lag_keep_nothing(lag_sim *sim);
int lag_keep(lag_sim *sim, double t, const double *y);

/* contact.c. of: the contact that the event is one of, or NULL. open: all of them, since the state will be another. settle: y, which a motion
 * or `who` has made, after what strikes has struck and what rests is closed; event: the one of a contact that has led there, or -1; ends: its
 * impacts have come to their end; who: it may set no state inside a contact, or NULL. begin: the start. arm: the signs of events of
 * contacts in `now`, where they are g[nev]: those that touch have none. Failures are reported. */
const lag_contact *lag_contact_of(const lag_model *m, int event);
int lag_contact_is_closed(const lag_sim *sim, const lag_contact *contact);
void lag_contact_open(lag_sim *sim);
int lag_contact_settle(lag_sim *sim, double *y, const char *who, int event, int ends);
int lag_contact_begin(lag_sim *sim);
int lag_contact_arm(lag_sim *sim, const double *g);

/* tangent.c. pass: the step has been used up. jump: event k changes the state from `now` to yb; more: another one has at this time. */
int lag_tangent_pass(lag_sim *sim);
int lag_tangent_jump(lag_sim *sim, int k, int more);
void lag_tangent_free(lag_sim *sim);

/* exact.c. at: the closed forms at t, behind the inputs in s->u; lag_inputs comes first. see: as in watch.c. */
int lag_exact_at(lag_sim *sim, double t);
int lag_exact_see(lag_sim *sim, double t, const double *y);

/* charges.c: as in watch.c; method: the one that steps will be made with; the others compute what a state makes of the charges. drift: of
 * charge k so far, relative to its size. flags: what is known of its rate of change, as inputs are set. _see returns LAG_EDRIFT, with a message,
 * where the energy has drifted past its size. */
void lag_charges_method(lag_sim *sim, const lag_method *method);
void lag_charges_begin(lag_sim *sim, double t, const double *y);
int lag_charges_see(lag_sim *sim, double t, const double *y);
/* Whether the energy, a number at first, is none at t. Then _see has added nothing, and returns LAG_ENAN. */
int lag_charges_lost(lag_sim *sim, double t, const double *y);
void lag_charges_jump(lag_sim *sim, double t, const double *ya, const double *yb);
double lag_charge_drift(const lag_sim *sim, int k);
unsigned lag_charge_flags(const lag_sim *sim, int k);

/* charges.c: whether half of the energy, known to be conserved or balanced, is still there: LAG_OK, or LAG_EDRIFT with a message. */
int lag_charges_kept(lag_sim *sim);

/* watch.c: charges and monitors. begin: first values. see: the state `y` at t is part of the run. jump: an
 * event changed the state from ya to yb. */
int lag_watch_begin(lag_sim *sim);
int lag_watch_see(lag_sim *sim, double t, const double *y);
int lag_watch_jump(lag_sim *sim, double t, const double *ya, const double *yb);

/* The root of f in [a, b] (a > b allowed), where f(a) and f(b) differ in sign: the end of the last bracket
 * on b's side, so that the sign has changed there. ITP method: I.F.D. Oliveira, R.H.C. Takahashi, ACM Trans.
 * Math. Softw. 47 (2020) 5, DOI 10.1145/3423597. */
double lag_root(double (*f)(void *context, double x), void *context, double a, double fa, double b, double fb);

/* A name in the scene: what it is and where. */
enum { LAG_IS_NOTHING, LAG_IS_P, LAG_IS_Q, LAG_IS_V, LAG_IS_Z, LAG_IS_U };
/* Finds name; *var is its description. LAG_IS_NOTHING: unknown. */
int lag_find(const lag_model *model, const char *name, int *index, const lag_var **var);
/* Whether var is the name of a member of the family called so: th[2] of th, r[1].x of r.x. */
/* What an effect calls its own: c of drag.c, v.x of wind.v.x; NULL where there is no dot. */
const char *lag_own_name(const char *var);
int lag_is_member(const char *var, const char *family, size_t length);
/* The known name nearest to `name` into best; 0 when none is near. */
int lag_nearest(const lag_model *model, const char *name, char *best, size_t nbest);
/* Member or component k of what is called `name` ("th": "th[1]", "th'": "th[1]'", "r": "r.x"), into part; 0 past the last. */
int lag_part(const lag_model *model, const char *name, int k, char *part, size_t npart);
/* Edits (insert, delete, replace, swap) between two words. */
int lag_distance(const char *a, const char *b);
/* The same where they may be a slip of the finger; LAG_FAR where there are so many, or one letter stands for another, that
 * it is another name. */
enum { LAG_FAR = 1000 };
int lag_near(const char *name, const char *known);

/* For app/: the output grid that is saved with the run. */
double *lag_sim_rows(lag_sim *sim);

#endif
