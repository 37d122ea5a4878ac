# modules.cmake - makes one script of modules: functions for embed.cmake, and for
# wasm/page.cmake.
#
# The modules that viewer.js imports become one file, without comments (but those
# with quotes at the end of a line, which may be in a text) and indents: a tunnel carries fewer bytes and one request.

# Sets `text` to a file without what only people read.
macro(read_short path)
  file(READ ${path} text)
  string(REGEX REPLACE "\n[ \t]+" "\n" text "\n${text}")
  string(REGEX REPLACE "\n//[^\n]*" "" text "${text}")
  string(REGEX REPLACE " // [^\n'\"`]*\n" "\n" text "${text}")
  string(REGEX REPLACE "\n/[*]([^*]|[*]+[^*/])*[*]+/" "" text "${text}")
  string(REGEX REPLACE "\n\n+" "\n" text "${text}")
endmacro()

# A module is a function that is called once and returns what it exports.
macro(wrap_module name)
  string(REGEX MATCHALL "\nexport [a-z ]+ [A-Za-z0-9_]+" exported "${text}")
  list(TRANSFORM exported REPLACE ".* " "")
  string(REPLACE ";" "," exported "${exported}")
  string(REGEX REPLACE "\nexport " "\n" text "${text}")
  string(APPEND modules "const ${name}_ = (() => {"
                        "${text}return {${exported}};\n})();\n")
endmacro()

# Modules without functions around them share their names; `module_NAME` is one.
macro(unwrap_module)
  string(REGEX REPLACE "\nimport [{][^}]*[}][ \n]*from '[.]/[a-z_]+[.]js';" "" text "${text}")
  string(REGEX REPLACE "\nexport " "\n" text "${text}")
  file(STRINGS ${file_${name}} defined REGEX "^(export )?(async )?(const|let|class|function) ")
  list(TRANSFORM defined REPLACE "^.*(const|let|class|function) ([A-Za-z0-9_]+).*$" "\\2")
  get_property(names GLOBAL PROPERTY names)
  foreach(one ${defined})
    if(one IN_LIST names)
      message(FATAL_ERROR "${name}.js: another module has a ${one} too: rename one")
    endif()
  endforeach()
  set_property(GLOBAL APPEND PROPERTY names ${defined})
  set_property(GLOBAL PROPERTY module_${name} "${text}")
endmacro()

# Appends a module to `modules`, after those that it imports.  The last names of
# `path` lead here.  Where ENGINE is set, all but it get that in the place of
# engine_server, whose names it may have too; else modules share their names.
function(add_module name path)
  if(name IN_LIST path)
    message(FATAL_ERROR "${FOLDER}: modules import each other: ${path}")
  endif()
  find_file(file_${name} ${name}.js PATHS ${FOLDER} NO_DEFAULT_PATH REQUIRED)
  read_short(${file_${name}})
  if(ENGINE AND NOT name STREQUAL ENGINE)
    string(REPLACE "/engine_server.js'" "/${ENGINE}.js'" text "${text}")
  endif()
  string(REGEX MATCHALL "from '[.]/[a-z_]+[.]js'" imported "${text}")
  foreach(one ${imported})
    string(REGEX REPLACE ".*/([a-z_]+)[.]js'" "\\1" one "${one}")
    get_property(done GLOBAL PROPERTY added)
    if(NOT one IN_LIST done)
      add_module(${one} "${path};${name}")
    endif()
  endforeach()
  get_property(modules GLOBAL PROPERTY modules)
  if(ENGINE)
    string(REGEX REPLACE "(\nimport [{][^}]*) as " "\\1: " text "${text}")
    string(REGEX REPLACE "\nimport ([{][^}]*[}])[ \n]*from '[.]/([a-z_]+)[.]js';"
           "\nconst \\1 = \\2_;" text "${text}")
  endif()
  if(NOT ENGINE)
    unwrap_module()
  elseif(path)
    wrap_module(${name})
  else()
    string(APPEND modules "${text}")
  endif()
  set_property(GLOBAL PROPERTY modules "${modules}")
  set_property(GLOBAL APPEND PROPERTY added ${name})
endfunction()
