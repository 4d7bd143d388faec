/* Advice for known mistakes: a table of words from other languages, and one function for each kind of unexpected
 * token. */
#include "syntax/parse_state.h"

#include <ctype.h>
#include <string.h>

#include "base/words.h"
#include "numeric/functions.def"
#include "syntax/parse.h"

/* ---- words ---- */

enum { W_MODEL = W_FILE | W_EFFECT | W_FOR };

/* words: no keywords, separated by spaces; where: the blocks in which people write them; way: the advice. */
static const struct {
  const char *words;
  unsigned where;
  const char *way;
} ways[] = {
    {"coordinate coordinates coords variable variables var vars dof", W_MODEL,
     "a coordinate is declared by `coord x [m]`"},
    {"rotation rotations orientation attitude quaternion", W_MODEL,
     "a rotation is a coordinate, too: `coord R: rotation`"},
    {"vector vec", W_MODEL, "a vector is a coordinate, too: `coord r: vec3 [m]`"},
    {"parameter parameters params par", W_MODEL, "a parameter is declared by `param k = 1 [N/m]`"},
    {"constant constants consts", W_MODEL,
     "write `param g = 9.81 [m/s^2]`; `const N = 10` is a number fixed when compiling, such as the size of a family"},
    {"def define set var", W_MODEL, "an abbreviation is made by `let a = …`, a function by `function f(x) = …`"},
    {"L lagrange lagr", W_MODEL, "the Lagrangian is given by `lagrangian = …`"},
    {"T kinetic_energy", W_MODEL, "the kinetic energy is given by `kinetic = …`"},
    {"V U potential_energy", W_MODEL, "the potential energy is given by `potential = …`"},
    {"H hamilton", W_MODEL, "the Hamiltonian is given by `hamiltonian = …`, each momentum by `momentum p of x`"},
    {"momenta impulse", W_MODEL, "the momentum of a coordinate is declared by `momentum p of x`"},
    {"D R damping damp rayleigh drag loss losses", W_MODEL,
     "losses are a Rayleigh function, `dissipation = c/2*x'^2`, or a `force`"},
    {"torque moment Q forces", W_MODEL, "a generalised force is given by `force q = …`; of an angle it is a torque"},
    {"equation equations eq eom ode", W_MODEL,
     "equations of motion follow from the Lagrangian; `expect x'' = …` checks one of yours, `flow z' = …` is for a "
     "state"},
    {"import require load using", W_MODEL, "another file is included by `include \"file.lag\"`"},
    {"initial init initials ic start", W_MODEL, "starts stand in a scene: `scene s { start x = 1 }`"},
    {"simulation simulate sim run experiment case", W_MODEL,
     "a simulation is a scene: `scene s { start x = 1; span 20 [s] }`"},
    {"time tspan duration tmax", W_MODEL, "the time of a run stands in a scene: `span 20 [s]`"},
    {"plot print", W_MODEL, "columns are chosen in a scene: `output x, y every 0.01 [s]`; `lagc plot` draws"},
    {"initial init initials ic", W_SCENE, "a start is set by `start x = 1, x' = 0`"},
    {"duration time times tspan tmax until end t_end tend stop", W_SCENE, "the time of a run is `span 20 [s]`"},
    {"dt step steps stepsize h", W_SCENE,
     "a step is an option of a method: `method rk4(step = 0.01)`; rows of output have `every 0.01 [s]`"},
    {"tol rtol atol accuracy precision eps", W_SCENE, "write `tolerance 1e-9`"},
    {"integrator solver integrate scheme", W_SCENE,
     "a method is chosen by `method rk4(step = 0.01)`; `lagc help methods` lists them"},
    {"plot print save write show record columns", W_SCENE, "columns are chosen by `output x, y every 0.01 [s]`"},
    {"every sample", W_SCENE, "write `output x, y every 0.01 [s]`"},
    {"with effects enable on", W_SCENE, "effects are turned on by `use drag`"},
    {"without disable off", W_SCENE, "`use none` turns all effects off; without `use` none is on"},
    {"from extends inherit based", W_SCENE, "a scene inherits from another by `like OTHER`"},
    {"set let", W_SCENE, "a value is set by `name = 2`, a start by `start x = 1`"},
    {"terminate end halt exit quit", W_EVENT, "the run is ended by `stop`"},
};

const char *advice_for_word(const char *word, unsigned where) {
  for (size_t i = 0; i < sizeof ways / sizeof *ways; i++)
    if ((ways[i].where & where & W_ANY) && has_word(ways[i].words, word)) return ways[i].way;
  return NULL;
}

const char *parse_advice(const char *word) { return advice_for_word(word, W_ANY); }

/* ---- tokens ---- */

/* Functions that people write without parentheses. */
static int is_function(const char *name) {
#define WORD(OP, name, ...) #name " "
  return name && has_word(FUNCTIONS(WORD) "ln sqrt abs max min mean rms hit count", name);
}

/* Whether an `=` follows the current token (after primes): then it begins another member of a list. */
static int sets_next(const Parse *cx) {
  const Source *source = cx->filter->scan->source;
  const char *s = source->text + (cx->current.span.end - source->base);
  s += strspn(s, "' \t");
  return s[0] == '=' && s[1] != '=';
}

/* Two statements on one line. */
static const char *missing_end(const Parse *cx) {
  const Token *t = &cx->current;
  const Filter *f = cx->filter;
  if (t->kind != TOK_IDENT || !token_ends_operand(cx->before.kind) || cx->open.span.end || sets_next(cx)) return NULL;
  if (token_statement(t->name, f->where[f->depth]) == TOK_IDENT) return NULL;
  return arena_printf(cx->ast->arena, "put a `;` before `%s`, or a new line: a statement ends there", t->name);
}

/* Two adjacent names where a list is expected. */
static const char *missing_comma(const Parse *cx, const TokKind *set, int n) {
  const Token *t = &cx->current;
  if (t->kind != TOK_IDENT || !token_is_in(set, n, TOK_COMMA) || cx->open.span.end) return NULL;
  switch (cx->filter->word) {
  case TOK_PARAM: case TOK_CONST: case TOK_INPUT: case TOK_LET: case TOK_OBSERVE: case TOK_START: case TOK_FLOW:
  case TOK_EXACT: return sets_next(cx) ? arena_printf(cx->ast->arena, "put a `,` before `%s`", t->name) : NULL;
  case TOK_COORD: case TOK_STATE: case TOK_USE: case TOK_REQUIRES:
  case TOK_EXCLUDES: return arena_printf(cx->ast->arena, "put a `,` before `%s`", t->name);
  case TOK_OUTPUT: return arena_printf(cx->ast->arena, "put a `,` before `%s`; a product is written with `*`", t->name);
  default: return NULL;
  }
}

/* Advice after an operand, where an operator is expected. */
static const char *missing_operator(const Parse *cx) {
  const Token *t = &cx->current, *b = &cx->before;
  if ((t->name && has_word("if then else when where", t->name)) || (b->name && has_word("if then else", b->name)))
    return "a choice is written `if(x > 0, a, b)`: a where the condition holds, b where not";
  if (t->name && strcmp(t->name, "mod") == 0) return "a remainder is `mod(a, b)`";
  if (t->kind == TOK_IDENT && b->kind == TOK_NUMBER)
    return arena_printf(cx->ast->arena, "a unit stands in brackets: `[%s]`; a product is written with `*`", t->name);
  if (b->kind == TOK_IDENT && is_function(b->name))
    return arena_printf(cx->ast->arena, "a function takes its argument in parentheses: `%s(...)`", b->name);
  return "a product is written with `*`";
}

/* model, scene, effect: a name, a description, a block. */
static const char *misshapen_title(const Parse *cx, const TokKind *set, int n) {
  TokKind word = cx->filter->word;
  if (word != TOK_MODEL && word != TOK_SCENE && word != TOK_EFFECT) return NULL;
  if (cx->before.kind == word)
    return arena_printf(cx->ast->arena, "a name comes first: `%s NAME \"what it is\"`", token_word(word));
  if (token_is_in(set, n, TOK_STRING) && cx->current.kind != TOK_END && cx->current.kind != TOK_COLON)
    return "a name has letters, digits and `_`; a description stands in quotes";
  return NULL;
}

/* `start x = 1, span 5`: a word that begins a statement stands in a list. */
static const char *word_in_list(const Parse *cx, const TokKind *set, int n) {
  const Token *b = &cx->before;
  const Filter *f = cx->filter;
  if (!token_is_in(set, n, TOK_ASSIGN) || b->kind != TOK_IDENT ||
      token_statement(b->name, f->where[f->depth]) == TOK_IDENT)
    return NULL;
  return arena_printf(cx->ast->arena, "`%s` begins a statement of its own: a new line, or a `;`, stands before it",
                      b->name);
}

#define ANY TOK_COUNT
#define COMPARISON TOK_LT

#define CONTACT_FORM                                                                                                  \
  "a contact has a restitution, and with friction also the velocity of slipping: `contact NAME: y >= 0, restitution " \
  "= 0.5, friction = mu, slip = x'`"

#define GUIDE_FORM "a guide holds on both sides, with friction by its own force: `guide NAME: y = 0, friction = mu`"

#define PARAM_FORM "a parameter has a value, which scenes can change: `param m = 1 [kg]`"
#define INPUT_FORM "an input has a value, which scenes and runs can replace: `input u [N] = 0`"
#define FORCE_FORM "a force acts along a coordinate, `force x = …`, or at a point, `force (px, py) = (…, …)`"

/* Mistakes by their tokens: the statement's word, the unexpected token, one that is expected, one that is not. The
 * first row that fits counts; %s in its advice is the name before the token. */
static const struct {
  TokKind word, found, wants, lacks;
  const char *advice;
} slips[] = {
    {TOK_CONSTRAINT, ANY, TOK_COLON, TOK_TIMES, "a constraint has a name: `constraint NAME: x^2 + y^2 = l^2`"},
    {TOK_CONSTRAINT, ANY, TOK_IDENT, TOK_NUMBER, "a constraint has a name: `constraint NAME: x^2 + y^2 = l^2`"},
    {TOK_CONTACT, ANY, TOK_COLON, TOK_TIMES, "a contact has a name: `contact NAME: y >= 0, restitution = 0.5`"},
    {TOK_CONTACT, ANY, TOK_IDENT, TOK_NUMBER, "a contact has a name: `contact NAME: y >= 0, restitution = 0.5`"},
    {TOK_FRICTION, TOK_ASSIGN, ANY, ANY,
     "dry friction is `friction NAME on q: mu*N`; viscous losses are a Rayleigh function, `dissipation = c/2*x'^2`"},
    {TOK_FRICTION, ANY, TOK_ON, ANY, "dry friction has a name and a place: `friction NAME on q: mu*N`"},
    {TOK_FRICTION, ANY, TOK_STATIC, ANY,
     "after its size a friction has a static limit and nothing else: `friction NAME on q: mu*N, static = mu_s*N`"},
    {TOK_EVENT, ANY, TOK_COLON, TOK_TIMES, "an event has a name: `event NAME: x - 1 rising { … }`"},
    {TOK_EVENT, ANY, TOK_IDENT, TOK_NUMBER, "an event has a name: `event NAME: x - 1 rising { … }`"},
    {TOK_KICK, ANY, TOK_EVERY, ANY, "a kick has a name and a period: `kick NAME every T { p = p + K*sin(q) }`"},
    {TOK_KICK, ANY, TOK_IDENT, TOK_NUMBER, "a kick has a name and a period: `kick NAME every T { p = p + K*sin(q) }`"},
    {TOK_CONTACT, ANY, TOK_RESTITUTION, ANY, CONTACT_FORM},
    {TOK_CONTACT, TOK_COMMA, TOK_END, ANY, CONTACT_FORM},
    {TOK_CONTACT, TOK_END, TOK_COMMA, ANY, CONTACT_FORM},
    {TOK_CONTACT, ANY, TOK_SLIP, ANY, CONTACT_FORM},
    {TOK_CONTACT, TOK_IDENT, TOK_ASSIGN, ANY, CONTACT_FORM},
    {TOK_CONTACT, TOK_NUMBER, TOK_ASSIGN, ANY, CONTACT_FORM},
    {TOK_CONTACT, COMPARISON, ANY, ANY, "a contact is written `contact NAME: g >= 0, restitution = e`"},
    {TOK_GUIDE, COMPARISON, ANY, ANY, GUIDE_FORM "; a surface on one side is a contact"},
    {TOK_GUIDE, ANY, ANY, ANY, GUIDE_FORM},
    {TOK_MOMENTUM, ANY, TOK_OF, ANY, "a momentum names its coordinate: `momentum p of x`"},
    {TOK_SPAN, TOK_RANGE, ANY, ANY, "a run begins at 0, and lasts a time: `span 20 [s]`"},
    {TOK_METHOD, ANY, TOK_IDENT, ANY,
     "a method is chosen by `method rk4(step = 0.01)`; `lagc help methods` lists them"},
    {TOK_METHOD, ANY, TOK_LPAREN, ANY, "options stand in parentheses: `method %s(step = 0.01)`"},
    {ANY, TOK_COMMA, TOK_IN, ANY, "a range is written `i in 1..N`"},
    {ANY, TOK_ASSIGN, TOK_IN, ANY, "a range is written `i in 1..N`"},
    {ANY, TOK_IN, TOK_RBRACKET, ANY, "`for i in 1..N { … }` around a statement makes one for each i"},
    {ANY, ANY, TOK_IN, TOK_TIMES, "a range is written `i in 1..N`, a sum over it `sum(i in 1..N, x[i])`"},
    {ANY, TOK_IN, TOK_RPAREN, ANY, "a sum over two indices is a sum of sums: `sum(i in 1..N, sum(j in 1..K, x[i,j]))`"},
    {TOK_FOR, TOK_COMMA, TOK_LBRACE, ANY, "one `for` stands inside another: `for i in 1..N { for j in 1..K { … } }`"},
    {ANY, TOK_COMMA, TOK_RANGE, ANY, "a range is written `i in 1..N`"},
    {ANY, TOK_COMMA, TOK_RPAREN, ANY, "a function with several arguments has no `.` in its name: `pow(x, 2)`"},
    {ANY, TOK_RANGE, TOK_RBRACKET, ANY, "a family has a size: `x[N]` has the members 1 to N"},
    {ANY, TOK_EQ, TOK_ASSIGN, ANY, "write `=`: it states an equation; `==` compares two numbers"},
    {TOK_EVENT, TOK_ASSIGN, TOK_RISING, ANY,
     "an event is where an expression passes zero: `event e: x - 1 rising { … }`"},
    {ANY, TOK_ASSIGN, TOK_EQ, ANY, "write `==` to compare"},
    {TOK_COORD, TOK_ASSIGN, ANY, ANY, "its start stands in a scene: `start x = …`"},
    {TOK_STATE, TOK_ASSIGN, ANY, ANY, "its start stands in a scene: `start x = …`"},
    {ANY, TOK_COLON, TOK_LBRACE, TOK_NUMBER, "a block begins with `{`"},
    {ANY, TOK_COLON, TOK_ASSIGN, ANY, "write `%s = …`"},
    {TOK_MEASURE, TOK_LPAREN, TOK_ASSIGN, ANY, "a measure has a name: `measure top = max(y)`"},
    {TOK_MONITOR, TOK_END, TOK_NUMBER, ANY, "a monitor has a limit: `monitor energy 1e-8`"},
    {TOK_INPUT, TOK_COMMA, TOK_ASSIGN, ANY, INPUT_FORM},
    {TOK_INPUT, TOK_END, TOK_ASSIGN, ANY, INPUT_FORM},
    {TOK_PARAM, TOK_COMMA, TOK_ASSIGN, ANY, PARAM_FORM},
    {TOK_PARAM, TOK_END, TOK_ASSIGN, ANY, PARAM_FORM},
    {ANY, TOK_END, TOK_LBRACE, TOK_NUMBER, "a block begins with `{`"},
    {ANY, TOK_INDEX, TOK_UNIT, ANY, "a unit stands apart from the name: `u [N]`"},
    {TOK_EVENT, COMPARISON, TOK_RISING, ANY, "an event is where an expression passes zero: `x - 1 rising { … }`"},
    {ANY, COMPARISON, TOK_AND, ANY, "comparisons do not chain: write `a < b and b < c`"},
    {ANY, TOK_IN, TOK_IDENT, ANY, "`in` is a reserved word"},
    {ANY, TOK_AND, TOK_IDENT, ANY, "`and` is a reserved word"},
    {ANY, TOK_OR, TOK_IDENT, ANY, "`or` is a reserved word"},
    {ANY, TOK_NOT, TOK_IDENT, ANY, "`not` is a reserved word"},
    {TOK_FORCE, TOK_ASSIGN, TOK_IDENT, ANY, FORCE_FORM},
    {TOK_FORCE, TOK_LPAREN, TOK_ASSIGN, ANY, FORCE_FORM},
    {TOK_LAGRANGIAN, TOK_IDENT, TOK_ASSIGN, ANY, "write `lagrangian = …`, without a name"},
    {TOK_HAMILTONIAN, TOK_IDENT, TOK_ASSIGN, ANY, "write `hamiltonian = …`, without a name"},
    {TOK_KINETIC, TOK_IDENT, TOK_ASSIGN, ANY, "write `kinetic = …`, without a name"},
    {TOK_POTENTIAL, TOK_IDENT, TOK_ASSIGN, ANY, "write `potential = …`, without a name"},
    {TOK_START, TOK_LPAREN, TOK_ASSIGN, ANY, "a start is written `start x = 1, x' = 0`"},
    {TOK_START, TOK_NUMBER, TOK_IDENT, ANY, "a start is written `start x = 1, x' = 0`"},
    {TOK_IDENT, TOK_LPAREN, TOK_ASSIGN, ANY, "a start is written `start x = 1, x' = 0`"},
    {ANY, TOK_LPAREN, TOK_ASSIGN, ANY,
     "a name has no arguments here; declare a function of your own by `function %s(x) = …`"},
};

static const char *slip_advice(const Parse *cx, const TokKind *set, int n) {
  TokKind found = cx->current.kind;
  if ((found >= TOK_LT && found <= TOK_GE) || found == TOK_NE) found = COMPARISON;
  for (size_t i = 0; i < sizeof slips / sizeof *slips; i++) {
    if ((slips[i].word != ANY && slips[i].word != cx->filter->word) ||
        (slips[i].found != ANY && slips[i].found != found))
      continue;
    if ((slips[i].wants != ANY && !token_is_in(set, n, slips[i].wants)) ||
        (slips[i].lacks != ANY && token_is_in(set, n, slips[i].lacks)))
      continue;
    return arena_printf(cx->ast->arena, slips[i].advice, cx->before.name ? cx->before.name : "NAME");
  }
  return NULL;
}

/* 9,81 and x": the letters before and behind the token tell. */
static const char *foreign_sign(const Parse *cx) {
  const Token *t = &cx->current;
  const Source *source = cx->filter->scan->source;
  const char *s = source->text + (t->span.begin - source->base), *comma = t->kind == TOK_COMMA ? s : s - 1;
  int in_text = t->span.begin > source->base + 1 && cx->before.span.end;
  if (in_text && (t->kind == TOK_COMMA || t->kind == TOK_NUMBER) && *comma == ',' &&
      isdigit((unsigned char)comma[-1]) && isdigit((unsigned char)comma[1]))
    return "a number has a decimal point: `9.81`";
  if (t->kind == TOK_STRING && cx->before.span.end == t->span.begin) return "a second derivative has two primes: `x''`";
  return NULL;
}

const char *advice_for_token(const Parse *cx, const TokKind *set, int n) {
  const Token *t = &cx->current, *b = &cx->before;
  if (foreign_sign(cx)) return foreign_sign(cx);
  const char *end = missing_end(cx), *comma = end ? end : missing_comma(cx, set, n),
             *title = comma ? comma : misshapen_title(cx, set, n);
  const char *word = title ? title : word_in_list(cx, set, n), *slip = word ? word : slip_advice(cx, set, n);
  if (slip) return slip;
  if (cx->filter->word == TOK_MONITOR && !token_is_in(set, n, TOK_TIMES) && token_ends_operand(b->kind) &&
      (token_flags(t->kind) & T_BINARY))
    return "a monitor watches a name, or an expression in parentheses: `monitor (x + y) 1e-6`";
  switch (t->kind) {
    case TOK_UNIT: return b->kind == TOK_UNIT ? "an index touches its name, a unit does not: `x[N] [m]`" : NULL;
    case TOK_PRIME:
      if (b->kind == TOK_IDENT && b->span.begin == t->span.begin)
        return "a dot above a letter is a time derivative, as a `'` is: declare the name without it";
      return b->kind == TOK_END ? "a `'` never continues a line: put it on the line of its name" : NULL;
    case TOK_RPAREN: case TOK_RBRACKET:
      return token_is_in(set, n, TOK_TIMES) && !cx->open.span.end
                 ? arena_printf(cx->ast->arena, "this `%s` closes nothing", token_word(t->kind))
                 : NULL;
    case TOK_IDENT: case TOK_NUMBER: case TOK_LPAREN: case TOK_SUM: case TOK_PRODUCT:
      return token_is_in(set, n, TOK_TIMES) && token_ends_operand(b->kind) ? missing_operator(cx) : NULL;
    default: return NULL;
  }
}
