#!/usr/bin/env bash
# tests/package/package_release.sh - `script TOOL BUILD SOURCE`: the folder of a
# release has what was built twice alike, check sums that sha256sum accepts, a
# signature that gpgv accepts, and this version's notes; what differs is refused.
# Small files stand for the artifacts, which ./dev release builds for an hour.
. "$(dirname "$0")/../support/shell.sh"
SOURCE=$(realpath "$3")
release() { /usr/bin/python3 -B "$SOURCE/packaging/release" "$@"; }
unset SNOW_KEY
version=$("$TOOL" --version | grep -oE '[0-9]+[.][0-9]+[.][0-9]+')
mkdir one
for name in snowglass_$version-0snow1_amd64.deb snowglass_$version.orig.tar.gz \
    snowglass-dbgsym_$version-0snow1_amd64.deb snowglass_$version-0snow1.dsc \
    snowglass_$version-0snow1.debian.tar.xz snowglass-$version.tar.gz \
    snowglass-$version-linux-x86_64.tar.xz viewer.html \
    snowglass-$version-cp311-abi3-linux_x86_64.whl; do
    echo "$name" >"one/$name"
done
cp -r one two

run 0 "a release" release one two out
prints "^release $version: 9 files in out, not signed"
check "nothing is missing" [ "$(wc -l <"$OUT")" = 1 ]
run 0 "its sums" sh -c 'cd out && sha256sum --strict -c SHA256SUMS'
check "are of all files" [ "$(wc -l <out/SHA256SUMS)" = "$(($(ls out | wc -l) - 1))" ]
check "the notes are of this version" grep -qx "# Snowglass $version" out/NOTES.md
check "and are those of the changes" \
    grep -qxF -- "$(sed -n '/^### Rendering/,$p' "$SOURCE/CHANGELOG.md" | sed -n 3p)" out/NOTES.md
check "and name documents where a reader has them" \
    grep -qF "formats (\`docs/formats.md\` in snowglass-$version.tar.gz)" out/NOTES.md
check "for there are no links" [ "$(grep -c ']([a-z]*/' out/NOTES.md)" = 0 ]
run 0 "the manifest" /usr/bin/python3 -c '
import json
made = json.load(open("out/MANIFEST.json"))
print(made["version"], sorted({file["purpose"] for file in made["files"]}))
assert made["missing"] == []
assert all(file["bytes"] == len(file["name"]) + 1 for file in made["files"])'
prints "^$version .*package for pip.*package of Debian.*source package of Debian.*sources.*static tool"
mkdir -p less/{one,two}
cp one/*.{deb,xz,gz,dsc,html} less/one
cp one/*.{deb,xz,gz,dsc,html} less/two
run 0 "a release without a wheel" release less/one less/two less/out
prints "^missing: package for pip$"
check "says so in its manifest" grep -q '"package for pip"' less/out/MANIFEST.json

run 0 "what can be wrong is tried" release --try untried
check "and nothing is made" [ ! -e untried ]
run 1 "a release that exists, when it is tried" release --try out
says "out exists; move it away"

run 1 "a release that exists stays" release one two out
says "out exists; move it away"
echo other >two/viewer.html
run 1 "what differs" release one two new
says "viewer.html differs between the two builds"
rm two/viewer.html
run 1 "what was built once" release one two new
says "viewer.html was built once only"
cp one/viewer.html two
touch {one,two}/notes.txt
run 1 "what nobody knows" release one two new
says "notes.txt: nobody knows what it is for"
rm {one,two}/notes.txt
check "nothing is left of them" [ ! -e new ]

if command -v gpg >/dev/null && command -v gpgv >/dev/null; then
    export GNUPGHOME=$WORK/keys
    mkdir -m 700 "$GNUPGHOME"
    gpg --batch --quiet --passphrase '' --quick-generate-key \
        test@snowglass.invalid default default never 2>/dev/null
    run 0 "a key that signs, when it is tried" release --try untried --key test@snowglass.invalid
    run 1 "a key that does not" release --try untried --key nobody@snowglass.invalid
    says "gpg cannot sign by key nobody@snowglass.invalid: "
    run 0 "a signed release" release one two signed --key test@snowglass.invalid
    prints ", signed$"
    gpg --batch --quiet --export >keyring.gpg 2>/dev/null
    verify() { gpgv --keyring "$WORK/keyring.gpg" signed/SHA256SUMS.asc signed/SHA256SUMS; }
    run 0 "its signature is right" verify
    echo >>signed/SHA256SUMS
    run 1 "and tells a change" verify
    gpgconf --kill all 2>/dev/null
else
    echo "skip   no gpg: nothing is signed"
fi
finish
