/* cc minimal.c $(pkg-config --cflags --libs snowglass) -o minimal */
#include <snowglass/snowglass.h>
#include <stdio.h>

int main(int argc, char **argv) {
    snow_context *context = NULL; /* memory and messages */
    snow_image *image = NULL;
    snow_status status = snow_context_new(NULL, &context);
    if (!status)
        status = snow_render_file(context, "phantom:head", NULL, NULL, &image);
    if (!status)
        status = snow_image_save(image, argc > 1 ? argv[1] : "head.png", NULL);
    if (status)
        fprintf(stderr, "%s\n", snow_context_message(context));
    snow_image_free(image);
    snow_context_free(context);
    return (int)status;
}
