"""Energy of a fluid on a sphere under isotropic noise of degree 2 alone, by its second moments.

`moments.py` prints a known answer (N = 5, t = 1: 0.1459460860), and the energies of the scene
`stirred-sphere` at t = 0, 1, 2, 4 without H0. The moments P = E ww' of the coefficients w obey
P' = (KP + PK')/2 + sum APA' with K = sum AA and A the action of each noise.
"""

import numpy as np


def harmonics(n):
    """Real harmonics by (degree, order): eigenmatrices of the Laplacian on each diagonal."""
    s = (n - 1) / 2
    up = np.diag(np.sqrt(np.arange(1.0, n) * np.arange(n - 1.0, 0, -1)), 1)
    spins = [(up + up.T) / 2, (up - up.T) / 2j, np.diag(s - np.arange(n))]
    turn = lambda a, w: a @ w - w @ a
    found = {}
    for m in range(n):
        laplacian = np.zeros((n - m, n - m))
        for j in range(n - m):
            w = np.zeros((n, n), complex)
            w[j, j + m] = 1
            laplacian[:, j] = np.diag(sum(turn(a, turn(a, w)) for a in spins), m).real
        for q, t in enumerate(np.linalg.eigh(laplacian)[1].T):
            w = np.diag(t * np.sign(t[0]), m).astype(complex)
            if m == 0:
                found[q, 0] = w
            else:
                found[m + q, m] = (w + w.conj().T) / np.sqrt(2)
                found[m + q, -m] = (w - w.conj().T) / (np.sqrt(2) * 1j)
    return found


def energies(n, strength, times, coefficients, h):
    """Mean energies at times, which are multiples of h, by the rule of Runge and Kutta."""
    t, orders = harmonics(n), [(l, m) for l in range(1, n) for m in range(-l, l + 1)]
    basis = np.array([t[key].ravel() for key in orders])
    strength *= np.sqrt(n * (n * n - 1) / (16 * np.pi))
    bracket = lambda x: np.array([(-1j * (x @ t[k] - t[k] @ x)).ravel() for k in orders])
    noises = [strength * (basis.conj() @ bracket(t[2, m]).T).real for m in range(-2, 3)]
    half = 0.5 * sum(a @ a for a in noises)
    field = lambda p: half @ p + p @ half.T + sum(a @ p @ a.T for a in noises)
    w = np.zeros(len(orders))
    w[: len(coefficients)] = coefficients
    p, weights, found = np.outer(w, w), [0.5 / (l * (l + 1)) for l, _ in orders], []
    for step in range(round(max(times) / h) + 1):
        if any(abs(step * h - time) < h / 2 for time in times):
            found.append(float(weights @ np.diag(p)))
        a = field(p)
        b = field(p + h / 2 * a)
        c = field(p + h / 2 * b)
        p = p + h / 6 * (a + 2 * b + 2 * c + field(p + h * c))
    return found


print(energies(5, np.sqrt(16 * np.pi / 120), [1], [0, 1, 0], 0.002))
print(energies(8, 0.3, [0, 1, 2, 4], [0, 1, 0, 0, 0, 0, 0.8, 0, 0.5, 0, 0, 0, 0, 0.7, 0], 0.01))
