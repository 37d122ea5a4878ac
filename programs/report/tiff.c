/* tiff.c - the directories of a TIFF or BigTIFF file (TIFF 6.0, section 2):
 * tag, type, count, and numbers of technical tags. */
#include "report/report.h"

#include <inttypes.h>
#include <string.h>

#define PAGES 4 /* that are written; the others are counted */
#define VALUES 4

/* Of the standard, OME-TIFF and ImageJ. */
static const struct {
    unsigned tag;
    const char *name;
} technical[] = {
    {254, "NewSubfileType"},  {256, "ImageWidth"},
    {257, "ImageLength"},     {258, "BitsPerSample"},
    {259, "Compression"},     {262, "PhotometricInterpretation"},
    {266, "FillOrder"},       {270, "ImageDescription"},
    {273, "StripOffsets"},    {274, "Orientation"},
    {277, "SamplesPerPixel"}, {278, "RowsPerStrip"},
    {279, "StripByteCounts"}, {282, "XResolution"},
    {283, "YResolution"},     {284, "PlanarConfiguration"},
    {296, "ResolutionUnit"},  {317, "Predictor"},
    {322, "TileWidth"},       {323, "TileLength"},
    {324, "TileOffsets"},     {325, "TileByteCounts"},
    {330, "SubIFDs"},         {338, "ExtraSamples"},
    {339, "SampleFormat"},    {32997, "ImageDepth"},
    {32998, "TileDepth"},     {50838, "IJMetadataByteCounts"},
};

/* Attributes of OME-XML and keys of ImageJ's text, with numbers or words. */
static const char *const described[] = {"SizeX=\"",
                                        "SizeY=\"",
                                        "SizeZ=\"",
                                        "SizeC=\"",
                                        "SizeT=\"",
                                        "PhysicalSizeX=\"",
                                        "PhysicalSizeY=\"",
                                        "PhysicalSizeZ=\"",
                                        "DimensionOrder=\"",
                                        "Type=\"",
                                        "BigEndian=\"",
                                        "SignificantBits=\"",
                                        "SamplesPerPixel=\"",
                                        "PhysicalSizeXUnit=\"",
                                        "PhysicalSizeYUnit=\"",
                                        "PhysicalSizeZUnit=\"",
                                        "images=",
                                        "channels=",
                                        "slices=",
                                        "frames=",
                                        "hyperstack=",
                                        "spacing=",
                                        "unit=",
                                        "min=",
                                        "max="};

typedef struct entry {
    unsigned tag, type;
    uint64_t count;
    unsigned char value[8]; /* or where the values are */
} entry;

typedef struct layout {
    bool big, large;
    int word; /* bytes of offsets */
} layout;

/* Bytes of a value of a type, from 0 on. */
static int type_size(unsigned type) {
    static const int sizes[] = {0, 1, 1, 2, 4, 8, 1, 1, 2, 4,
                                8, 4, 8, 4, 0, 0, 8, 8, 8};
    return type < sizeof sizes / sizeof *sizes ? sizes[type] : 0;
}

/* The first bytes of the values of an entry. */
static size_t read_values(const source *from, const layout *f, const entry *e,
                          unsigned char *bytes, size_t room) {
    int size = type_size(e->type);
    uint64_t all =
        size && e->count < (uint64_t)1 << 40 ? e->count * (uint64_t)size : 0;
    size_t wanted = all < room ? (size_t)all : room;
    if (all > (uint64_t)f->word)
        return source_read(from, whole_at(e->value, f->word, f->big), bytes,
                           wanted);
    memcpy(bytes, e->value, wanted);
    return wanted;
}

static void put_description(FILE *out, const char *text) {
    for (size_t i = 0; i < sizeof described / sizeof *described; i++) {
        const char *found = strstr(text, described[i]);
        if (!found || (found > text && found[-1] != ' ' && found[-1] != '\n'))
            continue;
        const char *value = found + strlen(described[i]);
        fprintf(out, "    %.*s ", (int)strcspn(described[i], "="), found);
        put_text(out, value, strcspn(value, "\"\r\n"));
        putc('\n', out);
    }
}

static void put_values(FILE *out, const source *from, const layout *f,
                       const entry *e) {
    unsigned char bytes[VALUES * 8];
    int size = type_size(e->type);
    size_t there = read_values(from, f, e, bytes, sizeof bytes);
    const bool ratio = e->type == 5 || e->type == 10;
    if (!size || e->type == 2 || e->type == 7)
        return;
    fprintf(out, " =");
    for (size_t i = 0; i < VALUES && (i + 1) * (size_t)size <= there; i++) {
        const unsigned char *b = bytes + i * (size_t)size;
        if (e->type == 11 || e->type == 12)
            fprintf(out, " %.9g", real_at(b, size, f->big));
        else if (ratio)
            fprintf(out, " %" PRIu64 "/%" PRIu64, whole_at(b, 4, f->big),
                    whole_at(b + 4, 4, f->big));
        else
            fprintf(out, " %" PRIu64, whole_at(b, size, f->big));
    }
    if (e->count > VALUES)
        fprintf(out, " ...");
}

static void put_entry(FILE *out, const source *from, const layout *f,
                      const entry *e) {
    const char *name = NULL;
    for (size_t i = 0; i < sizeof technical / sizeof *technical; i++)
        if (technical[i].tag == e->tag)
            name = technical[i].name;
    fprintf(out, "  %u type %u count %" PRIu64 "%s%s", e->tag, e->type,
            e->count, name ? " " : "", name ? name : "");
    if (name)
        put_values(out, from, f, e);
    putc('\n', out);
    if (e->tag == 270 && e->type == 2) {
        char text[16385];
        text[read_values(from, f, e, (unsigned char *)text, 16384)] = '\0';
        put_description(out, text);
    }
}

/* Writes a directory, unless `out` is NULL; returns where the next is, or 0. */
static uint64_t put_page(FILE *out, const source *from, const layout *f,
                         uint64_t at) {
    unsigned char bytes[20];
    const int head = f->large ? 8 : 2, row = f->large ? 20 : 12;
    if (source_read(from, at, bytes, (size_t)head) < (size_t)head)
        return 0;
    uint64_t count = whole_at(bytes, head, f->big);
    at += (uint64_t)head;
    for (uint64_t i = 0; i < count && i < 4096; i++, at += (uint64_t)row) {
        entry e = {0};
        if (!out)
            continue;
        if (source_read(from, at, bytes, (size_t)row) < (size_t)row)
            return 0;
        e.tag = (unsigned)whole_at(bytes, 2, f->big);
        e.type = (unsigned)whole_at(bytes + 2, 2, f->big);
        e.count = whole_at(bytes + 4, f->word, f->big);
        memcpy(e.value, bytes + 4 + f->word, (size_t)f->word);
        put_entry(out, from, f, &e);
    }
    if (source_read(from, at, bytes, (size_t)f->word) < (size_t)f->word)
        return 0;
    return whole_at(bytes, f->word, f->big);
}

bool report_tiff(FILE *out, const source *from) {
    unsigned char bytes[16];
    size_t there = source_read(from, 0, bytes, sizeof bytes);
    layout f = {.big = bytes[0] == 'M', .word = 4};
    if (there < 16 || (memcmp(bytes, "II", 2) && memcmp(bytes, "MM", 2)))
        return false;
    f.large = whole_at(bytes + 2, 2, f.big) == 43;
    if (!f.large && whole_at(bytes + 2, 2, f.big) != 42)
        return false;
    f.word = f.large ? 8 : 4;
    fprintf(out, "%s, %s endian\n", f.large ? "BigTIFF" : "TIFF",
            f.big ? "big" : "little");
    uint64_t at = whole_at(bytes + f.word, f.word, f.big), pages = 0;
    for (; at && pages < 100000; pages++) {
        if (pages < PAGES)
            fprintf(out, "directory %" PRIu64 "\n", pages);
        at = put_page(pages < PAGES ? out : NULL, from, &f, at);
    }
    fprintf(out, "%" PRIu64 " director%s\n", pages, pages == 1 ? "y" : "ies");
    return true;
}
