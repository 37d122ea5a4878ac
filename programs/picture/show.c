/* show.c - implements show.h.
 *
 * By kitty's graphics protocol ("Terminal graphics protocol", K. Goyal) where
 * the environment names a terminal that has it; elsewhere by half blocks, two
 * pixels in each character cell in colours of 24 bits.  tmux and screen keep
 * the variables of the terminal that they run in, but do not pass its graphics
 * on. */
#define _DEFAULT_SOURCE
#include "picture/show.h"
#include "run/log.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <unistd.h>

/* Bytes of the picture in one of kitty's messages: 4096 letters of base64. */
#define CHUNK 3072

typedef struct pixels {
    int width, height;
    unsigned char *rgb;
} pixels;

int show_check(const options *opts) {
    if (!opts->show || isatty(STDOUT_FILENO))
        return CONTINUE;
    return fail_usage("--show: standard output is not a terminal; remove it, "
                      "and write a file with -o");
}

static bool is_named(const char *variable, const char *part) {
    const char *value = getenv(variable);
    return value && strstr(value, part);
}

static bool has_kitty(void) {
    const bool multiplexed = getenv("TMUX") || getenv("STY") ||
                             is_named("TERM", "screen") ||
                             is_named("TERM", "tmux");
    if (multiplexed)
        return false;
    return getenv("KITTY_WINDOW_ID") || is_named("TERM", "kitty") ||
           is_named("TERM", "ghostty") || is_named("TERM_PROGRAM", "ghostty") ||
           is_named("TERM_PROGRAM", "WezTerm");
}

static void print_base64(const unsigned char *bytes, size_t count) {
    static const char letters[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZ"
                                  "abcdefghijklmnopqrstuvwxyz0123456789+/";
    for (size_t i = 0; i < count; i += 3) { /* pixels have three bytes */
        unsigned long word = (unsigned long)bytes[i] << 16 |
                             (unsigned long)bytes[i + 1] << 8 | bytes[i + 2];
        for (int shift = 18; shift >= 0; shift -= 6)
            putchar(letters[word >> shift & 63]);
    }
}

static void print_kitty(const pixels *p) {
    size_t all = 3 * (size_t)p->width * (size_t)p->height;
    for (size_t at = 0; at < all; at += CHUNK) {
        size_t count = all - at < CHUNK ? all - at : CHUNK;
        printf("\033_G");
        if (at == 0)
            printf("a=T,f=24,s=%d,v=%d,q=2,", p->width, p->height);
        printf("m=%d;", at + count < all);
        print_base64(p->rgb + at, count);
        printf("\033\\");
    }
    printf("\n");
}

/* The mean of the pixels from (x0, y0) to, not including, (x1, y1). */
static void mean_of(const pixels *p, int x0, int y0, int x1, int y1,
                    int out[3]) {
    long sums[3] = {0}, count = (long)(x1 - x0) * (y1 - y0);
    for (int y = y0; y < y1; y++)
        for (int x = x0; x < x1; x++)
            for (int c = 0; c < 3; c++)
                sums[c] +=
                    p->rgb[3 * ((size_t)y * (size_t)p->width + (size_t)x) +
                           (size_t)c];
    for (int c = 0; c < 3; c++)
        out[c] = (int)(sums[c] / count);
}

/* Pixels per half block, so that the picture fits the window. */
static int step_for(const pixels *p) {
    struct winsize window = {0};
    if (ioctl(STDOUT_FILENO, TIOCGWINSZ, &window) != 0 || !window.ws_col ||
        window.ws_row < 2)
        window = (struct winsize){.ws_row = 24, .ws_col = 80};
    int across = (p->width + window.ws_col - 1) / window.ws_col;
    int rows = 2 * (window.ws_row - 1);
    int down = (p->height + rows - 1) / rows;
    return across > down ? across : down;
}

static int least(int a, int b) {
    return a < b ? a : b;
}

/* The upper half has the colour of the letter, the lower that behind it. */
static void print_blocks(const pixels *p) {
    int step = step_for(p), upper[3], lower[3];
    for (int y = 0; y < p->height; y += 2 * step) {
        for (int x = 0; x < p->width; x += step) {
            int right = least(x + step, p->width);
            int middle = least(y + step, p->height);
            mean_of(p, x, y, right, middle, upper);
            printf("\033[38;2;%d;%d;%d", upper[0], upper[1], upper[2]);
            if (middle < p->height) {
                mean_of(p, x, middle, right, least(middle + step, p->height),
                        lower);
                printf(";48;2;%d;%d;%d", lower[0], lower[1], lower[2]);
            }
            printf("m\xe2\x96\x80");
        }
        printf("\033[0m\n");
    }
}

int show_picture(const snow_image *image, const snow_image_options *form) {
    pixels p = {snow_image_width(image), snow_image_height(image), NULL};
    p.rgb = malloc(3 * (size_t)p.width * (size_t)p.height);
    if (!p.rgb)
        return fail_memory("out of memory to show %d x %d pixels; use a "
                           "smaller --size",
                           p.width, p.height);
    snow_image_to_rgb8(image, form, p.rgb);
    if (has_kitty())
        print_kitty(&p);
    else
        print_blocks(&p);
    free(p.rgb);
    int done = finish_stdout();
    return done == SNOW_STATUS_OK ? CONTINUE : done;
}
