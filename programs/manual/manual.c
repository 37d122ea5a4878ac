/* manual.c - snowglass-manual: `man [VERB|mpi]`, `header FILE`, `document N
 * SUMMARY (FILE HEADING TITLE)...`, `bash`, `zsh`, `fish`, `fish-mpi`, `json`
 * or `options` (as Markdown) to standard output. */
#include "manual/manual.h"

#include <stdio.h>
#include <string.h>

static int refuse(void) {
    fputs("usage: snowglass-manual man [VERB|mpi] | header FILE |\n"
          "  document N SUMMARY (FILE HEADING TITLE)... |\n"
          "  bash | zsh | fish | fish-mpi | json | options\n",
          stderr);
    return SNOW_STATUS_BAD_USAGE;
}

int main(int argc, char **argv) {
    const char *what = argc > 1 ? argv[1] : "";
    bool done = argc == 2;
    int code = SNOW_STATUS_OK;
    if (strcmp(what, "man") == 0)
        done = print_page(argc > 2 ? argv[2] : NULL);
    else if (argc == 3 && strcmp(what, "header") == 0)
        done = print_header(argv[2]);
    else if (strcmp(what, "document") == 0)
        done = print_document(argc - 2, argv + 2);
    else if (done && strcmp(what, "options") == 0)
        print_options();
    else if (done && strcmp(what, "bash") == 0)
        print_bash();
    else if (done && strcmp(what, "zsh") == 0)
        print_zsh();
    else if (done && strncmp(what, "fish", 4) == 0)
        print_fish(what[4] != '\0');
    else if (done && strcmp(what, "json") == 0)
        code = print_schema();
    else
        done = false;
    if (!done)
        return refuse();
    return fflush(stdout) || ferror(stdout) ? SNOW_STATUS_BAD_OUTPUT : code;
}
