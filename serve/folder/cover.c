/* cover.c - small pictures of the volumes in a list: the middle slice, as
 * `snowglass slice` draws it in 96 x 96 pixels, of one channel; see folder.h.
 *
 * They are made when pages ask for them, one after another, and the newest are
 * kept. */
#include "answers/answers.h"
#include "commands/commands.h"
#include "folder/inside.h"
#include "folder/own.h"
#include "message.h"
#include "pack.h"
#include "run/log.h"

#include <stdlib.h>
#include <string.h>

#define SIDE 96

/* What takes longer, or needs more memory, has none. */
#define SECONDS_MOST 10
#define BYTES_MOST ((uint64_t)1 << 30)

/* --- the slice ------------------------------------------------------------ */

/* As the verb slice chooses it: axial; of a volume that is one slice, that. */
static snow_status find_slice(folder *f, const snow_volume_info *info,
                              int *along) {
    static const char *const names[] = {"axial", "coronal", "sagittal"};
    const int64_t *dims = info->dims;
    const bool flat = (dims[0] == 1) + (dims[1] == 1) + (dims[2] == 1) == 1;
    snow_status status = SNOW_STATUS_OK;
    for (int n = 0; n < (flat ? 4 : 1) && status == SNOW_STATUS_OK; n++) {
        snow_view view;
        snow_view_init(&view);
        view.width = view.height = SIDE;
        status = snow_slice_view(f->context, info, names[n % 3], &view, along);
        if (flat && n < 3 && dims[*along] == 1)
            break;
    }
    return status;
}

/* The slice alone is read, where the format lets it. */
static snow_status open_slice(folder *f, const char *path, const char *series,
                              int *along, snow_volume **out) {
    snow_volume_info info;
    snow_status status = describe(f, path, series, &info);
    if (status == SNOW_STATUS_OK)
        status = find_slice(f, &info, along);
    snow_volume_options data = {.size = sizeof data,
                                .series = series,
                                .each_time = true,
                                .each_channel = true,
                                .allow_gaps = f->base->allow_gaps};
    if (status != SNOW_STATUS_OK)
        return status;
    data.crop[*along][0] = info.dims[*along] / 2;
    data.crop[*along][1] = data.crop[*along][0] + 1;
    return snow_volume_open(f->context, path, &data, out);
}

static snow_status draw(folder *f, const options *opts, const char *path,
                        const char *series, snow_image **image) {
    static const char *const axes[] = {"x", "y", "z"};
    snow_volume *volume = NULL;
    snow_transfer *transfer = NULL;
    snow_settings settings;
    snow_view view;
    const snow_look look = look_options(opts);
    int along = 0;
    fill_settings(opts, &settings);
    settings.threads = 1;
    settings.mode = SNOW_MODE_OVER; /* a slice has none */
    snow_view_init(&view);
    view.width = view.height = SIDE;
    snow_status status = open_slice(f, path, series, &along, &volume);
    if (status == SNOW_STATUS_OK)
        status = snow_slice_view(f->context, snow_volume_get_info(volume),
                                 axes[along], &view, &along);
    if (status == SNOW_STATUS_OK)
        status = snow_transfer_new_for_volume(volume, &look, &transfer);
    if (status == SNOW_STATUS_OK)
        status =
            snow_slice_render(volume, 0, transfer, &view, &settings, image);
    snow_transfer_free(transfer);
    snow_volume_close(volume);
    return status;
}

/* --- as a text ------------------------------------------------------------ */

static char *encode(const unsigned char *bytes, size_t length) {
    static const char digits[] =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    static const char head[] = "data:image/jpeg;base64,";
    char *text = malloc(sizeof head + (length + 2) / 3 * 4);
    if (!text)
        return NULL;
    char *at = text + sizeof head - 1;
    memcpy(text, head, sizeof head);
    for (size_t i = 0; i < length; i += 3) {
        const unsigned all = (unsigned)bytes[i] << 16 |
                             (i + 1 < length ? bytes[i + 1] : 0U) << 8 |
                             (i + 2 < length ? bytes[i + 2] : 0U);
        for (int n = 0; n < 4; n++)
            *at++ = i + (size_t)n <= length ? digits[all >> (18 - 6 * n) & 63]
                                            : '=';
    }
    *at = 0;
    return text;
}

/* "" where there is none. */
static char *make_cover(folder *f, const char *path, const char *series) {
    static options opts; /* large; one thread makes them */
    snow_image *image = NULL;
    char where[NAME_MAX + 1], *text = NULL;
    options_init(&opts);
    opts.mode = "slice";
    opts.output = "-";
    f->until = seconds_now() + SECONDS_MOST;
    snow_context_set_memory_limit(f->context, BYTES_MOST);
    if (inside_root(f->real, path, where) &&
        draw(f, &opts, path, *series ? series : NULL, &image) ==
            SNOW_STATUS_OK) {
        const snow_image_options form = picture_form(&opts, NULL);
        outgoing *made = pack_small(image, &form, false, 0, 0);
        if (made)
            text = encode(made->bytes + FRAME_HEAD_BYTES,
                          made->length - FRAME_HEAD_BYTES);
        if (made)
            outgoing_release(f->box, made);
    }
    snow_image_free(image);
    snow_context_set_memory_limit(f->context, 0);
    f->until = 0;
    return text ? text : strdup("");
}

/* --- questions ------------------------------------------------------------ */

/* Under the lock: the newest are kept. */
static void keep(folder *f, size_t entry, char *cover) {
    size_t *place = &f->kept[f->covers++ % COVERS_KEPT];
    if (f->covers > COVERS_KEPT) {
        free(f->entries[*place].cover);
        f->entries[*place].cover = NULL;
    }
    *place = entry;
    free(f->entries[entry].cover);
    f->entries[entry].cover = cover;
}

static void answer(const folder *f, const cover_question *q,
                   const char *cover) {
    answer_put(f->box, q->client, MESSAGE_PLAIN,
               json_pack("{s:s, s:I, s:s?}", "t", "cover", "entry",
                         (json_int_t)q->entry, "image",
                         cover && *cover ? cover : NULL));
}

/* What is asked; one that is kept is answered at once. */
static bool take(folder *f, cover_question *q, char path[PATH_MAX],
                 char series[65]) {
    bool makes = false;
    pthread_mutex_lock(&f->lock);
    while (f->waiting && !makes && !f->ended) {
        *q = f->asked[f->first];
        f->first = (f->first + 1) % COVERS_ASKED;
        f->waiting--;
        const folder_entry *e = &f->entries[q->entry];
        makes =
            e->kind == ENTRY_VOLUME && !e->cover && list_path(f, e->name, path);
        memcpy(series, e->series, 65);
        if (!makes)
            answer(f, q, e->cover);
    }
    pthread_mutex_unlock(&f->lock);
    return makes;
}

bool cover_serve(folder *f) {
    cover_question q;
    char path[PATH_MAX], series[65];
    while (!f->ended && take(f, &q, path, series)) {
        char *cover = make_cover(f, path, series);
        answer(f, &q, cover);
        pthread_mutex_lock(&f->lock);
        keep(f, q.entry, cover);
        pthread_mutex_unlock(&f->lock);
    }
    return !f->ended;
}

void cover_ask(folder *f, uint64_t client, size_t entry) {
    pthread_mutex_lock(&f->lock);
    const bool room = f->waiting < COVERS_ASKED;
    if (room)
        f->asked[(f->first + f->waiting++) % COVERS_ASKED] =
            (cover_question){client, entry};
    pthread_cond_signal(&f->changed);
    pthread_mutex_unlock(&f->lock);
    if (!room)
        answer_put(f->box, client, MESSAGE_PLAIN,
                   json_pack("{s:s, s:I, s:n}", "t", "cover", "entry",
                             (json_int_t)entry, "image"));
}
