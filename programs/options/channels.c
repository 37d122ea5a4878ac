/* channels.c - see channels.h.  The form of a word behind a channel says what
 * it is: a range has "..", an opacity is a number, a colour is neither. */
#include "options/channels.h"
#include "options/config.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

static bool refuse(char wrong[WRONG_BYTES], const char *text, const char *why) {
    snprintf(wrong, WRONG_BYTES, "is no list of channels: '%.40s' %s", text,
             why);
    return false;
}

bool channels_rgb(const char *text, double rgb[3]) {
    char *end;
    if (*text != '#' || strlen(text) != 7 ||
        strspn(text + 1, "0123456789abcdefABCDEF") != 6)
        return false;
    const unsigned long all = strtoul(text + 1, &end, 16);
    for (int c = 0; c < 3; c++)
        rgb[c] = (double)(all >> (16 - 8 * c) & 255) / 255;
    return true;
}

/* "100..2000", "p1..p99.9". */
static bool parse_range(const char *text, range_value *out) {
    char list[80];
    const char *dots = strstr(text, "..");
    if (!dots || strlen(text) >= sizeof list)
        return false;
    snprintf(list, sizeof list, "%.*s,%s", (int)(dots - text), text, dots + 2);
    return value_range(list, out);
}

static bool parse_word(const char *word, channel_pick *pick,
                       char wrong[WRONG_BYTES]) {
    double rgb[3], opacity;
    if (strstr(word, ".."))
        return parse_range(word, &pick->range) ||
               refuse(wrong, word, "is no range, such as 100..2000 or p1..p99");
    if (value_real(word, &opacity)) {
        pick->opacity = opacity;
        return (opacity >= 0 && opacity <= 1) ||
               refuse(wrong, word, "is no opacity from 0 to 1");
    }
    if (strlen(word) >= sizeof pick->color ||
        (!channels_rgb(word, rgb) && snow_colormap_from_name(word) < 0))
        return refuse(wrong, word,
                      "is no colour: give red, green, blue, cyan, magenta, "
                      "yellow, grey, #rrggbb or another colour map");
    snprintf(pick->color, sizeof pick->color, "%s", word);
    return true;
}

/* The next part of a text up to a separator; false: too long. */
static bool take(const char **at, const char *ends, char *out, size_t size) {
    const size_t length = strcspn(*at, ends);
    if (length >= size)
        return false;
    memcpy(out, *at, length);
    out[length] = 0;
    *at += length;
    return true;
}

/* As names of files are cut: whole letters of UTF-8. */
static void cut_name(const char *word, char *out, size_t size) {
    size_t length = strlen(word);
    if (length >= size)
        for (length = size - 1; length && (word[length] & 0xc0) == 0x80;)
            length--;
    memcpy(out, word, length);
    out[length] = 0;
}

static bool parse_pick(const char **at, channel_pick *pick,
                       char wrong[WRONG_BYTES]) {
    char word[400];
    *pick = (channel_pick){.index = -1, .opacity = 1};
    if (!take(at, ":,", word, sizeof word) || !*word)
        return refuse(wrong, *at, "names no channel: give a number or a name");
    cut_name(word, pick->name, sizeof pick->name);
    if (!value_integer(pick->name, &pick->index))
        pick->index = -1;
    else if (pick->index < 0)
        return refuse(wrong, pick->name, "is below 0");
    while (**at == ':') {
        ++*at;
        if (!take(at, ":,", word, sizeof word) || !*word)
            return refuse(wrong, *at, "says nothing of a channel");
        if (!parse_word(word, pick, wrong))
            return false;
    }
    return true;
}

bool channels_parse(const char *text, channel_list *out,
                    char wrong[WRONG_BYTES]) {
    channel_list list = {.count = 0};
    for (const char *at = text;; at++) {
        if (list.count == SNOW_CHANNELS_MAX) {
            snprintf(wrong, WRONG_BYTES,
                     "has too many channels: up to %d are "
                     "shown together",
                     SNOW_CHANNELS_MAX);
            return false;
        }
        if (!parse_pick(&at, &list.picks[list.count++], wrong))
            return false;
        if (!*at)
            break;
    }
    list.plain = list.count == 1 && !strchr(text, ':');
    *out = list;
    return true;
}

bool channels_find(channel_list *list, const snow_volume_info *info,
                   const char **missing) {
    for (int n = 0; n < list->count; n++) {
        channel_pick *pick = &list->picks[n];
        for (int i = 0; i < SNOW_CHANNELS_MAX && pick->index < 0; i++)
            if (i < info->channels && *info->channel[i].name &&
                strcasecmp(pick->name, info->channel[i].name) == 0)
                pick->index = i;
        if (pick->index < 0) {
            *missing = pick->name;
            return false;
        }
    }
    return true;
}

void channels_text(const channel_list *list, char *out, size_t size) {
    size_t used = 0;
    *out = 0;
    for (int n = 0; n < list->count; n++) {
        const channel_pick *pick = &list->picks[n];
        const range_value *r = &pick->range;
        const char *p = r->kind == SNOW_RANGE_PERCENTILES ? "p" : "";
        char low[40], high[40], range[96] = "", opacity[48] = "";
        config_real(r->low, low);
        config_real(r->high, high);
        if (r->kind == SNOW_RANGE_VALUES || r->kind == SNOW_RANGE_PERCENTILES)
            snprintf(range, sizeof range, ":%s%s..%s%s", p, low, p, high);
        if (pick->opacity < 1) {
            config_real(pick->opacity, low);
            snprintf(opacity, sizeof opacity, ":%s", low);
        }
        used += (size_t)snprintf(out + used, size - used, "%s%lld%s%s%s%s",
                                 n ? "," : "", (long long)pick->index,
                                 *pick->color ? ":" : "", pick->color, range,
                                 opacity);
        if (used >= size)
            return;
    }
}

/* Those of napari, for two, three, and more. */
static const char *usual_color(int n, int count) {
    static const char *const two[] = {"magenta", "green"};
    static const char *const three[] = {"red", "green", "blue"};
    static const char *const more[] = {"cyan",  "yellow", "magenta", "red",
                                       "green", "blue",   "grey",    "hot"};
    return count <= 1   ? "grey"
           : count == 2 ? two[n]
           : count == 3 ? three[n]
                        : more[n % 8];
}

#define PALE_BLUE "#4d4dff"

/* A colour that has a name gets it. */
static void name_color(const double rgb[3], char out[32]) {
    static const char *const names[] = {"",    "blue",    "green",  "cyan",
                                        "red", "magenta", "yellow", "grey"};
    int at = 0, level[3];
    bool full = true;
    for (int c = 0; c < 3; c++) {
        level[c] = (int)lround(255 * rgb[c]);
        full = full && (level[c] == 0 || level[c] == 255);
        at = 2 * at + (level[c] == 255);
    }
    if (full && at)
        snprintf(out, 32, "%s", names[at]);
    else
        snprintf(out, 32, "#%02x%02x%02x", (unsigned)level[0] & 255,
                 (unsigned)level[1] & 255, (unsigned)level[2] & 255);
}

void channels_fill(channel_list *list, const snow_volume_info *info,
                   const char *colormap) {
    for (int n = 0; n < list->count; n++) {
        channel_pick *pick = &list->picks[n];
        const bool known = pick->index < SNOW_CHANNELS_MAX &&
                           info->channel[pick->index].color[0] >= 0;
        if (*pick->color)
            continue;
        if (known && !colormap)
            name_color(info->channel[pick->index].color, pick->color);
        else
            snprintf(pick->color, sizeof pick->color, "%.31s",
                     colormap ? colormap : usual_color(n, list->count));
        if (pick->light && !colormap && strcmp(pick->color, "blue") == 0)
            strcpy(pick->color, PALE_BLUE);
    }
}

/* More are no stains but a spectrum, or times. */
#define MOST_STAINS 16

bool channels_are_light(const channel_list *list,
                        const snow_volume_info *info) {
    bool all = list->count > 0, colored = false;
    for (int n = 0; n < list->count; n++) {
        const int64_t at = list->picks[n].index;
        const bool own = at < SNOW_CHANNELS_MAX && info->channel[at].own;
        all = all && !own && !info->directions &&
              (!info->light || (at < 64 && (info->light >> at & 1)));
        colored |= *list->picks[n].color != 0;
    }
    return all && (info->light || (colored && info->channels > 1 &&
                                   info->channels <= MOST_STAINS));
}

void channels_of_file(const snow_volume_info *info, channel_list *out) {
    channel_list list = {.count = 0};
    for (int n = 0; n < SNOW_CHANNELS_MAX && n < info->channels; n++) {
        const snow_channel *of = &info->channel[n];
        channel_pick *pick = &list.picks[list.count];
        if (!of->shown)
            continue;
        *pick = (channel_pick){.index = n, .opacity = 1};
        snprintf(pick->name, sizeof pick->name, "%.39s", of->name);
        list.count++;
    }
    if (list.count == 1 && list.picks[0].index == 0)
        list.count = 0;
    *out = list;
}

void channels_of_directions(channel_list *out) {
    static const char *const names[] = {"|x|", "|y|", "|z|"};
    static const char *const colors[] = {"red", "green", "blue"};
    *out = (channel_list){.count = 3};
    for (int n = 0; n < 3; n++) {
        out->picks[n] = (channel_pick){.index = n, .opacity = 1};
        strcpy(out->picks[n].name, names[n]);
        strcpy(out->picks[n].color, colors[n]);
    }
}
