"""NumPy arrays beside NumPy itself."""
import sys

try:
    import numpy as np
except ImportError as missing:
    print("skip  ", missing)
    sys.exit(77)
import oracle

place = oracle.folder()
TYPES = ["i1", "u1", "<i2", ">i2", "<u2", ">u2", "<i4", ">u4", "<i8", ">i8",
         "<u8", "<f2", ">f2", "<f4", ">f4", "<f8", ">f8", "?"]
WIDER = {"f2": np.float32, "b1": np.uint8}

for kind in TYPES:
    a = oracle.sample(kind)
    wide = WIDER.get(a.dtype.str[1:], np.dtype(a.dtype.newbyteorder("=")))
    for order in "CF":
        np.save("a.npy", np.array(a, order=order))
        oracle.expect("a.npy", a.astype(wide), name=f"{kind} {order}")

for shape in [(300, 4, 1), (1, 1, 5), (9, 8), (3, 700, 900), (700, 3, 900)]:
    a = oracle.sample("<u2", shape)
    for order in "CF":
        np.save("a.npy", np.array(a, order=order))
        oracle.expect("a.npy", a.reshape((1,) * (3 - a.ndim) + a.shape),
                      name=f"{shape} {order}")

a = oracle.sample("<f4", (3, 5, 6, 7))
b = oracle.sample("<i2", (3, 2, 5, 6, 7))
for order in "CF":
    np.save("a.npy", np.array(a, order=order))
    np.save("b.npy", np.array(b, order=order))
    for time in range(3):
        oracle.expect("a.npy", a[time], options=["--time", time])
        for channel in range(2):
            oracle.expect("b.npy", b[time, channel],
                          options=["--time", time, "--channel", channel])
oracle.refuse("a.npy", "no time step 3", ["--time", 3], 2)
oracle.refuse("b.npy", "channel 2 does not exist", ["--channel", 2], 2)
v = oracle.sample("<f8", (5, 6, 7, 3))
for order in "CF":
    np.save("v.npy", np.array(v, order=order))
    oracle.expect("v.npy", oracle.magnitude(v), name=f"vectors {order}")
    for number, name in enumerate("xyz"):
        oracle.expect("v.npy", v[..., number], options=["--component", name])
np.savez("c.npz", a)
oracle.refuse("c.npz", "unzip")
np.save("d.npy", a.astype(complex))
oracle.refuse("d.npy", "float32")
np.save("e.npy", a, allow_pickle=False)
import gzip
with gzip.open("e.npy.gz", "wb") as file:
    np.save(file, a[0])
oracle.expect("e.npy.gz", a[0])
oracle.finish()
