#!/usr/bin/env bash
# tests/cli/data/cli_report.sh - `script TOOL`: reports have the structure of
# headers, and no name.
. "$(dirname "$0")/../../support/shell.sh"
need_python
PYTHONPATH=$HERE/oracles python3 -B "$HERE/cli/data/report.py" "$TOOL" .
code=$?
[ $code -eq 77 ] && exit 77
check "reports have tags and no names" [ $code -eq 0 ]
finish
