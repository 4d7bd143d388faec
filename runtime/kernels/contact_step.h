/* contact_step.h: contacts in one step of Moreau's time-stepping. Enters: positions at the middle of a step,
 * velocities at its begin, and at its end without contacts; leaves: those with contacts. Holds: no contact does work on
 * the motion, measured by its impulse and the mean of its rates at both ends.
 *
 * A contact takes part where its gap is closed at the middle of the step, and where it may close until the end at a
 * rate that forces cause in a step, its pace: so that what lies stays where it is. Its rate afterwards, u, is
 * bounded by Newton's law u >= -e u0 where it was closing faster than its pace, by u >= 0 (or what is left of a gap)
 * where slower, and by u >= -u0 where it was opening; so P (u0 + u) <= 0. Where the gap is curved, its rate is 0 at
 * the end of the step, not at the middle, and curvature belongs to the pace: a bead in a hoop does not strike it.
 * Friction opposes the mean of the slip velocities at both ends: it drives the slip s into the ball whose diameter
 * goes from -s0 to 0, so F (s0 + s) <= 0, both slips being those at the positions of their ends. In an impact it
 * opposes the slip at the end, driven to 0, or with tangential restitution to -e_t s0, as in the papers below; at a
 * contact where this would add energy, as it may where the impulse turns the slip round (T.R. Kane, D.A. Levinson,
 * Dynamics (1985), 5.8), the mean of both, too, so P (u0 + u) + F (s0 + s) <= 0 always. J.J. Moreau, in: Nonsmooth
 * Mechanics and Applications (1988), 1, DOI 10.1007/978-3-7091-2624-0_1; D.E. Stewart, J.C. Trinkle, Int. J. Numer.
 * Methods Eng. 39 (1996) 2673, DOI 10.1002/(SICI)1097-0207(19960815)39:15<2673::AID-NME972>3.0.CO;2-I.
 *
 * An instance defines before it includes this text lag_contact and lag_entry (lag_model.h), and:
 *   LAG_MODEL, LAG_THE_MODEL             the first parameters of functions: the model; the same as arguments
 *   LAG_IS_GAP(c)                   whether the contact c is a gap; else a tangent, or no contact of this step
 *   LAG_CLOSE(t, only, u)           a status; inputs u at t with contact `only` closed, or all of them (-1)
 *   LAG_GAPS(t, q, v, z, u, c, r)   a status; gaps and rates of all constraints
 *   LAG_GAP_MATRICES(t, y, u, A, M) a status; entries of the Jacobian and of the mass matrix
 *   LAG_UNIT_CHANGE(w, row, t, y, u, g, d, effort)  a status; d: least change with A d = g, in which row `row` of
 *                                   w->all.A has 1, effort = M d, and behind it components of forces of guides, `loads`
 *                                   of them
 *   LAG_STRIKE(t, y, u, i, v)       a status; velocities after the impact of contact i alone
 *   LAG_FRICTIONS(t, y, u, law)     a status; friction and tangential restitution, two for each contact; static
 *                                   friction beside its gap
 *   LAG_CONTACT_FAILS(t, i, words)  the status of a failure of contact i
 *   LAG_SINGULAR(t)                 that of a singular mass matrix */
#ifndef LAG_CONTACT_STEP_H
#define LAG_CONTACT_STEP_H

#include "kernels/band_matrix.h"
#include "kernels/impulses.h"

/* ---- contacts ---- */

/* Contacts in a step. Those that take part: all.of[all.n], in rows 0 to rows - 1. */
typedef struct lag_moreau_contacts {
  int contacts, constraints, nq, entries, nmass, band; /* sizes; entries: of the Jacobian; band: half bandwidth of M */
  int loads;                                           /* components of forces of guides */
  int others;                                          /* other constraints hold beside contacts */
  const char *bound; /* [contacts] where others hold: whether they bear on its bodies; NULL: on all */
  const lag_contact *at;                               /* [contacts] */
  const lag_entry *jacobian_at, *mass_at;              /* rows and columns of entries */
  LAG_REAL epsilon, loose;                             /* rounding of LAG_REAL; part of the fastest rate, or 0 */
  LAG_REAL rough;                                      /* roundings to which impulses of this step agree, where many */
  const LAG_REAL *guess;                               /* [contacts] impulses of the step before */
  LAG_REAL *u;                                         /* inputs */
  lag_impulses all;
  int rows, impacts, sweeps;
  LAG_REAL *response, *b, *before; /* [rows]; before: rates at the begin of the step */
  LAG_REAL *law;                   /* [2 contacts] friction, tangential restitution; of a gap its static friction */
  /* [constraints] gaps, rates at the begin, rates without contacts, their changes by forces and curvature in a step, by
   * curvature in its first half, and in its second, a unit */
  LAG_REAL *c, *r0, *r1, *pace, *bend, *tail, *g;
  LAG_REAL *d, *effort, *x;        /* [nq], [nq + loads], [nq] */
  LAG_REAL *loading, *load;        /* [rows loads] of a unit impulse; [loads] by contacts: the instance's */
  LAG_REAL *smooth, *pressed;      /* with loads: [rows (nq + 1)] responses without these guides; [rows] impulses */
  LAG_REAL *jacobian, *mass, *lu, *pivot, *scale;
  LAG_REAL *first, *entry;         /* entry[first[k]] to entry[first[k + 1]]: entries of constraint k */
} lag_moreau_contacts;

enum { LAG_PRESSING_SIZE = (int)(sizeof(lag_pressing)/sizeof(LAG_REAL)) };
/* Scalars that a step with these sizes needs; entries of D: `responses`; of the factored mass matrix: `lu`. */
#define LAG_CONTACT_ROOM(contacts, constraints, nq, entries, nmass, responses, lu, loads) \
  ((contacts)*(LAG_PRESSING_SIZE + 10 + (loads) + ((loads) > 0 ? (nq) + 2 : 0)) + 4 + 8*(constraints) + 5*(nq) + \
   (loads) + 4*(entries) + 2*(responses) + (nmass) + (lu))

/* Places arrays into room[LAG_CONTACT_ROOM]; sizes are set. */
static inline void lag_contacts_place(lag_moreau_contacts *w, int responses, LAG_REAL *room) {
  const int p = w->contacts, nc = w->constraints, nq = w->nq, e = w->entries;
  w->all.n = w->rows = w->impacts = w->sweeps = 0, w->rough = LAG_C(0.0);
  w->all.of = (lag_pressing *)(void *)room, room += p*LAG_PRESSING_SIZE;
  w->response = room, w->b = room += p, w->before = room += p, w->all.P = room += p, w->law = room += p;
  w->all.was = room += 2*p, w->all.went = room += p;
  w->all.A.first = room += p, w->all.D.first = room += p + 1;
  w->c = room += p + 1, w->r0 = room += nc, w->r1 = room += nc, w->pace = room += nc, w->bend = room += nc;
  w->tail = room += nc, w->g = room += nc, w->d = room += nc, w->effort = room += nq, w->x = room += nq + w->loads;
  w->loading = room += nq, w->smooth = room += p*w->loads, w->pressed = room += w->loads > 0 ? p*(nq + 1) : 0;
  w->pivot = room += w->loads > 0 ? p : 0, w->scale = room += nq;
  w->jacobian = room += nq, w->all.A.col = room += e, w->all.A.value = room += e;
  w->all.D.col = room += e, w->all.D.value = room += responses, w->mass = room += responses, w->lu = room += w->nmass;
  w->first = room += lag_band_matrix_size(nq, w->band), w->entry = room + nc + 2;
  w->all.response = w->response, w->all.b = w->b;
  w->loose = LAG_C(0.0);
  w->bound = 0;
}

/* Sorts entries of the Jacobian by constraints. */
static inline void lag_contact_entries(lag_moreau_contacts *w) {
  LAG_REAL *const first = w->first;
  for (int k = 0; k < w->constraints + 2; k++) first[k] = LAG_C(0.0);
  for (int e = 0; e < w->entries; e++) first[w->jacobian_at[e].row + 2] += LAG_C(1.0);
  for (int k = 2; k < w->constraints + 2; k++) first[k] += first[k - 1];
  for (int e = 0; e < w->entries; e++) {
    LAG_REAL *const end = first + w->jacobian_at[e].row + 1;
    w->entry[(int)*end] = (LAG_REAL)e;
    *end += LAG_C(1.0);
  }
}

/* --- responses --- */

static inline lag_band_matrix lag_contact_inertia(const lag_moreau_contacts *w) {
  const lag_band_matrix M = {w->nq, w->band, w->lu, w->pivot};
  return M;
}

/* Whether others hold bodies of contact i. */
static inline int lag_contact_is_bound(const lag_moreau_contacts *w, int i) {
  return w->others && (!w->bound || w->bound[i]);
}

/* Factors M, for contacts without other constraints. Not 0: it is singular. */
static inline int lag_contacts_factor(lag_moreau_contacts *w) {
  lag_band_matrix M = lag_contact_inertia(w);
  for (int i = 0; i < lag_band_matrix_size(w->nq, w->band); i++) w->lu[i] = LAG_C(0.0);
  for (int e = 0; e < w->nmass; e++) {
    *lag_band_matrix_at(&M, w->mass_at[e].row, w->mass_at[e].col) = w->mass[e];
    *lag_band_matrix_at(&M, w->mass_at[e].col, w->mass_at[e].row) = w->mass[e];
  }
  return lag_band_matrix_factor(&M, w->scale);
}

/* d := change of velocities by a unit impulse of contact i, whose row of A is `row`, under the other constraints. */
static inline int lag_contact_respond(LAG_MODEL, lag_moreau_contacts *w, LAG_REAL t, const LAG_REAL *y, int i,
                                      int row) {
  const lag_sparse_rows *const A = &w->all.A;
  LAG_REAL work = LAG_C(0.0);
  int status = 0;
  if (!lag_contact_is_bound(w, i)) {
    lag_band_matrix M = lag_contact_inertia(w);
    for (int j = 0; j < w->nq; j++) w->d[j] = LAG_C(0.0);
    for (int e = (int)A->first[row]; e < (int)A->first[row + 1]; e++) w->d[(int)A->col[e]] = A->value[e];
    lag_band_matrix_solve(&M, w->d);
    for (int j = 0; j < w->loads; j++) w->loading[row*w->loads + j] = LAG_C(0.0);
    return status;
  }
  for (int k = 0; k < w->constraints; k++) w->g[k] = k == w->at[i].constraint ? LAG_C(1.0) : LAG_C(0.0);
  LAG_TRY(LAG_CLOSE(t, i, w->u));
  LAG_TRY(LAG_UNIT_CHANGE(w, row, t, y, w->u, w->g, w->d, w->effort));
  for (int j = 0; j < w->nq; j++) work += w->d[j]*w->effort[j];
  const int moves = work > LAG_C(0.0) && LAG_FN(fabs)(lag_row_product(A, row, w->d) - LAG_C(1.0)) < LAG_C(0.5);
  for (int j = 0; j < w->nq; j++) w->d[j] = moves ? w->d[j]/work : LAG_C(0.0);
  for (int j = 0; j < w->loads; j++)
    w->loading[row*w->loads + j] = moves ? w->effort[w->nq + j]/work : LAG_C(0.0);
  return status;
}

/* Appends the row of contact i to A and D. */
static inline int lag_contact_row(LAG_MODEL, lag_moreau_contacts *w, LAG_REAL t, const LAG_REAL *y, int i) {
  const int r = w->rows++, k = w->at[i].constraint;
  lag_sparse_rows *const A = &w->all.A, *const D = &w->all.D;
  int e = (int)A->first[r], f = (int)D->first[r], status = 0;
  for (int j = (int)w->first[k]; j < (int)w->first[k + 1]; j++) {
    A->col[e] = (LAG_REAL)w->jacobian_at[(int)w->entry[j]].col;
    A->value[e++] = w->jacobian[(int)w->entry[j]];
  }
  A->first[r + 1] = (LAG_REAL)e;
  const int alone = !lag_contact_is_bound(w, i) && w->band == 0 && w->loads == 0; /* M is diagonal */
  w->response[r] = LAG_C(0.0);
  for (int j = (int)A->first[r]; j < e && alone; j++) {
    D->col[f] = A->col[j];
    D->value[f] = A->value[j]/w->lu[(int)A->col[j]];
    w->response[r] += A->value[j]*D->value[f++];
  }
  if (!alone) LAG_TRY(lag_contact_respond(LAG_THE_MODEL, w, t, y, i, r));
  for (int j = 0; j < w->nq && !alone; j++) {
    if (!(w->d[j] < LAG_C(0.0) || w->d[j] > LAG_C(0.0)) && w->loads == 0) continue;
    D->col[f] = (LAG_REAL)j;
    D->value[f++] = w->d[j];
  }
  D->first[r + 1] = (LAG_REAL)f;
  if (!alone) w->response[r] = lag_row_product(A, r, w->d);
  w->before[r] = w->r0[k];
  w->b[r] = w->r0[k] - lag_row_product(A, r, y + w->nq);
  w->all.P[r] = w->guess[i];
  return status;
}

/* --- laws --- */

/* *e := restitution of contact i, from its law of impact. */
static inline int lag_contact_bounce(LAG_MODEL, lag_moreau_contacts *w, LAG_REAL t, const LAG_REAL *y, int i,
                                     LAG_REAL *e) {
  const int k = w->at[i].constraint, nq = w->nq;
  LAG_REAL change = LAG_C(0.0);
  int status = 0;
  LAG_TRY(LAG_CLOSE(t, i, w->u));
  for (int j = 0; j < nq; j++) w->x[j] = y[nq + j];
  LAG_TRY(LAG_STRIKE(t, y, w->u, i, w->x));
  for (int j = (int)w->first[k]; j < (int)w->first[k + 1]; j++) {
    const int at = (int)w->entry[j], col = w->jacobian_at[at].col;
    change += w->jacobian[at]*(w->x[col] - y[nq + col]);
  }
  *e = change/-w->r0[k] - LAG_C(1.0);
  return lag_is_number(*e) ? status : LAG_CONTACT_FAILS(t, i, "has no finite restitution");
}

/* Static friction of c: at its full size where the contact rests at the begin, or friction has held it in the step
 * before, in which its slip may have turned; then it takes what is left of that, too. */
static inline void lag_contact_static(const lag_moreau_contacts *w, lag_pressing *c) {
  const LAG_REAL zero = LAG_C(0.0), two = LAG_C(2.0), hold = w->law[2*(int)c->contact], P = w->guess[(int)c->contact];
  const int i = (int)c->contact + 1, r = (int)c->row + 1;
  LAG_REAL slip = zero, pace = zero, rub = zero, slow = zero;
  c->slack = -LAG_C(1.0);
  c->hold = c->strikes > zero ? c->mu : lag_larger(hold, c->mu);
  for (int j = 0; j < (int)c->tangents; j++) {
    slip = lag_length_of(slip, c->slip[j] - c->turn[j]);
    pace += w->pace[w->at[i + j].constraint];
    slow += w->response[r + j];
    rub = lag_length_of(rub, w->guess[i + j]);
  }
  if (!(c->hold > c->mu) || !(slow > zero)) return;
  const int held = P > zero && lag_contact_holds(c, P, rub, w->epsilon);
  if (slip <= LAG_C(1e-9)*(pace + slow*hold*P) || (held && slip <= two*pace)) c->slack = slip/slow;
}

/* Columns that all rows of A and D have from row on, a contact's; 0: they differ, or D is to change. */
static inline int lag_contact_columns(const lag_moreau_contacts *w, int row) {
  const lag_sparse_rows *const A = &w->all.A, *const D = &w->all.D;
  const int a = (int)A->first[row], d = (int)D->first[row], n = (int)A->first[row + 1] - a;
  int same = w->loads == 0 && n > 0;
  for (int r = row; r < w->rows; r++)
    same = same && (int)A->first[r + 1] - (int)A->first[r] == n && (int)D->first[r + 1] - (int)D->first[r] == n;
  for (int e = 0; same && e < (w->rows - row)*n; e++)
    same = (int)A->col[a + e] == (int)A->col[a + e % n] && (int)D->col[d + e] == (int)A->col[a + e % n];
  return same ? n : 0;
}

/* Appends contact i with its rows and its law. */
static inline int lag_contact_add(LAG_MODEL, lag_moreau_contacts *w, LAG_REAL t, LAG_REAL h, const LAG_REAL *y, int i) {
  const LAG_REAL zero = LAG_C(0.0);
  const int k = w->at[i].constraint, row = w->rows;
  lag_pressing *const c = &w->all.of[w->all.n++];
  int tangents = 0, status = 0;
  LAG_REAL e = zero;
  while (i + tangents + 1 < w->contacts && w->at[i + tangents + 1].is_tangent) tangents++;
  c->contact = (LAG_REAL)i;
  c->row = (LAG_REAL)row;
  c->tangents = (LAG_REAL)tangents;
  for (int j = 0; j <= tangents; j++) LAG_TRY(lag_contact_row(LAG_THE_MODEL, w, t, y, i + j));
  c->shared = (LAG_REAL)lag_contact_columns(w, row);
  const int moves = w->response[row] > zero, strikes = lag_contact_strikes(w->r0[k], w->pace[k]) && moves;
  if (strikes) LAG_TRY(lag_contact_bounce(LAG_THE_MODEL, w, t, y, i, &e));
  w->impacts += strikes;
  c->mu = tangents > 0 ? w->law[2*(i + 1)] : zero;
  c->strikes = strikes ? LAG_C(1.0) : zero;
  c->rate = w->r0[k];
  for (int j = 0; j < tangents; j++) {
    c->slip[j] = w->before[row + 1 + j];
    c->turn[j] = w->bend[w->at[i + 1 + j].constraint];
    c->tail[j] = w->tail[w->at[i + 1 + j].constraint];
  }
  lag_contact_static(w, c);
  lag_contact_law(c, w->c[k], w->bend[k], h, e, strikes && tangents > 0 ? w->law[2*(i + 1) + 1] : zero);
  return moves || w->r1[k] >= zero ? 0 : LAG_CONTACT_FAILS(t, i, "closes, and nothing can keep it from closing");
}

/* Gaps, rates at both ends without contacts, their changes by forces and curvature, and matrices. */
static inline int lag_contacts_evaluate(LAG_MODEL, lag_moreau_contacts *w, LAG_REAL t, LAG_REAL h, const LAG_REAL *y,
                                        const LAG_REAL *end) {
  const LAG_REAL half = h/LAG_C(2.0), *const v = y + w->nq, *const z = v + w->nq;
  int status = 0;
  (void)z;
  LAG_TRY(LAG_CLOSE(t - half, -1, w->u));
  for (int i = 0; i < w->nq; i++) w->x[i] = y[i] - half*v[i];
  LAG_TRY(LAG_GAPS(t - half, w->x, v, z, w->u, w->c, w->bend));
  LAG_TRY(LAG_CLOSE(t + half, -1, w->u));
  for (int i = 0; i < w->nq; i++) w->x[i] = y[i] + half*end[i];
  LAG_TRY(LAG_GAPS(t + half, w->x, end, z, w->u, w->c, w->tail));
  LAG_TRY(LAG_CLOSE(t, -1, w->u));
  LAG_TRY(LAG_GAPS(t, y, end, z, w->u, w->c, w->r1));
  LAG_TRY(LAG_GAPS(t, y, v, z, w->u, w->c, w->r0));
  LAG_TRY(LAG_GAP_MATRICES(t, y, w->u, w->jacobian, w->mass));
  LAG_TRY(LAG_FRICTIONS(t, y, w->u, w->law));
  for (int k = 0; k < w->constraints; k++) {
    w->bend[k] = w->r0[k] - w->bend[k];
    w->tail[k] -= w->r1[k];
    w->pace[k] = LAG_C(2.0)*LAG_FN(fabs)(w->bend[k]);
  }
  for (int e = 0; e < w->entries; e++) {
    const int j = w->jacobian_at[e].col;
    w->pace[w->jacobian_at[e].row] += LAG_FN(fabs)(w->jacobian[e]*(end[j] - v[j]));
  }
  for (int i = 0; i < w->contacts; i++) {
    const int k = w->at[i].constraint;
    if (!lag_is_number(w->r0[k]) || !lag_is_number(w->r1[k]) || (LAG_IS_GAP(w->at[i]) && !lag_is_number(w->c[k])))
      return LAG_CONTACT_FAILS(t, i, "has no finite values");
  }
  return status;
}

/* Chooses the contacts that take part in the step h with its middle at t: y = [middle q|v at the begin|z], end[nq]:
 * velocities at the end without contacts. */
static inline int lag_contacts_find(LAG_MODEL, lag_moreau_contacts *w, LAG_REAL t, LAG_REAL h, const LAG_REAL *y,
                                    const LAG_REAL *end) {
  int status = 0;
  w->all.n = w->rows = w->impacts = w->sweeps = 0, w->rough = LAG_C(0.0);
  w->all.A.first[0] = w->all.D.first[0] = LAG_C(0.0);
  lag_contact_entries(w);
  LAG_TRY(lag_contacts_evaluate(LAG_THE_MODEL, w, t, h, y, end));
  for (int i = 0; i < w->contacts; i++) {
    const int k = w->at[i].constraint;
    if (!LAG_IS_GAP(w->at[i]) || !lag_contact_takes_part(w->c[k], w->r0[k], w->r1[k], w->pace[k], h)) continue;
    if (w->all.n == 0 && (!w->others || w->bound) && lag_contacts_factor(w)) return LAG_SINGULAR(t);
    LAG_TRY(lag_contact_add(LAG_THE_MODEL, w, t, h, y, i));
  }
  return status;
}

/* v[j] := 0 where contacts, by all that they could do, leave far less of it than its rounding: rests would go on as
 * subnormal numbers. */
static inline void lag_contacts_rest(const lag_moreau_contacts *w, LAG_REAL *v) {
  const lag_sparse_rows *const D = &w->all.D;
  const LAG_REAL zero = LAG_C(0.0), one = LAG_C(1.0), little = w->epsilon*w->epsilon;
  for (int j = 0; j < w->nq; j++) w->x[j] = zero;
  for (int i = 0; i < w->all.n; i++) {
    const lag_pressing *const c = &w->all.of[i];
    const int row = (int)c->row, end = row + 1 + (int)c->tangents;
    for (int e = (int)D->first[row]; e < (int)D->first[end]; e++)
      w->x[(int)D->col[e]] += LAG_FN(fabs)(w->all.P[row]*D->value[e])*(e < (int)D->first[row + 1] ? one : c->hold);
  }
  for (int j = 0; j < w->nq; j++) v[j] = LAG_SELECT(LAG_FN(fabs)(v[j]) > little*w->x[j], v[j], zero);
}

/* load := forces of guides by contacts in a step h. In impacts guides are smooth. */
static inline void lag_contacts_load(const lag_moreau_contacts *w, LAG_REAL h) {
  for (int k = 0; k < w->loads; k++) w->load[k] = LAG_C(0.0);
  for (int i = 0; i < w->all.n; i++) {
    const lag_pressing *const c = &w->all.of[i];
    const int row = (int)c->row, end = row + 1 + (int)c->tangents;
    for (int r = row; r < end && !(c->strikes > LAG_C(0.0)); r++)
      for (int k = 0; k < w->loads; k++) w->load[k] += w->all.P[r]/h*w->loading[r*w->loads + k];
  }
}

/* v[nq], velocities without contacts, := those with them. Not 0: no impulses agree. */
static inline int lag_contacts_solve(lag_moreau_contacts *w, LAG_REAL *v) {
  enum { MOST = 200000 };
  const lag_sparse_rows *const A = &w->all.A;
  LAG_REAL size = LAG_C(0.0);
  if (w->all.n == 0) return 0;
  for (int e = 0; e < (int)A->first[w->rows]; e++)
    size = lag_larger(size, LAG_FN(fabs)(A->value[e]*v[(int)A->col[e]]));
  w->all.v = v;
  w->all.v_was = w->d, w->all.nv = w->nq;
  w->all.loose = w->loose*size;
  const LAG_REAL enough = LAG_C(64.0)*w->epsilon*size;
  const int sweeps = lag_contact_impulses(&w->all, enough, MOST);
  w->sweeps += sweeps;
  if (sweeps >= 1000) w->rough = lag_larger(w->rough, LAG_C(1024.0)*lag_contact_swing(w->all.n, sweeps));
  lag_contacts_rest(w, v);
  return sweeps > MOST;
}

/* Part of velocities to which impulses agree. */
static inline LAG_REAL lag_contacts_enough(const lag_moreau_contacts *w, LAG_REAL epsilon) {
  return lag_larger(w->loose/epsilon, lag_larger(w->rough, LAG_C(1e4)));
}

/* ---- end ---- */
#endif
