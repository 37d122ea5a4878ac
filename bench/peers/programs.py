"""bench/peers/programs.py - the programs that are compared, all with one face.

A program is loaded, given a transfer function (a file of 256 lines red green
blue opacity), asked for pictures and timed by itself: `frame` gives wall and
processor seconds.  Most are workers behind a pipe that stay alive; Teem is a
command that is started for each picture and tells its rendering time.
"""
import math
import os
import re
import shutil
import struct
import subprocess
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
SYSTEM_PYTHON = "/usr/bin/python3"  # Debian's, which has Debian's VTK


class Failed(Exception):
    """A program that cannot be measured; its text says why."""


class Worker:
    """A process that reads commands on stdin: README.md lists them."""

    def __init__(self, name, threads, command, environment=None):
        self.name, self.threads = name, threads
        self.process = subprocess.Popen(
            [str(word) for word in command], stdin=subprocess.PIPE,
            stdout=subprocess.PIPE, text=True,
            env={**os.environ, **(environment or {})})

    def ask(self, command):
        try:
            self.process.stdin.write(command + "\n")
            self.process.stdin.flush()
            answer = self.process.stdout.readline().split()
        except BrokenPipeError:
            answer = []
        if len(answer) != 3 or answer[0] != "ok":
            raise Failed(f"{self.name} gave up at '{command}'")
        return float(answer[1]), float(answer[2])

    def load(self):
        return self.ask("load")

    def table(self, path):
        self.ask(f"table {path}")

    def frame(self, azimuth, elevation):
        return self.ask(f"frame {azimuth} {elevation}")

    def save(self, path):
        self.ask(f"save {path}")

    def peak_megabytes(self):
        return self.ask("memory")[0] / 1024

    def close(self):
        """Waited for, so that nothing of it disturbs what comes next."""
        try:
            self.process.communicate("quit\n", timeout=10)
        except (subprocess.TimeoutExpired, OSError, ValueError):
            self.process.kill()
            self.process.wait()


class Teem:
    """teem-miter, Teem's volume renderer (mrender only reduces rays).

    Its own "rendering time" counts, without loading and writing.  Processor
    time is that of the process less that of one with a picture of one pixel.
    """

    def __init__(self, case, threads, folder):
        self.name, self.threads, self.case = "teem", threads, case
        self.volume = folder / f"{case.raw.stem}.nhdr"
        self.colors = folder / f"teem-{threads}.txf.nrrd"
        self.picture = folder / f"teem-{threads}.nrrd"
        self.peak = 0

    def load(self):
        self.volume.write_text(
            "NRRD0005\ntype: uint8\ndimension: 3\nsizes: {} {} {}\n"
            "space dimension: 3\nspace origin: (0,0,0)\n"
            "space directions: (1,0,0) (0,1,0) (0,0,1)\n"
            "centers: cell cell cell\nencoding: raw\ndata file: {}\n".format(
                *self.case.dims, self.case.raw))
        self.null = None
        return 0, 0

    def table(self, path):
        rows = [list(map(float, line.split()))
                for line in Path(path).read_text().splitlines()]
        self.colors.write_bytes(
            b'NRRD0005\ntype: float\ndimension: 2\nsizes: 4 256\n'
            b'axis mins: nan 0\naxis maxs: nan 255\ncenters: none node\n'
            b'labels: "RGBA" "gage(scalar:v)"\nendian: little\n'
            b'encoding: raw\n\n' +
            b"".join(struct.pack("<4f", *row) for row in rows))

    def command(self, azimuth, elevation, size):
        """Tent and central differences: what the model takes at voxels."""
        radius = self.case.radius
        target = [(n - 1) / 2 for n in self.case.dims]
        up, back = turned(azimuth, elevation)
        eye = [t + 4 * radius * b for t, b in zip(target, back)]
        shade = (["-ads", 0.2, 0.7, 0.2, "-sp", 20, "-side", 0, "-ss",
                  "phong:gage(scalar:n)"] if self.case.shaded else
                 ["-ads", 1, 0, 0, "-ss", "none"])
        return ["teem-miter", "-i", self.volume, "-txf", self.colors,
                "-fr", *eye, "-at", *target, "-up", *up, "-or", "-ar",
                "-dn", -radius, "-di", 0, "-df", radius,
                "-ur", -radius, radius, "-vr", -radius, radius,
                "-is", size, size, *shade, "-k00", "tent", "-k11", "cendif",
                "-step", 1, "-ref", 1, "-n1", 0.99, "-nt", self.threads,
                "-o", self.picture]

    def run(self, azimuth, elevation, size):
        """Rendering seconds as told, processor seconds of the process."""
        process = subprocess.Popen(
            [str(word) for word in self.command(azimuth, elevation, size)],
            stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
        said = process.stderr.read().decode(errors="replace")
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        process.stderr.close()
        told = re.search(r"rendering time = ([0-9.e+-]+)", said)
        if process.returncode or not told:
            raise Failed(f"teem gave up: {said[-200:]}")
        self.peak = max(self.peak, usage.ru_maxrss)
        return float(told.group(1)), usage.ru_utime + usage.ru_stime

    def frame(self, azimuth, elevation):
        if self.null is None:
            self.null = self.run(azimuth, elevation, 1)[1]
        wall, cpu = self.run(azimuth, elevation, self.case.size)
        return wall, max(0.0, cpu - self.null)

    def save(self, path):
        """Doubles red green blue alpha depth, straight, rows from below."""
        values = self.picture.read_bytes().partition(b"\n\n")[2]
        size = self.case.size
        rows = []
        for y in reversed(range(size)):
            row = bytearray()
            for x in range(size):
                rgba = struct.unpack_from("<4d", values, 40 * (y * size + x))
                row += bytes(int(255 * clamped(c * rgba[3]) + 0.5)
                             for c in rgba[:3])
            rows.append(bytes(row))
        Path(path).write_bytes(b"P6\n%d %d\n255\n" % (size, size) +
                               b"".join(rows))

    def peak_megabytes(self):
        return self.peak / 1024

    def close(self):
        pass


def clamped(x):
    return min(1.0, max(0.0, x)) if x == x else 0.0


def turned(azimuth, elevation):
    """The camera's up and back: docs/model.md, section 2."""
    ca, sa = math.cos(math.radians(azimuth)), math.sin(math.radians(azimuth))
    ce, se = (math.cos(math.radians(elevation)),
              math.sin(math.radians(elevation)))
    return (-se * sa, ce, -se * ca), (ce * sa, se, ce * ca)


class Display:
    """The X server that VTK wants: DISPLAY's, or an Xvfb of our own."""

    def __init__(self):
        self.process, self.name = None, os.environ.get("DISPLAY")
        if self.name or not shutil.which("Xvfb"):
            return
        reading, writing = os.pipe()
        self.process = subprocess.Popen(
            ["Xvfb", "-displayfd", str(writing), "-screen", "0",
             "1280x1280x24"], pass_fds=[writing], stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        os.close(writing)
        with os.fdopen(reading) as pipe:
            number = pipe.readline().strip()
        self.name = f":{number}" if number else None

    def close(self):
        if self.process:
            self.process.terminate()
            self.process.wait()


def missing(build, display):
    """{program: why it cannot run here}."""
    why = {}
    if not (build / "peers" / "volpack_worker").exists():
        why["volpack"] = "not built: VolPack (libvolpack1-dev) is missing"
    if not shutil.which("teem-miter"):
        why["teem"] = "no teem-miter (teem-apps)"
    found = subprocess.run([SYSTEM_PYTHON, "-c", "import vtk, numpy"],
                           capture_output=True, check=False)
    for name in ("vtk-cpu", "vtk-gl"):
        if found.returncode:
            why[name] = "no VTK for Python (python3-vtk9, python3-numpy)"
        elif not display.name:
            why[name] = "no X display and no Xvfb (xvfb): VTK aborts without"
    return why


# Our rows: name and quality.
OURS = {"snowglass-draft": "draft", "snowglass": "normal",
        "snowglass-high": "high"}

# In the order of the tables; for each the numbers of threads it can use.
# VolPack's octree is a second worker: see README.md.
THREADS = {"snowglass-draft": (1, 2), "snowglass": (1, 2),
           "snowglass-high": (1, 2), "volpack": (1,), "volpack-octree": (1,),
           "vtk-cpu": (1, 2), "vtk-gl": (1, 2), "teem": (1, 2)}


def start(name, threads, case, options, display):
    """Starts one program on one case."""
    build = Path(options.build)
    shape = [case.raw, *case.dims, case.size, threads, int(case.shaded)]
    if name in OURS:
        return Worker(name, threads, [build / "peers" / "ours_worker", *shape,
                                      options.method, OURS[name]])
    if name.startswith("volpack"):
        how = "octree" if name.endswith("octree") else "classified"
        return Worker(name, threads, [build / "peers" / "volpack_worker",
                                      *shape, int(case.coloured), how])
    if name.startswith("vtk"):
        return Worker(name, threads, [SYSTEM_PYTHON, HERE / "vtk_worker.py",
                                      name[4:], *shape],
                      {"DISPLAY": display.name})
    return Teem(case, threads, Path(options.output) / "data")


def versions():
    """Debian's versions of what is installed."""
    names = ["libvolpack1", "python3-vtk9", "teem-apps", "libgl1-mesa-dri"]
    if not shutil.which("dpkg-query"):
        return {}
    said = subprocess.run(["dpkg-query", "-W", "-f", "${Package} ${Version}\n",
                           *names], capture_output=True, text=True, check=False)
    return dict(line.split() for line in said.stdout.splitlines()
                if len(line.split()) == 2)


if __name__ == "__main__":
    sys.exit("this is a part of peers.py")
