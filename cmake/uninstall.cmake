# cmake/uninstall.cmake - `cmake -DBUILD=FOLDER -P uninstall.cmake`: removes what
# was installed from a build folder, by the lists that CMake keeps there and where
# their files went (install.cmake).  A list is used once.  Python writes bytecode
# beside its modules, which no list has; while a file is in its folder
# `import snowglass` succeeds.  Folders of ours that are empty then go too.
cmake_minimum_required(VERSION 3.20)
file(GLOB lists "${BUILD}/install_manifest*.txt")
if(NOT lists)
  message(FATAL_ERROR "${BUILD}: nothing was installed from this folder; name the "
                      "build folder that cmake --install was given")
endif()

# Before anything is removed.
foreach(list IN LISTS lists)
  if(NOT EXISTS "${list}.root")
    message(FATAL_ERROR "${list}: nobody knows below which DESTDIR these files are; "
                        "install once more, or remove them by this list")
  endif()
  file(STRINGS "${list}.root" place) # DESTDIR, in brackets, and the prefix
  string(REGEX MATCH "^<(.*)>;(.*)$" place "${place}")
  set(root "${CMAKE_MATCH_1}")
  if(DEFINED ENV{DESTDIR} AND NOT "$ENV{DESTDIR}" STREQUAL root)
    message(FATAL_ERROR "${list}: its files went below '${root}/', not DESTDIR "
                        "'$ENV{DESTDIR}'; leave DESTDIR away")
  endif()
endforeach()

set(folders "")
set(ours "/(lib[^/]*|[^/]*-linux-gnu[^/]*|share|doc|include|cmake|[a-z]*-packages)/snowglass")
foreach(list IN LISTS lists)
  file(STRINGS "${list}.root" place)
  string(REGEX MATCH "^<(.*)>;(.*)$" place "${place}")
  set(root "${CMAKE_MATCH_1}")
  # CMake makes the folder of an optional file that is not there.
  set(tops "${root}${CMAKE_MATCH_2}/share/snowglass")
  file(STRINGS "${list}" files)
  foreach(file IN LISTS files)
    string(PREPEND file "${root}")
    file(REMOVE "${file}")
    get_filename_component(folder "${file}" DIRECTORY)
    if(file MATCHES "/([^/]*)[.]py$")
      file(GLOB bytecode "${folder}/__pycache__/${CMAKE_MATCH_1}.*.pyc")
      foreach(each IN LISTS bytecode)
        file(REMOVE "${each}")
      endforeach()
      list(APPEND folders "${folder}/__pycache__")
    endif()
    while(folder MATCHES "${ours}")
      list(APPEND tops "${folder}")
      get_filename_component(folder "${folder}" DIRECTORY)
    endwhile()
  endforeach()
  file(REMOVE "${list}" "${list}.root")
  list(REMOVE_DUPLICATES tops)
  foreach(top IN LISTS tops)
    file(GLOB within LIST_DIRECTORIES true "${top}/*")
    list(APPEND folders "${top}" ${within})
  endforeach()
endforeach()
list(REMOVE_DUPLICATES folders)
list(SORT folders ORDER DESCENDING) # what lies in a folder goes before it
foreach(folder IN LISTS folders)
  if(IS_DIRECTORY "${folder}" AND NOT IS_SYMLINK "${folder}")
    execute_process(COMMAND rmdir "${folder}" ERROR_QUIET) # if it is empty
  endif()
endforeach()
