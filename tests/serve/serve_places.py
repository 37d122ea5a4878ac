"""Where the viewer runs and listens: it writes no file, needs no display, and is
reached by the addresses that it names; and no page hears of a patient."""
import json
import os
import re
import socket
import struct
import subprocess
import sys
import tempfile
import zlib

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from viewer_client import TOOL, Page, Server, check, finish
from dicom import dicom_slice

FOLDER = tempfile.TemporaryDirectory()
SMALL = os.path.join(FOLDER.name, "small.nrrd")
subprocess.run([TOOL, "phantom", "head", "--dims", "40x40x40", "-o", SMALL],
               check=True, capture_output=True)


def ask_all(page):
    """What a page hears of all that it can ask for, as bytes."""
    heard = []

    def receive_until(good):
        while True:
            what, message = page.hear()
            if what == "closed":
                return False
            heard.append(json.dumps(message, ensure_ascii=False).encode()
                         if what == "text" else message)
            if what == "picture":
                page.say({"t": "ack", "n": 0})
            if good(what, message):
                return True

    page.set(1, size=[96, 80], legend=True)
    all_heard = receive_until(lambda what, message: what == "picture" and
                           message[4:9] == struct.pack("<IB", 1, 2))
    page.set(2, time=7)
    all_heard &= receive_until(lambda what, message: what == "text" and
                            message["t"] == "said")
    for kind, asked in (
            ("histogram", {}), ("command", {}), ("movie-command", {}), ("recipe", {}),
            ("value", {"at": [1, 2, 3]}), ("depth", {"x": 0.5, "y": 0.5}),
            ("slice-command", {"axis": "z", "index": 1, "range": [0, 255]})):
        page.question(kind, **asked)
        all_heard &= receive_until(lambda what, message: what == "text" and
                                message["t"] in (kind, "command"))
    for pane, asked in ((2, {"what": "slice", "axis": "z", "index": 1, "n": 5,
                             "range": [0, 255], "exact": True}),
                        (4, {"what": "thumbnail", "preset": "ct-bone"})):
        page.say({"t": "ask", "pane": pane, **asked})
        all_heard &= receive_until(lambda what, message: what == "picture" and
                                message[10] == pane)
    return heard if all_heard else []


# --- where it runs -------------------------------------------------------------------

def read_only(folder):
    """What starts a program where no file can be written, where that can be made."""
    words = ["unshare", "-m", "sh", "-c",
             'mount --bind "$0" "$0" && mount -o remount,bind,ro "$0" && '
             'mount -o remount,bind,ro / && cd "$0" && ! touch x 2>&- && exec "$@"', folder]
    try:
        tried = subprocess.run([*words, "true"], capture_output=True, text=True)
        if tried.returncode == 0:
            return [words]
        why = tried.stderr.strip()
    except OSError as error:
        why = error
    print(f"skip   a file system that is read-only: {why}")
    return []


def written_files(server):
    """Files that it has open for writing, but for one in memory."""
    found = []
    for each in os.listdir(f"/proc/{server.process.pid}/fd"):
        name = os.readlink(f"/proc/{server.process.pid}/fd/{each}")
        with open(f"/proc/{server.process.pid}/fdinfo/{each}") as about:
            flags = int(re.search(r"flags:\s*(\d+)", about.read())[1], 8)
        if flags & 3 and name.startswith("/") and not name.startswith(("/dev/",
                                                                       "/memfd:")):
            found.append(name)
    return found


def nothing_written():
    """As root it could write to the folder; what it does elsewhere is seen only
    where it cannot."""
    folder = os.path.join(FOLDER.name, "here")
    os.mkdir(folder)
    os.chmod(folder, 0o555)
    lacking = {name: value for name, value in os.environ.items()
               if name not in ("DISPLAY", "WAYLAND_DISPLAY", "XAUTHORITY",
                               "XDG_RUNTIME_DIR")}
    lacking.update(HOME="/nonexistent", TMPDIR="/nonexistent")
    for words in ([], *read_only(folder)):
        server = Server(SMALL, tool=[*words, TOOL], cwd=folder, env=lacking)
        page = Page(server)
        check("without a display all is answered, " + (
            "where no file can be written" if words else "from a folder of mode 555"),
              ask_all(page))
        check("no file is open for writing", not written_files(server),
              written_files(server))
        page.close()
        code, said = server.stop()
        check("nor was one made", code == 0 and not said and not os.listdir(folder),
              f"{code} {said} {os.listdir(folder)}")


# --- where it listens ------------------------------------------------------------------

def other_loopback():
    try:
        socket.create_server(("::1", 0), family=socket.AF_INET6).close()
    except OSError as error:
        print(f"skip   [::1]: {error}")
        return
    server = Server(SMALL)
    server.address = "::1", server.port
    host = f"[::1]:{server.port}"
    check("[::1] is reached", server.get("/", host=host)[0] == 200)
    page = Page(server, host=host, origin=f"http://{host}")
    check("and opens a WebSocket", page.receive_text("info") is not None)
    page.close()
    check("not for another port's page",
          not Page(server, host=host, origin="http://[::1]:1").is_open)
    server.stop()


def own_addresses():
    for address, name in (("127.0.0.1", "127.0.0.1"),
                          ("0.0.0.0", socket.gethostname())):
        server = Server(SMALL, "--listen", address)
        check(f"--listen {address} names itself", server.host ==
              f"{name}:{server.port}", server.host)
        check("sends its page", server.get("/")[0] == 200)
        page = Page(server)
        check("opens a WebSocket", page.receive_text("info") is not None)
        page.close()
        check("refuses another name",
              server.get("/", host=f"evil.org:{server.port}")[0] == 421)
        code, said = server.stop()
        check("and says what is unsafe", code == 0 and said.count("\n") == 1 and
              said.startswith(f"snowglass: note: --listen {address}: ") and
              f"ssh -L 8000:127.0.0.1:{server.port}" in said, said)


def folders_of_sockets():
    """In a folder of others, who could put another socket in the place."""
    def is_refused(folder, why):
        path = os.path.join(folder, "s")
        done = subprocess.run([TOOL, "serve", SMALL, "--listen", f"unix:{path}"],
                              capture_output=True, text=True, timeout=60)
        check(f"a folder that {why} is refused", done.returncode == 2 and
              done.stderr.count("\n") == 1 and why in done.stderr and
              path in done.stderr and not os.path.exists(path),
              f"{done.returncode} {done.stderr}")

    folder = os.path.join(FOLDER.name, "shared")
    os.mkdir(folder)
    for mode in 0o777, 0o770, 0o702:
        os.chmod(folder, mode)
        is_refused(folder, "can be written to by others")
    if os.geteuid() == 0:
        os.chmod(folder, 0o755)
        os.chown(folder, 12345, -1)
        is_refused(folder, "belongs to another user")
        os.chown(folder, 0, -1)
    else:
        print("skip   a folder of another user: this one cannot make it")
    for mode, path in ((0o1777, os.path.join(folder, "s")), (0o755, "s")):
        os.chmod(folder, mode)
        server = Server(SMALL, "--listen", f"unix:{path}", cwd=folder)
        server.path = os.path.join(folder, "s")
        check(f"one of mode {mode:o} is taken",
              server.get("/", host="localhost:8000")[0] == 200)
        server.stop()


# --- a patient's name --------------------------------------------------------------------

SECRETS = ["Zyxwvut^Patient", "ID-QQ4711", "19010203", "Hospital of Qwert",
           "1.2.826.0.1.4711.99", "Doctor^Asdfgh", "head of Zyxwvut"]


def write_scan(folder):
    """Slices with all that says whose they are."""
    name, number, day, place, study, doctor, part = SECRETS
    os.mkdir(folder)
    for z in range(8):
        with open(os.path.join(folder, f"{z}.dcm"), "wb") as out:
            out.write(dicom_slice(
                z, [(x - 10) ** 2 + (y - 12) ** 2 + 30 * z for y in range(24)
                    for x in range(24)], 2 * z, about={
                        (8, 0x18): ("UI", f"{study}.3.{z + 1}"), (8, 0x60): ("CS", "MR"),
                        (8, 0x20): ("DA", day), (8, 0x80): ("LO", place),
                        (8, 0x90): ("PN", doctor), (8, 0x1030): ("LO", part),
                        (8, 0x103E): ("LO", part), (0x10, 0x10): ("PN", name),
                        (0x10, 0x20): ("LO", number), (0x10, 0x30): ("DA", day),
                        (0x20, 0xD): ("UI", study + ".1"),
                        (0x20, 0xE): ("UI", study + ".2")}))


def texts_of(png):
    """Its chunks but for the pixels, unpacked where they are packed."""
    found, at = b"", 8
    while at < len(png):
        size, = struct.unpack(">I", png[at:at + 4])
        kind, body = png[at + 4:at + 8], png[at + 8:at + 8 + size]
        if kind != b"IDAT":
            found += body
        if kind in (b"zTXt", b"iTXt") and b"\x78" in body:
            start = body.index(b"\x78")
            found += zlib.decompressobj().decompress(body[start:])
        at += size + 12
    return found


def no_patient():
    folder = os.path.join(FOLDER.name, "scan")
    write_scan(folder)
    server = Server(folder)
    page = Page(server)
    heard = ask_all(page)
    kinds = {json.loads(each)["t"] for each in heard if each.startswith(b"{")}
    check("a scan is shown, with its figures", {
        "info", "state", "look", "said", "recipe", "command"} <= kinds, kinds)
    heard += [texts_of(each[32:]) for each in heard if each[32:36] == b"\x89PNG"]
    heard += [server.get(path)[2] for path in ("/", "/viewer.js", "/viewer.css")]
    page.close()
    heard.append(server.stop()[1].encode())
    for secret in [*SECRETS, "Zyxwvut", "Qwert", "Asdfgh"]:
        found = [each[:300] for each in heard if secret.encode() in each]
        check(f"{secret} is in no message, picture or page", not found, found)


nothing_written()
other_loopback()
own_addresses()
folders_of_sockets()
no_patient()
finish()
