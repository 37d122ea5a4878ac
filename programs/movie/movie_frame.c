/* movie_frame.c - what becomes of a frame, by the workers. */
#include "movie/movie_frame.h"
#include "picture/outputs.h"

#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

static snow_status fault(frame_slot *slot, const char *path, int number) {
    snprintf(slot->fault, sizeof slot->fault,
             "%s: %s; make space or choose another place, then continue with "
             "--resume",
             path, strerror(number));
    return SNOW_STATUS_BAD_OUTPUT;
}

/* Loads a frame that was kept, for ffmpeg. */
static snow_status load_frame(const movie *s, frame_slot *slot,
                              const char *path) {
    snow_status status = snow_image_load(slot->context, path, &slot->image);
    if (status != SNOW_STATUS_OK)
        return status;
    if (snow_image_width(slot->image) == (int)s->opts->size[0] &&
        snow_image_height(slot->image) == (int)s->opts->size[1])
        return SNOW_STATUS_OK;
    snprintf(slot->fault, sizeof slot->fault,
             "%s: has another size than the movie; remove it and continue with "
             "--resume",
             path);
    return SNOW_STATUS_BAD_INPUT;
}

static snow_status fill_bytes(const movie *s, frame_slot *slot,
                              const snow_image_options *form) {
    if (!slot->work) /* once: all frames have one size */
        slot->work =
            malloc((size_t)s->opts->size[0] * (size_t)s->opts->size[1] * 3);
    if (!slot->work) {
        snprintf(
            slot->fault, sizeof slot->fault,
            "out of memory for the bytes of a frame; use a smaller --size");
        return SNOW_STATUS_NO_MEMORY;
    }
    snow_image_to_rgb8(slot->image, form, slot->work);
    return SNOW_STATUS_OK;
}

void movie_take_time(movie *s, int64_t index, const snow_volume_info *info) {
    frame_time *time = &s->times[index];
    time->value = info->time_value;
    memcpy(time->unit, info->time_unit, sizeof time->unit);
    memcpy(time->calendar, info->calendar, sizeof time->calendar);
}

/* Makes a new frame: its unfinished file and its bytes. */
static snow_status make_frame(const movie *s, frame_slot *slot) {
    const movie_shot *shot = &s->list->shots[slot->index];
    snow_overlay *overlay = NULL;
    snow_image_options form = s->form;
    picture_annotations annotations = s->annotations;
    char path[PATH_MAX];
    const frame_time *time = &s->times[slot->index];
    snow_volume_info *info = &annotations.info;
    info->time_value = time->value;
    memcpy(info->time_unit, time->unit, sizeof info->time_unit);
    memcpy(info->calendar, time->calendar, sizeof info->calendar);
    if (s->list->steps && !s->list->slices)
        annotations.measures = s->measured[slot->index];
    if (s->list->slices) {
        annotations.axis = shot->axis;
        annotations.index = &shot->slice;
    }
    snow_status status = annotations_make(
        &annotations, shot->azimuth, shot->step,
        s->list->slices ? NULL : slot->image, slot->context, &overlay);
    form.overlay = overlay;
    form.depth = slot->depth;
    if (!s->place.streams)
        place_aside(&s->place, slot->index, path, sizeof path);
    if (status == SNOW_STATUS_OK && !s->place.streams)
        status = snow_image_save(slot->image, path, &form);
    if (status == SNOW_STATUS_OK && s->encoding)
        status = fill_bytes(s, slot, &form);
    snow_overlay_free(overlay);
    free(s->measured[slot->index]);
    s->measured[slot->index] = NULL;
    return status;
}

snow_status movie_frame_prepare(void *user, frame_slot *slot) {
    const movie *s = user;
    char path[PATH_MAX];
    if (!s->record.kept[slot->index])
        return make_frame(s, slot);
    place_frame(&s->place, slot->index, path, sizeof path);
    snow_status status = load_frame(s, slot, path);
    return status == SNOW_STATUS_OK && s->encoding
               ? fill_bytes(s, slot, &s->form)
               : status;
}

/* Gives a frame its final name, under which the record lists it already: a run
 * that is killed between the two leaves no frame that nobody knows.  A file of
 * this name that was there before is another program's, and stays, unless a
 * record shows that it may be replaced. */
static snow_status name_frame(movie *s, frame_slot *slot) {
    char aside[PATH_MAX], path[PATH_MAX];
    struct stat what;
    place_aside(&s->place, slot->index, aside, sizeof aside);
    place_frame(&s->place, slot->index, path, sizeof path);
    if (!s->record.replaces && lstat(path, &what) == 0)
        return fault(slot, path, EEXIST);
    int64_t bytes = stat(aside, &what) == 0 ? (int64_t)what.st_size : 0;
    int number = record_add(&s->record, &s->place, s->list, slot->index, bytes);
    s->begun = s->begun || number == 0;
    if (number != 0)
        return fault(slot, s->place.record, number);
    number = name_output(aside, path, s->record.replaces);
    return number == 0 ? SNOW_STATUS_OK : fault(slot, path, number);
}

snow_status movie_frame_commit(void *user, frame_slot *slot) {
    movie *s = user;
    snow_status status = SNOW_STATUS_OK;
    if (!s->record.kept[slot->index] && !s->place.streams)
        status = name_frame(s, slot);
    if (status != SNOW_STATUS_OK || !s->encoding)
        return status;
    size_t size = (size_t)s->opts->size[0] * (size_t)s->opts->size[1] * 3;
    int number = encoder_write(&s->encoder, slot->work, size);
    if (number == 0 || !s->place.streams)
        return number ? fault(slot, "ffmpeg", number) : SNOW_STATUS_OK;
    snprintf(slot->fault, sizeof slot->fault,
             "standard output: %s; see why its reader ended", strerror(number));
    return SNOW_STATUS_BAD_OUTPUT;
}

void movie_frame_release(void *user, frame_slot *slot) {
    (void)user;
    free(slot->work);
    slot->work = NULL;
}
