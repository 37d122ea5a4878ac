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
run 0 "a volume" "$TOOL" phantom shells --dims 24x24x24 -o a.nrrd
cat >watch.py <<'PY'
"""watch.py SECONDS TERMINAL COMMAND...: runs a command that gets a.nrrd on its
standard input after so many seconds; prints what it says on standard error."""
import os, pty, subprocess, sys, threading, time
wait, live, command = float(sys.argv[1]), sys.argv[2] == "yes", sys.argv[3:]
reader, writer = pty.openpty() if live else os.pipe()
os.environ["TERM"] = "xterm"
process = subprocess.Popen(command, stdin=subprocess.PIPE, stderr=writer)
os.close(writer)
def feed():
    time.sleep(wait)
    try:
        process.stdin.write(open("a.nrrd", "rb").read())
        process.stdin.close()
    except BrokenPipeError:
        pass
threading.Thread(target=feed).start()
said = b""
while True:
    try:
        more = os.read(reader, 4096)
    except OSError:
        break
    if not more:
        break
    said += more
sys.stdout.write(said.decode().replace("\r", "\n"))
sys.exit(process.wait())
PY
watch() { python3 watch.py "$@"; }

if [ "$terminals" ]; then
    run 0 "on a terminal" watch 2.5 yes "$TOOL" - -o a.png -s 32x32
    prints '^reading'
    prints 'reading, 2 s'
    prints 'rendering'
    run 0 "where nothing shall be said" watch 1.5 yes "$TOOL" - -o b.png \
        -s 32x32 --progress never
    check "nothing is" bash -c "! grep -q reading '$OUT'"
    run 0 "one large picture" watch 0 yes "$TOOL" phantom:engine \
        --dims 160x160x160 -o d.png -s 1000x1000 --method original -j 1
    prints '\[#+-+\] rendering, [1-9][0-9]? %, [0-9]+ s'
    run 0 "a bar" watch 0 yes "$TOOL" turntable a.nrrd -o e.npy.%d.npy \
        -s 300x300 --frames 300 -j 1
    prints '\[#+-+\] frame [0-9]+ of 300, [0-9.e+]+ a second, .* left'
fi
run 0 "without a terminal" watch 10.6 no "$TOOL" - -o c.png -s 32x32
prints '^snowglass: reading, 10 s$'
check "once" [ "$(grep -c reading "$OUT")" = 1 ]
run 0 "always" watch 0 no "$TOOL" - -o f.png -s 32x32 --progress always
prints '^snowglass: rendering$'
finish
