# A test program of googletest. Its sources too are compiled together: each has a namespace with the file's name.
function(robomill_test_program target)
  add_executable(${target} ${ARGN})
  target_link_libraries(${target} PRIVATE robomill_test_flags GTest::gtest_main)
  target_precompile_headers(${target} REUSE_FROM robomill_precompiled_test)
  set_target_properties(${target} PROPERTIES UNITY_BUILD ${ROBOMILL_UNITY} UNITY_BUILD_BATCH_SIZE 12)
endfunction()

# Sources of a stage, compiled once.
function(robomill_objects target precompiled flags libraries)
  add_library(${target} OBJECT ${ARGN})
  target_include_directories(${target} PRIVATE ${PROJECT_SOURCE_DIR})
  target_link_libraries(${target} PRIVATE ${flags} Eigen3::Eigen ${libraries})
  target_precompile_headers(${target} REUSE_FROM ${precompiled})
  set_target_properties(${target} PROPERTIES UNITY_BUILD ${ROBOMILL_UNITY} UNITY_BUILD_BATCH_SIZE 24)
endfunction()

# robomill_stage(NAME modal LAYER 2
#                SOURCES frf.cpp ...            library sources of the stage
#                PUBLIC_HEADERS frf.hpp ...     installed, and compiled on their own
#                DEPENDS base signal            stages on lower layers
#                LIBRARIES Ceres::ceres         third-party libraries, private to the stage
#                COLD files/                    where no source is hot, compiled for a quick build: folders, or . for the whole stage
#                TESTS frf_test.cpp ...         one test program: <name>_test
#                BENCHES lobes_bench.cpp ...    one benchmark program: <name>_bench
#                TEST_LIBRARIES ...             what only tests and benchmarks link: any stage, any library
#                AT_SOURCE ...                  of these, those that read data/ and examples/ by ROBOMILL_SOURCE_DIR
#                THREADED pso_test.cpp ...)     of TESTS, those whose threads ThreadSanitizer looks at; its build has no others
function(robomill_stage)
  cmake_parse_arguments(S "" "NAME;LAYER"
    "SOURCES;PUBLIC_HEADERS;DEPENDS;LIBRARIES;COLD;TESTS;BENCHES;TEST_LIBRARIES;AT_SOURCE;THREADED" ${ARGN})
  set(target robomill_${S_NAME})
  foreach(dependency IN LISTS S_DEPENDS)
    if(NOT TARGET robomill_${dependency})
      message(FATAL_ERROR "stage ${S_NAME}: '${dependency}' is no stage on a lower layer")
    endif()
    get_target_property(below robomill_${dependency} ROBOMILL_LAYER)
    if(NOT below LESS S_LAYER)
      message(FATAL_ERROR "stage ${S_NAME} (layer ${S_LAYER}) must not depend on ${dependency} (layer ${below})")
    endif()
  endforeach()

  # The archive serves tests and the program, the objects the shared library.
  set(hot ${S_SOURCES})
  set(cold "")
  foreach(folder IN LISTS S_COLD)
    string(REPLACE "." "" begin "${folder}")
    set(these ${hot})
    list(FILTER these INCLUDE REGEX "^${begin}")
    list(FILTER hot EXCLUDE REGEX "^${begin}")
    list(APPEND cold ${these})
  endforeach()
  set(objects "")
  if(hot)
    robomill_objects(${target}_objects robomill_precompiled robomill_flags "${S_LIBRARIES}" ${hot})
    list(APPEND objects $<TARGET_OBJECTS:${target}_objects>)
  endif()
  if(cold)
    robomill_objects(${target}_cold_objects robomill_precompiled_cold robomill_cold_flags "${S_LIBRARIES}" ${cold})
    list(APPEND objects $<TARGET_OBJECTS:${target}_cold_objects>)
  endif()
  add_library(${target} STATIC ${objects})
  set_target_properties(${target} PROPERTIES ROBOMILL_LAYER ${S_LAYER})
  target_include_directories(${target} PUBLIC ${PROJECT_SOURCE_DIR})
  target_link_libraries(${target} PRIVATE ${S_LIBRARIES} PUBLIC Eigen3::Eigen)
  foreach(dependency IN LISTS S_DEPENDS)
    target_link_libraries(${target} PUBLIC robomill_${dependency})
  endforeach()
  set_property(GLOBAL APPEND PROPERTY ROBOMILL_STAGE_OBJECTS ${objects})
  set_property(GLOBAL APPEND PROPERTY ROBOMILL_STAGE_LIBRARIES ${S_LIBRARIES})

  foreach(header IN LISTS S_PUBLIC_HEADERS)
    set_property(GLOBAL APPEND PROPERTY ROBOMILL_PUBLIC_HEADERS robomill/${S_NAME}/${header})
  endforeach()

  if(ROBOMILL_TESTS AND ROBOMILL_ALONE_HEADERS)
    # A public header that needs another one first does not compile here.
    set(alone "")
    foreach(header IN LISTS S_PUBLIC_HEADERS)
      set(source ${CMAKE_CURRENT_BINARY_DIR}/alone_${header}.cpp)
      file(CONFIGURE OUTPUT ${source} CONTENT "#include \"robomill/${S_NAME}/${header}\"\n#include \"robomill/${S_NAME}/${header}\"\n")
      list(APPEND alone ${source})
    endforeach()
    if(alone)
      add_library(${target}_headers OBJECT ${alone})
      target_link_libraries(${target}_headers PRIVATE robomill_flags Eigen3::Eigen)
      target_include_directories(${target}_headers PRIVATE ${PROJECT_SOURCE_DIR})
    endif()
  endif()
  set(label ${S_NAME})
  if(ROBOMILL_SANITIZE STREQUAL "thread")
    list(FILTER S_TESTS EXCLUDE REGEX "_test.cpp$")  # helpers stay
    list(PREPEND S_TESTS ${S_THREADED})
    if(NOT S_THREADED)
      set(S_TESTS "")
    endif()
    # One word, which ctest -L finds by either half: gtest_discover_tests tears a list of labels apart.
    string(APPEND label "-threaded")
  endif()
  if(ROBOMILL_TESTS AND S_TESTS)
    robomill_test_program(${S_NAME}_test ${S_TESTS})
    target_link_libraries(${S_NAME}_test PRIVATE ${target} ${S_TEST_LIBRARIES})
    if(ROBOMILL_UNITY)  # a source with definitions of its own would be compiled alone
      target_compile_definitions(${S_NAME}_test PRIVATE ROBOMILL_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
    else()
      set_source_files_properties(${S_AT_SOURCE} PROPERTIES COMPILE_DEFINITIONS ROBOMILL_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
    endif()
    add_dependencies(stage_tests ${S_NAME}_test)
    gtest_discover_tests(${S_NAME}_test DISCOVERY_MODE PRE_TEST DISCOVERY_TIMEOUT 60 PROPERTIES LABELS ${label} TIMEOUT 1200)
  endif()
  if(ROBOMILL_BENCHES AND S_BENCHES)
    add_executable(${S_NAME}_bench ${S_BENCHES})
    target_link_libraries(${S_NAME}_bench PRIVATE robomill_flags ${target} benchmark::benchmark_main ${S_TEST_LIBRARIES})
    set_source_files_properties(${S_AT_SOURCE} PROPERTIES COMPILE_DEFINITIONS ROBOMILL_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
  endif()
endfunction()
