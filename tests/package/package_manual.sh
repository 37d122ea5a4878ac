#!/usr/bin/env bash
# tests/package/package_manual.sh - `script TOOL BUILD SOURCE`: manual pages,
# completions and the schema of recipes say what the tool does.
. "$(dirname "$0")/../support/shell.sh"
MADE=$2/manual
[ -d "$MADE" ] || { echo "built without manual pages" && exit 77; }
place() { find "$MADE" -path "*/$1"; }
page() { place "man1/snowglass$1.1"; }
bash_file=$(place completions/snowglass)
zsh_file=$(place site-functions/_snowglass)
fish_file=$(place vendor_completions.d/snowglass.fish)
fish_mpi=$(place vendor_completions.d/snowglass-mpi.fish)
have() { command -v "$1" >/dev/null; }

# --- each verb and option of the help is everywhere ---------------------------

# The options of a topic's help, and those that a verb's page has.
options_of() { "$TOOL" help "$1" | sed -nE 's/^  (-., |    )--([a-z-]+).*/\2/p'; }
paged() { sed -nE 's/^\\fB.*\\-\\-([a-z\\-]+)\\fR.*/\1/p' "$1" | tr -d '\\'; }
words_of() { "$TOOL" help | sed -n "/^$1/,/^\$/s/^  \([a-z]*\) .*/\1/p"; }
verbs=$(words_of verbs)
check "the help has verbs" [ "$(wc -w <<<"$verbs")" -gt 9 ]
lacking=
for verb in $verbs; do
    file=$(page "-$verb")
    [ -n "$file" ] || { lacking+=" $verb.1" && continue; }
    paged "$file" >>pages
    said=$(sed -n "/^        $verb)/,/;;/p" "$bash_file")
    zshed=$(sed -n "/^    $verb)/,/;;/p" "$zsh_file")
    for option in $(paged "$file"); do
        [[ $option != @(cut|combine|timeout) ]] || continue # of MPI
        grep -q -- "--$option " <<<"$said" || lacking+=" bash:$verb:$option"
        grep -qE -- "--${option}[=[}]" <<<"$zshed" || lacking+=" zsh:$verb:$option"
        grep -E -- "-n '__snowglass_takes [a-z ]*\\b$verb\\b.* -l $option " \
            "$fish_file" >/dev/null || lacking+=" fish:$verb:$option"
    done
done
for topic in $(words_of topics); do
    for option in $(options_of "$topic"); do
        grep -qx -- "$option" pages || lacking+=" page:$option"
    done
done
check "all is in pages and completions${lacking:+, not$lacking}" [ -z "$lacking" ]
check "the page of report has its own output" grep -q "text file that the report" \
    "$(page -report)"
check "pages have options" [ "$(paged "$(page -render)" | wc -l)" -gt 60 ]

# --- manual pages -------------------------------------------------------------

also() { sed -n '/^.SH SEE ALSO/,$p' "$1"; }
check "the tool's page does not name itself" \
    [ -z "$(also "$(page "")" | grep -x '.BR snowglass (1).*')" ]
unnamed=
for verb in $verbs; do
    also "$(page "")" | grep -qF ".BR snowglass\\-$verb (1)," || unnamed+=" $verb"
    also "$(page "-$verb")" | grep -qx '.BR snowglass (1),' || unnamed+=" of:$verb"
done
check "pages name one another${unnamed:+, not$unnamed}" [ -z "$unnamed" ]
status() { sed -n "/^.SH EXIT STATUS/,/^.SH ENV/{/^.B $1\$/,/^.TP/p}" "$(page "")"; }
check "status 2 is of the command line" grep -q 'command line' <(status 2)
check "status 130 is of signals" grep -q 'SIGTERM' <(status 130)

# Each function of the headers is named and declared, each key of a recipe is
# there, and the model has its sections.
declared() { sed -nE 's/^SNOW_API [^(]*\b(snow_[a-z0-9_]+)\(.*/\1/p' "$1"; }
lacking='' functions=0
for header in "$3"/include/snowglass/*.h; do
    name=$(basename "$header" .h)
    [ "$name" != snowglass ] && name=-${name//_/-} || name=
    file=$(place "man3/snowglass$name.3")
    [ -n "$file" ] || { lacking+=" snowglass$name.3" && continue; }
    for function in $(declared "$header"); do
        functions=$((functions + 1))
        [ "$(grep -cE "(^|[ *])$function([(,]|$)" "$file")" -ge 2 ] ||
            lacking+=" $function"
    done
done
[ -n "$(place man1/snowglass-mpi.1)" ] || lacking=${lacking/ snowglass-mpi.3/}
check "all functions have pages${lacking:+, not$lacking}" [ -z "$lacking" ]
check "there are many" [ "$functions" -gt 150 ]
formats=$(place man5/snowglass.5)
lacking=
for key in $("$TOOL" phantom:shells --dims 8x8x8 -s 8x8 -q -o t.png \
    --save-config t.json && grep -o '^ *"[a-z-]*"' t.json | tr -d ' "'); do
    grep -qE "\\fB([^\\]|\\\\-)*${key//-/\\\\-}\\\\fR" "$formats" || lacking+=" $key"
done
check "a saved recipe has known keys${lacking:+, not$lacking}" [ -z "$lacking" ]
for section in Grid Camera Classification Shading Output GEOMETRY; do
    check "the model: $section" grep -qE "^[.]S[HS] .*$section" \
        "$(place man7/snowglass.7)"
done

pages=("$MADE"/*/man/man[1357]/*)
check "there are pages of four kinds" [ "${#pages[@]}" -gt 25 ]
if have mandoc; then
    mandoc -Tlint "${pages[@]}" >lint 2>&1
    cat lint
    check "mandoc finds nothing" [ ! -s lint ]
else
    skipped "pages" "there is no mandoc"
fi
if have man && have groff; then
    for file in "${pages[@]}"; do
        man --warnings -E UTF-8 -l "$file" 2>>warned >/dev/null
    done
    check "groff finds nothing" [ ! -s warned ]
fi

# --- bash ---------------------------------------------------------------------

# completes WORDS... gives the words offered for the last one, as bash splits them.
completes() {
    bash -c '. "$0"; COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1))
        _snowglass; printf "%s " "${COMPREPLY[@]}"' "$bash_file" "$@" 2>said
    cat said >&2
}
offers() { # WHAT WORDS...
    local what=$1 got
    shift
    got=$(completes "$@" 2>&1)
    [ "${got% }" = "$what" ] || { echo "$*: '$got', not '$what'" && return 1; }
}
: >some.nrrd
check "bash: a verb" offers turntable snowglass turn
check "bash: an option" offers --encoding snowglass render --enc
check "bash: an option of the first verb" offers --encoding snowglass a.nrrd --enc
check "bash: not of another verb" offers "" snowglass info a.nrrd --enc
check "bash: choices" offers "auto crs bitmap rle" snowglass render --encoding ''
check "bash: choices behind =" offers "bitmap" snowglass render --encoding = b
check "bash: all of them" offers "auto crs bitmap rle" snowglass --encoding =
check "bash: a preset" offers ct-bones snowglass a.nrrd --preset ct-bones
check "bash: a type" offers "uint8 uint16 uint32 uint64" snowglass a.raw --type ui
check "bash: a topic" offers camera snowglass help cam
check "bash: a phantom" offers engine snowglass phantom : en
check "bash: a preset to show" offers ct-muscle snowglass tf show ct-mu
check "bash: a file" offers some.nrrd snowglass render so
check "bash: an option without value is none's" offers some.nrrd \
    snowglass render --legend so
check "bash: nothing for a number" offers "" snowglass a.nrrd --zoom ''
check "bash: of MPI alone" offers "" snowglass a.nrrd --radi
check "bash: for MPI" offers --combine snowglass-mpi a.nrrd --combin

# --- zsh and fish -------------------------------------------------------------

# In a terminal of its own, as zsh completes nowhere else.
zsh_types() { # TEXT: what stands on the line after a tab
    zsh -f <<END
zmodload zsh/zpty
zpty shell zsh -f -i
zpty -w shell "PROMPT= ; fpath=('$(dirname "$zsh_file")' \\\$fpath); \\
autoload -U compinit; compinit -u -d '$WORK/dump'; \\
show() { print -r -- \"<\\\$BUFFER>\"; BUFFER= ; zle accept-line }; zle -N show; \\
bindkey '^X' show; print REA\\DY"
zpty -r -m shell line '*READY*'
zpty -w -n shell "$1"\$'\t\x18'
zpty -r -m shell line '*<*>*'
print -r -- "\${line##*<}"
zpty -d shell
END
}
zsh_gives() { # WANT TEXT
    local got
    got=$(timeout 300 bash -c "$(declare -f zsh_types); zsh_types '$2'")
    [[ $got == "$1"* ]] || { echo "'$2': '$got', not '$1'" && return 1; }
}
export zsh_file WORK
if have zsh; then
    check "zsh: a verb" zsh_gives 'snowglass turntable ' 'snowglass turn'
    check "zsh: an option" zsh_gives 'snowglass render a --encoding' \
        'snowglass render a --enc'
    check "zsh: a choice" zsh_gives 'snowglass a --encoding bitmap ' \
        'snowglass a --encoding bi'
    check "zsh: a preset to show" zsh_gives 'snowglass tf show ct-muscle ' \
        'snowglass tf show ct-mu'
    check "zsh: an option of its verb alone" zsh_gives 'snowglass info a --enc>' \
        'snowglass info a --enc'
else
    skipped "zsh" "it is not there"
fi

fish_offers() { # WHAT TEXT
    local got
    got=$(HOME=$WORK fish --no-config -c "source $fish_file; source $fish_mpi
        complete -C '$2'" | cut "-f${3:-1}" | tr '\n' ' ')
    [ "${got% }" = "$1" ] || { echo "'$2': '$got', not '$1'" && return 1; }
}
fish_describes() { fish_offers "$@" 2; }
if have fish; then
    check "fish: a verb" fish_offers turntable 'snowglass turn'
    check "fish: an option" fish_offers --encoding 'snowglass render a --enc'
    check "fish: choices" fish_offers 'auto bitmap crs rle' \
        'snowglass a --encoding '
    check "fish: a preset to show" fish_offers ct-muscle 'snowglass tf show ct-mu'
    check "fish: an option of its verb alone" fish_offers "" \
        'snowglass info a --enc'
    check "fish: an option is described" fish_describes "speed or quality" \
        'snowglass a --qualit'
    check "fish: so is each choice" fish_describes \
        'one intermediate pixel per voxel and linear filters' \
        'snowglass a --quality d'
    check "fish: the last too" fish_describes \
        'also interpolates between slices' 'snowglass a --quality h'
    check "fish: others as their option" fish_describes \
        'reconstruction kernel' 'snowglass a --kernel bs'
    [ -z "$fish_mpi" ] ||
        check "fish: for MPI" fish_offers --combine 'snowglass-mpi a --combin'
else
    skipped "fish" "it is not there"
fi

# --- the schema of recipes ----------------------------------------------------

python=$(command -v /usr/bin/python3 || command -v python3)
schema=$(place recipe.schema.json)
if [ -n "$python" ] && "$python" -c 'import jsonschema' 2>/dev/null; then
    run 0 "the schema takes and refuses what the tool does" "$python" -B \
        "$HERE/package/schema.py" "$TOOL" "$schema"
    cat "$OUT"
else
    skipped "the schema" "there is no jsonschema for Python"
fi
finish
