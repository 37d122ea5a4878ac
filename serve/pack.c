/* pack.c - implements pack.h. */
#define _GNU_SOURCE /* memfd_create */
#include "pack.h"
#include "message.h"

#include <errno.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <time.h>
#include <turbojpeg.h>
#include <unistd.h>
#if SNOW_HAVE_WEBP
#include <webp/encode.h>
#endif

/* Quality of the first picture at rest, also where pictures that move have less
 * than QUALITY_GOOD. */
#define QUALITY_NORMAL 90
#define QUALITY_NORMAL_LOW 75
#define QUALITY_GOOD 75

/* On thin links both are WebP, which takes three times as long and needs a
 * third fewer bytes; where it was not built they are JPEGs of QUALITY_THIN. */
#define QUALITY_THIN 50
#define QUALITY_WEBP 60

/* One packs pictures that move, and one those at rest, which take longer: a
 * draft does not wait for the one before it. */
typedef struct lane {
    packer *of;
    pthread_t thread;
    bool runs;
    picture *waiting, *packing; /* or NULL */
} lane;

enum { MOVING, AT_REST, LANES };

struct packer {
    pthread_mutex_t lock;
    pthread_cond_t changed;
    lane lanes[LANES];
    picture *done;
    bool ending;
    uint32_t newest;      /* revision that was put */
    double pixel_seconds; /* of the last one */
    outbox *box;
    const viewer_state *state;
    snow_context *context; /* of the thread for pictures at rest */
};

/* Standard output, of which a process has one, as a file in memory: two threads
 * write PNGs to it. */
static pthread_mutex_t file_lock = PTHREAD_MUTEX_INITIALIZER;
static int file = -1;

static double seconds(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* --- JPEG and WebP ----------------------------------------------------------
 */

static outgoing *finish(frame_head *head, int kind, double begin,
                        const void *bytes, size_t length) {
    head->kind = kind;
    head->pack_us = (uint32_t)(1e6 * (seconds() - begin));
    outgoing *made = outgoing_new(FRAME_HEAD_BYTES + length);
    if (!made)
        return NULL;
    frame_head_write(head, made->bytes);
    memcpy(made->bytes + FRAME_HEAD_BYTES, bytes, length);
    return made;
}

/* Grey takes less time, here and in the page, and a fifth fewer bytes; fine
 * pictures keep all their colours. */
static int sampling_of(const unsigned char *rgb, size_t pixels, bool fine) {
    unsigned differ = 0;
    for (size_t i = 0; i < pixels && !differ; i++, rgb += 3)
        differ |= (unsigned)((rgb[0] ^ rgb[1]) | (rgb[0] ^ rgb[2]));
    return !differ ? TJSAMP_GRAY : fine ? TJSAMP_444 : TJSAMP_420;
}

static outgoing *compress_jpeg(const unsigned char *rgb, int quality,
                               frame_head *head, double begin) {
    unsigned char *bytes = NULL;
    unsigned long length = 0;
    bool fine = head->level > 0 && quality >= QUALITY_NORMAL;
    outgoing *made = NULL;
    tjhandle jpeg = tjInitCompress();
    if (jpeg &&
        tjCompress2(jpeg, rgb, (int)head->width, 0, (int)head->height, TJPF_RGB,
                    &bytes, &length,
                    sampling_of(rgb, (size_t)head->width * head->height, fine),
                    quality, fine ? TJFLAG_ACCURATEDCT : TJFLAG_FASTDCT) == 0)
        made = finish(head, FRAME_JPEG, begin, bytes, length);
    tjFree(bytes);
    if (jpeg)
        tjDestroy(jpeg);
    return made;
}

#if SNOW_HAVE_WEBP
/* As fast as it can: method 0. */
static outgoing *compress_webp(const unsigned char *rgb, frame_head *head,
                               double begin) {
    WebPConfig config;
    WebPPicture form;
    WebPMemoryWriter writer;
    outgoing *made = NULL;
    if (!WebPConfigInit(&config) || !WebPPictureInit(&form))
        return NULL;
    config.method = 0;
    config.quality = QUALITY_WEBP;
    WebPMemoryWriterInit(&writer);
    form.width = (int)head->width;
    form.height = (int)head->height;
    form.writer = WebPMemoryWrite;
    form.custom_ptr = &writer;
    if (WebPPictureImportRGB(&form, rgb, 3 * form.width) &&
        WebPEncode(&config, &form))
        made = finish(head, FRAME_WEBP, begin, writer.mem, writer.size);
    WebPPictureFree(&form);
    WebPMemoryWriterClear(&writer);
    return made;
}
#endif

/* `quality` is that of pictures that move; 0: on a thin link. */
static outgoing *compress(const unsigned char *rgb, int quality,
                          frame_head *head, double begin) {
#if SNOW_HAVE_WEBP
    if (!quality)
        return compress_webp(rgb, head, begin);
#endif
    if (!quality)
        quality = QUALITY_THIN;
    if (head->level > 0)
        quality = quality < QUALITY_GOOD ? QUALITY_NORMAL_LOW : QUALITY_NORMAL;
    return compress_jpeg(rgb, quality, head, begin);
}

static outgoing *pack_lossy(const snow_image *image,
                            const snow_image_options *form, int quality,
                            frame_head *head) {
    double begin = seconds();
    unsigned char *rgb = malloc(3 * (size_t)head->width * head->height);
    outgoing *made = NULL;
    if (rgb && snow_image_to_rgb8(image, form, rgb) == SNOW_STATUS_OK)
        made = compress(rgb, quality, head, begin);
    free(rgb);
    return made;
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

static outgoing *read_back(frame_head *head, double begin) {
    off_t length = lseek(file, 0, SEEK_END);
    void *bytes =
        length > 0 ? mmap(NULL, (size_t)length, PROT_READ, MAP_SHARED, file, 0)
                   : MAP_FAILED;
    if (bytes == MAP_FAILED)
        return NULL;
    outgoing *made = finish(head, FRAME_PNG, begin, bytes, (size_t)length);
    munmap(bytes, (size_t)length);
    return made;
}

/* The library writes a PNG to a file or to standard output (packer_new). */
static outgoing *write_png(const snow_image *image,
                           const snow_image_options *form, frame_head *head,
                           double begin) {
    outgoing *packed = NULL;
    pthread_mutex_lock(&file_lock);
    if (ftruncate(file, 0) == 0 && lseek(STDOUT_FILENO, 0, SEEK_SET) == 0 &&
        snow_image_save(image, "-", form) == SNOW_STATUS_OK)
        packed = read_back(head, begin);
    pthread_mutex_unlock(&file_lock);
    return packed;
}

/* Nobody waits for it any more. */
static bool is_stale(void *user, snow_stage stage, double fraction) {
    const packer *p = user;
    (void)stage;
    (void)fraction;
    return state_is_stale(p->state, p->lanes[AT_REST].packing->revision);
}

static outgoing *pack_png(packer *p, const picture *made, frame_head *head) {
    double begin = seconds();
    snow_image *image = copy_image(p->context, made->image);
    snow_image_options form = made->form;
    form.overlay = made->overlay;
    outgoing *packed = image ? write_png(image, &form, head, begin) : NULL;
    snow_image_free(image);
    return packed;
}

outgoing *pack_small(const snow_image *image, const snow_image_options *form,
                     bool exact, int pane, uint32_t n) {
    frame_head head = {.n = n,
                       .level = exact ? 2 : 1,
                       .pane = pane,
                       .width = (uint32_t)snow_image_width(image),
                       .height = (uint32_t)snow_image_height(image)};
    return exact ? write_png(image, form, &head, seconds())
                 : pack_lossy(image, form, QUALITY_GOOD, &head);
}

/* --- the thread ------------------------------------------------------------
 */

static void put(packer *p, const picture *made, outgoing *packed,
                message_topic about) {
    if (packed) {
        packed->revision = made->revision;
        packed->topic = about;
        if (made->level == 2)
            packed->shape = frame_shape(packed->bytes);
    }
    pthread_mutex_lock(&p->lock);
    if (made->revision >= p->newest) {
        p->newest = made->revision;
        outbox_put(p->box, packed);
    } else if (packed) { /* the pages have a newer one */
        outgoing_release(p->box, packed);
    }
    pthread_mutex_unlock(&p->lock);
}

/* Once for all pages on fast links, and once for those on thin ones; the
 * picture at rest is one for all. */
static void pack(packer *p, const picture *made) {
    frame_head head = {.level = made->level,
                       .width = (uint32_t)snow_image_width(made->image),
                       .height = (uint32_t)snow_image_height(made->image),
                       .render_us = made->render_us};
    snow_image_options form = made->form;
    form.overlay = made->overlay;
    if (made->level == 2) {
        put(p, made, pack_png(p, made, &head), MESSAGE_PICTURE);
        return;
    }
    if (outbox_has_audience(p->box, MESSAGE_PICTURE))
        put(p, made,
            pack_lossy(made->image, &form, outbox_quality(p->box), &head),
            MESSAGE_PICTURE);
    if (outbox_has_audience(p->box, MESSAGE_THIN_PICTURE))
        put(p, made, pack_lossy(made->image, &form, 0, &head),
            MESSAGE_THIN_PICTURE);
}

static void *run(void *user) {
    lane *own = user;
    packer *p = own->of;
    pthread_mutex_lock(&p->lock);
    while (!p->ending) {
        picture *next = own->waiting;
        if (!next) {
            pthread_cond_wait(&p->changed, &p->lock);
            continue;
        }
        own->waiting = NULL;
        own->packing = next;
        pthread_mutex_unlock(&p->lock);
        double begin = seconds();
        pack(p, next);
        pthread_mutex_lock(&p->lock);
        if (next->level == 0)
            p->pixel_seconds = (seconds() - begin) /
                               snow_image_width(next->image) /
                               snow_image_height(next->image);
        own->packing = NULL;
        next->next = p->done;
        p->done = next;
        pthread_cond_broadcast(&p->changed);
    }
    pthread_mutex_unlock(&p->lock);
    return NULL;
}

/* An error number, or 0. */
static int start(packer *p) {
    int number = 0;
    snow_context_set_progress(p->context, is_stale, p);
    for (int i = 0; i < LANES && !number; i++) {
        lane *own = &p->lanes[i];
        own->of = p;
        number = pthread_create(&own->thread, NULL, run, own);
        own->runs = number == 0;
    }
    return number;
}

packer *packer_new(outbox *box, const viewer_state *state) {
    packer *p = calloc(1, sizeof *p);
    if (!p)
        return NULL;
    p->box = box;
    p->state = state;
    pthread_mutex_init(&p->lock, NULL);
    pthread_cond_init(&p->changed, NULL);
    /* From here on nothing may print to standard output. */
    file = memfd_create("snowglass", MFD_CLOEXEC);
    int number =
        file >= 0 && dup2(file, STDOUT_FILENO) == STDOUT_FILENO ? 0 : errno;
    if (!number && snow_context_new(NULL, &p->context) != SNOW_STATUS_OK)
        number = ENOMEM;
    if (!number)
        number = start(p);
    if (!number)
        return p;
    packer_end(p);
    packer_free(p);
    errno = number;
    return NULL;
}

static picture *take_done(packer *p) {
    picture *done = p->done;
    p->done = NULL;
    return done;
}

picture *packer_put(packer *p, picture *made) {
    lane *own = &p->lanes[made->level == 2 ? AT_REST : MOVING];
    pthread_mutex_lock(&p->lock);
    if (own->waiting) {
        own->waiting->next = p->done;
        p->done = own->waiting;
    }
    own->waiting = made;
    picture *done = take_done(p);
    pthread_cond_broadcast(&p->changed);
    pthread_mutex_unlock(&p->lock);
    return done;
}

void packer_wait_for_draft(packer *p) {
    pthread_mutex_lock(&p->lock);
    const lane *moving = &p->lanes[MOVING];
    while ((moving->packing && moving->packing->level == 0) ||
           (moving->waiting && moving->waiting->level == 0))
        pthread_cond_wait(&p->changed, &p->lock);
    pthread_mutex_unlock(&p->lock);
}

double packer_pixel_seconds(packer *p) {
    pthread_mutex_lock(&p->lock);
    double seconds_each = p->pixel_seconds;
    pthread_mutex_unlock(&p->lock);
    return seconds_each;
}

picture *packer_wait(packer *p) {
    pthread_mutex_lock(&p->lock);
    for (int i = 0; i < LANES; i++)
        while (p->lanes[i].packing || p->lanes[i].waiting)
            pthread_cond_wait(&p->changed, &p->lock);
    picture *done = take_done(p);
    pthread_mutex_unlock(&p->lock);
    return done;
}

picture *packer_end(packer *p) {
    pthread_mutex_lock(&p->lock);
    p->ending = true;
    pthread_cond_broadcast(&p->changed);
    pthread_mutex_unlock(&p->lock);
    for (int i = 0; i < LANES; i++) {
        lane *own = &p->lanes[i];
        if (own->runs)
            pthread_join(own->thread, NULL);
        if (own->waiting) {
            own->waiting->next = p->done;
            p->done = own->waiting;
        }
        own->runs = false;
        own->waiting = NULL;
    }
    return take_done(p);
}

void packer_free(packer *p) {
    if (!p)
        return;
    if (file >= 0)
        close(file);
    file = -1;
    snow_context_free(p->context);
    pthread_cond_destroy(&p->changed);
    pthread_mutex_destroy(&p->lock);
    free(p);
}
