/* dicom.c - the elements of a DICOM file (PS3.5, 7; PS3.10, 7.1): tag, value
 * representation, length, and the values of technical elements. */
#include "report/report.h"

#include <inttypes.h>
#include <string.h>

#define UNDEFINED 0xffffffffu
#define DEPTH 8   /* sequences within one another */
#define ITEMS 2   /* of a sequence that are written; the others are alike */
#define VALUES 16 /* numbers of an element */

/* Elements whose values say nothing of people, if they hold what they should.
 */
static const struct {
    uint32_t tag;
    const char *keyword;
} technical[] = {
    {0x00020002, "MediaStorageSOPClassUID"},
    {0x00020010, "TransferSyntaxUID"},
    {0x00080008, "ImageType"},
    {0x00080016, "SOPClassUID"},
    {0x00080060, "Modality"},
    {0x00180050, "SliceThickness"},
    {0x00180088, "SpacingBetweenSlices"},
    {0x00181164, "ImagerPixelSpacing"},
    {0x00185100, "PatientPosition"},
    {0x00200032, "ImagePositionPatient"},
    {0x00200037, "ImageOrientationPatient"},
    {0x00200100, "TemporalPositionIdentifier"},
    {0x00200105, "NumberOfTemporalPositions"},
    {0x00201041, "SliceLocation"},
    {0x00280002, "SamplesPerPixel"},
    {0x00280004, "PhotometricInterpretation"},
    {0x00280006, "PlanarConfiguration"},
    {0x00280008, "NumberOfFrames"},
    {0x00280010, "Rows"},
    {0x00280011, "Columns"},
    {0x00280030, "PixelSpacing"},
    {0x00280034, "PixelAspectRatio"},
    {0x00280100, "BitsAllocated"},
    {0x00280101, "BitsStored"},
    {0x00280102, "HighBit"},
    {0x00280103, "PixelRepresentation"},
    {0x00280106, "SmallestImagePixelValue"},
    {0x00280107, "LargestImagePixelValue"},
    {0x00280120, "PixelPaddingValue"},
    {0x00281050, "WindowCenter"},
    {0x00281051, "WindowWidth"},
    {0x00281052, "RescaleIntercept"},
    {0x00281053, "RescaleSlope"},
    {0x00281054, "RescaleType"},
    {0x00281056, "VOILUTFunction"},
    {0x00281101, "RedPaletteColorLookupTableDescriptor"},
    {0x00282110, "LossyImageCompression"},
    {0x00289110, "PixelMeasuresSequence"},
    {0x00289132, "FrameVOILUTSequence"},
    {0x00289145, "PixelValueTransformationSequence"},
    {0x00209111, "FrameContentSequence"},
    {0x00209113, "PlanePositionSequence"},
    {0x00209116, "PlaneOrientationSequence"},
    {0x00209157, "DimensionIndexValues"},
    {0x00541001, "Units"},
    {0x00541102, "DecayCorrection"},
    {0x00620001, "SegmentationType"},
    {0x00620004, "SegmentNumber"},
    {0x3004000c, "GridFrameOffsetVector"},
    {0x3004000e, "DoseGridScaling"},
    {0x52009229, "SharedFunctionalGroupsSequence"},
    {0x52009230, "PerFrameFunctionalGroupsSequence"},
    {0x7fe00010, "PixelData"},
};

/* A place in the elements. */
typedef struct walk {
    FILE *out, *nowhere;
    const unsigned char *bytes;
    size_t at, end;
    bool explicit, big;
    bool cut; /* bytes is a first part */
    int depth;
} walk;

typedef struct element {
    uint32_t tag, length;
    char vr[3];
} element;

static const char *keyword_of(uint32_t tag) {
    for (size_t i = 0; i < sizeof technical / sizeof *technical; i++)
        if (technical[i].tag == tag)
            return technical[i].keyword;
    return NULL;
}

static bool is_vr(const char *vr, const char *list) {
    const char *found = strstr(list, vr);
    return found && (found - list) % 3 == 0;
}

/* Reads a tag, its representation and length; false at the end, or where no
 * element is. */
static bool read_element(walk *w, element *e) {
    if (w->end - w->at < 8)
        return false;
    const unsigned char *b = w->bytes + w->at;
    e->tag =
        (uint32_t)(whole_at(b, 2, w->big) << 16 | whole_at(b + 2, 2, w->big));
    strcpy(e->vr, "--");
    w->at += 8;
    if (!w->explicit || e->tag >> 16 == 0xfffe) {
        e->length = (uint32_t)whole_at(b + 4, 4, w->big);
        return true;
    }
    memcpy(e->vr, b + 4, 2);
    if (!is_vr(e->vr, "AE AS AT CS DA DS DT FD FL IS LO LT PN SH SL SS ST TM "
                      "UI UL US OB OD OF OL OV OW SQ SV UC UN UR UT UV "))
        return false;
    if (!is_vr(e->vr, "OB OD OF OL OV OW SQ SV UC UN UR UT UV ")) {
        e->length = (uint32_t)whole_at(b + 6, 2, w->big);
        return true;
    }
    if (w->end - w->at < 4)
        return false;
    e->length = (uint32_t)whole_at(b + 8, 4, w->big);
    w->at += 4;
    return true;
}

static void put_numbers(const walk *w, const unsigned char *bytes,
                        uint32_t length, int size, char kind) {
    for (uint32_t i = 0; i < length / (uint32_t)size && i < VALUES; i++) {
        const unsigned char *b = bytes + i * (uint32_t)size;
        uint64_t whole = whole_at(b, size, w->big);
        if (kind == 'f')
            fprintf(w->out, " %.9g", real_at(b, size, w->big));
        else if (kind == 's')
            fprintf(w->out, " %d",
                    size == 2 ? (int)(int16_t)whole : (int)(int32_t)whole);
        else
            fprintf(w->out, " %" PRIu64, whole);
    }
    if (length / (uint32_t)size > VALUES)
        fprintf(w->out, " ...");
}

/* Only those that the standard itself gives, so that none is of a person. */
static void put_uid(FILE *out, const char *text, uint32_t length) {
    static const char root[] = "1.2.840.10008.";
    while (length && (text[length - 1] == '\0' || text[length - 1] == ' '))
        length--;
    bool known = length > sizeof root && length <= 64 &&
                 memcmp(text, root, sizeof root - 1) == 0;
    for (uint32_t i = 0; known && i < length; i++)
        known = (text[i] >= '0' && text[i] <= '9') || text[i] == '.';
    if (known)
        fprintf(out, " %.*s", (int)length, text);
    else
        fprintf(out, " text of %" PRIu32 " bytes", length);
}

/* Without the representation these are short whole numbers, or text. */
static void put_value(const walk *w, const element *e) {
    const unsigned char *bytes = w->bytes + w->at;
    const bool whole =
        (e->tag >> 16 == 0x0028 &&
         ((e->tag & 0xffff) <= 0x0011 || ((e->tag & 0xff00) == 0x0100)) &&
         e->length == 2);
    fprintf(w->out, " =");
    if (is_vr(e->vr, "US OW ") || (!w->explicit && whole))
        put_numbers(w, bytes, e->length, 2, 'u');
    else if (is_vr(e->vr, "SS "))
        put_numbers(w, bytes, e->length, 2, 's');
    else if (is_vr(e->vr, "UL AT "))
        put_numbers(w, bytes, e->length, 4, 'u');
    else if (is_vr(e->vr, "SL "))
        put_numbers(w, bytes, e->length, 4, 's');
    else if (is_vr(e->vr, "FL "))
        put_numbers(w, bytes, e->length, 4, 'f');
    else if (is_vr(e->vr, "FD "))
        put_numbers(w, bytes, e->length, 8, 'f');
    else if (strstr(keyword_of(e->tag), "UID"))
        put_uid(w->out, (const char *)bytes, e->length);
    else {
        putc(' ', w->out);
        put_text(w->out, (const char *)bytes, e->length);
    }
}

static void put_elements(walk *w);

/* The items of a sequence, or the fragments of packed pixels, which have no
 * elements.  `end` is where they end at the latest. */
static void put_items(walk *w, const element *of, size_t end) {
    const bool pixels = of->tag == 0x7fe00010;
    const size_t all = w->end;
    uint64_t count = 0, bytes = 0;
    element item;
    while (w->at < end && read_element(w, &item) && item.tag == 0xfffee000) {
        FILE *out = w->out;
        size_t stop = item.length == UNDEFINED ? end : w->at + item.length;
        w->end = stop < end ? stop : end;
        if (pixels || item.length == 0 || w->depth >= DEPTH)
            w->at = w->end;
        else {
            if (count >= ITEMS) /* is walked for its end */
                w->out = w->nowhere;
            w->depth++;
            put_elements(w);
            w->depth--;
            w->out = out;
            if (item.length != UNDEFINED)
                w->at = stop < all ? stop : all;
        }
        w->end = all;
        bytes += item.length == UNDEFINED ? 0 : item.length;
        count++;
    }
    fprintf(w->out, "%*s%" PRIu64 " %s%s", 2 * w->depth + 2, "", count,
            pixels ? "fragment" : "item", count == 1 ? "" : "s");
    if (pixels)
        fprintf(w->out, " of %" PRIu64 " bytes", bytes);
    putc('\n', w->out);
}

/* Up to the end, the end of an item, or what is no element. */
static void put_elements(walk *w) {
    element e;
    size_t start;
    while (start = w->at, read_element(w, &e)) {
        if (e.tag == 0xfffee00d || e.tag == 0xfffee0dd)
            return;
        const char *keyword = keyword_of(e.tag);
        const bool nested = e.length == UNDEFINED || is_vr(e.vr, "SQ ") ||
                            (keyword && strstr(keyword, "Sequence"));
        fprintf(w->out, "%*s(%04x,%04x) %s", 2 * w->depth, "", e.tag >> 16,
                e.tag & 0xffff, e.vr);
        if (e.length == UNDEFINED)
            fprintf(w->out, " undefined length");
        else
            fprintf(w->out, " %" PRIu32, e.length);
        if (keyword)
            fprintf(w->out, " %s", keyword);
        const size_t left = w->end - w->at;
        if (e.length != UNDEFINED && e.length > left && !w->cut)
            fprintf(w->out, "; only %zu bytes follow", left);
        else if (keyword && !nested && e.tag != 0x7fe00010 && e.length < 4096 &&
                 e.length <= left)
            put_value(w, &e);
        putc('\n', w->out);
        size_t end = e.length == UNDEFINED || e.length > left
                         ? w->end
                         : w->at + e.length;
        const bool explicit = w->explicit;
        w->explicit &= !is_vr(e.vr, "UN "); /* PS3.5, 6.2.2 */
        if (nested)
            put_items(w, &e, end);
        w->explicit = explicit;
        if (e.length != UNDEFINED)
            w->at = end;
    }
    if (start < w->end)
        fprintf(w->out, "%*sno element at byte %zu of %zu\n", 2 * w->depth, "",
                start, w->end);
}

/* The value of (0002,0010), and where group 2 ends: it is explicit and little
 * endian. */
static void read_meta(walk *w, char syntax[65]) {
    walk meta = *w;
    element e;
    meta.explicit = true;
    while (w->at = meta.at, read_element(&meta, &e) && e.tag >> 16 == 2 &&
                                e.length <= meta.end - meta.at) {
        if (e.tag == 0x00020010 && e.length < 65) {
            memcpy(syntax, meta.bytes + meta.at, e.length);
            syntax[e.length] = '\0';
            syntax[strcspn(syntax, " ")] = '\0';
        }
        meta.at += e.length;
    }
}

/* Files of old programs lack the mark and begin with group 8. */
static bool looks_bare(const walk *w) {
    walk test = *w;
    element e;
    return read_element(&test, &e) && e.tag >> 16 == 8 &&
           e.length <= test.end - test.at;
}

static bool put_file(walk *from) {
    walk w = *from;
    char syntax[66] = "1.2.840.10008.1.2";
    if (w.end >= 132 && memcmp(w.bytes + 128, "DICM", 4) == 0) {
        walk meta = w;
        w.at = meta.at = 132;
        read_meta(&w, syntax);
        fprintf(w.out, "DICOM, with preamble\n");
        meta.end = w.at;
        meta.explicit = true;
        put_elements(&meta);
    } else if (w.explicit = true, !looks_bare(&w)) {
        w.explicit = false;
        if (!looks_bare(&w))
            return false;
        fprintf(w.out, "DICOM without preamble\n");
    } else {
        strcpy(syntax, "1.2.840.10008.1.2.1");
        fprintf(w.out, "DICOM without preamble\n");
    }
    w.explicit = strcmp(syntax, "1.2.840.10008.1.2") != 0;
    w.big = strcmp(syntax, "1.2.840.10008.1.2.2") == 0;
    if (strcmp(syntax, "1.2.840.10008.1.2.1.99") == 0)
        fprintf(w.out, "elements are deflated and not listed\n");
    else
        put_elements(&w);
    return true;
}

bool report_dicom(FILE *out, const source *from) {
    walk w = {.out = out,
              .nowhere = fopen("/dev/null", "w"),
              .bytes = from->head,
              .end = from->head_size,
              .cut = from->head_size == SOURCE_HEAD};
    bool is = w.nowhere && put_file(&w);
    if (w.nowhere)
        fclose(w.nowhere);
    return is;
}
