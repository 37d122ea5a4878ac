#!/bin/bash
# --show in a terminal: by kitty's protocol all pixels, elsewhere half blocks.
. "$(dirname "$0")/../../support/shell.sh"

refused 2 "no terminal" '\-\-show: standard output is not a terminal' \
    "$TOOL" phantom:cube --show
python3 -c 'import pty, fcntl, termios' 2>/dev/null || exit 77
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
run 0 "the picture as a file" "$TOOL" $picture -o a.png
run 0 "in a plain terminal" python3 terminal.py blocks "$TOOL" $picture --show
check "no file is written" absent head.png
run 0 "with an output" python3 terminal.py again "$TOOL" $picture --show \
    -o b.png
check "the file is written too" cmp -s a.png b.png
check "and the same is shown" cmp -s blocks again
export KITTY_WINDOW_ID=1
run 0 "in kitty" python3 terminal.py kitty "$TOOL" $picture --show
check "by its protocol" grep -q _Ga=T kitty
for inside in TMUX=/tmp/tmux,1,0 STY=1.pts TERM=tmux-256color TERM=screen; do
    run 0 "in kitty, $inside" env $inside python3 terminal.py inside "$TOOL" \
        $picture --show
    check "$inside: half blocks are shown" cmp -s inside blocks
done
# Whatever is written, a PNG is shown: its background, letters and colours.
"$TOOL" convert -q phantom:head --dims 40x40x40 -o head.nrrd
for options in "" "-c hot" "-m mip" "-m mean -c viridis"; do
    shown="head.nrrd -s 200x160 -q $options --show"
    # shellcheck disable=SC2086
    run 0 "'$options' as a PNG" python3 terminal.py as_png "$TOOL" $shown
    # shellcheck disable=SC2086
    run 0 "'$options' beside a file of floats" python3 terminal.py as_npy \
        "$TOOL" $shown -y -o shown.npy
    check "'$options': the same is shown" cmp -s as_png as_npy
done
for verb in "slice --at 20" "slice --axis x -c hot"; do
    run 0 "$verb as a PNG" python3 terminal.py as_png "$TOOL" $verb head.nrrd \
        -q -s 120x100 --show
    run 0 "$verb beside a file of values" python3 terminal.py as_values \
        "$TOOL" $verb head.nrrd -q -s 120x100 --show -y -o values.npy
    check "$verb: the same is shown" cmp -s as_png as_values
done
run 0 "without letters" python3 terminal.py bare "$TOOL" head.nrrd -s 200x160 -q \
    -m mean -c viridis --show --no-labels
check "letters are among what is shown" [ "$(cmp -s as_npy bare; echo $?)" = 1 ]
run 0 "what is written" "$TOOL" head.nrrd -s 200x160 -q -m mean -c viridis -o own.npy
check "is as without showing" cmp -s shown.npy own.npy
cat >compare.py <<'END'
"""What was shown beside the levels of the PNG."""
import base64, re, struct, zlib
data = open("a.png", "rb").read()
assert struct.unpack(">II", data[16:24]) == (90, 60) and data[24:26] == b"\x08\x02"
at, body = 8, b""
while at < len(data):
    size, kind = struct.unpack(">I4s", data[at:at + 8])
    if kind == b"IDAT":
        body += data[at + 8:at + 8 + size]
    at += 12 + size
raw, rows = zlib.decompress(body), []
for y in range(60):
    line = bytearray(raw[y * 271 + 1:(y + 1) * 271])
    for i in range(270):
        left = line[i - 3] if i >= 3 else 0
        up = rows[-1][i] if rows else 0
        corner = rows[-1][i - 3] if rows and i >= 3 else 0
        p = left + up - corner
        near = min((abs(p - v), n) for n, v in enumerate((left, up, corner)))[1]
        line[i] = (line[i] + (0, left, up, (left + up) // 2,
                              (left, up, corner)[near])[raw[y * 271]]) & 255
    rows.append(line)
kitty = open("kitty", "rb").read()
parts = re.findall(rb"\x1b_G([^;]*);([^\x1b]*)\x1b\\", kitty)
assert parts[0][0] == b"a=T,f=24,s=90,v=60,q=2,m=1" and parts[-1][0] == b"m=0"
assert all(len(text) <= 4096 for _, text in parts)
assert b"".join(base64.b64decode(t) for _, t in parts) == b"".join(rows)
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
