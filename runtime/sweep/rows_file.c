/* Rows of a CSV file (sweep_grid.h). Enters: names in the first line, "th [rad]" for th, numbers in each other one;
 * leaves: a list of values for each name. */
#include <ctype.h>
#include <string.h>

#include "io/csv_file.h"
#include "sweep/sweep_grid.h"

/* Names become factors; "m[2] [kg]" is m[2], in kg. */
static int add_names(const CsvFile *f, SweepPlan *p) {
  for (int k = 0; k < f->ncols; k++) {
    char *name = f->names[k], *unit = strstr(name, " [");
    size_t n = strlen(name);
    if (unit && name[n - 1] == ']') *unit = name[n - 1] = '\0', unit += 2;
    else unit = NULL;
    if (!*name) return lag_csv_refuse(f, "column %d has no name", k + 1);
    if (isdigit((unsigned char)*name) || *name == '-')
      return lag_csv_refuse(f, "%.60s is no name: the first line has the names of the columns, as th,l", name);
    if (lag_plan_add_column(p, name, unit ? unit : "", f->why, f->size)) return -1;
  }
  return 0;
}

static int add_numbers(const CsvFile *f, SweepPlan *p) {
  for (int k = 0; k < f->ncols; k++) {
    const char *s = f->field[k];
    double x;
    if (!lag_plan_number(&s, &x) || *s)
      return lag_csv_refuse(f, "\"%.60s\" is not a number; rows have one for each name in the first line", f->field[k]);
    if (lag_factor_add(&p->factor[k], x)) return lag_csv_refuse(f, "out of memory");
  }
  return 0;
}

int lag_plan_add_rows(SweepPlan *p, const char *path, char *why, size_t size) {
  CsvFile f = {.path = path, .why = why, .size = size};
  if (p->n) return lag_csv_refuse(&f, "rows of a file, and ranges beside them: put the values into the file");
  int rc = lag_csv_open(&f, path, why, size), more = 0;
  rc = rc ? rc : add_names(&f, p);
  while (rc == 0 && (more = lag_csv_row(&f)) > 0) rc = add_numbers(&f, p);
  rc = rc || more ? -1 : p->factor[0].n ? 0 : lag_csv_refuse(&f, "there are no rows below the names");
  p->zip = 1;
  lag_csv_close(&f);
  return rc;
}
