/* tests/serve/test_state.c - what is shown next: the newest state, by a clock
 * that the test moves. */
#include "support/support.h"

#include <math.h>
#include <time.h>

static double clock_seconds = 1000; /* in seconds */

int __wrap_clock_gettime(clockid_t id, struct timespec *at) {
    (void)id;
    at->tv_sec = (time_t)clock_seconds;
    at->tv_nsec = (long)((clock_seconds - (double)at->tv_sec) * 1e9);
    return 0;
}

#include "state.h"

static json_t *tree_of(const char *text) {
    json_t *tree = json_loads(text, 0, NULL);
    assert_non_null(tree);
    return tree;
}

static viewer_state *state_of(const char *text) {
    viewer_state *s = state_new(tree_of(text));
    assert_non_null(s);
    return s;
}

/* The revision, or 0 where the changes are refused. */
static uint32_t set(viewer_state *s, const char *text) {
    uint32_t revision;
    json_t *changes = tree_of(text);
    char *fault = state_set(s, changes, &revision);
    json_decref(changes);
    if (!fault)
        return revision;
    free(fault);
    return 0;
}

static void assert_recipe(viewer_state *s, const char *text) {
    json_t *wanted = tree_of(text), *is = state_recipe(s);
    char *found = json_dumps(is, JSON_COMPACT);
    if (!json_equal(wanted, is))
        fail_msg("the recipe is %s", found);
    free(found);
    json_decref(wanted);
    json_decref(is);
}

/* The next work, without waiting, and when else there is some: in seconds from
 * now, 0 for none. */
static viewer_work next(viewer_state *s, uint32_t drawn, int level,
                        double *due) {
    viewer_question question = {.tree = NULL};
    json_t *recipe = NULL;
    uint32_t revision = 0;
    viewer_work work =
        state_next(s, drawn, level, due, &question, &recipe, &revision);
    *due = *due > 0 ? *due - clock_seconds : 0;
    assert_true((work == WORK_ANSWER) == (question.tree != NULL));
    assert_true((work >= WORK_DRAFT) == (recipe != NULL));
    if (recipe)
        assert_int_equal(revision, state_revision(s));
    json_decref(question.tree);
    json_decref(recipe);
    return work;
}

static void assert_next(viewer_state *s, uint32_t drawn, int level,
                        viewer_work work, double wanted) {
    double due;
    assert_int_equal(next(s, drawn, level, &due), work);
    if (work == WORK_NONE)
        assert_true(fabs(due - wanted) < 1e-6);
}

static void ask(viewer_state *s, const char *what) {
    assert_true(state_ask(s, 1, json_pack("{s:s}", "what", what)));
}

static void the_last_set_wins(void **state) {
    (void)state;
    viewer_state *s = state_of("{\"azimuth\":1,\"size\":[64,48]}");
    uint32_t first = state_revision(s);
    for (int i = 1; i <= 100; i++) {
        char text[64];
        snprintf(text, sizeof text, "{\"azimuth\":%d}", i);
        assert_int_equal(set(s, text), first + (uint32_t)i);
    }
    assert_true(set(s, "{\"elevation\":5,\"size\":null}"));
    assert_recipe(s, "{\"azimuth\":100,\"elevation\":5}");
    assert_true(state_is_stale(s, first + 100));
    assert_false(state_is_stale(s, first + 101));
    state_free(s);
}

static void what_is_wrong_is_left_out(void **state) {
    (void)state;
    static const char *const wrong[] = {
        "{\"zoom\":\"large\"}", "{\"time\":\"2:4\"}", "{\"preset\":7}",
        "{\"overlay-look\":\"0.5\"}", "{\"overlay-look\":\"hot,5,\"}"};
    viewer_state *s = state_of("{\"azimuth\":1}");
    uint32_t first = state_revision(s);
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        assert_int_equal(set(s, wrong[i]), 0);
        assert_recipe(s, "{\"azimuth\":1}");
        assert_int_equal(state_revision(s), first);
    }
    assert_int_equal(set(s, "{\"azimuth\":2,\"zoom\":\"large\",\"mode\":3}"),
                     0);
    assert_recipe(s, "{\"azimuth\":2}");
    assert_int_equal(state_revision(s), first + 1);
    /* One of two that exclude one another makes room, in whichever order. */
    assert_true(set(s, "{\"window\":[10,5]}"));
    assert_int_equal(set(s, "{\"range\":[1,2],\"window\":null,\"mode\":3}"), 0);
    assert_recipe(s, "{\"azimuth\":2,\"range\":[1,2]}");
    state_free(s);
}

static void files_are_switched_and_not_told(void **state) {
    (void)state;
    viewer_state *s = state_of("{\"mask\":\"/secret.nrrd\",\"azimuth\":1}");
    assert_true(set(s, "{\"mask\":null,\"overlay\":true}"));
    assert_recipe(s, "{\"azimuth\":1}");
    assert_true(set(s, "{\"mask\":true}"));
    assert_recipe(s, "{\"mask\":\"/secret.nrrd\",\"azimuth\":1}");
    outgoing *p = state_message(s, 3, 0);
    assert_non_null(p);
    char *text = calloc(1, p->length + 1);
    memcpy(text, p->bytes, p->length);
    assert_null(strstr(text, "secret"));
    assert_non_null(strstr(text, "\"mask\":true"));
    assert_int_equal(p->revision, state_revision(s));
    free(text);
    free(p);
    state_free(s);
}

static void what_cannot_be_drawn_is_taken_back(void **state) {
    (void)state;
    viewer_state *s = state_of("{\"azimuth\":1,\"size\":[64,48]}");
    json_t *drawn = state_recipe(s);
    uint32_t bad = set(s, "{\"time\":7,\"size\":[90,80]}");
    assert_false(state_take_back(s, bad - 1, drawn)); /* a newer one is there */
    assert_recipe(s, "{\"azimuth\":1,\"time\":7,\"size\":[90,80]}");
    assert_true(state_take_back(s, bad, drawn));
    assert_recipe(s, "{\"azimuth\":1,\"size\":[90,80]}"); /* the window stays */
    assert_true(state_is_stale(s, bad));
    assert_false(state_take_back(s, bad + 1, drawn)); /* nothing to change */
    json_decref(drawn);
    state_free(s);
}

static void crop_and_camera_come_together_or_not(void **state) {
    (void)state;
    viewer_state *s = state_of("{}");
    assert_true(set(s, "{\"crop\":[[1,9],[1,9],[1,9]]}"));
    assert_true(state_crop_is_alone(s));
    assert_true(set(s, "{\"azimuth\":3}"));
    assert_true(state_crop_is_alone(s));
    assert_true(set(s, "{\"crop\":null,\"zoom\":2}"));
    assert_false(state_crop_is_alone(s));
    state_free(s);
}

static void a_picture_gets_finer_while_it_rests(void **state) {
    (void)state;
    viewer_state *s = state_of("{}");
    assert_next(s, 0, -1, WORK_NONE, 0); /* nobody looks */
    state_set_watchers(s, 1);
    assert_next(s, 0, -1, WORK_DRAFT, 0);
    uint32_t drawn = set(s, "{\"azimuth\":5}");
    assert_next(s, drawn - 1, 2, WORK_DRAFT, 0);
    clock_seconds += 0.1;
    assert_next(s, drawn, 0, WORK_NONE, STATE_NORMAL_SECONDS - 0.1);
    clock_seconds += 0.03;
    assert_next(s, drawn, 0, WORK_NORMAL, 0);
    assert_next(s, drawn, 1, WORK_NONE, STATE_HIGH_SECONDS - 0.13);
    clock_seconds += 0.2;
    assert_next(s, drawn, 1, WORK_HIGH, 0);
    assert_next(s, drawn, 2, WORK_NONE, 0);
    assert_next(s, drawn, -1, WORK_DRAFT, 0); /* it had no room, say */
    state_set_watchers(s, 0);
    assert_next(s, drawn, 0, WORK_NONE, 0);
    state_free(s);
}

static void drafts_suffice_while_something_moves(void **state) {
    (void)state;
    viewer_state *s = state_of("{}");
    state_set_watchers(s, 1);
    state_set_moving(s, true);
    uint32_t drawn = set(s, "{\"azimuth\":5}");
    clock_seconds += 9;
    assert_next(s, drawn, 0, WORK_NONE, 0);
    assert_next(s, drawn - 1, 0, WORK_DRAFT, 0);
    state_set_moving(s, false); /* it rests from here on */
    assert_next(s, drawn, 0, WORK_NONE, STATE_NORMAL_SECONDS);
    state_set_moving(s, true);
    state_set_watchers(s, 0); /* who moved it has gone */
    state_set_watchers(s, 1);
    clock_seconds += 9;
    assert_next(s, drawn, 0, WORK_NORMAL, 0);
    state_free(s);
}

static void answers_and_drafts_take_turns(void **state) {
    (void)state;
    viewer_state *s = state_of("{}");
    state_set_watchers(s, 1);
    uint32_t drawn = set(s, "{\"azimuth\":5}");
    for (int i = 0; i < 3; i++)
        ask(s, "command");
    assert_true(state_is_asked(s));
    assert_next(s, drawn - 1, 0, WORK_ANSWER, 0);
    assert_next(s, drawn - 1, 0, WORK_DRAFT, 0);
    assert_next(s, drawn - 1, 0, WORK_ANSWER, 0);
    clock_seconds += 9; /* a picture at rest waits for all answers */
    assert_next(s, drawn, 0, WORK_ANSWER, 0);
    assert_false(state_is_asked(s));
    assert_next(s, drawn, 0, WORK_NORMAL, 0);
    state_free(s);
}

static void thumbnails_wait_for_the_picture(void **state) {
    (void)state;
    viewer_state *s = state_of("{}");
    state_set_watchers(s, 1);
    uint32_t drawn = set(s, "{\"azimuth\":5}");
    ask(s, "thumbnail");
    assert_false(state_is_asked(s));
    assert_next(s, drawn, 0, WORK_NONE, STATE_NORMAL_SECONDS);
    ask(s, "command");
    assert_next(s, drawn, 0, WORK_ANSWER, 0); /* it comes before */
    assert_false(state_is_asked(s));
    assert_next(s, drawn, 1, WORK_NONE, STATE_HIGH_SECONDS);
    state_set_moving(s, true);
    assert_next(s, drawn, 2, WORK_NONE, 0);
    state_set_moving(s, false);
    assert_next(s, drawn, 2, WORK_ANSWER, 0);
    assert_next(s, drawn, 2, WORK_NONE, 0);
    state_free(s);
}

static void questions_have_a_limit(void **state) {
    (void)state;
    viewer_state *s = state_of("{}");
    for (int round = 0; round < 3; round++) { /* of a ring, each begins later */
        for (int i = 0; i < STATE_QUESTIONS_OF_PAGE; i++)
            ask(s, i % 2 ? "thumbnail" : "command");
        assert_false(state_ask(s, 1, json_object()));
        for (int i = STATE_QUESTIONS_OF_PAGE; i < STATE_QUESTIONS_MOST; i++)
            assert_true(state_ask(s, 2, json_object())); /* another page */
        assert_false(state_ask(s, 2, json_object()));
        for (int i = 0; i < STATE_QUESTIONS_MOST; i++)
            assert_next(s, 0, -1, WORK_ANSWER, 0);
        assert_next(s, 0, -1, WORK_NONE, 0);
        ask(s, "command");
        assert_next(s, 0, -1, WORK_ANSWER, 0);
    }
    ask(s, "command"); /* freed with the rest */
    state_free(s);
}

static void the_end_comes_before_all(void **state) {
    (void)state;
    viewer_state *s = state_of("{}");
    state_set_watchers(s, 1);
    ask(s, "command");
    state_end(s);
    assert_true(state_has_ended(s) && state_is_stale(s, state_revision(s)));
    assert_next(s, 0, -1, WORK_END, 0);
    state_free(s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_last_set_wins),
        cmocka_unit_test(what_is_wrong_is_left_out),
        cmocka_unit_test(files_are_switched_and_not_told),
        cmocka_unit_test(what_cannot_be_drawn_is_taken_back),
        cmocka_unit_test(crop_and_camera_come_together_or_not),
        cmocka_unit_test(a_picture_gets_finer_while_it_rests),
        cmocka_unit_test(drafts_suffice_while_something_moves),
        cmocka_unit_test(answers_and_drafts_take_turns),
        cmocka_unit_test(thumbnails_wait_for_the_picture),
        cmocka_unit_test(questions_have_a_limit),
        cmocka_unit_test(the_end_comes_before_all),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
