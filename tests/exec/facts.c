/* Checks what is known of a model (models/NAME.facts) against its emitted C and liblag. Prints TAP.
 *   facts MODEL FILE     linked with `const lag_scene *const facts_scenes[]`, NULL at the end
 *
 * A line of a .facts file is a comment (#), an abbreviation `let NAME = EXPRESSION`, or a fact in four columns
 *   SCENE [name=value | --tol X | --until T | --method NAME]... | LEFT = RIGHT | TOLERANCE [rel] | why it holds
 * The first column is what one types after `lagc run MODEL`. Both sides are measures (tests/measure_words.h) in SI
 * units, angles in radians: th(2) at a time, also after the end of the run; max(x), period(x), hit(NAME, 3), ...; pi
 * deg au day; and the functions of the table `functions` below. The fact holds when |LEFT - RIGHT| <= TOLERANCE
 * (rel: times |RIGHT|). Successive facts with the same first column share one run. GSL evaluates the special
 * functions; without it (no -DFACTS_GSL) the facts that need them are skipped. */
#include <ctype.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "analysis/measure.h"

#include "../measure_words.h"
#ifdef FACTS_GSL
#include <gsl/gsl_errno.h>
#include <gsl/gsl_sf_elljac.h>
#include <gsl/gsl_sf_ellint.h>
#include <gsl/gsl_sf_lambert.h>
#endif

extern const lag_scene *const facts_scenes[];

enum { LINE = 1000, NAME = 64, MAX_LETS = 64, MAX_FACTS = 400 };

static const double PI = 3.14159265358979323846;

typedef struct {
  char line[LINE];
  char *columns[4], *right; /* parts of the line; columns[1]: the left side */
  int number;               /* in TAP */
  int holds, skipped;
  char why[LINE];           /* why it does not hold; or by how much it is off */
} Fact;

typedef struct {
  char name[NAME], text[LINE];
} Let;

static Let lets[MAX_LETS] = {{"au", "149597870700"}, {"day", "86400"}}; /* au: IAU 2012, resolution B2 */
static int nlets = 2, nfacts, missing; /* missing: a function without GSL was called */
static Fact facts[MAX_FACTS];

/* ---- Functions -------------------------------------------------------------------------------- */

static double f_kepler(double mean, double e) { /* E of E - e sin E = mean, by Newton from pi: monotone */
  double turns = floor(mean/(2*PI)), m = mean - 2*PI*turns, x = PI;
  for (int i = 0; i < 100; i++) x -= (x - e*sin(x) - m)/(1 - e*cos(x));
  return x + 2*PI*turns;
}

#ifdef FACTS_GSL
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
static double f_K(double k) { return missing = 1, NAN*k; }
static double f_sn(double u, double k) { return missing = 1, NAN*u*k; }
static double f_cn(double u, double k) { return missing = 1, NAN*u*k; }
static double f_dn(double u, double k) { return missing = 1, NAN*u*k; }
static double f_lambert(double x) { return missing = 1, NAN*x; }
#endif

static const MeasureFunction functions[] = {
  {"kepler", NULL, f_kepler},                      /* eccentric from mean anomaly and eccentricity */
  {"K", f_K, NULL},                                /* complete elliptic integral of modulus k */
  {"sn", NULL, f_sn}, {"cn", NULL, f_cn}, {"dn", NULL, f_dn}, /* Jacobi, of u and modulus k */
  {"lambert", f_lambert, NULL},                    /* W0 */
};

/* ---- Runs ------------------------------------------------------------------------------------- */

__attribute__((format(printf, 3, 4))) static int fail(char *why, int rc, const char *fmt, ...) {
  va_list ap;
  va_start(ap, fmt);
  vsnprintf(why, LINE, fmt, ap);
  va_end(ap);
  return rc;
}

static char *trim(char *s) {
  while (isspace((unsigned char)*s)) s++;
  for (size_t n = strlen(s); n && isspace((unsigned char)s[n - 1]); n--) s[n - 1] = '\0';
  return s;
}

static int number(const char *text, double *x, char *why) {
  char *end = NULL;
  *x = text ? strtod(text, &end) : NAN;
  return !text || *end || end == text ? fail(why, -1, "`%s` is not a number", text ? text : "") : 0;
}

/* Applies the words of a first column to sim. 0, or -1 after a message. */
static int set_up(lag_sim *sim, char *words, double *until, char *why) {
  *until = lag_sim_scene(sim)->t1;
  for (char *w = strtok(words, " \t"); w; w = strtok(NULL, " \t")) {
    char *equals = strchr(w, '=');
    int status = LAG_OK;
    double x = 0;
    if (strcmp(w, "--method") == 0) {
      const lag_method *m = lag_find_method(strtok(NULL, " \t"));
      status = m ? lag_sim_set_method(sim, m, NULL, 0) : LAG_EINVAL;
    } else if (*w != '-' && !equals) {
      return fail(why, -1, "`%s` is no setting", w);
    } else {
      if (equals) *equals = '\0';
      if (number(equals ? equals + 1 : strtok(NULL, " \t"), &x, why)) return -1;
      if (strcmp(w, "--until") == 0) *until = x;
      else status = strcmp(w, "--tol") == 0 ? lag_sim_set_tolerance(sim, x) : lag_sim_set(sim, w, x);
    }
    if (status != LAG_OK) return fail(why, -1, "%s: %s", w, lag_sim_message(sim));
  }
  return 0;
}

static const char *text_of_let(const char *name) {
  for (int i = 0; i < nlets; i++)
    if (strcmp(lets[i].name, name) == 0) return lets[i].text;
  return NULL;
}

static Measures *compile(const lag_scene *scene, int n, const char *const *text, char *why) {
  static const MeasureDialect extended = {
      .past_end = 1, .nfunctions = sizeof functions / sizeof *functions, .functions = functions};
  enum { WORDS = 12*LINE }; /* names of lets are expanded */
  static char words[2*MAX_FACTS][WORDS];
  static const char *all[2*MAX_FACTS];
  for (int i = 0; i < n; i++) {
    if (!measure_words(text[i], text_of_let, words[i], WORDS)) return fail(why, 0, "`%s` is no measure", text[i]), NULL;
    all[i] = words[i];
  }
  return lag_measures_new(scene, n, all, &extended, why, LINE);
}

/* ---- Facts ------------------------------------------------------------------------------------ */

/* Compares the sides of a fact. */
static void compare(Fact *f, double left, double right, const char *why_left, const char *why_right) {
  char *end;
  double tol = strtod(f->columns[2], &end), error = fabs(left - right);
  end = trim(end);
  double allowed = *end ? tol*fabs(right) : tol;
  if (!(tol > 0) || (*end && strcmp(end, "rel") != 0))
    fail(f->why, 0, "a tolerance is a number > 0, and `rel` after it or nothing");
  else if (!(error <= allowed))
    fail(f->why, 0, "%.17g and %.17g differ by %.3g, more than %.3g %s %s", left, right, error, allowed, why_left,
         why_right);
  else f->holds = 1, fail(f->why, 0, " (off by %.1e, allowed %.1e)", error, allowed);
  f->skipped = missing && (isnan(left) || isnan(right));
}

/* Judges n facts with the same first column by one run. Those with why are wrong already. */
static void judge(Fact *f, int n) {
  static double value[2*MAX_FACTS];
  static const char *text[2*MAX_FACTS];
  char *name = strtok(strcpy((char[LINE]){0}, f->columns[0]), " \t"), words[LINE], why[LINE] = "", failed[LINE] = "";
  const lag_scene *scene = NULL;
  int taken = 0;
  double until;
  for (const lag_scene *const *s = facts_scenes; *s; s++)
    if (name && strcmp((*s)->name, name) == 0) scene = *s;
  for (int i = 0; i < n; i++) {
    const char *sides[] = {f[i].columns[1], f[i].right};
    Measures *alone = NULL;
    if (!scene) fail(f[i].why, 0, "no scene `%s`", name ? name : "");
    else if (!f[i].why[0]) alone = compile(scene, 2, sides, f[i].why);
    if (alone) text[taken++] = sides[0], text[taken++] = sides[1];
    lag_measures_free(alone);
  }
  if (!taken) return;
  lag_sim *sim = lag_sim_new(scene);
  Measures *m = compile(scene, taken, text, why);
  snprintf(words, sizeof words, "%s", f->columns[0] + strlen(name));
  if (sim && m && set_up(sim, words, &until, why) == 0 && lag_measures_run(m, sim, until, value) < 0)
    fail(failed, 0, "the run failed: %s", lag_sim_message(sim)); /* values at times before that are known */
  for (int i = 0, k = 0; i < n; i++) {
    if (f[i].why[0]) continue;
    if (why[0]) strcpy(f[i].why, why);
    else
      compare(&f[i], value[k], value[k + 1], lag_measures_why(m, k), failed[0] ? failed : lag_measures_why(m, k + 1));
    k += 2;
  }
  lag_measures_free(m);
  lag_sim_free(sim);
}

/* Splits a line into a fact. */
static void take_fact(const char *line) {
  Fact *f = &facts[nfacts++];
  int k = 1;
  snprintf(f->line, sizeof f->line, "%s", line);
  f->number = nfacts;
  for (int i = 0; i < 4; i++) f->columns[i] = f->line + strlen(f->line);
  f->columns[0] = f->line;
  for (char *bar = strchr(f->line, '|'); bar && k < 4; bar = strchr(f->columns[k - 1], '|'))
    *bar = '\0', f->columns[k++] = bar + 1;
  for (int i = 0; i < 4; i++) f->columns[i] = trim(f->columns[i]);
  f->right = strchr(f->columns[1], '=');
  if (k < 4) fail(f->why, 0, "it has %d columns of 4", k);
  else if (!f->right) fail(f->why, 0, "`%s`: LEFT = RIGHT", f->columns[1]);
  else if (!*f->columns[3]) fail(f->why, 0, "the fourth column says why it holds");
  if (f->right) *f->right++ = '\0';
}

static void take_let(char *line) {
  char *equals = strchr(line, '=');
  if (!equals || nlets == MAX_LETS) {
    printf("Bail out! wrong or too many: let %s\n", line);
    exit(2);
  }
  *equals = '\0';
  snprintf(lets[nlets].name, NAME, "%s", trim(line));
  snprintf(lets[nlets++].text, LINE, "%s", trim(equals + 1));
}

int main(int argc, char **argv) {
  FILE *in = argc == 3 ? fopen(argv[2], "r") : NULL;
  char line[LINE];
  int failed = 0;
#ifdef FACTS_GSL
  gsl_set_error_handler_off();
#endif
  if (!in) {
    fprintf(stderr, "usage: facts MODEL FILE\n");
    return 2;
  }
  while (fgets(line, sizeof line, in) && nfacts < MAX_FACTS) {
    char *text = trim(line);
    if (strncmp(text, "let ", 4) == 0) take_let(text + 4);
    else if (*text && *text != '#') take_fact(text);
  }
  fclose(in);
  for (int i = 0, n; i < nfacts; i += n) {
    for (n = 1; i + n < nfacts && strcmp(facts[i + n].columns[0], facts[i].columns[0]) == 0;) n++;
    judge(&facts[i], n);
    for (const Fact *f = &facts[i]; f < &facts[i + n]; f++) {
      failed += !f->holds && !f->skipped;
      printf("%s %d - %s %s: %s = %s%s\n", f->holds || f->skipped ? "ok" : "not ok", f->number, argv[1], f->columns[0],
             f->columns[1], f->right ? f->right : "",
             f->skipped ? " # SKIP needs GSL"
             : f->holds ? f->why
                        : "");
      if (!f->holds && !f->skipped) printf("# %s\n# it should hold: %s\n", f->why, f->columns[3]);
    }
  }
  printf("1..%d\n", nfacts);
  return failed != 0;
}
