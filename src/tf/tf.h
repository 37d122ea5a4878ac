/* tf/tf.h - what the readers of transfer functions share: the points that they
 * make, their input, numbers of text, and colour spaces. */
#ifndef SNOW_TF_PARTS_H
#define SNOW_TF_PARTS_H

#include <snowglass/context.h>
#include <snowglass/tf.h>
#include <stdbool.h>

#define TF_NAME_BYTES 64

/* Leaves a function when a call in it fails. */
#define TF_TRY(call)                        \
    do {                                    \
        snow_status tf_try_status = (call); \
        if (tf_try_status != SNOW_OK)       \
            return tf_try_status;           \
    } while (0)

/* A list of points that grows; either kind begins with its value. */
typedef struct tf_list {
    void *points;
    size_t size, count, room;
} tf_list;

struct snow_tf {
    snow_context *context;
    const char *format;
    char name[TF_NAME_BYTES];
    tf_list colors, opacities, gradients;
    snow_points points; /* over the lists, once all is read */
};

/* A file's bytes, behind which lies a zero byte, and who is wanted of it. */
typedef struct tf_input {
    snow_context *context;
    const char *name; /* for messages */
    const char *bytes;
    size_t size;
    const char *wanted; /* NULL: the first */
} tf_input;

/* A message that begins with the file's name. */
snow_status tf_fail(const tf_input *in, const char *format, ...)
    SNOW_PRINTF(2, 3);

/* Appends a point: finite, not below the one before it, 0 to 1 (a rounding
 * beyond is cut off).  `what` and the count name it in messages. */
snow_status tf_add_color(const tf_input *in, snow_tf *tf, double value,
                         const double rgb[3]);
snow_status tf_add_opacity(const tf_input *in, snow_tf *tf, tf_list *list,
                           const char *what, double value, double opacity);

/* Whether a name is the wanted one. */
bool tf_is_wanted(const tf_input *in, const char *name);
void tf_set_name(snow_tf *tf, const char *name);

/* --- text: tf/number.c ---------------------------------------------------- */

/* Takes a number in decimal digits, whatever the locale, from *at on, which is
 * then behind it; blanks before it are skipped, lines' ends too.  False where
 * there is none: *at is at what stands there. */
bool tf_take_number(const char **at, const char *end, double *out);

/* --- colour spaces: tf/space.c -------------------------------------------- */

typedef enum tf_space {
    TF_RGB,
    TF_HSV,
    TF_HSV_WRAP, /* the shorter way around */
    TF_LAB,
    TF_DIVERGING,
    TF_STEP, /* up to a point, and at it, all has its colour, as in VTK */
    TF_SPACES
} tf_space;

/* The colour at a part, 0 to 1, of the way from a to b. */
void tf_mix(tf_space space, const double a[3], const double b[3], double part,
            double out[3]);

/* Appends a colour point, and before it those that straight lines need for the
 * way from the point before, whose colour is `last` (NULL: none), joined in a
 * colour space. */
snow_status tf_join_color(const tf_input *in, snow_tf *tf, tf_space space,
                          double last_value, const double *last, double value,
                          const double rgb[3]);

/* The same for opacities with VTK's midpoint and sharpness: tf/curve.c. */
snow_status tf_join_opacity(const tf_input *in, snow_tf *tf, const double a[4],
                            const double b[4]);

/* --- readers -------------------------------------------------------------- */

snow_status tf_read_vp(const tf_input *in, snow_tf *tf);
snow_status tf_read_xml(const tf_input *in, snow_tf *tf);
snow_status tf_read_json(const tf_input *in, snow_tf *tf);
snow_status tf_read_pal(const tf_input *in, snow_tf *tf);
snow_status tf_read_csv(const tf_input *in, snow_tf *tf);

/* Three lists of Slicer's, "count v v v ..." each: opacities, gradient
 * opacities and colours: tf/vp.c. */
snow_status tf_read_slicer_lists(const tf_input *in, snow_tf *tf,
                                 const char *opacities, const char *gradients,
                                 const char *colors);

#endif
