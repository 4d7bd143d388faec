/* coupled_friction.h: contacts beside dry friction of joints in one step of Moreau's time-stepping. Enters: velocities
 * and states at the end of the step without either; leaves: those with both. Holds: impulses and friction agree; each
 * is solved in turn, until friction changes nothing more.
 *
 * An instance defines, besides what contact_step.h and joint_friction.h ask for:
 *   LAG_FIND_CONTACTS(s, w)  a status; contacts that take part
 *   LAG_MEET(s, w)           a status; s->y1 with impulses of contacts
 *   LAG_COUPLING_FAILS(t)    the status where both find no agreement */
#ifndef LAG_COUPLED_FRICTION_H
#define LAG_COUPLED_FRICTION_H

#include "kernels/contact_step.h"
#include "kernels/joint_friction.h"

/* ---- coupled ---- */

typedef struct lag_coupled_friction {
  lag_moreau_contacts contacts;
  lag_joint_friction *joints;
  LAG_REAL *end;                   /* [states] the end of the step without contacts */
  LAG_REAL *was, *change, *stride; /* [n] modes before a round; change by the last, and strides in parts of it */
  LAG_REAL *base, *other;          /* [states] rates */
  LAG_REAL *held;                  /* [n] surfaces that friction held when the turn began */
  int loaded;                      /* contacts have loaded guides in this step */
} lag_coupled_friction;

/* Contacts meet in a model that has some; dry friction alone needs no `end`. */
static inline void lag_coupled_place(lag_coupled_friction *w, LAG_REAL *room) {
  const int n = w->joints->n;
  w->loaded = 0;
  w->was = room, w->change = room += n, w->stride = room += n, w->held = room += n, w->base = room + n;
  w->other = w->base + w->joints->states;
  for (int j = 0; j < n; j++) w->change[j] = w->stride[j] = w->held[j] = LAG_C(0.0);
}

/* A round of lag_joints_solve. *moved: the largest change of a slip, in units of the largest slip. */
static inline int lag_coupled_round(LAG_MODEL, lag_coupled_friction *w, const lag_kick *s, int struck,
                                    LAG_REAL *moved) {
  lag_joint_friction *const f = w->joints;
  LAG_REAL size[1];
  int status = 0;
  for (int j = 0; j < f->n; j++) w->was[j] = f->mode[j];
  LAG_TRY(lag_joints_solve(LAG_THE_MODEL, f, s, struck, size));
  *moved = LAG_C(0.0);
  for (int j = 0; j < f->n; j++)
    *moved = lag_larger(LAG_FN(fabs)((f->mode[j] - w->was[j])*f->response[j]), *moved);
  *moved = size[0] > LAG_C(0.0) ? *moved/size[0] : LAG_C(0.0);
  return status;
}

/* Static friction of surface j, which would slip, may hold and let go by turns as contacts follow: in later rounds it
 * has broken loose. */
static inline void lag_coupled_let_go(lag_joint_friction *f, int j, int round) {
  if (round >= 50) f->bound[j] = f->grip[j] = LAG_C(1.0);
}

/* Mode to go on from on surface j: by longer strides where it changes in the same direction round by round, as where
 * contacts leave a slip that is small beside what friction changes: then friction comes to its limit by small equal
 * steps. */
static inline LAG_REAL lag_coupled_stride(lag_coupled_friction *w, int j, int round) {
  const LAG_REAL one = LAG_C(1.0), mode = w->joints->mode[j], change = mode - w->was[j], last = w->change[j];
  const int goes_on = change*last > LAG_C(0.0) && LAG_FN(fabs)(change) >= LAG_FN(fabs)(last)/LAG_C(2.0);
  const LAG_REAL stride = goes_on ? lag_smaller(LAG_C(2.0)*w->stride[j] + one, LAG_C(1e6)) : LAG_C(0.0);
  const LAG_REAL to = mode + stride*change;
  w->change[j] = change;
  w->stride[j] = stride;
  if (!goes_on || LAG_FN(fabs)(to) <= w->joints->bound[j]) return to;
  lag_coupled_let_go(w->joints, j, round);
  return LAG_SELECT(to < LAG_C(0.0), -one, one);
}

/* x[states] += part times what the last calls of round and lengthen changed. */
static inline void lag_coupled_carry(const lag_coupled_friction *w, LAG_REAL part, LAG_REAL *x) {
  const lag_joint_friction *const f = w->joints;
  for (int j = 0; j < f->n; j++)
    for (int i = f->nq; i < f->states; i++) x[i] += part*(f->mode[j] - w->was[j])*f->d[j*f->states + i];
}

/* Response of row r to an impulse that presses guides, too: smooth, or with their friction. */
static inline void lag_coupled_response(lag_moreau_contacts *c, int r, const LAG_REAL *friction) {
  LAG_REAL *const smooth = c->smooth + r*(c->nq + 1), *const D = c->all.D.value + r*c->nq;
  for (int j = 0; j < c->nq; j++) D[j] = friction ? smooth[j] + friction[j] : smooth[j];
  c->response[r] = friction ? lag_row_product(&c->all.A, r, D) : smooth[c->nq];
}

/* Responses without friction of guides, whose forces stay those by the impulses `pressed`. */
static inline void lag_coupled_straighten(lag_coupled_friction *w) {
  lag_moreau_contacts *const c = &w->contacts;
  const int nq = c->nq;
  for (int r = 0; r < c->rows; r++) {
    for (int j = 0; j < nq; j++)
      w->end[nq + j] += c->pressed[r]*(c->all.D.value[r*nq + j] - c->smooth[r*(nq + 1) + j]);
    lag_coupled_response(c, r, 0);
  }
}

/* Where a surface has begun to slip or to stick, by which responses change, this turn goes on without them. */
static inline void lag_coupled_turns(lag_coupled_friction *w, int round) {
  lag_joint_friction *const f = w->joints;
  int turns = 0;
  for (int j = 0; j < f->n; j++) {
    turns += w->held[j] < f->sticks[j] || w->held[j] > f->sticks[j];
    lag_coupled_let_go(f, j, w->held[j] > f->sticks[j] ? round : 0);
    w->held[j] = f->sticks[j];
  }
  if (turns && w->loaded) lag_coupled_straighten(w);
}

/* s->y1 := w->end with both. */
static inline int lag_coupled_agree(LAG_MODEL, lag_coupled_friction *w, const lag_kick *s) {
  /* of the largest slip, or of what friction changes: friction that follows it to its limit by many small steps */
  const LAG_REAL little = LAG_C(1e-5);
  LAG_REAL moved[1] = {LAG_C(0.0)}, before = LAG_C(0.0);
  int status = 0;
  for (int round = 0; round < 500; round++) {
    for (int i = s->nq; i < w->joints->states; i++) s->y1[i] = w->end[i];
    LAG_TRY(LAG_MEET(s, w));
    LAG_TRY(lag_coupled_round(LAG_THE_MODEL, w, s, w->contacts.impacts > 0, moved));
    if (moved[0] <= LAG_C(64.0)*s->epsilon) return status;
    lag_coupled_turns(w, round);
    if (round > 0 && moved[0] <= LAG_C(1e7)*s->epsilon && moved[0] >= before/LAG_C(2.0)) return status;
    for (int j = 0; j < w->joints->n; j++) LAG_HOLD(w->joints, j, lag_coupled_stride(w, j, round));
    lag_coupled_carry(w, s->h, w->end);
    lag_coupled_carry(w, LAG_C(1.0), s->rate0);
    before = moved[0];
  }
  return moved[0] <= little ? status : LAG_COUPLING_FAILS(s->t);
}

/* Responses at the first middle, where friction acts once before contacts are chosen, and in later turns. */
static inline int lag_coupled_respond(LAG_MODEL, lag_coupled_friction *w, const lag_kick *s, int turn) {
  LAG_REAL moved[1];
  int status = 0;
  if (w->joints->n > 0) LAG_TRY(lag_joints_respond_again(LAG_THE_MODEL, w->joints, s, turn));
  if (w->contacts.contacts == 0 || turn > 0) return status;
  if (w->joints->n > 0) {
    LAG_TRY(lag_coupled_round(LAG_THE_MODEL, w, s, 0, moved));
    lag_coupled_carry(w, LAG_C(1.0), s->rate0);
  }
  return LAG_FIND_CONTACTS(s, w);
}

/* Friction of guides from here on follows what contacts press on them, too; so does that at the begin of the step. */
static inline int lag_coupled_load(LAG_MODEL, lag_coupled_friction *w, const lag_kick *s) {
  lag_moreau_contacts *const c = &w->contacts;
  const int nq = s->nq;
  int status = 0;
  if (c->loads == 0) return status;
  lag_contacts_load(c, s->h);
  if (w->loaded) lag_coupled_straighten(w);
  if (w->loaded) return status;
  for (int r = 0; r < c->rows; r++) {
    for (int j = 0; j < nq; j++) c->smooth[r*(nq + 1) + j] = c->all.D.value[r*nq + j];
    c->smooth[r*(nq + 1) + nq] = c->response[r];
  }
  w->loaded = 1;
  return LAG_MODE_RATES(s->t, s->mid, w->joints, s->rate0);
}

/* Forces of guides that slip by the impulse P of row r; those that stick keep theirs. */
static inline void lag_coupled_press(lag_coupled_friction *w, int r, LAG_REAL P, LAG_REAL h) {
  lag_moreau_contacts *const c = &w->contacts;
  const int switches = w->joints->n - c->loads/3;
  for (int k = 0; k < c->loads; k++)
    if (!(w->held[switches + k/3] > LAG_C(0.0))) c->load[k] += P/h*c->loading[r*c->loads + k];
}

/* Responses of this turn: by differences about the impulses so far, whose friction is in w->end. */
static inline int lag_coupled_lean(LAG_MODEL, lag_coupled_friction *w, const lag_kick *s) {
  lag_moreau_contacts *const c = &w->contacts;
  const int nq = s->nq;
  LAG_REAL unit = LAG_C(0.0);
  int status = 0;
  LAG_TRY(lag_joints_respond(LAG_THE_MODEL, w->joints, s));
  for (int j = 0; j < w->joints->n; j++) w->held[j] = w->joints->sticks[j];
  for (int r = 0; r < c->rows; r++) c->pressed[r] = c->all.P[r];
  for (int r = 0; r < c->rows; r++) unit = lag_larger(LAG_C(1e-6)*LAG_FN(fabs)(c->all.P[r]), unit);
  if (!(unit > LAG_C(0.0))) return status;
  LAG_TRY(LAG_MODE_RATES(s->t, s->mid, w->joints, w->base));
  for (int i = 0; i < c->all.n; i++) {
    const lag_pressing *const of = &c->all.of[i];
    const int row = (int)of->row, end = row + 1 + (int)of->tangents;
    for (int r = row; r < end && !(of->strikes > LAG_C(0.0)); r++) {
      lag_coupled_press(w, r, unit, s->h);
      LAG_TRY(LAG_MODE_RATES(s->t, s->mid, w->joints, w->other));
      for (int j = 0; j < nq; j++) w->other[j] = s->h*(w->other[nq + j] - w->base[nq + j])/unit;
      lag_coupled_response(c, r, w->other);
      if (!(c->response[r] > LAG_C(0.0))) lag_coupled_response(c, r, 0); /* it jams, or has no motion */
      else
        for (int j = 0; j < nq; j++) w->end[nq + j] -= c->pressed[r]*w->other[j];
      lag_contacts_load(c, s->h);
    }
  }
  return status;
}

/* s->y1 := velocities and states with contacts and friction, of a model with either. */
static inline int lag_coupled_obey(LAG_MODEL, lag_coupled_friction *w, const lag_kick *s) {
  LAG_REAL size[1];
  int status = 0;
  if (w->contacts.contacts == 0)
    return w->joints->n > 0 ? lag_joints_solve(LAG_THE_MODEL, w->joints, s, 0, size) : 0;
  if (w->joints->n == 0) return LAG_MEET(s, w);
  for (int i = s->nq; i < w->joints->states; i++) w->end[i] = s->y1[i];
  if (w->loaded) LAG_TRY(lag_coupled_lean(LAG_THE_MODEL, w, s));
  LAG_TRY(lag_coupled_agree(LAG_THE_MODEL, w, s));
  return lag_coupled_load(LAG_THE_MODEL, w, s);
}

/* Once all agree: surfaces whose slip is 0 at the end; friction may be at its limit where contacts hold the body. */
static inline int lag_coupled_note(LAG_MODEL, lag_joint_friction *f, const lag_kick *s) {
  int status = 0;
  LAG_TRY(LAG_SLIPS(s->end, s->mid, s->y1, f, f->slip));
  for (int j = 0; j < f->n; j++)
    f->sticks[j] = LAG_FN(fabs)(f->slip[j]) <= LAG_C(1e-9)*LAG_FN(fabs)(f->response[j]) ? LAG_C(1.0) : LAG_C(0.0);
  return status;
}

/* ---- end ---- */
#endif
