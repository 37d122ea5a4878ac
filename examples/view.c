/* examples/view.c - a picture of a built-in volume from a chosen side, with
 * each object made by itself: volume, transfer function, frame, view, settings.
 */
#include <snowglass/snowglass.h>
#include <stdio.h>

int main(int argc, char **argv) {
    snow_context *context = NULL; /* memory and messages of all the rest */
    if (argc != 2 || snow_context_new(NULL, &context) != SNOW_STATUS_OK)
        return SNOW_STATUS_BAD_USAGE;

    snow_volume *volume = NULL;
    snow_transfer *transfer = NULL; /* data value to colour and opacity */
    snow_look look;                 /* by default chosen from the histogram */
    snow_look_init(&look);
    snow_frame *frame = NULL; /* the pipeline with its buffers */
    snow_settings settings;
    snow_settings_init(&settings);
    snow_view view;
    snow_view_init(&view);
    snow_image *image = NULL;

    snow_status status =
        snow_volume_open(context, "phantom:head", NULL, &volume);
    if (!status)
        status = snow_transfer_new_for_volume(volume, &look, &transfer);
    if (!status)
        status = snow_frame_new(context, &frame);
    if (!status) {
        snow_view_default(volume, &view); /* 512x512, from the front */
        view.azimuth = 30;
        status = snow_frame_render(frame, volume, transfer, &view, &settings,
                                   &image);
    }
    if (!status)
        status = snow_image_save(image, argv[1], NULL);
    if (status)
        fprintf(stderr, "view: %s\n", snow_context_message(context));

    snow_image_free(image);
    snow_frame_free(frame);
    snow_transfer_free(transfer);
    snow_volume_close(volume);
    snow_context_free(context);
    return (int)status;
}
