# The three of 31 times with the largest determinant for run_design.sh, by a search over all subsets of closed forms: x = x0 cos(sqrt(k/m) t), sigma
# 0.01; y = t v0, which says nothing of k, x0, m. What is known of m: 0.3.
import itertools
import math


def row(t, k=8, m=2, x0=0.5, sigma=0.01):
    w = math.sqrt(k / m)
    c, s = math.cos(w * t), math.sin(w * t)
    return [-x0 * t * s * w / (2 * k) / sigma, c / sigma, x0 * t * s * w / (2 * m) / sigma]


def information(rows):
    M = [[sum(r[i] * r[j] for r in rows) for j in range(3)] for i in range(3)]
    M[2][2] += 1 / 0.3**2
    return M


def det(M):
    return sum(M[0][i] * (M[1][(i + 1) % 3] * M[2][(i + 2) % 3] - M[1][(i + 2) % 3] * M[2][(i + 1) % 3]) for i in range(3))


def minor(M, i):
    a, b = [j for j in range(3) if j != i]
    return M[a][a] * M[b][b] - M[a][b] * M[b][a]


times = [k / 10 for k in range(31)]
rows = [row(t) for t in times]
best = max(itertools.combinations(range(31), 3), key=lambda c: det(information([rows[i] for i in c])))
M = information([rows[i] for i in best])
print(" ".join("x@%.3g" % times[i] for i in best))
for i, name in enumerate(["k", "x0", "m"]):
    print(name, repr(math.sqrt(minor(M, i) / det(M))))
