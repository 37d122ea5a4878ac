# embed.cmake - makes a C file of the files of web/, packed by gzip:
#
#   cmake -D FOLDER=web -D GZIP=gzip -D OUT=web_files.c -P embed.cmake
#
# Together they have at most 25,000 bytes, since they go through thin tunnels.
set(most 25000)
string(REPEAT "." 70 line) # 14 bytes
file(GLOB files ${FOLDER}/*.html ${FOLDER}/*.css ${FOLDER}/*.js)
list(SORT files)
set(arrays "")
set(rows "")
set(total 0)
set(number 0)
foreach(file ${files})
  get_filename_component(name ${file} NAME)
  get_filename_component(suffix ${file} LAST_EXT)
  string(SUBSTRING ${suffix} 1 -1 suffix)
  if(suffix STREQUAL html)
    set(type "text/html; charset=utf-8")
  elseif(suffix STREQUAL css)
    set(type "text/css; charset=utf-8")
  else()
    set(type "text/javascript; charset=utf-8")
  endif()
  if(name STREQUAL index.html)
    set(name "")
  endif()
  execute_process(COMMAND ${GZIP} -9nc INPUT_FILE ${file}
                  OUTPUT_FILE ${OUT}.gz COMMAND_ERROR_IS_FATAL ANY)
  file(SIZE ${file} length)
  file(SIZE ${OUT}.gz packed)
  file(SHA256 ${file} hash)
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
endforeach()
file(REMOVE ${OUT}.gz)
if(total GREATER most)
  message(FATAL_ERROR "${FOLDER}: ${total} bytes packed, more than ${most}: "
                      "shorten the page")
endif()
message(STATUS "the page: ${total} bytes packed, of at most ${most}")
file(WRITE ${OUT} "/* Made of web/ by serve/embed.cmake. */\n#include \"net/pages.h\"\n"
     "\n${arrays}\nconst page_file page_files[] = {\n${rows}    {0}};\n")
