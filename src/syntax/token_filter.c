/* The filter between scanner and parser.
 *
 * In: raw tokens, where every name is an IDENT and every line end a NEWLINE.
 * Out: statements, each closed by exactly one END (also before the `}` of its block, and after it).
 *
 * Where a statement ends: at `;`, at `}`, and at the end of a line, unless the line goes on:
 *   - its last token is an operator or one of , = -> : .. ( [ { in not (unless the next line can
 *     only be a statement: `let a = 2*<newline> let b = 3` has lost an operand, not a line end)
 *   - the next line begins with an operator (a leading `-` too), one of = -> , .. : or `{`
 *   - a bracket is open, unless two operands would meet there (`sin(th <newline> let ...`): nothing
 *     could make sense of that, so the bracket was forgotten and the statement ends.
 * A leading `'` never continues a line.
 *
 * Keywords depend on the block that a statement stands in: the file, an effect, a `for`, a scene or an event.
 *   - In a file, effect or for, every statement begins with a keyword.
 *   - In a scene or event, a first name followed by = . ' or a touching [ is a name being set;
 *     otherwise it is a keyword.
 *   - A first name where a keyword must stand, but that is none of this block, becomes BADWORD.
 *   - `periodic`, `rising`, `falling`, `crossing` and `every` are keywords directly after an
 *     operand, in the statements that take them, and so is `while` in a constraint; `restitution` after the `,` of a
 *     contact, `on` and `static` of a friction, `exactly`
 *     and `guess` after `start` when a name follows; `for` after the `:` or `,` of a symmetry when a name
 *     follows; `sum` and `product` before `(`; in a `draw` the shape, and each name behind an operand.
 * Everywhere else a name is a name: a coordinate may be called `force`, `every` or `sum`.
 *
 * Must hold: at most two raw tokens of lookahead, no recursion; the depth of blocks is limited. */
#include "syntax/token_filter.h"

#include "base/words.h"

Filter *filter_new(Scan *scan, int single) {
  Filter *f = ARENA_NEW(scan->arena, Filter);
  f->scan = scan;
  f->single = single;
  f->where[0] = W_FILE;
  f->prev = TOK_END;
  return f;
}

const OpenBracket *filter_open_bracket(const Filter *f) {
  return f->brackets.n ? &f->brackets.at[f->brackets.n - 1] : NULL;
}

/* The raw token after the next k. */
static const Token *peek_at(Filter *f, uint32_t k) {
  while (f->n_ahead <= k) {
    f->ahead[f->n_ahead] = scan_next(f->scan);
    f->n_ahead++;
  }
  return &f->ahead[k];
}

static const Token *peek(Filter *f) { return peek_at(f, 0); }

static Token take_raw_token(Filter *f) {
  Token t = *peek(f);
  f->n_ahead--;
  if (f->n_ahead) f->ahead[0] = f->ahead[1];
  return t;
}

static Token out(Filter *f, Token t) {
  t.depth = f->depth;
  f->prev = t.kind;
  return t;
}

static Token end_statement(Filter *f, Span span, TokKind sign) {
  f->inside = f->end_due = f->assigned = 0;
  f->brackets.n = f->lists = f->pending_primes = 0;
  return out(f, (Token){.kind = TOK_END, .span = span, .follows = sign});
}

static Token bad(Filter *f, Span span, const char *message, const char *help) {
  return out(f, (Token){.kind = TOK_BAD, .span = span, .text = message, .help = help});
}

/* ---- ends of lines ---- */

/* Whether the next line can only be a new statement, although this one ends in an operator: it
 * begins with a word of the place and another operand, or it would be a second `=`. */
static int statement_begins(Filter *f) {
  const Token *next = peek(f);
  if (next->kind != TOK_IDENT) return 0;
  unsigned where = f->where[f->depth];
  TokKind kind = token_statement(next->name, where);
  int word = kind != TOK_IDENT && !(kind == TOK_FOR && f->word == TOK_SYMMETRY);
  TokKind follows = peek_at(f, 1)->kind;
  if (follows == TOK_ASSIGN) return f->assigned && (word || (where & (W_SCENE | W_EVENT)));
  return word && (follows == TOK_IDENT || follows == TOK_STRING || follows == TOK_NUMBER);
}

/* Whether a line end before the next token is no statement end. */
static int line_continues(Filter *f) {
  TokKind next = peek(f)->kind;
  unsigned after = token_flags(next), before = token_flags(f->prev);
  if (next == TOK_RBRACE && f->lists) return 1;
  if (next == TOK_FINISH || next == TOK_RBRACE) return 0;
  if (before & T_OPENS) return !statement_begins(f);
  if (next == TOK_LBRACE) return 1;
  if (next == TOK_PRIME || next == TOK_SEMICOLON) return 0;
  if (after & T_BINARY) return 1;
  if (!f->brackets.n) return 0;
  int operands_meet = (before & T_OPERAND) && (after & T_START);
  return !operands_meet;
}

static int at_line_end(Filter *f) {
  while (peek(f)->kind == TOK_NEWLINE) take_raw_token(f);
  return !f->single && !line_continues(f);
}

/* ---- words ---- */

static int sets_a_name(TokKind next) {
  return next == TOK_ASSIGN || next == TOK_DOT || next == TOK_PRIME || next == TOK_INDEX;
}

/* Classifies the first name of a statement: a statement word, a name being set, or BADWORD. */
static Token first_name(Filter *f, Token t) {
  unsigned where = f->where[f->depth];
  TokKind next = peek(f)->kind;
  if (next == TOK_NEWLINE && peek_at(f, 1)->kind == TOK_ASSIGN) next = TOK_ASSIGN;
  f->word = TOK_IDENT;
  if ((where & (W_SCENE | W_EVENT)) && (sets_a_name(next) || t.dots)) return t;
  t.kind = token_statement(t.name, where);
  t.follows = next;
  f->word = t.kind;
  f->has_block = (token_flags(t.kind) & T_BLOCK) != 0;
  if (t.kind != TOK_IDENT || ((where & W_EVENT) && next == TOK_LPAREN)) return t; /* omega(R) = ... */
  /* A mistyped or misplaced keyword may own a block: it is skipped as a whole. */
  t.kind = TOK_BADWORD;
  f->has_block = 1;
  return t;
}

/* A word after a comma of a contact or a guide. */
static TokKind contact_word(const char *name) {
  static const TokKind words[] = {TOK_RESTITUTION, TOK_FRICTION, TOK_STATIC, TOK_SLIP, TOK_TANGENTIAL, TOK_LAW};
  for (size_t i = 0; i < sizeof words / sizeof *words; i++)
    if (strcmp(name, token_word(words[i])) == 0) return words[i];
  return TOK_IDENT;
}

/* A name of `draw ball[i in 1..N] at P radius r`: the shape, then what it draws unless the name is one of `heads`;
 * behind an operand a word. */
static TokKind drawing_word(Filter *f, const Token *t) {
  static const char heads[] = "from at of to width radius size turn coils spokes box scale as for";
  if (f->prev == TOK_DRAW) {
    f->headed = 1;
    return TOK_SHAPE;
  }
  if (f->brackets.n) return TOK_IDENT;
  int subject = f->headed && (f->prev == TOK_SHAPE || f->prev == TOK_RBRACKET) && !has_word(heads, t->name);
  int word = !subject && (token_ends_operand(f->prev) || f->prev == TOK_SHAPE);
  f->headed = 0;
  return word ? TOK_CLAUSE : TOK_IDENT;
}

/* Classifies a name inside a statement: a keyword in its slot, otherwise IDENT. */
static TokKind slot_word(Filter *f, const Token *t) {
  static const struct {
    TokKind statement, word;
  } slots[] = {{TOK_COORD, TOK_PERIODIC}, {TOK_EVENT, TOK_RISING}, {TOK_EVENT, TOK_FALLING},
               {TOK_EVENT, TOK_CROSSING}, {TOK_OUTPUT, TOK_EVERY}, {TOK_KICK, TOK_EVERY},
               {TOK_FRICTION, TOK_ON},    {TOK_MOMENTUM, TOK_OF},  {TOK_CONSTRAINT, TOK_WHILE},
               {TOK_NETWORK, TOK_FROM},   {TOK_NETWORK, TOK_LAYERS}};
  if (f->prev == TOK_START && peek(f)->kind == TOK_IDENT)
    return strcmp(t->name, "exactly") == 0 ? TOK_EXACTLY : strcmp(t->name, "guess") == 0 ? TOK_GUESS : TOK_IDENT;
  if ((f->word == TOK_CONTACT || f->word == TOK_GUIDE) && f->prev == TOK_COMMA && !f->brackets.n)
    return contact_word(t->name);
  if (f->word == TOK_FRICTION && f->prev == TOK_COMMA && !f->brackets.n)
    return strcmp(t->name, "static") == 0 ? TOK_STATIC : TOK_IDENT;
  if (f->word == TOK_SYMMETRY && peek(f)->kind == TOK_IDENT && (f->prev == TOK_COLON || f->prev == TOK_COMMA))
    return strcmp(t->name, "for") == 0 ? TOK_FOR : TOK_IDENT;
  if (peek(f)->kind == TOK_LPAREN && !token_ends_operand(f->prev)) {
    if (strcmp(t->name, "sum") == 0) return TOK_SUM;
    if (strcmp(t->name, "product") == 0) return TOK_PRODUCT;
  }
  if (f->word == TOK_DRAW) return drawing_word(f, t);
  if (!token_ends_operand(f->prev) || f->brackets.n) return TOK_IDENT;
  for (size_t i = 0; i < sizeof slots / sizeof *slots; i++)
    if (slots[i].statement == f->word && strcmp(t->name, token_word(slots[i].word)) == 0) return slots[i].word;
  return TOK_IDENT;
}

/* ---- brackets and blocks ---- */

static void open_bracket(Filter *f, const Token *t) {
  OpenBracket b = {.kind = t->kind, .span = t->span};
  if (t->kind == TOK_INDEX) {
    b.dots = f->pending_primes;
    f->pending_primes = 0;
  }
  f->lists += t->kind == TOK_LBRACE;
  vec_push(f->scan->arena, &f->brackets, b);
}

static void close_bracket(Filter *f, const Token *t) {
  if (!f->brackets.n) return;
  if (t->kind == TOK_RBRACE) /* closes brackets left open inside the list, too */
    while (f->lists && filter_open_bracket(f)->kind != TOK_LBRACE) f->brackets.n--;
  f->brackets.n--;
  const OpenBracket *b = &f->brackets.at[f->brackets.n];
  f->lists -= b->kind == TOK_LBRACE;
  f->pending_primes = b->dots;
  f->primes = *t;
}

static unsigned place_of(const Filter *f) {
  switch (f->word) { /* only words with a block, and BADWORD as IDENT, come here */
    case TOK_EFFECT: return W_EFFECT;
    case TOK_SCENE: return W_SCENE;
    case TOK_EVENT: case TOK_KICK: return W_EVENT;
    default: return W_FOR;
  }
}

static Token open_block(Filter *f, Token t) {
  if (f->depth == FILTER_BLOCKS) {
    f->has_block = 0;
    return bad(f, t.span, "blocks are nested more than 64 deep", NULL);
  }
  Token brace = out(f, t);
  f->open[f->depth] = t;
  f->where[f->depth + 1] = place_of(f);
  f->depth++;
  f->inside = f->assigned = 0;
  return brace;
}

/* A `}` that closes no list ends the statement before it, then the block, then the statement that holds the block. */
static Token close_block(Filter *f) {
  if (f->inside) return end_statement(f, peek(f)->span, TOK_RBRACE);
  Token t = take_raw_token(f);
  f->end_due = 1;
  if (!f->depth) return bad(f, t.span, "this `}` closes nothing", NULL);
  f->depth--;
  return out(f, t);
}

/* End of the text: ends the statement, reports each block that was never closed, and closes it. */
static Token finish(Filter *f) {
  Span here = peek(f)->span;
  if (f->inside) return end_statement(f, here, TOK_FINISH);
  if (!f->depth) return out(f, *peek(f));
  Span opened = f->open[f->depth - 1].span;
  Token brace = {.kind = TOK_RBRACE, .span = here};
  f->end_due = 1;
  if (f->where[f->depth]) { /* the message comes first, once */
    f->where[f->depth] = 0;
    return bad(f, opened, "this `{` is never closed", "put a `}` at the end of the block");
  }
  f->depth--;
  return out(f, brace);
}

/* ---- the loop ---- */

static Token filter_name(Filter *f, Token t) {
  int first = !f->inside && !f->single;
  if (first) {
    f->has_block = 0;
    t = first_name(f, t);
  } else {
    t.kind = slot_word(f, &t);
  }
  f->inside = 1;
  if (t.kind == TOK_IDENT) {
    f->pending_primes = t.dots;
    f->primes = t;
  }
  return out(f, t);
}

static Token emit_pending_prime(Filter *f) {
  f->pending_primes--;
  return out(f, (Token){.kind = TOK_PRIME, .span = f->primes.span});
}

static Token filter_sign(Filter *f, Token t) {
  if (!f->inside) {
    f->word = TOK_IDENT;
    f->has_block = 0;
  }
  f->inside = 1;
  if (t.kind == TOK_ASSIGN) f->assigned = 1;
  if (t.kind == TOK_COMMA && !f->brackets.n) f->assigned = 0;
  if (t.kind == TOK_LPAREN || t.kind == TOK_INDEX || t.kind == TOK_LBRACE) {
    if (f->brackets.n == FILTER_BRACKETS)
      return bad(f, t.span, "brackets are nested more than 1000000 deep", NULL);
    open_bracket(f, &t);
  } else if (t.kind == TOK_RPAREN || t.kind == TOK_RBRACKET || t.kind == TOK_RBRACE) {
    close_bracket(f, &t);
  }
  return out(f, t);
}

Token filter_next(Filter *f) {
  for (;;) {
    const Token *next = peek(f);
    if (f->end_due) return end_statement(f, (Span){next->span.begin, next->span.begin + 1}, TOK_RBRACE);
    if (f->pending_primes && next->kind != TOK_INDEX) return emit_pending_prime(f);
    Span at = next->span;
    switch (next->kind) {
      case TOK_NEWLINE:
        if (at_line_end(f) && f->inside) return end_statement(f, at, TOK_NEWLINE);
        continue;
      case TOK_SEMICOLON:
        take_raw_token(f);
        if (f->inside) return end_statement(f, at, TOK_SEMICOLON);
        continue;
      case TOK_FINISH: return finish(f);
      case TOK_IDENT: return filter_name(f, take_raw_token(f));
      case TOK_RBRACE:
        if (f->single || (f->inside && f->lists)) return filter_sign(f, take_raw_token(f));
        return close_block(f);
      case TOK_LBRACE:
        if (f->inside && f->has_block && !f->brackets.n) return open_block(f, take_raw_token(f));
        return filter_sign(f, take_raw_token(f));
      default: return filter_sign(f, take_raw_token(f));
    }
  }
}
