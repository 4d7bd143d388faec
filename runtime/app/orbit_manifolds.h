/* Rows and picture of manifolds (orbit_manifolds.c) and of connections between them (orbit_connections.c). */
#pragma once

#include "analysis/manifold.h"
#include "app/app.h"

typedef struct Manifolds {
  App *app;
  int wanted[2]; /* unstable, stable */
  int phases;
  double follow; /* time of each run; 0: by the growth */
  Manifold found;
  Table drawn; /* rows of both manifolds: kind, state */
  const ManifoldStart *now; /* of the rows: stable, phase, side */
  size_t rows;
  int rc;
} Manifolds;

/* The options --manifold, --follow and --section. 0, or the exit status after a message. */
int lag_manifolds_settings(Manifolds *m);
/* The table; its second column is `number`. Then a row, and the picture of all rows, if one is asked for. */
int lag_manifolds_columns(Manifolds *m, const char *number);
void lag_manifolds_row(Manifolds *m, double t, const double *y);
int lag_manifolds_draw(Manifolds *m, const char *of);
