/* transfer/formats/tf.h - what the readers of transfer functions share: their
 * input and points, parsing of numbers, and colour spaces. */
#ifndef SNOW_TRANSFER_FORMATS_TF_H
#define SNOW_TRANSFER_FORMATS_TF_H

#include <snowglass/context.h>
#include <snowglass/extend.h>
#include <snowglass/look_file.h>
#include <stdbool.h>

#define TF_NAME_BYTES 64

/* Returns from a function if a call in it fails. */
#define TF_TRY(call)                         \
    do {                                     \
        snow_status tf_try_status = (call);  \
        if (tf_try_status != SNOW_STATUS_OK) \
            return tf_try_status;            \
    } while (0)

/* A growing list of points; a point of either kind begins with its value. */
typedef struct tf_list {
    void *points;
    size_t size, count, room;
} tf_list;

struct snow_look_file {
    snow_context *context;
    const char *format;
    char name[TF_NAME_BYTES];
    tf_list colors, opacities, gradients;
    snow_look look; /* points to the lists, after reading */
};

/* The bytes of a file, followed by a zero byte, and the name of the wanted
 * map. */
typedef struct tf_input {
    snow_context *context;
    const char *name; /* for messages */
    const char *bytes;
    size_t size;
    const char *wanted; /* NULL: the first */
} tf_input;

/* Fails with a message that begins with the file's name. */
snow_status tf_fail(const tf_input *in, const char *format, ...)
    SNOW_PRINTF(2, 3);

/* Appends a point: finite, not below the one before it, 0 to 1 (rounding errors
 * are clamped).  `what` and the count name it in messages. */
snow_status tf_add_color(const tf_input *in, snow_look_file *tf, double value,
                         const double rgb[3]);
snow_status tf_add_opacity(const tf_input *in, snow_look_file *tf,
                           tf_list *list, const char *what, double value,
                           double opacity);

/* Returns whether a name is the wanted one. */
bool tf_is_wanted(const tf_input *in, const char *name);
void tf_set_name(snow_look_file *tf, const char *name);

/* --- text: number.c
 * ------------------------------------------
 * */

/* Parses a decimal number, independent of the locale, at *at, and moves *at
 * past it; blanks and line ends before it are skipped.  Returns false if there
 * is no number: *at is then at the next character that is not blank. */
bool tf_take_number(const char **at, const char *end, double *out);

/* --- colour spaces: space.c
 * ----------------------------------
 * */

typedef enum tf_space {
    TF_RGB,
    TF_HSV,
    TF_HSV_WRAP, /* the shorter way around */
    TF_LAB,
    TF_DIVERGING,
    TF_STEP, /* the colour of a point holds up to and at it, as in VTK */
    TF_SPACES
} tf_space;

/* The colour at a share, 0 to 1, of the way from a to b. */
void tf_mix(tf_space space, const double a[3], const double b[3], double part,
            double out[3]);

/* Appends a colour point, and before it the points that straight lines need to
 * follow a colour space from the point before, whose colour is `last` (NULL:
 * none). */
snow_status tf_join_color(const tf_input *in, snow_look_file *tf,
                          tf_space space, double last_value, const double *last,
                          double value, const double rgb[3]);

/* The same for opacities with VTK's midpoint and sharpness:
 * curve.c. */
snow_status tf_join_opacity(const tf_input *in, snow_look_file *tf,
                            const double a[4], const double b[4]);

/* --- readers -------------------------------------------------------------- */

snow_status tf_read_vp(const tf_input *in, snow_look_file *tf);
snow_status tf_read_xml(const tf_input *in, snow_look_file *tf);
snow_status tf_read_json(const tf_input *in, snow_look_file *tf);
snow_status tf_read_pal(const tf_input *in, snow_look_file *tf);
snow_status tf_read_csv(const tf_input *in, snow_look_file *tf);

/* Reads three lists of Slicer, "count v v v ..." each: opacities, gradient
 * opacities and colours: vp.c. */
snow_status tf_read_slicer_lists(const tf_input *in, snow_look_file *tf,
                                 const char *opacities, const char *gradients,
                                 const char *colors);

#endif
