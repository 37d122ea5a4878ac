/* netcdf.c - the header of a NetCDF file in the classic formats (CDF-1, -2 and
 * -5): dimensions, attributes, variables. */
#include "report/report.h"

#include <inttypes.h>
#include <string.h>

#define MOST 2000 /* dimensions, attributes or variables of one list */

typedef struct place {
    FILE *out;
    const unsigned char *bytes;
    size_t at, end;
    int version;
} place;

static bool take(place *p, int size, uint64_t *out) {
    if (p->end - p->at < (size_t)size)
        return false;
    *out = whole_at(p->bytes + p->at, size, true);
    p->at += (size_t)size;
    return true;
}

/* Counts have 8 bytes in CDF-5. */
static bool take_count(place *p, uint64_t *out) {
    return take(p, p->version == 5 ? 8 : 4, out);
}

static bool skip(place *p, uint64_t bytes) {
    bytes += (4 - bytes % 4) % 4;
    if (bytes > p->end - p->at)
        return false;
    p->at += (size_t)bytes;
    return true;
}

static bool put_own_name(place *p, bool *known) {
    uint64_t length;
    if (!take_count(p, &length) || length > p->end - p->at)
        return false;
    const char *name = (const char *)p->bytes + p->at;
    *known = has_technical_number(name, (size_t)length);
    put_name(p->out, name, (size_t)length);
    return skip(p, length);
}

static int type_size(uint64_t type) {
    static const int sizes[] = {0, 1, 1, 2, 4, 4, 8, 1, 2, 4, 8, 8};
    return type < sizeof sizes / sizeof *sizes ? sizes[type] : 0;
}

static void put_values(place *p, uint64_t type, uint64_t count) {
    const unsigned char *b = p->bytes + p->at;
    int size = type_size(type);
    fprintf(p->out, " =");
    if (type == 2) {
        putc(' ', p->out);
        put_text(p->out, (const char *)b, (size_t)count);
        return;
    }
    for (uint64_t i = 0; i < count && i < 4; i++, b += size)
        if (type == 5 || type == 6)
            fprintf(p->out, " %.9g", real_at(b, size, true));
        else
            fprintf(p->out, " %" PRId64,
                    (int64_t)(whole_at(b, size, true) << (64 - 8 * size)) >>
                        (64 - 8 * size));
}

/* The count of a list, whose tag is 0 where it is empty. */
static bool take_list(place *p, uint64_t *count) {
    uint64_t tag;
    return take(p, 4, &tag) && take_count(p, count) && *count <= MOST;
}

static bool put_attributes(place *p, const char *indent) {
    uint64_t count, type, length;
    bool known;
    if (!take_list(p, &count))
        return false;
    for (uint64_t i = 0; i < count; i++) {
        fprintf(p->out, "%sattribute ", indent);
        if (!put_own_name(p, &known) || !take(p, 4, &type) ||
            !take_count(p, &length))
            return false;
        uint64_t bytes = length * (uint64_t)type_size(type);
        fprintf(p->out, " type %" PRIu64 " count %" PRIu64, type, length);
        if (length > p->end || bytes > p->end - p->at || !type_size(type))
            return false;
        if (known)
            put_values(p, type, length);
        putc('\n', p->out);
        if (!skip(p, bytes))
            return false;
    }
    return true;
}

static bool put_dimensions(place *p) {
    uint64_t count, length;
    bool known;
    if (!take_list(p, &count))
        return false;
    for (uint64_t i = 0; i < count; i++) {
        fprintf(p->out, "dimension %" PRIu64 " ", i);
        if (!put_own_name(p, &known) || !take_count(p, &length))
            return false;
        fprintf(p->out,
                length ? " %" PRIu64 "\n" : " unlimited (%" PRIu64 ")\n",
                length);
    }
    return true;
}

static bool put_variables(place *p) {
    uint64_t count, rank, number;
    bool known;
    if (!take_list(p, &count))
        return false;
    for (uint64_t i = 0; i < count; i++) {
        fprintf(p->out, "variable ");
        if (!put_own_name(p, &known) || !take_count(p, &rank) || rank > 64)
            return false;
        fprintf(p->out, " dimensions");
        for (uint64_t n = 0; n < rank; n++) {
            if (!take_count(p, &number))
                return false;
            fprintf(p->out, " %" PRIu64, number);
        }
        putc('\n', p->out);
        if (!put_attributes(p, "  ") || !take(p, 4, &number))
            return false;
        fprintf(p->out, "  type %" PRIu64, number);
        if (!take_count(p, &number))
            return false;
        fprintf(p->out, ", %" PRIu64 " bytes", number);
        if (!take(p, p->version == 1 ? 4 : 8, &number))
            return false;
        fprintf(p->out, " at %" PRIu64 "\n", number);
    }
    return true;
}

bool report_netcdf(FILE *out, const source *from) {
    place p = {.out = out, .bytes = from->head, .end = from->head_size};
    uint64_t records;
    if (p.end < 8 || memcmp(p.bytes, "CDF", 3) != 0)
        return false;
    p.version = p.bytes[3];
    p.at = 4;
    fprintf(out, "NetCDF, CDF-%d\n", p.version);
    if (take_count(&p, &records))
        fprintf(out, "%" PRIu64 " records\n", records);
    if (!put_dimensions(&p) || !put_attributes(&p, "") || !put_variables(&p))
        fprintf(out, "\nthe header ends, or is damaged, at byte %zu\n", p.at);
    return true;
}
