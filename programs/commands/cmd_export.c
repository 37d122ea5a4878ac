/* cmd_export.c - the verb export: a page with the viewer, its engine and a
 * volume in one file, which any browser shows without a server.
 *
 * The page is installed with the tool (wasm/).  The volume is added as NRRD, as
 * every reader's options are known here, packed by gzip, in base64. */
#ifndef _XOPEN_SOURCE
#define _XOPEN_SOURCE 700 /* mkdtemp, readlink */
#endif
#include "commands/commands.h"
#include "options/config.h"
#include "picture/outputs.h"
#include "run/log.h"

#include <limits.h>
#include <math.h>
#include <snowglass/overlay.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include <zlib.h>

/* What browsers hold as one text, and a page's memory. */
#define PACKED_MOST ((size_t)256 << 20)
#define VOXELS_MOST ((uint64_t)1 << 30)

/* Where the page lies, from the folder of the program: installed, built. */
static const char *const places[] = {"../share/snowglass/web/viewer.html",
                                     "../build-web/viewer.html"};

#define PLACE_COUNT (sizeof places / sizeof *places)

typedef struct page_text {
    char *bytes;
    size_t length, room;
    bool lost; /* no memory */
} page_text;

/* Makes room for `more` bytes and returns where they go; NULL: no memory. */
static char *extend(page_text *t, size_t more) {
    if (t->length + more > t->room) {
        size_t room = 2 * (t->length + more);
        char *grown = t->lost ? NULL : realloc(t->bytes, room);
        t->lost = !grown;
        if (!grown)
            return NULL;
        t->bytes = grown;
        t->room = room;
    }
    t->length += more;
    return t->bytes + t->length - more;
}

static void append(page_text *t, const void *bytes, size_t length) {
    char *to = extend(t, length);
    if (to && length)
        memcpy(to, bytes, length);
}

static void append_text(page_text *t, const char *value) {
    append(t, value, strlen(value));
}

/* As the value of an attribute. */
static void append_quoted(page_text *t, const char *value) {
    for (; *value; value++)
        if (*value == '&')
            append_text(t, "&amp;");
        else if (*value == '"')
            append_text(t, "&quot;");
        else
            append(t, value, 1);
}

static void append_base64(page_text *t, const unsigned char *bytes,
                          size_t length) {
    static const char letters[] =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    char *to = extend(t, (length + 2) / 3 * 4);
    for (size_t i = 0; to && i < length; i += 3, to += 4) {
        size_t left = length - i;
        unsigned group = (unsigned)bytes[i] << 16 |
                         (left > 1 ? (unsigned)bytes[i + 1] << 8 : 0) |
                         (left > 2 ? bytes[i + 2] : 0);
        for (int k = 0; k < 4; k++)
            to[k] = letters[group >> (18 - 6 * k) & 63];
        if (left < 3)
            to[3] = '=';
        if (left < 2)
            to[2] = '=';
    }
}

/* Appends all bytes of a file; whether that worked. */
static bool append_file(page_text *t, FILE *file) {
    size_t got;
    do {
        char *to = extend(t, BUFSIZ);
        got = to ? fread(to, 1, BUFSIZ, file) : 0;
        t->length -= to ? BUFSIZ - got : 0;
    } while (got);
    return !ferror(file) && !t->lost;
}

/* --- the page ------------------------------------------------------------- */

/* The page alone may read what its user names; one with a volume, which may be
 * of a person, can reach no machine: all policies of a page hold. */
static const char closed[] =
    "\n<meta http-equiv=\"content-security-policy\" content=\"connect-src "
    "'none'\">";

/* Puts the policy into the head of a page, if it has one. */
static bool close_page(page_text *t) {
    const size_t size = sizeof closed - 1;
    append(t, "", 1); /* the end for strstr */
    const char *head = t->lost ? NULL : strstr(t->bytes, "<head>");
    if (!head)
        return false;
    const size_t before = (size_t)(head - t->bytes) + strlen("<head>");
    const size_t rest = --t->length - before;
    if (!extend(t, size))
        return false;
    memmove(t->bytes + before + size, t->bytes + before, rest);
    memcpy(t->bytes + before, closed, size);
    return true;
}

static int read_page(page_text *out) {
    char path[PATH_MAX] = "viewer.html", self[PATH_MAX];
    ssize_t length = readlink("/proc/self/exe", self, sizeof self - 1);
    self[length > 0 ? length : 0] = 0;
    char *slash = strrchr(self, '/');
    FILE *page = NULL;
    for (size_t i = PLACE_COUNT; !page && slash && i > 0; i--) {
        snprintf(path, PATH_MAX, "%.*s/%s", (int)(slash - self), self,
                 places[i - 1]);
        page = fopen(path, "rb");
    }
    if (!page)
        return fail_usage("export: %s is missing; run ./dev web in the "
                          "sources, or install the package snowglass-web",
                          path);
    bool good = append_file(out, page);
    fclose(page);
    if (good && !close_page(out) && !out->lost)
        return fail_usage("%s: has no head, so that it is not the page; run "
                          "./dev web in the sources, or install the package "
                          "snowglass-web again",
                          path);
    return good && !out->lost ? CONTINUE
           : out->lost ? fail_memory("%s: out of memory for the page; close "
                                     "other programs",
                                     path)
                       : fail_usage("%s: cannot be read to its end; check the "
                                    "disk",
                                    path);
}

/* --- the volume ----------------------------------------------------------- */

static int refuse_size(const char *path, double bytes, double most,
                       const char *what) {
    return fail_memory("%s: has %.0f MiB of %s, and a page at most %.0f; take "
                       "a part of it with --crop, or fewer bits (snowglass "
                       "convert --as uint8)",
                       path, bytes / 0x1p20, what, most / 0x1p20);
}

/* NRRD has no slope and intercept: values become floats then. */
static int open_volume(snow_context *context, const options *opts,
                       snow_volume **out) {
    snow_volume_options data = data_options(opts);
    const char *path = opts->operands[0];
    snow_volume_info info = {.size = sizeof info};
    memset(data.clip, 0, sizeof data.clip); /* the page has handles for them */
    snow_status status = snow_volume_inspect(context, path, &data, &info);
    const bool scaled = info.slope != 1 || info.intercept != 0;
    const size_t size = snow_type_size(info.type);
    double bytes = (double)info.dims[0] * (double)info.dims[1] *
                   (double)info.dims[2] *
                   (double)(!scaled    ? size
                            : size > 2 ? 8
                                       : 4);
    if (status == SNOW_STATUS_OK && bytes > (double)VOXELS_MOST)
        return refuse_size(path, bytes, VOXELS_MOST, "voxels");
    if (status == SNOW_STATUS_OK)
        status = snow_volume_open(context, path, &data, out);
    if (status == SNOW_STATUS_OK && scaled) {
        snow_volume *made = NULL;
        status = snow_volume_convert(*out, SNOW_TYPE_NONE, NULL, &made);
        snow_volume_close(*out);
        *out = made;
    }
    return check_status(context, status);
}

/* Packs a file in base64. */
static int append_packed(page_text *out, FILE *file, const char *path) {
    page_text plain = {0}, packed = {0};
    z_stream z = {.zalloc = NULL};
    bool whole = append_file(&plain, file);
    bool good = whole && deflateInit2(&z, 9, Z_DEFLATED, 15 + 16, 9,
                                      Z_DEFAULT_STRATEGY) == Z_OK;
    if (good) {
        size_t most = deflateBound(&z, (uLong)plain.length);
        z.next_in = (Bytef *)plain.bytes;
        z.avail_in = (uInt)plain.length;
        z.next_out = (Bytef *)extend(&packed, most);
        z.avail_out = (uInt)most;
        good = z.next_out && deflate(&z, Z_FINISH) == Z_STREAM_END;
        packed.length = z.total_out;
        deflateEnd(&z);
    }
    free(plain.bytes);
    int done = !whole && !plain.lost
                   ? fail_output("%s: its voxels cannot be read again; check "
                                 "the disk of TMPDIR",
                                 path)
               : !good
                   ? fail_memory("%s: out of memory for the page; take a part "
                                 "of it with --crop",
                                 path)
               : packed.length > PACKED_MOST
                   ? refuse_size(path, (double)packed.length, PACKED_MOST,
                                 "packed voxels")
                   : CONTINUE;
    if (done == CONTINUE)
        append_base64(out, (unsigned char *)packed.bytes, packed.length);
    free(packed.bytes);
    return done;
}

/* As it is drawn: a page knows no axes of other units. */
static snow_status save_drawn(snow_context *context, const snow_volume *volume,
                              const char *path) {
    snow_volume_info info = *snow_volume_get_info(volume);
    snow_volume *drawn = NULL;
    bool plain = true;
    for (int i = 0; i < 3; i++) {
        plain = plain && !(fabs(info.axis_scale[i]) > 0);
        info.axis_scale[i] = 0;
    }
    if (plain)
        return snow_volume_save(volume, path, false);
    snow_status status =
        snow_volume_wrap(context, &info, snow_volume_voxels(volume), &drawn);
    if (status == SNOW_STATUS_OK)
        status = snow_volume_save(drawn, path, false);
    snow_volume_close(drawn);
    return status;
}

/* By way of a file, since volumes are written to files. */
static int append_volume(snow_context *context, const options *opts,
                         const snow_volume *volume, page_text *out) {
    const char *folder = getenv("TMPDIR");
    char place[PATH_MAX - 16], path[PATH_MAX];
    snprintf(place, sizeof place, "%s/snowglass-XXXXXX",
             folder && *folder ? folder : "/tmp");
    if (!mkdtemp(place))
        return fail_output(
            "%s: cannot be made; set TMPDIR to a folder that can "
            "be written",
            place);
    snprintf(path, sizeof path, "%s/volume.nrrd", place);
    snow_status status = save_drawn(context, volume, path);
    FILE *file = status == SNOW_STATUS_OK ? fopen(path, "rb") : NULL;
    unlink(path);
    rmdir(place);
    if (!file)
        return fail_status(context, status == SNOW_STATUS_OK
                                        ? SNOW_STATUS_BAD_OUTPUT
                                        : status);
    int done = append_packed(out, file, opts->operands[0]);
    fclose(file);
    return done;
}

/* A page's volume has no quantity: it stands in the legend. */
static void add_legend(const options *opts, const snow_volume_info *info,
                       json_t *tree) {
    const legend_value *legend = &opts->legend;
    const char *unit = *legend->unit      ? legend->unit
                       : info->hounsfield ? "HU"
                                          : info->value_unit;
    const char *name = *legend->name ? legend->name : info->quantity;
    if (*unit)
        json_object_set_new(tree, "legend",
                            json_sprintf("%s (%s)", name, unit));
    else if (*name)
        json_object_set_new(tree, "legend", json_string(name));
}

/* What the page begins with: all that is not done to the volume here, what NRRD
 * does not hold, and what a page may choose. */
static char *recipe_text(const options *opts, const snow_volume_info *info,
                         const char *tf) {
    static const char *const done[] = {
        "input",   "output",        "depth",      "verb",     "version",
        "quality", "bits",          "channel",    "dims",     "type",
        "endian",  "offset",        "time",       "dataset",  "spacing",
        "series",  "mask",          "labels",     "crop",     "overwrite",
        "memory",  "component",     "allow-gaps", "threads",  "isa",
        "method",  "deterministic", "tf",         "encoding", "label-table",
        "levels",  "z-scale",       "suv",        "vertical"};
    json_t *tree = config_tree(opts, verb_of(VERB_RENDER));
    for (size_t i = 0; i < sizeof done / sizeof *done; i++)
        json_object_del(tree, done[i]);
    if (opts->footprint)
        json_object_set_new(tree, "kernel", json_string(opts->kernel));
    if (tf)
        json_object_set_new(tree, "tf", json_string(tf));
    else if (opts->labels && !opts->mask && !opts->preset)
        json_object_set_new(tree, "preset", json_string("labels"));
    if (opts->legend.bar)
        add_legend(opts, info, tree);
    char time[256]; /* nor a time: it becomes part of the title */
    if (opts->annotate.time &&
        snow_time_text(info, opts->annotate.format, time, sizeof time)) {
        json_object_set_new(tree, "title",
                            json_sprintf("%.250s%s%s",
                                         opts->title ? opts->title : "",
                                         opts->title ? "\n" : "", time));
        json_object_del(tree, "annotate");
    }
    char *made = json_dumps(tree, JSON_COMPACT | JSON_FORM);
    json_decref(tree);
    return made;
}

/* "head.nii.gz" of /data/head.nii.gz, "head" of phantom:head, and "volume" of
 * many files. */
static const char *name_of(const char *path) {
    const char *base = path + folder_length(path);
    const char *colon = strrchr(base, ':');
    if (colon)
        base = colon + 1;
    return *base && !strpbrk(base, "%*?") ? base : "volume";
}

/* Begins a script of bytes, which shell.js looks for: behind the page's end,
 * from where browsers take it into the body. */
static void begin_script(page_text *page, const char *name,
                         const char *recipe) {
    append_text(page, "<script type=\"text/plain\" data-name=\"");
    append_quoted(page, name);
    append_text(page, "\" data-recipe=\"");
    append_quoted(page, recipe);
    append_text(page, "\">");
}

/* Appends the file of --tf. */
static int append_look(const options *opts, page_text *page) {
    page_text bytes = {0};
    FILE *file = fopen(opts->tf, "rb");
    bool good = file && append_file(&bytes, file);
    begin_script(page, name_of(opts->tf), "{}");
    append_base64(page, (unsigned char *)bytes.bytes, good ? bytes.length : 0);
    append_text(page, "</script>\n");
    if (file)
        fclose(file);
    free(bytes.bytes);
    return good ? CONTINUE : fail_usage("%s: cannot be read again", opts->tf);
}

static int make(snow_context *context, const options *opts,
                const snow_volume *volume, page_text *page) {
    const snow_volume_info *info = snow_volume_get_info(volume);
    /* The page is sent away; a patient's file may be called by a name. */
    const bool person = (info->medical || *info->modality) &&
                        strncmp(opts->operands[0], "phantom:", 8) != 0;
    char *recipe = recipe_text(opts, info, opts->tf ? name_of(opts->tf) : NULL);
    begin_script(page, person ? "volume" : name_of(opts->operands[0]),
                 recipe ? recipe : "{}");
    free(recipe);
    int done = append_volume(context, opts, volume, page);
    append_text(page, "</script>\n");
    if (done == CONTINUE && opts->tf)
        done = append_look(opts, page);
    return done == CONTINUE && page->lost
               ? fail_memory("out of memory for the page; take a part of the "
                             "volume with --crop")
               : done;
}

static int export_to(snow_context *context, const options *opts) {
    page_text page = {0};
    snow_volume *volume = NULL;
    int done = read_page(&page);
    if (done == CONTINUE)
        done = open_volume(context, opts, &volume);
    if (done == CONTINUE)
        done = make(context, opts, volume, &page);
    if (done == CONTINUE)
        done =
            write_text(page.bytes, page.length, opts->output, opts->overwrite);
    if (done == SNOW_STATUS_OK && opts->verbosity >= 0)
        say("%s: %.1f MiB; open it in any browser", opts->output,
            (double)page.length / 0x1p20);
    snow_volume_close(volume);
    free(page.bytes);
    return done;
}

void export_take(options *opts) {
    opts->output = opts->operands[0];
    opts->operands++;
    opts->operand_count--;
}

int cmd_export(const options *opts) {
    static options checked; /* large */
    snow_context *context = NULL;
    int done = check_stats_path(opts->output, opts->overwrite);
    checked = *opts;
    checked.output = "-"; /* a picture of levels */
    if (done == CONTINUE)
        done = check_settings(&checked);
    if (done == CONTINUE)
        done = open_context(opts, &context);
    if (done == CONTINUE)
        done = export_to(context, opts);
    snow_context_free(context);
    return done;
}
