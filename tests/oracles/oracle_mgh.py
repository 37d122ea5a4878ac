"""FreeSurfer's volumes, as nibabel writes and reads them."""
import gzip

import oracle
from oracle import np

nibabel, = oracle.need("nibabel")

matrix = np.diag([1.5, 2, 2.5, 1])
matrix[:3, :3] = oracle.rotation(20, -70, 130) @ matrix[:3, :3]
matrix[:3, 3] = -12, 34, 5.5


def expect(path, name):
    image = nibabel.load(path)
    values = np.asarray(image.dataobj)
    values = values.astype(values.dtype.newbyteorder("="))
    for frame in range(values.shape[3] if values.ndim == 4 else 1):
        one = values[..., frame] if values.ndim == 4 else values
        oracle.expect(path, one.T, image.affine, ["--time", frame],
                      unit="mm", name=f"{name} frame {frame}")


for kind in ("u1", "i2", "i4", "f4"):
    for shape in ((5, 6, 7), (4, 3, 2, 3), (50, 1, 1)):
        nibabel.save(nibabel.MGHImage(oracle.sample(kind, shape), matrix),
                     "a.mgz")
        expect("a.mgz", f"{kind} of {shape}")
whole = gzip.decompress(oracle.got("a.mgz"))
for name, content in (
        ("without a footer", whole[:284 + 200]),
        ("with tags", whole + b"\0\0\0\3" + bytes(7) + b"\x10mri_convert -it ")):
    expect(oracle.put("b.mgh", content), name)

# Where there is no place, nibabel has y and z the other way round than
# FreeSurfer, whose y goes down and z to the front.
oracle.put("b.mgh", whole[:28] + b"\0\0" + whole[30:])
turn = nibabel.load("b.mgh").affine @ np.diag([1, -1, -1, 1])
turn[1:3, 3] = -nibabel.load("b.mgh").affine[1:3, 3]
oracle.expect("b.mgh", oracle.sample("f4", (50, 1, 1)).T, turn)
oracle.says("no place", "b.mgh", "no valid place")
oracle.refuse_cut("b.mgh", (0, 100, 284, 300), "cut.mgh")
oracle.finish()
