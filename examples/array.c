/* examples/array.c - a picture of an array that a program has in memory.
 *
 * cc array.c $(pkg-config --cflags --libs snowglass) -lm -o array
 * ./array blob.png */
#include <math.h>
#include <snowglass/snowglass.h>
#include <stdint.h>
#include <stdio.h>

enum { SIDE = 64 };

/* A ball of values that fall from its middle, x fastest. */
static void fill(uint8_t voxels[SIDE][SIDE][SIDE]) {
    for (int z = 0; z < SIDE; z++)
        for (int y = 0; y < SIDE; y++)
            for (int x = 0; x < SIDE; x++) {
                double a = x - SIDE / 2, b = y - SIDE / 2, c = z - SIDE / 2;
                double r = sqrt(a * a + b * b + c * c);
                voxels[z][y][x] = (uint8_t)(r < 30 ? 250 - 8 * r : 0);
            }
}

static snow_status draw(snow_context *context, const snow_volume *volume,
                        snow_image **out) {
    snow_look look; /* by default colours and opacities by the histogram */
    snow_transfer *transfer = NULL;
    snow_frame *frame = NULL;
    snow_settings settings;
    snow_view view;
    snow_look_init(&look);
    snow_settings_init(&settings);
    snow_view_init(&view);
    snow_view_default(volume, &view);
    snow_status status = snow_transfer_new_for_volume(volume, &look, &transfer);
    if (!status)
        status = snow_frame_new(context, &frame);
    if (!status)
        status =
            snow_frame_render(frame, volume, transfer, &view, &settings, out);
    snow_frame_free(frame);
    snow_transfer_free(transfer);
    return status;
}

int main(int argc, char **argv) {
    static uint8_t voxels[SIDE][SIDE][SIDE];
    snow_volume_info info;
    snow_context *context = NULL;
    snow_volume *volume = NULL;
    snow_image *image = NULL;
    if (argc != 2 || snow_context_new(NULL, &context) != SNOW_STATUS_OK)
        return SNOW_STATUS_BAD_USAGE;
    fill(voxels);
    snow_volume_info_init(&info);
    info.dims[0] = info.dims[1] = info.dims[2] = SIDE;
    info.type = SNOW_TYPE_UINT8;
    snow_status status = snow_volume_wrap(context, &info, voxels, &volume);
    if (!status)
        status = draw(context, volume, &image);
    if (!status)
        status = snow_image_save(image, argv[1], NULL);
    if (status)
        fprintf(stderr, "array: %s\n", snow_context_message(context));
    snow_image_free(image);
    snow_volume_close(volume);
    snow_context_free(context);
    return (int)status;
}
