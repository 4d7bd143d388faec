/* State of model_build, shared by the files of this folder. */
#pragma once

#include "model/declarations.h"
#include "model/model.h"

/* Index of a file's statements by name, made once (file_index.c): a file may have thousands of scenes, each compiled
 * by itself. */
typedef struct FileIndex {
  Scope scenes, effects;                   /* the first of each name: index into `named` */
  VEC(const AstStmt *) named;
  const AstStmt *model, *scene, *effect;   /* the first named statement of each kind, or NULL */
  VEC(const AstStmt *) common;             /* all statements but scenes, in the file's order */
  VEC(const AstStmt *) repeated;           /* scenes and effects whose name was declared before */
  /* names and effects were checked and are right; effects_check found an error */
  int is_sound, clashes;
} FileIndex;

FileIndex *file_index(Ast *ast);

/* The statement of a scene or effect by name (NULL: the first); the model statement; or NULL. */
const AstStmt *find_named(Ast *ast, AstStmtKind kind, const char *name);

typedef enum { WAITING, DOING, DONE } Progress;

/* Position of an expression in the text; each allows all names of those before it, and more. */
typedef enum {
  IN_CONST,    /* numbers, constants declared before */
  IN_PARAM,    /* + parameters declared before */
  IN_START,    /* + all parameters; lets and functions of them */
  IN_INPUT,    /* + t */
  IN_DYNAMICS, /* + q, q', z, inputs, lets, functions */
  IN_EXACT,    /* + start values x(0) */
  IN_OBSERVE,  /* + q'', z', multipliers, energy, charges */
  IN_OUTPUT    /* + closed forms exact(q), error(q) */
} Context;

/* Value of an expression: a number, a vector of 2 or 3 components of one dimension, or a rotation (unit quaternion
 * w, x, y, z). */
typedef struct {
  union {
    Expr e; /* the number, or component 0; 0: error, already reported */
    Expr at[4];
  };
  Dim dim;
  int bare;      /* made of plain numbers: takes the unit of the name it is given to */
  int condition; /* a truth value, not a number */
  int point;     /* temperature on a scale with an offset, 20 [degC]: cannot be scaled */
  const char *unit; /* unit as written, of a name or of a number with a unit; otherwise NULL */
  uint32_t n;    /* shape: 0 number, 2 or 3 vector, ROTATION */
  /* condition under which the text has a real value; 0: wherever the nodes have, or unknown (Builder.domains) */
  Expr domain;
} Value;

/* Evaluation of a let, an observable or a function, when first needed. */
typedef struct {
  Progress progress;
  Value value; /* e is 0 after an error; unused for a function: see Instance */
} Evaluated;

/* The size of a friction, as it is written. */
/* Instance of a user function for given argument shapes. Its body is evaluated once, with symbols as arguments and
 * unknown dimensions; each call substitutes its own. */
typedef struct {
  uint32_t function;
  Value *args;            /* made of LOCAL symbols */
  uint32_t nargs;
  /* all arguments' components; if the body takes a rate, followed by their rates and second rates */
  VEC(SymId) symbols;
  uint32_t nplain;        /* number of arguments' components, and so of rates and of second rates */
  uint32_t first_unknown; /* argument i has dimension dim_of_unknown(first_unknown + i) */
  int done;
  Value value;
  Span call;              /* the first call */
  uint32_t errors;        /* error count before the evaluation */
} Instance;

/* A name declared without a unit, and the unknown that stands for its dimension. */
typedef struct {
  Name name;
  Dim dim;
} Undeclared;

/* Start value of an angular velocity, `start omega(R) = (a, b, c)`. */
typedef struct {
  uint32_t coord; /* first coordinate of the rotation, R.w */
  Expr at[3];
  Span span;
} SpinStart;

/* A setting in a scene of n numbers of a family: of all members (rank 3), of ranges (2, 1), of one member (0). */
typedef struct {
  AstId lhs;
  uint32_t n, rank;
} MemberSetting;

/* A family with members set in the scene; by[i]: index + 1 of the last setting of number i in Builder.settings. */
typedef struct {
  Name name, effect;
  uint32_t parts, primes, *by;
} GivenFamily;

/* A name that only the statement being read knows. */
typedef struct {
  Name name;
  SymId sym;
} BoundName;

/* The highest rate of an input that is needed: input_rates.c. */
typedef struct {
  Name name;
  int order;
} InputRate;

/* Rates that builds of the model have found to be needed; missing: the last one lacked some. */
typedef struct {
  VEC(InputRate) of;
  int missing;
} InputRates;

/* A sum in a statement of a family (family_sums.c): row i - lo of a nest is member i's; rows 0: all members have the
 * same; value.e 0: it has no such form. */
typedef struct {
  AstId sum;
  Value value;
  int64_t lo;
  LoopRange range;
} FamilySum;

typedef struct Builder Builder;
struct Builder {
  Ast *ast;
  Diags *diags;
  Arena *arena;
  ExprGraph *g;
  Model *m;
  Scope scope, members, constraints;
  Scope outputs; /* the first `labelled` of the scene's outputs by label; index into Scene.outputs */
  uint32_t labelled;
  Rotations rotations;
  VEC(SpinStart) spins; /* start values of angular velocities */
  Scope *named; /* names of events, constraints and expectations; NULL: none yet */
  IndexVars index; /* indices of the `for` around the current statement, and the range of the innermost */
  int64_t for_range[2];
  int index_symbols; /* 1: they stand for themselves, as symbols */
  VEC(struct Eval *) idle; /* free list of evaluations */
  VEC(Expr) scratch;
  uint32_t *start_index; /* [SymId] index into Scene.starts + 1; 0: no start value */
  Expr *at_start, *from_start; /* [nbefore], [nstart]: substitution q -> q(0), and back (resolve_exact.c) */
  uint32_t nbefore, nstart;
  Expr *seeds; /* [nseeds] time derivative of each symbol; 0: constant */
  uint32_t nseeds;
  ExprMap rates; /* time derivatives of definition nodes, memoised */
  EntKind needed_kind; /* kind and index of the definition that an evaluation waits for */
  uint32_t needed;
  Actives active;
  Definitions lets, functions, observes;
  VEC(Evaluated) state[ENT_BUILTIN]; /* [ENT_LET].at[i]: evaluation of lets[i]; so for ENT_FUNCTION and ENT_OBSERVE */
  VEC(Instance *) instances;
  Constants constants;
  VEC(Value) constant_values; /* made of numbers and pi */
  Dims *dims;
  VEC(Dim) dim_of; /* [SymId] */
  Dim energy;      /* dimension of L */
  VEC(Undeclared) undeclared;
  const Define *defines;
  uint32_t ndefines;
  const AstStmt **chain; /* the scene after its `like` ancestors, oldest first; NULL-terminated */
  int is_variant;  /* ModelChoice.only is given */
  int is_giving;   /* ModelChoice.given is being applied */
  int in_scene;    /* statements of a scene are being applied; the settings so far of one scene of the chain: */
  VEC(MemberSetting) settings;
  VEC(GivenFamily) given;
  int is_measuring; /* a measure is being read */
  int unitless;    /* no name of the model has a unit: dimensions are not checked */
  /* [nbound] the group parameter of the symmetry being read; the new variables of a canonical transformation */
  const BoundName *bound;
  uint32_t nbound;
  int gives_lagrangian; /* the model itself has L, T or V */
  int in_friction; /* lambda(NAME) may stand in the size of a friction */
  Span force_span; /* of a lambda(NAME) elsewhere; empty: there is none */
  int brackets;    /* {f, g} in an expression is a Poisson bracket */
  int domains;     /* compute Value.domain, for claims */
  uint32_t sums_from; /* sums over at least so many pairs are not written out; 0: none is */
  int64_t more;       /* as in ModelChoice */
  InputRates *rates_wanted;
  VEC(FamilySum) family_sums;
  int keeps_rows; /* the statement is a force or a flow, whose sums may be rows of a nest */
};

/* Evaluates an expression of the text; after an error, reported, the value has e = 0. */
Value resolve(Builder *b, AstId id, Context where, Name effect);

/* The same, with the values of its nodes, nodes[i] for node ast_expr(id)->first + i; 0: a vector, or none of its own
 * (part of a chain). */
Value resolve_condition(Builder *b, AstId id, Name effect); /* a value of the dynamics that may be a condition */
Value resolve_nodes(Builder *b, AstId id, Context where, Name effect, Expr *nodes);

/* Value assigned to a name with a unit: a bare number is multiplied by the unit, any other value must have its
 * dimension. 0 after an error. value_in refuses vectors; resolve_in resolves the expression first. */
Value values_in(Builder *b, Value v, Span span, const Unit *unit);
Expr value_in(Builder *b, Value v, Span span, const Unit *unit);
Expr resolve_in(Builder *b, AstId id, Context where, Name effect, const Unit *unit);

/* Value of member `at` of a family (a vector where members are vectors), differentiated `primes` times by t.
 * Indices must be in range: index_in_range reports where they are not. */
Value resolve_member(Builder *b, const Entity *e, const int64_t *at, uint32_t primes, Span span, Context where);
int index_in_range(Builder *b, const Entity *e, const int64_t *at, Span span);

/* Sets at[] to the first member, or advances it, row by row; 0: there is none, or none any more. */
int first_member(const Entity *e, int64_t *at);
int next_member(const Entity *e, int64_t *at);

/* Component k of u x v in space; for vectors of a plane component 2. */
Expr cross_component(ExprGraph *g, const Expr *u, const Expr *v, int k);

/* Evaluates an index or the end of a range to an integer; 0, reported, when the value is not an integer constant. */
int resolve_whole(Builder *b, AstId id, Name effect, int64_t *out);

/* 1 if a range has at most RANGE_MAX members; 0, reported, if not. */
int range_fits(Builder *b, int64_t from, int64_t to, Span span);

enum { RANGE_MAX = 1000000 };

/* Index list, `[2]` or `[i in 1..N, 3]`, as ranges; lo == hi for a single number. */
typedef struct {
  uint32_t n;
  Name name[2]; /* NULL: a number */
  int64_t lo[2], hi[2];
} IndexRange;
int resolve_indices(Builder *b, AstId list, Name effect, IndexRange *out);

/* Reports a third index: families have one or two. */
void report_many_indices(Builder *b, Span span);

/* 1, reported, if v contains action variables, which only outputs may. */
int refuse_actions(Builder *b, const Value *v, Span span);

/* domain.c: conjunction of two conditions, each 0 where it always holds. */
Expr domain_and(const Builder *b, Expr p, Expr q);

/* Shape for messages: "a number", "a vector of 3 components", "a rotation". */
const char *shape_text(const Builder *b, uint32_t n);
/* 1 for the shape of a number; else 0, reported. */
int need_number(Builder *b, Span span, uint32_t n);

/* Calls fn for a statement, or, where st is a `for`, for its body once per index value, with b->index set. */
typedef void StatementFn(Builder *b, const AstStmt *st, Name effect, void *data);
void each_statement(Builder *b, const AstStmt *st, Name effect, StatementFn *fn, void *data);

/* Left side of a statement, taken apart: `drag.c`, `m[i in 1..N]`, `r[2].x'`. */
typedef struct {
  AstId stem;      /* name, or effect.name */
  uint32_t primes;
  int part;        /* component: 0, 1, 2, 3 for x, y, z, w; 4 for any other letter; -1: all components */
  AstId indices;   /* 0: the whole family */
  int wrong;       /* the expression does not have this form */
} Target;
Target read_target(const Builder *b, AstId id);

/* Index of Target.part among the n components of a value; -1: no such component. */
static inline int component_index(uint32_t n, int part) {
  int place = n == ROTATION ? (part + 1) % ROTATION : part;
  return part < 0 || part > 3 || place >= (int)n ? -1 : place;
}

/* The list in `{1, 3} [kg]`, and its unit or NULL. Returns NULL where the expression is not a list. */
const AstExpr *list_behind(const Builder *b, AstId id, const AstUnit **unit);

/* Element of a list, and the unit written after the list, or NULL. */
typedef struct {
  AstId id;
  const AstUnit *behind;
} Element;

typedef VEC(Element) Elements;

/* Elements of a list for the members r of family `name`, row by row; for two indices the list may be a list of rows.
 * 0, reported, when the number of elements differs from that of members. */
int list_elements(Builder *b, const AstExpr *list, const AstUnit *behind, const IndexRange *r, Name name,
                  Elements *out);
Value element_value(Builder *b, const Element *x, Context where, Name effect);

/* Index range of a whole family. */
IndexRange entity_range(const Entity *e);

/* Number of members; the next one, row by row, or 0 after the last. */
uint64_t range_count(const IndexRange *r);
int range_next(const IndexRange *r, int64_t *at);

/* Assigns values to the members and components of entity e that p names: calls `give` for each scalar, with its
 * index in the model's array. `unit` returns the unit in which a scalar takes bare numbers. */
typedef struct {
  Context where; /* names allowed in the value */
  const Unit *(*unit)(Builder *b, uint32_t scalar, void *data);
  void (*give)(Builder *b, uint32_t scalar, Expr value, Span span, void *data);
  void *data;
  Name effect;   /* the effect around the statement, or NULL */
  /* takes one formula for many members; 0: it does not. NULL: none is taken */
  int (*give_family)(Builder *b, const FamilyValue *x, void *data);
} Assigner;
void assign_values(Builder *b, const Target *p, const Entity *e, AstId lhs, AstId rhs, const Assigner *assigner);

/* resolve_exact.c: sets the closed form of a coordinate, velocity or state; finds the closed form of symbol e, or NULL;
 * the deviation of the motion from it (for an angle within -pi..pi). */
void set_closed_form(Builder *b, SymId target, const Unit *unit, int periodic, Expr value, Span span);
const Exact *find_closed_form(const Builder *b, Expr e);
Expr closed_form_error(Builder *b, const Exact *x);

/* effect.c: reports an unknown scene or effect, with the nearest name. */
void report_unnamed(const Ast *ast, AstStmtKind kind, Span span, const char *name);

/* Effects in use: tests for one; adds those of a scene's `use` statements; adds one with all effects it requires;
 * reports unmet `requires` and violated `excludes` of one. */
int uses_effect(const Builder *b, Name effect);
int is_use_none(const AstStmt *st);
void collect_uses(Builder *b, const AstStmt *scene);
void use_with_required(Builder *b, Name effect);
void check_effect_needs(Builder *b, const AstStmt *effect);
/* 1 if an expression contains a name of an effect that is off. */
int names_off_effect(const Builder *b, AstId value);

/* output.c: appends an output to the scene, even if its label exists; its index in Scene.outputs. */
int push_output(Builder *b, const Output *o);

void drop_outputs(Builder *b);

/* Adds an expression to the scene's outputs (all components and members). Index of the output if the expression is one
 * number; -1 for more, or after an error. */
int add_outputs(Builder *b, AstId id);

/* Adds the output error(q) for closed form x; its index. */
int add_error(Builder *b, const Exact *x, Span span);

/* add_outputs, with `label` as the column's name. */
int add_outputs_as(Builder *b, AstId id, Name label);

/* monitor.c: reads `monitor q limit`. */
void set_monitor(Builder *b, const AstStmt *st);

/* measure.c: reads `measure NAME = EXPR`; a second one of the name replaces the first. */
void set_measure(Builder *b, const AstStmt *st);
/* The same of the command line: plain numbers are in the unit beside them, units that do not match draw warnings. */
void ask_measure(Builder *b, const CommandOutput *asked);

/* input_rates.c: notes that the rate of this order of the inputs in e, or of those of momenta, is needed;
 * declares the rates of an input that an earlier build noted, behind it; gives them formulas and tables. */
void want_rates_of(Builder *b, Expr e, int order);
void want_rates_of_momenta(Builder *b);
void declare_input_rates(Builder *b, uint32_t input);
void fill_input_rates(Builder *b);

/* input_table.c: sets the formula or, where rhs is a file name, the table of input `index`; stem: its name without
 * the effect. */
/* input_integral.c. is_input_integral: of another input. fill: their tables, once those of all inputs are known. */
int is_input_integral(const Builder *b, AstId rhs);
void fill_input_integrals(Builder *b);
void give_input(Builder *b, uint32_t index, Name stem, AstId rhs, Name effect);

/* declare.c: enters the names that a statement declares into scope and model; a StatementFn. Likewise, of momenta
 * alone. */
void declare_statement(Builder *b, const AstStmt *st, Name effect, void *data);
/* Families of observables in a `for` without turns, once all others are declared. */
void declare_empty_families(Builder *b, const AstStmt *st, Name effect);
void declare_momentum(Builder *b, const AstStmt *st, Name effect, void *data);

/* Declares a name; 0, with a message, when it is taken. */
int declare_entity(Builder *b, const AstStmt *st, Entity e);

enum { FAMILY_MAX = 1000000 };

/* declared_type.c: declares the name of a refused declaration, so that its uses are not reported as unknown;
 * brackets after a space are a unit, else a size: 0, reported, where a unit was written without the space. */
void declare_refused(Builder *b, const AstStmt *st, Name effect);
int check_brackets(Builder *b, const AstStmt *st, Name effect);
/* Fills in the entity for a plain name, a vector or a family, without declaring it; 0 after an error. `index` is
 * that of its first scalar; `parts` comes from read_type. */
int read_family(Builder *b, const AstStmt *st, Name effect, EntKind kind, uint32_t index, uint8_t parts, Entity *e);
int read_type(Builder *b, const AstStmt *st, Name effect, uint8_t *parts);

/* Name of component k of member `at`: "th", "th[2]", "r.x", "r[2].x". */
Name scalar_name(Builder *b, const Entity *e, Name stem, const int64_t *at, uint32_t k);

/* fixed_params.c: replaces the parameters listed in `words` (NULL: none) by their values, and numbers the remaining
 * ones (Param.place). Mistakes are reported. */
void fix_params(Builder *b, const char *words);

/* declare_param.c */
void declare_param(Builder *b, const AstStmt *st, Name effect);
void declare_const(Builder *b, const AstStmt *st, Name effect);
SymId declare_symbol(Builder *b, SymKind kind, uint32_t index, Name name, ExprSign sign, Dim dim);

/* Value of a constant expression (span, step, tolerance) in `unit`; NAN after an error. `what` names it in messages.
 * *digits (or NULL) as in base/num.h. */
double resolve_number(Builder *b, AstId id, const Unit *unit, const char *what, const char **digits);

/* command_value.c: evaluates ModelChoice.values. */
void command_values(Builder *b, CommandValue *values, uint32_t n);

/* Value of a formula of numbers and pi. */
long double constant_value(const Builder *b, Expr e);
/* Decimal digits of a number times pi^-1, pi^0 or pi^1; NULL for other expressions. */
const char *expression_digits(Builder *b, Expr e);

/* Records a let, a function or an observable, without a value. */
void add_definition(Builder *b, EntKind kind, Definition d);
/* resolve_function.c: the functions that functions.def defines by a text, as far as some expression calls them. */
void declare_composed(Builder *b);
/* Notes in the Ast which of them expressions call that were read since the last note: once for a file, as each scene
 * declares them. */
void note_composed(Ast *ast);

/* Evaluates a let or an observable, unless it has a value already. */
void resolve_definition(Builder *b, EntKind kind, uint32_t index);

/* The entity that a name means outside of effects, or NULL. */
static inline const Entity *entity_named(const Builder *b, Name name) {
  return scope_find(&b->scope, name, NULL, NULL);
}

/* Entity of a name; unknown and ambiguous names are reported. `declare` is the kind of declaration to suggest
 * ("state"), or NULL for any. */
const Entity *resolve_name(Builder *b, Name name, Span span, Name effect, const char *declare);

/* Warns when a unit is also the name of a constant: `th [N]` is th in newtons. */
void warn_unit_is_constant(Builder *b, const AstUnit *u);

/* Reports a value that contradicts its parameter's declared sign. */
void check_sign(Builder *b, const Param *p, Span span);

/* Warns of parameters whose value, computed from others, contradicts their declared sign: a run refuses them. */
void warn_signs(Builder *b);
/* Adds a size made of parameters, or of them and of a factor that is not negative; others are left out, as are those
 * whose sign is proved. */
void add_size(Builder *b, Expr value, const char *what, Span span, int part);
void add_static_limit(Builder *b, Expr limit, Expr friction, Span span);
/* The cut-off of a sum over neighbours, at least 0, and at most half of each side of the box. */
void add_near_cut(Builder *b, Expr cut, Span span);
void add_opening_angle(Builder *b, Expr theta, Span span);
void add_near_box(Builder *b, Expr side, Expr cut, Span span);
/* Errors where the values of the scene make sizes of friction and contacts negative, or too large. */
void check_sizes(Builder *b);

/* name_hints.c: adds a hint to the message about an unknown name. */
void advise_unknown_name(Builder *b, Name name, Span span, Name effect, const char *declare);
/* Adds the equivalent of a function known from other languages or books; 0: the name is not known. */
int advise_unknown_function(Builder *b, Name name);
#define FOREIGN_CHOICES "piecewise where ifelse iif cases select cond"

/* The active statement that declares a name, anywhere in the file; or NULL. */
const AstStmt *declared_in_use(const Builder *b, Name name, Name effect);

/* The first effect that declares a name, in use or not, or NULL; whether a given effect (NULL: no) declares it. */
const AstStmt *declaring_effect(const Builder *b, Name name);
int effect_declares(const AstStmt *effect, Name name);

/* Source text of an expression (of a span) on one line, without comments; ast_short leaves out the middle of a long
 * one. */
const char *ast_text(const Builder *b, AstId id);
const char *source_text(const Builder *b, Span s);
const char *ast_short(const Builder *b, AstId id);
Name intern_printf(Builder *b, const char *fmt, ...) __attribute__((format(printf, 2, 3)));

/* Unit of a declaration. Without one the dimension is a new unknown, shared by all members of a family and inferred
 * from the equations. */
Unit declared_unit(Builder *b, const AstStmt *st, Name effect);

/* entities.c: declared unit of an entity, or NULL. */
int is_coordinate(const Builder *b, const Entity *e); /* also one that is stored as a state */
const Unit *entity_unit(const Builder *b, const Entity *e);
/* The symbol of element i of the model's coordinates, states, parameters or inputs; of the first two its rate. */
SymId entity_symbol(const Model *m, EntKind kind, int rate, uint32_t i);

/* check_units.c */

/* Unit of a rate, u/s, and of a difference; both without offset. */
Unit unit_per_second(const Builder *b, const Unit *u);
Unit unit_of_difference(const Unit *u);

int is_zero(const Builder *b, const Value *v);

/* 1 if two values can be added: equal dimensions, or unknowns chosen so; zero fits every dimension. */
int dims_agree(Builder *b, const Value *x, const Value *y, Span why);

/* For messages: unit of a value, as written or from its dimension; "in [m]" or "a pure number". */
const char *shown_unit(const Builder *b, const Value *v);
const char *in_unit(const Builder *b, const char *unit);
const char *in_dim(const Builder *b, Dim d);

/* Adds to a message about dimensions x and y (y DIM_ANY: x alone) where the dimension of a name without unit was
 * inferred, or that no choice of unit would help. */
void explain_dims(Builder *b, Dim x, Dim y);

/* Replaces missing units in the model by the inferred ones. */
void fill_inferred_units(Builder *b);

/* drawing.c: Scene.shapes and their outputs, the last of the scene; guessed where the text has no `draw`. wanted 0:
 * statements are checked, and leave nothing but nodes. */
void build_drawing(Builder *b, int wanted);

/* rotation.c */

/* Adds the constraint q.q = 1 for the quaternion whose first coordinate is `coord`. */
void constrain_rotation(Builder *b, Name name, uint32_t coord, Span span);

/* Sets Model.regularising: a kinetic term in the rate of |q|, which no motion has, so that the mass matrix is
 * regular. */
void add_rotation_inertia(Builder *b);

/* Rates q' = q (0, w)/2 from the angular velocity w in the body frame; and w from the rates. */
Value rotation_rates(Builder *b, const Value *q, const Expr *w);
void rotation_spin(Builder *b, const Value *q, const Value *rates, Expr *w);

/* First coordinate (R.w) of the rotation in a target `omega(R)`; -1: the target is not a call; -2: error, reported. */
int spin_target(Builder *b, AstId place, Name effect);

/* Generalised force along the four quaternion coordinates of a torque in the body frame. */
Value torque_force(Builder *b, const Value *q, const Value *torque);

/* hamiltonian.c: decides whether the text gives L (gives_lagrangian), or H and not L (Model.hamiltonian); reports
 * coordinates without a momentum. */
void find_hamiltonian(Builder *b);
void check_momenta(Builder *b);
/* Whether people call a momentum so: p, px, p1, p_th. */
int is_momentum_name(Name name);

/* 1 if a statement adds to H; 0, reported, if the model, or an effect of it, may not give H here. *first: the
 * model's own statement. */
int gives_hamiltonian(Builder *b, const AstStmt *st, Name effect, Span *first);
/* 1 unless a term of L stands beside H; reported. */
int adds_to_hamiltonian(Builder *b, const AstStmt *st);
/* 1 if H has no velocity, as written or through a let (v, or NULL); otherwise reported. */
int is_free_of_velocities(Builder *b, const AstStmt *st, const Value *v);
/* The first velocity in an expression, as written or through a let (v, or NULL); empty: none. */
Span velocity_in(const Builder *b, AstId id, const Value *v);
/* 1 if momentum p has the shape of its coordinate q, which has no other; otherwise reported. */
int pair_fits(Builder *b, const AstStmt *st, const Entity *p, const Entity *q);
/* H, and the term p*q' of a momentum, which is paired with its coordinate; e = 0 after an error. */
Value value_of_hamiltonian(Builder *b, const AstStmt *st, Name effect);
Value action_of_momentum(Builder *b, const AstStmt *st, Name effect);

/* constraint.c: adds a constraint statement, or a contact statement, to the model. */
void add_constraint(Builder *b, const AstStmt *st, Name effect);
void add_contact(Builder *b, const AstStmt *st, Name effect);
/* contact_family.c: a contact with ranges in its index; whether it is one; refusals where moreau does not follow. */
int is_contact_family(const Builder *b, const AstStmt *st);
void add_contact_family(Builder *b, const AstStmt *st, Name effect);
void check_contact_families(Builder *b);
/* Whether a family of contacts reads members of the parameter e at its indices. */
int read_by_contact_family(const Builder *b, const Entity *e);
/* guide.c: the constraint of a guide; its friction, once all constraints are known. */
void add_guide(Builder *b, const AstStmt *st, Name effect);
void add_guide_friction(Builder *b, const AstStmt *st, Name effect, void *data);

/* symmetry.c: declares a symmetry and its charge; reads its maps, once L is known. */
void declare_symmetry(Builder *b, const AstStmt *st, Name effect);
void add_symmetry(Builder *b, const AstStmt *st, Name effect);

/* canonical.c: reads a canonical transformation, once L is known. */
void add_canonical(Builder *b, const AstStmt *st);

/* redeclarations.c: reports repeated names of scenes, effects, events, constraints and expectations, and settings
 * that a scene or event gives twice. */
void check_names_once(Builder *b, const FileIndex *file);
void check_name_is_new(Builder *b, const char *what, Name name, Name effect, Span span);
void check_set_once(Builder *b, const AstStmt *block);
/* kept_members.c: in a scene, records the members r as set; reports those set before by a setting that is not the
 * wider one. */
void check_members_kept(Builder *b, const Target *p, const Entity *e, const IndexRange *r, AstId lhs);

/* event.c: adds an event, or a section; resolves a value assigned to a coordinate, a state, or the rate of one,
 * whose name is declared in `unit`; reports different shapes. */
void add_event(Builder *b, const AstStmt *st, Name effect);
void add_section(Builder *b, const Section *s);
Value resolve_for(Builder *b, AstId id, Name effect, SymId target, const Unit *unit);
void report_shapes(Builder *b, Span span, uint32_t left, uint32_t right);
void report_units(Builder *b, Span span, Dim left, Dim right);

/* start_values.c: reads `start q = ...`, `exact q = ...`; completes the starts of rotations after all statements of
 * the scene (default: the identity); rad/s. */
void set_motion(Builder *b, const AstStmt *st);
void complete_rotation_starts(Builder *b);
Unit spin_unit(const Builder *b);

/* name_hints.c: reports an unknown `effect.name`. */
void report_no_member(Builder *b, Span span, Name effect, Name name);

/* new_coordinates.c: the active statements in the new coordinates of a point transformation. */
void change_coordinates(Builder *b, Name to);

/* scene.c: selects the active statements (Builder.active); then reads the scene's statements into Model.scene. */
void scene_select(Builder *b, const ModelChoice *choice);
void scene_build(Builder *b, const ModelChoice *choice);

/* method.c: reads a `method` statement. */
void scene_method(Builder *b, const AstStmt *st);
