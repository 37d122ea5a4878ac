"""The table of options as Markdown, for the pages of the site."""
from table import takes_word


def cell(text):
    """A bar would end the cell."""
    return text.replace("|", "\\|").replace("<", "&lt;")


def option_row(option):
    letter = f"-{option['letter']}`, `" if option["letter"] else ""
    argument = (option["argument"] or "").replace("|", "\\|")
    space = " " if takes_word(option) else ""
    return f"| `{letter}--{option['name']}{space}{argument}` | " \
        f"{cell(option['text'])} | {', '.join(option['verbs'])} |"


def options(table):
    """The verbs, and a table for each topic."""
    out = ["## Verbs\n\n| verb | does |\n| --- | --- |"]
    out += [f"| `{verb['name']}` | {cell(verb['text'])} |" for verb in table["verbs"]]
    for topic in table["topics"]:
        out.append(f"\n## {topic['name']}: {topic['text']}\n\n"
                   "| option | meaning | verbs |\n| --- | --- | --- |")
        out += [option_row(option) for option in table["options"]
                if option["topic"] == topic["name"]]
    return out
