/* Lists of points in the options of plot and animate, split into the texts of their expressions. */
#ifndef LAGC_COMMANDS_POINT_LIST_H
#define LAGC_COMMANDS_POINT_LIST_H

#include "base/vec.h"

typedef struct {
  const char *x, *y; /* one line, spaces collapsed */
} PointText;

typedef VEC(PointText) PointTexts;

/* Splits "x1,y1 x2,y2" or "x1, y1; x2, y2" into the texts of each point. After its comma a point ends at a space that no
 * operator touches (a sign may follow it). Returns 0, with *error, where a point has not two parts. */
int points_split(Arena *a, const char *text, PointTexts *points, const char **error);

/* A text on one line, without white space at its ends and with single spaces inside. */
const char *text_trimmed(Arena *a, const char *text, size_t n);

#endif
