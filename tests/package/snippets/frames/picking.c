/* The snippet of docs/output.md: points and pixels. */
#include <snowglass/snowglass.h>

int main(void) {
    snow_context *context = NULL;
    snow_volume *volume = NULL;
    snow_transfer *transfer = NULL;
    snow_frame *frame = NULL;
    snow_image *image = NULL;
    snow_view view;
    snow_settings settings;
    const double mouse_x = 256.3, mouse_y = 250.9;
    snow_settings_init(&settings);
    settings.depth = true;
    snow_view_init(&view);
    if (snow_context_new(NULL, &context) ||
        snow_volume_open(context, "ct.nrrd", NULL, &volume) ||
        snow_transfer_new_for_volume(volume, NULL, &transfer) ||
        snow_view_default(volume, &view) ||
        snow_view_fit(NULL, volume, transfer, NULL, NULL, 0, &view) ||
        snow_frame_new(context, &frame) ||
        snow_frame_render(frame, volume, transfer, &view, &settings, &image))
        return 1;
    SNIPPET
    /* What is seen is in the volume. */
    const snow_volume_info *info = snow_volume_get_info(volume);
    for (int i = 0; i < 3; i++) {
        double low = info->matrix[i][3], high = low;
        for (int axis = 0; axis < 3; axis++) {
            double all = info->matrix[i][axis] * (double)info->dims[axis];
            *(all < 0 ? &low : &high) += all;
        }
        if (!(place[i] > low - 10 && place[i] < high + 10))
            return 1;
    }
    return 0;
}
