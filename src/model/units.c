/* Table of units, and conversion of written units. Contract: units.h.
 *
 * Values: SI Brochure, 9th edition (BIPM 2019), tables 4 and 8; au: IAU 2012 Resolution B2; eV and u: CODATA 2018;
 * yr: the Julian year of 365.25 days (IAU); bar, L, min, h, d: table 8 of the brochure; ft and lb: exact by the
 * international yard and pound agreement of 1959; ly: 299792458 m/s times yr; pc: 648000/pi au, IAU 2015 Resolution
 * B2; Msun: the nominal 1.3271244e20 m^3/s^2 of IAU 2015 Resolution B3 over G = 6.67430e-11 m^3/(kg s^2) of CODATA
 * 2018, which is known to 2.2e-5. */
#include "model/units.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/words.h"

#define PI 3.14159265358979323846

typedef struct {
  const char *name;
  const char *factor; /* SI value of one unit, decimal, without the power of pi */
  int pi_power;
  int prefixes;       /* 1: takes SI prefixes */
  int8_t e[DIM_BASES]; /* m kg s A K mol cd */
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
  {"ft", "0.3048", 0, 0, {1}},
  {"lb", "0.45359237", 0, 0, {0, 1}},
  {"ly", "9460730472580800", 0, 0, {1}},
  {"pc", "96939420213600000", -1, 1, {1}},
  {"Msun", "1.988409870698051e30", 0, 0, {0, 1}},
  {"degC", "1", 0, 0, {0, 0, 0, 0, 1}}, /* see offset_of() */
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

/* Row and power of ten of a unit with or without prefix: "km" is m and 3. NULL: unknown. */
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

/* Common other spellings of units, for messages. */
static const char *const spellings[][2] = {
    {"meter metre meters metres", "m"}, {"gram grams", "g"}, {"kilogram kilograms kgs Kg KG kilo", "kg"},
    {"sec secs second seconds Sec", "s"}, {"minute minutes", "min"}, {"hour hours hr", "h"}, {"days", "d"},
    {"year years a", "yr"}, {"degree degrees", "deg"}, {"radian radians", "rad"}, {"turn", "rev"}, {"rpm", "rev/min"},
    {"Newton newton", "N"}, {"Joule joule", "J"}, {"Watt watt", "W"}, {"Volt volt", "V"}, {"Ampere ampere amp", "A"},
    {"Kelvin kelvin", "K"}, {"Ohm", "ohm"}, {"Hertz hertz", "Hz"}, {"Pascal", "Pa"}, {"Coulomb", "C"}, {"Farad", "F"},
    {"Henry", "H"}, {"Tesla", "T"}, {"AU", "au"}, {"ev", "eV"}, {"us", "µs"}, {"um", "µm"}, {"liter litre l", "L"},
    {"amu Da", "u"}, {"foot feet", "ft"}, {"lbs pound pounds", "lb"}, {"parsec", "pc"}, {"lyr", "ly"},
    {"M_sun msun", "Msun"},
};
enum { N_SPELLINGS = sizeof spellings / sizeof *spellings };

/* Common prefixed units, candidates for suggestions. */
static const char *const usual[] = {
  "kg", "mg", "km", "cm", "mm", "µm", "nm", "ms", "µs", "ns", "kN", "MN", "mN", "kPa", "MPa", "GPa", "kJ", "MJ", "mJ",
  "kW", "MW", "mW", "mA", "kA", "mV", "kV", "kHz", "MHz", "GHz", "mrad", "keV", "MeV", "GeV", "mL", "kmol", "mmol",
};
enum { N_USUAL = sizeof usual / sizeof *usual };

/* 1 for kg and units of the table, except deg and degC. */
static int is_plain(const char *name) {
  return strcmp(name, "kg") == 0 || (find_row(name) && strncmp(name, "deg", 3) != 0);
}

/* Recognises `Nm` as N*m; 0: not a product of two units. */
static int report_product(const AstUnitFactor *f, Diags *diags) {
  size_t length = strlen(f->name);
  char first[16];
  for (size_t cut = length < sizeof first ? length - 1 : 0; cut > 0; cut--) {
    snprintf(first, sizeof first, "%.*s", (int)cut, f->name);
    if (!is_plain(first) || !is_plain(f->name + cut)) continue;
    diag_help(diags, "a product is written with `*`: `%s*%s`", first, f->name + cut);
    return 1;
  }
  return 0;
}

static void report_unknown(const AstUnitFactor *f, Diags *diags) {
  diag_error(diags, f->span, "unknown unit `%s`", f->name);
  for (int i = 0; i < N_SPELLINGS; i++)
    if (has_word(spellings[i][0], f->name)) {
      diag_help(diags, "write `%s`", spellings[i][1]);
      return;
    }
  if (report_product(f, diags)) return;
  Name known[N_UNITS + N_USUAL];
  for (int i = 0; i < N_USUAL; i++) known[i] = usual[i];
  for (int i = 0; i < N_UNITS; i++) known[N_USUAL + i] = table[i].name;
  Name near = suggest(f->name, known, N_UNITS + N_USUAL);
  if (near) diag_help(diags, "did you mean `%s`?", near);
  else diag_help(diags, "`lagc help units` lists them");
}

/* SI value of the unit's zero point. */
static Num offset_of(const UnitRow *row) { return strcmp(row->name, "degC") == 0 ? num_ratio(27315, 100) : num_int(0); }

static Dim row_dim(Dims *dims, const UnitRow *row) {
  Dim d = DIM_NONE;
  for (int i = 0; i < DIM_BASES; i++)
    if (row->e[i]) d = dim_mul(dims, d, dim_pow(dims, dim_base(dims, (DimBase)i), num_int(row->e[i])));
  return d;
}

static void multiply(Unit *u, Dims *dims, const UnitRow *row, int power, Num exponent) {
  Num base = strcmp(row->name, "deg") == 0 ? num_ratio(1, 180) : num_parse(row->factor, strlen(row->factor));
  Num one = num_mul(base, power_of_ten(power)), turns = num_mul(num_int(row->pi_power), exponent);
  int exact;
  u->factor = num_mul(u->factor, num_pow(one, exponent, &exact));
  if (num_is_int(turns)) u->pi_power += (int)turns.num;
  else u->factor = num_mul(u->factor, num_double(pow(PI, num_value(turns))));
  u->dim = dim_mul(dims, u->dim, dim_pow(dims, row_dim(dims, row), exponent));
}

/* Reports degC in a product or power: a unit with an offset stands alone. */
static void report_offset(const AstUnit *u, const AstUnitFactor *f, Diags *diags, Arena *a) {
  StrBuf in_kelvin = strbuf(a);
  size_t at = 0;
  for (const char *c = strstr(u->text, f->name); c; c = strstr(u->text + at, f->name)) {
    sb_printf(&in_kelvin, "%.*sK", (int)(c - u->text - (ptrdiff_t)at), u->text + at);
    at = (size_t)(c - u->text) + strlen(f->name);
  }
  sb_puts(&in_kelvin, u->text + at);
  diag_error(diags, f->span, "`%s` stands alone: its zero is not that of the kelvin", f->name);
  diag_help(diags, "a difference of temperatures is the same in kelvin: `[%s]`", sb_text(&in_kelvin));
}

/* Multiplies u by one factor of the written unit; 0, reported, if the factor is unknown or has an offset. */
static int apply_factor(Unit *u, const AstUnit *ast, const AstUnitFactor *f, Dims *dims, Diags *diags, Arena *a) {
  int power;
  const UnitRow *row = find_prefixed(f->name, &power);
  if (!row) {
    report_unknown(f, diags);
    return 0;
  }
  Num offset = offset_of(row);
  if (!num_is_zero(offset) && (ast->n > 1 || !num_is_one(f->exponent))) {
    report_offset(ast, f, diags, a);
    return 0;
  }
  u->offset = offset;
  multiply(u, dims, row, power, f->exponent);
  return 1;
}

Unit unit_resolve(const AstUnit *ast, Dims *dims, Diags *diags, Arena *a) {
  Unit u = unit_si(ast->n ? DIM_NONE : DIM_ANY, "");
  if (!ast->n) return u;
  u.text = arena_strdup(a, ast->text);
  for (uint32_t i = 0; i < ast->n; i++)
    if (!apply_factor(&u, ast, &ast->at[i], dims, diags, a)) {
      u.dim = DIM_ANY;
      return u;
    }
  if (num_is_one(u.factor) && !u.pi_power && num_is_zero(u.offset)) dim_spell(dims, u.dim, u.text);
  return u;
}

Unit unit_of_dim(Dims *dims, Dim d) {
  Unit u = unit_si(d, "");
  d = dim_resolved(dims, d);
  if (d != DIM_ANY && d != DIM_NONE && !dim_is_open(dims, d)) u.text = dim_text(dims, d);
  return u;
}

int unit_measures(const AstUnit *u) {
  for (uint32_t i = 0; i < u->n; i++) {
    int power;
    const UnitRow *row = find_prefixed(u->at[i].name, &power);
    if (!row) return 1; /* unknown unit, reported elsewhere */
    for (int k = 0; k < DIM_BASES; k++)
      if (row->e[k]) return 1;
  }
  return 0;
}

const char *unit_name(uint32_t i) { return i < N_UNITS ? table[i].name : NULL; }
int unit_takes_prefixes(uint32_t i) { return table[i].prefixes; }
const char *unit_prefix(uint32_t i) { return i < sizeof prefixes / sizeof *prefixes ? prefixes[i].name : NULL; }

const char *unit_meaning(uint32_t i, Arena *a) {
  const UnitRow *row = &table[i];
  Dims *dims = dims_new(a);
  const char *base = dim_product_text(dims, row_dim(dims, row));
  if (strcmp(base, row->name) == 0) return NULL;
  if (strcmp(row->name, "deg") == 0) return "pi/180";
  if (row->pi_power)
    return arena_printf(a, "%s%s%s%s", row->factor, row->pi_power < 0 ? "/pi" : "*pi", *base ? " " : "", base);
  if (!num_is_zero(offset_of(row)))
    return arena_printf(a, "%s, counted from %g %s", base, num_value(offset_of(row)), base);
  if (strcmp(row->factor, "1") == 0) return *base ? base : "1";
  return arena_printf(a, "%s%s%s", row->factor, *base ? " " : "", base);
}

double unit_factor(const Unit *u) {
  double f = num_value(u->factor);
  for (int i = 0; i < u->pi_power; i++) f *= PI;
  for (int i = 0; i > u->pi_power; i--) f /= PI;
  return f;
}

const char *unit_factor_text(Arena *a, const Unit *u) {
  char text[32];
  const char *digits = decimal_literal(a, u->factor, u->pi_power);
  if (!digits) num_format_double(text, unit_factor(u));
  return digits ? digits : arena_strdup(a, text);
}
