"""Text of manual pages in the macros man(7), which every reader of manual pages
knows.  What the functions return has no newline at its end."""
import os
import re
import time

LINE = 76


# --- plain text ---------------------------------------------------------------

def chars(text, typed=True):
    """Characters; a hyphen that is `typed` stays one when it is copied, one
    beyond ASCII is written by its number, which every terminal's roff knows."""
    text = text.replace("\\", "\\e")
    if typed:
        text = text.replace("-", "\\-")
    return re.sub(r"[^\x00-\x7f]", lambda m: f"\\[u{ord(m[0]):04X}]", text)


def is_typed(word):
    """Whether a word is an option, maybe in brackets."""
    return word.lstrip("([").startswith("-")


def ends_sentence(word):
    if len(word) > 1 and word[-1] == ")":
        word = word[:-1]
    return len(word) > 1 and word[-1] in ".!?" and \
        not (len(word) > 3 and word.startswith("e.g."))


def fill(text, written, width):
    """A paragraph: the words `written` of those of `text` on lines, each sentence
    on a line of its own."""
    lines, at = [""], 0
    for word, shown in zip(text.split(" "), written):
        length = len(word.encode())
        if at and at + 1 + length > width:
            lines.append("")
            at = 0
        lines[-1] += (" " if at else guarded(word)) + shown
        at += length + 1
        if ends_sentence(word):
            lines.append("")
            at = 0
    return "\n".join(lines).removesuffix("\n")


def guarded(line):
    """What must stand before a line that would be a macro."""
    return "\\&" if line[:1] in (".", "'") and line else ""


def text(words):
    return fill(words, [chars(word, is_typed(word)) for word in words.split(" ")],
                LINE)


def macro(name, argument):
    """A line of a macro, whose argument is one text."""
    return f"{name} {chars(argument)}"


def item(name, words):
    return f".TP\n{macro('.B', name)}\n{text(words)}"


def code_line(line):
    return guarded(line) + chars(line)


def head(table, title, section, origin):
    """The title and the heading of the section NAME, with the day that the build
    names, so that two builds are equal."""
    day = time.strftime("%Y-%m-%d", time.gmtime(
        int(os.environ.get("SOURCE_DATE_EPOCH") or time.time())))
    return (f'.\\" made by scripts/manual from {origin}\n'
            f'.TH {title.upper()} {section} {day} "Snowglass {table["version"]}"\n'
            ".SH NAME")


# --- words of Markdown --------------------------------------------------------

def closes(text, at, mark):
    """Whether a mark before a word has one behind a word."""
    at += len(mark)
    if not re.match("[A-Za-z0-9]", text[at:]):
        return False
    return re.search(r"[^ ]" + re.escape(mark), text[at:]) is not None


def mark_at(text, at, font):
    """(characters, font) of a mark of Markdown at this place; of a link the words
    are written.  Fonts are R, I, b (bold) and B (code)."""
    def changed(to, length):
        return length, "R" if font == to else to

    if text[at] == "`":
        return changed("B", 1)
    if font == "B":
        return 0, font
    if text.startswith("**", at) and (font == "b" or closes(text, at, "**")):
        return changed("b", 2)
    if text[at] == "*" and (text[at - 1] != " " if font == "I"
                            else closes(text, at, "*")):
        return changed("I", 1)
    if re.match(r"\[[^\[]*?\]\(", text[at:]):
        return 1, font
    link = re.match(r"\]\([^)]*\)", text[at:])
    return (len(link[0]) if link else 0), font


def marked_words(text):
    """The words of a text with marks of Markdown."""
    font, start = "R", 0
    for word in text.split(" "):
        at, end, shown = start, start + len(word), ""
        while at < end:
            taken, now = mark_at(text, at, font)
            if now != font:
                shown += "\\f" + now.upper()
            elif not taken:
                shown += chars(text[at], is_typed(word) or font == "B")
            font = now
            at += taken or 1
        yield shown
        start = end + 1


def prose(text, one_line=False):
    """A paragraph of Markdown; marks make lines longer."""
    words = list(marked_words(text))
    if one_line:
        return guarded(text) + " ".join(words)
    return fill(text, words, LINE - 14)
