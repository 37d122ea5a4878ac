/* nifti.c - the fields of a header of NIfTI-1 or -2 (nifti1.h, nifti2.h), which
 * stand at fixed places; of texts the length. */
#include "report/report.h"

#include <inttypes.h>

/* Kinds: i whole, f real, t text.  A size of 0: the version has none. */
static const struct {
    const char *name;
    int at1, size1, at2, size2, count;
    char kind;
} fields[] = {
    {"sizeof_hdr", 0, 4, 0, 4, 1, 'i'},
    {"magic", 344, 1, 4, 1, 4, 'm'},
    {"dim", 40, 2, 16, 8, 8, 'i'},
    {"datatype", 70, 2, 12, 2, 1, 'i'},
    {"bitpix", 72, 2, 14, 2, 1, 'i'},
    {"pixdim", 76, 4, 104, 8, 8, 'f'},
    {"vox_offset", 108, 4, 168, 8, 1, 'v'},
    {"scl_slope", 112, 4, 176, 8, 1, 'f'},
    {"scl_inter", 116, 4, 184, 8, 1, 'f'},
    {"cal_max", 124, 4, 192, 8, 1, 'f'},
    {"cal_min", 128, 4, 200, 8, 1, 'f'},
    {"slice_duration", 132, 4, 208, 8, 1, 'f'},
    {"toffset", 136, 4, 216, 8, 1, 'f'},
    {"intent_code", 68, 2, 504, 4, 1, 'i'},
    {"xyzt_units", 123, 1, 500, 4, 1, 'i'},
    {"qform_code", 252, 2, 344, 4, 1, 'i'},
    {"sform_code", 254, 2, 348, 4, 1, 'i'},
    {"quatern_b, c, d", 256, 4, 352, 8, 3, 'f'},
    {"qoffset_x, y, z", 268, 4, 376, 8, 3, 'f'},
    {"srow_x", 280, 4, 400, 8, 4, 'f'},
    {"srow_y", 296, 4, 432, 8, 4, 'f'},
    {"srow_z", 312, 4, 464, 8, 4, 'f'},
    {"data_type", 4, 1, 0, 0, 10, 't'},
    {"db_name", 14, 1, 0, 0, 18, 't'},
    {"descrip", 148, 1, 240, 1, 80, 't'},
    {"aux_file", 228, 1, 320, 1, 24, 't'},
    {"intent_name", 328, 1, 508, 1, 16, 't'},
};

static void put_field(FILE *out, const unsigned char *at, int size, int count,
                      char kind, bool big) {
    size_t used = 0;
    if (kind == 't') {
        while (used < (size_t)count && at[used])
            used++;
        fprintf(out, " %zu of %d bytes\n", used, count);
        return;
    }
    for (int i = 0; i < count; i++, at += size) {
        uint64_t whole = whole_at(at, size, big);
        if (kind == 'm')
            fprintf(out, " %02x", *at);
        else if (kind == 'f' || (kind == 'v' && size == 4))
            fprintf(out, " %.9g", real_at(at, size, big));
        else
            fprintf(out, " %" PRId64,
                    size == 2   ? (int64_t)(int16_t)whole
                    : size == 4 ? (int64_t)(int32_t)whole
                                : (int64_t)whole);
    }
    putc('\n', out);
}

/* Blocks of 16 bytes and more behind the header; what they hold is not said. */
static void put_extensions(FILE *out, const source *from, size_t at, bool big) {
    if (at + 4 > from->head_size || !from->head[at])
        return;
    for (at += 4; at + 8 <= from->head_size;) {
        uint64_t size = whole_at(from->head + at, 4, big);
        fprintf(out, "extension: code %" PRIu64 ", %" PRIu64 " bytes\n",
                whole_at(from->head + at + 4, 4, big), size);
        if (size < 16 || size > from->head_size - at)
            return;
        at += size;
    }
}

bool report_nifti(FILE *out, const source *from) {
    bool big = false, second = false;
    for (int i = 0; i < 4; i++) {
        big = i & 1;
        second = i & 2;
        size_t size = second ? 540 : 348;
        if (from->head_size < size || whole_at(from->head, 4, big) != size)
            continue;
        fprintf(out, "NIfTI-%d or Analyze, %s endian\n", second ? 2 : 1,
                big ? "big" : "little");
        for (size_t n = 0; n < sizeof fields / sizeof *fields; n++) {
            int bytes = second ? fields[n].size2 : fields[n].size1;
            if (bytes == 0)
                continue;
            fprintf(out, "%-16s", fields[n].name);
            put_field(out,
                      from->head + (second ? fields[n].at2 : fields[n].at1),
                      bytes, fields[n].count, fields[n].kind, big);
        }
        put_extensions(out, from, size, big);
        return true;
    }
    return false;
}
