"""A simulation that makes a movie of itself: `insitu_movie.py FORM`, as the lines
of docs/python.md do, over as many ranks as there are."""
import sys

import numpy
from mpi4py import MPI

from snowglass import insitu

comm = MPI.COMM_WORLD
form = sys.argv[1]
dims = (20, 18, 16 * comm.size // comm.size)


def whole(step):
    z, y, x = numpy.meshgrid(numpy.arange(16), numpy.arange(18),
                             numpy.arange(20), indexing="ij")
    return (numpy.hypot(x - 9 - step, y - 7) + 0.3 * z).astype(numpy.float32)


low, high = (16 * n // comm.size for n in (comm.rank, comm.rank + 1))
if form == "halo":  # one layer of the neighbours, or of the own border
    part = numpy.pad(whole(0), 1, mode="edge")[low:high + 2].copy()
else:
    part = whole(0)[low:high].copy(order="F" if form == "fortran" else "C")
with insitu.Movie(comm, dims, spacing=(1, 1, 1.5), output="f_%02d.png",
                  recipe={"input": "of.another", "size": [80, 60],
                          "view": "left"},
                  preset="linear", range=(0, 15), colormap="viridis",
                  fit="volume", bits=16) as movie:
    movie.brick(part, first=(0, 0, low), halo=1 if form == "halo" else 0)
    for step in range(2):
        if form == "halo":
            part[...] = numpy.pad(whole(step), 1, mode="edge")[low:high + 2]
        else:
            part[...] = whole(step)[low:high]
        movie.step(step)
if comm.rank == 0:
    numpy.save("last.npy", whole(1))
for wrong, text in ((lambda: movie.step(3), "the movie is closed"),
                    (lambda: insitu.Movie(comm, dims, nonsense=1),
                     "nonsense"),
                    (lambda: insitu.Movie(comm, (0, 1, 1)), "is empty")):
    try:
        wrong()
    except (ValueError, RuntimeError) as error:
        assert text in str(error), error
    else:
        raise AssertionError(text)
