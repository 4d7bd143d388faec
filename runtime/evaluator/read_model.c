/* A lag_program from bytes. The order of the fields is that of src/emit/emit_bytes.c; each index is checked. */
#include "evaluator/evaluator.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "evaluator/evaluated_model.h"
#include "evaluator/read_program.h"

typedef struct {
  lag_program program;
  Memory *memory;
} Evaluated;

/* A model that is being read, with the lengths of arrays that its functions share. */
typedef struct {
  Bytes *b;
  EvaluatedModel *m;
  Lengths state;
  int ny;
} Reader;

static const char *name_of(Bytes *b) {
  const char *text = lag_bytes_text(b);
  lag_bytes_need(b, text != NULL, "a name is missing");
  return text;
}

/* A program that writes arrays of these lengths, 0 at the end. */
static const Program *program(const Reader *r, int64_t x, int64_t y, int64_t z) {
  Lengths of = r->state;
  of.out[0] = x, of.out[1] = y, of.out[2] = z;
  return lag_read_program(r->b, &of);
}

/* One that must be there if it is wanted, and must not if not. */
static const Program *wanted(const Reader *r, int is_wanted, int64_t x, int64_t y) {
  const Program *p = program(r, x, y, 0);
  lag_bytes_need(r->b, (p != NULL) == (is_wanted != 0), "a function is missing");
  return p;
}

/* A reader for functions that read `n` elements of one more array. */
static Reader with_array(const Reader *r, int array, int64_t n) {
  Reader with = *r;
  with.state.in[array] = n;
  return with;
}

/* A reader for functions that are called with parameters alone, or with time, too. */
static Reader without_state(const Reader *r, int timed) {
  Reader alone = *r;
  memset(&alone.state, 0, sizeof alone.state);
  alone.state.in[PROGRAM_T] = timed, alone.state.in[PROGRAM_P] = r->state.in[PROGRAM_P];
  return alone;
}

static const lag_var *variables(Bytes *b, int *n) {
  lag_var *v = list(b, n, 32, sizeof *v);
  for (int i = 0; v && i < *n; i++) {
    v[i].name = name_of(b), v[i].unit = name_of(b);
    v[i].factor = lag_bytes_number(b), v[i].offset = lag_bytes_number(b);
    v[i].periodic = flag(b), v[i].sign = lag_bytes_int(b, -2, 2);
  }
  return v;
}

/* Entries of a sparse matrix, row by row, columns ascending. lower: of the lower triangle. */
static const lag_entry *entries(Bytes *b, int *n, int rows, int columns, int lower) {
  lag_entry *e = list(b, n, 8, sizeof *e);
  for (int i = 0; e && i < *n; i++) {
    e[i].row = below(b, rows), e[i].col = below(b, columns);
    int follows = !i || e[i].row > e[i - 1].row || (e[i].row == e[i - 1].row && e[i].col > e[i - 1].col);
    lag_bytes_need(b, follows && (!lower || e[i].col <= e[i].row), "entries of a matrix are out of order");
  }
  return e;
}

/* --- parts of a model --- */

static void read_events(Reader *r) {
  Bytes *b = r->b;
  int n = r->m->model.nev = (int)lag_bytes_count(b, 24);
  lag_event *ev = lag_bytes_room(b, (size_t)n, sizeof *ev);
  EvaluatedEvent *of = lag_bytes_room(b, (size_t)n, sizeof *of);
  for (int i = 0; of && ev && i < n; i++) {
    ev[i].name = name_of(b), ev[i].direction = lag_bytes_int(b, -1, LAG_KICK);
    of[i].stop = flag(b), of[i].strikes = flag(b);
    of[i].constraint = (int)lag_bytes_word(b), of[i].input = (int)lag_bytes_word(b);
    int inside = of[i].constraint >= 0 && of[i].constraint < r->m->nconstraints && of[i].input >= 0 &&
                 of[i].input < r->m->model.nu;
    lag_bytes_need(b, !of[i].strikes || inside, "an event strikes out of range");
  }
  r->m->model.ev = ev;
  r->m->event = of;
  r->m->events = wanted(r, n > 0, n, 0);
  Reader alone = with_array(r, PROGRAM_G, r->m->nconstraints);
  alone.state.in[PROGRAM_U] = r->m->model.nu; /* the law of impact has inputs of its own, without modes */
  r->m->impact = program(&alone, r->m->model.nq, 0, 0);
  for (int i = 0; of && i < n; i++) {
    of[i].action = program(r, r->m->model.nq, r->m->model.nq, r->m->model.nz);
    lag_bytes_need(b, !of[i].strikes || r->m->impact, "a law of impact is missing");
  }
}

static void read_tables(Reader *r) {
  Bytes *b = r->b;
  lag_model *m = &r->m->model;
  lag_table *t = list(b, &m->ntables, 8, sizeof *t);
  for (int i = 0; t && i < m->ntables; i++) {
    int input = below(b, m->nu), k = below(b, r->m->inputs ? (int)r->m->inputs->ncurves : 0);
    if (b->why) return;
    const Curve *c = &r->m->inputs->curves[k];
    t[i] = (lag_table){input, c->n, c->columns, c->row};
  }
  m->tables = t;
}

static const lag_adjoint *read_adjoint(Reader *r) {
  Bytes *b = r->b;
  const lag_model *m = &r->m->model;
  EvaluatedAdjoint *x = flag(b) ? lag_bytes_room(b, 1, sizeof *x) : NULL;
  if (!x) return NULL;
  Reader with = with_array(r, PROGRAM_G, m->nq + m->nz + r->m->nconstraints);
  with.state.in[PROGRAM_A] = m->nq;
  x->adjoint.at = entries(b, &x->adjoint.n, m->nu, m->np, 0);
  x->eval = program(&with, r->ny, m->nu + m->np, x->adjoint.n);
  if (r->m->nconstraints) {
    x->rates = program(r, m->nq, m->nz, r->m->nconstraints);
    with.state.in[PROGRAM_G] = r->ny;
    x->project = program(&with, r->ny, m->nu + m->np, x->adjoint.n);
  }
  lag_bytes_need(b, x->eval && !r->m->nconstraints == !x->rates && !x->rates == !x->project, "a function is missing");
  lag_set_adjoint_functions(x);
  return &x->adjoint;
}

static void read_constraints(Reader *r) {
  Bytes *b = r->b;
  int n = below(b, INT32_MAX), kept = below(b, n + 1), nq = r->m->model.nq;
  lag_bytes_need(b, n == r->m->nconstraints, "constraints are missing");
  if (!n || b->why) return;
  EvaluatedConstraints *c = lag_bytes_room(b, 1, sizeof *c);
  lag_constraint *of = lag_bytes_room(b, (size_t)n, sizeof *of);
  for (int i = 0; of && i < n; i++) {
    of[i].name = name_of(b), of[i].unit = name_of(b);
    of[i].holonomic = flag(b), of[i].line = below(b, INT32_MAX);
  }
  if (!c) return;
  lag_constraints *k = &c->constraints;
  k->n = n, k->nholonomic = kept, k->of = of;
  k->jacobian = entries(b, &k->njacobian, n, nq, 0);
  k->mass = entries(b, &k->nmass, nq, nq, 1);
  c->residuals = wanted(r, 1, kept, n);
  c->matrices = wanted(r, 1, k->njacobian, k->nmass);
  Reader places = with_array(r, PROGRAM_G, kept), rates = with_array(r, PROGRAM_G, n);
  c->position = wanted(&places, kept > 0, nq, nq);
  c->velocity = wanted(&rates, 1, nq, nq);
  k->adjoint = read_adjoint(r);
  lag_set_constraint_functions(c);
  r->m->model.constraints = k;
}

/* Guides, which own the tangents that follow no contact. */
static void read_guides(Reader *r, const lag_contact *c, int n) {
  Bytes *b = r->b;
  lag_model *m = &r->m->model;
  int of = 0, have = m->nguides = (int)lag_bytes_count(b, 12);
  lag_guide *g = lag_bytes_room(b, (size_t)have, sizeof *g);
  for (int i = 0; g && i < have; i++) {
    g[i].tangent = below(b, n), g[i].parts = lag_bytes_int(b, 1, 3);
    g[i].turn = lag_bytes_int(b, -1, m->nev - 1);
    lag_bytes_need(b, c && n > 0 && c[g[i].tangent].is_tangent, "a guide has no tangent");
  }
  m->guides = g;
  for (int i = 0; c && g && i < n; i++) {
    while (of < have && g[of].tangent < i) of++;
    int own = of < have && g[of].tangent == i;
    lag_bytes_need(b, own || !c[i].is_tangent || i > 0, "a tangent has no contact");
  }
}

static void read_contacts(Reader *r) {
  Bytes *b = r->b;
  lag_model *m = &r->m->model;
  int n = m->ncontacts = (int)lag_bytes_count(b, 32);
  lag_contact *c = lag_bytes_room(b, (size_t)n, sizeof *c);
  for (int i = 0; c && i < n; i++) {
    c[i].input = below(b, m->nu), c[i].constraint = below(b, r->m->nconstraints);
    c[i].impact = below(b, m->nev), c[i].release = below(b, m->nev);
    c[i].is_tangent = flag(b), c[i].force = below(b, m->nu);
    c[i].conditional = flag(b), c[i].law = lag_bytes_int(b, 0, 2);
  }
  m->contacts = c;
  read_guides(r, c, n);
  r->m->contact_laws = program(r, 3 * (int64_t)n + 4 * (int64_t)m->nguides, 0, 0);
  Reader loads = with_array(r, PROGRAM_G, r->m->nconstraints);
  r->m->guide_loads = program(&loads, m->nq, m->nq, 3 * (int64_t)m->nguides);
}

static int64_t turns_of(const lag_contact_family *f, int row) { return f->turns + (int64_t)f->more * row; }

/* n reads, whose indices are below `end` for all members. */
static const lag_read *read_reads(Bytes *b, const lag_contact_family *f, int n, int end) {
  enum { MOST = 1 << 28 };
  int row[2] = {0, f->rows - 1}; /* the first and the last with turns */
  while (row[0] <= row[1] && turns_of(f, row[0]) <= 0) row[0]++;
  while (row[0] <= row[1] && turns_of(f, row[1]) <= 0) row[1]--;
  lag_read *x = lag_bytes_room(b, (size_t)n, sizeof *x);
  for (int i = 0; x && i < n; i++) {
    x[i].first = lag_bytes_int(b, -MOST, MOST);
    x[i].by_row = lag_bytes_int(b, -MOST, MOST), x[i].by_turn = lag_bytes_int(b, -MOST, MOST);
    for (int k = 0; row[0] <= row[1] && k < 4; k++) { /* corners */
      int64_t of = row[k / 2], turn = f->skew * of + (k % 2 ? turns_of(f, row[k / 2]) - 1 : 0);
      int64_t at = x[i].first + x[i].by_row * of + x[i].by_turn * turn;
      lag_bytes_need(b, at >= 0 && at < end, "a contact reads out of range");
    }
  }
  return x;
}

static void read_family(Reader *r, lag_contact_family *f, EvaluatedFamily *of) {
  enum { MOST = 1 << 20, STEEP = 4 };
  Bytes *b = r->b;
  const int nq = r->m->model.nq, np = r->m->model.np;
  f->name = name_of(b), f->indices = lag_bytes_int(b, 1, 2);
  f->i0 = lag_bytes_int(b, -MOST, MOST), f->j0 = lag_bytes_int(b, -MOST, MOST), f->rows = lag_bytes_int(b, 0, MOST);
  f->skew = lag_bytes_int(b, -STEEP, STEEP), f->turns = lag_bytes_int(b, -MOST, MOST);
  f->more = lag_bytes_int(b, -STEEP, STEEP), f->tangents = lag_bytes_int(b, 0, 2), f->nplaces = lag_bytes_int(b, 0, 3);
  f->ncoords = (int)lag_bytes_count(b, 12), f->coords = read_reads(b, f, f->ncoords, nq);
  f->nparams = (int)lag_bytes_count(b, 12), f->params = read_reads(b, f, f->nparams, np);
  for (int c = 0, members = f->i0 + f->rows - f->j0; c < f->nplaces; c++) {
    lag_read *x = &f->place[c];
    x->first = below(b, nq), x->by_row = lag_bytes_int(b, 0, 0);
    x->by_turn = lag_bytes_int(b, 0, nq);
    int64_t last = x->first + (int64_t)(members - 1) * x->by_turn;
    lag_bytes_need(b, f->i0 >= f->j0 && members > 0 && last < nq && x->by_turn == f->place[0].by_turn,
                   "places of contacts are out of range");
  }
  Reader with = *r, alone = without_state(r, 0);
  with.state.in[PROGRAM_Q] = with.state.in[PROGRAM_V] = f->ncoords, with.state.in[PROGRAM_Z] = f->nparams;
  of->values = wanted(&with, 1, LAG_FAMILY_VALUES + f->tangents + (1 + f->tangents) * (int64_t)f->ncoords, 0);
  of->reach = wanted(&alone, f->nplaces > 0, 4, 0);
}

/* Families of contacts; their rows at once, as moreau finds room for them, are some millions at most. */
static void read_families(Reader *r) {
  Bytes *b = r->b;
  const int n = (int)lag_bytes_count(b, 52), nq = r->m->model.nq;
  if (!n) return;
  EvaluatedFamilies *all = lag_bytes_room(b, 1, sizeof *all);
  lag_contact_family *f = lag_bytes_room(b, (size_t)n, sizeof *f);
  EvaluatedFamily *of = lag_bytes_room(b, (size_t)n, sizeof *of);
  int64_t most = 0;
  for (int i = 0; f && of && !b->why && i < n; i++)
    read_family(r, &f[i], &of[i]), most += 24 * ((int64_t)f[i].rows + 1) * (f[i].ncoords + f[i].nparams + 1);
  if (!all || !f || !of || !lag_bytes_need(b, most < INT32_MAX, "contacts are too many")) return;
  all->families.n = n, all->of = of;
  all->families.mass = entries(b, &all->families.nmass, nq, nq, 1);
  all->inertia = wanted(r, 1, all->families.nmass, 0);
  lag_set_family_functions(all, f);
  r->m->model.families = &all->families;
}

static void read_sizes(Reader *r) {
  Bytes *b = r->b;
  lag_model *m = &r->m->model;
  m->nsizes = (int)lag_bytes_count(b, 16), m->nmoving = (int)lag_bytes_count(b, 16);
  lag_size *s = lag_bytes_room(b, (size_t)m->nsizes + (size_t)m->nmoving, sizeof *s);
  for (int i = 0; s && i < m->nsizes + m->nmoving; i++) {
    s[i].what = name_of(b), s[i].text = name_of(b);
    s[i].open = flag(b), s[i].part = flag(b);
  }
  m->sizes = s;
  r->m->sizes = wanted(r, m->nsizes > 0, m->nsizes, 0);
  r->m->moving_sizes = wanted(r, m->nmoving > 0, m->nmoving, 0);
}

static void read_charges(Reader *r) {
  Bytes *b = r->b;
  int n = (int)lag_bytes_count(b, 12);
  EvaluatedCharges *c = lag_bytes_room(b, 1, sizeof *c);
  lag_charge *of = lag_bytes_room(b, (size_t)n, sizeof *of);
  for (int i = 0; of && i < n; i++) of[i].name = name_of(b), of[i].unit = name_of(b), of[i].flags = lag_bytes_word(b);
  if (!c) return;
  c->charges.n = n, c->charges.of = of, c->charges.dry_friction = flag(b);
  c->values = program(r, 2 * ((int64_t)n - 1), 0, 0);
  lag_bytes_need(b, n < 2 || c->values, "charges have no values");
  c->powers = program(r, n + c->charges.dry_friction, 0, 0);
  lag_set_charge_functions(c);
  if (n) r->m->model.charges = &c->charges;
}

static void read_switches(Reader *r) {
  Bytes *b = r->b;
  lag_model *m = &r->m->model;
  int n = m->nswitch = (int)lag_bytes_count(b, 28), modes = below(b, n + 1);
  lag_switch *s = lag_bytes_room(b, (size_t)n, sizeof *s);
  lag_bytes_need(b, modes == m->nmodes, "switches are missing");
  for (int i = 0; s && i < n; i++) {
    s[i].surface = name_of(b), s[i].text = name_of(b), s[i].line = below(b, INT32_MAX);
    s[i].jumps = flag(b), s[i].is_floor = flag(b), s[i].is_timed = flag(b), s[i].nonnegative = flag(b);
  }
  m->switches = s;
  r->m->switch_values = wanted(r, n > 0, n, 0);
  r->m->switch_rates = wanted(r, modes > 0, modes, 0);
  r->m->switch_grips = program(r, modes, 0, 0);
}

/* Derivatives of residuals by so many parameters or inputs; NULL: none. */
static const lag_partials *read_partials(Reader *r, int columns, int nmass) {
  Bytes *b = r->b;
  EvaluatedPartials *p = flag(b) ? lag_bytes_room(b, 1, sizeof *p) : NULL;
  if (!p) return NULL;
  p->partials.at = entries(b, &p->partials.n, r->m->model.nq + r->m->model.nz, columns, 0);
  p->eval = wanted(r, 1, p->partials.n, nmass);
  lag_set_partial_functions(p);
  return &p->partials;
}

static void read_linear(Reader *r) {
  Bytes *b = r->b;
  if (!flag(b)) return;
  int nq = r->m->model.nq, ny = r->ny;
  EvaluatedLinear *l = lag_bytes_room(b, 1, sizeof *l);
  if (!l) return;
  l->linear.dr = entries(b, &l->linear.ndr, nq + r->m->model.nz, ny, 0);
  l->linear.mass = entries(b, &l->linear.nmass, nq, nq, 1);
  l->linear.ops = lag_bytes_int(b, 0, INT32_MAX);
  Reader with = with_array(r, PROGRAM_A, nq);
  l->eval = wanted(&with, 1, l->linear.ndr, l->linear.nmass);
  lag_jump *j = list(b, &l->linear.njump, 12, sizeof *j);
  for (int i = 0; j && i < l->linear.njump; i++) {
    j[i].event = below(b, r->m->model.nev);
    j[i].row = lag_bytes_int(b, INT32_MIN + 1, ny - 1), j[i].col = below(b, ny + 1);
  }
  l->linear.jump = j;
  l->jumps = program(r, l->linear.njump, 0, 0);
  lag_bytes_need(b, !l->linear.njump || l->jumps, "derivatives of events are missing");
  l->linear.by_params = read_partials(&with, r->m->model.np, l->linear.nmass);
  l->linear.by_inputs = read_partials(&with, r->m->model.nu, l->linear.nmass);
  l->linear.adjoint = read_adjoint(&with);
  lag_set_linear_functions(l);
  r->m->model.linear = &l->linear;
}

static void read_variation(Reader *r) {
  Bytes *b = r->b;
  lag_model *m = &r->m->model;
  r->m->variation = program(r, m->nq, m->nq, m->nq);
  lag_second *s = list(b, &m->nsecond, 12, sizeof *s);
  for (int i = 0; s && i < m->nsecond; i++) {
    s[i].part = lag_bytes_int(b, LAG_QQ, LAG_FV);
    s[i].row = below(b, m->nq), s[i].col = below(b, m->nq);
  }
  m->second_at = s;
  r->m->second = wanted(r, r->m->variation != NULL, m->nsecond, 0);
  Reader with = with_array(r, PROGRAM_A, m->nq);
  r->m->inverse = program(&with, m->nq, 0, 0);
}

static void read_kepler(Reader *r) {
  const int nq = r->m->model.nq;
  EvaluatedKepler *k = flag(r->b) ? lag_bytes_room(r->b, 1, sizeof *k) : NULL;
  if (!k) return;
  k->kepler.n = lag_bytes_int(r->b, 1, nq), k->kepler.dim = lag_bytes_int(r->b, 2, 3), k->kepler.fixed = flag(r->b);
  if (!lag_bytes_need(r->b, (int64_t)k->kepler.n * k->kepler.dim == nq, "coordinates of bodies are missing")) return;
  k->kepler.at = ints_of(r->b, nq, nq);
  k->values = wanted(r, 1, 2 * (int64_t)k->kepler.n, 0);
  lag_set_kepler_functions(k);
  r->m->model.kepler = &k->kepler;
}

static void read_taylor(Reader *r) {
  enum { MOST = 1 << 24 };
  Bytes *b = r->b;
  if (!flag(b)) return;
  EvaluatedTaylor *t = lag_bytes_room(b, 1, sizeof *t);
  if (!t) return;
  t->nq = r->m->model.nq, t->nz = r->m->model.nz;
  t->taylor =
      (lag_taylor){.order = LAG_TAYLOR_ORDER, .columns = lag_bytes_int(b, 1, MOST), .width = (r->ny + 3) / 4 * 4};
  t->sums = lag_bytes_int(b, 0, MOST), t->squares = lag_bytes_int(b, 0, MOST);
  t->first_square = lag_bytes_int(b, 0, MOST), t->row = lag_bytes_int(b, 0, MOST);
  t->constants = lag_bytes_int(b, 0, MOST), t->uses_time = flag(b), t->near = flag(b);
  t->taylor.cost_first = lag_bytes_int(b, 0, INT32_MAX), t->taylor.cost_next = lag_bytes_int(b, 0, INT32_MAX),
  t->taylor.sums = below(b, INT32_MAX);
  int fits = t->sums <= t->first_square && t->first_square + t->squares <= t->row &&
             t->taylor.width <= t->taylor.columns &&
             (int64_t)3 * t->nq + 2 * (int64_t)t->nz + t->uses_time <= t->taylor.columns;
  lag_bytes_need(b, fits, "columns of a series are missing");
  Reader with = with_array(r, PROGRAM_FREE, r->m->model.nu);
  t->first = wanted(&with, 1, t->taylor.columns, t->constants);
  Lengths of = {{0}, {t->taylor.columns, t->taylor.columns, t->row, t->first_square}};
  of.in[PROGRAM_COEF] = t->taylor.columns, of.in[PROGRAM_SUMS] = t->row, of.in[PROGRAM_STEP] = t->constants;
  of.in[PROGRAM_ORDER] = of.in[PROGRAM_PER_ORDER] = of.in[PROGRAM_UP] = 1;
  t->next = lag_read_program(b, &of);
  if (!lag_bytes_need(b, t->first && t->next, "a series is missing")) return;
  size_t room = lag_taylor_room(t);
  lag_bytes_need(b, room < INT32_MAX, "a series is too long");
  t->taylor.nw = (int)room;
  lag_set_taylor_functions(t);
  r->m->model.taylor = &t->taylor;
}

/* --- models and scenes --- */

static void read_head(Reader *r) {
  Bytes *b = r->b;
  lag_model *m = &r->m->model;
  m->abi = LAG_ABI, m->real_size = sizeof(double);
  m->name = name_of(b), m->doc = name_of(b), m->effects = name_of(b), m->digest = name_of(b),
  m->fixed = lag_bytes_text(b);
  m->math = flag(b) ? "sin and cos: lag_math.h" : "sin and cos: the C library's";
  m->flags = lag_bytes_word(b), m->ops = lag_bytes_int(b, 0, INT32_MAX); /* at most what ops_as_int gives */
  m->q = variables(b, &m->nq), m->z = variables(b, &m->nz), m->p = variables(b, &m->np), m->u = variables(b, &m->nu);
  m->nderived = lag_bytes_int(b, 0, 1 << 24), m->nmodes = lag_bytes_int(b, 0, 1 << 24);
  r->m->nconstraints = lag_bytes_int(b, 0, 1 << 24);
  r->ny = 2 * m->nq + m->nz;
  int flows = (m->flags & LAG_FIRST_ORDER) != 0, splits = flows && (m->flags & (LAG_SEPARABLE | LAG_SUM_HAMILTONIAN));
  lag_bytes_need(b, !(flows && m->nq) && !(splits && m->nz % 2), "the flags of a model are wrong");
  int64_t *in = r->state.in;
  in[PROGRAM_T] = 1, in[PROGRAM_Q] = in[PROGRAM_V] = m->nq, in[PROGRAM_Z] = m->nz;
  in[PROGRAM_P] = (int64_t)m->np + m->nderived, in[PROGRAM_U] = (int64_t)m->nu + m->nmodes;
}

static Reader read_model(Bytes *b) {
  Reader r = {.b = b, .m = lag_bytes_room(b, 1, sizeof(EvaluatedModel))};
  if (!r.m) return r;
  read_head(&r);
  lag_model *m = &r.m->model;
  Reader alone = without_state(&r, 0), timed = without_state(&r, 1);
  r.m->derive = wanted(&alone, m->nderived > 0, r.state.in[PROGRAM_P], 0);
  r.m->accel = wanted(&r, 1, m->nq, m->nz);
  r.m->energy = program(&r, 2, 0, 0);
  read_events(&r);
  r.m->inputs = wanted(&timed, m->nu > 0, m->nu, 0);
  read_tables(&r);
  read_constraints(&r);
  read_contacts(&r);
  read_families(&r);
  read_sizes(&r);
  read_charges(&r);
  read_switches(&r);
  read_linear(&r);
  read_variation(&r);
  read_kepler(&r);
  read_taylor(&r);
  if (!b->why) lag_set_model_functions(r.m);
  return r;
}

static void read_lists(Bytes *b, const Reader *r, lag_scene *s) {
  lag_option *o = list(b, &s->noptions, 16, sizeof *o);
  for (int i = 0; o && i < s->noptions; i++)
    o[i].name = name_of(b), o[i].value = lag_bytes_number(b), o[i].text = lag_bytes_text(b);
  s->options = o;
  lag_monitor *m = list(b, &s->nmonitors, 20, sizeof *m);
  int charges = r->m->model.charges ? r->m->model.charges->n : 1;
  for (int i = 0; m && i < s->nmonitors; i++) {
    m[i].name = name_of(b), m[i].output = lag_bytes_int(b, -charges, s->nout - 1);
    m[i].limit = lag_bytes_number(b), m[i].absolute = flag(b);
  }
  s->monitors = m;
  lag_measure *k = list(b, &s->nmeasures, 8, sizeof *k);
  for (int i = 0; k && i < s->nmeasures; i++) k[i].name = name_of(b), k[i].text = name_of(b);
  s->measures = k;
}

static void read_shapes(Bytes *b, lag_scene *s) {
  s->ndrawn = lag_bytes_int(b, 0, s->nout);
  lag_shape *x = list(b, &s->nshapes, 68, sizeof *x);
  for (int i = 0; x && i < s->nshapes; i++) {
    x[i].kind = name_of(b), x[i].role = name_of(b), x[i].text = lag_bytes_text(b);
    x[i].count = lag_bytes_int(b, 0, 1000);
    int *const of[4] = {x[i].a, x[i].b, x[i].size, x[i].turn}; /* columns of outputs, or -1 */
    for (int k = 0; k < 13; k++) of[k < 12 ? k / 3 : 3][k < 12 ? k % 3 : 3] = lag_bytes_int(b, -1, s->nout - 1);
  }
  s->shapes = x;
}

static void read_actions(Bytes *b, const Reader *r, EvaluatedScene *s) {
  EvaluatedAction *a = list(b, &s->nactions, 16, sizeof *a);
  for (int i = 0; a && i < s->nactions; i++) {
    lag_action_curve *c = &a[i].curve;
    c->nq = r->m->model.nq, c->nz = r->m->model.nz;
    c->q = below(b, r->ny), c->p = below(b, r->ny);
    c->periodic = flag(b);
    a[i].of = wanted(r, 1, 4, 0);
  }
  const Program *momenta = program(r, r->m->model.nq, 0, 0);
  for (int i = 0; a && i < s->nactions; i++) a[i].momenta = momenta, lag_set_action_functions(&a[i]);
  s->action = a;
}

static void read_outputs(Bytes *b, const Reader *r, EvaluatedScene *s) {
  lag_scene *c = &s->scene;
  c->outputs = variables(b, &c->nout);
  if (flag(b)) {
    unsigned char *forces = lag_bytes_room(b, (size_t)c->nout, 1);
    for (int i = 0; forces && i < c->nout; i++) forces[i] = (unsigned char)flag(b);
    c->forces = forces;
  }
  c->nexact = (int)lag_bytes_count(b, 4);
  c->exact_of = ints_of(b, c->nexact, r->ny);
  s->exact = wanted(r, c->nexact > 0, c->nexact, 0);
  read_actions(b, r, s);
  s->nrow = r->m->model.nu + r->m->model.nmodes + c->nexact;
  Reader with = with_array(r, PROGRAM_U, (int64_t)s->nrow + s->nactions);
  s->observe = wanted(&with, 1, c->nout, 0);
}

static void read_params(Bytes *b, const Reader *alone, EvaluatedScene *s) {
  int left = alone->m->model.np;
  EvaluatedParams *x = list(b, &s->nparams, 8, sizeof *x);
  for (int i = 0; x && i < s->nparams; i++)
    x[i].n = lag_bytes_int(b, 1, left), left -= x[i].n, x[i].values = program(alone, alone->m->model.np, 0, 0);
  if (lag_bytes_need(b, !left, "a parameter has no value")) s->params = x;
}

static const lag_scene *read_scene(Bytes *b, const Reader *r) {
  EvaluatedScene *s = lag_bytes_room(b, 1, sizeof *s);
  if (!s) return NULL;
  lag_scene *c = &s->scene;
  const lag_model *m = &r->m->model;
  s->of = r->m, c->model = m;
  c->name = name_of(b), c->doc = name_of(b), c->method = lag_bytes_text(b);
  c->t0 = lag_bytes_number(b), c->t1 = lag_bytes_number(b), c->tolerance = lag_bytes_number(b),
  c->every = lag_bytes_number(b);
  c->has_span = flag(b), c->exactly = flag(b);
  Reader alone = without_state(r, 0);
  read_params(b, &alone, s);
  s->start = program(&alone, m->nq, m->nq, m->nz);
  unsigned char *given = m->constraints ? lag_bytes_room(b, (size_t)r->ny, 1) : NULL;
  for (int i = 0; given && i < r->ny; i++) given[i] = (unsigned char)lag_bytes_int(b, 0, 2);
  c->given = given;
  read_outputs(b, r, s);
  read_lists(b, r, c);
  read_shapes(b, c);
  lag_bytes_need(b, isfinite(c->t0) && isfinite(c->t1), "a span is not finite");
  if (b->why) return NULL;
  lag_set_scene_functions(s);
  return c;
}

/* A model with its scenes, which share w. */
static void read_unit(Bytes *b, const lag_scene ***at, int *room, int *n) {
  Reader r = read_model(b);
  int scenes = (int)lag_bytes_count(b, 60);
  size_t most = b->why ? 0 : lag_model_room(r.m);
  for (int i = 0; !b->why && i < scenes; i++) {
    if (*n == *room) { /* the list grows in steps; earlier ones are freed with the rest */
      const lag_scene **bigger = lag_bytes_room(b, 2 * (size_t)*room + 8, sizeof *bigger);
      if (!bigger) return;
      if (*n) memcpy(bigger, *at, (size_t)*n * sizeof *bigger);
      *at = bigger, *room = 2 * *room + 8;
    }
    const lag_scene *s = read_scene(b, &r);
    if (!s) return;
    (*at)[(*n)++] = s;
    size_t need = lag_scene_room((const EvaluatedScene *)(const void *)s);
    if (need > most) most = need;
  }
  lag_bytes_need(b, most < INT32_MAX, "a program is too large");
  if (!b->why) r.m->model.nw = (int)most;
}

static void read_all(Bytes *b, lag_program *p) {
  lag_bytes_need(b, lag_bytes_word(b) == PROGRAM_MAGIC, "these bytes are no program");
  lag_bytes_need(b, lag_bytes_word(b) == PROGRAM_VERSION, "the program was written by another version of lagc");
  p->name = name_of(b), p->doc = name_of(b), p->source = name_of(b), p->effects = name_of(b);
  uint32_t units = lag_bytes_count(b, 100);
  const lag_scene **scenes = NULL;
  int room = 0;
  for (uint32_t i = 0; !b->why && i < units; i++) read_unit(b, &scenes, &room, &p->nscenes);
  p->scenes = scenes;
  p->build = "evaluated by liblag";
  lag_bytes_need(b, p->nscenes > 0, "a program has no scenes");
  lag_bytes_need(b, b->at == b->end, "bytes are left over");
}

const lag_program *lag_program_read(const void *bytes, size_t n, const char **why) {
  Evaluated *e = calloc(1, sizeof *e);
  Bytes b = {.at = bytes, .end = (const unsigned char *)bytes + n, .memory = e ? &e->memory : NULL};
  *why = "out of memory";
  if (!e) return NULL;
  read_all(&b, &e->program);
  *why = b.why;
  if (!b.why) return &e->program;
  lag_program_free(&e->program);
  return NULL;
}

void lag_program_free(const lag_program *program) {
  Evaluated *e = (Evaluated *)(void *)(size_t)(const void *)program;
  for (Memory *m = e ? e->memory : NULL, *before; m; m = before) before = m->before, free(m);
  free(e);
}
