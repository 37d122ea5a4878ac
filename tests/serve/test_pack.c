/* tests/serve/test_pack.c - a draft does not wait for a picture at rest that is
 * packed, which then is not shown over it. */
#include "support/support.h"

#include "message.h"
#include "pack.h"

#include <stdatomic.h>
#include <time.h>
#include <unistd.h>

#define SIDE 2500 /* whose noise takes much longer to pack than a draft */

/* The state of the pages, of which the packer only asks this, amid a PNG. */
static atomic_uint newest, asked;

bool state_is_stale(const viewer_state *s, uint32_t revision) {
    (void)s;
    asked++;
    return revision != newest;
}

static atomic_int woken;

static void note(void *user) {
    (void)user;
    woken++;
}

static picture *noise(snow_context *context, int side, int level,
                      uint32_t revision) {
    snow_image *image;
    picture *made = calloc(1, sizeof *made);
    uint64_t random = 1;
    assert_non_null(made);
    assert_int_equal(snow_image_new(context, side, side, 4, &image),
                     SNOW_STATUS_OK);
    float *pixels = snow_image_pixels(image);
    for (int i = 0; i < 4 * side * side; i++)
        pixels[i] = i % 4 == 3 ? 1 : (float)support_uniform(&random);
    *made = (picture){.image = image,
                      .form = {.size = sizeof made->form, .unsynced = true},
                      .revision = revision,
                      .level = level};
    return made;
}

static void free_all(picture *made) {
    for (picture *next; made; made = next) {
        next = made->next;
        snow_image_free(made->image);
        free(made);
    }
}

/* The levels of what was put, in order, as digits. */
static void take_levels(outbox *box, char levels[8]) {
    size_t count = 0;
    for (outgoing *next, *p = outbox_take(box); p; p = next) {
        next = p->next;
        levels[count++] = (char)('0' + p->bytes[8]);
        outgoing_release(box, p);
    }
    levels[count] = 0;
}

static void a_draft_does_not_wait_for_a_picture_at_rest(void **state) {
    (void)state;
    const struct timespec moment = {.tv_nsec = 1000000};
    snow_context *context = support_context();
    outbox *box = outbox_new(note, NULL);
    char levels[8];
    const int screen = dup(STDOUT_FILENO);
    packer *p = packer_new(box, NULL);
    assert_non_null(p);
    outbox_set_audience(box, 1, 0, 75);
    newest = 1;
    free_all(packer_put(p, noise(context, SIDE, 2, 1)));
    while (!asked && !woken)
        nanosleep(&moment, NULL);
    assert_int_equal(woken, 0); /* it is being packed */
    picture *draft = noise(context, 16, 0, 2);
    newest = 2;
    free_all(packer_put(p, draft));
    while (!woken)
        nanosleep(&moment, NULL);
    take_levels(box, levels);
    assert_string_equal(levels, "0");
    free_all(packer_wait(p));
    take_levels(box, levels);
    assert_string_equal(levels, "");
    assert_int_equal(woken, 1);
    free_all(packer_put(p, noise(context, 16, 2, 2)));
    free_all(packer_wait(p));
    take_levels(box, levels);
    assert_string_equal(levels, "2");
    free_all(packer_end(p));
    packer_free(p);
    assert_int_equal(dup2(screen, STDOUT_FILENO), STDOUT_FILENO);
    close(screen);
    outbox_free(box);
    snow_context_free(context);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_draft_does_not_wait_for_a_picture_at_rest),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
