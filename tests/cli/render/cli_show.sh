#!/bin/bash
# --show in a terminal: by kitty's protocol all pixels, elsewhere half blocks.
. "$(dirname "$0")/../../support/shell.sh"

refused 2 "no terminal" '\-\-show: standard output is not a terminal' \
    "$TOOL" phantom:cube --show
python3 -c 'import pty, fcntl, termios' 2>/dev/null || exit 77
need_python
cat >terminal.py <<'END'
"""Runs a command with its standard output at a pseudo-terminal of 40 x 12."""
import fcntl, os, pty, struct, subprocess, sys, termios
master, slave = pty.openpty()
fcntl.ioctl(slave, termios.TIOCSWINSZ, struct.pack("HHHH", 12, 40, 0, 0))
attributes = termios.tcgetattr(slave)
attributes[1] &= ~termios.OPOST
termios.tcsetattr(slave, termios.TCSANOW, attributes)
child = subprocess.Popen(sys.argv[2:], stdout=slave, stdin=subprocess.DEVNULL)
os.close(slave)
with open(sys.argv[1], "wb") as out:
    while True:
        try:
            piece = os.read(master, 65536)
        except OSError:
            break
        if not piece:
            break
        out.write(piece)
sys.exit(child.wait())
END
unset KITTY_WINDOW_ID TERM_PROGRAM TMUX STY
export TERM=xterm-256color
picture="phantom:head --dims 40x40x40 -s 90x60 -q -c hot --background black"
# shown FILE OPTION...: what a terminal gets.
shown() { run 0 "shown: ${*:2}" python3 terminal.py "$1" "$TOOL" "${@:2}" -q --show; }
run 0 "the picture as a file" "$TOOL" $picture -o a.png
shown blocks $picture
check "no file is written" absent head.png
shown again $picture -o b.png
same_file "the file is written too" a.png b.png
same_file "and the same is shown" blocks again
export KITTY_WINDOW_ID=1
shown kitty $picture
check "by kitty's protocol" grep -q _Ga=T kitty
for inside in TMUX=/tmp/tmux,1,0 STY=1.pts TERM=tmux-256color TERM=screen; do
    run 0 "in kitty, $inside" env $inside python3 terminal.py inside "$TOOL" \
        $picture --show
    same_file "$inside: half blocks are shown" inside blocks
done
# Whatever is written, a PNG is shown: its background, letters and colours.
"$TOOL" convert -q phantom:head --dims 40x40x40 -o head.nrrd
for verb in "slice --at 20" "slice --axis x -c hot" render "render -c hot" "render -m mip" \
    "render -m mean -c viridis"; do
    shown as_png $verb head.nrrd -s 200x160
    shown as_npy $verb head.nrrd -s 200x160 -y -o shown.npy
    same_file "$verb: the same is shown beside a file of floats" as_png as_npy
done
shown bare $verb head.nrrd -s 200x160 --no-labels
other_file "letters are among what is shown" as_npy bare
run 0 "what is written" "$TOOL" $verb head.nrrd -s 200x160 -q -o own.npy
same_file "is as without showing" shown.npy own.npy
cat >compare.py <<'END'
"""What was shown beside the levels of the PNG."""
import base64, re
from png import levels
width, height, colors = levels(open("a.png", "rb").read())
assert (width, height) == (90, 60)
body = bytes(value for pixel in zip(*colors) for value in pixel)
rows = [body[270 * y:270 * (y + 1)] for y in range(60)]
kitty = open("kitty", "rb").read()
parts = re.findall(rb"\x1b_G([^;]*);([^\x1b]*)\x1b\\", kitty)
assert parts[0][0] == b"a=T,f=24,s=90,v=60,q=2,m=1" and parts[-1][0] == b"m=0"
assert all(len(text) <= 4096 for _, text in parts)
assert b"".join(base64.b64decode(t) for _, t in parts) == body
shown = open("blocks", "rb").read().decode()
lines = shown.split("\n")[:-1]
assert len(lines) <= 11, len(lines)  # 12 rows, less the cursor's
cells = [re.findall(r"38;2;(\d+);(\d+);(\d+)(?:;48;2;(\d+);(\d+);(\d+))?m\u2580",
                    line) for line in lines]
assert all(len(row) == len(cells[0]) <= 40 for row in cells)
step = 3
assert len(cells) == 10 and len(cells[0]) == 30
for r, row in enumerate(cells):
    for c, cell in enumerate(row):
        for half in (0, 1):
            for k in range(3):
                values = [rows[y][3 * x + k]
                          for y in range((2 * r + half) * step, (2 * r + half + 1) * step)
                          for x in range(c * step, (c + 1) * step)]
                assert int(cell[3 * half + k]) == sum(values) // len(values)
END
run 0 "all pixels are those of the file, and blocks their means" \
    python3 compare.py
finish
