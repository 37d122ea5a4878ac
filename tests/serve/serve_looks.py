"""Looks that move: what a draft has in haste is what is at rest; and looks that stay:
a change of one part leaves the others as they were chosen."""
import array
import os
import subprocess
import sys
import tempfile

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from viewer_client import TOOL, check, finish, is_of_command, viewer
from volumes import nrrd

FOLDER = tempfile.TemporaryDirectory()
os.chdir(FOLDER.name)


def look_with(page, ends):
    """The next look of a range."""
    while True:
        what, message = page.hear()
        if what == "closed":
            return None
        if what == "picture":
            page.say({"t": "ack", "n": int.from_bytes(message[4:8], "little")})
        elif message["t"] == "look" and all(
                abs(message[key] - end) < 1e-6
                for key, end in zip(("low", "high"), ends)):
            return message


def are_near(a, b):
    return len(a) == len(b) and all(
        abs(x - y) < 1e-3 for one, other in zip(a, b) for x, y in zip(one, other))


def drag(page, n, name, quick, first, second, ends):
    """The second range is spread in haste; the look at rest is the same.  One of two
    numbers takes points and colours along, so that nothing is counted at all."""
    def say(n, recipe):
        page.set(n, **recipe)

    page.say({"t": "moving", "on": True})
    say(n, first)
    page.receive_picture(0, n)
    say(n + 1, second)
    draft = look_with(page, ends)
    counted = " made by histogram" if "histogram" in draft["text"] else ""
    check(f"{name}: a draft is{'' if quick else ' not'} quick", quick != bool(counted),
          draft["text"])
    page.say({"t": "moving", "on": False})
    if quick and "window" in second:
        rested = look_with(page, ends)
        check("its look was made anew", "histogram" in rested["text"], rested["text"])
        check("and is that of the draft", are_near(draft["opacity"], rested["opacity"])
              and draft["strip"] == rested["strip"], [draft, rested])
    is_of_command(page, "and that of its command", n + 2, azimuth=20)
    page.say({"t": "set", "step": n + 3, "keys": {key: None for key in
                                             [*first, *second, "azimuth"]}})
    page.receive_picture(2, n + 3)


with viewer("phantom:head", "--dims", "40x40x40", "-q") as page:
    page.rest(0, size=[64, 64])
    drag(page, 10, "a range", True, {"range": [10, 200]}, {"range": [30, 180]}, (30, 180))
    drag(page, 20, "a window", True, {"window": [100, 90]},
         {"window": [120, 80]}, (20, 140))
    drag(page, 40, "the first window", False, {"azimuth": 3}, {"window": [150, 105]},
         (30, 180))
def state(page, n, **recipe):
    """What the server says of its state after a change."""
    page.set(n, **recipe)
    while True:
        told = page.receive_text("state")
        if told["step"] >= n:
            return told


def keeps(name, *volume):
    """The values that a look has, sent back, change no pixel of it; nor does a part
    that is set and taken back."""
    with viewer(*volume, "-q") as page:
        look = page.receive_text("look")
        plain = page.rest(1, size=[96, 80])
        ends = [look["low"], look["high"]]
        shade = "phong" if look["shaded"] else "none"
        for i, (key, value) in enumerate((("opacity", look["opacity"]), ("range", ends),
                                          ("shade", shade))):
            n = 10 * (i + 1)
            told = state(page, n, **{key: value})
            check(f"{name}: a {key} writes what else was computed", len(told["computed"]) >= 2
                  and not set(told["computed"]) & set(told["keys"]), told)
            same = is_of_command(page, "and the command has that", n + 1, azimuth=0)
            check("no pixel changes", same == plain)
            told = state(page, n + 2, **{key: None, "azimuth": None})
            check("all of it goes with the change", not told["computed"] and not {
                "opacity", "range", "shade", "colormap", "preset"} & set(told["keys"]), told)
            check("and the picture is as before", page.receive_picture(2, n + 2) == plain)
        low, wide = look["low"], look["high"] - look["low"]
        told = state(page, 50, range=[low, low + wide / 2])
        moved = told["computed"]["opacity"]
        check("points of the opacity go with a range", are_near(
            [[low + (at - low) / 2, of] for at, of in look["opacity"]], moved), moved)
        told = state(page, 51, range=[low, low + 2 * wide])
        check("as far as it moves in all", are_near(
            [[low + (at - low) * 2, of] for at, of in look["opacity"]],
            told["computed"]["opacity"]), told)
        told = state(page, 52, preset="linear", range=None)
        check("a preset takes what was computed away",
              told["computed"] == {} and "opacity" not in told["keys"], told)


subprocess.run([TOOL, "convert", "phantom:head", "--dims", "48x40x36", "-o", "head.nrrd",
                "-q"], check=True)
with open("head.nrrd", "rb") as file:
    voxels = file.read().split(b"\n\n", 1)[1]
nrrd("ct.nrrd", (48, 40, 36), array.array("h", (
    8 * value - 1000 for value in voxels)).tobytes(), "space: right-anterior-superior",
    "space directions: (4,0,0) (0,4,0) (0,0,4)", kind="int16")
nrrd("signed.nrrd", (40, 40, 40), array.array("f", (
    ((x - 20) ** 2 - (y - 20) ** 2 + z) * 2.0 ** -((x - 20) ** 2 / 90 + (y - 20) ** 2 / 60)
    for z in range(40) for y in range(40) for x in range(40))).tobytes(), kind="float")
for each in (["ct.nrrd"], ["phantom:turbulence", "--dims", "40x40x40"],
             ["phantom:head", "--dims", "40x40x40"], ["signed.nrrd"]):
    keeps(each[0], *each)
for words in (["--clip", "1,0,0,3"], ["--mask", "phantom:head"]):
    with viewer("phantom:head", "-q", *words) as page:
        info = page.receive_text("info")
        check(f"with {words[0]} the type is the file's", info["type"] == "uint8", info["type"])
finish()
