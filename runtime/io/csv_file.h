/* A CSV file (RFC 4180) as it is read: names in the first line, as many fields in each other one. */
#pragma once

#include <stddef.h>

typedef struct CsvFile {
  const char *path;
  char *text, *at;       /* the whole file; its next line */
  long long line;        /* number of the line before that; 0: the file as a whole */
  char **names, **field; /* [ncols] in the first line; in the last row */
  int ncols;
  char *why;             /* [size] message of a refused file, with its path and line */
  size_t size;
} CsvFile;

/* Reads the file and its names. Returns 0, or -1 after a message in why[size]; lag_csv_close in either case. */
int lag_csv_open(CsvFile *f, const char *path, char *why, size_t size);
/* *x := the number in field i of the row. -1 after a message with this name. */
int lag_csv_number(const CsvFile *f, int i, const char *name, double *x);
void lag_csv_close(CsvFile *f);
/* Fields of the next line that is not blank, without quotes and the spaces around them. 1; 0: no more; -1: refused. */
int lag_csv_row(CsvFile *f);
int lag_csv_refuse(const CsvFile *f, const char *format, ...); /* returns -1 */
