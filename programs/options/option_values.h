/* option_values.h - the values of options, parsed strictly from text.
 *
 * Numbers are decimal, finite and end where the text ends; nothing is rounded
 * to fit.  A function that returns false leaves its result unchanged. */
#ifndef VALUES_H
#define VALUES_H

#include <snowglass/snowglass.h>

/* Size of the end of an error message, see options.h. */
#define WRONG_BYTES 1024

#define POINTS_MAX 256

/* A list of control points of the opacity; or one factor for all opacities of a
 * look, the opacity of a point whose value is NaN. */
typedef struct point_list {
    snow_opacity_point points[POINTS_MAX];
    size_t count;
} point_list;

typedef struct range_value {
    snow_range kind;
    double low, high;
} range_value;

/* The look of an overlay, of which any part may be left out. */
typedef struct overlay_look_value {
    const char *text;    /* as it was given; NULL: not */
    const char *preset;  /* NULL: none */
    char colormap[1024]; /* a name or a list; "": none */
    bool outline;        /* borders alone, in slices */
    range_value range;
    point_list opacity;
} overlay_look_value;

/* A position or a direction in the world. */
typedef struct place_value {
    bool given;
    double at[3];
} place_value;

/* Where the light comes from; the angles are of a direction. */
typedef struct light_value {
    snow_light light;
    double azimuth, elevation;
} light_value;

/* Of the values. */
typedef struct scale_value {
    bool log;
    double symlog; /* 0: not; -1: from where it suits */
} scale_value;

/* Where the viewer listens. */
typedef struct listen_value {
    char address[64]; /* as numbers; "": this machine alone */
    int port;         /* 0: a free one */
    const char *path; /* of a Unix socket; NULL: a port */
} listen_value;

/* What explains the colours and lengths of a picture. */
typedef struct legend_value {
    bool bar, scale;           /* colours; lengths */
    const char *title;         /* as it was given: "name (unit)"; NULL: not */
    char name[104], unit[104]; /* its parts; "": the file's */
} legend_value;

/* Which step a picture is of. */
typedef struct annotate_value {
    const char *text;   /* as it was given; NULL: not */
    bool time;          /* its physical time, where there is one */
    const char *format; /* of the time; NULL: the usual */
} annotate_value;

typedef struct color_value {
    bool given;     /* false: transparent, or */
    bool automatic; /* dark where the output shows a background */
    double rgb[3];
} color_value;

bool value_real(const char *text, double *out);
bool value_integer(const char *text, int64_t *out);
bool value_count(const char *text, uint64_t *out);

/* Parses bytes: digits, or a number and K, M, G or T (of 1024), optionally
 * followed by B or iB; rounded down to whole bytes. */
bool value_bytes(const char *text, uint64_t *out);

/* A number, or a quotient of two such as 1/255. */
bool value_quotient(const char *text, double *out);

/* The most numbers that an option takes: clip planes. */
#define VALUES_MOST (4 * SNOW_CLIPS_MAX)

/* `count` numbers between single characters `separator`: "256x256x110"; up to
 * three whole numbers, up to VALUES_MOST others. */
bool value_reals(const char *text, char separator, int count, double *out);
bool value_integers(const char *text, char separator, int count, int64_t *out);

/* "first:end,first:end,first:end"; an omitted number is 0, the end of the
 * volume. first < end if both are given. */
bool value_crop(const char *text, int64_t out[3][2]);

/* "auto", "none", a name, #rgb, #rrggbb, or red,green,blue from 0 to 1. */
bool value_color(const char *text, color_value *out);

/* The names of colours, separated by blanks. */
void value_color_names(char *out, size_t size);

/* "lo,hi", "p1,p99" or "full". */
bool value_range(const char *text, range_value *out);

/* "v:o,v:o,...": values that do not decrease, opacities from 0 to 1. */
bool value_points(const char *text, point_list *out);

/* Parses one factor, from 0 to 1; whether a list is one. */
bool value_factor(const char *text, point_list *out);
bool points_are_factor(const point_list *list);

/* "hot,2,12,0.6": colours, range and opacities by their forms. */
bool value_overlay_look(const char *text, overlay_look_value *out);

/* "ADDRESS:PORT", "[ADDRESS]:PORT", ":PORT", "ADDRESS" or "unix:PATH". */
bool value_listen(const char *text, listen_value *out);

/* True if `text` is one of the words of "a|b|c", in any case; "" is not a
 * choice. */
bool value_is_choice(const char *choices, const char *text);

#endif
