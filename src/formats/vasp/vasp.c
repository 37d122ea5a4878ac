/* formats/vasp/vasp.c - grids of VASP: CHGCAR, CHG, PARCHG, AECCAR, LOCPOT,
 * ELFCAR.  After "CHGCAR", "LOCPOT" and "POSCAR" of VASP's wiki:
 *
 *     comment
 *     scale                      below 0: the volume of the cell; or x y z
 *     x y z                      of the three vectors of the cell
 *     names of elements          since VASP 5
 *     numbers of atoms
 *     Selective dynamics         perhaps
 *     Direct or Cartesian
 *     x y z                      of each atom
 *
 *     n1 n2 n3
 *     the values, n1 fastest
 *     augmentation occupancies   of a charge, and other lines
 *     n1 n2 n3                   magnetization, or spin down; in each direction
 *     the values ...
 *
 * A charge is multiplied by the volume of the cell, a potential is not.  The
 * cell is periodic: its first layers are its last ones too. */
#include "formats/array.h"
#include "formats/ascii.h"
#include "io/seekable.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#define LINE_BYTES 4096
#define MOST_KINDS 1024

/* More than a noncollinear calculation has. */
#define MOST_SETS 4

typedef enum vasp_kind { CHARGE, POTENTIAL, OTHER, UNKNOWN } vasp_kind;

typedef struct vasp_file {
    double cell[3][3]; /* vectors, in angstrom */
    double volume;
    snow_text_grid grid;
    int64_t sets;
    bool augmented; /* as charges are */
    vasp_kind kind;
} vasp_file;

/* --- the header ----------------------------------------------------------- */

static double volume_of(double v[3][3]) {
    return fabs(v[0][0] * (v[1][1] * v[2][2] - v[1][2] * v[2][1]) -
                v[0][1] * (v[1][0] * v[2][2] - v[1][2] * v[2][0]) +
                v[0][2] * (v[1][0] * v[2][1] - v[1][1] * v[2][0]));
}

/* Takes the cell from the lines behind the comment, which are apart by '\n' or
 * ends of strings; false if they are none. */
static bool take_cell(const char *const lines[4], vasp_file *out) {
    double scale[3];
    const int scales = snow_text_reals(lines[0], "", scale, 3);
    bool right = (scales == 1 && scale[0] != 0) ||
                 (scales == 3 && scale[0] > 0 && scale[1] > 0 && scale[2] > 0);
    for (int i = 0; i < 3 && right; i++)
        right = snow_text_reals(lines[i + 1], "", out->cell[i], 3) == 3;
    if (!right)
        return false;
    double factor = scale[0];
    if (factor < 0)
        factor = cbrt(-factor / volume_of(out->cell));
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            out->cell[i][j] *= scales == 3 ? scale[j] : factor;
    out->volume = volume_of(out->cell);
    return isfinite(out->volume) && out->volume > 0;
}

/* The atoms that a line counts, -1 if it does not. */
static int64_t count_atoms(const char *line) {
    int64_t counts[MOST_KINDS], all = 0;
    const int kinds = snow_text_integers(line, "", counts, MOST_KINDS);
    for (int i = 0; i < kinds && all >= 0; i++)
        all = counts[i] < 0 || counts[i] > INT32_MAX ? -1 : all + counts[i];
    return kinds < 1 ? -1 : all;
}

static bool is_name(const char *line) {
    return isalpha((unsigned char)line[strspn(line, " \t")]);
}

static bool probe_vasp(const unsigned char *bytes, size_t size) {
    char text[LINE_BYTES + 1];
    char *lines[9] = {text};
    int count = 1;
    vasp_file file;
    if (size > LINE_BYTES)
        size = LINE_BYTES;
    memcpy(text, bytes, size);
    text[size] = 0;
    if (memchr(text, 0, size))
        return false;
    for (char *at = text; count < 9 && (at = strchr(at, '\n')); count++) {
        *at++ = 0;
        lines[count] = at;
    }
    const char *const cell[4] = {lines[1], lines[2], lines[3], lines[4]};
    return count == 9 && take_cell(cell, &file) &&
           (count_atoms(lines[5]) > 0 ||
            (is_name(lines[5]) && count_atoms(lines[6]) > 0));
}

static snow_status next_line(snow_source *source, char line[LINE_BYTES]) {
    bool got;
    SNOW_TRY(snow_source_read_line(source, line, LINE_BYTES, &got));
    return got ? SNOW_STATUS_OK
               : snow_fail(snow_source_context(source), SNOW_STATUS_BAD_INPUT,
                           "ends in its header: it is a POSCAR, which has no "
                           "grid, or cut");
}

static snow_status fail_header(snow_source *source, const char *what) {
    return snow_fail(snow_source_context(source), SNOW_STATUS_BAD_INPUT,
                     "%s as in files of VASP; it is damaged, or of another "
                     "program",
                     what);
}

/* Passes the names of elements, their numbers and the atoms. */
static snow_status pass_atoms(snow_source *source) {
    char line[LINE_BYTES];
    SNOW_TRY(next_line(source, line));
    if (is_name(line))
        SNOW_TRY(next_line(source, line));
    const int64_t atoms = count_atoms(line);
    if (atoms < 0)
        return fail_header(source, "its atoms are not counted");
    SNOW_TRY(next_line(source, line));
    if (tolower((unsigned char)line[strspn(line, " \t")]) == 's')
        SNOW_TRY(next_line(source, line));
    for (int64_t i = 0; i < atoms; i++)
        SNOW_TRY(next_line(source, line));
    return SNOW_STATUS_OK;
}

static snow_status read_header(snow_source *source, snow_volume_info *info,
                               vasp_file *out) {
    char lines[5][LINE_BYTES];
    const char *const cell[4] = {lines[1], lines[2], lines[3], lines[4]};
    int64_t dims[3];
    for (int i = 0; i < 5; i++)
        SNOW_TRY(next_line(source, lines[i]));
    snow_copy_name(lines[0] + strspn(lines[0], " \t"), info->description,
                   sizeof info->description);
    if (!take_cell(cell, out))
        return fail_header(source, "its cell is not written");
    SNOW_TRY(pass_atoms(source));
    do
        SNOW_TRY(next_line(source, lines[0]));
    while (!lines[0][strspn(lines[0], " \t")]);
    if (snow_text_integers(lines[0], "", dims, 3) != 3 || dims[0] < 1 ||
        dims[1] < 1 || dims[2] < 1 || dims[0] > INT32_MAX ||
        dims[1] > INT32_MAX || dims[2] > INT32_MAX)
        return fail_header(source, "the sizes of its grid are not written");
    out->grid = (snow_text_grid){.values = 1,
                                 .order = {0, 1, 2},
                                 .dims = {dims[0], dims[1], dims[2]},
                                 .closed = true};
    return SNOW_STATUS_OK;
}

/* --- more grids ----------------------------------------------------------- */

/* Passes lines up to the sizes of another grid, if there is one. */
static snow_status find_grid(snow_source *source, vasp_file *file,
                             bool *found) {
    char line[LINE_BYTES];
    int64_t dims[4];
    for (*found = false; !*found;) {
        bool got;
        SNOW_TRY(snow_source_read_line(source, line, sizeof line, &got));
        if (!got)
            return SNOW_STATUS_OK;
        file->augmented |= !strncmp(line, "augmentation", 12);
        *found = snow_text_integers(line, "", dims, 4) == 3 &&
                 !memcmp(dims, file->grid.dims, sizeof file->grid.dims);
    }
    return SNOW_STATUS_OK;
}

/* Passes grids up to one, or all, and counts them. */
static snow_status pass_grids(snow_source *source, int64_t most,
                              vasp_file *file) {
    bool found = true;
    for (file->sets = 0; found && file->sets < most;) {
        SNOW_TRY(snow_skip_grid(source, &file->grid));
        file->sets++;
        SNOW_TRY(find_grid(source, file, &found));
    }
    return SNOW_STATUS_OK;
}

/* --- what it is ----------------------------------------------------------- */

static bool is_called(const char *path, const char *name) {
    const char *slash = strrchr(path, '/');
    for (const char *at = slash ? slash + 1 : path; *at; at++) {
        size_t i = 0;
        while (name[i] && toupper((unsigned char)at[i]) == name[i])
            i++;
        if (!name[i])
            return true;
    }
    return false;
}

static vasp_kind kind_of(const char *path, const vasp_file *file) {
    static const struct {
        const char *name;
        vasp_kind kind;
    } names[] = {{"LOCPOT", POTENTIAL},
                 {"ELFCAR", OTHER},
                 {"CHG", CHARGE},
                 {"AECCAR", CHARGE}};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        if (is_called(path, names[i].name))
            return names[i].kind;
    return file->augmented ? CHARGE : UNKNOWN;
}

static void name_sets(const vasp_file *file, snow_volume_info *info) {
    static const char *const names[2][MOST_SETS] = {
        {"total", "magnetization", "magnetization y", "magnetization z"},
        {"spin up", "spin down", "B2", "B3"}};
    static const char *const quantities[] = {"charge density", "potential",
                                             "localization", ""};
    static const char *const units[] = {"e/angstrom^3", "eV", "", ""};
    const bool spins = file->kind != CHARGE;
    snprintf(info->quantity, sizeof info->quantity, "%s",
             quantities[file->kind]);
    snprintf(info->value_unit, sizeof info->value_unit, "%s",
             units[file->kind]);
    if (file->sets < 2)
        return;
    snow_channels_begin(info, file->sets, false);
    if (file->kind == UNKNOWN)
        return;
    for (int i = 0; i < (int)file->sets; i++)
        snow_copy_name(names[spins][i], info->channel[i].name,
                       sizeof info->channel[i].name);
    if (file->sets == MOST_SETS)
        for (int i = 0; i < 2; i++)
            snow_copy_name(spins ? i ? "B1" : "scalar"
                           : i   ? "magnetization x"
                                 : "total",
                           info->channel[i].name, sizeof info->channel[i].name);
}

static void say_what(snow_context *context, const vasp_file *file,
                     snow_volume_info *info) {
    const int64_t *dims = file->grid.dims;
    for (int j = 0; j < 3; j++)
        for (int i = 0; i < 3; i++)
            info->matrix[i][j] = file->cell[j][i] / (double)dims[j];
    memcpy(info->unit, "angstrom", sizeof "angstrom");
    snow_notify(context,
                "the cell is periodic: the first layer of each axis is shown "
                "at its end too, %lldx%lldx%lld become %lldx%lldx%lld",
                (long long)dims[0], (long long)dims[1], (long long)dims[2],
                (long long)dims[0] + 1, (long long)dims[1] + 1,
                (long long)dims[2] + 1);
    if (file->kind == CHARGE) {
        info->slope = 1 / file->volume;
        snow_notify(context,
                    "values are divided by the volume of the cell, %g "
                    "angstrom^3, by which VASP multiplies charges",
                    file->volume);
    } else if (file->kind == UNKNOWN) {
        snow_notify(context,
                    "nothing says whether values are a charge, which VASP "
                    "multiplies by the volume of the cell, or a potential: "
                    "they are as stored; name the file CHGCAR or LOCPOT");
    }
}

static size_t copy_held(void *user, uint64_t at, void *bytes, size_t size) {
    return snow_seekable_read(user, at, bytes, size);
}

/* A source at the beginning of the bytes. */
static snow_status open_again(snow_source *source, snow_seekable *bytes,
                              snow_source **out) {
    const snow_bytes_behind behind = {copy_held, bytes,
                                      snow_seekable_size(bytes)};
    return snow_source_open_with(snow_source_context(source),
                                 snow_source_name(source), &behind, out);
}

/* Looks at the whole file, which does not say how many grids it has. */
static snow_status survey(snow_source *source, snow_volume_info *info,
                          vasp_file *file) {
    SNOW_TRY(read_header(source, info, file));
    SNOW_TRY(pass_grids(source, MOST_SETS, file));
    if (file->sets == 3)
        file->sets = 2;
    file->kind = kind_of(snow_source_name(source), file);
    return SNOW_STATUS_OK;
}

/* The source is at the beginning. */
static snow_status read_set(snow_source *source, int64_t set,
                            const snow_volume_options *options,
                            snow_volume_info *info, snow_volume **out) {
    vasp_file file = {.volume = 0};
    snow_volume_info other = snow_volume_info_default("vasp");
    SNOW_TRY(read_header(source, &other, &file));
    SNOW_TRY(pass_grids(source, set, &file));
    return snow_read_grid(source, &file.grid, options, info, out);
}

static snow_status read_grids(snow_source *source, snow_seekable *bytes,
                              const snow_volume_options *options,
                              snow_volume_info *info, snow_volume **out) {
    snow_context *context = snow_source_context(source);
    snow_source *from;
    vasp_file file = {.volume = 0};
    int64_t set;
    SNOW_TRY(open_again(source, bytes, &from));
    snow_status status = survey(from, info, &file);
    snow_source_close(from);
    SNOW_TRY(status);
    name_sets(&file, info);
    SNOW_TRY(snow_volume_pick_channel(context, options, file.sets, info, &set));
    if (set && file.kind == CHARGE) {
        snprintf(info->quantity, sizeof info->quantity, "%s",
                 info->channel[set].name);
        memcpy(info->value_unit, "mu_B/angstrom^3", sizeof "mu_B/angstrom^3");
    }
    say_what(context, &file, info);
    SNOW_TRY(open_again(source, bytes, &from));
    status = read_set(from, set, options, info, out);
    snow_source_close(from);
    return status;
}

static snow_status read_vasp(snow_source *source,
                             const snow_volume_options *options,
                             snow_volume_info *info, snow_volume **out) {
    snow_seekable *bytes;
    *info = snow_volume_info_default("vasp");
    SNOW_TRY(snow_seekable_open(source, &bytes));
    snow_status status = read_grids(source, bytes, options, info, out);
    snow_seekable_close(bytes);
    return status;
}

const snow_format snow_format_vasp = {
    .name = "vasp",
    .text = "VASP's grids (CHGCAR, CHG, LOCPOT, ELFCAR)",
    .suffixes = {"CHGCAR", "LOCPOT", "ELFCAR", "CHG", ".vasp"},
    .probe = probe_vasp,
    .crops = true,
    .channels = true,
    .read = read_vasp,
};
