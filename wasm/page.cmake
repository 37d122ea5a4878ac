# page.cmake - makes the page without a server, one file with all in it:
#
#   cmake -D TOP=.. -D ENGINE_FILE=engine.wasm -D ESBUILD=esbuild -D OUT=viewer.html
#         -P page.cmake
#
# `snowglass export` adds a volume to it.  The page alone may read what its user names
# on servers; one with a volume can reach no machine (cmd_export.c): policies say so.
# The engine has at most 450,000 bytes when it is packed.
cmake_minimum_required(VERSION 3.20)
set(most 450000)
set(folder ${OUT}.d)

# Sets `text` to what esbuild makes of a file, by more words.
macro(read_short path)
  execute_process(COMMAND ${ESBUILD} ${path} --minify --charset=utf8 --log-level=warning ${ARGN}
                  OUTPUT_VARIABLE text COMMAND_ERROR_IS_FATAL ANY)
endmacro()

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
# Whose code that is, and on what terms, goes wherever a page goes.
file(READ ${TOP}/packaging/debian/copyright text)
if("${text}" MATCHES "--!?>|<!--")
  message(FATAL_ERROR "packaging/debian/copyright has the end of a comment in it")
endif()
file(APPEND ${OUT}.new "<!--\n${text}-->\n")
read_short(${TOP}/wasm/page/remote.js)
set(remote "${text}")
read_short(${TOP}/wasm/page/worker.js)
string(PREPEND text "${remote}")
add_script(" id=\"worker\" type=\"text/plain\"")
# Among the modules engine_wasm.js takes the place of engine_server.js, which it imports.
file(REMOVE_RECURSE ${folder})
file(COPY ${TOP}/web/ DESTINATION ${folder})
file(RENAME ${folder}/engine_server.js ${folder}/engine_socket.js)
file(READ ${TOP}/wasm/page/engine_wasm.js text)
string(REPLACE "/engine_server.js'" "/engine_socket.js'" text "${text}")
file(WRITE ${folder}/engine_server.js "${text}")
read_short(${folder}/viewer.js --bundle --format=esm)
set(viewer "${text}")
read_short(${TOP}/wasm/page/shell.js --bundle --format=esm)
string(PREPEND text "function begin(host){const{document,window,location}=host;${viewer}"
       "return window.snowglass}\n")
add_script(" type=\"module\"")
file(APPEND ${OUT}.new "</body>\n</html>\n")
file(REMOVE ${OUT}.gz)
file(RENAME ${OUT}.new ${OUT})
