/* bench/peers/pipe.c - the loop of the workers in C.
 *
 * What a command takes is measured around the worker's own function only: wall
 * time, and processor time of all threads of the process.  Reading a table and
 * writing a picture are done outside of it. */
#include "pipe.h"

#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#define PATH_BYTES 4096

void pipe_fail(const pipe_worker *worker, const char *reason) {
    fprintf(stderr, "%s: %s\n", worker->name, reason);
    exit(1);
}

static double seconds(clockid_t clock) {
    struct timespec now;
    clock_gettime(clock, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* Lines of red, green, blue, opacity, one for each value. */
static void read_table(const pipe_worker *worker, const char *path) {
    static pipe_table table;
    FILE *file = fopen(path, "r");
    for (int v = 0; v < PIPE_VALUES; v++)
        for (int c = 0; c < 4; c++)
            if (!file || fscanf(file, "%lf", &table[v][c]) != 1)
                pipe_fail(worker, "the table cannot be read");
    fclose(file);
    worker->take((const pipe_table *)&table);
}

static void write_picture(const pipe_worker *worker, const char *path) {
    FILE *file = fopen(path, "wb");
    if (!file)
        pipe_fail(worker, "the picture cannot be written");
    fprintf(file, "P6\n%d %d\n255\n", worker->size, worker->size);
    for (int y = 0; y < worker->size; y++)
        for (int x = 0; x < worker->size; x++) {
            unsigned char rgb[3];
            worker->pixel(x, y, rgb);
            fwrite(rgb, 1, sizeof rgb, file);
        }
    if (fclose(file) != 0)
        pipe_fail(worker, "the picture cannot be written");
}

/* Peak resident memory of this process, in kilobytes. */
static long peak_memory(void) {
    FILE *file = fopen("/proc/self/status", "r");
    char line[256];
    long kilobytes = 0;
    while (file && fgets(line, sizeof line, file))
        if (strncmp(line, "VmHWM:", 6) == 0)
            kilobytes = strtol(line + 6, NULL, 10);
    if (file)
        fclose(file);
    return kilobytes;
}

/* Does what a line asks for and answers; false when that is to end. */
static bool obey(const pipe_worker *worker, char *line) {
    double azimuth, elevation;
    char *path = strchr(line, ' ') ? strchr(line, ' ') + 1 : line;
    line[strcspn(line, "\n")] = '\0';
    if (strcmp(line, "quit") == 0)
        return false;
    if (strncmp(line, "table ", 6) == 0)
        read_table(worker, path);
    else if (strncmp(line, "save ", 5) == 0)
        write_picture(worker, path);
    double wall = seconds(CLOCK_MONOTONIC);
    double cpu = seconds(CLOCK_PROCESS_CPUTIME_ID);
    if (strcmp(line, "load") == 0)
        worker->load();
    else if (sscanf(line, "frame %lf %lf", &azimuth, &elevation) == 2)
        worker->frame(azimuth, elevation);
    wall = seconds(CLOCK_MONOTONIC) - wall;
    cpu = seconds(CLOCK_PROCESS_CPUTIME_ID) - cpu;
    if (strcmp(line, "memory") == 0)
        printf("ok %ld 0\n", peak_memory());
    else
        printf("ok %.9f %.9f\n", wall, cpu);
    return true;
}

void pipe_serve(const pipe_worker *worker) {
    char line[PATH_BYTES];
    while (fgets(line, sizeof line, stdin) && obey(worker, line))
        fflush(stdout);
}
