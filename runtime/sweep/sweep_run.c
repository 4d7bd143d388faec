/* One run of a sweep in parts (run_chunks_impl.h), so that it may wait for steps that are made elsewhere. */
#include <math.h>
#include <stdio.h>

#include "sweep/run_chunks_impl.h"

double *lag_sweep_row(const Sweep *s, double *row, long long k) { return row + k * lag_sweep_columns(s); }

double *lag_sweep_motion(const Sweep *s, double *row, long long c, long long k) {
  int columns = lag_sweep_columns(s);
  return s->nrows ? row + lag_sweep_chunk_runs(s, c) * columns + k * ((long long)lag_sweep_numbers(s) - columns) : NULL;
}

static int after_step(void *sweep, const lag_sim *sim) {
  const Sweep *s = sweep;
  (void)sim;
  return s->stop(s->context);
}

/* Puts a row of the present state. */
static void put_row(const Sweep *s, SweepRun *r) {
  r->next[0] = lag_sim_time(r->sim);
  if (lag_sim_outputs(r->sim, r->next + 1))
    for (int i = 1; i < s->width; i++) r->next[i] = NAN;
  r->next += s->width;
}

static int begin(SweepRun *r) {
  r->begun = 1;
  int rc = lag_measures_begin(r->measures, r->sim);
  return rc < 0 ? rc : LAG_OK;
}

/* A crossing of the section, after the transient. */
static void note_event(void *run, int k, double t, const double *before, const double *after) {
  SweepRun *r = run;
  (void)t, (void)before, (void)after;
  if (k != r->section || !r->begun || !r->motion || r->k > r->sweep->nrows) return;
  put_row(r->sweep, r);
  r->k++;
}

int lag_sweep_run_open(Sweep *s, SweepRun *r, long long i, double *value) {
  const SweepVariant *variant = &s->variant[lag_plan_variant(s->plan, i)];
  lag_sim *sim = r->sim = lag_sim_renew(r->sim, variant->like);
  int rc = sim ? LAG_OK : LAG_ENOMEM;
  lag_plan_values(s->plan, i, value);
  for (int k = 0; k < s->plan->n && rc == LAG_OK; k++)
    if (!s->plan->factor[k].compiled) rc = lag_sim_set(sim, s->plan->factor[k].name, value[k]);
  lag_sim_on_step(sim, s->stop ? after_step : NULL, s);
  if (sim && s->nrows && !s->time) lag_sim_on_event(sim, note_event, r);
  r->sweep = s;
  r->section = variant->section;
  r->next = r->motion;
  r->k = r->begun = 0;
  for (size_t k = 0; r->motion && k < (size_t)(s->nrows + 1) * (size_t)s->width; k++) r->motion[k] = NAN;
  if (rc == LAG_OK && isnan(s->skip)) rc = begin(r);
  return rc < 0 ? rc : LAG_OK;
}

int lag_sweep_run_advance(const Sweep *s, SweepRun *r) {
  int rc = r->begun ? LAG_OK : lag_sim_advance(r->sim, s->skip);
  if (!r->begun && rc == LAG_OK) rc = begin(r);
  for (; r->motion && s->time && r->k < s->nrows && rc == LAG_OK; r->k += rc == LAG_OK) {
    rc = lag_measures_advance(r->measures, s->time[r->k]);
    if (rc == LAG_OK) put_row(s, r);
  }
  return rc == LAG_OK ? lag_measures_advance(r->measures, s->until) : rc;
}

int lag_sweep_run_end(const Sweep *s, SweepRun *r, int status, char *why, size_t size) {
  if (status >= 0 && r->motion && s->time && (r->next == r->motion || r->next[-s->width] != lag_sim_time(r->sim)))
    put_row(s, r);
  if (status >= 0) {
    int judged = lag_sim_judge(r->sim);
    status = judged < 0 ? judged : status;
  }
  if (status >= 0 && r->begun && lag_measures_end(r->measures, r->row)) status = LAG_ENOMEM;
  for (int k = 0; k < s->nmeasures && !r->begun; k++) r->row[k] = NAN; /* it ended within the transient */
  /* up to a failure they are no measures of the run */
  for (int k = 0; k < s->nmeasures && status < 0; k++) r->row[k] = NAN;
  r->row[s->nmeasures] = status;
  if (why) snprintf(why, size, "%s", status < 0 && r->sim ? lag_sim_message(r->sim) : "");
  return status == LAG_ENOMEM || status == LAG_INTERRUPTED ? status : LAG_OK;
}

int lag_sweep_run_whole(Sweep *s, SweepRun *r, long long i, double *value, char *why, size_t size) {
  int status = lag_sweep_run_open(s, r, i, value);
  if (status == LAG_OK) status = lag_sweep_run_advance(s, r);
  return lag_sweep_run_end(s, r, status, why, size);
}
