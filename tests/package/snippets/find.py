"""The snippets of documents, manual pages and pages of the site."""
import gzip
import html.parser
import re
import textwrap
from typing import NamedTuple


class Snippet(NamedTuple):
    place: str     #: the document and its line
    language: str  #: of the fence; "": none is named
    text: str

    @property
    def lines(self):
        """Those of a shell, continued ones joined."""
        joined = re.sub(r"\\\n\s*", "", self.text)
        return [line for line in joined.splitlines() if line.strip()]


def of_markdown(name, text):
    """Fences, and lines that are indented after an empty one."""
    found, lines, at = [], text.splitlines(), 0
    while at < len(lines):
        begin, fence = at, re.match(r"```(\w*)$", lines[at])
        at += 1
        if fence:
            while lines[at] != "```":
                at += 1
            found.append(Snippet(f"{name}:{begin + 1}", fence.group(1),
                                 "\n".join(lines[begin + 1:at]) + "\n"))
            at += 1
        elif lines[begin].startswith("    ") and not lines[begin - 1].strip():
            while at < len(lines) and (lines[at].startswith("    ") or
                                       not lines[at].strip()):
                at += 1
            block = "\n".join(lines[begin:at]).rstrip() + "\n"
            found.append(Snippet(f"{name}:{begin + 1}", "",
                                 textwrap.dedent(block)))
    return found


def of_manual(path):
    """What stands between .EX and .EE."""
    opened = gzip.open if path.suffix == ".gz" else open
    with opened(path, "rt", encoding="utf-8") as file:
        text = file.read()
    found = []
    for block in re.finditer(r"(?ms)^\.EX\n(.*?)^\.EE", text):
        lines = text.count("\n", 0, block.start()) + 1
        plain = re.sub(r"\\f[RBIP]|\\f\(..|\\&", "", block.group(1))
        for roff, sign in ((r"\-", "-"), (r"\(aq", "'"), (r"\(dq", '"'),
                           (r"\(ga", "`"), (r"\(ha", "^"), (r"\(ti", "~"),
                           (r"\e", "\\"), (r"\(rs", "\\")):
            plain = plain.replace(roff, sign)
        found.append(Snippet(f"{path.name}:{lines}", "",
                             textwrap.dedent(plain)))
    return found


class _Blocks(html.parser.HTMLParser):
    def __init__(self):
        super().__init__()
        self.blocks, self.open = [], None

    def handle_starttag(self, tag, attributes):
        if tag == "pre":
            self.open = (self.getpos()[0], [])

    def handle_data(self, data):
        if self.open:
            self.open[1].append(data)

    def handle_endtag(self, tag):
        if tag == "pre":
            self.blocks.append((self.open[0], "".join(self.open[1])))
            self.open = None


def of_page(path, name):
    """The preformatted blocks of a page of the site."""
    parser = _Blocks()
    parser.feed(path.read_text(encoding="utf-8"))
    return [Snippet(f"{name}:{line}", "", text) for line, text in parser.blocks]


def plain(text):
    """What of a text must be the same in two places."""
    return re.sub(r"\s+", " ", text).strip()
