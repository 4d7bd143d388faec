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
  if (!find(lib, "ut_read_xml", &u->read_xml) || !find(lib, "ut_parse", &u->parse) ||
      !find(lib, "ut_get_converter", &u->get_converter) || !find(lib, "cv_convert_double", &u->convert) ||
      !find(lib, "cv_free", &u->free_converter) || !find(lib, "ut_free", &u->free_unit) ||
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
static Unit unit_named(Arena *a, Dims *d, const char *name) {
  const char *lag = arena_printf(a, "model m\nparam k = 1 [%s]\n", name);
  Sources *sources = sources_new(a);
  Ast *ast = ast_new(a, interner_new(a), sources, diags_new(a, sources));
  parse(ast, source_add(sources, "test.lag", lag, strlen(lag)));
  if (ast->diags->errors) return (Unit){.dim = DIM_ANY};
  const AstUnit *u = &ast_expr(ast, ast->first->next->rhs)->unit;
  Unit unit = unit_resolve(u, d, ast->diags, a);
  if (ast->diags->errors) unit.factor = num_int(0);
  return unit;
}

/* The dimension spelled in SI base units, for the library. */
static const char *si_text(Arena *a, const Dims *d, const Unit *u) {
  static const char *const base[DIM_BASES] = {"m", "kg", "s", "A", "K", "mol", "cd"};
  StrBuf b = strbuf(a);
  for (int i = 0; i < DIM_BASES; i++) {
    double e = num_value(dim_exponent(d, u->dim, (DimBase)i));
    if (e != 0) sb_printf(&b, "%s%s%g", b.n ? " " : "", base[i], e);
  }
  return b.n ? sb_text(&b) : "1";
}

/* Names that the library spells otherwise, or defines by older values of constants. */
static const char *theirs(const char *name) {
  static const char *const other[][2] = {{"deg", "degree"},
                                         {"rev", "turn"}, {"yr", "(365.25 day)"}, {"au", "(149597870700 m)"},
                                         {"t", "tonne"}, {"u", "(1.66053906660e-27 kg)"}, {"Ω", "ohm"},
                                         {"degC", "degree_Celsius"}, {"pc", "(30856775814913672.789 m)"},
                                         {"ly", "(9460730472580800 m)"},
                                         {"Msun", "(1.98840987069805e30 kg)"}};
  for (size_t i = 0; i < sizeof other / sizeof *other; i++)
    if (strcmp(name, other[i][0]) == 0) return other[i][1];
  return name;
}

static void agree(const Udunits *lib, Arena *a, const char *ours, const char *other) {
  Dims *d = dims_new(a);
  Unit u = unit_named(a, d, ours);
  double f = unit_factor(&u) + num_value(u.offset), want = converted(lib, other, si_text(a, d, &u));
  if (!(fabs(f / want - 1) < 1e-12))
    fail_msg("1 [%s] is %.17g %s here, and 1 [%s] is %.17g there", ours, f, si_text(a, d, &u), other, want);
}

/* Every unit of the compiler's own table: what is added there is judged here. */
static void test_table(void **state) {
  const Udunits *lib = *state;
  if (!lib) skip();
  Arena *a = arena_new(NULL);
  int units = 0;
  for (uint32_t i = 0; unit_name(i); i++, units++) {
    const char *name = unit_name(i);
    /* The library's electronvolt is that of CODATA 1986; ours is exact since 2019, 1.602176634e-19 J. */
    agree(lib, a, name, strcmp(name, "eV") == 0 ? "(1.602176634e-19 J)" : theirs(name));
  }
  assert_true(units > 40);
  arena_free(a);
}

/* A unit of its own comes before a prefix: cd is no centiday, min no milli-inch. */
static int is_whole(const char *name) {
  for (uint32_t i = 0; unit_name(i); i++)
    if (strcmp(name, unit_name(i)) == 0) return 1;
  return 0;
}

/* Every unit that takes prefixes, with every prefix. The prefixes of 2022 (ronto to quetta) are newer than the
 * library: they are compared with a power of ten. */
static void test_prefixes(void **state) {
  static const struct {
    const char *name, *power;
  } of_2022[] = {{"Q", "1e30"}, {"R", "1e27"}, {"r", "1e-27"}, {"q", "1e-30"}};
  const Udunits *lib = *state;
  if (!lib) skip();
  Arena *a = arena_new(NULL);
  int pairs = 0;
  for (uint32_t i = 0; unit_name(i); i++) {
    const char *unit = unit_name(i);
    for (uint32_t k = 0; unit_takes_prefixes(i) && unit_prefix(k); k++) {
      const char *prefix = unit_prefix(k), *name = arena_printf(a, "%s%s", prefix, unit), *other = name;
      if (is_whole(name)) continue;
      if (strcmp(unit, "Ω") == 0) other = arena_printf(a, "%sohm", prefix);
      if (strcmp(unit, "eV") == 0) other = arena_printf(a, "1.602176634e-19 %sJ", prefix);
      if (strcmp(unit, "pc") == 0) other = arena_printf(a, "30856775814913672.789 %sm", prefix);
      for (size_t n = 0; n < sizeof of_2022 / sizeof *of_2022; n++)
        if (strcmp(prefix, of_2022[n].name) == 0)
          other = arena_printf(a, "%s (%s)", of_2022[n].power,
                               strcmp(unit, "eV") == 0 ? "1.602176634e-19 J" : theirs(unit));
      agree(lib, a, name, other);
      pairs++;
    }
  }
  assert_true(pairs > 500);
  arena_free(a);
}

static void test_compound(void **state) {
  const Udunits *lib = *state;
  if (!lib) skip();
  static const char *const pairs[][2] = {
      {"kg*m^2/s^2", "kg m2 s-2"}, {"km/h", "km/h"}, {"N*s/m", "N s m-1"}, {"deg/s", "degree/s"},
      {"rev/min", "turn/min"}, {"mm^2", "mm2"}, {"kg/m^3", "kg m-3"}, {"1/s", "s-1"}, {"m/s/s", "m s-2"},
      {"cm^3/min", "cm3/min"}, {"kPa*L", "kPa L"}, {"deg^2", "degree2"}, {"µm/ns", "µm/ns"}, {"N m", "N m"},
      {"N·m", "N m"}, {"N⋅m", "N m"}, {"J/kg*K", "J K/kg"}, {"J/(kg*K)", "J/kg/K"}, {"W/m^2/K^4", "W m-2 K-4"},
      {"(km/h)^2", "km2/h2"}, {"s^-1", "s-1"}, {"m^(4/2)", "m2"}, {"V*s/A", "H"}, {"1", "1"},
  };
  Arena *a = arena_new(NULL);
  for (size_t i = 0; i < sizeof pairs / sizeof *pairs; i++) agree(lib, a, pairs[i][0], pairs[i][1]);
  arena_free(a);
}

/* ---- what needs no library ---- */

static void test_refused(void **state) {
  (void)state;
  static const char *const unknown[] = {"kdeg", "kmin", "kkg",   "mh",     "foo",    "Kg",
                                        "kyr",  "kt",   "mdegC", "J/degC", "degC^2", "N.m"};
  Arena *a = arena_new(NULL);
  Dims *d = dims_new(a);
  for (size_t i = 0; i < sizeof unknown / sizeof *unknown; i++) {
    Unit u = unit_named(a, d, unknown[i]);
    if (!num_is_zero(u.factor)) fail_msg("[%s] should be no unit", unknown[i]);
    assert_false(unit_exists(unknown[i]));
  }
  arena_free(a);
}

static void test_factors(void **state) {
  (void)state;
  Arena *a = arena_new(NULL);
  Dims *d = dims_new(a);
  const double pi = 3.14159265358979323846;
  Unit deg = unit_named(a, d, "deg"), root = unit_named(a, d, "deg^(1/2)"), warm = unit_named(a, d, "degC");
  assert_float_equal(unit_factor(&deg), pi / 180, 1e-17);
  assert_float_equal(unit_factor(&root) * unit_factor(&root), pi / 180, 1e-16);
  assert_float_equal(unit_factor(&warm), 1, 0);
  assert_float_equal(num_value(warm.offset), 273.15, 0);
  static const struct {
    const char *name;
    double value;
  } others[] = {{"ft", 0.3048},
                {"lb", 0.45359237}, {"ly", 299792458.0 * 31557600.0},
                {"pc", 648000 * 149597870700.0 / 3.14159265358979323846}, {"Msun", 1.3271244e20 / 6.67430e-11},
                {"\xC2\xB0", 3.14159265358979323846 / 180},
                {"\xC2\xB0/s", 3.14159265358979323846 / 180}};
  for (size_t i = 0; i < sizeof others / sizeof *others; i++) {
    Unit u = unit_named(a, d, others[i].name);
    assert_float_equal(unit_factor(&u)/others[i].value, 1, 4e-16);
  }
  Unit celsius = unit_named(a, d, "\xC2\xB0" "C");
  assert_float_equal(num_value(celsius.offset), 273.15, 0);
  assert_string_equal(celsius.text, "degC");
  arena_free(a);
}

int main(void) {
  static Udunits lib;
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(test_table), cmocka_unit_test(test_prefixes), cmocka_unit_test(test_compound),
    cmocka_unit_test(test_refused), cmocka_unit_test(test_factors),
  };
  enum { N = sizeof tests / sizeof *tests };
  struct CMUnitTest with[N];
  int there = udunits_open(&lib);
  for (int i = 0; i < N; i++) {
    with[i] = tests[i];
    with[i].initial_state = there ? &lib : NULL;
  }
  int failed = cmocka_run_group_tests(with, NULL, NULL);
  if (there) lib.free_system(lib.system);
  return failed;
}
