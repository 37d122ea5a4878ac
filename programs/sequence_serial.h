/* sequence_serial.h - frames rendered by this process alone. */
#ifndef SEQUENCE_SERIAL_H
#define SEQUENCE_SERIAL_H

#include "render_stats.h"
#include "sequence.h"

typedef struct serial_renderer {
    const options *asked;
    const char *output;
    int64_t count; /* of frames, to be told */
    snow_context *context;
    snow_volume *volume; /* of the last shot; kept while shots are of it */
    const char *path;    /* of that volume */
    int64_t time;
    snow_transfer *transfer; /* NULL: made of the first volume */
    snow_frame *frame;
    snow_settings settings;
    snow_volume_info grid; /* of the first volume */
    bool whole_files;      /* a file with several time steps is an error: it is
                              one of many, and nobody said which step */
    bool drawn;            /* a picture has been made, and choices told */
    render_times times;    /* read and look are sums */
} serial_renderer;

/* Answers GO_ON or an exit code. */
int serial_open(const options *asked, serial_renderer *out);
void serial_close(serial_renderer *serial);

/* Makes a shot's volume the present one.  Answers GO_ON or an exit code. */
int serial_volume(serial_renderer *serial, const movie_shot *shot);

/* For sequence_run; valid as long as the serial renderer. */
sequence_renderer serial_renderer_of(serial_renderer *serial);

#endif
