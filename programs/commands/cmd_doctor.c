/* cmd_doctor.c - the verb doctor: what this build and this machine can do.  The
 * names come from the library's own lists, so the answer stays up to date. */
#include "commands/commands.h"
#include "movie/movie_encoder.h"
#include "run/log.h"
#include "run/start.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

static const char *encoding_at(size_t i) {
    return i < 3 ? snow_encoding_name((snow_encoding)(i + SNOW_ENCODING_CRS))
                 : NULL;
}

static const char *kernel_at(size_t i) {
    return i < 5 ? snow_kernel_name((snow_kernel)(i + SNOW_KERNEL_BSPLINE))
                 : NULL;
}

static const char *method_at(size_t i) {
    return snow_method_name((snow_method)(i + SNOW_METHOD_ORIGINAL));
}

static const char *mode_at(size_t i) {
    return snow_mode_name((snow_mode)i);
}

/* The picture formats that this build can write. */
static const char *picture_suffix_at(size_t i) {
    const char *suffix;
    bool built;
    for (size_t n = 0; (suffix = snow_image_format_suffix(n, &built)); n++)
        if (built && i-- == 0)
            return suffix;
    return NULL;
}

static bool writes_webp(void) {
    const char *suffix;
    for (size_t i = 0; (suffix = picture_suffix_at(i)); i++)
        if (strcmp(suffix, ".webp") == 0)
            return true;
    return false;
}

/* Each key is a key of the JSON object and the first word of a line. */
static const struct {
    const char *key;
    const char *(*at)(size_t index);
} lists[] = {
    {"formats", snow_format_name},
    {"phantoms", snow_phantom_name},
    {"presets", snow_preset_name},
    {"colormaps", snow_colormap_name},
    {"views", snow_view_name},
    {"kernels", kernel_at},
    {"encodings", encoding_at},
    {"methods", method_at},
    {"modes", mode_at},
    {"volume_outputs", snow_volume_format_suffix},
    {"picture_outputs", picture_suffix_at},
};

#define LISTS (sizeof lists / sizeof *lists)

/* The memory of the machine or the limit of the control group, in bytes,
 * whichever is smaller; 0 if neither is known. */
static uint64_t memory_bytes(void) {
    uint64_t limit = 0;
    long pages = sysconf(_SC_PHYS_PAGES), page = sysconf(_SC_PAGESIZE);
    if (pages > 0 && page > 0)
        limit = (uint64_t)pages * (uint64_t)page;
    FILE *file = fopen("/sys/fs/cgroup/memory.max", "r");
    char text[32] = "";
    uint64_t group;
    if (file && fgets(text, sizeof text, file)) {
        text[strcspn(text, "\n")] = '\0';
        if (value_count(text, &group) && (limit == 0 || group < limit))
            limit = group;
    }
    if (file)
        fclose(file);
    return limit;
}

/* Turns "a b c" into a list. */
static json_t *words_json(const char *words) {
    json_t *list = json_array();
    while (*words) {
        size_t length = strcspn(words, " ");
        json_array_append_new(list, json_stringn(words, length));
        words += length + (words[length] == ' ');
    }
    return list;
}

/* The versions of the optional libraries; null for a library that is
 * missing. */
static json_t *libraries_json(void) {
    json_t *object = json_object();
    const char *name, *version, *formats;
    for (size_t i = 0; (name = snow_library_name(i, &version, &formats)); i++)
        json_object_set_new(object, name,
                            version ? json_string(version) : json_null());
    return object;
}

/* Features that are missing are listed too, as false or 1, so that a script
 * need not change when they arrive. */
static json_t *doctor_json(void) {
    json_t *o = json_object();
    json_object_set_new(o, "version", json_string(snow_version()));
    for (size_t i = 0; i < LISTS; i++)
        json_object_set_new(o, lists[i].key, json_names(lists[i].at));
    json_object_set_new(o, "ffmpeg", json_boolean(encoder_is_there()));
    json_object_set_new(o, "libraries", libraries_json());
    json_object_set_new(o, "isa_found", words_json(snow_isa_found()));
    json_object_set_new(o, "isa", json_string(snow_isa_used()));
    json_object_set_new(o, "threads", json_integer(process_processors()));
    json_object_set_new(
        o, "mpi", process_mpi() ? json_string(process_mpi()) : json_false());
    json_object_set_new(o, "ranks", json_integer(process_ranks()));
    json_object_set_new(o, "display", json_false());
    json_object_set_new(o, "memory_bytes",
                        json_integer((json_int_t)memory_bytes()));
    json_object_set_new(o, "jansson", json_string(jansson_version_str()));
    return o;
}

void doctor_write(FILE *out) {
    json_t *object = doctor_json();
    if (json_dumpf(object, out, JSON_FORM) == 0)
        putc('\n', out);
    json_decref(object);
}

static void print_row(const char *key, const char *text) {
    printf("%-16s%s\n", key, text);
}

/* The key of the JSON object, with its underscores as spaces. */
static void print_list(const char *key, const char *(*at)(size_t)) {
    char words[17] = "";
    for (size_t i = 0; i < sizeof words - 1 && key[i]; i++)
        words[i] = key[i] == '_' ? ' ' : key[i];
    printf("%-16s", words);
    for (size_t i = 0; at(i); i++)
        printf("%s%s", i ? " " : "", at(i));
    printf("\n");
}

static int report_text(void) {
    print_row("version", snow_version());
    for (size_t i = 0; i < LISTS; i++)
        print_list(lists[i].key, lists[i].at);
    printf("%-16s%s%s%s\n", "movie outputs", writes_webp() ? ".webp" : "",
           encoder_is_there() && writes_webp() ? " " : "",
           encoder_is_there() ? ".mp4 .webm .gif (with ffmpeg)"
           : writes_webp()
               ? "; other movies as frames only: ffmpeg was not found"
               : "frames only: ffmpeg was not found");
    const char *name, *version, *formats;
    for (size_t i = 0; (name = snow_library_name(i, &version, &formats)); i++)
        printf("%-16s%s %s (%s)\n", i ? "" : "libraries", name,
               version ? version : "is missing", formats);
    printf("%-16sfound %s; used %s\n", "isa", snow_isa_found(),
           snow_isa_used());
    printf("%-16s%d\n", "threads", process_processors());
    if (process_mpi())
        printf("%-16s%s, %d rank%s\n", "mpi", process_mpi(), process_ranks(),
               process_ranks() > 1 ? "s" : "");
    else
        print_row("mpi", "no; use snowglass-mpi");
    print_row("display", "not needed");
    printf("%-16s%.1f GiB\n", "memory",
           (double)memory_bytes() / (double)(1 << 30));
    print_row("jansson", jansson_version_str());
    return finish_stdout();
}

/* Needs no context, no file and hardly any memory, so it works where nothing
 * else does. */
int cmd_doctor(const options *opts) {
    return opts->json ? print_json(doctor_json()) : report_text();
}
