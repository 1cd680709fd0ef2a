# The house is built floor by floor: each folder of src/ is one object library that links only to lower floors.

# Settings that every target of the project shares.
add_library(selvage_settings INTERFACE)
target_compile_features(selvage_settings INTERFACE cxx_std_20)
# GCC's straight-line vectorizer (12.2 at least) drops the rounding of a double to float and back, on which every box
# that is rounded outward depends.
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  target_compile_options(selvage_settings INTERFACE -fno-tree-slp-vectorize)
endif()
# The same bits from every instruction set: no fused multiply-add unless the source says so.
target_compile_options(selvage_settings INTERFACE -ffp-contract=off -Wall -Wextra -Wshadow -Wpedantic)
if(CMAKE_CXX_COMPILER_ID MATCHES "Clang")
  # Kernels open their namespace inline where the headers that all floors read do not.
  target_compile_options(selvage_settings INTERFACE -Wno-inline-namespace-reopened-noninline)
endif()
if(CMAKE_UNITY_BUILD AND CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  # Sources that are compiled together look like headers, where a member of a nameless namespace would be amiss.
  target_compile_options(selvage_settings INTERFACE -Wno-subobject-linkage)
endif()
if(SELVAGE_WARNINGS_AS_ERRORS)
  target_compile_options(selvage_settings INTERFACE -Werror)
endif()
if(SELVAGE_MARCH)
  target_compile_options(selvage_settings INTERFACE -march=${SELVAGE_MARCH})
endif()
if(SELVAGE_SANITIZE)
  target_compile_options(selvage_settings INTERFACE -fsanitize=${SELVAGE_SANITIZE} -fno-omit-frame-pointer
                         -fno-sanitize-recover=all)
  # These take minutes to compile; the address sanitizer stands in.
  target_compile_options(selvage_settings INTERFACE -fno-sanitize=null,alignment,object-size,vptr,pointer-overflow)
  target_link_options(selvage_settings INTERFACE -fsanitize=${SELVAGE_SANITIZE})
endif()

# What most files include, read once instead of two seconds a file. Every file still includes what it uses:
# -DCMAKE_DISABLE_PRECOMPILE_HEADERS=ON builds without.
set(SELVAGE_COMMON_HEADERS <Eigen/Core> <Eigen/Geometry> <tbb/blocked_range.h> <tbb/parallel_for.h>
    <tbb/parallel_invoke.h> <tbb/parallel_reduce.h> <tbb/parallel_sort.h> <fmt/format.h> <algorithm> <array> <atomic>
    <cmath> <cstdint> <functional> <future> <memory> <mutex> <optional> <span> <string> <string_view> <vector>)

# selvage_precompile(TARGET OWNER [HEADER...]): TARGET takes OWNER's precompiled headers; OWNER itself makes them.
function(selvage_precompile target owner)
  if(target STREQUAL owner)
    target_precompile_headers(${target} PRIVATE ${SELVAGE_COMMON_HEADERS} ${ARGN})
  else()
    target_precompile_headers(${target} REUSE_FROM ${owner})
  endif()
endfunction()

# selvage_floor(NAME [LOWER...]): the floor in the current folder, made of every .cpp in it and its rooms (kernels
# excepted).
function(selvage_floor name)
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/*.cpp)
  list(FILTER sources EXCLUDE REGEX "_kernel\\.cpp$")
  add_library(selvage_${name} OBJECT ${sources})
  set_target_properties(selvage_${name} PROPERTIES POSITION_INDEPENDENT_CODE ON)
  target_include_directories(selvage_${name} PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include>
                             PRIVATE ${PROJECT_SOURCE_DIR}/src)
  target_link_libraries(selvage_${name} PRIVATE $<BUILD_INTERFACE:selvage_settings> fmt::fmt)
  target_link_libraries(selvage_${name} PUBLIC Eigen3::Eigen TBB::tbb)
  foreach(lower IN LISTS ARGN)
    target_link_libraries(selvage_${name} PUBLIC selvage_${lower})
  endforeach()
  if(SELVAGE_BUILD_FUZZERS AND SELVAGE_SANITIZE AND name MATCHES "^(core|mesh|io|scene)$")
    # Coverage of the readers, which steers the fuzzers; everywhere else it would only slow the other tests down. The
    # fuzzing loop itself is linked into the fuzz targets only, and a sanitizer's runtime takes the calls elsewhere.
    target_compile_options(selvage_${name} PRIVATE
                           -fsanitize-coverage=inline-8bit-counters,pc-table,indirect-calls,trace-cmp)
  endif()
  selvage_precompile(selvage_${name} selvage_core)
endfunction()

# selvage_isa_objects(PREFIX SOURCE): object libraries PREFIX_<isa> of SOURCE, one per instruction set, each in its own
# namespace (SELVAGE_ISA), so that one binary runs on every x86-64; core/isa.h decides at run time which copy is called.
function(selvage_isa_objects prefix source)
  foreach(isa IN ITEMS baseline avx2 avx512)
    set(flags_baseline "")
    set(flags_avx2 "-march=x86-64-v3")
    set(flags_avx512 "-march=x86-64-v4;-mprefer-vector-width=256")
    add_library(${prefix}_${isa} OBJECT ${source})
    set_target_properties(${prefix}_${isa} PROPERTIES POSITION_INDEPENDENT_CODE ON UNITY_BUILD OFF)
    target_compile_definitions(${prefix}_${isa} PRIVATE SELVAGE_ISA=${isa})
    target_compile_options(${prefix}_${isa} PRIVATE ${flags_${isa}})
    target_include_directories(${prefix}_${isa} PRIVATE ${PROJECT_SOURCE_DIR}/include ${PROJECT_SOURCE_DIR}/src)
    target_link_libraries(${prefix}_${isa} PRIVATE selvage_settings Eigen3::Eigen TBB::tbb)
  endforeach()
endfunction()

# selvage_kernel(FLOOR SOURCE): SOURCE, once per instruction set, becomes part of the library.
function(selvage_kernel name source)
  get_filename_component(stem ${source} NAME_WE)
  selvage_isa_objects(selvage_${name}_${stem} ${source})
  foreach(isa IN ITEMS baseline avx2 avx512)
    set_property(GLOBAL APPEND PROPERTY SELVAGE_KERNEL_OBJECTS $<TARGET_OBJECTS:selvage_${name}_${stem}_${isa}>)
  endforeach()
endfunction()

# selvage_library(FLOOR...): the one library users link to, and its installation.
macro(selvage_library)
  get_property(kernel_objects GLOBAL PROPERTY SELVAGE_KERNEL_OBJECTS)
  add_library(selvage ${kernel_objects})
  foreach(floor ${ARGN})
    target_sources(selvage PRIVATE $<TARGET_OBJECTS:selvage_${floor}>)
  endforeach()
  add_library(selvage::selvage ALIAS selvage)
  target_compile_features(selvage PUBLIC cxx_std_20)
  target_include_directories(selvage PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include>
                             $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  target_link_libraries(selvage PRIVATE $<BUILD_INTERFACE:selvage_settings> fmt::fmt ZLIB::ZLIB pugixml::pugixml
                        PUBLIC Eigen3::Eigen TBB::tbb)
  set_target_properties(selvage PROPERTIES LINKER_LANGUAGE CXX VERSION ${PROJECT_VERSION}
                        SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
  include(CMakePackageConfigHelpers)
  install(TARGETS selvage EXPORT selvage-targets)
  install(DIRECTORY include/selvage DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
  install(EXPORT selvage-targets NAMESPACE selvage:: DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/selvage)
  configure_package_config_file(cmake/selvage-config.cmake.in ${PROJECT_BINARY_DIR}/selvage-config.cmake
                                INSTALL_DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/selvage)
  write_basic_package_version_file(${PROJECT_BINARY_DIR}/selvage-config-version.cmake COMPATIBILITY SameMinorVersion)
  install(FILES ${PROJECT_BINARY_DIR}/selvage-config.cmake ${PROJECT_BINARY_DIR}/selvage-config-version.cmake
          DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/selvage)
endmacro()
