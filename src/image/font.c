/* image/font.c - the letters of labels and legends.
 *
 * The font was drawn for this project and is in the public domain.  A glyph is
 * a text of strokes on a grid of 12 units from the base line to the top of
 * capitals, y upwards:
 *
 *   -xyxyxy   straight lines from point to point
 *   ~xyxyxy   a curve from the first to the last point, whose control points
 *             are all others: the quadratic B-spline, which runs from the
 *             middle of each side of the control polygon to that of the next
 *   oxyxyxy   the same closed: four corners of a box make a round letter
 *   .xy       a dot
 *
 * x is a digit, y a digit, a, b, c (10, 11, 12) or z, y, x, w (-1 to -4).  A
 * glyph is as wide as its farthest point; SPACE separates two glyphs.  Strokes
 * have round ends and one width, so that letters are readable at heights from
 * 9 to a hundred pixels. */
#include "image/overlay.h"

#include <assert.h>
#include <math.h>
#include <string.h>

#define CAPITAL 12.0 /* units */
#define SPACE 3.8
#define BLANK 2.5 /* width of the blank, besides the space around it */
#define PIECES 6  /* straight pieces of a curve between two middles */

/* Beginning with ' '. */
static const char *const glyphs[] = {
    "", "-0c04.00", "-0c09-3c39", "-2c10-6c50-0878-0474",
    "~7a7c0c0676700002-4e3y", "-7c00o0c3c3909o43737040", "~70171c5c5805005075",
    "-0c09", "~3c09013y", "~0c39310y", "-3a32-0864-0468", "-3933-0666", "-110y",
    "-0555", ".00", "-005c",
    /* 0 to 9 */
    "o0c7c7000", "-093c30", "~090c7c7700-0070", "~0a0c6c6626~2676700002",
    "-505c0474", "-6c0c06~0628787000~0002", "~6c0c03o07777000", "-0c7c20",
    "o1c6c6616o06767000", "~107079o75050c7c",
    /* : to @ */
    ".07.01", ".17-110y", "-5a0652", "-0868-0464", "-0a5602",
    "~090c6c673633.30", "~60000c8c836368o28686323",
    /* A to Z */
    "-004c80-1474", "-000c~0c6c6606~06767000", "~797c0c007073",
    "-000c~0c7c7000", "-7c0c0070-0666", "-7c0c00-0666", "~797c0c007075-7545",
    "-000c-707c-0676", "-0c4c-0040-2c20", "~5c500003", "-000c-7c04-2670",
    "-0c0070", "-000c458c80", "-000c707c", "o0c8c8000", "-000c~0c7c7505",
    "o0c8c8000-538z", "-000c~0c7c7606-3670", "~7a7c0c0676700002", "-0c8c-4c40",
    "~0c00707c", "-0c408c", "-0c2049608c", "-0c70-007c", "-0c468c-4640",
    "-0c7c0070",
    /* [ to ` */
    "-2c0c0y2y", "-0c50", "-0c2c2y0y", "-093c69", "-0y7y", "-0c2a",
    /* a to z */
    "o08686000-6860", "-0c00o08686000", "~666808006062", "-6c60o08686000",
    "-0464~646808006062", "~4c1c18-1810-0848", "-6860o08686000~606w0w0x",
    "-0c00~05086860", "-0800.0b", "-2820~202w0w.2b", "-0c00-5803-2560", "-0c00",
    "-0800~05084840~45488880", "-0800~05086860", "o08686000", "-080wo08686000",
    "-686wo08686000", "-0800~050848", "~5758080454500001", "-1c13~131040-0848",
    "~08006063-6860", "-083068", "-0820466088", "-0860-0068", "-0830-682w",
    "-08680060",
    /* { to ~ */
    "-2c1b1706151z2y", "-0c0y", "-0c1b1726151z0y", "~05184467"};

static_assert(sizeof glyphs / sizeof *glyphs == 127 - ' ',
              "a glyph for each character");

/* What else has a glyph; dashes, too. */
static const struct {
    unsigned code;
    const char *glyph;
} symbols[] = {{0xa0, ""},
               {0xb0, "o090c3c39"},
               {0xb1, "-3a34-0767-0161"},
               {0xb2, "~0b0c3c3b07-0737"},
               {0xb3, "~0c3c3a1a~1a3a3707"},
               {0xb5, "-080w~08026062-6860"},
               {0xb7, ".06"},
               {0xb9, "-0b1c17"},
               {0xd7, "-0862-0268"},
               {0xf7, "-0565.38.32"},
               {0x3bc, "-080w~08026062-6860"},
               {0x2013, "-0565"},
               {0x2014, "-0595"},
               {0x2019, "-0c09"},
               {0x207b, "-0939"},
               {0x2212, "-0565"}};

static const char box[] = "-000c7c7000";

/* Latin-1 from U+C0 on: letters without their marks, and which marks. */
static const char bases[] = "AAAAAAACEEEEIIIIDNOOOOO OUUUUYPs"
                            "aaaaaaaceeeeiiiidnooooo ouuuuypy";
static const char marked[] = "gactdr ,gacdgacd tgactd  gacda  "
                             "gactdr ,gacdgacd tgactd  gacda d";

/* A mark belongs over the glyph's middle, and higher over a capital. */
typedef struct marked_letter {
    const char *glyph, *mark;
    double lift;
} marked_letter;

/* Passes a character of UTF-8; a byte that begins none is of Latin-1. */
static unsigned decode(const char **text) {
    const unsigned char *at = (const unsigned char *)*text;
    int more = *at >= 0xf0 ? 3 : *at >= 0xe0 ? 2 : *at >= 0xc2;
    unsigned code = more ? *at & (0x3fU >> more) : *at;
    for (int n = 1; n <= more; n++) {
        if ((at[n] & 0xc0) != 0x80) {
            (*text)++;
            return *at;
        }
        code = code << 6 | (at[n] & 0x3f);
    }
    *text += more + 1;
    return code;
}

static marked_letter next_letter(const char **text) {
    unsigned code = decode(text);
    marked_letter found = {box, "", 0};
    if (code >= 32 && code < 127)
        found.glyph = glyphs[code - 32];
    if (code >= 0xc0 && code <= 0xff) {
        char base = bases[code - 0xc0], mark = marked[code - 0xc0];
        found.glyph = base == 'i' ? "-0800" : glyphs[base - 32];
        /* Above a small letter 6 wide: grave, acute, circumflex, tilde,
         * diaeresis and ring; and the cedilla. */
        static const char names[] = "gactdr,";
        static const char *const marks[] = {"-2c4a",     "-4c2a",  "-1a3c5a",
                                            "~0a2c4a6c", ".1b.5b", "o1a1d5d5a",
                                            "-303z2y"};
        const char *at = strchr(names, mark);
        found.mark = at && *at ? marks[at - names] : "";
        found.lift = base < 'a' && mark != ',' ? 3 : 0;
    }
    for (size_t n = 0; n < sizeof symbols / sizeof *symbols; n++)
        if (symbols[n].code == code)
            found.glyph = symbols[n].glyph;
    return found;
}

static double column(char digit) {
    return digit - '0';
}

static double row(char digit) {
    if (digit <= '9')
        return digit - '0';
    return digit < 'p' ? digit - 'a' + 10 : digit - 'z' - 1;
}

static bool is_mode(char letter) {
    return letter == '-' || letter == '~' || letter == 'o' || letter == '.';
}

static double glyph_width(const char *glyph) {
    double widest = *glyph ? 0 : BLANK;
    while (*glyph) {
        if (is_mode(*glyph)) {
            glyph++;
            continue;
        }
        if (column(*glyph) > widest)
            widest = column(*glyph);
        glyph += 2;
    }
    return widest;
}

double snow_font_width(const char *text) {
    double width = 0;
    while (*text)
        width += glyph_width(next_letter(&text).glyph) + SPACE;
    return fmax(width - SPACE, 0) / CAPITAL;
}

bool snow_font_has(const char *text) {
    while (*text)
        if (*text == '\n')
            text++;
        else if (next_letter(&text).glyph == box)
            return false;
    return true;
}

void snow_font_shorten(double width, char *text) {
    size_t end = strlen(text), length = end;
    while (end > 0 && snow_font_width(text) > width) {
        do
            end--;
        while (end > 0 && ((text[end] & 0xc0) == 0x80 || end + 3 > length));
        strcpy(text + end, end + 3 > length ? "" : "...");
    }
}

/* The position at which a glyph is drawn. */
typedef struct pen {
    snow_overlay *overlay;
    double x, y, unit; /* of its grid's origin, pixels; pixels a unit */
    double at[2];      /* grid */
} pen;

static snow_status line_to(pen *p, double x, double y) {
    snow_status status = snow_overlay_stroke(
        p->overlay, p->x + p->at[0] * p->unit, p->y - p->at[1] * p->unit,
        p->x + x * p->unit, p->y - y * p->unit);
    p->at[0] = x;
    p->at[1] = y;
    return status;
}

/* Draws a parabola from the pen's position. */
static snow_status curve_to(pen *p, const double control[2], double x,
                            double y) {
    const double from[2] = {p->at[0], p->at[1]}, to[2] = {x, y};
    for (int n = 1; n <= PIECES; n++) {
        double t = (double)n / PIECES, s = 1 - t, at[2];
        for (int i = 0; i < 2; i++)
            at[i] = s * s * from[i] + 2 * s * t * control[i] + t * t * to[i];
        SNOW_TRY(line_to(p, at[0], at[1]));
    }
    return SNOW_STATUS_OK;
}

static void point_at(const char *points, size_t index, double point[2]) {
    point[0] = column(points[2 * index]);
    point[1] = row(points[2 * index + 1]);
}

/* The middle of the side of the control polygon that begins with a point. */
static void middle_at(const char *points, size_t count, size_t index,
                      double middle[2]) {
    double a[2], b[2];
    point_at(points, index % count, a);
    point_at(points, (index + 1) % count, b);
    middle[0] = (a[0] + b[0]) / 2;
    middle[1] = (a[1] + b[1]) / 2;
}

static snow_status draw_lines(pen *p, const char *points, size_t count) {
    double to[2];
    for (size_t n = count > 1 ? 1 : 0; n < count; n++) {
        point_at(points, n, to);
        SNOW_TRY(line_to(p, to[0], to[1]));
    }
    return SNOW_STATUS_OK;
}

/* The first and the last side of an open curve are straight up to their
 * middles, so that the curve ends in its end points. */
static snow_status draw_curve(pen *p, const char *points, size_t count,
                              bool closed) {
    double control[2], to[2];
    middle_at(points, count, closed ? count - 1 : 0, to);
    if (closed)
        memcpy(p->at, to, sizeof to);
    else
        SNOW_TRY(line_to(p, to[0], to[1]));
    for (size_t n = closed ? 0 : 1; n < count - (closed ? 0 : 1); n++) {
        point_at(points, n, control);
        middle_at(points, count, n, to);
        SNOW_TRY(curve_to(p, control, to[0], to[1]));
    }
    if (closed)
        return SNOW_STATUS_OK;
    point_at(points, count - 1, to);
    return line_to(p, to[0], to[1]);
}

static snow_status draw_glyph(pen *p, const char *glyph) {
    while (*glyph) {
        char mode = *glyph++;
        size_t length = 0;
        while (glyph[length] && !is_mode(glyph[length]))
            length += 2;
        point_at(glyph, 0, p->at);
        if (mode == '-' || mode == '.')
            SNOW_TRY(draw_lines(p, glyph, length / 2));
        else
            SNOW_TRY(draw_curve(p, glyph, length / 2, mode == 'o'));
        glyph += length;
    }
    return SNOW_STATUS_OK;
}

snow_status snow_font_draw(snow_overlay *overlay, double x, double y,
                           double height, const char *text) {
    pen p = {.overlay = overlay, .x = x, .y = y, .unit = height / CAPITAL};
    while (*text) {
        marked_letter l = next_letter(&text);
        pen above = p;
        above.x += (glyph_width(l.glyph) - 6) / 2 * p.unit;
        above.y -= l.lift * p.unit;
        SNOW_TRY(draw_glyph(&p, l.glyph));
        SNOW_TRY(draw_glyph(&above, l.mark));
        p.x += (glyph_width(l.glyph) + SPACE) * p.unit;
    }
    return SNOW_STATUS_OK;
}
