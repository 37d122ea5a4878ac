"""interrupt.py: how long Ctrl-C takes, for the command line and for Python.

    SNOWGLASS=build/snowglass PYTHONPATH=build/python \\
        /usr/bin/python3 tests/python/interrupt.py [WORD...]

Of each case (those whose name has all words) a run on one thread is interrupted at
moments spread over its time.  A line says how long the run takes, how long the longest
answer took, and at which moment that was.  The answer is the end of the program, or
the exception in Python.  Ends with 1 where one took more than 100 ms, but for files
that the tool is writing, which it ends first.  All is processor time, which other programs do not change
much: on an idle machine it passes as wall time does."""
import math
import os
import signal
import subprocess
import sys
import tempfile
import time

TOOL = os.path.abspath(os.environ.get("SNOWGLASS", "snowglass"))
MOMENTS = 12  # a third of them for runs of more than 3 seconds


def most(name):
    """Seconds that an answer may take."""
    writes = "tool: write", "tool: convert", "tool: a movie"
    return math.inf if name.startswith(writes) else 0.1


#: What Python does first; what is interrupted is `work()`.
BEFORE = """
import signal, sys, time
import numpy
import snowglass as sg
"""
AFTER = """
def raised(number, frame):
    raise KeyboardInterrupt
signal.signal(signal.SIGINT, raised)
print("ready", flush=True)
try:
    work()
    print("done", flush=True)
    sys.stdin.readline()
except KeyboardInterrupt:
    print(time.process_time(), flush=True)
"""


def head(path, dims, kind):
    """A volume in a file: the head phantom as another type, made once."""
    if not os.path.exists(path):
        subprocess.run([TOOL, "convert", "phantom:head", "--dims", dims, "-o", path,
                        "--as", kind, "-q"], check=True)
    return path


def cases(folder):
    """(name, words of the command line or lines of Python)"""
    large = head(os.path.join(folder, "large.nrrd"), "512x512x300", "int16")
    packed = head(os.path.join(folder, "packed.nii.gz"), "256x256x150", "int16")
    small = head(os.path.join(folder, "small.nrrd"), "128x128x100", "uint8")
    out = os.path.join(folder, "out.png")

    def tool(*words, to=out, verb="render"):
        one = [] if verb == "convert" else ["-j", "1"]
        return [TOOL, verb, *words, "-o", to, "-y", "-q", *one]

    def python(before, work):
        return f"{BEFORE}{before}\ndef work():\n    {work}\n{AFTER}"
    volume = f"volume = sg.Volume({large!r})"
    looked = f"{volume}\nlook = sg.Look(preset='mr-default')"
    both = [
        ("draft", ["--quality", "draft"], "quality='draft'"),
        ("normal", [], ""),
        ("high", ["--quality", "high"], "quality='high'"),
        ("ray cast", ["--method", "raycast"], "method='raycast'"),
        ("footprint", ["--method", "footprint"], "method='footprint'"),
        ("mip", ["--mode", "mip"], "mode='mip'"),
        ("high, 2048", ["--quality", "high", "-s", "2048"],
         "quality='high', size=2048"),
        ("darkened, 2048", ["--depth-darkening", "--occlusion", "-s", "2048"],
         "depth_darkening=1, occlusion=1, size=2048"),
    ]
    yield "tool: unpack", tool(packed)
    for name, words, _ in both:
        yield f"tool: {name}", tool(large, *words)
    yield "tool: a surface", tool(large, "--mode", "iso", "--iso", "120")
    yield "tool: write 4096", tool(small, "-s", "4096", "--quality", "draft")
    yield "tool: write 4096, webp", tool(small, "-s", "4096", "--quality", "draft",
                                         to=os.path.join(folder, "out.webp"))
    yield "tool: convert", tool(large, to=os.path.join(folder, "out.nii.gz"),
                                verb="convert")
    yield "tool: a movie", tool(small, "--frames", "40", "-s", "512",
                                to=os.path.join(folder, "out.mp4"), verb="turntable")
    yield "tool: info", [TOOL, "info", large, "--json"]
    yield "Python: read", python("", f"sg.Volume({large!r})")
    yield "Python: unpack", python("", f"sg.Volume({packed!r})")
    yield "Python: choose a look", python(volume, "print(volume.look())")
    for name, _, words in both:
        yield f"Python: {name}", python(looked, f"volume.render(look, threads=1, {words})")
    yield "Python: project", python(volume, "volume.project('sum', size=1024)")
    yield "Python: statistics", python(volume, "volume.statistics")
    yield "Python: mask", python(f"{volume}\nmask = numpy.asarray(volume) > 300",
                                 "volume.masked(mask)")
    yield "Python: resample an overlay", python(
        f"volume = sg.Volume(numpy.asarray(sg.Volume({large!r})), medical=True)\n"
        f"other = sg.Volume(numpy.ones((200, 200, 200)), spacing=2, medical=True)",
        "volume.render(overlay=other, overlay_look='hot', size=64)")
    yield "Python: slice", python(volume, "volume.slice('z')")
    yield "Python: save a volume", python(
        volume, f"volume.save({os.path.join(folder, 'o.nii.gz')!r}, overwrite=True)")
    picture = f"picture = sg.Volume({small!r}).render(size=4096, quality='draft')"
    for suffix in "png", "webp", "jpg", "exr":
        yield f"Python: save 4096, {suffix}", python(
            picture, f"picture.save({os.path.join(folder, 'o.' + suffix)!r}, "
                     f"overwrite=True)")
    yield "Python: a movie", python(
        f"volume = sg.Volume({small!r})",
        f"volume.turntable({os.path.join(folder, 'o.mp4')!r}, frames=40, size=512)")


def processor_time(child):
    """Seconds of another process so far: its clock, as clock_getcpuclockid has it."""
    return time.clock_gettime((~child.pid << 3) | 2)


def interrupt(child, begin, moment):
    """Sends the signal when the child has taken so long, or does nothing any more;
    its time then."""
    how = os.WEXITED | os.WNOHANG | os.WNOWAIT
    now, since = begin, time.monotonic()
    while now < begin + moment and time.monotonic() < since + 2 and \
            not os.waitid(os.P_PID, child.pid, how):
        time.sleep(0.0005)
        before, now = now, processor_time(child)
        if now > before:
            since = time.monotonic()
    os.kill(child.pid, signal.SIGINT)
    return now


def run_tool(words, moment):
    """Seconds from the signal to the end, 0: it had ended; without a moment, of the
    whole."""
    child = subprocess.Popen(words, stdout=subprocess.DEVNULL,
                             stderr=subprocess.DEVNULL)
    sent = 0 if moment is None else interrupt(child, 0, moment)
    _, status, used = os.wait4(child.pid, 0)
    child.returncode = os.waitstatus_to_exitcode(status)
    took = used.ru_utime + used.ru_stime - sent
    return took if moment is None or child.returncode in (0, 130) else 0


def run_python(text, moment):
    child = subprocess.Popen([sys.executable, "-c", text], stdin=subprocess.PIPE,
                             stdout=subprocess.PIPE, text=True)
    while (line := child.stdout.readline()) and line != "ready\n":
        continue
    begin = processor_time(child)
    if moment is None:
        while (line := child.stdout.readline()) and line != "done\n":
            continue
        whole = processor_time(child) - begin
        child.communicate()
        return whole
    sent = interrupt(child, begin, moment)
    return float(child.communicate()[0].split()[-1]) - sent


def measure(name, work):
    """The longest answer, in seconds."""
    run = run_tool if isinstance(work, list) else run_python
    whole = run(work, None)
    count = MOMENTS if whole < 3 else MOMENTS // 3
    at = [(n + 0.5) / count for n in range(count)]
    longest = max((run(work, whole * part), part) for part in at)
    print(f"{name:28s} {1e3 * whole:8.0f} {1e3 * longest[0]:8.1f} "
          f"{100 * longest[1]:4.0f} %", flush=True)
    return longest[0]


def main():
    # Where it is ignored, as in a job in the background, so would children.
    signal.signal(signal.SIGINT, signal.default_int_handler)
    folder = os.environ.get("SNOW_INTERRUPT") or tempfile.mkdtemp()
    print("case                         whole, ms  longest answer, ms, at")
    late = [measure(name, work) > most(name) for name, work in cases(folder)
            if all(word in name for word in sys.argv[1:])]
    return 1 if any(late) or not late else 0


if __name__ == "__main__":
    sys.exit(main())
