"""manual: manual pages, completions and the schema of recipes.

    python3 scripts/manual TABLE man [VERB|mpi]
    python3 scripts/manual TABLE header FILE
    python3 scripts/manual TABLE document N SUMMARY (FILE HEADING TITLE)...
    python3 scripts/manual TABLE bash|zsh|fish|fish-mpi|json|options|keywords

TABLE is build/table.json, the table of options, which snowglass-table writes.
Text goes to standard output: a page of the tool, of a public header or of
sections of documents, completions of a shell, the schema, the options as
Markdown, or those of Python."""
import sys

from documents import document, header
from keywords import keywords
from options import options
from pages import page
from schema import schema
from shells import bash, fish, fish_mpi, zsh
from table import load

ALONE = {"bash": bash, "zsh": zsh, "fish": fish, "fish-mpi": fish_mpi,
         "json": schema, "options": options, "keywords": keywords}


def lines(path, what, *words):
    """The text that is asked for; None: there is none."""
    table = load(path)
    if what == "man" and len(words) < 2:
        return page(table, *(words or [None]))
    if what == "header" and len(words) == 1:
        return header(table, *words)
    if what == "document" and len(words) > 4 and len(words) % 3 == 2:
        return document(table, *words)
    if what in ALONE and not words:
        return ALONE[what](table)
    return None


def main():
    made = lines(*sys.argv[1:]) if len(sys.argv) > 2 else None
    if made is None:
        sys.exit(__doc__)
    sys.stdout.reconfigure(encoding="utf-8")
    print("\n".join(made))


main()
