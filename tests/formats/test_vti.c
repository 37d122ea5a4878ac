/* tests/formats/test_vti.c - VTI files by hand, and what is refused.  What VTK
 * writes is compared in oracle_vtk.py. */
#include "support/files.h"

#define FILE_TAG "<VTKFile type=\"ImageData\" byte_order=\"LittleEndian\">\n"
#define GRID                                                   \
    "<ImageData WholeExtent=\"1 3 0 1 0 0\" Origin=\"1 2 3\" " \
    "Spacing=\"0.5 1 2\"><Piece Extent=\"1 3 0 1 0 0\"><PointData>"
#define ARRAY(name, form) \
    "<DataArray type=\"UInt8\" Name=\"" name "\" format=\"" form "\">"
#define END "</DataArray></PointData></Piece></ImageData></VTKFile>"
#define BYTES "BgAAAAABAgMEBQ==" /* 6, then 0 to 5 */

#define LZ4 "<VTKFile type=\"ImageData\" compressor=\"vtkLZ4DataCompressor\">"
#define PIECE(x, y, type, offset)                                         \
    "<Piece Extent=\"" x " " y " 0 0\"><PointData Scalars=\"a\">"         \
    "<DataArray type=\"" type "\" Name=\"a\" format=\"appended\" offset=" \
    "\"" offset "\"/></PointData></Piece>"
/* 4 x 2 points, counted from 0, in two pieces of 2 x 2 and one of none. */
#define PIECES(last, type)                                                     \
    FILE_TAG "<ImageData WholeExtent=\"0 3 0 1 0 0\">"                         \
             "<Piece Extent=\"0 -1 0 -1 0 -1\"><PointData/></Piece>" PIECE(    \
                 "0 1", "0 1", "UInt8", "0")                                   \
                 PIECE("2 3", last, type,                                      \
                       "12") "</ImageData><AppendedData encoding=\"base64\">_" \
                             "BAAAAAABBAU=BAAAAAIDBgc="
#define ENDED "</AppendedData></VTKFile>"
#define ONES                                                         \
    "<Piece Extent=\"0 0 0 0 0 0\"/><Piece Extent=\"0 0 0 0 0 0\"/>" \
    "<Piece Extent=\"0 0 0 0 0 0\"/>"

static snow_volume *opened(support_files *files, const char *text,
                           const snow_volume_options *options) {
    return support_opened(files, support_write_text(files, "a.vti", text),
                          options);
}

static void expect_counting(snow_volume *volume) {
    for (int i = 0; i < 6; i++)
        assert_int_equal(((const uint8_t *)snow_volume_voxels(volume))[i], i);
    snow_volume_close(volume);
}

static void text_and_base64_are_read_in_place(void **state) {
    support_files *files = *state;
    static const char *const texts[] = {
        FILE_TAG GRID ARRAY("a", "ascii") "0 1 2\n 3 4 5" END,
        FILE_TAG GRID ARRAY("a", "binary") "\n  " BYTES "\n" END,
        FILE_TAG GRID ARRAY("a", "binary") "BgAA\nAAAB AgMEBQ= =" END,
        "<?xml version=\"1.0\"?>\n<!-- by hand -->\n" FILE_TAG GRID ARRAY(
            "a", "ascii") "0 1 2 3 4 5" END,
    };
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
        snow_volume *volume = opened(files, texts[i], NULL);
        const snow_volume_info *info = snow_volume_get_info(volume);
        assert_string_equal(info->format, "vti");
        assert_true(info->dims[0] == 3 && info->dims[1] == 2);
        /* The first index is 1. */
        assert_true(info->matrix[0][0] == 0.5 && info->matrix[0][3] == 1.5);
        expect_counting(volume);
    }
    assert_string_equal(files->warnings, "");
}

static void the_scalars_of_the_file_come_before_others(void **state) {
    support_files *files = *state;
    expect_counting(
        opened(files,
               FILE_TAG
               "<ImageData WholeExtent=\"1 3 0 1 0 0\">"
               "<Piece Extent=\"1 3 0 1 0 0\"><PointData Scalars=\"b\">" ARRAY(
                   "a", "ascii") "9 9 9 9 9 9</DataArray>" ARRAY("b", "binary")
                   BYTES END,
               NULL));
    const snow_volume_options options = {.size = sizeof options,
                                         .dataset = "c"};
    support_refused(
        files,
        support_write_text(files, "b.vti",
                           FILE_TAG GRID ARRAY("a", "ascii") "0 1 2 3 4 5" END),
        &options, SNOW_STATUS_BAD_USAGE, "the file has a", SUPPORT_MOST);
}

static void appended_arrays_lie_at_their_offsets(void **state) {
    support_files *files = *state;
    static const char text[] = FILE_TAG GRID
        "<DataArray type=\"UInt8\" Name=\"a\" format=\"appended\" "
        "offset=\"16\"/></PointData></Piece></ImageData>"
        "<AppendedData encoding=\"base64\">\n _BgAAAAkJCQkJCQ==" BYTES
        "</AppendedData></VTKFile>";
    expect_counting(opened(files, text, NULL));
}

static void pieces_are_joined(void **state) {
    support_files *files = *state;
    const snow_volume_options box = {.size = sizeof box, .crop = {{1, 3}}};
    static const char text[] = PIECES("0 1", "UInt8") ENDED;
    snow_volume *volume = opened(files, text, NULL);
    for (int i = 0; i < 8; i++)
        assert_int_equal(((const uint8_t *)snow_volume_voxels(volume))[i], i);
    snow_volume_close(volume);
    volume = opened(files, text, &box);
    assert_memory_equal(snow_volume_voxels(volume), "\1\2\5\6", 4);
    snow_volume_close(volume);
    assert_string_equal(files->warnings, "");
}

static void blocks_of_lz4_are_unpacked(void **state) {
    support_files *files = *state;
#if SNOW_HAVE_LZ4
    expect_counting(
        opened(files,
               LZ4 GRID ARRAY(
                   "a", "binary") "AQAAAAYAAAAAAAAABwAAAA==YAABAgMEBQ==" END,
               NULL));
#else
    support_bad_file(files, support_write_text(files, "a.vti", LZ4 GRID END),
                     "liblz4-dev");
#endif
}

static void what_is_no_image_is_refused(void **state) {
    support_files *files = *state;
    static const char *const cases[][2] = {
        {"<VTKFile type=\"PolyData\"/>", "is a VTK file of surfaces"},
        {"<a><VTKFile/></a>", "not a VTK file"},
        {"<VTKFile type=\"ImageData\"><", "XML is damaged"},
        {FILE_TAG, "XML is damaged"},
        {FILE_TAG "</VTKFile>", "no array"},
        {"<!DOCTYPE a>" FILE_TAG "</VTKFile>", "no array"},
        {"<!DOCTYPE a [<!ENTITY b \"c\">]>" FILE_TAG "</VTKFile>",
         "declares entities"},
        {"<VTKFile type=\"ImageData\" compressor=\"vtkLZMADataCompressor\"/>",
         "neither by zlib nor LZ4"},
        {LZ4 GRID ARRAY("a",
                        "binary") "AQAAAAYAAAAAAAAABwAAAA==cAABAgMEBQ==" END,
         "data are invalid"},
        {LZ4 GRID ARRAY("a",
                        "binary") "AQAAAAYAAAAAAAAACQAAAA==YAABAgMEBQ==" END,
         ""},
        {LZ4 GRID ARRAY("a", "binary") "AQAAAAYAAAAAAAAAAAAAAA==" END,
         "larger than the file"},
        {LZ4 GRID ARRAY("a",
                        "binary") "AQAAAAAAAEAAAAAABwAAAA==YAABAgMEBQ==" END,
         "larger than the file"},
        {PIECES("0 1", "UInt8") "</AppendedData>", "damaged"},
        {PIECES("0 1", "Int8") ENDED, "piece 1 (counted from 0) has voxels of"},
        {PIECES("0 2", "UInt8") ENDED, "outside"},
        {FILE_TAG
         "<ImageData WholeExtent=\"0 1 0 0 0 0\">" ONES ONES ONES ONES ONES ONES
         "</ImageData></VTKFile>",
         "pieces that overlap"},
        {FILE_TAG "<ImageData WholeExtent=\"0 1 0 0 0 0\">" ONES
                  "</ImageData></VTKFile>",
         "has no array"},
        {FILE_TAG "<ImageData/></VTKFile>", "WholeExtent"},
        {FILE_TAG "<ImageData WholeExtent=\"1 0 0 0 0 0\"/></VTKFile>",
         "WholeExtent"},
        {FILE_TAG "<ImageData WholeExtent=\"0 9 0 9 0 9\">"
                  "<Piece Extent=\"0 9 0 9 0 4\"/></ImageData></VTKFile>",
         "no piece"},
        {FILE_TAG GRID ARRAY("a", "ascii") "0 1 2 3 4" END,
         "not a valid uint8"},
        {FILE_TAG GRID ARRAY("a", "binary") "BQAAAAABAgME" END,
         "5 bytes but the voxels need 6"},
        {FILE_TAG GRID ARRAY("a", "binary") "BgAAAAABAgM=" END, "too early"},
        {FILE_TAG GRID ARRAY("a", "binary") "BgAAAAABAg=" END, "base64"},
        {FILE_TAG GRID ARRAY("a", "hex") "00" END, "unknown type"},
        {FILE_TAG GRID "<DataArray type=\"String\" format=\"ascii\">" END,
         "unknown type"},
        {FILE_TAG
         "<ImageData WholeExtent=\"0 9 0 9 0 9\" Spacing=\"0 1 1\">"
         "<Piece Extent=\"0 9 0 9 0 9\"><PointData>" ARRAY("a", "ascii") END,
         "spacing"},
        {FILE_TAG
         "<ImageData WholeExtent=\"0 99999999 0 99999999 0 9\">"
         "<Piece Extent=\"0 99999999 0 99999999 0 9\"><PointData>" ARRAY(
             "a", "ascii") END,
         "is truncated"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        support_bad_file(files, support_write_text(files, "a.vti", cases[i][0]),
                         cases[i][1]);
}

#define APPENDED(encoding, data)                                       \
    FILE_TAG GRID                                                      \
        "<DataArray type=\"UInt8\" Name=\"a\" format=\"appended\" "    \
        "offset=\"0\"/></PointData></Piece></ImageData><AppendedData " \
        "encoding=\"" encoding "\">_" data

/* The tags behind the array that is read. */
static void tags_that_cross_or_have_no_end_are_refused(void **state) {
    support_files *files = *state;
    static const char *const ends[] = {
        "</PointData></DataArray></Piece></ImageData></VTKFile>",
        "</DataArray></PointData></Piece></VTKFile></ImageData>",
        "</DataArray></PointData></Piece></ImageData>",
        "</DataArray></PointData></Piece></ImageData></VTKFile",
        "</DataArray></PointData><CellData></Piece></ImageData></VTKFile>",
        "</DataArray></PointData></Piece></ImageData><AppendedData "
        "encoding=\"raw\">_<&</AppendedData>",
        "",
    };
    for (size_t i = 0; i < sizeof ends / sizeof *ends; i++) {
        char text[1024];
        const char *const starts[] = {
            FILE_TAG GRID ARRAY("a", "ascii") "0 1 2 3 4 5",
            FILE_TAG GRID ARRAY("a", "binary") BYTES};
        for (int k = 0; k < 2; k++) {
            snprintf(text, sizeof text, "%s%s", starts[k], ends[i]);
            support_bad_file(files, support_write_text(files, "a.vti", text),
                             i == 6 && !k ? "" : "damaged behind the array");
        }
    }
    static const char *const appended[] = {
        APPENDED("base64", BYTES),
        APPENDED("base64", BYTES "</AppendedData>"),
        APPENDED("base64", BYTES "</Appended></VTKFile>"),
        APPENDED("base64", BYTES "</AppendedData></Piece></VTKFile>"),
        APPENDED("raw", "\6!!!012345</AppendedData></ImageData>"),
        APPENDED("raw", "\6!!!012345<AppendedData")};
    for (size_t i = 0; i < sizeof appended / sizeof *appended; i++) {
        char text[1024];
        snprintf(text, sizeof text, "%s", appended[i]);
        const size_t size = strlen(text);
        for (size_t k = 0; k < size; k++)
            text[k] = text[k] == '!' ? 0 : text[k];
        support_bad_file(files, support_write(files, "a.vti", text, size),
                         i == 0 || i == 2 || i == 5 ? "no end" : "damaged");
    }
}

static void bytes_after_the_last_tag_cause_a_note(void **state) {
    support_files *files = *state;
    static const char *const texts[] = {
        FILE_TAG GRID ARRAY("a", "ascii") "0 1 2 3 4 5" END "\n<!-- x -->\1<",
        APPENDED("base64", BYTES "</AppendedData></VTKFile>\n more"),
    };
    for (size_t i = 0; i < 2; i++) {
        expect_counting(opened(files, texts[i], NULL));
        assert_non_null(strstr(files->warnings, "after its last tag"));
        *files->warnings = 0;
    }
}

/* A compressed array in three blocks of 2 bytes, the sizes as told. */
static void blocks_that_lie_are_refused(void **state) {
    support_files *files = *state;
    static const uint32_t heads[][6] = {
        {3, 2, 0, 1u << 30, 1, 1}, {1u << 31, 1u << 31, 0, 1, 1, 1},
        {3, 1u << 30, 0, 9, 9, 9}, {0, 0, 0, 1, 1, 1},
        {3, 2, 2, 10, 10, 10},
    };
    static const char text[] =
        "<VTKFile type=\"ImageData\" compressor=\"vtkZLibDataCompressor\">" GRID
        "<DataArray type=\"UInt8\" Name=\"a\" format=\"appended\" "
        "offset=\"0\"/></PointData></Piece></ImageData>"
        "<AppendedData encoding=\"raw\">_";
    for (size_t i = 0; i < sizeof heads / sizeof *heads; i++) {
        unsigned char bytes[sizeof text + 100] = {0};
        memcpy(bytes, text, sizeof text - 1);
        for (size_t k = 0; k < 24; k++)
            bytes[sizeof text - 1 + k] =
                (unsigned char)(heads[i][k / 4] >> (8 * (k % 4)));
        support_bad_file(
            files, support_write(files, "a.vti", bytes, sizeof bytes), ";");
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        SUPPORT_TEST(text_and_base64_are_read_in_place),
        SUPPORT_TEST(the_scalars_of_the_file_come_before_others),
        SUPPORT_TEST(appended_arrays_lie_at_their_offsets),
        SUPPORT_TEST(pieces_are_joined),
        SUPPORT_TEST(blocks_of_lz4_are_unpacked),
        SUPPORT_TEST(what_is_no_image_is_refused),
        SUPPORT_TEST(tags_that_cross_or_have_no_end_are_refused),
        SUPPORT_TEST(bytes_after_the_last_tag_cause_a_note),
        SUPPORT_TEST(blocks_that_lie_are_refused),
    };
    const char *version, *formats;
    if (snow_library_name(0, &version, &formats) && !version)
        return 77;
    return cmocka_run_group_tests(tests, NULL, NULL);
}
