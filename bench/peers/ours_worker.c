/* bench/peers/ours_worker.c - Snowglass behind the pipe of peers.py.
 *
 * What is timed is what a user of the library would write: through the public
 * headers, from the voxels in memory to a picture in memory.
 *
 *   ours_worker RAW X Y Z SIZE THREADS SHADED METHOD QUALITY */
#include "pipe.h"

#include <snowglass/snowglass.h>
#include <stdlib.h>
#include <string.h>

/* All that lives between two commands. */
static struct worker {
    const char *raw;
    snow_context *context;
    snow_volume *volume;
    snow_transfer *transfer;
    snow_frame *frame;
    unsigned char *rgba; /* over black */
    snow_view view;      /* its width and height are set when it is loaded */
    snow_settings settings;
    snow_volume_options options;
    snow_color_point colors[PIPE_VALUES];
    snow_opacity_point opacities[PIPE_VALUES];
    bool changed; /* the table is newer than `transfer` */
} worker;

static void load(void);
static void take(const pipe_table *table);
static void frame(double azimuth, double elevation);
static void pixel(int x, int y, unsigned char rgb[3]);

static pipe_worker face = {
    .name = "ours_worker",
    .load = load,
    .take = take,
    .frame = frame,
    .pixel = pixel,
};

static void check(snow_status status) {
    if (status != SNOW_STATUS_OK)
        pipe_fail(&face, snow_context_message(worker.context));
}

static void take(const pipe_table *table) {
    for (int v = 0; v < PIPE_VALUES; v++) {
        const double *c = (*table)[v];
        worker.colors[v] = (snow_color_point){v, c[0], c[1], c[2]};
        worker.opacities[v] = (snow_opacity_point){v, c[3]};
    }
    worker.changed = true;
}

static void load(void) {
    snow_view_init(&worker.view);
    check(snow_volume_open(worker.context, worker.raw, &worker.options,
                           &worker.volume));
    check(snow_view_from_name(worker.context, "+z", &worker.view));
    check(snow_frame_new(worker.context, &worker.frame));
    worker.view.width = worker.view.height = face.size;
    worker.rgba = malloc(4 * (size_t)face.size * (size_t)face.size);
    if (!worker.rgba)
        pipe_fail(&face, "no memory");
}

/* A changed transfer function is made here, since making it is part of showing
 * it. */
static void frame(double azimuth, double elevation) {
    static const double black[3] = {0, 0, 0};
    if (worker.changed) {
        snow_transfer_free(worker.transfer);
        worker.transfer = NULL;
        check(snow_transfer_new(worker.context, worker.colors, PIPE_VALUES,
                                worker.opacities, PIPE_VALUES,
                                &worker.transfer));
        worker.changed = false;
    }
    worker.view.azimuth = azimuth;
    worker.view.elevation = elevation;
    check(snow_frame_render_bytes(worker.frame, worker.volume, worker.transfer,
                                  &worker.view, &worker.settings, black,
                                  worker.rgba, 4 * (size_t)face.size));
}

static void pixel(int x, int y, unsigned char rgb[3]) {
    memcpy(rgb, worker.rgba + 4 * (y * face.size + x), 3);
}

static void set_up(char **argv) {
    snow_settings *settings = &worker.settings;
    int method = snow_method_from_name(argv[8]);
    int quality = snow_quality_from_name(argv[9]);
    if (method < 0 || quality < 0)
        pipe_fail(&face, "no such method or quality");
    if (snow_context_new(NULL, &worker.context) != SNOW_STATUS_OK)
        pipe_fail(&face, "no memory");
    worker.raw = argv[1];
    face.size = atoi(argv[5]);
    snow_volume_options_init(&worker.options);
    worker.options.type = SNOW_TYPE_UINT8;
    for (int i = 0; i < 3; i++)
        worker.options.dims[i] = atoi(argv[2 + i]);
    snow_settings_init(settings);
    settings->threads = atoi(argv[6]);
    settings->shade = atoi(argv[7]) ? SNOW_SHADE_PHONG : SNOW_SHADE_NONE;
    settings->light = SNOW_LIGHT_HEAD; /* as that of the other programs */
    settings->method = (snow_method)method;
    settings->quality = (snow_quality)quality;
}

int main(int argc, char **argv) {
    if (argc != 10)
        pipe_fail(&face, "wants RAW X Y Z SIZE THREADS SHADED METHOD QUALITY");
    set_up(argv);
    pipe_serve(&face);
    free(worker.rgba);
    snow_frame_free(worker.frame);
    snow_transfer_free(worker.transfer);
    snow_volume_close(worker.volume);
    snow_context_free(worker.context);
    return 0;
}
