/* Loops of a program as loops in C.
 *
 * Inside, a value is a `const` of its turn. What other turns, other loops or the code behind need is kept
 * in a local array, one element a turn, with room in front for what the first turns take from before. */
#include <string.h>

#include "emit/cwriter_impl.h"

static const Loop *loop_at(const Writer *w, uint32_t k) { return &w->rolls.loops.at[k]; }
static Slot code_of(const Writer *w, const Loop *l, uint32_t turn, uint32_t offset) {
  return w->rolls.code[l->begin + turn * l->period + offset];
}

/* --- names and indices --- */

/* x[3]' -> x', D12 -> D, L2_11 -> L: what the turns' names have in common. */
static const char *stem_of(Arena *a, const char *name) {
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

/* first + step*k */
static const char *index_text(const Writer *w, int64_t first, int64_t step) {
  const char *k = step == 1 || step == -1 ? "k" : arena_printf(w->a, "%lld*k", (long long)(step < 0 ? -step : step));
  if (step < 0) return arena_printf(w->a, "%lld - %s", (long long)first, k);
  return first ? arena_printf(w->a, "%s %c %lld", k, first < 0 ? '-' : '+', (long long)(first < 0 ? -first : first)) : k;
}

/* The value at `place` of a loop, and step turns further with each k; step 0: that one. */
static Piece kept_value(const Writer *w, uint32_t place, int64_t step) {
  uint32_t in = w->rolls.loop[place] - 1, offset, turn;
  const Loop *l = loop_at(w, in);
  offset = (place - l->begin) % l->period;
  turn = (place - l->begin) / l->period;
  int64_t first = (int64_t)(l->kept[offset] - 1) + turn;
  const char *index = step ? index_text(w, first, step) : arena_printf(w->a, "%lld", (long long)first);
  return (Piece){arena_printf(w->a, "%s[%s]", w->kept[in][offset], index), C_ATOM, 1};
}

/* --- preparation --- */

static void name_load(Writer *w, Slot s) {
  if (s && w->p->ins.at[s].op == IR_LOAD) w->named_load[s] = 1;
}

int cloop_names_load(const Writer *w, Slot s) { return !w->rolls.loops.n || w->named_load[s]; }

void cloop_prepare(Writer *w) {
  const Rolls *r = &w->rolls;
  if (!r->loops.n) return;
  w->named_load = ARENA_ARRAY(w->a, unsigned char, w->p->ins.n);
  w->kept = ARENA_ARRAY(w->a, const char **, r->loops.n);
  cnames_reserve(&w->names, "k");
  for (uint32_t k = 0; k < r->n; k++) {
    const Ins *i = &w->p->ins.at[r->code[k]];
    const Loop *l = r->loop[k] ? loop_at(w, r->loop[k] - 1) : NULL;
    uint32_t offset = l ? (k - l->begin) % l->period : 0;
    for (int which = 0; which < 3; which++) {
      Slot x = roll_operand(i, which);
      if (x && (!l || roll_step(r, l, offset, which).kind == STEP_SAME)) name_load(w, x);
    }
    if (i->op != IR_SOLVE) continue;
    const Solve *s = &w->p->solves.at[i->index];
    for (uint32_t j = 0; j < s->n * s->n; j++) name_load(w, s->matrix[j]);
    for (uint32_t j = 0; j < s->n; j++) name_load(w, s->rhs[j]);
  }
  for (uint32_t k = 0; k < w->p->stores.n; k++) name_load(w, w->p->stores.at[k].slot);
}

/* --- a loop --- */

/* Loads that change from turn to turn, each named once. */
typedef struct {
  Slot first;
  int64_t step;
  const char *name;
} TurnLoad;

typedef struct {
  const Loop *l;
  uint32_t number;
  uint32_t *own_uses; /* [period] in the same turn */
  VEC(TurnLoad) loads;
} Body;

static uint32_t offset_of(const Writer *w, const Loop *l, Slot s) { return w->rolls.place[s] - 1 - l->begin; }

static void count_own_uses(Writer *w, Body *b) {
  for (uint32_t k = 0; k < b->l->period; k++) {
    const Ins *i = &w->p->ins.at[code_of(w, b->l, 0, k)];
    int twice = i->op == IR_PIVOT || i->op == IR_SIGN || i->op == IR_MIN || i->op == IR_MAX; /* spelled twice */
    for (int which = 0; which < 3; which++) {
      Slot x = roll_operand(i, which);
      if (x && roll_step(&w->rolls, b->l, k, which).kind == STEP_OWN) b->own_uses[offset_of(w, b->l, x)] += twice ? 2 : 1;
    }
  }
}

static void declare_kept(Writer *w, const Body *b) {
  const Loop *l = b->l;
  const char **names = w->kept[b->number] = ARENA_ARRAY(w->a, const char *, l->period);
  StrBuf text = strbuf(w->a);
  for (uint32_t k = 0; k < l->period; k++) {
    if (!l->kept[k]) continue;
    const Ins *i = &w->p->ins.at[code_of(w, l, 0, k)];
    names[k] = cnames_take(&w->names, i->name ? stem_of(w->a, i->name) : "kept");
    sb_printf(&text, "%s%s[%u]", text.n ? ", " : "", names[k], l->count + l->kept[k] - 1);
  }
  if (!text.n) return;
  cwriter_statement(w, arena_printf(w->a, "%s_REAL %s;", w->style->prefix, sb_text(&text)));
  sb_putc(w->out, '\n');
}

/* What the first turns take from the code before. */
static void write_first_values(Writer *w, const Body *b) {
  const Loop *l = b->l;
  for (uint32_t k = 0; k < l->period; k++)
    for (uint32_t t = 0; t + 1 < l->kept[k]; t++) {
      uint32_t place = l->begin + k - (l->kept[k] - 1 - t) * l->period;
      cwriter_statement(w, arena_printf(w->a, "%s[%u] = %s;", w->kept[b->number][k], t, cwriter_operand(w, w->rolls.code[place]).text));
      sb_putc(w->out, '\n');
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
      Slot x = roll_operand(&w->p->ins.at[code_of(w, b->l, 0, k)], which);
      Step s = x ? roll_step(&w->rolls, b->l, k, which) : (Step){.kind = STEP_SAME};
      if (s.kind != STEP_LOAD || turn_load(b, x, s.step)) continue;
      const Ins *i = &w->p->ins.at[x];
      const char *name = cnames_take(&w->names, stem_of(w->a, i->name));
      vec_push(w->a, &b->loads, ((TurnLoad){x, s.step, name}));
      cwriter_statement(w, arena_printf(w->a, "const %s_REAL %s = %s[%s];", w->style->prefix, name, w->style->in[i->array],
                                        index_text(w, i->index, s.step)));
      sb_putc(w->out, '\n');
    }
}

static Piece turn_operand(const Writer *w, const Body *b, uint32_t offset, int which, Slot x) {
  Step s = roll_step(&w->rolls, b->l, offset, which);
  uint32_t place = w->rolls.place[x] - 1; /* of values that are no loads */
  switch (s.kind) {
    case STEP_SAME: case STEP_OWN: return w->piece[x];
    case STEP_LOAD: return (Piece){turn_load(b, x, s.step)->name, C_ATOM, 0};
    case STEP_BEFORE: {
      uint32_t at = place + s.back * b->l->period - b->l->begin; /* offset of what it becomes */
      const char *index = index_text(w, (int64_t)(b->l->kept[at] - 1) - s.back, 1);
      return (Piece){arena_printf(w->a, "%s[%s]", w->kept[b->number][at], index), C_ATOM, 1};
    }
    case STEP_OTHER: return kept_value(w, place, s.step);
  }
  return w->piece[x];
}

static void write_value(Writer *w, const Body *b, uint32_t offset, Slot s, const Ins *i) {
  uint32_t kept = b->l->kept[offset];
  if (i->op == IR_PIVOT) {
    cwriter_pivot(w, i);
    return;
  }
  Piece x = cwriter_spell(w, i);
  if (!kept && b->own_uses[offset] <= 1 && cwriter_is_short(w, x)) {
    w->piece[s] = x;
    return;
  }
  if (b->own_uses[offset]) {
    Ins named = *i;
    if (named.name) named.name = stem_of(w->a, named.name);
    cwriter_declare(w, s, cwriter_name(w, &named), x);
    x = w->piece[s];
  }
  if (!kept) return;
  cwriter_statement(w, arena_printf(w->a, "%s[%s] = %s;", w->kept[b->number][offset], index_text(w, kept - 1, 1), x.text));
  sb_putc(w->out, '\n');
}

static void write_turn(Writer *w, const Body *b) {
  for (uint32_t k = 0; k < b->l->period; k++) {
    Slot s = code_of(w, b->l, 0, k);
    const Ins *i = &w->p->ins.at[s];
    Piece before[3], now[3];
    for (int which = 0; which < 3; which++) {
      Slot x = roll_operand(i, which);
      before[which] = w->piece[x];
      now[which] = x ? turn_operand(w, b, k, which, x) : before[which];
    }
    for (int which = 0; which < 3; which++) w->piece[roll_operand(i, which)] = now[which];
    write_value(w, b, k, s, i);
    for (int which = 3; which-- > 0;) w->piece[roll_operand(i, which)] = before[which];
  }
}

void cloop_write(Writer *w, uint32_t loop) {
  Body b = {.l = loop_at(w, loop), .number = loop};
  b.own_uses = ARENA_ARRAY(w->a, uint32_t, b.l->period);
  count_own_uses(w, &b);
  cwriter_flush_title(w);
  declare_kept(w, &b);
  write_first_values(w, &b);
  cwriter_statement(w, arena_printf(w->a, "for (int k = 0; k < %u; k++) {", b.l->count));
  sb_putc(w->out, '\n');
  w->indent += 2;
  name_turn_loads(w, &b);
  write_turn(w, &b);
  w->indent -= 2;
  cwriter_statement(w, "}");
  sb_putc(w->out, '\n');
  for (uint32_t k = 0; k < b.l->period; k++)
    for (uint32_t t = 0; t < b.l->count && b.l->kept[k]; t++) {
      Slot s = code_of(w, b.l, t, k);
      w->piece[s] = kept_value(w, w->rolls.place[s] - 1, 0);
    }
}

/* --- stores --- */

static int in_loop(const Writer *w, Slot s) { return s && w->rolls.place[s] && w->rolls.loop[w->rolls.place[s] - 1]; }

uint32_t cloop_stores(Writer *w, uint32_t k) {
  enum { FEWEST = 8 };
  const Prog *p = w->p;
  const Store *first = &p->stores.at[k];
  if (k + FEWEST > p->stores.n || !in_loop(w, first->slot) || !in_loop(w, first[1].slot)) return 0;
  int64_t place = w->rolls.place[first->slot] - 1, step = (int64_t)w->rolls.place[first[1].slot] - 1 - place;
  uint32_t in = w->rolls.loop[place], n = 1;
  const Loop *l = loop_at(w, in - 1);
  if (!step || step % (int64_t)l->period != 0 || (w->style->params && strcmp(w->style->out[first->array], w->style->in[ARR_P]) == 0)) return 0;
  while (k + n < p->stores.n && first[n].array == first->array && first[n].index == first->index + n && in_loop(w, first[n].slot) &&
         (int64_t)w->rolls.place[first[n].slot] - 1 == place + (int64_t)n * step && w->rolls.loop[w->rolls.place[first[n].slot] - 1] == in) n++;
  if (n < FEWEST) return 0;
  Piece value = kept_value(w, (uint32_t)place, step / (int64_t)l->period);
  cwriter_statement(w, arena_printf(w->a, "for (int k = 0; k < %u; k++) %s[%s] = %s;", n, w->style->out[first->array],
                                    index_text(w, first->index, 1), value.text));
  sb_printf(w->out, " /* %s ... %s */\n", comment_text(w->a, first->comment), comment_text(w->a, first[n - 1].comment));
  return n;
}
