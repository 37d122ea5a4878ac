/* The snippet of README.md and snowglass(3). */
#include <snowglass/snowglass.h>

#include <stdio.h>

int main(int argc, char **argv) {
    SNIPPET
    return status != SNOW_STATUS_OK;
}
