/* cmd_tf.c - the verb tf: lists, shows and converts transfer functions without
 * a volume. */
#include "commands/commands.h"
#include "picture/outputs.h"
#include "run/interrupt.h"
#include "run/log.h"
#include "run/paths.h"

#include <assert.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* --- list ----------------------------------------------------------------- */

static int list(const options *opts) {
    if (opts->json) {
        json_t *o = json_object();
        json_object_set_new(o, "presets", json_names(snow_preset_name));
        json_object_set_new(o, "colormaps", json_names(snow_colormap_name));
        return print_json(o);
    }
    printf("presets (--preset NAME):\n");
    for (size_t i = 0; snow_preset_name(i); i++)
        printf("  %-27s %s\n", snow_preset_name(i), snow_preset_description(i));
    printf("colour maps (--colormap NAME):\n");
    for (size_t i = 0; snow_colormap_name(i); i++)
        printf("  %s\n", snow_colormap_name(i));
    return finish_stdout();
}

/* --- finding one by name -------------------------------------------------- */

/* A transfer function that was found by name: a file, a preset or a colour
 * map. */
typedef struct named {
    snow_context *context;
    snow_look_file *tf;
    const char *kind;
    snow_look look;
    snow_color_point colors[SNOW_COLORMAP_POINTS_MAX];
} named;

static void take_colormap(int index, const char *name, named *out) {
    out->kind = "colour map";
    out->look = (snow_look){
        .size = sizeof(snow_look), .name = name, .domain = SNOW_DOMAIN_RANGE};
    out->look.color_count = snow_colormap_points((size_t)index, out->colors,
                                                 SNOW_COLORMAP_POINTS_MAX);
    out->look.colors = out->colors;
}

/* A file has priority over a preset of the same name. */
static int find_transfer(const options *opts, const char *name, named *out) {
    int done = open_context(opts, &out->context);
    if (done != CONTINUE)
        return done;
    int preset = snow_preset_from_name(name),
        map = snow_colormap_from_name(name);
    snow_color_point point;
    if (map >= 0 && snow_colormap_points((size_t)map, &point, 1) == 0)
        map = -1; /* a list of colours, which has no points of its own */
    bool file = is_there(name) || (preset < 0 && map < 0);
    if (!file && preset >= 0 && !snow_preset_look((size_t)preset)->color_count)
        return fail_usage("%s: is made of a volume's values and has no points; "
                          "use it with --preset %s",
                          name, name);
    if (!file && preset >= 0) {
        out->kind = "preset";
        out->look = *snow_preset_look((size_t)preset);
        out->look.name = snow_preset_name((size_t)preset);
        return CONTINUE;
    }
    if (!file) {
        const char *plain = snow_colormap_name((size_t)map);
        take_colormap(map, plain ? plain : name, out);
        return CONTINUE;
    }
    snow_status status = snow_look_load(out->context, name, &out->tf);
    if (status != SNOW_STATUS_OK && !strpbrk(name, "./#")) {
        say("%s: is not a file, a preset or a colour map; `snowglass tf list` "
            "lists the names",
            name);
        return SNOW_STATUS_BAD_INPUT;
    }
    if (status != SNOW_STATUS_OK)
        return fail_status(out->context, status);
    out->kind = snow_look_file_format(out->tf);
    out->look = *snow_look_file_look(out->tf);
    return CONTINUE;
}

/* --- show ----------------------------------------------------------------- */

#define WIDE 512
#define CURVE 128 /* rows of the opacity curve */
#define BAR 32    /* rows of the colour bar below it */

/* Completes a transfer function that lacks colours (white) or opacities
 * (opaque). */
static snow_status make_whole(const named *n, snow_transfer **out) {
    static const snow_color_point white[] = {{1, 1, 1, 1}};
    static const snow_opacity_point solid[] = {{1, 1}};
    const snow_look *p = &n->look;
    snow_status status =
        snow_transfer_new(n->context, p->color_count ? p->colors : white,
                          p->color_count ? p->color_count : 1,
                          p->opacity_count ? p->opacities : solid,
                          p->opacity_count ? p->opacity_count : 1, out);
    if (status == SNOW_STATUS_OK && p->log)
        status = snow_transfer_set_log(*out);
    return status;
}

static void widen(double value, double ends[2]) {
    ends[0] = value < ends[0] ? value : ends[0];
    ends[1] = value > ends[1] ? value : ends[1];
}

/* From the first to the last control point of either kind. */
static void find_ends(const snow_look *p, double ends[2]) {
    ends[0] = ends[1] =
        p->color_count ? p->colors[0].value : p->opacities[0].value;
    if (p->color_count)
        widen(p->colors[p->color_count - 1].value, ends);
    if (p->opacity_count) {
        widen(p->opacities[0].value, ends);
        widen(p->opacities[p->opacity_count - 1].value, ends);
    }
}

/* Draws the colours as a bar, and above it the opacity as a curve. */
static void paint_transfer(const snow_transfer *transfer, const double ends[2],
                           float *pixels) {
    for (int x = 0; x < WIDE; x++) {
        double part = (x + 0.5) / WIDE, rgba[4];
        snow_transfer_evaluate(transfer, ends[0] * (1 - part) + ends[1] * part,
                               rgba);
        for (int y = 0; y < CURVE + BAR; y++) {
            float *pixel = pixels + 4 * (y * WIDE + x);
            double height = 1 - (y + 0.5) / CURVE;
            bool on = y >= CURVE || height < rgba[3];
            for (int c = 0; c < 3; c++)
                pixel[c] = on ? (float)rgba[c] : 0.13F;
            pixel[3] = 1;
        }
    }
}

static int save_picture(const options *opts, const named *n) {
    snow_transfer *transfer = NULL;
    snow_image *image = NULL;
    snow_image_options form = {.size = sizeof form,
                               .overwrite = opts->overwrite};
    double ends[2];
    int done = check_no_folder(opts->output);
    if (done != CONTINUE)
        return done;
    find_ends(&n->look, ends);
    snow_status status = make_whole(n, &transfer);
    if (status == SNOW_STATUS_OK)
        status = snow_image_new(n->context, WIDE, CURVE + BAR, 4, &image);
    if (status == SNOW_STATUS_OK) {
        paint_transfer(transfer, ends, snow_image_pixels(image));
        interrupt_hold();
        status = snow_image_save(image, opts->output, &form);
    }
    snow_image_free(image);
    snow_transfer_free(transfer);
    return status == SNOW_STATUS_OK ? SNOW_STATUS_OK
                                    : fail_status(n->context, status);
}

static void print_points(const snow_look *p) {
    for (size_t i = 0; i < p->color_count; i++)
        printf("colour   %12.6g  %.4f %.4f %.4f\n", p->colors[i].value,
               p->colors[i].red, p->colors[i].green, p->colors[i].blue);
    for (size_t i = 0; i < p->opacity_count; i++)
        printf("opacity  %12.6g  %.4f\n", p->opacities[i].value,
               p->opacities[i].opacity);
    for (size_t i = 0; i < p->gradient_opacity_count; i++)
        printf("gradient %12.6g  %.4f\n", p->gradient_opacities[i].value,
               p->gradient_opacities[i].opacity);
}

/* A function of the library that returns a text, to be freed; NULL after the
 * error was printed. */
typedef snow_status text_writer(snow_context *context, const snow_look *points,
                                char *text, size_t capacity, size_t *length);

static char *text_of(const named *n, text_writer *write, size_t *length,
                     int *done) {
    snow_status status = write(n->context, &n->look, NULL, 0, length);
    char *text = status == SNOW_STATUS_OK ? malloc(*length + 1) : NULL;
    if (text)
        status = write(n->context, &n->look, text, *length + 1, length);
    *done =
        status != SNOW_STATUS_OK ? fail_status(n->context, status) : CONTINUE;
    if (status == SNOW_STATUS_OK && !text)
        *done = fail_memory("out of memory for the text; close other programs");
    return text;
}

static int show(const options *opts, const named *n) {
    static const char *const values[] = {
        "data values", "shares of the range of all values",
        "shares of the range of the object's values",
        "shares of a range that is symmetric around 0"};
    static_assert(sizeof values / sizeof *values == SNOW_DOMAIN_SYMMETRIC + 1,
                  "a text for each domain");
    if (opts->output)
        return save_picture(opts, n);
    if (opts->json) {
        size_t length;
        int done;
        char *text = text_of(n, snow_look_write_json, &length, &done);
        if (done == CONTINUE) {
            text[length] = '\n';
            done = write_text(text, length + 1, "-", false);
        }
        free(text);
        return done;
    }
    printf("name     %s\nkind     %s\nvalues   %s\njoined   %s\nopacity  per "
           "%s\n",
           n->look.name, n->kind, values[n->look.domain],
           n->look.log ? "by logarithms" : "linearly",
           n->look.per_mm ? "mm" : "voxel");
    print_points(&n->look);
    return finish_stdout();
}

/* --- convert -------------------------------------------------------------- */

/* Reports what a table cannot hold. */
static void report_losses(const options *opts, const snow_look *p) {
    if (opts->verbosity >= 0 &&
        (p->gradient_opacity_count || p->log || p->domain))
        say("%s: a table cannot hold%s%s%s; write .json to keep it",
            opts->output,
            p->gradient_opacity_count ? " the gradient opacity" : "",
            p->log ? " the logarithmic scale" : "",
            p->domain ? " values as shares of a range" : "");
}

static int convert(const options *opts, const named *n) {
    bool csv = ends_with(opts->output, ".csv");
    size_t length;
    int done;
    char *text = text_of(n, csv ? snow_look_write_csv : snow_look_write_json,
                         &length, &done);
    if (done == CONTINUE && csv)
        report_losses(opts, &n->look);
    if (done == CONTINUE) {
        if (!csv)
            text[length++] = '\n';
        if (!is_special(opts->output))
            interrupt_hold();
        done = write_text(text, length, opts->output, opts->overwrite);
    }
    free(text);
    return done;
}

static int check_convert(const options *opts) {
    if (!opts->output)
        return fail_usage(
            "no output file given; add -o OUT.json or -o OUT.csv");
    int done = check_no_folder(opts->output);
    if (done != CONTINUE)
        return done;
    if (!ends_with(opts->output, ".json") && !ends_with(opts->output, ".csv") &&
        strcmp(opts->output, "-") != 0)
        return fail_usage("%s: transfer functions are written as .json or "
                          ".csv; use one of these endings",
                          opts->output);
    if (strcmp(opts->output, "-") == 0)
        return CONTINUE;
    return check_stats_path(opts->output, opts->overwrite);
}

/* --- the verb ------------------------------------------------------------- */

static int run_named(const options *opts, const char *name,
                     int (*act)(const options *, const named *)) {
    named n = {.context = NULL};
    int done = find_transfer(opts, name, &n);
    if (done == CONTINUE)
        done = act(opts, &n);
    snow_look_file_free(n.tf);
    snow_context_free(n.context);
    return done;
}

int cmd_tf(const options *opts) {
    const char *word = opts->operand_count ? opts->operands[0] : "";
    bool converts = strcmp(word, "convert") == 0;
    if (strcmp(word, "list") == 0 && opts->operand_count == 1)
        return list(opts);
    if ((!converts && strcmp(word, "show") != 0) || opts->operand_count != 2)
        return fail_usage("tf: no action given; use tf list, tf show "
                          "NAME|FILE, or tf convert IN -o OUT.json");
    int done = converts ? check_convert(opts) : CONTINUE;
    if (done != CONTINUE)
        return done;
    return run_named(opts, opts->operands[1], converts ? convert : show);
}
