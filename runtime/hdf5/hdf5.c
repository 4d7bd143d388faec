/* Rows and motions of a sweep as HDF5: a dataset for each measure or output, with an axis for each range, as
 * dimension scales; units as attributes. The HDF Group, HDF5 Dimension Scale Specification (2005). */
#include <hdf5.h>
#include <hdf5_hl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "lag.h"

static int put_text(hid_t of, const char *name, const char *text) {
  return *text && H5LTset_attribute_string(of, ".", name, text) < 0;
}

/* A dataset of doubles, written later where x is NULL, with the same bytes in every file: without the time at which
 * it was made. */
static hid_t put_numbers(hid_t file, const char *name, int n, const hsize_t *size, const double *x) {
  hid_t how = H5Pcreate(H5P_DATASET_CREATE), space = H5Screate_simple(n, size, NULL);
  H5Pset_obj_track_times(how, 0);
  hid_t set = H5Dcreate2(file, name, H5T_IEEE_F64LE, space, H5P_DEFAULT, how, H5P_DEFAULT);
  if (set >= 0 && x && H5Dwrite(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, x) < 0) {
    H5Dclose(set);
    set = -1;
  }
  H5Sclose(space);
  H5Pclose(how);
  return set;
}

/* In names of datasets '/' is a separator. */
static void dataset_name(char *s, size_t n, const char *name) {
  snprintf(s, n, "%s", name);
  for (; *s; s++)
    if (*s == '/') *s = ':';
}

static int put_axis(hid_t file, const lag_axis *a) {
  char name[200];
  hsize_t n = (hsize_t)a->n;
  dataset_name(name, sizeof name, a->name);
  hid_t set = put_numbers(file, name, 1, &n, a->x);
  int bad = set < 0 || H5DSset_scale(set, a->name) < 0 || put_text(set, "units", a->unit);
  if (set >= 0) H5Dclose(set);
  return bad;
}

/* Column c over its axes; *set := its dataset. */
static int put_column(hid_t file, const lag_grid *g, const lag_axis *c, hid_t *set) {
  char name[200];
  hsize_t size[LAG_GRID_MOST];
  int naxes = g->naxes - (g->next && c->x);
  for (int k = 0; k < naxes; k++) size[k] = (hsize_t)g->axis[k].n;
  dataset_name(name, sizeof name, c->name);
  *set = put_numbers(file, name, naxes, size, c->x);
  int bad = *set < 0 || put_text(*set, "units", c->unit);
  for (int k = 0; k < naxes && !bad; k++) {
    dataset_name(name, sizeof name, g->axis[k].name);
    hid_t scale = H5Dopen2(file, name, H5P_DEFAULT);
    bad = scale < 0 || H5DSattach_scale(*set, scale, (unsigned)k) < 0 ||
          H5DSset_label(*set, (unsigned)k, g->axis[k].name) < 0;
    if (scale >= 0) H5Dclose(scale);
  }
  return bad;
}

/* One place of the axes but the last: x[n of the last]. */
static int put_block(hid_t set, const lag_grid *g, long long place, const double *x) {
  hsize_t start[LAG_GRID_MOST], count[LAG_GRID_MOST];
  int last = g->naxes - 1;
  for (int k = last - 1; k >= 0; place /= g->axis[k--].n) {
    start[k] = (hsize_t)(place % g->axis[k].n);
    count[k] = 1;
  }
  start[last] = 0;
  count[last] = (hsize_t)g->axis[last].n;
  hid_t space = H5Dget_space(set), block = H5Screate_simple(g->naxes, count, NULL);
  int bad = H5Sselect_hyperslab(space, H5S_SELECT_SET, start, NULL, count, NULL) < 0 ||
            H5Dwrite(set, H5T_NATIVE_DOUBLE, block, space, H5P_DEFAULT, x) < 0;
  H5Sclose(block);
  H5Sclose(space);
  return bad;
}

/* The columns that come block by block. */
static int put_blocks(const lag_grid *g, const hid_t *set) {
  long long places = 1, rows = g->axis[g->naxes - 1].n;
  double *block = malloc((size_t)g->ncolumns * (size_t)rows * sizeof *block);
  for (int k = 0; k + 1 < g->naxes; k++) places *= g->axis[k].n;
  int bad = !block;
  for (long long i = 0; i < places && !bad; i++) {
    const double *x = block;
    bad = g->next(g->context, block) != 0;
    for (int k = 0; k < g->ncolumns && !bad; k++) {
      if (g->column[k].x) continue;
      bad = put_block(set[k], g, i, x);
      x += rows;
    }
  }
  free(block);
  return bad;
}

int lag_hdf5_write(const char *path, const lag_grid *g) {
  hid_t how = H5Pcreate(H5P_FILE_CREATE), *set = calloc((size_t)g->ncolumns + 1, sizeof *set);
  H5Eset_auto2(H5E_DEFAULT, NULL, NULL);
  H5Pset_obj_track_times(how, 0);
  hid_t file = H5Fcreate(path, H5F_ACC_TRUNC, how, H5P_DEFAULT);
  int bad = !set || file < 0 || put_text(file, "title", g->title), n = 0;
  for (int k = 0; k < g->naxes && !bad; k++) bad = put_axis(file, &g->axis[k]);
  for (; n < g->ncolumns && !bad; n++) bad = put_column(file, g, &g->column[n], &set[n]);
  if (g->next && !bad) bad = put_blocks(g, set);
  while (n--)
    if (set[n] >= 0) bad |= H5Dclose(set[n]) < 0;
  H5Pclose(how);
  free(set);
  if (file >= 0 && H5Fclose(file) < 0) bad = 1;
  return bad ? -1 : 0;
}
