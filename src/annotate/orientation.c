/* annotate/orientation.c - the letters at a picture's edges that show how the
 * patient lies.
 *
 * Radiologists read them before anything else.  Directions are those of the
 * camera, in the RAS world (model, sections 1 and 2): the edge of the picture
 * towards the patient's left is labelled L. */
#include "image/overlay.h"
#include "transform/transform.h"

#include <snowglass/extend.h>
#include <snowglass/overlay.h>

#include <math.h>

/* Sine of 25 degrees: below it the second letter is omitted. */
#define OBLIQUE 0.42261826174069944

/* Two components are equal within this tolerance, so that a turn of 45 degrees
 * has the same letters in every quadrant. */
#define TIE 1e-6

/* How many places a letter has along its edge. */
#define ROW 41

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

/* Draws a letter at the middle of its edge, or as near to it as there is room:
 * up to a tenth of the edge from a corner, or as far in two more rows. */
static snow_status draw_letter(snow_overlay *overlay, const double place[2],
                               const double share[2], const char *letter) {
    size_t first = overlay->shape_count;
    double offsets[3 * ROW][2] = {{0, 0}};
    bool level = share[0] == 0.5; /* an edge at the top or the bottom */
    int edge = level ? overlay->width : overlay->height;
    double height = snow_overlay_text_height(overlay);
    SNOW_TRY(snow_overlay_text(overlay, place[0], place[1], share[0], share[1],
                               height, letter));
    for (int n = 0; n < 3 * ROW; n++) {
        int step = (n % ROW + 1) / 2 * (n % 2 ? 1 : -1);
        offsets[n][!level] = floor(0.8 / (ROW - 1) * edge * step);
        offsets[n][level] = floor(n / ROW * 5 * height * (0.5 - share[level]));
    }
    snow_overlay_settle(overlay, first, (const double(*)[2])offsets, 3 * ROW,
                        false);
    return SNOW_STATUS_OK;
}

snow_status snow_overlay_orientation(snow_overlay *overlay,
                                     const snow_volume_info *info,
                                     const snow_view *view) {
    /* The point of a letter's box that lies at the same point of the picture:
     * at the middle of its edges. */
    static const double shares[4][2] = {{0, 0.5}, {1, 0.5}, {0.5, 0}, {0.5, 1}};
    char letters[4][4];
    SNOW_TRY(snow_view_orientation(overlay->context, info, view, letters));
    if (overlay->width < 64 || overlay->height < 64)
        return SNOW_STATUS_OK;
    double margin = 0.6 * snow_overlay_text_height(overlay);
    for (int n = 0; n < 4; n++) {
        const double place[2] = {
            margin + shares[n][0] * (overlay->width - 2 * margin),
            margin + shares[n][1] * (overlay->height - 2 * margin)};
        SNOW_TRY(draw_letter(overlay, place, shares[n], letters[n]));
    }
    return SNOW_STATUS_OK;
}
