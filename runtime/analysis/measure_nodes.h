/* Measures as nodes: written by measure_text.c, evaluated along a run by measure_run.c. Holds: the nodes of an
 * expression stand together, arguments before their node, so an evaluation is a loop over node[begin .. root]. */
#pragma once

#include "analysis/measure.h"
#include "numeric/functions.def"

typedef enum MeasureKind {
  MEASURE_NUMBER,
  MEASURE_QUANTITY, /* its present value */
  MEASURE_ONE, MEASURE_TWO, /* a function of node a; of nodes a and b */
  MEASURE_TRACK,    /* number `index` of the tracks */
  MEASURE_AT,       /* quantity a at the time b */
  MEASURE_HIT,      /* firing number a of event `index` */
  MEASURE_FIRINGS,  /* of event `index` */
  MEASURE_END,
  MEASURE_LYAPUNOV,
  MEASURE_MEGNO
} MeasureKind;

typedef enum QuantityKind {
  QUANTITY_TIME, QUANTITY_STATE, QUANTITY_OUTPUT, QUANTITY_CHARGE, QUANTITY_PARAMETER, QUANTITY_INPUT,
  QUANTITY_KINDS
} QuantityKind;

typedef enum TrackKind {
#define TRACK_KIND(KIND, ...) TRACK_##KIND,
  TRACKS(TRACK_KIND)
  TRACK_KINDS
} TrackKind;

/* Search within steps; INTEGRATED: none, the track is summed over them. */
typedef enum TrackHow { INTEGRATED, HIGHEST = 1, LOWEST = 2, EXTREMES = HIGHEST | LOWEST, PASSAGES = 4 } TrackHow;

/* Unit in which a value is shown: SI = shown*factor + offset. */
typedef struct MeasureUnit {
  char text[48];
  double factor, offset;
} MeasureUnit;

/* MEASURE_STATIC: known before the run; else the number of the run after which the value is known, 0 for all but
 * values at times that are measures. */
enum { MEASURE_STATIC = -1 };

typedef struct MeasureNode {
  MeasureKind kind;
  int begin, a, b;
  int index;            /* of the quantity, track or event */
  QuantityKind of;
  double (*one)(double);
  double (*two)(double, double);
  int known;
  int taken;            /* MEASURE_AT: 1 once the run has come there */
  double value;         /* at the last evaluation */
  double result;        /* of a number, and of a run so far; NaN: not known */
} MeasureNode;

/* Firing number `firing` of an event, and the side of its action; event -1: none. */
typedef struct Happening {
  int event, firing, after;
} Happening;

/* A value that is followed along the run. */
typedef struct Track {
  TrackKind kind;
  TrackHow how;
  int node, arg;        /* its node, and the node of the expression that is followed */
  double first, last;   /* value at the start, and at the end of the last part */
  double least, most, when_first, when_least, when_most; /* and their times, */
  Happening least_at, most_at; /* which are those of events */
  double sum, lost;     /* the integral, and what its rounding has lost */
  double size;          /* largest value seen at places of the integral */
  double passage, latest; /* first and last upward passage of 0, */
  Happening passage_at, latest_at; /* over which an event may lead, */
  int passages;         /* and their number */
  double bad;           /* the first time at which the value is not finite; NaN: none */
  double from, to;      /* the window of time that counts; NaN: the begin, the end of the run */
  double covered;       /* time of the window that the run has passed */
  int begun, active;    /* 1: the window has begun; the present part lies in it */
} Track;

enum { MEASURE_SAMPLES = 16 };

struct Measures {
  const lag_scene *scene;
  MeasureDialect dialect;
  int n, nnodes, room, ntracks;
  int *root;            /* [n] */
  MeasureUnit *unit;    /* [n] */
  char (*why)[200];     /* [n] */
  MeasureNode *node;
  Track *track;
  int uses[QUANTITY_KINDS]; /* 1: an expression contains such a quantity */
  int integrates, samples; /* 1: some track is an integral; some track needs samples */
  double *y, *out;      /* the state and outputs of the present evaluation */
  double *sampled;      /* [ntracks][MEASURE_SAMPLES + 1] of the present part */
  double *firings;      /* [nev] so far */
  int exponent, megno;  /* 1: an expression contains the Lyapunov exponent, or MEGNO, */
  char no_exponent[200]; /* and why the last run has none */
  int status;           /* of the run under way, as lag_measures_advance returned it last */
  lag_sim *sim;         /* the run under way */
  double t0, t;         /* its start; time of the present evaluation */
  Happening last;       /* its last event, with its time */
  double last_time;
  lag_event_fn *on_event; /* the caller's hook */
  void *on_event_context;
};

/* measure_text.c: reads measure k; m->root[k], m->unit[k] := its node and unit. 0, or -1 after a message in why. */
int lag_measure_read(Measures *m, int k, const char *text, char *why, size_t size);

/* measure_run.c: the expression of a node at the state y[n] and time t; m->y := y. */
double lag_measure_at(Measures *m, int node, double t, const double *y);

/* measure_run.c: the end of the part of [a, reach] in which each track is in its window, or out of it. */
double lag_measure_part(const Measures *m, double a, double reach);

/* measure_run.c: the end of a part of [a, reach], within a step, in which no mean has a corner or a jump; `last`:
 * length of the part before, 0: none. */
double lag_measure_smooth(Measures *m, double a, double reach, double last);

/* measure_run.c: the places of a quadrature over [a, b], a part of a step: their number; place j with its weight. */
int lag_measure_places(const Measures *m);
double lag_measure_place(const Measures *m, int j, double a, double b, double *weight);

/* Whether a track counts at time t, which is not an edge of its window. */
static inline int lag_track_counts(const Track *k, double t) { return !(t < k->from) && !(t > k->to); }

/* measure_lyapunov.c: the largest exponent, or MEGNO, of a run that has come to `until`; NaN with the reason in
 * m->no_exponent. */
double lag_measure_lyapunov(Measures *m, const lag_sim *first, double until, MeasureKind kind);
