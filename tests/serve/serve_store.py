"""The page's state and camera without a browser: what it sends, and what it makes of answers
and drags."""
import os
import shutil
import subprocess
import sys
import tempfile

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from viewer_client import check, finish, skip

HERE = os.path.dirname(os.path.abspath(__file__))
node = shutil.which("node") or shutil.which("nodejs")
if not node:
    skip("there is no node")
folder = tempfile.TemporaryDirectory()
os.chdir(folder.name)
shutil.copytree(os.path.join(HERE, "..", "..", "web"), "web")
for name in "store.mjs", "camera.mjs":
    shutil.copy(os.path.join(HERE, "web", name), ".")
with open("web/package.json", "w") as out:
    out.write('{"type": "module"}')
done = subprocess.run([node, "store.mjs"])
check("the state of the page", done.returncode == 0, done.returncode)
done = subprocess.run([node, "camera.mjs"])
check("its camera", done.returncode == 0, done.returncode)
finish()
