/* BAOAB at a fixed step, one thread: the price of stationary averages without a bound of the bias.
 *
 *     gcc -O3 -march=native -ffast-math -DPROBLEM=0 baoab.c -o baoab -lm && ./baoab 0.1 1e-3
 *
 * Runs one chain until both averages have this half-width of a 95 % interval. PROBLEM is 0 for a
 * double well (q² and p²), 1 for a pendulum (cos q and p²), 2 for ten masses with quartic springs
 * (q₅² and p₅²); friction 1 and kT = 1. The scenes are in docs/measurements.md. */
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#ifndef PROBLEM
#define PROBLEM 0
#endif
#define N (PROBLEM == 2 ? 10 : 1)

/* xoshiro256++ (Blackman and Vigna) and Marsaglia's polar method. */
static uint64_t s[4] = {1, 2, 3, 4};
static inline uint64_t turned(uint64_t x, int k) { return (x << k) | (x >> (64 - k)); }
static inline double uniform(void) {
    uint64_t word = turned(s[0] + s[3], 23) + s[0], t = s[1] << 17;
    s[2] ^= s[0], s[3] ^= s[1], s[1] ^= s[2], s[0] ^= s[3], s[2] ^= t, s[3] = turned(s[3], 45);
    return ((word >> 11) + 0.5) * 0x1p-53;
}
static inline double normal(void) {
    static double spare;
    static int has;
    if (has) { has = 0; return spare; }
    double u, v, r;
    do { u = 2 * uniform() - 1, v = 2 * uniform() - 1, r = u * u + v * v; } while (r >= 1 || r == 0);
    double factor = sqrt(-2 * log(r) / r);
    return has = 1, spare = v * factor, u * factor;
}

static double q[10], p[10], f[10];
static inline void force(void) {
#if PROBLEM == 0
    f[0] = -4 * q[0] * (q[0] * q[0] - 1);
#elif PROBLEM == 1
    f[0] = -sin(q[0]);
#else
    for (int i = 0; i < N; i++) f[i] = -q[i];
    for (int i = 0; i + 1 < N; i++) {
        double d = q[i + 1] - q[i], g = d * d * d;
        f[i] += g, f[i + 1] -= g;
    }
#endif
}

int main(int count, char **words) {
    double tau = count > 1 ? atof(words[1]) : 0.1, accuracy = count > 2 ? atof(words[2]) : 1e-3;
    double decay = exp(-tau), noise = sqrt(1 - decay * decay);
    static double means[2][1 << 16];
    const long length = 20000;
    clock_t start = clock();
    for (int i = 0; i < N; i++) q[i] = PROBLEM == 2 ? 0.1 : 1;
    force();
    for (int n = 1; n <= 1 << 16; n++) {
        double sums[2] = {0, 0};
        for (long k = 0; k < length; k++) {
            for (int i = 0; i < N; i++) {
                p[i] += 0.5 * tau * f[i], q[i] += 0.5 * tau * p[i];
                p[i] = decay * p[i] + noise * normal();
                q[i] += 0.5 * tau * p[i];
            }
            force();
            for (int i = 0; i < N; i++) p[i] += 0.5 * tau * f[i];
            int one = PROBLEM == 2 ? 4 : 0;
            sums[0] += PROBLEM == 1 ? cos(q[0]) : q[one] * q[one], sums[1] += p[one] * p[one];
        }
        for (int k = 0; k < 2; k++) means[k][n - 1] = sums[k] / length;
        if (n < 64 || n % 16) continue;
        double mean[2], half[2];
        for (int k = 0; k < 2; k++) {
            double sum = 0, square = 0;
            for (int j = 0; j < n; j++) sum += means[k][j];
            mean[k] = sum / n;
            for (int j = 0; j < n; j++) square += pow(means[k][j] - mean[k], 2);
            half[k] = 1.96 * sqrt(square / (n - 1.0) / n);
        }
        if (half[0] > accuracy || half[1] > accuracy) continue;
        printf("%.5f ± %.1e, %.5f ± %.1e; %.2e steps, %.2f s\n", mean[0], half[0], mean[1], half[1],
               (double)n * length, (double)(clock() - start) / CLOCKS_PER_SEC);
        return 0;
    }
    return 1;
}
