/* The runs of a sweep (sweep_grid.h): a grid of all combinations, the last range fastest, and at each of its places
 * the same samples. */
#include "sweep/sweep_grid.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "sweep/sampling.h"

#define MOST_RUNS 1e12 /* a counter; the time is told before */

/* ---- Ranges as text */

int lag_plan_number(const char **s, double *x) {
  char *end;
  size_t length = strspn(*s += strspn(*s, " "), "+-.0123456789eE");
  char text[64];
  if (length == 0 || length >= sizeof text) return 0;
  memcpy(text, *s, length);
  text[length] = '\0';
  char *dots = strstr(text, ".."); /* "1..2" */
  if (dots) *dots = '\0';
  *x = strtod(text, &end);
  if (end == text || *end || !isfinite(*x)) return 0;
  *s += end - text;
  *s += strspn(*s, " ");
  return 1;
}

static int take(const char **s, const char *word) {
  size_t n = strlen(word);
  if (strncmp(*s, word, n) != 0) return 0;
  *s += n;
  *s += strspn(*s, " ");
  return 1;
}

int lag_plan_is_range(const char *word) {
  const char *eq = strchr(word, '='), *tilde = strchr(word, '~');
  if (tilde && (!eq || tilde < eq)) return 1;
  return eq && (strstr(eq, "..") || strchr(eq, ','));
}

static int refuse(char *why, size_t size, const char *word, const char *what) {
  const int most = 200; /* a list may be long, and the reason stands behind it */
  snprintf(why, size, "%.*s%s: %s", most, word, strlen(word) > (size_t)most ? "..." : "", what);
  return -1;
}

static int refuse_empty(char *why, size_t size, const char *word, const Factor *f) {
  char what[120];
  snprintf(what, sizeof what, "the range is empty: its first value, %g, is not below its last, %g", (double)f->a,
           (double)f->b);
  return refuse(why, size, word, what);
}

static const char range_form[] = "a range is FIRST..LAST:NUMBER, for example 0..1:11; with a unit 0..180[deg]:19",
                  list_form[] = "a list is numbers and commas, 1,2,5 or 0,90[deg]; a range is 0..1:11; values at "
                                "random are NAME~normal(MEAN, DEVIATION)";

/* "A..B", "A..B:N", "A..B:log:N" */
static int read_interval(Factor *f, const char *s, const char *word, char *why, size_t size) {
  double n = 0;
  f->kind = FACTOR_LINEAR;
  if (!lag_plan_number(&s, &f->a) || !take(&s, "..") || !lag_plan_number(&s, &f->b))
    return refuse(why, size, word, range_form);
  if (!*s) {
    f->kind = FACTOR_UNIFORM;
  } else {
    if (!take(&s, ":")) return refuse(why, size, word, range_form);
    if (take(&s, "log")) f->kind = FACTOR_LOG;
    if (f->kind == FACTOR_LOG && !take(&s, ":"))
      return refuse(why, size, word, "the number of values is missing, for example 1e-3..1e3:log:7");
    if (!lag_plan_number(&s, &n) || *s || n != floor(n) || n < 1)
      return refuse(
          why, size, word,
          "the number of values is a whole number above 0, as in 0..1:11, or, in equal ratios, 1..100:log:11");
    if (n > MOST_RUNS) return refuse(why, size, word, "a sweep has up to 1e12 runs: take fewer values");
    f->n = (long long)n;
    if (f->n == 1 && f->a != f->b) return refuse(why, size, word, "one value of a range: write the value alone");
  }
  if (f->b < f->a || (f->b == f->a && f->n != 1)) return refuse_empty(why, size, word, f);
  if (!isfinite(f->b - f->a)) return refuse(why, size, word, "the range is wider than the largest number");
  if (f->kind == FACTOR_LOG && !(f->a > 0))
    return refuse(why, size, word, "a range with equal ratios has positive ends");
  return 0;
}

int lag_factor_add(Factor *f, double x) {
  if ((f->n & (f->n - 1)) == 0) { /* 0 and powers of 2 */
    double *list = realloc(f->list, (size_t)(f->n ? 2 * f->n : 1) * sizeof *list);
    if (!list) return -1;
    f->list = list;
  }
  f->list[f->n++] = x;
  return 0;
}

static int read_list(Factor *f, const char *s, const char *word, char *why, size_t size) {
  double x;
  f->kind = FACTOR_LIST;
  do {
    if (!lag_plan_number(&s, &x)) return refuse(why, size, word, list_form);
    if (lag_factor_add(f, x)) return refuse(why, size, word, "out of memory");
  } while (take(&s, ","));
  return *s ? refuse(why, size, word, list_form) : 0;
}

static int read_distribution(Factor *f, const char *s, const char *word, char *why, size_t size) {
  int normal = take(&s, "normal"), ok = normal || take(&s, "uniform");
  f->kind = normal ? FACTOR_NORMAL : FACTOR_UNIFORM;
  ok = ok && take(&s, "(") && lag_plan_number(&s, &f->a) && take(&s, ",") && lag_plan_number(&s, &f->b) &&
       take(&s, ")") && !*s;
  if (!ok) return refuse(why, size, word, "a distribution is normal(MEAN, DEVIATION) or uniform(FIRST, LAST)");
  if (normal && !(f->b > 0)) return refuse(why, size, word, "the deviation is positive");
  if (!normal && !isfinite(f->b - f->a)) return refuse(why, size, word, "the range is wider than the largest number");
  if (!normal && !(f->b > f->a)) return refuse_empty(why, size, word, f);
  return 0;
}

/* A new factor with the name text[n]; NULL with the reason. */
static Factor *add_factor(SweepPlan *p, const char *text, size_t n, char *why, size_t size) {
  Factor f = {.n = 0}, *all;
  while (n && text[n - 1] == ' ') n--;
  if (n == 0 || n >= sizeof f.name) {
    refuse(why, size, text, "a name is missing, or too long");
    return NULL;
  }
  memcpy(f.name, text, n);
  for (int i = 0; i < p->n; i++)
    if (strcmp(p->factor[i].name, f.name) == 0) {
      snprintf(why, size, "%s varies twice", f.name);
      return NULL;
    }
  all = realloc(p->factor, (size_t)(p->n + 1) * sizeof *all);
  if (!all) {
    snprintf(why, size, "out of memory");
    return NULL;
  }
  p->factor = all;
  p->factor[p->n] = f;
  return &p->factor[p->n++];
}

int lag_plan_add_column(SweepPlan *p, const char *name, const char *unit, char *why, size_t size) {
  Factor *f = add_factor(p, name, strlen(name), why, size);
  if (!f) return -1;
  f->kind = FACTOR_LIST;
  snprintf(f->unit, sizeof f->unit, "%s", unit);
  return 0;
}

int lag_plan_add(SweepPlan *p, const char *word, char *why, size_t size) {
  const char *mark = word + strcspn(word, "=~");
  Factor *f = add_factor(p, word, (size_t)(mark - word), why, size);
  if (!f) return -1;
  if (*mark == '~') return read_distribution(f, mark + 1 + strspn(mark + 1, " "), word, why, size);
  return strstr(mark, "..") ? read_interval(f, mark + 1, word, why, size) : read_list(f, mark + 1, word, why, size);
}

/* ---- Runs */

static int count_grid(SweepPlan *p, char *why, size_t size) {
  double all = 1;
  p->grid = 1;
  for (int k = 0, first = -1; k < p->n; k++) {
    const Factor *f = &p->factor[k];
    if (!f->n) continue;
    if (p->zip && first >= 0 && f->n != p->factor[first].n) {
      snprintf(why, size, "--zip: %s has %lld values, %s %lld; ranges that are walked together have the same number",
               p->factor[first].name, p->factor[first].n, f->name, f->n);
      return -1;
    }
    if (p->zip && first >= 0) continue;
    first = k;
    all *= (double)f->n;
    if (all <= MOST_RUNS) p->grid *= f->n;
  }
  if (all <= MOST_RUNS) return 0;
  snprintf(why, size, "%.3g runs are more than %g: take fewer values", (double)all, (double)MOST_RUNS);
  return -1;
}

int lag_plan_finish(SweepPlan *p, long long samples, char *why, size_t size) {
  p->dimensions = 0;
  for (int k = 0; k < p->n; k++) {
    const Factor *f = &p->factor[k];
    if (f->n) continue;
    if (samples == 0 && f->kind == FACTOR_UNIFORM) {
      char range[160], ratios[200] = "";
      snprintf(range, sizeof range, "%s=%g..%g", f->name, (double)f->a, (double)f->b);
      if (f->a > 0) snprintf(ratios, sizeof ratios, " %s:log:11 in equal ratios,", range);
      snprintf(why, size, "%s: the number of values is missing: write %s:11,%s or add --samples 1000 for random values",
               range, range, ratios);
      return -1;
    }
    if (samples == 0) {
      snprintf(why, size, "%s has a distribution: write the number of samples, for example --samples 1000", f->name);
      return -1;
    }
    p->dimensions++;
  }
  if (samples && !p->dimensions) {
    snprintf(why, size, "--samples: no name has a distribution; write for example g~normal(9.81, 0.01)");
    return -1;
  }
  if (p->n == 0) {
    snprintf(why, size,
             "nothing varies: no value has two dots or a comma; write a range, NAME=FIRST..LAST:NUMBER, for example "
             "th=0..1:11, or a list, th=0,1,2");
    return -1;
  }
  if (count_grid(p, why, size)) return -1;
  p->samples = samples ? samples : 1;
  if ((double)p->grid * (double)p->samples > MOST_RUNS) {
    snprintf(why, size, "%.3g runs are more than %g: take fewer values or samples",
             (double)p->grid * (double)p->samples, (double)MOST_RUNS);
    return -1;
  }
  p->runs = p->grid * p->samples;
  return 0;
}

static double grid_value(const Factor *f, long long i) {
  if (f->kind == FACTOR_LIST) return f->list[i];
  if (i == 0) return f->a;
  if (i == f->n - 1) return f->b;
  double part = (double)i / (double)(f->n - 1), ratio = f->b / f->a;
  if (f->kind == FACTOR_LOG) return isfinite(ratio) ? f->a * pow(ratio, part) : pow(f->a, 1 - part) * pow(f->b, part);
  return f->a + part * (f->b - f->a);
}

static double sample_value(const SweepPlan *p, const Factor *f, long long sample, int d) {
  double u;
  switch (p->sampling) {
    case SAMPLING_HYPERCUBE: u = lag_hypercube_at(p->seed, (uint64_t)sample, (uint64_t)p->samples, (uint32_t)d); break;
    case SAMPLING_POINTS: u = p->points[(size_t)sample * (size_t)p->dimensions + (size_t)d]; break;
    default: u = lag_random_at(p->seed, (uint64_t)sample, (uint32_t)d);
  }
  return f->kind == FACTOR_NORMAL ? f->a + f->b * lag_normal_quantile(u) : f->a + u * (f->b - f->a);
}

void lag_plan_values(const SweepPlan *p, long long i, double *value) {
  long long sample = i % p->samples, place = i / p->samples;
  for (int k = p->n - 1, d = p->dimensions; k >= 0; k--) {
    const Factor *f = &p->factor[k];
    if (!f->n) {
      value[k] = sample_value(p, f, sample, --d);
    } else {
      value[k] = grid_value(f, place % f->n);
      if (!p->zip) place /= f->n;
    }
  }
}

long long lag_plan_variant(const SweepPlan *p, long long i) {
  long long place = i / p->samples, variant = 0, stride = 1;
  for (int k = p->n - 1; k >= 0; k--) {
    const Factor *f = &p->factor[k];
    if (f->compiled && p->zip) return place;
    if (f->compiled) {
      variant += place % f->n * stride;
      stride *= f->n;
    }
    if (f->n) place /= f->n;
  }
  return variant;
}

long long lag_plan_run_of(const SweepPlan *p, long long variant) {
  long long place = 0, stride = 1;
  for (int k = p->n - 1; k >= 0; k--) {
    const Factor *f = &p->factor[k];
    if (f->compiled && p->zip) return variant * p->samples;
    if (f->compiled) {
      place += variant % f->n * stride;
      variant /= f->n;
    }
    if (f->n) stride *= f->n;
  }
  return place * p->samples;
}

void lag_plan_free(SweepPlan *p) {
  for (int k = 0; k < p->n; k++) free(p->factor[k].list);
  free(p->factor);
  *p = (SweepPlan){0};
}
