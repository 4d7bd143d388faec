/* ProgramSet: a unit of emission: the programs of one set of effects, and the scenes that share
 * them. It carries its own names and units: emit never meets a Model. */
#pragma once

#include "ir/prog.h"

/* Bit numbers of flags: UNIT_CONSERVES_ENERGY, ..., CHARGE_CONSERVED, ... */
enum {
#define MODEL_FLAG(name) UNIT_##name,
#include "ir/flags.def"
#undef MODEL_FLAG
  UNIT_FLAGS
};
enum {
#define CHARGE_FLAG(name) CHARGE_##name,
#include "ir/flags.def"
#undef CHARGE_FLAG
  CHARGE_FLAGS
};

typedef struct {
  const char *text; /* as the user wrote it */
  double factor, offset;
  Num ratio;    /* the factor is ratio*pi^pi_power, exact where ratio is exact */
  int pi_power;
  const char *si;       /* name of the SI unit, "N*m"; "" for pure numbers */
  signed char base[7];  /* its powers of m, kg, s, A, K, mol, cd; all 0 where one is no integer */
} IrUnit;

typedef struct {
  const char *name;
  const IrUnit *unit; /* variables of one unit share it */
  int periodic, sign;
} IrVar;

enum { EVENT_KICK = 2 }; /* LAG_KICK of lag_model.h: an event at equal times, whose function is the period */

typedef struct {
  const char *name;
  int direction; /* 1 rising, -1 falling, 0 both, EVENT_KICK */
  const Prog *action;
  int stop;
} IrEvent;

typedef struct {
  const char *name, *text;
  double value;
} IrOption;

typedef struct {
  const char *name;
  int output;
  double limit;
  int absolute;
} IrMonitor;

typedef struct {
  const char *name, *text;
} IrMeasure;

/* An output `action(x)`, which a run computes on the curve H(q, p) = E; q, p: components of [q|v|z], q of x, and of
 * the momenta in their places. */
typedef struct {
  const char *name;  /* x */
  const Prog *curve; /* H, dH/dp, d2H/dp2, dH/dq; where the model gives L with momenta in the place of velocities */
  uint32_t q, p;
  int periodic;
} IrAction;

/* A component of [q|v] that constraints move at the start, and its new value. */
typedef struct {
  uint32_t component;
  double value;
} IrMove;

/* A shape of the scene's drawing: lag_shape of lag_model.h. */
typedef struct {
  const char *kind, *role, *text;
  int a[3], b[3], size[3], turn[4], count;
} IrShape;

/* Values of parameters first ... first + n - 1, none of which reads another of them. out 0: p */
typedef struct {
  uint32_t first, n;
  const Prog *values;
} IrParams;

typedef struct {
  const char *name, *doc;
  VEC(IrParams) params; /* all parameters, in order */
  const Prog *start, *observe;
  VEC(IrMove) moves;  /* found with the scene's parameters; for emitted programs that do no such search */
  double t0, t1;
  const char *t1_digits; /* decimal text where a double has too few digits, or NULL */
  int has_span;
  int exactly;        /* constraints may not move the given start values */
  VEC(uint32_t) implied; /* components with a guess, and quaternion coordinates without a given start value */
  const char *method; /* or NULL */
  VEC(IrOption) options;
  double tolerance, every;
  VEC(IrVar) outputs;
  /* by output, in models with constraints: whether it contains multipliers or accelerations */
  VEC(unsigned char) forces;
  const Prog *observe_plain; /* outputs without closed forms and actions, for programs that know no start, */
  VEC(IrVar) plain;          /* and their descriptions */
  const Prog *observe_held;  /* the same with modes, as held_accel; NULL: no motion sticks */
  const Prog *exact;
  VEC(uint32_t) exact_of;    /* component of [q|v|z] that each closed form describes */
  VEC(IrAction) actions;     /* their values stand behind closed forms */
  const Prog *momenta;       /* dL/dq'[nq], for actions; NULL: there are none, or momenta are states */
  VEC(IrMonitor) monitors;
  VEC(IrMeasure) measures;
  VEC(IrShape) shapes;
  uint32_t ndrawn;           /* the last outputs, which only shapes have */
} IrScene;

/* Position of an entry of a sparse matrix. */
typedef struct {
  uint32_t row, col;
} IrEntry;

/* Position of an entry of the derivatives of events: see Jump in mech/eqns.h. */
typedef struct {
  uint32_t event;
  int row;
  uint32_t col;
} IrJump;

/* Programs that only some methods of integration, or headers, need; made on request. */
enum {
  WANT_VARIATION = 1,
  WANT_TAYLOR = 2,
  WANT_LINEAR = 4,
  WANT_MASS = 8,
  WANT_INVERSE = 16,
  WANT_BY_INPUTS = 32,
  WANT_BY_PARAMS = 64,
  WANT_MULTIPLIERS = 128,
  WANT_OUTPUTS = 256,
  WANT_CONSTRAINED = 512 /* derivatives also of models with constraints, which simulators take by differences */,
  WANT_HELD = 1024,
  WANT_ADJOINT = 2048,
  WANT_SENSITIVITY = 4 | 32 | 64 /* what a tangent by parameters needs */
};

/* Position of a second derivative of L or of a force; part: SECOND_... of mech/lagrangian_hessian.h. */
typedef struct {
  int part;
  uint32_t row, col;
} IrSecond;

typedef struct {
  const char *name, *unit;
  uint32_t line;
} IrConstraint;

/* Holonomic constraints first; the first nkept keep a function of positions (residuals c and r, see lower.h). */
typedef struct {
  VEC(IrConstraint) of;
  uint32_t nholonomic, nkept;
  VEC(IrEntry) jacobian, mass;
  const Prog *residuals, *matrices, *position, *velocity;
} IrConstraints;

/* Indices: of the input that says whether the contact is closed, of its constraint, of its two events; of a tangent:
 * of the input of its force. conditional: a constraint with `while`; of a tangent, law: of impact. */
typedef struct {
  uint32_t input, constraint, impact, release, force;
  int is_tangent, conditional, law;
  uint32_t parts, turn; /* of a tangent of a guide: components of its force; of one: the event where it turns */
} IrContact;

/* A size, at least 0; open: more than 0; part: at most 1. */
typedef struct {
  const char *what, *text; /* "this friction has a size", "mu*m*g" */
  int open, part;
} IrSize;

/* A switching function of mech/switches.h. */
typedef struct {
  const char *surface, *text;
  uint32_t line;
  int jumps, is_floor, is_timed, nonnegative;
} IrSwitch;

/* Modes from here on are not held: the state decides. As LAG_FREE in lag_model.h. */
#define HELD_MOST 1e30

/* flags: bits CHARGE_CONSERVED, CHARGE_BALANCED (its balance is known), CHARGE_BY_FORMULAS (only while inputs follow
 * their formulas), CHARGE_JUMPS. */
typedef struct {
  const char *name, *unit;
  unsigned flags;
} IrCharge;

/* Recurrences of Taylor coefficients (series/series.h makes them). Columns of the coefficients x[k][...]: q, v, z,
 * then q'' and z', then t. */
typedef struct {
  const Prog *first;     /* order 0. out 0: x[0], its q'' and z'; out 1: c, the constants that `next` reads */
  /* order k. Reads x[k] of q, v, z, t, the sums s, and c. out 0: x[k], its q'' and z'; out 1: x[k+1], its q, v and
   * z; out 2, 3: a[k], b[k] (no b[k] of squares) */
  const Prog *next;
  uint32_t nq, nz;
  uint32_t columns;      /* of x, a multiple of 4 */
  uint32_t sums;         /* pairs a != b, with a column of a, b and s each */
  uint32_t squares;      /* pairs a = b, with a column of a and s each, behind the others; 0: few, counted as sums */
  uint32_t group;        /* columns in a group; the last group of sums, and of squares, is padded */
  uint32_t first_square, width; /* column where squares begin; number of columns */
  uint32_t constants;    /* length of c */
  uint32_t room;         /* work space of systems that a loop solves, in reals */
  int uses_time;
} Series;

/* A number that the text of a family reads; by row and turn, its index among coordinates or parameters. */
typedef struct {
  int64_t first, by_row, by_turn;
} IrRead;

/* Contacts with one text for all members: lag_contact_family of lag_model.h. */
typedef struct {
  const char *name;
  uint32_t indices;
  int64_t i0, j0, rows, skew, turns, more;
  VEC(IrRead) coords, params;
  uint32_t tangents;
  const Prog *values; /* reads q, v by coords, z by params */
  const Prog *reach;  /* cut and sides, of parameters; NULL: all members are looked at */
  IrRead place[3];
  uint32_t nplaces;
} IrContactFamily;

typedef struct {
  Arena *arena;
  const char *name, *doc, *source, *effects, *all_effects;
  const char *fixed;        /* names of parameters that are numbers here, separated by spaces; "": none */
  const char *fixed_values; /* "g = 9.81, drag.c = 0.2", in SI */
  unsigned flags;
  VEC(IrVar) q, z, p, u;
  VEC(IrEvent) events;
  const Prog *accel, *energy, *event_values, *inputs;
  VEC(IrSize) sizes;
  const Prog *size_values, *moving_sizes; /* of the first sizes, of parameters alone, and of the others; NULL: none */
  uint32_t nmoving;
  /* computes parameters p.n ... p.n + nderived - 1 from the others; NULL, 0: none, or before unit_hoist */
  const Prog *derived;
  uint32_t nderived;
  VEC(IrCharge) charges;        /* the energy first; empty where the energy is the only one, conserved, without unit */
  const Prog *charge_values, *charge_powers; /* NULL: the energy is the only charge; all charges are conserved */
  int dry_friction;             /* charge_powers has its power, too, behind those of the charges */
  VEC(IrSwitch) switches;
  uint32_t nmodes;              /* switches that a run holds; their modes are inputs behind those of the model */
  /* NULL: no switches; none that is held; no static limits; no contact with friction */
  const Prog *switch_values, *switch_rates, *switch_grips, *contact_laws, *guide_loads;
  const Prog *held_accel; /* of headers: accel with modes; NULL: no motion sticks */
  /* of headers: friction and tangential restitution of each contact; NULL: none has friction */
  const Prog *contact_coefficients;
  IrConstraints constraints;
  VEC(IrContact) contacts;
  VEC(IrContactFamily) families;
  VEC(IrEntry) family_mass;
  const Prog *family_inertia;   /* out 0: entries of M at family_mass; NULL: there are no families */
  const Prog *impact;           /* Newton's law of impact of one contact, see lower_impact; NULL: no contact strikes */
  unsigned wants;
  const Prog *variation, *second; /* NULL unless WANT_VARIATION */
  VEC(IrSecond) second_at;        /* positions of the outputs of `second` */
  const Prog *kepler;             /* out 0: masses, couplings (mech/kepler_part.h); NULL: L has no Kepler part */
  uint32_t kepler_bodies;
  int kepler_fixed;
  VEC(uint32_t) kepler_at;        /* coordinates, body by body */
  /* NULL unless WANT_TAYLOR, and where the model has no series: not analytic, constraints, tables */
  const Series *taylor;
  const Prog *linear;           /* NULL: not requested */
  VEC(IrEntry) linear_dr, linear_mass; /* positions of its outputs 0 and 1; output 2: constraints.jacobian */
  /* of headers; NULL: not requested */
  const Prog *mass, *bias, *inverse, *multipliers, *by_inputs, *by_params, *outputs;
  VEC(IrEntry) by_inputs_dr, by_params_dr; /* as linear_dr */
  /* of the derivatives of outputs, formulas of parameters and inputs: columns q, v, z, inputs, q'', z', parameters */
  VEC(IrEntry) outputs_at;
  const Prog *adjoint;          /* NULL: not requested */
  const Prog *adjoint_rates, *adjoint_projection; /* beside it where there are constraints */
  VEC(IrEntry) formulas_at;     /* positions of its output 2: input, parameter */
  const Prog *jumps;            /* NULL: not requested, or no event changes the state */
  VEC(IrJump) jump_at;          /* positions of its outputs */
  VEC(IrScene) scenes;
  double times;                 /* size asked for, as a multiple of the one that this is made for */
  int libm;                     /* emitted code calls the C library's sin and cos */
  int lanes;                    /* emitted to be compiled for lanes, too, and for a double with the same bits */
  /* messages on constraints and switches give their source lines: simulators name their file */
  int lines;
} ProgramSet;

/* Number of guides with friction; of contacts and their tangents. */
uint32_t program_set_guides(const ProgramSet *u);
uint32_t program_set_contacts(const ProgramSet *u);

typedef VEC(const Prog *) ProgList;

/* All programs of a unit and its scenes; those that it does not have are left out. */
ProgList program_set_programs(const ProgramSet *u);

/* NULL, or what is wrong with one of its programs: an internal error. */
const char *program_set_verify(const ProgramSet *u);
/* The name of the first kick; NULL: the unit has none. */
const char *program_set_kick(const ProgramSet *u);
/* The contact that strikes at event i, by u->impact; NULL: none. A constraint with `while`, and a tangent, have no
 * law of impact of their own. */
const IrContact *program_set_striking_contact(const ProgramSet *u, uint32_t i);

/* Values of a scene: parameters p[np] (NaN where a formula has none), the start y[2*nq + nz] on the constraints,
 * inputs in[nu] at its time. */
void scene_values(const ProgramSet *u, const IrScene *s, long double *p, long double *y, long double *in);

/* hoist.c: moves values that depend on parameters alone from the programs that a step calls to u->derived, and
 * leaves loads of parameters u->p.n, u->p.n + 1, ... in their place; a constant mass matrix that is eliminated in
 * straight-line code is factored then, too. Only for emitted models, whose callers compute derived parameters; call
 * once, after all programs are made. Checks of pivots stay where they are. */
void unit_hoist(ProgramSet *u);
