/* What a simulator writes: rows, pictures, its saved state. Holds for all files: they are written as
 * FILE.part-N-M and renamed when complete, so that no half-written FILE is ever seen (outfile.h). */
#ifndef LAG_IO_IO_H
#define LAG_IO_IO_H

#include <stdio.h>

#include "io/outfile.h"
#include "lag.h"

typedef struct Column {
  char name[96], unit[64];
  const char *const *words; /* [nwords] of a column that holds words: a value is the number of its word. NULL: numbers */
  int nwords;
} Column;

/* Column 0 is the time. data[nrows * ncols], row by row; kept only when keep is set. */
typedef struct Table {
  int ncols;
  Column *cols;
  int keep;
  int points; /* rows are points by themselves, not of a curve */
  double *data;
  size_t nrows, capacity;
} Table;

int table_init(Table *t, const lag_sim *sim, int keep);
void table_free(Table *t);
int table_add(Table *t, const double *row);
/* The time in years, days or hours where the rows span two of them or more, for pictures; as it is where nothing has a unit. */
void table_long_time(Table *t);

/* Rows to a file: .npy by its suffix, else CSV, whose header waits for the first row or the end: what fails before writes nothing. */
typedef struct Rows {
  Outfile out;
  int open, npy;
  size_t nrows;
  int ncols;
  size_t npy_header; /* bytes */
  const Column *cols;
} Rows;

int rows_open(Rows *r, const char *path, const Table *t);
int rows_write(Rows *r, const double *row);
int rows_close(Rows *r, int keep);

/* The rows that a picture needs, of those that are added: straight lines between them miss no row by more than a part
 * of the range of each column that is drawn. */
typedef struct Thin {
  Table *table;    /* where they go; with store 0 they are only counted */
  int store;
  double part;     /* of the range that is not seen */
  double longest;  /* time between two of them */
  int common;      /* the columns share one scale, the widest range's */
  size_t kept;
  int ndrawn, *drawn;   /* [ncols], the columns */
  double *memory, *low, *high, *least, *most, *from, *last, *width; /* [ncols] each */
  int have_last;
} Thin;

/* -1: no memory. Free it with thin_free in any case. */
int thin_init(Thin *w, Table *t, int store, double part, double longest);
void thin_free(Thin *w);
/* The column is drawn. */
void thin_draw(Thin *w, int col);
/* Widens the ranges by a row. A row must be seen before it is added. */
void thin_see(Thin *w, const double *row);
/* Whether the row `between` two others lies on the line that joins them, as far as one can see. */
int thin_straight(const Thin *w, const double *a, const double *b, const double *between);
/* Rows in the order of time; the last is kept by thin_end, after which more may follow. -1: no memory. */
int thin_add(Thin *w, const double *row);
int thin_end(Thin *w);
/* Keeps fewer rows: doubles the part until at most `most` are left, or it is 1/2. -1: no memory. */
int thin_again(Thin *w, size_t most);

/* Ticks: a round step (1, 2, 5 times a power of ten) of which about n fit between lo and hi. */
double nice_step(double lo, double hi, int n);

/* What a picture draws: column y[i] against column x[i]. Column 0 is the time. */
typedef struct Drawn {
  int n, *x, *y;
  const char *xname, *yname; /* of what has several columns; NULL: everything against the time */
} Drawn;

/* As SVG. -1 with errno set. */
int svg_write(const char *path, const Table *t, const char *title, const Drawn *d);

/* Points (x, y), all positive, joined in their order. */
typedef struct Series {
  char name[96];
  int n;
  const double *x, *y;
} Series;

/* Curves of points on two logarithmic axes, each with its name beside it. -1 with errno set. */
int svg_chart(const char *path, const char *title, const char *xlabel, const char *ylabel, const Series *s, int n);

/* The same as text, the first few of them. */
void sketch(FILE *f, const Table *t, const Drawn *d);

/* What an animation shows: points whose x and y are columns, in one unit. */
typedef struct Animation {
  int npoints;
  int *cols;        /* x, y of each point: [2 * npoints] */
  int from;         /* the first point is where the first rod begins, and no body */
  int rods, trace;
  const char *unit;
  const char *note; /* for those who watch, or "" */
} Animation;

/* The table as a page that plays it. -1 with errno set. */
int html_write(const char *path, const Table *t, const char *title, const Animation *a);

/* JSON text: a string in quotes or null; a number that reads back exactly, or null. */
void json_string(FILE *f, const char *s);
void json_number(FILE *f, double x);

/* What stands at the head of a saved state, and the state. data is malloced by read. */
typedef struct State {
  char program[128], scene[128], method[64];
  double tol;
  int noptions;
  double options[16];
  unsigned long long signature;
  double t;
  size_t n;
  double *data;
} State;

int state_write(const char *path, const State *s);
/* The state that is written in a whole file's text, from anywhere; NULL, or why it is none, and then there is no data. */
const char *state_parse(char *text, State *s);
/* 0; -1 errno; 1: not a saved state, or damaged: *why says how. */
int state_read(const char *path, State *s, const char **why);

/* Writes a text with & < > " as XML and HTML spell them. */
void io_markup(FILE *f, const char *s);

#endif
