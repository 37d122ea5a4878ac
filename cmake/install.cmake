# What `cmake --install` does.  Components, one or all of which are installed:
#
#   snowglass_runtime  programs, shared libraries, modules, manual, completions
#   snowglass_dev      headers, archives, pkg-config, CMake package, Fortran
#   snowglass_mpi      all that needs MPI: program, library, header, packages, the
#                      module for Python
#   snowglass_python   the Python package (python/CMakeLists.txt)
#   snowglass_doc      documents and examples
#
# All may be moved afterwards: no file tells where it lies.
include(CMakePackageConfigHelpers)
set(SNOW_CMAKE_FOLDER ${CMAKE_INSTALL_LIBDIR}/cmake/snowglass)

# --- libraries and headers ----------------------------------------------------

# Each export is a file of its own, since one that names a file that is not
# there fails: snowglass-NAME-targets.cmake.
function(snow_install_library target name runtime dev)
  install(TARGETS ${target} EXPORT snowglass-${name}
    LIBRARY COMPONENT ${runtime} NAMELINK_COMPONENT ${dev}
    ARCHIVE COMPONENT ${dev})
  install(EXPORT snowglass-${name} NAMESPACE snowglass::
          FILE snowglass-${name}-targets.cmake COMPONENT ${dev}
          DESTINATION ${SNOW_CMAKE_FOLDER})
endfunction()
set(kinds snowglass_runtime snowglass_dev)
snow_install_library(snowglass_shared shared ${kinds})
snow_install_library(snowglass static ${kinds})
if(TARGET snowglass_recipe)
  snow_install_library(snowglass_recipe_shared recipe ${kinds})
  snow_install_library(snowglass_recipe recipe-static ${kinds})
endif()
if(TARGET snowglass_mpi)
  set(kinds snowglass_mpi snowglass_mpi)
  snow_install_library(snowglass_mpi mpi ${kinds})
  snow_install_library(snowglass_mpi_static mpi-static ${kinds})
  install(FILES include/snowglass/mpi.h COMPONENT snowglass_mpi
          DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/snowglass)
endif()
install(DIRECTORY include/snowglass DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}
        COMPONENT snowglass_dev FILES_MATCHING PATTERN "*.h"
        PATTERN "mpi.h" EXCLUDE)
# A module of Fortran is compiled by the compiler that uses it.
install(FILES examples/insitu/snowglass.f90 COMPONENT snowglass_dev
        DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/snowglass)

# The page without a server, where ./dev web has made it: `snowglass export`.
install(FILES build-web/viewer.html OPTIONAL COMPONENT snowglass_runtime
        DESTINATION share/snowglass/web)

# --- pkg-config ---------------------------------------------------------------

# Words for the linker instead of files: -lNAME, and -L where it is not searched.
function(snow_linker_words out)
  set(words "")
  list(REMOVE_DUPLICATES ARGN)
  foreach(file ${ARGN})
    get_filename_component(folder ${file} DIRECTORY)
    get_filename_component(name ${file} NAME_WE)
    string(REGEX REPLACE "^lib" "-l" name ${name})
    set(L "")
    if(NOT folder IN_LIST CMAKE_C_IMPLICIT_LINK_DIRECTORIES)
      set(L -L${folder})
    endif()
    list(APPEND words ${L} ${name})
  endforeach()
  string(JOIN " " words ${words})
  set(${out} "${words}" PARENT_SCOPE)
endfunction()
snow_linker_words(SNOW_ARCHIVE_FLAGS ${SNOW_ARCHIVE_FILES})
snow_linker_words(SNOW_RECIPE_FLAGS ${SNOW_RECIPE_FILES})
if(SNOW_HAVE_GDCM) # for programs in C
  string(APPEND SNOW_ARCHIVE_FLAGS " -lstdc++")
endif()
string(APPEND SNOW_ARCHIVE_FLAGS " -pthread -lm")

# What those libraries need themselves, where they are archives too.
pkg_check_modules(SNOW_PNG QUIET libpng)
set(SNOW_ARCHIVE_MORE ${SNOW_PNG_STATIC_LDFLAGS})
foreach(entry ${SNOW_ARCHIVE_PACKAGES})
  string(REGEX MATCH "^[^=]+" name ${entry})
  if(NOT name STREQUAL EXR) # of which one library is used
    list(APPEND SNOW_ARCHIVE_MORE ${${name}_STATIC_LDFLAGS})
  endif()
endforeach()
foreach(folder ${CMAKE_C_IMPLICIT_LINK_DIRECTORIES})
  list(REMOVE_ITEM SNOW_ARCHIVE_MORE -L${folder})
endforeach()
list(REVERSE SNOW_ARCHIVE_MORE) # the last of each counts
list(REMOVE_DUPLICATES SNOW_ARCHIVE_MORE)
list(REVERSE SNOW_ARCHIVE_MORE)
string(JOIN " " SNOW_ARCHIVE_MORE ${SNOW_ARCHIVE_MORE})

set(SNOW_PC_FOLDER ${CMAKE_INSTALL_FULL_LIBDIR}/pkgconfig)
file(RELATIVE_PATH SNOW_WAY_UP ${SNOW_PC_FOLDER} ${CMAKE_INSTALL_PREFIX})
file(RELATIVE_PATH SNOW_LIBDIR ${CMAKE_INSTALL_PREFIX}
     ${CMAKE_INSTALL_FULL_LIBDIR})
file(RELATIVE_PATH SNOW_INCLUDEDIR ${CMAKE_INSTALL_PREFIX}
     ${CMAKE_INSTALL_FULL_INCLUDEDIR})
string(REGEX REPLACE "/$" "" SNOW_WAY_UP ${SNOW_WAY_UP})
get_filename_component(SNOW_MPI_NAME "${MPI_C_COMPILER}" NAME)
function(snow_install_pc component)
  foreach(name ${ARGN})
    configure_file(cmake/${name}.pc.in ${name}.pc @ONLY)
    install(FILES ${PROJECT_BINARY_DIR}/${name}.pc COMPONENT ${component}
            DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
  endforeach()
endfunction()
snow_install_pc(snowglass_dev snowglass snowglass-static)
if(TARGET snowglass_recipe)
  snow_install_pc(snowglass_dev snowglass-recipe snowglass-recipe-static)
endif()
if(TARGET snowglass_mpi)
  snow_install_pc(snowglass_mpi snowglass-mpi snowglass-mpi-static)
endif()

# --- CMake's package ----------------------------------------------------------

configure_package_config_file(cmake/snowglass-config.cmake.in
  snowglass-config.cmake INSTALL_DESTINATION ${SNOW_CMAKE_FOLDER}
  NO_SET_AND_CHECK_MACRO)
write_basic_package_version_file(
  ${PROJECT_BINARY_DIR}/snowglass-config-version.cmake
  COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/snowglass-config.cmake
        ${PROJECT_BINARY_DIR}/snowglass-config-version.cmake
        DESTINATION ${SNOW_CMAKE_FOLDER} COMPONENT snowglass_dev)

# --- documents ----------------------------------------------------------------

install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR}
        COMPONENT snowglass_runtime)
install(FILES README.md CHANGELOG.md CONTRIBUTING.md
        DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT snowglass_doc)
install(DIRECTORY docs examples DESTINATION ${CMAKE_INSTALL_DOCDIR}
        COMPONENT snowglass_doc
        REGEX "/examples/(insitu/)?CMakeLists[.]txt$" EXCLUDE
        PATTERN "run.cmake" EXCLUDE)

# --- and away -----------------------------------------------------------------

if(PROJECT_SOURCE_DIR STREQUAL CMAKE_SOURCE_DIR)
  # CMake's lists do not tell DESTDIR, below which their files may be.
  foreach(part runtime dev mpi python doc)
    install(CODE [[
      set(list install_manifest)
      if(CMAKE_INSTALL_COMPONENT)
        string(APPEND list _${CMAKE_INSTALL_COMPONENT})
      endif()
      set(root "")
      if(NOT "$ENV{DESTDIR}" STREQUAL "")
        get_filename_component(root "$ENV{DESTDIR}" ABSOLUTE)
      endif()
      file(WRITE "${CMAKE_CURRENT_LIST_DIR}/${list}.txt.root"
           "<${root}>\n${CMAKE_INSTALL_PREFIX}\n")
    ]] COMPONENT snowglass_${part})
  endforeach()
  add_custom_target(uninstall COMMAND ${CMAKE_COMMAND} -DBUILD=${PROJECT_BINARY_DIR}
                    -P ${PROJECT_SOURCE_DIR}/cmake/uninstall.cmake)
endif()
