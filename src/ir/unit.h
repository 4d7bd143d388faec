/* IrUnit: what is emitted together: the programs of one set of effects, and the scenes that share
 * them. It carries its own names and units: emit never meets a Model. */
#ifndef LAGC_IR_UNIT_H
#define LAGC_IR_UNIT_H

#include "ir/series.h"

typedef struct {
  const char *name, *unit; /* as the user wrote them */
  double factor;
  int periodic, sign;
  double offset;
  Num ratio;    /* the factor exactly, where ratio is: ratio*pi^pi_power */
  int pi_power;
} IrVar;

typedef struct {
  const char *name;
  int direction;
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

/* A component of [q|v] that constraints move at the start, and where to. */
typedef struct {
  uint32_t component;
  double value;
} IrMove;

typedef struct {
  const char *name, *doc;
  const Prog *const *params; /* [np] */
  const Prog *start, *observe;
  VEC(IrMove) moves;  /* found with the scene's parameters; for programs that do not look for themselves */
  double t0, t1;
  const char *t1_digits; /* more than a double has, or NULL */
  int has_span;
  int exactly;        /* constraints may not move what the start gives */
  VEC(uint32_t) implied; /* coordinates of rotations of which the start says nothing */
  const char *method; /* or NULL */
  VEC(IrOption) options;
  double tolerance, every;
  VEC(IrVar) outputs;
  VEC(unsigned char) forces;    /* by output, of models with constraints: whether it contains multipliers or accelerations */
  const Prog *observe_plain; /* the same without closed forms, for programs that know of no start; */
  VEC(IrVar) plain;          /* and what that leaves */
  const Prog *exact;
  VEC(uint32_t) exact_of;    /* component of [q|v|z] */
  VEC(IrMonitor) monitors;
} IrScene;

/* Place of an entry of a sparse matrix. */
typedef struct {
  uint32_t row, col;
} IrEntry;

/* An entry of the derivatives of events: as in mech/eqns.h. */
typedef struct {
  uint32_t event;
  int row;
  uint32_t col;
} IrJump;

/* What only some methods of integration need, and is not made for the others. */
enum { WANT_VARIATION = 1, WANT_TAYLOR = 2, WANT_LINEAR = 4 };

/* An entry of the second derivatives: part as in mech/variation.h. */
typedef struct {
  int part;
  uint32_t row, col;
} IrSecond;

typedef struct {
  const char *name, *unit;
  uint32_t line;
} IrConstraint;

/* The holonomic ones first, then those that keep a function of positions; the programs are those of lower.h. */
typedef struct {
  VEC(IrConstraint) of;
  uint32_t nholonomic, nkept;
  VEC(IrEntry) jacobian, mass;
  const Prog *residuals, *matrices, *position, *velocity;
} IrConstraints;

/* Places: of the input that says whether it is closed, in the constraints, of its events. */
typedef struct {
  uint32_t input, constraint, impact, release;
} IrContact;

/* A switching function of mech/switching_surfaces.h. */
typedef struct {
  const char *surface, *text;
  uint32_t line;
  int nonnegative;
} IrSwitch;

/* flags: 1 it is conserved, 2 its balance is known, 4 while inputs follow their formulas. */
typedef struct {
  const char *name, *unit;
  unsigned flags;
} IrCharge;

typedef struct {
  Arena *arena;
  const char *name, *doc, *source, *effects, *all_effects;
  const char *fixed;        /* names of parameters that are numbers here, with spaces between them; "": none */
  const char *fixed_values; /* "g = 9.81, drag.c = 0.2", in SI */
  unsigned flags;
  VEC(IrVar) q, z, p, u;
  VEC(IrEvent) events;
  const Prog *accel, *energy, *event_values, *inputs;
  const Prog *derived;          /* parameters p.n ... p.n + nderived - 1 of the programs, from the others; NULL and 0 before unit_hoist, and where there are none */
  uint32_t nderived;
  VEC(IrCharge) charges;        /* the energy first; none where there is nothing to say of them but that it is conserved */
  const Prog *charge_values, *charge_powers; /* NULL: there is only the energy; all are conserved */
  VEC(IrSwitch) switches;
  const Prog *switch_values;    /* NULL: there are none */
  IrConstraints constraints;
  VEC(IrContact) contacts;
  unsigned wants;
  const Prog *variation, *second; /* NULL unless WANT_VARIATION */
  VEC(IrSecond) second_at;        /* what the values of `second` are */
  const Series *taylor;         /* NULL unless WANT_TAYLOR, and where a value is not analytic */
  const Prog *linear;           /* NULL: not asked for */
  VEC(IrEntry) linear_dr, linear_mass; /* what its outputs 0 and 1 are */
  const Prog *jumps;            /* NULL: not asked for, or no event changes the state */
  VEC(IrJump) jump_at;          /* what its outputs are */
  VEC(IrScene) scenes;
  int libm;                     /* emitted code calls the C library's sin and cos */
  int lines;                    /* constraints and switches say in what line they stand: of simulators, which name their file */
} IrUnit;

#endif
