"""Clients that mean harm, read nothing, or die: what others get meanwhile."""
import os
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import time

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from viewer_client import (PATIENCE, SANITIZED, SHORT, TOOL, Page, Server, check,
                           finish, page_comes)

FOLDER = tempfile.TemporaryDirectory()
SMALL = os.path.join(FOLDER.name, "small.nrrd")
subprocess.run([TOOL, "phantom", "head", "--dims", "40x40x40", "-o", SMALL],
               check=True, capture_output=True)


def until(good):
    """Whether it becomes true; that may take long on a busy machine."""
    end = time.monotonic() + PATIENCE
    while not good() and time.monotonic() < end:
        time.sleep(0.02)
    return good()


# --- harm that goes on -----------------------------------------------------------

class Harm:
    """Strikes from a thread of its own while it is entered."""

    def __init__(self, strike):
        self.strike, self.count, self.over = strike, 0, threading.Event()
        self.thread = threading.Thread(target=self.run, daemon=True)

    def run(self):
        while not self.over.wait(0.005):
            self.count += self.strike()

    def __enter__(self):
        self.thread.start()
        until(lambda: self.count >= 3)
        return self

    def __exit__(self, *_):
        self.over.set()
        self.thread.join()


def slow_loris(server):
    """Many headers at once that come byte by byte."""
    head = f"GET / HTTP/1.1\r\nHost: {server.host}\r\nX-Slow: ".encode()
    drops = [head[i:i + 1] for i in range(len(head))] + [b"x"] * 5000
    open_ones = {}

    def strike():
        while len(open_ones) < 60:
            open_ones[server.connect()] = iter(drops)
        for each, rest in list(open_ones.items()):
            try:
                each.sendall(next(rest))
            except OSError:
                del open_ones[each]
                each.close()
        return True

    return strike


def closes(server, say):
    """A page that says something, and is closed for it."""
    def strike():
        page = Page(server)
        say(page)
        closed = page.closed_code() is not None
        page.close()
        return closed

    return strike


def harms(server):
    for name, strike in (
            ("60 headers that come byte by byte", slow_loris(server)),
            ("frames of 2^63 bytes", closes(server, lambda page: page.send_frame(
                0x81, b"xxxx", length=1 << 63))),
            ("frames without a mask", closes(server, lambda page: page.send_frame(
                0x81, b"{}", mask=False))),
            ("braces by the thousand", closes(server, lambda page: page.say(
                b"{" * 60000)))):
        with Harm(strike) as harm:
            begun = harm.count
            page_comes(server, name)
            until(lambda: harm.count > begun)
        check("which went on meanwhile", harm.count > begun >= 3, (begun, harm.count))


# --- who is silent -----------------------------------------------------------------

class Silent:
    """Connections that are closed after their time; nothing else uses their server,
    where a newer one would end the oldest.  The clock is the server's: a later
    connection, after its page, has the same time, so it is closed after them.
    Without limits of ours they would be closed 2.5 s after it, by lws."""

    def __init__(self):
        self.server, self.begin = Server(SMALL), time.monotonic()
        self.ones = {"an idle connection": self.server.connect(),
                     "half a header": self.server.connect()}
        self.ones["half a header"].sendall(b"GET / HT")

    def end(self):
        time.sleep(max(0, self.begin + 2.5 - time.monotonic()))
        later = self.server.connect()
        later.sendall(f"HEAD / HTTP/1.1\r\nHost: {self.server.host}\r\n\r\n".encode())
        while not later.recv(4096).endswith(b"\r\n\r\n"):
            pass
        check("a connection is closed after its page", later.recv(100) == b"")
        for name, one in self.ones.items():
            one.setblocking(False)
            try:
                rest = one.recv(100)
            except OSError as error:
                rest = repr(error)
            check(f"{name} was closed before", rest == b"", rest)
        self.server.stop()


# --- who dies ------------------------------------------------------------------------

def die_in_a_frame(server, reads):
    """In another process, which is killed: half a message, or half a picture."""
    ready, begun = os.pipe()
    child = os.fork()
    if child == 0:
        try:
            page = deaf_page(server)
            if reads:
                page.need(9000)
            else:
                page.send_frame(0x81, b'{"t":"set","step":1,"keys":', length=60000)
            os.write(begun, b".")
            time.sleep(600)
        finally:
            os._exit(1)
    os.close(begun)
    began = os.read(ready, 1)
    os.kill(child, signal.SIGKILL)
    os.waitpid(child, 0)
    os.close(ready)
    return began == b"."


def deaths(server):
    """More than may look at once are killed in the middle of a frame."""
    witness = Page(server)
    witness.set(1, size=[600, 600])
    check("there is a picture", witness.receive_picture(2, 1) is not None)
    before, count = server.files(), 12 if SHORT else 40
    begun = [die_in_a_frame(server, turn % 2) for turn in range(count)]
    check(f"{count} clients are killed", all(begun), begun)
    check("and leave no file open", until(lambda: server.files() <= before),
          f"{server.files()} {before}")
    witness.set(2, size=[64, 64])
    check("another sees the next change", witness.receive_picture(2, 2) is not None)
    witness.close()


# --- who reads nothing -----------------------------------------------------------------

def deaf_page(server):
    """It has taken nothing but the answer to its request, and has little room."""
    made = socket.socket()
    made.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 2048)
    made.connect(server.address)
    made.settimeout(PATIENCE)
    return Page(server, made=made)


def is_answered(page):
    """Also where the questions of others wait."""
    page.question("command")
    while True:
        what, message = page.hear()
        if what == "closed" or what == "text" and message["t"] == "said":
            return False
        if what == "text" and message["t"] == "command":
            return True
        if what == "picture":
            page.say({"t": "ack", "n": 0})


def deaf(server):
    """It says that it has painted what it never took."""
    side = 512 if SANITIZED else 1024
    other, silent = Page(server), deaf_page(server)
    other.set(10, size=[side, side])
    check("the first picture", other.receive_picture(2, 10) is not None)
    before, seen, last = server.kilobytes(), 0, 20 if SHORT else 50
    for n in range(11, last):
        for _ in range(3):
            silent.say({"t": "ack", "n": 0})
        other.set(n, azimuth=n)
        seen += other.receive_picture(2 if n % 5 == 0 else 0, n) is not None
    check(f"each of {seen} pictures of {side} x {side} comes beside a page that "
          "reads nothing", seen == last - 11, seen)
    more = server.kilobytes() - before
    check(f"which took {more} kB more", more < 40000 or SANITIZED, more)
    files = server.files()
    for _ in range(400):
        silent.question("recipe")
    check("nor does an answer wait for 400 that it leaves", is_answered(other))
    check("it is closed", until(lambda: server.files() < files), files)
    silent.close()
    other.close()


silent = Silent()
server = Server(SMALL)
page = Page(server)
page.set(1, size=[64, 64])
check("there is a first picture", page.receive_picture(2, 1) is not None)
page.close()
harms(server)
silent.end()
deaths(server)
deaf(server)
code, said = server.stop()
check("it ends in order", code == 0, f"{code} {said}")
finish()
