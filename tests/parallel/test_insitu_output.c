/* tests/parallel/test_insitu_output.c - the files of a running simulation: what
 * recipes say of them without naming them, and outputs that cannot be written,
 * which are found before a picture is drawn, on all ranks.
 *
 * The linker's --wrap counts the calls of fsync. */
#include "support/folder.h"
#include "support/support.h"

#include "image/image.h"

#include <snowglass/recipe.h>

#include <stdatomic.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#define SIDE 8
#define RANKS 2

static atomic_int synced;

int __real_fsync(int file);
int __wrap_fsync(int file);
int __wrap_fsync(int file) {
    synced++;
    return __real_fsync(file);
}

/* A run of two ranks: what is set, and what came of it. */
typedef struct run {
    const char *output, *recipe; /* of snow_insitu_set; NULL: none */
    bool overwrite, sync;        /* of that */
    int steps;                   /* each makes the same picture */
    char folder[SUPPORT_FOLDER_BYTES];
    snow_status applied[RANKS], made[RANKS];
    char said[RANKS][1024];
    int64_t pictures[RANKS];
} run;

static float field[SIDE * SIDE * SIDE];

static snow_status set_all(snow_insitu *insitu, const run *r, int rank) {
    static const int64_t dims[3] = {SIDE, SIDE, SIDE};
    static const int64_t half[3] = {SIDE, SIDE, SIDE / RANKS};
    const int64_t first[3] = {0, 0, rank * half[2]};
    const snow_image_options image = {.size = sizeof image,
                                      .overwrite = r->overwrite};
    snow_view view = {.size = sizeof view};
    char path[512];
    snow_view_init(&view);
    view.width = view.height = 16;
    snprintf(path, sizeof path, "%s/%s", r->folder, r->output ? r->output : "");
    const snow_insitu_settings settings = {.size = sizeof settings,
                                           .view = &view,
                                           .output = r->output ? path : NULL,
                                           .image = r->output ? &image : NULL,
                                           .sync = r->sync};
    SNOW_TRY(snow_insitu_set_grid(insitu, dims, NULL, NULL));
    SNOW_TRY(snow_insitu_set_brick(insitu, 0, first, half, NULL));
    SNOW_TRY(snow_insitu_set_voxels(insitu, 0, SNOW_TYPE_FLOAT32,
                                    field + SIDE * SIDE * first[2], NULL));
    return snow_insitu_set(insitu, &settings);
}

static snow_status run_rank(snow_comm *comm, void *user) {
    run *r = user;
    snow_insitu *insitu = NULL;
    snow_insitu_stats stats = {.size = sizeof stats};
    const int rank = snow_comm_rank(comm);
    char recipe[600];
    SNOW_TRY(snow_insitu_new(comm, &insitu));
    set_all(insitu, r, rank); /* what is wrong is told by a step */
    snprintf(recipe, sizeof recipe, "%s/r.json", r->folder);
    if (r->recipe)
        r->applied[rank] = snow_recipe_apply_file(insitu, recipe);
    for (int step = 0; step < r->steps; step++)
        r->made[rank] = snow_insitu_step(insitu, 7);
    snprintf(r->said[rank], sizeof *r->said, "%s", snow_insitu_message(insitu));
    snow_status status = snow_insitu_get_stats(insitu, &stats);
    r->pictures[rank] = stats.pictures;
    snow_insitu_free(insitu);
    return status;
}

/* The recipe's %s is the folder. */
static void make(run *r, const char *folder) {
    snow_context *context = support_context();
    char path[600];
    snprintf(r->folder, sizeof r->folder, "%s", folder);
    snprintf(path, sizeof path, "%s/r.json", folder);
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    fprintf(file, r->recipe ? r->recipe : "{}%.0s", folder);
    assert_int_equal(fclose(file), 0);
    for (int i = 0; i < SIDE * SIDE * SIDE; i++)
        field[i] = (float)(i % SIDE);
    synced = 0;
    assert_int_equal(snow_comm_run_threads(context, RANKS, run_rank, r),
                     SNOW_STATUS_OK);
    remove(path);
    snow_context_free(context);
}

/* The first pixel of the picture, which is of the background; removes it. */
static void take_pixel(const char *folder, float pixel[4]) {
    snow_context *context = support_context();
    snow_image *image = NULL;
    char path[512];
    snprintf(path, sizeof path, "%s/u_7.png", folder);
    if (snow_image_load(context, path, &image) != SNOW_STATUS_OK)
        fail_msg("%s", snow_context_message(context));
    memcpy(pixel, image->pixels, 4 * sizeof *pixel);
    snow_image_free(image);
    snow_context_free(context);
    remove(path);
}

static void
a_recipe_without_an_output_says_how_files_are_written(void **state) {
    static const struct {
        const char *recipe;
        bool overwrite;
        float blue, alpha;
        snow_status second; /* of a step of the same number */
    } cases[] = {
        {"{\"background\": \"#0000ff\"}", false, 1, 1, SNOW_STATUS_BAD_OUTPUT},
        {"{\"background\": \"#0000ff\"}", true, 1, 1, SNOW_STATUS_OK},
        {"{\"overwrite\": true}", false, 0, 0, SNOW_STATUS_OK},
        {"{\"azimuth\": 3}", true, 0, 0, SNOW_STATUS_OK},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        run r = {.output = "u_%d.png",
                 .recipe = cases[i].recipe,
                 .overwrite = cases[i].overwrite,
                 .steps = 2};
        float pixel[4];
        make(&r, *state);
        assert_int_equal(r.applied[0], SNOW_STATUS_OK);
        assert_int_equal(r.applied[1], SNOW_STATUS_OK);
        if (r.made[1] != cases[i].second)
            fail_msg("%s: %s", r.recipe, r.said[1]);
        take_pixel(*state, pixel);
        assert_true(pixel[2] == cases[i].blue && pixel[3] == cases[i].alpha);
    }
}

/* Without a recipe a step says it, with one who applies it. */
static void an_output_is_tried_before_a_picture_is_drawn(void **state) {
    static const struct {
        const char *output, *recipe, *wrong;
    } cases[] = {
        {"none/u_%d.png", NULL, "make the folder first"},
        {"u_%d%d.png", NULL, "one %d or %04d"},
        {"u_%d.tga", NULL, "has no suffix of a picture format"},
        {NULL, "{\"output\": \"%s/none/u_%%d.png\"}", "make the folder first"},
        {NULL, "{\"output\": \"%s/r.json/u_%%d.png\"}",
         "make the folder first"},
        {NULL, "{\"output\": \"%s/u_%%d_%%d.png\"}", "one %d or %04d"},
        {NULL, "{\"output\": \"%s/u_%%d.tga\"}", "has no suffix of a picture"},
        {"u_%d.npy", "{\"background\": \"#ffffff\"}", "nor a number of bits"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        run r = {
            .output = cases[i].output, .recipe = cases[i].recipe, .steps = 1};
        make(&r, *state);
        const bool early = !r.output;
        for (int rank = 0; rank < RANKS; rank++) {
            assert_true(early == (r.applied[rank] != SNOW_STATUS_OK));
            if (r.made[rank] == SNOW_STATUS_OK ||
                !strstr(r.said[rank], cases[i].wrong))
                fail_msg("case %zu, rank %d: %s", i, rank, r.said[rank]);
            assert_int_equal(r.pictures[rank], 0);
        }
    }
}

static void a_step_waits_for_the_disk_where_that_is_asked_for(void **state) {
    static const struct {
        const char *recipe;
        bool sync;
        int calls; /* of the file, and of its folder */
    } cases[] = {{NULL, false, 0},
                 {NULL, true, 2},
                 {"{\"sync\": true}", false, 2},
                 {"{\"sync\": false}", true, 0}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        run r = {.output = "u_%d.png",
                 .recipe = cases[i].recipe,
                 .sync = cases[i].sync,
                 .steps = 1};
        float pixel[4];
        make(&r, *state);
        assert_int_equal(r.made[0], SNOW_STATUS_OK);
        take_pixel(*state, pixel);
        assert_int_equal(synced, cases[i].calls);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_recipe_without_an_output_says_how_files_are_written),
        cmocka_unit_test(an_output_is_tried_before_a_picture_is_drawn),
        cmocka_unit_test(a_step_waits_for_the_disk_where_that_is_asked_for)};
    return cmocka_run_group_tests(tests, support_folder_setup,
                                  support_folder_teardown);
}
