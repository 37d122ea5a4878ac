"""Completions for bash, zsh and fish.  Each shell gets the verbs, the options
that each verb takes and the words that their arguments can be; other arguments
are files or nothing."""
import re

from table import (brief, names, of_ranks, option_words, taken, takes_file,
                   takes_word, verb_words, word_text)

ORIGIN = "# made by scripts/manual from the table of options"


def filled(template, **texts):
    """The template with texts for @names@."""
    return re.sub("@([a-z]+)@", lambda found: texts[found[1]], template)


def phantoms(table, before=""):
    return " ".join(before + name for name in names(table["phantoms"]))


# --- bash ---------------------------------------------------------------------

# Bash splits words at "=" and ":", which are then words themselves.
BASH = """\
@origin@
_snowglass() {
    local cur=${COMP_WORDS[COMP_CWORD]} at=$((COMP_CWORD - 1))
    local verb=render names= options= ranks= words= only=
    COMPREPLY=()
    [ "$cur" != = ] || { cur='' && at=$COMP_CWORD; }
    [ "${COMP_WORDS[at]}" != = ] || at=$((at - 1))
    case ${COMP_WORDS[at]} in
@arguments@
    :) [ "${COMP_WORDS[at - 1]}" != phantom ] || { words='@phantoms@' && only=yes; } ;;
    esac
    if [ "$cur" = : ] && [ "${COMP_WORDS[at]}" = phantom ]; then
        cur='' words='@phantoms@' only=yes
    fi
    if [ -n "$only" ]; then
        compopt +o default 2>/dev/null
        mapfile -t COMPREPLY < <(compgen -W "$words" -- "$cur")
        return 0
    fi
    if [ "$COMP_CWORD" -gt 1 ]; then
        case ${COMP_WORDS[1]} in
        @pattern@) verb=${COMP_WORDS[1]} ;;
        esac
    fi
    case $verb in
@verbs@
    esac
    [ "${COMP_WORDS[0]##*/}" != snowglass-mpi ] || options+=$ranks
    case $cur in
    -*) words=$options ;;
    *)
        [ "$COMP_CWORD" -ne 1 ] || words='@names@'
        [ "$COMP_CWORD" -ne 2 ] || words=$names
        [ "$verb ${COMP_WORDS[2]} $COMP_CWORD" != 'tf show 3' ] || words='@presets@'
        mapfile -t COMPREPLY < <(compgen -f -- "$cur")
        compopt -o filenames 2>/dev/null ;;
    esac
    while read -r; do COMPREPLY+=("$REPLY"); done < <(compgen -W "$words" -- "$cur")
}
complete -o default -F _snowglass snowglass snowglass-mpi"""


def bash_argument(table, option):
    """The case of an option whose next word is its argument."""
    letter = f"-{option['letter']} | " if option["letter"] else ""
    words = " ".join(option_words(table, option))
    does = "return 0" if takes_file(option) else f"words='{words}' only=yes"
    return f"    {letter}--{option['name']}) {does} ;;"


def bash_verb(table, verb):
    def listed(options):
        return "".join(f"--{option['name']} " for option in options)

    ranks = [option for option in table["options"]
             if of_ranks(option) and verb["name"] in option["verbs"]]
    return (f"        {verb['name']})\n"
            f"            names='{' '.join(verb_words(table, verb))}'\n"
            f"            options='{listed(taken(table, verb))}'\n"
            f"            ranks='{listed(ranks)}' ;;")


def bash(table):
    verbs = names(table["verbs"])
    return [filled(
        BASH, origin=ORIGIN, phantoms=phantoms(table),
        presets=" ".join(names(table["presets"])), names=" ".join(verbs),
        pattern=" | ".join(verbs),
        arguments="\n".join(bash_argument(table, option)
                            for option in table["options"] if takes_word(option)),
        verbs="\n".join(bash_verb(table, verb) for verb in table["verbs"]))]


# --- zsh ----------------------------------------------------------------------

ZSH = """\
#compdef snowglass snowglass-mpi
@origin@
_snowglass_inputs() {
    compadd -- @phantoms@
    _files
}
_snowglass() {
    local verb=render
    local -a verbs ranks
    verbs=(
@described@
    )
    if [[ ${words[1]:t} == snowglass-mpi ]]; then
        ranks=(
@ranks@
        )
    fi
    if (( CURRENT == 2 )) && [[ $words[2] != -* ]]; then
        _describe -t verbs verb verbs
        _snowglass_inputs
        return
    fi
    case $words[2] in
    @pattern@)
        verb=$words[2]
        shift words
        (( CURRENT-- )) ;;
    esac
    case $verb in
@verbs@
    esac
}
_snowglass "$@\""""


def zsh_text(text):
    """A text inside quotes and brackets, or in a list of NAME:TEXT."""
    return re.sub(r"([\[\]:\\])", r"\\\1", brief(text)).replace("'", "'\\''")


def zsh_argument(table, option):
    """`[text]:argument:action`, the end of a specification of _arguments."""
    text = f"[{zsh_text(option['text'])}]"
    if not option["argument"]:
        return text
    words = option_words(table, option)
    action = "_files" if takes_file(option) else \
        f"({' '.join(words)})" if words else " "
    return f"{text}{'' if takes_word(option) else ':'}:" \
        f"{'word' if words else 'value'}:{action}"


def zsh_option(table, option):
    name, letter = option["name"], option["letter"]
    takes = "" if not option["argument"] else "=" if takes_word(option) else "=-"
    flags = f"--{name}{takes}"
    if letter:
        plus = "+" if takes_word(option) else ""
        flags = f"(-{letter} --{name})'{{-{letter}{plus},--{name}{takes}}}'"
    return f"            '{flags}{zsh_argument(table, option)}' \\\n"


def zsh_verb(table, verb):
    words = verb_words(table, verb)
    return (f"    {verb['name']})\n        _arguments -s -S : $ranks \\\n" +
            "".join(zsh_option(table, option) for option in taken(table, verb)) +
            (f"            '1:word:({' '.join(words)})' \\\n" if words else "") +
            ("            '2:preset or file:{ compadd -- "
             f"{' '.join(names(table['presets']))}; _files }}' \\\n"
             if verb["name"] == "tf" else "") +
            "            '*:input:_snowglass_inputs' ;;")


def zsh(table):
    return [filled(
        ZSH, origin=ORIGIN, phantoms=phantoms(table, "phantom:"),
        pattern="|".join(names(table["verbs"])),
        described="\n".join(f"        '{verb['name']}:{zsh_text(verb['text'])}'"
                            for verb in table["verbs"]),
        ranks="\n".join(
            f"            '--{option['name']}={zsh_argument(table, option)}'"
            for option in table["options"] if of_ranks(option)),
        verbs="\n".join(zsh_verb(table, verb) for verb in table["verbs"]))]


# --- fish ---------------------------------------------------------------------

FISH = """\
@origin@
function __snowglass_verb
    set -l typed (commandline -opc)
    if set -q typed[2]; and contains -- $typed[2] @names@
        echo $typed[2]
    else
        echo render
    end
end
function __snowglass_takes
    contains -- (__snowglass_verb) $argv
end
function __snowglass_first
    test (count (commandline -opc)) -eq 1
end
function __snowglass_second
    test (count (commandline -opc)) -eq 2
    and test (__snowglass_verb) = $argv[1]
end
function __snowglass_shows
    set -l typed (commandline -opc)
    test (count $typed) -eq 3; and test "$typed[2..3]" = 'tf show'
end
complete -c snowglass -n __snowglass_shows -a '@presets@'
complete -c snowglass -a '@phantoms@'"""


def fish_quoted(text):
    """Inside single quotes."""
    return re.sub(r"(['\\])", r"\\\1", text)


def fish_word(option, word):
    """A word that the option's text describes; fish reads the list once more,
    hence the inner quotes.  The others are described as the option is."""
    text = word_text(option["text"], word)
    if not text:
        return word
    inner = re.sub(r'(["$\\])', r"\\\1", brief(text))
    return f'{word}\\t"{fish_quoted(inner)}"'


def fish_option(table, option, command="snowglass"):
    verbs = [name for name in names(table["verbs"]) if name in option["verbs"]]
    out = f"complete -c {command} -n '__snowglass_takes {' '.join(verbs)}' " \
        f"-l {option['name']} "
    if option["letter"]:
        out += f"-s {option['letter']} "
    if takes_file(option):
        out += "-r -F "
    elif takes_word(option):
        words = [fish_word(option, word) for word in option_words(table, option)]
        out += "-x " + (f"-a '{' '.join(words)}' " if words else "")
    return f"{out}-d '{fish_quoted(brief(option['text']))}'"


def fish_verb(table, verb):
    name, words = verb["name"], verb_words(table, verb)
    yield f"complete -c snowglass -n __snowglass_first -a {name} " \
        f"-d '{fish_quoted(brief(verb['text']))}'"
    if words:
        yield f"complete -c snowglass -n '__snowglass_second {name}' " \
            f"-a '{' '.join(words)}'"


def fish(table):
    out = [filled(FISH, origin=ORIGIN, names=" ".join(names(table["verbs"])),
                  presets=" ".join(names(table["presets"])),
                  phantoms=phantoms(table, "phantom:"))]
    for verb in table["verbs"]:
        out += fish_verb(table, verb)
    return out + [fish_option(table, option) for option in table["options"]
                  if not of_ranks(option)]


def fish_mpi(table):
    """The command under MPI takes all that the other does."""
    return [ORIGIN, "complete -c snowglass-mpi -w snowglass"] + \
        [fish_option(table, option, "snowglass-mpi")
         for option in table["options"] if of_ranks(option)]
