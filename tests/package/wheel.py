"""wheel.py SOURCE WORK: makes the wheel that pyproject.toml describes, prints
its name.

By scikit-build-core, where it is installed.  Else by the same settings of
pyproject.toml, which are checked to be all that there are: configured, built in a
folder of the sources, installed component by component, packed.
"""
import os
import pathlib
import re
import subprocess
import sys
import sysconfig
import tomllib
import zipfile

KNOWN = {"cmake", "build", "install", "wheel", "metadata"}


def run(*words):
    subprocess.run([str(word) for word in words], check=True,
                   stdout=sys.stderr)


def by_backend(source, work):
    from scikit_build_core.build import build_wheel
    os.chdir(source)
    return build_wheel(str(work), {"build-dir": str(source / "built")})


def by_hand(source, work):
    with open(source / "pyproject.toml", "rb") as file:
        project = tomllib.load(file)
    settings = project["tool"]["scikit-build"]
    assert set(settings) == KNOWN, settings
    built = source / "built"
    run("cmake", "-S", source, "-B", built, "-DCMAKE_BUILD_TYPE=Release",
        *settings["cmake"]["args"])
    run("cmake", "--build", built, "--parallel", 2, "--target",
        *settings["build"]["targets"])
    stage = work / "stage"
    for component in settings["install"]["components"]:
        run("cmake", "--install", built, "--prefix", stage,
            "--component", component)
    version = settings["metadata"]["version"]
    found = re.search(version["regex"], (source / version["input"]).read_text())
    number = version["result"].format(**found.groupdict())
    name = f"{project['project']['name']}-{number}"
    tag = (f"{settings['wheel']['py-api']}-abi3-"
           f"{sysconfig.get_platform().replace('-', '_').replace('.', '_')}")
    about = f"Metadata-Version: 2.1\nName: snowglass\nVersion: {number}\n"
    scripts = "".join(f"{command} = {place}\n" for command, place
                      in project["project"]["scripts"].items())
    kind = f"Wheel-Version: 1.0\nRoot-Is-Purelib: false\nTag: {tag}\n"
    with zipfile.ZipFile(work / f"{name}-{tag}.whl", "w",
                         zipfile.ZIP_DEFLATED) as wheel:
        for file in sorted(stage.rglob("*")):
            if file.is_file():
                wheel.write(file, file.relative_to(stage))
        wheel.writestr(f"{name}.dist-info/METADATA", about)
        wheel.writestr(f"{name}.dist-info/WHEEL", kind)
        wheel.writestr(f"{name}.dist-info/entry_points.txt",
                       f"[console_scripts]\n{scripts}")
        wheel.writestr(f"{name}.dist-info/RECORD", "")
    return f"{name}-{tag}.whl"


def main():
    source, work = (pathlib.Path(word).resolve() for word in sys.argv[1:])
    try:
        name = by_backend(source, work)
    except ImportError:
        name = by_hand(source, work)
    print(name)


main()
