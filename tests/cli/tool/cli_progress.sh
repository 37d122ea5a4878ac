#!/bin/bash
# --progress: seconds and a bar on a terminal, a line every 10 s elsewhere.
. "$(dirname "$0")/../../support/shell.sh"

command -v python3 >/dev/null || {
    skipped "all" "there is no python3"
    exit 77
}
# A root without /dev/pts, such as a plain chroot, has no terminals to open.
if python3 -c 'import pty; pty.openpty()' 2>/dev/null; then
    terminals=1
else
    terminals=
    skipped "on a terminal" "no pseudo-terminal can be opened here"
fi
# A clock that makes all take long (quick_clock.c).
quick=$(dirname "$TOOL")/tests/libquick_clock.so
run 0 "a volume" "$TOOL" phantom shells --dims 24x24x24 -o a.nrrd
cat >watch.py <<'PY'
"""watch.py TERMINAL FEED COMMAND...: runs a command, and prints what it says on
standard error.  It gets a.nrrd on its standard input when it has said FEED."""
import os, pty, re, subprocess, sys
live, feed, command = sys.argv[1] == "yes", sys.argv[2], sys.argv[3:]
reader, writer = pty.openpty() if live else os.pipe()
os.environ["TERM"] = "xterm"
process = subprocess.Popen(command, stdin=subprocess.PIPE, stderr=writer)
os.close(writer)
fed, said = False, ""
while True:
    if not fed and re.search(feed, said, re.M):
        fed = True
        try:
            process.stdin.write(open("a.nrrd", "rb").read())
            process.stdin.close()
        except BrokenPipeError:
            pass
    try:
        more = os.read(reader, 4096)
    except OSError:
        break
    if not more:
        break
    said += more.decode().replace("\r", "\n")
sys.stdout.write(said)
sys.exit(process.wait())
PY
watch() { python3 watch.py "$@"; }

if [ "$terminals" ]; then
    printed "on a terminal" '^reading' watch yes 'reading, [1-9] s' "$TOOL" - -o a.png -s 32x32
    prints 'rendering'
    run 0 "where nothing shall be said" watch yes "" "$TOOL" - -o b.png \
        -s 32x32 --progress never
    check "nothing is" bash -c "! grep -q reading '$OUT'"
    if [ -e "$quick" ]; then
        run 0 "one large picture" watch yes "" env LD_PRELOAD="$quick" "$TOOL" \
            a.nrrd -o d.png -s 300x300 --method original -j 1
        prints '\[[#-]+\] rendering, [1-9][0-9]? %, [0-9]+ s'
        run 0 "a bar" watch yes "" env LD_PRELOAD="$quick" "$TOOL" \
            turntable a.nrrd -o e.%d.npy -s 32x32 --frames 20 -j 1
        prints '\[[#-]+\] frame [0-9]+ of 20, [0-9.e+-]+ a second, .* left'
    else
        skipped "a bar" "quick_clock is not built"
    fi
fi
run 0 "always" watch no "" "$TOOL" - -o f.png -s 32x32 --progress always
prints '^snowglass: rendering$'
if long_tier; then
    run 0 "without a terminal" watch no '^snowglass: reading, 1[0-9] s$' \
        "$TOOL" - -o c.png -s 32x32
    check "once" [ "$(grep -c reading "$OUT")" = 1 ]
else
    skipped "the line each 10 s" "left to the long tier"
fi
finish
