"""NumPy arrays, and grids of chemistry in text, beside NumPy itself."""
import gzip

import oracle
from oracle import np

TYPES = ["i1", "u1", "<i2", ">i2", "<u2", ">u2", "<i4", ">u4", "<i8", ">i8",
         "<u8", "<f2", ">f2", "<f4", ">f4", "<f8", ">f8", "?"]
for order in "CF":
    for kind in TYPES:
        a = oracle.sample(kind)
        np.save("a.npy", np.array(a, order=order))
        oracle.expect("a.npy", oracle.wide(a), name=f"{kind} {order}")
    for shape in [(300, 4, 1), (1, 1, 5), (9, 8), (3, 700, 900), (700, 3, 900)]:
        a = oracle.sample("<u2", shape)
        np.save("a.npy", np.array(a, order=order))
        oracle.expect("a.npy", a.reshape((1,) * (3 - a.ndim) + a.shape),
                      np.diag((1, -1, -1, 1)) if a.ndim < 3 else None,
                      name=f"{shape} {order}")
    for samples in (3, 4):  # colours, as matplotlib's imshow has them
        a = oracle.sample("u1", (9, 10, samples))
        np.save("a.npy", np.array(a, order=order))
        for channel in range(samples):
            oracle.expect("a.npy", a[None, ..., channel],
                          np.diag((1, -1, -1, 1)), ["--channel", channel],
                          name=f"picture of {samples} {order}")
    a = oracle.sample("<f4", (3, 5, 6, 7))
    b = oracle.sample("<i2", (3, 2, 5, 6, 7))
    np.save("a.npy", np.array(a, order=order))
    np.save("b.npy", np.array(b, order=order))
    for time in range(3):
        oracle.expect("a.npy", a[time], options=["--time", time])
        for channel in range(2):
            oracle.expect("b.npy", b[time, channel],
                          options=["--time", time, "--channel", channel])
    for kind in ("<f8", "u1"):  # the latter may be colours
        v = oracle.sample(kind, (5, 6, 7, 3))
        np.save("v.npy", np.array(v, order=order))
        whole = v[..., 0] if kind == "u1" else oracle.magnitude(v)
        oracle.expect("v.npy", whole, name=f"{kind} vectors {order}")
        for number, name in enumerate("xyz"):
            oracle.expect("v.npy", v[..., number],
                          options=["--component", name])
oracle.expect("v.npy", oracle.magnitude(v.astype("f4")),
              options=["--component", "magnitude"])
oracle.refuse("v.npy", "component 3 does not exist", ["--component", "w"], 2)
oracle.refuse("a.npy", "no time step 3", ["--time", 3], 2)
oracle.refuse("b.npy", "channel 2 does not exist", ["--channel", 2], 2)
halves = np.arange(1 << 16, dtype="u2").view("f2").reshape(16, 64, 64)
np.save("h.npy", halves)
if not np.array_equal(oracle.voxels_of("h.npy")[0], halves.astype("f4"),
                      equal_nan=True):
    oracle.fail("all halves", "are other floats")
np.savez("c.npz", a)
oracle.refuse("c.npz", "unzip")
np.save("d.npy", a.astype(complex))
oracle.refuse("d.npy", "float32")
with gzip.open("e.npy.gz", "wb") as file:
    np.save(file, a[0])
oracle.expect("e.npy.gz", a[0])

# Grids of chemistry's programs, which are text: cells that are no boxes, in Bohr or
# angstrom, as C and Fortran write numbers.
CELL = np.array([[4, 0.5, 0], [-1, 5, 0.25], [0.5, 0.25, 6]])
ATOMS = 2


def lines(values, a_line, form="{:13.5E}"):
    """The values, so many in a line."""
    words = [form.format(v) for v in np.ravel(values)]
    return "".join("".join(words[i:i + a_line]) + "\n"
                   for i in range(0, len(words), a_line))


def cube(values, units=(1, 1, 1), orbitals=None, each=1, a_line=6, form="{:13.5E}"):
    """values[x, y, z(, of a voxel)]."""
    n = values.shape[:3]
    text = "title\ncomment\n" + f"{ATOMS * (-1 if orbitals else 1):5d} -1.5 2. 0.25"
    text += f"{each:5d}\n" if each > 1 or orbitals else "\n"
    for i in range(3):
        text += f"{units[i] * n[i]:5d}" + "".join(f"{v:12.6f}" for v in CELL[i] / n[i]) + "\n"
    text += "    8    8.000000    0.000000    0.100000    0.200000\n" * ATOMS
    if orbitals:
        ids = [len(orbitals), *orbitals]
        text += "".join("".join(f"{v:5d}" for v in ids[i:i + 10]) + "\n"
                        for i in range(0, len(ids), 10))
    return text + "".join(lines(row, a_line, form) for plane in values for row in plane)


def cube_matrix(units, n):
    m = np.eye(4)
    scale = [0.529177210903 if unit > 0 else 1 for unit in units]
    for i in range(3):
        m[:3, i] = np.round(CELL[i] / n[i], 6) * scale[i]
    m[:3, 3] = np.array([-1.5, 2, 0.25]) * scale[0]
    return m


rng = np.random.default_rng(5)
v = np.round(rng.normal(size=(3, 4, 5)), 4) * 1e-3
def read(values):
    return np.array([float(f"{x:13.5E}") for x in np.ravel(values)]).reshape(values.shape)


for name, units in (("bohr", (1, 1, 1)), ("angstrom", (-1, -1, -1)), ("both", (1, -1, 1))):
    for a_line in (1, 5, 6, 10, 4000):
        oracle.put("a.cube", cube(v, units, a_line=a_line))
        oracle.expect("a.cube", read(v).T, cube_matrix(units, v.shape), unit="angstrom",
                      name=f"cube {name} {a_line}")
for spelled in (lambda s: s.replace("E", "D"), lambda s: s.replace("E", "e"),
                lambda s: s.replace("\n", "\r\n"), lambda s: s + "\n\n"):
    oracle.put("x.dat", spelled(cube(v, form=" {:12.5E}")))
    oracle.expect("x.dat", read(v).T, cube_matrix((1, 1, 1), v.shape), name="cube spelled")
oracle.expect(oracle.packed("x.dat", "a.cube.gz"), read(v).T,
              cube_matrix((1, 1, 1), v.shape), name="cube gzip")
oracle.says("cube", "x.dat", None)
tiny = cube(v).replace(f"{v[0, 0, 1]:13.5E}", "   0.12345-103", 1)
found, _ = oracle.voxels_of(oracle.put("a.cube", tiny))
if found is None or found[1, 0, 0] != 0.12345e-103:
    oracle.fail("cube", "an exponent of three digits")
many = np.round(rng.normal(size=(3, 4, 5, 12)), 4)
for number in (0, 1, 11):
    oracle.put("a.cube", cube(many, orbitals=range(21, 33)))
    oracle.expect("a.cube", read(many[..., number]).T, cube_matrix((1, 1, 1), v.shape),
                  ["--channel", number])
    oracle.put("b.cube", cube(many, each=12))
    oracle.expect("b.cube", read(many[..., number]).T, cube_matrix((1, 1, 1), v.shape),
                  ["--channel", number])
names = [c["name"] for c in oracle.told("a.cube").get("channels", [])]
if names[:2] != ["orbital 21", "orbital 22"]:
    oracle.fail("cube", f"orbitals {names}")
whole = cube(v)
for text, part in ((whole[:-40], "are missing"), (whole[:200], "line 7 is not"),
                   ("\n".join(whole.split("\n")[:7]), "line 8 is not"), (whole[:-14] + "  ******** ", "no number"),
                   (whole.replace("    3 ", "999999999 ", 1), "are missing")):
    oracle.refuse(oracle.put("a.cube", text), part)
oracle.refuse("b.cube", "does not exist", ["--channel", 12], 2)


def vasp(sets, scale="1.0", names=True, augmented=True, a_line=5, form="{:19.11E}"):
    """sets of values[x, y, z]."""
    n = sets[0].shape
    text = f"a crystal\n   {scale}\n"
    text += "".join("".join(f"{c:12.6f}" for c in row) + "\n" for row in CELL)
    text += ("   Si   O\n" if names else "") + "     1     1\n"
    text += ("" if names else "Selective dynamics\n") + "Direct\n"
    text += "  0.000000  0.500000  0.250000" + ("\n" if names else " T F T\n")
    text += "  0.250000  0.500000  0.250000" + ("\n" if names else " T F T\n") + "\n"
    for number, values in enumerate(sets):
        if number:
            text += lines([1.0, -1.0], 2)
        text += "".join(f"{size:5d}" for size in n) + "\n"
        text += lines(values.transpose(2, 1, 0), a_line, form)
        if augmented:
            for atom in (1, 2):
                text += f"augmentation occupancies   {atom}   7\n" + lines(rng.normal(size=7), 5)
    return text


def closed(values):
    """The first layers at the ends, too; (z, y, x)."""
    return np.pad(values, ((0, 1),) * 3, mode="wrap").transpose(2, 1, 0)


def vasp_matrix(n, factor=1.0):
    m = np.eye(4)
    m[:3, :3] = CELL.T / n * np.reshape(factor, (-1, 1))
    return m


sets = [np.array([float(f"{x:19.11E}") for x in rng.normal(size=60)]).reshape(3, 4, 5)
        for _ in range(4)]
volume = np.linalg.det(CELL)
for name, names, a_line, scale, factor in (
        ("CHGCAR", True, 5, "1.0", 1.0), ("CHG", False, 10, "2.0", 2.0),
        ("AECCAR0", True, 3, "-500.0", np.cbrt(500 / volume)),
        ("CHGCAR_sum", True, 5, "1.0 2.0 0.5", np.array([1, 2, 0.5]))):
    for count in (1, 2, 4):
        oracle.put(name, vasp(sets[:count], scale, names, name != "CHG", a_line))
        size = volume * (np.prod(factor) if np.ndim(factor) else factor ** 3)
        for number in range(count):
            oracle.expect(name, closed(sets[number]) / size,
                          vasp_matrix(sets[0].shape, factor), ["--channel", number],
                          dtype="f8", unit="angstrom", name=f"{name} {count} {number}")
            oracle.tells(name, ["--channel", number], value_unit=(
                "mu_B/angstrom^3" if number else "e/angstrom^3"))
    oracle.says(name, name, "divided by the volume of the cell", "--channel", 1)
    oracle.says(name, name, "3x4x5 become 4x5x6")
oracle.put("LOCPOT", vasp(sets[:2], augmented=False))
oracle.expect("LOCPOT", closed(sets[0]), vasp_matrix(sets[0].shape), unit="angstrom")
oracle.expect("LOCPOT", closed(sets[1]), vasp_matrix(sets[0].shape), ["--channel", "1"])
oracle.tells("LOCPOT", value_unit="eV", quantity="potential")
names = [c["name"] for c in oracle.told("CHGCAR").get("channels", [])]
if names[:2] != ["total", "magnetization x"]:
    oracle.fail("CHGCAR", f"channels {names}")
oracle.put("ELFCAR", vasp(sets[:2], augmented=False))
oracle.expect("ELFCAR", closed(sets[1]), vasp_matrix(sets[0].shape), ["--channel", "1"])
oracle.put("other", vasp(sets[:1], augmented=False))
oracle.expect("other", closed(sets[0]), vasp_matrix(sets[0].shape))
oracle.says("other", "other", "are as stored")
oracle.put("other", vasp(sets[:1]))
oracle.says("other", "other", "are divided")
whole = vasp(sets[:1], augmented=False)
for text, part in ((whole[:-40], "2 are missing"), ("\n".join(whole.split("\n")[:9]), "ends in its header"),
                   (whole.replace("    3    4    5\n", "Direct configuration= 2\n"), "sizes of its grid"),
                   (whole.replace("    3    4    5", "9999 9999 999"), "are missing")):
    oracle.refuse(oracle.put("CHGCAR", text), part)
oracle.finish()
