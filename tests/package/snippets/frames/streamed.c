/* The snippet of docs/larger.md. */
#include <snowglass/snowglass.h>

#include <stdio.h>

int main(void) {
    snow_context *context = NULL;
    snow_frame *frame = NULL;
    snow_transfer *transfer = NULL;
    snow_image *image = NULL;
    snow_view view;
    snow_settings settings;
    if (snow_context_new(NULL, &context) || snow_frame_new(context, &frame))
        return 1;
    snow_view_init(&view);
    view.width = view.height = 64;
    snow_settings_init(&settings);
    SNIPPET
    if (!image)
        fprintf(stderr, "%s\n", snow_context_message(context));
    return !image;
}
