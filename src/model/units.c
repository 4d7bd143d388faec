/* Units. Values: SI Brochure, 9th edition (BIPM 2019), tables 4 and 8; au: IAU 2012 Resolution B2; eV and u: CODATA 2018; yr is the Julian year of 365.25 days
 * (IAU), bar, L, min, h, d as in table 8 of the brochure. */
#include "model/units.h"

#include <math.h>
#include <string.h>

#include "base/suggest.h"

const Dim DIM_NONE = {1, {0}};
const Dim DIM_UNKNOWN = {0, {0}};

typedef struct {
  const char *name;
  const char *factor; /* decimal, SI value of one */
  int pi_power;
  int prefixes;       /* 1: takes SI prefixes */
  int8_t e[DIM_COUNT]; /* m kg s A K mol cd */
} UnitRow;

static const UnitRow table[] = {
  {"1", "1", 0, 0, {0}},
  {"m", "1", 0, 1, {1}},
  {"g", "0.001", 0, 1, {0, 1}},
  {"s", "1", 0, 1, {0, 0, 1}},
  {"A", "1", 0, 1, {0, 0, 0, 1}},
  {"K", "1", 0, 1, {0, 0, 0, 0, 1}},
  {"mol", "1", 0, 1, {0, 0, 0, 0, 0, 1}},
  {"cd", "1", 0, 1, {0, 0, 0, 0, 0, 0, 1}},
  {"Hz", "1", 0, 1, {0, 0, -1}},
  {"N", "1", 0, 1, {1, 1, -2}},
  {"Pa", "1", 0, 1, {-1, 1, -2}},
  {"J", "1", 0, 1, {2, 1, -2}},
  {"W", "1", 0, 1, {2, 1, -3}},
  {"C", "1", 0, 1, {0, 0, 1, 1}},
  {"V", "1", 0, 1, {2, 1, -3, -1}},
  {"F", "1", 0, 1, {-2, -1, 4, 2}},
  {"ohm", "1", 0, 1, {2, 1, -3, -2}},
  {"Ω", "1", 0, 1, {2, 1, -3, -2}},
  {"S", "1", 0, 1, {-2, -1, 3, 2}},
  {"Wb", "1", 0, 1, {2, 1, -2, -1}},
  {"T", "1", 0, 1, {0, 1, -2, -1}},
  {"H", "1", 0, 1, {2, 1, -2, -2}},
  {"lm", "1", 0, 1, {0, 0, 0, 0, 0, 0, 1}},
  {"lx", "1", 0, 1, {-2, 0, 0, 0, 0, 0, 1}},
  {"Bq", "1", 0, 1, {0, 0, -1}},
  {"Gy", "1", 0, 1, {2, 0, -2}},
  {"Sv", "1", 0, 1, {2, 0, -2}},
  {"kat", "1", 0, 1, {0, 0, -1, 0, 0, 1}},
  {"rad", "1", 0, 1, {0}},
  {"sr", "1", 0, 1, {0}},
  {"deg", "1", 1, 0, {0}}, /* times pi/180; see multiply() */
  {"rev", "2", 1, 0, {0}},
  {"min", "60", 0, 0, {0, 0, 1}},
  {"h", "3600", 0, 0, {0, 0, 1}},
  {"d", "86400", 0, 0, {0, 0, 1}},
  {"day", "86400", 0, 0, {0, 0, 1}},
  {"yr", "31557600", 0, 0, {0, 0, 1}},
  {"au", "149597870700", 0, 0, {1}},
  {"eV", "1.602176634e-19", 0, 1, {2, 1, -2}},
  {"u", "1.66053906660e-27", 0, 0, {0, 1}},
  {"bar", "100000", 0, 1, {-1, 1, -2}},
  {"L", "0.001", 0, 1, {3}},
  {"t", "1000", 0, 0, {0, 1}},
};
enum { N_UNITS = sizeof table / sizeof *table };

static const struct {
  const char *name;
  int power;
} prefixes[] = {
  {"Q", 30}, {"R", 27}, {"Y", 24}, {"Z", 21}, {"E", 18}, {"P", 15}, {"T", 12}, {"G", 9}, {"M", 6},
  {"k", 3}, {"h", 2}, {"da", 1}, {"d", -1}, {"c", -2}, {"m", -3}, {"µ", -6}, {"μ", -6}, {"n", -9},
  {"p", -12}, {"f", -15}, {"a", -18}, {"z", -21}, {"y", -24}, {"r", -27}, {"q", -30},
};

static const UnitRow *find_row(const char *name) {
  for (int i = 0; i < N_UNITS; i++)
    if (strcmp(table[i].name, name) == 0) return &table[i];
  return NULL;
}

/* "km": the row of m and 3. */
static const UnitRow *find_prefixed(const char *name, int *power) {
  *power = 0;
  const UnitRow *row = find_row(name);
  if (row) return row;
  for (size_t i = 0; i < sizeof prefixes / sizeof *prefixes; i++) {
    size_t n = strlen(prefixes[i].name);
    if (strncmp(name, prefixes[i].name, n) != 0) continue;
    row = find_row(name + n);
    if (row && row->prefixes) {
      *power = prefixes[i].power;
      return row;
    }
  }
  return NULL;
}

int unit_exists(const char *name) {
  int power;
  return find_prefixed(name, &power) != NULL;
}

static Num power_of_ten(int n) {
  Num ten = num_int(10), e = num_int(n);
  int exact;
  return num_pow(ten, e, &exact);
}

/* What people write for a unit that has another spelling here. */
static const char *const spellings[][2] = {
  {"meter", "m"}, {"metre", "m"}, {"meters", "m"}, {"metres", "m"}, {"gram", "g"}, {"grams", "g"}, {"kilogram", "kg"},
  {"kilograms", "kg"}, {"kgs", "kg"}, {"Kg", "kg"}, {"KG", "kg"}, {"kilo", "kg"}, {"sec", "s"}, {"secs", "s"},
  {"second", "s"}, {"seconds", "s"}, {"Sec", "s"}, {"minute", "min"}, {"minutes", "min"}, {"hour", "h"}, {"hours", "h"},
  {"hr", "h"}, {"days", "d"}, {"year", "yr"}, {"years", "yr"}, {"a", "yr"}, {"degree", "deg"}, {"degrees", "deg"},
  {"radian", "rad"}, {"radians", "rad"}, {"turn", "rev"}, {"rpm", "rev/min"}, {"Newton", "N"}, {"newton", "N"},
  {"Joule", "J"}, {"joule", "J"}, {"Watt", "W"}, {"watt", "W"}, {"Volt", "V"}, {"volt", "V"}, {"Ampere", "A"},
  {"ampere", "A"}, {"amp", "A"}, {"Kelvin", "K"}, {"kelvin", "K"}, {"Ohm", "ohm"}, {"Hertz", "Hz"}, {"hertz", "Hz"},
  {"Pascal", "Pa"}, {"Coulomb", "C"}, {"Farad", "F"}, {"Henry", "H"}, {"Tesla", "T"}, {"AU", "au"}, {"ev", "eV"},
  {"us", "µs"}, {"um", "µm"}, {"liter", "L"}, {"litre", "L"}, {"l", "L"}, {"amu", "u"}, {"Da", "u"},
};
enum { N_SPELLINGS = sizeof spellings / sizeof *spellings };

/* Prefixed units that people use, for suggestions. */
static const char *const usual[] = {
  "kg", "mg", "km", "cm", "mm", "µm", "nm", "ms", "µs", "ns", "kN", "MN", "mN", "kPa", "MPa", "GPa", "kJ", "MJ", "mJ",
  "kW", "MW", "mW", "mA", "kA", "mV", "kV", "kHz", "MHz", "GHz", "mrad", "keV", "MeV", "GeV", "mL", "kmol", "mmol",
};
enum { N_USUAL = sizeof usual / sizeof *usual };

static void report_unknown(const AstUnitFactor *f, Diags *diags) {
  if (strcmp(f->name, "degC") == 0) {
    diag_error(diags, f->span, "not yet: `degC`, whose zero is not that of the kelvin");
    diag_help(diags, "write kelvin: 20 degC is 293.15 [K]");
    return;
  }
  diag_error(diags, f->span, "unknown unit `%s`", f->name);
  for (int i = 0; i < N_SPELLINGS; i++)
    if (strcmp(f->name, spellings[i][0]) == 0) {
      diag_help(diags, "write `%s`", spellings[i][1]);
      return;
    }
  Name known[N_UNITS + N_USUAL];
  for (int i = 0; i < N_USUAL; i++) known[i] = usual[i];
  for (int i = 0; i < N_UNITS; i++) known[N_USUAL + i] = table[i].name;
  Name near = suggest(f->name, known, N_UNITS + N_USUAL);
  if (near) diag_help(diags, "did you mean `%s`?", near);
  else diag_help(diags, "`lagc help units` lists them");
}

static void multiply(Unit *u, const UnitRow *row, int power, Num exponent) {
  Num base = strcmp(row->name, "deg") == 0 ? num_ratio(1, 180) : num_parse(row->factor, strlen(row->factor));
  Num ten = power_of_ten(power);
  int exact;
  Num one = num_mul(base, ten);
  Num raised = num_pow(one, exponent, &exact);
  u->factor = num_mul(u->factor, raised);
  u->pi_power += (int)(row->pi_power * num_value(exponent));
  Dim d = {.known = 1};
  for (int i = 0; i < DIM_COUNT; i++) d.e[i] = (int16_t)(row->e[i] * DIM_ONE);
  u->dim = dim_mul(u->dim, dim_pow(d, exponent));
}

Unit unit_resolve(const AstUnit *ast, Diags *diags, Arena *a) {
  Unit u = {.dim = ast->n ? DIM_NONE : DIM_UNKNOWN, .factor = num_int(1), .text = ""};
  if (ast->n) u.text = arena_strdup(a, ast->text);
  for (uint32_t i = 0; i < ast->n; i++) {
    int power;
    const UnitRow *row = find_prefixed(ast->at[i].name, &power);
    if (row) {
      multiply(&u, row, power, ast->at[i].exponent);
    } else {
      report_unknown(&ast->at[i], diags);
      u.dim = DIM_UNKNOWN;
      return u;
    }
  }
  return u;
}

double unit_factor(const Unit *u) {
  const double pi = 3.14159265358979323846;
  double f = num_value(u->factor);
  for (int i = 0; i < u->pi_power; i++) f *= pi;
  for (int i = 0; i > u->pi_power; i--) f /= pi;
  return f;
}

/* --- dimensions --- */

Dim dim_mul(Dim a, Dim b) {
  if (!a.known || !b.known) return DIM_UNKNOWN;
  for (int i = 0; i < DIM_COUNT; i++) a.e[i] = (int16_t)(a.e[i] + b.e[i]);
  return a;
}

Dim dim_pow(Dim a, Num e) {
  if (!a.known) return a;
  for (int i = 0; i < DIM_COUNT; i++) a.e[i] = (int16_t)lround((double)a.e[i] * num_value(e));
  return a;
}

Dim dim_div(Dim a, Dim b) { return dim_mul(a, dim_pow(b, num_int(-1))); }

int dim_fits(Dim a, Dim b) { return !a.known || !b.known || memcmp(a.e, b.e, sizeof a.e) == 0; }

int dim_is_none(Dim a) { return a.known && memcmp(a.e, DIM_NONE.e, sizeof a.e) == 0; }

/* A derived unit with a name of its own: what people expect to read. */
static const char *derived_name(Dim a) {
  static const char *const named[] = {"N", "J", "W", "Pa", "C", "V"};
  for (size_t i = 0; i < sizeof named / sizeof *named; i++) {
    const UnitRow *row = find_row(named[i]);
    int same = 1;
    for (int k = 0; k < DIM_COUNT; k++) same &= a.e[k] == row->e[k] * DIM_ONE;
    if (same) return row->name;
  }
  return NULL;
}

static void put_exponent(StrBuf *b, const char *name, int twelfths) {
  sb_puts(b, name);
  if (twelfths == DIM_ONE) return;
  Num e = num_ratio(twelfths, DIM_ONE);
  sb_puts(b, num_is_int(e) ? "^" : "^(");
  num_print(b, e);
  if (!num_is_int(e)) sb_putc(b, ')');
}

/* In base units. */
static const char *base_text(Dim a, Arena *arena) {
  static const char *const base[DIM_COUNT] = {"m", "kg", "s", "A", "K", "mol", "cd"};
  static const int order[DIM_COUNT] = {DIM_MASS, DIM_LENGTH, DIM_TIME, DIM_CURRENT, DIM_TEMPERATURE, DIM_AMOUNT, DIM_LUMINOUS};
  StrBuf b = strbuf(arena);
  int above = 0;
  for (int i = 0; i < DIM_COUNT; i++)
    if (a.e[order[i]] > 0) {
      if (above++) sb_putc(&b, '*');
      put_exponent(&b, base[order[i]], a.e[order[i]]);
    }
  if (!above) sb_putc(&b, '1');
  for (int i = 0; i < DIM_COUNT; i++)
    if (a.e[order[i]] < 0) {
      sb_putc(&b, '/');
      put_exponent(&b, base[order[i]], -a.e[order[i]]);
    }
  return sb_text(&b);
}

const char *dim_text(Dim a, Arena *arena) {
  if (!a.known) return "?";
  const char *name = derived_name(a);
  return name ? name : base_text(a, arena);
}

/* --- the table, for help --- */

const char *unit_name(size_t i) { return i < N_UNITS ? table[i].name : NULL; }
int unit_takes_prefixes(size_t i) { return i < N_UNITS && table[i].prefixes; }

const char *unit_meaning(size_t i, Arena *a) {
  Unit u = {.dim = DIM_NONE, .factor = num_int(1)};
  multiply(&u, &table[i], 0, num_int(1));
  const char *in_base = base_text(u.dim, a);
  if (strcmp(in_base, table[i].name) == 0) return NULL;
  int one = strcmp(table[i].factor, "1") == 0, pure = dim_is_none(u.dim);
  if (!u.pi_power) return one ? in_base : arena_printf(a, pure ? "%s" : "%s %s", table[i].factor, in_base);
  StrBuf b = strbuf(a);
  num_print(&b, u.factor); /* times pi: 1/180 or 2 */
  return strncmp(sb_text(&b), "1/", 2) == 0 ? arena_printf(a, "pi%s", sb_text(&b) + 1) : arena_printf(a, "%s*pi", sb_text(&b));
}
