"""A running simulation in the viewer: newest steps, turns, and that no page
slows it.  Run by tests/mpi/mpi_serve.sh as `python3 live.py TOOL MPIEXEC
SIMULATION`."""
import atexit
import json
import os
import struct
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from viewer_client import TOOL, Page, Server, check, finish

FOLDER = tempfile.TemporaryDirectory()
os.chdir(FOLDER.name)
RECIPE = {"output": "u_%05d.png", "size": [160, 120], "reread": True,
          "range": [0, 1], "opacity": [[0.3, 0], [1, 0.8]],
          "background": "#101018"}


def write(recipe, path="look.json"):
    with open(path + ".new", "w") as out:
        json.dump(recipe, out)
    os.rename(path + ".new", path)


def read(path="look.json"):
    with open(path) as file:
        return json.load(file)


def simulate():
    for name in os.listdir("."):
        os.remove(name)
    write(RECIPE)
    made = subprocess.Popen([sys.argv[2], "-n", "3", sys.argv[3], "look.json"],
                            stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                            text=True)
    atexit.register(made.kill)
    return made


def end(simulation):
    """Steps, and the longest in seconds."""
    open("stop", "w").close()
    told, said = simulation.communicate(timeout=180)
    check("the simulation ends well", simulation.returncode == 0, told + said)
    steps, longest = told.split()[:2]
    return int(steps), float(longest)


def newest():
    return max((name for name in os.listdir(".") if name.startswith("u_")),
               default="u_-0001.png")


def number(name):
    return int(name[2:7])


def wait_for(what, seconds=90):
    stop = time.monotonic() + seconds
    while time.monotonic() < stop:
        found = what()
        if found:
            return found
        time.sleep(0.05)
    return None


def receive_step(page):
    """The next picture, and the step that was told before it."""
    step = None
    while True:
        what, message = page.hear()
        if what == "closed":
            return None, None
        if what == "text" and message["t"] == "step":
            step = message["step"]
        elif what == "picture" and step is not None:
            page.say({"t": "ack", "n": 0})
            return step, message[32:]


def steps_and_turns():
    simulation = simulate()
    server = Server("--live", "look.json")
    page = Page(server)
    info = page.receive_text("info")
    check("the grid of the simulation", info["dims"] == [24, 24, 30] and
          info["matrix"] == [[0.5, 0, 0, 100], [0, 0.5, 0, 50], [0, 0, 2, -20]]
          and info["live"] and info["slices"] is None, info)
    look = page.receive_text("look")
    check("its look", look["low"] == 0 and look["high"] == 1 and
          look["opacity"] == [[0.3, 0], [1, 0.8]], look)
    counts = page.ask("histogram")
    check("how often values occur, each voxel once", len(counts["counts"]) == 256
          and sum(counts["counts"]) == 24 * 24 * 30 and
          counts["lo"] < counts["hi"], counts)
    before = number(newest())
    shown = [receive_step(page) for _ in range(5)]
    steps = [step for step, _ in shown]
    check("steps go up", steps == sorted(set(steps)), steps)
    check("and are new", steps[-1] >= before, f"{steps} {before}")
    for step, picture in shown:
        with open(f"u_{step:05d}.png", "rb") as file:
            check(f"the picture of step {step} is its file",
                  file.read() == picture)
    page.set(1, azimuth=70, elevation=20, colormap="magma", size=[999, 999])
    found = wait_for(lambda: read().get("azimuth") == 70)
    check("a turn is written into the recipe", found and
          read()["colormap"] == "magma" and read()["output"] ==
          RECIPE["output"] and read()["reread"], read())
    check("but no size, as a movie has one", read()["size"] == [160, 120])
    latest = number(newest())
    while True:  # one that was begun after
        step, picture = receive_step(page)
        if step is None or step > latest + 2:
            break
    check("the simulation has drawn it", step is not None and
          picture != shown[0][1])
    page.set(2, clip=[[1, 0, 0, 105]])
    check("clip planes are written into it",
          wait_for(lambda: read().get("clip") == [[1, 0, 0, 105]]), read())
    few = wait_for(lambda: 0 < sum(page.receive_text("histogram")["counts"]) <
                   24 * 24 * 30)
    check("and what they take away is not counted", few)
    page.set(3, clip=None)
    check("all of it is back", wait_for(lambda: sum(page.receive_text("histogram")
          ["counts"]) == 24 * 24 * 30) and "clip" not in read(), read())
    page.question("fit")
    page.question("command")
    check("there is no command", "look.json" in page.receive_text("said")["text"])
    check("the recipe", json.loads(page.ask("recipe")["text"])["azimuth"]
          == 70)
    page.set(4, range=[0, 0.5])
    info = page.receive_text("info")
    check("another range is told, of the same pictures", info["max"] == 0.5 and
          info["name"] == RECIPE["output"], info)
    page.set(5, zoom="large")
    check("a wrong value is answered and not written",
          "zoom" in page.receive_text("said")["text"] and "zoom" not in read())
    end(simulation)
    other = Page(server)
    check("a page that comes later has the newest picture",
          receive_step(other)[0] == number(newest()))
    check("the viewer ends in order", server.stop()[0] == 0)


def png(told):
    """As much of a picture with a comment as the viewer reads."""
    text = b"Snowglass\0" + json.dumps(told).encode()
    return (b"\x89PNG\r\n\x1a\n" + struct.pack(">I4sIIxxxxxxxxx", 13, b"IHDR", 8, 8)
            + struct.pack(">I4s", len(text), b"tEXt") + text + bytes(4)
            + struct.pack(">I4sxxxx", 0, b"IEND"))


def show(number, told):
    with open("u.new", "wb") as out:
        out.write(png(told))
    os.rename("u.new", f"u_{number:05d}.png")


def strange_pictures():
    """Comments of pictures without a simulation."""
    for name in os.listdir("."):
        os.remove(name)
    write(RECIPE)
    server = Server("--live", "look.json")
    page = Page(server)
    told = {"step": 1, "dims": [4, 5, 6], "range": [0, 1], "opacity": [],
            "matrix": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0]}
    page.receive_text("state")  # the page is known
    show(1, {**told, "range": [2, 1]})
    check("why a look cannot be made is said",
          "range" in page.receive_text("said")["text"])
    show(2, told)
    check("the next picture is told", page.receive_text("info")["dims"] ==
          told["dims"])
    show(3, {**told, "ends": [0, 1], "counts": ["many"] * 256})
    show(4, {**told, "ends": [0, 1], "counts": [7] * 256})
    counts = page.receive_text("histogram")
    check("counts that are not numbers are not shown", counts["counts"] == [7] * 256 and
          [counts["lo"], counts["hi"]] == [0, 1], counts)
    check("the viewer ends in order", server.stop()[0] == 0)


def slow_pages():
    """A simulation goes on beside pages that read nothing."""
    simulation = simulate()
    wait_for(lambda: number(newest()) >= 0)
    server = Server("--live", "look.json")
    pages = [Page(server) for _ in range(8)]
    pages[0].receive_text("info")
    first = number(newest())
    # More steps than fill what lies between the viewer and the pages.
    went_on = wait_for(lambda: number(newest()) >= first + 60, 360)
    server.process.kill()
    steps, longest = end(simulation)
    print(f"       the longest of {steps} steps beside {len(pages)} pages that read "
          f"nothing took {longest:.2f} s")
    check("pages that read nothing do not stop it", went_on, newest())
    server.process.communicate()


def refused():
    cases = {"needs \"reread\": true": {**RECIPE, "reread": False},
             "needs an output": {**RECIPE, "output": "u.png"},
             "such as": {**RECIPE, "output": "u_%d.pfm"},
             "nonsense": {**RECIPE, "nonsense": 1}}
    for text, recipe in cases.items():
        write(recipe, "wrong.json")
        done = subprocess.run([TOOL, "serve", "--live", "wrong.json"],
                              capture_output=True, text=True, timeout=60)
        check(f"{recipe} is refused", done.returncode and text in done.stderr
              and done.stderr.count("\n") == 1, done.stderr)
    write(RECIPE, "right.json")
    for words in (["--azimuth", "30"], ["--preset", "ct-bone"],
                  ["--mask", "none.nrrd"], ["--deterministic"], ["-j", "2"]):
        done = subprocess.run([TOOL, "serve", "--live", "right.json", *words],
                              capture_output=True, text=True, timeout=60)
        check(f"{words} is refused, which the recipe says", done.returncode and
              "cannot be given with --live" in done.stderr
              and done.stderr.count("\n") == 1, done.stderr)
    for words in (["look.json", "--live", "wrong.json"], ["--live", "none.json"]):
        done = subprocess.run([TOOL, "serve", *words], capture_output=True,
                              text=True, timeout=60)
        check(f"{words} is refused", done.returncode and
              done.stderr.count("\n") == 1, done.stderr)


refused()
strange_pictures()
steps_and_turns()
slow_pages()
finish()
