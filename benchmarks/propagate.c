/* Hand-written yardstick for lpv/propagate.wgsl: the same algorithm, the same numbers.
 *
 * RGB lattices of float4 (a, bx, by, bz), [channel][z][y][x]. With M one step of the centroid
 * scheme, the sum of M I, M^2 I ... up to ITERATIONS, by doubling. A blocked lattice has
 * eight words a cell as lattice/openness.wgsl writes them: six of (reflected rgb, closed) for the
 * outgoing hops +x -x +y -y +z -z, two of the six incoming hops' open shares; unorm8.
 *
 *   cc -O3 -march=native -fopenmp -ffast-math propagate.c -o propagate
 *   ./propagate check N [blocked] <input >output   the lattice I (and the faces) in, B out
 *   ./propagate serve N [blocked]                  a line in, a run, its milliseconds out
 *
 * Compiled and run by `airlight bench`; not part of the package. */
#include <omp.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { ITERATIONS = 8 };
typedef float float4 __attribute__((vector_size(16)));
typedef int32_t int4 __attribute__((vector_size(16)));

/* Hop matrix along an axis: a <- A a + B b_along, b_along <- 3B a + C b_along, b_across <- D. */
#define A 0.16666667f
#define B 0.13853161f
#define C 0.34832350f
#define D 0.05939389f

/* The lattice's size, and what it holds. */
static int n;
static int is_blocked;
static uint32_t *faces;
static float unorm[256];

/* What two opposite neighbours add along an axis: `up` travels +axis, `down` -axis. */
static inline float4 along_x(float4 up, float4 down) {
    const float4 even = up + down, odd = up - down;
    return even * (float4){A, C, D, D}
         + __builtin_shuffle(odd, (int4){1, 0, 2, 3}) * (float4){B, 3 * B, 0, 0};
}
static inline float4 along_y(float4 up, float4 down) {
    const float4 even = up + down, odd = up - down;
    return even * (float4){A, D, C, D}
         + __builtin_shuffle(odd, (int4){2, 1, 0, 3}) * (float4){B, 0, 3 * B, 0};
}
static inline float4 along_z(float4 up, float4 down) {
    const float4 even = up + down, odd = up - down;
    return even * (float4){A, D, D, C}
         + __builtin_shuffle(odd, (int4){3, 1, 2, 0}) * (float4){B, 0, 0, 3 * B};
}

/* The share of a cell's power towards a closed face that comes back. */
static inline float
returned(float p, float even, uint32_t face, int channel, int is_first) {
    const uint32_t reflected = face >> (8 * channel) & 255, closed = face >> 24;
    return p * (p * even > 0 ? unorm[reflected] : is_first ? 0 : unorm[closed]);
}

static inline float4 bounced(float4 v, const uint32_t *f, int channel, int is_first) {
    float4 back = {0, 0, 0, 0};
    for (int axis = 0; axis < 3; ++axis) {
        const float even = A * v[0], along = B * v[axis + 1];
        const float plus = returned(even + along, even, f[2 * axis], channel, is_first);
        const float minus = returned(even - along, even, f[2 * axis + 1], channel, is_first);
        back[0] += plus + minus;
        back[axis + 1] = 2 * (minus - plus);
    }
    return back;
}

static inline float open_share(const uint32_t *f, int hop) {
    return unorm[f[6 + hop / 4] >> (8 * (hop % 4)) & 255];
}

static inline __attribute__((always_inline)) void
row(const float4 *in, float4 *out, int c, int z, int y, int blocked, int is_first) {
    static const float4 dark[1];
    const long line = n, layer = (long)n * n;
    const long start = ((c * (long)n + z) * n + y) * n;
    /* Neighbours beyond the border: a cell without light, which is not walked along. */
    const float4 *p = in + start;
    const float4 *south = y > 0 ? p - line : dark, *north = y < n - 1 ? p + line : dark;
    const float4 *below = z > 0 ? p - layer : dark, *above = z < n - 1 ? p + layer : dark;
    const long ds = y > 0, dn = y < n - 1, db = z > 0, da = z < n - 1;
    for (int x = 0; x < n; ++x) {
        const float4 west = x > 0 ? p[x - 1] : dark[0], east = x < n - 1 ? p[x + 1] : dark[0];
        float4 sum = dark[0];
        if (!blocked) {
            sum += along_x(west, east) + along_y(south[ds * x], north[dn * x])
                 + along_z(below[db * x], above[da * x]);
        } else {
            const uint32_t *f = faces + 8 * ((z * (long)n + y) * n + x);
            sum += along_x(open_share(f, 0) * west, open_share(f, 1) * east)
                 + along_y(open_share(f, 2) * south[ds * x], open_share(f, 3) * north[dn * x])
                 + along_z(open_share(f, 4) * below[db * x], open_share(f, 5) * above[da * x])
                 + bounced(p[x], f, c, is_first);
        }
        out[start + x] = sum;
    }
}

static void step(const float4 *in, float4 *out, int is_first) {
#pragma omp parallel for schedule(static) collapse(2)
    for (int c = 0; c < 3; ++c)
        for (int z = 0; z < n; ++z)
            for (int y = 0; y < n; ++y) {
                if (is_blocked && is_first) row(in, out, c, z, y, 1, 1);
                else if (is_blocked) row(in, out, c, z, y, 1, 0);
                else if (is_first) row(in, out, c, z, y, 0, 1);
                else row(in, out, c, z, y, 0, 0);
            }
}

static void add(const float4 *state, float4 *sum) {
    const long values = 3L * n * n * n;
#pragma omp parallel for schedule(static)
    for (long i = 0; i < values; ++i) sum[i] += state[i];
}

/* The sum of the states after 1 to ITERATIONS steps, by doubling: S <- S + M^k S. */
static const float4 *run(const float4 *injected, float4 *lattices[3]) {
    float4 *sum = lattices[0], *spare[2] = {lattices[1], lattices[2]};
    step(injected, sum, 1);
    for (int steps = 1; steps < ITERATIONS; steps *= 2) {
        const float4 *state = sum;
        for (int k = 0; k < steps; ++k) {
            step(state, spare[k % 2], 0);
            state = spare[k % 2];
        }
        add(state, sum);
    }
    return sum;
}

static void *lattice(size_t bytes) {
    void *made = aligned_alloc(64, (bytes + 63) / 64 * 64);
    if (made == NULL) exit(3);
    return memset(made, 0, bytes);
}

static int serve(const float4 *injected, float4 *lattices[3]) {
    for (int key = getchar(); key != EOF; key = getchar()) {
        if (key != '\n') continue;
        const double begin = omp_get_wtime();
        run(injected, lattices);
        printf("%.6f\n", (omp_get_wtime() - begin) * 1e3);
        fflush(stdout);
    }
    return 0;
}

int main(int argc, char **argv) {
    if (argc < 3) return 2;
    n = atoi(argv[2]);
    is_blocked = argc > 3;
    const size_t cells = (size_t)n * n * n, bytes = 3 * cells * sizeof(float4);
    for (int i = 0; i < 256; ++i) unorm[i] = i / 255.0f;
    float4 *injected = lattice(bytes), *lattices[3];
    for (int k = 0; k < 3; ++k) lattices[k] = lattice(bytes);
    faces = lattice(cells * 32);
    if (strcmp(argv[1], "serve") == 0) {
        for (size_t i = 0; i < 3 * cells; ++i) injected[i] = (float4){(float)(i % 7), 1, 2, 3};
        for (size_t i = 0; i < 8 * cells; ++i) faces[i] = (uint32_t)i * 2654435761u;
        return serve(injected, lattices);
    }
    if (fread(injected, 1, bytes, stdin) != bytes) return 4;
    if (is_blocked && fread(faces, 1, cells * 32, stdin) != cells * 32) return 4;
    return fwrite(run(injected, lattices), 1, bytes, stdout) == bytes ? 0 : 5;
}
