/* One evaluation of an expression, shared by the files resolve*.c only. */
#ifndef LAGC_RESOLVE_IMPL_H
#define LAGC_RESOLVE_IMPL_H

#include "model/builder.h"

/* A sum or a product whose body is being evaluated, once for each value of its index. */
typedef struct {
  AstId construct;
  int64_t at, hi;
  uint32_t base; /* its first term in Eval.terms */
} Loop;

/* An operand of a chain of + and -, or of * and /. */
typedef struct {
  AstId at;
  int inverted; /* subtracted, or divided by */
} Operand;

typedef struct Eval Eval;
struct Eval {
  Builder *b;
  Context where;
  Name effect;
  const Instance *function;   /* whose arguments are in scope, or NULL */
  EntKind kind;               /* what is being defined: ENT_LET, ENT_FUNCTION; ENT_NONE: nothing */
  uint32_t definition;        /* its place in b->lets, or in b->instances */
  IndexVars index;            /* of the sums around, and of the definition */
  int in_statement;           /* the indices of b->index are in scope too */
  int waiting;                /* for b->needed */
  AstId first, root, pc;
  uint32_t cap;
  Value *value;        /* of node first + i */
  unsigned char *open; /* node first + i is gathered by its parent, or nobody's business */
  AstId *guarded;      /* the sum, product or `if` whose body or branch begins at node first + i, or 0 */
  VEC(Loop) loops;
  VEC(Value) terms;    /* of all open loops */
  uint32_t rounds;     /* of all loops so far */
  VEC(Operand) operands;
};

static const Value FAILED = {0};

/* The value of something that is a number, not a condition. */
static inline Value a_value(Expr e, Dim dim, int bare) { return (Value){.e = e, .dim = dim, .bare = bare}; }

/* Number of components. */
static inline uint32_t parts_of(const Value *v) { return v->n ? v->n : 1; }

static inline Value *value_of(const Eval *ev, AstId id) { return &ev->value[id - ev->first]; }

/* check_units.c: whether two values may be added, reported where they may not; a demand for a pure number
 * (an angle is one), `what` asks for it; whether what the node makes of temperatures in degC has a meaning. */
int operands_agree(Eval *ev, Span span, AstId x, AstId y);
int need_pure(Eval *ev, AstId arg, const char *what);
int point_fits(Eval *ev, const AstExpr *x, AstId operand);
int refuse_point(Eval *ev, AstId operand, const char *why);

/* Whether the value of an operand can stand in x: a condition in a condition, and first in `if`; a vector
 * where vectors are taken; reported where it cannot. */
int operand_fits(Eval *ev, const AstExpr *x, AstId operand);

/* Whether two values have the same shape; reported where they have not. */
int same_shape(Eval *ev, Span span, AstId x, AstId y);

/* e, which x stands for: noted in Model.written, where it may jump and is new there. */
Expr note_written(Eval *ev, const AstExpr *x, Expr e);

/* The value of a number, an operator, or a tuple. */
Value operator_value(Eval *ev, AstId id);
Value power_value(Eval *ev, const AstExpr *x, AstId base_id, AstId exp_id);
void report_condition(Builder *b, AstId id);

/* resolve_name.c: names, members of families and effects, components. */
Value name_value(Eval *ev, const AstExpr *x);
Value index_value(Eval *ev, const AstExpr *x);
Value member_value(Eval *ev, const AstExpr *x);

/* The argument called `name`, when a function's body is evaluated; otherwise NULL. */
const Value *function_argument(const Builder *b, const Instance *function, Name name);

/* Lets the evaluation wait for a let, or an instance of a function, which is begun when it returns. When that
 * is already being evaluated it is defined by itself, which is reported. */
void wait_for(Eval *ev, EntKind kind, uint32_t index, Progress progress, Name name, Span span);

/* resolve_function.c: an instance of a function, at the end of b->instances, for arguments of these shapes (0: a
 * number, 2, 3), not evaluated yet; resolve_instance evaluates it. */
Instance *new_instance(Builder *b, uint32_t function, const uint32_t *shapes);
const Instance *resolve_instance(Builder *b, uint32_t function, const uint32_t *shapes);

/* Its body has the value v; an error in it is said to be one of the call. */
void finish_instance(Builder *b, Instance *in, Value v);

/* Gives the arguments of an instance symbols for their rates. */
void need_rates(Builder *b, Instance *in);
/* A call of a function of the model's own. */
Value call_function(Eval *ev, const AstExpr *x, const Entity *e);

/* The function of the model's own that x calls, or NULL. */
const Entity *own_function(const Eval *ev, const AstExpr *x);

/* rotation.c: turns by q, then by p; the vector that q makes of v of three components; R as a value, from its first coordinate. */
Value rotation_product(Builder *b, const Value *p, const Value *q);
Value rotation_turn(Builder *b, const Value *q, const Value *v);
Value rotation_coordinate(const Builder *b, uint32_t coord);

/* omega(R), turn(axis, angle), transpose(R); their names, NULL past the end. */
Value rotation_function(Eval *ev, const AstExpr *x);
int call_is_of_rotation(Name name);
const char *rotation_function_name(size_t i);

/* Reports a rotation, written `text`, where it has no meaning; FAILED. */
typedef enum {
  TURN_SUM, TURN_NEGATION, TURN_DIVISOR, TURN_SCALED, TURN_BEHIND, TURN_PLANE, TURN_PRIME, TURN_UNIT, TURN_EQUATION, TURN_VALUE, TURN_NUMBER
} TurnMistake;
Value refuse_rotation(Builder *b, Span span, const char *text, TurnMistake why);

/* constraint.c: c = 0, of dimension dim. */
void add_scalar_constraint(Builder *b, Name name, Expr c, Dim dim, Span span);

/* constraint.c: lambda(NAME), the multiplier of a constraint; of a constraint of vectors a vector. */
Value multiplier_value(Eval *ev, const AstExpr *x);

/* The number an index expression stands for, or 0, reported. */
int whole_number(Builder *b, const Value *v, AstId id, int64_t *out);

/* Sums and products: starts one whose range is known (0: nothing to do, its value is there), takes
 * the value of its body in (1: the body once more), and gives its value. */
int loop_begin(Eval *ev, AstId id);
int loop_next(Eval *ev);

/* resolve_exact.c: v at the time `when`, which is the start; exact(q) and error(q), where they have a meaning. */
Value start_value(Eval *ev, Value v, Span span, const Value *when);
void report_start(Builder *b, Span span); /* where it has none */
int call_is_exact(const Eval *ev, Name name);
Value exact_value(Eval *ev, const AstExpr *x);

/* A name without an index. */
Value whole_value(Eval *ev, const Entity *e, Span span);

/* domain.c: where node id, of value v, has a real value; where the derivatives of a value exist besides. */
Expr domain_of_node(const Eval *ev, AstId id, const Value *v);
Expr domain_of_derivative(const Builder *b, const Value *of);

/* resolve_time.c */
Value time_derivative(Builder *b, Value of, Span span, Context where);
Value unit_value(Eval *ev, const AstExpr *x);
Expr times_unit(Builder *b, Expr e, const Unit *u);

/* Whether a function takes vectors. */
int call_takes_vectors(const Eval *ev, const AstExpr *x);

/* Whether a call has so many arguments; reported when it has not. */
int arity_is(Eval *ev, const AstExpr *x, uint32_t want);

/* The value of an AST_CALL. */
Value call_value(Eval *ev, const AstExpr *x);

#endif
