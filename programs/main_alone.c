/* main_alone.c - the tool as one process. */
#include "run/start.h"

int main(int argc, char **argv) {
    const process_start alone = {.comm = NULL};
    return tool_run(argc, argv, &alone);
}
