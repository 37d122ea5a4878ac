# static.cmake - settings of the tool without shared libraries, for any Linux:
#   cmake -DCMAKE_PROJECT_INCLUDE=packaging/static.cmake ...
# Debian has no archives of GDCM, OpenEXR and what libblosc needs, and that of
# HDF5 brings half of the network with it.
set(CMAKE_FIND_LIBRARY_SUFFIXES .a)
set(CMAKE_EXE_LINKER_FLAGS "${CMAKE_EXE_LINKER_FLAGS} -static")
foreach(part MODULES MPI PYTHON CATALYST SERVE HDF5 GDCM EXR BLOSC)
  set(SNOW_${part} OFF CACHE STRING "" FORCE)
endforeach()
# What libtiff itself needs, last.
set(CMAKE_C_STANDARD_LIBRARIES "-lwebp -lLerc -ljbig -lzstd -llzma -ljpeg -ldeflate -lz -lstdc++ -lm")
