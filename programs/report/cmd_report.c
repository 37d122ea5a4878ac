/* cmd_report.c - the verb report: what a report of a fault needs to know of
 * this build and of a file, and nothing of a person or a place. */
#define _POSIX_C_SOURCE 200809L
#include "commands/commands.h"
#include "commands/info_volume.h"
#include "picture/outputs.h"
#include "report/report.h"
#include "run/log.h"
#include "run/paths.h"

#include <errno.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>

/* What the library says of a file while it is opened. */
typedef struct messages {
    FILE *out;
    char *foreign;
    size_t size;
} messages;

static void take_warning(void *user, const char *text) {
    messages *m = user;
    fprintf(m->out, "warning: ");
    put_message(m->out, text, m->foreign, m->size);
}

/* The object of info --json, whose words are technical ones only. */
static void put_info(FILE *out, const snow_volume *volume) {
    snow_volume_statistics found;
    snow_volume_statistics_init(&found);
    json_t *object = json_object();
    info_set_geometry(object, snow_volume_get_info(volume));
    if (snow_volume_get_statistics(volume, &found) == SNOW_STATUS_OK) {
        json_object_set_new(object, "voxels", json_integer(found.voxels));
        json_object_set_new(object, "finite", json_integer(found.finite));
        json_object_set_new(object, "min", json_number(found.min));
        json_object_set_new(object, "max", json_number(found.max));
        json_object_set_new(object, "sum", json_number(found.sum));
    }
    json_t *shown = technical_json(object);
    char *text = json_dumps(shown, JSON_FORM);
    fprintf(out, "%s\n", text ? text : "");
    free(text);
    json_decref(shown);
    json_decref(object);
}

static void put_volume(messages *m, const options *opts, const char *path) {
    snow_context *context = NULL;
    snow_volume *volume = NULL;
    snow_volume_options data = data_options(opts);
    fprintf(m->out, "\ninfo --json\n");
    snow_status status = snow_context_new(NULL, &context);
    if (status == SNOW_STATUS_OK) {
        snow_context_set_warning(context, take_warning, m);
        status = snow_volume_open(context, path, &data, &volume);
    }
    if (status == SNOW_STATUS_OK) {
        put_info(m->out, volume);
    } else {
        fprintf(m->out, "error %d: ", (int)status);
        put_message(m->out,
                    context ? snow_context_message(context) : "out of memory",
                    m->foreign, m->size);
    }
    snow_volume_close(volume);
    snow_context_free(context);
}

/* A volume that is computed has no file. */
static bool is_phantom(const char *path) {
    return strncmp(path, "phantom:", 8) == 0;
}

static void put_structure(FILE *out, const source *from, const char *path) {
    fprintf(out, "\nstructure\n");
    if (is_phantom(path))
        fprintf(out, "a phantom, which has no file\n");
    else if (from->file < 0)
        report_folder(out, path);
    else {
        fprintf(out, "%llu bytes%s\n", (unsigned long long)from->size,
                from->head_size > 1 && from->size > 1 ? "" : ", empty");
        if (!report_dicom(out, from) && !report_nifti(out, from) &&
            !report_text(out, from) && !report_tiff(out, from) &&
            !report_hdf5(out, from) && !report_netcdf(out, from))
            fprintf(out, "no structure of this format is written\n");
    }
}

/* Opens what a report is made of; a folder or a phantom has no bytes. */
static int open_source(const char *path, source *out) {
    *out = (source){.file = -1};
    if (is_phantom(path) || is_folder(path) || source_open(path, out))
        return CONTINUE;
    return fail_with(SNOW_STATUS_BAD_INPUT,
                     "%s: cannot be read: %s; check the "
                     "name and the permissions",
                     path, strerror(errno));
}

/* The header first: what the library does with the file may be the fault. */
static int put_report(FILE *out, const options *opts, const char *path) {
    char file[PATH_MAX];
    source from;
    messages m = {.out = out};
    file_of_input(path, file, sizeof file);
    int done = open_source(file, &from);
    if (done != CONTINUE)
        return done;
    fprintf(out, "snowglass report: no names of files or people, no voxels\n"
                 "\ndoctor --json\n");
    doctor_write(out);
    put_structure(out, &from, file);
    fflush(out);
    m.foreign = foreign_text(path, &from, &m.size);
    if (m.foreign)
        put_volume(&m, opts, path);
    free(m.foreign);
    source_close(&from);
    return CONTINUE;
}

/* It is shown, and then written where that is requested. */
int cmd_report(const options *opts) {
    char *text = NULL;
    size_t size = 0;
    FILE *out = open_memstream(&text, &size);
    if (!out)
        return fail_memory("report: there is no memory for its text");
    int done = put_report(out, opts, opts->operands[0]);
    fclose(out);
    if (done == CONTINUE) {
        fwrite(text, 1, size, stdout);
        done = finish_stdout();
    }
    if (done == 0 && opts->output)
        done = write_text(text, size, opts->output, opts->overwrite);
    free(text);
    return done;
}
