/* transfer/preset.c - presets: looks by name, with control points of our own.
 *
 * linear is how the paper maps its data (section 5.2, Table 1: the opacity of a
 * voxel is its 8-bit value).  The others have names that users know from 3D
 * Slicer and from viewers that copied them.  The points were chosen here from
 * the values of tissues and by looking at volumes.
 *
 * The ct presets are in Hounsfield units: air -1000, lung -900 to -500, fat
 * -120 to -70, water 0, muscle and blood 40 to 60, liver with contrast 100 to
 * 130, blood with contrast 150 to 450, spongy bone 200 to 500, dense bone above
 * 700, metal above 2500.  Gradient magnitudes are in Hounsfield units per
 * millimetre: noise and uniform regions up to 15, fat against muscle 60, bone
 * and air against all else above 150.  CT data that are stored with an offset
 * and without an intercept (smallest value 0, water about 1000) need a range;
 * those of 8 bits are spread over the object's range, found from the histogram.
 * MR values have no unit, so the MR presets are spread over that range too. */
#include "transfer/look.h"

#define COUNT(array) (sizeof(array) / sizeof *(array))

typedef snow_color_point color;
typedef snow_opacity_point opacity;

/* --- bone ----------------------------------------------------------------- */

static const color bone_colors[] = {
    {150, 0.60, 0.38, 0.28},
    {300, 0.85, 0.70, 0.54},
    {600, 0.95, 0.90, 0.79},
    {1500, 1, 1, 0.98},
};
static const opacity bone_opacities[] = {
    {150, 0}, {220, 0.10}, {350, 0.40}, {1500, 0.85}};

/* Harder than ct-bone: surfaces only, spongy bone darker than dense bone. */
static const color bones_colors[] = {
    {180, 0.55, 0.30, 0.20},
    {350, 0.86, 0.68, 0.50},
    {700, 0.97, 0.93, 0.82},
    {1600, 1, 1, 1},
};
static const opacity bones_opacities[] = {
    {180, 0}, {260, 0.35}, {500, 0.75}, {1600, 0.95}};

/* A cut through bone is also a surface, so even marrow is shown. */
static const color cropped_colors[] = {
    {100, 0.62, 0.22, 0.16},
    {250, 0.80, 0.52, 0.36},
    {500, 0.94, 0.84, 0.66},
    {1400, 1, 1, 0.97},
};
static const opacity cropped_opacities[] = {
    {90, 0}, {130, 0.15}, {200, 0.75}, {1400, 0.95}};

/* --- vessels with contrast ------------------------------------------------ */

/* Blood is red, thrombus and walls dark, bone ivory. */
static const color aaa_colors[] = {
    {130, 0.42, 0.08, 0.06}, {230, 0.80, 0.16, 0.10}, {380, 0.96, 0.46, 0.30},
    {600, 0.96, 0.86, 0.70}, {1500, 1, 1, 0.97},
};
static const opacity aaa_opacities[] = {
    {130, 0}, {180, 0.16}, {300, 0.50}, {600, 0.62}, {2000, 0.85}};

/* The same with organs as a veil. */
static const color aaa2_colors[] = {
    {-60, 0.80, 0.62, 0.45}, {30, 0.72, 0.40, 0.32},  {120, 0.60, 0.20, 0.14},
    {230, 0.85, 0.18, 0.10}, {380, 0.98, 0.50, 0.32}, {600, 0.96, 0.86, 0.70},
    {1500, 1, 1, 0.97},
};
static const opacity aaa2_opacities[] = {{-60, 0},    {20, 0.015}, {120, 0.03},
                                         {180, 0.18}, {300, 0.50}, {600, 0.62},
                                         {2000, 0.85}};

static const color vessel_colors[] = {
    {90, 0.45, 0.12, 0.08},  {200, 0.85, 0.25, 0.15}, {350, 0.98, 0.62, 0.40},
    {550, 0.97, 0.88, 0.72}, {1500, 1, 1, 0.98},
};
static const opacity chest_vessels_opacities[] = {
    {90, 0}, {150, 0.12}, {280, 0.45}, {600, 0.60}, {1800, 0.80}};

/* Lungs as a veil, the heart and vessels solid. */
static const color chest_colors[] = {
    {-850, 0.55, 0.62, 0.75}, {-500, 0.72, 0.66, 0.70}, {-80, 0.90, 0.74, 0.55},
    {50, 0.75, 0.35, 0.28},   {200, 0.86, 0.22, 0.14},  {350, 0.98, 0.58, 0.38},
    {600, 0.97, 0.90, 0.76},  {1500, 1, 1, 1},
};
static const opacity chest_opacities[] = {
    {-850, 0},   {-700, 0.008}, {-450, 0.012}, {-200, 0.004}, {60, 0.012},
    {140, 0.10}, {260, 0.42},   {600, 0.62},   {1800, 0.80}};

/* Pulmonary arteries and veins are among the brightest: all below is faint. */
static const color pulmonary_colors[] = {
    {-600, 0.45, 0.50, 0.62}, {-300, 0.50, 0.42, 0.55}, {100, 0.36, 0.22, 0.50},
    {220, 0.30, 0.42, 0.80},  {400, 0.55, 0.72, 0.98},  {700, 0.96, 0.90, 0.80},
    {1500, 1, 1, 1},
};
static const opacity pulmonary_opacities[] = {
    {-600, 0},   {-400, 0.01}, {-100, 0.01}, {140, 0.02},
    {220, 0.30}, {400, 0.55},  {1800, 0.75}};

static const color liver_colors[] = {
    {60, 0.42, 0.20, 0.16},  {110, 0.62, 0.30, 0.24}, {160, 0.82, 0.38, 0.28},
    {230, 0.95, 0.66, 0.42}, {500, 0.97, 0.90, 0.76}, {1500, 1, 1, 1},
};
static const opacity liver_opacities[] = {
    {70, 0}, {110, 0.02}, {135, 0.10}, {180, 0.40}, {500, 0.60}, {1800, 0.8}};

/* --- the heart ------------------------------------------------------------ */

/* Walls (about 100) and chambers (200 to 400); uniform regions are fainter, so
 * that the chambers are visible. */
static const color cardiac_colors[] = {
    {20, 0.38, 0.10, 0.08},  {110, 0.66, 0.22, 0.17}, {220, 0.90, 0.38, 0.26},
    {380, 0.99, 0.74, 0.54}, {700, 0.98, 0.93, 0.82}, {1600, 1, 1, 1},
};
static const opacity cardiac_opacities[] = {
    {20, 0}, {80, 0.03}, {140, 0.14}, {220, 0.32}, {400, 0.52}, {1600, 0.75}};
static const opacity cardiac2_opacities[] = {
    {60, 0},     {110, 0.12}, {170, 0.30}, {260, 0.10},
    {450, 0.16}, {700, 0.55}, {1600, 0.75}};
static const opacity cardiac3_opacities[] = {
    {-20, 0}, {40, 0.10}, {110, 0.34}, {220, 0.55}, {1600, 0.90}};
static const opacity soft_edges[] = {{0, 0.35}, {15, 0.45}, {60, 1}};

static const color coronary_colors[] = {
    {90, 0.45, 0.16, 0.12},  {200, 0.86, 0.34, 0.22}, {320, 0.99, 0.70, 0.44},
    {480, 0.99, 0.90, 0.72}, {900, 1, 1, 0.96},
};
static const opacity coronary_opacities[] = {
    {130, 0}, {180, 0.08}, {260, 0.38}, {450, 0.68}, {1500, 0.90}};
static const opacity coronary2_opacities[] = {
    {30, 0}, {90, 0.03}, {150, 0.09}, {220, 0.40}, {450, 0.68}, {1500, 0.90}};
static const color coronary3_colors[] = {
    {80, 0.20, 0.24, 0.44},  {160, 0.62, 0.24, 0.34}, {260, 0.93, 0.40, 0.22},
    {380, 0.99, 0.76, 0.34}, {600, 1, 0.96, 0.80},    {1200, 1, 1, 1},
};
static const opacity coronary3_opacities[] = {
    {100, 0}, {170, 0.16}, {240, 0.55}, {400, 0.80}, {1500, 0.95}};

/* --- soft tissue, fat, lung ----------------------------------------------- */

/* Skin and organs, with bone visible through them. */
static const color soft_colors[] = {
    {-350, 0.78, 0.55, 0.45}, {-100, 0.93, 0.74, 0.58}, {10, 0.86, 0.52, 0.42},
    {80, 0.78, 0.38, 0.32},   {200, 0.90, 0.72, 0.60},  {500, 1, 0.97, 0.90},
};
static const opacity soft_opacities[] = {
    {-350, 0}, {-150, 0.12}, {0, 0.20}, {80, 0.35}, {500, 0.80}};

/* Skin as a surface; uniform regions inside are faint. */
static const opacity soft_tissue_opacities[] = {{-450, 0},    {-250, 0.25},
                                                {-120, 0.22}, {-20, 0.18},
                                                {60, 0.40},   {500, 0.85}};
static const opacity skin_edges[] = {{0, 0.12}, {20, 0.2}, {90, 1}};

/* Muscle is a band; fat is faint, and bone is visible behind. */
static const color muscle_colors[] = {
    {-100, 0.92, 0.80, 0.55}, {-10, 0.70, 0.32, 0.26}, {50, 0.72, 0.20, 0.16},
    {110, 0.86, 0.38, 0.30},  {250, 0.92, 0.82, 0.66}, {900, 1, 0.99, 0.95},
};
static const opacity muscle_opacities[] = {
    {-30, 0},    {15, 0.10},  {50, 0.38},  {100, 0.30},
    {160, 0.12}, {300, 0.40}, {1000, 0.80}};

static const color fat_colors[] = {
    {-220, 0.80, 0.62, 0.34}, {-100, 0.98, 0.86, 0.55}, {-40, 0.96, 0.78, 0.52},
    {150, 0.80, 0.60, 0.50},  {500, 1, 0.98, 0.92},
};
static const opacity fat_opacities[] = {{-200, 0},   {-140, 0.16}, {-100, 0.30},
                                        {-60, 0.14}, {-25, 0},     {200, 0},
                                        {500, 0.30}};

/* Lung tissue as a veil, its vessels and the walls of the airways solid; the
 * body around it is omitted. */
static const color lung_colors[] = {
    {-950, 0.35, 0.44, 0.62}, {-800, 0.58, 0.68, 0.84},
    {-600, 0.86, 0.80, 0.80}, {-400, 0.94, 0.66, 0.56},
    {-150, 0.86, 0.40, 0.34},
};
static const opacity lung_opacities[] = {
    {-930, 0},    {-820, 0.015}, {-700, 0.03}, {-560, 0.16},
    {-400, 0.24}, {-250, 0.06},  {-150, 0}};

/* A linear ramp, for maximum intensity projection; what it shows black is left
 * out of other pictures. */
static const color ct_mip_colors[] = {{-200, 0, 0, 0}, {900, 1, 1, 1}};
static const opacity ct_mip_opacities[] = {{50, 0}, {150, 0.05}, {900, 0.9}};

/* --- MR: over 0..1, from the end of the background to the brightest value ---
 */

static const color mr_colors[] = {
    {0, 0.45, 0.32, 0.28},
    {0.3, 0.72, 0.58, 0.50},
    {0.6, 0.92, 0.84, 0.76},
    {1, 1, 1, 1},
};
static const opacity mr_opacities[] = {
    {0, 0}, {0.12, 0.10}, {0.4, 0.25}, {1, 0.75}};

static const color angio_colors[] = {
    {0, 0.45, 0.08, 0.06},
    {0.35, 0.85, 0.22, 0.14},
    {0.7, 1, 0.62, 0.42},
    {1, 1, 0.95, 0.86},
};
static const opacity angio_opacities[] = {
    {0, 0}, {0.15, 0.15}, {0.45, 0.50}, {1, 0.85}};

static const color mr_mip_colors[] = {{0, 0, 0, 0}, {1, 1, 1, 1}};
static const opacity mr_mip_opacities[] = {{0, 0}, {0.25, 0.06}, {1, 0.9}};

/* Cerebrospinal fluid is bright, brain grey and pink, bone and air dark. */
static const color t2_colors[] = {
    {0, 0.30, 0.22, 0.22},    {0.25, 0.66, 0.50, 0.46}, {0.5, 0.86, 0.74, 0.68},
    {0.75, 0.70, 0.84, 0.96}, {1, 0.92, 0.97, 1},
};
static const opacity t2_opacities[] = {
    {0, 0}, {0.10, 0.02}, {0.30, 0.14}, {0.60, 0.28}, {1, 0.60}};

/* Fractional anisotropy: grey matter below 0.2, tracts above 0.3. */
static const color fa_colors[] = {
    {0.1, 0.16, 0.20, 0.45}, {0.25, 0.18, 0.48, 0.72}, {0.45, 0.36, 0.78, 0.55},
    {0.7, 0.96, 0.84, 0.32}, {1, 0.98, 0.36, 0.20},
};
static const opacity fa_opacities[] = {
    {0.12, 0}, {0.25, 0.06}, {0.45, 0.30}, {1, 0.75}};

static const color linear_colors[] = {{0, 0, 0, 0}, {1, 1, 1, 1}};
static const opacity linear_opacities[] = {{0, 0}, {1, 1}};

/* --- the table ------------------------------------------------------------ */

typedef struct preset_row {
    const char *name, *text;
    snow_look look;
} preset_row;

#define LOOK(word, spread, own_colors, own_opacities, edges, edge_count)   \
    {                                                                      \
        .size = sizeof(snow_look), .name = word, .domain = spread,         \
        .colors = own_colors, .color_count = COUNT(own_colors),            \
        .opacities = own_opacities, .opacity_count = COUNT(own_opacities), \
        .gradient_opacities = edges, .gradient_opacity_count = edge_count  \
    }
#define CT(name, text, word, colors, opacities) \
    { name, text, LOOK(word, SNOW_DOMAIN_DATA, colors, opacities, NULL, 0) }
#define EDGES(name, text, word, colors, opacities, edges)          \
    {                                                              \
        name, text,                                                \
            LOOK(word, SNOW_DOMAIN_DATA, colors, opacities, edges, \
                 COUNT(edges))                                     \
    }
#define SHARES(name, text, word, spread, colors, opacities) \
    { name, text, LOOK(word, spread, colors, opacities, NULL, 0) }

/* --- simulations ---------------------------------------------------------- */

/* The map cool-warm.  Nothing at 0; both signs alike. */
static const color signed_colors[] = {
    {0, 0.230, 0.299, 0.754},    {0.125, 0.384, 0.510, 0.918},
    {0.25, 0.555, 0.690, 0.996}, {0.375, 0.722, 0.816, 0.976},
    {0.5, 0.865, 0.865, 0.865},  {0.625, 0.957, 0.769, 0.678},
    {0.75, 0.957, 0.604, 0.482}, {0.875, 0.871, 0.376, 0.302},
    {1, 0.706, 0.016, 0.150},
};
static const opacity signed_opacities[] = {
    {0, 0.7},  {0.25, 0.12},  {0.38, 0.012}, {0.45, 0},
    {0.55, 0}, {0.62, 0.012}, {0.75, 0.12},  {1, 0.7}};

/* clang-format off */
static const preset_row presets[] = {
    SHARES("linear", "grey and opacity 0 to 1 over the range, as in the paper",
           "grey", SNOW_DOMAIN_RANGE, linear_colors, linear_opacities),
    CT("ct-aaa", "arteries with contrast: an aneurysm of the aorta", "blood",
       aaa_colors, aaa_opacities),
    CT("ct-aaa2", "arteries with contrast, organs as a veil", "blood", aaa2_colors,
       aaa2_opacities),
    CT("ct-bone", "bone of a CT in Hounsfield units", "bone", bone_colors,
       bone_opacities),
    CT("ct-bones", "bone with hard surfaces", "bone", bones_colors,
       bones_opacities),
    EDGES("ct-cardiac", "heart with contrast: walls and chambers", "heart",
          cardiac_colors, cardiac_opacities, soft_edges),
    CT("ct-cardiac2", "heart: walls, with faint chambers", "heart",
       cardiac_colors, cardiac2_opacities),
    CT("ct-cardiac3", "heart, solid from the outside", "heart",
       cardiac_colors, cardiac3_opacities),
    CT("ct-chest-contrast-enhanced", "chest with contrast: lungs as a veil",
       "chest", chest_colors, chest_opacities),
    CT("ct-chest-vessels", "vessels and bones of the chest", "vessels",
       vessel_colors, chest_vessels_opacities),
    CT("ct-coronary-arteries", "vessels of the heart with contrast", "vessels",
       coronary_colors, coronary_opacities),
    CT("ct-coronary-arteries-2", "vessels of the heart, muscle as a veil", "vessels",
       coronary_colors, coronary2_opacities),
    CT("ct-coronary-arteries-3", "vessels of the heart by colour", "vessels",
       coronary3_colors, coronary3_opacities),
    CT("ct-cropped-volume-bone", "cropped bone with its marrow", "bone",
       cropped_colors, cropped_opacities),
    CT("ct-fat", "fat, bone faint behind it", "fat", fat_colors,
       fat_opacities),
    CT("ct-liver-vasculature", "vessels of the liver with contrast", "liver",
       liver_colors, liver_opacities),
    CT("ct-lung", "lungs, airways and their vessels", "lung", lung_colors,
       lung_opacities),
    CT("ct-mip", "a grey ramp from fat to bone", "grey", ct_mip_colors,
       ct_mip_opacities),
    CT("ct-muscle", "muscle, bone behind it", "muscle", muscle_colors,
       muscle_opacities),
    CT("ct-pulmonary-arteries", "vessels of the lungs with contrast", "lung",
       pulmonary_colors, pulmonary_opacities),
    CT("ct-soft", "skin and soft tissue of a CT in Hounsfield units", "tissue",
       soft_colors, soft_opacities),
    EDGES("ct-soft-tissue", "skin and organs by their surfaces", "tissue",
          soft_colors, soft_tissue_opacities, skin_edges),
    SHARES("mr-angio", "bright vessels of an MR angiogram", "blood",
           SNOW_DOMAIN_OBJECT, angio_colors, angio_opacities),
    SHARES("mr-default", "MR with any scale, spread over the object's values",
           "warm", SNOW_DOMAIN_OBJECT, mr_colors, mr_opacities),
    SHARES("mr-mip", "a grey ramp over the object's values", "grey",
           SNOW_DOMAIN_OBJECT, mr_mip_colors, mr_mip_opacities),
    SHARES("mr-t2-brain", "brain in T2: fluid bright", "brain",
           SNOW_DOMAIN_OBJECT, t2_colors, t2_opacities),
    SHARES("dti-fa-brain", "fractional anisotropy: tracts", "tracts",
           SNOW_DOMAIN_RANGE, fa_colors, fa_opacities),
    SHARES("signed", "fields of both signs, symmetric around 0", "cool-warm",
           SNOW_DOMAIN_SYMMETRIC, signed_colors, signed_opacities),
    {"labels", "a colour for each whole number, as of a segmentation",
     {.size = sizeof(snow_look), .name = "labels"}},
};
/* clang-format on */

const char *snow_preset_name(size_t index) {
    return index < COUNT(presets) ? presets[index].name : NULL;
}

const char *snow_preset_description(size_t index) {
    return index < COUNT(presets) ? presets[index].text : NULL;
}

const snow_look *snow_preset_look(size_t index) {
    return index < COUNT(presets) ? &presets[index].look : NULL;
}

int snow_preset_from_name(const char *name) {
    for (size_t i = 0; i < COUNT(presets); i++)
        if (snow_same_name(name, presets[i].name))
            return (int)i;
    return -1;
}
