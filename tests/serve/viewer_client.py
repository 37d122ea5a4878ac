"""What the tests of the viewer share: a server, and a WebSocket made of a plain
socket, which can also say what no browser would.

Tests are run as `python3 serve_NAME.py TOOL DATA`; they exit with 77 where the
viewer is not built."""
import base64
import collections
import concurrent.futures
import contextlib
import http.client
import json
import os
import shlex
import socket
import struct
import subprocess
import sys
import threading
import time

sys.path.append(os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "support"))
TOOL = os.path.abspath(sys.argv[1])
DATA = sys.argv[2] if len(sys.argv) > 2 else ""
SANITIZED = "SNOW_SANITIZED" in os.environ
THREADS = os.environ.get("SNOW_SANITIZED") == "thread"  # by far the slowest
PATIENCE = 120  # seconds, which only a test that fails takes
SHORT = os.environ.get("SNOW_TIER", "short") == "short"  # docs/testing.md
HELLO = ["jpeg", "png"]
wrong = 0


def skip(why):
    print("skip  ", why)
    sys.exit(77)


def check(name, good, why=""):
    global wrong
    print(f"ok     {name}" if good else f"FAILED {name}: {why}")
    wrong += not good


def aside(*tests):
    """Begins tests that mostly wait; the function that it returns ends when they have."""
    pool = concurrent.futures.ThreadPoolExecutor()
    begun = [pool.submit(test) for test in tests]
    return lambda: [each.result() for each in begun]


def finish():
    if wrong:
        sys.exit(f"{wrong} checks failed")


class Server:
    """A viewer of its own; `url` is what it prints."""

    def __init__(self, *arguments, tool=(TOOL,), **how):
        if not os.path.exists(os.path.join(os.path.dirname(TOOL),
                                           "snowglass-serve")):
            skip("snowglass-serve is not built: libwebsockets or libturbojpeg "
                 "is missing")
        self.process = subprocess.Popen(
            [*tool, "serve", *arguments], stdout=subprocess.PIPE,
            stderr=subprocess.PIPE, text=True, **how)
        self.url = self.process.stdout.readline().strip()
        if not self.url:
            sys.exit(f"FAILED to start: {self.process.stderr.read()}")
        self.host = self.url.split("/")[2]
        self.port = int(self.host.rsplit(":", 1)[1])
        self.token = self.url.partition("token=")[2]
        self.address = "127.0.0.1", self.port
        self.path = None  # of a Unix socket

    def connect(self):
        if self.path:
            made = socket.socket(socket.AF_UNIX)
            made.connect(self.path)
        else:
            made = socket.create_connection(self.address)
        made.settimeout(PATIENCE)
        return made

    def get(self, path="/", host=None, method="GET", **headers):
        """Status, headers and body of a page."""
        connection = http.client.HTTPConnection("127.0.0.1", self.port)
        connection.sock = self.connect()
        connection.putrequest(method, path, skip_host=True,
                              skip_accept_encoding=True)
        if host != "":
            connection.putheader("Host", host or self.host)
        for name, value in headers.items():
            connection.putheader(name.replace("_", "-"), value)
        connection.endheaders()
        answer = connection.getresponse()
        body = answer.read()
        connection.close()
        return answer.status, dict((name.lower(), value) for name, value
                                   in answer.getheaders()), body

    def files(self):
        return len(os.listdir(f"/proc/{self.process.pid}/fd"))

    def processor_seconds(self):
        """What all its threads have used: the clock that Linux has of a process."""
        return time.clock_gettime((~self.process.pid << 3) | 2)

    def kilobytes(self, what="VmRSS"):
        with open(f"/proc/{self.process.pid}/status") as status:
            for line in status:
                if line.startswith(what + ":"):
                    return int(line.split()[1])
        return 0

    def stop(self):
        """With sanitizers the end says what was not freed."""
        self.process.terminate()
        code, said = self.process.wait(60), self.process.stderr.read()
        if code:
            check("a server ends in order", False, f"{code} {said}")
        return code, said


def page_comes(server, beside):
    """A page that is asked for amid others.  What the server itself does for it has
    a limit; what passes is printed, and limited only so that it ends, as the
    machine may be busy."""
    passed, used = [], []
    for _ in range(10):
        begin, before = time.monotonic(), server.processor_seconds()
        good = server.get("/")[0] == 200
        used.append(1000 * (server.processor_seconds() - before))
        passed.append(1000 * (time.monotonic() - begin) if good else 1e9)
        time.sleep(0.02)
    passed.sort()
    used.sort()
    print(f"       beside {beside}: a page after {passed[0]:.1f} to {passed[-1]:.1f} "
          f"ms, half of them within {passed[5]:.1f}; {used[5]:.1f} ms of processor")
    check(f"beside {beside} each page comes", passed[-1] < 1e9)
    check("the server does not work long for it",
          used[5] < (1000 if SANITIZED else 50), used)
    check("nor lets it wait", passed[0] < (60000 if SANITIZED else 4000), passed)


class ThinLink:
    """A proxy that delays and limits what a server sends: `tc netem` is not
    everywhere."""

    def __init__(self, server, bits, delay):
        self.rate, self.delay, self.port_of = bits / 8, delay, server.port
        self.door = socket.create_server(("127.0.0.1", 0))
        self.port = self.door.getsockname()[1]
        threading.Thread(target=self.serve, daemon=True).start()

    def serve(self):
        while True:
            near, _ = self.door.accept()
            far = socket.create_connection(("127.0.0.1", self.port_of))
            for a, b, rate in ((near, far, lambda: 1e9), (far, near, lambda: self.rate)):
                queue = collections.deque()
                threading.Thread(target=self.read, args=(a, queue, rate),
                                 daemon=True).start()
                threading.Thread(target=self.write, args=(b, queue),
                                 daemon=True).start()

    def read(self, source, queue, rate):
        free = time.monotonic()
        while True:
            try:
                got = source.recv(4096)
            except OSError:
                got = b""
            free = max(free, time.monotonic()) + len(got) / rate()
            queue.append((free + self.delay, got))
            if not got:
                return
            while free > time.monotonic() + 0.02:  # a small buffer
                time.sleep(0.002)

    @staticmethod
    def write(target, queue):
        while True:
            if not queue or queue[0][0] > time.monotonic():
                time.sleep(0.001)
                continue
            _, got = queue.popleft()
            try:
                if not got:
                    target.close()
                    return
                target.sendall(got)
            except OSError:
                return


class Page:
    """A WebSocket as a page has one."""

    def __init__(self, server, origin=None, host=None, path="/ws",
                 protocol="snowglass.1", token=None, hello=True, port=None,
                 wants=HELLO, made=None):
        self.socket = made or (socket.create_connection(("127.0.0.1", port))
                               if port else server.connect())
        self.bytes, self.server, self.part = b"", server, b""
        self.at_part = None  # what is done when a part has come
        key = base64.b64encode(os.urandom(16)).decode()
        origin = f"http://{server.host}" if origin is None else origin
        lines = [f"GET {path} HTTP/1.1", f"Host: {host or server.host}",
                 "Upgrade: websocket", "Connection: Upgrade",
                 f"Sec-WebSocket-Key: {key}", "Sec-WebSocket-Version: 13"]
        lines += [f"Sec-WebSocket-Protocol: {protocol}"] if protocol else []
        lines += [f"Origin: {origin}"] if origin else []
        self.socket.sendall(("\r\n".join(lines) + "\r\n\r\n").encode())
        self.head = b""
        while b"\r\n\r\n" not in self.head:
            try:
                got = self.socket.recv(4096)
            except OSError:
                break
            if not got:
                break
            self.head += got
        self.head, _, self.bytes = self.head.partition(b"\r\n\r\n")
        self.is_open = self.head.startswith(b"HTTP/1.1 101")
        if hello and self.is_open:
            self.say({"t": "hello", "token": token or server.token,
                      "wants": list(wants)})

    def send_frame(self, first, body, mask=True, length=None):
        length = len(body) if length is None else length
        bit = 0x80 if mask else 0
        head = bytes([first])
        if length < 126:
            head += bytes([bit | length])
        elif length < 65536:
            head += bytes([bit | 126]) + struct.pack(">H", length)
        else:
            head += bytes([bit | 127]) + struct.pack(">Q", length)
        if mask:
            key = os.urandom(4)
            body = bytes(b ^ key[i & 3] for i, b in enumerate(body))
            head += key
        try:
            self.socket.sendall(head + body)
        except OSError:
            pass  # closed already

    def say(self, message):
        if not isinstance(message, bytes):
            message = json.dumps(message).encode()
        self.send_frame(0x81, message)

    def set(self, n, **recipe):
        self.say({"t": "set", "step": n, "keys": {
            name.replace("_", "-"): value for name, value in recipe.items()}})

    def rest(self, n, **recipe):
        """Bytes of the picture at rest of a state."""
        self.set(n, **recipe)
        return self.receive_picture(2, n)

    def question(self, what, **asked):
        self.say({"t": "ask", "what": what, **asked})

    def ask(self, what, **asked):
        """The answer, which is a text; all commands are answered alike."""
        self.question(what, **asked)
        return self.receive_text(what if "command" not in what else "command")

    def need(self, count):
        while len(self.bytes) < count:
            got = self.socket.recv(1 << 20)
            if not got:
                raise EOFError
            self.bytes += got
        taken, self.bytes = self.bytes[:count], self.bytes[count:]
        return taken

    def hear(self):
        """("text", object), ("picture", bytes), ("closed", code)."""
        whole, kind = b"", 0
        while True:
            try:
                first, length = self.need(2)
                if length == 126:
                    length, = struct.unpack(">H", self.need(2))
                elif length == 127:
                    length, = struct.unpack(">Q", self.need(8))
                body = self.need(length)
            except (EOFError, ConnectionError):
                return "closed", 0
            if first & 15 == 8:
                return "closed", int.from_bytes(body[:2], "big")
            if first & 15 == 9:
                self.send_frame(0x8A, body)  # without it a page is thought gone
                continue
            kind = first & 15 or kind
            whole += body
            if first & 128 and kind == 1:
                return "text", json.loads(whole)
            if first & 128:
                picture, whole, kind = self.joined(whole), b"", 0
                if picture:
                    return "picture", picture

    def joined(self, message):
        """A picture that comes in parts, which are acknowledged, once all are there."""
        if not message[11]:
            return message
        self.say({"t": "part"})
        self.part = message if message[11] == 1 else self.part + message[32:]
        if self.at_part:
            self.at_part, act = None, self.at_part
            act()
        whole = len(self.part) - 32 == int.from_bytes(message[12:16], "little")
        return self.part if whole else None

    def receive_text(self, kind, seconds=PATIENCE):
        """The next text of a kind; None when the page was closed."""
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            what, message = self.hear()
            if what == "closed":
                return None
            if what == "text" and message["t"] == kind:
                return message
        return None

    def receive_picture(self, level, n=None, seconds=60, head=False):
        """Bytes of the next picture of a quality or a finer one, as a busy machine
        may leave out a draft; or its head.  It is acknowledged."""
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            what, message = self.hear()
            if what == "closed":
                return None
            if what != "picture" or message[10]:
                continue
            got, = struct.unpack("<I", message[4:8])
            self.say({"t": "ack", "n": got})
            if message[8] >= level and (n is None or got == n):
                return message[:32] if head else message[32:]
        return None

    def receive_small(self, pane):
        """The next picture of a pane; None when the page was closed."""
        while True:
            what, message = self.hear()
            if what == "closed":
                return None
            if what != "picture":
                continue
            if message[10] == pane:
                return message
            self.say({"t": "ack", "n": 0})

    def slice(self, **asked):
        """A picture, with its head; None where the answer is that there is none."""
        self.question("slice", pane=2, n=7, **asked)
        while True:
            what, message = self.hear()
            if what == "closed":
                return "closed"
            if what == "text" and message["t"] == "slice" and message["pane"] == 2:
                return None
            if what == "picture" and message[10] == 2:
                return message
            if what == "picture" and not message[10]:
                self.say({"t": "ack", "n": 0})

    def closed_code(self):
        """Waits for the close, whatever is said before; None: none came."""
        end = time.monotonic() + PATIENCE
        self.socket.settimeout(PATIENCE)
        while time.monotonic() < end:
            try:
                what, code = self.hear()
            except (TimeoutError, socket.timeout):
                return None
            if what == "closed":
                return code
        return None

    def close(self):
        self.socket.close()


@contextlib.contextmanager
def viewer(*arguments, **how):
    """A page of a viewer of its own."""
    server = Server(*arguments, **how)
    page = Page(server)
    yield page
    page.close()
    server.stop()


COUNT, DEEP, HIGH, WIDE = 3, 22, 26, 30


def brightness(c, z, y, x):
    """A ball of each channel beside the others, on a faint ground."""
    far = (x - 9 - 6 * c) ** 2 + (y - 12) ** 2 + (z - 11) ** 2
    return max(10 * c, 1000 - 12 * far) if far < 75 else 3 * ((x + y + z) % 4)


def write_channels(name, windows, count=COUNT):
    """An OME-Zarr of channels with names and colours, or ranges too."""
    shape = [count, DEEP, HIGH, WIDE]
    os.makedirs(f"{name}/0")
    channels = [{"label": label, "color": color, "active": True,
                 **({"window": {"start": 20, "end": 900}} if windows else {})}
                for label, color in (("DAPI", "0000ff"), ("GFP", "00ff00"),
                                     ("Cy5", "ff8000"),
                                     *((f"dye {c}", f"{c:x}0{c:x}080")
                                       for c in range(COUNT, count)))]
    axes = [{"name": "c", "type": "channel"}] + [
        {"name": axis, "type": "space", "unit": "micrometer"} for axis in "zyx"]
    scale = [{"type": "scale", "scale": [1, 0.9, 0.5, 0.5]}]
    for path, tree in (
            (f"{name}/.zgroup", {"zarr_format": 2}),
            (f"{name}/.zattrs", {
                "multiscales": [{"version": "0.4", "axes": axes, "datasets": [
                    {"path": "0", "coordinateTransformations": scale}]}],
                "omero": {"channels": channels}}),
            (f"{name}/0/.zarray", {
                "zarr_format": 2, "shape": shape, "chunks": shape, "dtype": "<u2",
                "compressor": None, "fill_value": 0, "order": "C",
                "filters": None})):
        with open(path, "w") as out:
            json.dump(tree, out)
    with open(f"{name}/0/0.0.0.0", "wb") as out:
        out.write(b"".join(struct.pack("<H", brightness(c, z, y, x))
                           for c in range(count) for z in range(DEEP)
                           for y in range(HIGH) for x in range(WIDE)))


def run_command(text, *changes, out="again.png"):
    """The bytes of a copied command's picture, or what it says."""
    words = shlex.split(text)
    words[0] = TOOL
    words[words.index("--output") + 1] = out
    done = subprocess.run([*words, *changes, "-y", "-q"], capture_output=True)
    return open(out.replace("%d", "0"), "rb").read() if done.returncode in (0, 7) else \
        done.stderr


def is_of_command(page, name, n, **recipe):
    """Sets a recipe; the picture at rest must be that of its command."""
    shown, command = page.rest(n, **recipe), page.ask("command")["text"]
    made = run_command(command)
    check(name, shown == made, f"{command} {made[:200]}")
    return shown


def slice_is_of_command(page, name, *changes, **asked):
    asked.setdefault("range", [0, 255])
    shown = page.slice(**asked, exact=True)
    command = page.ask("slice-command", **asked)["text"]
    made = run_command(command, *changes)
    check(name, shown and shown[32:] == made, f"{command} {made[:200]}")
    return shown and shown[32:]


def drag_over(server, link, side, seconds, after=None):
    """Turns the view through a link, then does something else: pictures a second after the first quarter,
    their kinds and sizes."""
    page = Page(server, port=link.port, wants=("jpeg", "png", "webp"))
    page.rest(1, size=[side, side])
    page.say({"t": "moving", "on": True})
    stop, kinds, sizes = time.monotonic() + seconds, [], []

    def move():
        n = 2
        while time.monotonic() < stop:
            page.set(n, azimuth=n % 360)
            n += 1
            time.sleep(0.03)

    threading.Thread(target=move).start()
    while time.monotonic() < stop:
        what, message = page.hear()
        if what == "picture":
            page.say({"t": "ack", "n": 0})
            kinds.append(message[9])
            sizes.append(len(message))
    if after:
        after(page)
    page.close()
    return len(kinds[len(kinds) // 4:]) / (0.75 * seconds), kinds, sizes
