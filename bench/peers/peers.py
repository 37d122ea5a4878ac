#!/usr/bin/env python3
"""bench/peers/peers.py - Snowglass beside what people use today on processors.

Run it as `./dev peers`, which builds what it needs.  Every case is a volume, a
look and a picture size; all programs are loaded with it, and then each in its
turn draws the object from all sides, again and again, so that a change of the
machine's speed meets them all.  What is compared and why it is fair: README.md.
"""
import argparse
import array
import gzip
import json
import math
import signal
import statistics
import subprocess
import sys
import time
from dataclasses import dataclass
from pathlib import Path

import pictures
import programs
import report

AZIMUTH, ELEVATION = 30, 20  # of the first picture, in degrees
# Pictures all around the object: so many where one takes at most that many
# seconds.
AROUND = ((0.05, 120), (0.5, 12), (math.inf, 3))
CHANGES = 15                 # pictures with another transfer function each
SLOW = 1.0                   # seconds: such a program makes SLOW_TIMES of them,
SLOW_TIMES = 3               # and its warming up counts as one
REST = 0.01  # seconds before a program's turn: idle threads of the last one may
             # wait actively for a while, at the next one's cost

# name: (file below --data, phantom when there is none, voxels, first visible
# value).  Where the phantom is None the volume is left out without --data.
VOLUMES = {
    "engine": ("classic/engine_256x256x110_u8.raw.gz", "engine",
               (256, 256, 110), 10),
    "head": ("classic/CThead_256x256x113_u16be.raw.gz", "head",
             (256, 256, 113), 30),
    "bonsai": ("classic/bonsai.vti", None, None, 20),
    "aneurism": ("classic/aneurism.vti", None, None, 20),
    "engine512": (None, "engine", (512, 512, 512), 30),
}

# Colours of value 0 and of value 255, between them a straight line; opacity at
# value 255; whether there is shading.  Two colours at most, so that VolPack
# can have them as two materials.
GREY = ((0, 0, 0), (1, 1, 1))
LOOKS = {
    "grey": (GREY, 1, False),
    "glass": (GREY, 0.2, False),
    "shaded": (((1, 1, 1), (1, 1, 1)), 1, True),
    "colour": (((0.75, 0.25, 0.15), (1, 0.95, 0.8)), 1, True),
}

CASES = ["engine:shaded:512", "engine:grey:512", "engine:glass:512",
         "engine:colour:512", "engine:shaded:1024", "head:shaded:512",
         "bonsai:colour:512", "aneurism:shaded:512", "engine512:shaded:512",
         "engine512:shaded:1024"]


@dataclass
class Case:
    name: str
    raw: Path
    dims: tuple
    size: int
    look: str
    low: int      # the first value that is seen
    source: str   # in words

    @property
    def shaded(self):
        return LOOKS[self.look][2]

    @property
    def coloured(self):
        return self.look == "colour"

    @property
    def radius(self):
        """From the middle to the farthest corner of the voxel boxes."""
        return math.sqrt(sum(n * n for n in self.dims)) / 2


# --- volumes, as raw bytes ---------------------------------------------------

def head_bytes(packed):
    """16-bit values on 8 bits as bench/volumes.c does."""
    values = array.array("H", gzip.decompress(packed))
    if sys.byteorder == "little":
        values.byteswap()
    mapped = [min(255, math.floor((v + 88) * 0.0825)) for v in range(65536)]
    return bytes(map(mapped.__getitem__, values))


def from_vti(source, raw):
    said = subprocess.run(
        [programs.SYSTEM_PYTHON, programs.HERE / "vtk_worker.py", "convert",
         source, raw], capture_output=True, text=True, check=True).stdout
    return tuple(map(int, said.split()[-3:]))


def from_phantom(name, dims, raw, build):
    subprocess.run([build / "snowglass", "phantom", name, "--quiet", "-y",
                    "--dims", "x".join(map(str, dims)), "-o", raw], check=True)
    return dims


def make_raw(name, options):
    """(raw file, dims, where it came from in words)."""
    file, phantom, dims, _ = VOLUMES[name]
    build, raw = Path(options.build), options.folder / "data" / f"{name}.raw"
    source = Path(options.data) / file if options.data and file else None
    if not source:
        if not phantom:
            raise programs.Failed(f"{name} is a real volume: give --data")
        return raw, from_phantom(phantom, dims, raw, build), "phantom"
    if not source.exists():
        raise programs.Failed(f"{source} is missing")
    if source.suffix == ".vti":
        try:
            return raw, from_vti(source, raw), file
        except (OSError, subprocess.CalledProcessError) as error:
            raise programs.Failed(f"{file} is read by VTK, which is "
                                  "missing") from error
    packed = source.read_bytes()
    raw.write_bytes(head_bytes(packed) if name == "head"
                    else gzip.decompress(packed))
    return raw, dims, file


def make_case(text, options, made):
    name, look, size = text.split(":")
    if name not in VOLUMES or look not in LOOKS:
        raise programs.Failed(f"no case '{text}'; see --help")
    if name not in made:
        made[name] = make_raw(name, options)
    raw, dims, source = made[name]
    return Case(text, raw, dims, int(size), look, VOLUMES[name][3], source)


# --- transfer functions ------------------------------------------------------

def write_table(case, variant, folder):
    """Opacity rises in a straight line from the first visible value to 255; a
    variant begins a little higher, as when a user moves it."""
    (first, last), most, _ = LOOKS[case.look]
    low = case.low + 2 * variant
    lines = []
    for value in range(256):
        color = [a + (b - a) * value / 255 for a, b in zip(first, last)]
        opacity = most * max(0, value - low) / (255 - low)
        lines.append("{:.7f} {:.7f} {:.7f} {:.7f}\n".format(*color, opacity))
    path = folder / "tables" / f"{case.name.replace(':', '-')}-{variant}.txt"
    path.write_text("".join(lines))
    return path


# --- measuring ---------------------------------------------------------------

class Runner:
    """One program on one case, and what was measured of it."""

    def __init__(self, worker):
        self.worker = worker
        self.first = None  # (wall, cpu) of the first picture
        self.turning, self.changing = [], []
        self.around = 0    # pictures all around the object
        self.megabytes = self.idle = 0  # at most; before loading
        self.picture = None
        self.failed = None

    def attempt(self, action, *arguments):
        """Does it unless the program failed before; None when it fails now."""
        if self.failed:
            return None
        try:
            return action(*arguments)
        except (programs.Failed, OSError) as error:
            self.failed = str(error)
            print(f"  {error}", file=sys.stderr)
            return None

    def frame(self, azimuth):
        time.sleep(REST)
        return self.attempt(self.worker.frame, azimuth, ELEVATION)

    def whole_turn(self):
        """(wall, cpu) of a picture, the mean of those all around the object;
        they follow one another at once, as when a user turns it."""
        time.sleep(REST)
        sums = [0, 0]
        for n in range(self.around):
            took = self.attempt(self.worker.frame,
                                AZIMUTH + 360 * (n + 1) / self.around,
                                ELEVATION)
            if not took:
                return None
            sums = [a + b for a, b in zip(sums, took)]
        return [a / self.around for a in sums]

    def may_change(self):
        """Whether it is to make another picture with a new table."""
        return not self.failed and (len(self.changing) < SLOW_TIMES or
                                    self.changing[-1][0] < SLOW)


def begin(runner, case, folder):
    """Loads, makes the first picture and keeps it: in the beginning every
    program sees the same view and the same transfer function."""
    worker = runner.worker
    runner.idle = runner.attempt(worker.peak_megabytes)
    runner.attempt(worker.load)
    runner.attempt(worker.table, write_table(case, 0, folder))
    runner.first = runner.frame(AZIMUTH)
    path = folder / "pictures" / (f"{case.name.replace(':', '-')}-"
                                  f"{worker.name}-{worker.threads}.ppm")
    runner.attempt(worker.save, path)
    if not runner.failed:
        runner.picture = pictures.read_ppm(path)
        path.unlink()
        pictures.write_png(path.with_suffix(".png"), runner.picture)


def turn(runners, turns):
    """The view turns, the transfer function stays.  A first turn warms up: what
    a program does once for each axis is no part of its pace."""
    for runner in runners:
        took = runner.frame(AZIMUTH)
        runner.around = next(n for most, n in AROUND
                             if not took or took[0] <= most)
    for number in range(turns + 1):
        for runner in runners:
            took = runner.whole_turn()
            if took and number:
                runner.turning.append(took)


def change(runners, case, folder):
    """The view stays, the transfer function changes for every picture."""
    for step in range(CHANGES + 1):
        table = write_table(case, 1 + step % 5, folder)
        for runner in runners:
            if runner.may_change():
                runner.attempt(runner.worker.table, table)
                took = runner.frame(AZIMUTH)
                if took and (step or took[0] > SLOW):
                    runner.changing.append(took)


def figures(runner, reference):
    """What the report needs, in milliseconds."""
    row = {"program": runner.worker.name, "threads": runner.worker.threads}
    if runner.failed:
        return {**row, "failed": runner.failed}

    def middle(times, which):
        return (1e3 * statistics.median(t[which] for t in times)
                if times else None)

    row.update(first=1e3 * runner.first[0],
               frame=middle(runner.turning, 0),
               frame_cpu=middle(runner.turning, 1),
               frame_least=1e3 * min(t[0] for t in runner.turning),
               change_least=1e3 * min(t[0] for t in runner.changing),
               change=middle(runner.changing, 0),
               change_cpu=middle(runner.changing, 1),
               turns=len(runner.turning), pictures=runner.around,
               megabytes=runner.megabytes,
               idle_megabytes=runner.idle)
    if reference and reference is not runner.picture:
        row["psnr"], row["psnr_scaled"] = pictures.psnr(runner.picture,
                                                        reference)
    return row


def measure(case, chosen, options, display):
    """All programs on one case; the rows of its table."""
    folder = options.folder
    runners = []
    try:
        for name, threads in chosen:
            runners.append(Runner(programs.start(name, threads, case, options,
                                                 display)))
            begin(runners[-1], case, folder)
        turn([r for r in runners if r.worker.name != "volpack-octree"],
             options.turns)
        change(runners, case, folder)
        for runner in runners:
            runner.megabytes = runner.attempt(runner.worker.peak_megabytes)
    finally:
        for runner in runners:
            runner.worker.close()
    reference = next((r.picture for r in runners
                      if r.worker.name == "vtk-cpu" and r.picture), None)
    # The reference comes first: VTK's mappers, Teem, VolPack, and ours.
    shown = [(r.worker.name, r.picture) for r in reversed(runners)
             if r.picture and r.worker.name != "volpack-octree" and
             r.worker.threads == min(programs.THREADS[r.worker.name])]
    shown.sort(key=lambda named: named[1] is not reference)
    if shown:
        pictures.write_png(folder / f"{case.name.replace(':', '-')}.png",
                           pictures.sheet(shown))
    for runner in runners:  # its pace while turning is not asked for
        if runner.worker.name == "volpack-octree" and not runner.failed:
            runner.turning = runner.changing
    return report.join_volpack([figures(r, reference) for r in runners])


# --- the command -------------------------------------------------------------

def parse():
    parser = argparse.ArgumentParser(
        prog="./dev peers", description="Snowglass beside VTK, VolPack and "
        "Teem, on the same volumes, views and transfer functions.")
    parser.add_argument("--data", help="folder of the real volumes (the one "
                        "that holds classic/); without it phantoms")
    parser.add_argument("--turns", type=int, default=5, help="turns all around "
                        "the object whose median is taken (%(default)s)")
    parser.add_argument("--case", action="append", metavar="VOLUME:LOOK:SIZE",
                        help="only this one, may be repeated; volumes: "
                        f"{' '.join(VOLUMES)}; looks: {' '.join(LOOKS)}; all: "
                        f"{' '.join(CASES)}")
    parser.add_argument("--program", action="append", help="only this one, may "
                        f"be repeated: {' '.join(programs.THREADS)}")
    parser.add_argument("--threads", type=int, help="only runs with so many")
    parser.add_argument("--method", default="shear-warp",
                        help="method of Snowglass (%(default)s)")
    parser.add_argument("--json", action="store_true",
                        help="print JSON in place of the tables")
    parser.add_argument("--output", default="out/peers",
                        help="folder for pictures and tables (%(default)s)")
    parser.add_argument("--build", default="build", help="folder that ./dev "
                        "peers built in (%(default)s)")
    options = parser.parse_args()
    if options.turns < 1:
        parser.error("--turns wants at least 1")
    for name in options.program or ():
        if name not in programs.THREADS:
            parser.error(f"no program '{name}'")
    options.folder = Path(options.output).resolve()
    options.output = str(options.folder)
    for name in ("data", "tables", "pictures"):
        (options.folder / name).mkdir(parents=True, exist_ok=True)
    return options


def choose(options, display):
    """[(program, threads)] that can run here; says which cannot."""
    why = programs.missing(Path(options.build), display)
    chosen, skipped = [], {}
    for name, counts in programs.THREADS.items():
        reason = why.get(name.replace("-octree", ""))
        if options.program and name not in options.program:
            continue
        if reason:
            skipped[name] = reason
            if not name.endswith("-octree"):
                print(f"{name}: skipped, {reason}", file=sys.stderr)
            continue
        chosen += [(name, n) for n in counts
                   if options.threads in (None, n)]
    return chosen, skipped


def repeat(options):
    """The command that measures the same again, on any machine."""
    words = ["./dev", "peers"]
    words += ["--data", "FOLDER"] if options.data else []
    words += ["--turns", str(options.turns)]
    for text in options.case or ():
        words += ["--case", text]
    for name in options.program or ():
        words += ["--program", name]
    words += ["--threads", str(options.threads)] if options.threads else []
    return " ".join(words + ["--method", options.method])


def main():
    options = parse()
    # However it ends, the workers and the display end with it.
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(1))
    signal.signal(signal.SIGINT, lambda *_: sys.exit(1))
    display = programs.Display()
    made, cases, left_out = {}, [], {}
    try:
        chosen, skipped = choose(options, display)
        for text in options.case or CASES:
            try:
                case = make_case(text, options, made)
            except (programs.Failed, ValueError) as error:
                left_out[text] = str(error)
                print(f"{text}: left out, {error}", file=sys.stderr)
                continue
            print(f"measuring {text} ...", file=sys.stderr, flush=True)
            rows = measure(case, chosen, options, display)
            cases.append({"case": text, "dims": case.dims, "look": case.look,
                          "size": case.size, "source": case.source,
                          "rows": rows})
            if not options.json:
                print(report.text_of(cases[-1]), flush=True)
    finally:
        display.close()
    result = {"machine": report.machine(), "versions": programs.versions(),
              "turns": options.turns, "method": options.method,
              "skipped": skipped, "left_out": left_out, "cases": cases}
    markdown = report.markdown(result, repeat(options))
    (options.folder / "peers.json").write_text(json.dumps(result, indent=1))
    (options.folder / "peers.md").write_text(markdown)
    print(json.dumps(result, indent=1) if options.json else markdown)
    failed = any("failed" in row for case in cases for row in case["rows"])
    return 1 if failed or not cases else 0


if __name__ == "__main__":
    sys.exit(main())
