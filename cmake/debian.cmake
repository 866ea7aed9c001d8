# The packages of Debian: a component of cmake/package.cmake each. tools/package makes them.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME robomill)
set(CPACK_PACKAGE_VENDOR "robomill")
set(CPACK_PACKAGE_VERSION ${PROJECT_VERSION})
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_THREADS 1)  # the same bytes from the same files
set(CPACK_COMPONENTS_ALL program library development)
if(ROBOMILL_PYTHON)
  list(APPEND CPACK_COMPONENTS_ALL python)
endif()
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_COMPRESSION_TYPE xz)
set(CPACK_DEBIAN_PACKAGE_RELEASE 1)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS ${PROJECT_BINARY_DIR})
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS ON)
# Its default: CPack puts any other one before the packages' own first lines.
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "${CMAKE_PROJECT_NAME} built using CMake")
set(ROBOMILL_MAINTAINER "The robomill authors <robomill@localhost>" CACHE STRING "Maintainer of the Debian packages")
set(CPACK_DEBIAN_PACKAGE_MAINTAINER ${ROBOMILL_MAINTAINER})

set(library_package librobomill${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
set(of_this_version "(= ${PROJECT_VERSION}-${CPACK_DEBIAN_PACKAGE_RELEASE})")

# robomill_package(PROGRAM robomill science "a line" "what it has" DEPENDS …)
macro(robomill_package component name section line text)
  set(CPACK_DEBIAN_${component}_PACKAGE_NAME ${name})
  set(CPACK_DEBIAN_${component}_PACKAGE_SECTION ${section})
  set(CPACK_DEBIAN_${component}_DESCRIPTION "${line}\nrobomill takes hammer hits, or a tool's drawing, and an NC program to spindle\nspeeds and depths of cut without chatter, forces, a smooth joint trajectory,\nand an alarm while cutting.\n\n${text}")
  set(CPACK_DEBIAN_${component}_PACKAGE_DEPENDS "${ARGN}")
  string(TOLOWER ${component} installed)
  install(DIRECTORY ${PROJECT_BINARY_DIR}/packaging/${name}/ DESTINATION share/doc/${name} COMPONENT ${installed})
  install(FILES ${PROJECT_BINARY_DIR}/packaging/overrides/${name} DESTINATION share/lintian/overrides COMPONENT ${installed})
endmacro()

robomill_package(PROGRAM robomill science "milling with robots without chatter: program"
  "This package has the program, with its page, manual, completion, schemas and\nexamples." "${library_package} ${of_this_version}")
robomill_package(LIBRARY ${library_package} libs "milling with robots without chatter: shared library"
  "This package has the shared library.")
robomill_package(DEVELOPMENT librobomill-dev libdevel "milling with robots without chatter: headers"
  "This package has the headers, and what CMake and pkg-config\nneed." "${library_package} ${of_this_version}, libeigen3-dev")
if(ROBOMILL_PYTHON)
  robomill_package(PYTHON python3-robomill python "milling with robots without chatter: Python module"
    "This package has the module robomill." "${library_package} ${of_this_version}, python3 (>= 3.11), python3 (<< 3.12), python3-numpy")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_RECOMMENDS "python3-matplotlib, robomill")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_CONTROL_EXTRA ${PROJECT_SOURCE_DIR}/packaging/python/postinst ${PROJECT_SOURCE_DIR}/packaging/python/prerm)
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/python/examples/ DESTINATION share/doc/python3-robomill/examples COMPONENT python
    FILES_MATCHING PATTERN "*.py" PATTERN "README.md")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_SHLIBDEPS ON)
endif()
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_LIBRARY_PACKAGE_SHLIBDEPS ON)
file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/packaging/triggers CONTENT "activate-noawait ldconfig\n")
set(CPACK_DEBIAN_LIBRARY_PACKAGE_CONTROL_EXTRA ${PROJECT_BINARY_DIR}/packaging/triggers)
# Those that need no program of their own; packaging/check runs them.
foreach(example IN ITEMS ball-end-lobes ball-end-ur5e force-along-program joint-bar new-tool)
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/examples/${example} DESTINATION share/doc/robomill/examples COMPONENT program
    FILES_MATCHING PATTERN "*.toml" PATTERN "*.ngc" PATTERN "README.md")
endforeach()
include(CPack)
