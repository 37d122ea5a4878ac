"""A simulation that makes a movie of itself: `insitu_movie.py FORM`, as the lines
of docs/python.md do, over as many ranks as there are."""
import os
import sys

import numpy
from mpi4py import MPI

import snowglass as sg
from snowglass import insitu

comm = MPI.COMM_WORLD
form = sys.argv[1]
dims = (20, 18, 16 * comm.size // comm.size)


def whole(step):
    z, y, x = numpy.meshgrid(numpy.arange(16), numpy.arange(18),
                             numpy.arange(20), indexing="ij")
    return (numpy.hypot(x - 9 - step, y - 7) + 0.3 * z).astype(numpy.float32)


low, high = (16 * n // comm.size for n in (comm.rank, comm.rank + 1))
halo = {"halo": 1, "sides": ((1, 0), 2, (0, 3))}.get(form, 0)
around = {"halo": ((1, 1),) * 3, "sides": ((0, 3), (2, 2), (1, 0))}.get(form)


def within(step):
    """The own part with layers of the neighbours, or of the own border."""
    before, behind = around[0]
    return numpy.pad(whole(step), around, mode="edge")[low:high + before + behind]


if around:
    part = within(0).copy()
else:
    part = whole(0)[low:high].copy(order="F" if form == "fortran" else "C")
with insitu.Movie(comm, dims, spacing=(1, 1, 1.5), output="f_%02d.png",
                  recipe={"input": "of.another", "size": [80, 60],
                          "view": "left"},
                  preset="linear", range=(0, 15), colormap="viridis",
                  fit="volume", bits=16) as movie:
    movie.brick(part, first=(0, 0, low), halo=halo)
    for step in range(2):
        part[...] = within(step) if around else whole(step)[low:high]
        movie.step(step)
if comm.rank == 0:
    numpy.save("last.npy", whole(1))


def refuses(wrong, text, status=None):
    """An exception that has the text, and no name of C or of the tool, on all ranks;
    with a status it is snowglass.Error.  A recipe that is wrong has status 3."""
    try:
        wrong()
    except (TypeError, ValueError, RuntimeError) as error:
        assert text in str(error), error
        assert "snow_" not in str(error) and "--" not in str(error), error
        assert isinstance(error, sg.Error) or status is None, type(error)
        assert getattr(error, "status", 3) == (status or 3), error.status
    else:
        raise AssertionError(text)


for wrong, text in ((lambda: movie.step(3), "the movie is closed"),
                    (lambda: insitu.Movie(comm, dims, nonsense=1),
                     "nonsense"),
                    (lambda: insitu.Movie(comm, (0, 1, 1)), "is empty"),
                    (lambda: insitu.Movie(comm, (4, 5)), "dims: give three whole"),
                    (lambda: insitu.Movie(comm, (4, 5, 6.5)), "not (4, 5, 6.5)"),
                    (lambda: insitu.Movie(comm, "112"), "not '112'"),
                    (lambda: insitu.Movie(comm, (1, 1, 2 ** 63)),
                     "dims: 9223372036854775808 is out of range"),
                    (lambda: insitu.Movie(comm, dims,
                                          spacing=(1, float("nan"), 1)),
                     "spacing: nan is not a finite number"),
                    (lambda: insitu.Movie("x", dims), "comm: give a communicator"),
                    (lambda: insitu.Movie(comm, dims, spacing=(1, 1, -1)),
                     "invalid spacing=-1")):
    refuses(wrong, text)

# Messages name what there is in Python.
wide = numpy.zeros((4, 4, 4), numpy.float32)
for wrong, text in (
        (lambda movie: movie.step(0), "give output= to Movie"),
        (lambda movie: movie.step(0, time="x"), "time: must be a number"),
        (lambda movie: movie.step("a"), "number: must be a whole number, not 'a'"),
        (lambda movie: movie.brick(wide, first=(0, 0)), "first: give three whole"),
        (lambda movie: movie.brick(wide, first=(2, 0, 0)),
         "correct first= or the shape of the array"),
        (lambda movie: movie.brick(wide, id=-1), "id: -1 is out of range"),
        (lambda movie: movie.brick(wide, id=2 ** 20), "invalid id=1048576"),
        (lambda movie: movie.brick(wide, halo=0.5), "halo: must be a whole number"),
        (lambda movie: movie.brick(wide, halo=(1, 1)), "halo: give a whole number"),
        (lambda movie: movie.brick(wide, halo=(1, (0, 1, 2), 0)), "halo: give a whole"),
        (lambda movie: movie.brick(wide, halo=((0, 4), 0, 0)), "within its halo"),
        (lambda movie: movie.brick(wide, cells=(2, 2)), "cells: give three whole"),
        (lambda movie: movie.brick(wide, cells=2), "correct first="),
        (lambda movie: movie.brick(wide > 0), "a brick of bool")):
    with insitu.Movie(comm, (4, 4, 4)) as movie:
        refuses(lambda: wrong(movie), text)
# A wrong brick fails the next step on all ranks, and no more than that one.
with insitu.Movie(comm, (4, 4, 4 * comm.size), output="f_%02d.png",
                  overwrite=True, size=40) as movie:
    refuses(lambda: movie.brick(wide, first=(2, 0, 0)),
            "the next step raises this too")
    refuses(lambda: movie.brick(wide, id=2 ** 20), "invalid id=1048576")
    movie.brick(wide, first=(0, 0, 4 * comm.rank))
    refuses(lambda: movie.step(0), "correct first=")
    movie.step(0)
with insitu.Movie(comm, (4, 4, 4), output="f_%02d.png") as movie:
    refuses(lambda: movie.step(0), "no rank has a brick; call Movie.brick")
    if comm.rank == 0:
        movie.brick(wide)
    # Rank 0 writes; the others know why it does not.
    refuses(lambda: movie.step(0), "give overwrite=True to Movie", status=4)

# What cannot be written is known before a step, on all ranks.
for output, text in (("none/f_%d.png", "make the folder first"),
                     ("f_%d.tga", "has no suffix of a picture format"),
                     ("f_%d_%d.png", "one %d or %04d")):
    refuses(lambda: insitu.Movie(comm, (4, 4, 4), output=output), text,
            status=4 if "/" in output else None)

# Cells of two voxels of a linear field are drawn as its voxels are.
coarse = numpy.arange(8, dtype=numpy.float32)[None, None, :] * 2 + 100.5
with insitu.Movie(comm, (16, 8, 8 * comm.size), output="c_%02d.png", size=40,
                  range=(100, 115), bits=16) as movie:
    movie.brick(numpy.broadcast_to(coarse, (4, 4, 8)).copy(), (0, 0, 8 * comm.rank),
                cells=2)
    movie.step(0)
with insitu.Movie(comm, (16, 8, 8 * comm.size), output="c_%02d.png", size=40,
                  range=(100, 115), bits=16) as movie:
    fine = numpy.arange(100, 116, dtype=numpy.float32)
    movie.brick(numpy.broadcast_to(fine, (8, 8, 16)).copy(), (0, 0, 8 * comm.rank))
    movie.step(1)

# Of a long path a message has the end.
deep = "/".join(["folder" * 30] * 12)
if comm.rank == 0:
    os.makedirs(deep, exist_ok=True)
    with open(f"{deep}/f_00.png", "wb"):
        pass
with insitu.Movie(comm, (4, 4, 4), output=f"{deep}/f_%02d.png") as movie:
    if comm.rank == 0:
        movie.brick(wide)
    refuses(lambda: movie.step(0),
            f"...{deep[-188:]}/f_00.png: exists; remove it, choose "
            "another output, or give overwrite=True to Movie", status=4)
