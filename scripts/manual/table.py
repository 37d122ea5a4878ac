"""The table of options, as snowglass-table writes it, and what can be asked of
its rows."""
import json
import re
from pathlib import Path


def load(path):
    return json.loads(Path(path).read_text(encoding="utf-8"))


def names(rows):
    return [row["name"] for row in rows]


def literals(text, between):
    """The words that are typed as they stand, in a text such as
    "key|head|AZ,EL"."""
    return [word for word in re.split(between, text or "")
            if re.fullmatch("[a-z0-9][a-z0-9-]*", word)]


def topic_words(table):
    """What `snowglass help` takes: topics, then verbs."""
    return names(table["topics"]) + names(table["verbs"])


def option_words(table, option):
    """The words that an option's argument can be, or that begin it: its choices,
    or names of the library's lists."""
    lists = {"preset": "presets", "colormap": "colormaps", "view": "views",
             "type": "types"}
    if option["reader"] in lists:
        return names(table[lists[option["reader"]]])
    if option["reader"] == "component":
        return ["x", "y", "z", "w", "magnitude"]  # numbers are names too
    if option["name"] == "help":
        return topic_words(table)
    return literals(option["argument"], "[|]")


def verb_words(table, verb):
    """The same of the first operand of a verb, taken from its usage."""
    if verb["name"] == "phantom":
        return names(table["phantoms"])
    if verb["name"] == "help":
        return topic_words(table)
    return literals(verb["usage"], "[ |]")


def word_text(text, word):
    """What an option's text says of one of its words, as "fast" of "low" in
    "quality. low: fast; high: slow"; None: nothing."""
    found = re.search(rf"(?s)(?:^|[;.].){re.escape(word)}: (.*)", text)
    return found and found[1]


def takes_word(option):
    """Whether the next word is the option's argument; one in brackets follows an
    equals sign."""
    return bool(option["argument"]) and option["argument"][0] != "["


def takes_file(option):
    return option["argument"] == "FILE"


def of_ranks(option):
    """Whether the program with MPI alone has it."""
    return option["topic"] == "ranks"


def taken(table, verb):
    """The options of a verb that the program without MPI has."""
    return [option for option in table["options"]
            if verb["name"] in option["verbs"] and not of_ranks(option)]


def brief(text):
    """The first clause of a help text: up to a bracket or the end of a clause."""
    return re.split(r" \(|\. |; ", text, maxsplit=1)[0][:95]
