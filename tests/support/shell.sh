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
    # shellcheck disable=SC2086
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
    # shellcheck disable=SC2059
    printf "$bytes" >"$1"
}

finish() {
    [ "$FAILED" -eq 0 ] && exit 0
    echo "$FAILED checks failed"
    exit 1
}
