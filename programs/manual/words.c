/* words.c - what can be asked of a row of the tables. */
#include "manual/manual.h"

#include <ctype.h>
#include <string.h>

/* A word that is typed as it stands, in a text such as "key|head|AZ,EL". */
static bool is_literal(const char *word, size_t length) {
    bool good = length > 0 && length < WORD_BYTES && word[0] != '-';
    for (size_t i = 0; i < length && good; i++)
        good = islower((unsigned char)word[i]) ||
               isdigit((unsigned char)word[i]) || word[i] == '-';
    return good;
}

/* Number `index` of the literal words of a text. */
static const char *literal(const char *text, const char *between, size_t index,
                           char room[WORD_BYTES]) {
    while (text && *text) {
        size_t length = strcspn(text, between);
        if (is_literal(text, length) && index-- == 0) {
            memcpy(room, text, length);
            room[length] = '\0';
            return room;
        }
        text += length + (text[length] != '\0');
    }
    return NULL;
}

/* Numbers are names of components too. */
static const char *component_word(size_t index) {
    static const char *const names[] = {"x", "y", "z", "w", "magnitude"};
    return index < sizeof names / sizeof *names ? names[index] : NULL;
}

/* Topics, then verbs. */
static const char *topic_word(size_t index) {
    size_t topics = 0, verbs = 0;
    while (topic_table[topics].name)
        topics++;
    if (index < topics)
        return topic_table[index].name;
    for (const verb_row *verb = verb_table; verb->name; verb++)
        if (verbs++ == index - topics)
            return verb->name;
    return NULL;
}

const char *option_word(const option_row *row, size_t index,
                        char room[WORD_BYTES]) {
    if (row->read == read_preset)
        return snow_preset_name(index);
    if (row->read == read_colormap)
        return snow_colormap_name(index);
    if (row->read == read_view)
        return snow_view_name(index);
    if (row->read == read_type)
        return index < SNOW_TYPE_FLOAT64
                   ? snow_type_name((snow_type)(index + 1))
                   : NULL;
    if (row->read == read_component)
        return component_word(index);
    if (strcmp(row->name, "help") == 0)
        return topic_word(index);
    return literal(row->argument, "|", index, room);
}

const char *word_text(const char *text, const char *word) {
    size_t length = strlen(word);
    for (const char *at = text; (at = strstr(at, word)); at += length)
        if (strncmp(at + length, ": ", 2) == 0 &&
            (at == text || (at - text >= 2 && strchr(";.", at[-2]))))
            return at + length + 2;
    return NULL;
}

const char *verb_word(const verb_row *verb, size_t index,
                      char room[WORD_BYTES]) {
    if (verb->bit == VERB_PHANTOM)
        return snow_phantom_name(index);
    if (verb->bit == VERB_HELP)
        return topic_word(index);
    return literal(verb->usage, " |", index, room);
}

bool option_takes_word(const option_row *row) {
    return row->argument && row->argument[0] != '[';
}

bool option_takes_file(const option_row *row) {
    return row->argument && strcmp(row->argument, "FILE") == 0;
}

bool verb_takes(const verb_row *verb, const option_row *row) {
    return (row->verbs & verb->bit) != 0;
}

bool option_is_of_ranks(const option_row *row) {
    return row->topic == TOPIC_RANKS;
}

/* Up to a bracket, or the end of a clause. */
const char *brief(const char *text, char room[BRIEF_BYTES]) {
    size_t length = 0;
    while (text[length] && length + 1 < BRIEF_BYTES &&
           strncmp(text + length, " (", 2) != 0 &&
           strncmp(text + length, ". ", 2) != 0 &&
           strncmp(text + length, "; ", 2) != 0)
        length++;
    memcpy(room, text, length);
    room[length] = '\0';
    return room;
}
