"""The viewer's door: who is refused, and that nobody keeps others out."""
import glob
import json
import os
import re
import socket
import stat
import struct
import subprocess
import sys
import tempfile
import time

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, HERE)
from viewer_client import (PATIENCE, SANITIZED, SHORT, THREADS, TOOL, Page, Server, ThinLink,
                           aside, check, drag_over, finish, is_of_command, page_comes,
                           run_command, slice_is_of_command, viewer)

FOLDER = tempfile.TemporaryDirectory()
os.chdir(FOLDER.name)
SMALL = os.path.join(FOLDER.name, "small.nrrd")
SIDE = 96
subprocess.run([TOOL, "phantom", "head", "--dims", "48x48x48", "-o", SMALL],
               check=True, capture_output=True)


def texts_of_web():
    """Texts with blanks, which the page's packing could take for code."""
    found = []
    quoted = re.compile(r"""'(?:[^'\\]|\\.)*'|"(?:[^"\\]|\\.)*"|`(?:[^`\\]|\\.)*`""")
    for path in glob.glob(os.path.join(HERE, "../../web/**/*.js"), recursive=True):
        with open(path, encoding="utf-8") as file:
            text = re.sub(r"(?s)/\*.*?\*/", "", file.read())
        for line in re.sub(r"(?m)^\s*//.*| // [^'\"`]*$", "", text).splitlines():
            for each in quoted.findall(line):
                code = r"\$\{[^}]*\}" if each[0] == "`" else "$^"
                found += [part for part in re.split(code, each[1:-1])
                          if " " in part and "${" not in part]
    return found


def pages(server):
    status, headers, body = server.get("/")
    check("the page", status == 200 and b"<script type" in body, status)
    policy = headers.get("content-security-policy", "")
    for word in ("default-src 'none'", "script-src 'self'", "base-uri 'none'",
                 "frame-ancestors 'none'", "form-action 'none'"):
        check(f"the policy has {word}", word in policy, policy)
    check("nothing unsafe is in the policy", "unsafe" not in policy, policy)
    for name, value in (("x-content-type-options", "nosniff"),
                        ("x-frame-options", "DENY"),
                        ("referrer-policy", "no-referrer"),
                        ("cross-origin-opener-policy", "same-origin"),
                        ("cross-origin-embedder-policy", "require-corp"),
                        ("cross-origin-resource-policy", "same-origin"),
                        ("cache-control", "no-store")):
        check(f"{name} is {value}", headers.get(name) == value, headers)
    check("no cookie", "set-cookie" not in headers)
    check("no style or script in the page",
          not re.search(rb"style=|<style|onclick|<script>", body))
    status, headers, packed = server.get("/viewer.js", Accept_Encoding="gzip")
    check("a module is packed", headers.get("content-encoding") == "gzip")
    plain = server.get("/a/prefix/viewer.js")[2]
    check("and is the same under a prefix", len(plain) > len(packed) and
          b"snowglass.1" in plain)
    missing = [text for text in texts_of_web() if text not in plain.decode()]
    check("its texts are those of the modules", not missing, missing)
    status = server.get("/viewer.js", If_None_Match=headers["etag"])[0]
    check("it is not sent again", status == 304, status)
    check("HEAD has no body", server.get("/", method="HEAD")[2] == b"")


def embedded():
    """Frames are for the pages of one origin, and of two."""
    for origins in ("https://hub.example.org", "http://a:8888,https://b.org"):
        server = Server(SMALL, "--embed", origins)
        for path in ("/", "/viewer.js", "/no-such-page"):
            headers = server.get(path)[1]
            policy = headers.get("content-security-policy", "")
            check(f"with --embed {origins} {path} has them alone as ancestors",
                  policy.endswith("; frame-ancestors " +
                                  origins.replace(",", " ")) and
                  "script-src 'self'" in policy and "'none'" in policy, policy)
            check("and no other header forbids a frame",
                  "x-frame-options" not in headers and
                  "cross-origin-opener-policy" not in headers and
                  headers["cross-origin-resource-policy"] == "cross-origin",
                  headers)
        for origin in origins.split(","):
            check(f"a page of {origin} itself opens no WebSocket",
                  not Page(server, origin=origin).is_open)
        check("the viewer's own page does", Page(server).is_open)
        server.stop()


def strangers(server):
    """tests/serve/test_guard.c has all names, origins and secrets that are refused."""
    for host in ("evil.org", f"127.0.0.1:{server.port + 1}"):
        status = server.get("/", host=host)[0]
        check(f"host {host} is refused", status == 421, status)
        check(f"host {host} opens no WebSocket",
              not Page(server, host=host, origin=f"http://{host}").is_open)
    check("localhost is no stranger",
          server.get("/", host=f"localhost:{server.port}")[0] == 200)
    for origin in ("", "http://evil.org"):
        check(f"origin '{origin}' is refused",
              not Page(server, origin=origin).is_open)
    for path in ("/", "/viewer.js", "/wsx", "/ws/x"):
        check(f"path {path} opens no WebSocket",
              not Page(server, path=path).is_open)
    for protocol in ("", "snowglass.2", "http", "door"):
        check(f"protocol '{protocol}' is refused",
              not Page(server, protocol=protocol).is_open)
    code = Page(server, token=server.token[:-1]).closed_code()
    check("another secret is refused", code == 4401, code)


def odd_requests(server):
    for path in ("/..%2f..%2fetc/passwd", "/../../etc/passwd", "/etc/passwd", "/index.html/x", "/viewer.js%00",
                 "//etc/passwd", "/serve", "/x"):
        try:
            status, _, body = server.get(path)
        except Exception as refused:  # closed without an answer
            status, body = 0, str(refused).encode()
        check(f"{path} is no page", status in (0, 400, 403, 404) and
              b"root:" not in body, status)
    for method in ("POST", "PUT", "DELETE", "OPTIONS", "TRACE", "NONSENSE"):
        try:
            status = server.get("/", method=method)[0]
        except Exception:
            status = 0
        check(f"{method} is refused", status in (0, 400, 403, 404, 405), status)


def odd_messages(server):
    """Each ends its own connection, and nothing else.  tests/serve/test_message.c has
    all texts that are refused."""
    cases = {
        "a frame of 2^63 bytes": lambda p: p.send_frame(0x81, b"xxxx",
                                                        length=1 << 63),
        "no mask": lambda p: p.send_frame(0x81, b"{}", mask=False),
        "a binary message": lambda p: p.send_frame(0x82, b"{}"),
        "a reserved bit": lambda p: p.send_frame(0xC1, b"{}"),
        "an unknown opcode": lambda p: p.send_frame(0x83, b"{}"),
        "what is no JSON": lambda p: p.say(b"{]"),
        "pieces without an end": lambda p: [
            p.send_frame(0x01 if i == 0 else 0x00, b"x" * 8192)
            for i in range(10)],
    }
    for name, say in cases.items():
        page = Page(server)
        page.receive_text("info")
        say(page)
        check(f"{name} closes", page.closed_code() is not None)
    page = Page(server, hello=False)
    page.set(1)
    check("what comes before hello closes", page.closed_code() == 4401)
    page = Page(server)
    page.receive_text("info")
    page.set(1, zoom="large", preset=7)
    said = page.receive_text("said")
    check("a wrong value is answered", said and "zoom" in said["text"], said)
    for n, time_of in enumerate(("2:4", "0.3s"), 2):
        page.set(n, time=time_of)
        said = page.receive_text("said")
        check(f"so is time {time_of}", said and '"time"' in said["text"], said)
    page.set(4, time="last")
    check("the last step is taken", page.receive_picture(2, 4) is not None)
    for odd, name in (({"t": "set", "step": 5, "keys": {
            "mask": "/etc/passwd", "input": "/etc/passwd", "elevation": 11}}, "mask, input"),
                      ({"t": "set", "keys": {}}, "set: "), ({"t": "turn"}, "kind"),
                      ({"t": "ask", "what": 7}, "ask: ")):
        page.say(odd)
        said = page.receive_text("said")
        check(f"what a page cannot say is named and left out: {name}",
              said and name in said["text"], said)
    state = Page(server).receive_text("state")["keys"]
    check("the rest is taken, and no file", state["elevation"] == 11 and
          not {"mask", "input"} & set(state), state)
    page.question("nothing")
    check("and so is a wrong question", page.receive_text("said") is not None)
    page.close()


def crowds(server):
    count = 200 if SHORT else 1000
    idle = []
    for _ in range(count):
        idle.append(server.connect())
    page_comes(server, f"{count} idle connections")
    page = Page(server)
    check("and a WebSocket is opened", page.receive_text("info") is not None)
    files = server.files()
    check(f"few stay open: {files} files", files < 110, files)
    page.close()
    for each in idle:
        each.close()


def slow_ones(server):
    """No hello, a header byte by byte; half a header: serve_hostile.py."""
    silent, begin = Page(server, hello=False), time.monotonic()
    code = silent.closed_code()
    check("no hello closes after 2 s", code == 4408 and
          1.5 < time.monotonic() - begin, code)
    drops, closed = server.connect(), False
    drops.sendall(b"GET / HTTP/1.1\r\nX-Slow: ")
    end = time.monotonic() + PATIENCE
    while time.monotonic() < end and not closed:
        try:
            drops.sendall(b"X")
            time.sleep(0.2)
            drops.setblocking(False)
            closed = drops.recv(1) == b""
        except BlockingIOError:
            pass
        except OSError:
            closed = True
        finally:
            drops.setblocking(True)
    check("a header byte by byte is closed", closed)


def many_pages(server):
    """A page that takes nothing slows no other, and the 33rd is one too many."""
    fast, slow = Page(server), Page(server)
    fast.set(1, size=[SIDE, SIDE])
    check("the first picture", fast.receive_picture(2) is not None)
    seen = 0
    for n in range(2, 42):  # the slow one acknowledges nothing
        fast.set(n, azimuth=n)
        seen += fast.receive_picture(0, n, 10) is not None
    check(f"each of 40 changes is seen beside a slow page: {seen}", seen == 40)
    state = slow.receive_text("state")
    check("the other page learns of changes", state is not None)
    last = None
    slow.say({"t": "ack", "n": 0})
    slow.say({"t": "ack", "n": 0})
    while last is None or last["keys"].get("azimuth") != 41:
        last = slow.receive_text("state")
        if last is None:
            break
    check("and sees the newest state", last is not None)
    others = [Page(server) for _ in range(30)]
    for page in others:
        page.receive_text("info")
    check("the 33rd page is refused", Page(server).closed_code() == 4429)
    for page in [*others, slow]:
        page.socket.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER,
                               struct.pack("ii", 1, 0))  # as a kill -9
        page.close()
    fast.set(50, azimuth=0)
    check("the rest is served on", fast.receive_picture(0, 50) is not None)
    fast.close()


def floods(server):
    """Sets faster than pictures: the newest wins, and none is kept."""
    count = 300 if SHORT else 10000
    page = Page(server)
    page.receive_text("info")
    before = server.kilobytes()
    for n in range(1, count + 1):
        page.set(n, azimuth=n % 360, size=[SIDE, SIDE])
    check(f"after {count} changes the newest is shown",
          page.receive_picture(2, count) is not None)
    more = server.kilobytes() - before
    check(f"which took {more} kB", more < 30000 or SANITIZED, more)
    page.close()


def same_bytes(server, recipe):
    """The picture at rest is the file of the copied command."""
    page = Page(server)
    is_of_command(page, f"{recipe} has the bytes of its command", 7,
                  **{"size": [SIDE, SIDE + 10], **recipe})
    page.close()


def crop_and_back(server):
    """A crop keeps the object's size; a step back names its zoom itself."""
    page = Page(server)
    before = page.receive_text("state")["keys"]
    page.set(1, crop=[[12, 36], [12, 36], [12, 36]])
    cropped = page.receive_text("state")["keys"]
    check("a crop keeps the scale", cropped["zoom"] < 0.8 * before["zoom"],
          f"{before['zoom']} {cropped['zoom']}")
    page.rest(2, crop=None, zoom=before["zoom"], target=before["target"])
    page.close()
    page = Page(server)
    now = page.receive_text("state")["keys"]
    check("a step back has its own zoom", now["zoom"] == before["zoom"],
          f"{before['zoom']} {now['zoom']}")
    page.close()


def two_at_once(server):
    """Both pages learn of both changes, and which of their own are in a state."""
    one, other = Page(server), Page(server)
    for page in (one, other):
        page.receive_text("state")
    for n in range(1, 30):
        one.set(n, azimuth=n)
        other.set(100 + n, elevation=n)
    for page, own, key, last in ((one, "azimuth", "elevation", 29),
                                 (other, "elevation", "azimuth", 129)):
        state = {"keys": {}}
        while state and state["keys"].get(key) != 29:
            state = page.receive_text("state")
        check(f"the other's {key} arrives", state is not None)
        if state:
            base = 100 if own == "elevation" else 0
            check(f"its n is that of its {own}",
                  state["step"] in (0, base + state["keys"].get(own, 0)), state)
    one.set(77, zoom="wrong")
    state = one.receive_text("state")
    while state and state["step"] != 77:
        state = one.receive_text("state")
    check("a refused change counts as heard", state is not None)
    one.close()
    other.close()


def first_state():
    """What a page sets at once is not lost, nor its first state another one."""
    server = Server("phantom:head", "--dims", "64x64x64")
    page = Page(server)
    page.set(1, zoom=3.5)
    begin = page.receive_text("state")["keys"]
    check("the first state is framed", "target" in begin, begin)
    page.receive_picture(2, 1)
    page.close()
    page = Page(server)
    now = page.receive_text("state")["keys"]
    check("a zoom that is set at once stays", now["zoom"] == 3.5, now)
    page.close()
    server.stop()


def thumbnails_wait(server):
    """They come when the picture is final, and no change waits for them."""
    page = Page(server)
    page.set(1, azimuth=3)
    for pane in range(4, 12):
        page.question("thumbnail", preset="ct-bone", pane=pane)
    page.question("command")
    kinds = []
    while len([kind for kind in kinds if kind == "small"]) < 8:
        what, message = page.hear()
        if what == "closed":
            break
        if what == "text" and message["t"] == "command":
            kinds.append("command")
        elif what == "picture" and message[10]:
            kinds.append("small")
        elif what == "picture":
            got, = struct.unpack("<I", message[4:8])
            page.say({"t": "ack", "n": got})
            if got == 1:
                kinds.append(message[8])
    first = kinds.index("small") if "small" in kinds else 0
    check("thumbnails come after pictures and other answers",  # the final one
          {"command", 0, 1} <= set(kinds[:first]), kinds)  # is packed meanwhile
    for pane in range(4, 12):
        page.question("thumbnail", preset="ct-bone", pane=pane)
    page.question("command")
    smalls = 0
    while True:
        what, message = page.hear()
        if what == "closed" or what == "text" and message["t"] == "command":
            break
        smalls += what == "picture" and message[10] > 0
    check("a command does not wait for thumbnails", smalls < 4, smalls)
    page.set(2, azimuth=4)
    for preset in ("ct-bone", "ct-soft") * 150:  # the newest of a pane is made
        page.question("thumbnail", preset=preset, pane=4)
    page.question("command")
    texts = []
    while not texts or texts[-1]["t"] not in ("closed", "command"):
        what, message = page.hear()
        if what == "closed":
            texts.append({"t": what})
        elif what == "text":
            texts.append(message)
    check("thumbnails of a pane that change do not add up", not [
        each for each in texts if "too many" in each.get("text", "")],
        texts[-1])
    page.close()


def answers_first():
    """No answer waits for a large picture at rest, which comes all the same."""
    with viewer("phantom:engine") as page:
        side = 1000 if SANITIZED else 3000
        for n in range(1, 9):  # on a busy machine this page may ask too late
            page.set(n, size=[side, side], azimuth=n)
            page.receive_picture(1, n)
            time.sleep(0.1)  # the picture of quality high is under way
            page.question("value", at=[1, 2, 3])
            kinds = []
            while "value" not in kinds:
                what, message = page.hear()
                kinds.append(message["t"] if what == "text" else what)
            if "figures" not in kinds:
                break
        check("an answer comes before the picture at rest",
              "figures" not in kinds, kinds)
        check("which comes then", page.receive_picture(2, n) is not None)


def movie_command():
    """The turn begins with the picture at rest."""
    with viewer(SMALL) as page:
        shown = page.rest(1, azimuth=20, preset="ct-bone", size=[SIDE, SIDE])
        text = page.ask("movie-command")["text"]
        check("a movie's first picture is the one at rest",
              text.startswith("snowglass turntable ") and
              run_command(text, "--frames", "2", out="f_%d.png") == shown, text)
        check("it is a movie", "--output small.mp4" in text, text)


def thumbnails(server):
    """The picture of a preset is the same in every mode."""
    page = Page(server)
    seen = []
    for n, mode in enumerate(("over", "mean", "sum"), 1):
        page.rest(n, mode=mode, size=[SIDE, SIDE], background="#000000")
        page.question("thumbnail", preset="ct-bone", pane=4)
        seen.append(page.receive_small(4)[32:])
    check("a thumbnail is painted in all modes", seen[1:] == seen[:1] * 2,
          [len(each) for each in seen])
    page.set(9, mode="over", size=None, background=None)
    page.close()


def fit_at_position():
    with viewer(SMALL, "--position", "200,10,20") as page:
        page.receive_text("state")
        page.question("fit")
        said = page.receive_text("said")
        check("what cannot be framed is told", said and "position" in said["text"],
              said)


def looks_until(page, kind, n=0):
    """The looks that come before a text of a kind, or before picture n; and that."""
    looks = []
    while True:
        what, message = page.hear()
        if what == "closed":
            sys.exit(f"FAILED to hear {kind}: the page was closed")
        if what == "picture" and not message[10]:
            page.say({"t": "ack", "n": n})
            if message[4:8] == struct.pack("<I", n):
                return looks, message[32:]
        elif what == "text" and message["t"] == kind:
            return looks, message
        elif what == "text" and message["t"] == "look":
            looks.append(message)


def colors_of(jpeg):
    """How many: what begins a baseline frame says so."""
    return jpeg[jpeg.index(b"\xff\xc0") + 9]


def dragged_points(more, grey):
    """A point that is dragged takes the colours of the look before, as the look
    that is made anew has them; that is made when the picture rests.  A side of 64
    is that of the smallest draft: none is smaller."""
    with viewer(SMALL, *more) as page:
        n = 1
        points = page.receive_text("look")["opacity"]
        moved = [[value, min(1, 2 * opacity)] for value, opacity in points]
        page.say({"t": "moving", "on": True})

        def draft(**recipe):
            nonlocal n
            n += 1
            page.set(n, **recipe)
            looks, picture = looks_until(page, "", n)
            page.question("command")
            return picture, looks + looks_until(page, "command")[0]

        draft(size=[64, 64], opacity=points)
        quick, looks = draft(opacity=moved)
        check("a dragged point makes no new look", not looks, looks)
        hot = draft(colormap="hot")[0]
        anew, looks = draft(colormap=None)
        check("its picture is that of a look made anew", looks and anew == quick)
        check("only a picture in colours is packed in colours",
              (colors_of(anew), colors_of(hot)) == (1 if grey else 3, 3))
        check("which has changed", draft(opacity=points)[0] != quick)
        draft(opacity=moved)
        page.say({"t": "moving", "on": False})
        look = page.receive_text("look")
        check("the picture at rest has a new look", look and
              "as requested" in look["text"] and
              look["opacity"] == moved, look)


def windows():
    """Pages of five sizes, of which the last one turns: in the end four have pictures
    of their own, those of their commands; the fifth has another's."""
    sizes = [[90, 70], [120, 80], [70, 100], [64, 64], [100, 100]]
    server = Server(SMALL)
    pages = [Page(server) for _ in sizes]
    for page, size in zip(pages, sizes):
        page.set(1, size=size)
    pages[3].set(2, azimuth=25)

    def rest(page):
        while True:
            what, message = page.hear()
            if what == "picture" and not message[10]:
                page.say({"t": "ack", "n": 0})
                if message[8] == 2:
                    yield list(struct.unpack("<2I", message[16:24])), message[32:]

    for page, size in list(zip(pages, sizes))[::-1]:
        want, command = size, None
        for shown, picture in rest(page):
            if size == sizes[0] and shown in sizes[1:]:
                break  # whoever came last is listed first
            if shown != want:
                continue
            command = page.ask("command")["text"]
            if "--azimuth 25" in command and run_command(command) == picture:
                break
        check(f"a page of {size} has a picture at rest", True)
        page.close()
    server.stop()


def histograms():
    """Voxels are counted between pictures, and once for all pages."""
    name, side = os.path.join(FOLDER.name, "counted.nrrd"), 200
    subprocess.run([TOOL, "convert", "phantom:head", "--dims", f"{side}x{side}x{side}",
                    "-o", name, "-y", "-q"], check=True)
    with open(name, "rb") as file:
        voxels = file.read().split(b"\n\n", 1)[1]
    server = Server(name)
    page = Page(server)
    page.rest(1, size=[64, 64])
    page.question("histogram", lo=0, hi=256)
    page.set(2, azimuth=10)
    order = []
    while "histogram" not in order:
        what, message = page.hear()
        order.append(message["t"] if what == "text" else what)
        if what == "picture":
            page.say({"t": "ack", "n": 0})
    check("pictures come between the voxels that are counted",
          "picture" in order, order)
    counts = message["counts"]
    check("each is counted in its bin", counts == [voxels.count(i) for i in range(256)])
    before = server.processor_seconds()
    again = Page(server).ask("histogram", lo=0, hi=256)
    took = server.processor_seconds() - before
    check("another page has the same at once", again["counts"] == counts and took < (
        0.5 if SANITIZED else 0.04), took)
    server.stop()


def replaced():
    """A file that is another one now is told of, and opened when a page says so."""
    name, out = (os.path.join(FOLDER.name, each) for each in ("moved.nrrd", "moved.png"))

    def write(side):
        run_tool = [TOOL, "convert", "phantom:shells", "--dims", f"{side}x32x32",
                    "-o", f"{name}.new.nrrd", "-y", "-q"]
        subprocess.run(run_tool, check=True)
        os.replace(f"{name}.new.nrrd", name)

    write(32)
    with viewer(name, "-q") as page:
        info = page.receive_text("info")
        page.rest(1, size=[64, 64])
        write(40)
        page.set(2, azimuth=10)
        told = page.receive_text("replaced")
        check("a file that was replaced is told of", told["again"] and not told["gone"], told)
        page.question("reopen")
        again = page.receive_text("info")
        check("and opened", again["dims"] == [40, 32, 32] and again["file"] != info["file"]
              and again["instance"] == info["instance"], again)
        for _ in range(4):
            page.say({"t": "ack", "n": 0})  # what came beside these texts
        shown, command = page.rest(3, azimuth=20), page.ask("command")["text"]
        check("it is what is shown", shown == run_command(command, out=out))
        os.remove(name)
        page.set(4, azimuth=30)
        told = page.receive_text("replaced")
        check("one that is gone cannot be opened", told["gone"] and not told["again"], told)


def recipe_file():
    """A recipe has what only the command line sets, so it makes the picture."""
    points = os.path.join(FOLDER.name, "points.json")
    with open(points, "w") as out:
        json.dump({"snowglass-tf": 1, "values": "data", "opacities": [[20 + i, i / 400] for i in range(300)]}, out)
    raw = os.path.join(FOLDER.name, "small.raw")
    with open(raw, "wb") as out:
        out.write(bytes(i % 48 * 5 for i in range(48 ** 3)))
    with viewer(raw, "--dims", "48x48x48", "--type", "uint8", "--tf", points) as page:
        shown = page.rest(1, azimuth=12, size=[SIDE, SIDE])
        page.question("thumbnail", preset="", pane=4)
        of_file = page.receive_small(4)
        page.question("thumbnail", preset="ct-bone", pane=4)
        check("the first thumbnail is there", of_file and
              of_file[32:] != page.receive_small(4)[32:])
        late = Page(page.server)
        look = late.receive_text("look")
        check("a look of many points says how many there are",
              look["count"] == 300 and len(look["opacity"]) == 256, look["count"])
        late.close()
        recipe = page.ask("recipe")
        path, out = (os.path.join(FOLDER.name, name)
                     for name in ("recipe.json", "recipe.png"))
        with open(path, "w") as file:
            file.write(recipe["text"])
        done = subprocess.run([TOOL, "render", "--config", path, "-o", out, "-q"],
                              capture_output=True, text=True)
        check("a saved recipe has the bytes of the picture", done.returncode == 0
              and open(out, "rb").read() == shown, done.stderr or recipe["text"])
    saved_paths(raw, points)


def saved_paths(raw, points):
    """They are relative to the volume's folder, where the file is to lie."""
    inner = os.path.join(FOLDER.name, "inner")
    os.makedirs(inner, exist_ok=True)
    elsewhere = os.path.join(inner, "points.json")
    with open(points) as given, open(elsewhere, "w") as out:
        out.write(given.read())
    about = ["--dims", "48x48x48", "--type", "uint8", "--tf"]
    for volume, look, wanted in (
            (raw, points, ["small.raw", "points.json"]),
            (raw, elsewhere, ["small.raw", "inner/points.json"]),
            (os.path.relpath(raw), os.path.relpath(elsewhere),
             ["small.raw", "inner/points.json"]),
            (os.path.relpath(raw), points, ["small.raw", points]),
            ("phantom:head", None, ["phantom:head", None])):
        with viewer(volume, *(about + [look] if look else [])) as page:
            tree = json.loads(page.ask("recipe")["text"])
            found = [tree.get("input"), tree.get("tf")]
            check(f"a recipe of {volume} leads from its folder", found == wanted,
                  found)


SLICES = [
    ({}, {"axis": "z", "index": 20, "range": [20, 180]}),
    ({"preset": "ct-bone"}, {"axis": "x", "index": 0, "range": [0, 250],
                             "colored": True}),
    ({"preset": "ct-bone", "clip": [[1, 0, 0, 3.5]]},
     {"axis": "coronal", "index": 47, "range": [-20.5, 99]}),
    ({"crop": [[4, 40], [0, 48], [10, 48]], "colormap": "viridis"},
     {"axis": "axial", "index": 11, "range": [0, 250], "colored": True}),
]


def slices():
    """They are the pictures of the verb slice, which has the same command."""
    with viewer(SMALL, "--kernel", "tent") as page:
        info = page.receive_text("info")
        check("the page hears where slices lie",
              sorted(each["along"] for each in info["slices"]) == [0, 1, 2] and
              all(sorted([each["along"], each["right"][0], each["down"][0]]) ==
                  [0, 1, 2] for each in info["slices"]), info["slices"])
        for n, (recipe, asked) in enumerate(SLICES, 1):
            page.rest(n, **{"preset": None, "clip": None, "crop": None, "colormap": None,
                            "size": [SIDE, SIDE], **recipe})
            moving = page.slice(**asked)
            check(f"slice {n} moves as JPEG", moving and moving[9] == 1 and
                  moving[32:34] == b"\xff\xd8", moving)
            exact = page.slice(**asked, exact=True)
            check(f"slice {n} rests as PNG, with its own n", exact and
                  exact[9] == 2 and struct.unpack("<I", exact[4:8]) == (7,))
            slice_is_of_command(page, f"slice {n} has the bytes of its command", **asked)
            command = page.ask("slice-command", **asked)["text"]
            check("which says the slice", f"--axis {asked['axis']}" in command and
                  f"--at {asked['index']}" in command, command)
        good = SLICES[3][1]
        for name, wrong in (("no axis", {"axis": "w"}), ("no range", {"range": []}),
                            ("an empty range", {"range": [3, 3]}),
                            ("a slice below", {"index": -1}),
                            ("a slice above", {"index": 38}),
                            ("a slice far above", {"index": 2 ** 62})):
            check(f"{name} is answered by none", page.slice(**{**good, **wrong}) is None)
        check("another comes after that", page.slice(**good))


def slices_in_little_memory():
    """They have the room of their command, also after a picture that had none."""
    flat = os.path.join(FOLDER.name, "flat.nrrd")
    subprocess.run([TOOL, "convert", "phantom:head", "--dims", "400x400x20",
                    "-o", flat, "-q"], check=True)
    with viewer(flat, "-q", "-j", "2", "--memory", "14M") as page:
        page.set(1, size=[64, 64])
        said = page.receive_text("said")["text"]
        check("the picture at rest has no room in 14M", "14.0 MiB" in said, said)
        for axis, index in ("z", 3), ("y", 200), ("x", 80):
            slice_is_of_command(page, f"a slice across {axis} has", "--memory", "14M",
                                axis=axis, index=index)


def one_channel():
    """A channel that the volume has not is refused as by `render`."""
    with viewer(SMALL, "-q") as page:
        page.set(1, size=[SIDE, SIDE], channel="5")
        said = page.receive_text("said")["text"]
        check("a channel that is not there is refused",
              "channel 5 does not exist; the voxels have 1" in said, said)
        state = page.receive_text("state")
        check("and not kept", state and "channel" not in state["keys"], state)


def mask_switch():
    """A page switches the mask of the command line, and never hears its path;
    the pictures are those of the commands."""
    mask = os.path.join(FOLDER.name, "secret-mask.raw")
    with open(mask, "wb") as out:
        for z in range(48):
            out.write(bytes((1 if x < 24 else 2) for x in range(48)) * 48)
    subprocess.run([TOOL, "convert", mask, "--dims", "48x48x48", "--type",
                    "uint8", "-o", mask + ".nrrd", "-q"], check=True)
    with viewer(SMALL, "--mask", mask + ".nrrd", "--labels", "1") as page:
        info = page.receive_text("info")
        check("a page hears of a mask, and which labels it keeps",
              info["mask"] is True and info["labels"] == "1", info)
        state = page.receive_text("state")["keys"]
        check("but not of its file", state["mask"] is True and
              "secret" not in json.dumps(state), state)
        shown = []
        for n, change in enumerate(({"size": [SIDE, SIDE]},
                                    {"mask": None, "labels": None},
                                    {"clip": [[1, 0, 0, 3.5]]},
                                    {"mask": True, "labels": "1", "clip": None}), 1):
            shown.append(is_of_command(page, f"mask {n}: the picture is its command's", n,
                                       **change))
            command = page.ask("command")["text"]
            check(f"mask {n}: which names the mask where it is used",
                  ("--mask" in command) == (n in (1, 4)), command)
        check("the mask is gone, and comes again", shown[0] == shown[3] and
              shown[0] != shown[1], "")
    with viewer(SMALL) as page:
        check("there is no mask without one",
              page.receive_text("info")["mask"] is False)
        page.set(1, mask=True, azimuth=5)
        check("and none to switch", page.receive_picture(2, 1) is not None)


def known_volume(name):
    """x + 2 z, nothing from z = 30 on; its options."""
    raw = os.path.join(FOLDER.name, name)
    with open(raw, "wb") as out:
        for z in range(48):
            out.write(bytes(x + 2 * z if z < 30 else 0
                            for x in range(48)) * 48)
    return raw, "--dims", "48x48x48", "--type", "uint8"


def newest_values():
    """Values and slices are of the newest state, also while an older one is
    drawn."""
    with viewer(*known_volume("newest.raw")) as page:
        page.rest(1, size=[1500, 1500])
        page.say({"t": "moving", "on": True})
        got, sizes = [], []
        for n in range(2, 14):
            page.set(n, crop=[[n, 48], [0, 48], [0, 48]])
            got.append(page.ask("value", at=[0, 0, 0])["value"])
            page.set(n, crop=[[n, 48], [0, 48], [0, 20 + n]])
            slice_ = page.slice(axis="y", index=0, range=[0, 100])
            sizes.append(struct.unpack("<I", slice_[20:24])[0])
        check("values are of the newest crop", got == list(range(2, 14)), got)
        check("slices too", sizes == list(range(22, 34)), sizes)


def nothing_to_slice():
    """Whoever waits for a slice hears that there is none, and why."""
    raw, *known = known_volume("gone.raw")
    with viewer(raw, *known) as page:
        page.socket.settimeout(20)
        asked = {"axis": "x", "index": 3, "range": [0, 100]}
        check("there is a slice at first", page.slice(**asked))
        os.rename(raw, raw + ".away")
        page.set(1, crop=[[4, 48], [0, 48], [0, 48]])
        line = page.receive_text("said")["text"]
        check("that a file is gone is said", "gone.raw" in line, line)
        check("it has no slice", page.slice(**asked) is None)
        check("nor a value", page.ask("value", at=[1, 2, 3])["value"] is None)
        page.question("histogram")
        check("nor a histogram", "There is no volume" in
              page.receive_text("said")["text"])
        os.rename(raw + ".away", raw)
        page.set(2, crop=[[5, 48], [0, 48], [0, 48]])
        check("it has one when it is back", page.slice(**asked))


def taken_back():
    """What only the volume shows to be wrong is said, and leaves the state."""
    with viewer(SMALL) as page:
        before = page.rest(1, size=[64, 48], azimuth=20)
        for n, wrong in enumerate(({"time": 7},
                                   {"crop": [[90, 99], [0, 9], [0, 9]]}), 2):
            page.set(n, **wrong)
            key, = wrong
            line = page.receive_text("said")["text"]
            recipe = page.receive_text("state")["keys"]
            check(f"a wrong {key} is said, and taken back", key not in recipe and
                  recipe["azimuth"] == 20 and recipe["size"] == [64, 48],
                  f"{line} {recipe}")
        after = page.rest(9, azimuth=21)
        check("what comes after is drawn", after and after != before)


def flood_of_slices(page, n):
    """More than wait at a time, fewer than a page may leave unread: how many are
    answered, by none, and as too many."""
    page.set(n, size=[3000, 3000 - n])
    for _ in range(150):
        page.question("slice", pane=2, n=9, axis="x", index=3, range=[0, 100])
    heard, none, full = 0, 0, 0
    while heard + none < 150:
        what, message = page.hear()
        if what == "closed":
            break
        if what == "text":
            none += message["t"] == "slice"
            full += "too many questions" in message.get("text", "")
        elif message[10] == 2:
            heard += 1
        else:
            page.say({"t": "ack", "n": 0})
    return heard, none, full


def too_many_slices():
    """Each is answered, also where no more questions can wait."""
    with viewer(SMALL) as page:
        for n in range(1, 10):  # a draft may be over before all are asked
            heard, none, full = flood_of_slices(page, n)
            if full or heard + none < 150:
                break
        check("each of too many slices is answered", heard + none == 150 and
              none == full > 0, f"{heard} {none} {full}")


def streamed_slices():
    """A volume that stays in its file has slices too."""
    big = os.path.join(FOLDER.name, "big.raw")
    with open(big, "wb") as out:
        for z in range(320):
            out.write(bytes((x + z) & 255 for x in range(256)) * 256)
    with viewer(big, "--dims", "256x256x320", "--type", "uint8", "--memory", "16M") as page:
        page.receive_text("info")
        for at, value in ([1, 2, 3], 4), ([255, 255, 319], 62), ([0, 0, 320], None):
            told = page.ask("value", at=at)
            check(f"the value at {at} in the file", told["value"] == value, told)
        for at in ([1, 2, 3], [1, 100, 7], [200, 9, 3], [200, 100, 3]):
            page.slice(axis="z", index=at[2], range=[0, 255])
            page.slice(axis="y", index=at[1], range=[0, 255])
        os.rename(big, big + "x")
        for at in ([1, 2, 3], [9, 7, 3], [4, 100, 200]):
            told = page.ask("value", at=at)
            check(f"the value at {at} is of a slice that is there",
                  told["value"] == at[0] + at[2], told)
        again = page.slice(axis="y", index=100, range=[0, 255], exact=True)
        check("which is not read again", again is not None)
        check("another one is", page.ask("value", at=[1, 3, 4])["value"] is None)
        said = page.receive_text("said")
        check("which is said to be gone", os.path.basename(big) in json.dumps(said), said)
        os.rename(big + "x", big)
        check("its voxels are not in memory", page.server.kilobytes("VmRSS") < 60000,
              page.server.kilobytes("VmRSS"))
        heard = []
        page.question("histogram", lo=0, hi=255)
        page.question("value", at=[1, 2, 3])
        while "value" not in heard:
            heard += [message["t"] for what, message in [page.hear()] if what == "text"
                      and os.path.basename(big) not in json.dumps(message)]
        check("it has no histogram, in silence", "said" not in heard and
              "histogram" not in heard, heard)
        slice_is_of_command(page, "a slice of a volume in its file has its command's "
                            "bytes", axis="y", index=100)


def values_and_depths():
    """Against a volume that is known, opaque below z = 30."""
    with viewer(*known_volume("known.raw"), "--opacity", "0:0,1:1", "--view", "+z",
                "--target", "23.5,23.5,23.5", "--fit", "volume") as page:
        page.rest(1, azimuth=0)
        for at, value in (([5, 40, 7], 19), ([47, 0, 29], 105), ([1, 1, 30], 0),
                          ([48, 0, 0], None), ([0, -1, 0], None),
                          ([0, 2 ** 62, 0], None)):
            got = page.ask("value", at=at)
            check(f"the value at {at} is {value}", got["value"] == value and
                  got["at"] == at, got)
        for n, fov in enumerate((0, 30), 2):
            page.rest(n, perspective=fov, size=[200, 100])
            got = page.ask("depth", x=0.55, y=0.45)
            check(f"the object is 6 mm before the target, at {fov} degrees",
                  abs(got["depth"] + 5.5) < 1.1, got)
            check("and nothing is in a corner",
                  page.ask("depth", x=0.02, y=0.05)["depth"] is None)
        page.rest(4, mode="mip")
        check("mode mip has no depth", page.ask("depth", x=0.5, y=0.5)["depth"] is None)


RECIPES = [
    {"azimuth": 33.5, "elevation": -12},
    {"preset": "ct-bone", "view": "left", "legend": True},
    {"preset": None, "mode": "mip", "colormap": "viridis", "legend": None},
    {"mode": "mean", "colormap": None},
    {"mode": "iso", "iso": 100, "perspective": 30},
    {"mode": "over", "iso": None, "perspective": 0,
     "opacity": [[40, 0], [90.5, 0.3], [200, 0.9]]},
    {"clip": [[1, 0, 0, 3.5], [0, 0, -1, 8]], "shade": "none"},
    {"crop": [[4, 40], [0, 48], [10, 48]], "clip": None, "shade": None},
    {"crop": None, "range": ["p2", "p98"], "opacity": None, "threshold": 10},
    {"range": None, "threshold": 0, "light": "head", "occlusion": 0.5,
     "gradient-opacity": [[0, 0], [30, 1]]},
    {"gradient-opacity": None, "background": "#336699", "no-labels": True,
     "fit": "visible", "target": None, "zoom": 1},
]


def drop_rest(page, link):
    """The picture at rest comes in parts, and a turn that begins meanwhile ends it."""
    page.say({"t": "moving", "on": False})
    page.set(5000, azimuth=11.5)
    check("the picture at rest comes through a thin link",
          page.receive_picture(2, 5000) is not None)
    link.rate = 1e6 / 8  # it would take seconds
    page.set(5001, azimuth=12.5)

    def turn():
        page.say({"t": "moving", "on": True})
        page.set(5002, azimuth=13.5)

    page.at_part, seen = turn, []
    while not seen or seen[-1] != (0, 5002):
        what, message = page.hear()
        if what == "closed":
            break
        if what == "picture":
            page.say({"t": "ack", "n": 0})
            seen.append((message[8], *struct.unpack("<I", message[4:8])))
    check("a part of it had come", page.part, seen)
    check("and the rest of it does not", (2, 5001) not in seen and seen[-1] == (0, 5002), seen)


def thin_links():
    """5 Mbit/s and 80 ms: what a page at home gets of 1024x1024 pixels."""
    server = Server("phantom:engine", "--dims", "64x64x64", "--preset", "ct-bone")
    link = ThinLink(server, 5e6, 0.04)
    rate, kinds, sizes = drag_over(server, link, 1024, 4, lambda page: drop_rest(page, link))
    print(f"       5 Mbit/s, 80 ms: {rate:.1f} pictures a second, of "
          f"{sum(sizes) / len(sizes) / 1000:.0f} kB, "
          f"{kinds.count(3)} of {len(kinds)} as WebP")
    check("a thin link gets WebP", kinds.count(3) > len(kinds) / 3, kinds)
    server.stop()


def drafts(page, count, azimuth=0):
    """Bytes of drafts, each of a turn of its own."""
    got, azimuth = [], azimuth or count
    page.say({"t": "moving", "on": True})
    while len(got) < count:
        page.set(azimuth, azimuth=azimuth % 360)
        head = b""
        while not (head and head[8] == 0 and
                   struct.unpack("<I", head[4:8])[0] == azimuth):
            what, head = page.hear()
            if what == "closed":
                return got
            if what != "picture" or head[10]:
                head = b""
                continue
            page.say({"t": "ack", "n": 0})
        got.append(head[32:])
        azimuth += 1
    return got


def quality_of(jpeg):
    """By the first number of its first table: 16 at 50, as the standard has it."""
    first = jpeg[jpeg.index(b"\xff\xdb") + 5]
    return {16: 50, 12: 62, 8: 75, 5: 85, 3: 90}.get(first, -first)


def quality_of_links():
    """Through 1 Mbit/s a page that wants no WebP gets less and less in a picture,
    and those beside it too while it is there.  A small volume, and nothing beside it, as
    drafts that take long get smaller, and fit."""
    server = Server("phantom:engine", "--dims", "32x32x32", "--preset", "ct-bone")
    link = ThinLink(server, 1e6, 0.04)
    slow = Page(server, port=link.port)
    slow.say({"t": "moving", "on": True})  # so that no large picture at rest comes
    slow.set(1, size=[1024, 1024])
    got = drafts(slow, 20, 100)
    if quality_of(got[-1]) > 50:  # beside other programs
        got += drafts(slow, 40, 200)
    qualities = [quality_of(jpeg) for jpeg in got]
    print(f"       1 Mbit/s, 80 ms: quality {qualities[0]} to {qualities[-1]}, "
          f"{len(got[0]) / 1000:.0f} to {len(got[-1]) / 1000:.0f} kB")
    check("a slow link begins with 75", qualities[0] == 75, qualities)
    check("and goes down to 50, step by step",
          qualities == sorted(qualities, reverse=True) and
          set(qualities) == {75, 62, 50} and qualities[-1] == 50, qualities)
    beside = Page(server)
    got = drafts(beside, 2, 200)
    check("a page beside it has the same pictures",
          [quality_of(jpeg) for jpeg in got] == [50, 50],
          [quality_of(jpeg) for jpeg in got])
    beside.close()
    slow.close()
    server.stop()


def endings():
    for arguments, code, words in (
            (["no-such-file.nrrd"], 3, "no-such-file"),
            ([SMALL, SMALL], 2, "one file too many"),
            ([SMALL, "--listen", ":99999"], 2, "no place to listen"),
            ([SMALL, "--listen", "nowhere"], 2, "--listen"),
            ([SMALL, "--allow-host", "a b"], 2, "--allow-host"),
            ([SMALL, "--embed", "hub.example.org"], 2, "--embed"),
            ([SMALL, "--listen", "unix:/no/such/folder/x"], 4, "--listen"),
            ([SMALL, "--listen", "8000"], 2, "give a port such as :8000"),
            ([SMALL, "--listen", "unix:"], 2, "no place to listen"),
            ([SMALL, "--socket", "x"], 2, "--socket: unknown option"),
            ([SMALL, "--preset", "nonsense"], 2, "--preset"),
            (["-"], 2, "standard input")):
        done = subprocess.run([TOOL, "serve", *arguments], capture_output=True,
                              text=True, timeout=60)
        check(f"serve {' '.join(arguments)} ends with {code}",
              done.returncode == code and words in done.stderr and
              not done.stdout, f"{done.returncode} {done.stderr}")
    first = Server(SMALL)
    taken = subprocess.run([TOOL, "serve", SMALL, "--listen", f":{first.port}"],
                           capture_output=True, text=True, timeout=60)
    check("a port that is taken is refused", taken.returncode == 2 and
          "--listen" in taken.stderr, taken.stderr)
    code, said = first.stop()
    check("a signal ends it in order", code == 0 and not said, said)


def secrets():
    path = os.path.join(FOLDER.name, "secret")
    first = Server(SMALL, "--token-file", path)
    mode = stat.S_IMODE(os.stat(path).st_mode)
    check("the file of the secret is its owner's alone", mode == 0o600, oct(mode))
    check("it holds the secret", open(path).read().strip() == first.token)
    first.stop()
    again = Server(SMALL, "--token-file", path)
    check("and is read the next time", again.token == first.token)
    again.stop()
    os.chmod(path, 0o644)
    done = subprocess.run([TOOL, "serve", SMALL, "--token-file", path],
                          capture_output=True, text=True, timeout=60)
    check("a file that others can read is refused", done.returncode == 2 and
          "others" in done.stderr, done.stderr)
    check("two secrets differ", len({new_secret() for _ in range(2)}) == 2)


def new_secret():
    server = Server(SMALL)
    server.stop()
    return server.token


def unix_socket():
    path = os.path.join(FOLDER.name, "viewer.sock")
    for turn in ("new", "left behind"):
        server = Server(SMALL, "--listen", f"unix:{path}")
        server.path = path
        mode = stat.S_IMODE(os.stat(path).st_mode)
        check(f"a socket that is {turn} is its owner's alone",
              mode & 0o177 == 0, oct(mode))
        check("it serves pages under any port of the tunnel",
              server.get("/", host="localhost:4321")[0] == 200)
        check("but not under another name",
              server.get("/", host="evil.org:4321")[0] == 421)
        page = Page(server, host="localhost:4321",
                    origin="http://localhost:4321")
        check("and WebSockets", page.receive_text("info") is not None)
        check("not for another page's port",
              not Page(server, host="localhost:4321",
                       origin="http://localhost:1").is_open)
        if turn == "new":
            server.process.kill()
            server.process.wait()
        else:
            server.stop()
            check("it is removed in the end", not os.path.exists(path))


server = Server(SMALL, "--allow-host", "viewer.example.org")
check("the URL is the machine's own",
      re.fullmatch(r"http://127\.0\.0\.1:\d+/#token=[0-9a-f]{32}", server.url),
      server.url)
pages(server)
strangers(server)
odd_requests(server)
odd_messages(server)
check("an allowed name is no stranger",
      server.get("/", host="viewer.example.org")[0] == 200 and
      Page(server, host="viewer.example.org",
           origin="https://viewer.example.org").is_open)
crowds(server)
floods(server)
crop_and_back(server)
two_at_once(server)
if not SHORT:
    link_ends = aside(thin_links)
    slow_ones(server)
    many_pages(server)
    thumbnails_wait(server)
    thumbnails(server)
for recipe in RECIPES[::5] if SHORT else RECIPES:
    same_bytes(server, recipe)
print(f"       peak memory {server.kilobytes('VmHWM') / 1024:.0f} MB")
check("memory is bounded", server.kilobytes("VmHWM") < 400 * 1024)
code, said = server.stop()
check("it ends in order", code == 0, f"{code} {said}")
first_state()
fit_at_position()
slices()
one_channel()
if not THREADS:
    slices_in_little_memory()
    mask_switch()
dragged_points([], grey=True)
windows()
replaced()
histograms()
if not SHORT:
    dragged_points(["--preset", "ct-bone"], grey=False)
    recipe_file()
    movie_command()
    answers_first()
    newest_values()
    nothing_to_slice()
    taken_back()
    too_many_slices()
    values_and_depths()
    link_ends()
    quality_of_links()
if not (SHORT or SANITIZED):
    streamed_slices()
embedded()
endings()
secrets()
unix_socket()
finish()
