/* classify/shading/gloss.c - Phong's model for all normals of 16 bits: the
 * shading table of a view and light (model, point 4), as in
 * classify/shading/shade.c.
 *
 * Normals are generated row by row of their square, so that x, y and z are
 * linear in loops that the compiler vectorizes. */
#include "base/exp_log.h"
#include "base/thread_pool.h"
#include "classify/shading/normals.h"

#include <math.h>

#define SIDE SNOW_NORMAL_SIDE
#define MIDDLE (SNOW_NORMAL_SIDE / 2)

/* One item of work: rows of the square. */
#define ROWS 15

typedef struct gloss_job gloss_job;
typedef void gloss_row_fn(const gloss_job *job, int row);

struct gloss_job {
    gloss_row_fn *gloss_row;
    float viewer[3], light[3], half[3];
    float ambient, diffuse, specular;
    double shininess;
    int whole; /* as in snow_shader */
    snow_gloss *table;
};

/* Both are from 0 to 2. */
static inline snow_gloss gloss_of(float factor, float white) {
    return (uint32_t)(int32_t)(factor * SNOW_GLOSS_ONE + 0.5f) |
           (uint32_t)(int32_t)(white * SNOW_GLOSS_ONE + 0.5f) << 16;
}

#define TEMPLATE "classify/shading/gloss.tmpl.h"
#include "simd/each_isa.h"

static gloss_row_fn *row_of(snow_isa isa) {
    return SNOW_OF_ISA(isa, gloss_row);
}

static void gloss_rows(void *user, int64_t item, int worker) {
    (void)worker;
    const gloss_job *job = user;
    for (int row = 0; row < ROWS; row++)
        job->gloss_row(job, (int)item * ROWS + row);
}

snow_status snow_gloss_table(snow_context *context,
                             const snow_settings *settings,
                             const snow_placement *placement, int threads,
                             snow_gloss *table) {
    double light[3], half[3];
    snow_isa isa = snow_isa_resolve(settings->isa);
    gloss_job job = {.gloss_row = row_of(isa),
                     .ambient = (float)settings->ambient,
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
    snow_gloss plain = gloss_of(job.ambient, 0);
    table[SNOW_NO_NORMAL] = plain;
    for (int code = SIDE * SIDE + 1; code < SNOW_NORMALS; code++)
        table[code] = plain;
    return snow_parallel(context, threads, SIDE / ROWS, gloss_rows, &job);
}
