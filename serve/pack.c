/* pack.c - implements pack.h. */
#define _GNU_SOURCE /* memfd_create */
#include "pack.h"
#include "message.h"

#include <pthread.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <time.h>
#include <turbojpeg.h>
#include <unistd.h>

/* Quality and subsampling: of what moves, and of the first picture at rest. */
#define QUALITY_DRAFT 75
#define QUALITY_NORMAL 90

struct packer {
    pthread_t thread;
    pthread_mutex_t lock;
    pthread_cond_t changed;
    picture *waiting, *done;
    bool ending;
    outbox *box;
    snow_context *context; /* the thread's own */
    int file;              /* in memory, as standard output */
};

static double seconds(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static parcel *parcel_of(const frame_head *head, const void *bytes,
                         size_t length) {
    parcel *made = parcel_new(FRAME_HEAD_BYTES + length);
    if (!made)
        return NULL;
    frame_head_write(head, made->bytes);
    memcpy(made->bytes + FRAME_HEAD_BYTES, bytes, length);
    return made;
}

/* --- JPEG ------------------------------------------------------------------
 */

static parcel *compress(tjhandle jpeg, const unsigned char *rgb,
                        frame_head *head, double begin) {
    unsigned char *bytes = NULL;
    unsigned long length = 0;
    bool fine = head->level > 0;
    parcel *made = NULL;
    if (tjCompress2(jpeg, rgb, (int)head->width, 0, (int)head->height, TJPF_RGB,
                    &bytes, &length, fine ? TJSAMP_444 : TJSAMP_420,
                    fine ? QUALITY_NORMAL : QUALITY_DRAFT,
                    fine ? TJFLAG_ACCURATEDCT : TJFLAG_FASTDCT) == 0) {
        head->kind = FRAME_JPEG;
        head->pack_us = (uint32_t)(1e6 * (seconds() - begin));
        made = parcel_of(head, bytes, length);
    }
    tjFree(bytes);
    return made;
}

static parcel *pack_jpeg(const snow_image *image,
                         const snow_image_options *form, frame_head *head) {
    double begin = seconds();
    size_t count = 3 * (size_t)head->width * head->height;
    unsigned char *rgb = malloc(count);
    tjhandle jpeg = tjInitCompress();
    parcel *made = NULL;
    if (rgb && jpeg &&
        snow_image_to_rgb8_with(image, form, rgb) == SNOW_STATUS_OK)
        made = compress(jpeg, rgb, head, begin);
    if (jpeg)
        tjDestroy(jpeg);
    free(rgb);
    return made;
}

parcel *pack_small(const snow_image *image, const snow_image_options *form,
                   int pane) {
    frame_head head = {.level = 1,
                       .pane = pane,
                       .width = (uint32_t)snow_image_width(image),
                       .height = (uint32_t)snow_image_height(image)};
    return pack_jpeg(image, form, &head);
}

/* --- PNG -------------------------------------------------------------------
 */

/* A copy whose memory is counted in this thread's context. */
static snow_image *copy_image(snow_context *context, snow_image *from) {
    snow_image *image = NULL;
    int width = snow_image_width(from), height = snow_image_height(from);
    int channels = snow_image_channels(from);
    if (snow_image_new(context, width, height, channels, &image) ==
        SNOW_STATUS_OK)
        memcpy(snow_image_pixels(image), snow_image_pixels(from),
               (size_t)width * (size_t)height * (size_t)channels *
                   sizeof(float));
    return image;
}

/* The library writes a PNG to a file or to standard output, which is a file in
 * memory here (packer_new). */
static parcel *read_back(packer *p, frame_head *head, double begin) {
    off_t length = lseek(p->file, 0, SEEK_END);
    void *bytes = length > 0 ? mmap(NULL, (size_t)length, PROT_READ, MAP_SHARED,
                                    p->file, 0)
                             : MAP_FAILED;
    if (bytes == MAP_FAILED)
        return NULL;
    head->kind = FRAME_PNG;
    head->pack_us = (uint32_t)(1e6 * (seconds() - begin));
    parcel *made = parcel_of(head, bytes, (size_t)length);
    munmap(bytes, (size_t)length);
    return made;
}

static parcel *pack_png(packer *p, const picture *made, frame_head *head) {
    double begin = seconds();
    snow_image *image = copy_image(p->context, made->image);
    snow_image_options form = made->form;
    parcel *packed = NULL;
    form.overlay = made->overlay;
    if (image && ftruncate(p->file, 0) == 0 &&
        lseek(STDOUT_FILENO, 0, SEEK_SET) == 0 &&
        snow_image_save(image, "-", &form) == SNOW_STATUS_OK)
        packed = read_back(p, head, begin);
    snow_image_free(image);
    return packed;
}

/* --- the thread ------------------------------------------------------------
 */

static void pack(packer *p, const picture *made) {
    frame_head head = {.level = made->level,
                       .width = (uint32_t)snow_image_width(made->image),
                       .height = (uint32_t)snow_image_height(made->image),
                       .render_us = made->render_us};
    snow_image_options form = made->form;
    form.overlay = made->overlay;
    parcel *packed = made->level == 2 ? pack_png(p, made, &head)
                                      : pack_jpeg(made->image, &form, &head);
    if (!packed)
        return;
    packed->revision = made->revision;
    packed->topic = PARCEL_PICTURE;
    outbox_put(p->box, packed);
}

static void *run(void *user) {
    packer *p = user;
    pthread_mutex_lock(&p->lock);
    while (!p->ending) {
        picture *next = p->waiting;
        if (!next) {
            pthread_cond_wait(&p->changed, &p->lock);
            continue;
        }
        p->waiting = NULL;
        pthread_mutex_unlock(&p->lock);
        pack(p, next);
        pthread_mutex_lock(&p->lock);
        next->next = p->done;
        p->done = next;
    }
    pthread_mutex_unlock(&p->lock);
    return NULL;
}

/* From here on nothing may print to standard output. */
static bool open_file(packer *p) {
    p->file = memfd_create("snowglass", MFD_CLOEXEC);
    return p->file >= 0 && dup2(p->file, STDOUT_FILENO) == STDOUT_FILENO;
}

packer *packer_new(outbox *box) {
    packer *p = calloc(1, sizeof *p);
    if (!p)
        return NULL;
    p->box = box;
    p->file = -1;
    pthread_mutex_init(&p->lock, NULL);
    pthread_cond_init(&p->changed, NULL);
    if (open_file(p) && snow_context_new(NULL, &p->context) == SNOW_STATUS_OK &&
        pthread_create(&p->thread, NULL, run, p) == 0)
        return p;
    packer_free(p);
    return NULL;
}

picture *packer_put(packer *p, picture *made) {
    pthread_mutex_lock(&p->lock);
    if (p->waiting) {
        p->waiting->next = p->done;
        p->done = p->waiting;
    }
    p->waiting = made;
    picture *done = p->done;
    p->done = NULL;
    pthread_cond_signal(&p->changed);
    pthread_mutex_unlock(&p->lock);
    return done;
}

picture *packer_end(packer *p) {
    pthread_mutex_lock(&p->lock);
    p->ending = true;
    pthread_cond_signal(&p->changed);
    pthread_mutex_unlock(&p->lock);
    pthread_join(p->thread, NULL);
    picture *last = p->waiting;
    if (last)
        last->next = p->done;
    return last ? last : p->done;
}

void packer_free(packer *p) {
    if (!p)
        return;
    if (p->file >= 0)
        close(p->file);
    snow_context_free(p->context);
    pthread_cond_destroy(&p->changed);
    pthread_mutex_destroy(&p->lock);
    free(p);
}
