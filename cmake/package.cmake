# The one shared library that consumers link, and its CMake package. A consumer needs Eigen and nothing else.
get_property(objects GLOBAL PROPERTY ROBOMILL_STAGE_OBJECTS)
get_property(libraries GLOBAL PROPERTY ROBOMILL_STAGE_LIBRARIES)
get_property(headers GLOBAL PROPERTY ROBOMILL_PUBLIC_HEADERS)

add_library(robomill SHARED ${objects})
set_target_properties(robomill PROPERTIES LINKER_LANGUAGE CXX)
target_link_libraries(robomill PRIVATE robomill_flags ${libraries} INTERFACE Eigen3::Eigen)
target_include_directories(robomill INTERFACE $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>
  $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}>)
target_compile_features(robomill INTERFACE cxx_std_20)
set_target_properties(robomill PROPERTIES VERSION ${PROJECT_VERSION} SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})

# Components are the Debian packages of cmake/debian.cmake: program, library, development.
install(TARGETS robomill EXPORT robomill LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT library NAMELINK_COMPONENT development)
foreach(header IN LISTS headers)
  get_filename_component(folder ${header} DIRECTORY)
  install(FILES ${PROJECT_SOURCE_DIR}/${header} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/${folder} COMPONENT development)
endforeach()
install(FILES ${PROJECT_SOURCE_DIR}/robomill/robomill.hpp ${PROJECT_SOURCE_DIR}/robomill/version.hpp
  DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/robomill COMPONENT development)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/docs/schema DESTINATION ${CMAKE_INSTALL_DATADIR}/robomill COMPONENT program)
file(RELATIVE_PATH to_prefix /${CMAKE_INSTALL_LIBDIR}/pkgconfig /)
file(CONFIGURE OUTPUT ${CMAKE_CURRENT_BINARY_DIR}/robomill.pc @ONLY CONTENT
"prefix=\${pcfiledir}/@to_prefix@
Name: robomill
Description: @PROJECT_DESCRIPTION@
Version: @PROJECT_VERSION@
Requires: eigen3
Libs: -L\${prefix}/@CMAKE_INSTALL_LIBDIR@ -lrobomill
Cflags: -I\${prefix}/@CMAKE_INSTALL_INCLUDEDIR@
")
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/robomill.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT development)
install(EXPORT robomill NAMESPACE robomill:: DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/robomill FILE robomillTargets.cmake COMPONENT development)
if(TARGET robomill_app)
  install(TARGETS robomill_app RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT program)
  set(texts ${CMAKE_CURRENT_BINARY_DIR}/robomill.bash ${CMAKE_CURRENT_BINARY_DIR}/robomill.1)
  add_custom_command(OUTPUT ${texts} ${CMAKE_CURRENT_BINARY_DIR}/robomill.1.gz DEPENDS robomill_app
    COMMAND robomill_app completion bash -o robomill.bash
    COMMAND robomill_app man -o robomill.1
    COMMAND gzip -9nkf robomill.1)
  add_custom_target(robomill_texts ALL DEPENDS ${texts})
  install(FILES ${CMAKE_CURRENT_BINARY_DIR}/robomill.bash DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions
    RENAME robomill COMPONENT program OPTIONAL)
  install(FILES ${CMAKE_CURRENT_BINARY_DIR}/robomill.1.gz DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT program OPTIONAL)
endif()

include(CMakePackageConfigHelpers)
file(CONFIGURE OUTPUT ${CMAKE_CURRENT_BINARY_DIR}/robomillConfig.cmake @ONLY CONTENT
"include(CMakeFindDependencyMacro)
find_dependency(Eigen3 3.4 NO_MODULE)
include(\"\${CMAKE_CURRENT_LIST_DIR}/robomillTargets.cmake\")
")
write_basic_package_version_file(${CMAKE_CURRENT_BINARY_DIR}/robomillConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/robomillConfig.cmake ${CMAKE_CURRENT_BINARY_DIR}/robomillConfigVersion.cmake
  DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/robomill COMPONENT development)

# What a package of Debian has in its place is made by tools/package.
if(NOT ROBOMILL_DEBIAN)
  install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT program)
endif()
