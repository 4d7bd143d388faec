/* Frequencies over amplitudes, as text and JSON: for `lagc modes --amplitude`. */
#pragma once

#include "analysis/mode_amplitude.h"
#include "app/app.h"

/* *bends := those of all modes about the rest, from malloc. 0, or an exit status, with its message. */
int lag_app_find_amplitudes(const App *app, Equilibrium *rest, const Modes *modes, ModeAmplitude **bends);
void lag_app_put_amplitudes(FILE *f, const lag_model *m, int n, const ModeAmplitude *bends);
void lag_app_json_amplitude(Json *j, const lag_model *m, const ModeAmplitude *a);
