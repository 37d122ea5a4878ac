/* tests/parallel/test_insitu_marks.c - bars and the step's number over the
 * pictures of a running simulation. */
#include "support/image.h"

#include <snowglass/recipe.h>
#include <string.h>

/* Two steps of a field that does not change, as `recipe` says.  `sums` are of
 * the files' pixels. */
static void make_steps(image_fixture *f, const char *recipe, uint64_t sums[2]) {
    static float field[12 * 12 * 12];
    const int64_t dims[3] = {12, 12, 12}, first[3] = {0, 0, 0};
    snow_comm *comm = NULL;
    snow_insitu *insitu = NULL;
    snow_recipe r = {.size = sizeof r};
    for (int i = 0; i < 12 * 12 * 12; i++)
        field[i] = (float)(i % 12);
    assert_int_equal(snow_comm_new_self(f->context, &comm), SNOW_STATUS_OK);
    assert_int_equal(snow_insitu_new(comm, &insitu), SNOW_STATUS_OK);
    assert_int_equal(
        snow_recipe_parse(f->context, "text", recipe, strlen(recipe), &r),
        SNOW_STATUS_OK);
    r.output = support_image_path(f, "s_%d.png");
    r.width = r.height = 160;
    assert_int_equal(snow_insitu_set_grid(insitu, dims, NULL, NULL),
                     SNOW_STATUS_OK);
    assert_int_equal(snow_insitu_set_brick(insitu, 0, first, dims, NULL),
                     SNOW_STATUS_OK);
    assert_int_equal(
        snow_insitu_set_voxels(insitu, 0, SNOW_TYPE_FLOAT32, field, NULL),
        SNOW_STATUS_OK);
    assert_int_equal(snow_recipe_apply(&r, insitu), SNOW_STATUS_OK);
    for (int step = 0; step < 2; step++) {
        snow_image *image = NULL;
        char name[8] = {'s', '_', (char)('0' + step), '.', 'p', 'n', 'g', 0};
        assert_int_equal(snow_insitu_step(insitu, step), SNOW_STATUS_OK);
        assert_int_equal(
            snow_image_load(f->context, support_image_path(f, name), &image),
            SNOW_STATUS_OK);
        sums[step] = snow_image_checksum(image);
        snow_image_free(image);
        remove(f->path);
    }
    snow_recipe_clear(&r);
    snow_insitu_free(insitu);
    snow_comm_free(comm);
}

static void a_recipes_legend_and_step_are_drawn(void **state) {
    image_fixture *f = *state;
    uint64_t plain[2], legend[2], label[2];
    make_steps(f, "{}", plain);
    make_steps(f, "{\"legend\": true}", legend);
    make_steps(f, "{\"time-label\": true}", label);
    assert_true(plain[0] == plain[1]);
    assert_true(legend[0] == legend[1] && legend[0] != plain[0]);
    assert_true(label[0] != label[1] && label[0] != plain[0]);
}

static void a_depth_is_refused_in_situ(void **state) {
    image_fixture *f = *state;
    static const char text[] = "{\"depth\": \"d.npy\"}";
    snow_comm *comm = NULL;
    snow_insitu *insitu = NULL;
    snow_recipe r = {.size = sizeof r};
    assert_int_equal(snow_comm_new_self(f->context, &comm), SNOW_STATUS_OK);
    assert_int_equal(snow_insitu_new(comm, &insitu), SNOW_STATUS_OK);
    assert_int_equal(
        snow_recipe_parse(f->context, "text", text, strlen(text), &r),
        SNOW_STATUS_OK);
    assert_int_equal(snow_recipe_apply(&r, insitu), SNOW_STATUS_BAD_USAGE);
    assert_non_null(strstr(snow_context_message(snow_comm_context(comm)),
                           "\"depth\" is for pictures of files"));
    snow_recipe_clear(&r);
    snow_insitu_free(insitu);
    snow_comm_free(comm);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(a_depth_is_refused_in_situ,
                                        support_image_setup,
                                        support_image_teardown),
        cmocka_unit_test_setup_teardown(a_recipes_legend_and_step_are_drawn,
                                        support_image_setup,
                                        support_image_teardown)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
