"""overhead.py: what Python adds to the library: the time of a call, of the import,
and memory.  Ends with 1 where a limit is passed.

    PYTHONPATH=build/python /usr/bin/python3 tests/python/overhead.py

With --once times are measured once, and have no limit: tests run it so."""
import os
import resource
import subprocess
import sys
import tempfile
import time


ONCE = "--once" in sys.argv[1:]


def best(runs, measure):
    return min(measure() for _ in range(1 if ONCE else runs))


def import_ms(cache):
    """Beside an interpreter that imports nothing; processor time, which other
    programs do not change much.  From the second time on, as where it is
    installed, it is compiled."""
    environment = {**os.environ, "PYTHONPYCACHEPREFIX": cache}
    environment.pop("PYTHONDONTWRITEBYTECODE", None)

    def run(code):
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        subprocess.run([sys.executable, "-c", code], check=True, env=environment)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    alone = best(20, lambda: run("pass"))
    print(f"(an interpreter takes {1e3 * alone:.1f} ms to start and end; about 10 on "
          f"a quiet machine)")
    run("import snowglass")
    return 1e3 * (best(20, lambda: run("import snowglass")) - alone)


def call_ms(volume):
    """Above the call of the core, in C, that draws; of one thread, in processor
    time."""
    from snowglass import Image, Look
    transfer = volume._transfer("mr-default")
    look = Look(preset="mr-default")

    def core():
        begin = time.thread_time()
        volume._render(Image, transfer, None,
                       {"width": 64, "height": 64, "azimuth": 10.0},
                       {"threads": 1}, False, None, None, (), False, 1.0, None)
        return time.thread_time() - begin

    def call():
        begin = time.thread_time()
        volume.render(look, size=64, azimuth=10, fit="volume", threads=1)
        return time.thread_time() - begin

    def look_alone():  # which C makes too, for each picture
        begin = time.thread_time()
        volume._look({"preset": "mr-default", "colormap": None, "log": False,
                      "low": 0.0, "high": 0.0}, "auto", None, None, None)
        return time.thread_time() - begin
    return 1e3 * (best(300, call) - best(300, core) - best(300, look_alone))


def peak():
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024


def main():
    with tempfile.TemporaryDirectory() as cache:
        rows = [("import snowglass, ms", import_ms(cache), 30)]
    import numpy
    import snowglass as sg
    array = numpy.zeros((256, 512, 512), numpy.uint8)  # 64 MiB
    array[100:150, 200:300, 200:300] = 200
    before = peak()
    big = sg.Volume(array, copy=False)
    numpy.asarray(big)
    rows.append(("a volume over an array of 64 MiB, and back, MiB",
                 peak() - before, 2))
    picture = sg.Volume("phantom:head", dims=(64, 64, 64)).render(
        size=(4096, 2048), quality="draft")  # 64 or 128 MiB
    before = peak()
    numpy.asarray(picture)
    rows.append(("a picture of 4096x2048 as an array, MiB", peak() - before, 2))
    small = sg.Volume("phantom:head", dims=(64, 64, 64))
    rows.append(("volume.render above the C call, ms", call_ms(small), 0.2))
    for name, value, limit in rows:
        print(f"{name:48s} {value:8.3f}  (at most {limit})")
    return 1 if any(value > limit for name, value, limit in rows
                    if not (ONCE and name.endswith(", ms"))) else 0


if __name__ == "__main__":
    sys.exit(main())
