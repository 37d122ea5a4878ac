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

/* What else has a glyph: letters of the Nordic countries, Greek, and signs of
 * units and formulas.  Characters of one shape share it. */
static const struct {
    const char *letters, *glyph;
} symbols[] = {
    {"\u00a0", ""},
    {"°", "o090c3c39"},
    {"±", "-3a34-0767-0161"},
    {"·∙⋅", ".06"},
    {"×", "-0862-0268"},
    {"÷", "-0565.38.32"},
    {"–−", "-0565"},
    {"—", "-0595"},
    {"‘’′", "-0c09"},
    {"“”″", "-0c09-3c39"},
    {"…", ".00.30.60"},
    {"Æ", "-005c9c-5c5090-5686-2555"},
    {"æ", "o08484000-4494~949848409092"},
    {"Ø", "o0c8c8000-008c"},
    {"ø", "o08686000-0068"},
    {"Ð", "-101c~1c8c8010-0646"},
    {"ð", "o07676000~2c5a6863-195c"},
    {"Þ", "-000c~09797303"},
    {"þ", "-0c0wo08686000"},
    {"ß", "-0900~090c6c6727~27777020"},
    {"Γ", "-000c7c"},
    {"Δ∆", "-004c8000"},
    {"Θϴ", "o0c8c8000-2666"},
    {"Λ", "-004c80"},
    {"Ξ", "-0c7c-1666-0070"},
    {"Π∏", "-000c7c70"},
    {"Σ∑", "-7c0c460070"},
    {"Φ", "-4c40o0a8a8202"},
    {"Ψ", "-4c40~0c04848c"},
    {"Ω\u2126", "-0030~30040c8c8450-5080"},
    {"α", "~785000085870"},
    {"β", "-090w~090c6c6727~27777000"},
    {"γ", "-083z-683z3w"},
    {"δ", "o07676000~5c0c196864"},
    {"εϵ", "~5748080434~3404005051"},
    {"ζ", "-0c5c~5c0800505x3w"},
    {"η", "-0800~0508686w"},
    {"θϑ", "o0c6c6000-0666"},
    {"ι", "~08002021"},
    {"κ", "-0800-5803-2560"},
    {"λ", "-0c1c70-3700"},
    {"µμ", "-080w~08026062-6860"},
    {"ν", "-083068"},
    {"ξ", "-1c5c~3c0c0747~470700505x3w"},
    {"π", "-0878-2820-5850"},
    {"ρϱ", "-040wo08686000"},
    {"σ", "o08686000-3888"},
    {"ς", "~67580800505x3w"},
    {"τ", "-0868~38305051"},
    {"υ", "~08006068"},
    {"φϕ", "-3a3wo08686000"},
    {"χ", "-086w-680w"},
    {"ψ", "-3a3w~08006068"},
    {"ω", "~1806004045~4540808678"},
    {"∂", "~1b3c6c60000766"},
    {"∇", "-0c8c400c"},
    {"∞", "o0308386393986833"},
    {"√", "-0516306c9c"},
    {"∥‖", "-0c00-3c30"},
    {"⊥⟂", "-0080-4c40"},
    {"⊙☉", "o0a8a8202.46"},
    {"≈", "~03164265~071a4669"},
    {"≠", "-0464-0868-115b"},
    {"≤", "-6b0763-0060"},
    {"≥", "-0b6703-0060"},
    {"→", "-0686-598653"},
    {"←", "-8606-390633"}};

/* What looks like a letter above, and a digit raised or lowered: each with the
 * character in the same place. */
static const char alike[] = "ΑΒΕΖΗΙΚΜΝΟΡΤΥΧο\u212a\u212b";
static const char latin[] = "ABEZHIKMNOPTYXoK\xc5";
static const char raised[] = "⁰¹²³⁴⁵⁶⁷⁸⁹⁺⁻⁽⁾";
static const char lowered[] = "₀₁₂₃₄₅₆₇₈₉₊₋₍₎";
static const char digits[] = "0123456789+-()";

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
    double size, rise; /* of the whole: 1 and 0, or of a small digit */
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

/* Where a character stands in a text, or -1. */
static int place_in(const char *text, unsigned code) {
    for (int n = 0; *text; n++)
        if (decode(&text) == code)
            return n;
    return -1;
}

/* The character that is drawn for another. */
static unsigned drawn_for(unsigned code, marked_letter *found) {
    int place = place_in(alike, code);
    if (place >= 0)
        return (unsigned char)latin[place];
    const bool low = (place = place_in(raised, code)) < 0;
    if (low && (place = place_in(lowered, code)) < 0)
        return code;
    found->size = 0.55;
    found->rise = low ? -2 : CAPITAL - 0.55 * CAPITAL;
    return (unsigned char)digits[place];
}

/* A letter of Latin-1 from U+C0 on: another one and its mark. */
static void add_mark(unsigned code, marked_letter *found) {
    /* Above a small letter 6 wide: grave, acute, circumflex, tilde,
     * diaeresis and ring; and the cedilla. */
    static const char names[] = "gactdr,";
    static const char *const marks[] = {"-2c4a",     "-4c2a",  "-1a3c5a",
                                        "~0a2c4a6c", ".1b.5b", "o1a1d5d5a",
                                        "-303z2y"};
    char base = bases[code - 0xc0], mark = marked[code - 0xc0];
    const char *at = strchr(names, mark);
    found->glyph = base == 'i' ? "-0800" : glyphs[base - 32];
    found->mark = at && *at ? marks[at - names] : "";
    found->lift = base < 'a' && mark != ',' ? 3 : 0;
}

static marked_letter next_letter(const char **text) {
    marked_letter found = {box, "", 0, 1, 0};
    const unsigned code = drawn_for(decode(text), &found);
    if (code >= 32 && code < 127)
        found.glyph = glyphs[code - 32];
    else if (code >= 0xc0 && code <= 0xff)
        add_mark(code, &found);
    for (size_t n = 0; code > 127 && n < sizeof symbols / sizeof *symbols; n++)
        if (place_in(symbols[n].letters, code) >= 0)
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
    while (*text) {
        const marked_letter l = next_letter(&text);
        width += l.size * glyph_width(l.glyph) + SPACE;
    }
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
    const double unit = height / CAPITAL;
    while (*text) {
        const marked_letter l = next_letter(&text);
        pen p = {.overlay = overlay,
                 .x = x,
                 .y = y - l.rise * unit,
                 .unit = l.size * unit};
        pen above = p;
        above.x += (glyph_width(l.glyph) - 6) / 2 * p.unit;
        above.y -= l.lift * p.unit;
        SNOW_TRY(draw_glyph(&p, l.glyph));
        SNOW_TRY(draw_glyph(&above, l.mark));
        x += (l.size * glyph_width(l.glyph) + SPACE) * unit;
    }
    return SNOW_STATUS_OK;
}
