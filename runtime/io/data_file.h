/* A file of measurements as CSV: names with units in the first line, a row of numbers in each other one. */
#pragma once

#include "io/csv_file.h"

typedef struct DataFile {
  CsvFile file;    /* its names as they stand in the first line: "th [deg]" */
  size_t nrows;
  double *x;       /* [nrows * ncols]; NaN where a field is empty */
  long long *line; /* [nrows] line of the file */
} DataFile;

/* 0; or -1 with the reason in why[size], which names file and line. */
int lag_data_read(const char *path, DataFile *d, char *why, size_t size);
void lag_data_free(DataFile *d);
