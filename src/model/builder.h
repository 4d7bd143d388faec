/* The inside of model_build, shared by model.c, resolve.c and scene.c only. */
#ifndef LAGC_BUILDER_H
#define LAGC_BUILDER_H

#include "model/file_index.h"
#include "model/model.h"
#include "model/scope.h"

typedef enum { TODO, DOING, DONE } Progress;

/* Where an expression stands decides what may be in it. */
typedef enum {
  IN_CONST,    /* numbers and earlier constants */
  IN_PARAM,    /* and earlier parameters */
  IN_START,    /* and all parameters */
  IN_INPUT,    /* and t */
  IN_DYNAMICS, /* everything but q'' and z' */
  IN_EXACT,    /* the same, and values at the start */
  IN_OBSERVE,  /* everything */
  IN_OUTPUT    /* and closed forms */
} Context;

/* A number, a vector of n = 2 or 3 components with one dimension, or a rotation: the n = ROTATION numbers w, x, y, z of a unit quaternion. */
enum { ROTATION = 4 };
typedef struct {
  union {
    Expr e; /* 0 after an error: reported already */
    Expr at[4];
  };
  Dim dim;
  int bare;      /* made of numbers alone: takes on the unit of what it is given to */
  int condition; /* true or false, no number */
  int point;     /* 20 [degC]: a point on a scale whose zero is not that of the kelvin */
  const char *unit; /* of a name, or a number with a unit: as it was written; otherwise NULL */
  uint32_t n;    /* 0: a number */
  Expr domain;   /* where the text has a real value; 0: wherever the nodes have, or not asked for (Builder.domains) */
} Value;

/* What an index stands for, inside `for`, `sum`, and definitions with an index. */
typedef struct {
  Name name;
  int64_t at;
} IndexVar;

typedef VEC(IndexVar) IndexVars;

/* A let, an observable, or a member of a family of them, evaluated when first needed; or a function. */
typedef struct {
  const AstStmt *stmt;
  Name name, effect;
  Progress progress;
  Value value; /* e is 0 after an error */
  struct Instance *instances; /* of a function: where it has been called */
  IndexVar index[2]; /* of a member: its indices, by name where the let binds one */
  const IndexVar *around; /* of an observable: the indices of the `for` around it */
  uint32_t naround;
} Definition;

/* A function's body, evaluated for arguments of certain shapes: numbers, or vectors of 2 or 3 components. Their
 * dimensions may stay open, so that each call has its own. */
typedef struct Instance Instance;
struct Instance {
  uint32_t function;
  Value *args;            /* made of LOCAL symbols */
  uint32_t nargs;
  VEC(SymId) symbols;     /* of all arguments, in order; where a prime is taken of one, then all rates, then */
  uint32_t nplain;        /* all second rates; there are nplain of each */
  uint32_t first_unknown; /* the dimension of argument i is unknown first_unknown + i */
  int done;
  Value value;
  Span call;              /* the first */
  uint32_t errors;        /* there were before it was evaluated */
  Instance *next;         /* of the same function */
};

typedef struct {
  Name name, effect;
  Value value; /* made of numbers and pi */
  AstId given; /* by the file, or by -D; a bare number is in `unit` */
  Unit unit;
} Constant;

/* A name without a unit of its own. */
typedef struct {
  Name name;
  Dim dim;
} Undeclared;

typedef struct {
  const AstStmt *stmt;
  Name effect;
} Active;

/* `start omega(R) = (a, b, c)` */
typedef struct {
  uint32_t coord; /* R.w */
  Expr at[3];
  Span span;
} Spin;

typedef struct Builder Builder;
struct Builder {
  Ast *ast;
  Diags *diags;
  Arena *arena;
  ExprGraph *g;
  Model *m;
  Scope scope, members;
  Scope outputs; /* of the scene: index is the place */
  Scope constraints; /* by name; the index is that of the first component */
  VEC(uint32_t) rotations; /* the first coordinate of each */
  VEC(Spin) spins; /* what the scene in hand says of their angular velocities */
  Scope *named; /* events and expectations; NULL: none yet */
  IndexVars index; /* of the `for` around the statement in hand */
  VEC(struct Eval *) idle; /* evaluations to use again */
  VEC(Expr) scratch;
  uint32_t *start_of; /* place in the scene's starts, from 1, by SymId */
  Expr *at_start, *from_start; /* for closed forms: see resolve_exact.c */
  uint32_t nbefore, nstart;
  Expr *seeds; /* what each symbol becomes under d/dt, for nseeds symbols; 0: a number */
  uint32_t nseeds;
  ExprMap rates; /* the time derivatives of definitions */
  EntKind needed_kind; /* the definition that an evaluation waits for */
  uint32_t needed;
  VEC(Active) active; /* the statements that this scene uses */
  VEC(Definition) lets, functions, observes; /* observes: one for each in the model */
  VEC(Instance *) instances;
  VEC(Constant) constants;
  Dims *dims;
  VEC(Dim) dim_of; /* by SymId */
  Dim energy;      /* of L */
  VEC(Undeclared) undeclared;
  const Define *defines;
  uint32_t ndefines;
  const AstStmt **chain; /* the scene and those it is like, oldest first; NULL-terminated */
  int is_variant;  /* effects in use are ModelChoice.only */
  int unitless;    /* nothing is measured in a unit: nothing is checked */
  Name group;      /* the parameter of the symmetry in hand, or NULL; */
  SymId group_symbol;
  AstId stand_in;  /* a node that stands for `stands_for` (see model_reresolve), or 0 */
  Expr stands_for;
  int domains;     /* values know their domains: for what is claimed of them */
};

/* The value of an expression; errors are reported and give e = 0. */
Value resolve(Builder *b, AstId id, Context where, Name effect);

/* A value given to something with a unit: a bare number is multiplied by that unit, anything else
 * must have its dimension. 0 after an error. resolve_in resolves it first. */
Value values_in(Builder *b, Value v, Span span, const Unit *unit);
Expr value_in(Builder *b, Value v, Span span, const Unit *unit);
Expr resolve_in(Builder *b, AstId id, Context where, Name effect, const Unit *unit);

/* The value of member `at` of a family (of all its components where it is a family of vectors); primes
 * are taken of it. Indices must be in range: see index_in_range, which reports where they are not. */
Value resolve_member(Builder *b, const Entity *e, const int64_t *at, uint32_t primes, Span span, Context where);
int index_in_range(Builder *b, const Entity *e, const int64_t *at, Span span);

/* Position of a member, in its model's array, behind the family's first. */
uint32_t member_offset(const Entity *e, const int64_t *at);

/* The next member, row by row; 0 after the last. */
int next_member(const Entity *e, int64_t *at);

/* "th[2]", "u[2,1]" */
Name member_name(Builder *b, Name name, const int64_t *at, uint32_t ndims);

/* The entity of member `at` where members are declared one by one, or NULL. */
const Entity *find_member(const Builder *b, const Entity *e, const int64_t *at);

/* A whole number known when compiling: an index, or the end of a range. 0, reported, when it is none. */
int resolve_whole(Builder *b, AstId id, Name effect, int64_t *out);

/* Whether a range is short enough to be written out; reported where it is not. */
int range_fits(Builder *b, int64_t from, int64_t to, Span span);

/* The ends of a range; at most RANGE_MAX members. */
enum { RANGE_MAX = 1000000 };
int resolve_range(Builder *b, AstId lo, AstId hi, Name effect, int64_t *from, int64_t *to);

/* The indices of a place, `[2]` or `[i in 1..N]`, as ranges (from == to where it is one number). */
typedef struct {
  uint32_t n;
  Name name[2]; /* NULL: a number */
  int64_t lo[2], hi[2];
} IndexRange;
int resolve_indices(Builder *b, AstId list, Name effect, IndexRange *out);

/* Families have no third index. */
void report_many_indices(Builder *b, Span span);

/* domain.c: both conditions. */
Expr domain_and(const Builder *b, Expr p, Expr q);

/* The letter of component k of n. */
static inline char part_letter(uint32_t n, uint32_t k) { return "wxyz"[k + (n != ROTATION)]; }

/* "a number", "a vector of 3 components", "a rotation" */
const char *shape_text(const Builder *b, uint32_t n);

/* Calls fn for each statement that `for` around it makes of st, with b->index set. */
typedef void StatementFn(Builder *b, const AstStmt *st, Name effect, void *data);
void each_statement(Builder *b, const AstStmt *st, Name effect, StatementFn *fn, void *data);

/* What a statement names: `drag.c`, `m[i in 1..N]`, `r[2].x'`. */
typedef struct {
  AstId stem;      /* the name, or effect.name */
  uint32_t primes;
  int part;        /* the component: 0, 1, 2, 3 for x, y, z, w, 4 where there is none of that name; -1: all there are */
  AstId indices;   /* 0: the whole family */
  int wrong;       /* it is not of this form */
} Target;
Target read_target(const Builder *b, AstId id);

/* The place of component `part` of a target among n; -1: there is none. */
static inline int part_place(uint32_t n, int part) {
  int place = n == ROTATION ? (part + 1) % ROTATION : part;
  return part < 0 || part > 3 || place >= (int)n ? -1 : place;
}

/* The list that gives a family its values, and the unit behind it: `{1, 3} [kg]`. NULL: it is no list. */
const AstExpr *list_behind(const Builder *b, AstId id, const AstUnit **unit);

/* An element of a list, and the unit behind that list, or NULL. */
typedef struct {
  AstId id;
  const AstUnit *behind;
} Element;

typedef VEC(Element) Elements;

/* The elements of a list for the members in r, of the family `name`, row by row; a list for two indices may
 * be a list of its rows. 0, reported, when there are not as many as members. */
int list_elements(Builder *b, const AstExpr *list, const AstUnit *behind, const IndexRange *r, Name name, Elements *out);
Value element_value(Builder *b, const Element *x, Context where, Name effect);

/* All members. */
IndexRange entity_range(const Entity *e);

/* Gives what the place names, of entity e, its values: `give` is called for each scalar, with its place
 * in the model's array. `unit` tells in what unit a scalar takes bare numbers. */
typedef struct {
  Context where; /* of what is given */
  const Unit *(*unit)(Builder *b, uint32_t scalar, void *data);
  void (*give)(Builder *b, uint32_t scalar, Expr value, Span span, void *data);
  void *data;
  Name effect;   /* that the statement stands in, or NULL */
} Giver;
void assign_values(Builder *b, const Target *p, const Entity *e, AstId lhs, AstId rhs, const Giver *giver);

/* resolve_exact.c: gives a coordinate, a velocity or a state its closed form; that of the symbol e, NULL where it has
 * none; and how far the motion is from it, for an angle between -pi and pi. */
void give_exact(Builder *b, SymId target, const Unit *unit, int periodic, Expr value, Span span);
const Exact *find_exact(const Builder *b, Expr e);
Expr exact_error(Builder *b, const Exact *x);

/* effect.c: what to say where no scene, or effect, has that name. */
void report_unnamed(const Ast *ast, AstStmtKind kind, Span span, const char *name);

/* Whether the effect is in use; a scene's `use` statements; an effect turned on together with what it requires; whether what an effect
 * in use requires and excludes is so. */
int uses_effect(const Builder *b, Name effect);
int is_use_none(const AstStmt *st);
void collect_uses(Builder *b, const AstStmt *scene);
void use_with_needs(Builder *b, Name effect);
void check_effect_needs(Builder *b, const AstStmt *effect);
/* Whether a value speaks of an effect that is off. */
int mentions_off(const Builder *b, AstId value);

/* output.c: adds an output to the scene, whatever others are called; its place. */
int push_output(Builder *b, const Output *o);

void drop_outputs(Builder *b);

/* Adds what an expression puts out to the scene's outputs. The place of the one number that
 * it is; -1 when it is more, or after an error. */
int add_outputs(Builder *b, AstId id);

/* Adds error(q) for what has the closed form x; its place. */
int add_error(Builder *b, const Exact *x, Span span);

/* The same as add_outputs under a name of the caller's choice. */
int add_outputs_as(Builder *b, AstId id, Name label);

/* monitor.c: `monitor q limit`. */
void set_monitor(Builder *b, const AstStmt *st);

/* table.c: gives input `index` its formula, or the table whose file is named; stem: its name without its effect. */
void give_input(Builder *b, uint32_t index, Name stem, AstId rhs, Name effect);

/* declare.c: the declarations of a statement. */
void declare_statement(Builder *b, const AstStmt *st, Name effect, void *data);

/* Declares a name; 0, with a message, when it is taken. */
int declare_entity(Builder *b, const AstStmt *st, Entity e);

/* The entity of a family, a vector, or a plain name, not declared yet; 0 after an error. `index` is where
 * its first scalar will stand. read_type gives `parts`. */
int read_family(Builder *b, const AstStmt *st, Name effect, EntKind kind, uint32_t index, uint8_t parts, Entity *e);
int read_type(Builder *b, const AstStmt *st, Name effect, uint8_t *parts);

/* "th", "th[2]", "r.x", "r[2].x": component k of member `at`. */
Name scalar_name(Builder *b, const Entity *e, Name stem, const int64_t *at, uint32_t k);

/* fix.c: fixes the parameters that the words name, with the values that the model has for them, and places the others. Mistakes are
 * reported. words NULL: none is fixed. */
void fix_params(Builder *b, const char *words);

/* declare_param.c */
void declare_param(Builder *b, const AstStmt *st, Name effect);
void declare_const(Builder *b, const AstStmt *st, Name effect);
SymId declare_symbol(Builder *b, SymKind kind, uint32_t index, Name name, ExprSign sign, Dim dim);

/* A number known now (spans, steps, tolerances); NAN after an error. */
double resolve_number(Builder *b, AstId id, const Unit *unit, const char *what);
/* The same, and *digits: all that base/digits.h has of it, or NULL. */
double resolve_digits(Builder *b, AstId id, const Unit *unit, const char *what, const char **digits);
/* The digits of an expression that is a number times a power of pi; NULL of others. */
const char *expression_digits(Builder *b, Expr e);

/* Evaluates a let, or an observable, that nothing has needed so far. */
void resolve_let(Builder *b, uint32_t index);
void resolve_observe(Builder *b, uint32_t index);

/* model.c: puts the value of an observable into the model, checks its unit. */
void finish_observe(Builder *b, uint32_t index, Value v);

/* Checks a function that nothing calls: there must be shapes of arguments that make sense of its body. */
void check_uncalled(Builder *b, uint32_t function);

/* The entity a name stands for; unknown and ambiguous names are reported. `declare` is the statement
 * that would declare what is wanted ("state"), or NULL where it may be anything. */
const Entity *resolve_name(Builder *b, Name name, Span span, Name effect, const char *declare);

/* Warns when a unit is also the name of a constant: `th [N]` is th in newtons. */
void warn_unit_is_constant(Builder *b, const AstUnit *u);

/* Reports a value that is not of the sign that its parameter is declared to have. */
void check_sign(Builder *b, const Param *p, Span span);

/* Warns of parameters whose value, made of others, is not of the sign that they are declared to have: a run refuses them. */
void warn_signs(Builder *b);

/* advice.c: adds a way out to the message about an unknown name, or an unknown `effect.name`. */
void advise_unknown_name(Builder *b, Name name, Span span, Name effect, const char *declare);
void advise_unknown_member(Builder *b, Name effect, Name name);
/* The same of a function that other languages, or books, have; 0 when it is none. */
int advise_unknown_function(Builder *b, Name name);
#define FOREIGN_CHOICES "piecewise where ifelse iif cases select cond"

/* The active statement that declares the name, before or after; NULL when there is none. */
const AstStmt *declared_in_use(const Builder *b, Name name, Name effect);

/* An effect that declares the name, in use or not; and whether this one does (NULL: no). */
const AstStmt *declaring_effect(const Builder *b, Name name);
int effect_declares(const AstStmt *effect, Name name);

/* "not yet: what" */
void not_yet(Builder *b, Span span, const char *what);

/* The source text of an expression on one line, without comments; and the same with its middle left
 * out where it is long. */
const char *ast_text(const Builder *b, AstId id);
const char *source_text(const Builder *b, Span s);
const char *ast_short(const Builder *b, AstId id);
Name intern_printf(Builder *b, const char *fmt, ...) __attribute__((format(printf, 2, 3)));

/* The unit that a statement gives its name. Without one its dimension is unknown, and found from the
 * equations where they tell; that is once for all members of a family. */
Unit declared_unit(Builder *b, const AstStmt *st, Name effect);

/* output.c: the unit of what an entity declares, or NULL. */
const Unit *entity_unit(const Builder *b, const Entity *e);

/* check_units.c */

/* The unit of a rate: per second. Its zero is zero. */
Unit unit_per_second(const Builder *b, const Unit *u);
Unit unit_of_difference(const Unit *u);

int is_zero(const Builder *b, const Value *v);

/* Whether two values can be added: they have one dimension, or can be given it; zero is zero in every unit. */
int dims_agree(Builder *b, const Value *x, const Value *y, Span why);

/* For messages: the unit of a value as it was written, or that of its dimension; "in [m]", "a pure number". */
const char *shown_unit(const Builder *b, const Value *v);
const char *in_unit(const Builder *b, const char *unit);
const char *in_dim(const Builder *b, Dim d);

/* Adds to a message about two dimensions (DIM_ANY: about one) where a name without a unit in them has its own
 * from, or that it does not matter which one it has. */
void explain_dims(Builder *b, Dim x, Dim y);

/* Puts the units that were found into the model. */
void settle_units(Builder *b);

/* rotation.c */

/* c = 0 for the unit quaternion whose first coordinate is given. */
void hold_rotation(Builder *b, Name name, uint32_t coord, Span span);

/* What L gains: a term in the rates that no motion has, so that the mass matrix is regular in all directions. */
void add_rotation_inertia(Builder *b);

/* The rates of a rotation q that turns at w, in its own frame; and back. */
Value rotation_rates(Builder *b, const Value *q, const Expr *w);
void rotation_spin(Builder *b, const Value *q, const Value *rates, Expr *w);

/* The coordinate of a rotation, R.w, whose angular velocity a place speaks of, `omega(R)`; -1: it speaks of none. Wrong ones are reported, -2. */
int spin_target(Builder *b, AstId place, Name effect);


/* The force on a rotation is a torque in its own frame: what it is along the four components. */
Value torque_force(Builder *b, const Value *q, const Value *torque);

/* constraint.c: adds what a constraint says to the model; the multiplier of the constraint that an argument names, FAILED (reported)
 * where there is none. */
void add_constraint(Builder *b, const AstStmt *st, Name effect);
void add_contact(Builder *b, const AstStmt *st, Name effect);

/* symmetry.c: declares a symmetry, and its charge; reads what it does, after L is known. */
void declare_symmetry(Builder *b, const AstStmt *st, Name effect);
void add_symmetry(Builder *b, const AstStmt *st, Name effect);

/* twice.c: names of scenes, effects, events and expectations, each declared once, and what a scene or an event says, said once;
 * reported where they are not. */
void check_names_once(Builder *b, const FileIndex *file);
void check_name_is_new(Builder *b, const char *what, Name name, Name effect, Span span);
void check_said_once(Builder *b, const AstStmt *block);

/* event.c: an event, and a section, of the model; a value given to a symbol: a coordinate, a state, or the rate of one, declared in `unit`;
 * reports shapes that differ. */
void add_event(Builder *b, const AstStmt *st, Name effect);
void add_section(Builder *b, const Section *s);
Value resolve_for(Builder *b, AstId id, Name effect, SymId target, const Unit *unit);
void report_shapes(Builder *b, Span span, uint32_t left, uint32_t right);

/* start.c: `start q = ...`, `exact q = ...`; what the scene says of rotations, when all of it is said (those that it does not set are no
 * turn at all); the unit of angular velocities. */
void set_motion(Builder *b, const AstStmt *st);
void settle_rotations(Builder *b);
Unit spin_unit(const Builder *b);

/* advice.c: there is no `effect.name`. */
void report_no_member(Builder *b, Span span, Name effect, Name name);

/* scene.c: which statements are active (those of the effect `also` too), and the scene's contents. */
void scene_select(Builder *b, const ModelChoice *choice);
void scene_build(Builder *b, const ModelChoice *choice);

/* method.c: the scene's method. */
void scene_method(Builder *b, const AstStmt *st);

#endif
