/* Any simulator records its arrays, step by step: here a chain of springs. `./record 0 > a.csv; ./record 1 > b.csv`, and
 * `bitgrain bisect a.csv b.csv` says at which step the two part: the second sums the forces in another order.
 *
 *     cc record.c -I ../include ../target/release/libbitgrain_capi.a -lm -o record
 */
#include <bitgrain.h>
#include <stdio.h>
#include <stdlib.h>

static void must(int status) {
    if (status != BG_OK) {
        fprintf(stderr, "bitgrain: %s\n", bg_strerror(status));
        exit(1);
    }
}

int main(int count, char **words) {
    const int other = count > 1 && atoi(words[1]) != 0;
    enum { N = 8 };
    double x[N], v[N] = {0};
    for (int i = 0; i < N; i++) x[i] = i + 0.1 / (i + 3);
    const size_t shape[1] = {N};

    char line[BG_LINE];
    bg_recording recording = {.size = sizeof recording};
    must(bg_record_begin(&recording, line, sizeof line));
    fputs(line, stdout);
    for (uint64_t step = 0; step < 200; step++) {
        /* The bytes are those of a little-endian machine. */
        must(bg_record(&recording, step, "velocities", "f64", shape, 1, v, line, sizeof line));
        fputs(line, stdout);
        must(bg_record(&recording, step, "positions", "f64", shape, 1, x, line, sizeof line));
        fputs(line, stdout);
        for (int i = 1; i < N - 1; i++) {
            const double left = x[i - 1] - x[i] + 1, right = x[i + 1] - x[i] - 1, drag = -0.03 * v[i];
            const double force = other ? right + (drag + left) : (left + right) + drag;
            v[i] += 0.01 * force;
        }
        for (int i = 0; i < N; i++) x[i] += 0.01 * v[i];
    }
    must(bg_record_end(&recording, line, sizeof line));
    fputs(line, stdout);
    return 0;
}
