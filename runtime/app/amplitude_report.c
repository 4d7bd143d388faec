/* --modes --amplitude: how frequencies depend on amplitudes (amplitude_report.h). */
#include "app/amplitude_report.h"

#include <math.h>
#include <stdlib.h>

static const lag_var *leading(const lag_model *m, const ModeAmplitude *a) {
  return a->leads < m->nq ? &m->q[a->leads] : &m->z[a->leads - m->nq];
}

int lag_app_find_amplitudes(const App *app, Equilibrium *rest, const Modes *modes, Amplitudes *all) {
  const lag_model *m = app->scene->model;
  int rc = LAG_OK;
  if (!m->taylor || !m->taylor->along)
    return lag_app_error(
        &app->args,
        m->flags & LAG_SMOOTH
            ? "--amplitude needs series of the forces, which this program was built without: `lagc modes MODEL "
              "--amplitude` and `lagc build MODEL --with linear --method taylor` build them in"
            : "--amplitude needs a model without if, abs, sign, min, max, atan2 and tables, whose forces have no "
              "series; `lagc continue` follows its periodic motions over an amplitude");
  ModeAmplitude *a = all->bend = calloc((size_t)modes->n + 1, sizeof *a);
  for (int k = 0; a && k < modes->n && rc == LAG_OK; k++) rc = lag_mode_amplitude(&a[k], modes, k, rest);
  if (a && rc == LAG_OK) rc = lag_mode_couplings(&all->couplings, modes, a, rest);
  if (a && rc == LAG_OK) return 0;
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

static void put_bends(FILE *f, const lag_model *m, int n, const ModeAmplitude *bends) {
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

/* Unit of the shift of frequency i by mode j: 1 over A_j^2, or, over its action, 1/s. */
static double shift_unit(const lag_model *m, const Modes *modes, const Amplitudes *a, int i, int j, int by_action) {
  const Couplings *c = &a->couplings;
  double unit = leading(m, &a->bend[c->mode[j]])->factor;
  return by_action ? modes->mode[c->mode[i]].im / c->action[j] : unit * unit;
}

static int has_actions(const Couplings *c) {
  for (int i = 0; i < c->n; i++)
    if (isnan(c->action[i])) return 0;
  return 1;
}

/* 2 w2 - w1 = w3, the positive term first. */
static void put_combination(FILE *f, const Couplings *c, int i, int j, const ModeCoupling *pair) {
  const int mode[] = {c->mode[i < j ? i : j] + 1, c->mode[i < j ? j : i] + 1}, first = pair->times[0] <= 0;
  if (abs(pair->times[first]) == 2 && pair->times[!first] == -1 && pair->with + 1 == mode[first]) {
    fprintf(f, "w%d = w%d", mode[0], mode[1]);
    return;
  }
  for (int k = 0; k < 2; k++) {
    int of = k ? !first : first, times = pair->times[of];
    if (times == 0) continue;
    fputs(!k ? "" : times < 0 ? " - " : " + ", f);
    if (abs(times) > 1) fprintf(f, "%d ", abs(times));
    fprintf(f, "w%d", mode[of]);
  }
  fprintf(f, " = w%d", pair->with + 1);
}

/* Why a pair has no shift, or one for small amplitudes only. */
static void put_pair(FILE *f, const Couplings *c, int i, int j) {
  const ModeCoupling *pair = &c->pair[i][j], *back = &c->pair[j][i];
  const int a = c->mode[i] + 1, b = c->mode[j] + 1;
  if (pair->limit == AMPLITUDE_GROWTH || back->limit == AMPLITUDE_GROWTH)
    fprintf(f, "modes %d, %d: one makes the other grow or decay\n", a, b);
  else if (pair->limit == AMPLITUDE_RESONANCE) {
    fprintf(f, "modes %d, %d: no shifts by amplitudes alone: ", a, b);
    if (!pair->times[0] && !pair->times[1]) fprintf(f, "they drift along mode %d", pair->with + 1);
    else fputs("resonance ", f), put_combination(f, c, i, j, pair);
    fputc('\n', f);
  } else if (!isnan(pair->divisor)) {
    fprintf(f, "modes %d, %d: shifts for small A only, near the resonance ", a, b);
    put_combination(f, c, i, j, pair);
    fprintf(f, ", but for %.2g w%d\n", pair->divisor, a);
  }
}

/* The matrix of shifts, of frequencies relative to themselves by A^2, or of frequencies by actions. */
static void put_matrix(FILE *f, const lag_model *m, const Modes *modes, const Amplitudes *a, int n, int by_action) {
  const Couplings *c = &a->couplings;
  fputs(by_action ? "d w_i/d J_j [rad/s^2/J], J: action, energy over w" : "w_i: times 1 + sum of c_ij A_j^2", f);
  for (int j = 0; j < n; j++) fprintf(f, "%s%d", j ? ", " : "; j = ", c->mode[j] + 1);
  fputc('\n', f);
  for (int i = 0; i < n; i++) {
    fprintf(f, "%4d", c->mode[i] + 1);
    for (int j = 0; j < n; j++) {
      double shift = c->pair[i][j].shift * shift_unit(m, modes, a, i, j, by_action) + 0.0; /* no -0 */
      if (isnan(shift)) fputs("             -", f);
      else fprintf(f, " %13.6g", shift);
    }
    fputc('\n', f);
  }
}

static void put_couplings(FILE *f, const lag_model *m, const Modes *modes, int most, const Amplitudes *a) {
  const Couplings *c = &a->couplings;
  int n = c->n < most ? c->n : most;
  if (n < 2) return;
  put_matrix(f, m, modes, a, n, 0);
  if (has_actions(c)) put_matrix(f, m, modes, a, n, 1);
  for (int i = 0; i < n; i++)
    for (int j = i + 1; j < n; j++) put_pair(f, c, i, j);
}

void lag_app_put_amplitudes(FILE *f, const lag_model *m, const Modes *modes, int n, const Amplitudes *a) {
  enum { WIDTH = 8 };
  put_bends(f, m, n, a->bend);
  put_couplings(f, m, modes, n < WIDTH ? n : WIDTH, a);
  if (a->couplings.n > WIDTH)
    fprintf(f, "(shifts of modes 1 to %d by each other; --json has those of up to %d)\n", WIDTH, COUPLING_MOST);
}

static void json_matrix(Json *j, const char *name, const lag_model *m, const Modes *modes, const Amplitudes *a,
                        int by_action) {
  const Couplings *c = &a->couplings;
  JSON_EACH(j, name, '[', i, c->n) {
    JSON_EACH(j, NULL, '[', k, c->n)
      lag_json_number(j, NULL, c->pair[i][k].shift * shift_unit(m, modes, a, i, k, by_action));
  }
}

void lag_app_json_couplings(Json *j, const lag_model *m, const Modes *modes, const Amplitudes *a) {
  const Couplings *c = &a->couplings;
  lag_json_begin(j, "shifts", '{');
  JSON_EACH(j, "of_modes", '[', i, c->n) lag_json_count(j, NULL, c->mode[i] + 1);
  json_matrix(j, "by_amplitude", m, modes, a, 0);
  if (has_actions(c)) json_matrix(j, "by_action", m, modes, a, 1);
  lag_json_end(j, '}');
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
