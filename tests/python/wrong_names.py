"""What mypy must find: a line that ends with a comment `wrong` has a fault, and no
other line.  It is never run (test_types.py)."""
import numpy

import snowglass as sg

volume = sg.Volume("head.nii.gz", crop=((0, 9), (0, 9), (0, 9)), channel="GFP")
array = sg.Volume(numpy.zeros((4, 5, 6)), spacing=(1, 2, 3), copy=True)
sg.Volume("head.nii.gz", croop=((0, 9), (0, 9), (0, 9)))  # wrong
sg.Volume("head.nii.gz", time="last")
sg.Volume("head.nii.gz", time=numpy.datetime64("2005-08-28"))
sg.Volume("head.nii.gz", time=0.5)  # wrong
sg.open("head.nii.gz", dataset="rho", progress=True)
sg.open("head.nii.gz", data_set="rho")  # wrong

volume.render("ct-bone", mode="mip", quality="high", occlusion=0.5, threshold=10)
volume.render(cmap="viridis", clim=(0, 9), opacity="sigmoid", size=(800, 600))
volume.render(position=numpy.zeros(3), opacity=[(0, 0), (9, 1)], legend="T (K)")
volume.render(qualty="high")  # wrong
volume.render(quality="best")  # wrong
volume.render(mode="MIP")  # wrong
volume.render(occlusion="much")  # wrong
volume.render(treshold=10)  # wrong
volume.render(background="white")  # wrong

sg.render("head.nii.gz", "ct-bone", time=3, view="left", open={"unit": "um"})
sg.render("head.nii.gz", axis="axial", at=5)
sg.render("head.nii.gz", colourmap="viridis")  # wrong
recipe = volume.render().recipe
sg.render(**recipe)

volume.project("mip", view="left", threads=2)
volume.project("mip", cmap="viridis")  # wrong
volume.project("over")  # wrong
volume.turntable("turn.webp", frames=9, overwrite=True, background=None, mode="mip")
volume.turntable("turn.webp", frame=9)  # wrong
volume.slice_grid(2, 3, colums=4)  # wrong
volume.view("ct-bone", height=400, azimuth=30)
volume.view("ct-bone", azimut=30)  # wrong
for step in sg.series("run_*.h5", dataset="rho"):
    step.render().save("step.png", background="white")
for step in sg.series("run_*.h5", datset="rho"):  # wrong
    step.close()
