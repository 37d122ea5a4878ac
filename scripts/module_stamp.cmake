# Writes the constant by which a module and the library know that they are of
# one build (src/base/module.h): cmake -D SOURCE=... -D VERSION=... -D OUT=...
# -P this.  Structures that both sides know lie in any of these files.
file(GLOB_RECURSE files RELATIVE ${SOURCE} ${SOURCE}/include/*.h
     ${SOURCE}/src/base/* ${SOURCE}/src/io/* ${SOURCE}/src/simd/*
     ${SOURCE}/src/volume/* ${SOURCE}/src/formats/* ${SOURCE}/src/image/*)
list(SORT files)
set(all "")
foreach(name ${files})
  file(SHA256 ${SOURCE}/${name} digest)
  string(APPEND all "${name} ${digest}\n")
endforeach()
string(SHA256 digest "${all}")
string(SUBSTRING ${digest} 0 16 digest)
file(WRITE ${OUT} "extern const char snow_module_stamp[];
const char snow_module_stamp[] = \"${VERSION}-${digest}\";
")
