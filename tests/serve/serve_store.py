"""The page's state without a browser: what it sends, and what it makes of answers."""
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
shutil.copy(os.path.join(HERE, "web", "store.mjs"), ".")
with open("web/package.json", "w") as out:
    out.write('{"type": "module"}')
done = subprocess.run([node, "store.mjs"])
check("the state of the page", done.returncode == 0, done.returncode)
finish()
