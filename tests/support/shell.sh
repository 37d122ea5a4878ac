# tests/support/shell.sh - what every script over the tool starts with.
#
#   . "$(dirname "$0")/../../support/shell.sh"
#   run 0 "a name that says what must hold" "$TOOL" info ...
#   says "a pattern that standard error must match"
#   finish
#
# `run` keeps standard output in $OUT and standard error in $ERR and checks the
# exit code; each further check speaks of that run.  One line per check; the
# script fails when any check did.
set -u
# In the background of a shell, or under nohup, some signals are ignored, which
# no shell can undo for the commands that it starts.
if [ -z "${SNOW_SIGNALS-}" ] && env --default-signal=INT true 2>/dev/null; then
    SNOW_SIGNALS=default exec env --default-signal=INT,HUP,TERM bash "$0" "$@"
fi
TOOL=$(realpath "$1")
DATA=${2:-}
HERE=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd) # tests/
WORK=$(mktemp -d)
trap 'rm -rf "$WORK"' EXIT
OUT=$WORK/.stdout
ERR=$WORK/.stderr
cd "$WORK" || exit 1
FAILED=0

pass() { echo "ok     $1"; }
fail() {
    echo "FAILED $1${2:+: $2}"
    FAILED=$((FAILED + 1))
}

# run CODE NAME COMMAND...
run() {
    local want=$1 code
    NAME=$2
    shift 2
    "$@" >"$OUT" 2>"$ERR" </dev/null
    code=$?
    if [ "$code" -eq "$want" ]; then
        pass "$NAME"
    else
        fail "$NAME" "exit code $code, not $want: $(head -c 300 "$ERR")"
    fi
}

# check NAME COMMAND...: any command that must succeed.
check() {
    local name=$1
    shift
    if "$@"; then pass "$name"; else fail "$name"; fi
}

# matches PATTERN FILE: whether a line matches, as of grep -Eq, but without a
# process, of which the scripts would start thousands; long texts are grep's.
matches() {
    local line
    local -a lines
    mapfile -t -n 200 lines <"$2"
    if [ ${#lines[@]} -eq 200 ]; then
        grep -Eq -- "$1" "$2"
        return
    fi
    for line in "${lines[@]}"; do
        [[ $line =~ $1 ]] && return
    done
    return 1
}

says() {
    if matches "$1" "$ERR"; then
        pass "$NAME: says '$1'"
    else
        fail "$NAME: says '$1'" "$(head -c 300 "$ERR")"
    fi
}

prints() {
    if matches "$1" "$OUT"; then
        pass "$NAME: prints '$1'"
    else
        fail "$NAME: prints '$1'" "$(head -c 600 "$OUT")"
    fi
}

# An error is one to five lines on standard error and no data.
plain_error() {
    local -a lines
    mapfile lines <"$ERR"
    if [ ${#lines[@]} -ge 1 ] && [ ${#lines[@]} -le 5 ] && [ ! -s "$OUT" ] &&
        [[ ${lines[-1]} == *$'\n' ]] &&
        matches '^snowglass: ' "$ERR"; then
        pass "$NAME: one clear line"
    else
        fail "$NAME: one clear line" \
            "${#lines[@]} lines, $(wc -c <"$OUT") bytes out"
    fi
}

# refused CODE NAME PATTERN COMMAND...
refused() {
    local code=$1 name=$2 pattern=$3
    shift 3
    run "$code" "$name" "$@"
    plain_error
    says "$pattern"
}

# refusals CODE COMMAND...: with the arguments of each line "ARGUMENTS|PATTERN" the
# command is refused with that code and message.
refusals() {
    local code=$1 arguments pattern
    shift
    while IFS='|' read -r arguments pattern; do
        eval "refused $code \"\$arguments\" \"\$pattern\" \"\$@\" $arguments"
    done
}

# told NAME PATTERN COMMAND..., printed NAME PATTERN COMMAND...: it succeeds, and
# says, or prints, that.
told() {
    run 0 "$1" "${@:3}"
    says "$2"
}

printed() {
    run 0 "$1" "${@:3}"
    prints "$2"
}

# Of the last run: nothing was said, no line matches.
silent() { check "$NAME: nothing is said" [ ! -s "$ERR" ]; }
not_said() { check "$NAME: does not say '$1'" unmatched "$1" "$ERR"; }
unmatched() { ! matches "$@"; }

# same_file NAME FILE FILE, other_file NAME FILE FILE
same_file() { check "$1" cmp -s "$2" "$3"; }
other_file() { check "$1" differ "$2" "$3"; }
differ() { [ -e "$1" ] && [ -e "$2" ] && ! cmp -s "$1" "$2"; }

# pairs SUFFIX WORDS...: of each line "NAME | MORE | RELATION | MORE" the tool makes two
# files, by the words and those of the line.  They are the same (=), or not (!=), or
# `compare` finds them apart by at most a number, or by more (>0.1).  A " is the first
# file of the line before.
pairs() {
    local suffix=$1 name one relation two
    shift
    while IFS='|' read -r name one relation two; do
        name=${name%"${name##*[! ]}"} relation=${relation// /}
        [ "${one// /}" = '"' ] || draw_pair ".one.$suffix" "$name" "$one" "$@"
        draw_pair ".two.$suffix" "$name, and" "$two" "$@"
        case $relation in
        =) same_file "$name: the same" ".one.$suffix" ".two.$suffix" ;;
        !=) other_file "$name: others" ".one.$suffix" ".two.$suffix" ;;
        *)
            run $([ "$relation" = "${relation#>}" ] && echo 0 || echo 6) \
                "$name: $relation" "$TOOL" compare ".one.$suffix" ".two.$suffix" \
                --tolerance "${relation#>}"
            ;;
        esac
    done
}

draw_pair() {
    local file=$1 name=$2 more=$3
    shift 3
    rm -f "$file"
    eval "run 0 \"\$name\$more\" \"\$TOOL\" \"\$@\" $more -q -o \"\$file\""
}

# again NAME VERB OUT WORDS...: the command that -v prints and the configuration that is
# saved (first.json) make the files of OUT, which may be a pattern of frames, once more.
again() {
    local name=$1 verb=$2 out=$3 command
    shift 3
    rm -rf first && mkdir first
    run 0 "$name" "$TOOL" "$verb" -v "$@" -o "$out" --save-config first.json -y
    command=$(sed -n 's/^snowglass: again: //p' "$ERR")
    check "$name: a command is printed" [ -n "$command" ]
    outputs "$out" | xargs -d '\n' mv -t first
    eval "\"\$TOOL\" ${command#snowglass } -q"
    as_first "$name: the command" "$out"
    run 0 "$name: the configuration" "$TOOL" --config first.json -q
    as_first "$name: it" "$out"
}

outputs() { compgen -G "${1/\%d/?}"; }

as_first() {
    local file
    for file in first/*; do
        same_file "$1 gives ${file##*/} again" "$file" "${file##*/}"
    done
    outputs "$2" | xargs -d '\n' rm -f .*.frames
}

# Scripts in Python find tests/support; where there is no Python all is skipped.
need_python() {
    command -v python3 >/dev/null || {
        skipped all "there is no python3"
        exit 77
    }
    export PYTHONPATH=$HERE/support PYTHONDONTWRITEBYTECODE=1
}

# Whether what takes long is done too: not in the short tier (docs/testing.md).
long_tier() { [ "${SNOW_TIER:-short}" != short ]; }
release_tier() { [ "${SNOW_TIER:-short}" = release ]; }

# skipped WHAT WHY: a part of a script that is left out, with the reason.
skipped() { echo "skip   $1: $2"; }

is_png() {
    [ "$(head -c 8 "$1" | od -An -tx1 | tr -d ' \n')" = 89504e470d0a1a0a ]
}

# same_bytes FILES FILES: whether two lists of files, each end to end, are equal.
# (Process substitution would need /dev/fd, which a plain chroot lacks.)
same_bytes() {
    cat $1 >.first && cat $2 >.second && cmp .first .second
}

# What the system has free of memory, in whole gigabytes; 0 where it says nothing.
free_gigabytes() {
    [ -r /proc/meminfo ] || { echo 0 && return; }
    awk '/MemAvailable/ { print int($2 / 1048576) }' /proc/meminfo
}

# The readers of modules are found by /proc/self/maps (src/base/module.c).
need_modules() {
    [ -r /proc/self/maps ] && return
    skipped all "there is no /proc, and modules are not loaded without"
    exit 77
}

# await PATTERN FILE: until a line of the file matches; fails after minutes.
await() {
    local i
    for ((i = 0; i < 6000; i++)); do
        [ -e "$2" ] && matches "$1" "$2" && return 0
        sleep 0.02
    done
    return 1
}

absent() { [ ! -e "$1" ]; }

# number KEY: the number that follows "KEY": in the JSON of $OUT.
number() {
    sed -n 's/.*"'"$1"'": \(-\{0,1\}[0-9.e+-]*\).*/\1/p' "$OUT"
}

# raw_cube FILE SIDE: a uint8 cube of that side, of the bytes 0, 1, 2, ...
raw_cube() {
    local count=$(($2 * $2 * $2)) i byte bytes=
    for ((i = 0; i < count; i++)); do
        printf -v byte '\\%03o' $((i % 251))
        bytes+=$byte
    done
    printf "$bytes" >"$1"
}

finish() {
    [ "$FAILED" -eq 0 ] && exit 0
    echo "$FAILED checks failed"
    exit 1
}
