"""The isospectral midpoint of QuFlow (Cifani, Viviani and Modin 2023) in NumPy and Numba.

`isospectral.py FOLDER N...` runs the problems of `sphere_cost` and prints the same table, on one
thread with OPENBLAS_NUM_THREADS=1. Fixed-point iteration as in QuFlow's `isomp_fixedpoint`.
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


def run(w, steps, t_end):
    n = len(w)
    h = t_end / steps
    scale = np.sqrt(n * (n * n - 1) / (16 * np.pi))
    p = np.empty_like(w)
    w = w.copy()
    change = np.zeros_like(w)
    tolerance = 1e-15 * np.linalg.norm(w, np.inf)
    for _ in range(steps):
        last = np.inf
        for _ in range(30):
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
    folder, sizes = sys.argv[1], map(int, sys.argv[2:])
    for n in sizes:
        read = lambda name: np.fromfile(f"{folder}/{name}{n}", np.complex128).reshape(n, n).T.copy()
        w, exact = read("start"), read("end")
        run(w, 1, 0.1)
        for steps in [200, 400, 800, 1600]:
            start = time.perf_counter()
            end = run(w, steps, 10.0)
            seconds = time.perf_counter() - start
            error = np.linalg.norm(end - exact) / np.linalg.norm(exact)
            if not np.isfinite(end).all():
                print(f"{n} NumPy {steps}: the iteration does not converge")
                continue
            a, b = np.linalg.eigvalsh(w), np.linalg.eigvalsh(end)
            drift = max(abs((b**k).sum() / (a**k).sum() - 1) for k in (2, 4))
            print(f"{n} NumPy {steps}: error {error:.2e}, {seconds:.3f} s, tr W^2, W^4 to {drift:.1e}")


main()
