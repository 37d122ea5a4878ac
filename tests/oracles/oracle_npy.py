"""NumPy arrays beside NumPy itself."""
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
oracle.finish()
