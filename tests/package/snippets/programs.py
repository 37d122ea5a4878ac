"""Snippets of programs: each is put into a frame, built, and run."""
import json
import os
import pathlib
import re
import subprocess

from shells import environment

FRAMES = pathlib.Path(__file__).resolve().parent / "frames"
SCHEMA = "/usr/share/snowglass/recipe.schema.json"

#: The names of Python's snippets, which follow one another in a document.
known = {}


def framed(name, text):
    """A frame around a snippet; lines of it that include come first."""
    frame = (FRAMES / name).read_text(encoding="utf-8")
    if "INCLUDES" in frame:
        frame = frame.replace("INCLUDES", "".join(
            re.findall(r"(?m)^#include .*\n", text)))
        text = re.sub(r"(?m)^#include .*\n", "", text)
    return frame.replace("SNIPPET", text)


def call(command, folder, **more):
    """What is wrong, or None."""
    done = subprocess.run(["bash", "-c", command], cwd=folder, text=True,
                          capture_output=True, env=environment(**more),
                          timeout=600)
    return f"{command}: status {done.returncode}: " \
        f"{(done.stdout + done.stderr)[-1500:]}" if done.returncode else None


def c(snippet, folder):
    if "insitu" in snippet.text:
        # 512 to the power of three doubles are 1 GB, of which it draws a corner.
        text = snippet.text.replace("512, 512, 512", "64, 64, 64")
        name = "levels.c" if "_set_cells" in text else "simulation.c"
        (folder / "program.c").write_text(framed(name, text))
        return call("mpicc program.c -o program $(pkg-config --cflags --libs "
                    "snowglass-mpi) && rm -f u_*.png && mpirun -n 1 ./program && "
                    "[ -s u_0007.png ]", folder)
    alone = {"snow_frame_render_bytes": "loop.c",
             "snow_view_pixel_to_world": "picking.c"}
    frame = next((alone[name] for name in alone if name in snippet.text), None)
    if frame:
        (folder / "program.c").write_text(framed(frame, snippet.text))
        return call("cc -std=c11 -Wall -Werror -Wno-misleading-indentation program.c "
                    "-o program $(pkg-config --cflags --libs snowglass) && ./program",
                    folder)
    name = "streamed.c" if "streamed" in snippet.text else "picture.c"
    (folder / "program.c").write_text(framed(name, snippet.text))
    return call("cc -std=c11 -Wall -Werror -Wno-misleading-indentation program.c "
                "-o program $(pkg-config --cflags --libs snowglass) && rm -f "
                "head.png ct.png && ./program && "
                "ls head.png ct.png 2>/dev/null | grep -q png", folder)


def declaration(snippet, folder):
    """Of a manual page: it stands in an installed header, which programs of other
    snippets include."""
    return None


def fortran(snippet, folder):
    text = re.sub(r"(?m)^\.\.\.$", "", snippet.text)
    (folder / "program.f90").write_text(framed("simulation.f90", text))
    return call("mpifort snowglass.f90 program.f90 -o program $(pkg-config "
                "--libs snowglass-recipe snowglass-mpi) && mpirun -n 1 "
                "./program && [ -s heat_0007.png ]", folder)


def cmake(snippet, folder):
    (folder / "CMakeLists.txt").write_text(framed("CMakeLists.txt",
                                                  snippet.text))
    return call("cmake -S . -B there && cmake --build there && rm -f head.png "
                "&& there/program && [ -s head.png ]", folder)


def json_file(snippet, folder):
    """A recipe, or a file of a look."""
    tree = json.loads(snippet.text)
    (folder / "snippet.json").write_text(snippet.text)
    if "snowglass-tf" in tree:
        return call("snowglass head.nii.gz --tf snippet.json -o new.png -q",
                    folder)
    import jsonschema
    with open(SCHEMA, encoding="utf-8") as file:
        jsonschema.validate(tree, json.load(file))
    given = "" if "input" in tree else "head.nii.gz"
    return call(f"snowglass {given} --config snippet.json -o new.png -q",
                folder)


def series(folder):
    """The files that a snippet of a series names."""
    import h5py
    import numpy
    for step in range(3):
        with h5py.File(folder / f"run_{step:04d}.h5", "w") as file:
            file["rho"] = numpy.indices((16, 16, 16)).sum(0) * (step + 1.0)


def cells(folder):
    """The file of two channels that a snippet names."""
    import numpy
    import tifffile
    z, c, y, x = numpy.indices((8, 2, 16, 16))
    tifffile.imwrite(folder / "cells.ome.tif",
                     (20 * (c + 1) * ((x - 8) ** 2 + y < 40)).astype("u1"),
                     metadata={"axes": "ZCYX",
                               "Channel": {"Name": ["DAPI", "GFP"]}})


def python(snippet, folder):
    """In one interpreter, as one reads a document."""
    launched = re.match(r"# needs files of a run: (mpiexec .*)\n", snippet.text)
    if launched:
        (folder / "movie.py").write_text(snippet.text)
        return call(launched.group(1), folder)
    # Files of gigabytes are made smaller.
    text = re.sub(r"(?m)^side(.*) = \d\d\d\b", r"side\1 = 96", snippet.text)
    series(folder)
    if "cells.ome.tif" in text:
        cells(folder)
    here = os.getcwd()
    os.chdir(folder)
    try:
        exec(compile(text, snippet.place, "exec"), known)
    except Exception as error:  # whatever a snippet raises
        return f"{type(error).__name__}: {error}"
    finally:
        os.chdir(here)
    return None
