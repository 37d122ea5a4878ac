"""Looks that move: what a draft has in haste is what is at rest."""
import os
import sys
import tempfile

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from viewer_client import check, finish, is_of_command, viewer

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
    """The second range is spread in haste; the look at rest is the same."""
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
    if quick:
        rested = look_with(page, ends)
        check("its look was made anew", "histogram" in rested["text"], rested["text"])
        check("and is that of the draft", are_near(draft["opacity"], rested["opacity"])
              and draft["strip"] == rested["strip"], [draft, rested])
    is_of_command(page, "and that of its command", n + 2, azimuth=20)
    page.say({"t": "set", "n": n + 3, "recipe": {key: None for key in
                                             [*first, *second, "azimuth"]}})
    page.receive_picture(2, n + 3)


with viewer("phantom:head", "--dims", "40x40x40", "-q") as page:
    page.rest(0, size=[64, 64])
    drag(page, 10, "a range", True, {"range": [10, 200]}, {"range": [30, 180]}, (30, 180))
    drag(page, 20, "a window", True, {"window": [100, 90]},
         {"window": [120, 80]}, (20, 140))
    drag(page, 40, "the first range", False, {"azimuth": 3}, {"range": [30, 180]}, (30, 180))
for words in (["--clip", "1,0,0,3"], ["--mask", "phantom:head"]):
    with viewer("phantom:head", "-q", *words) as page:
        info = page.receive_text("info")
        check(f"with {words[0]} the type is the file's", info["type"] == "uint8", info["type"])
finish()
