/* tests/render/test_shear_warp_rows.c - rows that are read in place give the
 * bits of rows that are copied: along every axis, of 8 and 16 bits, with
 * windows beyond every side, by every instruction set. */
#include "reference/model.h"
#include "render/picture.h"
#include "simd/isa.h"

#define COUNT(array) (sizeof(array) / sizeof *(array))

static const snow_quality qualities[] = {
    SNOW_QUALITY_DRAFT, SNOW_QUALITY_NORMAL, SNOW_QUALITY_HIGH};

static const snow_type types[] = {SNOW_TYPE_UINT8, SNOW_TYPE_INT16,
                                  SNOW_TYPE_UINT16, SNOW_TYPE_INT8};

/* Wider and thinner than a window of 32 voxels, and of a single voxel. */
static reference_scene rows_scene(int n) {
    static const int64_t sizes[][3] = {{70, 41, 12}, {33, 9, 38}, {12, 71, 40},
                                       {1, 14, 17},  {13, 1, 9},  {67, 15, 1},
                                       {1, 1, 9},    {2, 40, 2},  {1, 1, 1}};
    static const double backs[][3] = {{0, 0, 1},  {0, 1, 0},  {1, 0, 0},
                                      {0, 0, -1}, {0, -1, 0}, {-1, 0, 0}};
    static const double ups[][3] = {{0, 1, 0}, {0, 0, 1}, {0, 0, 1}};
    static const snow_opacity_point looks[][3] = {
        {{0, 0.05}, {50, 0.2}, {100, 0.5}}, {{0, 0}, {40, 0}, {90, 0.7}}};
    reference_scene s =
        model_scene(sizes[n % 9], types[n / 2 % 4], n % 2,
                    n % 3 ? MODEL_PLAIN : MODEL_ANISOTROPIC, (uint64_t)n);
    s.settings.method = SNOW_METHOD_SHEAR_WARP;
    s.settings.threads = 2;
    s.settings.quality = qualities[n / 9 % 3];
    s.settings.shade = n % 7 ? SNOW_SHADE_PHONG : SNOW_SHADE_NONE;
    s.opacities = looks[n % 2];
    s.opacity_count = 3;
    model_look(&s, backs[n / 3 % 6], ups[n / 3 % 3]);
    model_turn(&s, n % 2 ? 25 : -33, n * 37 % 70 - 35, n % 4 ? 0 : 15,
               n % 5 ? 1.1 : 2.4);
    s.view.fov = n % 4 == 3 ? 40 : 0;
    s.view.width = 48;
    s.view.height = 44;
    return s;
}

static bool is_in_place(const snow_stats *stats, snow_type type) {
    return stats->slice_axis != 0 && type != SNOW_TYPE_INT8;
}

static void check(const model_stage *stage, int n, reference_scene *s) {
    size_t bytes =
        4 * sizeof(float) * (size_t)s->view.width * (size_t)s->view.height;
    s->settings.encoding = SNOW_ENCODING_AUTO;
    float *here = model_picture(stage, s);
    const snow_stats *stats = snow_frame_stats(stage->frame);
    if (is_in_place(stats, s->info.type) != (stats->ia_bytes == 0))
        fail_msg("scene %d: %llu bytes of IA along axis %d", n,
                 (unsigned long long)stats->ia_bytes, stats->slice_axis);
    int64_t interesting = stats->interesting;
    s->settings.encoding = SNOW_ENCODING_BITMAP;
    float *copied = model_picture(stage, s);
    assert_true(snow_frame_stats(stage->frame)->ia_bytes > 0);
    if (memcmp(here, copied, bytes) != 0)
        fail_msg("scene %d, instruction set %d: in place has other bits", n,
                 (int)s->settings.isa);
    free(here);
    free(copied);
    s->settings.method = SNOW_METHOD_RAYCAST; /* counts voxel by voxel */
    free(model_picture(stage, s));
    assert_int_equal(interesting, snow_frame_stats(stage->frame)->interesting);
    s->settings.method = SNOW_METHOD_SHEAR_WARP;
}

static void rows_in_place_give_the_bits_of_copies(void **state) {
    model_stage *stage = *state;
    for (int n = 0; n < 216; n++) {
        if (n >= 18 && !support_takes((size_t)n, 19)) /* all sizes twice */
            continue;
        reference_scene s = rows_scene(n);
        for (snow_isa isa = SNOW_ISA_SCALAR; isa <= SNOW_ISA_AVX512; isa++) {
            s.settings.isa = isa;
            if (snow_isa_runs(isa))
                check(stage, n, &s);
        }
        model_free(&s);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        MODEL_TEST(rows_in_place_give_the_bits_of_copies),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
