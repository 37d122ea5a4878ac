/* annotate/orientation.c - the letters at a picture's edges that show how the
 * patient lies.
 *
 * Radiologists read them before anything else.  Directions are those of the
 * camera, in the RAS world (model, sections 1 and 2): the edge of the picture
 * towards the patient's left is labelled L. */
#include "annotate/strokes.h"
#include "transform/transform.h"

#include <snowglass/extend.h>
#include <snowglass/overlay.h>

#include <math.h>

/* Sine of 25 degrees: below it the second letter is omitted. */
#define OBLIQUE 0.42261826174069944

/* Two components are equal within this tolerance, so that a turn of 45 degrees
 * has the same letters in every quadrant. */
#define TIE 1e-6

/* Of letters from their edge, of the picture's shorter side. */
#define MARGIN 0.02

/* The letters of a direction in the world: those of its largest and second
 * largest component. */
static void name_direction(const double direction[3], double sign,
                           char out[4]) {
    static const char names[3][2] = {{'R', 'L'}, {'A', 'P'}, {'S', 'I'}};
    int order[3] = {0, 1, 2}, used = 0;
    for (int n = 0; n < 2; n++)
        for (int i = 0; i < 2; i++)
            if (fabs(direction[order[i + 1]]) >
                fabs(direction[order[i]]) + TIE) {
                int first = order[i];
                order[i] = order[i + 1];
                order[i + 1] = first;
            }
    for (int n = 0; n < 2; n++) {
        double share = sign * direction[order[n]];
        if (fabs(share) > OBLIQUE)
            out[used++] = names[order[n]][share < 0];
    }
    out[used] = '\0';
}

snow_status snow_view_orientation(snow_context *context,
                                  const snow_volume_info *info,
                                  const snow_view *view, char letters[4][4]) {
    snow_camera camera;
    snow_volume_info volume;
    snow_view from;
    SNOW_TRY(SNOW_RECORD_READ(context, snow_volume_info, info, &volume));
    SNOW_TRY(SNOW_RECORD_READ(context, snow_view, view, &from));
    SNOW_TRY(snow_camera_make(context, &volume, &from, &camera));
    for (int edge = 0; edge < 4; edge++)
        letters[edge][0] = '\0';
    if (!volume.medical)
        return SNOW_STATUS_OK;
    name_direction(camera.right, -1, letters[0]);
    name_direction(camera.right, 1, letters[1]);
    name_direction(camera.up, 1, letters[2]);
    name_direction(camera.up, -1, letters[3]);
    return SNOW_STATUS_OK;
}

/* At the middle of each edge, always. */
snow_status snow_overlay_orientation(snow_overlay *overlay,
                                     const snow_volume_info *info,
                                     const snow_view *view) {
    /* The point of a letter's box that lies at the same point of the picture:
     * at the middle of its edges. */
    static const double shares[4][2] = {{0, 0.5}, {1, 0.5}, {0.5, 0}, {0.5, 1}};
    char letters[4][4];
    snow_view from;
    SNOW_TRY(SNOW_RECORD_READ(overlay->context, snow_view, view, &from));
    SNOW_TRY(snow_view_orientation(overlay->context, info, &from, letters));
    if (overlay->width < 64 || overlay->height < 64)
        return SNOW_STATUS_OK;
    double margin = MARGIN * snow_shorter_side(overlay);
    for (int n = 0; n < 4; n++)
        SNOW_TRY(snow_overlay_text(
            overlay,
            margin + shares[n][0] * (snow_view_room(&from) - 2 * margin),
            margin + shares[n][1] * (overlay->height - 2 * margin),
            shares[n][0], shares[n][1], snow_overlay_text_height(overlay),
            letters[n]));
    return SNOW_STATUS_OK;
}
