"""What pages measure and point at: the viewer's answers beside what the voxels and the
camera's geometry say, and what it does with questions that are wrong."""
import json
import math
import os
import statistics
import subprocess
import sys
import tempfile

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from viewer_client import TOOL, Page, Server, check, finish, run_command
from volumes import each, nrrd, placed

FOLDER = tempfile.TemporaryDirectory()
NAME = os.path.join(FOLDER.name, "ball.nrrd")
DIMS, STEP, FIRST, RADIUS = (40, 30, 20), (1, 2, 4), (10, -20, 30), 18


def place(at):
    return [f + s * i for f, s, i in zip(FIRST, STEP, at)]


MIDDLE = place([(n - 1) / 2 for n in DIMS])


def value(*at):
    """A ball, bright by its place: 1000 and more."""
    inside = math.dist(place(at), MIDDLE) < RADIUS
    return inside * (1000 + at[0] + 10 * at[1] + at[2])


nrrd(NAME, DIMS, each(DIMS, value, "h"), *placed(STEP, FIRST), kind="int16")


def near(a, b, most):
    return a is not None and abs(a - b) <= most


def answers(page, what, n, **asked):
    return page.ask(what, n=n, **asked)


def measured(server, page):
    z = 10
    ellipse = f"ellipse z {FIRST[2] + STEP[2] * z} 30,8 9 11"
    page.rest(1, size=[120, 90], measure=f"line 12,-10,50 40,30,70; {ellipse}")
    page.question("measures")
    message = page.receive_text("measures")
    line, oval = message["measures"]
    check("a line is as long as its ways", near(line["length"], math.dist(
        (12, -10, 50), (40, 30, 70)), 1e-9), line)
    inside = [value(x, y, z) for y in range(DIMS[1]) for x in range(DIMS[0])
              if ((10 + x - 30) / 9)**2 + ((2 * y - 20 - 8) / 11)**2 <= 1 + 1e-9]
    check("an ellipse has the voxels whose centres are inside",
          oval["count"] == len(inside) and oval["min"] == min(inside) and
          oval["max"] == max(inside), oval)
    check("and their mean and deviation", near(oval["mean"], statistics.mean(inside), 1e-9) and
          near(oval["deviation"], statistics.stdev(inside), 1e-9), oval)
    for more in {"clip": [[1, 0, 0, 25]]}, {"z-scale": 2, "clip": None}:
        page.rest(2 + ("z-scale" in more), **more)
        page.question("measures")
        check(f"{more} changes none of it",
              page.receive_text("measures")["measures"] == message["measures"])
    page.rest(4, **{"z-scale": None})
    page.question("command")
    command = page.receive_text("command")["text"]
    check("the command has it", f"--measure 'line 12,-10,50 40,30,70; {ellipse}'" in command, command)
    page.rest(5, crop=[[0, 40], [0, 30], [0, 8]])
    page.question("measures")
    line, oval = page.receive_text("measures")["measures"]
    check("a crop that has not the slice leaves the line", line["length"] > 0 and
          oval["count"] == 0 and oval["mean"] is None, oval)
    page.rest(6, crop=None)


def refused(page):
    for n, wrong in enumerate(("line 1,2", 7, ["line 0,0,0 1,1,1"], "ellipse q 1 1,1 1 1",
                               "line 0,0,0 1,1,1;" * 65)):
        page.set(10 + n, measure=wrong)
        said = page.receive_text("said")["text"]
        check(f"{str(wrong)[:40]} is refused", "measure" in said, said)
    page.question("measures")
    check("and changes nothing", len(page.receive_text("measures")["measures"]) == 2)


def pointed(page):
    for n, at in enumerate(([20, 15, 10], [0, 0, 0], [39, 29, 19])):
        page.question("probe", n=n, at=at)
        got = page.receive_text("probe")
        check(f"voxel {at} has its value", got["n"] == n and got["value"] == value(*at), got)
    for wrong in ([40, 0, 0], [-1, 0, 0], [1, 2], "x", [1.5, 2, 3], [2**62, 0, 0], {}, None):
        page.question("probe", n=9, at=wrong)
        got = page.receive_text("probe")
        plain = wrong in ([1, 2], "x", [1.5, 2, 3], {}, None)
        check(f"{wrong} is answered", got["value"] is None or plain, got)
    page.rest(30, view="superior", fit="volume", opacity=[[0, 0], [500, 0], [501, 1]])
    page.question("probe", n=1, x=0.5, y=0.5, size=[400, 400])
    depth = page.receive_text("probe")["depth"]
    check("the ball's front is its radius before its middle", near(depth, -RADIUS, STEP[2]), depth)
    page.question("probe", n=2, x=0.02, y=0.02, size=[400, 400])
    check("beside it there is nothing", page.receive_text("probe")["depth"] is None)
    for wrong in ({"x": 2, "y": 0.5}, {"x": "a"}, {}, {"x": 0.5, "y": -1, "size": "big"},
                  {"x": 0.5, "y": 0.5, "size": [1e9, -1]}):
        page.question("probe", n=3, **wrong)
        check(f"{wrong} is answered", "depth" in page.receive_text("probe"))
    page.rest(31, mode="mip")
    page.question("probe", n=4, x=0.5, y=0.5)
    check("a projection has no surface", page.receive_text("probe")["depth"] is None)


server = Server(NAME)
page = Page(server)
measured(server, page)
refused(page)
pointed(page)
code, said = server.stop()
check("the server ends in order", code == 0, f"{code} {said}")
finish()
