/* transfer/formats/space.c - interpolates colours in other colour spaces than
 * RGB.
 *
 * As in ParaView and VTK: CIE L*a*b* over sRGB with the white point D65
 * (0.9505, 1, 1.089), where colours outside of sRGB are scaled down; and K.
 * Moreland, "Diverging color maps for scientific visualization", ISVC 2009,
 * whose Msh is L*a*b* in polar coordinates, with white between two strong
 * hues. */
#include "transfer/formats/tf.h"

#include <math.h>
#include <string.h>

#define PI 3.14159265358979323846

/* The largest error of straight lines at the tested positions. */
#define TOLERANCE (1.0 / 1000)

/* The most halvings of one interval. */
#define DEPTH 9

static const double white[3] = {0.9505, 1.0, 1.0890};

static const double to_xyz[3][3] = {{0.4124, 0.3576, 0.1805},
                                    {0.2126, 0.7152, 0.0722},
                                    {0.0193, 0.1192, 0.9505}};
static const double from_xyz[3][3] = {{3.2406, -1.5372, -0.4986},
                                      {-0.9689, 1.8758, 0.0415},
                                      {0.0557, -0.2040, 1.0570}};

static void lab_of(const double rgb[3], double lab[3]) {
    double linear[3], f[3];
    for (int i = 0; i < 3; i++)
        linear[i] = rgb[i] > 0.04045 ? pow((rgb[i] + 0.055) / 1.055, 2.4)
                                     : rgb[i] / 12.92;
    for (int i = 0; i < 3; i++) {
        double t = (to_xyz[i][0] * linear[0] + to_xyz[i][1] * linear[1] +
                    to_xyz[i][2] * linear[2]) /
                   white[i];
        f[i] = t > 0.008856 ? cbrt(t) : 7.787 * t + 16.0 / 116;
    }
    lab[0] = 116 * f[1] - 16;
    lab[1] = 500 * (f[0] - f[1]);
    lab[2] = 200 * (f[1] - f[2]);
}

static void rgb_of(const double lab[3], double rgb[3]) {
    double y = (lab[0] + 16) / 116, most = 1, xyz[3];
    const double f[3] = {y + lab[1] / 500, y, y - lab[2] / 200};
    for (int i = 0; i < 3; i++) {
        double cube = f[i] * f[i] * f[i];
        xyz[i] =
            white[i] * (cube > 0.008856 ? cube : (f[i] - 16.0 / 116) / 7.787);
    }
    for (int i = 0; i < 3; i++) {
        double c = from_xyz[i][0] * xyz[0] + from_xyz[i][1] * xyz[1] +
                   from_xyz[i][2] * xyz[2];
        rgb[i] = c > 0.0031308 ? 1.055 * pow(c, 1 / 2.4) - 0.055 : 12.92 * c;
        most = rgb[i] > most ? rgb[i] : most;
    }
    for (int i = 0; i < 3; i++)
        rgb[i] = rgb[i] > 0 ? rgb[i] / most : 0;
}

static void straight(const double a[3], const double b[3], double part,
                     double out[3]) {
    for (int i = 0; i < 3; i++)
        out[i] = a[i] + (b[i] - a[i]) * part;
}

static void mix_lab(const double a[3], const double b[3], double part,
                    double out[3]) {
    double from[3], to[3], lab[3];
    lab_of(a, from);
    lab_of(b, to);
    straight(from, to, part, lab);
    rgb_of(lab, out);
}

/* --- HSV ------------------------------------------------------------------ */

static void hsv_of(const double rgb[3], double hsv[3]) {
    double most = fmax(rgb[0], fmax(rgb[1], rgb[2]));
    double least = fmin(rgb[0], fmin(rgb[1], rgb[2])), gap = most - least;
    double hue = 0;
    if (gap > 0 && most == rgb[0])
        hue = (rgb[1] - rgb[2]) / gap / 6;
    else if (gap > 0 && most == rgb[1])
        hue = (2 + (rgb[2] - rgb[0]) / gap) / 6;
    else if (gap > 0)
        hue = (4 + (rgb[0] - rgb[1]) / gap) / 6;
    hsv[0] = hue < 0 ? hue + 1 : hue;
    hsv[1] = most > 0 ? gap / most : 0;
    hsv[2] = most;
}

static void mix_hsv(const double a[3], const double b[3], bool wrap,
                    double part, double out[3]) {
    double from[3], to[3], hsv[3];
    hsv_of(a, from);
    hsv_of(b, to);
    if (wrap && fabs(from[0] - to[0]) > 0.5)
        from[0] > to[0] ? (from[0] -= 1) : (to[0] -= 1);
    straight(from, to, part, hsv);
    for (int i = 0; i < 3; i++) {
        /* The share of a primary colour, 0 to 1, at this distance around the
         * hue circle. */
        double around = hsv[0] - i / 3.0;
        double way = fabs(6 * (around - floor(around)) - 3) - 1;
        double share = way < 0 ? 0 : way > 1 ? 1 : way;
        out[i] = hsv[2] * (1 - hsv[1] * (1 - share));
    }
}

/* --- diverging ------------------------------------------------------------ */

static void msh_of(const double rgb[3], double msh[3]) {
    double lab[3];
    lab_of(rgb, lab);
    msh[0] = sqrt(lab[0] * lab[0] + lab[1] * lab[1] + lab[2] * lab[2]);
    msh[1] = msh[0] > 0.001 ? acos(lab[0] / msh[0]) : 0;
    msh[2] = msh[1] > 0.001 ? atan2(lab[2], lab[1]) : 0;
}

/* The hue for a colour without one beside a strong one. */
static double spun_hue(const double strong[3], double pale) {
    if (strong[0] >= pale - 0.1)
        return strong[2];
    double spin = strong[1] * sqrt(pale * pale - strong[0] * strong[0]) /
                  (strong[0] * sin(strong[1]));
    return strong[2] > -0.3 * PI ? strong[2] + spin : strong[2] - spin;
}

/* Strong hues more than a sixth of a turn apart get white between them. */
static void put_white_between(double from[3], double to[3], double *part) {
    double apart = fabs(from[2] - to[2]);
    apart = apart > PI ? 2 * PI - apart : apart;
    if (!(from[1] > 0.05 && to[1] > 0.05 && apart > 0.33 * PI))
        return;
    double middle[3] = {fmax(88, fmax(from[0], to[0])), 0, 0};
    memcpy(*part < 0.5 ? to : from, middle, sizeof middle);
    *part = *part < 0.5 ? 2 * *part : 2 * *part - 1;
}

static void mix_diverging(const double a[3], const double b[3], double part,
                          double out[3]) {
    double from[3], to[3], msh[3];
    msh_of(a, from);
    msh_of(b, to);
    put_white_between(from, to, &part);
    if (from[1] < 0.05 && to[1] > 0.05)
        from[2] = spun_hue(to, from[0]);
    else if (to[1] < 0.05 && from[1] > 0.05)
        to[2] = spun_hue(from, to[0]);
    straight(from, to, part, msh);
    const double lab[3] = {msh[0] * cos(msh[1]),
                           msh[0] * sin(msh[1]) * cos(msh[2]),
                           msh[0] * sin(msh[1]) * sin(msh[2])};
    rgb_of(lab, out);
}

void tf_mix(tf_space space, const double a[3], const double b[3], double part,
            double out[3]) {
    switch (space) {
    case TF_HSV:
    case TF_HSV_WRAP:
        mix_hsv(a, b, space == TF_HSV_WRAP, part, out);
        break;
    case TF_LAB:
        mix_lab(a, b, part, out);
        break;
    case TF_DIVERGING:
        mix_diverging(a, b, part, out);
        break;
    case TF_STEP:
        memcpy(out, part > 0 ? b : a, 3 * sizeof *out);
        break;
    default:
        straight(a, b, part, out);
        break;
    }
}

/* --- straight lines ------------------------------------------------------- */

typedef struct stretch {
    const tf_input *in;
    snow_look_file *tf;
    tf_space space;
    double value[2];
    const double *color[2];
} stretch;

/* Returns whether a straight line between two positions is close to the
 * curve. */
static bool is_close(const stretch *s, double from, const double a[3],
                     double to, const double b[3]) {
    for (int n = 1; n < 4; n++) {
        double exact[3], line[3];
        tf_mix(s->space, s->color[0], s->color[1], from + (to - from) * n / 4,
               exact);
        straight(a, b, n / 4.0, line);
        for (int i = 0; i < 3; i++)
            if (fabs(exact[i] - line[i]) > TOLERANCE)
                return false;
    }
    return true;
}

/* Adds the points between two positions, without these two. */
static snow_status add_between(const stretch *s, double from, const double a[3],
                               double to, const double b[3], int depth) {
    double middle = (from + to) / 2, color[3];
    if (depth == DEPTH || (depth > 1 && is_close(s, from, a, to, b)))
        return SNOW_STATUS_OK;
    tf_mix(s->space, s->color[0], s->color[1], middle, color);
    TF_TRY(add_between(s, from, a, middle, color, depth + 1));
    TF_TRY(tf_add_color(s->in, s->tf,
                        s->value[0] * (1 - middle) + s->value[1] * middle,
                        color));
    return add_between(s, middle, color, to, b, depth + 1);
}

snow_status tf_join_color(const tf_input *in, snow_look_file *tf,
                          tf_space space, double last_value, const double *last,
                          double value, const double rgb[3]) {
    if (last && space == TF_STEP)
        TF_TRY(tf_add_color(in, tf, nextafter(last_value, value), rgb));
    else if (last && space != TF_RGB && last_value < value) {
        const stretch s = {in, tf, space, {last_value, value}, {last, rgb}};
        TF_TRY(add_between(&s, 0, last, 1, rgb, 0));
    }
    return tf_add_color(in, tf, value, rgb);
}
