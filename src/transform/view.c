/* transform/view.c - views by name, and rotations of the camera.
 *
 * In RAS world space anterior is +y, left -x, superior +z. A frame is right,
 * up, back, with back pointing from the target to the camera. */

#include "transform/transform.h"
#include "volume/field.h"
#include "volume/volume.h"

#include <math.h>
#include <string.h>

#define THIRD 0.57735026918962576451 /* 1 / sqrt(3) */
#define SIXTH 0.40824829046386301637 /* 1 / sqrt(6) */

static const struct {
    const char *name;
    double back[3], up[3];
} views[] = {
    {"anterior", {0, 1, 0}, {0, 0, 1}},
    {"posterior", {0, -1, 0}, {0, 0, 1}},
    {"left", {-1, 0, 0}, {0, 0, 1}},
    {"right", {1, 0, 0}, {0, 0, 1}},
    {"superior", {0, 0, 1}, {0, 1, 0}},
    {"inferior", {0, 0, -1}, {0, 1, 0}},
    {"iso", {THIRD, THIRD, THIRD}, {-SIXTH, -SIXTH, 2 * SIXTH}},
    /* From the front, 30 degrees to the right and 25 up. */
    {"oblique",
     {0.45315389351832497, -0.7848855672213958, 0.42261826174069944},
     {-0.21130913087034972, 0.36599815077066683, 0.9063077870366499}},
    {"+x", {1, 0, 0}, {0, 0, 1}},
    {"-x", {-1, 0, 0}, {0, 0, 1}},
    {"+y", {0, 1, 0}, {0, 0, 1}},
    {"-y", {0, -1, 0}, {0, 0, 1}},
    {"+z", {0, 0, 1}, {0, 1, 0}},
    {"-z", {0, 0, -1}, {0, 1, 0}},
    {"axial", {0, 0, 1}, {0, 1, 0}},
    {"coronal", {0, -1, 0}, {0, 0, 1}},
    {"sagittal", {1, 0, 0}, {0, 0, 1}},
    {"front", {0, -1, 0}, {0, 0, 1}},
    {"back", {0, 1, 0}, {0, 0, 1}},
    {"top", {0, 0, 1}, {0, 1, 0}},
    {"bottom", {0, 0, -1}, {0, 1, 0}},
};

#define VIEW_COUNT (sizeof views / sizeof views[0])

const char *snow_view_name(size_t index) {
    return index < VIEW_COUNT ? views[index].name : NULL;
}

static const snow_view defaults = {
    .width = 512, .height = 512, .back = {0, 0, 1}, .up = {0, 1, 0}, .zoom = 1};

void snow_view_init_sized(snow_view *view, size_t size) {
    snow_record_init(view, size, &defaults, sizeof defaults);
}

snow_status snow_view_from_name(snow_context *context, const char *name,
                                snow_view *out) {
    snow_view view = defaults;
    for (size_t i = 0; i < VIEW_COUNT; i++) {
        if (!snow_same_name(name, views[i].name))
            continue;
        memcpy(view.back, views[i].back, sizeof view.back);
        memcpy(view.up, views[i].up, sizeof view.up);
        return SNOW_RECORD_FILL(context, snow_view, &view, out);
    }
    return snow_fail(
        context, SNOW_STATUS_BAD_USAGE,
        "unknown view '%.64s': must be anterior, posterior, left, "
        "right, superior, inferior, iso, oblique, axial, "
        "coronal, sagittal, front, back, top, bottom, +x, -x, +y, -y, +z "
        "or -z",
        name);
}

/* The most levels that are seen as a map, from above. */
#define LEVELS 5

/* A field with an inside and a height, which may also be a flat one, as that of
 * an atmosphere. */
static bool is_body_of_field(const snow_volume_info *info) {
    return (info->type == SNOW_TYPE_FLOAT32 ||
            info->type == SNOW_TYPE_FLOAT64) &&
           snow_volume_may_be_field(info) && info->dims[0] > LEVELS &&
           info->dims[1] > LEVELS && info->dims[2] > LEVELS;
}

/* Axial slices of patients are seen from the feet, as radiologists do. */
static const char *default_name(const snow_volume_info *info) {
    static const char *const faces[2][3] = {{"+x", "-y", "+z"},
                                            {"left", "anterior", "inferior"}};
    int thin = snow_volume_thin_axis(info), along = 0;
    double normal[3];
    if (is_body_of_field(info))
        return "oblique";
    if (thin < 0)
        return info->medical ? "anterior" : "+z";
    snow_slice_normal(info, thin, normal);
    for (int i = 1; i < 3; i++)
        if (fabs(normal[i]) > fabs(normal[along]))
            along = i;
    return faces[info->medical][along];
}

const char *snow_view_name_for(const snow_volume_info *info, const char *name) {
    static const char *const patient[][2] = {{"axial", "inferior"},
                                             {"coronal", "anterior"},
                                             {"sagittal", "left"},
                                             {"front", "anterior"},
                                             {"back", "posterior"}};
    for (size_t i = 0; i < sizeof patient / sizeof *patient && name; i++)
        if (info->medical && snow_same_name(name, patient[i][0]))
            return patient[i][1];
    return name ? name : default_name(info);
}

snow_status snow_view_default(const snow_volume *volume, snow_view *out) {
    const snow_volume_info *info = snow_volume_get_info(volume);
    return snow_view_from_name(volume->context, snow_view_name_for(info, NULL),
                               out);
}

double snow_view_zoom_for_voxels(const snow_volume *volume, int width,
                                 int height) {
    const snow_volume_info *info = snow_volume_get_info(volume);
    double voxel =
        fmin(info->spacing[0], fmin(info->spacing[1], info->spacing[2]));
    return 2 * snow_volume_radius(info) / (voxel * fmin(width, height));
}

/* Cosine and sine of an angle in degrees, exact at multiples of 90. */
static void turn_of(double degrees, double *cosine, double *sine) {
    const double radian = 0.017453292519943295769; /* pi / 180 */
    double quarter = floor(degrees / 90 + 0.5);
    double rest = (degrees - 90 * quarter) * radian; /* -45 to 45 degrees */
    double c = cos(rest), s = sin(rest);
    switch ((int)(quarter - 4 * floor(quarter / 4))) {
    case 0:
        *cosine = c, *sine = s;
        break;
    case 1:
        *cosine = -s, *sine = c;
        break;
    case 2:
        *cosine = -c, *sine = -s;
        break;
    default:
        *cosine = s, *sine = -c;
    }
}

/* Rotates a towards b, and b away from a. */
static void turn_pair(double a[3], double b[3], double degrees) {
    double c, s;
    turn_of(degrees, &c, &s);
    for (int i = 0; i < 3; i++) {
        double old = a[i];
        a[i] = c * old + s * b[i];
        b[i] = c * b[i] - s * old;
    }
}

void snow_frame_turn(double right[3], double up[3], double back[3],
                     double azimuth, double elevation, double roll) {
    turn_pair(back, right, azimuth);
    turn_pair(back, up, elevation);
    turn_pair(up, right, roll);
}
