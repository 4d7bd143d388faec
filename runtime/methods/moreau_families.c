/* Families of contacts: enumeration, values of members, guesses. Contract: moreau_families.h. */
#include "methods/moreau_families.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "kernels/impulses.h"
#include "lag_support.h"
#include "methods/steps.h"

/* Neighbours are looked at this much beyond the distance of closed gaps: what comes nearer within a step. */
static const double BEYOND = 1.25;

/* A contact of the step: member (row, turn) of a family; its first row of A. */
typedef struct Member {
  int family, row, turn, at;
} Member;

/* In pb->family, at the begin of the room. at, jacobian, guess, bound: first the model's own contacts and
 * constraints, then families'. */
typedef struct lag_family_rows {
  int most, rows, contacts, entries, parts; /* most: rows; parts: the most numbers that a member reads */
  lag_family_step own;                      /* sizes of the model's own */
  lag_contact *at;                          /* [own + most] */
  lag_entry *jacobian;                      /* [own + most*parts] */
  Member *of;                               /* [most] */
  double *guess, *key;                      /* [own + most], [most] */
  char *bound, *tied;                       /* [own + most], [nq] whether constraints hold a coordinate */
  double *q, *v, *z, *out;                  /* of a member */
  double *reach;                            /* [4 families] cut and sides */
  lag_near *near;                           /* [families] */
} lag_family_rows;

/* --- memory --- */

static double turns_of(const lag_contact_family *f) {
  double n = 0;
  for (int row = 0; row < f->rows; row++) n += f->turns + f->more * row > 0 ? f->turns + f->more * row : 0;
  return n;
}

/* Most contacts of a family at once: of bodies in a plane at most 3 each, in space some 7 (spheres: less). */
static int most_of(const lag_contact_family *f) {
  const double all = turns_of(f), some = 8.0 * f->rows + 8;
  return (int)(all < some ? all : some);
}

static int members_of(const lag_contact_family *f) { return f->i0 + f->rows - f->j0; }

static void sizes_of(const lag_model *m, lag_family_rows *w) {
  const lag_contact_families *all = m->families;
  w->most = w->parts = 0;
  w->own = (lag_family_step){.contacts = m->ncontacts - m->nguides};
  if (m->constraints) w->own.rows = m->constraints->n, w->own.entries = m->constraints->njacobian;
  for (int k = 0; k < all->n; k++) {
    const lag_contact_family *f = &all->of[k];
    w->most += most_of(f) * (1 + f->tangents);
    if (f->ncoords + f->nparams > w->parts) w->parts = f->ncoords + f->nparams;
  }
}

static size_t doubles_of(size_t bytes) { return (bytes + sizeof(double) - 1) / sizeof(double); }

/* Lays out the room, or without one returns its size. */
static size_t lay_out(const lag_model *m, lag_family_rows *w, double *room) {
  const lag_contact_families *all = m->families;
  double *const first = room;
  sizes_of(m, w);
  const size_t most = (size_t)w->most + 1, parts = (size_t)w->parts + 1, own = (size_t)w->own.contacts;
  size_t used = doubles_of(sizeof *w);
#define PLACE(to, n) (w->to = first ? (void *)(first + used) : NULL, used += doubles_of((n) * sizeof *w->to))
  PLACE(at, own + most), PLACE(jacobian, (size_t)w->own.entries + most * parts), PLACE(of, most);
  PLACE(guess, own + most), PLACE(key, most), PLACE(bound, own + most), PLACE(tied, (size_t)m->nq);
  PLACE(q, parts), PLACE(v, parts), PLACE(z, parts), PLACE(out, LAG_FAMILY_VALUES + 2 + 3 * parts);
  PLACE(reach, 4 * (size_t)all->n), PLACE(near, (size_t)all->n);
#undef PLACE
  for (int k = 0; k < all->n; k++) {
    const lag_contact_family *f = &all->of[k];
    const size_t n = (size_t)members_of(f);
    if (!f->reach) continue;
    if (first) {
      lag_near_open(&w->near[k], (int)n, f->nplaces, f->place[0].by_turn, first + used,
                    (int *)(void *)(first + used + LAG_NEAR_NUMBERS(n)));
      for (int c = 0; c < f->nplaces; c++) w->near[k].first[c] = f->place[c].first;
    }
    used += LAG_NEAR_NUMBERS(n) + doubles_of(LAG_NEAR_INTS(n) * sizeof(int));
  }
  return used;
}

size_t lag_families_size(const lag_model *m) {
  lag_family_rows w;
  return m->families ? lay_out(m, &w, NULL) : 0;
}

int lag_family_rows_of(const lag_model *m) {
  lag_family_rows w = {0};
  if (m->families) sizes_of(m, &w);
  return w.most;
}

int lag_family_parts_of(const lag_model *m) {
  lag_family_rows w = {0};
  if (m->families) sizes_of(m, &w);
  return w.parts;
}

/* The model's own contacts, and the coordinates that its constraints hold. */
static void place_own(const lag_model *m, lag_family_rows *w) {
  const lag_constraints *of = m->constraints;
  for (int i = 0; i < w->own.contacts; i++) w->at[i] = m->contacts[i], w->bound[i] = 1;
  for (int e = 0; e < w->own.entries; e++) {
    int held = 1;
    for (int i = 0; i < m->ncontacts; i++)
      held &= m->contacts[i].conditional || m->contacts[i].constraint != of->jacobian[e].row;
    w->jacobian[e] = of->jacobian[e];
    w->tied[of->jacobian[e].col] |= (char)held;
  }
}

void lag_families_begin(lag_problem *pb, double *room) {
  lag_family_rows *w = (lag_family_rows *)(void *)room;
  if (pb->family == w) return;
  lay_out(pb->model, w, room);
  place_own(pb->model, w);
  pb->family = w;
}

/* --- values --- */

static int index_of(const lag_read *x, int row, int turn) { return x->first + x->by_row * row + x->by_turn * turn; }

/* w->out := values of a member. */
static int member_values(lag_problem *pb, const Member *of, double t, const double *q, const double *v) {
  const lag_contact_families *all = pb->model->families;
  const lag_contact_family *f = &all->of[of->family];
  lag_family_rows *w = pb->family;
  for (int k = 0; k < f->ncoords; k++) {
    const int at = index_of(&f->coords[k], of->row, of->turn);
    w->q[k] = q[at];
    w->v[k] = v[at];
  }
  for (int k = 0; k < f->nparams; k++) w->z[k] = pb->p[index_of(&f->params[k], of->row, of->turn)];
  return f->values(f, t, w->q, w->v, w->z, pb->p, pb->u, w->out, pb->work);
}

static const double *row_of(const lag_family_rows *w, const lag_contact_family *f, int j) {
  return w->out + LAG_FAMILY_VALUES + f->tangents + j * f->ncoords;
}

/* --- the members that take part --- */

/* Whether a member's gap is closed at the middle of the step, or may close until its end; < 0: a failure. */
static int takes_part(lag_problem *pb, const Member *of, double t, double h, const double *mid, const double *end) {
  const lag_contact_family *f = &pb->model->families->of[of->family];
  const lag_family_rows *w = pb->family;
  const double *const v = mid + pb->nq, *A = row_of(w, f, 0);
  if (member_values(pb, of, t, mid, v)) return -1;
  const double gap = w->out[0], r0 = w->out[1];
  double r1 = r0, pace = 0;
  for (int k = 0; k < f->ncoords; k++) {
    const int at = index_of(&f->coords[k], of->row, of->turn);
    r1 += A[k] * (end[at] - v[at]);
    pace += fabs(A[k] * (end[at] - v[at]));
    w->q[k] = mid[at] - h / 2 * v[at];
  }
  if (f->values(f, t - h / 2, w->q, w->v, w->z, pb->p, pb->u, w->out, pb->work)) return -1;
  pace += 2 * fabs(r0 - w->out[1]);
  return lag_contact_takes_part(gap, r0, r1, pace, h);
}

static int fails(lag_problem *pb, double t, const lag_contact_family *f, const char *what) {
  snprintf(pb->words, sizeof pb->words, "the contacts %s %s", f->name, what);
  pb->detail = pb->words;
  return lag_step_failed(pb, LAG_EMETHOD, t);
}

/* Appends the rows of a member. banded: M couples coordinates. */
static void append(lag_family_rows *w, const lag_contact_family *f, const Member *of, double key, int banded) {
  lag_contact *const at = w->at + w->own.contacts;
  lag_entry *const jacobian = w->jacobian + w->own.entries;
  int bound = banded;
  Member *to = &w->of[w->contacts++];
  *to = *of;
  to->at = w->rows;
  for (int k = 0; k < f->ncoords; k++) bound |= w->tied[index_of(&f->coords[k], of->row, of->turn)];
  for (int j = 0; j <= f->tangents; j++) {
    const int row = w->rows++, constraint = w->own.rows + row;
    at[row] = (lag_contact){.constraint = constraint, .is_tangent = j > 0};
    w->key[row] = key + j;
    w->bound[w->own.contacts + row] = bound != 0;
    for (int k = 0; k < f->ncoords; k++)
      jacobian[w->entries++] = (lag_entry){constraint, index_of(&f->coords[k], of->row, of->turn)};
  }
}

/* Impulses of the step before, of the same members; both lists ascend. */
static void guess(const lag_problem *pb, lag_family_rows *w) {
  const int own = w->own.contacts;
  const double *was = pb->contact_impulse + pb->model->ncontacts;
  memcpy(w->guess, pb->contact_impulse, (size_t)own * sizeof *w->guess);
  for (int row = 0, k = 0; row < w->rows; row++) {
    w->guess[own + row] = 0;
    while (k < w->most && pb->contact_key[k] > 0 && pb->contact_key[k] < w->key[row]) k++;
    if (k < w->most && pb->contact_key[k] >= w->key[row] && pb->contact_key[k] <= w->key[row])
      w->guess[own + row] = was[k];
  }
}

/* Whether the members of a row and a turn are nearer than what is looked at. */
static int is_near(const lag_near *near, const double *q, int row, int turn) {
  double x[3] = {0}, y[3] = {0};
  for (int c = 0; c < near->parts; c++) {
    x[c] = q[near->first[c] + near->step * row];
    y[c] = q[near->first[c] + near->step * turn];
    if (near->side[c] > 0) {
      x[c] -= near->side[c] * lag_floor(x[c] * near->inverse[c]);
      y[c] -= near->side[c] * lag_floor(y[c] * near->inverse[c]);
    }
  }
  return lag_near_square(near, x, y) < near->cut * near->cut;
}

typedef struct Search {
  double t, h;
  const double *mid, *end;
  double key; /* of the first member of the row, from 1 */
  int banded;
} Search;

static int look_at(lag_problem *pb, const Search *s, int family, int row, int turn) {
  const lag_contact_family *f = &pb->model->families->of[family];
  lag_family_rows *w = pb->family;
  const Member of = {family, row, turn, 0};
  const int does = takes_part(pb, &of, s->t, s->h, s->mid, s->end);
  if (does < 0) return fails(pb, s->t, f, "have no finite values");
  if (!does) return 0;
  if (w->rows + f->tangents >= w->most) return fails(pb, s->t, f, "are too many at once: do bodies overlap?");
  append(w, f, &of, s->key + 3.0 * turn, s->banded);
  return 0;
}

static int look_at_row(lag_problem *pb, const Search *s, int family, int row) {
  const lag_contact_family *f = &pb->model->families->of[family];
  const int from = f->skew * row, to = from + f->turns + f->more * row, place = f->i0 + row - f->j0;
  const lag_near *near = &pb->family->near[family];
  const int *list = NULL;
  int n = f->reach ? lag_near_of(&pb->family->near[family], place, &list) : 0, rc = 0;
  for (int k = 0; k < n && rc == 0; k++)
    if (list[k] >= from && list[k] < to && is_near(near, s->mid, place, list[k]))
      rc = look_at(pb, s, family, row, list[k]);
  for (int turn = from; !f->reach && turn < to && rc == 0; turn++) rc = look_at(pb, s, family, row, turn);
  return rc;
}

static int find_neighbours(lag_problem *pb, int k, const double *q) {
  const lag_contact_family *f = &pb->model->families->of[k];
  double *reach = pb->family->reach + 4 * k;
  if (!f->reach) return 0;
  const int rc = f->reach(f, 0, q, q, q, pb->p, pb->u, reach, pb->work);
  if (rc == 0) lag_near_find(&pb->family->near[k], q, BEYOND * reach[0], reach + 1);
  return rc;
}

int lag_families_find(lag_problem *pb, double t, double h, const double *mid, const double *end, int banded,
                      lag_family_step *to) {
  const lag_contact_families *all = pb->model->families;
  lag_family_rows *w = pb->family;
  Search s = {t, h, mid, end, 1, banded};
  w->rows = w->contacts = w->entries = 0;
  for (int k = 0; k < all->n; k++) {
    const lag_contact_family *f = &all->of[k];
    const double most = f->indices > 1 ? 3.0 * (f->skew > 0 ? (double)f->skew * f->rows : 0) +
                                             3.0 * (f->turns + (f->more > 0 ? (double)f->more * f->rows : 0) + 1)
                                       : 3;
    int rc = find_neighbours(pb, k, mid);
    if (rc) return lag_step_refused(pb, rc, t);
    for (int row = 0; row < f->rows && rc == 0; row++, s.key += most) rc = look_at_row(pb, &s, k, row);
    if (rc) return rc;
  }
  guess(pb, w);
  *to = (lag_family_step){w->contacts, w->rows, w->entries, w->at, w->jacobian, w->guess, w->bound};
  return 0;
}

/* --- the kernel's questions --- */

int lag_families_gaps(lag_problem *pb, double t, const double *q, const double *v, double *c, double *r) {
  const lag_family_rows *w = pb->family;
  for (int i = 0; i < w->contacts; i++) {
    const Member *of = &w->of[i];
    const int tangents = pb->model->families->of[of->family].tangents;
    if (member_values(pb, of, t, q, v)) return lag_step_refused(pb, LAG_ERETRY, t);
    c[of->at] = w->out[0];
    r[of->at] = w->out[1];
    for (int j = 0; j < tangents; j++) {
      c[of->at + 1 + j] = 0;
      r[of->at + 1 + j] = w->out[LAG_FAMILY_VALUES + j];
    }
  }
  return 0;
}

int lag_families_rows(lag_problem *pb, double t, const double *y, double *A) {
  const lag_contact_families *all = pb->model->families;
  const lag_family_rows *w = pb->family;
  int e = 0;
  for (int i = 0; i < w->contacts; i++) {
    const lag_contact_family *f = &all->of[w->of[i].family];
    if (member_values(pb, &w->of[i], t, y, y + pb->nq)) return lag_step_refused(pb, LAG_ERETRY, t);
    const int n = (1 + f->tangents) * f->ncoords;
    memcpy(A + e, row_of(w, f, 0), (size_t)n * sizeof *A);
    e += n;
  }
  return 0;
}

const char *lag_families_tied(const lag_problem *pb) { return pb->family->tied; }

/* Friction and tangential restitution of the rows, at the places of tangents; static friction at that of a gap. */
int lag_families_laws(lag_problem *pb, double t, const double *y, double *law) {
  const lag_family_rows *w = pb->family;
  for (int i = 0; i < w->contacts; i++) {
    if (member_values(pb, &w->of[i], t, y, y + pb->nq)) return lag_step_refused(pb, LAG_ERETRY, t);
    for (int j = 0; j <= pb->model->families->of[w->of[i].family].tangents; j++) {
      law[2 * (w->of[i].at + j)] = w->out[j ? 3 : 5];
      law[2 * (w->of[i].at + j) + 1] = w->out[4];
    }
  }
  return 0;
}

static const Member *member_of_row(const lag_family_rows *w, int row) {
  int i = 0;
  for (int end = w->contacts; end - i > 1;) {
    const int mid = (i + end) / 2;
    if (w->of[mid].at <= row) i = mid;
    else end = mid;
  }
  return &w->of[i];
}

/* v: rates of the gap after Newton's law, by a change along its own row. */
int lag_families_strike(lag_problem *pb, double t, const double *y, int i, double *v) {
  const lag_family_rows *w = pb->family;
  const Member *of = member_of_row(w, i);
  const lag_contact_family *f = &pb->model->families->of[of->family];
  const double *A = row_of(w, f, 0);
  double square = 0;
  if (member_values(pb, of, t, y, y + pb->nq)) return lag_step_refused(pb, LAG_ERETRY, t);
  for (int k = 0; k < f->ncoords; k++) square += A[k] * A[k];
  for (int k = 0; k < f->ncoords && square > 0; k++)
    v[index_of(&f->coords[k], of->row, of->turn)] -= (1 + w->out[2]) * w->out[1] / square * A[k];
  return 0;
}

static const char *member_text(const lag_contact_family *f, const Member *of, char *text, size_t room) {
  if (f->indices > 1) snprintf(text, room, "%s[%d, %d]", f->name, f->i0 + of->row, f->j0 + of->turn);
  else snprintf(text, room, "%s[%d]", f->name, f->i0 + of->row);
  return text;
}

const char *lag_families_member(const lag_problem *pb, int i, char *text, size_t room) {
  const Member *of = member_of_row(pb->family, i);
  return member_text(&pb->model->families->of[of->family], of, text, room);
}

void lag_families_note(lag_problem *pb) {
  const lag_family_rows *w = pb->family;
  for (int row = 0; row < w->most; row++) pb->contact_key[row] = row < w->rows ? w->key[row] : 0;
}

/* --- the start --- */

typedef struct Overlap {
  double depth;
  Member of;
} Overlap;

static int see_overlap(lag_problem *pb, double t, const double *y, const Member *of, Overlap *worst) {
  const lag_contact_family *f = &pb->model->families->of[of->family];
  const lag_family_rows *w = pb->family;
  const double rounding = 1e-9, *A = row_of(w, f, 0);
  double size = 0;
  if (member_values(pb, of, t, y, y + pb->nq)) return lag_step_refused(pb, LAG_ERETRY, t);
  for (int k = 0; k < f->ncoords; k++) size += fabs(A[k] * w->q[k]);
  if (-w->out[0] > rounding * size && -w->out[0] > worst->depth) *worst = (Overlap){-w->out[0], *of};
  return 0;
}

int lag_families_check_start(lag_problem *pb, double t, const double *y) {
  const lag_contact_families *all = pb->model->families;
  Overlap worst = {0};
  char name[120];
  int rc = 0;
  for (int k = 0; k < all->n && rc == 0; k++) {
    const lag_contact_family *f = &all->of[k];
    rc = find_neighbours(pb, k, y);
    if (rc) return lag_step_refused(pb, rc, t);
    for (int row = 0; row < f->rows && rc == 0; row++) {
      const int from = f->skew * row, to = from + f->turns + f->more * row, *list = NULL;
      const int n = f->reach ? lag_near_of(&pb->family->near[k], f->i0 + row - f->j0, &list) : to - from;
      for (int i = 0; i < n && rc == 0; i++)
        rc = see_overlap(pb, t, y, &(Member){k, row, list ? list[i] : from + i, 0}, &worst);
    }
  }
  if (rc || !(worst.depth > 0)) return rc;
  snprintf(pb->words, sizeof pb->words, "%s is closed by %.3g at the start: place bodies apart",
           member_text(&all->of[worst.of.family], &worst.of, name, sizeof name), worst.depth);
  pb->detail = pb->words;
  return lag_step_failed(pb, LAG_EMETHOD, t);
}
