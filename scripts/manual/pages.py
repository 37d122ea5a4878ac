"""Manual pages of the tool and its verbs."""
from roff import chars, head, item, macro, text
from table import names, of_ranks, takes_word

EXAMPLES = ["snowglass phantom:engine -o engine.png --azimuth 30 --elevation 20",
            "snowglass head.nii.gz -o head.png --preset ct-bone -s 1024x1024",
            "snowglass turntable head.nii.gz -o head.webp --frames 60",
            "snowglass info volume.nrrd --json"]

# What a status means for the tool, where the library's words are about a call,
# and the one that the tool alone has.
STATUSES = {
    2: "the command line is wrong: an unknown option or verb, a value out of its "
       "range, or options that exclude one another",
    7: "the picture is written, but it is empty",
    130: "interrupted by SIGINT (Ctrl-C), SIGTERM or SIGHUP; no file is left "
         "unfinished, and a movie keeps its finished frames for --resume"}

# What options mean for a verb whose output is neither a picture nor a volume.
OF_VERB = {("report", "output"): "text file that the report is written to, after it "
                                 "is shown"}


# --- parts of pages -----------------------------------------------------------

def title(table, name, summary):
    return [head(table, name, 1, "the table of options"),
            f"{chars(name)} \\- {text(summary)}"]


def option_item(option):
    letter = f"\\-{option['letter']}\\fR, \\fB" if option["letter"] else ""
    argument = ""
    if option["argument"]:
        argument = f"{' ' if takes_word(option) else ''}\\fI" \
            f"{chars(option['argument'])}\\fR"
    return f".TP\n\\fB{letter}\\-\\-{chars(option['name'])}\\fR{argument}\n" + \
        text(option["text"])


def topic_items(topic, options):
    """The options of a topic, below its heading."""
    found = [option for option in options if option["topic"] == topic["name"]]
    if not found:
        return []
    mpi = " (snowglass-mpi)" if of_ranks(found[0]) else ""
    return [macro(".SS", f"{topic['name']}: {topic['text']}{mpi}")] + \
        [option_item(option) for option in found]


def name_list(heading, rows, described=True):
    """Names of the library, with what it says of them."""
    if described:
        return [macro(".SS", heading)] + [item(row["name"], row["text"])
                                          for row in rows]
    return [macro(".SS", heading),
            ",\n".join(chars(name) for name in names(rows)) + "."]


def see_also(pages):
    return [".SH SEE ALSO"] + [f".BR {chars(page)} (1)," for page in pages] + [
        ".BR snowglass (3),\n.BR snowglass (5),\n.BR snowglass (7)",
        text("and the documents in the folder share/doc/snowglass.")]


def statuses(table):
    texts = {row["value"]: row["text"] for row in table["statuses"]} | STATUSES
    return [".SH EXIT STATUS"] + [
        item(str(value), words[0].upper() + words[1:] + ".")
        for value, words in sorted(texts.items())]


# --- pages --------------------------------------------------------------------

def verb_page(table, verb):
    name = f"snowglass-{verb['name']}"
    out = title(table, name, verb["text"])
    out += [f".SH SYNOPSIS\n.B snowglass {verb['name']}", text(verb["usage"]),
            ".SH DESCRIPTION"]
    if verb["name"] == "bench":
        out.append(text('It has options of its own, which "snowglass bench --help" '
                        "prints."))
    else:
        out += [text(f"Verb of the tool: {verb['text']}."), ".SH OPTIONS"]
        options = [option | {"text": OF_VERB.get((verb["name"], option["name"]),
                                                 option["text"])}
                   for option in table["options"] if verb["name"] in option["verbs"]]
        for topic in table["topics"]:
            out += topic_items(topic, options)
    if verb["name"] == "phantom":
        out += name_list("Phantoms", table["phantoms"])
    return out + see_also(["snowglass"])


def mpi_page(table):
    out = title(table, "snowglass-mpi", "volume rendering on many processes of MPI")
    out += [".SH SYNOPSIS\n.B mpirun \\-n\n.I N\n.B snowglass\\-mpi\nVERB ...",
            ".SH DESCRIPTION",
            text("The tool snowglass under MPI: N processes make the same picture, "
                 "each of its part of the volume. Verbs and options are those of "
                 "snowglass, and those below. Start it with the launcher of the MPI "
                 "that it was built with."), ".SH OPTIONS"]
    for topic in table["topics"]:
        out += topic_items(topic, filter(of_ranks, table["options"]))
    return out + see_also(["snowglass"])


def overview(table):
    out = title(table, "snowglass", "volume rendering by sparse splatting")
    out += [".SH SYNOPSIS\n.B snowglass\n.I INPUT\n.B \\-o\n.I OUT.png\n[OPTIONS]\n"
            ".br\n.B snowglass\n.I VERB\n\\&... [OPTIONS]\n.SH DESCRIPTION",
            text("INPUT is a volume file, phantom:NAME, or - for standard input. "
                 "Each verb has a manual page, such as snowglass-render(1), with "
                 'its options. "snowglass help TOPIC" prints the options of a '
                 "topic.")]
    for heading in ("verbs", "topics"):
        out.append(f".SH {heading.upper()}")
        out += [item(row["name"], row["text"]) for row in table[heading]]
    out.append(".SH NAMES")
    out += name_list("Presets", table["presets"])
    out += name_list("Colour maps", table["colormaps"], False)
    out += name_list("Views", table["views"], False)
    out += name_list("Formats", table["formats"])
    out += name_list("Phantoms", table["phantoms"])
    out += statuses(table) + [
        ".SH ENVIRONMENT",
        item("SLURM_CPUS_PER_TASK, SLURM_CPUS_ON_NODE",
             "processors that Slurm assigned; no more threads are started."),
        item("PATH", "where ffmpeg, which encodes movies, is searched."),
        item("TERM", "whether progress is a status line."),
        ".SH FILES",
        item("share/snowglass/recipe.schema.json",
             "JSON schema of the files of --config and --save-config."),
        item("lib/snowglass-*/",
             "modules for formats, beside the library or the tool's folder."),
        ".SH EXAMPLES\n.EX", *map(chars, EXAMPLES), ".EE"]
    return out + see_also(f"snowglass-{name}" for name in names(table["verbs"]))


def page(table, name):
    """The page of a verb, of "mpi", or of the tool; None: there is none."""
    if not name:
        return overview(table)
    if name == "mpi":
        return mpi_page(table)
    for verb in table["verbs"]:
        if verb["name"] == name:
            return verb_page(table, verb)
    return None
