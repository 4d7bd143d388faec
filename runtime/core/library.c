/* The interface for other languages: names without structs, many states in one call. Enters: a scene, arrays of the
 * caller; leaves: names, rates, rows. */
#include <stdlib.h>
#include <string.h>

#include "core/core.h"
#include "numeric/clock.h"

int lag_library_abi(void) { return LAG_ABI; }

const lag_scene *lag_library_scene(const lag_program *program, int i) {
  return program && i >= 0 && i < program->nscenes ? program->scenes[i] : NULL;
}

const char *lag_scene_span(const lag_scene *scene, double *t0, double *t1, double *every) {
  if (!scene || !t0 || !t1 || !every) return NULL;
  *t0 = scene->t0;
  *t1 = scene->t1;
  *every = scene->every;
  return scene->name;
}

const char *lag_scene_method(const lag_scene *scene) { return scene ? scene->method : NULL; }

const char *lag_item(const lag_scene *scene, int kind, int i, const char **unit, double *factor, double *offset) {
  const lag_model *m = scene ? scene->model : NULL;
  const lag_var *vars = !m            ? NULL
                        : kind == 'q' ? m->q
                        : kind == 'z' ? m->z
                        : kind == 'p' ? m->p
                        : kind == 'u' ? m->u
                                      : NULL;
  int n = !m            ? 0
          : kind == 'q' ? m->nq
          : kind == 'z' ? m->nz
          : kind == 'p' ? m->np
          : kind == 'u' ? m->nu
          : kind == 'e' ? m->nev
          : kind == 'c' ? (m->charges ? m->charges->n : 0)
          : kind == 'm' ? lag_nmethods
                        : 0;
  if (unit) *unit = "";
  if (factor) *factor = 1;
  if (offset) *offset = 0;
  if (i < 0 || i >= n) return NULL;
  if (kind == 'm') return lag_methods[i]->name;
  if (kind == 'e') return m->ev[i].name;
  if (unit) *unit = kind == 'c' ? m->charges->of[i].unit : vars[i].unit;
  if (kind == 'c') return m->charges->of[i].name;
  if (factor) *factor = vars[i].factor;
  if (offset) *offset = vars[i].offset;
  return vars[i].name;
}

int lag_time_is_up(void *until, const lag_sim *s) {
  enum { OFTEN = 4 }; /* steps between two looks at the clock */
  return (long long)s->run->steps % OFTEN == 0 && lag_clock_seconds() > *(const volatile double *)until;
}

int lag_sim_rows(lag_sim *s, int rows, const double *t, double *y, double *out, int *done) {
  if (!s || rows < 0 || !t || !done) return LAG_EINVAL;
  size_t n = (size_t)s->pb.n, nout = (size_t)lag_sim_noutputs(s);
  for (*done = 0; *done < rows; ++*done) {
    size_t k = (size_t)*done;
    int rc = lag_sim_advance(s, t[k]);
    if (rc == 0 && out) rc = lag_sim_outputs(s, out + k * nout);
    if (rc) return rc;
    if (y) memcpy(y + k * n, s->now, n * sizeof *y);
  }
  return LAG_OK;
}
