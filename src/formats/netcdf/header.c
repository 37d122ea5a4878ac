/* formats/netcdf/header.c - reads the header of a classic NetCDF file.
 *
 * Each list gives its length; memory for the entries is allocated only if the
 * file has room for so many. */
#include "formats/netcdf/netcdf.h"

#include "formats/bytes/number.h"

#include <string.h>

/* Tags before the lists. */
enum { DIMENSIONS = 10, VARIABLES = 11, ATTRIBUTES = 12 };

/* The format's numbers of types. */
enum {
    BYTE = 1,
    CHAR,
    SHORT,
    INT,
    FLOAT,
    DOUBLE,
    UBYTE,
    USHORT,
    UINT,
    INT64,
    UINT64
};

/* A position in the header; `status` is the first error, after which nothing
 * more is read. */
typedef struct cursor {
    snow_context *context;
    snow_seekable *bytes;
    uint64_t at;
    int wide; /* bytes of a count: 4 or 8 */
    snow_status status;
} cursor;

static void fail_header(cursor *c, const char *reason) {
    if (c->status == SNOW_STATUS_OK)
        c->status = snow_fail(c->context, SNOW_STATUS_BAD_INPUT, "%s", reason);
}

static void copy_bytes(cursor *c, void *out, size_t size) {
    memset(out, 0, size);
    if (c->status != SNOW_STATUS_OK)
        return;
    if (snow_seekable_read(c->bytes, c->at, out, size) < size)
        fail_header(c, "its NetCDF header is truncated; get the file again");
    c->at += size;
}

static uint64_t take_number(cursor *c, int size) {
    unsigned char bytes[8];
    copy_bytes(c, bytes, (size_t)size);
    return snow_number_at(bytes, size, true);
}

/* A count or size, never below 0. */
static int64_t take_count(cursor *c) {
    uint64_t value = take_number(c, c->wide);
    if (value > (uint64_t)INT64_MAX || (c->wide == 4 && value > INT32_MAX)) {
        fail_header(c, "its NetCDF header has a count below 0; it is damaged");
        return 0;
    }
    return c->status == SNOW_STATUS_OK ? (int64_t)value : 0;
}

/* Bytes up to the next multiple of four. */
static void skip(cursor *c, uint64_t size) {
    uint64_t whole;
    if (!snow_add_u64(size, 3, &whole) ||
        !snow_add_u64(c->at, whole / 4 * 4, &c->at))
        fail_header(c,
                    "its NetCDF header is longer than any file; it is damaged");
}

static void take_name(cursor *c, char name[NETCDF_NAME_BYTES]) {
    int64_t length = take_count(c);
    *name = 0;
    if (length >= NETCDF_NAME_BYTES) {
        fail_header(c, "its NetCDF header has a name of more than 256 letters; "
                       "it is damaged");
        return;
    }
    uint64_t begin = c->at;
    copy_bytes(c, name, (size_t)length);
    name[length] = 0;
    c->at = begin;
    skip(c, (uint64_t)length);
}

/* The count of a list with that tag; 0 for one that is absent.  Entries have at
 * least `least` bytes. */
static int64_t take_list(cursor *c, unsigned tag, uint64_t least) {
    uint64_t found = take_number(c, 4);
    int64_t count = take_count(c);
    uint64_t size = snow_seekable_size(c->bytes);
    if (c->status == SNOW_STATUS_OK && found != tag && (found || count))
        fail_header(c, "its NetCDF header is invalid; it is damaged");
    if (c->status == SNOW_STATUS_OK && (uint64_t)count > size / least)
        fail_header(c, "its NetCDF header lists more than the file can hold; "
                       "it is damaged");
    return c->status == SNOW_STATUS_OK ? count : 0;
}

static uint64_t type_bytes(uint64_t type) {
    static const uint64_t bytes[] = {0, 1, 1, 2, 4, 4, 8, 1, 2, 4, 8, 8};
    return type <= UINT64 ? bytes[type] : 0;
}

static snow_type type_of(uint64_t type) {
    static const snow_type types[] = {
        SNOW_TYPE_NONE,    SNOW_TYPE_INT8,  SNOW_TYPE_NONE,
        SNOW_TYPE_INT16,   SNOW_TYPE_INT32, SNOW_TYPE_FLOAT32,
        SNOW_TYPE_FLOAT64, SNOW_TYPE_UINT8, SNOW_TYPE_UINT16,
        SNOW_TYPE_UINT32,  SNOW_TYPE_INT64, SNOW_TYPE_UINT64};
    return type <= UINT64 ? types[type] : SNOW_TYPE_NONE;
}

/* Takes a number and passes it. */
static cf_number take_value(cursor *c, uint64_t type) {
    unsigned char bytes[8];
    copy_bytes(c, bytes, (size_t)type_bytes(type));
    const uint64_t bits = snow_number_at(bytes, (int)type_bytes(type), true);
    switch (type) {
    case BYTE:
        return snow_cf_number((int8_t)bits);
    case SHORT:
        return snow_cf_number((int16_t)bits);
    case INT:
        return snow_cf_number((int32_t)bits);
    case INT64:
        return (cf_number){(double)(int64_t)bits, bits};
    case FLOAT:
        return snow_cf_number(snow_float_at(bytes, true));
    case DOUBLE:
        return snow_cf_number(snow_double_at(bytes, true));
    default:
        return (cf_number){(double)bits, bits};
    }
}

bool snow_netcdf_values(const netcdf_header *header, snow_seekable *bytes,
                        const netcdf_variable *v, int64_t count, double *out) {
    cursor c = {.context = header->context, .bytes = bytes};
    const uint64_t step =
        v->records ? header->record_bytes : snow_type_size(v->type);
    for (int64_t i = 0; i < count && c.status == SNOW_STATUS_OK; i++) {
        c.at = v->begin + (uint64_t)i * step;
        out[i] = take_value(&c, v->kind).value;
    }
    return c.status == SNOW_STATUS_OK;
}

/* Takes what is kept of an attribute; the position stays. */
static void take_attribute(cursor *c, uint64_t type, int64_t count,
                           cf_attribute *out) {
    const uint64_t begin = c->at;
    const int64_t room = (int64_t)sizeof out->text - 1;
    memset(out, 0, sizeof *out);
    if (type == CHAR)
        copy_bytes(c, out->text, (size_t)(count < room ? count : room));
    else
        out->count = count;
    for (int64_t i = 0; i < out->count && i < CF_MOST_NUMBERS; i++)
        out->numbers[i] = take_value(c, type);
    c->at = begin;
}

/* Passes a list of attributes, which `take` may be given. */
static void take_attributes(cursor *c, netcdf_take_fn *take, void *user) {
    char name[NETCDF_NAME_BYTES];
    cf_attribute attribute;
    int64_t count = take_list(c, ATTRIBUTES, 12);
    for (int64_t i = 0; i < count && c->status == SNOW_STATUS_OK; i++) {
        take_name(c, name);
        uint64_t type = take_number(c, 4), bytes;
        int64_t values = take_count(c);
        if (c->status == SNOW_STATUS_OK && !type_bytes(type))
            fail_header(c,
                        "its NetCDF header has an unknown type; it is damaged");
        if (c->status != SNOW_STATUS_OK)
            return;
        if (take) {
            take_attribute(c, type, values, &attribute);
            take(user, name, &attribute);
        }
        if (!snow_mul_u64((uint64_t)values, type_bytes(type), &bytes))
            bytes = UINT64_MAX - 8;
        skip(c, bytes);
    }
}

void snow_netcdf_attributes(const netcdf_header *header, snow_seekable *bytes,
                            const netcdf_variable *v, netcdf_take_fn *take,
                            void *user) {
    cursor c = {.context = header->context,
                .bytes = bytes,
                .at = v ? v->attributes : header->attributes,
                .wide = header->version == 5 ? 8 : 4};
    take_attributes(&c, take, user);
}

/* NULL after an error. */
static void *make_list(cursor *c, int64_t count, size_t size) {
    if (c->status != SNOW_STATUS_OK)
        return NULL;
    void *list = snow_allocate_array(c->context, (uint64_t)count, size);
    c->status = list ? SNOW_STATUS_OK : SNOW_STATUS_NO_MEMORY;
    return list;
}

static void take_dimensions(cursor *c, netcdf_header *header) {
    const int64_t count = take_list(c, DIMENSIONS, 8);
    header->dimensions = make_list(c, count, sizeof *header->dimensions);
    header->dimension_count = header->dimensions ? count : 0;
    for (int64_t i = 0; i < header->dimension_count; i++) {
        netcdf_dimension *d = &header->dimensions[i];
        take_name(c, d->name);
        d->size = take_count(c);
        d->records = d->size == 0;
    }
}

/* Reads the variable's axes, and computes the bytes per index along each axis,
 * except that of the records. */
static void take_axes(cursor *c, const netcdf_header *header,
                      netcdf_variable *v) {
    v->axes = take_count(c);
    v->bytes = 1;
    for (int64_t i = 0; i < v->axes && c->status == SNOW_STATUS_OK; i++) {
        int64_t index = take_count(c);
        if (c->status == SNOW_STATUS_OK && index >= header->dimension_count)
            fail_header(c, "a variable has a dimension that does not exist; "
                           "the file is damaged");
        if (c->status != SNOW_STATUS_OK)
            return;
        const netcdf_dimension *d = &header->dimensions[index];
        if (i < NETCDF_MOST_AXES)
            v->axis[i] = index;
        if (d->records && i == 0)
            v->records = true;
        else if (d->records)
            fail_header(c, "a variable has the records not as its first "
                           "dimension; the file is damaged");
        else if (!snow_mul_u64(v->bytes, (uint64_t)d->size, &v->bytes) ||
                 v->bytes > (uint64_t)INT64_MAX / 8)
            fail_header(c,
                        "a variable is too large for any file; it is damaged");
    }
}

static void take_variable(cursor *c, netcdf_header *header,
                          netcdf_variable *v) {
    memset(v, 0, sizeof *v);
    take_name(c, v->name);
    take_axes(c, header, v);
    v->attributes = c->at;
    take_attributes(c, NULL, NULL);
    uint64_t type = v->kind = take_number(c, 4);
    v->type = type_of(type);
    if (c->status == SNOW_STATUS_OK && !type_bytes(type))
        fail_header(c, "its NetCDF header has an unknown type; it is damaged");
    v->bytes *= type_bytes(type);
    take_count(c); /* the size, which is wrong in some files */
    v->begin = take_number(c, header->version == 1 ? 4 : 8);
}

static void take_variables(cursor *c, netcdf_header *header) {
    const int64_t count = take_list(c, VARIABLES, 28);
    header->variables = make_list(c, count, sizeof *header->variables);
    for (int64_t i = 0; i < count && c->status == SNOW_STATUS_OK; i++) {
        take_variable(c, header, &header->variables[i]);
        header->variable_count = i + 1;
    }
}

/* Parts of a record begin at multiples of four, except if a record has only one
 * variable. */
static void measure_records(cursor *c, netcdf_header *header) {
    uint64_t sum = 0, first = UINT64_MAX;
    const netcdf_variable *only = NULL;
    int count = 0;
    for (int64_t i = 0; i < header->variable_count; i++) {
        const netcdf_variable *v = &header->variables[i];
        if (!v->records)
            continue;
        only = v;
        count++;
        if (v->begin < first)
            first = v->begin;
        if (!snow_add_u64(sum, (v->bytes + 3) / 4 * 4, &sum) ||
            sum > (uint64_t)INT64_MAX)
            fail_header(c, "a record is too large for any file; it is damaged");
    }
    header->record_bytes = count == 1 ? only->bytes : sum;
    if (header->records >= 0 || c->status != SNOW_STATUS_OK)
        return;
    /* A program that still writes does not give the number of records. */
    uint64_t size = snow_seekable_size(c->bytes);
    header->records = header->record_bytes && first < size
                          ? (int64_t)((size - first) / header->record_bytes)
                          : 0;
}

snow_status snow_netcdf_read_header(snow_context *context, snow_seekable *bytes,
                                    netcdf_header *out) {
    cursor c = {.context = context, .bytes = bytes, .wide = 4};
    unsigned char magic[4];
    *out = (netcdf_header){.context = context};
    copy_bytes(&c, magic, sizeof magic);
    out->version = magic[3];
    if (memcmp(magic, "CDF", 3) != 0 ||
        (out->version != 1 && out->version != 2 && out->version != 5))
        fail_header(&c, "is not a NetCDF file of version 1, 2 or 5, although "
                        "its name says so; get it again");
    if (out->version == 5)
        c.wide = 8;
    uint64_t records = take_number(&c, c.wide);
    bool streaming = records == (c.wide == 4 ? UINT32_MAX : UINT64_MAX);
    if (!streaming && records > (uint64_t)INT64_MAX)
        fail_header(&c, "its NetCDF header has a count below 0; it is damaged");
    out->records = streaming ? -1 : (int64_t)records;
    take_dimensions(&c, out);
    out->attributes = c.at;
    take_attributes(&c, NULL, NULL);
    take_variables(&c, out);
    measure_records(&c, out);
    for (int64_t i = 0; i < out->dimension_count && c.status == SNOW_STATUS_OK;
         i++)
        if (out->dimensions[i].records)
            out->dimensions[i].size = out->records;
    return c.status;
}

void snow_netcdf_free_header(netcdf_header *header) {
    snow_release(header->context, header->dimensions);
    snow_release(header->context, header->variables);
}
