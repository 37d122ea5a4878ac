# cmake/uninstall.cmake - `cmake -DBUILD=FOLDER -P uninstall.cmake`: removes what
# was installed from a build folder, by the lists that CMake keeps there.  Python
# writes bytecode beside its modules, which no list has; while a file is in its
# folder `import snowglass` succeeds.  Folders of ours that are empty then go too.
file(GLOB lists "${BUILD}/install_manifest*.txt")
if(NOT lists)
  message(FATAL_ERROR "${BUILD}: nothing was installed from this folder; name the "
                      "build folder that cmake --install was given")
endif()
set(folders "")
set(ours "/(lib[^/]*|[^/]*-linux-gnu[^/]*|share|doc|include|cmake|[a-z]*-packages)/snowglass")
foreach(list IN LISTS lists)
  file(STRINGS "${list}" files)
  foreach(file IN LISTS files)
    string(PREPEND file "$ENV{DESTDIR}")
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
      list(APPEND folders "${folder}")
      get_filename_component(folder "${folder}" DIRECTORY)
    endwhile()
  endforeach()
endforeach()
list(REMOVE_DUPLICATES folders)
list(SORT folders ORDER DESCENDING) # what lies in a folder goes before it
foreach(folder IN LISTS folders)
  execute_process(COMMAND rmdir "${folder}" ERROR_QUIET) # if it is empty
endforeach()
