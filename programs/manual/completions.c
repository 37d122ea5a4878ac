/* completions.c - completions for bash, zsh and fish.  Each shell gets the
 * verbs, the options that each verb takes and the words that their arguments
 * can be; other arguments are files or nothing. */
#include "manual/manual.h"

#include <stdio.h>
#include <string.h>

static const char origin[] =
    "# made by snowglass-manual from the table of options\n";

/* --- bash ----------------------------------------------------------------- */

static void print_option_words(const option_row *row, const char *between) {
    char room[WORD_BYTES];
    for (size_t i = 0; option_word(row, i, room); i++)
        printf("%s%s", i ? between : "", option_word(row, i, room));
}

static bool has_words(const option_row *row) {
    char room[WORD_BYTES];
    return option_word(row, 0, room) != NULL;
}

/* "-o | --output", a pattern of case. */
static void print_pattern(const option_row *row) {
    if (row->letter)
        printf("-%c | ", row->letter);
    printf("--%s", row->name);
}

static void print_bash_arguments(void) {
    for (const option_row *row = option_table; row->name; row++) {
        if (!option_takes_word(row))
            continue;
        printf("    ");
        print_pattern(row);
        if (option_takes_file(row)) {
            printf(") return 0 ;;\n");
            continue;
        }
        printf(") words='");
        print_option_words(row, " ");
        printf("' only=yes ;;\n");
    }
}

static void print_bash_verbs(void) {
    char room[WORD_BYTES];
    for (const verb_row *verb = verb_table; verb->name; verb++) {
        printf("        %s)\n            names='", verb->name);
        for (size_t i = 0; verb_word(verb, i, room); i++)
            printf("%s%s", i ? " " : "", verb_word(verb, i, room));
        printf("'\n            options='");
        for (const option_row *row = option_table; row->name; row++)
            if (verb_takes(verb, row) && !option_is_of_ranks(row))
                printf("--%s ", row->name);
        printf("'\n            ranks='");
        for (const option_row *row = option_table; row->name; row++)
            if (verb_takes(verb, row) && option_is_of_ranks(row))
                printf("--%s ", row->name);
        printf("' ;;\n");
    }
}

static void print_verb_names(const char *between) {
    const char *before = "";
    for (const verb_row *verb = verb_table; verb->name; verb++) {
        printf("%s%s", before, verb->name);
        before = between;
    }
}

static void print_phantoms(const char *before) {
    for (size_t i = 0; snow_phantom_name(i); i++)
        printf("%s%s%s", i ? " " : "", before, snow_phantom_name(i));
}

/* Bash splits words at "=" and ":", which are then words themselves. */
void print_bash(void) {
    printf("%s_snowglass() {\n"
           "    local cur=${COMP_WORDS[COMP_CWORD]} at=$((COMP_CWORD - 1))\n"
           "    local verb=render names= options= ranks= words= only=\n"
           "    COMPREPLY=()\n"
           "    [ \"$cur\" != = ] || { cur='' && at=$COMP_CWORD; }\n"
           "    [ \"${COMP_WORDS[at]}\" != = ] || at=$((at - 1))\n"
           "    case ${COMP_WORDS[at]} in\n",
           origin);
    print_bash_arguments();
    printf("    :) [ \"${COMP_WORDS[at - 1]}\" != phantom ] || "
           "{ words='");
    print_phantoms("");
    printf("' && only=yes; } ;;\n    esac\n"
           "    if [ \"$cur\" = : ] && [ \"${COMP_WORDS[at]}\" = phantom ]; "
           "then\n        cur='' words='");
    print_phantoms("");
    printf("' only=yes\n    fi\n"
           "    if [ -n \"$only\" ]; then\n"
           "        compopt +o default 2>/dev/null\n"
           "        mapfile -t COMPREPLY < <(compgen -W \"$words\" -- "
           "\"$cur\")\n"
           "        return 0\n    fi\n"
           "    if [ \"$COMP_CWORD\" -gt 1 ]; then\n"
           "        case ${COMP_WORDS[1]} in\n        ");
    print_verb_names(" | ");
    printf(") verb=${COMP_WORDS[1]} ;;\n        esac\n    fi\n"
           "    case $verb in\n");
    print_bash_verbs();
    printf("    esac\n"
           "    [ \"${COMP_WORDS[0]##*/}\" != snowglass-mpi ] || "
           "options+=$ranks\n"
           "    case $cur in\n"
           "    -*) words=$options ;;\n"
           "    *)\n"
           "        [ \"$COMP_CWORD\" -ne 1 ] || words='");
    print_verb_names(" ");
    printf("'\n        [ \"$COMP_CWORD\" -ne 2 ] || words=$names\n"
           "        mapfile -t COMPREPLY < <(compgen -f -- \"$cur\")\n"
           "        compopt -o filenames 2>/dev/null ;;\n"
           "    esac\n"
           "    while read -r; do COMPREPLY+=(\"$REPLY\"); done < "
           "<(compgen -W \"$words\" -- \"$cur\")\n"
           "}\n"
           "complete -o default -F _snowglass snowglass snowglass-mpi\n");
}

/* --- zsh ------------------------------------------------------------------ */

/* A text inside quotes and brackets, or in a list of NAME:TEXT. */
static void print_zsh_text(const char *text) {
    char room[BRIEF_BYTES];
    for (text = brief(text, room); *text; text++) {
        if (*text == '\'')
            printf("'\\''");
        else
            printf(strchr("[]:\\", *text) ? "\\%c" : "%c", *text);
    }
}

/* `[text]:argument:action`, the end of a specification of _arguments. */
static void print_zsh_argument(const option_row *row) {
    printf("[");
    print_zsh_text(row->text);
    printf("]");
    if (!row->argument)
        return;
    printf("%s:%s:", option_takes_word(row) ? "" : ":",
           has_words(row) ? "word" : "value");
    if (option_takes_file(row)) {
        printf("_files");
    } else if (has_words(row)) {
        printf("(");
        print_option_words(row, " ");
        printf(")");
    } else {
        printf(" ");
    }
}

static void print_zsh_option(const option_row *row) {
    const char *takes = !row->argument           ? ""
                        : option_takes_word(row) ? "="
                                                 : "=-";
    printf("            '");
    if (row->letter)
        printf("(-%c --%s)'{-%c%s,--%s%s}'", row->letter, row->name,
               row->letter, option_takes_word(row) ? "+" : "", row->name,
               takes);
    else
        printf("--%s%s", row->name, takes);
    print_zsh_argument(row);
    printf("' \\\n");
}

static void print_zsh_verb(const verb_row *verb) {
    char room[WORD_BYTES];
    printf("    %s)\n        _arguments -s -S : $ranks \\\n", verb->name);
    for (const option_row *row = option_table; row->name; row++)
        if (verb_takes(verb, row) && !option_is_of_ranks(row))
            print_zsh_option(row);
    if (verb_word(verb, 0, room)) {
        printf("            '1:word:(");
        for (size_t i = 0; verb_word(verb, i, room); i++)
            printf("%s%s", i ? " " : "", verb_word(verb, i, room));
        printf(")' \\\n");
    }
    printf("            '*:input:_snowglass_inputs' ;;\n");
}

void print_zsh(void) {
    printf("#compdef snowglass snowglass-mpi\n%s"
           "_snowglass_inputs() {\n"
           "    compadd -- ",
           origin);
    print_phantoms("phantom:");
    printf("\n    _files\n}\n"
           "_snowglass() {\n"
           "    local verb=render\n"
           "    local -a verbs ranks\n"
           "    verbs=(\n");
    for (const verb_row *verb = verb_table; verb->name; verb++) {
        printf("        '%s:", verb->name);
        print_zsh_text(verb->text);
        printf("'\n");
    }
    printf("    )\n"
           "    if [[ ${words[1]:t} == snowglass-mpi ]]; then\n"
           "        ranks=(\n");
    for (const option_row *row = option_table; row->name; row++) {
        if (option_is_of_ranks(row)) {
            printf("            '--%s=", row->name);
            print_zsh_argument(row);
            printf("'\n");
        }
    }
    printf("        )\n    fi\n"
           "    if (( CURRENT == 2 )) && [[ $words[2] != -* ]]; then\n"
           "        _describe -t verbs verb verbs\n"
           "        _snowglass_inputs\n"
           "        return\n    fi\n"
           "    case $words[2] in\n    ");
    print_verb_names("|");
    printf(")\n        verb=$words[2]\n        shift words\n"
           "        (( CURRENT-- )) ;;\n    esac\n"
           "    case $verb in\n");
    for (const verb_row *verb = verb_table; verb->name; verb++)
        print_zsh_verb(verb);
    printf("    esac\n}\n_snowglass \"$@\"\n");
}

/* --- fish ----------------------------------------------------------------- */

/* Inside single quotes. */
static void put_fish(char letter) {
    printf(strchr("'\\", letter) ? "\\%c" : "%c", letter);
}

static void print_fish_text(const char *text) {
    char room[BRIEF_BYTES];
    printf("-d '");
    for (text = brief(text, room); *text; text++)
        put_fish(*text);
    printf("'\n");
}

/* A word that the option's text describes; fish reads the list once more, hence
 * the inner quotes.  The others are described as the option is. */
static void print_fish_word(const option_row *row, const char *word) {
    char room[BRIEF_BYTES];
    const char *text = word_text(row->text, word);
    printf("%s", word);
    if (!text)
        return;
    printf("\\t\"");
    for (text = brief(text, room); *text; text++) {
        if (strchr("\"$\\", *text))
            put_fish('\\');
        put_fish(*text);
    }
    printf("\"");
}

static void print_fish_words(const option_row *row) {
    char room[WORD_BYTES];
    const char *word;
    printf("-a '");
    for (size_t i = 0; (word = option_word(row, i, room)); i++) {
        printf(i ? " " : "");
        print_fish_word(row, word);
    }
    printf("' ");
}

static void print_fish_option(const option_row *row, const char *command) {
    printf("complete -c %s -n '__snowglass_takes", command);
    for (const verb_row *verb = verb_table; verb->name; verb++)
        if (verb_takes(verb, row))
            printf(" %s", verb->name);
    printf("' -l %s ", row->name);
    if (row->letter)
        printf("-s %c ", row->letter);
    if (option_takes_file(row)) {
        printf("-r -F ");
    } else if (option_takes_word(row)) {
        printf("-x ");
        if (has_words(row))
            print_fish_words(row);
    }
    print_fish_text(row->text);
}

static void print_fish_verb(const verb_row *verb) {
    char room[WORD_BYTES];
    printf("complete -c snowglass -n __snowglass_first -a %s ", verb->name);
    print_fish_text(verb->text);
    if (!verb_word(verb, 0, room))
        return;
    printf("complete -c snowglass -n '__snowglass_second %s' -a '", verb->name);
    for (size_t i = 0; verb_word(verb, i, room); i++)
        printf("%s%s", i ? " " : "", verb_word(verb, i, room));
    printf("'\n");
}

/* The command under MPI takes all that the other does. */
void print_fish(bool mpi) {
    printf("%s", origin);
    if (mpi)
        printf("complete -c snowglass-mpi -w snowglass\n");
    for (const option_row *row = option_table; row->name && mpi; row++)
        if (option_is_of_ranks(row))
            print_fish_option(row, "snowglass-mpi");
    if (mpi)
        return;
    printf("function __snowglass_verb\n"
           "    set -l typed (commandline -opc)\n"
           "    if set -q typed[2]; and contains -- $typed[2] ");
    print_verb_names(" ");
    printf("\n        echo $typed[2]\n    else\n        echo render\n    end\n"
           "end\n"
           "function __snowglass_takes\n"
           "    contains -- (__snowglass_verb) $argv\nend\n"
           "function __snowglass_first\n"
           "    test (count (commandline -opc)) -eq 1\nend\n"
           "function __snowglass_second\n"
           "    test (count (commandline -opc)) -eq 2\n"
           "    and test (__snowglass_verb) = $argv[1]\nend\n"
           "complete -c snowglass -a '");
    print_phantoms("phantom:");
    printf("'\n");
    for (const verb_row *verb = verb_table; verb->name; verb++)
        print_fish_verb(verb);
    for (const option_row *row = option_table; row->name; row++)
        if (!option_is_of_ranks(row))
            print_fish_option(row, "snowglass");
}
