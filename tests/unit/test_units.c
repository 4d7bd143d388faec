/* Units against UDUNITS-2, an independent table: every unit, with each of its prefixes, has the same
 * SI value to 1e-12, and the same dimension. The library is looked for when the test runs. */
#include <dlfcn.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#include "compile_text.h"
#include "model/units.h"

/* ---- the library, without its header ---- */

typedef struct {
  void *(*read_xml)(const char *);
  void *(*parse)(const void *system, const char *text, int encoding);
  void *(*get_converter)(void *from, void *to);
  double (*convert)(const void *converter, double x);
  void (*free_converter)(void *);
  void (*free_unit)(void *);
  void (*free_system)(void *);
  void *(*set_handler)(int (*)(const char *, va_list));
  void *system;
} Udunits;

static int quiet(const char *fmt, va_list ap) {
  (void)fmt;
  (void)ap;
  return 0;
}

static int find(void *lib, const char *name, void *function) {
  void *p = dlsym(lib, name);
  memcpy(function, &p, sizeof p);
  return p != NULL;
}

static int udunits_open(Udunits *u) {
  void *lib = dlopen("libudunits2.so.0", RTLD_NOW);
  if (!lib) lib = dlopen("libudunits2.so", RTLD_NOW);
  if (!lib) return 0;
  if (!find(lib, "ut_read_xml", &u->read_xml) || !find(lib, "ut_parse", &u->parse) || !find(lib, "ut_get_converter", &u->get_converter) ||
      !find(lib, "cv_convert_double", &u->convert) || !find(lib, "cv_free", &u->free_converter) || !find(lib, "ut_free", &u->free_unit) ||
      !find(lib, "ut_free_system", &u->free_system) || !find(lib, "ut_set_error_message_handler", &u->set_handler))
    return 0;
  u->set_handler(quiet);
  u->system = u->read_xml(NULL);
  return u->system != NULL;
}

/* The value of one `unit` in `si`; NAN when the library does not convert. */
static double converted(const Udunits *u, const char *unit, const char *si) {
  enum { UTF8 = 2 };
  void *from = u->parse(u->system, unit, UTF8), *to = u->parse(u->system, si, UTF8);
  void *c = from && to ? u->get_converter(from, to) : NULL;
  double x = c ? u->convert(c, 1) : NAN;
  if (c) u->free_converter(c);
  if (from) u->free_unit(from);
  if (to) u->free_unit(to);
  return x;
}

/* ---- ours ---- */

/* The unit as a model's parameter has it. Unknown ones give factor 0. */
static Unit unit_named(Arena *a, const char *name) {
  const char *lag = arena_printf(a, "model m\nparam k = 1 [%s]\n", name);
  Sources *sources = sources_new(a);
  Ast *ast = ast_new(a, interner_new(a), sources, diags_new(a, sources));
  parse(ast, source_add(sources, "test.lag", lag, strlen(lag)));
  const AstUnit *u = &ast_expr(ast, ast->first->next->rhs)->unit;
  Unit unit = unit_resolve(u, ast->diags, a);
  if (ast->diags->errors) unit.factor = num_int(0);
  return unit;
}

/* The dimension spelled in SI base units, for the library. */
static const char *si_text(Arena *a, const Unit *u) {
  static const char *const base[DIM_COUNT] = {"m", "kg", "s", "A", "K", "mol", "cd"};
  StrBuf b = strbuf(a);
  for (int i = 0; i < DIM_COUNT; i++)
    if (u->dim.e[i]) sb_printf(&b, "%s%s%d", b.n ? " " : "", base[i], u->dim.e[i] / DIM_ONE);
  return b.n ? sb_text(&b) : "1";
}

/* Names that the library spells otherwise. */
static const char *theirs(const char *name) {
  static const char *const other[][2] = {{"deg", "degree"}, {"rev", "turn"}, {"yr", "(365.25 day)"}, {"au", "(149597870700 m)"}, {"t", "tonne"},
                                         {"u", "(1.66053906660e-27 kg)"}, {"eV", "(1.602176634e-19 J)"}, {"Ω", "ohm"}};
  for (size_t i = 0; i < sizeof other / sizeof *other; i++)
    if (strcmp(name, other[i][0]) == 0) return other[i][1];
  return name;
}

static void agree(const Udunits *lib, Arena *a, const char *ours, const char *other) {
  Unit u = unit_named(a, ours);
  double f = unit_factor(&u), want = converted(lib, other, si_text(a, &u));
  if (!(fabs(f / want - 1) < 1e-12)) fail_msg("[%s] is %.17g %s here, and [%s] is %.17g there", ours, f, si_text(a, &u), other, want);
}

static const char *const units[] = {
  "m", "g", "s", "A", "K", "mol", "cd", "Hz", "N", "Pa", "J", "W", "C", "V", "F", "ohm", "Ω", "S", "Wb", "T", "H", "lm", "lx",
  "Bq", "Gy", "Sv", "kat", "rad", "sr", "deg", "rev", "min", "h", "d", "day", "yr", "au", "eV", "u", "bar", "L", "t",
};
static const char *const prefixed[] = {"m", "g", "s", "A", "K", "mol", "cd", "Hz", "N", "Pa", "J", "W", "C", "V", "F", "ohm",
                                       "S", "Wb", "T", "H", "lm", "lx", "Bq", "Gy", "Sv", "kat", "rad", "sr", "bar", "L"};
static const char *const prefixes[] = {"Y", "Z", "E", "P", "T", "G", "M", "k", "h", "da", "d", "c", "m", "µ", "n", "p", "f", "a", "z", "y"};
enum { N_UNITS = sizeof units / sizeof *units, N_PREFIXED = sizeof prefixed / sizeof *prefixed, N_PREFIXES = sizeof prefixes / sizeof *prefixes };

static void test_table(void **state) {
  const Udunits *lib = *state;
  if (!lib) skip();
  Arena *a = arena_new(NULL);
  for (int i = 0; i < N_UNITS; i++) agree(lib, a, units[i], theirs(units[i]));
  arena_free(a);
}

static void test_prefixes(void **state) {
  const Udunits *lib = *state;
  if (!lib) skip();
  Arena *a = arena_new(NULL);
  for (int i = 0; i < N_PREFIXED; i++)
    for (int k = 0; k < N_PREFIXES; k++) {
      const char *name = arena_printf(a, "%s%s", prefixes[k], prefixed[i]);
      int whole = 0; /* a unit of its own comes before a prefix: min is no milli-inch, cd no centiday */
      for (int j = 0; j < N_UNITS; j++) whole |= strcmp(name, units[j]) == 0;
      if (!whole) agree(lib, a, name, name);
    }
  arena_free(a);
}

static void test_compound(void **state) {
  const Udunits *lib = *state;
  if (!lib) skip();
  static const char *const pairs[][2] = {
    {"kg*m^2/s^2", "kg m2 s-2"}, {"km/h", "km/h"}, {"N*s/m", "N s m-1"}, {"deg/s", "degree/s"}, {"rev/min", "turn/min"},
    {"mm^2", "mm2"}, {"kg/m^3", "kg m-3"}, {"1/s", "s-1"}, {"m/s/s", "m s-2"}, {"cm^3/min", "cm3/min"}, {"kPa*L", "kPa L"},
    {"deg^2", "degree2"}, {"µm/ns", "µm/ns"},
  };
  Arena *a = arena_new(NULL);
  for (size_t i = 0; i < sizeof pairs / sizeof *pairs; i++) agree(lib, a, pairs[i][0], pairs[i][1]);
  arena_free(a);
}

/* ---- what needs no library ---- */

static void test_refused(void **state) {
  (void)state;
  static const char *const unknown[] = {"kdeg", "kmin", "kkg", "mh", "foo", "Kg", "kyr", "kt"};
  Arena *a = arena_new(NULL);
  for (size_t i = 0; i < sizeof unknown / sizeof *unknown; i++) {
    Unit u = unit_named(a, unknown[i]);
    if (!num_is_zero(u.factor)) fail_msg("[%s] should be no unit", unknown[i]);
    assert_false(unit_exists(unknown[i]));
  }
  arena_free(a);
}

static const char *text_of(Arena *a, const char *unit) {
  Unit u = unit_named(a, unit);
  return dim_text(u.dim, a);
}

static void test_dimensions(void **state) {
  (void)state;
  Arena *a = arena_new(NULL);
  assert_string_equal(text_of(a, "kg*m/s^2"), "N");
  assert_string_equal(text_of(a, "N*m"), "J");
  assert_string_equal(text_of(a, "m/s^2"), "m/s^2");
  assert_string_equal(text_of(a, "m^(1/2)"), "m^(1/2)");
  assert_string_equal(text_of(a, "rad"), "1");
  assert_string_equal(text_of(a, "1/s"), "1/s");
  assert_string_equal(dim_text(DIM_UNKNOWN, a), "?");
  Unit m = unit_named(a, "m"), s = unit_named(a, "s"), v = unit_named(a, "m/s"), root = unit_named(a, "m^(1/2)");
  assert_true(dim_fits(dim_div(m.dim, s.dim), v.dim));
  assert_true(dim_fits(dim_pow(root.dim, num_int(2)), m.dim));
  assert_false(dim_fits(m.dim, s.dim));
  assert_true(dim_fits(m.dim, DIM_UNKNOWN));
  assert_true(dim_is_none(dim_div(m.dim, m.dim)));
  assert_false(dim_mul(m.dim, DIM_UNKNOWN).known);
  arena_free(a);
}

int main(void) {
  static Udunits lib;
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(test_table), cmocka_unit_test(test_prefixes), cmocka_unit_test(test_compound),
    cmocka_unit_test(test_refused), cmocka_unit_test(test_dimensions),
  };
  struct CMUnitTest with[5];
  int there = udunits_open(&lib);
  for (int i = 0; i < 5; i++) {
    with[i] = tests[i];
    with[i].initial_state = there ? &lib : NULL;
  }
  int failed = cmocka_run_group_tests(with, NULL, NULL);
  if (there) lib.free_system(lib.system);
  return failed;
}
