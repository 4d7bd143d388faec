/* Checks what is known of a model (models/NAME.facts) against its emitted C and liblag. Prints TAP.
 *   facts MODEL FILE     linked with `const lag_scene *const facts_scenes[]`, NULL at the end
 *
 * A line of a .facts file is a comment (#), an abbreviation `let NAME = EXPRESSION`, or a fact in four columns
 *   SCENE [name=value | --tol X | --until T | --method NAME]... | LEFT = RIGHT | TOLERANCE [rel] | why it holds
 * The first column is what one types after `lagc run MODEL`. Both sides are expressions in SI units (angles in
 * radians) of numbers, parameters, + - * / ^, and
 *   th(2), th'(2)      an output, coordinate, velocity or state at a time        end        when the run ends
 *   period(x)          between its upward passages of zero, their mean           hit(NAME), hit(NAME, 3)  first, third time of an event
 *   max(x), min(x)     over the run      drift(x)   the largest |x(t) - x(0)|
 *   pi deg au day      and the functions of the table FUNCTIONS below.
 * The fact holds when |LEFT - RIGHT| <= TOLERANCE (rel: times |RIGHT|). GSL evaluates the special functions;
 * without it (no -DFACTS_GSL) the facts that need them are skipped. */
#include <ctype.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "lag.h"
#ifdef FACTS_GSL
#include <gsl/gsl_errno.h>
#include <gsl/gsl_sf_elljac.h>
#include <gsl/gsl_sf_ellint.h>
#include <gsl/gsl_sf_lambert.h>
#endif

extern const lag_scene *const facts_scenes[];

enum { LINE = 1000, NAME = 64, MAX_LETS = 64, MAX_DEPTH = 50, SAMPLES = 4000, MAX_EVENTS = 16 };

static const double PI = 3.14159265358979323846;

/* One fact while it is evaluated. */
typedef struct {
  const lag_scene *scene;
  char settings[LINE]; /* the first column without the scene */
  double until;
  double hit[MAX_EVENTS]; /* of each event in the last run: when it happened the nth time; NaN */
  int hits[MAX_EVENTS];   /* how often it happened */
  int nth;
  const char *at;      /* the next character of the expression */
  int depth;
  int skip;            /* a function is missing */
  jmp_buf wrong;
  char why[LINE];
} Fact;

typedef struct {
  char name[NAME], text[LINE];
} Let;

static Let lets[MAX_LETS];
static int nlets;

__attribute__((noreturn, format(printf, 2, 3))) static void fail(Fact *f, const char *fmt, ...) {
  va_list ap;
  va_start(ap, fmt);
  vsnprintf(f->why, sizeof f->why, fmt, ap);
  va_end(ap);
  longjmp(f->wrong, 1);
}

/* ---- Runs ------------------------------------------------------------------------------------- */

static void set_method(Fact *f, lag_sim *sim, const char *name) {
  for (int i = 0; i < lag_nmethods; i++)
    if (strcmp(lag_methods[i]->name, name) == 0 && lag_sim_set_method(sim, lag_methods[i], NULL, 0) == LAG_OK) return;
  fail(f, "no method %s", name);
}

static double number(Fact *f, const char *text) {
  char *end;
  double x = text ? strtod(text, &end) : NAN;
  if (!text || *end || end == text) fail(f, "`%s` is not a number", text ? text : "");
  return x;
}

/* The scene with the fact's settings, at its start. */
static lag_sim *open_run(Fact *f) {
  lag_sim *sim = lag_sim_new(f->scene);
  if (!sim) fail(f, "no simulation");
  char words[LINE];
  snprintf(words, sizeof words, "%s", f->settings);
  f->until = f->scene->t1;
  for (char *w = strtok(words, " \t"); w; w = strtok(NULL, " \t")) {
    char *equals = strchr(w, '=');
    int status = LAG_OK;
    if (strcmp(w, "--tol") == 0) status = lag_sim_set_tolerance(sim, number(f, strtok(NULL, " \t")));
    else if (strcmp(w, "--until") == 0) f->until = number(f, strtok(NULL, " \t"));
    else if (strcmp(w, "--method") == 0) set_method(f, sim, strtok(NULL, " \t"));
    else if (!equals) fail(f, "`%s` is no setting", w);
    else {
      *equals = '\0';
      status = lag_sim_set(sim, w, number(f, equals + 1));
    }
    if (status != LAG_OK) fail(f, "%s", lag_sim_message(sim));
  }
  return sim;
}

static void note_hit(void *context, int k, double t, const double *before, const double *after) {
  (void)before, (void)after;
  Fact *f = context;
  if (k < MAX_EVENTS && ++f->hits[k] == f->nth) f->hit[k] = t;
}

/* Integrates to t, or to where an event stops the run. 1: stopped before t. */
static int go(Fact *f, lag_sim *sim, double t) {
  int status = lag_sim_advance(sim, t); /* to the start itself: only then is there a state */
  if (status < 0) fail(f, "the run failed: %s", lag_sim_message(sim));
  return status == LAG_STOPPED;
}

/* The quantity `name` now, in SI. 0: there is none of that name. */
static int quantity(lag_sim *sim, const char *name, double *x) {
  const lag_model *m = lag_sim_scene(sim)->model;
  size_t n = strlen(name);
  for (int i = 0; i < m->nq; i++) {
    size_t k = strlen(m->q[i].name);
    if (strncmp(m->q[i].name, name, k) == 0 && (n == k || (n == k + 1 && name[k] == '\''))) {
      *x = n == k ? lag_sim_q(sim)[i] : lag_sim_v(sim)[i];
      return 1;
    }
  }
  for (int i = 0; i < m->nz; i++)
    if (strcmp(m->z[i].name, name) == 0) {
      *x = lag_sim_z(sim)[i];
      return 1;
    }
  double out[64];
  char label[NAME];
  if (lag_sim_noutputs(sim) > 64) return 0;
  for (int i = 0; i < lag_sim_noutputs(sim); i++) {
    double factor = lag_sim_output_info(sim, i, label, sizeof label, NULL, 0);
    if (strcmp(label, name) != 0) continue;
    if (lag_sim_outputs(sim, out) != LAG_OK) return 0;
    *x = out[i]*factor;
    return 1;
  }
  return 0;
}

static int is_quantity(Fact *f, const char *name) {
  double x;
  lag_sim *sim = open_run(f);
  int is = quantity(sim, name, &x);
  lag_sim_free(sim);
  return is;
}

static double value_now(Fact *f, lag_sim *sim, const char *name) {
  double x = NAN;
  if (!quantity(sim, name, &x)) fail(f, "no output, coordinate or state is called `%s`", name);
  return x;
}

/* The last run that was asked for a value, and where it stands: facts of one scene, sorted by time, share one integration. */
static struct {
  lag_sim *sim;
  const lag_scene *scene;
  char settings[LINE];
  double t; /* what was asked for last */
} kept;

/* That run at t; a new one where the settings are others or it is already past t. */
static lag_sim *run_to(Fact *f, double t) {
  int same = kept.sim && kept.scene == f->scene && strcmp(kept.settings, f->settings) == 0;
  if (!same || t < kept.t) {
    lag_sim_free(kept.sim);
    kept.sim = NULL;
    kept.sim = open_run(f);
    kept.scene = f->scene;
    snprintf(kept.settings, sizeof kept.settings, "%s", f->settings);
  }
  kept.t = INFINITY; /* what follows may leave this function by fail() */
  go(f, kept.sim, t);
  if (fabs(lag_sim_time(kept.sim) - t) > 1e-9*fabs(t)) fail(f, "the run ended at %g, before %g", lag_sim_time(kept.sim), t);
  kept.t = t;
  return kept.sim;
}

static double value_at(Fact *f, const char *name, double t) {
  return value_now(f, run_to(f, t), name);
}

static double end_time(Fact *f) {
  for (int k = 0; k < MAX_EVENTS; k++) f->hit[k] = NAN, f->hits[k] = 0;
  lag_sim *sim = open_run(f);
  lag_sim_on_event(sim, note_hit, f);
  go(f, sim, f->until);
  double t = lag_sim_time(sim);
  lag_sim_free(sim);
  return t;
}

static double hit_time(Fact *f, const char *name, double n) {
  f->nth = (int)n;
  end_time(f);
  const lag_model *m = f->scene->model;
  for (int k = 0; k < m->nev && k < MAX_EVENTS; k++)
    if (strcmp(m->ev[k].name, name) == 0) return f->hit[k];
  fail(f, "no event is called `%s`", name);
}

/* x[SAMPLES + 1] at equal intervals of time. Returns the interval. */
static double sample(Fact *f, const char *name, double *x) {
  lag_sim *sim = open_run(f);
  double end = f->scene->model->nev ? end_time(f) : f->until; /* without events nothing ends a run early */
  double t0 = lag_sim_time(sim), dt = (end - t0)/SAMPLES;
  for (int i = 0; i <= SAMPLES; i++) {
    go(f, sim, i == SAMPLES ? end : t0 + i*dt);
    x[i] = value_now(f, sim, name);
  }
  lag_sim_free(sim);
  return dt;
}

static double drift(Fact *f, const char *name) {
  static double x[SAMPLES + 1];
  sample(f, name, x);
  double worst = 0;
  for (int i = 1; i <= SAMPLES; i++) worst = fabs(x[i] - x[0]) > worst || isnan(x[i]) ? fabs(x[i] - x[0]) : worst;
  return worst;
}

/* Where it passes zero between a and b, where it is fa and fb: false position (Illinois). */
static double zero_between(Fact *f, const char *name, double a, double fa, double b, double fb) {
  for (int i = 0; i < 60 && fabs(b - a) > 1e-15*fabs(b); i++) {
    double c = b - fb*(b - a)/(fb - fa), fc = value_at(f, name, c);
    if (fc == 0) return c;
    if ((fc > 0) == (fb > 0)) fa /= 2;
    else a = b, fa = fb;
    b = c, fb = fc;
    if (fabs(fc) < 1e-15) break;
  }
  return b;
}

static double period(Fact *f, const char *name) {
  static double x[SAMPLES + 1];
  double t0 = f->scene->t0, dt = sample(f, name, x);
  int first = -1, last = -1, count = 0;
  for (int i = 0; i < SAMPLES; i++)
    if (x[i] < 0 && x[i + 1] >= 0) {
      if (first < 0) first = i;
      last = i;
      count++;
    }
  if (count < 2) fail(f, "`%s` passes zero upwards %d times: no period", name, count);
  double a = zero_between(f, name, t0 + first*dt, x[first], t0 + (first + 1)*dt, x[first + 1]);
  double b = zero_between(f, name, t0 + last*dt, x[last], t0 + (last + 1)*dt, x[last + 1]);
  return (b - a)/(count - 1);
}

/* The largest of sign*x: the best sample, then golden sections around it. */
static double extremum(Fact *f, const char *name, double sign) {
  static double x[SAMPLES + 1];
  double t0 = f->scene->t0, dt = sample(f, name, x), g = (sqrt(5) - 1)/2;
  int best = 0;
  for (int i = 1; i <= SAMPLES; i++)
    if (sign*x[i] > sign*x[best]) best = i;
  int left = best > 0 ? best - 1 : 0, right = best < SAMPLES ? best + 1 : SAMPLES;
  /* Of a parabola, the top stands above its best sample by less than its neighbours stand below: here that is rounding. */
  if (fabs(x[best] - x[left]) + fabs(x[best] - x[right]) < 1e-15*fmax(1, fabs(x[best]))) return x[best];
  double a = t0 + left*dt, b = t0 + right*dt;
  double c = b - g*(b - a), d = a + g*(b - a), fc = value_at(f, name, c), fd = value_at(f, name, d);
  while (b - a > 1e-7*dt + 1e-13*fabs(b)) {
    if (sign*fc > sign*fd) b = d, d = c, fd = fc, c = b - g*(b - a), fc = value_at(f, name, c);
    else a = c, c = d, fc = fd, d = a + g*(b - a), fd = value_at(f, name, d);
  }
  double inside = value_at(f, name, (a + b)/2);
  return sign*inside > sign*x[best] ? inside : x[best];
}

/* ---- Functions -------------------------------------------------------------------------------- */

static double f_kepler(double mean, double e) { /* E of E - e sin E = mean, by Newton from pi: monotone */
  double turns = floor(mean/(2*PI)), m = mean - 2*PI*turns, x = PI;
  for (int i = 0; i < 100; i++) x -= (x - e*sin(x) - m)/(1 - e*cos(x));
  return x + 2*PI*turns;
}

#ifdef FACTS_GSL
enum { HAVE_GSL = 1 };
static double f_K(double k) { return gsl_sf_ellint_Kcomp(k, GSL_PREC_DOUBLE); }
static double jacobi(double u, double k, int which) {
  double s[3];
  return gsl_sf_elljac_e(u, k*k, &s[0], &s[1], &s[2]) == GSL_SUCCESS ? s[which] : NAN;
}
static double f_sn(double u, double k) { return jacobi(u, k, 0); }
static double f_cn(double u, double k) { return jacobi(u, k, 1); }
static double f_dn(double u, double k) { return jacobi(u, k, 2); }
static double f_lambert(double x) { return gsl_sf_lambert_W0(x); }
#else
enum { HAVE_GSL = 0 };
static double f_K(double k) { return NAN*k; }
static double f_sn(double u, double k) { return NAN*u*k; }
static double f_cn(double u, double k) { return NAN*u*k; }
static double f_dn(double u, double k) { return NAN*u*k; }
static double f_lambert(double x) { return NAN*x; }
#endif

static const struct {
  const char *name;
  double (*one)(double);
  double (*two)(double, double);
  int gsl;
} FUNCTIONS[] = {
  {"sin", sin, NULL, 0},   {"cos", cos, NULL, 0},   {"tan", tan, NULL, 0},    {"asin", asin, NULL, 0},
  {"acos", acos, NULL, 0}, {"atan", atan, NULL, 0}, {"sqrt", sqrt, NULL, 0},  {"exp", exp, NULL, 0},
  {"log", log, NULL, 0},   {"abs", fabs, NULL, 0},  {"atan2", NULL, atan2, 0},
  {"kepler", NULL, f_kepler, 0},                    /* eccentric from mean anomaly and eccentricity */
  {"K", f_K, NULL, 1},                              /* complete elliptic integral of modulus k */
  {"sn", NULL, f_sn, 1},   {"cn", NULL, f_cn, 1},   {"dn", NULL, f_dn, 1},    /* Jacobi, of u and modulus k */
  {"lambert", f_lambert, NULL, 1},                  /* W0 */
};

/* ---- Expressions ------------------------------------------------------------------------------ */

static double sum(Fact *f);

static void blanks(Fact *f) {
  while (isspace((unsigned char)*f->at)) f->at++;
}

static int take(Fact *f, char c) {
  blanks(f);
  if (*f->at != c) return 0;
  f->at++;
  return 1;
}

static void need(Fact *f, char c) {
  if (!take(f, c)) fail(f, "expected `%c` before `%s`", c, f->at);
}

/* The characters of [2] and [2,1]. */
static int index_character(const char *name, int n, char c) {
  int open = 0;
  for (int i = 0; i < n; i++) open += (name[i] == '[') - (name[i] == ']');
  return c == '[' || (open && (isdigit((unsigned char)c) || c == ',' || c == ']'));
}

/* A name with its indices, dots and primes. */
static void word(Fact *f, char name[NAME]) {
  int n = 0;
  blanks(f);
  while (isalnum((unsigned char)*f->at) || *f->at == '_' || *f->at == '.' || *f->at == '\'' || (unsigned char)*f->at >= 0x80 ||
         index_character(name, n, *f->at)) {
    if (n == NAME - 1) fail(f, "a name is too long");
    name[n++] = *f->at++;
  }
  name[n] = '\0';
  if (!n) fail(f, "expected a name before `%s`", f->at);
}

static double parameter(Fact *f, const char *name) {
  const lag_model *m = f->scene->model;
  lag_sim *sim = open_run(f);
  go(f, sim, lag_sim_time(sim));
  double x = NAN;
  int found = 0;
  for (int i = 0; i < m->np && !found; i++)
    if (strcmp(m->p[i].name, name) == 0) x = lag_sim_p(sim)[i], found = 1;
  lag_sim_free(sim);
  if (!found) fail(f, "unknown name `%s`", name);
  return x;
}

static double of_let(Fact *f, const Let *l) {
  const char *back = f->at;
  if (++f->depth > MAX_DEPTH) fail(f, "`%s` needs itself", l->name);
  f->at = l->text;
  double x = sum(f);
  blanks(f);
  if (*f->at) fail(f, "`let %s`: `%s` is too much", l->name, f->at);
  f->depth--;
  f->at = back;
  return x;
}

static double plain_name(Fact *f, const char *name) {
  if (strcmp(name, "end") == 0) return end_time(f);
  if (strcmp(name, "pi") == 0) return PI;
  if (strcmp(name, "deg") == 0) return PI/180;
  if (strcmp(name, "au") == 0) return 149597870700; /* IAU 2012, resolution B2 */
  if (strcmp(name, "day") == 0) return 86400;
  for (int i = 0; i < nlets; i++)
    if (strcmp(lets[i].name, name) == 0) return of_let(f, &lets[i]);
  return parameter(f, name);
}

/* period(x), max(x), ...: 0 when `name` is none of these. */
static int of_trajectory(Fact *f, const char *name, double *x) {
  static const char *const words[] = {"period", "drift", "max", "min", "hit"};
  int which = -1;
  char arg[NAME];
  for (int i = 0; i < 5; i++)
    if (strcmp(name, words[i]) == 0) which = i;
  if (which < 0) return 0;
  word(f, arg);
  double n = which == 4 && take(f, ',') ? sum(f) : 1;
  need(f, ')');
  switch (which) {
    case 0: *x = period(f, arg); break;
    case 1: *x = drift(f, arg); break;
    case 2: *x = extremum(f, arg, 1); break;
    case 3: *x = extremum(f, arg, -1); break;
    default: *x = hit_time(f, arg, n); break;
  }
  return 1;
}

static double call(Fact *f, const char *name) {
  double x;
  if (of_trajectory(f, name, &x)) return x;
  double a = sum(f), b = 0;
  int two = take(f, ',');
  if (two) b = sum(f);
  need(f, ')');
  if (!two && is_quantity(f, name)) return value_at(f, name, a);
  for (size_t i = 0; i < sizeof FUNCTIONS/sizeof FUNCTIONS[0]; i++) {
    if (strcmp(FUNCTIONS[i].name, name) != 0 || two != (FUNCTIONS[i].two != NULL)) continue;
    if (FUNCTIONS[i].gsl && !HAVE_GSL) f->skip = 1;
    return two ? FUNCTIONS[i].two(a, b) : FUNCTIONS[i].one(a);
  }
  fail(f, "no function or output is called `%s`", name);
}

static double primary(Fact *f) {
  blanks(f);
  if (isdigit((unsigned char)*f->at) || *f->at == '.') {
    char *end;
    double x = strtod(f->at, &end);
    f->at = end;
    return x;
  }
  if (take(f, '(')) {
    double x = sum(f);
    need(f, ')');
    return x;
  }
  char name[NAME];
  word(f, name);
  return *f->at == '(' ? (f->at++, call(f, name)) : plain_name(f, name);
}

static double signed_power(Fact *f) {
  if (take(f, '-')) return -signed_power(f);
  double x = primary(f);
  return take(f, '^') ? pow(x, signed_power(f)) : x;
}

static double product(Fact *f) {
  double x = signed_power(f);
  for (;;) {
    if (take(f, '*')) x *= signed_power(f);
    else if (take(f, '/')) x /= signed_power(f);
    else return x;
  }
}

static double sum(Fact *f) {
  if (++f->depth > MAX_DEPTH) fail(f, "too deep");
  double x = product(f);
  for (;;) {
    if (take(f, '+')) x += product(f);
    else if (take(f, '-')) x -= product(f);
    else break;
  }
  f->depth--;
  return x;
}

/* ---- Lines ------------------------------------------------------------------------------------ */

static char *trim(char *s) {
  while (isspace((unsigned char)*s)) s++;
  for (size_t n = strlen(s); n && isspace((unsigned char)s[n - 1]); n--) s[n - 1] = '\0';
  return s;
}

static void take_let(char *line) {
  char *equals = strchr(line, '=');
  if (!equals || nlets == MAX_LETS) {
    printf("Bail out! wrong or too many: let %s\n", line);
    exit(2);
  }
  *equals = '\0';
  snprintf(lets[nlets].name, NAME, "%s", trim(line));
  snprintf(lets[nlets].text, LINE, "%s", trim(equals + 1));
  nlets++;
}

static void choose_scene(Fact *f, char *column) {
  char *name = trim(column), *rest = name + strcspn(name, " \t");
  if (*rest) *rest++ = '\0';
  snprintf(f->settings, sizeof f->settings, "%s", rest);
  for (const lag_scene *const *s = facts_scenes; *s; s++)
    if (strcmp((*s)->name, name) == 0) f->scene = *s;
  if (!f->scene) fail(f, "no scene `%s`", name);
}

/* The error and what is allowed, from the columns; or a jump to f->wrong. */
static void check(Fact *f, char *columns[4], double *error, double *allowed) {
  choose_scene(f, columns[0]);
  f->at = columns[1];
  double left = sum(f);
  need(f, '=');
  double right = sum(f);
  if (*f->at) fail(f, "`%s` is too much", f->at);
  char *end;
  double tol = strtod(columns[2], &end);
  end = trim(end);
  if (!(tol > 0) || (*end && strcmp(end, "rel") != 0)) fail(f, "a tolerance is a number > 0, and `rel` after it or nothing");
  *error = fabs(left - right);
  *allowed = *end ? tol*fabs(right) : tol;
  if (!(*error <= *allowed)) fail(f, "%.17g and %.17g differ by %.3g, more than %.3g", left, right, *error, *allowed);
}

/* 1: the fact holds. */
static int fact_line(char *line, const char *model, int n) {
  char *columns[4] = {line};
  int k = 1;
  for (char *bar = strchr(line, '|'); bar && k < 4; bar = strchr(columns[k - 1], '|')) *bar = '\0', columns[k++] = bar + 1;
  if (k < 4) {
    printf("not ok %d - %s: `%s` has %d columns of 4\n", n, model, line, k);
    return 0;
  }
  for (int i = 0; i < 4; i++) columns[i] = trim(columns[i]);
  char what[LINE];
  snprintf(what, sizeof what, "%s %s: %s", model, columns[0], columns[1]);
  Fact f = {.scene = NULL};
  double error = 0, allowed = 0;
  if (setjmp(f.wrong)) {
    if (f.skip) return printf("ok %d - %s # SKIP needs GSL\n", n, what), 1;
    printf("not ok %d - %s\n# %s\n# it should hold: %s\n", n, what, f.why, columns[3]);
    return 0;
  }
  if (!*columns[3]) fail(&f, "the fourth column says why it holds");
  check(&f, columns, &error, &allowed);
  printf("ok %d - %s (off by %.1e, allowed %.1e)\n", n, what, error, allowed);
  return 1;
}

int main(int argc, char **argv) {
  FILE *in = argc == 3 ? fopen(argv[2], "r") : NULL;
  char line[LINE];
  int n = 0, failed = 0;
#ifdef FACTS_GSL
  gsl_set_error_handler_off();
#endif
  if (!in) {
    fprintf(stderr, "usage: facts MODEL FILE\n");
    return 2;
  }
  while (fgets(line, sizeof line, in)) {
    char *text = trim(line);
    if (!*text || *text == '#') continue;
    if (strncmp(text, "let ", 4) == 0) take_let(text + 4);
    else failed += !fact_line(text, argv[1], ++n);
  }
  fclose(in);
  printf("1..%d\n", n);
  return failed != 0;
}
