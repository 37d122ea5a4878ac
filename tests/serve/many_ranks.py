"""The viewer over three ranks: pictures, answers, and how a job ends.  Run by
tests/mpi/mpi_serve.sh as `python3 many_ranks.py TOOL MPIEXEC MPI_TOOL`."""
import atexit
import os
import signal
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from viewer_client import TOOL, Page, Server, aside, check, finish, is_of_command, run_command, \
    slice_is_of_command, write_channels

RANKS = 3
MANY = (sys.argv[2], "-n", str(RANKS), sys.argv[3])
FOLDER = tempfile.TemporaryDirectory()
os.chdir(FOLDER.name)
SMALL = os.path.join(FOLDER.name, "small.nrrd")
SIDE = 96
subprocess.run([TOOL, "phantom", "head", "--dims", "60x50x48", "-o", SMALL],
               check=True, capture_output=True)


def start(*options):
    """A job that does not outlive the test."""
    made = Server(SMALL, *options, tool=MANY)
    atexit.register(made.process.kill)
    return made


def ranks_of(server):
    """Processes of the job by rank: children of the launcher."""
    found = {}
    for name in filter(str.isdigit, os.listdir("/proc")):
        try:
            with open(f"/proc/{name}/stat") as stat:
                parent = int(stat.read().rpartition(")")[2].split()[1])
            if parent != server.process.pid:
                continue
            with open(f"/proc/{name}/environ", "rb") as environ:
                for word in environ.read().split(b"\0"):
                    if word.startswith(b"OMPI_COMM_WORLD_RANK="):
                        found[int(word.partition(b"=")[2])] = int(name)
        except (OSError, ValueError):
            continue
    return [found[rank] for rank in range(RANKS)]


def end_of(server, seconds=180):
    """Exit code and what Snowglass said, without the launcher's own words."""
    said = server.process.communicate(timeout=seconds)[1]
    lines = [line for line in said.splitlines()
             if line.startswith("snowglass: ")]
    return server.process.returncode, lines


def is_near(shown, wanted):
    """Within 1/255, as pictures of several ranks are."""
    for name, content in (("shown.png", shown), ("wanted.png", wanted)):
        with open(name, "wb") as out:
            out.write(content)
    return not subprocess.run([TOOL, "compare", "shown.png", "wanted.png", "--tolerance",
                               "1.001/255"], capture_output=True).returncode


def answers(page):
    """What is known of the volume."""
    kept = {}
    for name, question in (
            ("histogram", {"what": "histogram"}),
            ("part of it", {"what": "histogram", "lo": 20, "hi": 90}),
            ("value", {"what": "value", "at": [31, 22, 24]}),
            ("no value", {"what": "value", "at": [31, 22, 48]}),
            ("depth", {"what": "depth", "x": 0.5, "y": 0.5})):
        page.say({"t": "ask", **question})
        kept[name] = page.receive_text(question["what"])
    for pane, axis in enumerate("xyz", 1):
        page.say({"t": "ask", "what": "slice", "axis": axis, "index": 21,
                  "range": [0, 100], "pane": pane, "n": 1, "exact": True})
        kept["slice " + axis] = page.receive_small(pane)[32:]
    page.question("thumbnail", preset="ct-bone", pane=4)
    kept["thumbnail"] = len(page.receive_small(4)) > 500
    return kept


STATES = ({"size": [SIDE, SIDE]},
          {"azimuth": 40, "elevation": 10, "preset": "ct-bone"},
          {"clip": [[1, 0, 0, 4]], "zoom": 2.5, "perspective": 30},
          {"clip": [[1, 0, 0, -9], [0, 1, 1, 30]], "azimuth": 70},
          {"clip": None, "preset": None, "mode": "mip", "crop": [
              [10, 50], [0, 40], [5, 40]]},
          {"crop": None, "mode": "minip"})


MIXES = ({"size": [SIDE, SIDE]}, {"channel": "2:red:20..900,0:0.5"},
         {"channel": "1"}, {"channel": None, "clip": [[1, 0, 0, 8]]},
         {"mode": "mip"})


def channels():
    """Channels are mixed by all ranks, and slices by the first one."""
    place = os.path.join(FOLDER.name, "told.zarr")
    write_channels(place, True)
    many = Server(place, "-q", "--deterministic", tool=MANY)
    atexit.register(many.process.kill)
    page = Page(many)
    for n, state in enumerate(MIXES, 2):
        is_of_command(page, f"channels {n} are the picture of their command", n, **state)
    for colored in True, False:
        slice_is_of_command(page, f"a slice, colored: {colored}", axis="z",
                            index=11, colored=colored)
    page.rest(9, channel="0,2")
    os.kill(ranks_of(many)[0], signal.SIGINT)
    code, lines = end_of(many)
    check("a job with a channel switched off ends in order",
          code == 0 and not lines, f"{code} {lines}")


def same_as_one(exact):
    """Pictures are those of the command, and answers those of one process."""
    with_bits = ["--deterministic"] if exact else []
    many = start(*with_bits)
    pages = [Page(many)]
    infos = [pages[0].receive_text("info")]
    shown = pages[0].receive_picture(2)
    check("a picture of the first state", shown is not None)
    for n, state in enumerate(STATES, 2):
        shown = pages[0].rest(n, **state)
        wanted = run_command(pages[0].ask("command")["text"])
        check(f"state {n} is the picture of its command",
              shown == wanted if exact else is_near(shown, wanted),
              f"{len(shown)} {len(wanted)}")
    if not exact:
        one = Server(SMALL)
        pages.append(Page(one))
        infos.append(pages[1].receive_text("info"))
        for info in infos:
            info.pop("instance")  # each viewer has one
            check("movies are made by one process",
                  (info.pop("movies") is None) == (info is infos[0]), infos)
        check("all is told of the volume alike", infos[0] == infos[1], infos)
        for page in pages:
            page.rest(9, size=[SIDE, SIDE], mode="over", azimuth=25, elevation=10,
                      zoom=1.5, perspective=0, target=[1, 2, 3])
        told, wanted = answers(pages[0]), answers(pages[1])
        for name in wanted:
            check(f"{name} is answered alike", told[name] == wanted[name],
                  f"{told[name]} {wanted[name]}"[:400])
        one.stop()
    many.process.send_signal(signal.SIGTERM)
    many.process.communicate(timeout=180)


def seconds_of(process):
    with open(f"/proc/{process}/stat") as stat:
        words = stat.read().rpartition(")")[2].split()
    return (int(words[11]) + int(words[12])) / os.sysconf("SC_CLK_TCK")


def newest_and_rest():
    """The newest of many states is drawn; then nobody works; a signal to the
    first rank ends all in order."""
    server = start()
    page = Page(server)
    page.receive_picture(2)
    for n in range(2, 200):
        page.set(n, azimuth=n, size=[ SIDE, SIDE])
    check("the newest state is drawn", page.receive_picture(2, 199) is not None)
    check("and is what its command says", "199" in page.ask("command")["text"])
    page.set(200, zoom="large")
    said = page.receive_text("said")
    check("a wrong value is answered", said and "zoom" in said["text"], said)
    page.set(201, crop=[[0, 99], [0, 9], [0, 9]])
    said = page.receive_text("said")
    check("so is one that only the volume shows", said is not None)
    check("and pictures go on",
          page.rest(202, crop=None) is not None)
    ranks = ranks_of(server)
    before, begin = [seconds_of(rank) for rank in ranks], time.monotonic()
    time.sleep(2)
    shares = [(seconds_of(rank) - was) / (time.monotonic() - begin)
              for rank, was in zip(ranks, before)]
    print("       share of a processor while nothing changes:",
          " ".join(f"{share:.4f}" for share in shares))
    check("ranks that wait do not work", max(shares) < 0.05, shares)
    os.kill(ranks[0], signal.SIGINT)
    code, lines = end_of(server)
    check("a signal ends all ranks in order", code == 0 and not lines,
          f"{code} {lines}")


def memory_of(process, what):
    with open(f"/proc/{process}/status") as status:
        return next(int(line.split()[1]) for line in status
                    if line.startswith(what + ":"))


def histogram_in_place():
    """A histogram takes no copy of what a rank holds."""
    large = os.path.join(FOLDER.name, "large.raw")
    with open(large, "wb") as out:
        for z in range(320):
            out.write(bytes((x + z) & 255 for x in range(256)) * 256)
    server = Server(large, "--dims", "256x256x320", "--type", "uint8",
                    "--opacity", "0:0,255:0,256:1", "--range", "0,255", tool=MANY)
    atexit.register(server.process.kill)
    page = Page(server)
    page.receive_picture(2)
    ranks = ranks_of(server)
    for rank in ranks:
        with open(f"/proc/{rank}/clear_refs", "w") as peak:
            peak.write("5")  # begins the peak anew
    before = [memory_of(rank, "VmRSS") for rank in ranks]
    counts = page.ask("histogram")["counts"]
    more = [memory_of(rank, "VmHWM") - was for rank, was in zip(ranks, before)]
    check("each voxel is counted once", counts == [256 * 320] * 256, counts)
    check("and none is copied for it", max(more) < 2048, f"{more} KiB")
    server.process.send_signal(signal.SIGTERM)
    server.process.communicate(timeout=180)


def stopped_rank():
    """A rank that is stopped ends the job."""
    server = start("--timeout", "6")
    page = Page(server)
    page.receive_picture(2)
    time.sleep(7)
    check("a wait for pages is no fault", server.process.poll() is None)
    lost = ranks_of(server)[2]
    os.kill(lost, signal.SIGSTOP)
    page.set(2, azimuth=10)
    code, lines = end_of(server)
    check("a stopped rank ends the job", code not in (0, None), code)
    check("with one line that names it", len(lines) == 1 and
          f"rank 2 (process {lost}" in lines[0], lines)


def killed_rank():
    """So does one that is gone."""
    server = start("--timeout", "6")
    page = Page(server)
    page.receive_picture(2)
    os.kill(ranks_of(server)[1], signal.SIGKILL)
    code, _ = end_of(server)
    check("so does one that was killed", code not in (0, None), code)
    check("and the page is closed", page.closed_code() is not None)


def refused():
    """One message, and no rank is left."""
    for words, text in (((SMALL, "--mode", "wrong"), "--mode"),
                        ((os.path.join(FOLDER.name, "none.nrrd"),), "none.nrrd"),
                        ((SMALL, "--token-file", FOLDER.name), "token-file"),
                        (("-",), "standard input")):
        done = subprocess.run([*MANY, "serve", *words], capture_output=True,
                              text=True, timeout=180)
        lines = [line for line in done.stderr.splitlines()
                 if line.startswith("snowglass: ")]
        check(f"{text} is refused once", done.returncode and len(lines) == 1 and
              text in lines[0], done.stderr)
    done = subprocess.run([*MANY, "serve", "--help"], capture_output=True,
                          text=True, timeout=180)
    check("one help", done.returncode == 0 and
          done.stdout.count("--token-file") == 1, done.stdout)


end_of_wait = aside(stopped_rank, killed_rank)
refused()
same_as_one(True)
same_as_one(False)
channels()
newest_and_rest()
histogram_in_place()
end_of_wait()
finish()
