/* operands.c - the words of a command that are no options: their number, and
 * what a wrong one was meant for. */
#include "options/guess.h"
#include "options/parse.h"
#include "run/log.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

/* Refuses the first of several words where no verb was written: it is not a
 * verb. */
static int refuse_verb(const char *word) {
    char near[128], verbs[256] = "";
    size_t used = 0;
    guess nearest;
    guess_begin(&nearest, word);
    for (const verb_row *row = verb_table; row->name; row++) {
        guess_offer(&nearest, row->name);
        if (used < sizeof verbs)
            used += (size_t)snprintf(verbs + used, sizeof verbs - used, " %s",
                                     row->name);
    }
    if (guess_write(&nearest, "", near, sizeof near))
        return fail_usage("%s: is not a verb; did you mean %s?", word, near);
    return fail_usage("%s: is neither a verb nor a file; verbs:%s", word,
                      verbs);
}

/* An extra word may be a misspelt verb, or a verb after the options.  `named`:
 * the verb was written. */
static int refuse_words(const options *out, const verb_row *verb, bool named) {
    const char *first = out->operands[0];
    /* it is no path of a file */
    const bool plain = verb->bit == VERB_RENDER && !strpbrk(first, "./:\\%#") &&
                       strcmp(first, "-") != 0 && access(first, F_OK) != 0;
    const verb_row *other = plain ? verb_named(first) : NULL;
    if (other)
        return fail_usage("%s: the verb must come first; give snowglass %s %s",
                          first, other->name, other->usage);
    if (plain && !named)
        return refuse_verb(first);
    const char *extra = out->operands[verb->operands];
    /* a shell has made a list of a pattern */
    if (verb->operands == 1 && !access(first, F_OK) && !access(extra, F_OK))
        return fail_usage("%s: is one word too many for %s; give one file or, "
                          "of slices, their folder or a pattern in quotes",
                          extra, verb->name);
    if (out->legend.bar && !out->legend.title && access(extra, F_OK) != 0)
        return fail_usage("%s: is one word too many for %s; the title of a "
                          "legend follows a =: --legend=\"%s\"",
                          extra, verb->name, extra);
    return fail_usage("%s: is one word too many for %s; give snowglass %s %s",
                      extra, verb->name, verb->name, verb->usage);
}

/* Checks the number of operands: a file may be missing, or a name with blanks
 * was not quoted. */
int operands_check(const options *out, const verb_row *verb, bool named) {
    if (verb->operands < 0 || out->operand_count == verb->operands)
        return CONTINUE;
    if (out->operand_count > verb->operands)
        return refuse_words(out, verb, named);
    return fail_usage("%s: an operand is missing; give snowglass %s %s",
                      verb->name, verb->name, verb->usage);
}
