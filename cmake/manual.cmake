# Manual pages, completions and the schema of recipes, made at build time by the
# scripts in scripts/manual/ from the tool's table of options, which a program
# that is not installed writes, the public headers and the documents.  A build
# for another machine takes the table of a native build: -DSNOW_MANUAL=PATH.
set(default ON)
if(CMAKE_CROSSCOMPILING OR SNOW_SANITIZE)
  set(default OFF)
endif()
set(SNOW_MANUAL ${default} CACHE STRING
    "manual pages and completions: ON, OFF, or the table of options as JSON")
if(NOT SNOW_MANUAL)
  return()
endif()
find_package(Python3 3.9 QUIET COMPONENTS Interpreter)
if(NOT Python3_Interpreter_FOUND)
  message(STATUS "Without manual pages and completions: there is no Python 3")
  return()
endif()

get_filename_component(table "${SNOW_MANUAL}" ABSOLUTE)
if(NOT EXISTS "${table}")
  set(table ${PROJECT_BINARY_DIR}/table.json)
  snow_tool(snowglass_table snowglass-table programs/manual/table.c)
  add_custom_command(OUTPUT ${table} COMMAND snowglass_table > ${table}
                     DEPENDS snowglass_table VERBATIM)
endif()
file(GLOB scripts CONFIGURE_DEPENDS scripts/manual/*.py)

set(SNOW_MANUAL_FILES "")
# snow_manual(COMPONENT FOLDER FILE WORD...): what the scripts write for these
# words is installed in the folder.  Words may be files of the sources.
function(snow_manual component folder file)
  set(out ${PROJECT_BINARY_DIR}/manual/${folder}/${file})
  get_filename_component(place ${out} DIRECTORY)
  file(MAKE_DIRECTORY ${place})
  set(files ${ARGN})
  list(FILTER files INCLUDE REGEX "[.](h|md)$")
  add_custom_command(OUTPUT ${out} VERBATIM
                     COMMAND Python3::Interpreter -B scripts/manual ${table}
                             ${ARGN} > ${out}
                     DEPENDS ${table} ${scripts} ${files}
                     WORKING_DIRECTORY ${PROJECT_SOURCE_DIR})
  set(SNOW_MANUAL_FILES ${SNOW_MANUAL_FILES} ${out} PARENT_SCOPE)
  if(SNOW_INSTALL)
    install(FILES ${out} DESTINATION ${folder} COMPONENT ${component})
  endif()
endfunction()

set(pages ${CMAKE_INSTALL_MANDIR}/man1)
set(bash ${CMAKE_INSTALL_DATADIR}/bash-completion/completions)
set(zsh ${CMAKE_INSTALL_DATADIR}/zsh/site-functions)
set(fish ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d)
snow_manual(snowglass_runtime ${pages} snowglass.1 man)
file(STRINGS programs/options/option_table.c verbs REGEX "^    {\"[a-z]+\", VERB_")
foreach(verb ${verbs})
  string(REGEX REPLACE "^    {\"([a-z]+)\".*" "\\1" verb "${verb}")
  snow_manual(snowglass_runtime ${pages} snowglass-${verb}.1 man ${verb})
endforeach()
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS
             ${PROJECT_SOURCE_DIR}/programs/options/option_table.c)
snow_manual(snowglass_runtime ${bash} snowglass bash)
snow_manual(snowglass_runtime ${zsh} _snowglass zsh)
snow_manual(snowglass_runtime ${fish} snowglass.fish fish)
snow_manual(snowglass_runtime ${CMAKE_INSTALL_DATADIR}/snowglass
            recipe.schema.json json)

# The library, file formats, and what a picture is.
set(mandir ${CMAKE_INSTALL_MANDIR})
file(GLOB headers CONFIGURE_DEPENDS include/snowglass/*.h)
foreach(header ${headers})
  get_filename_component(name ${header} NAME_WE)
  string(REPLACE _ - page snowglass-${name}.3)
  set(component snowglass_dev)
  if(name STREQUAL "mpi")
    set(component snowglass_mpi)
  elseif(name STREQUAL "snowglass")
    set(page snowglass.3)
  endif()
  if(TARGET snowglass_mpi OR NOT name STREQUAL "mpi")
    snow_manual(${component} ${mandir}/man3 ${page} header ${header})
  endif()
endforeach()
set(docs ${PROJECT_SOURCE_DIR}/docs)
snow_manual(snowglass_runtime ${mandir}/man5 snowglass.5 document 5
  "recipes and files of transfer functions"
  ${docs}/insitu.md Recipes RECIPES
  ${docs}/looks.md Files "TRANSFER FUNCTIONS")
snow_manual(snowglass_runtime ${mandir}/man7 snowglass.7 document 7
  "what a picture is: grid, camera, opacity, light"
  ${docs}/model.md "What a correct picture is" MODEL
  ${docs}/formats.md Geometry "GEOMETRY OF FILES")
if(TARGET snowglass_mpi_tool)
  snow_manual(snowglass_mpi ${pages} snowglass-mpi.1 man mpi)
  snow_manual(snowglass_mpi ${bash} snowglass-mpi bash)
  snow_manual(snowglass_mpi ${fish} snowglass-mpi.fish fish-mpi)
endif()
add_custom_target(snowglass_manual_files ALL DEPENDS ${SNOW_MANUAL_FILES})
