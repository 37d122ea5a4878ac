/* bench/speed/speed_verify.c - a time of a wrong picture is worth nothing, so
 * each way is held against the exact picture before it is timed: footprints
 * against method footprint with the scalar kernels and the way's own kernel,
 * which the tests hold against sums in double precision; what interpolates
 * values against rays in high quality.
 *
 * Bit for bit alike must be: all encodings of a method; any number of threads;
 * the wide instruction sets; and, at threshold 0, original and tested. */
#include "speed.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A quarter of an 8-bit step: what scalar kernels may differ from wide ones. */
#define SCALAR_LARGEST (0.25 / 255)

/* Exact pictures: of each kernel, and by raycast. */
#define KERNELS 5
enum { TRUTH = KERNELS, EXACTS };

typedef struct verification {
    speed_session *session;
    snow_image *exact[EXACTS]; /* NULL until it is needed */
    uint64_t sums[SPEED_WAYS_MOST];
    bool known[SPEED_WAYS_MOST]; /* whether there is a sum */
} verification;

SNOW_PRINTF(3, 4)
static snow_status wrong(const verification *verifier, int way,
                         const char *format, ...) {
    const speed_case *job = verifier->session->job;
    va_list arguments;
    fprintf(stderr,
            "snowglass: bench: %s %s %s %s %dx%d: %s: ", job->volume->name,
            job->look == SPEED_OPAQUE ? "opaque" : "translucent",
            job->color ? "rgba" : "grey",
            job->shade == SNOW_SHADE_PHONG ? "phong" : "unshaded", job->side,
            job->side, speed_ways[way].name);
    va_start(arguments, format);
    vfprintf(stderr, format, arguments);
    va_end(arguments);
    fprintf(stderr, "; nothing is timed\n");
    return SNOW_STATUS_DIFFERENT;
}

/* Methods whose truth are rays. */
static bool is_of_values(const speed_way *way) {
    return way->method == SNOW_METHOD_RAYCAST ||
           way->method == SNOW_METHOD_SHEAR_WARP;
}

/* By the scalar kernels, on a frame that is thrown away with its encoding,
 * which may be large. */
static snow_status render_exact(speed_session *session, const speed_way *way,
                                snow_image **out) {
    snow_settings settings;
    snow_frame *frame;
    snow_settings_init(&settings);
    settings.method =
        is_of_values(way) ? SNOW_METHOD_RAYCAST : SNOW_METHOD_FOOTPRINT;
    if (is_of_values(way))
        settings.quality = SNOW_QUALITY_HIGH;
    settings.kernel = way->kernel;
    settings.footprint = way->footprint;
    settings.shade = session->job->shade;
    settings.threshold = session->job->threshold;
    settings.light = SNOW_LIGHT_HEAD;
    settings.isa = SNOW_ISA_SCALAR;
    settings.threads = is_of_values(way) ? 0 : 1;
    SNOW_TRY(snow_frame_new(session->context, &frame));
    snow_status status = snow_frame_render(
        frame, session->job->volume->volume, session->job->volume->transfer,
        speed_view(session, 0), &settings, out);
    snow_frame_free(frame);
    return status;
}

/* The exact picture for a way, made once for all ways that share it. */
static snow_status exact_of(verification *verifier, int way, snow_image **out) {
    const speed_way *of = &speed_ways[way];
    snow_image **kept =
        &verifier->exact[is_of_values(of) ? TRUTH : (int)of->kernel];
    snow_status status = SNOW_STATUS_OK;
    if (!*kept)
        status = render_exact(verifier->session, of, kept);
    *out = *kept;
    return status;
}

static snow_status sum_of(verification *verifier, int way, snow_isa isa,
                          int threads, double threshold, uint64_t *sum) {
    snow_image *image;
    snow_status status = speed_render(verifier->session, way, isa, threads,
                                      threshold, 0, &image);
    if (status == SNOW_STATUS_OK) {
        *sum = snow_image_checksum(image);
        snow_image_free(image);
    }
    return status;
}

/* Within the way's bounds of a picture. */
static snow_status verify_near(const verification *verifier, int way,
                               const snow_image *exact, const snow_image *image,
                               speed_row *row) {
    const speed_way *bounds = &speed_ways[way];
    const speed_case *job = verifier->session->job;
    double least = bounds->psnr[job->shade == SNOW_SHADE_PHONG][job->look];
    snow_image_difference difference = {.size = sizeof difference};
    SNOW_TRY(snow_image_compare(exact, image, &difference));
    /* Written so that a NaN is beyond every bound. */
    if (!(difference.psnr >= least) || !(difference.largest <= bounds->largest))
        return wrong(verifier, way,
                     "PSNR %.1f dB (bound %g), largest difference %.2g (bound "
                     "%g)",
                     difference.psnr, least, difference.largest,
                     bounds->largest);
    row->largest = difference.largest;
    row->psnr = difference.largest > 0 ? difference.psnr : -1;
    return SNOW_STATUS_OK;
}

/* Against the exact picture. */
static snow_status verify_bounds(verification *verifier, int way,
                                 const snow_image *image, speed_row *row) {
    snow_image *exact;
    snow_status status = exact_of(verifier, way, &exact);
    return status == SNOW_STATUS_OK
               ? verify_near(verifier, way, exact, image, row)
               : status;
}

/* The `tested` way with the kernel of a way. */
static int tested_like(int way) {
    int tested = 0;
    while (speed_ways[tested].method != SNOW_METHOD_TESTED ||
           speed_ways[tested].kernel != speed_ways[way].kernel)
        tested++;
    return tested;
}

/* By a table weights are those of the nearest of 16 x 16 places. */
static snow_status verify_table(verification *verifier, int way,
                                speed_row *row) {
    speed_session *session = verifier->session;
    snow_image *image = NULL, *exact = NULL;
    snow_status status =
        speed_render(session, way, SNOW_ISA_AUTO, 1, 0, 0, &image);
    if (status == SNOW_STATUS_OK)
        status = speed_render(session, tested_like(way), SNOW_ISA_AUTO, 1, 0, 0,
                              &exact);
    if (status == SNOW_STATUS_OK)
        status = verify_near(verifier, way, exact, image, row);
    snow_image_free(image);
    snow_image_free(exact);
    return status;
}

/* Original splatting knows no threshold, so that it can only be held against
 * tested splatting at threshold 0, where every voxel that is not transparent
 * counts. */
static snow_status verify_original(verification *verifier, int way,
                                   speed_row *row) {
    uint64_t sum, expected = 0;
    int tested = tested_like(way);
    row->largest = 0;
    row->psnr = -1;
    if (verifier->session->job->original_known)
        return SNOW_STATUS_OK;
    snow_status status = sum_of(verifier, way, SNOW_ISA_AUTO, 1, 0, &sum);
    if (status == SNOW_STATUS_OK)
        status = sum_of(verifier, tested, SNOW_ISA_AUTO, 1, 0, &expected);
    if (status != SNOW_STATUS_OK)
        return status;
    if (sum != expected)
        return wrong(verifier, way, "another picture than tested at 0");
    return SNOW_STATUS_OK;
}

/* Pictures of other instruction sets; asked of one way in each group. */
static snow_status verify_isas(verification *verifier, int way,
                               const snow_image *image, uint64_t sum) {
    char found[64];
    snow_status status = SNOW_STATUS_OK;
    snprintf(found, sizeof found, "%s", snow_isa_found());
    for (char *name = strtok(found, " "); name && status == SNOW_STATUS_OK;
         name = strtok(NULL, " ")) {
        snow_isa isa = (snow_isa)snow_isa_from_name(name);
        snow_image *other;
        snow_image_difference difference = {.size = sizeof difference};
        status = speed_render(verifier->session, way, isa, 1,
                              verifier->session->job->threshold, 0, &other);
        if (status != SNOW_STATUS_OK)
            return status;
        status = snow_image_compare(image, other, &difference);
        bool wide = isa == SNOW_ISA_AVX2 || isa == SNOW_ISA_AVX512;
        if (status == SNOW_STATUS_OK && wide &&
            snow_image_checksum(other) != sum)
            status = wrong(verifier, way, "%s gives other bits", name);
        else if (status == SNOW_STATUS_OK &&
                 !(difference.largest <= SCALAR_LARGEST))
            status = wrong(verifier, way, "%s differs by %.2g (bound %.2g)",
                           name, difference.largest, SCALAR_LARGEST);
        snow_image_free(other);
    }
    return status;
}

/* An earlier way that differs in its encoding only, or -1. */
static int kin_of(const verification *verifier, int way) {
    const speed_way *a = &speed_ways[way];
    for (int i = 0; i < way; i++) {
        const speed_way *b = &speed_ways[i];
        if (verifier->known[i] && a->method == b->method &&
            a->quality == b->quality && a->kernel == b->kernel)
            return i;
    }
    return -1;
}

/* What must be alike bit for bit. */
static snow_status verify_sums(verification *verifier, int way,
                               const snow_image *image, const speed_row *rows,
                               int count) {
    uint64_t sum = snow_image_checksum(image), other;
    int kin = kin_of(verifier, way);
    verifier->sums[way] = sum;
    verifier->known[way] = true;
    if (kin >= 0 && verifier->sums[kin] != sum)
        return wrong(verifier, way, "another picture than %s",
                     speed_ways[kin].name);
    for (int i = 0; i < count; i++) {
        if (rows[i].threads == 1)
            continue;
        SNOW_TRY(sum_of(verifier, way, SNOW_ISA_AUTO, rows[i].threads,
                        verifier->session->job->threshold, &other));
        if (other != sum)
            return wrong(verifier, way, "another picture by %d threads",
                         rows[i].threads);
    }
    return kin >= 0 ? SNOW_STATUS_OK : verify_isas(verifier, way, image, sum);
}

/* All that can be said of one way; `rows` are its own.  Where the library takes
 * another method than it was asked for, as it may for pixels far wider than
 * voxels, there is nothing of this way to time. */
static snow_status verify_way(verification *verifier, int way, speed_row *rows,
                              int count, bool *done) {
    speed_session *session = verifier->session;
    snow_image *image;
    *done = true;
    if (speed_ways[way].tabled)
        return verify_table(verifier, way, rows);
    if (speed_ways[way].method == SNOW_METHOD_ORIGINAL)
        return verify_original(verifier, way, rows);
    snow_status status = speed_render(session, way, SNOW_ISA_AUTO, 1,
                                      session->job->threshold, 0, &image);
    if (status != SNOW_STATUS_OK)
        return status;
    const snow_stats *stats = speed_stats(session, way);
    *done = stats->method == speed_ways[way].method;
    if (*done)
        status = verify_bounds(verifier, way, image, rows);
    if (*done && status == SNOW_STATUS_OK)
        status = verify_sums(verifier, way, image, rows, count);
    snow_image_free(image);
    return status;
}

static void remove_rows(const verification *verifier, speed_result *result,
                        int first, int count) {
    int way = (int)(result->rows[first].way - speed_ways);
    const snow_stats *stats = speed_stats(verifier->session, way);
    fprintf(stderr, "snowglass: bench: %s %dx%d: %s is drawn by %s; left out\n",
            verifier->session->job->volume->name, verifier->session->job->side,
            verifier->session->job->side, result->rows[first].way->name,
            snow_method_name(stats->method));
    result->count -= count;
    memmove(&result->rows[first], &result->rows[first + count],
            (size_t)(result->count - first) * sizeof result->rows[0]);
}

snow_status speed_verify(speed_session *session, speed_result *result) {
    verification verifier = {.session = session};
    snow_status status = SNOW_STATUS_OK;
    for (int first = 0, count;
         first < result->count && status == SNOW_STATUS_OK; first += count) {
        speed_row *rows = &result->rows[first];
        int way = (int)(rows->way - speed_ways);
        bool done;
        for (count = 1; first + count < result->count; count++)
            if (rows[count].way != rows->way)
                break;
        status = verify_way(&verifier, way, rows, count, &done);
        for (int i = 1; i < count; i++) {
            rows[i].psnr = rows->psnr;
            rows[i].largest = rows->largest;
        }
        if (status == SNOW_STATUS_OK && !done) {
            remove_rows(&verifier, result, first, count);
            count = 0;
        }
    }
    for (int i = 0; i < EXACTS; i++)
        snow_image_free(verifier.exact[i]);
    return status;
}
