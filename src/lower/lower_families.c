/* Families of contacts: the program of one member, whose q and v are the coordinates that its text reads, in their
 * order, and whose z the members of families of parameters. */
#include <string.h>

#include "lower/lower_impl.h"
#include "sym/diff.h"

/* Place of a symbol among reads. */
static uint32_t place_of(const ExprGraph *g, const FamilyRead *reads, uint32_t n, SymKind kind, uint32_t index) {
  for (uint32_t k = 0; k < n; k++) {
    const Symbol *s = expr_symbol(g, reads[k].symbol);
    if (s->kind == kind && s->index == index) return k;
  }
  return n;
}

/* r[10].x of member i as r[i].x. */
static Name general_name(const Eqns *e, const ContactFamily *of, const FamilyRead *read, Name name) {
  const char *open = strchr(name, '['), *close = strchr(name, ']');
  if (!open || !close || (!read->at.by_row && !read->at.by_turn)) return name;
  return arena_printf(e->m->arena, "%.*s[%s]%s", (int)(open - name), name, read->at.by_turn ? of->name_j : of->name_i,
                      close + 1);
}

/* Loads of coordinates and of families' parameters become loads of the member's own arrays. */
static void gather(const Eqns *e, const ContactFamily *of, Prog *p) {
  for (Slot s = 1; s < p->ins.n; s++) {
    Ins *i = &p->ins.at[s];
    if (i->op != IR_LOAD) continue;
    if (i->array == ARR_Q || i->array == ARR_V) {
      i->index = place_of(e->g, of->coords.at, of->coords.n, SYM_COORD, i->index);
      i->name = general_name(e, of, &of->coords.at[i->index], i->name);
    }
    for (uint32_t k = 0; i->array == ARR_P && k < of->params.n; k++) {
      const Symbol *x = expr_symbol(e->g, of->params.at[k].symbol);
      if (e->m->params.at[x->index].place != i->index) continue;
      i->array = ARR_Z;
      i->index = k;
      i->name = general_name(e, of, &of->params.at[k], i->name);
    }
  }
}

static Expr rate_of(const Eqns *e, const ContactFamily *of) {
  ExprGraph *g = e->g;
  Expr rate = expr_diff(g, of->gap, e->m->time);
  for (uint32_t k = 0; k < of->coords.n; k++) {
    const Coord *q = &e->m->coords.at[expr_symbol(g, of->coords.at[k].symbol)->index];
    Expr slope = expr_diff(g, of->gap, q->q), part = expr_mul(g, slope, expr_symbol(g, q->v)->node);
    rate = expr_add(g, rate, part);
  }
  return rate;
}

/* FAMILY_VALUES; slips; rows of the rate and of the slips by velocities. */
static const Prog *lower_member(const Eqns *e, const ContactFamily *of) {
  Lower l = lower_new(e);
  const Expr first[] = {of->gap,      rate_of(e, of), of->restitution, of->friction, of->tangential, of->hold,
                        of->slip[0], of->slip[1]};
  static const char *const names[] = {"gap",  "gap'", "restitution", "friction", "tangential restitution",
                                      "static friction", "slip", "slip"};
  for (uint32_t k = 0; k < FAMILY_VALUES + of->tangents; k++) lower_output(&l, first[k], names[k]);
  for (uint32_t row = 0; row <= of->tangents; row++)
    for (uint32_t k = 0; k < of->coords.n; k++) {
      const Coord *q = &e->m->coords.at[expr_symbol(e->g, of->coords.at[k].symbol)->index];
      Expr slope = row ? expr_diff(e->g, of->slip[row - 1], q->v) : expr_diff(e->g, of->gap, q->q);
      lower_output(&l, slope, row ? "slip by a velocity" : "gap by a coordinate");
    }
  lower_roots(&l, l.values.at, l.values.n);
  lower_store_outputs(&l, 0);
  Prog *p = lower_finish(&l, &(PassPlan){0}, NULL);
  gather(e, of, p);
  return p;
}

static const Prog *lower_reach(const Eqns *e, const ContactFamily *of) {
  const Expr out[] = {of->cut, of->side[0], of->side[1], of->side[2]};
  if (!of->cut) return NULL;
  Lower l = lower_new(e);
  for (uint32_t k = 0; k < 4; k++)
    if (out[k]) lower_roots(&l, &out[k], 1);
  for (uint32_t k = 0; k < 4; k++) prog_store(l.p, 0, k, out[k] ? lower_slot(&l, out[k]) : 0, k ? "side" : "cut-off");
  return lower_finish_seldom(&l);
}

static IrRead read_at(Subscript x) { return (IrRead){x.first, x.by_row, x.by_turn}; }

static IrContactFamily family(const Eqns *e, const ContactFamily *of) {
  Arena *a = e->m->arena;
  IrContactFamily to = {.name = of->name, .indices = of->name_j ? 2 : 1, .i0 = of->i0, .j0 = of->j0,
                        .rows = of->range.rows, .skew = of->range.skew, .turns = of->range.turns,
                        .more = of->range.more, .tangents = of->tangents, .nplaces = of->nplaces};
  for (uint32_t k = 0; k < of->coords.n; k++) vec_push(a, &to.coords, read_at(of->coords.at[k].at));
  for (uint32_t k = 0; k < of->params.n; k++) {
    Subscript x = of->params.at[k].at; /* parameters that are numbers here have no place */
    const Symbol *s = expr_symbol(e->g, of->params.at[k].symbol);
    x.first += (int64_t)e->m->params.at[s->index].place - s->index;
    vec_push(a, &to.params, read_at(x));
  }
  for (uint32_t k = 0; k < of->nplaces; k++) to.place[k] = read_at(of->place[k]);
  to.values = lower_member(e, of);
  to.reach = lower_reach(e, of);
  return to;
}

void lower_families(ProgramSet *u, const Eqns *e) {
  const Model *m = e->m;
  if (!m->families.n) return;
  for (uint32_t i = 0; i < m->families.n; i++) {
    IrContactFamily one = family(e, &m->families.at[i]);
    vec_push(u->arena, &u->families, one);
  }
  Lower l = lower_new(e);
  for (uint32_t i = 0; i < e->mass.n; i++) {
    vec_push(u->arena, &u->family_mass, ((IrEntry){e->mass.at[i].row, e->mass.at[i].col}));
    lower_roots(&l, &e->mass.at[i].e, 1);
    prog_store(l.p, 0, i, lower_slot(&l, e->mass.at[i].e), m->coords.at[e->mass.at[i].row].name);
  }
  u->family_inertia = lower_finish(&l, &(PassPlan){0}, NULL);
}
