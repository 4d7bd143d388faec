/* State of an evaluation of an expression (Eval), and the functions that evaluate its nodes; included by this folder
 * only. */
#pragma once

#include "model/builder.h"

/* A `sum` or `product` in progress: its body is evaluated once per index value. */
typedef struct {
  AstId construct;
  int64_t at, hi;
  uint32_t base; /* index of its first term in Eval.terms */
  int64_t end, last; /* of the part of the range in progress, and of the range */
} Loop;

/* Operand of a chain of + and -, or of * and /. */
typedef struct {
  AstId at;
  int inverted; /* a subtrahend, or a divisor */
} Operand;

typedef struct Eval Eval;
struct Eval {
  Builder *b;
  Context where;
  Name effect;
  const Instance *function;   /* the instance whose arguments are in scope, or NULL */
  EntKind kind;               /* definition being evaluated: ENT_LET, ENT_OBSERVE, ENT_FUNCTION; ENT_NONE: none */
  uint32_t definition;        /* its index in b->lets, b->observes or b->instances */
  IndexVars index;            /* indices of the definition and of enclosing sums */
  int in_statement;           /* the indices of b->index are in scope too */
  int waiting;                /* suspended until b->needed has a value */
  AstId first, root, pc;
  uint32_t cap;
  Value *value;        /* [i] value of node first + i */
  /* [i] node first + i is skipped: its parent reads it (chain operand, name before an index) */
  unsigned char *by_parent;
  AstId *guarded;      /* [i] the sum, product or `if` whose body or branch begins at node first + i, or 0 */
  VEC(Loop) loops;
  VEC(Value) terms;    /* terms of all loops in progress */
  struct Quantified *sums; /* the sum over pairs in progress that is not written out; NULL: none */
  AstId written_out;       /* the last sum over pairs that has no such form */
  uint32_t rounds;     /* body evaluations so far, all loops together */
  VEC(Operand) operands;
};

static const Value FAILED = {0};

/* A scalar value that is not a condition. */
static inline Value a_value(Expr e, Dim dim, int bare) { return (Value){.e = e, .dim = dim, .bare = bare}; }

/* Reports an error, as diag_error does; returns FAILED. */
Value refuse(Builder *b, Span span, const char *fmt, ...) __attribute__((format(printf, 3, 4)));

/* Number of components. */
static inline uint32_t component_count(const Value *v) { return v->n ? v->n : 1; }

static inline Value *value_of(const Eval *ev, AstId id) { return &ev->value[id - ev->first]; }

/* check_units.c, each 0 and reported on failure: two values may be added; a value is a pure number (angles are), as
 * `what` requires; node x may have a temperature in degC as operand. refuse_point reports such an operand; 0. */
int operands_agree(Eval *ev, Span span, AstId x, AstId y);
int need_pure(Eval *ev, AstId arg, const char *what);
int point_fits(Eval *ev, const AstExpr *x, AstId operand);
int refuse_point(Eval *ev, AstId operand, const char *why);

/* 1 if the value's type suits node x: conditions in logic and first in `if`, vectors where x takes vectors; 0,
 * reported. */
int operand_fits(Eval *ev, const AstExpr *x, AstId operand);

/* 1 if two values have the same shape; 0, reported, if not. */
int same_shape(Eval *ev, Span span, AstId x, AstId y);

/* Returns e, the value of x, and records x in Model.written the first time a node that may jump appears. */
Expr record_jump(Eval *ev, const AstExpr *x, Expr e);

/* resolve_bracket.c: value of {f, g} where Builder.brackets. */
Value bracket_value(Eval *ev, const AstExpr *x);
Value action_value(Eval *ev, const AstExpr *x);

/* Value of a number, an operator, or a tuple. */
Value operator_value(Eval *ev, AstId id);
Value power_value(Eval *ev, const AstExpr *x, AstId base_id, AstId exp_id);
void report_condition(Builder *b, AstId id);

/* resolve_name.c: names, members of families and effects, components. */
Value name_value(Eval *ev, const AstExpr *x);
Value index_value(Eval *ev, const AstExpr *x);
Value member_value(Eval *ev, const AstExpr *x);

/* Argument `name` of the function whose body is being evaluated, or NULL. */
const Value *function_argument(const Builder *b, const Instance *function, Name name);

/* v, the value of a let or of a call; where a start is given, refused if anything but parameters is in it. */
Value known_at_start(Eval *ev, Value v, Name name, Span span);

/* Suspends the evaluation until a let, an observable or a function instance has a value. If that one is in progress,
 * the definition is circular: reported. */
void suspend_for(Eval *ev, EntKind kind, uint32_t index, Progress progress, Name name, Span span);

/* resolve_function.c: stores the value of an instance's body; an error in the body is attributed to the call. */
void finish_instance(Builder *b, Instance *in, Value v);

/* Declares symbols for first and second rates of an instance's arguments. */
void need_rates(Builder *b, Instance *in);
/* Value of a call of a user function. */
Value call_function(Eval *ev, const AstExpr *x, const Entity *e);

/* The user function that x calls, or NULL. */
const Entity *own_function(const Eval *ev, const AstExpr *x);

/* rotation.c: product p q (rotation by q, then by p); vector v rotated by q; rotation coordinate (rates: its rates)
 * as a value. */
Value rotation_product(Builder *b, const Value *p, const Value *q);
Value rotation_turn(Builder *b, const Value *q, const Value *v);
Value rotation_at(const Builder *b, uint32_t coord, int rates);

/* Values of omega(R), turn(axis, angle), transpose(R). */
Value omega_value(Eval *ev, const AstExpr *x);
Value turn_value(Eval *ev, const AstExpr *x);
Value transpose_value(Eval *ev, const AstExpr *x);

/* Reports the misuse of a rotation, written `text`; returns FAILED. */
typedef enum {
  TURN_SUM, TURN_INVERSE, TURN_SCALED, TURN_BEHIND, TURN_PRIME, TURN_EQUATION, TURN_VALUE, TURN_NUMBER
} TurnMistake;
Value refuse_rotation(Builder *b, Span span, const char *text, TurnMistake why);

/* entities.c: dimension of lambda, as lambda c is an energy, for velocity constraints a power; appends the
 * constraint c = 0 of dimension dim, with its multiplier. */
Dim multiplier_dim(Builder *b, Dim dim, int holonomic);
void add_scalar_constraint(Builder *b, Name name, Expr c, Dim dim, Span span);

/* constraint.c, for guides, too. check_slip: the velocity of slipping is linear in velocities, as derive checks, and
 * that of the gap, unless NULL, in units; one component in a plane, two in space. coefficient: option `word` of st, a
 * number up to `most` called `what`, or `other` where it is not given; each 0, reported. push_tangent: the tangent
 * NAME.slip of `owner`, along t.gap; `pressed` is the force that friction follows. */
int check_slip(Builder *b, const AstStmt *st, AstId id, const Value *slip, const Constraint *gap);
/* The gap and the restitution e of a contact; its options; a coefficient of it up to `most`. 0: reported. */
int check_contact(Builder *b, const AstStmt *st, Name name, const Value *gap, const Value *e);
int check_contact_options(Builder *b, const AstStmt *st);
int check_pure_number(Builder *b, const AstStmt *st, AstId id, const Value *x, double most, const char *what);
/* The coefficient of static friction of st, at least `friction`; 0: reported. */
Expr static_coefficient(Builder *b, const AstStmt *st, Name effect, Expr friction);
Expr coefficient(Builder *b, const AstStmt *st, Name effect, const char *word, double most, const char *what,
                 Expr other);
void push_tangent(Builder *b, const AstStmt *st, Name owner, Contact t, Expr pressed, Dim dim, const char *component);

/* resolve_multiplier.c: value of lambda(NAME), the constraint's multiplier; a vector for a vector constraint. */
Value multiplier_value(Eval *ev, const AstExpr *x);

/* Converts the value of an index expression to an integer; 0, reported, if it is none. */
int whole_number(Builder *b, const Value *v, AstId id, int64_t *out);

/* Whether a sum over neighbours stands in a sum over its first index; 0, reported. */
int quantified_fits(Eval *ev, AstId id);

/* After a turn of the sum `id`: whether the cut-off and the box of its neighbours rest; 0, reported. */
int quantified_judge(Eval *ev, AstId id);

/* quantified_sum.c: the last index, from lo on, up to which each `if` of the sum's body that compares the index takes
 * one branch, where the sum may stay one: it is the sum over such parts. */
int64_t quantified_part(Eval *ev, AstId id, int64_t lo, int64_t hi);

/* quantified_sum.c: starts the sum `id` over i in lo .. hi, or the sum inside it, as one over representative pairs;
 * 0: it has no such form; -1: its value is set. quantified_next takes the value v of a body: 1: evaluate it again;
 * 0: *v is that of the sum. */
int quantified_begin(Eval *ev, AstId id, int64_t lo, int64_t hi);
int quantified_next(Eval *ev, Value *v);

/* family_sums.c: starts the sum in a statement of a family as one nest for all members, as quantified_begin does; keeps
 * the value of a sum or product that all members have. */
int family_sum_begin(Eval *ev, AstId id, int64_t lo, int64_t hi);
void family_sum_keep(const Eval *ev, AstId id, const Value *v);

/* Whether the name of an index stands for its symbol there, as all turns have one body. */
int quantified_counts(const Eval *ev, const AstExpr *name);

/* `sum` and `product`: loop_begin evaluates the range and starts a loop (0: empty or wrong range, the value is set);
 * loop_next appends the body's value as a term (1: next index; 0: end, the value is set). */
int loop_begin(Eval *ev, AstId id);
int loop_next(Eval *ev);

/* resolve_exact.c: v at the start (`when` must be 0); exact(q) and error(q) in outputs. */
Value start_value(Eval *ev, Value v, Span span, const Value *when);
void report_start(Builder *b, Span span); /* a start value outside of `exact` */
int call_is_exact(const Eval *ev, Name name);
Value exact_value(Eval *ev, const AstExpr *x);

/* Value of a name without index; a family is reported. */
Value whole_value(Eval *ev, const Entity *e, Span span);

/* domain.c: condition under which node id, of value v, is real; condition under which a value is differentiable. */
Expr domain_of_node(const Eval *ev, AstId id, const Value *v);
Expr domain_of_derivative(const Builder *b, const Value *of);

/* resolve_time.c */
Value time_derivative(Builder *b, Value of, Span span, Context where);
Value unit_value(Eval *ev, const AstExpr *x);
Expr times_unit(Builder *b, Expr e, const Unit *u);

/* 1 if a function accepts vectors or rotations. */
int call_takes_vectors(const Eval *ev, const AstExpr *x);

/* 1 if a call has `want` arguments; 0, reported, if not. */
int arity_is(Eval *ev, const AstExpr *x, uint32_t want);

/* Value of a function call. */
Value call_value(Eval *ev, const AstExpr *x);
