/* Volume of the phase space along a motion (phase_volume.h). */
#include "analysis/phase_volume.h"

#include <math.h>
#include <string.h>

#include "analysis/orthonormalise.h"
#include "core/core.h"
#include "numeric/dense.h"

void lag_phase_volume_free(PhaseVolume *v) { lag_pool_free(&v->pool); }

/* log |det M| at the present state; 0 of a model without velocities. */
static double log_mass(PhaseVolume *v, lag_sim *sim) {
  int nq = sim->pb.nq;
  double log_of = 0;
  if (nq == 0) return 0;
  int rc = lag_linearise(&sim->pb, sim->run->t, sim->now, NULL, v->dr, v->M, v->work);
  if (rc || lag_eliminate((size_t)nq, 0, v->M, v->M)) return NAN;
  for (int i = 0; i < nq; i++) log_of += log(fabs(v->M[i * nq + i]));
  return log_of;
}

int lag_phase_volume_begin(PhaseVolume *v, lag_sim *sim) {
  const lag_model *m = sim->scene->model;
  size_t n = (size_t)sim->pb.n, nq = (size_t)sim->pb.nq;
  *v = (PhaseVolume){.n = sim->pb.n};
  if (m->constraints)
    return lag_fail(sim, LAG_EMETHOD,
                    "the volume of the phase space is that of all coordinates, and constraints leave a part of it; "
                    "write the model in coordinates without constraints");
  if (nq && !m->linear)
    return lag_fail(sim, LAG_EMETHOD,
                    "the volume of the phase space needs the mass matrix, which this program was built without; `lagc "
                    "run --volume` builds it in, and so does `lagc build --with linear`");
  const lag_part parts[] = {{&v->sum, n}, {&v->Y, n * n}, {&v->grown, n}, {&v->M, nq * nq}, {&v->dr, n * n},
      {&v->work, lag_linear_work(m) + 1}};
  lag_pool_parts(&v->pool, sizeof parts / sizeof *parts, parts);
  if (v->pool.failed) return LAG_ENOMEM;
  int rc = lag_sim_set_tangent(sim, sim->pb.n, NULL);
  v->mass = rc ? 0 : log_mass(v, sim);
  return rc;
}

/* log |det| at the present state, of vectors Y and the sums of their growth before. */
static double log_det_of(PhaseVolume *v, lag_sim *sim, const double *sum) {
  double log_of = log_mass(v, sim) - v->mass;
  for (int i = 0; i < v->n; i++) log_of += sum[i];
  return log_of;
}

int lag_phase_volume_step(PhaseVolume *v, lag_sim *sim) {
  int rc = lag_sim_tangent(sim, v->Y);
  rc = rc ? rc : lag_orthonormalise(v->n, v->n, v->Y, v->sum, 1, sim->tangent_log == -HUGE_VAL);
  rc = rc ? rc : lag_sim_set_tangent(sim, v->n, v->Y);
  sim->tangent_log = 0;
  if (rc == LAG_EDOMAIN)
    return lag_fail(sim, rc,
                    "at t = %s s neighbouring motions become one within a step, and their volume 0; take smaller steps",
                    LAG_TEXT(lag_sim_time(sim)));
  if (rc) return rc;
  v->log_det = log_det_of(v, sim, v->sum);
  v->largest = fmax(v->largest, fabs(v->log_det));
  return LAG_OK;
}

double lag_phase_volume_now(PhaseVolume *v, lag_sim *sim) {
  memcpy(v->grown, v->sum, (size_t)v->n * sizeof *v->sum);
  int rc = lag_sim_tangent(sim, v->Y);
  rc = rc ? rc : lag_orthonormalise(v->n, v->n, v->Y, v->grown, 1, sim->tangent_log == -HUGE_VAL);
  return rc ? NAN : log_det_of(v, sim, v->grown);
}
