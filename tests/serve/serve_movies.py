"""Movies that a page orders: their bytes are those of the printed command, all pages see
how far one is, and nothing is left of one that nobody waits for."""
import glob
import os
import resource
import shlex
import subprocess
import tempfile
import time

from viewer_client import PATIENCE, TOOL, Page, Server, aside, check, finish
from volumes import dated

HEAD = "phantom:head", "--dims", "48x40x36"
ALONE = 20  # seconds, serve/movies/job.h
work = tempfile.TemporaryDirectory(prefix="snow-movies-")
has_ffmpeg = subprocess.run(["sh", "-c", "command -v ffmpeg"], capture_output=True).returncode == 0


def server(*arguments, **how):
    """A viewer whose private folders are made in one of its own."""
    place = tempfile.mkdtemp(dir=work.name)
    made = Server(*arguments, env={**os.environ, "TMPDIR": place, **how.pop("env", {})}, **how)
    made.place = place
    return made


def left(viewer):
    """What its movies have left on the disk, and running."""
    ended = subprocess.run(["pgrep", "-f", viewer.place], capture_output=True, text=True)
    return os.listdir(viewer.place) + ended.stdout.split()


def gone(viewer, seconds=PATIENCE):
    end = time.monotonic() + seconds
    while left(viewer) and time.monotonic() < end:
        time.sleep(0.05)
    return not left(viewer)


def order(page, **asked):
    page.question("movie", **{"size": [64, 48], "format": "webp", "frames": 5, "overwrite": True, **asked})


def until(page, *states, seen=None):
    """The first message of one of these states."""
    while (message := page.receive_text("movie")) is not None:
        if seen is not None:
            seen.append(message)
        if message["state"] in states:
            return message
    return {"state": "closed", "text": ""}


def told(page):
    return page.receive_text("said")["text"]


def fetch(viewer, **headers):
    return viewer.get("/movie", x_auth_token=viewer.token, **headers)


def run(command, name):
    """The bytes that the printed command writes, in a folder of its own."""
    place = tempfile.mkdtemp(dir=work.name)
    words = shlex.split(command)
    words[words.index("--output") + 1] = os.path.join(place, name)
    subprocess.run([TOOL, *words[1:], "-q"], check=True, cwd=work.name)
    with open(os.path.join(place, name), "rb") as made:
        return made.read()


def steps():
    name = os.path.join(work.name, "steps.nc")
    dated(name, 4)
    return name


def frames_of(data):
    """Decoded, so that a difference of the container alone is told apart."""
    done = subprocess.run(["ffmpeg", "-v", "error", "-i", "pipe:0", "-f", "framemd5", "-"],
                          input=data, capture_output=True)
    return [line.split(b",")[-1].strip() for line in done.stdout.splitlines() if line[:1] != b"#"]


def is_of_the_command():
    viewer = server(*HEAD)
    page, other = Page(viewer), Page(viewer)
    offer = page.receive_text("info")["movies"]
    check("what can be ordered is offered", ("mp4" in offer["formats"]) == has_ffmpeg and
          bool(offer["note"]) != has_ffmpeg, offer)
    page.rest(1, size=[64, 48], azimuth=30, preset="ct-bone", colormap="hot")
    for kind in ["webp", "mp4"] if has_ffmpeg else ["webp"]:
        asked = {"size": [64, 48], "format": kind, "frames": 5, "fps": 10}
        command = page.ask("movie-command", **asked)["text"]
        check(f"the command has what was ordered ({kind})",
              all(each in command for each in ("turntable", "--frames 5", "--fps 10",
                                               "--azimuth 30", f"head.{kind}")), command)
        order(page, **asked, tag="mine")
        seen = []
        done = until(page, "done", "failed", seen=seen)
        check("the movie is written", done["state"] == "done" and done["tag"] == "mine", done)
        check("and was begun before", seen[0]["state"] == "writing" and
              seen[0]["frames"] == 5, seen)
        check("another page sees it too", until(other, "done")["name"] == f"head.{kind}")
        status, headers, data = fetch(viewer)
        check("it is fetched whole", status == 200 and len(data) == done["bytes"] and
              int(headers["content-length"]) == done["bytes"], (status, headers))
        again = run(command, f"head.{kind}")
        check(f"with the bytes of its command ({kind})", data == again, (len(data), len(again)))
        if has_ffmpeg and kind == "mp4":
            check("and as many frames", len(frames_of(data)) == 5, frames_of(data))
    order(page, overwrite=False)
    text = told(page)
    check("nothing takes its place without a word", "one is written already" in text and fetch(viewer)[2] == data, text)
    late = Page(viewer)
    check("a page that comes later knows of it", until(late, "done")["state"] == "done")
    late.question("movie-cancel")
    check("and can take it away", until(page, "none")["state"] == "none")
    check("from the disk, too", gone(viewer), left(viewer))
    check("so that nobody has it", fetch(viewer)[0] == 404)
    for each in page, other, late:
        each.close()
    viewer.stop()


def is_of_steps():
    viewer = server(steps())
    page = Page(viewer)
    page.rest(1, size=[64, 48], time=1, measure="line 2,2,2 12,9,8; ellipse z 6 9,8 4 3")
    texts = page.ask("times")["texts"]
    check("steps have their dates", texts == [f"2000-01-01 {6 * t:02}:00" for t in range(4)], texts)
    asked = {"kind": "movie", "first": 1, "last": 3, "fps": 25, "size": [64, 48], "format": "webp"}
    command = page.ask("movie-command", **asked)["text"]
    check("the command is that of steps", "snowglass movie " in command and
          "--time 1:4" in command and "--fps 25" in command, command)
    page.question("movie", **asked)
    done = until(page, "done", "failed")
    check("steps are written", done["state"] == "done" and done["frames"] == 3, done)
    check("with the bytes of their command", fetch(viewer)[2] == run(command, "steps.webp"))
    page.close()
    viewer.stop()
    check("the end of the viewer leaves nothing", not left(viewer), left(viewer))


SLOW = {"frames": 3600, "size": [640, 480], "format": "webp"}


def is_cancelled():
    viewer = server(*HEAD)
    page, other = Page(viewer), Page(viewer)
    page.rest(1, size=[64, 48])
    order(page, **SLOW)
    check("how far it is comes", until(page, "writing")["state"] == "writing")
    while not until(page, "writing")["frame"]:
        pass
    order(other, frames=2)
    check("a second one is refused meanwhile", "one is being written" in told(other))
    begin = time.monotonic()
    page.rest(2, azimuth=20)
    check("pictures go on", time.monotonic() - begin < PATIENCE / 4, time.monotonic() - begin)
    other.question("movie-cancel")
    check("another page can cancel", until(page, "cancelled", "done")["state"] == "cancelled")
    check("nothing is left of it", gone(viewer), left(viewer))
    order(page)
    check("and the next one is written", until(page, "done", "failed")["state"] == "done")
    order(page, **SLOW)
    until(page, "writing")
    page.close()
    other.close()
    viewer.stop()
    check("a viewer that ends amid one leaves nothing", not left(viewer), left(viewer))


def is_left_alone():
    viewer = server(*HEAD)
    page = Page(viewer)
    order(page, **SLOW)
    until(page, "writing")
    page.close()
    time.sleep(2)
    check("a page that is loaded again keeps its movie", bool(left(viewer)))
    check("without any page nothing is left", gone(viewer, ALONE + PATIENCE), left(viewer))
    page = Page(viewer)
    check("and who comes later hears so", until(page, "cancelled", "none")["state"] != "done")
    page.close()
    viewer.stop()


def is_killed():
    """The tool ends with a viewer that is killed, and the next one sweeps."""
    viewer = server(*HEAD)
    page = Page(viewer)
    order(page, **SLOW)
    until(page, "writing")
    viewer.process.kill()
    viewer.process.wait()
    end = time.monotonic() + PATIENCE
    while any(each.isdigit() for each in left(viewer)) and time.monotonic() < end:
        time.sleep(0.1)
    check("the tool ends with a viewer that is killed", not any(each.isdigit() for each in left(viewer)))
    for folder in glob.glob(os.path.join(viewer.place, "*")):
        os.utime(folder, (time.time() - 120,) * 2)
    following = Server(*HEAD, env={**os.environ, "TMPDIR": viewer.place})
    page = Page(following)
    order(page)
    until(page, "done")
    check("the next one takes away what it left", len(os.listdir(viewer.place)) == 1, os.listdir(viewer.place))
    page.close()
    following.stop()


def is_too_large():
    """A disk that is full, as a limit on files is for the tool; a folder that is not there."""
    def limit():
        resource.setrlimit(resource.RLIMIT_FSIZE, (4096, 4096))
    viewer = server(*HEAD, preexec_fn=limit)
    page = Page(viewer)
    order(page, frames=3, size=[320, 240])
    failed = until(page, "failed", "done")
    check("a full disk is said", failed["state"] == "failed" and "too large" in failed["text"] and
          "make space" in failed["text"] and viewer.place not in failed["text"], failed)
    check("and nothing is left", gone(viewer), left(viewer))
    order(page, frames=1)
    done = until(page, "done", "failed")
    check("a small one has room", done["state"] == "done", done)
    os.rename(viewer.place, viewer.place + "_")
    order(page)
    text = told(page)
    check("a folder that is not there is said", "TMPDIR" in text and viewer.place in text, text)
    os.rename(viewer.place + "_", viewer.place)
    check("and keeps the movie before", len(fetch(viewer)[2]) == done["bytes"])
    page.close()
    viewer.stop()


def is_without_ffmpeg():
    viewer = server(*HEAD, env={"PATH": work.name})
    page = Page(viewer)
    offer = page.receive_text("info")["movies"]
    check("without ffmpeg the rest is offered, and why", offer["formats"] in (["webp"], []) and
          "ffmpeg" in offer["note"], offer)
    order(page, format="mp4", frames=2)
    failed = until(page, "failed", "done")
    check("and it is said of others", failed["state"] == "failed" and "ffmpeg was not found" in failed["text"], failed)
    check("whose frames are not kept", gone(viewer), left(viewer))
    page.close()
    viewer.stop()


WRONG = [
    ({"frames": 0}, "frames"), ({"frames": 3601}, "frames"), ({"frames": 1.5}, "frames"),
    ({"frames": "9"}, "frames"), ({"fps": 0}, "fps"), ({"fps": 1e9}, "fps"), ({"fps": "a"}, "fps"),
    ({"size": [0, 9]}, "size"), ({"size": [99999, 9]}, "size"), ({"size": "9x9"}, "size"),
    ({"size": [4096, 4096], "frames": 3600}, "too many"), ({"format": "../x"}, "format"),
    ({"format": 7}, "format"), ({"kind": "render"}, "kind"), ({"kind": None}, "kind"),
    ({"kind": "movie", "frames": None}, "one time step"), ({"first": 0}, "first"),
    ({"overwrite": 1}, "overwrite"), ({"tag": "x" * 40}, "tag"), ({"tag": 4}, "tag"), ({"output": "/tmp/x.mp4"}, "output"),
    ({"resume": True}, "resume"), ({"'; touch x; '": 1}, "not known")]


def is_checked():
    viewer = server(*HEAD)
    page = Page(viewer)
    page.rest(1, size=[64, 48])
    for asked, word in WRONG:
        for what in "movie", "movie-command":
            page.question(what, **{"size": [64, 48], **asked})
            text = told(page)
            check(f"{what} {asked}", text.startswith("movie: ") and word in text, text)
    many = Server(steps())
    other = Page(many)
    for asked in {"first": 3, "last": 1}, {"first": -1}, {"last": 4}, {"frames": 3}:
        other.question("movie", kind="movie", size=[64, 48], **asked)
        check(f"steps {asked}", told(other).startswith("movie: "))
    other.close()
    many.stop()
    check("nothing was begun", not left(viewer), left(viewer))
    order(page, title=1)
    told(page)
    page.set(2, title="it's \"$(touch x)\"; `id` --output y")
    order(page)
    done = until(page, "done", "failed")
    check("quotes of a title stay its own", done["state"] == "done" and fetch(viewer)[2] == run(
        page.ask("movie-command", size=[64, 48], format="webp", frames=5)["text"], "head.webp"), done)
    page.set(3, title="--output")
    order(page, frames=1)
    done = until(page, "done", "failed")
    check("a title is no option", done["state"] == "done", done)
    guarded(viewer)
    page.close()
    viewer.stop()


def guarded(viewer):
    """The movie is for who has the secret, under the names of the viewer alone."""
    check("no secret, no movie", viewer.get("/movie")[0] == 403)
    for token in "", "0" * len(viewer.token), viewer.token[:-1], viewer.token + "0", "x" * 4000:
        check(f"a wrong one: {token[:40]}", viewer.get("/movie", x_auth_token=token)[0] in (403, 400))
    check("nor in its address", viewer.get(f"/movie?token={viewer.token}")[0] == 403)
    check("another name is refused", fetch(viewer, host="evil.example")[0] == 421)
    check("as is another method", viewer.get("/movie", method="POST", x_auth_token=viewer.token)[0] in (405, 400))
    check("a proxy may put a path before it",
          viewer.get("/proxy/8000/movie", x_auth_token=viewer.token)[0] == 200)
    headers = fetch(viewer)[1]
    check("it stays in no cache", headers["cache-control"] == "no-store" and
          headers["x-content-type-options"] == "nosniff", headers)


rest = aside(is_left_alone)
is_of_the_command()
is_of_steps()
is_cancelled()
is_killed()
is_too_large()
is_without_ffmpeg()
is_checked()
rest()
finish()
