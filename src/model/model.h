/* Ast -> Model: names resolved, units converted, one scene and its effects applied.
 *
 * Needs a parsed Ast. Statements that the scene does not use are read for the names they declare only, and make no
 * graph node: a model with an effect off is the model with the effect's text deleted. All values of a Model are in
 * SI units. */
#pragma once

#include "base/spline.h"
#include "model/shapes.def"
#include "model/units.h"
#include "sym/expr.h"
#include "syntax/ast.h"

typedef struct {
  Name name;
  Span span;
  Unit unit;
  int periodic;
  SymId q, v, a; /* th, th', th'' */
} Coord;

typedef struct {
  Name name;
  Span span;
  Unit unit;
  SymId z, rate;
  Expr flow;      /* right-hand side of z' = ...; 0: none yet, and always 0 for a coordinate */
  Span flow_span; /* of z' = ... */
  int coordinate; /* declared by `coord`: see Model.first_order */
  int periodic;
} State;

typedef struct {
  Name name;   /* drag.c for parameter c of effect drag */
  Span span;
  Unit unit;
  AstSign sign;
  SymId sym;
  Expr value;  /* of pi and earlier parameters */
  Name stem;   /* name without index and component: drag.w for drag.w[2] */
  int fixed;   /* compiled in as a number (ModelChoice.fix) */
  int given;   /* the value is one of ModelChoice.given */
  Num number;  /* the value of a fixed parameter, from the scene */
  uint32_t place; /* index into the programs' parameter array: counts parameters that are not fixed */
} Param;

typedef struct {
  Name name;           /* wind.gust for input gust of effect wind */
  Span span;
  Unit unit;
  SymId sym;
  Expr value;          /* of t and parameters; 0 where there is a table */
  const Spline *table; /* or NULL */
  int order;           /* 1, 2: the first or second rate of the input before it; 0: one that the text declares */
  uint32_t rate;       /* index of the input that is its rate; 0: none is needed */
  const char *file;    /* path of the table as the text writes it */
  AstId text;          /* the formula; 0: a table */
  int holds;           /* the table jumps at each row */
  AstId integral;      /* the call `integral(a)`, whose table is that of another input, integrated; or 0 */
  Name effect;         /* scope of the formula's names */
} Input;

/* A force f along the displacement of `point`: adds f * d(point)/dq_i to each Q_i. */
typedef struct {
  Expr point, f;
  Span span;
} Force;

/* A friction with a static limit: a body at rest, velocity 0, is held by up to `ratio` times the force of a sliding
 * one. */
typedef struct {
  Expr velocity, ratio;
} Grip;

typedef struct {
  Name name; /* or NULL */
  Span span;
  AstId lhs_ast, rhs_ast;
  Expr lhs, rhs;
  Expr domain; /* condition under which both sides, as written, have real values; 0: wherever the nodes have */
  Name effect; /* the effect around the statement, or NULL */
  /* values of the nodes of the left and the right side, in the order of the text (as resolve_nodes); NULL: one of
   * several instances of its statement (family, vector) */
  const Expr *nodes[2];
} Expect;

typedef struct {
  SymId target; /* of kind SYM_COORD, SYM_VEL or SYM_STATE */
  Expr value;
} Action;

typedef struct {
  Name name;
  Span span;
  Expr g;
  AstDirection direction;
  VEC(Action) actions;
  int stop;
} Event;

/* Constraint c(q, t) = 0 (holonomic) or c(q, q', t) = 0 (velocities). A vector constraint is one Constraint per
 * component. */
typedef struct {
  Name name; /* "rod", "rod[2]", "grip.x" */
  Span span;
  Expr c;
  Dim dim;
  SymId multiplier;
  int inside; /* made by the compiler: unit length of a rotation */
} Constraint;

/* Unilateral contact, gap >= 0. While the gap is closed it is the constraint c = closed*gap. A constraint with
 * `while` is another: it is closed where `margin` is positive, and has neither gap nor restitution.
 *
 * A contact with friction is followed by its tangent, an entry of its own: the constraint closed*slip = 0 on the
 * velocity of slipping, which holds while the contact sticks, and the force of friction while it slips. */
typedef struct {
  Name name;
  Expr gap, restitution;         /* of a tangent: the velocity of slipping, and the tangential restitution or 0 */
  Expr margin;                   /* 0: a contact */
  /* input set by the runtime: 1 while the gap is closed, or the contact sticks, else 0 */
  SymId closed;
  uint32_t constraint;           /* index into Model.constraints */
  /* indices into Model.events; of a tangent: the slip ends; the force reaches its limit */
  uint32_t impact, release;
  int is_tangent;                /* of the contact before it */
  Expr friction, hold;           /* of a tangent: its coefficients while it slips, and while it sticks */
  /* of a tangent: the law of impact, as LAG_IMPACT_STRONGE of runtime/contacts/planar_impact.h and its neighbours */
  int law;
  /* of a tangent: input set by the runtime, the force of friction along the slip while the contact slips */
  SymId force;
  /* of a tangent of a guide: components of the force of the guide, linear in multipliers; parts 0: of a contact */
  Expr normal[3];
  uint32_t parts;
  uint32_t turn; /* of a guide whose force has one component: event where that changes its side */
  /* coordinates of the space in which a guide slips by its constraints alone; nspace 0: the text gives its slip */
  uint32_t space[3], nspace;
} Contact;

/* Origin of an output in the text: component `component` of the value of `id`; where `id` names a family, of its
 * member `member`. id 0: no expression of the text. */
typedef struct {
  AstId id;
  uint32_t component;
  int is_member;
  int64_t member[2];
} OutputText;

/* `action(x)` in an output. */
typedef struct {
  SymId sym;        /* stands for its value */
  SymId coordinate; /* x */
  Name name;
  Span span;
} ActionOutput;

/* A Poisson bracket {f, g} in an expectation or of the command line. */
typedef struct {
  SymId sym; /* placeholder in expressions, which symmetry/ replaces */
  Expr f, g; /* may contain brackets before this one */
  Span span;
} ExpressionBracket;

/* A canonical transformation from z = (q, p) to Z = (Q, P), claimed by its maps, by a generating function, or by
 * several of these. Of a model that gives its Lagrangian: the forward map alone, or a point transformation. */
typedef struct {
  Name name;
  Span span;
  const AstStmt *stmt;
  uint32_t n;              /* degrees of freedom */
  const SymId *old, *fresh; /* [2n] z and Z; old: coordinates alone where the model gives L */
  const Span *spans;       /* [2n] places that define Z, for messages */
  const Expr *forward;     /* [2n] Z(z, t); NULL: not given */
  const Expr *inverse;     /* [2n] z(Z, t); NULL: not given; of a point transformation [n] q(Q, t) */
  int is_point;            /* in a model that gives L */
  int kind;                /* F1(q, Q), F2(q, P), F3(p, Q), F4(p, P); 0: no generating function */
  Expr generator;
  Expr K;                  /* the new Hamiltonian, in Z and t, as claimed; 0: no claim */
  Span K_span;
  Expr domain;             /* of all that is given; 0: wherever the nodes have values */
} Canonical;

/* A coordinate and its momentum, by index into Model.states. */
typedef struct {
  uint32_t q, p;
} CanonicalPair;

/* A named quantity: an output column of a scene, or an observe statement. */
typedef struct {
  Name name;
  Span span;
  Unit unit;
  Expr value; /* may contain q'', z' */
  OutputText from;
} Output;

/* Component of a symmetry's generator: first derivative of the transformed coordinate (or t) by the group parameter,
 * at 0. */
typedef struct {
  SymId target; /* of kind SYM_COORD, SYM_STATE (a coordinate) or SYM_TIME */
  Expr rate;    /* in coordinates, t and parameters; 0: wrong, and reported */
  Span span, value; /* of the map, and of its right side */
} Move;

typedef struct {
  Name name;       /* wind.gust for the symmetry gust of effect wind */
  Name effect;     /* the effect around the statement, or NULL */
  const char *doc; /* or NULL */
  Span span;
  const AstStmt *stmt;
  SymId parameter, charge; /* group parameter; placeholder for the charge in outputs, which mech replaces */
  Unit unit;               /* of the charge */
  VEC(Move) moves;         /* coordinates without an entry are left unchanged */
  ExprMap moved;           /* target -> index into moves + 1 */
} Symmetry;

/* A size, of parameters alone unless it moves: at least 0, more than 0 where open, at most 1 where it is a part. */
typedef struct {
  Expr value;
  const char *what; /* "this friction has a size" */
  Span span;
  int open, part, moves;
  const char *mistake; /* message where it is negative; NULL: it acts against the velocity by itself */
} ModelSize;

typedef struct {
  SymId target;
  Expr value; /* of parameters */
  int implied; /* default value: constraints may move it */
  int guess;   /* constraints move it before those that are given */
} Start;

/* One formula for members of a family: value[k] is of the number `at` + k, in symbols of the indices, which are
 * lo[0] + row and lo[1] + turn. */
typedef struct {
  LoopRange range;
  Subscript at;
  uint32_t n;
  Expr value[4];
  SymId index[2];
  int64_t lo[2];
} FamilyValue;

/* Starts of many members of a family; starts of single members override them. */
typedef struct {
  SymKind kind; /* of the targets: SYM_COORD, SYM_VEL or SYM_STATE */
  FamilyValue of;
} FamilyStart;

/* Closed form (`exact q = ...`) of a coordinate, a velocity or a state. */
typedef struct {
  Name name;
  SymId target;
  Unit unit;
  int periodic;
  Expr value; /* of t, parameters and inputs; a coordinate in it means its start value */
  SymId sym;  /* placeholder in outputs: kind SYM_INPUT, numbered after the model's inputs */
} Exact;

/* A name that was declared without a unit, and the unit inferred for it. */
typedef struct {
  Name name;
  const char *unit;
} FoundUnit;

typedef struct {
  Name name;
  double value;
  Name text; /* value of an option like quadrature = trapezoid; NULL: the number `value` */
} Option;

typedef struct {
  Name name;
  int output; /* index into outputs; -1: the energy; -2 - k: the charge of symmetry k */
  double limit;
  int absolute; /* 1: limit on the size of the output; 0: on its change */
} Monitor;

/* A number that one keeps of a run. */
typedef struct {
  Name name;
  const char *text; /* words in the notation of runtime/analysis/measure.h, */
  Unit unit;        /* and the unit of the value; */
  int alone;        /* 1: a quantity alone, in its own unit */
} Measure;

typedef VEC(Measure) Measures;

#define SHAPE_ENUM_(NAME, ...) SHAPE_##NAME,
typedef enum { SHAPES(SHAPE_ENUM_) } ShapeKind;
#undef SHAPE_ENUM_

/* A shape of a drawing, as lag_shape of lag_model.h; its numbers are indices of the scene's outputs, -1: none. */
typedef struct {
  ShapeKind kind;
  const char *role, *text;
  int a[3], b[3], size[3], turn[4], count;
} Shape;

const char *shape_word(ShapeKind kind);

typedef struct {
  Name name;
  Span span; /* of its name; empty: the file has no scene */
  const char *doc;
  VEC(Start) starts;
  VEC(FamilyStart) family_starts; /* before them, in order */
  Span exactly; /* the first `start exactly`; empty: none */
  double t0, t1;
  const char *t1_digits; /* t1 as decimal digits beyond double precision (base/num.h), or NULL */
  int has_span;
  Name method; /* or NULL */
  Span method_span;
  VEC(Option) options;
  double tolerance; /* relative error of a step; 0: not given */
  VEC(Output) outputs;
  double every;
  VEC(Monitor) monitors;
  Measures measures;
  VEC(Exact) exacts;
  VEC(Shape) shapes;
  uint32_t ndrawn; /* the last outputs, which only the drawing has */
  int guessed;     /* the text has no `draw` */
} Scene;

/* A read of a family's text: a coordinate (and its rate), or a parameter; its index, by row and turn. */
typedef struct {
  SymId symbol;
  Subscript at;
} FamilyRead;

/* Contacts with one text for all members, in the symbols of one of them, in rows i = i0 + row and turns j = j0 + turn;
 * name_j NULL: one index. cut 0: all are looked at, else those whose places, by component, may be as near. */
typedef struct {
  Name name, name_i, name_j;
  Span span;
  const struct AstStmt *stmt;
  Name effect;
  LoopRange range;
  int64_t i0, j0;
  VEC(FamilyRead) coords, params;
  Expr gap, restitution, friction, tangential, hold, slip[2]; /* hold: static friction */
  uint32_t tangents;
  Expr cut, side[3];
  Subscript place[3]; /* coordinates of the member of a turn */
  uint32_t nplaces;
} ContactFamily;
/* Values of a member before its slips: gap, rate, restitution, friction, tangential restitution, static friction. */
enum { FAMILY_VALUES = 6 };

/* A sum, or a part of its range lo .. hi, that is not written out. beside: its outer terms have more than the inner
 * sum; sampled: the self-check takes a sample of its turns; family: the index of members lo .. hi whose sum it is. */
typedef struct {
  AstId outer;
  int beside, sampled;
  int64_t lo, hi;
  Name family;
} QuantifiedSum;

typedef struct {
  const Ast *ast;
  Diags *diags;
  Arena *arena;
  ExprGraph *g;
  Dims *dims;
  Name name;
  const char *doc;
  Span span;       /* of the model's name */
  VEC(Name) effects;     /* in use, in order of declaration */
  VEC(Name) all_effects;
  SymId time, pi;
  VEC(Coord) coords;
  VEC(State) states;
  /* L is linear in all velocities: coordinates are held in `states`, velocities are their rates */
  int first_order;
  int hamiltonian;         /* the text gives H and not L: L = sum p q' - H, of first order */
  VEC(CanonicalPair) pairs; /* of such a model */
  VEC(Param) params;
  uint32_t nfixed;         /* number of parameters with `fixed` set */
  VEC(Input) inputs;
  Expr kinetic, potential; /* 0 when L was given as a whole */
  Expr lagrangian;         /* 0 when the text declares no coordinates */
  /* kinetic term in q.q' of each rotation, 0 on its constraint, which makes M regular; 0: none */
  Expr regularising;
  Span lagrangian_span;
  Span dissipation_span;
  Span kinetic_span;       /* empty when L was given as a whole */
  Expr dissipation;        /* sum of Rayleigh functions, or 0 */
  Expr domain;             /* where L, forces, flows and constraints have real values: see Expect.domain */
  VEC(Force) forces;
  VEC(Grip) grips;
  VEC(Constraint) constraints;
  VEC(Contact) contacts;
  VEC(ContactFamily) families;
  VEC(ModelSize) sizes; /* of friction and contacts */
  VEC(Symmetry) symmetries;
  VEC(Expect) expects;
  VEC(Canonical) canonicals;
  VEC(ExpressionBracket) brackets;
  VEC(ActionOutput) actions;
  Expr asked_bracket;      /* ModelChoice.bracket */
  VEC(Event) events;
  VEC(Output) observes;
  Scene scene;
  VEC(FoundUnit) found;    /* inferred units of names declared without one */
  VEC(QuantifiedSum) sums;
  double times; /* as in ModelChoice; 1 where that is 0 */
  ExprMap written; /* nodes that may jump (comparisons, sign, tan, atan2) -> AstId where the text writes them */
  Measures asked_measures; /* of the command line */
  int measured_outputs;    /* 1: they added outputs to the scene's */
  SymId energy_sym; /* placeholder for the energy p q' - L in outputs and expects, which mech replaces */
  Unit energy_unit;
  const struct Declarations *declared; /* names and definitions of the text (declarations.h), for the self-check */
} Model;

/* Name of built-in function i; NULL past the end. */
const char *function_name(size_t i);
/* Index of a built-in function; -1: none, or one that functions.def defines by a text, before which names of a model
 * go. */
int function_index(const char *name);

/* Names of the file's scenes, in order; "default" alone when there is none. */
typedef struct {
  const Name *at;
  uint32_t n;
} SceneList, EffectList, CoordList;
SceneList model_scenes(const Ast *ast);

/* Makes what all models of the file share; building the first makes it, too. */
void model_prepare(Ast *ast);

/* 1 if the file has this scene; 0, reported with the nearest name, if not. */
int model_has_scene(Ast *ast, const char *scene);

/* Names of the effects that no scene uses. */
EffectList model_unused_effects(const Ast *ast);

/* Warns of parameters, lets, inputs and functions of the model's main file that no expression uses. */
void model_warn_unused(Ast *ast);

/* Names of the effects that contain an expectation or a symmetry; the first is NULL if the model itself contains
 * one. */
EffectList model_claiming_effects(const Ast *ast);

/* An additional output from the command line, and the name of its column. */
typedef struct {
  AstId expr;
  Name name;
} CommandOutput;

/* A parameter, an input, or a start (of a coordinate, a velocity, a state; of omega(R)), and its value from the
 * command line: a formula; of an input also the name of a table. */
typedef struct {
  AstId what, value;
} CommandInput;

/* The surface of a Poincare section: an event without actions. */
typedef struct {
  AstId expr; /* its zero set; 0: no section */
  AstDirection direction;
  Name name;
} Section;

/* A value `name=value` of the command line for a simulator, and what it is in the declared unit of its name. */
typedef struct {
  AstId target, value; /* target 0: a time */
  int follows;         /* 1: of a family of motions: the target may be `energy`, a charge or `period`, too */
  double number;
  const char *digits;  /* as in base/num.h, or NULL */
} CommandValue;

/* A constant given by -D NAME=VALUE. */
typedef struct {
  const char *name, *value;
  AstId expr; /* the value; 0: not parsed yet, or a mistake */
} Define;

/* Arguments of model_build: scene, effects, and definitions from the command line. */
enum { SUMS_FROM = 2000 };

typedef struct {
  const char *scene; /* NULL: the first */
  Name also;         /* an effect to turn on besides the scene's, with its required effects; or NULL */
  int bare;          /* build without a scene: no effect but `also` (and its requirements) is on */
  /* the set of effects in use, instead of the scene's (a variant): values for other effects, outputs, monitors and
   * closed forms of the scene are dropped. NULL: the scene's effects */
  const EffectList *only;
  const Define *defines;
  uint32_t ndefines;
  const CommandOutput *asked; /* outputs besides the scene's own */
  uint32_t nextra_outputs;
  enum { DRAWING_NONE, DRAWING_WANTED, DRAWING_CHECKED } drawing; /* of Scene.shapes */
  const CommandOutput *measures; /* measures besides the scene's own */
  uint32_t nmeasures;
  const CommandInput *given; /* values that override the scene's */
  uint32_t ngiven;
  /* model_build evaluates them; an error is reported when a run cannot set a target, or a value does not fit it */
  CommandValue *values;
  uint32_t nvalues;
  AstId bracket;   /* an expression with brackets, to print; or 0 */
  Section section;
  const char *fix; /* parameters to compile in as numbers, with the scene's values: "g,drag.c", "all"; NULL: none */
  /* the point transformation (Canonical.is_point) in whose new coordinates the model is built; or NULL */
  Name coordinates;
  int domains;     /* Model.domain is wanted; without a scene it always is */
  double times; /* size of families asked for, as a multiple of the model's; 0: 1. What is long is judged there */
  int64_t more; /* and less the model's */
  uint32_t sums_from; /* sums over at least so many pairs are not written out; 0: the usual number */
  int unfixed;     /* set by callers that ignore the command line's --fix */
} ModelChoice;

/* Reason against coordinates and momenta as in brackets, with a way out; or NULL. */
const char *reason_against_brackets(const Model *m);

/* start_values.c: the symbol of component k of the member of row i and turn j. */
SymId model_start_target(const Model *m, const FamilyStart *f, int64_t i, int64_t j, uint32_t k);

/* start_values.c: sets the symbols of all starts; parameters are set. */
void model_eval_starts(const Model *m, long double *symbols);

/* Names of all coordinates, in order of declaration, whether L is of first order or not. */
CoordList model_coordinates(const Model *m);

/* Reason why a model of first order has no accelerations, for messages. */
static inline const char *no_inertia(const Model *m) {
  return m->hamiltonian ? "the model gives its Hamiltonian" : "L is linear in the velocities";
}

/* printed_text.c: value of an operator other than a call, whose operands have the values a and b; 0: one of them has
 * none. */
Expr operation_value(ExprGraph *g, const AstExpr *x, Expr a, Expr b);

/* The measure with its unit, as the runtime reads it. */
const char *measure_words(Arena *a, const Measure *m);

/* Builds the model; NULL after errors, all of which are in ast->diags. Memory is ast->arena's. */
Model *model_build(Ast *ast, const ModelChoice *choice);

/* Source text of a span on one line, without comments, its middle left out where it is long. */
const char *short_text(const Ast *ast, Span s);

/* The first constraint with `while`, or NULL. */
static inline Name model_conditional(const Model *m) {
  for (uint32_t i = 0; i < m->contacts.n; i++)
    if (m->contacts.at[i].margin) return m->contacts.at[i].name;
  return NULL;
}

/* Seeds of a derivative along the motion, by expr_tangent: t, and the inputs that have a rate. */
void model_seed_time(const Model *m, Expr *seed);

/* Whether a symbol is an input of a contact, which only the runtime sets. */
static inline int model_is_contact_switch(const Model *m, SymId sym) {
  for (uint32_t i = 0; i < m->contacts.n; i++)
    if (m->contacts.at[i].closed == sym || m->contacts.at[i].force == sym) return 1;
  return 0;
}

/* Whether a coordinate is declared periodic. */
static inline int model_is_periodic(const Model *m, SymId coordinate) {
  const Symbol *q = expr_symbol(m->g, coordinate);
  return q->kind == SYM_COORD ? m->coords.at[q->index].periodic : m->states.at[q->index].periodic;
}

/* Inputs that only the runtime sets: one for each contact, two for a tangent. */
static inline uint32_t model_contact_inputs(const Model *m) {
  uint32_t n = m->contacts.n;
  for (uint32_t i = 0; i < m->contacts.n; i++) n += (uint32_t)m->contacts.at[i].is_tangent;
  return n;
}

/* Values by symbol: pi, and 0 for all others. */
long double *model_constants(const Model *m);
