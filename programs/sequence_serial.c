/* sequence_serial.c - the renderer of a sequence in one process: a volume as
 * long as shots are of it, one look, one frame whose buffers and encoding are
 * kept from picture to picture. */
#include "sequence_serial.h"
#include "commands.h"
#include "report.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

int serial_open(const options *asked, serial_renderer *out) {
    *out = (serial_renderer){.asked = asked, .output = asked->output};
    return open_context(asked, &out->context);
}

void serial_close(serial_renderer *serial) {
    snow_frame_free(serial->frame);
    snow_transfer_free(serial->transfer);
    snow_volume_close(serial->volume);
    snow_context_free(serial->context);
}

/* A step is one volume, and on the grid of the others: the camera is placed by
 * the volume, and would jump. */
static int check_step(serial_renderer *serial) {
    const snow_volume_info *info = snow_volume_describe(serial->volume);
    const snow_volume_info *first = &serial->grid;
    if (serial->whole_files && info->times > 1) {
        say("%s: holds %" PRId64 " time steps; give it alone for a movie of "
            "them, or --time for one of each file",
            serial->path, info->times);
        return SNOW_BAD_INPUT;
    }
    if (first->dims[0] == 0) {
        serial->grid = *info;
        return GO_ON;
    }
    if (memcmp(info->dims, first->dims, sizeof info->dims) != 0) {
        say("%s: has %" PRId64 "x%" PRId64 "x%" PRId64 " voxels, the first "
            "step %" PRId64 "x%" PRId64 "x%" PRId64 "; steps of one movie lie "
            "on one grid",
            serial->path, info->dims[0], info->dims[1], info->dims[2],
            first->dims[0], first->dims[1], first->dims[2]);
        return SNOW_BAD_INPUT;
    }
    if (memcmp(info->matrix, first->matrix, sizeof info->matrix) == 0)
        return GO_ON;
    say("%s: lies elsewhere in the world than the first step; steps of one "
        "movie lie on one grid",
        serial->path);
    return SNOW_BAD_INPUT;
}

/* The old volume goes first: there is never room for two. */
int serial_volume(serial_renderer *serial, const movie_shot *shot) {
    if (serial->volume && strcmp(serial->path, shot->path) == 0 &&
        serial->time == shot->time)
        return GO_ON;
    double begin = seconds_now();
    options step = *serial->asked;
    step.time = shot->time;
    snow_volume_close(serial->volume);
    serial->volume = NULL;
    if (!serial->drawn)
        progress(serial->asked, "reading");
    int done = open_input(serial->context, &step, shot->path, &serial->volume);
    serial->times.read += seconds_now() - begin;
    serial->path = name_of_input(shot->path);
    serial->time = shot->time;
    return done == GO_ON ? check_step(serial) : done;
}

static int choose_look(serial_renderer *serial) {
    if (serial->transfer)
        return GO_ON;
    double begin = seconds_now();
    int done = open_look(serial->context, serial->asked, serial->volume,
                         &serial->transfer);
    serial->times.look += seconds_now() - begin;
    return done;
}

/* What was chosen where nothing was told: as render says it, of all frames. */
static void tell_choices(const serial_renderer *serial) {
    const options *asked = serial->asked;
    const snow_stats *stats = snow_frame_stats(serial->frame);
    if (asked->verbosity < 0)
        return;
    const char *view = asked->view            ? asked->view
                       : serial->grid.medical ? "anterior"
                                              : "+z";
    bool encoded = stats->encoding != SNOW_ENCODING_AUTO;
    char volume[256];
    describe_volume(&serial->grid, volume, sizeof volume);
    say("%s: %s; %s; view %s; method %s%s%s; %" PRId64
        " frames of %lldx%lld to %s",
        serial->path, volume, snow_transfer_text(serial->transfer), view,
        snow_method_name(stats->method), encoded ? ", encoding " : "",
        encoded ? snow_encoding_name(stats->encoding) : "", serial->count,
        (long long)asked->size[0], (long long)asked->size[1], serial->output);
}

static int render(void *self, const movie_shot *shot, snow_image **image) {
    serial_renderer *serial = self;
    snow_view view;
    int done = serial_volume(serial, shot);
    if (done == GO_ON)
        done = choose_look(serial);
    if (done == GO_ON)
        done = make_view(serial->context, serial->asked,
                         snow_volume_describe(serial->volume), &view);
    if (done == GO_ON)
        done =
            make_settings(serial->asked, snow_volume_describe(serial->volume),
                          &serial->settings);
    if (done != GO_ON)
        return done;
    view.azimuth = shot->azimuth;
    snow_status status = SNOW_OK;
    if (!serial->frame)
        status = snow_frame_new(serial->context, &serial->frame);
    if (status == SNOW_OK)
        status =
            snow_frame_render(serial->frame, serial->volume, serial->transfer,
                              &view, &serial->settings, image);
    if (status != SNOW_OK)
        return fail_volume(serial->context, status, serial->path);
    if (!serial->drawn)
        tell_choices(serial);
    serial->drawn = true;
    return GO_ON;
}

static void report(void *self, render_report *out) {
    const serial_renderer *serial = self;
    *out = (render_report){.volume = snow_volume_describe(serial->volume),
                           .stats = snow_frame_stats(serial->frame),
                           .peak = snow_context_peak_bytes(serial->context),
                           .load = 1,
                           .settings = &serial->settings,
                           .times = &serial->times};
}

sequence_renderer serial_renderer_of(serial_renderer *serial) {
    return (sequence_renderer){.self = serial,
                               .render = render,
                               .report = report,
                               .writes = true,
                               .ranks = 1};
}
