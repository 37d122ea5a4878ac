#!/usr/bin/env bash
# tests/cli/data/cli_tutorials.sh - `script TOOL`: every command, program and
# picture of docs/tutorials (scripts/tutorials).
. "$(dirname "$0")/../../support/shell.sh"
command -v ffmpeg >/dev/null || { echo "skip   there is no ffmpeg" && exit 77; }
/usr/bin/python3 -B -W ignore "$HERE/../scripts/tutorials" "$TOOL" "$(dirname "$TOOL")"
code=$?
[ $code -eq 77 ] && exit 77
check "the tutorials do what they say" [ $code -eq 0 ]
finish
