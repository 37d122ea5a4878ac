/* tests/parallel/test_ranks_open.c - many ranks open one file: each gets its
 * part of it, whole and with its ghosts, and little more is read than there is.
 */
#include "support/files.h"
#include "support/opened.h"

#include "classify/count_interesting.h"
#include "render/ghosts.h"
#include "transfer/transfer.h"
#include "volume/volume.h"

#include <math.h>
#include <pthread.h>
#include <sys/stat.h>
#include <unistd.h>

#define MOST_RANKS 33

/* What all ranks are asked, and what each answers. */
typedef struct order {
    const char *path, *wrong; /* the path on rank `odd` */
    int odd;                  /* -1: none */
    snow_volume_options options;
    snow_view view, turned;
    bool turn;
    uint64_t memory; /* of each rank; 0: no limit */
    snow_look look;  /* zeros: automatic */
    snow_settings settings;
    snow_ranks_options how;
    const snow_volume *whole;
    const snow_transfer *expected;
    snow_extent parts[MOST_RANKS];
    int64_t stored[MOST_RANKS];
    uint64_t read[MOST_RANKS];
} order;

static void begin_order(order *o, const snow_volume *whole) {
    *o = (order){.odd = -1, .whole = whole, .how.size = sizeof o->how};
    for (int rank = 0; rank < MOST_RANKS; rank++)
        snow_extent_init(&o->parts[rank]);
    snow_volume_options_init(&o->options);
    snow_look_init(&o->look);
    snow_settings_init(&o->settings);
    snow_view_init(&o->view);
    snow_view_default(whole, &o->view);
    o->turned = o->view;
}

static void set_view(support_files *place, const char *name, order *o) {
    assert_int_equal(snow_view_from_name(place->context, name, &o->view),
                     SNOW_STATUS_OK);
}

/* A phantom that ranks make themselves; its path begins with "phantom:". */
static snow_volume *phantom(support_files *place, const char *path, int64_t x,
                            int64_t y, int64_t z, order *o) {
    const int64_t dims[3] = {x, y, z};
    snow_volume *whole;
    assert_int_equal(
        snow_volume_open_phantom(place->context, path + 8, dims, 0, &whole),
        SNOW_STATUS_OK);
    begin_order(o, whole);
    o->path = path;
    memcpy(o->options.dims, dims, sizeof dims);
    return whole;
}

/* Every stored voxel is that of the whole, in its place in the world. */
static snow_status check_voxels(snow_comm *comm, const order *o,
                                const snow_volume *volume) {
    snow_extent part = {.size = sizeof part};
    snow_volume_info whole = {.size = sizeof whole};
    const snow_volume_info *all = &o->whole->info;
    size_t size = snow_type_size(all->type);
    const int64_t *dims = volume->info.dims;
    snow_volume_get_extent(volume, &part);
    snow_volume_whole(volume, &whole);
    CHECK(volume->info.type == all->type);
    CHECK(!memcmp(part.dims, all->dims, sizeof part.dims));
    CHECK(!memcmp(whole.dims, all->dims, sizeof part.dims));
    CHECK(!memcmp(whole.matrix, all->matrix, sizeof whole.matrix));
    for (int i = 0; i < 3; i++) {
        double place = all->matrix[i][3];
        for (int j = 0; j < 3; j++)
            place += all->matrix[i][j] * (double)part.stored[j];
        double off = volume->info.matrix[i][3] - place;
        CHECK(off < 1e-9 && off > -1e-9);
    }
    bool none = !part.count[0] || !part.count[1] || !part.count[2];
    const char *to = volume->voxels;
    for (int64_t z = 0; z < dims[2] && !none; z++)
        for (int64_t y = 0; y < dims[1]; y++) {
            int64_t at =
                ((part.stored[2] + z) * part.dims[1] + part.stored[1] + y) *
                    part.dims[0] +
                part.stored[0];
            CHECK(!memcmp((const char *)o->whole->voxels + (size_t)at * size,
                          to, (size_t)dims[0] * size));
            to += (size_t)dims[0] * size;
        }
    return SNOW_STATUS_OK;
}

/* Ghosts on every side that has a neighbour, as many as the view needs. */
static snow_status check_ghosts(snow_comm *comm, const order *o,
                                const snow_view *view,
                                const snow_volume *volume) {
    snow_extent part = {.size = sizeof part};
    int64_t layers[3];
    snow_volume_get_extent(volume, &part);
    SNOW_TRY(snow_ghosts_needed(
        snow_comm_context(comm), &o->whole->info, view, &o->settings,
        o->look.gradient_opacities != NULL, o->how.turns != 0, layers));
    for (int i = 0; i < 3 && part.count[0] && part.count[1] && part.count[2];
         i++) {
        int64_t below = part.first[i] - layers[i];
        int64_t end = part.first[i] + part.count[i] + layers[i];
        if (end > part.dims[i])
            end = part.dims[i];
        CHECK(part.stored[i] <= (below > 0 ? below : 0));
        CHECK(part.stored[i] + volume->info.dims[i] >= end);
    }
    return SNOW_STATUS_OK;
}

static snow_status check_transfer(snow_comm *comm, const order *o,
                                  const snow_transfer *transfer) {
    const snow_transfer *e = o->expected;
    CHECK(!e || !strcmp(e->text, transfer->text));
    CHECK(!e || (e->opacity_count == transfer->opacity_count &&
                 !memcmp(e->opacities, transfer->opacities,
                         e->opacity_count * sizeof *e->opacities)));
    return SNOW_STATUS_OK;
}

static snow_status turn_part(opened *part, const order *o) {
    snow_comm *comm = part->comm;
    uint64_t read = snow_context_bytes_read(snow_comm_context(comm));
    const snow_volume *before = part->volume;
    SNOW_TRY(opened_cut(part, &o->view));
    CHECK(before == part->volume);
    SNOW_TRY(opened_cut(part, &o->turned));
    CHECK(read == snow_context_bytes_read(snow_comm_context(comm)));
    SNOW_TRY(check_ghosts(comm, o, &o->turned, part->volume));
    before = part->volume;
    SNOW_TRY(opened_cut(part, &o->turned));
    CHECK(before == part->volume);
    return SNOW_STATUS_OK;
}

static snow_status open_part(snow_comm *comm, void *user) {
    order *o = user;
    int rank = snow_comm_rank(comm);
    const opened_request request = {.path = rank == o->odd ? o->wrong : o->path,
                                    .options = o->options,
                                    .look = o->look,
                                    .view = o->view,
                                    .settings = o->settings,
                                    .how = o->how};
    opened part;
    snow_context_set_memory_limit(snow_comm_context(comm), o->memory);
    SNOW_TRY(opened_enter(comm, &request, &part));
    o->read[rank] = snow_context_bytes_read(snow_comm_context(comm));
    snow_status status = check_transfer(comm, o, part.transfer);
    if (status == SNOW_STATUS_OK)
        status = check_ghosts(comm, o, &o->view, part.volume);
    /* The others would wait for a rank that does not turn. */
    status = snow_comm_agree_status(comm, status);
    if (status == SNOW_STATUS_OK && o->turn)
        status = turn_part(&part, o);
    if (status == SNOW_STATUS_OK && !part.volume->stream)
        status = check_voxels(comm, o, part.volume);
    snow_volume_get_extent(part.volume, &o->parts[rank]);
    const int64_t *dims = part.volume->info.dims;
    o->stored[rank] = dims[0] * dims[1] * dims[2];
    opened_leave(&part);
    return status;
}

/* Each voxel is owned by one rank. */
static void check_cover(const order *o, int ranks) {
    const int64_t *dims = o->whole->info.dims;
    size_t voxels = (size_t)(dims[0] * dims[1] * dims[2]);
    unsigned char *seen = calloc(voxels, 1);
    assert_non_null(seen);
    for (int rank = 0; rank < ranks; rank++) {
        const snow_extent *p = &o->parts[rank];
        for (int64_t z = 0; z < p->count[2]; z++)
            for (int64_t y = 0; y < p->count[1]; y++)
                for (int64_t x = 0; x < p->count[0]; x++)
                    seen[((p->first[2] + z) * dims[1] + p->first[1] + y) *
                             dims[0] +
                         p->first[0] + x]++;
    }
    for (size_t i = 0; i < voxels; i++)
        assert_int_equal(seen[i], 1);
    free(seen);
}

static void open_by(support_files *place, order *o, int ranks) {
    if (snow_comm_run_threads(place->context, ranks, open_part, o) !=
        SNOW_STATUS_OK)
        fail_msg("%d ranks, cut %d: %s", ranks, o->how.cut,
                 snow_context_message(place->context));
    check_cover(o, ranks);
}

/* All ranks fail alike; the message has these words. */
static void refused_by(support_files *place, order *o, int ranks,
                       snow_status status, const char *words) {
    assert_int_equal(snow_comm_run_threads(place->context, ranks, open_part, o),
                     status);
    assert_non_null(strstr(snow_context_message(place->context), words));
}

/* The phantom engine, small, as a file. */
static const char *put_engine(support_files *place, const char *name) {
    const int64_t dims[3] = {40, 36, 30};
    snow_volume *volume;
    assert_int_equal(
        snow_volume_open_phantom(place->context, "engine", dims, 0, &volume),
        SNOW_STATUS_OK);
    const char *path = support_path(place, name);
    assert_int_equal(snow_volume_save(volume, path, true), SNOW_STATUS_OK);
    snow_volume_close(volume);
    return path;
}

static void every_rank_gets_its_part(void **state) {
    support_files *place = *state;
    static const char *const names[] = {"e.nrrd", "e.nii.gz", "e.mha",
                                        "phantom:head"};
    static const int ranks[] = {1, 2, 3, 8, 33};
    for (size_t n = 0; n < sizeof names / sizeof *names; n++) {
        char path[256];
        snprintf(path, sizeof path, "%s",
                 n < 3 ? put_engine(place, names[n]) : names[n]);
        snow_volume_options options = {
            .size = sizeof options, .spacing = {1, 1.5, 2}, .crop = {{0, 0}}};
        if (n == 0) { /* dealt out like a volume */
            options.crop[0][0] = 5;
            options.crop[0][1] = 33;
            options.crop[2][0] = 11;
            options.crop[2][1] = 29;
        }
        if (n == 3)
            options.dims[0] = options.dims[1] = options.dims[2] = 37;
        snow_volume *whole;
        snow_transfer *expected;
        assert_int_equal(
            snow_volume_open(place->context, path, &options, &whole),
            SNOW_STATUS_OK);
        assert_int_equal(snow_transfer_new_for_volume(whole, NULL, &expected),
                         SNOW_STATUS_OK);
        for (int cut = SNOW_PARTITION_AUTO; cut <= SNOW_PARTITION_BRICKS; cut++)
            for (int i = 0; i < 5; i++) {
                if (!support_takes((n * 4 + (size_t)cut) * 5 + (size_t)i, 7))
                    continue;
                order o;
                begin_order(&o, whole);
                o.path = path;
                o.options = options;
                o.expected = expected;
                o.how.cut = (snow_partition)cut;
                o.view.azimuth = 40.0 * i;
                open_by(place, &o, ranks[i]);
            }
        snow_transfer_free(expected);
        snow_volume_close(whole);
    }
}

static void slabs_lie_along_the_slice_axis(void **state) {
    support_files *place = *state;
    static const char *const views[] = {"+x", "+y", "+z"};
    for (int n = 0; n < 6; n++) {
        order o;
        snow_volume *whole = phantom(place, "phantom:engine", 40, 36, 30, &o);
        o.how.cut = n < 3 ? SNOW_PARTITION_EQUAL : SNOW_PARTITION_COUNTED;
        set_view(place, views[n % 3], &o);
        open_by(place, &o, 5);
        for (int rank = 0; rank < 5; rank++)
            for (int i = 0; i < 3; i++)
                assert_true(
                    i == n % 3
                        ? o.parts[rank].count[i] < whole->info.dims[i] / 2
                        : o.parts[rank].count[i] == whole->info.dims[i]);
        snow_volume_close(whole);
    }
}

/* 12 MB: what all ranks read together is the file and a buffer for each header,
 * or the equal slabs with their ghosts; nobody reads more than its share. */
static void the_file_is_read_once(void **state) {
    support_files *place = *state;
    const int64_t dims[3] = {192, 160, 200};
    const uint64_t slice = 192 * 160;
    snow_volume *whole;
    assert_int_equal(
        snow_volume_open_phantom(place->context, "engine", dims, 0, &whole),
        SNOW_STATUS_OK);
    char path[256];
    snprintf(path, sizeof path, "%s", support_path(place, "e.nrrd"));
    assert_int_equal(snow_volume_save(whole, path, true), SNOW_STATUS_OK);
    for (int cut = SNOW_PARTITION_EQUAL; cut <= SNOW_PARTITION_BRICKS; cut++) {
        order o;
        begin_order(&o, whole);
        o.path = path;
        set_view(place, "+z", &o);
        o.how.cut = (snow_partition)cut;
        open_by(place, &o, 8);
        uint64_t sum = 0, most = 0;
        int64_t stored = 0;
        for (int rank = 0; rank < 8; rank++) {
            sum += o.read[rank];
            most = o.read[rank] > most ? o.read[rank] : most;
            stored = o.stored[rank] > stored ? o.stored[rank] : stored;
        }
        /* Twice a buffer: inspected, and opened. */
        uint64_t headers = 2 * 65536;
        /* The other sheet of a slab, and one more for its gradient. */
        uint64_t ghosts = cut == SNOW_PARTITION_EQUAL ? 4 * slice : 0;
        assert_in_range(sum, slice * 200, slice * 200 + 8 * (headers + ghosts));
        assert_true(most <= slice * 25 + headers + ghosts);
        print_message("cut %d: file %lld, read %llu, most by one %llu, most "
                      "voxels stored %lld\n",
                      cut, (long long)slice * 200, (unsigned long long)sum,
                      (unsigned long long)most, (long long)stored);
    }
    snow_volume_close(whole);
}

/* A Zarr array of 100 x 128 x 120 bytes in chunks of 16 x 64 x 128, which are
 * files. */
static void put_chunks(support_files *place, const char *name) {
    static const char about[] =
        "{\"zarr_format\":2,\"shape\":[100,128,120],\"chunks\":[16,64,128],"
        "\"dtype\":\"|u1\",\"compressor\":null,\"fill_value\":0,"
        "\"order\":\"C\",\"filters\":null}";
    static unsigned char chunk[16 * 64 * 128];
    char path[64];
    uint64_t random = 1;
    mkdir(support_path(place, name), 0700);
    snprintf(path, sizeof path, "%s/.zarray", name);
    support_write(place, path, about, sizeof about - 1);
    for (int n = 0; n < 14; n++) {
        for (size_t i = 0; i < sizeof chunk; i++)
            chunk[i] = (unsigned char)(support_random(&random) >> 56);
        snprintf(path, sizeof path, "%s/%d.%d.0", name, n / 2, n % 2);
        support_write(place, path, chunk, sizeof chunk);
    }
}

/* Shares begin between chunks, also where a crop cuts the first ones. */
static void each_chunk_is_unpacked_by_one_rank(void **state) {
    support_files *place = *state;
    static const int ranks[] = {1, 2, 3, 5, 7, 14};
    const uint64_t packed = 14 * 16 * 64 * 128; /* and headers */
    put_chunks(place, "c.zarr");
    char path[256];
    snprintf(path, sizeof path, "%s", support_path(place, "c.zarr"));
    for (int n = 0; n < 12; n++) {
        const snow_volume_options options = {
            .size = sizeof options, .crop = {{3, 0}, {n / 6 * 30, 0}, {n, 98}}};
        snow_volume *whole;
        order o;
        uint64_t sum = 0;
        assert_int_equal(
            snow_volume_open(place->context, path, &options, &whole),
            SNOW_STATUS_OK);
        begin_order(&o, whole);
        o.path = path;
        o.options = options;
        o.how.cut = SNOW_PARTITION_COUNTED;
        open_by(place, &o, ranks[n % 6]);
        for (int rank = 0; rank < ranks[n % 6]; rank++)
            sum += o.read[rank];
        assert_in_range(sum, packed, packed + (uint64_t)ranks[n % 6] * 1024);
        snow_volume_close(whole);
    }
}

static void another_view_is_served_without_the_file(void **state) {
    support_files *place = *state;
    static const int ranks[] = {1, 4, 9, 33};
    static const snow_opacity_point curve[] = {{5, 0}, {30, 1}};
    for (int n = 0; n < 16; n++) {
        order o;
        snow_volume *whole = phantom(place, "phantom:engine", 40, 36, 30, &o);
        o.how.cut = (snow_partition)(n % 4);
        o.settings.deterministic = n % 3 == 0;
        o.settings.method =
            n % 5 ? SNOW_METHOD_SHEAR_WARP : SNOW_METHOD_FOOTPRINT;
        o.turn = true;
        if (n % 2) { /* gradients without shading */
            o.settings.shade = SNOW_SHADE_NONE;
            o.look.gradient_opacities = curve;
            o.look.gradient_opacity_count = 2;
        }
        set_view(place, "+z", &o);
        o.turned = o.view;
        o.turned.azimuth = 80;
        o.turned.zoom = 0.2; /* wide pixels: more ghosts */
        open_by(place, &o, ranks[n / 4]);
        bool slabs = o.how.cut == SNOW_PARTITION_EQUAL ||
                     o.how.cut == SNOW_PARTITION_COUNTED || n % 5 == 0;
        for (int rank = 0; rank < ranks[n / 4] && slabs; rank++)
            if (o.parts[rank].count[0])
                assert_true(o.parts[rank].count[1] == 36 &&
                            o.parts[rank].count[2] == 30);
        snow_volume_close(whole);
    }
}

/* With ghosts for every turn nothing has to be cut again but slabs. */
static void bricks_for_turns_stay_where_they_are(void **state) {
    order o;
    snow_volume *whole = phantom(*state, "phantom:engine", 40, 36, 30, &o);
    o.how.cut = SNOW_PARTITION_BRICKS;
    o.how.turns = 1;
    open_by(*state, &o, 8);
    order again = o;
    again.turn = true;
    again.turned.azimuth = 77;
    again.turned.elevation = 20;
    open_by(*state, &again, 8);
    assert_memory_equal(o.parts, again.parts, sizeof o.parts);
    snow_volume_close(whole);
}

/* Parts that are not all of the volume across its slices. */
static int count_bricks(const order *o, int ranks, int slice_axis) {
    int bricks = 0;
    for (int rank = 0; rank < ranks; rank++)
        for (int axis = 0; axis < 3; axis++)
            bricks += axis != slice_axis &&
                      o->parts[rank].count[axis] != o->parts[rank].dims[axis];
    return bricks;
}

static void
every_method_is_cut_into_bricks_but_deterministic_pictures(void **state) {
    support_files *place = *state;
    const snow_method methods[] = {SNOW_METHOD_SHEAR_WARP,
                                   SNOW_METHOD_FOOTPRINT, SNOW_METHOD_ORIGINAL};
    for (int n = 0; n < 6; n++) {
        order o;
        snow_volume *whole = phantom(place, "phantom:engine", 40, 36, 30, &o);
        set_view(place, "+z", &o);
        o.settings.method = methods[n % 3];
        o.settings.deterministic = n >= 3;
        o.how.cut = SNOW_PARTITION_BRICKS;
        open_by(place, &o, 8);
        assert_int_equal(count_bricks(&o, 8, 2) > 0, n < 3);
        snow_volume_close(whole);
    }
}

static void a_file_that_one_rank_lacks_fails_all(void **state) {
    support_files *place = *state;
    char path[256], other[256];
    snprintf(path, sizeof path, "%s", put_engine(place, "e.nrrd"));
    snprintf(other, sizeof other, "%s", support_path(place, "none.nrrd"));
    snow_volume *whole = support_opened(place, path, NULL);
    for (int cut = SNOW_PARTITION_AUTO; cut <= SNOW_PARTITION_BRICKS; cut++) {
        order o;
        begin_order(&o, whole);
        o.path = path;
        o.wrong = other;
        o.odd = 3;
        o.how.cut = (snow_partition)cut;
        refused_by(place, &o, 5, SNOW_STATUS_BAD_INPUT, "rank 3: ");
        assert_non_null(
            strstr(snow_context_message(place->context), "none.nrrd"));
    }
    snow_volume_close(whole);
}

static void a_file_that_differs_on_one_rank_is_refused(void **state) {
    support_files *place = *state;
    order o;
    char path[256], other[256];
    snprintf(path, sizeof path, "%s", put_engine(place, "e.nrrd"));
    snow_volume *whole = support_opened(place, path, NULL), *half;
    const snow_volume_options options = {.size = sizeof options,
                                         .crop = {{0, 0}, {0, 0}, {3, 0}}};
    assert_int_equal(snow_volume_open(place->context, path, &options, &half),
                     SNOW_STATUS_OK);
    snprintf(other, sizeof other, "%s", support_path(place, "o.nrrd"));
    assert_int_equal(snow_volume_save(half, other, true), SNOW_STATUS_OK);
    snow_volume_close(half);
    begin_order(&o, whole);
    o.path = path;
    o.wrong = other;
    o.odd = 1;
    refused_by(place, &o, 4, SNOW_STATUS_BAD_INPUT, "is not the same file");
    snow_volume_close(whole);
}

/* A Zarr array of three slices, a file each, of one value. */
static void put_slices(support_files *place, const char *name, int value) {
    static const char about[] =
        "{\"zarr_format\":2,\"shape\":[3,64,64],\"chunks\":[1,64,64],"
        "\"dtype\":\"|u1\",\"compressor\":null,\"fill_value\":0,"
        "\"order\":\"C\",\"filters\":null}";
    char path[64];
    unsigned char slice[64 * 64];
    mkdir(support_path(place, name), 0700);
    snprintf(path, sizeof path, "%s/.zarray", name);
    support_write(place, path, about, sizeof about - 1);
    for (int z = 0; z < 3; z++) {
        memset(slice, z == 2 ? value : 1, sizeof slice);
        snprintf(path, sizeof path, "%s/%d.0.0", name, z);
        support_write(place, path, slice, sizeof slice);
    }
}

/* Its files have the same names and sizes: a copy is taken, others are not. */
static void a_folder_that_differs_on_one_rank_is_refused(void **state) {
    support_files *place = *state;
    for (int value = 1; value <= 2; value++) {
        char path[256], other[256];
        put_slices(place, "a.zarr", 1);
        put_slices(place, "b.zarr", value);
        snprintf(path, sizeof path, "%s", support_path(place, "a.zarr"));
        snprintf(other, sizeof other, "%s", support_path(place, "b.zarr"));
        snow_volume *whole = support_opened(place, path, NULL);
        order o;
        begin_order(&o, whole);
        o.path = path;
        o.wrong = other;
        o.odd = 1;
        if (value == 1)
            open_by(place, &o, 3);
        else
            refused_by(place, &o, 3, SNOW_STATUS_BAD_INPUT,
                       "is not the same file");
        snow_volume_close(whole);
    }
}

/* The data of a ramp: in a file beside the header, as they are or packed; or
 * packed behind it, where they are noise, so that they pack badly. */
typedef enum { PLAIN_BESIDE, PACKED_BESIDE, PACKED_NOISE } ramp_kind;

/* Writes a ramp of square slices, of floats or bytes. */
static const char *put_ramp(support_files *place, int side, int slices,
                            bool floats, ramp_kind kind) {
    static const char *const encodings[] = {"raw\ndata file: ramp",
                                            "gzip\ndata file: ramp.gz", "gzip"};
    const size_t count = (size_t)side * (size_t)side * (size_t)slices;
    char header[256], command[1200];
    float *values = malloc(count * sizeof *values);
    assert_non_null(values);
    for (size_t i = 0; i < count; i++)
        if (floats)
            values[i] = (float)(i * i % 65521);
        else
            ((unsigned char *)values)[i] =
                (unsigned char)(i % 16 && kind != PACKED_NOISE
                                    ? i >> 16
                                    : i * i * 2654435761U >> 24);
    const char *data = support_write(place, "ramp", values,
                                     count * (floats ? sizeof *values : 1));
    free(values);
    snprintf(header, sizeof header,
             "NRRD0004\ntype: %s\ndimension: 3\nsizes: %d %d %d\n"
             "endian: little\nencoding: %s\n\n",
             floats ? "float" : "uint8", side, side, slices, encodings[kind]);
    const char *path =
        support_write(place, "ramp.nhdr", header, strlen(header));
    snprintf(command, sizeof command, "gzip -c1 '%s' >>'%s'", data,
             kind == PACKED_NOISE ? path : support_path(place, "ramp.gz"));
    assert_int_equal(kind != PLAIN_BESIDE ? system(command) : 0, 0);
    return path;
}

/* Of two slices the third rank has none; of eight one rank has fewer. */
static void ranks_with_unequal_room_for_samples_agree(void **state) {
    support_files *place = *state;
    for (int slices = 2; slices <= 8; slices += 6) {
        char path[256];
        snow_transfer *expected;
        snprintf(path, sizeof path, "%s",
                 put_ramp(place, 512, slices, true, PLAIN_BESIDE));
        snow_volume *whole = support_opened(place, path, NULL);
        assert_int_equal(snow_transfer_new_for_volume(whole, NULL, &expected),
                         SNOW_STATUS_OK);
        order o;
        begin_order(&o, whole);
        o.path = path;
        o.expected = expected;
        o.memory = 11 << 20;
        open_by(place, &o, 3);
        snow_transfer_free(expected);
        snow_volume_close(whole);
    }
}

/* What is packed is unpacked from its beginning for each slab, so it is read as
 * a share, and before, where it lies beside a header, to see that it is packed;
 * what is plain is read in slabs under a limit, and once without. */
static void packed_data_are_not_read_in_slabs(void **state) {
    support_files *place = *state;
    for (int n = 0; n < 6; n++) {
        static const char *const names[] = {"ramp", "ramp.gz", "ramp.nhdr"};
        const ramp_kind kind = (ramp_kind)(n % 3);
        const bool limited = n >= 3;
        char path[256];
        struct stat about;
        order o;
        snprintf(path, sizeof path, "%s",
                 put_ramp(place, 1024, 17, false, kind));
        snow_volume *whole = support_opened(place, path, NULL);
        begin_order(&o, whole);
        o.path = path;
        o.memory = limited ? UINT64_C(1) << 30 : 0;
        open_by(place, &o, 1);
        assert_int_equal(stat(support_path(place, names[kind]), &about), 0);
        const uint64_t twice = 2 * (uint64_t)about.st_size + 4 * 65536;
        assert_int_equal(o.read[0] <= twice, kind != PLAIN_BESIDE || !limited);
        snow_volume_close(whole);
        unlink(support_path(place, "ramp.gz"));
    }
}

/* Writes a file into a pipe. */
static void *feed(void *user) {
    const char *const *names = user;
    FILE *from = fopen(names[0], "rb"), *to = fopen(names[1], "wb");
    for (int c; from && to && (c = getc(from)) != EOF;)
        putc(c, to);
    if (from)
        fclose(from);
    if (to)
        fclose(to);
    return NULL;
}

static void a_pipe_is_read_by_one_rank_and_sent_to_all(void **state) {
    support_files *place = *state;
    char path[256], pipe[256];
    snprintf(path, sizeof path, "%s", put_engine(place, "e.nrrd"));
    snprintf(pipe, sizeof pipe, "%s", support_path(place, "pipe"));
    assert_int_equal(mkfifo(pipe, 0600), 0);
    snow_volume *whole = support_opened(place, path, NULL);
    for (int cut = SNOW_PARTITION_AUTO; cut <= SNOW_PARTITION_BRICKS; cut++)
        for (int ranks = 1; ranks <= 7; ranks += 3) {
            order o;
            pthread_t thread;
            const char *names[2] = {path, pipe};
            begin_order(&o, whole);
            o.path = pipe;
            o.how.cut = (snow_partition)cut;
            assert_int_equal(pthread_create(&thread, NULL, feed, names), 0);
            open_by(place, &o, ranks);
            pthread_join(thread, NULL);
            for (int rank = 1; rank < ranks; rank++)
                assert_int_equal(o.read[rank], 0);
        }
    snow_volume_close(whole);
    unlink(pipe);
}

/* Allocations of four ranks fail, one after another, on whichever rank it is.
 */
static void memory_that_is_missing_fails_all_ranks(void **state) {
    support_files *place = *state;
    char path[256];
    snprintf(path, sizeof path, "%s", put_engine(place, "e.nrrd"));
    snow_volume *whole = support_opened(place, path, NULL);
    for (int cut = SNOW_PARTITION_EQUAL; cut <= SNOW_PARTITION_BRICKS; cut++) {
        snow_status status = SNOW_STATUS_NO_MEMORY;
        int64_t tries = 0;
        for (; status != SNOW_STATUS_OK && tries < 6000;
             tries += support_is_release() ? 3 : 97) {
            order o;
            begin_order(&o, whole);
            o.path = path;
            o.how.cut = (snow_partition)cut;
            o.turn = true;
            o.turned.azimuth = 90;
            place->fail_at = place->allocations + 1 + tries;
            status = snow_comm_run_threads(place->context, 4, open_part, &o);
            place->fail_at = 0;
            assert_true(status == SNOW_STATUS_OK ||
                        status == SNOW_STATUS_NO_MEMORY);
        }
        assert_in_range(tries, 50, 5999);
    }
    snow_volume_close(whole);
}

/* Whether loads are asked for or not: then of 1,040 slices each fourth is
 * counted for the boxes. */
static void check_plan(order *o, const snow_volume *whole,
                       const snow_transfer *transfer, int cut, int axis) {
    enum { RANKS = 12 };
    int64_t loads[RANKS], sum = 0, all;
    snow_box boxes[RANKS], again[RANKS];
    assert_int_equal(
        snow_count_interesting(whole, transfer, 20, SNOW_ISA_AUTO, 1, &all),
        SNOW_STATUS_OK);
    for (int counted = 0; counted < 2; counted++)
        assert_int_equal(snow_ranks_partition(whole, transfer, 20,
                                              (snow_partition)cut, axis, RANKS,
                                              counted ? boxes : again,
                                              counted ? loads : NULL),
                         SNOW_STATUS_OK);
    for (int i = 0; i < RANKS; i++) {
        memcpy(o->parts[i].first, boxes[i].first, sizeof o->parts[i].first);
        memcpy(o->parts[i].count, boxes[i].count, sizeof o->parts[i].count);
        sum += loads[i];
    }
    check_cover(o, RANKS);
    assert_memory_equal(boxes, again, sizeof boxes);
    assert_int_equal(sum, all);
}

static void a_plan_tells_parts_and_loads(void **state) {
    for (int n = 0; n < 2; n++) {
        order o;
        snow_transfer *transfer;
        snow_volume *whole =
            n ? phantom(*state, "phantom:head", 40, 36, 1040, &o)
              : phantom(*state, "phantom:engine", 64, 60, 56, &o);
        assert_int_equal(snow_transfer_new_for_volume(whole, NULL, &transfer),
                         SNOW_STATUS_OK);
        for (int cut = SNOW_PARTITION_AUTO; cut <= SNOW_PARTITION_BRICKS; cut++)
            for (int axis = 0; axis < 3; axis++)
                check_plan(&o, whole, transfer, cut, axis);
        for (int wrong = 0; wrong < 2; wrong++)
            assert_int_equal(
                snow_ranks_partition(whole, transfer, 20, SNOW_PARTITION_AUTO,
                                     wrong ? 2 : 3, wrong ? 0 : 12, NULL, NULL),
                SNOW_STATUS_BAD_USAGE);
        snow_transfer_free(transfer);
        snow_volume_close(whole);
    }
}

static void options_that_are_none_are_refused_by_all(void **state) {
    for (int n = 0; n < 3; n++) {
        order o;
        snow_volume *whole = phantom(*state, "phantom:cube", 32, 32, 32, &o);
        if (n == 0)
            o.how.cut = (snow_partition)9;
        else if (n == 1)
            o.settings.footprint = 99;
        else
            o.options.crop[1][1] = 9999;
        refused_by(*state, &o, 3, SNOW_STATUS_BAD_USAGE, "");
        snow_volume_close(whole);
    }
}

/* --- pictures ------------------------------------------------------------- */

#define SIDE 48
#define PICTURES 5

/* Pictures from five sides of a volume that was opened for the first one. */
typedef struct turntable {
    opened_request open;
    snow_view views[PICTURES];
    float *serial[PICTURES]; /* of one processor; freed by the test */
    size_t floats;
    double most; /* difference so far */
} turntable;

static void compare_pictures(turntable *t, int n, const float *pixels) {
    for (size_t i = 0; i < t->floats; i++) {
        double off = fabs((double)pixels[i] - (double)t->serial[n][i]);
        if (!(off <= t->most))
            t->most = off;
    }
}

static snow_status draw_views(turntable *t, opened *part) {
    for (int n = 0; n < PICTURES; n++) {
        snow_image *image = NULL;
        SNOW_TRY(opened_cut(part, &t->views[n]));
        SNOW_TRY(opened_draw(part, &t->views[n], &image));
        if (image)
            compare_pictures(t, n, snow_image_pixels(image));
        snow_image_free(image);
    }
    return SNOW_STATUS_OK;
}

static snow_status draw_turntable(snow_comm *comm, void *user) {
    turntable *t = user;
    opened part;
    SNOW_TRY(opened_enter(comm, &t->open, &part));
    const snow_status status = draw_views(t, &part);
    opened_leave(&part);
    return status;
}

static void draw_serial(support_files *place, turntable *t,
                        const snow_volume *whole) {
    snow_transfer *transfer;
    snow_frame *frame;
    assert_int_equal(snow_transfer_new_for_volume(whole, NULL, &transfer),
                     SNOW_STATUS_OK);
    assert_int_equal(snow_frame_new(place->context, &frame), SNOW_STATUS_OK);
    for (int n = 0; n < PICTURES; n++) {
        snow_image *image;
        snow_view_init(&t->views[n]);
        snow_view_default(whole, &t->views[n]);
        t->views[n].width = t->views[n].height = SIDE;
        t->views[n].azimuth = 65.0 * n;
        t->views[n].elevation = 11.0 * n;
        t->open.view = t->views[0];
        assert_int_equal(snow_frame_render(frame, whole, transfer, &t->views[n],
                                           &t->open.settings, &image),
                         SNOW_STATUS_OK);
        t->floats = (size_t)SIDE * SIDE * 2; /* grey and opacity */
        t->serial[n] = malloc(t->floats * sizeof(float));
        assert_non_null(t->serial[n]);
        memcpy(t->serial[n], snow_image_pixels(image),
               t->floats * sizeof(float));
        snow_image_free(image);
    }
    snow_frame_free(frame);
    snow_transfer_free(transfer);
}

/* Apart from rounding, and from what lies behind 0.5 / 255 of transparency,
 * which a rank leaves out where it sees it; or to the bit where that was asked
 * for. */
static void pictures_from_all_sides_are_those_of_one_processor(void **state) {
    support_files *place = *state;
    static const int ranks[] = {1, 3, 8, 17};
    char path[256];
    snprintf(path, sizeof path, "%s", put_engine(place, "e.nrrd"));
    snow_volume *whole = support_opened(place, path, NULL);
    for (int n = 0; n < 4; n++) {
        turntable t = {.open = {.path = path,
                                .how = {.size = sizeof(snow_ranks_options)}}};
        snow_volume_options_init(&t.open.options);
        snow_settings_init(&t.open.settings);
        t.open.settings.deterministic = n == 1;
        t.open.settings.method =
            n == 2 ? SNOW_METHOD_FOOTPRINT : SNOW_METHOD_AUTO;
        t.open.settings.threads = 1;
        draw_serial(place, &t, whole);
        for (int cut = SNOW_PARTITION_AUTO; cut <= SNOW_PARTITION_BRICKS; cut++)
            for (int i = 0; i < 4; i++) {
                if (!support_takes((size_t)((n * 4 + cut) * 4 + i), 7))
                    continue;
                t.open.how.cut = (snow_partition)cut;
                t.open.how.turns = n == 3;
                t.most = 0;
                if (snow_comm_run_threads(place->context, ranks[i],
                                          draw_turntable, &t) != SNOW_STATUS_OK)
                    fail_msg("%d ranks, cut %d: %s", ranks[i], cut,
                             snow_context_message(place->context));
                if (t.most > (n == 1 ? 0 : 0.5 / 255 + 1e-5))
                    fail_msg("case %d, %d ranks, cut %d: off by %g", n,
                             ranks[i], cut, t.most);
            }
        for (int k = 0; k < PICTURES; k++)
            free(t.serial[k]);
    }
    snow_volume_close(whole);
}

#define TEST(name)                                             \
    cmocka_unit_test_setup_teardown(name, support_files_setup, \
                                    support_files_teardown)

int main(void) {
    const struct CMUnitTest tests[] = {
        TEST(every_rank_gets_its_part),
        TEST(slabs_lie_along_the_slice_axis),
        TEST(the_file_is_read_once),
        TEST(each_chunk_is_unpacked_by_one_rank),
        TEST(another_view_is_served_without_the_file),
        TEST(bricks_for_turns_stay_where_they_are),
        TEST(every_method_is_cut_into_bricks_but_deterministic_pictures),
        TEST(a_file_that_one_rank_lacks_fails_all),
        TEST(a_file_that_differs_on_one_rank_is_refused),
        TEST(a_folder_that_differs_on_one_rank_is_refused),
        TEST(ranks_with_unequal_room_for_samples_agree),
        TEST(packed_data_are_not_read_in_slabs),
        TEST(a_pipe_is_read_by_one_rank_and_sent_to_all),
        TEST(memory_that_is_missing_fails_all_ranks),
        TEST(a_plan_tells_parts_and_loads),
        TEST(options_that_are_none_are_refused_by_all),
        TEST(pictures_from_all_sides_are_those_of_one_processor),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
