"""The isospectral midpoint of QuFlow (Cifani, Viviani and Modin 2023) on problems of `sphere_cost`.

`isospectral.py FOLDER T N STEPS...` reads the matrices that `sphere_cost FOLDER T N` wrote, and
prints a line like those of its table for each number of steps: stopped where QuFlow stops by
default, at a change of sqrt(eps) |W| dt/hbar or after ten iterations, and with iterations to
round-off. QuFlow is https://github.com/klasmodin/quflow, by PYTHONPATH. OPENBLAS_NUM_THREADS=1 and
NUMBA_NUM_THREADS=1 give one thread.
"""

import sys
import time

import numpy as np
import quflow


def main():
    folder, t_end, n = sys.argv[1], float(sys.argv[2]), int(sys.argv[3])
    # Ours is dW/dt = -i[V, W] with V = sqrt(n(n^2 - 1)/16 pi) (-Laplacian)^-1 W: theirs is icW.
    scale = 1j * np.sqrt(n / (4 * np.pi))
    read = lambda name: scale * np.fromfile(f"{folder}/{name}{n}", np.complex128).reshape(n, n).T
    w, exact = read("start"), read("end")
    quflow.isomp(w.copy(), 1e-3, steps=1)
    a = np.linalg.eigvalsh(-1j * w)
    for steps in map(int, sys.argv[4:]):
        to_round_off = dict(tol=1e-15 * np.linalg.norm(w, np.inf), maxit=30)
        for name, how in [("stopped", {}), ("to round-off", to_round_off)]:
            start = time.process_time()
            end = quflow.isomp(w.copy(), t_end / steps, steps=steps, **how)
            seconds = time.process_time() - start
            error = np.linalg.norm(end - exact) / np.linalg.norm(exact)
            b = np.linalg.eigvalsh(-1j * end) if np.isfinite(end).all() else a * np.nan
            drift = max(abs((b**k).sum() / (a**k).sum() - 1) for k in (2, 4))
            apart = abs(a - b).max() / abs(a).max()
            print(f"{n} QuFlow {steps}, {name}: error {error:.2e}, {seconds:.3f} s, tr W^2, W^4 to "
                  f"{drift:.1e}, eigenvalues to {apart:.1e}", flush=True)


main()
