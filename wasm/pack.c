/* pack.c - implements serve/pack.h for a page in the same process: drafts and
 * normal pictures go there as they are, at once, the picture at rest as the PNG
 * that the tool writes. */
#include "pack.h"
#include "files.h"
#include "message.h"

#include "run/log.h"

#include <stdlib.h>
#include <string.h>

struct packer {
    outbox *box;
};

packer *packer_new(outbox *box, const viewer_state *state) {
    (void)state;
    packer *p = malloc(sizeof *p);
    if (p)
        p->box = box;
    return p;
}

void packer_wait_for_draft(packer *p) {
    (void)p;
}

/* Nothing is packed. */
double packer_pixel_seconds(packer *p) {
    (void)p;
    return 0;
}

picture *packer_wait(packer *p) {
    (void)p;
    return NULL;
}

picture *packer_end(packer *p) {
    (void)p;
    return NULL;
}

void packer_free(packer *p) {
    free(p);
}

/* Three bytes a pixel become four, from the end on. */
static void widen(unsigned char *bytes, size_t pixels) {
    for (size_t i = pixels; i-- > 0;) {
        unsigned char *to = bytes + 4 * i;
        memmove(to, bytes + 3 * i, 3);
        to[3] = 255;
    }
}

static outgoing *pack_levels(const snow_image *image,
                             const snow_image_options *form, frame_head *head) {
    size_t pixels = (size_t)head->width * head->height;
    outgoing *made = outgoing_new(FRAME_HEAD_BYTES + 4 * pixels);
    if (!made)
        return NULL;
    unsigned char *bytes = made->bytes + FRAME_HEAD_BYTES;
    if (snow_image_to_rgb8(image, form, bytes) != SNOW_STATUS_OK) {
        free(made);
        return NULL;
    }
    widen(bytes, pixels);
    head->kind = FRAME_LEVELS;
    return made;
}

static outgoing *pack_png(const snow_image *image,
                          const snow_image_options *form, frame_head *head) {
    size_t length;
    files_forget_output();
    if (snow_image_save(image, "-", form) != SNOW_STATUS_OK)
        return NULL;
    const unsigned char *bytes = files_output(&length);
    outgoing *made = outgoing_new(FRAME_HEAD_BYTES + length);
    if (made)
        memcpy(made->bytes + FRAME_HEAD_BYTES, bytes, length);
    head->kind = FRAME_PNG;
    return made;
}

static outgoing *pack(const snow_image *image, const snow_image_options *form,
                      bool exact, frame_head *head) {
    double begin = seconds_now();
    head->width = (uint32_t)snow_image_width(image);
    head->height = (uint32_t)snow_image_height(image);
    outgoing *made =
        exact ? pack_png(image, form, head) : pack_levels(image, form, head);
    head->pack_us = (uint32_t)(1e6 * (seconds_now() - begin));
    if (made)
        frame_head_write(head, made->bytes);
    return made;
}

outgoing *pack_small(const snow_image *image, const snow_image_options *form,
                     bool exact, int pane, uint32_t n) {
    frame_head head = {.n = n, .level = exact ? 2 : 1, .pane = pane};
    return pack(image, form, true, &head); /* the page takes it for a file */
}

picture *packer_put(packer *p, picture *made) {
    frame_head head = {.level = made->level, .render_us = made->render_us};
    snow_image_options form = made->form;
    form.overlay = made->overlay;
    outgoing *packed = pack(made->image, &form, made->level == 2, &head);
    if (packed) {
        packed->revision = made->revision;
        packed->topic = MESSAGE_PICTURE;
    }
    outbox_put(p->box, packed);
    return made;
}
