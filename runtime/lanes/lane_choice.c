/* Chooses lanes by processor, method and model (lane_choice.h); what a simulation says to its lane. */
#include "lanes/lane_choice.h"

#include <math.h>
#include <string.h>

#include "core/core.h"
#include "numeric/processor.h"

void lag_lane_enter(lag_sim *s) { s->outside.on = 1; }

int lag_lane_waits(int status) { return status == LAG_WANTS_STEP; }

int lag_lane_doubts(lag_sim *s) {
  lag_charge_stats energy;
  lag_sim_charge(s, 0, &energy);
  return energy.flags & LAG_CONSERVED &&
         !(fabs(energy.now - s->charges[0].first) <= fmax(0.5 * fabs(energy.begin), 1e-12));
}

static const LaneKernel *kernel_of(const LaneWidth *w, const lag_method *method) {
  for (int i = 0; w->kernels && w->kernels[i]; i++)
    if (strcmp(w->kernels[i]->method, method->name) == 0) return w->kernels[i];
  return NULL;
}

static int has_signal(const lag_sim *s) {
  for (int i = 0; i < s->pb.model->nu; i++)
    if (s->signal[i].fn) return 1;
  return 0;
}

/* Whether an adaptive method has been asked for steps of equal size. */
static int does_not_adapt(const lag_sim *s) {
  for (int i = 0; s->options && i < s->method->noptions; i++)
    if (strcmp(s->method->options[i].name, "adapt") == 0) return s->options[i] != 0.0;
  return 0;
}

/* Why runs of this simulation need each step made alone; NULL: they do not. */
static const char *needs_single_steps(const lag_sim *s) {
  const lag_model *m = s->pb.model;
  if (m->ncontacts || m->families) return "since the model has contacts";
  if (m->constraints) return "since the model has constraints";
  if (m->nmodes || m->nswitch) return "since a force jumps or has a kink";
  for (int k = 0; k < m->nev; k++)
    if (lag_is_kick(m, k)) return "since the model has kicks";
  if (m->ntables) return "since an input is a table";
  if (has_signal(s)) return "since an input is a function";
  if (s->method->flags & LAG_METHOD_SPLITS && !(m->flags & LAG_SEPARABLE))
    return "since forces depend on velocities, or masses on positions";
  if (s->method->flags & LAG_METHOD_SPLITS && m->nq == 0) return "since the model gives its Hamiltonian";
  if (does_not_adapt(s)) return "since steps do not adapt";
  return NULL;
}

/* Why the program has no scenes for lanes. */
static const char *why_not_compiled(const lag_sim *s) {
  if (strcmp(LAG_PRECISION, "double") != 0)
    return "since vectors hold doubles, and this run computes in " LAG_PRECISION " precision";
  if (strstr(s->pb.model->math, "C library")) return "since the C library's sines (--math libm) have no vectors";
  return "since this program was compiled without: `lagc sweep` compiles 4 for AVX2 and NEON, and by gcc 8 for AVX-512";
}

const char *lag_lanes_choose(const lag_sim *like, const lag_scene *four, const lag_scene *eight, int wanted,
                             LaneChoice *c) {
  const LaneWidth *const widths[] = {&lag_lane_width_8, &lag_lane_width_4};
  const lag_scene *const scenes[] = {eight, four};
  const char *why = needs_single_steps(like);
  *c = (LaneChoice){.lanes = 1};
  if (wanted == 1) return NULL;
  if (why) return why;
  why = why_not_compiled(like);
  for (int i = 0; i < 2; i++) {
    int lanes = widths[i]->lanes;
    if (!scenes[i] || !widths[i]->kernels || (wanted && wanted != lanes)) continue;
    if (lag_processor_lanes() < lanes) {
      why = "since this processor has no such vectors";
      continue;
    }
    const LaneKernel *kernel = kernel_of(widths[i], like->method);
    if (!kernel) return "since the method has no lanes";
    *c = (LaneChoice){kernel, scenes[i]->model, lanes,
                      like->pb.model->nev > 0 || like->scene->nmonitors > 0 || !(like->pb.model->flags & LAG_SMOOTH)};
    return NULL;
  }
  return why;
}

int lag_lanes_possible(const lag_sim *like) {
  const LaneWidth *const widths[] = {&lag_lane_width_8, &lag_lane_width_4};
  for (int i = 0; i < 2 && !needs_single_steps(like); i++)
    if (lag_processor_lanes() >= widths[i]->lanes && kernel_of(widths[i], like->method)) return widths[i]->lanes;
  return 1;
}
