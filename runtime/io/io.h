/* Output files of a simulator: tables of rows, pictures, saved states. Holds for all: a file is written as
 * FILE.part-N-M and renamed when complete, so that no half-written FILE is ever seen (outfile.h). Names here are
 * internal to the simulator. */
#pragma once

#include <stdio.h>

#include "app/options.def" /* OptionTakes */
#include "io/outfile.h"
#include "lag.h"

typedef struct Column {
  char name[96], unit[64];
  const char *const *words; /* text column of a CSV file: a value is the index of its word. NULL: a column of numbers */
  int plain; /* bytes of the name before the label of its run; 0: all */
} Column;

/* A table of output; column 0 is the time. data[nrows * ncols], row-major. */
typedef struct Table {
  int ncols;
  Column *cols;
  int keep;   /* 0: rows are not stored, data stays NULL */
  int points; /* 1: rows are separate points, not joined to a curve, */
  int joined; /* but for the last columns, black lines: of two the second is dashed */
  /* rows up to the horizon of the run, as far as their digits mean something; 0: all. The rest is drawn grey */
  size_t certain;
  double horizon; /* where certain > 0: its time, in the unit of column 0 */
  double *data;
  size_t nrows, capacity;
} Table;

/* s[n] := name and unit of a column, "th [rad]". Returns s. */
const char *lag_column_label(const Column *c, char *s, size_t n);
/* Name and unit of component i of the state. */
Column lag_state_column(const lag_sim *sim, int i);
/* Columns from the outputs of the simulation. -1: no memory, as of lag_table_add. */
int lag_table_init(Table *t, const lag_sim *sim, int keep);
void lag_table_free(Table *t);
int lag_table_add(Table *t, const double *row);
static inline double lag_table_cell(const Table *t, size_t row, int col) {
  return t->data[row * (size_t)t->ncols + (size_t)col];
}
/* Widens [lo, hi] by the finite values of a column. */
void lag_table_range(const Table *t, int col, double *lo, double *hi);
/* The longest of year, day and hour of which a span [s] holds two, in seconds; *name: its unit. 0: none. */
double lag_long_time_unit(double span, const char **name);
/* For pictures: converts the time to years, days or hours where the rows span two or more of these; not where no
 * column has a unit. */
void lag_table_scale_time(Table *t);

/* A file of rows: .npy by its suffix, else CSV. The CSV header is written with the first row, so a run that fails
 * before writes nothing. */
typedef struct Rows {
  Outfile out;
  int open, npy;
  size_t nrows;
  int ncols;
  const Column *cols;
  struct {
    double x;
    char text[64];
  } known[128]; /* numbers that were written, by their bits: the values of a grid come again and again */
} Rows;

/* -1 with errno set. lag_rows_close: keep 0 removes the file. */
int lag_rows_open(Rows *r, const char *path, const Table *t);
int lag_rows_write(Rows *r, const double *row);
int lag_rows_close(Rows *r, int keep);

/* Makes [lo, hi] a drawable interval: with a margin relative to its length; half of the values on each side where it
 * is narrower than `least` times these; [0, 1] where it is empty. */
void lag_widen_range(double *lo, double *hi, double least, double margin);
/* Width of dots in a picture of so many: 8 pixels where they are few, 2 where they are thousands. */
double lag_dot_width(double rows);
/* Decimal logarithms: a factor of 2.2 at least, which contains a tick. */
void lag_widen_log_range(double *lo, double *hi);
/* Step of axis ticks: 1, 2 or 5 times a power of ten, about n of them from lo to hi. */
double lag_tick_step(double lo, double hi, int n);

/* Function drawn beneath a path, as level curves or as a curve: value(of, x, y) over its axes. */
typedef struct Beneath {
  double (*value)(void *of, double x, double y); /* NULL: nothing */
  void *of;
  double period; /* of x, which is then drawn from -period/2 to period/2; 0: none */
  int profile; /* 1: y is of the kind of the value, and the curve value(of, x, 0) is drawn; 0: level curves */
} Beneath;

/* A few words at a place of a picture. */
typedef struct PictureNote {
  double x, y;
  char text[24];
} PictureNote;

/* The curves of a picture: column y[i] against column x[i]; column 0 is the time. */
typedef struct PlottedCurves {
  int n, *x, *y;
  int xlog, ylog; /* 1: column 0, or the drawn ones, hold decimal logarithms */
  const char *xname, *yname; /* axis labels where several columns are drawn; NULL: all columns against time */
  Beneath beneath;
  int runs;   /* 0, or curve i is of run i mod runs, whose colour it has */
  int ordered; /* 1: the runs are those of a range, and coloured by their place in it */
  int nnotes;
  PictureNote *note; /* [nnotes], or NULL */
} PlottedCurves;

/* Options of a picture on the command line: PICTURE_FLAG and PICTURE_TEXT of the table of options. */
typedef struct PictureOptions {
#define PICTURE_FLAG(f) int f;
#define PICTURE_TEXT(f) const char *f;
#define OWN_FLAG TO
#define OWN_TEXT TO
#define OWN_LIST TO
#define TO(f)
#define LAGC(...)
#define BOTH(name, brief, value, takes, hint, commands, analyses, field, text) field
#define SIMULATOR(name, value, takes, analyses, field, text) field
#include "app/options.def"
} PictureOptions;

/* An SVG picture under way: writers begin it by lag_svg_head (svg_panel.h); its file ends with "</svg>". */
typedef struct Picture {
  FILE *f;
  const char *title;
  const PictureOptions *options;
} Picture;

void lag_svg_write(const Picture *p, const Table *t, const PlottedCurves *d);

/* A value over two others. */
typedef struct ValueMap {
  int nx, ny;
  const double *x, *y;  /* [nx], [ny]: centres of the cells, ascending, in equal steps, */
  int xlog, ylog;       /* 1: decimal logarithms */
  const double *value;  /* [ny * nx], from the lowest y on; not finite: no value */
  const char *xlabel, *ylabel, *label;
} ValueMap;

void lag_map_write(const Picture *p, const ValueMap *m);

/* Columns from `first` on over those before, and over each other. */
typedef struct ScatterMatrix {
  const Table *table;
  int first;
  const int *log;       /* [first] 1: the column holds decimal logarithms */
} ScatterMatrix;

void lag_matrix_write(const Picture *p, const ScatterMatrix *m);

/* Writes histograms of the columns from `first` on, of `parts` bars each. -1 with errno set. */
int lag_histograms_write(const Picture *p, const Table *t, int first, int parts);

/* Prints the first few curves as text (braille dots). */
void lag_sketch_write(FILE *f, const Table *t, const PlottedCurves *d);

/* From time t on a contact, constraint or surface of friction does as the word says; MARK_EVENT: at t alone. */
enum { MARK_NONE, MARK_SLIPS, MARK_STICKS, MARK_ACTS, MARK_EVENT };
typedef struct Mark {
  double t;
  int track, word;
} Mark;

typedef struct Marks {
  int ntracks;
  const char **names; /* [ntracks] of contacts, surfaces and events; owned by the model, the array by the marks */
  size_t n;
  Mark *at;           /* [n] in the order of time */
} Marks;

/* An animation: shapes whose numbers are columns of the table, all places in one unit. */
typedef struct Animation {
  int nshapes;
  lag_shape *shapes; /* [nshapes] */
  char *words;       /* texts of shapes that are not the scene's, or NULL */
  int trace;         /* 1: draw paths from the start on */
  const char *unit;
  const char *note; /* text below the animation, or "" */
  Marks marks;
} Animation;

/* Whether b of a shape is a place or a length: not of an arrow that is scaled to the picture. */
static inline int lag_shape_has_length(const lag_shape *s) { return s->kind[0] != 'a' || s->count == 0; }

/* Writes an HTML page that plays the table. -1 with errno set. */
int lag_html_write(const char *path, const Table *t, const char *title, const Animation *a);

/* Writes the shapes at --drawing N instants, at equal times from the first row to the last. -1 with errno set. */
int lag_drawing_write(const Picture *p, const Table *t, const Animation *a);

/* JSON writer: commas between members are its own. A name is NULL for elements of an array. */
typedef struct Json {
  FILE *f;
  int comma; /* 1: the next member follows another one */
} Json;

/* Writes s in quotes: a literal of JSON, and of Python. */
void lag_json_quote(FILE *f, const char *s);
/* Begins a member whose value the caller writes to j->f. */
void lag_json_name(Json *j, const char *name);
/* A member that is an object or an array; bracket: one of { [ and then } ]. */
void lag_json_begin(Json *j, const char *name, char bracket);
void lag_json_end(Json *j, char bracket);
/* s in quotes, or null for NULL; x with the digits to read back exactly, or null where it is not finite; true,
 * false, or null for -1. */
void lag_json_string(Json *j, const char *name, const char *s);
void lag_json_number(Json *j, const char *name, double x);
void lag_json_count(Json *j, const char *name, long long n);
void lag_json_truth(Json *j, const char *name, int yes);
/* x[n] as an array; x[rows][columns] as one of arrays. */
void lag_json_row(Json *j, const char *name, int n, const double *x);
void lag_json_matrix(Json *j, const char *name, int rows, int columns, const double *x);
/* The outermost object: its begin; its end, and that of its line. */
Json lag_json_open(FILE *f);
void lag_json_close(Json *j);
/* A member with n elements, each written by the statement behind, and an array of objects with the members written
 * there: JSON_EACH(j, "names", '[', i, n) lag_json_string(j, NULL, name[i]). */
#define JSON_EACH(j, name, bracket, i, n) \
  for (int i = (lag_json_begin(j, name, bracket), 0); i < (n) || (lag_json_end(j, (bracket) + 2), 0); i++)
#define JSON_OBJECTS(j, name, i, n) \
  for (int i = (lag_json_begin(j, name, '['), 0); \
       i < (n) ? (lag_json_begin(j, NULL, '{'), 1) : (lag_json_end(j, ']'), 0); lag_json_end(j, '}'), i++)

/* Several members: lag_json_numbers(j, {"t", t}, {"x", x}). */
#define JSON_LIST(Each, ...) (const Each[]){__VA_ARGS__, {NULL, 0}}
#define lag_json_numbers(j, ...) lag_json_number_list(j, JSON_LIST(JsonNumber, __VA_ARGS__))
#define lag_json_counts(j, ...) lag_json_count_list(j, JSON_LIST(JsonCount, __VA_ARGS__))
#define lag_json_strings(j, ...) lag_json_string_list(j, JSON_LIST(JsonString, __VA_ARGS__))
typedef struct JsonNumber {
  const char *name;
  double x;
} JsonNumber;
typedef struct JsonCount {
  const char *name;
  long long n;
} JsonCount;
typedef struct JsonString {
  const char *name, *s;
} JsonString;
void lag_json_number_list(Json *j, const JsonNumber *of);
void lag_json_count_list(Json *j, const JsonCount *of);
void lag_json_string_list(Json *j, const JsonString *of);

/* A saved state: its head and the n doubles of lag_sim_save. lag_state_parse and lag_state_read allocate data; the
 * caller frees it. */
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

/* -1 with errno set. */
int lag_state_write(const char *path, const State *s);
/* Parses the text of a state file, which may be any bytes. NULL, or the reason why it is no saved state; data is
 * then NULL. */
const char *lag_state_parse(char *text, State *s);
/* 0; -1 with errno set; 1: not a saved state, or damaged, with the reason in *why. */
int lag_state_read(const char *path, State *s, const char **why);

/* Writes s with & < > " escaped for XML and HTML, and hidden characters made visible. */
void lag_write_markup(FILE *f, const char *s);
