#!/usr/bin/env python3
"""Combining on simulated clusters, and whole pictures, beside what they are meant
to reach.

usage: simulate.py [--quick | --long] [--build FOLDER] [--only WORD]
                   [--tools FOLDER] [--write]

Builds bench/combine/mpi_combine.c with SimGrid's smpicc out of the very sources
of the library, writes the platforms, runs every case, and prints one line for
each.  --quick leaves out what takes minutes and what this machine's speed has a
part in, --long adds 4,096 nodes and large pictures; --only runs the cases whose
name contains a word.  Exit status 1 when a target is missed at assumed rates,
77 when there is no smpicc.

At assumed rates simulated times are exactly repeatable: they do not depend on
the machine that simulates, nor on its load.  At measured rates computing takes
what `snowglass bench combine --rates` of this run found on this machine, for all
its processors; and whole pictures take what the ranks of `snowglass bench frame`
worked.  Both need the tools of --tools (build/).  --write puts these tables into
docs/measurements/combining.md.
"""
import argparse
import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent.parent

# What the program is made of: nothing that renders.  Pictures in files are PNG
# and what else needs no further library.
SOURCES = ["bench/combine/*combine*.c", "bench/hosts.c", "bench/line.c", "bench/option_table.c",
           "src/combine/*.c", "src/simd/isa.c", "src/comm/*.c", "src/base/*.c",
           "src/io/*.c", "src/io/filters/*.c", "src/image/*.c",
           "src/mpi/comm_mpi.c", "src/mpi/messages.c"]
ABSENT = [f"-DSNOW_HAVE_{name}=0" for name in ("EXR", "TIFF", "WEBP")]

# --- networks ----------------------------------------------------------------

SPEED = 1_000_000_000  # flop/s of a simulated processor; work is told in s


class Network:
    """A kind of cluster: bandwidth in bytes/s and latency in s from node to
    node, and what a message costs the processors at each end."""

    def __init__(self, bandwidth, latency, overhead, topology=None):
        self.bandwidth, self.latency = bandwidth, latency
        self.overhead, self.topology = overhead, topology

    def platform(self, nodes):
        # A route is one link up and one down; in the fat tree two of each; in
        # the dragonfly five within a group, and two more between groups.
        links, extra = 2, 'sharing_policy="SPLITDUPLEX"'
        if self.topology == "fat":
            links = 4
            extra += f' topology="FAT_TREE" topo_parameters="{fat(nodes)}"'
        if self.topology == "dragonfly":
            links = 5
            extra += (f' topology="DRAGONFLY" '
                      f'topo_parameters="{DRAGONFLIES[nodes]}"')
        return f"""<?xml version='1.0'?>
<!DOCTYPE platform SYSTEM "https://simgrid.org/simgrid.dtd">
<platform version="4.1">
  <cluster id="cluster" prefix="node" suffix="" radical="0-{nodes - 1}"
           speed="{SPEED}f" bw="{self.bandwidth:.0f}Bps"
           lat="{self.latency / links:.4g}s" {extra}/>
</platform>
"""


def fat(nodes):
    """Two levels of switches, as many links up as down."""
    below = {32: 8, 128: 16, 1024: 32, 4096: 64}[nodes]
    return f"2;{below},{nodes // below};1,{below};1,1"


# Groups, chassis, routers and nodes, with the links between them.
DRAGONFLIES = {32: "2,4;2,2;4,1;2", 128: "4,4;2,4;8,1;2",
               1024: "8,8;4,4;16,1;2"}

NETWORKS = {
    "flat": Network(12.5e9, 1e-6, 3e-7),          # 100 Gb/s crossbar
    "fat tree": Network(12.5e9, 1e-6, 3e-7, "fat"),
    "dragonfly": Network(12.5e9, 1e-6, 3e-7, "dragonfly"),
    "10 Gb/s": Network(1.25e9, 20e-6, 5e-6),      # Ethernet, TCP
    "SP2": Network(35e6, 40e-6, 10e-6),           # the paper's machine
}

# --- cases -------------------------------------------------------------------

# The paper's combining stage: whole pictures of floats up a binary tree.  What
# counts is the moment when the display processor has them.
PAPER = ["--method", "tree", "--whole"]
# Pieces of a picture that is not warped afterwards may be interlaced.
OURS = ["--pieces", "interlaced"]
# One rank's work is not counted, as it was not in the figures of others.
NO_WORK = ["--scan", "0", "--blend", "0"]


class Case:
    """`value`: the key that has a target; `target`: the most it may be;
    `ratio`: the most that total / bound may be; `factor`: how many times slower
    the case named must be."""

    def __init__(self, name, network, ranks, size, options, value="total_ms",
                 target=None, ratio=None, factor=None, tier="quick"):
        self.name, self.network, self.ranks = name, network, ranks
        self.size, self.options, self.value = size, options, value
        self.target, self.ratio, self.factor = target, ratio, factor
        self.tier = tier


def cases():
    # With pixels, and compared with the picture of a chain.
    yield Case("checked-128", "flat", 128, 256, OURS + ["--check"])
    quick = {32: (0.60, 2.5, 13), 128: (0.48, 2.0, 23), 1024: (0.41, 1.65, 40)}
    for ranks, (target, ratio, times) in quick.items():
        paper = f"paper-{ranks}"
        # A thousand whole pictures take their time.
        tier = "quick" if ranks < 1024 else "usual"
        yield Case(paper, "flat", ranks, 1024, PAPER, "exchange_ms", tier=tier)
        yield Case(f"ours-{ranks}", "flat", ranks, 1024, OURS, target=target,
                   ratio=ratio, factor=(times, paper))
        yield Case(f"in-order-{ranks}", "flat", ranks, 1024, [],
                   tier="quick" if ranks < 1024 else "usual")
    yield Case("exchange-32", "flat", 32, 1024, OURS + NO_WORK, "exchange_ms",
               0.265)
    yield Case("exchange-128-small", "flat", 128, 256, OURS + NO_WORK,
               "exchange_ms", 0.015)
    yield Case("exchange-256-small", "flat", 256, 256, OURS + NO_WORK,
               "exchange_ms", 0.022)
    for ranks in (32, 128):
        for method in ("tree", "swap", "direct"):
            if (ranks, method) == (128, "direct"):
                continue  # the simulator takes too long over so many flows
            yield Case(f"{method}-{ranks}", "flat", ranks, 1024,
                       OURS + ["--method", method], tier="usual")
        for radix in (4, 8):
            yield Case(f"radix{radix}-{ranks}", "flat", ranks, 1024,
                       OURS + ["--method", "radix", "--radix", str(radix)],
                       tier="usual")
    for ranks, tier in ((32, "usual"), (128, "usual"), (1024, "long")):
        yield Case(f"fat-{ranks}", "fat tree", ranks, 1024, OURS, tier=tier)
    for ranks in (32, 64):
        yield Case(f"ethernet-paper-{ranks}", "10 Gb/s", ranks, 1024, PAPER,
                   "exchange_ms", tier="usual")
        yield Case(f"ethernet-{ranks}", "10 Gb/s", ranks, 1024, OURS,
                   tier="usual")
    # The paper's pictures, on its machine: 256 x 256, grey; 100 ns a pixel.
    slow = ["--grey", "--scan", "40e-9", "--blend", "100e-9"]
    yield Case("sp2-paper-32", "SP2", 32, 256, PAPER + slow, "exchange_ms",
               tier="usual")
    yield Case("sp2-32", "SP2", 32, 256, OURS + slow, tier="usual")
    for ranks, target, tier in ((32, 8.1, "usual"), (128, 7.3, "long"),
                                (1024, 6.6, "long")):
        yield Case(f"large-{ranks}", "flat", ranks, 4096, OURS, target=target,
                   tier=tier)
    yield Case("paper-4096", "flat", 4096, 1024, PAPER, "exchange_ms",
               tier="long")
    yield Case("ours-4096", "flat", 4096, 1024, OURS, target=0.42, ratio=1.7,
               factor=(40, "paper-4096"), tier="long")


# What a picture of 1024x1024 is to take at measured rates.
AIMS = {32: 0.60, 128: 0.48, 1024: 0.41, 4096: 0.42}

# Whole pictures: a built-in volume, and the ranks that predictions are made for
# and that real ones are compared with.
PHANTOM = ["phantom", "head", "--dims", "256x256x256"]
PICTURE = ["--size", "1024", "--azimuth", "20", "--elevation", "20",
           "--no-check", "--json"]
PREDICTED, REAL = (1, 2, 4, 8, 32), (1, 2, 4)

TIERS = {"quick": ["quick"], "usual": ["quick", "usual"],
         "long": ["quick", "usual", "long"]}

# --- running -----------------------------------------------------------------


def build(folder):
    folder.mkdir(parents=True, exist_ok=True)
    program = folder / "combine"
    sources = [str(path) for pattern in SOURCES
               for path in sorted(ROOT.glob(pattern))]
    subprocess.run(["smpicc", "-std=c11", "-O2", "-ffp-contract=off",
                    "-D_POSIX_C_SOURCE=200809L", *ABSENT, '-DSNOW_VERSION="simulated"',
                    f"-I{ROOT}/include",
                    f"-I{ROOT}/src", f"-I{ROOT}/bench", f"-I{ROOT}/bench/combine", *sources, "-o",
                    str(program), "-lpng", "-lz", "-lm", "-lpthread"], check=True)
    return program


def settings(network):
    """The simulator's, with the reason for each."""
    overhead = f"0:{network.overhead:g}:0"
    return [
        "--log=root.thres:critical",
        # Its own factors are those of an old network's TCP.
        "--cfg=smpi/lat-factor:0:1", "--cfg=smpi/bw-factor:0:0.97",
        # A processor is busy so long with each message it starts or gets.
        f"--cfg=smpi/os:{overhead}", f"--cfg=smpi/or:{overhead}",
        f"--cfg=smpi/ois:{overhead}",
        # Work is what the program says it is, not what this machine needs.
        "--cfg=smpi/simulate-computation:no", f"--cfg=smpi/host-speed:{SPEED}",
        # Collectives by logarithmic algorithms; only the start uses any.
        "--cfg=smpi/coll-selector:ompi", "--cfg=smpi/allreduce:rdb",
        "--cfg=smpi/shared-malloc-blocksize:67108864",
    ]


def run(program, folder, case):
    network = NETWORKS[case.network]
    stem = f"{case.network.replace(' ', '').replace('/', '')}{case.ranks}"
    platform, hosts = folder / f"{stem}.xml", folder / f"{stem}.hosts"
    platform.write_text(network.platform(case.ranks))
    hosts.write_text("".join(f"node{i}\n" for i in range(case.ranks)))
    bound = ["--alpha", str(network.latency + network.overhead + 2e-7),
             "--beta", str(1 / (0.97 * network.bandwidth))]
    command = ["smpirun", "-np", str(case.ranks), "-platform", str(platform),
               "-hostfile", str(hosts), *settings(network), str(program),
               "--json", "--size", str(case.size), *bound, *case.options]
    if "--check" not in case.options:
        command.append("--sizes-only")
    return said(command)


# --- this machine -------------------------------------------------------------


def said(command, **more):
    """The JSON object that a command prints."""
    done = subprocess.run(command, capture_output=True, text=True, **more)
    lines = [line for line in done.stdout.splitlines() if line.startswith("{")]
    if done.returncode or len(lines) != 1:
        sys.exit(f"{' '.join(command)} failed:\n{done.stdout}{done.stderr}")
    return json.loads(lines[0])


def processors():
    return len(os.sched_getaffinity(0))


def rates(tools, ranks, size):
    """What the threads of one of so many ranks take on this machine; rounding
    and moving have one thread."""
    command = [str(tools / "snowglass-bench"), "combine", "--rates", "--json",
               "--ranks", str(ranks), "--size", str(size), "--runs", "12"]
    found = said(command + ["--threads", str(processors())])
    alone = found if processors() == 1 else said(command)
    return found | {key: alone[key] for key in ("round_ns", "move_ns")}


def as_options(found):
    return [word for key in ("scan", "blend", "round", "move")
            for word in (f"--{key}", f"{found[key + '_ns'] * 1e-9:.4g}")]


def table(heads, rows):
    return "\n".join("| " + " | ".join(map(str, row)) + " |" for row in
                     [heads, ["---:"] * len(heads), *rows])


def measured_rates(options, program, tiers):
    """Table: combining at the rates that are measured now."""
    rows = []
    for ranks, aim in AIMS.items():
        if ranks > 1024 and "long" not in tiers:
            continue
        found = rates(options.tools, ranks, 1024)
        row = [f"{ranks:,}"]
        row += [f"{found[key]:.2f}" for key in ("scan_ns", "blend_ns",
                                                "round_ns", "move_ns")]
        row += [f"{found['over_copy']:.2f}"]
        for network in ("flat", "fat tree", "dragonfly"):
            if network != "flat" and (ranks > 128 and "long" not in tiers
                                      or ranks > 1024):
                row.append("-")
                continue
            result = run(program, options.build, Case(
                f"measured-{ranks}", network, ranks, 1024,
                OURS + as_options(found)))
            if network == "flat":
                row += [f"{result['exchange_ms']:.3f}",
                        f"{result['gather_ms']:.3f}"]
            row.append(f"{result['total_ms']:.3f}")
        rows.append(row[:6] + row[6:8] + [f"**{row[8]}**", aim] + row[9:])
    return table(["nodes", "scan", "composite", "round", "move 16 bytes",
                  "over a copy", "exchange", "gather", "picture", "aim",
                  "fat tree", "dragonfly"], rows)


# --- whole pictures -----------------------------------------------------------

# More ranks than processors, and in containers as root.
MPI = {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
       "OMPI_MCA_rmaps_base_oversubscribe": "1", "OMP_NUM_THREADS": "1",
       "OMPI_MCA_hwloc_base_binding_policy": "none"}


def frame(options, ranks, runs, *more, real=False):
    """Figures of one whole picture, by simulated ranks or by those of MPI."""
    tools, volume = options.tools.resolve(), options.build / "head.nrrd"
    if not volume.exists():
        subprocess.run([str(tools / "snowglass"), *PHANTOM, "-q", "-o",
                        str(volume)], check=True)
    if real:
        launcher = shutil.which("mpirun.openmpi") or "mpirun"
        program = [launcher, "-n", str(ranks), str(tools / "snowglass-mpi"),
                   "bench", "frame"]
    else:
        program = [str(tools / "snowglass-bench"), "frame", "--ranks",
                   str(ranks), "--network", "1e-6,12.5e9,3e-7"]
    return said([*program, str(volume), *PICTURE, "--runs", str(runs), *more],
                env={**os.environ, **MPI})


def least(results, key):
    return min(result[key] for result in results)


def whole_pictures(options, runs=12, turns=3):
    """Table: what ranks are predicted to work, and what real ones do, in turn.
    A splat three times as fast leaves all else as it is."""
    rows, alone, alone_fast = [], None, None
    for ranks in PREDICTED:
        simulated, real = [], []
        for _ in range(turns):
            simulated.append(frame(options, ranks, runs))
            if ranks in REAL:
                real.append(frame(options, ranks, runs, real=True))
        slowest, mean = (least(simulated, f"work_least{key}_ms")
                         for key in ("", "_mean"))
        projected = least(simulated, "projected_ms")
        splat = least(simulated, "splat_least_ms")
        fast = projected - splat * 2 / 3
        alone, alone_fast = alone or projected, alone_fast or fast
        row = [ranks, f"{splat:.2f}", f"{slowest:.2f}", f"{mean:.2f}"]
        if real:
            found = least(real, "work_least_mean_ms")
            row += [f"{least(real, 'work_least_ms'):.2f}", f"{found:.2f}",
                    f"{100 * (mean / found - 1):+.0f} %"]
        else:
            row += ["", "", ""]
        rows.append(row + [f"{projected:.2f}", f"{projected - splat:.2f}",
                           f"{100 * alone / projected / ranks:.0f} %",
                           f"{100 * alone_fast / fast / ranks:.0f} %"])
    return table(["ranks", "slowest splat", "slowest rank, predicted", "mean",
                  "slowest, MPI", "mean", "prediction", "picture",
                  "beside the splat", "efficiency",
                  "with a splat three times as fast"], rows)


def profiles(options, program):
    """Table: whole pictures on simulated networks, by a profile of real work."""
    rows = []
    for ranks in (32, 128):
        profile = options.build / f"profile{ranks}"
        frame(options, ranks, 6, "--profile", str(profile.resolve()))
        work = [float(line.split()[0])
                for line in profile.read_text().splitlines()]
        row = [ranks, f"{1e3 * max(work):.2f}"]
        found = rates(options.tools, ranks, 1024)
        for network in ("flat", "fat tree", "dragonfly"):
            row.append(f"""{run(program, options.build, Case(
                f"whole-{ranks}", network, ranks, 1024,
                as_options(found) + ["--profile", str(profile.resolve())]
                ))['total_ms']:.2f}""")
        rows.append(row)
    return table(["ranks", "slowest splat and what precedes it", "crossbar",
                  "fat tree", "dragonfly"], rows)


def of_this_machine(options, program, tiers):
    """Tables in whose figures this machine has a part."""
    makers = {"measured": lambda: measured_rates(options, program, tiers),
              "whole": lambda: whole_pictures(options),
              "profiles": lambda: profiles(options, program)}
    for name, make in makers.items():
        if options.only not in name:
            continue
        text = make()
        print(f"\n{name}\n{text}", flush=True)
        if options.write:
            kept = options.build / f"{name}.md"
            kept.write_text(text + "\n")
            subprocess.run([str(ROOT / "scripts" / "measurements"), "--from",
                            f"{name}={kept}", name], check=True)


# --- output -------------------------------------------------------------------

HEADINGS = ("case", "network", "nodes", "image", "k", "exchange", "gather",
            "total", "bound", "ratio", "target", "times", "")
LAYOUT = ("{:<19} {:<8} {:>5} {:>5} {:>10} {:>9} {:>8} {:>9} {:>7} {:>6} "
          "{:>15} {:>11} {}")


def judge(case, result, slow):
    """(target's text, factor's text, whether all is reached)."""
    wanted, good = [], True
    if case.target is not None:
        wanted.append(f"{case.value.removesuffix('_ms')} {case.target:g}")
        good = good and result[case.value] <= case.target
    if case.ratio is not None:
        wanted.append(f"x{case.ratio:g}")
        good = good and result["ratio"] <= case.ratio
    times = ""
    if case.factor and case.factor[1] in slow:
        factor = slow[case.factor[1]] / result["total_ms"]
        times = f"{factor:.1f} >= {case.factor[0]}"
        good = good and factor >= case.factor[0]
    return " ".join(wanted), times, good


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    tier = parser.add_mutually_exclusive_group()
    tier.add_argument("--quick", action="store_true")
    tier.add_argument("--long", action="store_true")
    parser.add_argument("--build", type=Path,
                        default=ROOT / "build" / "simulate")
    parser.add_argument("--tools", type=Path, default=ROOT / "build")
    parser.add_argument("--only", default="")
    parser.add_argument("--write", action="store_true")
    options = parser.parse_args()
    if not shutil.which("smpicc"):
        print("there is no smpicc: install libsimgrid-dev")
        return 77
    name = "quick" if options.quick else "long" if options.long else "usual"
    program = build(options.build)
    print("simulated milliseconds at assumed rates; in-order: pieces as they are before a warp")
    print(LAYOUT.format(*HEADINGS))
    missed, slow = [], {}
    for case in cases():
        if case.tier not in TIERS[name] or options.only not in case.name:
            continue
        result = run(program, options.build, case)
        slow[case.name] = result[case.value]
        target, times, good = judge(case, result, slow)
        if not good:
            missed.append(case.name)
        print(LAYOUT.format(
            case.name, case.network, case.ranks, case.size, result["k"][:10],
            f"{result['exchange_ms']:.4f}", f"{result['gather_ms']:.4f}",
            f"{result['total_ms']:.4f}", f"{result['bound_ms']:.4f}",
            f"{result['ratio']:.2f}", target, times,
            "" if good else "MISSED"), flush=True)
    if not options.quick:
        of_this_machine(options, program, TIERS[name])
    if missed:
        print("missed:", *missed)
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main())
