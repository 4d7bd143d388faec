/* The simulation object, and the functions that the files of core/ offer one another, grouped by file. Holds: the
 * state of a run is one block of doubles, `saved`, with no pointers in it; saving a run is writing that block.
 *
 * A run is a chain of method steps [step_t0, step_t1]. Within a step the run moves from `t` to `limit`: the next
 * event, or the end of the step. The times that the caller asks for do not change the steps. */
#pragma once

#include <float.h>
#include <math.h>
#include <stddef.h>

#include "lag.h"

/* Scalars of a run that are saved. Counts are doubles, exact to 2^53. */
typedef struct Run {
  double begun;          /* 1: the first advance was made */
  double dir;
  double t;              /* present time [s] */
  double have_step;      /* 1: [step_t0, step_t1] is a step that is not used up yet */
  double step_t0, step_t1;
  double from;           /* start of the search for events within the step */
  double limit, pending; /* pending: events fire at limit */
  double steps, rejected, rhs_calls, systems, iterations, events;
  double watched;        /* charges and their work are known up to this time */
  double balanced;       /* 1: the work of forces on charges is integrated along the run */
  double dry_work, dry_lost; /* work of dry friction, and what its rounding has lost */
  double at_events;      /* change of the energy at events: impacts, constraints that begin to hold, actions */
  double c_peak, r_peak; /* the largest residual of a constraint, and of its rate, at ends of steps */
  /* rank of the constraints at the start; and, at a singular start, their rank a hundredth away from it */
  double rank, beside;
  /* steps of equal size: period estimates made; estimates shorter than two steps; the last such period [s] */
  double looks, coarse, period;
  double stall_since;    /* time when the stall detector last judged the pace of steps */
  double creeps;         /* how often in a row they hardly advanced it */
  /* largest energy change in one step, and its time; replaced only by a change more than twice as large */
  double energy_jump, energy_jump_t;
  /* condition of the mass matrix at energy_jump_t, and the coordinate of least inertia */
  double mass_condition, mass_condition_of;
  /* events, ends of branches, turns of a slip; time when the stall detector last judged their pace */
  double restarts, restart_since;
  double pole_calls;     /* right-hand sides that the search for poles of forces took */
  double row_origin, row_every, row_next;  /* output grid, kept here for app/ */
  double seal;           /* in a saved state: hash of its numbers, and of what they belong to */
} Run;

/* The monitor of one charge along a run; only doubles, since it is saved. A difference is Q - int P dt - first. */
enum { LAG_BINS = 32, LAG_NODES = 8 };
typedef struct Charge {
  double begin;      /* Q at the start */
  double first;      /* Q at the start, plus the jumps of Q at events */
  double left, jumped; /* Q before the event that acts; sum of the |jumps| of Q at events */
  double peak;       /* largest |difference| */
  double size;       /* sum of |terms of Q| at the start: the size of Q, until there are bins */
  double terms;      /* size of Q where that is rounding (sizes.c), */
  double step;       /* with steps up to four times as long as this */
  double before;     /* difference at the last look */
  double through;    /* int |P| dt, step by step */
  double work, lost; /* int P dt, and what its rounding has lost */
  double balanced;   /* 1: P is known and integrated */
  double bins, width, in_bin; /* full bins; samples that fill a bin; samples in the open bin */
  /* means of time, difference and size over each bin; element LAG_BINS: sums over the open bin */
  double t[LAG_BINS + 1], d[LAG_BINS + 1], m[LAG_BINS + 1];
} Charge;

/* The scalar type of this library by its name in `lagc run --precision`, and advice for more digits. The Makefile
 * defines it for other types than double; see precision.awk. */
#ifndef LAG_PRECISION
#define LAG_PRECISION "double"
#define LAG_MORE_PRECISION "; --precision quad has 34 digits"
#else
#define LAG_MORE_PRECISION ""
#endif

/* A step that is made elsewhere, in the lanes of a vector (lanes/): with `on`, lag_sim_advance returns
 * LAG_WANTS_STEP where it needs a step, towards `to`; once `made` is set it goes on from the state in y, at the end
 * t of the step. */
enum { LAG_WANTS_STEP = 1000 };
typedef struct OutsideStep {
  int on, made;
  double to, t;
} OutsideStep;

struct lag_sim {
  const lag_scene *scene;
  const lag_method *method;
  lag_problem pb;
  double *options;       /* [method->noptions] */
  double tol;
  int steps_equal;       /* lag_equal_step(s) > 0, cached for checks made at each step */
  int forwards;          /* 1 + event that rises and falls as in a run forwards, whichever way the run goes; 0: none */
  unsigned char *fixed;  /* [np] 1: set by the caller */
  lag_signal *signal;    /* [nu] set by the caller; not saved */
  double *start;         /* [n] start values set by the caller; NaN: the scene's */
  double *scratch;       /* one block: u, work, y, g, g, outputs */
  double *sizes;         /* [nsizes + nmoving] scratch */
  double *sides;         /* [3 nswitch] switching functions, scratch of stall_detector.c */
  /* [3 n] force_pole.c: rate of change of the state over the last two steps, and its fading peak; NaN: not known */
  double *rate_history;
  double *contact_scratch, *contact_was; /* [2 constraints], [contacts]: scratch of contact.c */
  /* [contacts] 1 + the closed contact on the other side of one that touches, 0: none; gradients of gaps, scratch */
  double *contact_pair, *contact_rows;
  double *grip;          /* [nmodes] the largest mode of a sliding motion */
  /* [nmodes] switching.c: rounding of the switching functions, their size before events; whether the motion is at
   * the surface, the side to which it has slid off; scratch */
  double *side_noise, *slid_off, *meets, *left, *meeting;
  int *meeting_of;       /* [3 nmodes] scratch, pb.sliding, and bytes of scratch */
  double *u, *work, *ya, *yb, *yc, *g0, *g1, *out, *e, *spare;
  int *alike;            /* [nq + nz] sizes.c: the first coordinate, or state, with the unit of each */
  double *beside, *beside_noise, *beside_open; /* [n + np + nderived], [3 n], [3 n] scratch of sizes.c */
  double *saved;         /* one block: Run and the arrays below; it lies in `room`, which is freed */
  char *room;
  size_t nsaved;
  Run *run;
  /* [np + nderived]; its last nderived; [nu + nmodes] modes, and input constants, NaN: none */
  double *p, *derived, *hold;
  double *begin;         /* [n] at the start of the run */
  double *asked;         /* [n] start as requested, before projection onto the constraints */
  double *elsewhere;     /* [nq] another assembly, of coordinates that nobody set; NaN: none is known */
  double *redundant;     /* [constraints] 1: it follows from the others at the start */
  double *loose;         /* [nq] 1: at a singular start the velocity is free, but the constraints nearby determine it */
  double *kept;          /* [constraints] values at which constraints on positions are held */
  double *y;             /* [n] at step_t1 */
  double *y0;            /* [n] at step_t0 */
  double *now;           /* [n] at t */
  double *sign;          /* [nev] sign of g just after `from`: -1, 1; 0 not known yet */
  double *noise;         /* [nev] |g| up to this counts as 0 */
  double *root;          /* [nev] time of the next firing within the step, NaN none */
  double late;           /* delay of events, relative to their times: see error_report.c */
  double *sign_end;      /* [nev] sign of g at the end of the step */
  double *count;         /* [nev] */
  double *first, *last;  /* [nev] times of firing, where count is not 0 */
  /* [nev] interval between the last two firings; number of intervals in a row, each shorter than the one before */
  double *interval, *shorter;
  /* [nev] first interval of the present series of shorter ones; time of the flights that were taken as rest */
  double *flight, *skipped;
  /* [nmodes] times that a surface was crossed, slides begun; their time, start of the present mode */
  double *crossed, *slips, *slid, *slid_since;
  double *mon_first, *mon_peak; /* [nmonitors] first value and largest deviation of a monitored output */
  double *charge_block;
  Charge *charges;       /* charge_block as [lag_sim_ncharges]; the energy first */
  double *charge_now, *charge_power, *charge_gain; /* scratch: value and scale of each charge; P; int P dt */
  /* quadrature nodes and weights over a step, as lag_charges_nodes left them; node[0] 0: not yet */
  double node[LAG_NODES], weight[LAG_NODES];
  int nodes, nodes_at_end; /* their number; 1: Radau's, the last of them at the end */
  int balances;          /* lag_sim_balance was called */
  int unreported;        /* nobody reads its drifts: terms of charges are taken where one is judged */
  double *exact_peak;    /* [nexact] largest difference from the closed form */
  double *method_work;   /* [nwork] */
  size_t nwork;
  double kicks_late; /* time between the origin of kicks and the begin of the scene, as of a part of a motion */
  /* [n * tangent_columns] at step_t0, or at t where there is no step; NULL: no tangent */
  double *tangent, *tangent_jump, *tangent_scratch;
  double *hold_before; /* [nu + nmodes] of a run with a tangent: hold before the event */
  const double *forced; /* hold of constraints with `while` behind an event, for its derivative; NULL: by conditions */
  struct lag_sensitivity *sensitivity;   /* parameter_columns.c; NULL: the tangent is one by starts alone */
  struct lag_record *record;             /* gradient.c; NULL: steps are not kept */
  int parameters_shifted; /* the parameters are those of a difference, beside the run's own */
  int tangent_columns, tangent_at_event; /* tangent_at_event: the event at this time is already applied to it */
  /* switches met at this time; whether that time depends on the state; whether the last one is only touched */
  int tangent_meets, tangent_moves, tangent_touches;
  /* sum of log |det S| over events (flow_tangent.c), -HUGE_VAL once a slide has begun; its reader sets it back to 0 */
  double tangent_log;
  int (*on_step)(void *, const lag_sim *);
  void *on_step_context;
  lag_event_fn *on_event;
  void *on_event_context;
  OutsideStep outside;
  const lag_scene *lanes_4, *lanes_8; /* lanes/batch.c: the scene compiled for lanes; NULL: it is not */
  /* lag_sim_renew: this struct before the run, NULL: not renewed; the simulation that it is like */
  struct lag_sim *fresh;
  const struct lag_sim *like;
  char message[512];
};

/* An SI value converted to the declared unit of its variable: of the numbers that give it back, one with few decimals,
 * so that a start of 60 [deg] is shown as 60, not 59.99999999999999. */
static inline double lag_declared(const lag_var *v, double si) {
  double x = (si - v->offset) / v->factor, few = rint(1e6 * x) / 1e6;
  return v->factor != 1 && fabs(few - x) <= 4 * DBL_EPSILON * fabs(x) &&
                 fabs(few * v->factor + v->offset - si) <= DBL_EPSILON * fabs(si)
             ? few
             : x;
}

/* setup.c: why x [s] cannot be the step size of this scene, NULL: it can. */
const char *lag_step_error(const lag_sim *s, double x);
/* The common size of the steps [s]; 0 where the method adapts it. */
double lag_equal_step(const lag_sim *s);

/* saved_state.c: FNV-1a hash that goes on from h with a number, by its value: in memory, numbers of some precisions
 * have bytes without meaning. */
unsigned long long lag_hash_number(unsigned long long h, double x);
unsigned long long lag_hash_numbers(unsigned long long h, long long n, const double *x);

/* A number for %s in a message. */
#define LAG_TEXT(x) lag_number_text((x), (char[64]){0})

/* failure.c: message := the text; returns status. */
#if defined(__GNUC__)
__attribute__((format(printf, 3, 4)))
#endif
int lag_fail(lag_sim *sim, int status, const char *format, ...);

/* For lag_explain: pb->detail := the text, pb->bad_t := t; returns status. */
#if defined(__GNUC__)
__attribute__((format(printf, 4, 5)))
#endif
int lag_note(lag_problem *pb, int status, double t, const char *format, ...);

/* Writes into message why, when and where a step failed. Returns status. */
int lag_explain(lag_sim *sim, int status);

/* projection.c: y[n] := the dense output at t in the last step, projected onto the constraints. LAG_OK, or a failure
 * with its message. */
int lag_dense_state(lag_sim *sim, double t, double *y);

/* consistent_start.c: now[n], the requested start, becomes the nearest start on the constraints; sets asked,
 * redundant, loose, run->rank and run->beside. */
int lag_consistent_start(lag_sim *sim);
/* accessors.c: out[nout] := outputs of the scene [SI] at y, t; those with multipliers or accelerations are NaN near
 * a singular position of the constraints. LAG_OK, or the status of the failed function. */
int lag_observe(lag_sim *sim, double t, const double *y, double *out);
/* parameter_columns.c: out[noutputs] := the outputs in SI, or the state where the scene has none. Adds to a column of
 * D[noutputs columns]: the outputs, times weight; their derivative by parameter column j. */
int lag_outputs_at(lag_sim *s, double t, const double *y, double *out);
int lag_add_outputs(lag_sim *s, double t, const double *y, double weight, double *out, int columns, double *column);
int lag_outputs_by_parameter(lag_sim *s, double t, const double *y, int j, double *out, int columns, double *column);
/* M[nq nq] := the symmetric matrix with these entries of its lower triangle. */
void lag_symmetric_matrix(size_t nq, int n, const lag_entry *at, const double *entry, double *M);
/* constraint_rank.c: A[n nq] := Jacobian of all constraints by the coordinates at y, t, row-major; unit[nq] :=
 * coordinate scales (lag_scales of lag_kkt.h); mass[nq nq] := M unless NULL. 0, or the model's status; then they are
 * undefined. */
int lag_constraint_jacobian(lag_problem *pb, double t, const double *y, double *A, double *unit, double *mass);
/* The part of pb->ranks that lag_constraint_jacobian does not use: [n nq + nq + n]. */
double *lag_independence_scratch(const lag_problem *pb);
/* Whether coordinates have one typical magnitude, as the members of a family, of which there may be hundreds. */
int lag_are_alike(const lag_var *a, const lag_var *b);
/* The fraction of row[n] of A that is independent of the orthonormal rows Q[r n], 0 to 1. If more than `least`, its
 * direction becomes row r of Q. -1: the row is zero. Destroys row, which may be row r of Q, or a later one. */
double lag_independent_part(int n, int r, double least, const double *unit, double *Q, double *row);
/* massless_direction.c: estimate of the condition of the scaled mass matrix at y, t, on the directions that
 * constraints allow; NAN: not known; a value above 1e15 means above 1e15. *which: the coordinate with the largest
 * part in the direction of least inertia. */
double lag_mass_condition(lag_problem *pb, double t, const double *y, int *which);
/* Gaussian elimination of K[n n] with complete pivoting: returns the coordinate that moves most along the direction
 * of least inertia; *part: last pivot over the first. Destroys K; x[n] and column[n] are scratch. */
int lag_massless_direction(int n, double *K, double *x, int *column, double *part);
/* pb.redundant := whether any constraint is marked redundant (just found, or loaded). */
void lag_note_redundant(lag_sim *sim);

/* method_checks.c: values[noptions] := options by name; whether a method can integrate the model, and has the digits
 * for its tolerance. Fail with a message that says why, and which method can. */
int lag_method_read_options(lag_sim *sim, const lag_method *method, const lag_option *opt, int nopt, double *values);
int lag_method_check(lag_sim *sim, const lag_method *method);
int lag_method_check_digits(lag_sim *sim, const lag_method *method);
/* setup.c: sets the state at the start of a run. */
int lag_setup_start(lag_sim *sim);
/* The same without checks of parameters and inputs. */
int lag_start_state(lag_sim *sim);
/* Fail, with a message: a parameter, or a size that parameters determine, has another sign than declared; a friction is
 * negative at y, t. */
int lag_check_parameters(lag_sim *sim);
int lag_check_moving_sizes(lag_sim *sim, double t, const double *y);

/* events.c and event_location.c. arm: signs of g at the start of a chain of steps. locate: the first event in
 * (run->from, step_t1]; sets limit and pending. spread: variation of g[nev] about limit within the last digits of
 * the time, which the dense output cannot resolve; jumps[2 nev]: 1 for events that are due because g jumps over
 * zero; then scratch. fire: applies the events at limit. inputs_jump: modes of switches after a jump of inputs.
 * eval: g[nev] at y, t. */
int lag_events_arm(lag_sim *sim);
int lag_events_inputs_jump(lag_sim *sim);
int lag_events_locate(lag_sim *sim);
int lag_events_spread(lag_sim *sim, const double *at_event, double *spread, double *jumps);
int lag_events_fire(lag_sim *sim);
int lag_events_eval(lag_sim *sim, double t, const double *y, double *g);

/* branch_change.c: whether the step from `now` to y at t continues another motion, beside a singular position of the
 * constraints. LAG_OK, or LAG_EMETHOD with the reason in pb. */
int lag_changes_branch(lag_sim *sim, double t);

/* switching.c. place: modes for a new state `now`. meet: the event of switch k is due; settle: modes from there on,
 * and whether any has changed. before_events: call before events change the state. eval: event functions g[nmodes]
 * at y, t, after lag_inputs_at. noise: |g| up to this counts as 0. count: pb.sliding from the modes. */
int lag_switch_place(lag_sim *sim);
int lag_switch_before_events(lag_sim *sim);
void lag_switch_meet(lag_sim *sim, int k);
int lag_switch_settle(lag_sim *sim, int *changed);
int lag_switch_eval(lag_sim *sim, double t, const double *y, double *g);
double lag_switch_noise(const lag_sim *sim, int k);
int lag_switch_fail_zeno(lag_sim *sim, int k);
/* Event of a contact that sticks no longer: whether dry friction of a joint, whose slip it holds, takes over enough. */
int lag_switch_relieve(lag_sim *sim, int event);
void lag_switch_count(lag_sim *sim);
/* Exchanges inputs and modes that are held with other[nu + nmodes]. */
void lag_hold_swap(lag_sim *sim, double *other);
/* step: counts for the step from `now` to y at t, where the method finds modes. sticks: whether the motion does on
 * surface k. */
int lag_switch_step(lag_sim *sim, double t);
/* Value of the switching function on its surface, for messages. */
static inline const char *lag_switch_value(const lag_switch *c) { return c->is_floor ? "a whole number" : "0"; }
int lag_switch_sticks(const lag_sim *sim, int k);
/* 1: no branch is held, for right-hand sides at states that are not of the run; 0: those of the run again. */
void lag_switch_set_free(lag_sim *sim, int free);
/* Holds switch k at mode m, 0: sliding, for right-hand sides beside the surface. */
void lag_switch_hold(lag_sim *sim, int k, double m);
/* Holds each switch at its side of y, for differences beside its surface. A status. */
int lag_switch_hold_sides(lag_sim *sim, double t, const double *y);
/* Event functions that are watched: events, then switches that have a mode; none of these for methods that find no
 * events. */
static inline int lag_watched(const lag_sim *s) {
  return s->scene->model->nev + (s->method->flags & LAG_METHOD_STEPS_TO ? 0 : s->scene->model->nmodes);
}

/* stall_detector.c: judges the step from `now` to y at t. LAG_OK; LAG_ESTALL or LAG_ESTEP where the motion makes no
 * progress, with the reason in pb. */
int lag_detect_stall(lag_sim *sim, double t);
/* The one watch of restarts by events, contacts, impacts and switches: counts one; whether the last ones advanced
 * the time by next to nothing, *led. */
int lag_restarts_stall(lag_sim *sim, double *led);

/* force_pole.c: whether the step of equal size from `now` to y at t crosses a pole of a derivative. LAG_OK, or
 * LAG_EDOMAIN with the derivative in pb. */
int lag_crosses_force_pole(lag_sim *sim, double t);
void lag_reset_rate_history(lag_sim *sim);

/* projection.c: constraints on velocities that are the rate of a function of positions. keep_nothing: their
 * positions are free. keep: holds the functions at their values at y, t. Returns the model's status. */
void lag_release_integrals(lag_sim *sim);
int lag_hold_integrals(lag_sim *sim, double t, const double *y);

/* contact.c. of: the contact to which the event belongs, or NULL. open: opens all contacts, before the state is
 * replaced. settle: applies impacts to y and closes the contacts that rest. event: the contact event that led there,
 * or -1; ends: its series of impacts has ended; who: name of the event that set y, which must not lie inside a
 * contact, or NULL. begin: contacts at the start. arm: signs of contact events in `now`, where their functions are
 * g[nev]; those that touch have none. Failures have their message. */
const lag_contact *lag_contact_of(const lag_model *m, int event);
int lag_guide_turns(const lag_model *m, int event);    /* whether the force of a guide changes its side there */
int lag_guide_of(const lag_model *m, int contact); /* index of the guide with this tangent; -1: there is none */
enum { LAG_MOST_GUIDES = 16 }; /* whose frictions events decide together; moreau has no limit */
/* Whether a contact is a gap, and not a constraint with a condition. */
int lag_has_gaps(const lag_model *m);
/* Whether event k is located: those of contacts that are met by impulses are not. */
int lag_event_is_located(const lag_sim *sim, int k);
int lag_contact_is_closed(const lag_sim *sim, const lag_contact *contact);
void lag_contact_open(lag_sim *sim);
int lag_contact_resolve(lag_sim *sim, double *y, const char *who, int event, int ends);
int lag_contact_begin(lag_sim *sim);
int lag_contact_arm(lag_sim *sim, const double *g);
/* Index of the first contact that is not open at y, t, or constraint with `while` that acts; -1: none; -2: they have
 * no values there. */
int lag_contact_not_open(lag_sim *sim, double t, const double *y);
/* g[nev] at y, t beside the constraints: adds the gap of a closed contact to that of an open one on its other side. */
int lag_contact_pairs(lag_sim *sim, double t, const double *y, double *g);
/* contact_friction.c: law[3 contacts] at y, now. Failures have their message. law_size: numbers in pb.rub. */
int lag_contact_laws(lag_sim *sim, const double *y, double *law);
size_t lag_contact_law_size(const lag_model *m);
/* Until held is 0, forces of guides press to the side to which they did last: without the corner where they turn. */
void lag_guides_hold_sides(lag_problem *pb, int held);
/* Event functions g[nev] of tangents: 1 where they are none, 1 or -1 times the slip velocity. */
int lag_tangent_events(lag_sim *sim, double t, const double *y, double *g);
void lag_contacts_turn(lag_sim *sim); /* held directions of slips in space := those at the end of a step */
/* Event functions g[nev] of contacts that are met by impulses: 1, as they do not happen. show: u of these contacts,
 * for outputs with multipliers: closed where the last step pressed them. show_start: before the first step hold says
 * what rests at y under its forces, until lag_contact_open; where these decide nothing, all are open. */
void lag_contact_mute(const lag_sim *sim, double *g);
void lag_contact_show_start(lag_sim *sim, const double *y);
void lag_contact_show(lag_sim *sim);
void lag_mark_due(lag_sim *sim, int event); /* the event happens at this time, too, unless it has fired already */
/* conditional_constraints.c: constraints that hold while a condition is true. place: which of them hold at y, and no
 * more. settle: which of them hold at y, with the velocities that they and contacts then allow; moved: the event has
 * set velocities (1) or positions, too (2); zero[events]: rounding of event functions, or NULL; the others as for
 * lag_contact_resolve. */
int lag_conditional_place(lag_sim *sim, double t, const double *y);
int lag_settle_constraints(lag_sim *sim, double *y, const char *who, int event, int ends, int moved,
                           const double *zero);

/* linearisation.c: the scale of component i of the state at which a smooth model bends, for differences; of an angle
 * at most 1. */
double lag_difference_scale(lag_problem *pb, const double *y, int i);
/* J[(nq + nz) * nu]: exact derivatives by inputs of the rates below the first nq; work[lag_linear_work()]. LAG_EMETHOD:
 * there are none. */
int lag_input_jacobian(lag_problem *pb, double t, const double *y, double *J, double *work);

/* kicks.c: events at equal times (LAG_KICK). begin: checks their periods, values of the event functions. plan:
 * pb.kick := the time of the next. locate: root[] of those in the step, whose event functions at its start are
 * given; returns the end of the part of the step before the first. at_once: whether one is due now; it then makes a
 * step of no length, which ends there. */
int lag_is_kick(const lag_model *m, int k);
int lag_kicks_begin(lag_sim *sim, const double *period);
int lag_kicks_plan(lag_sim *sim);
double lag_kicks_locate(lag_sim *sim, const double *period);
int lag_kicks_at_once(lag_sim *sim);
/* flow_tangent.c. meet: carries the tangent to the present time, where switch event k ends its branch; corner: over
 * the change of rates there, after modes are settled; begin: projects the tangent of a motion that begins by
 * sliding. pass: carries the tangent over a step that is used up; carry: to the present time, where an event changes
 * the set of closed contacts or the state. saltation.c. jump: carries it over event k, which changes the state from
 * `now` to yb; more: another event has changed the state at this time. */
int lag_tangent_pass(lag_sim *sim);
int lag_tangent_meet(lag_sim *sim, int k);
int lag_tangent_corner(lag_sim *sim);
int lag_tangent_begin(lag_sim *sim);
int lag_tangent_jump(lag_sim *sim, int k, int more);
int lag_tangent_carry(lag_sim *sim);
/* edges: fails where friction holds with all its force. settle: projects the tangent at yb, with what holds there.
 * effect: after := the state behind event k at y, whose constraints hold. */
int lag_tangent_edges(lag_sim *sim);
int lag_tangent_settle(lag_sim *sim);
int lag_event_effect(lag_sim *sim, int k, const double *y, double *after);
void lag_tangent_free(lag_sim *sim);
/* As lag_sim_set_tangent, which first frees columns by parameters. */
int lag_tangent_set(lag_sim *sim, int k, const double *Y);
/* Y := D Y, with D the derivative of the last step up to t, on the constraints. */
int lag_tangent_over(lag_sim *sim, double t, double *Y);
/* Whether the present state at t has a tangent space. */
int lag_tangent_exists(lag_sim *sim, double t);
/* gradient.c: in place of advancing the tangent: keeps the last step up to t; the matrix by which a jump has multiplied
 * the columns, which begin anew. pause: the caller is about to look at a state within a step. */
int lag_record_step(lag_sim *sim, double t);
int lag_record_pause(lag_sim *sim);
/* Between steps: begins a new unit where the record is full. */
int lag_record_cut(lag_sim *sim);
/* saved_state.c: x[nsaved] := the run; the run := x, of the same simulation. */
void lag_put_down(lag_sim *sim, double *x);
void lag_take_up(lag_sim *sim, const double *x);
/* sim.c: the run up to the end of this step, on its way to time t. */
int lag_run_to_step(lag_sim *sim, double steps, double t);
int lag_record_jump(lag_sim *sim);
void lag_record_free(lag_sim *sim);
/* tangent_space.c. dimension: of the tangent space of the constraints at the present state; of a run that has not
 * begun at its start, which is computed; n without constraints; or a status < 0 with its message. project: each
 * column of Y[n k] at y, t onto that space, in the mass metric; scratch[lag_tangent_projection_size]. */
int lag_tangent_dimension(lag_sim *sim);
size_t lag_tangent_projection_size(const lag_problem *pb);
int lag_tangent_project(lag_problem *pb, double t, const double *y, int k, double *Y, double *scratch);
/* The transpose, by the emitted reverse mode: x[n] := of x, g[nu + np] += products by inputs and parameters;
 * scratch[lag_project_back_size]. */
size_t lag_project_back_size(const lag_problem *pb);
int lag_project_back(lag_problem *pb, double t, const double *y, double *x, double *g, double *scratch);

/* Differences of order 6: the weight of a value k steps away, k = -3 ... 3, times the step; a step as a part of the
 * scale. Wrong by rounding over 2^-9, and by 2^-54/140 of a seventh derivative, for a scale of 1. */
#define LAG_DIFFERENCE_PART 0x1p-9
static inline double lag_difference_weight(int k) {
  const double weight[] = {0, 0.75, -0.15, 1.0 / 60};
  return k < 0 ? -weight[-k] : weight[k];
}
/* Loops over k = -1, 1, -2, 2, -3, 3: in this order a value that does not change has the difference 0, not rounding. */
#define LAG_EACH_DIFFERENCE(k) for (int k = -1; k >= -3; k = k < 0 ? -k : -k - 1)
/* Parameters k steps along parameter column j. */
static inline const double *lag_shifted_parameters(const lag_problem *pb, const lag_parameter_columns *by, int j,
                                                   int k) {
  return by->shifted + (size_t)(7 * j + k + 3) * (size_t)(pb->model->np + pb->model->nderived);
}

/* setup.c: now[n] := the start as asked for. nearest_start.c: e[n], a change of that by a step h of parameter column j,
 * or (-1) of a start, := that of the nearest start, now; 0: it is not known, and differences have to tell. */
void lag_asked_start(lag_sim *sim);
int lag_start_change(lag_sim *sim, const lag_parameter_columns *by, int j, double h, double *e);
/* parameter_columns.c. use: the run computes with parameters k steps along parameter column j; k = 0: with its own
 * again. event: change[columns] := derivatives of event function `event` by parameters, 0 in columns of starts;
 * action: change[n columns], of the state that its action sets; after[n] is scratch. They use g1. */
void lag_parameter_columns_free(lag_sim *sim);
/* Columns by each parameter, pb.by, in place of those of the run, `kept`, until _end. */
int lag_all_parameters(lag_sim *sim);
void lag_all_parameters_end(lag_sim *sim, struct lag_sensitivity *kept);
/* A tangent with a column for each component of the start and for each parameter, in this order; its columns at the
 * start [n (n + np)]; derivative of parameter i by parameter j, which it may follow. */
int lag_all_columns(lag_sim *sim);
const double *lag_columns_at_start(const lag_sim *sim);
double lag_parameter_chain(const lag_sim *sim, int i, int j);
void lag_use_parameters(lag_sim *sim, int j, int k);
int lag_event_by_parameters(lag_sim *sim, int event, double *change);
int lag_action_by_parameters(lag_sim *sim, int event, double *after, double *change);

/* closed_form.c. at: the closed forms at t, stored behind the inputs in s->u; call lag_inputs first. see: as in
 * monitors.c. */
int lag_closed_form_at(lag_sim *sim, double t);
int lag_closed_form_record(lag_sim *sim, double t, const double *y);

/* charge_monitor.c: charge_now[2 k], charge_now[2 k + 1] := value and scale of charge k at y, t; NaN where there is
 * none. */
void lag_charges_at(lag_sim *sim, double t, const double *y);
/* begin, see and jump as in monitors.c. method: chooses quadrature nodes for the method of the steps, which nodes
 * computes before their first use. drift: of charge k so far, relative to its size. flags: what is known of its
 * rate, given the inputs that are set. _see returns LAG_EDRIFT, with a message, where the energy has drifted past
 * its size. */
void lag_charges_method(lag_sim *sim, const lag_method *method);
void lag_charges_nodes(lag_sim *sim);
void lag_charges_begin(lag_sim *sim, double t, const double *y);
int lag_charges_record(lag_sim *sim, double t, const double *y);
/* Whether the energy, finite at the start, is not finite at t. _see then adds nothing and returns LAG_ENAN. */
int lag_energy_undefined(lag_sim *sim, double t, const double *y);
void lag_charges_side(lag_sim *sim, double t, const double *y, int after);
/* Work at an instant, of impulses, whose effect on the energy is known better than from states before and after;
 * rubbed: of friction. */
void lag_charges_add_work(lag_sim *sim, double at_events, double rubbed);
double lag_charge_drift(const lag_sim *sim, int k);
unsigned lag_charge_flags(const lag_sim *sim, int k);
/* Whether dE/dt = 0: proved, or 0 to the last bit at these values of parameters, as the power of a drag that is 0. */
int lag_conserves_energy(lag_sim *sim);

/* charge_monitor.c: LAG_EDRIFT with a message where half of an energy that is known to be conserved or balanced is
 * lost; else LAG_OK. */
int lag_energy_retained(lag_sim *sim);

/* monitors.c: charges and monitors. begin: first values. see: records the state `y` at t of the run. jump: an event
 * changed the state from ya to yb; side: one half of this, where branches of switches change with it. */
int lag_monitors_begin(lag_sim *sim);
int lag_monitors_record(lag_sim *sim, double t, const double *y);
/* impulses: the same for impulses of contacts within a step, at the present time, once dense output contains them. */
int lag_monitors_impulses(lag_sim *sim);
int lag_monitors_jump(lag_sim *sim, double t, const double *ya, const double *yb);
int lag_monitors_side(lag_sim *sim, double t, const double *y, int after);

/* sizes.c: alike[nq + nz] of a simulation. */
void lag_find_alike(const lag_model *m, int *alike);
/* `size` where it is more than rounding of terms of the size `terms`, else `terms`. */
double lag_above_rounding(double size, double terms);
/* The size of the terms of the energy, forces in balance over a step h among them, and of output k, at y, t; v[nq] :=
 * of each velocity, that at which the coordinates of its unit would have this energy; HUGE_VAL: there is none. NaN: not
 * known. Scratch: ya, yb, yc. */
double lag_energy_terms(lag_sim *sim, double t, const double *y, double h);
double lag_output_terms(lag_sim *sim, double t, const double *y, int k);
/* Change of output k with a relative change of the state, per unit of it; NaN: not known. */
double lag_output_change(lag_sim *sim, double t, const double *y, int k);
void lag_velocity_terms(lag_sim *sim, double t, const double *y, double h, double *v);
/* pb.size := sizes of the components of a run that begins at `now`: of each unit the largest value and what forces
 * add to it in the time scale of the motion. Three right-hand sides, eleven from rest at 0, not counted. */
void lag_start_sizes(lag_sim *s);
/* The present step, before the first one the step that is set; 0: it is not known. */
double lag_step_so_far(const lag_sim *sim);
/* noise := rounding of a formula at t, y, with the inputs as they are. up, down: as noise, which is the energy
 * and its scale, rates of velocities and states, or residuals of nholonomic constraints. Not 0: there are no values.
 * */
typedef enum LagFormula { LAG_FORMULA_ENERGY, LAG_FORMULA_RATES, LAG_FORMULA_RESIDUALS } LagFormula;
int lag_formula_rounding(lag_sim *sim, LagFormula of, double t, const double *y, double *noise, double *up,
                         double *down);

/* Kinds of names in a scene. */
enum { LAG_IS_NOTHING, LAG_IS_P, LAG_IS_Q, LAG_IS_V, LAG_IS_Z, LAG_IS_U };
/* Finds name; returns its kind, *index within that kind and *var, its description. LAG_IS_NOTHING: unknown. */
int lag_find_name(const lag_model *model, const char *name, int *index, const lag_var **var);
/* The name inside its effect: c of drag.c, v.x of wind.v.x; NULL where there is no dot. */
const char *lag_name_in_effect(const char *var);

/* The input that is the rate of input i, which stands behind it with a prime in its name; -1: the model needs none. */
int lag_input_rate(const lag_model *m, int i);
/* Whether var is a member of the family: th[2] of th, r[1].x of r.x; length is strlen(family). */
int lag_is_member(const char *var, const char *family, size_t length);
/* best := the known name nearest to `name`; 0 when none is near. */
int lag_nearest_name(const lag_model *model, const char *name, char *best, size_t nbest);
/* part := member or component k of the family `name` ("th": "th[1]", "th'": "th[1]'", "r": "r.x"); 0 past the last. */
int lag_family_member(const lag_model *model, const char *name, int k, char *part, size_t npart);
/* LAG_EINVAL, after a message: the parts of a family, which one may `use` ("set"); or that of these kinds of names the
 * model has no such one, and the nearest. */
int lag_no_such_name(lag_sim *s, const char *name, const char *use, const char *kinds);
/* The nearest of several names, while they are tried one by one; best: NULL where none is near. */
typedef struct lag_nearest {
  const char *name, *best;
  int least; /* distance of the best, or 0 */
} lag_nearest;
void lag_try_nearest(lag_nearest *near, const char *known);

/* For app/: the output grid that is saved with the run: row_origin, row_every, row_next. */
double *lag_sim_output_grid(lag_sim *sim);
