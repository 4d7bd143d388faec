/* Frequencies over amplitudes, as text and JSON: for `lagc modes --amplitude`. */
#pragma once

#include "analysis/mode_coupling.h"
#include "app/app.h"

typedef struct Amplitudes {
  ModeAmplitude *bend; /* of each mode; NULL: not asked for */
  Couplings couplings;
} Amplitudes;

/* Amplitudes of all modes about the rest. 0, or an exit status, with its message. Free bend in any case. */
int lag_app_find_amplitudes(const App *app, Equilibrium *rest, const Modes *modes, Amplitudes *a);
void lag_app_put_amplitudes(FILE *f, const lag_model *m, const Modes *modes, int n, const Amplitudes *a);
void lag_app_json_amplitude(Json *j, const lag_model *m, const ModeAmplitude *a);
void lag_app_json_couplings(Json *j, const lag_model *m, const Modes *modes, const Amplitudes *a);
