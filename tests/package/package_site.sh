#!/usr/bin/env bash
# tests/package/package_site.sh - `script TOOL BUILD SOURCE`: the site of the
# documents is made, its links lead somewhere, and its references are whole.
. "$(dirname "$0")/../support/shell.sh"
TABLE=$2/table.json SOURCE=$3
[ -f "$TABLE" ] || { echo "skip   built without manual pages" && exit 77; }
PYTHON=/usr/bin/python3
"$PYTHON" -c 'import markdown' 2>/dev/null ||
    { echo "skip   there is no python3-markdown" && exit 77; }

# A copy, since documents are spoilt below.
(cd "$SOURCE" && cp -r --parents ./*.md LICENSE docs include examples/minimal.c \
    python/snowglass src/README.md bench/peers/README.md scripts/site scripts/manual \
    "$WORK")
make_site() { "$PYTHON" -B scripts/site "$TABLE" "$WORK/site" "$@"; }
run 0 "the site is made" make_site
prints '^site: [0-9]{2} pages, [0-9]{4} links, 0 faults$'
page() { cat "site/$1"; }
check "it begins with the README" grep -q '<h1 id="snowglass">' site/index.html
check "pictures are copied" cmp docs/gallery/engine.png site/docs/gallery/engine.png
check "each picture of the gallery has the source of its data" [ \
    "$(grep -c '^Data: .' docs/gallery/README.md)" = "$(grep -c '^## ' docs/gallery/README.md)" ]
check "the search alone has scripts" [ \
    "$(grep -rliE --include='*.html' '<script|javascript:' site)" = site/search.html ]
check "it knows each page" [ -z "$(cd site && find . -name '*.html' ! -name search.html |
    sed 's|^[.]/||' | while read -r page; do
        grep -qF "\"address\":\"$page#" search-index.js || echo "$page"; done)" ]
check "it has a dark form" grep -q 'prefers-color-scheme: dark' site/site.css
check "the chart is of the table" grep -qE \
    'Engine, shaded</text><text[^>]*>Snowglass, draft</text><rect[^>]*><text[^>]*>[0-9.]+<' \
    site/docs/measurements/peers.html

lacking=
for option in $("$PYTHON" -B scripts/manual "$TABLE" man render | sed -nE 's/^\\fB.*\\-\\-([a-z\\-]+)\\fR.*/\1/p' |
    tr -d '\\'); do
    grep -q -- "--$option" site/docs/options.html || lacking+=" --$option"
done
for function in $(sed -nE 's/^SNOW_API [^(]*\b(snow_[a-z0-9_]+)\(.*/\1/p' include/snowglass/*.h); do
    grep -q "id=\"$function\"" site/docs/c-api.html &&
        grep -q "href=\"#$function\"" site/docs/c-api.html || lacking+=" $function"
done
# Records and functions that callers give, as Universal Ctags finds them.
if ctags --version 2>/dev/null | grep -q Universal; then
    for type in $(ctags -x --c-kinds=t --_xformat=%N -IDUMMY include/snowglass/*.h); do
        case $type in snow_*) grep -q "id=\"$type\"" site/docs/c-api.html || lacking+=" $type" ;; esac
    done
fi
check "the headers themselves are there" cmp include/snowglass/volume.h \
    site/include/snowglass/volume.h
for name in Volume.render Look Image.save compare series Viewer.close insitu.Movie; do
    grep -q "<h[23] id=\"$(tr -d . <<<"${name,,}")\"" site/docs/python-api.html ||
        lacking+=" $name"
done
check "what only the package itself calls is no reference" [ -z "$(grep -E \
    '<h[23] id="(wrapped|wrap|bundle|drawing)"' site/docs/python-api.html)" ]
check "it says how a class is called" \
    grep -q 'Volume(source: Any, \*, .*progress' site/docs/python-api.html
check "references are whole${lacking:+, but for$lacking}" [ -z "$lacking" ]

if command -v tidy >/dev/null; then
    find site -name '*.html' -exec tidy -q -e {} + 2>&1 |
        grep -v 'proprietary attribute\|<a> anchor .* already defined' >tidied
    check "tidy finds nothing" [ ! -s tidied ]
    head -5 tidied
else
    skipped "the pages' HTML" "there is no tidy"
fi

# The demo has scripts, and nothing else has.  Its page of ./dev web stands in.
mkdir -p bin share/snowglass/web
cp "$TOOL" bin
run 0 "without the page of ./dev web" make_site bin/snowglass
says 'no demo: .*viewer.html is missing'
check "no menu names a demo" [ -z "$(grep -rl demo.html site)" ]
echo '<html><head><script></script>' >share/snowglass/web/viewer.html
run 0 "with it" make_site bin/snowglass
prints ', 0 faults$'
check "a page shows it" grep -q '<iframe src="../demo/engine.html"' site/docs/demo.html
check "menus name it" grep -q 'href="docs/demo.html">Try it' site/index.html
check "it has a volume" grep -q 'data-name="head" data-recipe' site/demo/head.html
check "scripts are there and in the search alone" [ \
    "$(grep -rlE --include='*.html' '<script|javascript:' site | sort)" = \
    "$(printf 'site/%s.html\n' demo/engine demo/head search)" ]
cat >bin/half <<'END'
#!/bin/sh
case $2 in *head*) echo "no room" >&2 && exit 1 ;; esac
exec "$(dirname "$0")/snowglass" "$@"
END
chmod +x bin/half
run 0 "where a later one cannot be made" make_site bin/half
says 'no demo: no room'
check "no half of a demo is left" [ ! -e site/demo ]

# What is broken is found.
echo 'See [nothing](docs/nothing.md), [no part](docs/usage.md#no-part).' >>README.md
echo '<img src="https://example.org/a.png" alt="">' >>docs/zarr.md
run 1 "broken links are found" make_site
says 'index.html links to docs/nothing.html, which is not there'
says 'index.html links to docs/usage.html#no-part, an anchor'
says 'zarr.html takes https://example.org/a.png from elsewhere'
mkdir other && touch other/mine
run 1 "a folder of other files is left alone" "$PYTHON" -B scripts/site \
    "$TABLE" other
check "all of it" [ -e other/mine ]
finish
