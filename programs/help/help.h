/* help.h - the parts of the help; help_print of options.h prints it. */
#ifndef HELP_H
#define HELP_H

#include "options/options.h"

/* Prints words, beginning at column `at` and wrapped to `indent`. */
void help_wrapped(const char *text, int at, int indent);

/* Prints one option with its own text or a shorter one. */
void help_option(const option_row *row, const char *text);

/* Prints one of the library's lists of names, below an empty line; `text` NULL:
 * the names alone. */
void help_names(const char *title, const char *(*name)(size_t),
                const char *(*text)(size_t));

/* Prints the views and what they mean. */
void help_views(void);

/* Prints the topics that have options of some verbs, with their texts. */
void help_topics(unsigned verbs);

/* Prints the page of a topic, or of a verb: its own options, the common ones,
 * examples and topics. Returns an exit code. */
void help_topic_page(topic which);
int help_verb_page(const verb_row *verb);

/* The option of a name, or of a letter; NULL: none. */
const option_row *help_option_named(const char *word);

/* Prints the page of an option or of a preset. */
void help_option_page(const option_row *row);
void help_preset_page(size_t index);

#endif
