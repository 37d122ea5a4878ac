# Runs an example: cmake -D PROGRAM=... -D PICTURE=... -P run.cmake
# It fails unless the program ends well and leaves a PNG file.
file(REMOVE ${PICTURE})
execute_process(COMMAND ${PROGRAM} ${PICTURE} RESULT_VARIABLE status)
if(NOT status EQUAL 0)
  message(FATAL_ERROR "${PROGRAM} ended with ${status}")
endif()
file(READ ${PICTURE} start LIMIT 8 HEX)
if(NOT start STREQUAL "89504e470d0a1a0a")
  message(FATAL_ERROR "${PICTURE} is no PNG file")
endif()
