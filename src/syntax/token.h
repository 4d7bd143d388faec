/* Tokens, from the scanner through the filter to the parser.
 *
 * One table names them all: lag.y declares the same names (its epilogue maps one to the other, and a
 * token missing there does not compile), the filter reads the flags, messages use the words. */
#pragma once

#include "syntax/ast.h"

enum {
  T_BINARY = 1 << 0,  /* a line that begins with it continues the line before */
  T_OPENS = 1 << 1,   /* the line after it continues it */
  T_OPERAND = 1 << 2, /* an operand may end with it */
  T_START = 1 << 3,   /* an operand may begin with it */
  T_BLOCK = 1 << 4,   /* a statement whose first `{` opens a block of statements */
  /* statement words: where they may stand */
  W_FILE = 1 << 5,
  W_EFFECT = 1 << 6,
  W_FOR = 1 << 7,
  W_SCENE = 1 << 8,
  W_EVENT = 1 << 9,
  W_ANY = W_FILE | W_EFFECT | W_FOR | W_SCENE | W_EVENT
};

#define T_SIGN (T_BINARY | T_OPENS) /* a sign between two operands */
#define W_DECL (W_FILE | W_EFFECT)
#define W_EACH (W_FILE | W_EFFECT | W_FOR) /* statements that a `for` may repeat for each member of a family */

/* X(name, word in messages, flags). For statement words and slots the word is the spelling. */
#define TOKENS(X)                                  \
  X(FINISH, "end of file", 0)                      \
  X(BEGIN_FILE, "", 0)                             \
  X(BEGIN_EXPR, "", 0)                             \
  X(END, "the end of the statement", 0)            \
  X(NEWLINE, "end of line", 0)                     \
  X(SEMICOLON, ";", 0)                             \
  X(BAD, "", 0)     /* a mistake that the scanner found: text, help */ \
  X(BADWORD, "", 0) /* a name where only a statement word can stand */ \
  X(IDENT, "a name", T_OPERAND | T_START)          \
  X(NUMBER, "a number", T_OPERAND | T_START)       \
  X(STRING, "a text in quotes", T_OPERAND)         \
  X(UNIT, "a unit", T_OPERAND)                     \
  X(PRIME, "'", T_OPERAND)                         \
  X(LPAREN, "(", T_OPENS | T_START)                \
  X(RPAREN, ")", T_OPERAND)                        \
  X(INDEX, "[", T_OPENS)                           \
  X(RBRACKET, "]", T_OPERAND)                      \
  X(LBRACE, "{", T_OPENS | T_START)                \
  X(RBRACE, "}", T_OPERAND)                        \
  X(COMMA, ",", T_SIGN)                            \
  X(COLON, ":", T_SIGN)                            \
  X(DOT, ".", T_SIGN)                              \
  X(RANGE, "..", T_SIGN)                           \
  X(ARROW, "->", T_SIGN)                           \
  X(ASSIGN, "=", T_SIGN)                           \
  X(PLUS, "+", T_SIGN | T_START)                   \
  X(MINUS, "-", T_SIGN | T_START)                  \
  X(TIMES, "*", T_SIGN)                            \
  X(DIVIDE, "/", T_SIGN)                           \
  X(POWER, "^", T_SIGN)                            \
  X(LT, "<", T_SIGN)                               \
  X(LE, "<=", T_SIGN)                              \
  X(GT, ">", T_SIGN)                               \
  X(GE, ">=", T_SIGN)                              \
  X(EQ, "==", T_SIGN)                              \
  X(NE, "!=", T_SIGN)                              \
  X(AND, "and", T_SIGN)                            \
  X(OR, "or", T_SIGN)                              \
  X(NOT, "not", T_OPENS | T_START)                 \
  X(IN, "in", T_SIGN)                              \
  X(SUM, "sum", T_START)                           \
  X(PRODUCT, "product", T_START)                   \
  /* statement words */                            \
  X(MODEL, "model", W_FILE)                        \
  X(INCLUDE, "include", W_FILE)                    \
  X(COORD, "coord", W_DECL)                        \
  X(MOMENTUM, "momentum", W_DECL)                  \
  X(PARAM, "param", W_DECL)                        \
  X(CONST, "const", W_DECL)                        \
  X(INPUT, "input", W_DECL)                        \
  X(STATE, "state", W_DECL)                        \
  X(LET, "let", W_DECL)                            \
  X(FUNCTION, "function", W_DECL)                  \
  X(NETWORK, "network", W_FILE)                    \
  X(HAMILTONIAN, "hamiltonian", W_DECL)            \
  X(LAGRANGIAN, "lagrangian", W_DECL)              \
  X(KINETIC, "kinetic", W_DECL)                    \
  X(POTENTIAL, "potential", W_DECL)                \
  X(DISSIPATION, "dissipation", W_EACH)            \
  X(FORCE, "force", W_EACH)                        \
  X(FRICTION, "friction", W_EACH)                  \
  X(FLOW, "flow", W_EACH)                          \
  X(CONSTRAINT, "constraint", W_EACH)              \
  X(SYMMETRY, "symmetry", W_DECL)                  \
  X(CANONICAL, "canonical", W_FILE)                \
  X(EXPECT, "expect", W_EACH)                      \
  X(EVENT, "event", W_EACH | T_BLOCK)              \
  X(KICK, "kick", W_EACH | T_BLOCK)                \
  X(CONTACT, "contact", W_EACH)                    \
  X(GUIDE, "guide", W_EACH)                        \
  X(OBSERVE, "observe", W_EACH)                    \
  X(DRAW, "draw", W_EACH | W_SCENE)                \
  X(FOR, "for", W_EACH | T_BLOCK)                  \
  X(EFFECT, "effect", W_FILE | T_BLOCK)            \
  X(REQUIRES, "requires", W_EFFECT)                \
  X(EXCLUDES, "excludes", W_EFFECT)                \
  X(SCENE, "scene", W_FILE | T_BLOCK)              \
  X(START, "start", W_SCENE)                       \
  X(EXACT, "exact", W_SCENE)                       \
  X(USE, "use", W_SCENE)                           \
  X(SPAN, "span", W_SCENE)                         \
  X(METHOD, "method", W_SCENE)                     \
  X(TOLERANCE, "tolerance", W_SCENE)               \
  X(OUTPUT, "output", W_SCENE)                     \
  X(MONITOR, "monitor", W_SCENE)                   \
  X(MEASURE, "measure", W_SCENE)                   \
  X(LIKE, "like", W_SCENE)                         \
  X(STOP, "stop", W_EVENT)                         \
  /* words of a fixed slot */                      \
  X(PERIODIC, "periodic", 0)                       \
  X(RISING, "rising", 0)                           \
  X(FALLING, "falling", 0)                         \
  X(CROSSING, "crossing", 0)                       \
  X(RESTITUTION, "restitution", 0)                 \
  X(ON, "on", 0)                                   \
  X(OF, "of", 0)                                   \
  X(STATIC, "static", 0)                           \
  X(SLIP, "slip", 0)                               \
  X(TANGENTIAL, "tangential", 0)                   \
  X(LAW, "law", 0)                                 \
  X(EXACTLY, "exactly", 0)                         \
  X(GUESS, "guess", 0)                             \
  X(EVERY, "every", 0)                             \
  X(WHILE, "while", 0)                             \
  X(FROM, "from", 0)                               \
  X(LAYERS, "layers", 0)                           \
  X(SHAPE, "a shape such as `ball`", 0)            \
  X(CLAUSE, "an option", T_OPENS)

#define TOKEN_ENUM_(name, word, flags) TOK_##name,
typedef enum { TOKENS(TOKEN_ENUM_) TOK_COUNT } TokKind;
#undef TOKEN_ENUM_

typedef struct {
  TokKind kind;
  Span span;
  uint32_t depth;   /* blocks around its statement; set by the filter */
  TokKind follows;  /* END: the sign that ended the statement; BADWORD: the next token */
  uint32_t dots;    /* IDENT: the dots above it, each a prime; the filter turns them into PRIMEs */
  Name name;        /* IDENT, BADWORD and words: the spelling */
  Num number;       /* NUMBER */
  AstUnit unit;     /* UNIT */
  const char *text; /* STRING: without quotes; BAD: the message */
  const char *help; /* BAD: advice, or NULL */
} Token;

const char *token_word(TokKind kind);
unsigned token_flags(TokKind kind);

static inline int token_ends_operand(TokKind kind) { return (token_flags(kind) & T_OPERAND) != 0; }

/* Whether `kind` is in set[n]. */
static inline int token_is_in(const TokKind *set, int n, TokKind kind) {
  for (int i = 0; i < n; i++)
    if (set[i] == kind) return 1;
  return 0;
}

/* The statement word spelled `name` that may stand in one of the places `where`, or TOK_IDENT. */
TokKind token_statement(Name name, unsigned where);
