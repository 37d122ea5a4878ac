# Which tests belong to which tier, and which of them take long.
#
# Labels:
#   release  of those that are `long`, run by ./dev test --release alone: on an
#            emulated machine what another test shows on a real one, or with the
#            other MPI what does not depend on it
#   long     not run by the short tier: it takes long, or repeats with large data
#            what another test shows with small
#   late     not run by the short tier either, but under sanitizers by the long
#            one: the bench program and its tables, the in situ adaptor, the
#            installed library, numbers held against a truth, files and
#            pictures held against other libraries, and what another
#            test of the short tier calls
#   surface  reads what comes from elsewhere: files, recipes, command lines;
#            run under the address and undefined-behaviour sanitizers by each
#            tier; all of formats/, and those named here
#   threads  runs threads; run under the thread sanitizer by the long tier
#   plain    not run under sanitizers: it compares numbers with a reference in
#            double, or looks at timing and memory of processes
# The sanitized builds of the long tier run all but `long` and `plain`.
set(SNOW_LABEL_release isa_wasm)
set(SNOW_LABEL_long cli_documents cli_paper cli_tutorials cli_large cli_matrix cli_stream cli_turntable
    isa_neon isa_wasm mpi_bench mpi_clusters mpi_fail mpi_hosts
    mpi_insitu mpi_other mpi_overlay mpi_python mpi_serve mpi_stall
    package_abi package_access package_cmake package_copies
    serve_fuzz
    package_layout package_manual package_pkgconfig package_recipes package_release package_site package_wheel
    package_within wasm_engine wasm_page)
set(SNOW_LABEL_late
    catalyst cli_codes cli_report cli_again cli_background cli_bench cli_figures
    cli_interrupt cli_limits cli_measurements cli_ranks cli_real
    cli_shear_warp cli_show mpi_comm oracle_amr oracle_cf oracle_damage oracle_dicom oracle_fit
    oracle_hdf5 oracle_mosaic oracle_mrc oracle_netcdf oracle_nibabel oracle_npy
    oracle_ome oracle_orientation oracle_pictures
    oracle_seg oracle_series oracle_slice oracle_tiff oracle_vtk oracle_zarr test_comm
    test_histogram test_model_encodings
    test_phantom test_raycast test_splat_threads test_stream)
file(GLOB formats CONFIGURE_DEPENDS formats/test_*.c)
list(TRANSFORM formats REPLACE ".*/(.*)[.]c$" "\\1")
set(SNOW_LABEL_surface ${formats} test_base test_compare test_convert test_image
    test_guard test_live_file test_mask test_message test_npy_pfm test_pictures test_png test_recipe test_save
    test_source test_tf test_volume test_writer test_writer_named)
set(SNOW_LABEL_threads test_affinity test_same_bits test_combine test_comm
    test_pipeline test_frames test_insitu test_insitu_levels test_insitu_marks test_insitu_output
    test_raycast test_shear_warp test_shear_warp_slabs test_simulated test_stop test_progress test_ranks test_ranks_open test_redistribute
    test_pool_signals serve_hostile serve_places serve_sockets)
set(SNOW_LABEL_plain test_model_camera test_model_encodings test_model_picture
    test_model_reference test_model_rules
    test_truth test_truth_edges test_laws
    test_phantom test_camera_points
    cli_documents cli_bench cli_figures cli_ranks cli_stream
    cli_again cli_matrix cli_turntable cli_modules cli_memory cli_progress cli_shear_warp
    serve_browser cli_interrupt cli_large cli_measurements oracle_zarr oracle_tiff
    oracle_vtk oracle_pictures oracle_damage cli_limits)

# Seconds that a test of the long tier took on a quiet machine of two cores, of
# those that take more than eight; of those that became shorter since, the share that
# is left of their processor time.  ctest begins with the longest, so that no core is
# idle at the end.
set(SNOW_COSTS
    serve_browser 110 python 88 cli_stream 60 cli_large 66 mpi_render 49
    wasm_engine 48 wasm_page 54 mpi_serve 42 serve_sockets 42 isa_neon 42
    mpi_stall 40 package_wheel 40 test_stream 35 test_ranks 35 cli_figures 33
    cli_documents 31 test_ranks_open 31 oracle_amr 22 package_cmake 30
    oracle_zarr 29 oracle_vtk 29 cli_turntable 28 mpi_fail 25 test_same_bits 25
    oracle_damage 25 package_manual 24 package_within 22 cli_bench 22
    oracle_netcdf 22 oracle_hdf5 21 test_pipeline 21 mpi_insitu 21
    test_histogram 20 cli_again 20 test_stop 18 cli_channels 18 cli_shear_warp 9
    oracle_tiff 20 cli_interrupt 17 serve_fuzz 16 test_raycast 15 cli_render 15
    mpi_comm 14 test_insitu 14 package_site 14 oracle_orientation 13
    serve_hostile 13 oracle_dicom 16 oracle_slice 17
    test_model_picture 13 cli_progress 12 oracle_seg 12 test_truth 12
    test_combine 11 package_layout 10 cli_real 10 mpi_python 10 test_modes 10
    package_pkgconfig 10 cli_matrix 10 test_channels 9 test_model_encodings 9
    cli_memory 8 mpi_clusters 8 oracle_series 8 test_laws 8 test_faults 8)

file(GLOB_RECURSE sources *.c *.sh *.py)
get_property(tests DIRECTORY PROPERTY TESTS)
foreach(label release long late surface threads plain)
  foreach(test ${SNOW_LABEL_${label}})
    if(test IN_LIST tests)
      set_property(TEST ${test} APPEND PROPERTY LABELS ${label})
    elseif(NOT test MATCHES "^(isa_neon|isa_wasm|test_writer_named)$" AND
           NOT sources MATCHES "/${test}[.](c|sh|py)(;|$)")
      message(FATAL_ERROR "tests/tiers.cmake: there is no test '${test}'")
    endif()
  endforeach()
endforeach()

# Sanitized builds do not make what they never run.
if(SNOW_SANITIZE)
  foreach(test ${SNOW_LABEL_plain})
    if(TARGET ${test})
      set_target_properties(${test} PROPERTIES EXCLUDE_FROM_ALL TRUE)
    endif()
  endforeach()
endif()

# Targets surface_tests and threads_tests: the programs of these labels, for
# builds that run no others; a script needs the tool.
file(GLOB fuzzers CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/fuzz/fuzz_*.c)
foreach(label surface threads)
  add_custom_target(${label}_tests)
  foreach(test ${SNOW_LABEL_${label}})
    if(TARGET ${test})
      add_dependencies(${label}_tests ${test})
    elseif(test IN_LIST tests)
      add_dependencies(${label}_tests snowglass_tool)
    endif()
  endforeach()
endforeach()
foreach(source ${fuzzers})
  get_filename_component(name ${source} NAME_WE)
  add_dependencies(surface_tests ${name})
endforeach()

list(LENGTH SNOW_COSTS count)
math(EXPR last "${count} / 2 - 1")
foreach(n RANGE ${last})
  math(EXPR at "2 * ${n}")
  math(EXPR next "2 * ${n} + 1")
  list(GET SNOW_COSTS ${at} test)
  list(GET SNOW_COSTS ${next} cost)
  if(test IN_LIST tests)
    set_tests_properties(${test} PROPERTIES COST ${cost})
  elseif(NOT test MATCHES "^(isa_neon|isa_wasm|python)$" AND
         NOT sources MATCHES "/${test}[.](c|sh|py)(;|$)")
    message(FATAL_ERROR "tests/tiers.cmake: there is no test '${test}'")
  endif()
endforeach()
