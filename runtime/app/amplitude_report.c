/* --modes --amplitude: how frequencies depend on amplitudes (amplitude_report.h). */
#include "app/amplitude_report.h"

#include <math.h>
#include <stdlib.h>

static const lag_var *leading(const lag_model *m, const ModeAmplitude *a) {
  return a->leads < m->nq ? &m->q[a->leads] : &m->z[a->leads - m->nq];
}

int lag_app_find_amplitudes(const App *app, Equilibrium *rest, const Modes *modes, ModeAmplitude **bends) {
  const lag_model *m = app->scene->model;
  int rc = LAG_OK;
  *bends = NULL;
  if (!m->taylor || !m->taylor->along)
    return lag_app_error(
        &app->args,
        m->flags & LAG_SMOOTH
            ? "--amplitude needs series of the forces, which this program was built without: `lagc modes MODEL "
              "--amplitude` and `lagc build MODEL --with linear --method taylor` build them in"
            : "--amplitude needs a model without if, abs, sign, min, max, atan2 and tables, whose forces have no "
              "series; `lagc continue` follows its periodic motions over an amplitude");
  ModeAmplitude *a = calloc((size_t)modes->n + 1, sizeof *a);
  for (int k = 0; a && k < modes->n && rc == LAG_OK; k++) rc = lag_mode_amplitude(&a[k], modes, k, rest);
  if (a && rc == LAG_OK) {
    *bends = a;
    return 0;
  }
  free(a);
  return lag_app_error(&app->args, !a || rc == LAG_ENOMEM ? "out of memory" : "no series of the forces at the rest");
}

/* The resonance that hides the next power of A, or the near one that makes the coefficients large. */
static void put_resonance(FILE *f, const ModeAmplitude *a, int mode) {
  const int blocked = a->limit == AMPLITUDE_RESONANCE;
  if (blocked && a->times == 0) {
    fprintf(f, "it drifts along mode %d", a->with + 1);
    return;
  }
  fputs(blocked ? "resonance" : "; for small A only, near the resonance", f);
  fprintf(f, " %d w%d = w%d", a->times, mode, a->with + 1);
  if (a->divisor > 1e-9) fprintf(f, ", but for %.2g w%d", a->divisor, mode);
}

void lag_app_put_amplitudes(FILE *f, const lag_model *m, int n, const ModeAmplitude *bends) {
  for (int i = 0; i < n; i++) {
    const ModeAmplitude *a = &bends[i];
    const lag_var *v = leading(m, a);
    double unit = v->factor * v->factor;
    fprintf(f, "mode %d: ", i + 1);
    if (a->limit == AMPLITUDE_NO_OSCILLATION) {
      fputs("no undamped oscillation, so no family of periodic motions\n", f);
      continue;
    }
    if (a->limit == AMPLITUDE_GROWTH)
      fprintf(f, "no family of periodic motions: A' = %.8g A^3 [1/s]", a->growth * unit);
    else if (isnan(a->a2)) fputs("no series of its own: ", f);
    else fprintf(f, "frequency times 1 %c %.8g A^2", a->a2 < 0 ? '-' : '+', fabs(a->a2) * unit);
    if (a->limit == AMPLITUDE_WHOLE) fprintf(f, " %c %.8g A^4", a->a4 < 0 ? '-' : '+', fabs(a->a4) * unit * unit);
    if (a->limit == AMPLITUDE_RESONANCE && !isnan(a->a2)) fputs(", no A^4: ", f);
    if (a->limit == AMPLITUDE_RESONANCE) put_resonance(f, a, i + 1);
    if (a->limit == AMPLITUDE_GROWTH || !isnan(a->a2))
      fprintf(f, "; A: half the swing of %s%s%s", v->name, v->unit[0] ? ", in " : "", v->unit);
    if (a->limit == AMPLITUDE_WHOLE && !isnan(a->divisor)) put_resonance(f, a, i + 1);
    fputc('\n', f);
  }
}

void lag_app_json_amplitude(Json *j, const lag_model *m, const ModeAmplitude *a) {
  const int found = a->limit != AMPLITUDE_NO_OSCILLATION;
  double unit = found ? pow(leading(m, a)->factor, 2) : NAN;
  lag_json_begin(j, "amplitude", '{');
  lag_json_string(j, "of", found ? leading(m, a)->name : NULL);
  lag_json_numbers(j, {"a2", a->a2 * unit}, {"a4", a->a4 * unit * unit}, {"a2_error", a->error2 * unit},
                      {"a4_error", a->error4 * unit * unit});
  if (a->limit == AMPLITUDE_GROWTH) lag_json_number(j, "growth", a->growth * unit);
  if (found && !isnan(a->divisor)) {
    lag_json_begin(j, "smallest_divisor", '{');
    lag_json_numbers(j, {"mode", a->with + 1}, {"times", a->times}, {"divisor", a->divisor});
    lag_json_end(j, '}');
  }
  lag_json_end(j, '}');
}
