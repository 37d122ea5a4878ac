/* default_name.c - implements default_name.h. */
#define _XOPEN_SOURCE 700
#include "picture/default_name.h"
#include "commands/commands.h"
#include "picture/outputs.h"
#include "run/log.h"
#include "run/paths.h"
#include "run/start.h"

#include <ctype.h>
#include <errno.h>
#include <limits.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

/* The last part of a path; for "." and "..", of the folder that they mean. */
static void take_name(const char *path, char out[STEM_BYTES]) {
    char real[PATH_MAX];
    size_t length = strlen(path);
    while (length > 1 && path[length - 1] == '/')
        length--;
    const char *end = path + length, *name = end;
    while (name > path && name[-1] != '/')
        name--;
    if (strspn(name, "./") >= (size_t)(end - name) && realpath(path, real)) {
        name = strrchr(real, '/') + 1;
        end = name + strlen(name);
    }
    snprintf(out, STEM_BYTES, "%.*s", (int)(end - name), name);
}

void default_stem(const char *given, char out[STEM_BYTES]) {
    bool phantom = strncmp(given, "phantom:", 8) == 0;
    const char *within = strstr(given, ":/"); /* a dataset of a file */
    char path[PATH_MAX];
    snprintf(path, sizeof path, "%.*s",
             (int)(within ? within - given : (ptrdiff_t)strlen(given)), given);
    take_name(phantom ? path + 8 : path, out);
    char *dot = strrchr(out, '.');
    bool folder = is_folder(path) && !(dot && strcmp(dot, ".zarr") == 0);
    if (phantom || folder)
        return;
    if (dot && (strcmp(dot, ".gz") == 0 || strcmp(dot, ".zip") == 0))
        *dot = '\0';
    dot = strrchr(out, '.'); /* 1.2.840 has no suffix */
    if (dot && dot > out && isalpha((unsigned char)dot[1]))
        *dot = '\0';
}

int default_name(options *opts) {
    static char path[NAME_MAX + 8];
    char name[STEM_BYTES];
    struct stat what;
    if (opts->output || opts->operand_count != 1)
        return CONTINUE;
    if (opts->show) { /* shown only, and not written */
        opts->output = "-";
        return CONTINUE;
    }
    if (strcmp(opts->operands[0], "-") == 0)
        return fail_usage("no output file given; add -o OUT.png");
    if (strpbrk(opts->operands[0], "*?[%"))
        return fail_usage("%s: a pattern gives the picture no name; add "
                          "-o OUT.png",
                          opts->operands[0]);
    errno = 0;
    default_stem(opts->operands[0], name);
    if (errno && !means_absence(errno)) {
        say("%s: cannot be opened: %s; check the name and the permissions",
            opts->operands[0], strerror(errno));
        return SNOW_STATUS_BAD_INPUT;
    }
    snprintf(path, sizeof path, "%s.png", name);
    opts->output = path;
    opts->named = true;
    if (!process_talks() || lstat(path, &what) != 0)
        return CONTINUE;
    int done = check_input_first(opts, &opts->output, 1);
    if (done != CONTINUE)
        return done;
    if (same_output(path, opts->operands[0]))
        return fail_output("%s: is the input; give another name with -o", path);
    return fail_output("%s: exists, and is replaced only where it is named; "
                       "give another name with -o, or -o %s -y",
                       path, path);
}
