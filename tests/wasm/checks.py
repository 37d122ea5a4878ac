"""What the tests of the page without a server have in common: checks, each a line,
and the programs that may be missing."""
import shutil
import sys

wrong = 0


def check(name, good, why=""):
    global wrong
    print(f"ok     {name}" if good else f"FAILED {name}: {why}")
    wrong += not good


def skip(why):
    print("skip  ", why)
    sys.exit(77)


def find(*names):
    """The first of some programs that is installed, or None."""
    return next(filter(None, map(shutil.which, names)), None)


def end():
    """Ends a test in which a check has failed."""
    if wrong:
        sys.exit(f"{wrong} checks failed")
