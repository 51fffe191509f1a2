/* Hand-written yardstick for scatter/propagate*.wgsl: the same algorithm, the same numbers.
 *
 * RGB lattices of float4 (A, Bx, By, Bz), [channel][z][y][x]. With M one step to 26 neighbours and
 * T the track it leaves, Q_0 = I, Q_k+1 = I + M Q_k: ITERATIONS - 1 steps of that, then T Q.
 * Held as planes with a dark border, so that rows are vectors and nothing asks where it is.
 *
 *   cc -O3 -march=native -fopenmp -ffast-math scatter.c -o scatter
 *   ./scatter check N numbers... <input >output   the lattice I in, the track out
 *   ./scatter serve N numbers...                  a line in, a run, its milliseconds out
 * numbers: per channel, M then T: even (3 kinds of hop, own), direct (3, own), kept even (3),
 * kept direct (3); then rho / length of the three kinds. See StepCoefficients.
 *
 * Compiled and run by `airlight bench`; not part of the package. */
#include <omp.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { ITERATIONS = 8, NUMBERS = 8 };

static int n, line;         /* cells a side; floats a row, borders counted */
static long plane, volume;  /* floats a layer, and a component */
static float numbers[2][3][NUMBERS], rho[3];

/* One neighbour: what it sends along the opposite of its offset, added by kind of hop. */
#define HOP(k, X, Y, Z) { \
    const long o = ((Z) * (long)plane + (Y) * (long)line + (X)); \
    const float p = a[i + o] - rho[k] * ((X) * bx[i + o] + (Y) * by[i + o] + (Z) * bz[i + o]); \
    e##k += p; x##k -= (X) * p; y##k -= (Y) * p; z##k -= (Z) * p; }

static inline __attribute__((always_inline)) void
row(const float *in, const float *source, float *out, const float *m, long start) {
    const float *restrict a = in + start, *restrict bx = a + volume, *restrict by = bx + volume,
                *restrict bz = by + volume;
    float *restrict to = out + start;
    const float *restrict from = source ? source + start : NULL;
#pragma omp simd
    for (int i = 0; i < n; ++i) {
        float e0 = 0, e1 = 0, e2 = 0, x0 = 0, x1 = 0, x2 = 0, y0 = 0, y1 = 0, y2 = 0, z0 = 0,
              z1 = 0, z2 = 0;
        HOP(0, 1, 0, 0) HOP(0, -1, 0, 0) HOP(0, 0, 1, 0) HOP(0, 0, -1, 0) HOP(0, 0, 0, 1)
        HOP(0, 0, 0, -1)
        HOP(1, 1, 1, 0) HOP(1, 1, -1, 0) HOP(1, -1, 1, 0) HOP(1, -1, -1, 0) HOP(1, 1, 0, 1)
        HOP(1, 1, 0, -1) HOP(1, -1, 0, 1) HOP(1, -1, 0, -1) HOP(1, 0, 1, 1) HOP(1, 0, 1, -1)
        HOP(1, 0, -1, 1) HOP(1, 0, -1, -1)
        HOP(2, 1, 1, 1) HOP(2, 1, 1, -1) HOP(2, 1, -1, 1) HOP(2, 1, -1, -1) HOP(2, -1, 1, 1)
        HOP(2, -1, 1, -1) HOP(2, -1, -1, 1) HOP(2, -1, -1, -1)
        const float even = m[0] * e0 + m[1] * e1 + m[2] * e2 + m[3] * a[i];
        const float dx = m[4] * x0 + m[5] * x1 + m[6] * x2 + m[7] * bx[i];
        const float dy = m[4] * y0 + m[5] * y1 + m[6] * y2 + m[7] * by[i];
        const float dz = m[4] * z0 + m[5] * z1 + m[6] * z2 + m[7] * bz[i];
        to[i] = even + (from ? from[i] : 0);
        to[i + volume] = dx + (from ? from[i + volume] : 0);
        to[i + 2 * volume] = dy + (from ? from[i + 2 * volume] : 0);
        to[i + 3 * volume] = dz + (from ? from[i + 3 * volume] : 0);
    }
}

static void step(const float *in, const float *source, float *out, int which) {
#pragma omp parallel for schedule(static) collapse(2)
    for (int c = 0; c < 3; ++c)
        for (int z = 0; z < n; ++z)
            for (int y = 0; y < n; ++y) {
                const long start = 4 * c * volume + (z + 1) * plane + (y + 1) * (long)line + 1;
                if (source) row(in, source, out, numbers[which][c], start);
                else row(in, NULL, out, numbers[which][c], start);
            }
}

static const float *run(const float *injected, float *lattices[2]) {
    const float *from = injected;
    for (int k = 1; k < ITERATIONS; ++k) {
        float *to = lattices[k & 1];
        step(from, injected, to, 0);
        from = to;
    }
    float *track = lattices[ITERATIONS & 1];
    step(from, NULL, track, 1);
    return track;
}

static float *lattice(void) {
    const size_t bytes = (12 * volume * sizeof(float) + 63) / 64 * 64;
    float *made = aligned_alloc(64, bytes);
    if (made == NULL) exit(3);
    return memset(made, 0, bytes);
}

static int serve(float *injected, float *lattices[2]) {
    for (int key = getchar(); key != EOF; key = getchar()) {
        if (key != '\n') continue;
        const double begin = omp_get_wtime();
        run(injected, lattices);
        printf("%.6f\n", (omp_get_wtime() - begin) * 1e3);
        fflush(stdout);
    }
    return 0;
}

/* Component k of the cell with running index j of channel c. */
static long place(int c, int k, long j) {
    const long x = j % n, y = j / n % n, z = j / n / n;
    return (4 * c + k) * volume + (z + 1) * plane + (y + 1) * line + x + 1;
}

int main(int argc, char **argv) {
    if (argc != 3 + 2 * 3 * NUMBERS + 3) return 2;
    n = atoi(argv[2]);
    line = n + 2;
    plane = (long)line * line;
    volume = plane * line;
    float *given = &numbers[0][0][0];
    for (int i = 0; i < 2 * 3 * NUMBERS; ++i) given[i] = strtof(argv[3 + i], NULL);
    for (int k = 0; k < 3; ++k) rho[k] = strtof(argv[3 + 2 * 3 * NUMBERS + k], NULL);
    float *injected = lattice(), *lattices[2] = {lattice(), lattice()};
    const long cells = (long)n * n * n;
    float *flat = malloc(12 * cells * sizeof(float));
    const int is_served = strcmp(argv[1], "serve") == 0;
    if (flat == NULL) return 3;
    for (long i = 0; i < 12 * cells; ++i) flat[i] = (float)(i % 7);
    if (!is_served && fread(flat, sizeof(float), 12 * cells, stdin) != (size_t)(12 * cells))
        return 4;
    for (int c = 0; c < 3; ++c)
        for (long j = 0; j < cells; ++j)
            for (int k = 0; k < 4; ++k) injected[place(c, k, j)] = flat[4 * (c * cells + j) + k];
    if (is_served) return serve(injected, lattices);
    const float *track = run(injected, lattices);
    for (int c = 0; c < 3; ++c)
        for (long j = 0; j < cells; ++j)
            for (int k = 0; k < 4; ++k) flat[4 * (c * cells + j) + k] = track[place(c, k, j)];
    return fwrite(flat, sizeof(float), 12 * cells, stdout) == (size_t)(12 * cells) ? 0 : 5;
}
