"""bench/peers/report.py - the tables of peers.py, as text and as Markdown."""
import os

LABELS = {"snowglass-draft": "Snowglass, draft",
          "snowglass": "Snowglass",
          "snowglass-high": "Snowglass, high",
          "volpack": "VolPack", "vtk-cpu": "VTK, fixed-point ray caster",
          "vtk-gl": "VTK, GPU mapper on llvmpipe", "teem": "Teem, miter"}


def machine():
    """The processor's name and the number of processors we may use."""
    name = "unknown"
    try:
        with open("/proc/cpuinfo", encoding="ascii", errors="replace") as file:
            name = next((line.split(":", 1)[1].strip() for line in file
                         if line.startswith("model name")), name)
    except OSError:
        pass
    return {"cpu": name, "processors": len(os.sched_getaffinity(0))}


def join_volpack(rows):
    """VolPack's two workers as one row, each at what it does best: a changing
    transfer function is the faster one's.  The memory of the other is told in
    `octree`."""
    octree = next((r for r in rows if r["program"] == "volpack-octree"), None)
    plain = next((r for r in rows if r["program"] == "volpack"), None)
    if not octree or not plain or "failed" in octree or "failed" in plain:
        return rows
    plain["octree"] = octree
    plain["reclassified"] = plain["change"]
    for key in ("change", "change_cpu", "change_least"):
        plain[key] = min(plain[key], octree[key])
    return [row for row in rows if row is not octree]


def number(value):
    """Three digits that matter."""
    if value is None:
        return "-"
    if value >= 100:
        return f"{value:.0f}"
    return f"{value:.1f}" if value >= 10 else f"{value:.2f}"


def rival(row, rows):
    """Our normal quality on as many threads."""
    return next((r for r in rows if r["program"] == "snowglass" and
                 r["threads"] == row["threads"] and "failed" not in r), None)


def ratio(row, rows, key):
    ours = rival(row, rows)
    if not ours or not row.get(key) or not ours.get(key):
        return ""
    return f"{row[key] / ours[key]:.1f}x"


def decibels(row, key):
    if key not in row:
        return ""
    return "equal" if row[key] is None else f"{row[key]:.1f}"


def text_of(case):
    """A case's table; "of ours" is how many times our normal quality's."""
    lines = [
        "",
        f"{case['case']}: {'x'.join(map(str, case['dims']))}, "
        f"{case['source']}; ms a picture, medians",
        f"{'':28}{'thr':>4}{'first':>8}{'turning':>9}{'least':>8}{'cpu':>8}"
        f"{'of ours':>9}{'TF new':>8}{'cpu':>8}{'of ours':>9}{'MB':>7}"
        f"{'dB':>7}{'scaled':>8}"]
    for row in case["rows"]:
        head = f"{LABELS.get(row['program'], row['program']):28}" \
               f"{row['threads']:>4}"
        if "failed" in row:
            lines.append(f"{head}  failed: {row['failed']}")
            continue
        lines.append(
            f"{head}{number(row['first']):>8}{number(row['frame']):>9}"
            f"{number(row['frame_least']):>8}{number(row['frame_cpu']):>8}"
            f"{ratio(row, case['rows'], 'frame'):>9}"
            f"{number(row['change']):>8}{number(row['change_cpu']):>8}"
            f"{ratio(row, case['rows'], 'change'):>9}"
            f"{row['megabytes']:>7.0f}{decibels(row, 'psnr'):>7}"
            f"{decibels(row, 'psnr_scaled'):>8}")
    return "\n".join(lines)


def find(case, program, threads):
    return next((r for r in case["rows"] if r["program"] == program and
                 r["threads"] == threads and "failed" not in r), None)


def both(case, program, key):
    """One thread's figure / two threads' figure."""
    said = []
    for threads in (1, 2):
        row = find(case, program, threads)
        if row and row.get(key) is not None:
            said.append(number(row[key]))
    return " / ".join(said) or "-"


def table(head, rows):
    lines = ["| " + " | ".join(head) + " |",
             "| --- |" + " ---: |" * (len(head) - 1)]
    return "\n".join(lines + ["| " + " | ".join(row) + " |" for row in rows])


def present(cases):
    return [name for name in LABELS if any(
        r["program"] == name for case in cases for r in case["rows"])]


def turning(cases):
    return table(["ms a picture, the view turns"] +
                 [case["case"].replace(":", " ") for case in cases],
                 [[LABELS[name]] + [both(case, name, "frame")
                                    for case in cases]
                  for name in present(cases)])


def changing(cases):
    return table(["ms a picture, the transfer function changes"] +
                 [case["case"].replace(":", " ") for case in cases],
                 [[LABELS[name]] + [both(case, name, "change")
                                    for case in cases]
                  for name in present(cases)])


def other(cases, key, title, digits):
    """What one thread shows of all cases."""
    rows = []
    for name in present(cases):
        row = [LABELS[name]]
        for case in cases:
            found = find(case, name, 1)
            value = found.get(key) if found else None
            row.append("-" if value is None else f"{value:.{digits}f}")
        rows.append(row)
    return table([title] + [case["case"].replace(":", " ") for case in cases],
                 rows)


def memory(cases):
    """Of the process that only turned the view; in brackets what it took
    before it had a volume: a Python with VTK is large by itself."""
    rows = []
    for name in present(cases):
        row = [LABELS[name]]
        for case in cases:
            found = find(case, name, 1)
            row.append("-" if not found else f"{found['megabytes']:.0f}" +
                       (f" ({found['idle_megabytes']:.0f})"
                        if found["idle_megabytes"] else ""))
        rows.append(row)
    return table(["peak MB (before loading), one thread"] +
                 [case["case"].replace(":", " ") for case in cases], rows)


def markdown(result, command):
    """For README files: every table, and the command that repeats them."""
    cases = result["cases"]
    if not cases:
        return "Nothing was measured.\n"
    parts = [
        f"Measured on {result['machine']['cpu']} "
        f"({result['machine']['processors']} processors), medians of "
        f"{result['turns']} whole turns, programs in turn; one thread / two "
        f"threads; Snowglass with method {result['method']}:",
        turning(cases), changing(cases),
        other(cases, "first", "ms to the first picture after loading, "
              "one thread", 0),
        memory(cases),
        other(cases, "psnr", "dB (grey) from VTK's fixed-point picture", 1),
        other(cases, "psnr_scaled", "the same, scaled to its brightness", 1),
        "    " + command]
    parts += [f"{name}: skipped, {why}."
              for name, why in result["skipped"].items()
              if not name.endswith("-octree")]
    parts += [f"{name}: left out, {why}."
              for name, why in result["left_out"].items()]
    return "\n\n".join(parts) + "\n"
