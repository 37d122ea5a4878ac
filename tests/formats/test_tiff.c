/* tests/formats/test_tiff.c - TIFF files by hand: which pages are no slices,
 * and what is refused.  What others write is compared in oracle_tiff.py. */
#include "support/files.h"

#include <math.h>

/* Indices of libraries among those of snow_library_name. */
#define EXPAT 0
#define LIBTIFF 1

typedef struct tiff {
    unsigned char bytes[4096];
    size_t size;
    size_t link;      /* where the next page's place stands */
    const char *text; /* the next page's description, or NULL */
} tiff;

static void put(tiff *t, size_t at, size_t size, uint64_t value) {
    for (size_t i = 0; i < size; i++)
        t->bytes[at + i] = (unsigned char)(value >> (8 * i));
}

static void begin(tiff *t) {
    memset(t, 0, sizeof *t);
    memcpy(t->bytes, "II*", 4);
    t->size = 8;
    t->link = 4;
}

/* A page of width x 2 pixels of `bits`, all of value `fill`; `tag` and `value`
 * replace one of its entries. */
static void add_page(tiff *t, uint32_t width, uint16_t bits, int fill,
                     uint16_t tag, uint32_t value) {
    uint32_t bytes = width * 2 * bits / 8, data = (uint32_t)t->size;
    const size_t letters = t->text ? strlen(t->text) + 1 : 0;
    const uint32_t words = data + bytes + bytes % 2;
    const uint32_t entries[][3] = {
        /* tag, type (2: text, 3: 16 bits, 4: 32), value */
        {254, 4, 0},
        {256, 4, width},
        {257, 4, 2},
        {258, 3, bits},
        {259, 3, 1},
        {262, 3, 1},
        {letters ? 270 : 269, 2, words},
        {273, 4, data},
        {277, 3, 1},
        {278, 4, 2},
        {279, 4, bytes},
        {339, 3, 1},
    };
    size_t count = sizeof entries / sizeof *entries;
    memset(t->bytes + t->size, fill, bytes);
    if (letters)
        memcpy(t->bytes + words, t->text, letters);
    t->size = words + letters + letters % 2;
    t->text = NULL;
    put(t, t->link, 4, t->size);
    put(t, t->size, 2, count);
    for (size_t i = 0; i < count; i++) {
        size_t at = t->size + 2 + 12 * i;
        put(t, at, 2, entries[i][0]);
        put(t, at + 2, 2, entries[i][1]);
        put(t, at + 4, 4, entries[i][1] == 2 ? letters : 1);
        put(t, at + 8, 4, entries[i][0] == tag ? value : entries[i][2]);
    }
    t->link = t->size + 2 + 12 * count;
    t->size = t->link + 4;
}

static const char *write_tiff(support_files *files, const tiff *t) {
    return support_write(files, "a.tif", t->bytes, t->size);
}

static void small_copies_are_no_slices(void **state) {
    support_files *files = *state;
    tiff t;
    begin(&t);
    add_page(&t, 4, 8, 1, 0, 0);
    add_page(&t, 2, 8, 9, 254, 1);
    add_page(&t, 4, 8, 2, 0, 0);
    snow_volume *volume = support_opened(files, write_tiff(files, &t), NULL);
    const uint8_t *voxels = snow_volume_voxels(volume);
    assert_int_equal(snow_volume_get_info(volume)->dims[2], 2);
    assert_true(voxels[0] == 1 && voxels[8] == 2);
    snow_volume_close(volume);
}

#define OME(planes)                                                         \
    "<OME><Image><Pixels SizeC='1' SizeT='1' SizeZ='2' SizeX='4' SizeY='2'" \
    " DimensionOrder='XYZCT'>" planes "</Pixels></Image></OME>"

static void a_plane_is_the_page_that_its_description_names(void **state) {
    support_files *files = *state;
    static const struct {
        const char *text;
        int first, second; /* of pages 1, 2 and 3; 0: missing */
    } cases[] = {
        {OME("<TiffData FirstZ='1' IFD='0'/><TiffData IFD='2'/>"), 3, 1},
        {OME("<TiffData IFD='1' PlaneCount='2'/>"), 2, 3},
        {OME("<TiffData/>"), 1, 2},
        {OME("<TiffData FirstZ='1' IFD='1'/>"), 0, 2},
        {OME("<TiffData IFD='2' PlaneCount='2'/>"), 3, 0},
        {"ImageJ=1.53t\nimages=2\nslices=2\n", 1, 2},
        {"{\"shape\": [2, 2, 4]}", 1, 2},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const bool gap = !cases[i].first || !cases[i].second;
        const snow_volume_options gaps = {.size = sizeof gaps,
                                          .allow_gaps = true};
        const char *expat = NULL, *formats;
        tiff t;
        snow_library_name(EXPAT, &expat, &formats);
        if (!expat && *cases[i].text == '<')
            continue;
        begin(&t);
        t.text = cases[i].text;
        for (int page = 1; page <= 3; page++)
            add_page(&t, 4, 8, page, 0, 0);
        const char *path = write_tiff(files, &t);
        if (gap)
            support_bad_file(files, path, "1 of 2 slices are missing");
        snow_volume *volume = support_opened(files, path, &gaps);
        assert_int_equal(snow_volume_get_info(volume)->dims[2], 2);
        for (int z = 0; z < 2; z++) {
            const int page = z ? cases[i].second : cases[i].first;
            const float *floats = snow_volume_voxels(volume);
            const uint8_t *bytes = snow_volume_voxels(volume);
            if (page)
                assert_true(gap ? floats[8 * z] == (float)page
                                : bytes[8 * z] == page);
            else
                assert_true(isnan(floats[8 * z]));
        }
        snow_volume_close(volume);
    }
}

static void white_zeros_are_inverted(void **state) {
    support_files *files = *state;
    tiff t;
    begin(&t);
    add_page(&t, 4, 8, 5, 262, 0);
    snow_volume *volume = support_opened(files, write_tiff(files, &t), NULL);
    assert_int_equal(*(const uint8_t *)snow_volume_voxels(volume), 250);
    snow_volume_close(volume);
}

static void pages_that_lie_are_refused(void **state) {
    support_files *files = *state;
    static const struct {
        uint16_t tag;
        uint32_t value;
        const char *part;
    } cases[] = {
        {256, 5, "must be alike"},  {257, 1, "must be alike"},
        {258, 16, "must be alike"}, {339, 2, "must be alike"},
        {258, 12, "must be alike"}, {339, 6, "format 6"},
        {339, 3, "format 3"},       {262, 6, "samplesperpixel"},
        {262, 32844, "luminance"},  {256, 2000000000, "must be alike"},
        {273, 60000, "damaged"},    {259, 32773, "damaged"},
        {259, 12345, "damaged"},    {258, 40, "40 bits"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        tiff t;
        begin(&t);
        add_page(&t, 4, 8, 1, 0, 0);
        add_page(&t, 4, 8, 1, cases[i].tag, cases[i].value);
        support_bad_file(files, write_tiff(files, &t), cases[i].part);
    }
}

static void sizes_that_the_file_cannot_hold_cost_nothing(void **state) {
    support_files *files = *state;
    tiff t;
    begin(&t);
    add_page(&t, 4, 8, 1, 256, 2000000000);
    support_bad_file(files, write_tiff(files, &t), "cannot hold");
    begin(&t);
    add_page(&t, 4, 8, 1, 257, 4000000000);
    support_bad_file(files, write_tiff(files, &t), "damaged");
    put(&t, t.link, 4, 8 + 8); /* the next page is the same one */
    support_bad_file(files, write_tiff(files, &t), ";");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        SUPPORT_TEST(small_copies_are_no_slices),
        SUPPORT_TEST(a_plane_is_the_page_that_its_description_names),
        SUPPORT_TEST(white_zeros_are_inverted),
        SUPPORT_TEST(pages_that_lie_are_refused),
        SUPPORT_TEST(sizes_that_the_file_cannot_hold_cost_nothing),
    };
    const char *version, *formats;
    if (snow_library_name(LIBTIFF, &version, &formats) && !version)
        return 77;
    return cmocka_run_group_tests(tests, NULL, NULL);
}
