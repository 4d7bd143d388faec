/* `lagc verify`: a right-hand side by hand against the derived equations.
 *
 * A program with the emitted model in quadruple precision and the function as it is written, in doubles, evaluates
 * both at sample points and at arguments some roundings beside each. A difference counts if it exceeds what rounding
 * explains: the spread of the difference over these arguments and the four directions of rounding (Kahan, How futile
 * are mindless assessments of roundoff, 2006), and the change of the derived value. */
#include <ctype.h>
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/posix.h" /* generated: a copy of runtime/io/posix.h */
#include "base/words.h"
#include "claims/difference_cause.h"
#include "commands/commands.h"
#include "commands/effect_study.h"
#include "commands/verify.h"
#include "toolchain/files.h"

/* ---- the command line ---- */

static int is_identifier(const char *s) {
  while (isalnum((unsigned char)*s) || *s == '_') s++;
  return !*s;
}

static int read_target(Verification *v, const char **error) {
  const char *given = v->c->o.against, *colon = given ? strrchr(given, ':') : NULL;
  if (!given) return fail_with(error, "which function? write --against FILE.c:FUNCTION");
  const char *other = colon ? arena_strndup(v->arena, given, (size_t)(colon - given)) : given,
             *dot = strrchr(other, '.');
  if (dot && has_word(".py .ipynb .m .jl .f .f90 .rs .js .java .nb", dot))
    return fail_with(
        error, arena_printf(v->arena,
                            "%s is not C: `lagc verify` compiles and calls a C function; from Python compare with "
                            "`lagc.load(MODEL).rhs(t, y)`, or write the formula into the model: `expect x'' = ...`",
                            other));
  if (!colon || !colon[1] || isdigit((unsigned char)colon[1]) || !is_identifier(colon + 1))
    return fail_with(error, arena_printf(v->arena, "--against %s names no function: write FILE.c:FUNCTION", given));
  v->file = arena_strndup(v->arena, given, (size_t)(colon - given));
  v->function = colon + 1;
  return 1;
}

static Name name_of(const Verification *v, uint32_t i) {
  return expr_symbol(v->g, sample_state_symbols(v->points).at[i])->name;
}

/* Index of the component that s[n] names; ny: none. */
static uint32_t component_named(const Verification *v, const char *s, size_t n) {
  uint32_t i = 0;
  while (i < v->ny && (strlen(name_of(v, i)) != n || strncmp(name_of(v, i), s, n) != 0)) i++;
  return i;
}

/* Length of the next name of a list with commas; a family's own commas stand in brackets. */
static size_t name_length(const char *s) {
  size_t n = 0;
  for (int depth = 0; s[n] && (depth || s[n] != ','); n++) depth += (s[n] == '[') - (s[n] == ']');
  return n;
}

static const char *all_names(const Verification *v, const uint32_t *order) {
  StrBuf b = strbuf(v->arena);
  for (uint32_t i = 0; i < v->ny; i++) sb_printf(&b, "%s%s", i ? "," : "", name_of(v, order ? order[i] : i));
  return sb_text(&b);
}

static int read_map(Verification *v, const char **error) {
  const char *s = v->c->o.map;
  uint32_t n = 0;
  v->map = ARENA_ARRAY(v->arena, uint32_t, v->ny + 1);
  for (uint32_t i = 0; i < v->ny; i++) v->map[i] = i;
  for (; s && *s; n++) {
    size_t length = name_length(s);
    const char *word = arena_strndup(v->arena, s, length);
    uint32_t i = component_named(v, s, length);
    if (i == v->ny) {
      Name *names = ARENA_ARRAY(v->arena, Name, v->ny + 1);
      for (uint32_t k = 0; k < v->ny; k++) names[k] = name_of(v, k);
      Name near = suggest(word, names, v->ny);
      const char *help = near ? arena_printf(v->arena, ": did you mean `%s`?", near)
                              : arena_printf(v->arena, "; they are %s", all_names(v, NULL));
      return fail_with(error, arena_printf(v->arena, "--map: `%s` is no component of y%s", word, help));
    }
    for (uint32_t k = 0; k < n && k < v->ny; k++)
      if (v->map[k] == i) return fail_with(error, arena_printf(v->arena, "--map: `%s` stands twice", word));
    if (n < v->ny) v->map[n] = i;
    s += length + (s[length] == ',');
  }
  if (v->c->o.map && n != v->ny)
    return fail_with(error, arena_printf(v->arena, "--map has %u name%s, y has %u components: %s", n, plural(n), v->ny,
                                         all_names(v, NULL)));
  return 1;
}

/* ---- the points ---- */

/* A whole number from -ROUNDINGS to ROUNDINGS. */
static int draw_roundings(uint32_t *random) {
  *random = *random * 1664525u + 1013904223u;
  return (int)(*random >> 16) % (2 * ROUNDINGS + 1) - ROUNDINGS;
}

/* Writes one set of arguments: those of the point, or, beside it, each some roundings off. */
static void write_arguments(Verification *v, const Real *symbols, int beside, uint32_t *random, FILE *in) {
  SymList y = sample_state_symbols(v->points), p = sample_parameters(v->points);
  double *x = ARENA_ARRAY(v->arena, double, 2 + 2 * (size_t)v->ny + v->np);
  x[0] = (double)symbols[v->m->time];
  for (uint32_t i = 0; i < v->ny; i++) x[1 + i] = (double)symbols[y.at[i]];
  for (uint32_t i = 0; i < v->np; i++) x[1 + v->ny + i] = (double)symbols[p.at[i]];
  for (uint32_t i = 0; i < 1 + v->ny + v->np && beside; i++) x[i] *= 1 + draw_roundings(random) * DBL_EPSILON;
  x[0] = fmax(x[0], v->m->scene.t0);
  for (uint32_t i = 0; i < v->ny; i++) x[1 + v->ny + v->np + i] = x[1 + v->map[i]];
  fwrite(x, sizeof *x, 1 + 2 * (size_t)v->ny + v->np, in);
}

/* Draws the points and writes their arguments; the first point comes once more at the end. */
static void write_points(Verification *v, FILE *in) {
  uint32_t random = 1;
  for (uint32_t k = 0; k < POINTS; k++) {
    Real *symbols = ARENA_ARRAY(v->arena, Real, expr_symbol_count(v->g) + 1);
    if (!sample_point(v->points, k, symbols)) continue;
    v->symbols[k] = symbols;
    for (int j = 0; j <= BESIDE; j++) write_arguments(v, symbols, j > 0, &random, in);
    v->point[v->n++] = k;
  }
  if (v->n) write_arguments(v, v->symbols[v->point[0]], 0, &random, in);
}

static size_t result_size(const Verification *v) { return 1 + 2 * (size_t)v->na + MODES * (1 + (size_t)v->ny); }

/* Results of argument set j (0: the point itself) of the i-th point. */
static Evaluation evaluation(const Verification *v, uint32_t i, uint32_t j) {
  const double *r = v->results + ((size_t)i * (BESIDE + 1) + j) * result_size(v);
  Evaluation x = {.status = r[0], .high = r + 1, .low = r + 1 + v->na};
  r += 1 + 2 * (size_t)v->na;
  for (int k = 0; k < MODES; k++, r += 1 + v->ny) x.yours_status[k] = r[0], x.dydt[k] = r + 1;
  return x;
}

/* ---- judgement ---- */

/* The derived value of the rate of component i at argument set j; q' is exact. */
static Real derived(const Verification *v, const Evaluation *x, const Real *symbols, uint32_t i, Real *low) {
  *low = 0;
  if (i < v->nq) return symbols[sample_state_symbols(v->points).at[v->nq + i]];
  *low = x->low[i - v->nq];
  return x->high[i - v->nq];
}

static Real ulp(Real x) {
  return x == 0 || !isfinite(x) ? DBL_TRUE_MIN : fmaxl(ldexpl(1, ilogbl(x) - DBL_MANT_DIG + 1), DBL_TRUE_MIN);
}

/* Largest acceleration or rate. Values 1e-9 times as large may differ by rounding that no argument moves, as exp(x)
 * - 1 does for tiny x; random points have none such, and decide. */
static Real largest_rate(const Verification *v, const Evaluation *x) {
  Real most = 0;
  for (uint32_t i = 0; i < v->na; i++) most = fmaxl(most, fabsl(x->high[i]));
  return most;
}

/* Larger by more than rounding: the same state is shown with every library of functions. */
static int is_clearly_larger(Real x, Real than) { return x > than * (1 + 1e-6L) && than < INFINITY; }

/* The difference of a component of dydt from the derived value, and what rounding explains of it. */
typedef struct {
  Real value, difference, bound;
  /* of the difference, and of the derived value, over arguments beside the point and directions of rounding */
  Real spread, moved;
} Difference;

/* Component i of dydt, at place `place` of the function, at the k-th point. */
static Difference difference_at(const Verification *v, uint32_t k, uint32_t i, uint32_t place) {
  const Real *symbols = v->symbols[v->point[k]];
  Evaluation x = evaluation(v, k, 0);
  Real low, value = derived(v, &x, symbols, i, &low), least = INFINITY, most = -INFINITY;
  Difference d = {.value = value, .difference = (x.dydt[0][place] - value) - low};
  for (uint32_t j = 0; j <= BESIDE; j++) {
    Evaluation b = evaluation(v, k, j);
    Real b_low, b_value = i < v->nq ? value : derived(v, &b, symbols, i, &b_low);
    if (i < v->nq && j) break; /* q' beside the point is another argument */
    if (i < v->nq) b_low = 0;
    if (b.status != 0 || !isfinite(b_value)) continue;
    d.moved = fmaxl(d.moved, fabsl((b_value - value) + (b_low - low)));
    for (int r = 0; r < MODES; r++) {
      Real off = (b.dydt[r][place] - b_value) - b_low;
      if (isfinite(off)) least = fminl(least, off), most = fmaxl(most, off);
    }
  }
  d.spread = most > least ? most - least : 0;
  d.bound = 2 * d.spread + d.moved + 8 * ulp(value);
  return d;
}

static void judge(Verification *v, uint32_t k, uint32_t i, uint32_t place) {
  const Real few = 1 << 26; /* a value of which roundings leave fewer is 0, and its ulp says nothing */
  /* of the largest rate: a constraint holds this rate at 0, and it is the rounding of others */
  const Real zero = 1e-17L;
  /* fewer than 9 digits may be left only where roundings of the arguments leave no more than 5 digits more */
  const Real enough = 1e-9L, condition = 65536;
  Component *c = &v->component[i];
  Evaluation x = evaluation(v, k, 0);
  Difference d = difference_at(v, k, i, place);
  if (x.status != 0 || !isfinite(d.value)) return;
  const Real largest = largest_rate(v, &x), size = fabsl(d.value) < zero * largest ? largest : fabsl(d.value);
  int scatters = d.spread > enough * size && d.spread > condition * d.moved,
      finite = isfinite(d.difference) && x.yours_status[0] == 0;
  c->scattered += scatters && sample_is_random(v->point[k]);
  if (scatters && finite) return;
  c->points++;
  Real excess = finite ? fabsl(d.difference) / d.bound : INFINITY, ulps = fabsl(d.difference) / ulp(d.value);
  if (excess > 1 && !sample_is_random(v->point[k]) && fabsl(d.difference) <= 1e-9L * largest) return;
  c->differs += excess > 1;
  Real relative = finite ? fabsl(d.difference) / fmaxl(fabsl(d.value), fabsl((Real)x.dydt[0][place])) : INFINITY;
  if (excess > 1 && is_clearly_larger(relative, c->worst)) c->worst = relative, c->worst_at = k;
  if (d.bound >= few * ulp(d.value)) c->is_rounding |= ulps > 0;
  else if (excess <= 1 && ulps > c->ulps) c->ulps = ulps;
}

/* ---- reports ---- */

static const char *signature(const Verification *v) {
  SymList p = sample_parameters(v->points);
  StrBuf b = strbuf(v->arena);
  sb_printf(&b, "y = %s; p = ", all_names(v, v->map));
  for (uint32_t i = 0; i < p.n; i++) sb_printf(&b, "%s%s", i ? "," : "", expr_symbol(v->g, p.at[i])->name);
  sb_puts(&b, "; SI units");
  return sb_text(&b);
}

static const char *rate_name(const Verification *v, uint32_t i) { return arena_printf(v->arena, "%s'", name_of(v, i)); }

static int differs(Verification *v, const char *what, uint32_t k, const char *how) {
  if (v->quiet) return STATUS_RUN;
  const char *at = sample_text(v->points, v->symbols[v->point[k]]);
  usage_error(arena_printf(v->arena, "%s:%s %s%s\n  at %s\n  called with %s", v->file, v->function, what,
                           how ? how : "", at, signature(v)));
  return STATUS_RUN;
}

/* Mistakes that need no numbers: writes past the end, a status, memory between calls. Returns a STATUS. */
static int judge_calls(Verification *v) {
  Evaluation first = evaluation(v, 0, 0), again = evaluation(v, v->n, 0);
  for (uint32_t k = 0; k < v->n; k++) {
    Evaluation x = evaluation(v, k, 0);
    if (isnan(x.yours_status[0]))
      return differs(v, arena_printf(v->arena, "writes past dydt[%u], the last component", v->ny - 1), k, NULL);
    if (x.status == 0 && x.yours_status[0] != 0)
      return differs(v,
                     arena_printf(v->arena, "returns %g, where the derived equations have a value", x.yours_status[0]),
                     k, NULL);
  }
  if (memcmp(first.dydt[0], again.dydt[0], v->ny * sizeof(double)) != 0 && !isnan(first.dydt[0][0]))
    return differs(v, "gives other values when it is called once more with the same arguments: it reads more than them",
                   0, NULL);
  return STATUS_OK;
}

static const char *cause_of(Verification *v) {
  DifferenceData d = {.points = v->points, .map = v->map};
  for (uint32_t k = 0; k < v->n && d.n < DIFFERENCE_STATES; k++) {
    Evaluation x = evaluation(v, k, 0);
    if (!sample_is_random(v->point[k]) || x.status != 0) continue;
    d.state[d.n] = v->symbols[v->point[k]];
    d.rate[d.n] = ARENA_ARRAY(v->arena, Real, v->ny + 1);
    d.difference[d.n] = ARENA_ARRAY(v->arena, Real, v->ny + 1);
    d.bound[d.n] = ARENA_ARRAY(v->arena, Real, v->ny + 1);
    for (uint32_t place = 0; place < v->ny; place++) {
      uint32_t i = v->map[place];
      Difference at = difference_at(v, k, i, place);
      d.rate[d.n][i] = x.dydt[0][place];
      d.difference[d.n][i] = at.difference;
      d.bound[d.n][i] = at.bound;
    }
    d.n++;
  }
  return difference_cause(v->e, &d);
}

static const char *agreeing_effects(Verification *v);

static int report_difference(Verification *v, uint32_t i) {
  if (v->quiet) return STATUS_RUN;
  const Component *c = &v->component[i];
  uint32_t place = 0;
  while (v->map[place] != i) place++;
  Evaluation x = evaluation(v, c->worst_at, 0);
  Real low, value = derived(v, &x, v->symbols[v->point[c->worst_at]], i, &low), yours = x.dydt[0][place];
  const char *effects = agreeing_effects(v), *cause = effects ? effects : cause_of(v), *a = arena_strdup(v->arena, ""),
             *b = a;
  for (int digits = 6; digits <= 21 && strcmp(a, b) == 0; digits += 5) {
    a = isnan(yours) ? "nan, or not set, or computed from a place outside y or p"
                     : arena_printf(v->arena, "%.*Lg", digits, yours);
    b = arena_printf(v->arena, "%.*Lg", digits, value);
  }
  StrBuf how = strbuf(v->arena);
  sb_printf(&how, " differs from the derived equations%s%s", cause ? ": " : "", cause ? cause : "");
  sb_printf(&how, "\n  %s = dydt[%u] is %s, derived %s: not equal at %u of %u states", rate_name(v, i), place, a, b,
            c->differs, c->points);
  for (uint32_t k = 0; k < v->ny; k++)
    if (k != i && v->component[k].differs)
      sb_printf(&how, "%s%s", k < i || !strstr(sb_text(&how), "; also") ? "; also " : ", ", rate_name(v, k));
  return differs(v, sb_text(&how) + 1, c->worst_at, NULL);
}

/* The next of 1, 2, 5, 10, 20, ... from x on: libraries of functions differ in their roundings. */
static Real round_up(Real x) {
  Real power = powl(10, floorl(log10l(x))), digit = x / power;
  return power * (digit <= 1 ? 1 : digit <= 2 ? 2 : digit <= 5 ? 5 : 10);
}

static int report_agreement(Verification *v, const char *precision) {
  StrBuf b = strbuf(v->arena);
  sb_printf(&b, "%s:%s agrees with the derived equations of %s, scene %s%s, at %u states\n  called with %s\n", v->file,
            v->function, v->m->name, v->m->scene.name, v->given, v->n, signature(v));
  for (uint32_t i = 0; i < v->ny; i++) {
    const Component *c = &v->component[i];
    sb_printf(&b, "  %-10s ", rate_name(v, i));
    if (c->ulps == 0) sb_puts(&b, c->is_rounding ? "0 up to roundings" : "exact");
    else
      sb_printf(&b, "within %.6Lg ulp%s", round_up(c->ulps),
                c->ulps > 2 * ROUNDINGS ? ", where roundings explain as many" : "");
    sb_putc(&b, '\n');
  }
  sb_printf(&b, "  derived: %s digits", strcmp(precision, "quad") == 0 ? "34" : "19");
  if (v->m->contacts.n) sb_puts(&b, "; contacts: open");
  if (v->e->constraints.n > v->m->contacts.n) sb_puts(&b, "; states on the constraints");
  if (v->m->events.n > 2 * v->m->contacts.n) sb_puts(&b, "; events are not compared");
  sb_putc(&b, '\n');
  return compiler_write(v->c, NULL, &b);
}

static int report(Verification *v, const char *precision) {
  uint32_t worst = 0, fewest = UINT32_MAX, scattered = 0;
  for (uint32_t k = 0; k < v->n; k++)
    for (uint32_t place = 0; place < v->ny; place++) judge(v, k, v->map[place], place);
  for (uint32_t i = 0; i < v->ny; i++) {
    const Component *c = &v->component[i];
    if (is_clearly_larger(c->worst, v->component[worst].worst)) worst = i;
    if (c->points < fewest) fewest = c->points;
    if (c->scattered > v->component[scattered].scattered) scattered = i;
  }
  if (v->component[worst].differs) return report_difference(v, worst);
  if (v->component[scattered].scattered > POINTS_RANDOM / 2)
    return differs(v,
                   arena_printf(v->arena,
                                "has fewer than 9 digits in %s, where the derived value keeps theirs when arguments "
                                "are rounded: is a float in it?",
                                rate_name(v, scattered)),
                   0, NULL);
  if (v->quiet) return fewest < FEWEST ? STATUS_RUN : STATUS_OK;
  if (fewest < FEWEST) {
    usage_error(arena_printf(v->arena,
                             "not decided: only %u states give the derived equations and %s:%s a value with digits; "
                             "declare signs of coordinates and parameters, so that states are drawn inside the domain",
                             fewest, v->file, v->function));
    return STATUS_RUN;
  }
  return report_agreement(v, precision);
}

/* The program did not evaluate all arguments. */
static int report_break(Verification *v, int status, size_t evaluated) {
  enum { LATE = 124, NOT_RUN = 127 };
  uint32_t k = (uint32_t)(evaluated / (BESIDE + 1));
  if (status == NOT_RUN || k > v->n) {
    usage_error("the program that compares cannot be run");
    return STATUS_USAGE;
  }
  if (k == v->n) k = 0;
  return differs(v,
                 status == LATE ? "does not return within 5 s"
                 : status < 0   ? "crashes"
                                : "ends the program",
                 k, NULL);
}

/* ---- the command ---- */

static int compare(Verification *v) {
  const char *precision = "quad";
  FILE *out = v->run.out;
  write_points(v, v->run.in);
  if (fflush(v->run.in) != 0) return usage_error("cannot write a temporary file");
  if (!v->n)
    return usage_error("no state inside the model's domain was found: declare signs of coordinates and parameters");
  int built = verify_run(v, precision) || verify_run(v, precision = "long");
  const char *error = v->run.error;
  if (!built && v->quiet) return STATUS_USAGE;
  if (!built && !strstr(error, " failed:\n")) return usage_error(error);
  if (!built)
    return usage_error(arena_printf(v->arena,
                                    "%s\nthe function is called as %s(t, y, dydt, p), where t is a double, and the "
                                    "others are arrays of doubles; it takes all four, also those that it does not use",
                                    error, v->function));
  size_t want = (size_t)v->n * (BESIDE + 1) + 1, size = result_size(v);
  v->results = ARENA_ARRAY(v->arena, double, want * size);
  rewind(out);
  size_t got = fread(v->results, sizeof(double), want * size, out) / size;
  if (got < want) return v->quiet ? STATUS_RUN : report_break(v, v->run.status, got);
  int status = judge_calls(v);
  return status == STATUS_OK ? report(v, precision) : status;
}

/* The verification by the equations e, whose arguments and results go through temporary files. */
static int verify_equations(Verification *v, Compiler *c, Eqns *e) {
  OneRun *run = &v->run;
  if (!(v->program = compiler_lower_scene(c, e, 1))) return STATUS_MODEL;
  *run = (OneRun){.in = tmpfile(), .out = tmpfile()};
  int status = run->in && run->out ? compare(v) : usage_error("cannot write a temporary file");
  if (run->in) fclose(run->in);
  if (run->out) fclose(run->out);
  return status;
}

static void prepare(Verification *v, Compiler *c, Eqns *e) {
  *v = (Verification){.c = c, .given = v->given, .quiet = v->quiet, .e = e, .m = e->m, .g = e->g, .arena = c->arena,
                      .points = sample_points_new(e), .nq = e->m->coords.n};
  v->ny = sample_state_symbols(v->points).n;
  v->np = sample_parameters(v->points).n;
  v->na = v->ny - v->nq;
  v->component = ARENA_ARRAY(c->arena, Component, v->ny + 1);
}

static int begin(Verification *v, const char **error) {
  const char *why;
  const Source *text;
  if (!read_target(v, error) || !read_map(v, error)) return 0;
  if (!(text = source_read(v->c->sources, v->file, &why)))
    return fail_with(error, arena_printf(v->arena, "cannot read %s: %s", v->file, why));
  *error = verify_function_missing(v, text->text);
  v->path = file_absolute(v->arena, v->file);
  if (!*error && (!v->path || strpbrk(v->path, "\"\\\n")))
    *error = arena_printf(v->arena, "%s: C cannot include a file of such a name", v->file);
  return !*error;
}

/* Searches for another set of the model's effects with which the function agrees: all sets of up to four effects, of
 * more those that differ by one. Returns the advice, or NULL. */
static const char *agreeing_effects(Verification *v) {
  enum { ALL = 4 };
  Compiler *c = v->c;
  if (!effect_graph(c->ast).n) return NULL;
  EffectStudy *s = effect_study_plan(v->m);
  uint32_t n = !s ? 0 : s->graph.n > ALL ? s->variants.n : 1u << s->graph.n;
  for (uint32_t i = 0; i < n; i++) {
    EffectSet set = s->graph.n > ALL ? s->variants.at[i] : i;
    EffectList names = effect_names(s, set);
    if (set == s->used || !effect_set_valid(s, set)) continue;
    ModelChoice choice = {
        .scene = c->o.scene, .only = &names, .given = c->given.at, .ngiven = c->given.n, .domains = 1};
    Eqns *e = compiler_derive(c, &choice);
    Verification other = {.given = v->given, .quiet = 1};
    const char *used = effect_names_joined(s, set), *error = NULL;
    if (!e) continue;
    prepare(&other, c, e);
    if (!other.ny || !begin(&other, &error) || verify_equations(&other, c, e) != STATUS_OK) continue;
    return arena_printf(c->arena,
                        "it agrees with the model %s%s, and the scene `%s` has other effects: compare it with a scene "
                        "that says `use %s`",
                        names.n ? "with " : "without effects", used, v->m->scene.name, names.n ? used : "none");
  }
  return NULL;
}

/* ", g=9.81, th=1" */
static const char *values_given(Arena *a, const Options *o) {
  StrBuf b = strbuf(a);
  for (uint32_t i = 0; i < o->rest.n; i++) sb_printf(&b, ", %s", o->rest.at[i]);
  return sb_text(&b);
}

int command_verify(Compiler *c) {
  if (!HAS_POSIX)
    return usage_error("`lagc verify` is not for Windows: a function that does not return can be ended on POSIX "
                       "systems only; WSL is one");
  const char *error = NULL, *given = values_given(c->arena, &c->o);
  if (!settings_compiled(c->ast, &c->o, 1, &c->given, &error)) return error ? usage_error(error) : STATUS_MODEL;
  if (c->o.rest.n) return usage_error(arena_printf(c->arena, "%s has no value: write name=value", c->o.rest.at[0]));
  Eqns *e =
      compiler_derive(c, &(ModelChoice){.scene = c->o.scene, .given = c->given.at, .ngiven = c->given.n, .domains = 1});
  if (!e) return STATUS_MODEL;
  Verification v = {.given = given};
  prepare(&v, c, e);
  Name conditional = model_conditional(v.m);
  if (conditional)
    return usage_error(arena_printf(c->arena,
                                    "a function is compared with one set of equations, and those change where `%s` "
                                    "begins to hold: compare models with and without that constraint",
                                    conditional));
  if (!v.ny) return usage_error("the model has no coordinates and no states: there is nothing to compare");
  if (!begin(&v, &error)) return usage_error(error);
  return verify_equations(&v, c, e);
}
