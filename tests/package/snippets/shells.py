"""Snippets for a shell: lines of the tool, of MPI, of compilers, batch scripts."""
import os
import pathlib
import pty
import re
import shlex
import signal
import subprocess
import time

SECONDS = float(os.environ.get("SNIPPET_SECONDS", "20"))
DATA = os.environ.get("SNOW_DATA", "")

#: What a line may begin with.
WORDS = {"snowglass", "mpirun", "cc", "mpicc", "mpifort", "export", ".",
         "fpath=(PREFIX/share/zsh/site-functions", "source", "/usr/bin/time"}

#: The status of an empty picture: options alone may be meant for other values
#: than those of the file that stands in.
EMPTY = 7

#: Words that stand for others.
MEANT = {"FOLDER": DATA or "/nowhere", "FILE": "ct.nrrd", "LIMIT": "1G",
         "INPUT": "head.nii.gz", "N": "4", "CUT": "counted"}

#: A stand-in for Slurm: as many ranks as the script asks for.  What srun does
#: with its own options, such as to bind ranks, is left out.
SRUN = """#!/bin/sh
while case $1 in --*) ;; *) false ;; esac do shift; done
exec mpirun -n "$TASKS" "$@"
"""


def knows(snippet):
    return all(line.split()[0] in WORDS or line.startswith(("--", "https://"))
               for line in snippet.lines)


def prepare(files):
    """Files that lines beside those of the tool name."""
    examples = "/usr/share/doc/snowglass/examples"
    for source, name in (("minimal.c", "program.c"),
                         ("insitu/heat.f90", "program.f90"),
                         ("insitu/heat.json", "heat.json")):
        subprocess.run(["cp", f"{examples}/{source}", files / name], check=True)
    subprocess.run(["cp", "/usr/include/snowglass/snowglass.f90", files],
                   check=True)
    frame = (pathlib.Path(__file__).parent / "frames" / "simulation.c").read_text()
    (files / "simulation.c").write_text(
        frame.replace("INCLUDES", "#include <snowglass/mpi.h>")
        .replace("SNIPPET", "snow_insitu *movie = NULL;\n"
                 "snow_insitu_new_mpi(NULL, comm, &movie);\n"
                 "snow_insitu_free(movie);"))
    # Another prefix than /usr, as files of Debian do not lie in zsh's own.
    share = files / "PREFIX" / "share"
    subprocess.run(["mkdir", "-p", share / "zsh"], check=True)
    for name, place in (("bash-completion", "bash-completion"),
                        ("fish", "fish"),
                        ("zsh/site-functions", "zsh/vendor-completions")):
        (share / name).symlink_to(f"/usr/share/{place}")
    for name, phantom in (("big", "shells"), ("run", "head"),
                          ("volume", "head")):
        subprocess.run(["snowglass", "phantom", phantom, "--dims", "32x32x32",
                        "-q", "-o", files / f"{name}.nrrd"], check=True)
    (files / "study").mkdir()
    subprocess.run(["cp", files / "run.nrrd", files / "volume.nrrd", files / "study"],
                   check=True)
    (files / "bin").mkdir()
    (files / "bin" / "srun").write_text(SRUN)
    (files / "bin" / "srun").chmod(0o755)
    write_hdf5(files / "run.h5")


def write_hdf5(path):
    import h5py
    import numpy
    with h5py.File(path, "a") as file:  # beside the steps that are there
        file["density"] = numpy.indices((16, 16, 16)).sum(0).astype("f4")


def run(snippet, folder):
    """What is wrong, or None."""
    text = re.sub("|".join(rf"(?<=\s){name}\b" for name in MEANT),
                  lambda match: MEANT[match.group(0)], snippet.text)
    if "#SBATCH" in text:
        return job(text, folder)
    for line in snippet._replace(text=text).lines:
        fault = run_line(line, folder)
        if fault:
            return f"{line}: {fault}"
    return None


def environment(**more):
    return {**os.environ, "PATH": "bin:" + os.environ["PATH"],
            "DATA": DATA, **more}


def run_line(line, folder):
    if line.startswith("https://"):  # what a browser would be given
        return None
    line = re.sub(r"--map-by \S+ --bind-to core|-n \d\d+", "-n 2", line)
    alone = line.startswith("--")  # options
    if alone:
        line = f"snowglass head.nii.gz -o new.png -q {line}"
    shell = re.search(r"# (zsh|bash)\b", line)
    shell = shell.group(1) if shell else \
        "fish" if line.startswith("source ") else "bash"
    words = shlex.split(line, comments=True) if shell == "bash" else []
    for n, word in enumerate(words[:-1]):  # what it writes is not there yet
        if word in ("-o", "--save-config", "--stats"):
            subprocess.run(["rm", "-rf", words[n + 1]], cwd=folder, check=True)
    command = [shell, "-c", line]
    if "serve" in words[:2] or words[:1] == ["mpirun"] and "serve" in words:
        return viewer(words, folder)
    if "--show" in words:
        return terminal(command, folder)
    measured = "bench" in words
    process = subprocess.Popen(command, cwd=folder, env=environment(),
                               stdin=subprocess.DEVNULL, text=True,
                               stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                               start_new_session=True)
    try:
        said = process.communicate(timeout=SECONDS if measured else 600)[0]
    except subprocess.TimeoutExpired:
        os.killpg(process.pid, signal.SIGTERM)
        process.communicate()
        return None if measured else "does not end"
    if process.returncode and not (alone and process.returncode == EMPTY):
        return f"status {process.returncode}: {said[-600:]}"
    return None


def end_by_signal(process):
    """Whether it ends.  Of many ranks mpirun itself may need the signal twice."""
    for _ in range(2):
        process.terminate()
        try:
            process.wait(60)
            return True
        except subprocess.TimeoutExpired:
            pass
    process.kill()
    process.wait()
    return False


def viewer(words, folder):
    """Shows its URL, answers, and ends with a signal."""
    os.makedirs("/run/user/1000", mode=0o700, exist_ok=True)
    if "--live" in words:  # of a running simulation
        (folder / words[words.index("--live") + 1]).write_text(
            '{"output": "u_%04d.png", "reread": true}')
    with open(folder / "said", "w+b") as said:
        process = subprocess.Popen(words, cwd=folder, env=environment(),
                                   stdout=said, stderr=said)
        end = time.monotonic() + SECONDS
        while time.monotonic() < end and process.poll() is None:
            if re.search(rb"https?://\S+", (folder / "said").read_bytes()):
                break
            time.sleep(0.1)
        text = (folder / "said").read_text()
        code = process.poll()
        ended = end_by_signal(process)
    if not ended:
        return "does not end by a signal"
    if code is not None or "://" not in text:
        return f"shows no URL: {text}"
    return None


def terminal(command, folder):
    """With a terminal as its output."""
    master, slave = pty.openpty()
    process = subprocess.Popen(command, cwd=folder, stdin=slave, stdout=slave,
                               stderr=slave, start_new_session=True,
                               env=environment(TERM="xterm-256color"))
    os.close(slave)
    said = b""
    try:
        while part := os.read(master, 65536):
            said += part
    except OSError:  # the terminal's end
        pass
    os.close(master)
    if process.wait() or len(said) < 500:
        return f"status {process.returncode}: {said[-300:]!r}"
    return None


def job(text, folder):
    """A batch script, with a stand-in for srun."""
    def wanted(name, otherwise):
        found = re.search(rf"(?m)^#SBATCH --{name}=(\d+)", text)
        return int(found.group(1)) if found else otherwise
    tasks = wanted("ntasks", wanted("nodes", 1) * wanted("ntasks-per-node", 1))
    done = subprocess.run(
        ["sh", "-eu", "-c", text], cwd=folder, capture_output=True, text=True,
        env=environment(TASKS=str(tasks), SLURM_ARRAY_TASK_ID="1",
                        SLURM_CPUS_PER_TASK=str(wanted("cpus-per-task", 1))),
        timeout=600)
    return f"status {done.returncode}: {done.stderr[-600:]}" \
        if done.returncode else None
