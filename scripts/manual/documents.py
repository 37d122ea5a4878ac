"""Manual pages of sections of documents, and of public headers, whose comments
stand before what they are about."""
import re
import sys
from pathlib import Path

from roff import chars, code_line, head, macro, prose, text


class Markdown:
    """Headings, paragraphs, lists, tables and programs as text of a manual page,
    from lines one by one.  Headings become those of subsections."""

    def __init__(self, top=0):
        self.out = []
        self.text = ""  # of a paragraph or item that may go on
        self.columns = []  # heads of a table
        self.fenced = self.indented = self.in_list = self.blank = False
        self.headed = True  # nothing stands below the heading yet
        self.top = top  # level of the heading of all

    def flush(self):
        if self.text:
            self.out.append(prose(self.text))
        self.text = ""

    def append(self, line):
        self.text += (" " if self.text else "") + line.lstrip(" ")

    def end_code(self):
        if self.fenced or self.indented:
            self.out.append(".EE\n.RE")
        self.fenced = self.indented = False

    def begin_code(self):
        self.flush()
        if not self.headed:
            self.out.append(".PP")
        self.out.append(".RS 4\n.EX")
        self.in_list = self.headed = False

    def begin_item(self, mark, words):
        self.flush()
        self.out.append(".IP \\(bu 2" if mark == "-" else f".IP {mark} 4")
        self.in_list, self.headed = True, False
        self.append(words)

    def row(self, line):
        """A row is an item: its first cell, and the others with their columns'
        names where there are more than two."""
        if line.startswith("| -"):
            return
        cells = cells_of(line)
        if not self.columns:
            self.columns = cells
            return
        self.headed = False
        self.out += [".TP", prose(cells[0] or "(any)", True)]
        for i, cell in enumerate(cells[1:], 1):
            if not cell:
                continue
            if len(cells) > 2 and i < len(self.columns) and self.columns[i]:
                self.append(self.columns[i] + ":")
            self.append(cell)
            self.flush()
            if len(cells) > 2 and i + 1 < len(cells):
                self.out.append(".br")

    def heading(self, line, level):
        self.flush()
        if level > self.top:
            self.out.append(macro(".SS", line[level + 1:]))
        self.in_list, self.headed = False, True

    def indented_line(self, line, blank):
        if not self.indented:
            self.begin_code()
        elif blank:
            self.out.append("")
        self.indented = True
        self.out.append(code_line(line[4:]))

    def plain_line(self, line, blank):
        self.end_code()
        item = re.match(r" *(-|\d+\.) (.*)", line)
        level = level_of(line)
        if level:
            self.heading(line, level)
        elif line.startswith("|"):
            self.row(line)
        elif item:
            self.begin_item(*item.groups())
        else:
            if blank and not self.headed and not (self.in_list and line[0] == " "):
                self.out.append(".PP")
            self.headed = False
            self.append(line)

    def line(self, line):
        blank, self.blank = self.blank, False
        if line.startswith("```") and self.fenced:
            self.end_code()
        elif self.fenced:
            self.out.append(code_line(line))
        elif line.startswith("```"):
            self.begin_code()
            self.fenced = True
        elif not line:
            self.flush()
            self.columns, self.blank = [], True
        elif line.startswith("    ") and (blank or self.indented):
            self.indented_line(line, blank)
        else:
            self.plain_line(line, blank)

    def end(self):
        self.flush()
        self.end_code()
        return self.out


def level_of(line):
    """The level of a heading; 0: it is none."""
    marks = re.match("(#+) ", line)
    return len(marks[1]) if marks else 0


def cells_of(line):
    """The cells of a row; bars in code and behind a backslash stay."""
    cells, code, at = [""], False, 0
    while at < len(line):
        letter = line[at]
        code ^= letter == "`"
        if line.startswith("\\|", at):
            at += 1
            cells[-1] += "|"
        elif letter == "|" and not code:
            cells.append("")
        else:
            cells[-1] += letter
        at += 1
    return [cell.strip(" ") for cell in cells[1:-1]]


# --- documents ----------------------------------------------------------------

def section(path, heading):
    """The lines of a section: from the heading that begins with these words to
    the next one that is not below it."""
    made, inside = None, False
    for line in Path(path).read_text(encoding="utf-8").split("\n"):
        level = 0 if made and made.fenced else level_of(line)
        if made and 0 < level <= made.top:
            inside = False
        if inside:
            made.line(line)
        elif level and not made and line[level + 1:].startswith(heading):
            made, inside = Markdown(level), True
    if not made:
        sys.exit(f"manual: {path} has no section '{heading}'")
    return made.end()


def document(table, number, summary, *parts):
    """A page of sections: `parts` are FILE, HEADING and TITLE of each."""
    out = [head(table, "snowglass", number, "the documents"),
           f"snowglass \\- {text(summary)}"]
    for path, heading, title in zip(parts[::3], parts[1::3], parts[2::3]):
        out += [macro(".SH", title)] + section(path, heading)
    return out + [".SH SEE ALSO\n.BR snowglass (1),\n.BR snowglass (3),\n"
                  ".BR snowglass (5),\n.BR snowglass (7)",
                  text("and the documents in the folder share/doc/snowglass.")]


# --- headers ------------------------------------------------------------------

PACKAGES = {"snowglass-mpi": "snowglass-mpi",
            "snowglass-recipe": "snowglass-recipe",
            "snowglass-look-file": "snowglass-recipe"}


def page_name(path):
    """"snowglass-look-file" of "include/snowglass/look_file.h"."""
    name = Path(path).stem.replace("_", "-")
    return name if name == "snowglass" else f"snowglass-{name}"


def comment_lines(comment):
    """The text of a comment: without its marks, and with examples, which are
    indented, as Markdown has them."""
    made, example = Markdown(), False
    for line in comment[2:-2].rstrip(" ").split("\n"):
        line = re.sub(r"^ *\*? ?", "", line)
        indented = line.startswith("  ")
        if indented != example and line:
            made.line("")
            example = indented
        made.line("  " + line if indented else line)
    return made.end()


def code_lines(code):
    """Code without lines that are for compilers alone, and without blank ones at
    its ends."""
    code = re.sub(r"(?m)^(#ifndef SNOWGLASS_.*|#define SNOWGLASS_.*_H|#include.*)\n",
                  "", code)
    code = re.sub(r"(?m)^SNOW_API ", "", code).strip("\n")
    code = re.sub("\n{3,}", "\n\n", code)
    return [line and code_line(line) for line in code.split("\n")] if code else []


def declarations(parts):
    """A comment stands before what it is about, and here behind it."""
    out, first = [], True
    for comment, code in zip([None] + parts[1::2], parts[::2]):
        lines = code_lines(code)
        if lines:
            out += [".EX" if first else ".PP\n.EX", *lines, ".EE"]
            first = False
        if comment:
            out += [".RS 4" if lines else ".PP\n.RS 4", *comment_lines(comment),
                    ".RE"]
    return out


def functions(source):
    for start in re.findall(r"SNOW_API ([^(;]*)\(", source):
        yield from re.findall("snow_[a-z0-9_]*$", start)


def header(table, path):
    """The page of a public header, which begins with a comment such as
    "snowglass/view.h - the camera. ..."."""
    source = Path(path).read_text(encoding="utf-8").removesuffix("#endif\n")
    name = page_name(path)
    _, about, *parts = re.split(r"(?ms)^(/\*.*?\*/)\n?", source) + [""]
    file, _, description = about[3:].partition(" - ")
    if not file.startswith("snowglass/") or not description:
        sys.exit(f"manual: {path} does not begin as a public header does")
    summary = re.split(r"\.(?=\s)|\*/", description)[0].replace("\n *", "")
    included = [page_name(other) for other
                in re.findall("#include <(snowglass/[^>]*)>", source)]
    return [head(table, name, 3, "the public headers"),
            ",\n".join([chars(name), *functions(source)]),
            f"\\- {text(summary)}",
            f".SH SYNOPSIS\n.B #include <{file}>\n.PP",
            ".B cc program.c $(pkg\\-config \\-\\-cflags \\-\\-libs "
            f"{chars(PACKAGES.get(name, 'snowglass'))})",
            ".SH DESCRIPTION",
            *comment_lines("/* " + description[0].upper() + description[1:]),
            ".SH DECLARATIONS", *declarations(parts), ".SH SEE ALSO",
            *[f".BR {chars(other)} (3)," for other in included],
            ".BR snowglass (3),\n.BR snowglass (7)"]
