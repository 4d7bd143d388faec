/* Marks of an animation. Enters: a run under way, its events. Leaves: the times at which contacts, constraints with
 * a condition and surfaces of friction begin to act, stick, slip and let go, and those of impacts and events. Holds:
 * nothing is noted unless an animation is written; noting does not change the run. */
#include <float.h>
#include <math.h>
#include <stdlib.h>

#include "app/app.h"
#include "core/core.h"
#include "numeric/release.h"

/* Tracks: contacts, surfaces, events. */
static int ntracks(const lag_model *m) { return m->ncontacts + m->nmodes + m->nev; }

int lag_marks_open(App *app) {
  const lag_model *m = app->scene->model;
  Marks *marks = &app->show.marks;
  if (!app->args.html || !ntracks(m)) return 0;
  marks->names = calloc((size_t)ntracks(m), sizeof *marks->names);
  app->marked = calloc((size_t)ntracks(m), sizeof *app->marked);
  if (!marks->names || !app->marked) return lag_app_error(&app->args, "out of memory");
  for (int i = 0; i < m->ncontacts; i++) marks->names[i] = m->constraints->of[m->contacts[i].constraint].name;
  for (int k = 0; k < m->nmodes; k++) marks->names[m->ncontacts + k] = m->switches[k].surface;
  for (int k = 0; k < m->nev; k++) marks->names[m->ncontacts + m->nmodes + k] = m->ev[k].name;
  marks->ntracks = ntracks(m);
  return 0;
}

void lag_marks_free(App *app) {
  lag_free_all(app->show.marks.names, app->show.marks.at, app->marked);
}

/* -1: no memory. */
static int add(Marks *marks, double t, int track, int word) {
  if ((marks->n & (marks->n + 1)) == 0) { /* 0, 1, 3, 7, ... */
    Mark *at = realloc(marks->at, 2 * (marks->n + 1) * sizeof *at);
    if (!at) return -1;
    marks->at = at;
  }
  marks->at[marks->n++] = (Mark){t, track, word};
  return 0;
}

static int has_impulses(const lag_sim *s) { return s->pb.contacts && s->pb.contacts->length > 0; }

/* Contacts that are met by impulses act where the last step pressed them, and stick where friction was below its
 * limit. */
static int contact_word(const lag_sim *s, int i, const double *law) {
  const lag_model *m = s->scene->model;
  const lag_contact *c = &m->contacts[i];
  const double *P = s->pb.contact_impulse;
  double rub = 0;
  if (c->is_tangent || !(has_impulses(s) ? P[i] > 0 : lag_contact_is_closed(s, c))) return MARK_NONE;
  if (i + 1 == m->ncontacts || !m->contacts[i + 1].is_tangent) return MARK_ACTS;
  if (!has_impulses(s)) return lag_contact_is_closed(s, c + 1) ? MARK_STICKS : MARK_SLIPS;
  for (int k = i + 1; k < m->ncontacts && m->contacts[k].is_tangent; k++) rub = hypot(rub, P[k]);
  double most = law[3 * (i + 1)] * P[i]; /* more: by static friction */
  return rub < most * (1 - 64 * DBL_EPSILON) || rub > most * (1 + 1e-9) ? MARK_STICKS : MARK_SLIPS;
}

static int surface_word(const lag_sim *s, int k) {
  return !s->scene->model->switches[k].jumps ? MARK_NONE : lag_switch_sticks(s, k) ? MARK_STICKS : MARK_SLIPS;
}

int lag_marks_note(App *app) {
  const lag_model *m = app->scene->model;
  lag_sim *s = app->sim;
  double *law = s->pb.rub, t = lag_sim_time(s); /* the step behind t is known already */
  int impulses = app->marked && has_impulses(s), struck = impulses && s->pb.contacts->from < s->run->step_t1;
  int rc = impulses && m->contact_laws ? lag_contact_laws(s, s->now, law) : LAG_OK;
  for (int i = 0; app->marked && i < m->ncontacts + m->nmodes && rc == 0; i++) {
    int word = i < m->ncontacts ? contact_word(s, i, law) : surface_word(s, i - m->ncontacts), was = app->marked[i];
    if (word != was && add(&app->show.marks, t, i, word)) return LAG_ENOMEM;
    if (struck && i < m->ncontacts && word != was && was == MARK_NONE &&
        add(&app->show.marks, t, m->ncontacts + m->nmodes + m->contacts[i].impact, MARK_EVENT))
      return LAG_ENOMEM;
    app->marked[i] = word;
  }
  return rc;
}

int lag_marks_event(App *app, int k, double t) {
  const lag_model *m = app->scene->model;
  const lag_contact *c = lag_contact_of(m, k);
  if (!app->marked || (c && (c->is_tangent || c->conditional || k != c->impact))) return 0; /* a track shows these */
  return add(&app->show.marks, t, m->ncontacts + m->nmodes + k, MARK_EVENT);
}
