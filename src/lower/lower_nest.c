/* Quantified sums (sym/sum_nest.h) as nests of loops (Nest in ir/prog.h): arguments become array elements with affine
 * indices, what stays the same in all turns is computed before the loops. Sums without that form, and those in series,
 * are written out. */
#include "lower/lower_impl.h"
#include "sym/sum_nest.h"

typedef struct {
  Lower *l;
  const SumNest *s;
  Expr nest;
  int half; /* s takes the pairs of its nest once: nest_half */
  Lower body;
  VEC(IrSubscript) at;
  VEC(Slot) outer;
} NestBuilder;

static Slot arg_slot(const NestBuilder *b, int64_t i) {
  return lower_slot(b->l, expr_sum_arg(b->l->g, b->nest, (uint32_t)i));
}

static int varies(const Subscript *at) { return at->by_row || at->by_turn; }

/* Whether the arguments of a read are elements of one array at equal steps; then the load of the first, and the index
 * of each turn. */
static int array_index(const NestBuilder *b, const Subscript *at, Ins *load, IrSubscript *index) {
  const Prog *p = b->l->p;
  int64_t least, most, step = subscript_step(at);
  if (!loop_extent(&b->s->range, at, &least, &most)) return 0;
  *load = p->ins.at[arg_slot(b, least)];
  if (load->op != IR_LOAD || ir_is_scalar(load->array) || load->array == ARR_CELL) return 0;
  int64_t by = least == most ? 0 : (int64_t)p->ins.at[arg_slot(b, least + step)].index - load->index;
  for (int64_t k = least; k <= most; k += step) {
    const Ins *x = &p->ins.at[arg_slot(b, k)];
    if (x->op != IR_LOAD || x->array != load->array || x->index != load->index + (k - least) / step * by) return 0;
  }
  *index =
      (IrSubscript){load->index + (at->first - least) / step * by, at->by_row / step * by, at->by_turn / step * by};
  return 1;
}

/* The value that all arguments of a read have, as of parameters fixed to one number; NOT_A_SLOT: they differ. */
static Slot common_value(const NestBuilder *b, const Subscript *at) {
  int64_t least, most, step = subscript_step(at);
  if (!loop_extent(&b->s->range, at, &least, &most)) return NOT_A_SLOT;
  Slot first = arg_slot(b, least);
  for (int64_t k = least; k <= most; k += step)
    if (arg_slot(b, k) != first) return NOT_A_SLOT;
  return first;
}

/* A value of the program around, in the body. */
static Slot outer_value(NestBuilder *b, Slot outer) {
  const Ins *i = &b->l->p->ins.at[outer];
  if (!outer) return 0;
  if (i->op == IR_CONST) return prog_num(b->body.p, i->number);
  vec_push(b->l->p->arena, &b->outer, outer);
  return prog_ins(b->body.p,
                  (Ins){.op = IR_LOAD, .array = ARR_OUTER, .index = b->outer.n - 1, .name = i->name});
}

/* Slots of the body for the reads that vary; 0: one has no index. Those of the row stand before those of the turn:
 * products begin with what changes least. */
static int load_reads(NestBuilder *b) {
  for (int by_turn = 0; by_turn < 2; by_turn++)
    for (uint32_t k = 0; k < b->s->nreads; k++) {
      const NestRead *r = &b->s->reads[k];
      Ins load;
      IrSubscript at;
      if (!varies(&r->at) || (r->at.by_turn != 0) != by_turn) continue;
      Slot common = common_value(b, &r->at);
      if (common != NOT_A_SLOT) {
        expr_map_set(&b->body.slots, expr_symbol(b->l->g, r->symbol)->node, outer_value(b, common) + 1);
        continue;
      }
      if (r->stem && !*r->stem) {
        load = (Ins){.array = ARR_INDEX, .name = expr_symbol(b->l->g, r->symbol)->name};
        at = r->index[0];
      } else if (!array_index(b, &r->at, &load, &at)) {
        return 0;
      }
      vec_push(b->l->p->arena, &b->at, at);
      Slot s = prog_ins(b->body.p,
                        (Ins){.op = IR_LOAD, .array = load.array, .index = b->at.n - 1, .name = load.name});
      expr_map_set(&b->body.slots, expr_symbol(b->l->g, r->symbol)->node, s + 1);
    }
  return 1;
}

/* A node that is the same in all turns, as a value of the program around. */
static void load_outer(NestBuilder *b, Expr e) {
  ExprGraph *g = b->l->g;
  SymId *syms = ARENA_ARRAY(b->l->p->arena, SymId, b->s->nreads + 1);
  Expr *with = ARENA_ARRAY(b->l->p->arena, Expr, b->s->nreads + 1);
  uint32_t n = 0;
  for (uint32_t k = 0; k < b->s->nreads; k++) {
    if (varies(&b->s->reads[k].at)) continue;
    syms[n] = b->s->reads[k].symbol;
    with[n++] = expr_sum_arg(g, b->nest, (uint32_t)b->s->reads[k].at.first);
  }
  Expr around = expr_replace(g, e, syms, with, n);
  lower_roots(b->l, &around, 1);
  Slot s = outer_value(b, lower_slot(b->l, around));
  expr_map_set(&b->body.slots, e, s + 1);
}

/* Finds what stays the same in all turns and is not part of something that does. */
static void load_constants(NestBuilder *b, const Expr *values, uint32_t n) {
  ExprGraph *g = b->l->g;
  ExprList list = expr_topo(g, values, n);
  ExprMap moving = expr_map(b->l->p->arena);
  for (uint32_t k = 0; k < b->s->nreads; k++)
    if (varies(&b->s->reads[k].at)) expr_map_set(&moving, expr_symbol(g, b->s->reads[k].symbol)->node, 1);
  for (uint32_t k = 0; k < list.n; k++) {
    Expr e = list.at[k];
    int moves = expr_map_get(&moving, e) != 0;
    for (uint32_t i = 0; i < expr_nargs(g, e); i++) moves |= expr_map_get(&moving, expr_arg(g, e, i)) != 0;
    if (!moves) continue;
    expr_map_set(&moving, e, 1);
    for (uint32_t i = 0; i < expr_nargs(g, e); i++) {
      Expr a = expr_arg(g, e, i);
      if (!expr_is_num(g, a) && !expr_map_get(&moving, a) && !expr_map_get(&b->body.slots, a)) load_outer(b, a);
    }
  }
  for (uint32_t k = 0; k < n; k++)
    if (!expr_map_get(&moving, values[k]) && !expr_is_num(g, values[k])) load_outer(b, values[k]);
}

/* --- neighbours --- */

/* The body's values where the test of near(...) holds; 0: it decides on more than whether a turn counts. */
static int split_test(const NestBuilder *b, const Expr *values, uint32_t n, Expr *inside) {
  ExprGraph *g = b->l->g;
  Expr test = b->s->near->test, yes = expr_int(g, 1), no = expr_int(g, 0);
  Expr *outside = ARENA_ARRAY(b->l->p->arena, Expr, n + 1);
  expr_replace_nodes(g, values, n, &test, &yes, 1, inside);
  expr_replace_nodes(g, values, n, &test, &no, 1, outside);
  for (uint32_t k = 0; k < n; k++)
    if (!expr_is_zero(g, outside[k])) return 0;
  return 1;
}

/* Index of a place in q: position in the nest's list; 0: it is no element of q at the nest's own step. */
static int place_index(NestBuilder *b, Expr symbol, uint32_t *position, IrSubscript *index) {
  for (uint32_t k = 0; k < b->s->nreads; k++) {
    const NestRead *r = &b->s->reads[k];
    Ins load;
    if (expr_symbol(b->l->g, r->symbol)->node != symbol) continue;
    if (!array_index(b, &r->at, &load, index) || load.array != ARR_Q) return 0;
    *position = b->at.n;
    vec_push(b->l->p->arena, &b->at, *index);
    return 1;
  }
  return 0;
}

static uint32_t push_outer(NestBuilder *b, Expr e) {
  lower_roots(b->l, &e, 1);
  vec_push(b->l->p->arena, &b->outer, lower_slot(b->l, e));
  return b->outer.n - 1;
}

/* The parts of a nest over neighbours. 0: places are not the members of families, all below the row's. */
static int find_places(NestBuilder *b, IrNear *near) {
  const NearTest *t = b->s->near;
  const LoopRange *r = &b->s->range;
  int64_t step = 0, shift = 0;
  near->n = t->n;
  near->boxed = t->side[0] != 0;
  for (uint32_t c = 0; c < t->n; c++) {
    IrSubscript i, j;
    if (!place_index(b, t->at_i[c], &near->at_i[c], &i) || !place_index(b, t->at_j[c], &near->at_j[c], &j)) return 0;
    if (!c) step = j.by_turn, shift = step ? (i.first - j.first) / step : 0;
    if (step <= 0 || j.by_turn != step || i.by_row != step || i.by_turn || j.by_row ||
        i.first - j.first != shift * step)
      return 0;
    near->side[c] = near->boxed ? push_outer(b, t->side[c]) : 0;
  }
  near->cut = push_outer(b, t->cut);
  return r->skew == 0 && r->more == 1 && r->turns == shift;
}

/* -x for x; 0: e is no negative multiple. */
static Expr negated(ExprGraph *g, Expr e) {
  Num c;
  if (expr_op(g, e) != EX_SUM || expr_pairs(g, e, EX_SUM) != 1) return 0;
  expr_pair(g, e, EX_SUM, 0, &c);
  return num_sign(c) < 0 ? expr_neg(g, e) : 0;
}

/* Shares in the list that cells want: values without a sign in front, so that action and reaction are one value. */
typedef struct {
  Expr value;
  Subscript at;
  int minus;
} Share;

typedef VEC(Share) Shares;

static Shares wanted_shares(const NestBuilder *b, const unsigned char *wanted, int64_t *least, int64_t *most) {
  ExprGraph *g = b->l->g;
  Shares all = {0};
  for (uint32_t k = 0; k < b->s->nshares; k++) {
    const NestShare *x = &b->s->shares[k];
    int64_t lo, hi, some = 0;
    if (!loop_extent(&b->s->range, &x->at, &lo, &hi)) continue;
    int64_t step = subscript_step(&x->at);
    for (int64_t c = lo; c <= hi && !some; c += step ? step : 1) some = wanted[c];
    if (!some) continue;
    if (!all.n || lo < *least) *least = lo;
    if (!all.n || hi > *most) *most = hi;
    Share one = {x->value, x->at, 0};
    Expr other = negated(g, x->value), opposite = expr_neg(g, x->value);
    for (uint32_t j = 0; j < all.n && !other; j++)
      if (all.at[j].value == opposite) other = opposite;
    if (other) one.value = other, one.minus = 1;
    vec_push(b->l->p->arena, &all, one);
  }
  return all;
}

/* How turns are found otherwise than in order. */
typedef struct {
  IrNear near;
  IrFar far;
} Listed;

/* Leaves out the first and the last rows, which have no turns. sampled: the self-check takes a sample of the turns. */
static void trim(Nest *n, int sampled, int half) {
  uint32_t first = 0, end = n->rows;
  while (first < end && nest_to(n, first) <= nest_from(n, first)) first++;
  while (end > first && nest_to(n, end - 1) <= nest_from(n, end - 1)) end--;
  IrSubscript *at = (IrSubscript *)n->at;
  for (uint32_t k = 0; k < n->n; k++) at[k].first += first * (at[k].by_row + at[k].by_turn * n->skew);
  n->turns += n->more * first;
  if (sampled) n->text_rows = n->rows;
  if (sampled && half) n->text_turns = n->rows;
  n->first_row = first;
  n->rows = end - first;
}

static uint64_t turns_of(const LoopRange *r) {
  uint64_t n = 0;
  for (uint32_t row = 0; row < r->rows; row++) n += (uint64_t)loop_turns(r, row);
  return n;
}

/* The order of cells least ... most in a nest whose turns are found in order. */
static CellOrder order_of_cells(const Shares *shares, const Listed *x, int64_t least, int64_t most, uint32_t base) {
  CellOrder order = {.least = least, .base = base};
  for (uint32_t k = 0; k < shares->n && !x->near.n && !x->far.n; k++) cells_follow(&order, &shares->at[k].at);
  cells_complete(&order, most);
  return order;
}

/* Appends the nest. */
static Slot append_nest(NestBuilder *b, const Shares *shares, const Listed *x, const CellOrder *order) {
  const IrNear *near = &x->near;
  Prog *p = b->l->p;
  const LoopRange *r = &b->s->range;
  for (uint32_t k = 0; k < shares->n; k++) {
    const Share *share = &shares->at[k];
    vec_push(p->arena, &b->at, cell_in_order(order, &share->at));
    prog_store(b->body.p, (uint32_t)share->minus, b->at.n - 1, lower_slot(&b->body, share->value), "");
  }
  if (near->n) prog_store(b->body.p, NEST_TEST, 0, lower_slot(&b->body, b->s->near->test), "");
  const Prog *body = prog_product_cse(prog_factor(prog_tidy(b->body.p)));
  Nest n = {.rows = r->rows, .count = (uint32_t)turns_of(r), .skew = r->skew, .turns = r->turns,
            .more = r->more, .body = body, .at = b->at.at, .outer = b->outer.at, .n = b->at.n, .nouter = b->outer.n,
            .near = *near, .far = x->far};
  enum { NEIGHBOURS = 32, CELLS = 300 }; /* of a row, for counts of operations */
  if (near->n) n.count = NEIGHBOURS * r->rows;
  if (x->far.n && n.count * b->l->e->m->times > (double)CELLS * r->rows) n.count = CELLS * r->rows;
  trim(&n, b->s->sampled, b->half);
  vec_push(p->arena, &p->nests, n);
  Slot before = 0;
  for (Slot s = p->ins.n; s-- > 1 && !before;)
    if (p->ins.at[s].op == IR_NEST) before = s;
  return prog_ins(p, (Ins){.op = IR_NEST, .a = before, .index = p->nests.n - 1});
}

/* --- trees --- */

static const NestRead *read_symbol(const NestBuilder *b, Expr symbol) {
  for (uint32_t k = 0; k < b->s->nreads; k++)
    if (expr_symbol(b->l->g, b->s->reads[k].symbol)->node == symbol) return &b->s->reads[k];
  return NULL;
}

static int same_subscript(const Subscript *x, const Subscript *y) {
  return x->first == y->first && x->by_row == y->by_row && x->by_turn == y->by_turn;
}

/* Component of the place by which a share is the derivative of the sum; -1: it is none. */
static int place_of_share(const NestBuilder *b, const NestShare *x) {
  const FarForm *far = b->s->far;
  for (uint32_t k = 0; k < 2 * far->n; k++) {
    Expr place = k < far->n ? far->at_i[k] : far->at_j[k - far->n];
    const NestRead *r = read_symbol(b, place);
    if (r && same_subscript(&r->at, &x->at) && expr_diff(b->l->g, far->term, r->symbol) == x->value)
      return (int)(k % far->n);
  }
  return -1;
}

/* The bodies as rows, one turn each, and what their charge reads. */
static SumNest rows_of_bodies(const NestBuilder *b) {
  const FarForm *far = b->s->far;
  SumNest s = *b->s;
  NestRead *reads = ARENA_ARRAY(b->l->p->arena, NestRead, s.nreads + 1);
  s.reads = reads;
  s.nreads = 0;
  for (uint32_t k = 0; k < b->s->nreads; k++) {
    NestRead r = b->s->reads[k];
    if (!expr_contains_sym(b->l->g, far->charge, r.symbol)) continue;
    r.at.first += far->first * r.at.by_row;
    for (uint32_t n = 0; n < r.nindices; n++) r.index[n].first += far->first * r.index[n].by_row;
    reads[s.nreads++] = r;
  }
  s.range = (LoopRange){.rows = (uint32_t)far->members, .turns = 1};
  s.near = NULL;
  s.far = NULL;
  s.sampled = 0;
  return s;
}

/* The charges as sums of their own; 0: they are no arrays. */
static int lower_far_charges(NestBuilder *rows, Expr charge, uint32_t *first) {
  Lower *l = rows->l;
  Shares shares = {0};
  vec_push(l->p->arena, &shares, ((Share){charge, {.by_row = 1}, 0}));
  rows->body = lower_new(l->e);
  load_constants(rows, &charge, 1);
  if (!load_reads(rows)) return 0;
  lower_roots(&rows->body, &charge, 1);
  *first = l->p->cells;
  l->p->cells += rows->s->range.rows;
  append_nest(rows, &shares, &(const Listed){0}, &(CellOrder){.step = 1, .base = *first});
  return 1;
}

/* Elements of q that are component c of the bodies, and the sums that take derivatives by it. */
static int far_place(NestBuilder *b, const NestBuilder *rows, uint32_t c, IrFar *far) {
  const NestRead *r = read_symbol(b, b->s->far->at_i[c]);
  Ins load;
  IrSubscript index;
  if (!r) return 0;
  Subscript at = r->at;
  at.first += b->s->far->first * at.by_row;
  if (at.by_turn || !array_index(rows, &at, &load, &index) || load.array != ARR_Q) return 0;
  if (c && (index.by_row != far->step || at.by_row != far->by)) return 0;
  far->step = index.by_row;
  far->by = at.by_row;
  far->first[c] = index.first;
  far->slope[c] = at.first;
  return far->step > 0 && far->by > 0;
}

/* The parts of a nest that a tree sums; cells numbered as in the sum, and their range widened to all bodies. 0: it adds
 * up something else. */
static int find_far(NestBuilder *b, const unsigned char *wanted, IrFar *far, int64_t *least, int64_t *most) {
  const FarForm *form = b->s->far;
  SumNest s = rows_of_bodies(b);
  NestBuilder rows = {.l = b->l, .s = &s, .nest = b->nest};
  int some[3] = {0};
  far->energy = b->s->ncells == 1 ? 0 : -1;
  for (uint32_t k = 0; k < b->s->nshares; k++) {
    const NestShare *x = &b->s->shares[k];
    int64_t lo, hi, any = 0, step = subscript_step(&x->at);
    if (!loop_extent(&b->s->range, &x->at, &lo, &hi)) continue;
    for (int64_t c = lo; c <= hi && !any; c += step ? step : 1) any = wanted[c];
    int place = !any ? -1 : far->energy == 0 ? 0 : place_of_share(b, x);
    if (any && (place < 0 || (far->energy == 0 && x->value != form->term))) return 0;
    if (any) some[place] = 1;
  }
  for (uint32_t c = 0; c < form->n; c++) {
    if (!far_place(b, &rows, c, far)) return 0;
    if (far->energy == 0 || !some[c]) far->slope[c] = -1;
    if (far->slope[c] < 0) continue;
    int64_t last = far->slope[c] + far->by * (form->members - 1);
    *least = far->slope[c] < *least ? far->slope[c] : *least;
    *most = last > *most ? last : *most;
  }
  if (!lower_far_charges(&rows, form->charge, &far->charge)) return 0;
  far->numbers[0] = push_outer(b, form->factor);
  far->numbers[1] = push_outer(b, form->soft);
  far->numbers[2] = push_outer(b, form->theta);
  far->members = (uint32_t)form->members;
  far->n = form->n;
  return 1;
}

/* Cells of the sum as cells of the program. */
static void number_cells(IrFar *far, int64_t by) {
  for (uint32_t c = 0; c < far->n; c++) far->slope[c] += far->slope[c] < 0 ? 0 : by;
  far->energy += far->energy < 0 ? 0 : by;
}

/* The cells as sums in a nest of loops; 0: their arguments are no arrays. */
static int lower_as_nest(NestBuilder *b, const Expr *cells, uint32_t n) {
  Lower *l = b->l;
  Arena *a = l->p->arena;
  unsigned char *wanted = ARENA_ARRAY(a, unsigned char, b->s->ncells);
  int64_t least = 0, most = -1;
  for (uint32_t k = 0; k < n; k++) wanted[expr_cell_number(l->g, cells[k])] = 1;
  Shares shares = wanted_shares(b, wanted, &least, &most);
  b->body = lower_new(l->e);
  Expr *values = ARENA_ARRAY(a, Expr, shares.n + 1), *inside = ARENA_ARRAY(a, Expr, shares.n + 1);
  uint32_t nvalues = shares.n;
  Listed listed = {0};
  for (uint32_t k = 0; k < shares.n; k++) values[k] = shares.at[k].value;
  if (b->s->near && shares.n && split_test(b, values, shares.n, inside) && find_places(b, &listed.near)) {
    for (uint32_t k = 0; k < shares.n; k++) shares.at[k].value = values[k] = inside[k];
    values[nvalues++] = b->s->near->test;
  } else {
    listed.near.n = 0;
  }
  if (b->s->far && shares.n && !find_far(b, wanted, &listed.far, &least, &most)) listed.far.n = 0;
  load_constants(b, values, nvalues);
  if (!load_reads(b)) return 0;
  lower_roots(&b->body, values, nvalues);
  const CellOrder order = order_of_cells(&shares, &listed, least, most, l->p->cells);
  l->p->cells += (uint32_t)(order.step * order.each);
  number_cells(&listed.far, order.base - least);
  Slot nest = shares.n ? append_nest(b, &shares, &listed, &order) : 0;
  for (uint32_t k = 0; k < n; k++) {
    int64_t c = expr_cell_number(l->g, cells[k]);
    uint32_t index = (uint32_t)cell_in_order(&order, &(Subscript){.first = c}).first;
    Ins load = {.op = IR_LOAD, .array = ARR_CELL, .a = nest, .index = index, .name = "sum"};
    Slot s = c >= least && c <= most ? prog_ins(l->p, load) : 0;
    expr_map_set(&l->slots, cells[k], s + 1);
  }
  return 1;
}

void lower_nest(Lower *l, Expr nest, const ExprList *list) {
  ExprGraph *g = l->g;
  const SumNest *half = nest_half(g, nest);
  NestBuilder b = {.l = l, .s = half ? half : expr_sum_nest(g, nest), .nest = nest, .half = half != NULL};
  VEC(Expr) cells = {0};
  for (uint32_t k = 0; k < list->n; k++)
    if (expr_op(g, list->at[k]) == EX_CELL && expr_cell_nest(g, list->at[k]) == nest &&
        !expr_map_get(&l->slots, list->at[k]))
      vec_push(l->p->arena, &cells, list->at[k]);
  if (!cells.n || (!l->direct && lower_as_nest(&b, cells.at, cells.n))) return;
  Expr *sums = ARENA_ARRAY(l->p->arena, Expr, cells.n + 1);
  expr_expand_sums(g, cells.at, cells.n, sums);
  if (b.s->sampled) expr_note_sums_out(g);
  lower_roots(l, sums, cells.n);
  for (uint32_t k = 0; k < cells.n; k++) expr_map_set(&l->slots, cells.at[k], lower_slot(l, sums[k]) + 1);
}
