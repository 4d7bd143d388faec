/* Ast -> Model: names resolved, units converted, one scene and its effects applied.
 *
 * Needs a parsed Ast. What the scene does not use is not looked at beyond the names it declares, and
 * makes no graph node: a model with an effect off is the model with the effect's text deleted.
 * Everything in a Model is in SI. */
#ifndef LAGC_MODEL_H
#define LAGC_MODEL_H

#include "base/define.h"
#include "base/spline.h"
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
  Expr flow;      /* 0 until a flow statement gives it; of a coordinate always */
  int coordinate; /* the text declares it as one: see Model.first_order */
  int periodic;
} State;

typedef struct {
  Name name;   /* drag.c for parameter c of effect drag */
  Span span;
  Unit unit;
  AstSign sign;
  SymId sym;
  Expr value;  /* of pi and earlier parameters */
  Name stem;   /* of a member of a family: drag.w */
  int fixed;   /* ModelChoice.fix: a number in programs, with the value that the scene gives it, */
  Num number;  /* this one */
  uint32_t place; /* in programs, among those that are not fixed */
} Param;

typedef struct {
  Name name;           /* wind.gust for input gust of effect wind */
  Span span;
  Unit unit;
  SymId sym;
  Expr value;          /* of t and parameters; 0 where there is a table */
  const Spline *table; /* or NULL */
  const char *file;    /* that the table was read from, as written */
  AstId text;          /* of the formula, which stands in `effect`; 0: there is none */
  Name effect;
} Input;

/* A force f along the displacement of `point`: adds f * d(point)/dq_i to each Q_i. */
typedef struct {
  Expr point, f;
  Span span;
} Force;

typedef struct {
  Name name; /* or NULL */
  Span span;
  AstId lhs_ast, rhs_ast;
  Expr lhs, rhs;
  Expr domain; /* where both sides have real values, as the text is written; 0: wherever the nodes have */
  Name effect; /* that it stands in, or NULL */
  int elsewhere; /* one of several that the text stands for: model_reresolve cannot tell which */
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

/* c = 0, made of coordinates and t, or of velocities, too. A constraint of vectors is one for each component. */
typedef struct {
  Name name; /* "rod", "rod[2]", "grip.x" */
  Span span;
  Expr c;
  Dim dim;
  SymId multiplier;
  int inside; /* it belongs to a rotation: nobody wrote it */
} Constraint;

/* A gap that cannot become negative. While it is closed it is a constraint: c = closed*gap. */
typedef struct {
  Name name;
  Expr gap, restitution;
  SymId closed;                  /* an input of the model's own: 1 while the gap is closed, else 0 */
  uint32_t constraint;           /* in constraints, */
  uint32_t impact, release;      /* in events */
} Contact;

/* The place of an output in the text: a component of the value of `id`, or of its member `member`, where that names a family. id: 0: of something else. */
typedef struct {
  AstId id;
  uint32_t component;
  int is_member;
  int64_t member[2];
} OutputText;

/* A named quantity: what a scene puts out, or an observe statement. */
typedef struct {
  Name name;
  Span span;
  Unit unit;
  Expr value; /* may contain q'', z' */
  OutputText from;
} Output;

/* What a symmetry does to a coordinate, or to t, to first order in its parameter. */
typedef struct {
  SymId target; /* of kind SYM_COORD, SYM_STATE (a coordinate) or SYM_TIME */
  Expr rate;    /* in coordinates, t and parameters */
  Span span;
} Move;

typedef struct {
  Name name;       /* wind.gust for the symmetry gust of effect wind */
  Name effect;     /* that it stands in, or NULL */
  const char *doc; /* or NULL */
  Span span;
  const AstStmt *stmt;
  SymId parameter, charge; /* its charge stands so in outputs, until mech knows it */
  Unit unit;               /* of the charge */
  VEC(Move) moves;         /* coordinates that it does not name stay */
} Symmetry;

typedef struct {
  SymId target;
  Expr value; /* of parameters */
  int implied; /* nobody said it: constraints may move it */
} Start;

/* What a coordinate, a velocity or a state should be. */
typedef struct {
  Name name;
  SymId target;
  Unit unit;
  int periodic;
  Expr value; /* of t, parameters and inputs; a coordinate in it is that at the start */
  SymId sym;  /* stands for it in outputs: of kind SYM_INPUT, behind the model's inputs */
} Exact;

/* A name that was declared without a unit, and the one that it has. */
typedef struct {
  Name name;
  const char *unit;
} FoundUnit;

typedef struct {
  Name name;
  double value;
  Name text; /* of an option like quadrature = trapezoid, or NULL */
} Option;

typedef struct {
  Name name;
  int output; /* index into outputs; -1: the energy; -2 - k: the charge of symmetry k */
  double limit;
  int absolute; /* the limit is one of size, not of change */
} Monitor;

typedef struct {
  Name name;
  const char *doc;
  VEC(Start) starts;
  Span exactly; /* of the first `start exactly` */
  double t0, t1;
  const char *t1_digits; /* more than a double has, or NULL */
  int has_span;
  Name method; /* or NULL */
  Span method_span;
  VEC(Option) options;
  double tolerance; /* 0: not given */
  VEC(Output) outputs;
  double every;
  VEC(Monitor) monitors;
  VEC(Exact) exacts;
} Scene;

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
  int first_order;         /* L is linear in all velocities: there are no coords, coordinates are states, velocities their rates */
  VEC(Param) params;
  uint32_t nfixed;         /* how many of them are numbers */
  VEC(Input) inputs;
  Expr kinetic, potential; /* 0 when L was given as a whole */
  Expr lagrangian;         /* 0 when the text declares no coordinates */
  Expr across;             /* or 0: quadratic in rates that rotations never have, added to L for a regular mass matrix */
  int lends;               /* constraints lend inertia to what has none: discrete Lagrangians need it, see mech/lend.h */
  Span lagrangian_span;
  Span dissipation_span;
  Span kinetic_span;       /* empty when L was given as a whole */
  Expr dissipation;        /* sum of Rayleigh functions, or 0 */
  Expr domain;             /* where L, forces, flows and constraints have real values: see Expect.domain */
  VEC(Force) forces;
  VEC(Constraint) constraints;
  VEC(Contact) contacts;
  VEC(Symmetry) symmetries;
  VEC(Expect) expects;
  VEC(Event) events;
  VEC(Output) observes;
  Scene scene;
  VEC(FoundUnit) found;    /* names that were declared without a unit, where the equations tell it */
  ExprMap written; /* comparisons and functions that may jump, as AstId */
  SymId energy_sym; /* stands for the energy p q' - L in outputs and expects, until mech knows it */
  Unit energy_unit;
  struct Builder *builder; /* what model_reresolve needs */
} Model;

/* Built-in function i; NULL past the end. */
const char *function_name(size_t i);

/* Appends a listing, for --dump=model. */
void model_dump(const Model *m, StrBuf *out);

/* The names of the scenes in the file, in order; one named "default" when there is none. */
typedef struct {
  const Name *at;
  uint32_t n;
} SceneList, EffectList, CoordList;
SceneList model_scenes(const Ast *ast);

/* Whether the file has this scene; if not, a message in its diags names the nearest. */
int model_has_scene(Ast *ast, const char *scene);

/* The effects that no scene uses. */
EffectList model_unused_effects(const Ast *ast);

/* Warns of parameters, lets, inputs and functions of the model's own file that no expression in it mentions. */
void model_warn_unused(Ast *ast);

/* The effects that contain an expectation or a symmetry; first NULL, when one stands outside of effects. */
EffectList model_claiming_effects(const Ast *ast);

/* An output that the command line asks for, and the name of its column. */
typedef struct {
  AstId expr;
  Name name;
} Asked;

/* What the command line gives an input: its name, and a formula or a text that names a table; or a rotation, omega(R), at the start. */
typedef struct {
  AstId what, value;
} Given;

/* A surface that the motion crosses, for a Poincare section: an event that changes nothing. */
typedef struct {
  AstId expr; /* 0: none is asked for */
  AstDirection direction;
  Name name;
} Section;

/* What to build a model for. */
typedef struct {
  const char *scene; /* NULL: the first */
  Name also;         /* an effect to turn on besides the scene's own, with what it requires; or NULL */
  int bare;          /* no scene at all: no effect but `also` is on */
  const EffectList *only; /* these effects are in use, whatever the scene says; what it says of others, or by them, its outputs, monitors and
                           * closed forms have no part in it. NULL: those of the scene */
  const Define *defines;
  uint32_t ndefines;
  const Asked *asked; /* outputs besides the scene's own */
  uint32_t nasked;
  const Given *given; /* values that win over the scene's */
  uint32_t ngiven;
  Section section;
  const char *fix; /* parameters that become numbers, with the values that the scene gives them: "g,drag.c", "all"; NULL: none */
  int lends;       /* Model.lends */
  int unfixed;     /* none, whatever the command line says */
} ModelChoice;

/* The names that `coord` declares, in order, whatever the order of L. */
CoordList model_coordinates(const Model *m);

/* Builds the model. NULL when there were errors; they are in ast->diags, all of them. */
Model *model_build(Ast *ast, const ModelChoice *choice);

/* The expression `root` of the expectation x (or one inside it) once more, with its node `node`
 * standing for `with`; node 0: as it is written. 0 where that has no meaning (a stand-in under a
 * prime, say); nothing is reported. */
Expr model_reresolve(const Model *m, const Expect *x, AstId root, AstId node, Expr with);

/* What the command line gives to `target` (0: to a time), as a number in its declared unit. 0, reported, when
 * the target is nothing that a run sets, or the value does not fit it. */
int model_setting(const Model *m, AstId target, AstId value, double *out, const char **digits);

#endif
