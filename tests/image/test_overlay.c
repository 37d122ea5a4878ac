/* tests/image/test_overlay.c - what is drawn over pictures as they are written.
 */
#include "image/overlay.h"
#include "reference/model.h"
#include "support/image.h"
#include "support/looks.h"
#include "transform/transform.h"

#include <math.h>
#include <snowglass/overlay.h>

/* --- letters -------------------------------------------------------------- */

static void letters_of_named_views_are_those_of_radiology(void **state) {
    static const char *const table[][5] = {
        /* view, left, right, top, bottom of the picture */
        {"anterior", "R", "L", "S", "I"}, {"posterior", "L", "R", "S", "I"},
        {"left", "A", "P", "S", "I"},     {"right", "P", "A", "S", "I"},
        {"superior", "L", "R", "A", "P"}, {"inferior", "R", "L", "A", "P"},
        {"iso", "RP", "LA", "S", "I"}};
    image_fixture *f = *state;
    snow_volume_info info = support_patient();
    for (size_t n = 0; n < sizeof table / sizeof *table; n++)
        for (int eye = 0; eye < 2; eye++) {
            char letters[4][4];
            snow_view view = support_view(f->context, table[n][0]);
            view.fov = eye ? 40 : 0;
            assert_int_equal(
                snow_view_orientation(f->context, &info, &view, letters),
                SNOW_STATUS_OK);
            for (int edge = 0; edge < 4; edge++)
                assert_string_equal(letters[edge], table[n][1 + edge]);
        }
}

static void letters_turn_with_the_camera(void **state) {
    static const struct {
        double azimuth, elevation, roll;
        const char *letters[4];
    } table[] = {
        {24, 0, 0, {"R", "L", "S", "I"}},    {26, 0, 0, {"RA", "LP", "S", "I"}},
        {-26, 0, 0, {"RP", "LA", "S", "I"}}, {64, 0, 0, {"AR", "PL", "S", "I"}},
        {66, 0, 0, {"A", "P", "S", "I"}},    {45, 0, 0, {"RA", "LP", "S", "I"}},
        {135, 0, 0, {"LA", "RP", "S", "I"}}, {0, 30, 0, {"R", "L", "SP", "IA"}},
        {0, 0, 90, {"S", "I", "L", "R"}},    {0, 0, 180, {"L", "R", "I", "S"}}};
    image_fixture *f = *state;
    snow_volume_info info = support_patient();
    for (size_t n = 0; n < sizeof table / sizeof *table; n++) {
        char letters[4][4];
        snow_view view = support_view(f->context, "anterior");
        view.azimuth = table[n].azimuth;
        view.elevation = table[n].elevation;
        view.roll = table[n].roll;
        assert_int_equal(
            snow_view_orientation(f->context, &info, &view, letters),
            SNOW_STATUS_OK);
        for (int edge = 0; edge < 4; edge++)
            assert_string_equal(letters[edge], table[n].letters[edge]);
    }
}

/* A patient's planes have the letters that radiologists expect: the right side
 * at the left of axial and coronal, the face at the left of sagittal. */
static void planes_of_a_patient_are_seen_as_radiologists_do(void **state) {
    static const struct {
        const char *name, *letters; /* left, right, top, bottom */
    } planes[] = {{"axial", "RLAP"}, {"Coronal", "RLSI"}, {"sagittal", "APSI"},
                  {"front", "RLSI"}, {"back", "LRSI"},    {"top", "LRAP"},
                  {"bottom", "RLAP"}};
    image_fixture *f = *state;
    snow_volume_info info = support_patient();
    for (size_t n = 0; n < sizeof planes / sizeof *planes; n++) {
        char letters[4][4];
        snow_view view =
            support_view(f->context, snow_view_name_for(&info, planes[n].name));
        assert_int_equal(
            snow_view_orientation(f->context, &info, &view, letters),
            SNOW_STATUS_OK);
        for (int edge = 0; edge < 4; edge++)
            assert_true(letters[edge][0] == planes[n].letters[edge] &&
                        letters[edge][1] == 0);
    }
}

/* Held against the reference's projection: a step of the patient's axis goes to
 * the edge that bears its first letter. */
static void a_step_along_a_letter_goes_to_its_edge(void **state) {
    static const char names[] = "RLAPSI";
    image_fixture *f = *state;
    uint64_t random = 5;
    reference_scene scene = {.info = support_patient()};
    for (int n = 0; n < 300; n++) {
        char letters[4][4];
        scene.view = support_view(f->context, snow_view_name((size_t)n % 13));
        scene.view.azimuth = (double)(support_random(&random) % 3600) / 10;
        scene.view.elevation = (double)(support_random(&random) % 1800) / 10;
        scene.view.roll = (double)(support_random(&random) % 3600) / 10;
        reference_camera camera;
        reference_camera_of(&scene, &camera);
        assert_int_equal(snow_view_orientation(f->context, &scene.info,
                                               &scene.view, letters),
                         SNOW_STATUS_OK);
        for (int edge = 0; edge < 4; edge++) {
            int best = 0;
            double farthest = 0;
            for (int axis = 0; axis < 6; axis++) {
                /* A step of the world as one of indices: the matrix is plain.
                 */
                double index[3] = {9.5, 14.5, 19.5}, from[2], to[2];
                reference_project(&scene, &camera, index, from);
                index[axis / 2] +=
                    (axis % 2 ? -1 : 1) / scene.info.matrix[axis / 2][axis / 2];
                reference_project(&scene, &camera, index, to);
                double right = to[0] - from[0], down = to[1] - from[1];
                double along[4] = {-right, right, -down, down};
                if (along[edge] > farthest * (1 + 1e-6)) {
                    farthest = along[edge];
                    best = axis;
                }
            }
            assert_int_equal(letters[edge][0], names[best]);
        }
    }
}

static void what_is_no_patient_has_no_letters(void **state) {
    image_fixture *f = *state;
    snow_volume_info info = support_patient();
    snow_view view = support_view(f->context, "iso");
    char letters[4][4];
    info.medical = false;
    assert_int_equal(snow_view_orientation(f->context, &info, &view, letters),
                     SNOW_STATUS_OK);
    for (int edge = 0; edge < 4; edge++)
        assert_string_equal(letters[edge], "");
    view.zoom = 0;
    assert_int_equal(snow_view_orientation(f->context, &info, &view, letters),
                     SNOW_STATUS_BAD_USAGE);
}

/* --- shapes --------------------------------------------------------------- */

/* The overlay alone: width * height * 4 floats; free with free(). */
static float *draw_alone(const snow_overlay *overlay, int piece) {
    int width = overlay->width;
    float *pixels =
        calloc((size_t)width * (size_t)overlay->height * 4, sizeof *pixels);
    assert_non_null(pixels);
    for (int y = 0; y < overlay->height; y++)
        for (int x = 0; x < width; x += piece)
            snow_overlay_draw(overlay, false, y, x,
                              width - x < piece ? width - x : piece, 4,
                              pixels + 4 * (y * width + x));
    return pixels;
}

/* A text of one character leaves something, within its own box and a border. */
static void check_in_its_box(const image_fixture *f, const char *text,
                             double height) {
    int side = (int)(4 * height);
    snow_overlay *overlay = support_overlay(f->context, side, side);
    double width = height * snow_font_width(text);
    assert_int_equal(
        snow_overlay_text(overlay, height, height, 0, 0, height, text),
        SNOW_STATUS_OK);
    float *pixels = draw_alone(overlay, side);
    double border = 2.7 + 0.15 * height, most = 0;
    for (int y = 0; y < side; y++)
        for (int x = 0; x < side; x++) {
            const float *pixel = pixels + 4 * (y * side + x);
            most = fmax(most, (double)pixel[0]);
            if (pixel[3] > 0)
                assert_true(x > height - border &&
                            x < height + width + border &&
                            y > height - 0.2 * height - border &&
                            y < 2 * height + 0.4 * height + border);
        }
    if (!(most > 0.7))
        fail_msg("%s at %g: %g", text, height, most);
    free(pixels);
    snow_overlay_free(overlay);
}

static const char *const characters[] = {
    "Æ", "æ", "Ø", "ø", "Ð", "ð", "Þ", "þ", "ß", "Γ", "Δ", "Θ", "Λ", "Ξ", "Π",
    "Σ", "Φ", "Ψ", "Ω", "α", "β", "γ", "δ", "ε", "ζ", "η", "θ", "ι", "κ", "λ",
    "μ", "ξ", "π", "ρ", "σ", "ς", "τ", "υ", "φ", "χ", "ψ", "ω", "∂", "∇", "∞",
    "√", "∥", "⊥", "⊙", "≈", "≠", "≤", "≥", "→", "←", "⁰", "¹", "²", "³", "⁴",
    "⁵", "⁶", "⁷", "⁸", "⁹", "⁻", "⁺", "₀", "₁", "₂", "₃", "₄", "₅", "₆", "₇",
    "₈", "₉"};

enum { SIGNS = sizeof characters / sizeof *characters, ASCII = 126 - ' ' };

static void every_character_is_drawn_in_its_box(void **state) {
    image_fixture *f = *state;
    for (double height = 9; height < 120; height *= 2) {
        for (int code = 33; code < 128; code++)
            check_in_its_box(f, (const char[2]){(char)code, 0}, height);
        for (size_t n = 0; n < SIGNS; n++)
            check_in_its_box(f, characters[n], height);
    }
}

/* Signs differ from each other and from all that ASCII has, at a title's size;
 * none is the box. */
static void signs_are_told_apart(void **state) {
    image_fixture *f = *state;
    enum { SIDE = 48, BYTES = SIDE * SIDE * 4 * sizeof(float) };
    float *pixels[SIGNS + ASCII];
    for (size_t n = 0; n < SIGNS + ASCII; n++) {
        const char ascii[2] = {n < SIGNS ? 0 : (char)(n - SIGNS + '!'), 0};
        const char *text = n < SIGNS ? characters[n] : ascii;
        snow_overlay *overlay = support_overlay(f->context, SIDE, SIDE);
        assert_int_equal(snow_overlay_text(overlay, 9, 9, 0, 0, 24, text),
                         SNOW_STATUS_OK);
        pixels[n] = draw_alone(overlay, SIDE);
        snow_overlay_free(overlay);
        for (size_t m = 0; m < n && m < SIGNS; m++)
            if (memcmp(pixels[m], pixels[n], BYTES) == 0)
                fail_msg("%s is drawn as %s", characters[m], text);
    }
    for (size_t n = 0; n < SIGNS + ASCII; n++)
        free(pixels[n]);
}

/* Letters differ from each other at the smallest size. */
static void letters_are_told_apart(void **state) {
    static const char names[] = "RLAPSI0123456789-.m";
    image_fixture *f = *state;
    float *pixels[sizeof names];
    size_t count = sizeof names - 1;
    for (size_t n = 0; n < count; n++) {
        const char text[2] = {names[n], 0};
        snow_overlay *overlay = support_overlay(f->context, 20, 20);
        assert_int_equal(snow_overlay_text(overlay, 5, 5, 0, 0, 9, text),
                         SNOW_STATUS_OK);
        pixels[n] = draw_alone(overlay, 20);
        snow_overlay_free(overlay);
    }
    for (size_t a = 0; a < count; a++)
        for (size_t b = 0; b < a; b++) {
            double sum = 0;
            for (int i = 0; i < 20 * 20; i++)
                sum += fabs((double)pixels[a][4 * i] - pixels[b][4 * i]);
            assert_true(sum > 3);
        }
    for (size_t n = 0; n < count; n++)
        free(pixels[n]);
}

static void pieces_of_rows_are_the_row(void **state) {
    image_fixture *f = *state;
    snow_overlay *overlay = support_overlay(f->context, 700, 130);
    snow_volume_info info = support_patient();
    snow_view view = support_view(f->context, "iso");
    view.width = 700, view.height = 130;
    assert_int_equal(snow_overlay_orientation(overlay, &info, &view),
                     SNOW_STATUS_OK);
    assert_int_equal(snow_overlay_title(overlay, "step 12"), SNOW_STATUS_OK);
    assert_int_equal(snow_overlay_scale_bar(overlay, &info, &view),
                     SNOW_STATUS_OK);
    float *whole = draw_alone(overlay, 700), *pieces = draw_alone(overlay, 7);
    assert_memory_equal(whole, pieces, 700 * 130 * 4 * sizeof *whole);
    free(whole);
    free(pieces);
    snow_overlay_free(overlay);
}

/* White inside and dark around it, or the reverse: on any grey the one or the
 * other is seen. */
static void letters_stand_out_on_any_background(void **state) {
    image_fixture *f = *state;
    for (int side = 128; side <= 4096; side *= 2)
        for (int grey = 0; grey <= 21; grey++) {
            bool light = grey > 10;
            snow_overlay *overlay = support_overlay(f->context, side, 64);
            double height = fmax(9, 0.036 * side);
            assert_int_equal(
                snow_overlay_text(overlay, height, 2, 0, 0, height, "L"),
                SNOW_STATUS_OK);
            float low = 1, high = 0, row[4 * 512];
            for (int y = 0; y < 64; y++) {
                for (int i = 0; i < 4 * 512; i++)
                    row[i] = i % 4 == 3 ? 1 : (float)(grey % 11) / 10;
                snow_overlay_draw(overlay, light, y, 0, side < 512 ? side : 512,
                                  4, row);
                for (int i = 0; i < 4 * (side < 512 ? side : 512); i += 4) {
                    low = fminf(low, row[i]);
                    high = fmaxf(high, row[i]);
                }
            }
            assert_true(high - low > 0.75f);
            snow_overlay_free(overlay);
        }
}

/* The darkest and the lightest red of a file with a letter, on a background. */
static void draw_on(image_fixture *f, double grey, bool flat, float *dark,
                    float *bright) {
    snow_image *image = support_blank(f->context, 60, 60, 2);
    snow_overlay *overlay = support_overlay(f->context, 60, 60);
    assert_int_equal(snow_overlay_text(overlay, 30, 30, 0.5, 0.5, 30, "S"),
                     SNOW_STATUS_OK);
    const snow_image_options options = {.size = sizeof options,
                                        .overlay = overlay,
                                        .flatten = flat,
                                        .background = {grey, grey, grey}};
    unsigned char *bytes = malloc(60 * 60 * 3);
    snow_image *read = support_round_trip(f, image, "a.png", &options);
    snow_image_to_rgb8(image, &options, bytes);
    *dark = 1;
    *bright = 0;
    for (size_t i = 0; i < 60 * 60; i++) {
        float red = snow_image_pixels(read)[4 * i];
        *dark = fminf(*dark, red);
        *bright = fmaxf(*bright, red);
        if (flat)
            assert_near(bytes[3 * i] / 255.0, (double)red, 1e-6);
    }
    free(bytes);
    snow_image_free(read);
    snow_image_free(image);
    snow_overlay_free(overlay);
}

/* Without a background they are white: it is not known what lies below. */
static void letters_are_dark_on_light_backgrounds(void **state) {
    image_fixture *f = *state;
    float dark, bright;
    for (int n = 0; n <= 10; n++) {
        draw_on(f, n / 10.0, true, &dark, &bright);
        assert_true(n > 5 ? dark < 0.01f : bright > 0.99f);
        if (n == 10)
            assert_true(bright > 0.99f);
        if (n == 0)
            assert_true(dark < 0.01f);
    }
    draw_on(f, 1, false, &dark, &bright);
    assert_true(bright > 0.99f);
}

/* --- bars ----------------------------------------------------------------- */

static void the_scale_bar_is_as_long_as_it_says(void **state) {
    image_fixture *f = *state;
    snow_volume_info info = support_patient();
    static const struct {
        double zoom;
        const char *unit;
    } cases[] = {{1, "mm"}, {3, "mm"}, {40, "um"}, {0.02, ""}, {7, "nm"}};
    for (size_t n = 0; n < sizeof cases / sizeof *cases; n++) {
        snow_view view = support_view(f->context, "anterior");
        snow_camera camera;
        view.zoom = cases[n].zoom;
        snprintf(info.unit, sizeof info.unit, "%s", cases[n].unit);
        assert_int_equal(snow_camera_make(f->context, &info, &view, &camera),
                         SNOW_STATUS_OK);
        snow_overlay *overlay = support_overlay(f->context, 512, 512);
        assert_int_equal(snow_overlay_scale_bar(overlay, &info, &view),
                         SNOW_STATUS_OK);
        /* Its line is the first stroke. */
        double length =
            (double)(overlay->numbers[2] - overlay->numbers[0]) * camera.pitch;
        double ten = pow(10, floor(log10(length) + 1e-6));
        double share = length / ten;
        assert_true(fabs(share - 1) < 1e-4 || fabs(share - 2) < 1e-4 ||
                    fabs(share - 5) < 1e-4);
        assert_true(overlay->numbers[2] - overlay->numbers[0] < 0.12f * 512);
        assert_true(overlay->numbers[2] - overlay->numbers[0] > 0.03f * 512);
        snow_overlay_free(overlay);
    }
}

/* "um" is what formats call it; u and the micro sign are different letters. */
static void micrometres_have_their_sign(void **state) {
    static const char *const texts[] = {"um", "\xc2\xb5m"};
    image_fixture *f = *state;
    snow_volume_info info = support_patient();
    snow_view view = support_view(f->context, "anterior");
    float *drawn[4];
    for (int n = 0; n < 4; n++) {
        snow_overlay *overlay = support_overlay(f->context, 512, 512);
        snprintf(info.unit, sizeof info.unit, "%s", texts[n % 2]);
        assert_int_equal(
            n < 2 ? snow_overlay_scale_bar(overlay, &info, &view)
                  : snow_overlay_text(overlay, 99, 99, 0, 0, 20, texts[n % 2]),
            SNOW_STATUS_OK);
        drawn[n] = draw_alone(overlay, 512);
        snow_overlay_free(overlay);
    }
    assert_memory_equal(drawn[0], drawn[1], 512 * 512 * 4 * sizeof **drawn);
    assert_memory_not_equal(drawn[2], drawn[3], 512 * 512 * 4 * sizeof **drawn);
    assert_near(snow_font_width("\xc2\xb5"), snow_font_width("u"), 1e-12);
    for (int n = 0; n < 4; n++)
        free(drawn[n]);
}

static void a_perspective_view_has_no_scale_bar(void **state) {
    image_fixture *f = *state;
    snow_volume_info info = support_patient();
    snow_view view = support_view(f->context, "anterior");
    snow_overlay *overlay = support_overlay(f->context, 512, 512);
    view.fov = 30;
    assert_int_equal(snow_overlay_scale_bar(overlay, &info, &view),
                     SNOW_STATUS_OK);
    assert_int_equal(overlay->shape_count, 0);
    snow_overlay_free(overlay);
}

static void the_color_bar_has_the_transfer_functions_colors(void **state) {
    image_fixture *f = *state;
    const snow_color_point colors[] = {{-100, 1, 0, 0}, {300, 0, 0, 1}};
    const snow_opacity_point opacities[] = {{-50, 0}, {300, 0.3}};
    snow_transfer *transfer = NULL;
    assert_int_equal(
        snow_transfer_new(f->context, colors, 2, opacities, 2, &transfer),
        SNOW_STATUS_OK);
    snow_overlay *overlay = support_overlay(f->context, 300, 400);
    assert_int_equal(
        snow_overlay_color_bar(overlay, transfer, "HU", NULL, 0, 1),
        SNOW_STATUS_OK);
    assert_false(overlay->grey);
    const snow_shape *bar = NULL;
    for (size_t n = 0; n < overlay->shape_count; n++)
        if (overlay->shapes[n].filled)
            bar = &overlay->shapes[n];
    assert_non_null(bar);
    for (size_t row = 0; row < bar->count; row++) {
        const float *rgb = overlay->numbers + bar->first + 3 * row;
        double share = ((double)row + 0.5) / (double)bar->count;
        assert_near((double)rgb[0], share, 1e-6); /* red is below */
        assert_near((double)rgb[2], 1 - share, 1e-6);
    }
    snow_overlay_free(overlay);
    snow_transfer_free(transfer);
}

/* The row whose colour is that of a value, on a bar of a look whose red falls
 * from 1 at its top to 0 at its bottom, by the place of the value on it. */
static void check_scale(image_fixture *f, snow_look look, const double ends[2],
                        double (*place)(double value)) {
    const snow_color_point colors[] = {{0, 0, 0, 0}, {1, 1, 0, 0}};
    const snow_opacity_point opacities[] = {{0, 1}, {1, 1}};
    snow_volume *volume = support_row(f->context, SNOW_TYPE_FLOAT64, ends, 2);
    look.size = sizeof look;
    look.domain = SNOW_DOMAIN_RANGE;
    look.colors = colors;
    look.color_count = 2;
    look.opacities = opacities;
    look.opacity_count = 2;
    snow_transfer *transfer = support_look(volume, look);
    snow_overlay *overlay = support_overlay(f->context, 300, 400);
    assert_int_equal(
        snow_overlay_color_bar(overlay, transfer, NULL, NULL, 0, 1),
        SNOW_STATUS_OK);
    size_t rows = 0;
    double top = 0, bottom = 0;
    for (size_t n = 0; n < overlay->shape_count; n++) {
        const snow_shape *shape = &overlay->shapes[n];
        for (size_t row = 0; shape->filled && row < shape->count; row++) {
            double red = (double)overlay->numbers[shape->first + 3 * row];
            double share = 1 - ((double)row + 0.5) / (double)shape->count;
            assert_near(red, share, 0.003);
            rows++;
        }
        if (shape->filled) {
            top = shape->box[1];
            bottom = shape->box[3];
        }
    }
    assert_true(rows > 100);
    /* Every tick is at a whole power of ten, or at 0, and has the right place:
     * the strokes follow the opacity's. */
    const snow_shape *ticks = NULL;
    for (size_t n = 0; n < overlay->shape_count && !ticks; n++)
        if (overlay->shapes[n].filled)
            ticks = &overlay->shapes[n + 2];
    for (size_t n = 0; n < ticks->count; n++) {
        const float *stroke = overlay->numbers + ticks->first + 4 * n;
        double share = (bottom - (double)stroke[1]) / (bottom - top);
        double best = 1, value;
        for (int power = -12; power < 12; power++)
            for (int side = -1; side <= 1; side++)
                for (int digit = 1; digit < 10; digit++) {
                    value = side * digit * pow(10, power);
                    double at = (place(value) - place(ends[0])) /
                                (place(ends[1]) - place(ends[0]));
                    best = fmin(best, fabs(at - share));
                }
        assert_true(best < 1.1 / (bottom - top));
    }
    assert_true(ticks->count >= 3);
    /* Numbers have room beside each other. */
    const snow_shape *end = overlay->shapes + overlay->shape_count;
    for (const snow_shape *a = ticks + 1; a < end; a++)
        for (const snow_shape *b = a + 1; b < end; b++)
            assert_true(fabs(a->box[1] + a->box[3] - b->box[1] - b->box[3]) >
                        0.7 * (a->box[3] - a->box[1] + b->box[3] - b->box[1]));
    snow_overlay_free(overlay);
    snow_transfer_free(transfer);
    snow_volume_close(volume);
}

static double by_log(double value) {
    return value > 0 ? log(value) : -1e9;
}

static double by_symlog(double value) {
    double size = fabs(value) / 0.1;
    return copysign(size > 1 ? 1 + log(size) : size, value);
}

static void a_bar_of_logarithms_has_decades(void **state) {
    const double decades[] = {1e-5, 300}, few[] = {20, 90},
                 signs[] = {-300, 300}, above[] = {0, 1e4};
    check_scale(*state, (snow_look){.log = true}, decades, by_log);
    check_scale(*state, (snow_look){.log = true}, few, by_log);
    check_scale(*state, (snow_look){.symlog = 0.1}, signs, by_symlog);
    check_scale(*state, (snow_look){.symlog = 0.1}, above, by_symlog);
    for (double top = 300; top < 1e11; top *= 3) {
        const double wide[] = {-top, top};
        check_scale(*state, (snow_look){.symlog = 0.1}, wide, by_symlog);
    }
}

/* One value, huge and tiny ranges: ticks are found for all. */
static void any_range_has_ticks(void **state) {
    image_fixture *f = *state;
    static const double ranges[][2] = {{0, 1},       {5, 5},
                                       {0, 0},       {-1e30, 1e30},
                                       {1e-9, 2e-9}, {1000000, 1000001},
                                       {-3, -2.5},   {0.1, 99}};
    for (size_t n = 0; n < sizeof ranges / sizeof *ranges; n++)
        for (int side = 128; side <= 1024; side *= 2) {
            const snow_color_point colors[] = {{ranges[n][0], 1, 1, 1},
                                               {ranges[n][1], 0, 0, 0}};
            const snow_opacity_point opacity = {ranges[n][0], 1};
            snow_transfer *transfer = NULL;
            assert_int_equal(snow_transfer_new(f->context, colors, 2, &opacity,
                                               1, &transfer),
                             SNOW_STATUS_OK);
            snow_overlay *overlay = support_overlay(f->context, side, side);
            assert_int_equal(
                snow_overlay_color_bar(overlay, transfer, NULL, NULL, 0, 1),
                SNOW_STATUS_OK);
            /* border, colours, opacity, tick lines, and a text for each */
            assert_true(overlay->shape_count >= 5);
            assert_true(overlay->shape_count <= 4 + 12);
            snow_overlay_free(overlay);
            snow_transfer_free(transfer);
        }
}

/* --- in files ------------------------------------------------------------- */

static void files_show_it_and_the_picture_stays(void **state) {
    image_fixture *f = *state;
    for (int channels = 2; channels <= 4; channels += 2) {
        snow_image *image = support_picture(f->context, 140, 130, channels, 3);
        snow_image_pixels(image)[5] = NAN;
        uint64_t sum = snow_image_checksum(image);
        snow_overlay *overlay = support_overlay(f->context, 140, 130);
        assert_int_equal(snow_overlay_text(overlay, 70, 60, 0.5, 0.5, 40, "S"),
                         SNOW_STATUS_OK);
        for (int flat = 0; flat < 2; flat++) {
            const snow_image_options options = {
                .size = sizeof options, .overlay = overlay, .flatten = flat};
            snow_image *read = support_round_trip(f, image, "a.png", &options);
            /* The middle of the letter is white and opaque. */
            const float *pixel = snow_image_pixels(read) + 4 * (60 * 140 + 70);
            bool found = false;
            for (int x = -4; x <= 4; x++)
                found |= pixel[4 * x] > 0.99f && pixel[4 * x + 3] > 0.99f;
            assert_true(found);
            /* What a movie gets is what a flat file holds. */
            unsigned char *bytes = malloc(140 * 130 * 3);
            snow_image_to_rgb8(image, &options, bytes);
            for (int i = 0; flat && i < 140 * 130 * 3; i++)
                assert_int_equal(
                    bytes[i],
                    (int)lround(255.0 * (double)snow_image_pixels(
                                            read)[i / 3 * 4 + i % 3]));
            free(bytes);
            snow_image_free(read);
        }
        assert_true(snow_image_checksum(image) == sum);
        const snow_image_options options = {.size = sizeof options,
                                            .overlay = overlay};
        assert_int_equal(
            snow_image_save(image, support_image_path(f, "b.npy"), &options),
            SNOW_STATUS_BAD_USAGE);
        snow_overlay *other = support_overlay(f->context, 140, 131);
        const snow_image_options wrong = {.size = sizeof wrong,
                                          .overlay = other};
        assert_int_equal(
            snow_image_save(image, support_image_path(f, "b.png"), &wrong),
            SNOW_STATUS_BAD_USAGE);
        snow_overlay_free(other);
        snow_overlay_free(overlay);
        snow_image_free(image);
    }
}

static void a_grey_picture_with_a_colored_bar_is_colored(void **state) {
    image_fixture *f = *state;
    snow_image *image = support_picture(f->context, 40, 40, 2, 3);
    snow_overlay *overlay = support_overlay(f->context, 40, 40);
    const float red[3] = {1, 0, 0};
    assert_int_equal(snow_overlay_rows(overlay, 3, 4, 9, 5, red),
                     SNOW_STATUS_OK);
    const snow_image_options options = {.size = sizeof options,
                                        .overlay = overlay};
    snow_image *read = support_round_trip(f, image, "a.png", &options);
    const float *pixel = snow_image_pixels(read) + 4 * (4 * 40 + 5);
    assert_true(pixel[0] == 1 && pixel[1] == 0 && pixel[3] == 1);
    snow_image_free(read);
    snow_overlay_free(overlay);
    snow_image_free(image);
}

/* Every allocation in turn. */
static void it_fails_cleanly_without_memory(void **state) {
    (void)state;
    snow_volume_info info = support_patient();
    const snow_color_point colors[] = {{0, 1, 0, 0}, {300, 0, 0, 1}};
    const snow_opacity_point opacity = {0, 1};
    snow_status status = SNOW_STATUS_NO_MEMORY;
    for (int64_t n = 0; status != SNOW_STATUS_OK; n++) {
        support_memory memory = {.left = INT64_MAX};
        snow_context *context = support_failing_context(&memory);
        snow_transfer *transfer = NULL;
        snow_overlay *overlay = NULL;
        snow_view view = support_view(context, "iso");
        assert_int_equal(
            snow_transfer_new(context, colors, 2, &opacity, 1, &transfer),
            SNOW_STATUS_OK);
        memory.left = n;
        status = snow_overlay_new(context, 512, 512, &overlay);
        if (status == SNOW_STATUS_OK)
            status = snow_overlay_orientation(overlay, &info, &view);
        if (status == SNOW_STATUS_OK)
            status =
                snow_overlay_color_bar(overlay, transfer, "HU", NULL, 0, 1);
        if (status == SNOW_STATUS_OK)
            status = snow_overlay_scale_bar(overlay, &info, &view);
        assert_true(status == SNOW_STATUS_OK ||
                    status == SNOW_STATUS_NO_MEMORY);
        memory.left = INT64_MAX;
        snow_overlay_free(overlay);
        snow_transfer_free(transfer);
        assert_int_equal(snow_context_bytes(context), 0);
        snow_context_free(context);
    }
}

#define HERE(test)                                             \
    cmocka_unit_test_setup_teardown(test, support_image_setup, \
                                    support_image_teardown)

int main(void) {
    const struct CMUnitTest tests[] = {
        HERE(letters_of_named_views_are_those_of_radiology),
        HERE(planes_of_a_patient_are_seen_as_radiologists_do),
        HERE(letters_turn_with_the_camera),
        HERE(a_step_along_a_letter_goes_to_its_edge),
        HERE(what_is_no_patient_has_no_letters),
        HERE(every_character_is_drawn_in_its_box),
        HERE(letters_are_told_apart),
        HERE(signs_are_told_apart),
        HERE(pieces_of_rows_are_the_row),
        HERE(letters_stand_out_on_any_background),
        HERE(letters_are_dark_on_light_backgrounds),
        HERE(the_scale_bar_is_as_long_as_it_says),
        HERE(micrometres_have_their_sign),
        HERE(a_perspective_view_has_no_scale_bar),
        HERE(the_color_bar_has_the_transfer_functions_colors),
        HERE(any_range_has_ticks),
        HERE(a_bar_of_logarithms_has_decades),
        HERE(files_show_it_and_the_picture_stays),
        HERE(a_grey_picture_with_a_colored_bar_is_colored),
        HERE(it_fails_cleanly_without_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
