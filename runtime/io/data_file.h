/* A file of measurements as CSV: names with units in the first line, a row of numbers in each other one. */
#pragma once

#include <stddef.h>

typedef struct DataFile {
  int ncols;
  size_t nrows;
  char **names;    /* [ncols] as they stand in the first line: "th [deg]" */
  double *x;       /* [nrows * ncols]; NaN where a field is empty */
  long long *line; /* [nrows] line of the file */
  char *text;
} DataFile;

/* 0; or -1 with the reason in why[size], which names file and line. */
int lag_data_read(const char *path, DataFile *d, char *why, size_t size);
void lag_data_free(DataFile *d);
