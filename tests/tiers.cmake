# Which tests belong to which tier, and which of them take long.
#
# Labels:
#   long     not run by the short tier: it takes long, or repeats with large data
#            what another test shows with small
#   surface  reads what comes from elsewhere: files, recipes, command lines;
#            run under the address and undefined-behaviour sanitizers by each
#            tier
#   threads  runs threads; run under the thread sanitizer by the long tier
#   plain    not run under sanitizers: it compares numbers with a reference in
#            double, or looks at timing and memory of processes
# The sanitized builds of the long tier run all but `long` and `plain`.
set(SNOW_LABEL_long cli_large simulate mpi_bench mpi_combine mpi_fail mpi_hosts
    mpi_insitu mpi_kill mpi_modes mpi_other mpi_stall)
set(SNOW_LABEL_surface test_base test_compare test_convert test_corpus test_den
    test_dicom test_hdf5 test_image test_mask test_metaimage test_mrc
    test_netcdf test_nifti test_npy test_npy_pfm test_nrrd test_pictures
    test_png test_png_slice test_raw test_recipe test_save test_source test_tf
    test_tiff test_volume test_vti test_vtk test_writer test_writer_named
    test_zarr)
set(SNOW_LABEL_threads test_affinity test_bands test_combine test_comm test_early
    test_pipeline test_frames test_insitu test_insitu_marks test_modes
    test_raycast test_value test_simulated test_stop test_progress test_ranks test_ranks_open test_shear_warp_bits test_redistribute
    test_load_balance)
set(SNOW_LABEL_plain test_model_camera test_model_encodings test_model_picture
    test_model_raycast test_model_reference test_model_rules test_model_slabs
    test_value_field test_value_model test_value_truth
    test_value_views
    test_shear_warp_quality test_phantom test_perspective test_camera_points
    test_normals cli_documents cli_bench cli_figures cli_frame cli_stream
    cli_matrix cli_balance cli_turntable cli_modules cli_memory cli_progress
    cli_large oracle_zarr oracle_tiff oracle_vtk oracle_pictures)

# Seconds on one core in the short tier, of those that take more than one: ctest
# begins with the longest, so that no core is idle at the end.
set(SNOW_COSTS
    mpi_stall 300 mpi_insitu 280 simulate 270 mpi_render 260 mpi_modes 250
    mpi_fail 240 mpi_comm 230 mpi_bench 220 cli_progress 200 cli_large 190
    test_ranks 150 cli_stream 140 test_stream 130 cli_documents 120
    test_shear_warp 110 oracle_orientation 100 oracle_zarr 95 oracle_vtk 90
    cli_bench 85 cli_figures 80 cli_turntable 75 cli_matrix 70 test_modes 65
    test_shear_warp_bits 64 test_model_picture 63 test_combine 62 test_mipmap 61
    test_ranks_open 60 test_pipeline 58 cli_render 57 test_bands 56
    test_phantom 55 oracle_tiff 54 test_shear_warp_quality 53 test_shear_warp_perspective 52
    test_histogram 51 test_early 50 test_insitu 49 test_model_encodings 48
    test_gradient_opacity 47 cli_frame 46 cli_config 45 cli_formats 44 cli_balance 43
    catalyst 42 cli_convert 41 oracle_dicom 40 oracle_pictures 39
    test_deterministic 38 test_comm 37 test_load_balance 36 test_splat_isa 35
    test_perspective 34 cli_real 33 cli_mask 32
    test_raycast 105 test_value 68)

file(GLOB_RECURSE sources *.c *.sh *.py)
get_property(tests DIRECTORY PROPERTY TESTS)
foreach(label long surface threads plain)
  foreach(test ${SNOW_LABEL_${label}})
    if(test IN_LIST tests)
      set_property(TEST ${test} APPEND PROPERTY LABELS ${label})
    elseif(NOT test MATCHES "^(simulate|test_writer_named)$" AND
           NOT sources MATCHES "/${test}[.](c|sh|py)(;|$)")
      message(FATAL_ERROR "tests/tiers.cmake: there is no test '${test}'")
    endif()
  endforeach()
endforeach()

# Targets surface_tests and threads_tests: the programs of these labels, for
# builds that run no others.
file(GLOB fuzzers CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/fuzz/fuzz_*.c)
foreach(label surface threads)
  add_custom_target(${label}_tests)
  foreach(test ${SNOW_LABEL_${label}})
    if(TARGET ${test})
      add_dependencies(${label}_tests ${test})
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
  endif()
endforeach()
