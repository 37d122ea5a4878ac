"""examples/picture.py - a picture of an array of NumPy.

    python3 picture.py blob.png"""
import sys

import numpy as np

import snowglass as sg

if len(sys.argv) != 2:
    sys.exit(__doc__)
SIDE = 64

# A ball of values that fall from its middle, [z, y, x].
z, y, x = np.indices((SIDE, SIDE, SIDE)) - SIDE // 2
r = np.sqrt(x * x + y * y + z * z)
voxels = np.where(r < 30, 250 - 8 * r, 0).astype(np.uint8)

volume = sg.Volume(voxels, spacing=(0.5, 0.5, 0.5), unit="mm")  # not copied
look = sg.Look(colormap="viridis", opacity=[(10, 0), (250, 0.3)])
picture = volume.render(look, azimuth=30, elevation=20, legend=True)
picture.save(sys.argv[1])
