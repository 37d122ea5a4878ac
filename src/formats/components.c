/* formats/components.c - voxels with several values: one of them, or the
 * magnitude of all.
 *
 * Readers give one component at a time.  The magnitude takes as many readings,
 * with two volumes in memory at once. */
#include "formats/array.h"
#include "formats/opening.h"
#include "volume/mask.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define MAGNITUDE "magnitude"

/* Voxels that are converted at once. */
#define RUN ((int64_t)1024)

/* The number of a component, of which "|x|" is the absolute value; -1 for the
 * magnitude and for other texts. */
static int64_t number_of(const char *text, bool *absolute) {
    static const char letters[] = "xyzw";
    char name[24];
    int64_t number;
    const size_t length = strlen(text);
    *absolute = length > 2 && length < sizeof name && *text == '|' &&
                text[length - 1] == '|';
    snprintf(name, sizeof name, "%.*s", *absolute ? (int)length - 2 : 23,
             text + *absolute);
    if (length >= sizeof name)
        return -1;
    const char *at = *name && !name[1] ? strchr(letters, *name) : NULL;
    if (at)
        return at - letters;
    return snow_parse_int64(name, &number) && number >= 0 ? number : -1;
}

snow_status snow_component_check(snow_context *context, bool named,
                                 const snow_volume_options *options) {
    const char *text = options->component;
    bool absolute;
    if (text && !named && strcmp(text, MAGNITUDE) != 0 &&
        number_of(text, &absolute) < 0)
        return snow_fail(context, SNOW_STATUS_BAD_USAGE,
                         "--component %.64s: not a component; give x, y, z, w, "
                         "a number from 0, or magnitude",
                         text);
    if (text && options->channel)
        return snow_fail(context, SNOW_STATUS_BAD_USAGE,
                         "give either --component or --channel, which name the "
                         "same");
    return SNOW_STATUS_OK;
}

static snow_status refuse_magnitude(snow_context *context, int64_t count) {
    if (count == 1)
        return snow_fail(context, SNOW_STATUS_BAD_USAGE,
                         "--component " MAGNITUDE ": the voxels have one "
                         "value; remove the option");
    return snow_fail(context, SNOW_STATUS_BAD_USAGE,
                     "--component " MAGNITUDE ": the %lld values of a voxel "
                     "are channels, not components of a vector; give a number",
                     (long long)count);
}

void snow_copy_name(const char *text, char *out, size_t size) {
    size_t used = 0, count;
    for (; *text; text += count) {
        bool control;
        count = snow_letter_bytes(text, &control);
        const bool good = count && !control;
        count = count ? count : 1;
        if (used + (good ? count : 1) >= size)
            break;
        memcpy(out + used, good ? text : "?", good ? count : 1);
        used += good ? count : 1;
    }
    out[used] = 0;
}

void snow_channels_begin(snow_volume_info *info, int64_t count, bool shown) {
    info->channels = count;
    info->light = 0;
    for (int64_t n = 0; n < SNOW_CHANNELS_MAX; n++)
        info->channel[n] = (snow_channel){.color = {-1, -1, -1},
                                          .shown = n < count && (shown || !n)};
}

/* More are no stains but a spectrum, or times. */
#define MOST_STAINS 16

void snow_channels_are_light(snow_volume_info *info, uint64_t through) {
    bool any = false;
    if (info->channels < 2 || info->channels > MOST_STAINS)
        return;
    info->light = ((UINT64_C(1) << info->channels) - 1) & ~through;
    for (int n = 0; n < SNOW_CHANNELS_MAX && n < info->channels; n++)
        any |= info->light >> n & 1 && info->channel[n].shown;
    for (int n = 0; n < SNOW_CHANNELS_MAX && n < info->channels; n++)
        info->channel[n].shown &= any ? info->light >> n & 1 : !n;
}

/* Levels are those of a screen: 0 to the largest, of floats 1. */
void snow_channels_are_colors(snow_volume_info *info) {
    const size_t bits = 8 * snow_type_size(info->type);
    const bool floats = info->type >= SNOW_TYPE_FLOAT32;
    const double most = floats ? 1 : ldexp(1, bits < 16 ? 8 : 16) - 1;
    static const char *const names[] = {"red", "green", "blue", "opacity"};
    for (int n = 0; n < 4; n++) {
        snow_channel *one = &info->channel[n];
        *one = (snow_channel){.window = {0, most},
                              .color = {n == 0, n == 1, n == 2},
                              .shown = n < 3,
                              .own = n < 3};
        memcpy(one->name, names[n], strlen(names[n]) + 1);
    }
}

/* White everywhere says nothing, nor does a window that is the type's. */
static void drop_empty_words(snow_volume_info *info) {
    const int64_t count =
        info->channels < SNOW_CHANNELS_MAX ? info->channels : SNOW_CHANNELS_MAX;
    const double most = ldexp(1, 8 * (int)snow_type_size(info->type)) - 1;
    bool white = count > 1;
    for (int64_t n = 0; n < count; n++) {
        snow_channel *one = &info->channel[n];
        white = white &&
                fmin(one->color[0], fmin(one->color[1], one->color[2])) >= 1;
        if (!one->own && info->type < SNOW_TYPE_FLOAT32 &&
            one->window[0] <= 0 && one->window[1] >= most)
            memset(one->window, 0, sizeof one->window);
    }
    for (int64_t n = 0; n < count && white; n++)
        info->channel[n].color[0] = -1;
}

snow_status snow_volume_pick_channel(snow_context *context,
                                     const snow_volume_options *options,
                                     int64_t channels, snow_volume_info *info,
                                     int64_t *out) {
    const char *text = options->component;
    const char *what = text && strcmp(text, "0") != 0 ? "component" : "channel";
    bool absolute;
    if (text && !strcmp(text, MAGNITUDE))
        return refuse_magnitude(context, channels);
    *out = text ? number_of(text, &absolute) : options->channel;
    if (!info->channels)
        snow_channels_begin(info, channels, false);
    drop_empty_words(info);
    if (*out < 0 || *out >= channels)
        return snow_fail(
            context, SNOW_STATUS_BAD_USAGE,
            "%s %lld does not exist; the voxels have %lld, counted from 0",
            what, (long long)*out, (long long)channels);
    if (channels > 1 && !text && !options->channel && !options->channel_given &&
        !options->each_channel)
        snow_notify(context,
                    "channel 0 of %lld (counted from 0) is used; --channel N "
                    "selects another",
                    (long long)channels);
    return SNOW_STATUS_OK;
}

snow_status snow_volume_pick_component(snow_context *context,
                                       const snow_volume_options *options,
                                       int64_t count, snow_volume_info *info,
                                       int64_t *out) {
    const bool floats =
        info->type == SNOW_TYPE_FLOAT32 || info->type == SNOW_TYPE_FLOAT64;
    info->directions = info->directions && floats && count == 3;
    /* Three or four bytes are a colour, as napari and ParaView take them. */
    if (info->type == SNOW_TYPE_UINT8 && (count == 3 || count == 4) &&
        !options->component)
        return snow_volume_pick_value(context, options, count, true, info, out);
    info->components = count;
    bool named = options->component && !strcmp(options->component, MAGNITUDE);
    if (named && count < 2)
        return refuse_magnitude(context, count);
    bool usual =
        !options->component && !options->channel && !options->channel_given;
    /* Vectors are shown by their length, as ParaView does. Four components may
     * be anything, and whole numbers are most often colours. */
    info->magnitude = named || (usual && floats && (count == 2 || count == 3));
    if (!info->magnitude)
        return snow_volume_pick_channel(context, options, count, info, out);
    *out = 0;
    return SNOW_STATUS_OK;
}

snow_status snow_volume_pick_value(snow_context *context,
                                   const snow_volume_options *options,
                                   int64_t count, bool colors,
                                   snow_volume_info *info, int64_t *out) {
    if (count > 1 && !colors)
        return snow_volume_pick_component(context, options, count, info, out);
    if (count > 1) {
        snow_channels_begin(info, count, false);
        snow_channels_are_colors(info);
    }
    return snow_volume_pick_channel(context, options, count, info, out);
}

snow_status snow_volume_pick_axes(snow_context *context,
                                  const snow_volume_options *options,
                                  const snow_axes *roles, const int64_t *sizes,
                                  snow_volume_info *info, int64_t *channel) {
    const int c = roles->channel, t = roles->time;
    for (int i = 0; i < 3; i++)
        info->dims[i] = roles->space[i] < 0 ? 1 : sizes[roles->space[i]];
    info->times = t < 0 ? 1 : sizes[t];
    SNOW_TRY(roles->interleaved
                 ? snow_volume_pick_component(context, options, sizes[c], info,
                                              channel)
                 : snow_volume_pick_channel(
                       context, options, c < 0 ? 1 : sizes[c], info, channel));
    return snow_volume_pick_time(context, "time step", options, info);
}

/* --- the magnitude -------------------------------------------------------- */

/* Squares of floats cannot overflow in double precision; those of doubles
 * can. */
static double longer(double length, double value, snow_type type) {
    return type == SNOW_TYPE_FLOAT32 ? sqrt(length * length + value * value)
                                     : hypot(length, value);
}

/* Adds a component to the lengths so far.  Of the first one those are its own
 * absolute values, which may take its place. */
static void add_component(const snow_volume *from, bool first,
                          snow_volume *to) {
    const snow_volume_info *info = &from->info;
    const snow_type type = to->info.type;
    int64_t all = info->dims[0] * info->dims[1] * info->dims[2];
    double values[RUN];
    for (int64_t begin = 0; begin < all; begin += RUN) {
        int64_t count = all - begin < RUN ? all - begin : RUN;
        snow_volume_stored(from, begin, (size_t)count, values);
        for (int64_t i = 0; i < count; i++) {
            double value = info->slope * values[i] + info->intercept;
            if (type == SNOW_TYPE_FLOAT32) {
                float *at = (float *)to->owned + begin + i;
                *at = (float)longer(first ? 0 : (double)*at, value, type);
            } else {
                double *at = (double *)to->owned + begin + i;
                *at = longer(first ? 0 : *at, value, type);
            }
        }
    }
}

/* The magnitude has a type of its own. */
static void describe(snow_volume_info *info) {
    info->type = snow_masked_type(info->type);
    info->slope = 1;
    info->intercept = 0;
}

/* Replaces the first component by its absolute values. */
static snow_status begin_lengths(snow_context *context, snow_volume **volume) {
    snow_volume *first = *volume, *made = first;
    snow_volume_info info = first->info;
    describe(&info);
    if (info.type != first->info.type)
        SNOW_TRY(snow_volume_new(context, &info, &made));
    add_component(first, true, made);
    made->info = info;
    if (made != first)
        snow_volume_close(first);
    *volume = made;
    return SNOW_STATUS_OK;
}

static snow_status add_next(snow_context *context, snow_component_fn *read,
                            void *user, const snow_volume_options *options,
                            int64_t number, snow_volume *sum) {
    char text[24];
    snow_volume_options own = *options;
    snow_volume_info info;
    snow_volume *next = NULL;
    snprintf(text, sizeof text, "%lld", (long long)number);
    own.component = text;
    SNOW_TRY(read(user, &own, &info, &next));
    snow_status status = SNOW_STATUS_OK;
    if (memcmp(next->info.dims, sum->info.dims, sizeof sum->info.dims) != 0)
        status = snow_fail(context, SNOW_STATUS_BAD_INPUT,
                           "changed while it was read; try again");
    else
        add_component(next, false, sum);
    snow_volume_close(next);
    return status;
}

/* Warnings of the first reading hold for all. */
static snow_status add_others(snow_context *context, snow_component_fn *read,
                              void *user, const snow_volume_options *options,
                              int64_t count, snow_volume **volume) {
    SNOW_TRY(begin_lengths(context, volume));
    snow_warning_fn *warning = context->warning;
    snow_status status = SNOW_STATUS_OK;
    context->warning = NULL;
    for (int64_t i = 1; i < count && status == SNOW_STATUS_OK; i++)
        status = add_next(context, read, user, options, i, *volume);
    context->warning = warning;
    return status;
}

/* An input that is gone shows what was read of it. */
static snow_status keep_first(snow_context *context,
                              const snow_volume_options *options,
                              snow_volume_info *info) {
    if (options->component)
        return snow_fail(context, SNOW_STATUS_BAD_USAGE,
                         "--component " MAGNITUDE ": the input is read once "
                         "for each component; write it to a file");
    snow_notify(context,
                "component 0 of %lld is used, as the input cannot be read "
                "again for the magnitude; --component N selects another",
                (long long)info->components);
    info->magnitude = false;
    return SNOW_STATUS_OK;
}

/* --- "u,v,w" ---------------------------------------------------------------
 */

/* One of the names, as a component that has it or as a data set. */
static snow_volume_options options_of(const snow_volume_options *options,
                                      const char *name, bool set) {
    snow_volume_options own = *options;
    own.component = set ? NULL : name;
    own.dataset = set ? name : options->dataset;
    return own;
}

/* Whether the names are those of data sets: where the first one is no
 * component. */
static snow_status find_kind(snow_context *context, snow_component_fn *read,
                             void *user, const snow_volume_options *options,
                             const char *name, bool *set) {
    static const char alone[] = "have a single data set";
    char message[sizeof context->message];
    snow_warning_fn *warning = context->warning;
    snow_volume_info info;
    context->warning = NULL;
    *set = false;
    snow_volume_options own = options_of(options, name, false);
    snow_status status = read(user, &own, &info, NULL);
    if (status != SNOW_STATUS_OK && !options->dataset) {
        memcpy(message, context->message, sizeof message);
        *set = true;
        own = options_of(options, name, true);
        status = read(user, &own, &info, NULL);
        if (status != SNOW_STATUS_OK && strstr(context->message, alone))
            memcpy(context->message, message, sizeof message);
    }
    context->warning = warning;
    return status;
}

/* Adds the volume of a name to the lengths so far, of which there are none at
 * number 0.  `sum` is NULL where only the sizes are checked. */
static snow_status add_named(snow_context *context, snow_component_fn *read,
                             void *user, const snow_volume_options *options,
                             int64_t number, snow_volume_info *info,
                             snow_volume **sum) {
    snow_volume_info own;
    snow_volume *next = NULL;
    SNOW_TRY(snow_components_read(context, read, user, false, options, &own,
                                  sum ? &next : NULL));
    snow_status status = SNOW_STATUS_OK;
    if (!number)
        *info = own;
    else if (memcmp(own.dims, info->dims, sizeof own.dims) != 0)
        status = snow_fail(context, SNOW_STATUS_BAD_USAGE,
                           "--component: its volumes have different sizes; "
                           "give some of one size");
    if (sum && !number) {
        *sum = next;
        return begin_lengths(context, sum);
    }
    if (sum && status == SNOW_STATUS_OK)
        add_component(next, false, *sum);
    snow_volume_close(next);
    return status;
}

/* The magnitude of volumes that are the components of one vector.  Warnings of
 * the first hold for all. */
static snow_status read_list(snow_context *context, snow_component_fn *read,
                             void *user, const snow_volume_options *options,
                             snow_volume_info *info, snow_volume **out) {
    char name[256];
    const char *at = options->component;
    snow_warning_fn *warning = context->warning;
    snow_status status = SNOW_STATUS_OK;
    bool set = false;
    int64_t count = 0;
    for (; at && status == SNOW_STATUS_OK; count++) {
        const size_t length = strcspn(at, ",");
        snprintf(name, sizeof name, "%.*s",
                 (int)(length < sizeof name ? length : 0), at);
        at = at[length] ? at + length + 1 : NULL;
        if (!*name)
            status = snow_fail(context, SNOW_STATUS_BAD_USAGE,
                               "--component %.200s: give names with commas "
                               "between them, as in u,v,w",
                               options->component);
        else if (!count)
            status = find_kind(context, read, user, options, name, &set);
        const snow_volume_options own = options_of(options, name, set);
        if (status == SNOW_STATUS_OK)
            status = add_named(context, read, user, &own, count, info, out);
        context->warning = NULL;
    }
    context->warning = warning;
    if (status != SNOW_STATUS_OK)
        return status;
    describe(info);
    info->magnitude = true;
    info->components = count;
    info->description[0] = 0;
    snprintf(info->quantity, sizeof info->quantity, "%.63s",
             options->component);
    return SNOW_STATUS_OK;
}

/* Reads the volume that the options ask for, and its other components. */
static snow_status read_vector(snow_context *context, snow_component_fn *read,
                               void *user, bool once,
                               const snow_volume_options *options,
                               snow_volume_info *info, snow_volume **volume) {
    snow_volume_options own = *options;
    char name[24];
    bool absolute = false;
    if (own.component)
        snprintf(name, sizeof name, "%lld",
                 (long long)number_of(own.component, &absolute));
    if (absolute)
        own.component = name;
    SNOW_TRY(read(user, &own, info, volume));
    if (absolute && volume)
        SNOW_TRY(begin_lengths(context, volume));
    if (absolute)
        describe(info);
    if (info->magnitude && once)
        SNOW_TRY(keep_first(context, options, info));
    if (!info->magnitude)
        return SNOW_STATUS_OK;
    if (!options->component && !options->each_time)
        snow_notify(context,
                    "the magnitude of the %lld components is used; "
                    "--component N selects one (from 0, or x, y, z)",
                    (long long)info->components);
    if (volume)
        SNOW_TRY(
            add_others(context, read, user, options, info->components, volume));
    describe(info);
    return SNOW_STATUS_OK;
}

snow_status snow_components_read(snow_context *context, snow_component_fn *read,
                                 void *user, bool once,
                                 const snow_volume_options *options,
                                 snow_volume_info *info, snow_volume **out) {
    snow_volume *volume = NULL, **wanted = out ? &volume : NULL;
    const bool list = options->component && strchr(options->component, ',');
    snow_status status =
        list && once ? snow_fail(context, SNOW_STATUS_BAD_USAGE,
                                 "--component %.200s: the input is read once "
                                 "for each of them; write it to a file",
                                 options->component)
        : list       ? read_list(context, read, user, options, info, wanted)
               : read_vector(context, read, user, once, options, info, wanted);
    if (status == SNOW_STATUS_OK && volume)
        volume->info = *info;
    return snow_volume_give(status, volume, out);
}
