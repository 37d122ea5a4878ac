"""bench/peers/vtk_worker.py - VTK behind the pipe of peers.py.

Two of VTK's volume mappers: `cpu` is vtkFixedPointVolumeRayCastMapper, `gl` is
vtkOpenGLGPUVolumeRayCastMapper on whatever OpenGL the display has (llvmpipe
under Xvfb).  Both with linear interpolation, one ray a pixel, one sample a
voxel pitch, and without the automatic changes of those two, which would make
pictures coarser until they are fast enough.

Of `cpu` only the ray casting is timed: the picture is then in memory, and
showing it by OpenGL is not its fault.

Commands and answers are those of the other workers: see README.md.

  vtk_worker.py cpu|gl RAW X Y Z SIZE THREADS SHADED
  vtk_worker.py convert IN.vti OUT.raw       prints X Y Z
"""
import math
import os
import sys
import time

# llvmpipe reads this when OpenGL starts: 0 draws in the calling thread.
if len(sys.argv) > 7:
    os.environ["LP_NUM_THREADS"] = sys.argv[7] if sys.argv[7] != "1" else "0"
    os.environ["GALLIUM_DRIVER"] = "llvmpipe"
    os.environ["LIBGL_ALWAYS_SOFTWARE"] = "1"

import numpy
import vtk
from vtk.util import numpy_support

VALUES = 256


def convert(source, target):
    """A .vti of bytes as raw."""
    reader = vtk.vtkXMLImageDataReader()
    reader.SetFileName(source)
    reader.Update()
    image = reader.GetOutput()
    values = numpy_support.vtk_to_numpy(image.GetPointData().GetScalars())
    if values.dtype != numpy.uint8 or set(image.GetSpacing()) != {1.0}:
        sys.exit(f"{source}: not bytes, or not with spacing 1")
    values.tofile(target)
    print(*image.GetDimensions())


def turned(azimuth, elevation):
    """The camera's up and back: model.md, section 2."""
    ca, sa = math.cos(math.radians(azimuth)), math.sin(math.radians(azimuth))
    ce, se = (math.cos(math.radians(elevation)),
              math.sin(math.radians(elevation)))
    return (-se * sa, ce, -se * ca), (ce * sa, se, ce * ca)


class Worker:
    def __init__(self, kind, raw, dims, size, threads, shaded):
        self.kind, self.raw, self.dims = kind, raw, dims
        self.pending = None
        vtk.vtkMultiThreader.SetGlobalMaximumNumberOfThreads(threads)
        self.mapper = self.make_mapper(threads)
        self.property = vtk.vtkVolumeProperty()
        self.property.SetInterpolationTypeToLinear()
        self.property.SetScalarOpacityUnitDistance(1)
        self.property.SetShade(shaded)
        self.property.SetAmbient(0.2)
        self.property.SetDiffuse(0.7)
        self.property.SetSpecular(0.2)
        self.property.SetSpecularPower(20)
        self.volume = vtk.vtkVolume()
        self.volume.SetMapper(self.mapper)
        self.volume.SetProperty(self.property)
        self.renderer = vtk.vtkRenderer()
        self.renderer.SetBackground(0, 0, 0)
        self.renderer.AutomaticLightCreationOff()
        # Without an ambient colour of its own the light gives none to `cpu`.
        light = vtk.vtkLight()
        light.SetLightTypeToHeadlight()
        light.SetAmbientColor(1, 1, 1)
        self.renderer.AddLight(light)
        self.window = vtk.vtkRenderWindow()
        self.window.SetOffScreenRendering(1)
        self.window.SetMultiSamples(0)
        self.window.SetSize(size, size)
        self.window.AddRenderer(self.renderer)
        # OpenGL starts before anything is timed.
        self.window.Render()
        self.renderer.AddVolume(self.volume)

    def make_mapper(self, threads):
        if self.kind == "gl":
            mapper = vtk.vtkOpenGLGPUVolumeRayCastMapper()
            mapper.UseJitteringOff()
        else:
            mapper = vtk.vtkFixedPointVolumeRayCastMapper()
            mapper.SetNumberOfThreads(threads)
        mapper.SetAutoAdjustSampleDistances(0)
        mapper.SetSampleDistance(1)
        mapper.SetImageSampleDistance(1)
        return mapper

    def load(self):
        values = numpy.fromfile(self.raw, numpy.uint8)
        self.values = values
        image = vtk.vtkImageData()
        image.SetDimensions(*self.dims)
        image.GetPointData().SetScalars(numpy_support.numpy_to_vtk(values))
        self.mapper.SetInputData(image)

    def table(self, path):
        """Made outside the clock: Python is slow at it, VTK is not."""
        rows = numpy.loadtxt(path)
        self.opacity = vtk.vtkPiecewiseFunction()
        self.color = vtk.vtkColorTransferFunction()
        for value, (red, green, blue, opacity) in enumerate(rows):
            self.opacity.AddPoint(value, opacity)
            self.color.AddRGBPoint(value, red, green, blue)
        self.pending = self.opacity, self.color

    def aim(self, azimuth, elevation):
        """The middle of the voxel boxes is that of the samples, too."""
        up, back = turned(azimuth, elevation)
        radius = math.sqrt(sum(n * n for n in self.dims)) / 2
        target = [(n - 1) / 2 for n in self.dims]
        camera = self.renderer.GetActiveCamera()
        camera.ParallelProjectionOn()
        camera.SetParallelScale(radius)
        camera.SetFocalPoint(target)
        camera.SetPosition([t + 4 * radius * b for t, b in zip(target, back)])
        camera.SetViewUp(up)
        camera.SetClippingRange(2 * radius, 6 * radius)
        self.renderer.UpdateLightsGeometryToFollowCamera()

    def cast(self):
        """What vtkFixedPointVolumeRayCastMapper::Render does, up to showing."""
        zeros = [0.0, 0.0, 0.0]
        self.mapper.PerImageInitialization(self.renderer, self.volume, 0,
                                           zeros, zeros, [0] * 6)
        self.mapper.PerVolumeInitialization(self.renderer, self.volume)
        self.mapper.PerSubVolumeInitialization(self.renderer, self.volume, 0)
        self.mapper.RenderSubVolume()

    def frame(self, azimuth, elevation):
        if self.pending:
            self.property.SetScalarOpacity(self.pending[0])
            self.property.SetColor(self.pending[1])
            self.pending = None
        self.aim(azimuth, elevation)
        if self.kind == "gl":
            self.window.Render()
            self.window.WaitForCompletion()
        else:
            self.cast()

    def save(self, path):
        """The window's pixels, rows from the bottom up, as PPM."""
        grab = vtk.vtkWindowToImageFilter()
        grab.SetInput(self.window)
        grab.SetInputBufferTypeToRGB()
        grab.ReadFrontBufferOff()
        grab.Update()
        width, height, _ = grab.GetOutput().GetDimensions()
        pixels = numpy_support.vtk_to_numpy(
            grab.GetOutput().GetPointData().GetScalars())
        with open(path, "wb") as file:
            file.write(b"P6\n%d %d\n255\n" % (width, height))
            file.write(pixels.reshape(height, width, 3)[::-1].tobytes())

    def obey(self, line):
        """The answer to a command; None when it is to quit."""
        word, _, rest = line.strip().partition(" ")
        wall, cpu = time.perf_counter(), time.process_time()
        if word == "quit":
            return None
        if word == "memory":
            with open("/proc/self/status") as file:
                return "ok " + next(line.split()[1] for line in file
                                    if line.startswith("VmHWM")) + " 0"
        if word == "gl":
            return "ok " + self.window.ReportCapabilities().split(
                "renderer string:")[1].splitlines()[0].strip()
        if word == "frame":
            self.frame(*map(float, rest.split()))
        elif word in ("load", "table", "save"):
            getattr(self, word)(*([rest] if rest else []))
        else:
            sys.exit(f"vtk_worker: no command '{word}'")
        return (f"ok {time.perf_counter() - wall:.9f} "
                f"{time.process_time() - cpu:.9f}")


def main():
    if sys.argv[1] == "convert":
        return convert(*sys.argv[2:4])
    dims = list(map(int, sys.argv[3:6]))
    size, threads, shaded = map(int, sys.argv[6:9])
    worker = Worker(sys.argv[1], sys.argv[2], dims, size, threads, shaded)
    for line in sys.stdin:
        answer = worker.obey(line)
        if answer is None:
            # Tearing OpenGL down is not asked for.
            sys.stdout.flush()
            os._exit(0)
        print(answer, flush=True)


if __name__ == "__main__":
    main()
