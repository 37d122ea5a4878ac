/* tests/isa/same_bits.c - shear-warp's pictures have the same bits with every
 * instruction set that this machine, or the one that it emulates, runs, but for
 * what the warp rounds (docs/fast.md).  It needs the core alone and no file, so
 * that it runs where next to nothing is installed: tests/isa/emulated.sh. */
#include <math.h>
#include <snowglass/snowglass.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define CHECK(call) check((call), context, #call)
#define SIDE 44
#define WIDTH 102
#define HEIGHT 75

static void check(snow_status status, snow_context *context, const char *call) {
    if (status == SNOW_STATUS_OK)
        return;
    fprintf(stderr, "%s: %s\n", call, snow_context_message(context));
    exit(1);
}

typedef struct scene {
    snow_mode mode;
    double fov, azimuth, elevation, zoom;
    snow_quality quality;
    snow_kernel kernel;
    double fade; /* gradient opacity below this magnitude */
    double ends; /* opacity of the largest values */
} scene;

static const scene scenes[] = {
    {SNOW_MODE_OVER, 0, 30, 20, 1.4, SNOW_QUALITY_DRAFT, 0, 0, 0.9},
    {SNOW_MODE_OVER, 30, -100, 15, 1.2, SNOW_QUALITY_NORMAL, 0, 0, 0.9},
    {SNOW_MODE_OVER, 0, 10, 70, 1.6, SNOW_QUALITY_HIGH, 0, 0, 0.1},
    {SNOW_MODE_OVER, 40, 200, -35, 0.4, SNOW_QUALITY_DRAFT, 0, 0, 0.003},
    {SNOW_MODE_OVER, 0, 0, 0, 3, SNOW_QUALITY_NORMAL, SNOW_KERNEL_BSPLINE, 0,
     0.5},
    {SNOW_MODE_OVER, 0, 45, 30, 1, SNOW_QUALITY_NORMAL, 0, 9, 0.5},
    {SNOW_MODE_MIP, 0, 20, 40, 1.3, SNOW_QUALITY_NORMAL, 0, 0, 0.5},
    {SNOW_MODE_SUM, 25, 20, 40, 1.3, SNOW_QUALITY_NORMAL, 0, 0, 0.5},
    {SNOW_MODE_ISO, 0, -20, 40, 1.3, SNOW_QUALITY_NORMAL, 0, 0, 0.5},
};

/* Nested shells with noise, of 8 or 16 bits. */
static void fill(void *voxels, bool wide) {
    uint32_t seed = 1;
    for (int n = 0; n < SIDE * SIDE * SIDE; n++) {
        double x = n % SIDE - 30.3, y = n / SIDE % SIDE - 29.1;
        double z = n / SIDE / SIDE - 28.4;
        double value = 90 + 80 * cos(sqrt(x * x + y * y + z * z) / 4);
        seed = seed * 1664525 + 1013904223;
        value = fmax(0, value + (double)(seed >> 28) - 8);
        if (wide)
            ((uint16_t *)voxels)[n] = (uint16_t)(value * 100);
        else
            ((uint8_t *)voxels)[n] = (uint8_t)value;
    }
}

static snow_transfer *look(snow_context *context, const scene *s, bool wide,
                           bool grey) {
    const double unit = wide ? 100 : 1;
    const snow_color_point colors[] = {
        {0, 0.1, grey ? 0.1 : 0.4, grey ? 0.1 : 0.2},
        {180 * unit, 1, grey ? 1 : 0.8, grey ? 1 : 0.3}};
    const snow_opacity_point opacities[] = {
        {100 * unit, 0}, {140 * unit, s->ends / 3}, {180 * unit, s->ends}};
    const snow_opacity_point fades[] = {{0, 0.2}, {s->fade * unit, 1}};
    snow_transfer *transfer;
    CHECK(snow_transfer_new(context, colors, 2, opacities, 3, &transfer));
    if (s->fade > 0)
        CHECK(snow_transfer_set_gradient_opacity(transfer, fades, 2));
    return transfer;
}

static snow_image *draw(snow_context *context, snow_volume *volume,
                        const snow_transfer *transfer, const scene *s,
                        snow_isa isa) {
    snow_frame *frame;
    snow_image *image;
    snow_settings settings;
    snow_view view;
    snow_settings_init(&settings);
    settings.mode = s->mode;
    settings.iso = 120;
    settings.quality = s->quality;
    settings.kernel = s->kernel;
    settings.isa = isa;
    settings.threads = 1; /* an emulator has few */
    snow_view_init(&view);
    CHECK(snow_view_from_name(context, "+z", &view));
    view.width = WIDTH;
    view.height = HEIGHT;
    view.fov = s->fov;
    view.azimuth = s->azimuth;
    view.elevation = s->elevation;
    view.zoom = s->zoom;
    CHECK(snow_frame_new(context, &frame));
    CHECK(snow_frame_render(frame, volume, transfer, &view, &settings, &image));
    snow_frame_free(frame);
    return image;
}

/* The largest difference of two pictures that show something. */
static double difference(snow_image *a, snow_image *b) {
    int channels = snow_image_channels(a);
    size_t count = (size_t)WIDTH * HEIGHT * (size_t)channels;
    const float *left = snow_image_pixels(a), *right = snow_image_pixels(b);
    double most = 0, shown = 0;
    for (size_t n = 0; n < count; n++) {
        bool none = isnan(left[n]) && isnan(right[n]);
        most = fmax(most, none ? 0 : fabs((double)left[n] - right[n]));
        most = isnan(left[n]) == isnan(right[n]) ? most : INFINITY;
        shown = fmax(shown, isnan(left[n]) ? 0 : (double)left[n]);
    }
    return shown > 0 ? most / fmax(1, shown) : INFINITY;
}

static int compare(snow_context *context, snow_volume *volume, const scene *s,
                   bool wide, bool grey) {
    int failed = 0;
    snow_transfer *transfer = look(context, s, wide, grey);
    snow_image *plain = draw(context, volume, transfer, s, SNOW_ISA_SCALAR);
    for (int isa = SNOW_ISA_SCALAR + 1; snow_isa_name((snow_isa)isa); isa++) {
        const char *name = snow_isa_name((snow_isa)isa);
        if (!strstr(snow_isa_found(), name))
            continue;
        snow_image *image = draw(context, volume, transfer, s, (snow_isa)isa);
        /* NEON and WebAssembly share the warp of scalar. */
        double bound = name[0] == 'a' ? 2e-6 : 0;
        double most = difference(plain, image);
        bool same = most <= bound;
        failed += !same;
        printf("%s %s: scene %d, %s, %s: %g\n", same ? "ok    " : "FAILED",
               name, (int)(s - scenes), wide ? "16 bits" : "8 bits",
               grey ? "grey" : "colours", most);
        snow_image_free(image);
    }
    snow_image_free(plain);
    snow_transfer_free(transfer);
    return failed;
}

int main(void) {
    static uint16_t voxels[SIDE * SIDE * SIDE];
    snow_context *context;
    int failed = 0;
    if (snow_context_new(NULL, &context) != SNOW_STATUS_OK)
        return 1;
    for (int wide = 0; wide < 2; wide++) {
        snow_volume_info info;
        snow_volume *volume;
        snow_volume_info_init(&info);
        for (int n = 0; n < 3; n++)
            info.dims[n] = SIDE;
        info.type = wide ? SNOW_TYPE_UINT16 : SNOW_TYPE_UINT8;
        fill(voxels, wide);
        CHECK(snow_volume_wrap(context, &info, voxels, &volume));
        for (size_t n = 0; n < sizeof scenes / sizeof *scenes; n++)
            failed += compare(context, volume, &scenes[n], wide, n % 2);
        snow_volume_close(volume);
    }
    snow_context_free(context);
    printf("%s: %d failed\n", snow_isa_found(), failed);
    return failed > 0;
}
