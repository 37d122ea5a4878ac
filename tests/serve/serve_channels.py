"""Channels in the viewer: pictures and slices are those of their commands."""
import json
import os
import re
import sys
import tempfile

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from viewer_client import (SHORT, check, finish, is_of_command, slice_is_of_command,
                           viewer, write_channels)

FOLDER = tempfile.TemporaryDirectory()
os.chdir(FOLDER.name)


def look_of(page, good):
    """The next look that is good; pictures are acknowledged, or no others would be
    drawn."""
    while True:
        what, message = page.hear()
        if what == "picture":
            page.say({"t": "ack", "n": 0})
        elif what == "closed" or message["t"] == "look" and good(message):
            return message


def numbers(look):
    return [one[0] for one in look["channels"]]


def too_large():
    """In memory for one channel, the first is drawn, and the command says so; also
    after a picture that took more memory, or had no room."""
    with viewer("told.zarr", "-q", "-j", "2", "--memory", "6M", "-m", "over") as page:
        for n, size in enumerate(([400, 300], [900, 700]), 1):
            page.set(n, size=size)
            if n == 1:
                page.receive_picture(2, n)
            else:
                line = page.receive_text("said")["text"]
                check("a large picture has no room in 6M", "900 x 700" in line and
                      "--memory of 6.0 MiB" in line and "window" in line, line)
        value = page.ask("value", at=[3, 4, 5])["value"]
        check("values are those of the volume before", value is not None, value)
        command = page.ask("command")["text"]
        check("and the command is that of the page", "--size 900x700" in command, command)
        page.set(3, size=[96, 80])
        look = look_of(page, lambda look: len(look["channels"]) == 1)
        check("one is drawn in 6M", numbers(look) == [0], look)
        is_of_command(page, "the first", 4, azimuth=20)
        slice_is_of_command(page, "its slice", axis="y", index=12, colored=True)


def ends_with_one_off():
    """What was put away is closed before what it was read by."""
    with viewer("plain.zarr", "-q", "-j", "2") as page:
        page.rest(1, size=[64, 64])
        page.rest(2, channel="0,2")


def begun_with_one(name, *options):
    """A component or a look of the command line gives way to a list of channels."""
    with viewer("plain.zarr", "-q", "-j", "2", *options) as page:
        one = is_of_command(page, f"{name}: one channel", 1, size=[64, 64])
        two = is_of_command(page, "two in its place", 2, component=None,
                            channel="0:blue,2:red")
        slice_is_of_command(page, "their slice", axis="z", index=11, colored=True)
        check("are others", two != one)
        alone = is_of_command(page, "in a mode of one channel", 3, mode="mean")
        check("is another", alone not in (one, two))
        back = is_of_command(page, "one again", 4, mode=None, channel=None,
                             component="1")
        check("has the look of the command line", options[0] != "--tf" or back != two)


def switched(name, *options, clip=None):
    """All, some, one, none but the first; clipped; in other modes."""
    with viewer(name, "-q", "-j", "2", *options) as page:
        what = " ".join([name, *options])
        info = page.receive_text("info")
        check(f"{what}: channels have names", info["channels"] == ["DAPI", "GFP", "Cy5"],
              info["channels"])
        look = look_of(page, lambda look: True)
        check("all are drawn", numbers(look) == [0, 1, 2], look["channels"])
        check("in their colours", [one[3] for one in look["channels"]] ==
              ["#4d4dff", "#00ff00", "#ff8000"], look["channels"])
        spec = ["%d:%s:%r..%r" % (one[0], one[2], one[4], one[5])
                for one in look["channels"]]
        every = is_of_command(page, "all", 1, size=[96, 80])
        told = is_of_command(page, "as the page tells them", 2, channel=",".join(spec))
        check("are the same", every == told)
        two = is_of_command(page, "two", 3, channel=f"{spec[0]},{spec[2]}")
        back = is_of_command(page, "three again", 4, channel=",".join(spec))
        check("are the first three", back == every and two != every)
        other = is_of_command(page, "another colour, range and opacity", 5,
                              channel=f"{spec[2]}:0.5,1:#ff40c0:100..700")
        check("is another", other not in (every, two))
        colored = slice_is_of_command(page, "a slice in colours", axis="z", index=11,
                                      colored=True)
        grey = slice_is_of_command(page, "and in grey", axis="z", index=11)
        check("is another", grey != colored)
        clipped = is_of_command(page, "clipped", 6, clip=[[1, 0, 0, 6]])
        check("is another", clipped != other)
        is_of_command(page, "clipped elsewhere", 7, clip=[[1, 0, 0, 9]])
        shown = slice_is_of_command(page, "slices show what is cut", axis="z",
                                    index=11, colored=True)
        check("as before", shown == colored)
        is_of_command(page, "all of them clipped", 8, channel=None)
        alone = is_of_command(page, "one alone", 9, channel="1", clip=None)
        first = is_of_command(page, "the first alone", 10, channel="0")
        is_of_command(page, "by a preset", 11, preset="linear")
        grey = slice_is_of_command(page, "its slice", axis="y", index=12, colored=True)
        green = is_of_command(page, "one in its colour", 12, preset=None,
                              channel=spec[1])
        check("are four", len({alone, first, green, every}) == 4)
        is_of_command(page, "all again", 13, channel=",".join(spec))
        composited = is_of_command(page, "and composited", 14, mode="over")
        slice_is_of_command(page, "its slice", axis="x", index=12, colored=True)
        check("is another", composited not in (every, green))
        page.set(15, mode="mean")
        look = look_of(page, lambda look: len(look["channels"]) == 1)
        check("a mode of one channel draws the first", numbers(look) == [0],
              look["channels"])
        is_of_command(page, "as its command does", 16, box="outline")
        last = is_of_command(page, "and all again", 17, channel=None, mode=None,
                             box=None, clip=clip)
        check("are the first", last == every)
        page.set(18, channel="7:red,0")
        said = page.receive_text("said")["text"]
        check("one that is not there is refused", "channel 7 does not exist" in said, said)
        last = is_of_command(page, "and the page goes on", 19, channel=None)
        check("as before", last == every)


def refused():
    """Why a state is taken back is the last that a page hears: not what is noted
    of the volume that is opened again."""
    with viewer("plain.zarr", "-j", "2", "--preset", "linear") as page:
        page.rest(1, size=[64, 64])
        page.set(2, component="zz")
        said, at_rest = [], False
        while not at_rest:
            what, message = page.hear()
            if what == "picture":
                page.say({"t": "ack", "n": 0})
                at_rest = message[8] == 2
            elif message["t"] == "said":
                said.append(message["text"])
        check("a component that is none is the last thing said",
              len(said) == 1 and "--component zz" in said[0], said)


def limits():
    """The page has the limits of the library."""
    top = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..")
    for limit, module, name in (("SNOW_CHANNELS_MAX", "channels.js", "CHANNELS_MOST"),
                                ("SNOW_CLIPS_MAX", "clip.js", "PLANES_MOST")):
        with open(os.path.join(top, "include", "snowglass", "volume.h")) as header, \
                open(os.path.join(top, "web", "panel", module)) as page:
            known = re.findall(rf"#define {limit} (\d+)", header.read())
            used = re.findall(rf"const {name} = (\d+);", page.read())
        check(f"{name} is {limit}", known == used and len(used) == 1, (known, used))


limits()
write_channels("plain.zarr", False)
write_channels("told.zarr", True)
switched("plain.zarr")
ends_with_one_off()
refused()
begun_with_one("a component", "--component", "1")
with open("look.json", "w") as out:
    json.dump({"snowglass-tf": 1, "values": "data", "colormap": "viridis",
               "opacities": [[0, 0], [900, 1]]}, out)
begun_with_one("a file of a look", "--tf", "look.json")
if not SHORT:
    switched("told.zarr")
    switched("told.zarr", "--clip", "0,0,1,8", clip=[[0, 0, 1, 8]])
    switched("told.zarr", "--memory", "12M")
    too_large()
finish()
