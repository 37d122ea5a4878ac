/* words.c - which words of a file are technical, so that a report may have
 * them.
 *
 * A file may hold anything anywhere: a name in the tag of the modality, or as
 * that of a data set.  So a word is not passed on by where it stands, but only
 * if it is one of these. */
#define _XOPEN_SOURCE 700
#include "report/report.h"

#include <ctype.h>
#include <dirent.h>
#include <inttypes.h>
#include <limits.h>
#include <string.h>
#include <sys/stat.h>

/* Defined terms of DICOM, words of NRRD, MetaImage, OME, Zarr and CF, and the
 * keys of info. */
static const char *const words[] = {
    " CT MR PT NM US XA RF CR DX MG SC OT SEG SM OPT OCT RTDOSE RTSTRUCT"
    " MONOCHROME1 MONOCHROME2 PALETTE COLOR RGB YBR_FULL YBR_FULL_422"
    " YBR_ICT YBR_RCT YBR_PARTIAL_420 ORIGINAL DERIVED PRIMARY SECONDARY"
    " AXIAL LOCALIZER VOLUME MOSAIC PHASE MAG REAL IMAGINARY MIXED NONE HU"
    " BQML CNTS GML CM2ML PROPCNTS SUV BW LBM BSA START ADMIN DECY ATTN"
    " SCAT DTIM RAN NORM BINARY FRACTIONAL LINEAR LINEAR_EXACT SIGMOID HFS"
    " HFP FFS FFP HFDR FFDR True False true false Yes No type dimension"
    " space sizes spacings directions kinds kind endian encoding origin"
    " thicknesses centers"
    " ",
    " centerings measurement frame units axis mins maxs labels number min"
    " max data file byte skip line block size sample right left anterior"
    " posterior superior inferior right-anterior-superior"
    " left-anterior-superior left-posterior-superior RAS LAS LPS"
    " scanner-xyz 3D-right-handed 3D-left-handed domain list vector"
    " 3-vector 3-color RGB-color RGBA-color scalar complex matrix cell"
    " node none little big raw gzip gz bzip2 bz2 ascii txt text hex signed"
    " unsigned char short int long float double int8 uint8 int16 uint16"
    " int32 uint32 int64 uint64 float32 float64 uchar ushort uint"
    " ulonglong longlong int8_t uint8_t int16_t uint16_t int32_t uint32_t"
    " int64_t uint64_t LOCAL"
    " ",
    " ObjectType NDims DimSize ElementType ElementSpacing ElementSize"
    " ElementNumberOfChannels ElementDataFile ElementByteOrderMSB"
    " BinaryDataByteOrderMSB BinaryData CompressedData CompressedDataSize"
    " TransformMatrix Offset Position Orientation CenterOfRotation"
    " AnatomicalOrientation HeaderSize DistanceUnits Image MET_CHAR"
    " MET_UCHAR MET_SHORT MET_USHORT MET_INT MET_UINT MET_LONG MET_ULONG"
    " MET_LONG_LONG MET_ULONG_LONG MET_FLOAT MET_DOUBLE RAI LPI mm cm m km"
    " um µm nm pm micron microns millimeter micrometer nanometer meter"
    " kilometer inch pixel pixels second seconds s ms us minute minutes"
    " hour hours day days degrees_north degrees_east degree degrees K degC"
    " Pa hPa kg kg-1 m-1 m-2 m-3 s-1 images channels slices frames"
    " hyperstack mode unit spacing loop grayscale color composite"
    " ",
    " XYZCT XYZTC XYCTZ XYCZT XYTCZ XYTZC zarr_format node_type array"
    " group shape chunks chunk_shape dtype data_type compressor filters"
    " order fill_value dimension_separator chunk_grid chunk_key_encoding"
    " configuration separator codecs name id cname clevel shuffle"
    " blocksize level typesize checksum index_codecs index_location"
    " sharding_indexed bytes blosc zstd zlib lz4 lz4hc blosclz snappy lzma"
    " crc32c transpose regular default v2 C F start end bitshuffle"
    " noshuffle delta fixedscaleoffset quantize null attributes metadata"
    " dimension_names storage_transformers consolidated_metadata"
    " must_understand inline multiscales version axes datasets path"
    " coordinateTransformations scale translation omero window active"
    " rdefs label image-label time channel _ARRAY_DIMENSIONS <i1 <i2 <i4"
    " <i8 <u1"
    " ",
    " <u2 <u4 <u8 <f2 <f4 <f8 >i1 >i2 >i4 >i8 >u1 >u2 >u4 >u8 >f2 >f4 >f8"
    " |i1 |u1 |b1 x y z t c lat lon latitude longitude lev height depth"
    " altitude pressure west_east south_north bottom_top west_east_stag"
    " south_north_stag bottom_top_stag DateStrLen Time Times XLAT XLONG PH"
    " PHB HGT T P PB U V W QVAPOR QCLOUD QRAIN QICE QSNOW standard_name"
    " long_name positive calendar scale_factor add_offset _FillValue"
    " missing_value valid_min valid_max valid_range actual_range"
    " grid_mapping coordinates bounds flag_values flag_meanings"
    " cell_methods Conventions FieldType MemoryOrder stagger description"
    " up down standard gregorian proleptic_gregorian noleap 360_day"
    " 365_day"
    " ",
    " X Y Z XYZ XY CLASS NAME REFERENCE_LIST DIMENSION_LIST"
    " DIMENSION_SCALE _Netcdf4Dimid _Netcdf4Coordinates _NCProperties"
    " _nc3_strict _NCCOPY element_size_um unitSI axisLabels gridSpacing"
    " gridGlobalOffset gridUnitSI geometry cartesian thetaMode dataOrder"
    " openPMD openPMDextension Origin Spacing Direction WholeExtent Type"
    " ImageData format dims axis_units medical slope intercept times"
    " components magnitude channel_count shown value_unit modality voxels"
    " finite sum wsum sparse_ratio threshold ratio histogram low high"
    " counts value opacity dicom nifti nrrd metaimage mgh gipl mrc npy"
    " tiff png jpeg hdf5 netcdf zarr vtk vti vtkhdf xdmf amrex bov den"
    " cube vasp phantom memory storage look DICOM NIfTI NRRD TIFF"
    " ",
    " HDF5 NetCDF OME-TIFF OME-Zarr Zarr VTK VTKHDF PET JPEG PNG MRI XML"
    " JSON UID CRS WRF"
    " ",
};

bool is_technical(const char *word, size_t length) {
    char key[64];
    if (length == 0 || length > sizeof key - 3)
        return false;
    snprintf(key, sizeof key, " %.*s ", (int)length, word);
    for (size_t i = 0; i < sizeof words / sizeof *words; i++)
        if (!memchr(word, ' ', length) && strstr(words[i], key))
            return true;
    return false;
}

bool has_technical_number(const char *name, size_t length) {
    static const char *const of_people[] = {"id",     "name",  "NAME",
                                            "number", "label", "labels"};
    for (size_t i = 0; i < sizeof of_people / sizeof *of_people; i++)
        if (strlen(of_people[i]) == length &&
            memcmp(of_people[i], name, length) == 0)
            return false;
    return is_technical(name, length);
}

static bool is_number(const char *word, size_t length) {
    size_t digits = 0;
    for (size_t i = 0; i < length; i++) {
        if (!strchr("0123456789+-.eE", word[i]) || !word[i])
            return false;
        digits += isdigit((unsigned char)word[i]) != 0;
    }
    return digits > 0 && length <= 26;
}

static bool parts(char letter) {
    return letter && strchr(" \t\r\n\\,;()[]\"'", letter);
}

/* The length of the word at a place of a text. */
static size_t word_length(const char *text, size_t left) {
    size_t length = 0;
    while (length < left && !parts(text[length]))
        length++;
    return length;
}

static bool is_plain(const char *text, size_t length) {
    for (size_t at = 0; at < length;) {
        size_t word = word_length(text + at, length - at);
        if (word && !is_number(text + at, word) &&
            !is_technical(text + at, word))
            return false;
        at += word ? word : 1;
    }
    return true;
}

/* Texts are padded with blanks or zeros, and may end a line. */
static size_t trimmed(const char *text, size_t length) {
    while (length && (text[length - 1] == ' ' || text[length - 1] == '\0' ||
                      text[length - 1] == '\r' || text[length - 1] == '\n'))
        length--;
    return length;
}

void put_text(FILE *out, const char *text, size_t length) {
    size_t used = trimmed(text, length);
    if (used == 0)
        fprintf(out, "empty");
    else if (used <= 200 && is_plain(text, used))
        fprintf(out, "%.*s", (int)used, text);
    else
        fprintf(out, "text of %zu byte%s", used, used == 1 ? "" : "s");
}

void put_name(FILE *out, const char *name, size_t length) {
    if (is_technical(name, length))
        fprintf(out, "%.*s", (int)length, name);
    else
        fprintf(out, "(name of %zu byte%s)", length, length == 1 ? "" : "s");
}

/* --- JSON ----------------------------------------------------------------- */

static json_t *of_kind(const char *kind, size_t size) {
    char text[64];
    snprintf(text, sizeof text, "(%s of %zu)", kind, size);
    return json_string(text);
}

static json_t *technical_object(const json_t *from) {
    json_t *made = json_object();
    void *at = json_object_iter((json_t *)from);
    for (size_t n = 1; at; at = json_object_iter_next((json_t *)from, at)) {
        const char *key = json_object_iter_key(at);
        json_t *value = json_object_iter_value(at);
        char hidden[64];
        if (is_technical(key, strlen(key))) {
            json_object_set_new(made, key,
                                json_is_number(value) &&
                                        !has_technical_number(key, strlen(key))
                                    ? json_string("(number)")
                                    : technical_json(value));
            continue;
        }
        snprintf(hidden, sizeof hidden, "(name %zu of %zu bytes)", n++,
                 strlen(key));
        json_object_set_new(
            made, hidden,
            json_is_object(value)   ? of_kind("object", json_object_size(value))
            : json_is_array(value)  ? of_kind("list", json_array_size(value))
            : json_is_string(value) ? of_kind("text", json_string_length(value))
                                    : json_string("(number)"));
    }
    return made;
}

json_t *technical_json(const json_t *from) {
    if (json_is_object(from))
        return technical_object(from);
    if (json_is_array(from)) {
        json_t *list = json_array();
        for (size_t i = 0; i < json_array_size(from); i++)
            json_array_append_new(list,
                                  technical_json(json_array_get(from, i)));
        return list;
    }
    if (!json_is_string(from))
        return json_deep_copy(from);
    const char *text = json_string_value(from);
    size_t length = json_string_length(from);
    return is_plain(text, length) && (length < 4 || !is_number(text, length))
               ? json_string(text)
               : of_kind("text", length);
}

/* --- messages ------------------------------------------------------------- */

/* Whether a text has a word, in any case. */
static bool has_word(const char *text, size_t size, const char *word,
                     size_t length) {
    for (size_t at = 0; at + length <= size; at++) {
        size_t i = 0;
        while (i < length && tolower((unsigned char)text[at + i]) ==
                                 tolower((unsigned char)word[i]))
            i++;
        if (i == length)
            return true;
    }
    return false;
}

/* Words of messages are small letters, such as --dataset too. */
static bool is_small(const char *word, size_t length) {
    for (size_t i = 0; i < length; i++)
        if (!islower((unsigned char)word[i]) && word[i] != '-')
            return false;
    return true;
}

static bool is_ours(const char *word, size_t length, const char *foreign,
                    size_t size) {
    if (is_technical(word, length))
        return true;
    /* Short numbers stand in any bytes, so they are looked for in the path. */
    if (is_number(word, length) && length < 5)
        size = strcspn(foreign, "\n");
    return (is_small(word, length) || is_number(word, length)) &&
           !has_word(foreign, size, word, length);
}

void put_message(FILE *out, const char *message, const char *foreign,
                 size_t size) {
    size_t left = strlen(message);
    for (size_t length; left; message += length, left -= length) {
        length = 0;
        while (length < left && (isalnum((unsigned char)message[length]) ||
                                 (unsigned char)message[length] > 127 ||
                                 strchr("-_/.<>=", message[length])))
            length++;
        if (length == 0) {
            length = 1;
            putc(isprint((unsigned char)*message) ? *message : '?', out);
            continue;
        }
        size_t bare = length; /* without the point that ends a sentence */
        while (bare > 1 && message[bare - 1] == '.')
            bare--;
        if (is_ours(message, bare, foreign, size))
            fprintf(out, "%.*s", (int)length, message);
        else
            putc('*', out);
    }
    putc('\n', out);
}

/* The names in a folder and the first bytes of its files; `left` bounds how
 * many entries are looked at. */
static void add_folder(FILE *out, const char *path, int *left) {
    DIR *folder = opendir(path);
    struct dirent *entry;
    while (folder && *left > 0 && (entry = readdir(folder))) {
        char inner[PATH_MAX];
        struct stat facts;
        unsigned char bytes[16384];
        if (entry->d_name[0] == '.' && strlen(entry->d_name) < 3)
            continue;
        --*left;
        fprintf(out, "%s\n", entry->d_name);
        if (snprintf(inner, sizeof inner, "%s/%s", path, entry->d_name) >=
                (int)sizeof inner ||
            lstat(inner, &facts) != 0)
            continue;
        if (S_ISDIR(facts.st_mode))
            add_folder(out, inner, left);
        FILE *data = S_ISREG(facts.st_mode) ? fopen(inner, "rb") : NULL;
        if (data) {
            fwrite(bytes, 1, fread(bytes, 1, sizeof bytes, data), out);
            fclose(data);
        }
    }
    if (folder)
        closedir(folder);
}

char *foreign_text(const char *path, const source *from, size_t *size) {
    char *text = NULL;
    int left = 4000;
    FILE *out = open_memstream(&text, size);
    if (!out)
        return NULL;
    fprintf(out, "%s\n", path);
    if (from->file >= 0)
        fwrite(from->head, 1, from->head_size, out);
    else
        add_folder(out, path, &left);
    fclose(out);
    return text;
}
