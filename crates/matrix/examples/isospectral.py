"""The isospectral midpoint of QuFlow (Cifani, Viviani and Modin 2023) in NumPy and Numba.

`isospectral.py FOLDER T N...` runs the problems of `sphere_cost` and prints the same table, on one
thread with OPENBLAS_NUM_THREADS=1. Fixed-point iteration as in QuFlow's `isomp_fixedpoint`, to
round-off, and stopped where QuFlow stops unless told otherwise: at a change of
sqrt(eps) |W| tau sqrt(N^2 - 1)/2, or after ten iterations.
"""

import sys
import time

import numba
import numpy as np


@numba.njit(cache=True)
def stream(w, p, n, factor):
    """p = factor (-Laplacian)^-1 w for a Hermitian w, diagonal by diagonal."""
    s = 0.5 * (n - 1)
    d = np.empty(n, np.complex128)
    c = np.empty(n)
    for m in range(n):
        length = n - m
        for j in range(length):
            b = 2 * (s * (s + 1) - (s - j) * (s - j - m))
            if m == 0 and j == n - 1:
                b += 1.0  # fixes the mean
            before = 0.0
            if j > 0:
                a = np.sqrt(j * (n - j) * (j + m) * (n - j - m) * 1.0)
                b -= a * c[j - 1]
                before = a
            if j + 1 < length:
                c[j] = np.sqrt((j + 1) * (n - 1 - j) * (j + 1 + m) * (n - 1 - j - m) * 1.0) / b
            d[j] = (w[j, j + m] + (before * d[j - 1] if j > 0 else 0.0)) / b
        for j in range(length - 2, -1, -1):
            d[j] += c[j] * d[j + 1]
        mean = 0.0j
        if m == 0:
            for j in range(n):
                mean += d[j] / n
        for j in range(length):
            x = factor * (d[j] - mean)
            p[j, j + m] = x
            p[j + m, j] = -np.conj(x)


def run(w, steps, t_end, converged=True):
    n = len(w)
    h = t_end / steps
    scale = np.sqrt(n * (n * n - 1) / (16 * np.pi))
    p = np.empty_like(w)
    w = w.copy()
    change = np.zeros_like(w)
    size, most = 1e-15, 30
    if not converged:
        size, most = np.sqrt(np.finfo(float).eps) * h * np.sqrt(n * n - 1) / 2, 10
    tolerance = size * np.linalg.norm(w, np.inf)
    for _ in range(steps):
        last = np.inf
        for _ in range(most):
            half = w + change
            stream(half, p, n, -0.5j * h * scale)
            pw = p @ half
            turn = pw + pw.conj().T
            new = turn + pw @ p
            error = np.linalg.norm(new - change, np.inf)
            change = new
            if error <= tolerance or error >= last:
                break
            last = error
        w += 2 * turn
    return w


def main():
    folder, t_end, sizes = sys.argv[1], float(sys.argv[2]), map(int, sys.argv[3:])
    for n in sizes:
        read = lambda name: np.fromfile(f"{folder}/{name}{n}", np.complex128).reshape(n, n).T.copy()
        w, exact = read("start"), read("end")
        run(w, 1, 1e-3)
        a = np.linalg.eigvalsh(w)
        for steps, converged in [(s, c) for s in [200, 400, 800, 1600, 3200] for c in [True, False]]:
            steps = int(np.ceil(steps * t_end / 10))
            start = time.process_time()
            end = run(w, steps, t_end, converged)
            seconds = time.process_time() - start
            error = np.linalg.norm(end - exact) / np.linalg.norm(exact)
            name = f"{n} NumPy {steps}, {'converged' if converged else 'stopped'}"
            if not (np.isfinite(end).all() and error < 10):
                print(f"{name}: the iteration does not converge")
                continue
            b = np.linalg.eigvalsh(end)
            drift = max(abs((b**k).sum() / (a**k).sum() - 1) for k in (2, 4))
            apart = abs(a - b).max() / abs(a).max()
            print(f"{name}: error {error:.2e}, {seconds:.3f} s, tr W^2, W^4 to {drift:.1e},"
                  f" eigenvalues to {apart:.1e}", flush=True)


main()
