/* Rolled loops of a program as loops in C.
 *
 * Inside, a value is a `const` of its iteration. A value that other iterations, other loops or later code need is
 * kept in a local array, one element per iteration, preceded by the values that the first iterations take from the
 * code before. */
#include <string.h>

#include "emit/cwriter_impl.h"

static const Loop *loop_at(const Writer *w, uint32_t k) { return &w->rolls.loops.at[k]; }
static Slot code_of(const Writer *w, const Loop *l, uint32_t turn, uint32_t offset) {
  return w->rolls.code[l->begin + turn * l->period + offset];
}

int cloop_share_turn(const Writer *w, Slot a, Slot b) {
  uint32_t pa = w->rolls.place[a], pb = w->rolls.place[b];
  uint32_t la = pa ? w->rolls.loop[pa - 1] : 0, lb = pb ? w->rolls.loop[pb - 1] : 0;
  if (la != lb || !la) return la == lb;
  const Loop *l = loop_at(w, la - 1);
  if (loop_turn(l, pa - 1) != loop_turn(l, pb - 1)) return 0;
  Step x = roll_step(&w->rolls, l, loop_offset(l, pa - 1), 0), y = roll_step(&w->rolls, l, loop_offset(l, pb - 1), 0);
  return x.kind == y.kind && x.step == y.step && x.back == y.back;
}

int cloop_contains(const Writer *w, Slot s) { return w->rolls.place[s] && w->rolls.loop[w->rolls.place[s] - 1]; }

/* --- names and indices --- */

const char *cloop_stem(Arena *a, const char *name) {
  StrBuf b = strbuf(a);
  for (const char *s = name; *s; s++) {
    const char *close = *s == '[' ? strchr(s, ']') : NULL;
    if (close) s = close;
    else sb_putc(&b, *s);
  }
  size_t n = b.n;
  while (n > 1 && ((sb_text(&b)[n - 1] >= '0' && sb_text(&b)[n - 1] <= '9') || sb_text(&b)[n - 1] == '_')) n--;
  return arena_strndup(a, sb_text(&b), n);
}

/* Appends a term such as " + 3*k". */
static void put_term(StrBuf *b, int64_t factor, const char *counter) {
  const char *sign = factor < 0 ? b->n ? " - " : "-" : b->n ? " + " : "";
  int64_t size = factor < 0 ? -factor : factor;
  if (size == 1) sb_printf(b, "%s%s", sign, counter);
  else if (size) sb_printf(b, "%s%lld*%s", sign, (long long)size, counter);
}

const char *cloop_index(Arena *a, int64_t first, int64_t by_i, const char *i, int64_t by_j, const char *j) {
  StrBuf b = strbuf(a);
  int leads = by_i <= 0 && by_j <= 0; /* the number is written first */
  if (leads && (first || (by_i >= 0 && by_j >= 0))) sb_printf(&b, "%lld", (long long)first);
  put_term(&b, by_i, i);
  put_term(&b, by_j, j);
  if (!leads && first) sb_printf(&b, " %c %lld", first < 0 ? '-' : '+', (long long)(first < 0 ? -first : first));
  return sb_text(&b);
}

/* Text of the index first + step*k. */
static const char *index_text(const Writer *w, int64_t first, int64_t step) {
  return cloop_index(w->a, first, step, "k", 0, "");
}

/* The element of the kept array that holds the value at `place` of a loop; if step is not 0, its index advances by
 * `step` iterations per k. */
static CExpr kept_value(const Writer *w, uint32_t place, int64_t step) {
  uint32_t in = w->rolls.loop[place] - 1, offset = loop_offset(loop_at(w, in), place);
  int64_t first = (int64_t)(loop_at(w, in)->kept[offset] - 1) + loop_turn(loop_at(w, in), place);
  const char *index = step ? index_text(w, first, step) : arena_printf(w->a, "%lld", (long long)first);
  return (CExpr){arena_printf(w->a, "%s[%s]", w->kept[in][offset], index), C_ATOM, 1};
}

/* --- preparation --- */

static void name_load(Writer *w, Slot s) {
  if (s && w->p->ins.at[s].op == IR_LOAD) w->load_needs_name[s] = 1;
}

int cloop_names_load(const Writer *w, Slot s) { return w->load_needs_name[s]; }

void cloop_prepare(Writer *w) {
  const Rolls *r = &w->rolls;
  w->load_needs_name = ARENA_ARRAY(w->a, unsigned char, w->p->ins.n);
  w->kept = ARENA_ARRAY(w->a, const char **, r->loops.n);
  cnames_reserve(&w->names, "k");
  for (uint32_t k = 0; k < r->n; k++) {
    const Ins *i = &w->p->ins.at[r->code[k]];
    const Loop *l = r->loop[k] ? loop_at(w, r->loop[k] - 1) : NULL;
    uint32_t offset = l ? loop_offset(l, k) : 0;
    for (uint32_t j = 0; j < prog_operands(w->p, i); j++) {
      Slot x = prog_operand(w->p, i, j);
      if (x && (!l || roll_step(r, l, offset, (int)j).kind == STEP_SAME)) name_load(w, x);
    }
  }
  for (uint32_t k = 0; k < w->p->stores.n;) {
    uint32_t n = cloop_stores(w, k);
    const Store *st = &w->p->stores.at[k];
    if (!n || st[0].slot == st[1].slot) name_load(w, st->slot);
    k += n ? n : 1;
  }
}

/* --- a loop --- */

/* Load whose index changes from turn to turn, named once a turn. */
typedef struct {
  Slot first;
  int64_t step;
  const char *name;
} TurnLoad;

typedef struct {
  const Loop *l;
  uint32_t number;
  uint32_t *own_uses; /* [period] uses of a value in its own turn */
  const char **row;   /* [period] array that has the sines or cosines of all turns; NULL: none */
  VEC(TurnLoad) loads;
} Body;

static uint32_t offset_of(const Writer *w, const Loop *l, Slot s) { return w->rolls.place[s] - 1 - l->begin; }

static void count_own_uses(Writer *w, Body *b) {
  for (uint32_t k = 0; k < b->l->period; k++) {
    const Ins *i = &w->p->ins.at[code_of(w, b->l, 0, k)];
    int twice = i->op == IR_PIVOT || i->op == IR_SIGN || i->op == IR_MIN || i->op == IR_MAX; /* spelled twice */
    for (int which = 0; which < 3; which++) {
      Slot x = ins_operand(i, which);
      if (x && roll_step(&w->rolls, b->l, k, which).kind == STEP_OWN)
        b->own_uses[offset_of(w, b->l, x)] += twice ? 2 : 1;
    }
  }
  for (uint32_t k = 0; k < b->l->stores.n; k++) b->own_uses[b->l->stores.at[k].offset]++;
}

static const char *kept_name(const Writer *w, const Ins *i) {
  const Ins *x = &w->p->ins.at[i->a];
  if (i->name) return cloop_stem(w->a, i->name);
  return i->op == IR_FN1 && x->op == IR_LOAD ? arena_printf(w->a, "%s_%s", i->text, cloop_stem(w->a, x->name)) : "kept";
}

/* Name of a value carried to the next turn: x[3]' -> last_x'. */
static const char *carried_name(const Writer *w, const Ins *i) {
  const char *name = kept_name(w, i);
  return i->name ? arena_printf(w->a, "last_%s", name) : "last";
}

/* Declares the kept arrays of numbers, or of conditions; a value that only the next turn needs is a variable. */
static void declare_kept(Writer *w, const Body *b, int conditions) {
  const Loop *l = b->l;
  const char **names = w->kept[b->number];
  StrBuf text = strbuf(w->a);
  for (uint32_t k = 0; k < l->period; k++) {
    const Ins *i = &w->p->ins.at[code_of(w, l, 0, k)];
    if (!l->kept[k] || ir_is_condition(i->op) != conditions) continue;
    names[k] = cnames_take(&w->names, l->carried[k] ? carried_name(w, i) : kept_name(w, i));
    if (l->carried[k])
      sb_printf(&text, "%s%s = %s", text.n ? ", " : "", names[k],
                cwriter_operand(w, w->rolls.code[l->begin + k - l->period]).text);
    else sb_printf(&text, "%s%s[%u]", text.n ? ", " : "", names[k], l->count + l->kept[k] - 1);
  }
  if (!text.n) return;
  cwriter_line(w, arena_printf(w->a, "%s_%s %s;", w->style->prefix, conditions ? "MASK" : "REAL", sb_text(&text)));
}

/* Copies the values that the first turns take from the code before the loop into the kept arrays. */
static void write_first_values(Writer *w, const Body *b) {
  const Loop *l = b->l;
  for (uint32_t k = 0; k < l->period; k++)
    for (uint32_t t = 0; t + 1 < l->kept[k] && !l->carried[k]; t++) {
      uint32_t place = l->begin + k - (l->kept[k] - 1 - t) * l->period;
      cwriter_line(w, arena_printf(w->a, "%s[%u] = %s;", w->kept[b->number][k], t,
                                   cwriter_operand(w, w->rolls.code[place]).text));
    }
}

/* Array for the value at `offset` of all turns: the one in which it is kept, or a new one. */
static const char *row_of(Writer *w, Body *b, uint32_t offset) {
  const char *kept = w->kept[b->number][offset];
  if (kept) return b->row[offset] = kept;
  b->row[offset] = cnames_take(&w->names, kept_name(w, &w->p->ins.at[code_of(w, b->l, 0, offset)]));
  cwriter_line(w, arena_printf(w->a, "%s_REAL %s[%u];", w->style->prefix, b->row[offset], b->l->count));
  return b->row[offset];
}

/* Appends "x[k + t], &sin[k + t], &cos[k + t]". */
static void put_angle(const Writer *w, const char *const *row, const Ins *load, int64_t step, int64_t t, int64_t by,
                      StrBuf *b) {
  const char *at = index_text(w, t, by);
  sb_printf(b, "%s%s[%s], &%s[%s], &%s[%s]", b->n ? ", " : "", cwriter_array(w, load->array),
            index_text(w, load->index + t * step, by * step), row[0], at, row[1], at);
}

/* Sines and cosines of an array's elements before the loop, four calls at once, which processors overlap. */
static void write_sincos_rows(Writer *w, Body *b) {
  for (uint32_t k = 0; k < b->l->period; k++) {
    Slot s = code_of(w, b->l, 0, k), other = w->pair[s], angle = w->p->ins.at[s].a;
    if (other < s) continue;
    uint32_t j = offset_of(w, b->l, other);
    Step by = roll_step(&w->rolls, b->l, k, 0);
    if (by.kind != STEP_LOAD || b->l->kept[k] > 1 || b->l->kept[j] > 1) continue;
    int swap = strcmp(w->p->ins.at[s].text, "cos") == 0;
    const char *row[2];
    row[swap] = row_of(w, b, k), row[!swap] = row_of(w, b, j);
    uint32_t count = b->l->count, fours = count - count % SINCOS_BATCH;
    StrBuf four = strbuf(w->a);
    for (int t = 0; t < SINCOS_BATCH; t++) put_angle(w, row, &w->p->ins.at[angle], by.step, t, 1, &four);
    cwriter_line(w, arena_printf(w->a, "for (int k = 0; k < %u; k += %d)", fours, SINCOS_BATCH));
    w->indent += 2;
    cwriter_line(w, arena_printf(w->a, "%s_sincos%d(%s);", w->style->math, SINCOS_BATCH, sb_text(&four)));
    w->indent -= 2;
    for (uint32_t t = fours; t < count; t++) {
      StrBuf one = strbuf(w->a);
      put_angle(w, row, &w->p->ins.at[angle], by.step, t, 0, &one);
      cwriter_line(w, arena_printf(w->a, "%s_sincos(%s);", w->style->math, sb_text(&one)));
    }
  }
}

static const TurnLoad *turn_load(const Body *b, Slot first, int64_t step) {
  for (uint32_t i = 0; i < b->loads.n; i++)
    if (b->loads.at[i].first == first && b->loads.at[i].step == step) return &b->loads.at[i];
  return NULL;
}

static void name_turn_loads(Writer *w, Body *b) {
  for (uint32_t k = 0; k < b->l->period; k++)
    for (int which = 0; which < 3; which++) {
      Slot x = ins_operand(&w->p->ins.at[code_of(w, b->l, 0, k)], which);
      Step s = x ? roll_step(&w->rolls, b->l, k, which) : (Step){.kind = STEP_SAME};
      if (s.kind != STEP_LOAD || b->row[k] || turn_load(b, x, s.step)) continue;
      const Ins *i = &w->p->ins.at[x];
      const char *name = cnames_take(&w->names, cloop_stem(w->a, i->name));
      vec_push(w->a, &b->loads, ((TurnLoad){x, s.step, name}));
      cwriter_line(w, arena_printf(w->a, "const %s_REAL %s = %s[%s];", w->style->prefix, name,
                                   cwriter_array(w, i->array), index_text(w, i->index, s.step)));
    }
}

/* unit*index; a denominator that is not a power of two divides last, so that the result is rounded once. */
static CExpr multiple(const Writer *w, Num unit, const char *index) {
  int dyadic = (unit.den & (unit.den - 1)) == 0;
  const char *up = c_number(w->a, w->style->prefix, dyadic ? unit : num_int(unit.num));
  if (dyadic) return (CExpr){arena_printf(w->a, "%s*(%s_LANE)(%s)", up, w->style->prefix, index), C_MUL, 0};
  return (CExpr){arena_printf(w->a, "%s*(%s_LANE)(%s)/%s", up, w->style->prefix, index,
                              c_number(w->a, w->style->prefix, num_int(unit.den))),
                 C_MUL, 0};
}

static CExpr turn_operand(const Writer *w, const Body *b, uint32_t offset, int which, Slot x) {
  Step s = roll_step(&w->rolls, b->l, offset, which);
  uint32_t place = w->rolls.place[x] - 1; /* meaningless for loads and constants, where it is not used */
  switch (s.kind) {
    case STEP_SAME: case STEP_OWN: return w->piece[x];
    case STEP_NUMBER: {
      Num unit = {0};
      int64_t first = 0;
      Slot y = ins_operand(&w->p->ins.at[code_of(w, b->l, 1, offset)], which);
      roll_number(&w->p->ins.at[x], &w->p->ins.at[y], &unit, &first);
      return multiple(w, unit, index_text(w, first, 1));
    }
    case STEP_LOAD: return (CExpr){turn_load(b, x, s.step)->name, C_ATOM, 0};
    case STEP_BEFORE: {
      uint32_t at = place + s.back * b->l->period - b->l->begin; /* offset of the same value inside the loop */
      if (b->l->carried[at]) return (CExpr){w->kept[b->number][at], C_ATOM, 1};
      const char *index = index_text(w, (int64_t)(b->l->kept[at] - 1) - s.back, 1);
      return (CExpr){arena_printf(w->a, "%s[%s]", w->kept[b->number][at], index), C_ATOM, 1};
    }
    case STEP_OTHER: return kept_value(w, place, s.step);
  }
  return w->piece[x];
}

static Ins named_by_stem(const Writer *w, const Ins *i) {
  Ins named = *i;
  if (named.name) named.name = cloop_stem(w->a, named.name);
  return named;
}

static void write_value(Writer *w, const Body *b, uint32_t offset, Slot s, const Ins *i) {
  uint32_t kept = b->l->kept[offset];
  if (i->op == IR_PIVOT) {
    cwriter_pivot(w, i);
    return;
  }
  if (b->row[offset]) {
    w->piece[s] = (CExpr){arena_printf(w->a, "%s[k]", b->row[offset]), C_ATOM, 1};
    return;
  }
  CExpr x = cwriter_spell(w, i);
  int carried = b->l->carried[offset];
  Ins named = named_by_stem(w, i), pair = named_by_stem(w, &w->p->ins.at[w->pair[s]]);
  if (cwriter_declare_sincos(w, s, &named, &pair)) {
    x = w->piece[s];
  } else if (!kept && b->own_uses[offset] <= 1 && cwriter_is_short(w, x)) {
    w->piece[s] = x;
    return;
  } else if (b->own_uses[offset] || carried) {
    cwriter_declare(w, s, cwriter_name(w, &named), x);
    x = w->piece[s];
  }
  if (!kept || carried) return;
  cwriter_line(w, arena_printf(w->a, "%s[%s] = %s;", w->kept[b->number][offset], index_text(w, kept - 1, 1), x.text));
}

static void write_turn(Writer *w, const Body *b) {
  for (uint32_t k = 0; k < b->l->period; k++) {
    Slot s = code_of(w, b->l, 0, k);
    const Ins *i = &w->p->ins.at[s];
    CExpr before[3], now[3];
    for (int which = 0; which < 3; which++) {
      Slot x = ins_operand(i, which);
      before[which] = w->piece[x];
      now[which] = x && !b->row[k] ? turn_operand(w, b, k, which, x) : before[which];
    }
    for (int which = 0; which < 3; which++) w->piece[ins_operand(i, which)] = now[which];
    write_value(w, b, k, s, i);
    for (int which = 3; which-- > 0;) w->piece[ins_operand(i, which)] = before[which];
  }
}

/* End of a turn: stores, and the values carried to the next turn. */
static void write_turn_end(Writer *w, const Body *b) {
  const Loop *l = b->l;
  vec_each(const LoopStore, s, l->stores) {
    const char *index = index_text(w, s->index, s->step), *x = cwriter_operand(w, code_of(w, l, 0, s->offset)).text;
    cwriter_statement(w, arena_printf(w->a, "%s%s[%s] = %s;", cwriter_guard(w, index), w->style->out[s->array], index,
                                      x));
    sb_printf(w->out, " /* %s ... %s */\n", comment_text(w->a, s->first), comment_text(w->a, s->last));
  }
  for (uint32_t k = 0; k < l->period; k++) {
    if (!l->carried[k]) continue;
    cwriter_line(w, arena_printf(w->a, "%s = %s;", w->kept[b->number][k], w->piece[code_of(w, l, 0, k)].text));
  }
}

void cloop_write(Writer *w, uint32_t loop) {
  Body b = {.l = loop_at(w, loop), .number = loop};
  b.own_uses = ARENA_ARRAY(w->a, uint32_t, b.l->period);
  b.row = ARENA_ARRAY(w->a, const char *, b.l->period);
  count_own_uses(w, &b);
  cwriter_flush_title(w);
  w->kept[loop] = ARENA_ARRAY(w->a, const char *, b.l->period);
  declare_kept(w, &b, 0);
  declare_kept(w, &b, 1);
  write_first_values(w, &b);
  write_sincos_rows(w, &b);
  cwriter_line(w, arena_printf(w->a, "for (int k = 0; k < %u; k++) {", b.l->count));
  w->indent += 2;
  name_turn_loads(w, &b);
  write_turn(w, &b);
  write_turn_end(w, &b);
  w->indent -= 2;
  cwriter_line(w, "}");
  for (uint32_t k = 0; k < b.l->period; k++)
    for (uint32_t t = 0; t < b.l->count && b.l->kept[k]; t++) {
      Slot s = code_of(w, b.l, t, k);
      w->piece[s] = b.l->carried[k] ? (CExpr){w->kept[loop][k], C_ATOM, 1} : kept_value(w, w->rolls.place[s] - 1, 0);
    }
}

/* --- stores --- */

/* Position of s in the rolled code; -1 if s is in no loop. */
static int64_t loop_place(const Writer *w, Slot s) {
  uint32_t place = s ? w->rolls.place[s] : 0;
  return place && w->rolls.loop[place - 1] ? (int64_t)place - 1 : -1;
}

/* Whether store n after `first` continues the progression of the first two: index + n, and value x[0] + n*(x[1] -
 * x[0]). */
static int follows(const Writer *w, const Store *first, uint32_t n) {
  Slot x = first[0].slot, y = first[1].slot, z = first[n].slot;
  if (first[n].array != first->array || first[n].index != first->index + n) return 0;
  if (x == y) return z == x;
  const Ins *i = &w->p->ins.at[x], *j = &w->p->ins.at[y], *k = &w->p->ins.at[z];
  if (i->op == IR_LOAD)
    return j->op == IR_LOAD && k->op == IR_LOAD && j->array == i->array && k->array == i->array &&
           (int64_t)k->index - i->index == (int64_t)n * ((int64_t)j->index - i->index);
  int64_t px = loop_place(w, x), py = loop_place(w, y), pz = loop_place(w, z);
  return px >= 0 && py >= 0 && pz >= 0 && w->rolls.loop[px] == w->rolls.loop[pz] && pz - px == (int64_t)n * (py - px) &&
         (py - px) % (int64_t)loop_at(w, w->rolls.loop[px] - 1)->period == 0;
}

static const char *stored_value(const Writer *w, const Store *first) {
  Slot x = first[0].slot, y = first[1].slot;
  const Ins *i = &w->p->ins.at[x];
  if (x == y) return cwriter_operand(w, x).text;
  Num unit;
  int64_t start;
  if (roll_number(i, &w->p->ins.at[y], &unit, &start)) return multiple(w, unit, index_text(w, start, 1)).text;
  if (i->op == IR_LOAD)
    return arena_printf(w->a, "%s[%s]", cwriter_array(w, i->array),
                        index_text(w, i->index, (int64_t)w->p->ins.at[y].index - i->index));
  int64_t px = loop_place(w, x), py = loop_place(w, y);
  return kept_value(w, (uint32_t)px, (py - px) / (int64_t)loop_at(w, w->rolls.loop[px] - 1)->period).text;
}

uint32_t cloop_stores(const Writer *w, uint32_t k) {
  const Prog *p = w->p;
  const Store *first = &p->stores.at[k];
  uint32_t fewest = p->nests.n ? 8 : 16; /* programs with nests, as of networks, have shorter runs of stores */
  if (k + fewest > p->stores.n || (w->style->params && strcmp(w->style->out[first->array], w->style->in[ARR_P]) == 0))
    return 0;
  if (w->style->params && p->ins.at[first->slot].op == IR_LOAD && p->ins.at[first->slot].array == ARR_P) return 0;
  uint32_t n = roll_constants(p, k);
  while (k + n < p->stores.n && follows(w, first, n)) n++;
  return n >= fewest ? n : 0;
}

void cloop_write_stores(Writer *w, uint32_t k, uint32_t n) {
  const Store *first = &w->p->stores.at[k];
  const char *index = index_text(w, first->index, 1);
  cwriter_statement(w, arena_printf(w->a, "for (int k = 0; k < %u; k++) %s%s[%s] = %s;", n, cwriter_guard(w, index),
                                    w->style->out[first->array], index, stored_value(w, first)));
  sb_printf(w->out, " /* %s ... %s */\n", comment_text(w->a, first->comment), comment_text(w->a, first[n - 1].comment));
}
