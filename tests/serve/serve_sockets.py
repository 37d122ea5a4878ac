"""The viewer's door: who is refused, and that nobody keeps others out."""
import json
import os
import re
import shlex
import socket
import stat
import struct
import subprocess
import sys
import tempfile
import threading
import time

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from viewer_client import SHORT, TOOL, Page, Server, ThinLink, check, finish

FOLDER = tempfile.TemporaryDirectory()
SMALL = os.path.join(FOLDER.name, "small.nrrd")
SIDE = 96
subprocess.run([TOOL, "phantom", "head", "--dims", "48x48x48", "-o", SMALL],
               check=True, capture_output=True)


def pages(server):
    status, headers, body = server.get("/")
    check("the page", status == 200 and b"<script type" in body, status)
    policy = headers.get("content-security-policy", "")
    for word in ("default-src 'none'", "script-src 'self'", "base-uri 'none'",
                 "frame-ancestors 'none'", "form-action 'none'"):
        check(f"the policy has {word}", word in policy, policy)
    check("nothing unsafe is in the policy", "unsafe" not in policy, policy)
    for name, value in (("x-content-type-options", "nosniff"),
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
          b"engine_server.js" in plain)
    status = server.get("/viewer.js", If_None_Match=headers["etag"])[0]
    check("it is not sent again", status == 304, status)
    check("HEAD has no body", server.get("/", method="HEAD")[2] == b"")


def strangers(server):
    other = f"127.0.0.1:{server.port + 1}"
    for host in ("evil.org", f"evil.org:{server.port}", other, "127.0.0.1",
                 f"localhost.evil.org:{server.port}"):
        status = server.get("/", host=host)[0]
        check(f"host {host} is refused", status == 421, status)
        check(f"host {host} opens no WebSocket",
              not Page(server, host=host, origin=f"http://{host}").is_open)
    check("localhost is no stranger",
          server.get("/", host=f"localhost:{server.port}")[0] == 200)
    for origin in ("", "null", "http://evil.org", f"http://{other}",
                   f"https://127.0.0.1:{server.port}", "file://"):
        check(f"origin '{origin}' is refused",
              not Page(server, origin=origin).is_open)
    for path in ("/", "/viewer.js", "/wsx", "/ws/x"):
        check(f"path {path} opens no WebSocket",
              not Page(server, path=path).is_open)
    for protocol in ("", "snowglass.2", "http", "door"):
        check(f"protocol '{protocol}' is refused",
              not Page(server, protocol=protocol).is_open)
    for token in ("x", server.token[:-1], server.token + "0",
                  server.token[::-1], "0" * 32):
        code = Page(server, token=token).closed_code(5)
        check(f"token of {len(token)} letters is refused", code == 4401, code)


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
    """Each ends its own connection, and nothing else."""
    cases = {
        "a frame of 2^63 bytes": lambda p: p.send_frame(0x81, b"xxxx",
                                                        length=1 << 63),
        "no mask": lambda p: p.send_frame(0x81, b"{}", mask=False),
        "3,000 braces": lambda p: p.say(b"{" * 3000),
        "a binary message": lambda p: p.send_frame(0x82, b"{}"),
        "no UTF-8": lambda p: p.send_frame(0x81, b'{"t":"\xff\xfe"}'),
        "no JSON": lambda p: p.say(b"hello"),
        "64 KiB and a byte": lambda p: p.say(b'{"t":"ask","what":"' +
                                            b"x" * 65536 + b'"}'),
        "a reserved bit": lambda p: p.send_frame(0xC1, b"{}"),
        "an unknown opcode": lambda p: p.send_frame(0x83, b"{}"),
        "a file in a recipe": lambda p: p.say(
            {"t": "set", "n": 1, "recipe": {"mask": "/etc/passwd"}}),
        "an output in a recipe": lambda p: p.say(
            {"t": "set", "n": 1, "recipe": {"output": "x.png"}}),
        "a picture too large": lambda p: p.say(
            {"t": "set", "n": 1, "recipe": {"size": [4097, 10]}}),
        "pieces without an end": lambda p: [
            p.send_frame(0x01 if i == 0 else 0x00, b"x" * 8192)
            for i in range(10)],
    }
    for name, say in cases.items():
        page = Page(server)
        page.hear_text("info")
        say(page)
        check(f"{name} closes", page.closed_code(8) is not None)
    page = Page(server, hello=False)
    page.say({"t": "set", "n": 1, "recipe": {}})
    check("what comes before hello closes", page.closed_code(5) == 4401)
    page = Page(server)
    page.hear_text("info")
    page.say({"t": "set", "n": 1, "recipe": {"zoom": "large", "preset": 7}})
    said = page.hear_text("said")
    check("a wrong value is answered", said and "zoom" in said["text"], said)
    page.say({"t": "ask", "what": "nothing"})
    check("and so is a wrong question", page.hear_text("said") is not None)
    page.close()


def served_within(server, seconds):
    """A page that is asked for amid others; the best of a few, as the machine
    may be busy."""
    best = 1e9
    for _ in range(5):
        begin = time.monotonic()
        status = server.get("/")[0]
        if status == 200:
            best = min(best, time.monotonic() - begin)
    return best < seconds, f"{1000 * best:.0f} ms"


def crowds(server):
    count = 200 if SHORT else 1000
    idle = []
    for _ in range(count):
        idle.append(server.connect())
    good, told = served_within(server, 0.05)
    check(f"beside {count} idle connections a page comes in {told}", good, told)
    page = Page(server)
    check("and a WebSocket is opened", page.hear_text("info") is not None)
    files = len(os.listdir(f"/proc/{server.process.pid}/fd"))
    check(f"few stay open: {files} files", files < 110, files)
    page.close()
    for each in idle:
        each.close()


def slow_ones(server):
    """Half a header, no hello, a header byte by byte."""
    half, silent = server.connect(), Page(server, hello=False)
    half.sendall(b"GET / HT")
    begin = time.monotonic()
    code = silent.closed_code(10)
    check("no hello closes after 2 s", code == 4401 and
          1.5 < time.monotonic() - begin < 8, code)
    if not SHORT:
        drops = server.connect()
        end = time.monotonic() + 12
        closed = False
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
    half.settimeout(10)
    try:
        rest = half.recv(100)
    except OSError as error:
        rest = repr(error)
    check("half a header is closed after 5 s", rest == b"", rest)
    check("which took about that", time.monotonic() - begin < 20)


def many_pages(server):
    """A page that takes nothing slows no other, and the 33rd is one too many."""
    fast, slow = Page(server), Page(server)
    fast.say({"t": "set", "n": 1, "recipe": {"size": [SIDE, SIDE]}})
    check("the first picture", fast.hear_picture(2) is not None)
    seen = 0
    for n in range(2, 42):  # the slow one acknowledges nothing
        fast.say({"t": "set", "n": n, "recipe": {"azimuth": n}})
        seen += fast.hear_picture(0, n, 10) is not None
    check(f"each of 40 changes is seen beside a slow page: {seen}", seen == 40)
    state = slow.hear_text("state")
    check("the other page learns of changes", state is not None)
    last = None
    slow.say({"t": "ack", "n": 0})
    slow.say({"t": "ack", "n": 0})
    while last is None or last["recipe"].get("azimuth") != 41:
        last = slow.hear_text("state")
        if last is None:
            break
    check("and sees the newest state", last is not None)
    others = [Page(server) for _ in range(30)]
    for page in others:
        page.hear_text("info")
    check("the 33rd page is refused", Page(server).closed_code(5) == 4429)
    for page in [*others, slow]:
        page.socket.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER,
                               struct.pack("ii", 1, 0))  # as a kill -9
        page.close()
    fast.say({"t": "set", "n": 50, "recipe": {"azimuth": 0}})
    check("the rest is served on", fast.hear_picture(0, 50) is not None)
    fast.close()


def floods(server):
    """Sets faster than pictures: the newest wins."""
    count = 300 if SHORT else 3000
    page = Page(server)
    page.hear_text("info")
    for n in range(1, count + 1):
        page.say({"t": "set", "n": n, "recipe": {"azimuth": n % 360,
                                                 "size": [SIDE, SIDE]}})
    check(f"after {count} changes the newest is shown",
          page.hear_picture(2, count) is not None)
    page.close()


def same_bytes(server, path, recipe):
    """The picture at rest is the file of the copied command."""
    page = Page(server)
    page.say({"t": "set", "n": 7, "recipe": {"size": [SIDE, SIDE + 10],
                                             **recipe}})
    shown = page.hear_picture(2, 7)
    page.say({"t": "ask", "what": "command"})
    command = page.hear_text("command")
    words = shlex.split(command["text"]) if command else []
    page.close()
    if not words or shown is None:
        check(f"{recipe} has a command", False, command)
        return
    out = os.path.join(FOLDER.name, "again.png")
    words[0] = TOOL
    words[words.index("--output") + 1] = out
    done = subprocess.run([*words, "-y", "-q"], capture_output=True, text=True)
    written = open(out, "rb").read() if done.returncode in (0, 7) else b""
    check(f"{recipe} has the bytes of the command", shown == written,
          f"{done.returncode} {done.stderr} {' '.join(words)}")


def crop_and_back(server):
    """A crop keeps the object's size; a step back names its zoom itself."""
    page = Page(server)
    before = page.hear_text("state")["recipe"]
    page.say({"t": "set", "n": 1, "recipe": {"crop": [[12, 36], [12, 36],
                                                      [12, 36]]}})
    cropped = page.hear_text("state")["recipe"]
    check("a crop keeps the scale", cropped["zoom"] < 0.8 * before["zoom"],
          f"{before['zoom']} {cropped['zoom']}")
    page.say({"t": "set", "n": 2, "recipe": {
        "crop": None, "zoom": before["zoom"], "target": before["target"]}})
    page.hear_picture(2, 2)
    page.close()
    page = Page(server)
    now = page.hear_text("state")["recipe"]
    check("a step back has its own zoom", now["zoom"] == before["zoom"],
          f"{before['zoom']} {now['zoom']}")
    page.close()


def two_at_once(server):
    """Both pages learn of both changes, and which of their own are in a state."""
    one, other = Page(server), Page(server)
    for page in (one, other):
        page.hear_text("state")
    for n in range(1, 30):
        one.say({"t": "set", "n": n, "recipe": {"azimuth": n}})
        other.say({"t": "set", "n": 100 + n, "recipe": {"elevation": n}})
    for page, own, key, last in ((one, "azimuth", "elevation", 29),
                                 (other, "elevation", "azimuth", 129)):
        state = {"recipe": {}}
        while state and state["recipe"].get(key) != 29:
            state = page.hear_text("state")
        check(f"the other's {key} arrives", state is not None)
        if state:
            base = 100 if own == "elevation" else 0
            check(f"its n is that of its {own}",
                  state["n"] in (0, base + state["recipe"].get(own, 0)), state)
    one.say({"t": "set", "n": 77, "recipe": {"zoom": "wrong"}})
    state = one.hear_text("state")
    while state and state["n"] != 77:
        state = one.hear_text("state")
    check("a refused change counts as heard", state is not None)
    one.close()
    other.close()


def first_state():
    """What a page sets at once is not lost, nor its first state another one."""
    server = Server("phantom:head")
    page = Page(server)
    page.say({"t": "set", "n": 1, "recipe": {"zoom": 3.5}})
    begin = page.hear_text("state")["recipe"]
    check("the first state is framed", "target" in begin, begin)
    page.hear_picture(2, 1)
    page.close()
    page = Page(server)
    now = page.hear_text("state")["recipe"]
    check("a zoom that is set at once stays", now["zoom"] == 3.5, now)
    page.close()
    server.stop()


def thumbnails_wait(server):
    """They come when the picture is final, and no change waits for them."""
    page = Page(server)
    page.say({"t": "set", "n": 1, "recipe": {"azimuth": 3}})
    for pane in range(4, 12):
        page.say({"t": "ask", "what": "thumbnail", "preset": "ct-bone",
                  "pane": pane})
    page.say({"t": "ask", "what": "command"})
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
        page.say({"t": "ask", "what": "thumbnail", "preset": "ct-bone",
                  "pane": pane})
    page.say({"t": "ask", "what": "command"})
    smalls = 0
    while True:
        what, message = page.hear()
        if what == "closed" or what == "text" and message["t"] == "command":
            break
        smalls += what == "picture" and message[10] > 0
    check("a command does not wait for thumbnails", smalls < 4, smalls)
    page.close()


def thumbnails(server):
    """The picture of a preset is the same in every mode."""
    page = Page(server)
    seen = []
    for n, mode in enumerate(("over", "mean", "sum"), 1):
        page.say({"t": "set", "n": n, "recipe": {
            "mode": mode, "size": [SIDE, SIDE], "background": "#000000"}})
        page.hear_picture(2, n)
        page.say({"t": "ask", "what": "thumbnail", "preset": "ct-bone",
                  "pane": 4})
        seen.append(page.hear_small(4)[32:])
    check("a thumbnail is painted in all modes", seen[1:] == seen[:1] * 2,
          [len(each) for each in seen])
    page.say({"t": "set", "n": 9, "recipe": {
        "mode": "over", "size": None, "background": None}})
    page.close()


def fit_at_position():
    server = Server(SMALL, "--position", "200,10,20")
    page = Page(server)
    page.hear_text("state")
    page.say({"t": "ask", "what": "fit"})
    said = page.hear_text("said")
    check("what cannot be framed is told", said and "position" in said["text"],
          said)
    page.close()
    server.stop()


def recipe_file():
    """A recipe has what only the command line sets, so it makes the picture."""
    points = os.path.join(FOLDER.name, "points.json")
    with open(points, "w") as out:
        json.dump({"snowglass-tf": 1, "values": "data", "opacities": [[20 + i, i / 400] for i in range(300)]}, out)
    raw = os.path.join(FOLDER.name, "small.raw")
    with open(raw, "wb") as out:
        out.write(bytes(i % 48 * 5 for i in range(48 ** 3)))
    server = Server(raw, "--dims", "48x48x48", "--type", "uint8", "--tf", points)
    page = Page(server)
    page.say({"t": "set", "n": 1, "recipe": {"azimuth": 12,
                                             "size": [SIDE, SIDE]}})
    shown = page.hear_picture(2, 1)
    page.say({"t": "ask", "what": "thumbnail", "preset": "", "pane": 4})
    of_file = page.hear_small(4)
    page.say({"t": "ask", "what": "thumbnail", "preset": "ct-bone", "pane": 4})
    check("the first thumbnail is there", of_file and
          of_file[32:] != page.hear_small(4)[32:])
    late = Page(server)
    look = late.hear_text("look")
    check("a look of many points says how many there are",
          look["count"] == 300 and len(look["opacity"]) == 256, look["count"])
    late.close()
    page.say({"t": "ask", "what": "recipe"})
    recipe = page.hear_text("recipe")
    path, out = (os.path.join(FOLDER.name, name)
                 for name in ("recipe.json", "recipe.png"))
    with open(path, "w") as file:
        file.write(recipe["text"])
    done = subprocess.run([TOOL, "render", "--config", path, "-o", out, "-q"],
                          capture_output=True, text=True)
    check("a saved recipe has the bytes of the picture", done.returncode == 0
          and open(out, "rb").read() == shown, done.stderr or recipe["text"])
    page.close()
    server.stop()


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


def thin_links():
    """5 Mbit/s and 80 ms: what a page at home gets of 1024x1024 pixels."""
    server = Server("phantom:engine", "--preset", "ct-bone")
    link = ThinLink(server, 5e6, 0.04)
    page = Page(server, port=link.port, wants=("jpeg", "png", "webp"))
    page.say({"t": "set", "n": 1, "recipe": {"size": [1024, 1024]}})
    page.hear_picture(2, 1)
    page.say({"t": "moving", "on": True})
    stop, kinds, sizes = time.monotonic() + 8, [], []

    def move():
        n = 2
        while time.monotonic() < stop:
            page.say({"t": "set", "n": n, "recipe": {"azimuth": n % 360}})
            n += 1
            time.sleep(0.03)

    threading.Thread(target=move).start()
    while time.monotonic() < stop:
        what, message = page.hear()
        if what == "picture":
            page.say({"t": "ack", "n": 0})
            kinds.append(message[9])
            sizes.append(len(message))
    rate = len(kinds[len(kinds) // 4:]) / 6
    print(f"       5 Mbit/s, 80 ms: {rate:.1f} pictures a second, of "
          f"{sum(sizes) / len(sizes) / 1000:.0f} kB, "
          f"{kinds.count(3)} of {len(kinds)} as WebP")
    check("a thin link gets WebP", kinds.count(3) > len(kinds) / 3, kinds)
    page.close()
    server.stop()


def endings():
    for arguments, code, words in (
            (["no-such-file.nrrd"], 3, "no-such-file"),
            ([SMALL, SMALL], 2, "one file too many"),
            ([SMALL, "--port", "99999"], 2, "out of range"),
            ([SMALL, "--listen", "nowhere"], 2, "--listen"),
            ([SMALL, "--allow-host", "a b"], 2, "--allow-host"),
            ([SMALL, "--idle", "soon"], 2, "--idle"),
            ([SMALL, "--socket", "/no/such/folder/x"], 4, "--socket"),
            ([SMALL, "--socket", "x", "--port", "8000"], 2, "conflicts"),
            ([SMALL, "--preset", "nonsense"], 2, "--preset"),
            (["-"], 2, "standard input")):
        done = subprocess.run([TOOL, "serve", *arguments], capture_output=True,
                              text=True, timeout=60)
        check(f"serve {' '.join(arguments)} ends with {code}",
              done.returncode == code and words in done.stderr and
              not done.stdout, f"{done.returncode} {done.stderr}")
    idle = Server(SMALL, "--idle", "0.3s")
    check("--idle ends it", idle.process.wait(20) == 0)
    first = Server(SMALL)
    taken = subprocess.run([TOOL, "serve", SMALL, "--port", str(first.port)],
                           capture_output=True, text=True, timeout=60)
    check("a port that is taken is refused", taken.returncode == 2 and
          "--port" in taken.stderr, taken.stderr)
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
        server = Server(SMALL, "--socket", path)
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
        check("and WebSockets", page.hear_text("info") is not None)
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
slow_ones(server)
many_pages(server)
floods(server)
crop_and_back(server)
two_at_once(server)
thumbnails_wait(server)
thumbnails(server)
for recipe in RECIPES[::3] if SHORT else RECIPES:
    same_bytes(server, SMALL, recipe)
print(f"       peak memory {server.kilobytes('VmHWM') / 1024:.0f} MB")
check("memory is bounded", server.kilobytes("VmHWM") < 400 * 1024)
code, said = server.stop()
check("it ends in order", code == 0, f"{code} {said}")
first_state()
fit_at_position()
recipe_file()
if not SHORT:
    thin_links()
endings()
secrets()
unix_socket()
finish()
