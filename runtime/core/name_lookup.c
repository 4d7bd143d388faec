/* Look-up of the names that a user may write: exact, or the suffix of one dotted name; and the nearest known name to
 * a wrong one. Enters: text; leaves: kind, index and description. */
#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/core.h"
#include "numeric/edit_distance.h"

static int is_called(const lag_var *var, const char *name, size_t length) {
  return var->name[0] == name[0] && strlen(var->name) == length && memcmp(var->name, name, length) == 0;
}

/* A family that counts up, as r[1].x, r[1].y, r[2].x: variables first ... end - 1, `group` of them a member. */
typedef struct Members {
  int first, end, group;
  size_t stem; /* length of the names up to the number */
  long from;
} Members;

static int is_of_member(const lag_var *vars, const Members *f, int k) {
  const char *name = vars[f->first + k * f->group].name;
  return strncmp(name, vars[f->first].name, f->stem) == 0 && strtol(name + f->stem, NULL, 10) == f->from + k;
}

/* The family from the variable `first` on; its end by bisection, since members stand in a row. */
static Members members_from(const lag_var *vars, int n, int first) {
  Members f = {.first = first, .group = 1, .stem = strcspn(vars[first].name, "[") + 1};
  f.from = strtol(vars[first].name + f.stem, NULL, 10);
  while (first + f.group < n && strncmp(vars[first + f.group].name, vars[first].name, f.stem) == 0 &&
         strtol(vars[first + f.group].name + f.stem, NULL, 10) == f.from)
    f.group++;
  int last = 0, beyond = (n - first) / f.group;
  while (beyond - last > 1) {
    int k = last + (beyond - last) / 2;
    *(is_of_member(vars, &f, k) ? &last : &beyond) = k;
  }
  f.end = first + (last + 1) * f.group;
  return f;
}

static int find_in(const lag_var *vars, int n, const char *name, size_t length) {
  for (int i = 0, end; i < n; i = end) {
    end = i + 1;
    if (is_called(&vars[i], name, length)) return i;
    if (end == n || vars[end].name[0] != vars[i].name[0] || !strchr(vars[i].name, '[')) continue;
    Members f = members_from(vars, n, i);
    end = f.end;
    if (strncmp(vars[i].name, name, f.stem) != 0) continue;
    long k = strtol(name + f.stem, NULL, 10) - f.from;
    for (int at = 0; k >= 0 && k < (end - i) / f.group && at < f.group; at++)
      if (is_called(&vars[i + (int)k * f.group + at], name, length)) return i + (int)k * f.group + at;
  }
  return -1;
}

const char *lag_name_in_effect(const char *var) {
  const char *dot = strpbrk(var, ".[");
  return dot && *dot == '.' ? dot + 1 : NULL;
}

/* The last variable that is called `name` inside its effect; adds to *count the number of them. */
static int find_suffix(const lag_var *vars, int n, const char *name, int *count) {
  int found = -1;
  for (int i = 0; i < n; i++) {
    const char *own = lag_name_in_effect(vars[i].name);
    if (own && strcmp(own, name) == 0) {
      found = i;
      ++*count;
    }
  }
  return found;
}

/* Whether a variable is an input of a contact, which nobody may set. */
static int is_switch(const lag_model *m, const lag_var *var) {
  for (int i = 0; i < m->ncontacts; i++)
    if (&m->u[m->contacts[i].input] == var || (m->contacts[i].is_tangent && &m->u[m->contacts[i].force] == var))
      return 1;
  return 0;
}

/* Finds a name, inputs of contacts included. */
static int find(const lag_model *m, const char *name, int *index, const lag_var **var) {
  size_t n = strlen(name);
  const struct {
    int kind, n;
    const lag_var *vars;
  } tables[] = {{LAG_IS_P, m->np, m->p}, {LAG_IS_Q, m->nq, m->q}, {LAG_IS_Z, m->nz, m->z}, {LAG_IS_U, m->nu, m->u}};

  if (n > 1 && name[n - 1] == '\'' && (*index = find_in(m->q, m->nq, name, n - 1)) >= 0) {
    *var = &m->q[*index];
    return LAG_IS_V;
  }
  for (size_t k = 0; k < sizeof tables / sizeof *tables; k++)
    if ((*index = find_in(tables[k].vars, tables[k].n, name, n)) >= 0) {
      *var = &tables[k].vars[*index];
      return tables[k].kind;
    }
  int count = 0, p = find_suffix(m->p, m->np, name, &count), u = find_suffix(m->u, m->nu, name, &count);
  if (count != 1) return LAG_IS_NOTHING;
  *index = p >= 0 ? p : u;
  *var = p >= 0 ? &m->p[p] : &m->u[u];
  return p >= 0 ? LAG_IS_P : LAG_IS_U;
}

int lag_input_rate(const lag_model *m, int i) {
  size_t n = strlen(m->u[i].name);
  int is = i + 1 < m->nu && strncmp(m->u[i + 1].name, m->u[i].name, n) == 0 && strcmp(m->u[i + 1].name + n, "'") == 0;
  return is ? i + 1 : -1;
}

int lag_find_name(const lag_model *m, const char *name, int *index, const lag_var **var) {
  int kind = find(m, name, index, var);
  return kind == LAG_IS_U && is_switch(m, *var) ? LAG_IS_NOTHING : kind;
}

int lag_is_member(const char *var, const char *family, size_t length) {
  size_t stem = strcspn(var, "[");
  const char *close = strchr(var, ']'), *rest = close ? close + 1 : NULL;
  return rest && stem + strlen(rest) == length && memcmp(var, family, stem) == 0 &&
         memcmp(family + stem, rest, length - stem) == 0;
}

int lag_family_member(const lag_model *m, const char *name, int k, char *part, size_t npart) {
  const struct {
    int n;
    const lag_var *vars;
  } tables[] = {{m->np, m->p}, {m->nq, m->q}, {m->nz, m->z}, {m->nu, m->u}};
  size_t n = strlen(name), rate = n > 1 && name[n - 1] == '\'';

  n -= rate;
  for (size_t i = rate; i < (rate ? 2 : sizeof tables / sizeof *tables); i++) { /* only coordinates have rates to set */
    for (int j = 0; j < tables[i].n; j++) {
      const char *whole = tables[i].vars[j].name;
      if (strncmp(whole, name, n) != 0 || !whole[n] || !strchr("[.", whole[n]) || is_switch(m, &tables[i].vars[j]) ||
          k-- > 0)
        continue;
      snprintf(part, npart, "%s%s", whole, rate ? "'" : "");
      return 1;
    }
  }
  return 0;
}

/* Edit distance where `name` may be a typing error for `known`; NO_TYPO where it is another name: too many
 * edits, or a single letter replaced. */
enum { NO_TYPO = 1000 };
static int typo_distance(const char *name, const char *known) {
  size_t na = strlen(name), nb = strlen(known);
  if (na > LAG_LONGEST_WORD || nb > LAG_LONGEST_WORD) return strcmp(name, known) ? NO_TYPO : 0;
  int n = (int)na, d = lag_edit_distance(name, na, known, nb, 2) / 2;
  int guess = n == 1 && known[0] && !known[1] && tolower((unsigned char)name[0]) != tolower((unsigned char)known[0]);

  return guess || d > n / 3 + 1 ? NO_TYPO : d;
}

void lag_try_nearest(lag_nearest *near, const char *known) {
  int d = typo_distance(near->name, known);
  if (d < (near->best ? near->least : NO_TYPO)) {
    near->least = d;
    near->best = known;
  }
}

int lag_nearest_name(const lag_model *m, const char *name, char *best, size_t nbest) {
  const struct {
    int n;
    const lag_var *vars;
    const char *suffix;
  } tables[] = {{m->np, m->p, ""}, {m->nq, m->q, ""}, {m->nq, m->q, "'"}, {m->nz, m->z, ""}, {m->nu, m->u, ""}};
  int least = NO_TYPO;
  size_t n = strlen(name);

  best[0] = '\0';
  for (size_t k = 0; k < sizeof tables / sizeof *tables; k++)
    for (int i = 0; i < tables[k].n; i++) {
      char full[64];
      snprintf(full, sizeof full, "%s%s", tables[k].vars[i].name, tables[k].suffix);
      int part = strncmp(full, name, n) == 0 && (full[n] == '.' || full[n] == '['); /* r of r.x, drag of drag.c */
      int d = part ? 0 : typo_distance(name, full);
      if (d < least && !is_switch(m, &tables[k].vars[i])) {
        least = d;
        snprintf(best, nbest, "%s", full);
      }
    }
  return best[0] != '\0';
}

int lag_no_such_name(lag_sim *s, const char *name, const char *use, const char *kinds) {
  const lag_model *m = s->scene->model;
  char near[64];
  if (lag_family_member(m, name, 0, near, sizeof near))
    return lag_fail(s, LAG_EINVAL, "%s has parts: %s %s, and so on", name, use, near);
  int is = lag_nearest_name(m, name, near, sizeof near);
  return lag_fail(s, LAG_EINVAL, "%s: no such %s in model %s%s%s%s", name, kinds, m->name, is ? "; did you mean " : "",
                  near, is ? "?" : "");
}
