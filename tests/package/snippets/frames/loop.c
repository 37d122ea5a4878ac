/* The snippet of docs/output.md: pictures in a loop. */
#include <snowglass/snowglass.h>

#include <stddef.h>

enum { STRIDE = 4 * 2048 };
static unsigned char pixels[2048 * STRIDE];
static int shown;

/* Counts pictures that have something in them. */
static void show(const unsigned char *bytes) {
    for (size_t at = 0; at < sizeof(pixels); at += 4)
        if (bytes[at] > 40) {
            shown++;
            return;
        }
}

int main(void) {
    snow_context *context = NULL;
    snow_volume *volume = NULL;
    snow_transfer *transfer = NULL;
    snow_frame *frame = NULL;
    snow_view view;
    const double background[3] = {0, 0, 0};
    const size_t stride = STRIDE;
    if (snow_context_new(NULL, &context) ||
        snow_volume_open(context, "ct.nrrd", NULL, &volume) ||
        snow_transfer_new_for_volume(volume, NULL, &transfer) ||
        snow_frame_new(context, &frame))
        return 1;
    SNIPPET
    return shown != 120;
}
