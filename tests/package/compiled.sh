# tests/package/compiled.sh - sourced with the folder of a copy of the sources, from
# which a script builds the library as others would.  The compiler cache, where one
# is used, takes what the release build has compiled: it must see the same flags,
# and the same way from the folder that the compiler runs in to the source.  So
# the build is in a folder of the copy, as that of ./dev is, and made by Ninja,
# which runs all compilers in one folder.
export CCACHE_BASEDIR=$WORK/$1
! command -v ninja >/dev/null || export CMAKE_GENERATOR=Ninja
