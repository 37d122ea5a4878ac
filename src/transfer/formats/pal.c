/* transfer/formats/pal.c - palettes of Amrvis: 256 bytes of red, then of green
 * and of blue, and in files of 1024 bytes of opacity, in percent.  They have no
 * values: entry n is at n / 255 of the range. */
#include "transfer/formats/tf.h"

#define ENTRIES 256

snow_status tf_read_pal(const tf_input *in, snow_look_file *tf) {
    const unsigned char *bytes = (const unsigned char *)in->bytes;
    for (size_t n = 0; n < ENTRIES; n++) {
        const double rgb[3] = {bytes[n] / 255.0, bytes[n + ENTRIES] / 255.0,
                               bytes[n + 2 * ENTRIES] / 255.0};
        TF_TRY(tf_add_color(in, tf, (double)n / (ENTRIES - 1), rgb));
        if (in->size < 4 * ENTRIES)
            continue;
        int percent = bytes[n + 3 * ENTRIES];
        if (percent > 100)
            return tf_fail(in,
                           "entry %zu has an opacity of %d percent; Amrvis "
                           "palettes range from 0 to 100",
                           n, percent);
        TF_TRY(tf_add_opacity(in, tf, &tf->opacities, "opacity",
                              (double)n / (ENTRIES - 1), percent / 100.0));
    }
    tf->format = "pal";
    tf->look.domain = SNOW_DOMAIN_RANGE;
    return SNOW_STATUS_OK;
}
