#!/usr/bin/env bash
# tests/package/package_recipes.sh - `script TOOL BUILD SOURCE`: what packaging/
# says agrees with the sources: versions, options of the build, and that each
# installed file has its place in one of Debian's packages.
. "$(dirname "$0")/../support/shell.sh"
BUILD=$2 PACKAGING=$3/packaging CMAKE_FILES=("$3/CMakeLists.txt" "$3"/*/CMakeLists.txt
    "$3"/*/*/CMakeLists.txt "$3"/cmake/*.cmake)
version=$("$TOOL" --version | grep -oE '[0-9]+[.][0-9]+[.][0-9]+')
series=${version%.*}
for file in spack/package.py conda/meta.yaml container/Containerfile debian/changelog \
        ../CITATION.cff; do
    check "$file is of this version" grep -q "$version" "$PACKAGING/$file"
done

# Options that are given to CMake exist.
known() { grep -qE "\b$1\b|snow_optional\(${1#SNOW_} " "${CMAKE_FILES[@]}"; }
lacking=
for option in $(grep -ohE -- '-DSNOW_[A-Z0-9_]+' "$PACKAGING/debian/rules" \
    "$PACKAGING/conda/build.sh" | sed 's/-D//' | sort -u); do
    known "$option" || lacking+=" $option"
done
check "options exist${lacking:+, but for$lacking}" [ -z "$lacking" ]

# Parts that are built where their libraries are found.  A package that does not
# name them has what the machine that built it happened to have.
parts=$(sed -nE 's/^ *set\(SNOW_([A-Z0-9]+) (AUTO|\$\{default\}) CACHE STRING.*/\1/p
    s/^snow_optional\(([A-Z0-9]+).*/\1/p' "${CMAKE_FILES[@]}" | grep -vx MANUAL)
check "the parts are found" [ "$(wc -w <<<"$parts")" -ge 14 ]
names_all() { # FILE PATTERN PART...: each part stands in the file, behind the pattern
    local file=$1 pattern=$2 part lacking=
    shift 2
    for part; do
        grep -qE -- "$pattern$part\b" "$file" || lacking+=" SNOW_$part"
    done
    [ -z "$lacking" ] || { echo "not$lacking" && return 1; }
}
check "Debian's rules name all parts" names_all "$PACKAGING/debian/rules" -DSNOW_ $parts
# The formats' libraries are those of conda itself.
check "conda's script names the others" names_all "$PACKAGING/conda/build.sh" \
    -DSNOW_ MPI CATALYST PYTHON SERVE

# --- Spack and conda ----------------------------------------------------------

# The recipe is run with a stand-in for Spack's own module.
python=$(command -v /usr/bin/python3 || command -v python3)
cat >stand_in.py <<'END'
import re
import sys
import types

seen = {"variants": [], "needs": [], "extends": [], "versions": []}


class CMakePackage:
    run_tests = False

    def define(self, name, value):
        return f"-D{name}={'ON' if value else 'OFF'}"

    def define_from_variant(self, name, variant):
        assert variant in seen["variants"], variant
        return self.define(name, True)


module = types.ModuleType("spack.package")
module.CMakePackage = CMakePackage
module.license = lambda name: None
module.version = lambda name, **more: seen["versions"].append(name)
module.variant = lambda name, **more: seen["variants"].append(name)
module.depends_on = lambda name, when="", type=None: seen["needs"].append(when)
module.extends = lambda name, when="": seen["extends"].append((name, when))
sys.modules["spack"] = types.ModuleType("spack")
sys.modules["spack.package"] = module
spec = {}
exec(compile(open(sys.argv[1]).read(), sys.argv[1], "exec"), spec)
for word in spec["Snowglass"]().cmake_args():
    print(re.match("-D([A-Z0-9_]+)=", word)[1])
for when in seen["needs"]:
    assert not when or when[1:] in seen["variants"], when
for name in seen["variants"]:
    assert f"+{name}" in seen["needs"], f"{name} needs nothing"
assert seen["extends"] == [("python", "+python")], "Python does not find it"
END
if [ -n "$python" ]; then
    run 0 "Spack's recipe runs" "$python" -B stand_in.py "$PACKAGING/spack/package.py"
    lacking=
    while read -r option; do
        [ "$option" = BUILD_TESTING ] || known "$option" || lacking+=" $option"
    done <"$OUT"
    check "and its options exist${lacking:+, but for$lacking}" [ -z "$lacking" ]
    check "all of them" names_all "$OUT" ^SNOW_ $parts
fi
if [ -n "$python" ] && "$python" -c 'import yaml' 2>/dev/null; then
    sed -e '/^{%/d' -e "s/{{ version }}/$version/; s/{{ \([a-z]*\)('\([a-z]*\)') }}/\1_\2/" \
        "$PACKAGING/conda/meta.yaml" >meta.yaml
    run 0 "conda's recipe is YAML" "$python" -c \
        'import yaml; m = yaml.safe_load(open("meta.yaml"))
print(m["package"]["version"], len(m["requirements"]["host"]))
print(*m["test"]["requires"])'
    prints "^$version 15$"
    # A test has what it requires and the package, which needs no pkg-config.
    prints '^pkg-config$'
else
    skipped "conda's recipe" "there is no yaml for Python"
fi
check "conda's script is of bash" bash -n "$PACKAGING/conda/build.sh"
check "packaging/make is of bash" bash -n "$PACKAGING/make"

# A build by Spack has no esbuild: the page is longer, and no error.
if command -v gzip >/dev/null; then
    run 0 "the page without esbuild" cmake -D "FOLDER=$3/web" -D GZIP=gzip -D ESBUILD= \
        -D OUT=web_files.c -P "$3/serve/embed.cmake"
    check "has all modules" [ "$(grep -c '^ *{"[a-z_]*[.]js"' web_files.c)" = \
        "$(find "$3/web" -name '*.js' | wc -l)" ]
    rm -f web_files.c
fi

# --- Debian -------------------------------------------------------------------

# As debian/rules installs, but for folders of the system; then each file must
# be in the list of just one package.
cmake --install "$BUILD" --prefix "$WORK/usr" >log 2>&1 || cat log
rm -f usr/share/doc/snowglass/LICENSE
libdir=$(dirname "$(dirname "$(find usr -name snowglass.pc)")")
check "modules are in the folder of the series" [ -d "$libdir/snowglass-$series" ]
for list in "$PACKAGING"/debian/*.install "$PACKAGING"/debian/*.manpages; do
    while read -r pattern _; do
        [[ $pattern != \#* ]] || continue
        pattern=${pattern#debian/tmp/}
        # A folder of libraries may be deeper; pages are what CMake installs.
        pattern=${pattern/usr\/lib\/\*/$libdir}
        pattern=${pattern/usr\/lib\/python3\*\/dist-packages/usr/lib/python3*/*-packages}
        files=$(find $pattern ! -type d 2>/dev/null)
        [ -n "$files" ] || echo "${list##*/}: $pattern" >>idle
        echo "$files" >>listed
        [[ $list == *-mpi* ]] || echo "$files" >>without_mpi
    done <"$list"
done
[ -e "$(find usr -name 'snowglass-mpi.pc')" ] || sed -i '/mpi/d' idle 2>/dev/null
[ -e usr/share/snowglass/web/viewer.html ] || sed -i '/viewer[.]html/d' idle 2>/dev/null
[ -e usr/bin/snowglass-serve ] || sed -i '/serve/d' idle 2>/dev/null
[ -n "$(find usr -name '_snowglass*.so')" ] || sed -i '/python3/d' idle 2>/dev/null
check "each line of the lists names a file" [ ! -s idle ]
cat idle 2>/dev/null
find usr ! -type d | sort >installed
check "there are many" [ "$(wc -l <installed)" -gt 100 ]
check "each file is in a list" diff <(sort -u listed | sed '/^$/d') installed
check "and in one only" [ -z "$(sort listed | sed '/^$/d' | uniq -d)" ]
# What dpkg-shlibdeps would make the package of the file depend on.
xargs readelf -d <without_mpi >needed 2>/dev/null
check "libraries that files need are found" grep -q 'NEEDED.*libsnowglass[.]so' needed
needs_no_mpi() { ! grep -E 'NEEDED.*\[lib(snowglass-)?mpi' needed; }
check "packages that are not of MPI do not need it" needs_no_mpi

# Python is told what pyproject.toml says of a package for pip.
info=$(find usr -name 'snowglass-*.dist-info')
if [ -n "$info" ] && [ -n "$python" ]; then
    PYTHONPATH=${info%/*} run 0 "importlib.metadata knows it" "$python" -B -c '
import importlib.metadata, sys, tomllib
found = importlib.metadata.metadata("snowglass")
with open(sys.argv[1], "rb") as file:
    project = tomllib.load(file)["project"]
assert found["Summary"] == project["description"]
assert found["Requires-Python"] == project["requires-python"]
assert found.get_all("Requires-Dist") == project["dependencies"]
print(found["Version"])' "$3/pyproject.toml"
    prints "^$version$"
fi

# A page that is sent away has the notices of all code in it.
page=usr/share/snowglass/web/viewer.html
if [ -e $page ]; then
    "$TOOL" phantom head --dims 8x8x8 -q -o head.nrrd
    run 0 "a page" usr/bin/snowglass export page.html head.nrrd
    lacking=
    for words in 'the Snowglass developers' 'Redistribution and use in source' \
        'Petri Lehtinen' 'Permission is hereby granted, free of charge' 'Cosmin Truta' \
        'Jean-loup Gailly' 'Rich Felker' 'the Emscripten Authors' 'Google LLC' 'Cynthia Brewer' \
        'Francesc Alted' 'Yann Collet' 'Meta Platforms'; do
        [ "$(grep -cF "$words" page.html)" -ge 1 ] || lacking+=" '$words'"
    done
    check "it names whose code it has${lacking:+, but not$lacking}" [ -z "$lacking" ]
fi

for package in $(sed -n 's/^Package: //p' "$PACKAGING/debian/control"); do
    [ -e "$PACKAGING/debian/$package.install" ] || fail "$package has no list"
done
for name in $(sed -n 's/^Tests: //p' "$PACKAGING/debian/tests/control"); do
    check "debian/tests/$name can be run" [ -x "$PACKAGING/debian/tests/$name" ]
    check "and read" bash -n "$PACKAGING/debian/tests/$name"
done
# Only verbs that pack the committed sources need a repository of Git.
if command -v dpkg-parsechangelog >/dev/null; then
    mkdir archive && cp -r "$PACKAGING" archive/packaging
    export GIT_CEILING_DIRECTORIES=$WORK
    run 1 "a verb that does not exist" archive/packaging/make none out
    says "there is no 'none'"
    run 1 "packages without a repository" archive/packaging/make debs out
    says "run this in a clone by git"
    SNOW_COMMIT=0000 run 2 "packages of a given commit" archive/packaging/make debs out
    says "not a git repository"
    check "which is not looked up" [ -e archive/out/deb ]
fi
for file in "$PACKAGING"/debian/libsnowglass*"$series".symbols; do
    for so in $(sed -n 's/^\(lib[^ ]*\) .*/\1/p' "$file"); do
        [ -e "$libdir/$so" ] || [[ $so == *-mpi* ]] ||
            fail "${file##*/} has $so, which is not installed"
    done
    check "${file##*/} is of the version of the functions" grep -q \
        "^ (symver)SNOWGLASS_$series $version\$" "$file"
done
finish
