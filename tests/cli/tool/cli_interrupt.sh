#!/bin/bash
# Ctrl-C (SIGINT) and SIGTERM while a volume is read, a picture is drawn and a
# movie is made: exit code 130 at once, one line, nothing half left behind.
. "$(dirname "$0")/../../support/shell.sh"

command -v python3 >/dev/null || exit 77
cat >interrupt.py <<'PY'
"""interrupt.py SIGNAL SECONDS FILE COMMAND...: sends the signal so many seconds
after FILE (or, "-": anything) is there; prints standard error, then the exit
code and the milliseconds from the signal to the end."""
import glob, os, signal, subprocess, sys, time
number = getattr(signal, sys.argv[1])
seconds, pattern, command = float(sys.argv[2]), sys.argv[3], sys.argv[4:]
signal.signal(signal.SIGINT, signal.SIG_DFL) # a shell's job ignores it
process = subprocess.Popen(command, stdin=subprocess.PIPE,
                           stderr=subprocess.PIPE)
while pattern != "-" and not glob.glob(pattern) and process.poll() is None:
    time.sleep(0.01)
time.sleep(seconds)
begin = time.monotonic()
process.send_signal(number)
said = process.stderr.read().decode()
code = process.wait()
took = 1e3 * (time.monotonic() - begin)
sys.stdout.write(said)
print(f"code {code}\nafter {took:.0f} ms")
slow = took > 3000 # 100 where nobody else is at work
sys.exit(code if not slow else 99)
PY
interrupt() { python3 interrupt.py "$@"; }

run 0 "a volume" "$TOOL" phantom engine --dims 200x200x200 -o v.nrrd
before=$(ls -A)
# A picture that takes seconds: every moment of it.
for seconds in 0.15 0.3 0.6; do
    for signal in SIGINT SIGTERM; do
        run 130 "$signal after $seconds s" interrupt $signal $seconds - \
            "$TOOL" v.nrrd -o a.png -s 2000x2000 -q --method original -j 1
        prints '^snowglass: interrupted$'
        check "which is said once" [ "$(grep -c snowglass "$OUT")" = 1 ]
        check "and nothing is left" [ "$(ls -A)" = "$before" ]
    done
done
run 130 "while a pipe is read" interrupt SIGINT 0.3 - "$TOOL" - -o a.png
check "nothing is left" [ "$(ls -A)" = "$before" ]
run 130 "while a phantom is made" interrupt SIGINT 0.3 - "$TOOL" \
    phantom:turbulence --dims 700x700x700 -o a.png
check "nothing is left" [ "$(ls -A)" = "$before" ]

# A movie keeps its whole frames.
run 0 "a small volume" "$TOOL" phantom engine --dims 64x64x64 -o w.nrrd
slow=("$TOOL" turntable w.nrrd -s 800x800 --frames 12 --method original -j 1)
run 130 "a movie" interrupt SIGINT 0.2 'part_01.png' "${slow[@]}" \
    -o part_%02d.png
prints 'interrupted; frames that are being written'
check "leaves some frames" [ -e part_00.png ]
check "not all" [ ! -e part_11.png ]
check "each whole" bash -c 'for f in part_*.png; do
    "'"$TOOL"'" compare "$f" "$f" >/dev/null || exit 1; done'
check "and nothing half" [ -z "$(ls -A | grep snow-)" ]
run 0 "which goes on" "${slow[@]}" -o part_%02d.png --resume
run 0 "to all frames" "${slow[@]}" -o again_%02d.png
check "that are the same" bash -c 'for n in 00 05 11; do
    cmp part_$n.png again_$n.png || exit 1; done'
finish
