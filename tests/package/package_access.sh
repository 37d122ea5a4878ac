#!/usr/bin/env bash
# tests/package/package_access.sh - `script TOOL BUILD SOURCE`: the pages of the site
# in a browser: axe-core, their width, and the search (site.mjs).
. "$(dirname "$0")/../support/shell.sh"
BUILD=$(realpath "$2") SOURCE=$(realpath "$3")
browser=$(command -v chromium || command -v chromium-browser)
[ -e "$BUILD/web/node_modules/axe-core" ] && [ -n "$browser" ] && command -v node >/dev/null ||
    { echo "skip   node, chromium, playwright-core or axe-core is missing" && exit 77; }
/usr/bin/python3 -c 'import markdown' 2>/dev/null && [ -f "$BUILD/table.json" ] ||
    { echo "skip   the site cannot be made" && exit 77; }
run 0 "the site is made" /usr/bin/python3 -B "$SOURCE/scripts/site" "$BUILD/table.json" "$WORK/site"
pattern=
long_tier || pattern='index[.]html|usage|options|-api|search'
run 0 "its pages are for everybody, and can be searched" node "$SOURCE/tests/package/site.mjs" \
    "$BUILD/web/node_modules" "$browser" "$WORK/site" $pattern
cat "$OUT"
finish
