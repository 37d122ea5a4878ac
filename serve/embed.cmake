# embed.cmake - makes a C file of the page in web/, packed by gzip:
#
#   cmake -D FOLDER=web -D GZIP=gzip -D OUT=web_files.c -P embed.cmake
#
# In all at most 60,000 bytes.
cmake_minimum_required(VERSION 3.19)
set(most 60000)

include(${CMAKE_CURRENT_LIST_DIR}/modules.cmake)

set(arrays "")
set(rows "")
set(total 0)
string(REPEAT "." 70 line) # 14 bytes

# Appends the row of a file whose content is `text`.
macro(add_file number name type)
  file(WRITE ${OUT}.text "${text}")
  execute_process(COMMAND ${GZIP} -9nc INPUT_FILE ${OUT}.text
                  OUTPUT_FILE ${OUT}.gz COMMAND_ERROR_IS_FATAL ANY)
  file(SIZE ${OUT}.text length)
  file(SIZE ${OUT}.gz packed)
  file(SHA256 ${OUT}.text hash)
  string(SUBSTRING ${hash} 0 16 hash)
  file(READ ${OUT}.gz bytes HEX)
  string(REGEX REPLACE "(..)" "0x\\1," bytes "${bytes}")
  string(REGEX REPLACE "(${line})" "\\1\n    " bytes "${bytes}")
  math(EXPR total "${total} + ${packed}")
  string(APPEND arrays
         "static const unsigned char file${number}[] = {\n    ${bytes}};\n")
  string(APPEND rows "    {\"${name}\", \"${type}\", \"\\\"${hash}\\\"\",\n"
                     "     file${number}, ${packed}, ${length}},\n")
endmacro()

read_short(${FOLDER}/index.html)
string(STRIP "${text}" text) # a byte before <!doctype> would be one too many
add_file(0 "" "text/html; charset=utf-8")
read_short(${FOLDER}/viewer.css)
string(REGEX REPLACE "([:;,{])[ \n]+" "\\1" text "${text}")
string(REPLACE " {" "{" text "${text}")
string(REPLACE " > " ">" text "${text}")
string(REGEX REPLACE ";?[ \n]*}\n?" "}" text "${text}")
add_file(1 viewer.css "text/css; charset=utf-8")
add_module(viewer "")
# Gzip sees 32 KiB back: what is alike stands together.  Modules but viewer, the last,
# do nothing until they are called, so that they may stand in any order; this one was
# the best of some thousand.
get_property(added GLOBAL PROPERTY added)
set(order clip recipe engine_server camera pointer editor overlay channels colors slices
    controls panel keys ${added})
list(REMOVE_DUPLICATES order)
set(text "")
foreach(one ${order})
  get_property(module GLOBAL PROPERTY module_${one})
  string(APPEND text "${module}")
endforeach()
string(ASCII 1 blank)
string(ASCII 2 semicolon)
# Blanks in texts stay, beside whatever they are.  What lies between two texts
# begins otherwise than a text does; where it is taken for one, the text behind it
# is found the next time.
string(REPLACE ";" "${semicolon}" text "${text}")
foreach(quote "'" "\"" "`" "'" "\"" "`")
  set(other "[^${quote}\n]*")
  set(quoted "${quote}[$A-Za-z0-9%]${other}([-=<>*/+?&|:,]| of) ${other}${quote}")
  string(REGEX MATCHALL "${quoted}" found "${text}")
  foreach(one ${found})
    string(REPLACE " " "${blank}" kept "${one}")
    string(REPLACE "${one}" "${kept}" text "${text}")
  endforeach()
endforeach()
string(REPLACE "${semicolon}" ";" text "${text}")
string(REGEX REPLACE " (=>|===|!==|&&|[|][|]|[+]=|-=|=|[?]|:|[?][?]|[?][?]=|[|][|]=|&&=) " "\\1" text "${text}")
foreach(again 1 2) # one name is between two
  string(REGEX REPLACE "([])A-Za-z0-9_]) ([-=<>*/+%]|<=|>=) ([A-Za-z0-9_([])" "\\1\\2\\3" text "${text}")
  string(REGEX REPLACE "([])A-Za-z0-9_']), ([[{('`A-Za-z0-9_.])" "\\1,\\2" text "${text}")
endforeach()
string(REPLACE "{}, " "{}," text "${text}")
string(REGEX REPLACE "([})]), ([{(A-Za-z])" "\\1,\\2" text "${text}")
string(REGEX REPLACE " =>\n" "=>" text "${text}")
string(REGEX REPLACE "\n(if|for|while|switch) [(]" "\n\\1(" text "${text}")
string(REGEX REPLACE "(return|const|let|of) ([[{(`'])" "\\1\\2" text "${text}")
string(REGEX REPLACE "([A-Za-z0-9]'): " "\\1:" text "${text}")
string(REGEX REPLACE "([{,] ?[A-Za-z]+): ([A-Za-z0-9`'[({])" "\\1:\\2" text "${text}")
string(REGEX REPLACE "([])]) {\n" "\\1{\n" text "${text}")
string(REGEX REPLACE "} else (if|{)" "}else \\1" text "${text}")
string(REPLACE "else {" "else{" text "${text}")
string(REPLACE "try {" "try{" text "${text}")
string(REGEX REPLACE "} catch ?" "}catch" text "${text}")
string(REPLACE "' +\n'" "" text "${text}")
string(REPLACE "` +\n`" "" text "${text}")
foreach(again 1 2 3 4 5 6) # constants of one line each
  string(REGEX REPLACE "\n(const|let) ([^\n;]*);\n(const|let) ?" "\n\\1 \\2," text "${text}")
endforeach()
string(REGEX REPLACE "([;{,(])\n" "\\1" text "${text}") # no newline is needed there
string(REGEX REPLACE "\n([})])" "\\1" text "${text}")
string(REGEX REPLACE "([])}])\n" "\\1" text "${text}") # statements end in semicolons
string(REGEX REPLACE "([?:&|+]|,)\n" "\\1" text "${text}")
string(REGEX REPLACE "\n([.?:&|+])" "\\1" text "${text}")
string(REGEX REPLACE "([];{}(\n])const([ [{])" "\\1let\\2" text "${text}") # nothing sets one
string(REPLACE ";}" "}" text "${text}") # no statement is empty
string(REGEX REPLACE "([{,][A-Za-z]+): ([[{('`A-Za-z0-9-])" "\\1:\\2" text "${text}") # lines are joined
string(REGEX REPLACE "else if [(]" "else if(" text "${text}")
string(REGEX REPLACE "([;}]class [A-Za-z]+) {" "\\1{" text "${text}")
string(REGEX REPLACE "([A-Za-z0-9_)}]), ([-+])" "\\1,\\2" text "${text}")
string(REGEX REPLACE "([])}]) ([?:]) ?([[{(])" "\\1\\2\\3" text "${text}")
# Names of modules with capitals inside are no words of texts, nor of properties.
get_property(names GLOBAL PROPERTY names)
list(FILTER names INCLUDE REGEX "^[A-Z_]+[A-Z]$|[a-z][A-Z]")
set(count 0)
foreach(one ${names})
  foreach(again 1 2)
    string(REGEX REPLACE "([^A-Za-z0-9_])${one}([^A-Za-z0-9_])" "\\1$${count}\\2" text "${text}")
  endforeach()
  math(EXPR count "${count} + 1")
endforeach()
string(REPLACE "${blank}" " " text "${text}")
add_file(2 viewer.js "text/javascript; charset=utf-8")
file(REMOVE ${OUT}.gz)
if(total GREATER most)
  message(FATAL_ERROR "${FOLDER}: ${total} bytes packed, more than ${most}: "
                      "shorten the page")
endif()
message(STATUS "the page: ${total} bytes packed, of at most ${most}")
file(WRITE ${OUT} "/* Made of web/ by serve/embed.cmake. */\n#include \"net/pages.h\"\n"
     "\n${arrays}\nconst page_file page_files[] = {\n${rows}    {0}};\n")
