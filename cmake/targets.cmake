# What all libraries that others link have in common: names within other
# projects, versions, where they are built and how they find one another.
set(SNOW_SERIES ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
configure_file(cmake/snowglass.map.in snowglass.map @ONLY)

# An installed library or module finds those in the folder `way` from its own,
# also after all was moved.
function(snow_find_beside target way)
  set(origin $ORIGIN)
  if(APPLE)
    set(origin @loader_path)
  endif()
  if(NOT way STREQUAL ".")
    string(APPEND origin /${way})
  endif()
  set_target_properties(${target} PROPERTIES
                        INSTALL_RPATH "${origin};${CMAKE_INSTALL_RPATH}")
endfunction()

# `name` is what others call it, in a build tree too: snowglass::NAME.
function(snow_public_library target name)
  add_library(snowglass::${name} ALIAS ${target})
  # Modules are searched beside the shared library (src/base/module.c).
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${name}
    VERSION ${PROJECT_VERSION} SOVERSION ${SNOW_SERIES}
    ARCHIVE_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}
    LIBRARY_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR})
  if(NOT name STREQUAL "snowglass") # the others are over this one
    snow_find_beside(${target} .)
  endif()
  get_target_property(type ${target} TYPE)
  if(type STREQUAL SHARED_LIBRARY AND NOT APPLE)
    # A library calls its own functions, also where the process has another one
    # of that series, which a program links and a plug-in brings.
    target_link_options(${target} PRIVATE LINKER:-Bsymbolic-functions
      "LINKER:--version-script=${PROJECT_BINARY_DIR}/snowglass.map")
    set_target_properties(${target} PROPERTIES
                          LINK_DEPENDS ${PROJECT_BINARY_DIR}/snowglass.map)
  endif()
endfunction()

# What an archive needs.  Targets of pkg-config are of this build; those who
# link the installed archive find them anew, under another name
# (cmake/snowglass-config.cmake.in).
function(snow_link_archive target)
  foreach(library ${ARGN})
    string(REGEX REPLACE "^(PkgConfig|GDCM)::" "PkgConfig::SNOWGLASS_" there
           ${library})
    target_link_libraries(${target} PUBLIC $<BUILD_INTERFACE:${library}>
                          $<INSTALL_INTERFACE:${there}>)
  endforeach()
endfunction()

function(snow_install_program target)
  if(NOT SNOW_INSTALL OR target STREQUAL snowglass_table) # of the build
    return()
  endif()
  set(component snowglass_runtime)
  if(target MATCHES "_mpi")
    set(component snowglass_mpi)
  endif()
  install(TARGETS ${target} RUNTIME COMPONENT ${component})
endfunction()
