/* classify/preset.c - looks by name, with control points of our own.
 *
 * linear is how the paper reads its data (section 5.2, Table 1: the opacity of
 * a voxel is its 8-bit value).  The ct presets are in Hounsfield units: air
 * -1000, lung -700, fat -100, water 0, muscle 50, spongy bone 200 to 500, dense
 * bone above 1000.  CT data that are stored with an offset and without an
 * intercept (smallest value 0, water about 1000) need a range with it.  MR
 * values have no unit, so mr-default is spread over what the histogram shows
 * to be the object. */
#include "classify/look.h"

#define COUNT(array) (sizeof(array) / sizeof *(array))

static const snow_color_point bone_colors[] = {
    {150, 0.60, 0.38, 0.28},
    {300, 0.85, 0.70, 0.54},
    {600, 0.95, 0.90, 0.79},
    {1500, 1, 1, 0.98},
};

static const snow_opacity_point bone_opacities[] = {
    {150, 0}, {220, 0.10}, {350, 0.40}, {1500, 0.85}};

/* Skin and organs; bone shines through. */
static const snow_color_point soft_colors[] = {
    {-350, 0.78, 0.55, 0.45}, {-100, 0.93, 0.74, 0.58}, {10, 0.86, 0.52, 0.42},
    {80, 0.78, 0.38, 0.32},   {200, 0.90, 0.72, 0.60},  {500, 1, 0.97, 0.90},
};

static const snow_opacity_point soft_opacities[] = {
    {-350, 0}, {-150, 0.12}, {0, 0.20}, {80, 0.35}, {500, 0.80}};

/* Over 0..1, from the background's end to the brightest. */
static const snow_color_point mr_colors[] = {
    {0, 0.45, 0.32, 0.28},
    {0.3, 0.72, 0.58, 0.50},
    {0.6, 0.92, 0.84, 0.76},
    {1, 1, 1, 1},
};

static const snow_opacity_point mr_opacities[] = {
    {0, 0}, {0.12, 0.10}, {0.4, 0.25}, {1, 0.75}};

static const snow_color_point linear_colors[] = {{0, 0, 0, 0}, {1, 1, 1, 1}};
static const snow_opacity_point linear_opacities[] = {{0, 0}, {1, 1}};

enum { FULL_RANGE, OBJECT_RANGE, HOUNSFIELD };

static const struct {
    const char *name, *text, *colors_name;
    const snow_color_point *colors;
    size_t color_count;
    const snow_opacity_point *opacities;
    size_t opacity_count;
    int spread;
} presets[] = {
    {"linear", "grey and opacity 0 to 1 over the range, as in the paper",
     "grey", linear_colors, COUNT(linear_colors), linear_opacities,
     COUNT(linear_opacities), FULL_RANGE},
    {"ct-bone", "bone of a CT in Hounsfield units", "bone", bone_colors,
     COUNT(bone_colors), bone_opacities, COUNT(bone_opacities), HOUNSFIELD},
    {"ct-soft", "skin and soft tissue of a CT in Hounsfield units", "tissue",
     soft_colors, COUNT(soft_colors), soft_opacities, COUNT(soft_opacities),
     HOUNSFIELD},
    {"mr-default", "MR of any scale, spread over the object's values", "warm",
     mr_colors, COUNT(mr_colors), mr_opacities, COUNT(mr_opacities),
     OBJECT_RANGE},
};

const char *snow_preset_name(size_t index) {
    return index < COUNT(presets) ? presets[index].name : NULL;
}

const char *snow_preset_text(size_t index) {
    return index < COUNT(presets) ? presets[index].text : NULL;
}

int snow_preset_named(const char *name) {
    for (size_t i = 0; i < COUNT(presets); i++)
        if (snow_same_name(name, presets[i].name))
            return (int)i;
    return -1;
}

bool snow_preset_is_hounsfield(int preset) {
    return presets[preset].spread == HOUNSFIELD;
}

/* From the end of the background to the brightest of the object. */
static snow_status object_range(const snow_census *census, double *low,
                                double *high) {
    snow_parting p;
    SNOW_TRY(snow_part_histogram(census, &p));
    snow_full_range(census, low, high);
    if (!p.constant) {
        *low = snow_between(p.background, p.threshold, 0.6);
        *high = p.top;
    }
    return SNOW_OK;
}

snow_status snow_draft_preset(int preset, const snow_census *census,
                              snow_draft *out) {
    snow_draft draft = {.name = presets[preset].colors_name,
                        .reason = presets[preset].name,
                        .color_count = presets[preset].color_count,
                        .opacity_count = presets[preset].opacity_count};
    double low = 0, high = 1;
    bool relative = !snow_preset_is_hounsfield(preset);
    if (presets[preset].spread == FULL_RANGE)
        snow_full_range(census, &low, &high);
    else if (presets[preset].spread == OBJECT_RANGE)
        SNOW_TRY(object_range(census, &low, &high));
    for (size_t i = 0; i < draft.color_count; i++) {
        draft.colors[i] = presets[preset].colors[i];
        if (relative)
            draft.colors[i].value =
                snow_between(low, high, draft.colors[i].value);
    }
    for (size_t i = 0; i < draft.opacity_count; i++) {
        draft.opacities[i] = presets[preset].opacities[i];
        if (relative)
            draft.opacities[i].value =
                snow_between(low, high, draft.opacities[i].value);
    }
    draft.low = draft.colors[0].value;
    draft.high = draft.colors[draft.color_count - 1].value;
    *out = draft;
    return SNOW_OK;
}
