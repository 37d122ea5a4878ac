/* bench/speed/speed_volumes.c - the volumes whose pictures are timed, and their
 * two looks: translucent, where every voxel counts, and opaque, where most of
 * them are hidden. */
#include "speed.h"

#include <stdio.h>
#include <string.h>

#define CUBIC_DIMS(n)                                            \
    {                                                            \
        .size = sizeof(snow_volume_options), .dims = { n, n, n } \
    }

/* The paper's volumes, two very different 256^3 ones of a public collection,
 * and phantoms: hollow (cube), in thin layers (shells), and of 512^3, which
 * take minutes each. */
static const struct {
    const char *word; /* of --volumes */
    bool large;
    bench_source source; /* a phantom NULL: only with --data */
    int table_set;       /* bench_set whose source it is, else -1 */
} volumes[] = {
    {"engine",
     false,
     {NULL, NULL, NULL, {.size = sizeof(snow_volume_options)}},
     BENCH_ENGINE},
    {"head",
     false,
     {NULL, NULL, NULL, {.size = sizeof(snow_volume_options)}},
     BENCH_HEAD},
    {"aneurism",
     false,
     {"Aneurism",
      NULL,
      "classic/aneurism.vti",
      {.size = sizeof(snow_volume_options)}},
     -1},
    {"bonsai",
     false,
     {"Bonsai",
      NULL,
      "classic/bonsai.vti",
      {.size = sizeof(snow_volume_options)}},
     -1},
    {"cube",
     false,
     {"Cube",
      "phantom:cube",
      NULL,
      {.size = sizeof(snow_volume_options), .dims = {256, 256, 110}}},
     -1},
    {"shells", false, {"Shells", "phantom:shells", NULL, CUBIC_DIMS(256)}, -1},
    {"cube512", true, {"Cube", "phantom:cube", NULL, CUBIC_DIMS(512)}, -1},
    {"engine512",
     true,
     {"Engine", "phantom:engine", NULL, CUBIC_DIMS(512)},
     -1},
    {"head512", true, {"Head", "phantom:head", NULL, CUBIC_DIMS(512)}, -1},
};

#define VOLUMES (int)(sizeof volumes / sizeof volumes[0])

/* --quick is for tests: a phantom that small is drawn in a moment. */
static const bench_source quick_source = {
    "Engine",
    "phantom:engine",
    NULL,
    {.size = sizeof(snow_volume_options), .dims = {40, 40, 32}}};

const bench_source *speed_source(const bench_options *options, int index) {
    if (options->quick)
        return index == 0 ? &quick_source : NULL;
    if (index >= VOLUMES)
        return NULL;
    int set = volumes[index].table_set;
    return set < 0 ? &volumes[index].source : bench_source_of((bench_set)set);
}

/* Whether a word stands in a list with commas. */
static bool lists(const char *list, const char *word) {
    size_t length = strlen(word);
    while (list) {
        size_t this = strcspn(list, ",");
        if (this == length && strncmp(list, word, length) == 0)
            return true;
        list = list[this] ? list + this + 1 : NULL;
    }
    return false;
}

bool speed_source_taken(const bench_options *options, int index) {
    const bench_source *source = speed_source(options, index);
    bool here = source->phantom || options->data;
    if (options->quick)
        return true;
    if (options->volumes)
        return lists(options->volumes, volumes[index].word);
    return here && (!volumes[index].large || options->large);
}

static int volume_named(const char *word, size_t length) {
    for (int i = 0; i < VOLUMES; i++)
        if (strlen(volumes[i].word) == length &&
            strncmp(volumes[i].word, word, length) == 0)
            return i;
    return -1;
}

bool speed_volumes_known(const bench_options *options) {
    const char *list = options->volumes;
    while (list) {
        size_t length = strcspn(list, ",");
        int index = volume_named(list, length);
        if (index < 0) {
            fprintf(stderr,
                    "snowglass: bench: there is no volume '%.*s'; choose "
                    "from:",
                    (int)length, list);
            for (int i = 0; i < VOLUMES; i++)
                fprintf(stderr, " %s", volumes[i].word);
            fprintf(stderr, "\n");
            return false;
        }
        const bench_source *source = speed_source(options, index);
        if (source && !source->phantom && !options->data) {
            fprintf(stderr,
                    "snowglass: bench: %s is a file; give --data DIR with %s\n",
                    volumes[index].word, source->file);
            return false;
        }
        list = list[length] ? list + length + 1 : NULL;
    }
    return true;
}

double speed_slope(speed_look look) {
    return look == SPEED_OPAQUE ? 2 / 255.0 : 0.2 / 255;
}

/* Translucent: opacity 0.2 v / 255.  Opaque: min(1, 2 v / 255).  In colour from
 * blue over amber to white, so that no two channels are alike. */
snow_status speed_dress(snow_context *context, bench_volume *volume,
                        speed_look look, bool color) {
    static const snow_color_point grey[] = {{0, 0, 0, 0}, {255, 1, 1, 1}};
    static const snow_color_point hues[] = {
        {0, 0.1, 0.2, 0.6}, {110, 0.9, 0.6, 0.2}, {255, 1, 0.95, 0.9}};
    static const snow_opacity_point translucent[] = {{0, 0}, {255, 0.2}};
    static const snow_opacity_point opaque[] = {{0, 0}, {127.5, 1}};
    snow_transfer_free(volume->transfer);
    volume->transfer = NULL;
    return snow_transfer_new(context, color ? hues : grey, color ? 3 : 2,
                             look == SPEED_OPAQUE ? opaque : translucent, 2,
                             &volume->transfer);
}
