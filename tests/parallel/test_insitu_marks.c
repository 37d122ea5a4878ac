/* tests/parallel/test_insitu_marks.c - a running simulation of one rank: bars
 * and the step's number over its pictures, recipes from files, ranges. */
#include "support/image.h"

#include <snowglass/recipe.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The text that a PNG has for viewers. */
static char comment[4096];

static void read_comment(const char *path) {
    static const char key[] = "tEXtSnowglass";
    static char bytes[65536];
    FILE *file = fopen(path, "rb");
    assert_non_null(file);
    size_t size = fread(bytes, 1, sizeof bytes, file), at = 0;
    fclose(file);
    while (at + sizeof key < size && memcmp(bytes + at, key, sizeof key) != 0)
        at++;
    unsigned length =
        (unsigned char)bytes[at - 2] * 256U + (unsigned char)bytes[at - 1] - 10;
    assert_true(length < sizeof comment && at + sizeof key + length < size);
    snprintf(comment, sizeof comment, "%.*s", (int)length,
             bytes + at + sizeof key);
}

/* --- a movie of one rank ---------------------------------------------------
 */

#define SIDE 12
#define VOXELS (SIDE * SIDE * SIDE)
static const int64_t cube[3] = {SIDE, SIDE, SIDE};

typedef struct fixture {
    float field[VOXELS]; /* which the test changes */
    snow_comm *comm;
    snow_insitu *insitu;
    char recipe[512], said[512];
} fixture;

static void keep_text(void *user, const char *text) {
    snprintf(user, 512, "%s", text);
}

static void set_grid(snow_insitu *insitu, const int64_t dims[3], snow_type type,
                     const void *voxels) {
    static const int64_t first[3] = {0, 0, 0};
    assert_int_equal(snow_insitu_set_grid(insitu, dims, NULL, NULL),
                     SNOW_STATUS_OK);
    assert_int_equal(snow_insitu_set_brick(insitu, 0, first, dims, NULL),
                     SNOW_STATUS_OK);
    assert_int_equal(snow_insitu_set_voxels(insitu, 0, type, voxels, NULL),
                     SNOW_STATUS_OK);
}

static fixture *open_in(image_fixture *f, snow_context *context) {
    static fixture m;
    m = (fixture){.comm = NULL};
    for (int i = 0; i < VOXELS; i++)
        m.field[i] = (float)(i % SIDE);
    snprintf(m.recipe, sizeof m.recipe, "%s", support_image_path(f, "r.json"));
    assert_int_equal(snow_comm_new_self(context, &m.comm), SNOW_STATUS_OK);
    assert_int_equal(snow_insitu_new(m.comm, &m.insitu), SNOW_STATUS_OK);
    snow_insitu_set_warning(m.insitu, keep_text, m.said);
    set_grid(m.insitu, cube, SNOW_TYPE_FLOAT32, m.field);
    return &m;
}

static fixture *open_movie(image_fixture *f) {
    return open_in(f, f->context);
}

static void close_movie(fixture *m) {
    snow_insitu_free(m->insitu);
    snow_comm_free(m->comm);
    remove(m->recipe);
}

/* Two steps of a field that does not change, as `recipe` says.  `sums` are of
 * the files' pixels. */
static void make_steps(image_fixture *f, const char *recipe, uint64_t sums[2]) {
    fixture *m = open_movie(f);
    snow_recipe r = {.size = sizeof r};
    assert_int_equal(
        snow_recipe_parse(f->context, "text", recipe, strlen(recipe), &r),
        SNOW_STATUS_OK);
    r.output = support_image_path(f, "s_%d.png");
    r.width = r.height = 160;
    assert_int_equal(snow_recipe_apply(&r, m->insitu), SNOW_STATUS_OK);
    for (int step = 0; step < 2; step++) {
        snow_image *image = NULL;
        char name[8] = {'s', '_', (char)('0' + step), '.', 'p', 'n', 'g', 0};
        assert_int_equal(snow_insitu_step(m->insitu, step), SNOW_STATUS_OK);
        assert_int_equal(
            snow_image_load(f->context, support_image_path(f, name), &image),
            SNOW_STATUS_OK);
        sums[step] = snow_image_checksum(image);
        snow_image_free(image);
        read_comment(f->path);
        remove(f->path);
    }
    snow_recipe_clear(&r);
    close_movie(m);
}

/* --- texts of recipes ------------------------------------------------------
 */

static void a_picture_tells_its_grid_and_look(void **state) {
    uint64_t sums[2];
    make_steps(*state, "{\"range\": [0, 8], \"opacity\": [[0, 0], [8, 0.5]]}",
               sums);
    assert_string_equal(
        comment, "{\"step\":1,\"dims\":[12,12,12],\"range\":[0,8],\"matrix\":"
                 "[1,0,0,0,0,1,0,0,0,0,1,0],\"opacity\":[[0,0],[8,0.5]]}");
}

static void a_recipes_legend_and_step_are_drawn(void **state) {
    image_fixture *f = *state;
    uint64_t plain[2], legend[2], label[2];
    make_steps(f, "{}", plain);
    make_steps(f, "{\"legend\": true}", legend);
    make_steps(f, "{\"annotate\": \"step\"}", label);
    assert_true(plain[0] == plain[1]);
    assert_true(legend[0] == legend[1] && legend[0] != plain[0]);
    assert_true(label[0] != label[1] && label[0] != plain[0]);
}

static void a_recipes_planes_cut_the_picture(void **state) {
    image_fixture *f = *state;
    uint64_t plain[2], cut[2], spared[2];
    make_steps(f, "{\"range\": [0, 8]}", plain);
    make_steps(f, "{\"range\": [0, 8], \"clip\": [[1, 0, 0, 6]]}", cut);
    make_steps(f, "{\"range\": [0, 8], \"clip\": [[1, 0, 0, 11]]}", spared);
    assert_true(plain[0] == spared[0] && cut[0] != plain[0]);
}

static void others_are_refused_in_situ(void **state) {
    image_fixture *f = *state;
    static const char *const texts[][2] = {
        {"{\"depth\": \"d.npy\"}", "\"depth\" is for pictures of files"},
        {"{\"overlay\": \"o.nii\"}", "\"overlay\" is for pictures of files"},
        {"{\"crop\": [[0, 9], [0, 9], [0, 9]]}", "\"crop\" is for"},
        {"{\"mask\": \"m.nii\"}", "\"mask\" is for pictures of files"},
        {"{\"labels\": \"1,2\"}", "\"labels\" is for pictures of files"},
        {"{\"label-table\": \"t\"}", "\"label-table\" is for pictures"},
        {"{\"levels\": 1}", "\"levels\" is for pictures of files"}};
    for (size_t n = 0; n < sizeof texts / sizeof *texts; n++) {
        fixture *m = open_movie(f);
        snow_recipe r = {.size = sizeof r};
        const char *text = texts[n][0];
        assert_int_equal(
            snow_recipe_parse(f->context, "text", text, strlen(text), &r),
            SNOW_STATUS_OK);
        assert_int_equal(snow_recipe_apply(&r, m->insitu),
                         SNOW_STATUS_BAD_USAGE);
        assert_non_null(strstr(snow_context_message(snow_comm_context(m->comm)),
                               texts[n][1]));
        snow_recipe_clear(&r);
        close_movie(m);
    }
}

/* --- recipes in files ------------------------------------------------------
 */

/* Files of other lengths differ, whatever the clock's steps. */
static void write_recipe(const fixture *m, const char *text) {
    FILE *file = fopen(m->recipe, "w");
    assert_non_null(file);
    assert_true(fputs(text, file) >= 0);
    assert_int_equal(fclose(file), 0);
}

static void apply_recipe(const fixture *m, const char *text) {
    write_recipe(m, text);
    assert_int_equal(snow_recipe_apply_file(m->insitu, m->recipe),
                     SNOW_STATUS_OK);
}

static void scale_field(fixture *m, float factor) {
    for (int i = 0; i < VOXELS; i++)
        m->field[i] *= factor;
}

/* The picture's pixels as a number. */
static uint64_t draw(const fixture *m) {
    snow_image *image = NULL;
    assert_int_equal(snow_insitu_update(m->insitu), SNOW_STATUS_OK);
    assert_int_equal(snow_insitu_render(m->insitu, &image), SNOW_STATUS_OK);
    uint64_t sum = snow_image_checksum(image);
    snow_image_free(image);
    return sum;
}

static void a_wrong_recipe_makes_no_picture(void **state) {
    fixture *m = open_movie(*state);
    snow_image *image = NULL;
    write_recipe(m, "{\"colour\": 3}");
    assert_int_equal(snow_recipe_apply_file(m->insitu, m->recipe),
                     SNOW_STATUS_BAD_INPUT);
    assert_non_null(strstr(snow_insitu_message(m->insitu), "\"colour\""));
    for (int step = 0; step < 3; step++) {
        assert_int_equal(snow_insitu_update(m->insitu), SNOW_STATUS_BAD_INPUT);
        assert_non_null(strstr(snow_insitu_message(m->insitu), "colour"));
        assert_int_equal(snow_insitu_render(m->insitu, &image),
                         SNOW_STATUS_BAD_INPUT);
        assert_null(image);
    }
    apply_recipe(m, "{\"size\": 64}");
    draw(m);
    close_movie(m);
}

static void a_recipe_that_changes_is_read_again(void **state) {
    fixture *m = open_movie(*state);
    apply_recipe(m, "{\"size\": 64, \"reread\": true}");
    uint64_t before = draw(m);
    assert_true(draw(m) == before);
    write_recipe(m, "{\"size\": 64, \"reread\": true, \"azimuth\": 40}");
    uint64_t turned = draw(m);
    assert_true(turned != before);
    write_recipe(m, "{\"size\": 64, \"reread\": true, \"azimut\": 40, ");
    assert_true(draw(m) == turned);
    assert_non_null(strstr(m->said, "pictures stay as they were"));
    m->said[0] = 0;
    assert_true(draw(m) == turned); /* and says so once */
    assert_string_equal(m->said, "");
    write_recipe(m, "{\"size\": 64, \"output\": \"all.png\"}");
    assert_true(draw(m) == turned); /* which updates, and renders */
    assert_non_null(strstr(m->said, "one %d or %04d"));
    write_recipe(m, "{\"size\": 64}");
    assert_true(draw(m) == before);
    write_recipe(m, "{\"size\": 64, \"azimuth\": 40.0}");
    assert_true(draw(m) == before); /* it asked for nothing more */
    close_movie(m);
}

static void a_range_is_kept_and_widened_with_a_note(void **state) {
    fixture *m = open_movie(*state);
    apply_recipe(m, "{\"size\": 64, \"preset\": \"linear\"}");
    uint64_t before = draw(m);
    scale_field(m, 0.5F);
    uint64_t darker = draw(m);
    assert_true(darker != before);
    assert_string_equal(m->said, "");
    scale_field(m, 8);
    draw(m);
    assert_non_null(strstr(m->said, "spread over 0 to 44"));
    m->said[0] = 0;
    scale_field(m, 0.25F);
    assert_true(draw(m) != before); /* 11 is no longer white */
    assert_string_equal(m->said, "");
    close_movie(m);
}

static void a_range_begins_where_values_differ(void **state) {
    fixture *m = open_movie(*state);
    apply_recipe(m, "{\"size\": 64, \"preset\": \"linear\"}");
    for (int step = 0; step < 3; step++) { /* 300, 400, and 300 to 400 */
        for (int i = 0; i < VOXELS; i++)
            m->field[i] =
                (float)(step == 2 ? 300 + 100 * (i % 2) : 300 + 100 * step);
        draw(m);
    }
    assert_non_null(strstr(m->said, "spread over 300 to 400"));
    close_movie(m);
}

/* The picture of blocks of labels; in a movie that began with others, or not.
 */
static uint64_t draw_blocks(image_fixture *f, const char *recipe, int first) {
    static uint8_t field[8 * 8 * 512];
    static const uint8_t labels[2][8] = {{0, 7, 0, 3, 0, 3, 0, 7},
                                         {0, 7, 0, 3, 0, 5, 0, 9}};
    const int64_t dims[3] = {8, 8, 512};
    fixture *m = open_movie(f);
    uint64_t sum = 0;
    set_grid(m->insitu, dims, SNOW_TYPE_UINT8, field);
    apply_recipe(m, recipe);
    for (int step = first; step < 2; step++) {
        for (int i = 0; i < 8 * 8 * 512; i++)
            field[i] = labels[step][i / (8 * 8 * 64)];
        sum = draw(m);
    }
    close_movie(m);
    return sum;
}

static void labels_that_appear_have_their_colours(void **state) {
    static const char *const recipes[] = {
        "{\"size\": 64, \"view\": \"iso\"}",
        "{\"size\": 64, \"view\": \"iso\", \"preset\": \"labels\"}"};
    uint64_t sums[2][2];
    for (int n = 0; n < 2; n++)
        for (int first = 0; first < 2; first++)
            sums[n][first] = draw_blocks(*state, recipes[n], first);
    assert_true(sums[0][0] == sums[0][1] && sums[1][0] == sums[1][1]);
    assert_true(sums[0][0] == sums[1][0]);
}

/* The picture of a field, which is best unshaded. */
static uint64_t draw_field(image_fixture *f, const char *recipe) {
    fixture *m = open_movie(f);
    write_recipe(m, recipe);
    for (int i = 0; i < VOXELS; i++)
        m->field[i] = (float)(i % 12) + 0.5F;
    assert_int_equal(snow_recipe_apply_file(m->insitu, m->recipe),
                     SNOW_STATUS_OK);
    uint64_t sum = draw(m);
    close_movie(m);
    return sum;
}

static void a_shade_that_is_named_is_kept(void **state) {
    uint64_t plain = draw_field(*state, "{\"size\": 64}");
    assert_true(draw_field(*state, "{\"size\": 64, \"shade\": \"none\"}") ==
                plain);
    assert_true(draw_field(*state, "{\"size\": 64, \"shade\": \"phong\"}") !=
                plain);
}

/* --- two ranks -------------------------------------------------------------
 */

/* A file of a look that rank 1 has no memory for. */
#define TF_BYTES (3 << 20)

static _Thread_local bool has_little;

static void *allocate_little(void *user, size_t bytes) {
    (void)user;
    return has_little && bytes >= TF_BYTES ? NULL : malloc(bytes);
}

static void release(void *user, void *block) {
    (void)user;
    free(block);
}

typedef struct rereading {
    fixture files; /* the recipe's name, and what is said */
    char texts[5][512];
    uint64_t sums[5];
} rereading;

static snow_status describe_half(snow_insitu *insitu, const float *field) {
    const int rank = snow_comm_rank(snow_insitu_comm(insitu));
    const int64_t half[3] = {12, 12, 6}, first[3] = {0, 0, 6 * rank};
    SNOW_TRY(snow_insitu_set_grid(insitu, cube, NULL, NULL));
    SNOW_TRY(snow_insitu_set_brick(insitu, 0, first, half, NULL));
    return snow_insitu_set_voxels(insitu, 0, SNOW_TYPE_FLOAT32,
                                  field + rank * 6 * 144, NULL);
}

static snow_status reread_rank(snow_comm *comm, void *user) {
    rereading *r = user;
    snow_insitu *insitu = NULL;
    snow_status status = SNOW_STATUS_OK;
    has_little = snow_comm_rank(comm) == 1;
    SNOW_TRY(snow_insitu_new(comm, &insitu));
    snow_insitu_set_warning(insitu, keep_text, r->files.said);
    for (int n = 0; n < 5 && status == SNOW_STATUS_OK; n++) {
        snow_image *image = NULL;
        if (!has_little)
            write_recipe(&r->files, r->texts[n]);
        if (n == 0)
            status = snow_recipe_apply_file(insitu, r->files.recipe);
        if (status == SNOW_STATUS_OK)
            status = describe_half(insitu, r->files.field);
        if (status == SNOW_STATUS_OK)
            status = snow_insitu_update(insitu);
        if (status == SNOW_STATUS_OK)
            status = snow_insitu_render(insitu, &image);
        if (image)
            r->sums[n] = snow_image_checksum(image);
        snow_image_free(image);
    }
    snow_insitu_free(insitu);
    return status;
}

/* The recipes one after another; the second and third are refused. */
static void write_texts(rereading *r, const char *tf) {
    static const char *const texts[5] = {
        "{\"size\": 64, \"reread\": true}",
        "{\"size\": 64, \"reread\": true, \"tf\": \"%s\"}",
        "{\"size\": 64, \"tf\": \"%s\"}", "{\"size\": 64, \"azimuth\": 40}",
        "{\"size\": 64, \"azimuth\": 80.0}"};
    for (int n = 0; n < 5; n++)
        snprintf(r->texts[n], sizeof *r->texts, texts[n], tf);
}

/* With and without "reread": nothing of it is applied, and all go on to look
 * at the file, until a recipe asks them not to. */
static void a_recipe_that_fails_on_one_rank_is_applied_on_none(void **state) {
    image_fixture *f = *state;
    static rereading r;
    const snow_allocator allocator = {allocate_little, release, NULL};
    snow_context *context = NULL;
    char tf[128];
    for (int i = 0; i < VOXELS; i++)
        r.files.field[i] = (float)(i % 12);
    snprintf(r.files.recipe, sizeof r.files.recipe, "%s/r.json", f->folder);
    snprintf(tf, sizeof tf, "%s/look.csv", f->folder);
    FILE *file = fopen(tf, "w");
    assert_non_null(file);
    fprintf(file, "0 0\n11 1\n#%*s\n", TF_BYTES, "");
    assert_int_equal(fclose(file), 0);
    write_texts(&r, tf);
    assert_int_equal(snow_context_new(&allocator, &context), SNOW_STATUS_OK);
    snow_status status = snow_comm_run_threads(context, 2, reread_rank, &r);
    if (status != SNOW_STATUS_OK)
        fail_msg("%s", snow_context_message(context));
    snow_context_free(context);
    assert_non_null(strstr(r.files.said, "rank 1: out of memory"));
    assert_non_null(strstr(r.files.said, "pictures stay as they were"));
    assert_true(r.sums[1] == r.sums[0] && r.sums[2] == r.sums[0]);
    assert_true(r.sums[3] != r.sums[0] && r.sums[4] == r.sums[3]);
    remove(tf);
    remove(r.files.recipe);
}

/* --- how often values occur ------------------------------------------------
 */

/* Refuses blocks of some size. */
typedef struct picky {
    size_t refused;
    int times;
} picky;

static void *picky_allocate(void *user, size_t bytes) {
    picky *p = user;
    /* A context may ask for a little more than it is asked for. */
    if (!p->refused || bytes < p->refused || bytes > p->refused + 128)
        return malloc(bytes);
    p->times++;
    return NULL;
}

static void picky_release(void *user, void *block) {
    (void)user;
    free(block);
}

typedef struct counting {
    int64_t dims[3];
    const char *suffix;
    picky memory;
    char said[512];
    int64_t counted; /* in the file of the picture */
} counting;

static int64_t sum_of_counts(void) {
    const char *at = strstr(comment, "\"counts\":[");
    int64_t sum = 0;
    if (!at)
        return 0;
    for (at = strchr(at, '['); *at != ']';) {
        char *end;
        sum += strtoll(at + 1, &end, 10);
        at = end;
    }
    return sum;
}

/* A step of a recipe that is read again. */
static void count_step(image_fixture *f, counting *c) {
    const snow_allocator allocator = {picky_allocate, picky_release,
                                      &c->memory};
    const size_t size = (size_t)(c->dims[0] * c->dims[1] * c->dims[2]);
    unsigned char *field = malloc(size);
    char name[32], text[1024];
    snow_context *context = NULL;
    assert_non_null(field);
    for (size_t n = 0; n < size; n++)
        field[n] = (unsigned char)(n % 200);
    assert_int_equal(snow_context_new(&allocator, &context), SNOW_STATUS_OK);
    fixture *m = open_in(f, context);
    set_grid(m->insitu, c->dims, SNOW_TYPE_UINT8, field);
    snprintf(name, sizeof name, "c_%%d%s", c->suffix);
    snprintf(text, sizeof text,
             "{\"size\": 16, \"reread\": true, \"range\": [0, 255], "
             "\"overwrite\": true, \"output\": \"%s\"}",
             support_image_path(f, name));
    apply_recipe(m, text);
    if (snow_insitu_step(m->insitu, 0) != SNOW_STATUS_OK)
        fail_msg("%s", snow_insitu_message(m->insitu));
    snprintf(name, sizeof name, "c_0%s", c->suffix);
    const char *path = support_image_path(f, name);
    if (strcmp(c->suffix, ".png") == 0) {
        read_comment(path);
        c->counted = sum_of_counts();
    }
    assert_int_equal(remove(path), 0);
    memcpy(c->said, m->said, sizeof c->said);
    close_movie(m);
    snow_context_free(context);
    free(field);
}

static void values_are_counted_for_viewers(void **state) {
    counting small = {.dims = {13, 12, 11}, .suffix = ".png"},
             flat = {.dims = {1100, 1000, 2}, .suffix = ".png"},
             deep = {.dims = {120, 100, 100}, .suffix = ".png"};
    count_step(*state, &small);
    assert_int_equal(small.counted, 13 * 12 * 11);
    count_step(*state, &flat); /* each eighth row */
    assert_int_equal(flat.counted, 1100 * 125 * 2);
    count_step(*state, &deep); /* each fourth slice */
    assert_int_equal(deep.counted, 120 * 100 * 25);
    assert_string_equal(deep.said, "");
}

/* Where the counts have no room, the picture is written. */
static void a_picture_is_written_without_counts(void **state) {
    counting c = {.dims = {1303, 7, 3},
                  .suffix = ".png",
                  .memory = {.refused = 1303 * 7}};
    count_step(*state, &c);
    assert_true(c.memory.times > 0);
    assert_int_equal(c.counted, 0);
    assert_null(strstr(comment, "ends"));
    assert_non_null(strstr(c.said, "without the counts"));
}

/* Files of values have no room for counts: the memory for them is not asked
 * for. */
static void files_of_values_have_no_counts(void **state) {
    counting c = {.dims = {1303, 7, 3},
                  .suffix = ".npy",
                  .memory = {.refused = 1303 * 7}};
    count_step(*state, &c);
    assert_int_equal(c.memory.times, 0);
    assert_string_equal(c.said, "");
}

int main(void) {
#define HERE(test)                                             \
    cmocka_unit_test_setup_teardown(test, support_image_setup, \
                                    support_image_teardown)
    const struct CMUnitTest tests[] = {
        HERE(a_recipes_planes_cut_the_picture),
        HERE(others_are_refused_in_situ),
        HERE(a_picture_tells_its_grid_and_look),
        HERE(a_recipes_legend_and_step_are_drawn),
        HERE(a_wrong_recipe_makes_no_picture),
        HERE(a_recipe_that_changes_is_read_again),
        HERE(a_range_is_kept_and_widened_with_a_note),
        HERE(a_shade_that_is_named_is_kept),
        HERE(a_range_begins_where_values_differ),
        HERE(labels_that_appear_have_their_colours),
        HERE(a_recipe_that_fails_on_one_rank_is_applied_on_none),
        HERE(values_are_counted_for_viewers),
        HERE(a_picture_is_written_without_counts),
        HERE(files_of_values_have_no_counts)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
