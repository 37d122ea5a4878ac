# page.cmake - makes the page without a server, one file with all in it:
#
#   cmake -D TOP=.. -D ENGINE_FILE=engine.wasm -D OUT=viewer.html -P page.cmake
#
# `snowglass export` adds a volume to it.  The page can reach no other machine:
# its policy says so.  The engine has at most 425,000 bytes when it is packed.
cmake_minimum_required(VERSION 3.20)
set(most 425000)
set(FOLDER ${TOP}/web ${TOP}/wasm/page)
set(ENGINE engine_wasm)
include(${TOP}/serve/modules.cmake)

# Appends a script, whose text no browser may take for its end.
macro(add_script head)
  if("${text}" MATCHES "</script|<!--")
    message(FATAL_ERROR "a script of the page has its own end in it")
  endif()
  file(APPEND ${OUT}.new "<script${head}>\n${text}\n</script>\n")
endmacro()

execute_process(COMMAND zopfli -c ${ENGINE_FILE} OUTPUT_FILE ${OUT}.gz
                COMMAND_ERROR_IS_FATAL ANY)
file(SIZE ${OUT}.gz packed)
if(packed GREATER most)
  message(FATAL_ERROR "${ENGINE_FILE}: ${packed} bytes packed, more than ${most}: "
                      "leave something out (wasm/CMakeLists.txt)")
endif()
message(STATUS "the engine: ${packed} bytes packed, of at most ${most}")
execute_process(COMMAND base64 -w 0 ${OUT}.gz OUTPUT_VARIABLE engine
                COMMAND_ERROR_IS_FATAL ANY)

file(READ ${TOP}/wasm/page/head.html text)
file(WRITE ${OUT}.new "${text}")
read_short(${TOP}/web/viewer.css)
file(APPEND ${OUT}.new "<style>${text}</style>\n</head>\n<body>\n<main id=\"viewer\"></main>\n")
set(text "${engine}")
add_script(" id=\"engine\" type=\"text/plain\"")
read_short(${TOP}/wasm/page/worker.js)
add_script(" id=\"worker\" type=\"text/plain\"")
add_module(viewer "")
get_property(modules GLOBAL PROPERTY modules)
read_short(${TOP}/wasm/page/shell.js)
string(PREPEND text "function begin(host) {\nconst {document, window, location} = host;\n"
       "${modules}\nreturn window.snowglass;\n}\n")
add_script(" type=\"module\"")
file(APPEND ${OUT}.new "</body>\n</html>\n")
file(REMOVE ${OUT}.gz)
file(RENAME ${OUT}.new ${OUT})
