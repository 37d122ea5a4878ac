/* topic.c - the page of a topic, and the list of topics. */
#include "help/help.h"

#include <stdio.h>

/* The options of all verbs, then the names that they take. */
void help_topic_page(topic which) {
    printf("%s: %s\n", topic_table[which].name, topic_table[which].text);
    for (const option_row *row = option_table; row->name; row++)
        if (row->topic == which)
            help_option(row, row->text);
    if (which == TOPIC_LOOK) {
        help_names("presets", snow_preset_name, snow_preset_description);
        help_names("colour maps", snow_colormap_name, NULL);
    } else if (which == TOPIC_CAMERA) {
        help_views();
    } else if (which == TOPIC_DATA) {
        help_names("formats", snow_format_name, snow_format_description);
        help_names("phantoms (as phantom:NAME)", snow_phantom_name,
                   snow_phantom_description);
    }
}

static bool has_options(topic which, unsigned verbs) {
    const option_row *row = option_table;
    while (row->name && !(row->topic == which && (row->verbs & verbs)))
        row++;
    return row->name != NULL;
}

void help_topics(unsigned verbs) {
    for (int i = 0; topic_table[i].name; i++)
        if (topic_is_here((topic)i) && has_options((topic)i, verbs))
            printf("  %-11s%s\n", topic_table[i].name, topic_table[i].text);
}
