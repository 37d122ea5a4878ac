/* classify/gloss.c - Phong's model for all normals of 16 bits: the shading
 * table of a view and light (model, point 4), as classify/shade.c has it.
 *
 * Normals turn up row by row of their square, so that x, y and z are linear in
 * loops that the compiler carries to vectors. */
#include "base/parallel.h"
#include "base/power.h"
#include "classify/normals.h"

#include <math.h>

#define SIDE 255
#define MIDDLE 127

/* One item of work: rows of the square. */
#define ROWS 15

typedef struct gloss_job {
    float viewer[3], light[3], half[3];
    float ambient, diffuse, specular;
    double shininess;
    int whole; /* as snow_shader has it */
    snow_gloss *table;
} gloss_job;

/* x^whole in place, by squaring. */
static void raise_whole(float *x, int whole) {
    float power[SIDE];
    for (int i = 0; i < SIDE; i++)
        power[i] = 1;
    for (unsigned n = (unsigned)whole; n; n /= 2) {
        if (n % 2)
            for (int i = 0; i < SIDE; i++)
                power[i] *= x[i];
        for (int i = 0; i < SIDE; i++)
            x[i] *= x[i];
    }
    for (int i = 0; i < SIDE; i++)
        x[i] = power[i];
}

static void raise(float *x, double exponent) {
    for (int i = 0; i < SIDE; i++)
        x[i] = (float)snow_power((double)x[i], exponent);
}

/* The cosines of one row of normals, turned to the viewer, with the light and
 * the half-way vector; 0 where they are below. */
static void cosines(const gloss_job *job, int row, float *lambert,
                    float *highlight) {
    const float *l = job->light, *h = job->half, *e = job->viewer;
    float down = (float)(row - MIDDLE) / MIDDLE;
    for (int i = 0; i < SIDE; i++) {
        float across = (float)(i - MIDDLE) / MIDDLE;
        float x = (across + down) / 2, y = (across - down) / 2;
        float z = 1 - fabsf(x) - fabsf(y);
        float scale = 1 / sqrtf(x * x + y * y + z * z);
        float facing = x * e[0] + y * e[1] + z * e[2];
        scale = facing < 0 ? -scale : scale;
        float lit = (x * l[0] + y * l[1] + z * l[2]) * scale;
        float glint = (x * h[0] + y * h[1] + z * h[2]) * scale;
        lambert[i] = lit > 0 ? lit : 0;
        highlight[i] = lit > 0 && glint > 0 ? glint : 0;
    }
}

static void gloss_row(const gloss_job *job, int row) {
    float lambert[SIDE], white[SIDE];
    cosines(job, row, lambert, white);
    snow_gloss *out = job->table + 1 + row * SIDE;
    if (job->whole >= 0)
        raise_whole(white, job->whole);
    else
        raise(white, job->shininess);
    /* x^0 is 1 for a highlight of 0 too, which must stay black. */
    for (int i = 0; i < SIDE; i++) {
        out[i].factor = job->ambient + job->diffuse * lambert[i];
        out[i].white = lambert[i] > 0 ? job->specular * white[i] : 0;
    }
}

static void gloss_rows(void *user, int64_t item, int worker) {
    (void)worker;
    for (int row = 0; row < ROWS; row++)
        gloss_row(user, (int)item * ROWS + row);
}

void snow_gloss_table(const snow_settings *settings,
                      const snow_placement *placement, int threads,
                      snow_gloss *table) {
    double light[3], half[3];
    gloss_job job = {.ambient = (float)settings->ambient,
                     .diffuse = (float)settings->diffuse,
                     .specular = (float)settings->specular,
                     .shininess = settings->shininess,
                     .whole = snow_whole_shininess(settings->shininess),
                     .table = table};
    if (!snow_light_of(placement, settings, light, half))
        job.specular = 0;
    for (int i = 0; i < 3; i++) {
        job.viewer[i] = (float)placement->back[i];
        job.light[i] = (float)light[i];
        job.half[i] = (float)half[i];
    }
    snow_gloss plain = {job.ambient, 0};
    table[SNOW_NO_NORMAL] = plain;
    for (int code = SIDE * SIDE + 1; code < SNOW_NORMALS; code++)
        table[code] = plain;
    snow_parallel(threads, SIDE / ROWS, gloss_rows, &job);
}
