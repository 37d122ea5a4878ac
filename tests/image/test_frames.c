/* tests/image/test_frames.c - the queue between rendering and writing: order,
 * copies, bounds and faults, with more threads than processors.  Under the
 * thread sanitizer it is the test that the queue has no race. */
#include "support/support.h"

#include "movie/frames.h"

#include <stdatomic.h>

/* What a sink saw. */
typedef struct seen {
    int64_t committed[512];
    float values[512];
    int count; /* commits; one thread at a time, so plain */
    int64_t fail_prepare, fail_commit; /* indices, -1: none */
    atomic_int preparing, most;        /* at once */
    atomic_int puts;
    int ahead; /* the most frames put beyond the one committed */
    int slots_released;
} seen;

/* Takes its time, differently for each frame. */
static void dawdle(int64_t index) {
    struct timespec nap = {0, (long)(index * 7919 % 13) * 50000};
    nanosleep(&nap, NULL);
}

static snow_status prepare_slot(void *user, frame_slot *slot) {
    seen *s = user;
    int now = ++s->preparing, most = s->most;
    while (now > most && !atomic_compare_exchange_weak(&s->most, &most, now))
        continue;
    dawdle(slot->index);
    if (!slot->work)
        slot->work = malloc(sizeof(float));
    assert_non_null(slot->work);
    *(float *)slot->work =
        slot->image ? snow_image_pixels(slot->image)[0] : -1.0f;
    s->preparing--;
    if (slot->index != s->fail_prepare)
        return SNOW_STATUS_OK;
    snprintf(slot->fault, sizeof slot->fault, "frame %d is bad",
             (int)slot->index);
    return SNOW_STATUS_FAILED;
}

static snow_status commit_slot(void *user, frame_slot *slot) {
    seen *s = user;
    int ahead = s->puts - s->count;
    if (ahead > s->ahead)
        s->ahead = ahead;
    s->committed[s->count] = slot->index;
    s->values[s->count++] = *(float *)slot->work;
    if (slot->index != s->fail_commit)
        return SNOW_STATUS_OK;
    snprintf(slot->fault, sizeof slot->fault, "no room for %d",
             (int)slot->index);
    return SNOW_STATUS_BAD_OUTPUT;
}

static void release_slot(void *user, frame_slot *slot) {
    seen *s = user;
    free(slot->work);
    slot->work = NULL;
    s->slots_released++;
}

static seen nothing_seen(void) {
    return (seen){.fail_prepare = -1, .fail_commit = -1};
}

static frame_queue *open_queue(seen *s, int workers) {
    const frame_sink sink = {s, prepare_slot, commit_slot, release_slot};
    frame_queue *queue = NULL;
    assert_int_equal(frames_new(&sink, workers, &queue), SNOW_STATUS_OK);
    return queue;
}

static snow_image *picture(snow_context *context, int width, int channels) {
    snow_image *image = NULL;
    assert_int_equal(snow_image_new(context, width, 3, channels, &image),
                     SNOW_STATUS_OK);
    return image;
}

/* Puts frames until one is refused: one picture written over for each. */
static snow_status put_frames(frame_queue *queue, seen *s, snow_image *image,
                              int count) {
    snow_status status = SNOW_STATUS_OK;
    for (int i = 0; i < count && status == SNOW_STATUS_OK; i++) {
        snow_image_pixels(image)[0] = (float)i;
        s->puts++;
        status = frames_put(queue, i, image, NULL);
    }
    return status;
}

/* Pictures change their form; some lie in files already. */
static void frames_are_committed_in_order_as_they_were_put(void **state) {
    snow_context *context = *state;
    for (int workers = 1; workers <= FRAME_WORKERS_MOST; workers++) {
        seen s = nothing_seen();
        frame_queue *queue = open_queue(&s, workers);
        for (int i = 0; i < 150; i++) {
            snow_image *image = picture(context, 1 + i % 7, i % 2 ? 2 : 4);
            snow_image_pixels(image)[0] = (float)i;
            s.puts++;
            assert_int_equal(frames_put(queue, i, i % 5 ? image : NULL, NULL),
                             SNOW_STATUS_OK);
            snow_image_free(image);
        }
        assert_int_equal(frames_drain(queue), SNOW_STATUS_OK);
        assert_string_equal(frames_message(queue), "");
        assert_int_equal(s.count, 150);
        for (int i = 0; i < 150; i++) {
            assert_int_equal(s.committed[i], i);
            assert_true(s.values[i] == (i % 5 ? (float)i : -1.0f));
        }
        assert_true(s.most <= workers);
        assert_true(workers == 1 || s.most > 1);
        /* the frame in hand, the slots, and the one that waits to be put */
        assert_true(s.ahead <= workers + 2 + 1);
        frames_free(queue);
        assert_int_equal(s.slots_released, workers + 2);
    }
}

static void nothing_is_committed_after_a_fault(void **state) {
    snow_context *context = *state;
    snow_image *image = picture(context, 4, 4);
    for (int workers = 1; workers <= 4; workers += 3) {
        seen s = nothing_seen();
        s.fail_commit = 20;
        frame_queue *queue = open_queue(&s, workers);
        assert_int_equal(put_frames(queue, &s, image, 100),
                         SNOW_STATUS_BAD_OUTPUT);
        assert_int_equal(frames_status(queue), SNOW_STATUS_BAD_OUTPUT);
        assert_int_equal(frames_drain(queue), SNOW_STATUS_BAD_OUTPUT);
        assert_string_equal(frames_message(queue), "no room for 20");
        assert_int_equal(s.count, 21);
        assert_int_equal(frames_put(queue, 100, image, NULL),
                         SNOW_STATUS_BAD_OUTPUT);
        frames_free(queue);
        assert_int_equal(s.count, 21);
    }
    snow_image_free(image);
}

/* Later frames may fail sooner; the first one counts. */
static void a_fault_of_compression_is_told_in_its_turn(void **state) {
    snow_context *context = *state;
    snow_image *image = picture(context, 4, 4);
    for (int both = 1; both >= 0; both--) {
        seen s = nothing_seen();
        s.fail_prepare = 13;            /* which dawdles not at all */
        s.fail_commit = both ? 12 : -1; /* which dawdles longest */
        frame_queue *queue = open_queue(&s, 6);
        (void)put_frames(queue, &s, image, 60);
        assert_int_equal(frames_drain(queue),
                         both ? SNOW_STATUS_BAD_OUTPUT : SNOW_STATUS_FAILED);
        assert_string_equal(frames_message(queue),
                            both ? "no room for 12" : "frame 13 is bad");
        assert_int_equal(s.count, 13);
        frames_free(queue);
    }
    snow_image_free(image);
}

static void a_queue_may_stay_empty(void **state) {
    (void)state;
    seen s = nothing_seen();
    frame_queue *queue = open_queue(&s, FRAME_WORKERS_MOST);
    assert_int_equal(frames_drain(queue), SNOW_STATUS_OK);
    assert_true(frames_seconds(queue) == 0);
    frames_free(queue);
    frames_free(NULL);
    assert_int_equal(s.count + s.slots_released, 0);
}

static int begin(void **state) {
    *state = support_context();
    return 0;
}

static int end(void **state) {
    snow_context_free(*state);
    return 0;
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(frames_are_committed_in_order_as_they_were_put),
        cmocka_unit_test(nothing_is_committed_after_a_fault),
        cmocka_unit_test(a_fault_of_compression_is_told_in_its_turn),
        cmocka_unit_test(a_queue_may_stay_empty),
    };
    return cmocka_run_group_tests(tests, begin, end);
}
