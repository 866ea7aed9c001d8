# Every third-party library: one imported target each, its headers SYSTEM. Debian's packages are in packages.txt.
find_package(Threads REQUIRED)
find_package(PkgConfig REQUIRED)
find_package(Eigen3 3.4 REQUIRED NO_MODULE)
find_package(fmt 9 REQUIRED)
find_package(nlohmann_json 3.11 REQUIRED)
find_package(Ceres 2.1 REQUIRED)
find_package(Pagmo 2.18 REQUIRED)
find_package(Boost 1.74 REQUIRED)
find_package(fcl 0.7 REQUIRED)  # target fcl; brings libccd and octomap (all three BSD)
if(ROBOMILL_THREADS STREQUAL "tbb")
  find_package(TBB REQUIRED)
endif()
if(ROBOMILL_APP)
  find_package(CLI11 2.1 REQUIRED)
  find_package(OpenSSL REQUIRED)  # which Paho's targets name
  find_package(eclipse-paho-mqtt-c 1.3 REQUIRED)
  # One header and the library that carries its functions.
  pkg_check_modules(httplib REQUIRED IMPORTED_TARGET cpp-httplib)
endif()
pkg_check_modules(hdf5 REQUIRED IMPORTED_TARGET hdf5)
pkg_check_modules(matio REQUIRED IMPORTED_TARGET matio)
pkg_check_modules(zlib REQUIRED IMPORTED_TARGET zlib)
pkg_check_modules(sndfile REQUIRED IMPORTED_TARGET sndfile)
pkg_check_modules(kdl REQUIRED IMPORTED_TARGET orocos-kdl)
pkg_check_modules(urdfdom REQUIRED IMPORTED_TARGET urdfdom tinyxml)  # tinyxml is what urdfdom reads XML with

# kissfft.hh is one header, a template over the scalar.
find_path(KISSFFT_INCLUDE_DIR kissfft.hh PATH_SUFFIXES kissfft REQUIRED)
add_library(kissfft_headers INTERFACE)
target_include_directories(kissfft_headers SYSTEM INTERFACE ${KISSFFT_INCLUDE_DIR})

# toml++ is used as one header, so that nothing has to be linked.
find_path(TOMLPLUSPLUS_INCLUDE_DIR toml++/toml.h REQUIRED)
add_library(tomlplusplus_headers INTERFACE)
target_include_directories(tomlplusplus_headers SYSTEM INTERFACE ${TOMLPLUSPLUS_INCLUDE_DIR})
target_compile_definitions(tomlplusplus_headers INTERFACE TOML_HEADER_ONLY=1)

if(ROBOMILL_TESTS)
  find_package(GTest 1.12 REQUIRED)
endif()
if(ROBOMILL_BENCHES)
  find_package(benchmark 1.7 REQUIRED)
endif()
