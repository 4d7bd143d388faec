/* Nests of a program as nested loops in C.
 *
 * Sums are elements of one local array; a sum whose element is the same in all turns of a row is accumulated in a
 * variable. Where turns do not depend on each other, LAG_TURNS of them are computed side by side, if the compiler has
 * vectors (lag_lanes.h), and added in their order: the bits are the same. */
#include <string.h>

#include "emit/cnest_impl.h"
#include "emit/late_text.h"

static int has_rows(const Nest *n) { return n->rows > 1; }

static const char *index_text(const Nesting *x, IrSubscript at) {
  return cloop_index(x->body.a, at.first, has_rows(x->n) ? at.by_row : 0, x->i, nest_has_turns(x->n) ? at.by_turn : 0,
                     x->j);
}

const char *cnest_place(const Nesting *x, uint32_t k) { return index_text(x, x->n->at[k]); }

const char *cnest_turn_of_row(const Nesting *x, int behind) {
  const Nest *n = x->n;
  return index_text(x, (IrSubscript){.first = behind ? n->turns : 0, .by_row = n->skew + (behind ? n->more : 0)});
}

void cnest_open_loop(Writer *w, const char *counter, const char *from, const char *end) {
  cwriter_line(w, arena_printf(w->a, "for (int %s = %s; %s < %s; %s++) {", counter, from, counter, end, counter));
  w->indent += 2;
}

void cnest_close_loop(Writer *w) {
  w->indent -= 2;
  cwriter_line(w, "}");
}

void cnest_declare_array(Writer *w, const char *name, long long n) {
  const char *real = arena_printf(w->a, "%s_REAL", w->style->prefix);
  StrBuf line = strbuf(w->a);
  if (w->style->params) sb_printf(&line, "%s %s[%lld];", real, name, n);
  else
    late_array(&line, real, name, cnames_take(&w->names, arena_printf(w->a, "%s_of_thread", name)), (uint64_t)n);
  cwriter_line(w, sb_text(&line));
}

/* The store that says whether a turn counts; NULL: all do. */
static const Store *test_of(const Prog *p) {
  const Store *last = p->stores.n ? &p->stores.at[p->stores.n - 1] : NULL;
  return last && last->array == NEST_TEST ? last : NULL;
}

/* --- the turn --- */

static void find_varying(Nesting *x) {
  const Prog *p = x->n->body;
  for (Slot s = 1; s < p->ins.n; s++) {
    const Ins *i = &p->ins.at[s];
    if (i->op == IR_LOAD && i->array != ARR_OUTER && !ir_is_scalar(i->array))
      x->each[s] = (unsigned char)nest_moves(x->n, i->index);
    else x->each[s] = x->each[i->a] | x->each[i->b] | x->each[i->c];
  }
}

static void write_load(Nesting *x, const Writer *around, Slot s) {
  Writer *w = &x->body;
  const Ins *i = &w->p->ins.at[s];
  if (i->array == ARR_OUTER) {
    w->piece[s] = cwriter_operand(around, x->n->outer[i->index]);
  } else if (ir_is_scalar(i->array)) {
    w->piece[s] = (CExpr){w->style->in[i->array], C_ATOM, 0};
  } else if (i->array == ARR_INDEX) {
    const char *name = cnames_take(&w->names, i->name);
    cwriter_line(w, arena_printf(w->a, "const %s_REAL %s = %s_C(1.0)*(double)(%s);", w->style->prefix, name,
                                 w->style->prefix, cnest_place(x, i->index)));
    w->piece[s] = (CExpr){name, C_ATOM, 0};
  } else {
    const char *name = w->again ? w->again[s].text : cnames_take(&w->names, i->name ? i->name : "sum");
    const char *array = i->array == ARR_P && w->parameters ? w->parameters : cwriter_array(w, i->array);
    const char *one = arena_printf(w->a, "%s[%s]", array, cnest_place(x, i->index));
    cwriter_line(w, w->together ? arena_printf(w->a, "const lag_turns %s = lag_turns_at(&%s, %lld);", name, one,
                                               (long long)x->n->at[i->index].by_turn)
                                : arena_printf(w->a, "const %s_REAL %s = %s;", w->style->prefix, name, one));
    w->piece[s] = (CExpr){name, C_ATOM, 0};
  }
}

/* Writes the values that change from turn to turn (each = 1), or those that do not (each = 0). */
static void write_values(Nesting *x, const Writer *around, int each) {
  Writer *w = &x->body;
  for (Slot s = 1; s < w->p->ins.n; s++)
    if (w->p->ins.at[s].op == IR_LOAD && x->each[s] == each) write_load(x, around, s);
  for (Slot s = 1; s < w->p->ins.n; s++)
    if (w->p->ins.at[s].op != IR_LOAD && x->each[s] == each) cwriter_instruction(w, s);
}

/* Adds the terms of turns side by side to a sum, in the order of turns. */
static void write_addition_together(Nesting *x, uint32_t k) {
  Writer *w = &x->body;
  const Store *st = &w->p->stores.at[k];
  const char *value = cwriter_operand(w, st->slot).text, *part = x->partial[k];
  const char *how = st->array ? "less" : "plus";
  cwriter_line(w, part ? arena_printf(w->a, "%s = lag_turns_%s(%s, %s);", part, how, part, value)
                       : arena_printf(w->a, "lag_turns_each_%s(&%s[%s], %lld, %s);", how, w->cells,
                                      cnest_place(x, st->index), (long long)x->n->at[st->index].by_turn, value));
}

static void write_additions(Nesting *x) {
  Writer *w = &x->body;
  const char *ours = cnest_declare_ours(x);
  for (uint32_t k = 0; k < w->p->stores.n; k++) {
    const Store *st = &w->p->stores.at[k], *test = test_of(w->p);
    if (st == test) continue;
    if (w->together) {
      write_addition_together(x, k);
      continue;
    }
    if (st->array >= NEST_SETS) {
      const char *to = w->style->out[st->array - NEST_SETS], *value = cwriter_operand(w, st->slot).text;
      cwriter_statement(w, arena_printf(w->a, "%s[%s] = %s;", to, cnest_place(x, st->index), value));
      sb_printf(w->out, " /* %s */\n", comment_text(w->a, st->comment));
      continue;
    }
    const char *sum = x->partial[k] ? x->partial[k] : arena_printf(w->a, "%s[%s]", w->cells, cnest_place(x, st->index));
    const char *value = cwriter_operand(w, st->slot).text, *prefix = w->style->prefix;
    if (test)
      value = arena_printf(w->a, "%s_SELECT(%s, %s, %s_C(0.0))", prefix, cwriter_operand(w, test->slot).text, value,
                           prefix);
    const char *where = ours && !x->partial[k] ? arena_printf(w->a, "if (%s) ", ours) : "";
    cwriter_line(w, arena_printf(w->a, "%s%s %s %s;", where, sum, st->array ? "-=" : "+=", value));
  }
}

/* --- neighbours --- */

/* Values on which the test depends are computed before it. */
static void find_test(Nesting *x) {
  const Prog *p = x->n->body;
  if (!x->near) return;
  unsigned char *need = ARENA_ARRAY(x->body.a, unsigned char, p->ins.n);
  need[test_of(p)->slot] = 1;
  for (Slot s = p->ins.n; s-- > 1;) {
    if (!need[s]) continue;
    for (int k = 0; k < 3; k++) need[ins_operand(&p->ins.at[s], k)] = 1;
    if (x->each[s]) x->each[s] = 2;
  }
}

/* Declares the list, and brings it up to date. */
static void find_neighbours(Nesting *x, const Writer *around) {
  Writer *w = &x->body;
  const Nest *n = x->n;
  const IrNear *near = &n->near;
  const char *list = x->near, *real = w->style->prefix;
  const int64_t members = cnest_near_members(n), step = n->at[near->at_j[0]].by_turn;
  cwriter_line(w, arena_printf(w->a, "static _Thread_local double %s_x[LAG_NEAR_NUMBERS(%lld)];", list,
                               (long long)members));
  cwriter_line(w, arena_printf(w->a, "static _Thread_local int %s_of[LAG_NEAR_INTS(%lld)];", list, (long long)members));
  if (x->share == SHARE_LISTS) {
    const char *own = cnames_take(&w->names, arena_printf(w->a, "%s_of_thread", list));
    cwriter_line(w, arena_printf(w->a, "static _Thread_local lag_near %s;", own));
    cwriter_line(w, arena_printf(w->a, "lag_near *const %s = &%s;", list, own));
  } else {
    cwriter_line(w, arena_printf(w->a, "static _Thread_local lag_near %s;", list));
  }
  StrBuf side = strbuf(w->a), first = strbuf(w->a);
  for (uint32_t c = 0; c < near->n; c++) {
    const char *open = arena_printf(w->a, "%s_C(0.0)", real);
    sb_printf(&side, "%s%s", c ? ", " : "",
              near->boxed ? cwriter_operand(around, n->outer[near->side[c]]).text : open);
    sb_printf(&first, "%s%s%sfirst[%u] = %lld", c ? ", " : "", list, x->share == SHARE_LISTS ? "->" : ".", c,
              (long long)n->at[near->at_j[c]].first);
  }
  cwriter_line(w, arena_printf(w->a, "lag_near_open(%s, %lld, %u, %lld, %s_x, %s_of);", cnest_near_pointer(x),
                               (long long)members, near->n, (long long)step, list, list));
  cwriter_line(w, arena_printf(w->a, "%s;", sb_text(&first)));
  cwriter_line(w, arena_printf(w->a, "lag_near_find(%s, %s, %s, (const %s_REAL[]){%s});", cnest_near_pointer(x),
                               cwriter_array(w, ARR_Q), cwriter_operand(around, n->outer[near->cut]).text, real,
                               sb_text(&side)));
}

/* --- trees --- */

static const char *numbers_text(Arena *a, const int64_t *x, uint32_t n) {
  StrBuf out = strbuf(a);
  for (uint32_t k = 0; k < n; k++) sb_printf(&out, "%s%lld", k ? ", " : "", (long long)x[k]);
  return sb_text(&out);
}

/* The sums by a tree. */
static void write_tree(Writer *w, const Nest *n) {
  const IrFar *far = &n->far;
  const char *tree = cnames_take(&w->names, "tree"), *value[3];
  for (int k = 0; k < 3; k++) value[k] = cwriter_operand(w, n->outer[far->numbers[k]]).text;
  cwriter_line(w, "{");
  w->indent += 2;
  cwriter_line(w, arena_printf(w->a, "static _Thread_local double %s_x[LAG_TREE_NUMBERS(%u)];", tree, far->members));
  cwriter_line(w, arena_printf(w->a, "static _Thread_local int %s_of[LAG_TREE_INTS(%u)];", tree, far->members));
  cwriter_line(w, arena_printf(w->a, "lag_tree %s = {.parts = %u, .step = %lld, .first = {%s}, .energy = %lld, "
                                     ".slope = {%s}, .by = %lld};",
                               tree, far->n, (long long)far->step, numbers_text(w->a, far->first, far->n),
                               (long long)far->energy, numbers_text(w->a, far->slope, far->n), (long long)far->by));
  cwriter_line(w, arena_printf(w->a, "lag_tree_open(&%s, %u, %s_x, %s_of);", tree, far->members, tree, tree));
  cwriter_line(w, arena_printf(w->a, "lag_tree_sum(&%s, %s, %s + %u, (const %s_REAL[]){%s, %s, %s}, %s);", tree,
                               cwriter_array(w, ARR_Q), w->cells, far->charge, w->style->prefix, value[0], value[1],
                               value[2], w->cells));
  w->indent -= 2;
  cwriter_line(w, "}");
}

/* --- turns side by side --- */

/* Whether a vector has the operation, with the same bits; a load: of what turns do not change. */
static int is_of_vectors(const Nesting *x, const Ins *i) {
  const Prog *p = x->n->body;
  if (i->op == IR_LOAD) {
    for (uint32_t k = 0; k < p->stores.n && i->array == ARR_CELL; k++)
      if (!nest_never_meet(x->n, i->index, p->stores.at[k].index)) return 0;
    return i->array != ARR_INDEX;
  }
  return i->op == IR_ADD || i->op == IR_SUB || i->op == IR_MUL || i->op == IR_DIV || i->op == IR_NEG ||
         i->op == IR_SQRT;
}

/* Whether turns may be computed before the sums of those before them are complete, and gain by it: divisions and roots
 * take most of the time. */
static int may_run_together(const Nesting *x, const CStyle *style) {
  enum { FEWEST = 4 }; /* turns of the longest row */
  const Nest *n = x->n;
  const Prog *p = n->body;
  const int64_t first = n->turns, last = n->turns + n->more * ((int64_t)n->rows - 1);
  if (!style->turns || x->near || nest_sets(n) || !nest_has_turns(n) || test_of(p) || (first < FEWEST && last < FEWEST))
    return 0;
  int slow = 0;
  for (Slot s = 1; s < p->ins.n; s++) {
    if (x->each[s] && !is_of_vectors(x, &p->ins.at[s])) return 0;
    slow |= x->each[s] && (p->ins.at[s].op == IR_DIV || p->ins.at[s].op == IR_SQRT);
  }
  for (uint32_t k = 0; k < p->stores.n; k++) {
    if (!x->each[p->stores.at[k].slot]) return 0;
    const uint32_t at = p->stores.at[k].index;
    for (uint32_t j = 0; j < k && nest_moves(n, at); j++)
      if (nest_moves(n, p->stores.at[j].index) && !nest_never_meet(n, p->stores.at[j].index, at)) return 0;
  }
  return slow;
}

/* Most turns of a row in vectors; the loop over the others follows, with the same names. */
static void write_together(Nesting *x, const Writer *around) {
  Writer *w = &x->body;
  const char *from = x->from, *end = x->end;
  sb_puts(w->out, "#ifdef LAG_TURNS\n");
  cwriter_line(w, arena_printf(w->a, "for (int %s = %s; %s + LAG_TURNS <= %s; %s += LAG_TURNS) {", x->j, from, x->j,
                               end, x->j));
  w->indent += 2;
  w->together = 1;
  write_values(x, around, 1);
  write_additions(x);
  w->together = 0;
  cnest_close_loop(w);
  sb_puts(w->out, "#endif\n");
  CExpr *again = ARENA_ARRAY(w->a, CExpr, w->p->ins.n);
  memcpy(again, w->piece, w->p->ins.n * sizeof *again);
  w->again = again;
  cnest_open_loop(w, x->j, arena_printf(w->a, "LAG_REST(%s, %s)", from, end), end);
}

/* --- the loops --- */

static void open_neighbours(Nesting *x) {
  Writer *w = &x->body;
  const char *list = x->near;
  cwriter_line(w, arena_printf(w->a, "const int *%s_j;", list));
  cnest_find_list(x);
  cnest_open_loop(w, arena_printf(w->a, "%s_k", list), "0", arena_printf(w->a, "%s_n", list));
  cwriter_line(w, arena_printf(w->a, "const int %s = %s_j[%s_k];", x->j, list, list));
}

/* Values of the test, and the rest of the turn only where it holds. */
static void write_test(Nesting *x, const Writer *around) {
  Writer *w = &x->body;
  write_values(x, around, 2);
  cwriter_line(w, arena_printf(w->a, "if (!LAG_ANY(%s)) continue;", cwriter_operand(w, test_of(w->p)->slot).text));
}

/* --- rows --- */

static void declare_partial(Nesting *x) {
  Writer *w = &x->body;
  StrBuf text = strbuf(w->a);
  for (uint32_t k = 0; k < w->p->stores.n; k++) {
    const Store *st = &w->p->stores.at[k];
    if (st->array >= NEST_TEST || nest_moves(x->n, st->index)) continue;
    x->partial[k] = cnames_take(&w->names, "part");
    sb_printf(&text, "%s%s = ", text.n ? ", " : "", x->partial[k]);
    sb_puts(&text, cnest_row_begins(x, k));
  }
  if (text.n) cwriter_line(w, arena_printf(w->a, "%s_REAL %s;", w->style->prefix, sb_text(&text)));
}

static void write_rows(Nesting *x, const Writer *around) {
  Writer *w = &x->body;
  const Nest *n = x->n;
  if (x->near) find_neighbours(x, around);
  x->from = cnest_turn_of_row(x, 0), x->end = cnest_turn_of_row(x, 1);
  if (has_rows(n) && nest_has_turns(n)) cnest_open_rows(x);
  write_values(x, around, 0);
  declare_partial(x);
  if (x->near) open_neighbours(x);
  else if (may_run_together(x, w->style)) write_together(x, around);
  else if (nest_has_turns(n)) cnest_open_loop(w, x->j, x->from, x->end);
  else cnest_open_loop(w, x->i, "0", arena_printf(w->a, "%u", n->rows));
  if (x->near) write_test(x, around);
  write_values(x, around, 1);
  write_additions(x);
  cnest_close_loop(w);
  cnest_end_row(x);
  if (has_rows(n) && nest_has_turns(n)) cnest_close_loop(w);
  cnest_end_rows(x);
}

/* Copy of the body in which values have the name common to all turns (cloop_stem). */
static const Prog *named_by_stems(const Writer *w, const Prog *p) {
  Prog *r = ARENA_NEW(w->a, Prog);
  *r = *p;
  r->ins.at = ARENA_ARRAY(w->a, Ins, p->ins.n);
  memcpy(r->ins.at, p->ins.at, p->ins.n * sizeof *p->ins.at);
  for (Slot s = 1; s < p->ins.n; s++)
    if (r->ins.at[s].name) r->ins.at[s].name = cloop_stem(w->a, r->ins.at[s].name);
  return r;
}

void cnest_write(Writer *w, const Ins *i) {
  const Nest *n = &w->p->nests.at[i->index];
  if (n->far.n && !w->style->params) {
    cwriter_flush_title(w);
    write_tree(w, n);
    return;
  }
  Nesting x = {.n = n, .body = *w, .i = w->row, .j = w->turn};
  x.body.p = named_by_stems(w, n->body);
  x.body.uses = prog_uses(n->body), x.body.in_call = NULL;
  x.body.stored = ARENA_ARRAY(w->a, const char *, n->body->ins.n);
  cwriter_init_pieces(&x.body);
  x.body.rolls = roll_find(n->body, 0, UINT32_MAX, 0);
  x.each = ARENA_ARRAY(w->a, unsigned char, n->body->ins.n);
  x.partial = ARENA_ARRAY(w->a, const char *, n->body->stores.n + 1);
  cwriter_find_sincos(&x.body);
  find_varying(&x);
  if (n->near.n && !w->style->params) x.near = cnames_take(&x.body.names, "near");
  x.share = nest_row_share(n, !w->style->params, w->style->times > 0 ? w->style->times : 1);
  find_test(&x);
  cwriter_flush_title(w);
  x.body.title = NULL;
  write_rows(&x, w);
  w->names = x.body.names;
  w->temps = x.body.temps;
}

/* Highest index that place k of the nest takes, plus 1. */
static int64_t end_of(const Nest *n, uint32_t k) {
  int64_t end = 0;
  for (int64_t i = 0; i < n->rows; i++)
    for (int64_t j = nest_from(n, i); j < nest_to(n, i); j++)
      if (nest_index(n, k, i, j) >= end) end = nest_index(n, k, i, j) + 1;
  return end;
}

/* Copies the parameters that nests read into an array: struct members cannot be indexed. */
static void copy_parameters(Writer *w) {
  int64_t end = 0;
  vec_each(const Nest, n, w->p->nests) {
    for (Slot s = 1; s < n->body->ins.n; s++) {
      const Ins *i = &n->body->ins.at[s];
      if (i->op == IR_LOAD && i->array == ARR_P && end_of(n, i->index) > end) end = end_of(n, i->index);
    }
  }
  if (!end) return;
  StrBuf text = strbuf(w->a);
  w->parameters = cnames_take(&w->names, "values");
  sb_printf(&text, "const %s_REAL %s[%lld] = {", w->style->prefix, w->parameters, (long long)end);
  for (int64_t k = 0; k < end; k++)
    sb_printf(&text, "%s%s->%s", k ? ", " : "", w->style->in[ARR_P], w->style->params[k]);
  sb_puts(&text, "};");
  cwriter_line(w, sb_text(&text));
}

void cnest_prepare(Writer *w) {
  if (!w->p->nests.n) return;
  if (w->style->params) copy_parameters(w);
  w->cells = cnames_take(&w->names, "sum");
  w->row = cnames_take(&w->names, "i");
  w->turn = cnames_take(&w->names, "j");
  if (!w->p->cells) return;
  cnest_declare_array(w, w->cells, w->p->cells);
  cwriter_line(w, arena_printf(w->a, "for (int %s = 0; %s < %u; %s++) %s[%s] = %s_C(0.0);", w->row, w->row, w->p->cells,
                               w->row, w->cells, w->row, w->style->prefix));
}
