# The flags of every target of ours; third-party headers come as SYSTEM and stay silent. Sources link robomill_flags, those of no
# hot loop robomill_cold_flags, tests robomill_test_flags.
add_library(robomill_common_flags INTERFACE)
add_library(robomill_flags INTERFACE)
add_library(robomill_cold_flags INTERFACE)
target_compile_options(robomill_common_flags INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wold-style-cast -ffp-contract=off)
if(ROBOMILL_WERROR)
  target_compile_options(robomill_common_flags INTERFACE -Werror)
endif()
# A macro of fmt's headers, which are precompiled for all.
target_compile_definitions(robomill_common_flags INTERFACE $<TARGET_PROPERTY:fmt::fmt,INTERFACE_COMPILE_DEFINITIONS>)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  # GCC 12 sees an uninitialised read in Eigen's packet code where there is none (GCC bug 105562).
  # With precompiled headers it also sees strings copied beyond their bounds (like GCC bugs 105329 and 105651).
  target_compile_options(robomill_common_flags INTERFACE -Wno-maybe-uninitialized -Wno-array-bounds -Wno-restrict
    -Wno-stringop-overflow -Wno-stringop-overread)
  # A tenth of the compile time is the collection of what GCC no longer needs, unless it may take 2 GB first.
  target_compile_options(robomill_common_flags INTERFACE "SHELL:--param ggc-min-expand=400" "SHELL:--param ggc-min-heapsize=2000000")
endif()
# Clang has no code of its own for atomic values of more than a word.
target_link_libraries(robomill_common_flags INTERFACE $<$<CXX_COMPILER_ID:Clang>:atomic>)
if(ROBOMILL_UNITY)
  # Sources that are compiled together see each other's unnamed namespaces.
  target_compile_options(robomill_common_flags INTERFACE -Wno-shadow $<$<CXX_COMPILER_ID:GNU>:-Wno-subobject-linkage>)
endif()
# UndefinedBehaviorSanitizer looks at the product alone: in the tests' own code it costs 40 % of their compile time.
string(REPLACE ",undefined" "" test_sanitizers "${ROBOMILL_SANITIZE}")
add_library(robomill_test_flags INTERFACE)
target_link_libraries(robomill_test_flags INTERFACE robomill_common_flags)
target_link_libraries(robomill_flags INTERFACE robomill_common_flags)
target_link_libraries(robomill_cold_flags INTERFACE robomill_flags)
# The flag that comes last counts.
target_compile_options(robomill_cold_flags INTERFACE ${ROBOMILL_COLD})
target_compile_options(robomill_test_flags INTERFACE ${ROBOMILL_COLD})
if(ROBOMILL_SANITIZE)
  set(reports -fno-omit-frame-pointer -fno-sanitize-recover=all)
  # Not UndefinedBehaviorSanitizer's checks of null and of alignment, which double the time that Eigen's kernels take to compile
  # and to run: AddressSanitizer detects a dereferenced null pointer too, and bytes are decoded by value, by no cast of a pointer.
  # Nor that of the dynamic type: it opens a pipe to see whether memory can be read, and a child that reads MAT files may open none.
  target_compile_options(robomill_flags INTERFACE -fsanitize=${ROBOMILL_SANITIZE} -fno-sanitize=null,alignment,vptr ${reports})
  target_compile_options(robomill_test_flags INTERFACE -fsanitize=${test_sanitizers} ${reports})
  target_link_options(robomill_common_flags INTERFACE -fsanitize=${ROBOMILL_SANITIZE})
endif()
