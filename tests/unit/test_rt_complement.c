/* lag_solve_complementarity: problems solved by hand; random ones against all 3^n choices of
 * bounds, or against the properties that define a solution; problems without solution, with
 * several, with dependent rows. The sweeps of kernels/impulses.h against it and lag_contact_modes. */
#include "test_rt_models.h"

#include "contacts/contact_modes.h"
#include "kernels/impulses.h"
#include "numeric/complementarity.h"

enum { MOST = 8 };

/* A number in [-1, 1), the same in each run: D. Knuth's generator (MMIX). */
static double chance(uint64_t *state) {
  *state = *state * 6364136223846793005u + 1442695040888963407u;
  return (double)(*state >> 11) * 0x1p-52 - 1;
}

/* M = J J^T of rank at most `rank`, as of contacts of which some depend on others. */
static void gram(int n, int rank, uint64_t *seed, double *M) {
  double J[MOST][MOST];
  for (int i = 0; i < n; i++)
    for (int k = 0; k < rank; k++) J[i][k] = chance(seed);
  for (int i = 0; i < n * n; i++) {
    M[i] = 0;
    for (int k = 0; k < rank; k++) M[i] += J[i / n][k] * J[i % n][k];
  }
}

/* gram, and a skew part with which M is monotone but not symmetric. */
static void monotone(int n, int rank, uint64_t *seed, double *M) {
  gram(n, rank, seed, M);
  for (int i = 0; i < n; i++)
    for (int j = 0; j < i; j++) {
      double skew = chance(seed);
      M[i * n + j] += skew;
      M[j * n + i] -= skew;
    }
}

typedef struct Problem {
  int n;
  double M[MOST * MOST], q[MOST], z[MOST], w[MOST];
  lag_box box[MOST];
  unsigned char at[MOST]; /* where the search begins and ends */
} Problem;

/* z, w by lag_solve_complementarity; w from z and the problem as it was given. */
static int solve(Problem *p, lag_complementarity *of) {
  static double T[MOST * MOST], scale[MOST];
  memcpy(T, p->M, sizeof T);
  memcpy(p->z, p->q, sizeof p->z);
  *of = (lag_complementarity){p->n, -1, T, p->z, scale, p->box, p->at, 1e-10, 1e-13};
  int status = lag_solve_complementarity(of);
  for (int i = 0; i < p->n; i++) {
    p->w[i] = p->q[i];
    for (int j = 0; j < p->n; j++) p->w[i] += p->M[i * p->n + j] * p->z[j];
  }
  return status;
}

/* The definition; error: of z and w, rounding as pivots magnify it. */
static void assert_solution(const Problem *p, double error) {
  for (int i = 0; i < p->n; i++) {
    double z = p->z[i], w = p->w[i];
    assert_true(z >= p->box[i].lower - error && z <= p->box[i].upper + error);
    if (p->at[i] == LAG_BETWEEN) assert_true(fabs(w) <= error);
    if (p->at[i] == LAG_AT_LOWER) assert_true(w >= -error);
    if (p->at[i] == LAG_AT_UPPER) assert_true(w <= error);
  }
}

/* x := A^-1 b by Cramer's rule for n <= 4, det by cofactors. Returns det. */
static double det(int n, const double *A) {
  double sum = 0, B[9];
  if (n == 0) return 1;
  for (int c = 0; c < n; c++) {
    for (int i = 1, k = 0; i < n; i++)
      for (int j = 0; j < n; j++)
        if (j != c) B[k++] = A[i * n + j];
    sum += (c % 2 ? -1 : 1) * A[c] * det(n - 1, B);
  }
  return sum;
}

/* Tries choice[n] (0 lower, 1 between, 2 upper); z[n] := that solution. 0: it is none. */
static int is_solution(const Problem *p, const int *choice, double *z) {
  int n = p->n, m = 0, of[4];
  double A[16], b[4], D[16], d;
  for (int i = 0; i < n; i++) {
    z[i] = choice[i] == 0 ? p->box[i].lower : choice[i] == 2 ? p->box[i].upper : 0;
    if (choice[i] == 1) of[m++] = i;
  }
  for (int a = 0; a < m; a++) {
    b[a] = -p->q[of[a]];
    for (int j = 0; j < n; j++) b[a] -= p->M[of[a] * n + j] * z[j];
    for (int c = 0; c < m; c++) A[a * m + c] = p->M[of[a] * n + of[c]];
  }
  if ((d = det(m, A)) == 0) return 0;
  for (int a = 0; a < m; a++) {
    memcpy(D, A, sizeof D);
    for (int c = 0; c < m; c++) D[c * m + a] = b[c];
    z[of[a]] = det(m, D) / d;
  }
  for (int i = 0; i < n; i++) {
    double w = p->q[i];
    for (int j = 0; j < n; j++) w += p->M[i * n + j] * z[j];
    if (choice[i] == 0 ? w < 0 : choice[i] == 2 ? w > 0 : z[i] < p->box[i].lower || z[i] > p->box[i].upper) return 0;
  }
  return 1;
}

/* Boxes in a plane of bounds, M of positive principal minors: one of the 3^n choices fits, which
 * is found from any begin. */
static void test_all_choices(void **state) {
  (void)state;
  uint64_t seed = 3;
  for (int k = 0; k < 600; k++) {
    Problem p = {.n = 1 + k % 4};
    int count = 0, all = p.n == 1 ? 3 : p.n == 2 ? 9 : p.n == 3 ? 27 : 81;
    double z[4], found[4] = {0};
    lag_complementarity of;
    monotone(p.n, p.n, &seed, p.M);
    for (int i = 0; i < p.n; i++) {
      p.q[i] = 2 * chance(&seed);
      p.M[i * p.n + i] += 0.1;
      p.box[i] = (lag_box){-1 - chance(&seed), 1 + chance(&seed), 0, 0};
      if (i > 1) p.box[i] = (lag_box){0, i > 2 ? HUGE_VAL : 1, 0, 0};
      p.at[i] = i > 2 || k % 2 ? LAG_AT_LOWER : chance(&seed) > 0 ? LAG_BETWEEN : LAG_AT_UPPER;
    }
    for (int c = 0; c < all; c++) {
      int choice[4] = {c % 3, c / 3 % 3, c / 9 % 3, c / 27};
      if (p.n == 4 && choice[3] == 2) continue; /* infinite */
      if (!is_solution(&p, choice, z)) continue;
      count++;
      memcpy(found, z, sizeof found);
    }
    assert_int_equal(count, 1);
    assert_int_equal(solve(&p, &of), LAG_SOLVED);
    for (int i = 0; i < p.n; i++) assert_true(fabs(p.z[i] - found[i]) <= 1e-10); /* minors are above 0.1^n */
  }
}

/* Contacts of any rank: what is found obeys the definition; a regular matrix has a solution for
 * each q. */
static void test_contacts(void **state) {
  (void)state;
  uint64_t seed = 1;
  int solved = 0, full = 0;
  for (int k = 0; k < 4000; k++) {
    Problem p = {.n = 1 + k % MOST};
    int rank = 1 + k / MOST % p.n;
    lag_complementarity of;
    full += rank == p.n;
    gram(p.n, rank, &seed, p.M);
    for (int i = 0; i < p.n; i++) {
      p.q[i] = chance(&seed);
      p.box[i] = (lag_box){0, HUGE_VAL, 0, 0};
    }
    int status = solve(&p, &of);
    if (status == LAG_SOLVED) assert_solution(&p, 1e-6); /* random pivots are mostly far from 1e-10 */
    else assert_true(status == LAG_NO_SOLUTION && rank < p.n);
    solved += status == LAG_SOLVED;
  }
  assert_true(solved >= full && solved > 2000);
}

/* Two-sided boxes of any rank always have a solution, also where dependent rows make it one of
 * many. */
static void test_dependent_boxes(void **state) {
  (void)state;
  uint64_t seed = 5;
  for (int k = 0; k < 2000; k++) {
    Problem p = {.n = 1 + k % 6};
    lag_complementarity of;
    monotone(p.n, k / 6 % p.n, &seed, p.M);
    if (k % 2) gram(p.n, k / 6 % p.n, &seed, p.M);
    for (int i = 0; i < p.n; i++) {
      p.q[i] = chance(&seed);
      p.box[i] = (lag_box){-1, 1, 0, 0};
    }
    assert_int_equal(solve(&p, &of), LAG_SOLVED);
    assert_solution(&p, 1e-6);
  }
}

/* Two contacts on both sides of a body: w_1 = q_1 + z_1 - z_2, w_2 = q_2 - z_1 + z_2; both at
 * least 0 only where q_1 + q_2 is. */
static void test_squeezed(void **state) {
  (void)state;
  const double q[][2] = {{-1, -1}, {-1, 0.5}, {-1, 1}, {-1, 2}, {2, -1}, {1, 1}};
  const int status[] = {LAG_NO_SOLUTION, LAG_NO_SOLUTION, LAG_SOLVED, LAG_SOLVED, LAG_SOLVED, LAG_SOLVED};
  for (int k = 0; k < 6; k++) {
    Problem p = {2, {1, -1, -1, 1}, {q[k][0], q[k][1]}, {0}, {0}, {{0, HUGE_VAL, 0, 0}, {0, HUGE_VAL, 0, 0}}, {0}};
    lag_complementarity of;
    assert_int_equal(solve(&p, &of), status[k]);
    if (status[k] != LAG_SOLVED) continue;
    assert_close(p.w[0] + p.w[1], q[k][0] + q[k][1], 1e-15);
    assert_true(p.z[0] >= 0 && p.z[1] >= 0 && fmin(p.z[0], p.w[0]) == 0 && fmin(p.z[1], p.w[1]) == 0);
  }
}

/* One contact, three times: the least index pushes, the others follow from it, whatever their
 * scale. */
static void test_follows(void **state) {
  (void)state;
  double M[] = {4, 8, -2e-3, 8, 16, -4e-3, -2e-3, -4e-3, 1e-6}, x[] = {-2, -4, 1e-3}, scale[3];
  unsigned char at[3];
  lag_complementarity of = lag_contact_complementarity(3, M, x, scale, at);
  assert_int_equal(lag_solve_complementarity(&of), LAG_SOLVED);
  assert_true(at[0] == LAG_BETWEEN && at[1] == LAG_AT_LOWER && at[2] == LAG_AT_LOWER);
  assert_close(x[0], 0.5, 1e-15);
  assert_true(M[4] <= of.zero && M[8] <= of.zero && M[0] > of.zero);
}

/* Friction of one body, w = pull + force, the mode -1..1: it is held up to 1, with a reserve of
 * 0.5 up to 1.5; beyond it slips under 1. */
static void test_reserve(void **state) {
  (void)state;
  const double pull[] = {0.5, 1.2, -1.2, 1.7, -1.7}, z[] = {-0.5, -1.2, 1.2, -1, 1};
  for (int k = 0; k < 5; k++) {
    Problem p = {1, {1}, {pull[k]}, {0}, {0}, {{-1, 1, 0.5, 0}}, {LAG_BETWEEN}};
    lag_complementarity of;
    assert_int_equal(solve(&p, &of), LAG_SOLVED);
    assert_close(p.z[0], z[k], 1e-15);
  }
}

/* A surface that the motion only crosses, beside one on which it slides: w_1 = 0.5 + z_1, w_2 =
 * 0.2 - z_1: z_1 = -0.5, so w_2 > 0, z_2 = -1. A surface alone that the motion leaves to both
 * sides, w = -z, has no motion between. */
static void test_switches(void **state) {
  (void)state;
  Problem p = {2, {1, 0, -1, 0}, {0.5, 0.2}, {0}, {0}, {{-1, 1, 0, 0}, {-1, 1, 0, 1}}, {LAG_BETWEEN, LAG_AT_UPPER}};
  Problem both = {1, {-1}, {0}, {0}, {0}, {{-1, 1, 0, 0}}, {LAG_BETWEEN}};
  lag_complementarity of;
  assert_int_equal(solve(&p, &of), LAG_SOLVED);
  assert_true(p.at[0] == LAG_BETWEEN && p.at[1] == LAG_AT_LOWER);
  assert_close(p.z[0], -0.5, 1e-15);
  assert_int_equal(solve(&both, &of), LAG_NOT_MONOTONE);
  both.q[0] = -2;
  both.at[0] = LAG_AT_LOWER;
  assert_int_equal(solve(&both, &of), LAG_NOT_MONOTONE);
}

/* The largest least of `limits` values a[k] + slope[k] c over all c, by all pairs that cross. */
static double best_of_lines(int limits, const double *a, const double *slope) {
  double best = -HUGE_VAL;
  for (int i = 0; i < limits; i++)
    for (int k = 0; k < limits; k++) {
      double c = slope[i] == slope[k] ? 0 : (a[i] - a[k]) / (slope[k] - slope[i]), least = HUGE_VAL;
      for (int j = 0; j < limits; j++) least = fmin(least, a[j] + slope[j] * c);
      best = fmax(best, least);
    }
  return best;
}

/* Forces that one direction shifts, as of a body wedged between two surfaces: the best margin
 * against all crossings of its limits. */
static void test_margins(void **state) {
  (void)state;
  uint64_t seed = 11;
  for (int k = 0; k < 300; k++) {
    int n = 1 + k % 3, limits = 0;
    lag_touch of[3];
    double x[6], D[6], c[2], a[7], slope[7], size = 0;
    for (int i = 0; i < 2 * n; i++) {
      x[i] = chance(&seed) + (i < n ? 1 : 0);
      D[i] = chance(&seed);
    }
    for (int i = 0; i < n; i++) {
      int sticks = k % 2 || i;
      of[i] = (lag_touch){.mu = 0.5, .tangent = n + i, .mode = sticks ? LAG_CONTACT_STICKS : LAG_CONTACT_SLIPS};
      for (int side = -1; side <= sticks; side += 2) {
        a[limits] = (sticks ? 0.5 : 1) * x[i] + (sticks ? side * x[n + i] : 0);
        slope[limits++] = (sticks ? 0.5 : 1) * D[i] + (sticks ? side * D[n + i] : 0);
      }
    }
    for (int j = 0; j < limits; j++) size = fmax(size, fabs(a[j]));
    int wedged = lag_cone_forces(n, of, 2 * n, x, 1, D, c);
    double margin = c[1];
    a[limits] = size; /* the size of the forces bounds their margin, too */
    slope[limits++] = 0;
    assert_true(fabs(margin - best_of_lines(limits, a, slope)) <= 1e-11); /* rounding of a crossing */
    assert_true(wedged == (margin >= size * (1 - 1e-11)));
  }
}

/* ---- the same problems by sweeps */

/* Sweeps over rows whose response is M = A A^T, A[n][n] the triangular factor of a random one, from v = 0. */
enum { LARGE = 16 };
typedef struct Sweeps {
  int n;
  double M[LARGE * LARGE], A[LARGE * LARGE], first[LARGE + 1], col[LARGE * LARGE];
  double b[LARGE], P[LARGE], v[LARGE], response[LARGE], was[LARGE], went[LARGE];
} Sweeps;

static void begin_sweeps(Sweeps *s, int n, uint64_t *seed) {
  *s = (Sweeps){.n = n};
  for (int e = 0; e < n * n; e++) {
    s->A[e] = (e / n == e % n) + fmin(0.5, 2.0 / n) * chance(seed);
    s->col[e] = e % n;
  }
  for (int i = 0; i <= n; i++) s->first[i] = i * n;
  for (int e = 0; e < n * n; e++)
    for (int k = 0; k < n; k++) s->M[e] += s->A[e / n * n + k] * s->A[e % n * n + k];
  for (int i = 0; i < n; i++) s->response[i] = s->M[i * n + i];
}

static int sweep(Sweeps *s, int contacts, lag_pressing *of) {
  const lag_sparse_rows rows = {s->first, s->col, s->A};
  const lag_impulses impulses = {contacts, of, rows, rows, s->response, s->b, s->P, s->v, s->was, s->went, 0, 0, NULL};
  return lag_contact_impulses(&impulses, 1e-14, 100000) <= 100000;
}

/* Contacts without friction, by sweeps and by pivoting. */
static void test_sweeps_of_contacts(void **state) {
  (void)state;
  uint64_t seed = 21;
  for (int k = 0; k < 200; k++) {
    Sweeps s;
    Problem p = {.n = 1 + k % 4};
    lag_pressing of[4];
    lag_complementarity solver;
    begin_sweeps(&s, p.n, &seed);
    memcpy(p.M, s.M, sizeof p.M);
    for (int i = 0; i < p.n; i++) {
      of[i] = (lag_pressing){.contact = i, .row = i};
      p.q[i] = s.b[i] = chance(&seed);
      p.box[i] = (lag_box){0, HUGE_VAL, 0, 0};
    }
    assert_true(sweep(&s, p.n, of));
    assert_int_equal(solve(&p, &solver), LAG_SOLVED);
    for (int i = 0; i < p.n; i++)
      assert_true(fabs(s.P[i] - p.z[i]) <= 1e-9 * (1 + p.z[i])); /* 1e-14 by the condition of M */
  }
}

/* Contacts with friction at rest, by sweeps and by all of their modes; seven and eight by changes of one mode at a
 * time. */
static void test_sweeps_of_friction(void **state) {
  (void)state;
  uint64_t seed = 22;
  int sticks = 0, slips = 0, large = 0;
  for (int k = 0; k < 300; k++) {
    Sweeps s;
    int n = k % 3 == 2 ? 7 + k % 2 : 1 + k % 2, rows = 2 * n;
    double mu = k % 4 || n > 2 ? 0.3 : 3; /* 3: friction moves the gap by more than what presses */
    lag_touch touch[LARGE / 2];
    lag_pressing of[LARGE / 2];
    double W[LARGE * LARGE], pull[LARGE], x[LARGE], room[LARGE * (LARGE + 5)];
    begin_sweeps(&s, rows, &seed);
    for (int i = 0; i < rows; i++) s.b[i] = chance(&seed) - (i % 2 ? 0 : 1);
    for (int i = 0; i < rows; i++) { /* gaps first */
      int of_i = i < n ? 2 * i : 2 * (i - n) + 1;
      pull[i] = s.b[of_i];
      for (int j = 0; j < rows; j++) W[i * rows + j] = s.M[of_i * rows + (j < n ? 2 * j : 2 * (j - n) + 1)];
    }
    for (int i = 0; i < n; i++) {
      touch[i] = (lag_touch){.mu = mu, .tangent = n + i};
      of[i] = (lag_pressing){.contact = i, .row = 2 * i, .tangents = 1, .mu = mu, .hold = mu};
    }
    if (lag_contact_modes(n, touch, rows, W, pull, x, room) != 1) continue;
    assert_true(sweep(&s, n, of));
    large += n > LAG_TRIED_TOUCHES;
    for (int i = 0; i < n; i++) {
      double near = 1e-9 * (1 + fabs(x[i])); /* 1e-12 of contact_modes by the condition of W */
      assert_true(fabs(s.P[2 * i] - x[i]) <= near && fabs(s.P[2 * i + 1] - x[n + i]) <= near);
      sticks += touch[i].mode == LAG_CONTACT_STICKS;
      slips += touch[i].mode == LAG_CONTACT_SLIPS;
    }
  }
  assert_true(sticks > 50 && slips > 50 && large > 90);
}

/* A body in space that closes with 2 m/s and slips with (3, 4) m/s, responses 1 along the gap and 2 along both
 * tangents: 2.5 of friction stops it, of 2 mu at most, whatever the guess. */
static void test_friction_in_space(void **state) {
  (void)state;
  const double mu[] = {1.5, 0.5}, along[] = {-1.5, -0.6}, across[] = {-2, -0.8};
  for (int k = 0; k < 2; k++) {
    Sweeps s = {.n = 3, .A = {1, 0, 0, 0, sqrt(2), 0, 0, 0, sqrt(2)}, .first = {0, 3, 6, 9}};
    const double col[] = {0, 1, 2, 0, 1, 2, 0, 1, 2}, rate[] = {-2, 3, 4}, guess[] = {7, 1, 5}, response[] = {1, 2, 2};
    memcpy(s.col, col, sizeof col);
    memcpy(s.b, rate, sizeof rate);
    memcpy(s.P, guess, sizeof guess);
    memcpy(s.response, response, sizeof response);
    lag_pressing of = {.tangents = 2, .mu = mu[k], .hold = mu[k]};
    assert_true(sweep(&s, 1, &of));
    assert_close(s.P[0], 2, 1e-14);
    assert_close(s.P[1], along[k], 1e-13);
    assert_close(s.P[2], across[k], 1e-13);
  }
}

/* Instance of kernels/joint_friction.h: slips that are linear in modes. */
static int slips_of(const Problem *p, double *slip) {
  for (int k = 0; k < p->n; k++) {
    slip[k] = -p->q[k];
    for (int j = 0; j < p->n; j++) slip[k] -= p->M[k * p->n + j] * p->z[j];
  }
  return 0;
}
#define LAG_MODEL const Problem *problem
#define LAG_THE_MODEL problem
#define LAG_JOINTS(w) (w)->n
#define LAG_HOLD(w, j, value) (w)->mode[j] = value
#define LAG_SLIPS(t, y, x, w, g) ((void)(t), (void)(y), slips_of(problem, g))
#define LAG_GRIPS(t, y, w, g) 0
#define LAG_MODE_RATES(t, y, w, k) ((void)problem, 0)
#define LAG_FRICTION_FAILS(t, j, words) -1
#include "kernels/joint_friction.h"

/* Surfaces of dry friction, by sweeps and by pivoting; a mode is 1 where the slip is positive, so w = -slip. */
static void test_sweeps_of_surfaces(void **state) {
  (void)state;
  uint64_t seed = 23;
  for (int k = 0; k < 200; k++) {
    Sweeps s;
    Problem p = {.n = 1 + k % 4}, q;
    double room[LAG_JOINT_ROOM(4, 0)] = {0}, size;
    const lag_kick step = {.epsilon = 0x1p-52};
    lag_joint_friction of = {.n = p.n};
    lag_complementarity solver;
    begin_sweeps(&s, p.n, &seed);
    memcpy(p.M, s.M, sizeof p.M);
    for (int i = 0; i < p.n; i++) {
      p.q[i] = 2 * chance(&seed);
      p.box[i] = (lag_box){-1, 1, 0, 0};
    }
    q = p;
    lag_joints_place(&of, room);
    of.mode = q.z;
    for (int i = 0; i < p.n; i++) of.response[i] = -s.response[i], of.bound[i] = of.grip[i] = 1;
    assert_int_equal(lag_joints_solve(&q, &of, &step, 0, &size), 0);
    assert_int_equal(solve(&p, &solver), LAG_SOLVED);
    for (int i = 0; i < p.n; i++) {
      assert_true(fabs(q.z[i] - p.z[i]) <= 1e-7); /* sweeps may end at changes of 2e-9, if slow */
      assert_true(of.sticks[i] == (p.at[i] == LAG_BETWEEN));
    }
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_all_choices), cmocka_unit_test(test_contacts), cmocka_unit_test(test_dependent_boxes),
      cmocka_unit_test(test_squeezed), cmocka_unit_test(test_follows), cmocka_unit_test(test_reserve),
      cmocka_unit_test(test_switches), cmocka_unit_test(test_margins), cmocka_unit_test(test_sweeps_of_contacts),
      cmocka_unit_test(test_sweeps_of_friction), cmocka_unit_test(test_friction_in_space),
      cmocka_unit_test(test_sweeps_of_surfaces)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
