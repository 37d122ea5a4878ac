#!/usr/bin/env bash
# tests/cli/data/cli_limits.sh - `script TOOL`: what the tool takes for files of
# the corpora, and for small ones that ask for much.
. "$(dirname "$0")/../../support/shell.sh"
need_python
check "memory and time have limits" \
    python3 "$HERE/cli/data/limits.py" "$TOOL" "$HERE/../fuzz/corpus"
finish
