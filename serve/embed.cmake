# embed.cmake - makes a C file of the page in web/, packed by gzip:
#
#   cmake -D FOLDER=web -D GZIP=gzip -D ESBUILD=esbuild -D OUT=web_files.c -P embed.cmake
#
# esbuild makes one short script of the modules: a tunnel carries fewer bytes and one
# request, in all at most 60,000 bytes.  Without it they are sent as they are.
cmake_minimum_required(VERSION 3.19)
set(most 60000)

set(arrays "")
set(rows "")
set(total 0)
set(number 0)
string(REPEAT "." 70 line) # 14 bytes

# Appends the row of a file.
macro(add_file name type path)
  execute_process(COMMAND ${GZIP} -9nc INPUT_FILE ${path}
                  OUTPUT_FILE ${OUT}.gz COMMAND_ERROR_IS_FATAL ANY)
  file(SIZE ${path} length)
  file(SIZE ${OUT}.gz packed)
  file(SHA256 ${path} hash)
  string(SUBSTRING ${hash} 0 16 hash)
  file(READ ${OUT}.gz bytes HEX)
  string(REGEX REPLACE "(..)" "0x\\1," bytes "${bytes}")
  string(REGEX REPLACE "(${line})" "\\1\n    " bytes "${bytes}")
  math(EXPR total "${total} + ${packed}")
  string(APPEND arrays
         "static const unsigned char file${number}[] = {\n    ${bytes}};\n")
  string(APPEND rows "    {\"${name}\", \"${type}\", \"\\\"${hash}\\\"\",\n"
                     "     file${number}, ${packed}, ${length}},\n")
  math(EXPR number "${number} + 1")
endmacro()

add_file("" "text/html; charset=utf-8" ${FOLDER}/index.html)
file(GLOB paths ${FOLDER}/*.css ${FOLDER}/*.js ${FOLDER}/*/*.js) # of names of their own
if(ESBUILD)
  set(short ${OUT}.d)
  execute_process(COMMAND ${ESBUILD} ${FOLDER}/viewer.js ${FOLDER}/viewer.css --bundle
                          --minify --charset=utf8 --format=esm --log-level=warning
                          --outdir=${short} COMMAND_ERROR_IS_FATAL ANY)
  set(paths ${short}/viewer.css ${short}/viewer.js)
endif()
foreach(path ${paths})
  get_filename_component(name ${path} NAME)
  if(name MATCHES "css$")
    add_file(${name} "text/css; charset=utf-8" ${path})
  else()
    add_file(${name} "text/javascript; charset=utf-8" ${path})
  endif()
endforeach()
file(REMOVE ${OUT}.gz)
if(NOT ESBUILD)
  message(STATUS "the page: ${total} bytes packed, since there is no esbuild")
elseif(total GREATER most)
  message(FATAL_ERROR "${FOLDER}: ${total} bytes packed, more than ${most}: "
                      "shorten the page")
else()
  message(STATUS "the page: ${total} bytes packed, of at most ${most}")
endif()
file(WRITE ${OUT} "/* Made of web/ by serve/embed.cmake. */\n#include \"net/pages.h\"\n"
     "\n${arrays}\nconst page_file page_files[] = {\n${rows}    {0}};\n")
