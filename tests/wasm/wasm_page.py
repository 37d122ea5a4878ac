"""The page without a server in Chromium: a phantom, dropped files, a page that
`snowglass export` made, and one that a server sends so that it may share memory."""
import functools
import http.server
import json
import os
import shlex
import shutil
import subprocess
import sys
import threading

TOOL, OUT, TOP = map(os.path.abspath, sys.argv[1:4])
HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, HERE)
from dicom_slice import dicom  # noqa: E402

PLAYWRIGHT = os.path.join(os.path.dirname(TOOL), "web", "node_modules",
                          "playwright-core", "index.mjs")
PAGE = os.path.join(TOP, "build-web", "viewer.html")
wrong = 0


def check(name, good, why=""):
    global wrong
    print(f"ok     {name}" if good else f"FAILED {name}: {why}")
    wrong += not good


def skip(why):
    print("skip  ", why)
    sys.exit(77)


def find(*names):
    return next(filter(None, map(shutil.which, names)), None)


node, chromium = find("node", "nodejs"), find("chromium", "chromium-browser")
if not node or not chromium or not os.path.exists(PLAYWRIGHT):
    skip("node, chromium or playwright-core is missing")
if not os.path.exists(PAGE):
    skip("there is no page: ./dev web builds it")
shutil.rmtree(OUT, ignore_errors=True)
os.makedirs(OUT)


def tool(*words):
    return subprocess.run([TOOL, *words], cwd=OUT, capture_output=True,
                          text=True)


def watch(*pages):
    """Looks at pages, each with its volumes, and runs their commands where those are."""
    done = subprocess.run(
        [node, os.path.join(HERE, "page.mjs"), PLAYWRIGHT, chromium, OUT,
         json.dumps([{"url": url, "volumes": volumes} for url, *volumes in pages])],
        timeout=500)
    check("the pages", done.returncode == 0, done.returncode)
    for name in (volume[0] for _, *volumes in pages for volume in volumes):
        with open(os.path.join(OUT, f"{name}.txt")) as file:
            words = shlex.split(file.read())
        words[words.index("--output") + 1] = "again.png"
        tool(*words[1:], "-y", "-q")
        with open(os.path.join(OUT, "again.png"), "rb") as a, \
                open(os.path.join(OUT, f"{name}-rest.png"), "rb") as b:
            check(f"{name}: the picture at rest is the command's",
                  a.read() == b.read())


head = tool("phantom", "head", "--dims", "64x64x48", "-o", "head.nrrd")
assert head.returncode == 0, head.stderr
tool("convert", "head.nrrd", "-o", "head.raw")
with open(os.path.join(OUT, "apart.nhdr"), "w") as file:
    file.write("NRRD0004\ntype: uint8\ndimension: 3\nsizes: 64 64 48\n"
               "spacings: 4 4 4.7\nencoding: raw\ndata file: head.raw\n")
os.makedirs(os.path.join(OUT, "series"))
for z in range(11):  # the order is not that of the names
    with open(os.path.join(OUT, "series", f"{7 * z % 11}.dcm"), "wb") as file:
        file.write(dicom(z))
other = os.path.join(OUT, "other.nrrd")  # whose title is not the page's
shutil.copy(os.path.join(OUT, "head.nrrd"), other)

with open(os.path.join(OUT, "points.json"), "w") as file:
    file.write('{"snowglass-tf": 1, "values": "data", "opacities": '
               '[[20, 0], [90, 0.2], [200, 0.9]]}')
made = tool("export", "made.html", "head.nrrd", "--tf", "points.json",
            "--azimuth", "30", "--legend")
check("a page is made", made.returncode == 0, made.stderr)


class Isolating(http.server.SimpleHTTPRequestHandler):
    """Sends what a browser asks of pages that share memory."""
    def end_headers(self):
        self.send_header("Cross-Origin-Opener-Policy", "same-origin")
        self.send_header("Cross-Origin-Embedder-Policy", "require-corp")
        super().end_headers()

    def log_message(self, *words):
        pass


with http.server.ThreadingHTTPServer(
        ("127.0.0.1", 0), functools.partial(Isolating, directory=OUT)) as server:
    threading.Thread(target=server.serve_forever, daemon=True).start()
    watch(("file://" + PAGE, ["phantom"],
           ["apart", os.path.join(OUT, "apart.nhdr"), os.path.join(OUT, "head.raw")],
           ["folder", os.path.join(OUT, "series")],
           ["raw", os.path.join(OUT, "head.raw")],
           ["dropped", os.path.join(OUT, "head.nrrd")]),
          ("file://" + os.path.join(OUT, "made.html"), ["made"]),
          (f"http://127.0.0.1:{server.server_port}/made.html", ["shared"],
           ["shared-dropped", other]))
    server.shutdown()
again = tool("export", "made.html", "head.nrrd")
check("a page is not replaced", again.returncode == 4 and
      "made.html: exists" in again.stderr, again)
large = tool("export", "large.html", "phantom:engine", "--dims",
             "1200x1200x1200")
check("what is too large is refused with what to do",
      large.returncode == 5 and "1648 MiB" in large.stderr and
      "at most 1024" in large.stderr and "--crop" in large.stderr and
      not os.path.exists(os.path.join(OUT, "large.html")), large)
if wrong:
    sys.exit(f"{wrong} checks failed")
