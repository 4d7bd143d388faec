/* Parts that all SVG pictures share. */
#pragma once

#include "io/io.h"

/* Places in a picture [pixels]. */
enum { WIDTH = 860, LEFT = 84, RIGHT = 150, TOP = 50, BOTTOM = 52 };

/* Eight colours distinct for all kinds of colour vision (Okabe and Ito), yellow darkened. */
extern const char *const lag_colour[8];

typedef struct Panel {
  double x, y, w, h;         /* rectangle in pixels */
  double x0, x1, y0, y1;     /* ranges of the data */
  int xlog, ylog;            /* 1: the data are decimal logarithms, and labels their powers of ten */
  int size;                  /* of text, in pixels; 0: 14 */
  const char *xlabel;
} Panel;

/* Pixels of a value. */
double lag_panel_x(const Panel *p, double x);
double lag_panel_y(const Panel *p, double y);

/* The beginning of a picture: size, title, styles; lag_svg_large_head: with text of this size. */
void lag_svg_head(const Picture *p, int width, int height);
void lag_svg_large_head(const Picture *p, int width, int height, int size);
void lag_svg_text(FILE *f, double x, double y, const char *attributes, const char *s);
/* svg_levels.c: level curves of a value over the panel; its curve along y = 0; [y0, y1] widened to the latter's
 * lowest value, and by half upwards. */
void lag_svg_levels(FILE *f, const Panel *p, const Beneath *b);
/* Widens the panel's y, over a period of x, until a separatrix is inside. */
void lag_svg_levels_range(const Beneath *b, Panel *p);
void lag_svg_profile(FILE *f, const Panel *p, const Beneath *b);
void lag_svg_profile_range(const Beneath *b, double x0, double x1, double *y0, double *y1);
/* The panel's frame, grid and labels; last: with those of x; ylabel NULL: without those of y. A logarithmic x may
 * fall to the right, x0 > x1. */
void lag_svg_axes(FILE *f, const Panel *p, const char *ylabel, int last);
