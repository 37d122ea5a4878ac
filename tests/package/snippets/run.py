#!/usr/bin/python3
"""run.py ROOT [SITE]: every snippet of the documents and manual pages is run, by
what is installed alone.

ROOT holds README.md and docs as they are installed, tests/cli/tool/
cli_documents.sh, which makes stand-ins for files, and fuzz/corpus/tf for it; the
manual pages are the system's.  A snippet that is not run has a reason, below; one
that nobody knows is a failure.  Of SITE, pages of the documents, each block must
be one of these snippets, or stand in an installed header or Python file.

SNOW_DATA names a folder of real volumes.  SNIPPET_SECONDS limits measurements,
which are run as long as that, and viewers, which do not end by themselves (20)."""
import collections
import functools
import os
import pathlib
import re
import subprocess
import sys
import tempfile

import find
import programs
import shells

HERE = pathlib.Path(__file__).resolve().parent

# Why a snippet is not run: of the document, and of the text.
REASONS = [
    (r"model\.md|snowglass\.7", r".*", "a formula"),
    (r".*", r"\./dev |scripts/|node tests/|(?s:SNOW_[A-Z_]+=.*(build/|ctest|\./dev))|perf |"
     r"mpicc .* bench/",
     "for the source tree, which users of packages have not"),
    (r".*", r"(module load .*\n)?cmake (-S \. )?-B|add_subdirectory",
     "builds the sources: as ./dev package debs does, and tests of them"),
    (r".*", r"ssh |srun --pty|https://", "needs other machines"),
    (r".*", r"valgrind ", "needs valgrind"),
    (r"(ct-turntable|pet-ct|microscope|simulation|python-figure|cluster|c-program)\.md",
     r"", "run with its files by scripts/tutorials, a test of the sources"),
    (r".*", r"pip install [.]", "needs scikit-build-core"),
    (r".*", r"mpirun\.mpich", "needs MPICH; the package is of Open MPI"),
    (r"dicom\.md", r"SUV = ", "a formula"),
    (r"(install|python)\.md", r".*(--target uninstall|apt-get install)",
     "removes or installs packages"),
    (r"install\.md", r"umask 022\n", "installs as an administrator"),
    (r"install\.md", r"local root = ", "needs environment modules"),
    (r"install\.md", r"mkdir -p recipes/", "needs Spack"),
    (r"movies\.md", r".*--as rgb24.*\|\n", "a pipe of two lines, which tests of movies run"),
    (r"looks\.md", r"light-grey 173", "what the tool prints"),
    (r"usage\.md", r"\(0008,0060\)", "what the tool prints"),
    (r"README\.md", r"\s*(SD|base|head\.nrrd)\s", "a figure"),
]


def documents(root):
    """Those of the site are these, and READMEs of folders of sources."""
    found = []
    for path in [root / "README.md", *sorted((root / "docs").rglob("*.md")),
                 *sorted((root / "sources").rglob("README.md"))]:
        found += find.of_markdown(str(path.relative_to(root)),
                                  path.read_text(encoding="utf-8"))
    return found


def manuals():
    found = []
    for path in sorted(pathlib.Path("/usr/share/man").glob("man*/snowglass*")):
        found += find.of_manual(path)
    return found


def kind_of(snippet):
    """The name of how it is run: a function of shells or programs; None: nobody
    knows."""
    if snippet.language:
        named = {"c": programs.c, "fortran": programs.fortran,
                 "cmake": programs.cmake, "json": programs.json_file,
                 "python": programs.python}
        return named.get(snippet.language, shells.run)
    if re.search(r"(?m)^snow_status status = ", snippet.text):
        return programs.c
    if snippet.place.split(":")[0].endswith((".3", ".3.gz")) and \
            find.plain(snippet.text) in installed_text():
        return programs.declaration
    first = snippet.text.split(None, 1)[0]
    if first.startswith("{"):
        return programs.json_file
    if re.search(r"^\s*snow_\w+ .*;$", snippet.text, re.M):
        return programs.c
    return shells.run if shells.knows(snippet) else None


def needs_volumes(snippet):
    """Whether it names real volumes, of which there are none."""
    return not shells.DATA and re.search(r"\$DATA/|--data FOLDER", snippet.text)


def reason_of(snippet):
    if needs_volumes(snippet):
        return "needs real volumes: SNOW_DATA names no folder of them"
    document = snippet.place.split(":")[0].rpartition("/")[2]
    for place, text, reason in REASONS:
        if re.fullmatch(place, document) and re.match(text, snippet.text):
            return reason
    return None


class Report:
    def __init__(self):
        self.ran, self.reasons, self.failed = collections.Counter(), \
            collections.Counter(), 0

    def run(self, snippet, folder):
        reason = reason_of(snippet)
        if reason:
            self.reasons[reason] += 1
            return
        kind = kind_of(snippet)
        fault = "nobody knows how this is run: say so in tests/package/snippets"
        if kind:
            try:
                fault = kind(snippet, folder)
            except (OSError, subprocess.SubprocessError) as error:
                fault = str(error)
            self.ran[kind.__name__] += 1
        if fault:
            self.failed += 1
            print(f"FAILED {snippet.place}: {fault}\n{snippet.text}", flush=True)
        else:
            print(f"ok     {snippet.place}", flush=True)

    def end(self):
        for reason, count in self.reasons.items():
            print(f"{count} not run: {reason}")
        kinds = ", ".join(f"{count} {name}" for name, count in
                          sorted(self.ran.items()))
        print(f"{sum(self.ran.values())} snippets run ({kinds}), "
              f"{self.failed} failed")
        return self.failed == 0 and sum(self.ran.values()) > 50


@functools.lru_cache(None)
def installed_text():
    """What headers and Python files have."""
    found = []
    for pattern in ("include/snowglass/*.h",
                    "lib/python3*/dist-packages/snowglass/*.py",
                    "share/doc/snowglass/examples/**/*.c"):
        found += [path.read_text(encoding="utf-8")
                  for path in pathlib.Path("/usr").glob(pattern)]
    text = "\n".join(found)
    return find.plain(re.sub(r"(?m)^ \* ?", "", text)) + \
        find.plain(re.sub(r"\bSNOW_API ", "", text)) + \
        find.plain(re.sub(r"\bSNOW_API |\bSNOW_RECORD\(\w+\);", "", text))


def check_site(site, snippets):
    """The number of blocks, and of those whose text is nowhere else."""
    known = {find.plain(each.text) for each in snippets}
    text, count, strange = installed_text(), 0, 0
    for page in sorted(site.rglob("*.html")):
        for block in find.of_page(page, str(page.relative_to(site))):
            count += 1
            plain = find.plain(block.text)
            if page.name == "python-api.html":  # made of what is installed
                continue
            if plain not in known and plain not in text:
                strange += 1
                print(f"FAILED {block.place}: stands in no document, header or "
                      f"Python file\n{block.text}")
    print(f"{count} blocks of the site, {strange} of them in no document")
    return strange == 0 and count > 50


def main():
    root = pathlib.Path(sys.argv[1]).resolve()
    snippets = documents(root) + manuals()
    report, seen = Report(), set()
    with tempfile.TemporaryDirectory() as place:
        files = pathlib.Path(place, "files")
        files.mkdir()
        subprocess.run(["bash", root / "tests/cli/tool/cli_documents.sh",
                        "/usr/bin/snowglass"], check=True,
                       env={**os.environ, "STAND_INS": str(files)})
        shells.prepare(files)
        for number, snippet in enumerate(snippets):
            if find.plain(snippet.text) in seen:
                continue  # of a document that is a manual page too
            seen.add(find.plain(snippet.text))
            folder = pathlib.Path(place, str(number))
            subprocess.run(["cp", "-a", files, folder], check=True)
            report.run(snippet, folder)
            subprocess.run(["rm", "-rf", folder], check=True)
    fine = report.end()
    if len(sys.argv) > 2:
        fine = check_site(pathlib.Path(sys.argv[2]), snippets) and fine
    return 0 if fine else 1


if __name__ == "__main__":
    sys.exit(main())
