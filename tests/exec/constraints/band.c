/* Large systems of lag_kkt.h, as chains and ladders have them, in a random order of unknowns: those that have a band
 * are solved within it, and agree with elimination in long double; those that are singular, or nearly so, are left
 * to the solver that decides about ranks. Exit status 1 when something is wrong. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "lag_kkt.h"

enum { N = 90, M = 40, ALL = N + M, ROOM = N * N + M * N + M * M + 2 * N + 9 * M };
enum { CHAIN, WEIGHTLESS, INDEFINITE, RING, SCALED, REDUNDANT, CLOSE, DENSE, KINDS };
static const char *const names[] = {"a chain",          "without inertia here and there",
                                    "indefinite",       "a ring",
                                    "in other units",   "redundant",
                                    "nearly redundant", "dense"};

static double m[N * N], a[M * N], f[N], g[M];
static int once, twice; /* constraints of which the second is twice the first */
static unsigned long long seed = 7;

static double next(void)
{
  seed = seed * 6364136223846793005u + 1442695040888963407u;
  return (double)(seed >> 11) / 9007199254740992.0 * 2 - 1;
}

/* place[n] := 0 ... n - 1 in a random order. */
static void shuffle(int n, int *place)
{
  for (int i = 0; i < n; i++) place[i] = i;
  for (int i = n - 1; i > 0; i--) {
    int j = (int)(fabs(next()) * i), was = place[i];
    place[i] = place[j], place[j] = was;
  }
}

/* Coordinates along a line, each coupled with the next one by inertia, and constraints of four that stand together,
 * or, closed to a ring, of the last and the first. */
static void make(int kind)
{
  int q[N], c[M];

  shuffle(N, q), shuffle(M, c);
  memset(m, 0, sizeof m), memset(a, 0, sizeof a);
  for (int i = 0; i < N; i++) {
    double sign = kind == INDEFINITE && i % 5 == 0 ? -1 : 1, unit = kind == SCALED && i % 2 ? 1e4 : 1;
    m[q[i] * N + q[i]] = sign * (2 + next()) * unit * unit;
    if (i > 0) m[q[i] * N + q[i - 1]] = m[q[i - 1] * N + q[i]] = 0.4 * next() * (kind == SCALED ? 1e4 : 1);
    f[i] = next();
  }
  for (int k = 0; k < M; k++) {
    double row = kind == SCALED ? pow(10, 4 * next()) : 1;
    for (int i = 0; i < 4; i++)
      a[c[k] * N + q[(2 * k + i + (kind == RING && k == M - 1 ? N - 2 * k - 2 : 0)) % N]] =
          (next() + (i == 1 ? 3 : 0)) * row;
    g[c[k]] = next() * row;
  }
  for (int k = 0; k < M && kind == WEIGHTLESS; k += 3) /* the coordinate that constraint k moves most */
    for (int i = 0; i < N; i++) m[q[2 * k + 1] * N + i] = m[i * N + q[2 * k + 1]] = 0;
  for (int i = 0; i < N && (kind == REDUNDANT || kind == CLOSE); i++)
    a[c[1] * N + i] = 2 * a[c[0] * N + i] * (1 + (kind == CLOSE ? 1e-7 * next() : 0));
  once = c[0], twice = c[1];
  if (kind == REDUNDANT || kind == CLOSE) g[c[1]] = 2 * g[c[0]];
  for (int i = 0; i < N * N && kind == DENSE; i++) m[i] += 1e-3 / N;
}

/* z[ALL] = x, l by elimination with partial pivoting. */
static void by_elimination(double *z)
{
  static long double k[ALL][ALL + 1];

  memset(k, 0, sizeof k);
  for (int i = 0; i < N; i++) {
    for (int j = 0; j < N; j++) k[i][j] = m[i * N + j];
    for (int j = 0; j < M; j++) k[N + j][i] = a[j * N + i], k[i][N + j] = -(long double)a[j * N + i];
    k[i][ALL] = f[i];
  }
  for (int j = 0; j < M; j++) k[N + j][ALL] = g[j];
  for (int c = 0; c < ALL; c++) {
    int top = c;
    for (int r = c; r < ALL; r++) top = fabsl(k[r][c]) > fabsl(k[top][c]) ? r : top;
    for (int j = 0; j <= ALL; j++) {
      long double was = k[c][j];
      k[c][j] = k[top][j], k[top][j] = was;
    }
    for (int r = 0; r < ALL; r++) {
      long double factor = r == c ? 0 : k[r][c] / k[c][c];
      for (int j = c; j <= ALL && factor != 0; j++) k[r][j] -= factor * k[c][j];
    }
  }
  for (int i = 0; i < ALL; i++) z[i] = (double)(k[i][ALL] / k[i][i]);
}

/* Whether the system is solved within a band; the solution of lag_kkt in z. */
static int ours(double *z)
{
  static double w[N * N + M * N + ALL + ROOM], x[N], l[M];

  memcpy(x, f, sizeof f), memcpy(l, g, sizeof g);
  const lag_entries whole = {0, 0, 0, 0, 0};
  int banded = lag_banded(N, M, m, a, &whole, x, l, w, ROOM);
  memcpy(w, m, sizeof m), memcpy(w + N * N, a, sizeof a), memcpy(w + N * N + M * N, f, sizeof f),
      memcpy(w + N * N + M * N + N, g, sizeof g);
  if (!lag_kkt(N, M, 0, w)) printf("refused\n");
  memcpy(z, w + N * N + M * N, ALL * sizeof *z);
  return banded;
}

/* The largest component of what equation i < ALL is off by, relative to its terms: in long double. */
static double residual(const double *z)
{
  double most = 0;

  for (int i = 0; i < ALL; i++) {
    long double sum = i < N ? -(long double)f[i] : -(long double)g[i - N], size = fabsl(sum);
    for (int j = 0; j < ALL; j++) {
      long double k = i < N ? j < N ? m[i * N + j] : -(long double)a[(j - N) * N + i] : j < N ? a[(i - N) * N + j] : 0;
      sum += k * z[j], size += fabsl(k * z[j]);
    }
    most = fmax(most, (double)(fabsl(sum) / size));
  }
  return most;
}

int main(void)
{
  int bad = 0;

  for (int kind = 0; kind < KINDS; kind++) {
    int singular = kind == REDUNDANT || kind == CLOSE, in_band = 0;
    double most = 0, off = 0;
    for (int n = 0; n < 20; n++) {
      double z[ALL], z0[ALL], size = 0, far = 0;
      make(kind);
      in_band += ours(z);
      by_elimination(z0);
      for (int i = 0; i < ALL && !singular; i++) {
        far = fmax(far, isfinite(z[i]) ? fabs(z[i] - z0[i]) : HUGE_VAL);
        size = fmax(size, fabs(z0[i]));
      }
      most = fmax(most, singular ? 0 : far / size);
      off = fmax(off, residual(z));
      /* of multipliers the least */
      if (kind == REDUNDANT) most = fmax(most, fabs(z[N + twice] - 2 * z[N + once]) / fabs(z[N + twice]));
    }
    /* Both round to the last digit times the condition of the system, of up to 1e4, and 1e12 for elimination in
     * other units; equations are met to rounding of their terms, those of a system that is singular but for 1e-7 to
     * 1e10 times that. */
    printf("%s: %d of 20 in a band, differs by %.1e, equations by %.1e\n", names[kind], in_band, most, off);
    bad |= in_band != (singular || kind == DENSE ? 0 : 20) || !(most < (kind == SCALED ? 1e-7 : 1e-11)) ||
           !(off < (kind == CLOSE ? 1e-6 : 1e-12));
  }
  return bad;
}
