#!/bin/bash
# Ctrl-C (SIGINT) and SIGTERM while a volume is read, a picture is drawn and a
# movie is made: exit code 130 at once, one line, nothing half left behind.
. "$(dirname "$0")/../../support/shell.sh"

need_python
cat >interrupt.py <<'PY'
"""interrupt.py SIGNAL SECONDS FILE COMMAND...: sends the signal so many seconds
after FILE is there (or, "-": after the tool has begun to listen to signals);
prints standard error, then the exit code, and the milliseconds that the
processor worked from the signal to the end.  99: these were too many."""
import glob, os, re, signal, subprocess, sys, time
number = getattr(signal, sys.argv[1])
seconds, pattern, command = float(sys.argv[2]), sys.argv[3], sys.argv[4:]
signal.signal(signal.SIGINT, signal.SIG_DFL) # a shell's job ignores it
process = subprocess.Popen(command, stdin=subprocess.PIPE,
                           stderr=subprocess.PIPE)
def listens():
    try:
        with open(f"/proc/{process.pid}/status") as file:
            caught = re.search(r"SigCgt:\s*(\w+)", file.read())
        return bool(int(caught[1], 16) >> (number - 1) & 1)
    except OSError: # no /proc
        time.sleep(1)
        return True
def worked():
    try:
        with open(f"/proc/{process.pid}/stat") as file:
            ticks = file.read().rsplit(")", 1)[1].split()[11:13]
        return sum(map(int, ticks)) / os.sysconf("SC_CLK_TCK")
    except OSError:
        return 0
ready = listens if pattern == "-" else lambda: glob.glob(pattern)
while not ready() and process.poll() is None:
    time.sleep(0.005)
time.sleep(seconds)
before = worked()
process.send_signal(number)
said = process.stderr.read().decode()
used = os.wait4(process.pid, 0)
code = os.waitstatus_to_exitcode(used[1])
took = 1e3 * (used[2].ru_utime + used[2].ru_stime - before)
sys.stdout.write(said)
print(f"code {code}\nafter {took:.0f} ms")
sys.exit(code if took < 500 else 99)
PY
interrupt() { python3 interrupt.py "$@"; }

run 0 "a volume" "$TOOL" phantom engine --dims 160x160x160 -o v.nrrd
before=$(ls -A)
# A picture that takes seconds: every moment of it.
for seconds in 0 0.15 0.5; do
    for signal in SIGINT SIGTERM; do
        run 130 "$signal after $seconds s" interrupt $signal $seconds - \
            "$TOOL" v.nrrd -o a.png -s 2000x2000 -q --method original -j 1
        prints '^snowglass: interrupted$'
        check "which is said once" [ "$(grep -c snowglass "$OUT")" = 1 ]
        check "and nothing is left" [ "$(ls -A)" = "$before" ]
    done
done
run 130 "while a pipe is read" interrupt SIGINT 0.1 - "$TOOL" - -o a.png
check "nothing is left" [ "$(ls -A)" = "$before" ]
run 130 "while a phantom is made" interrupt SIGINT 0.3 - "$TOOL" \
    phantom:turbulence --dims 700x700x700 -o a.png
check "nothing is left" [ "$(ls -A)" = "$before" ]

# A movie keeps its whole frames.
run 0 "a small volume" "$TOOL" phantom engine --dims 64x64x64 -o w.nrrd
slow=("$TOOL" turntable w.nrrd -s 600x600 --frames 12 --method original -j 1)
for _ in $(seq 20); do # as often as it comes too late
    interrupt SIGINT 0 part_01.png "${slow[@]}" -o part_%02d.png >"$OUT"
    code=$?
    [ -e part_11.png ] || break
    rm -f part_* .part_*
done
NAME="a movie"
check "$NAME" [ $code -eq 130 ]
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
