# cmake -DROOT=<repository> -DVERSION=<version> -P check_public_headers.cmake: fails where selvage.h lacks a public
# header, where version.h names another version than the project, and where a public header holds what only kernels
# need: vector instructions, the choice of an instruction set, hierarchies, traversals, threads.

cmake_policy(VERSION 3.25)

set(violations "")
file(GLOB_RECURSE headers RELATIVE ${ROOT}/include ${ROOT}/include/selvage/*.h)
list(REMOVE_ITEM headers selvage/selvage.h)
if(NOT headers)
  message(FATAL_ERROR "no public header found under ${ROOT}")
endif()
file(STRINGS ${ROOT}/include/selvage/selvage.h umbrella REGEX "^#include")
foreach(header IN LISTS headers)
  if(NOT "#include \"${header}\"" IN_LIST umbrella)
    list(APPEND violations "selvage/selvage.h does not include ${header}")
  endif()
  get_filename_component(name ${header} NAME_WE)
  if(name MATCHES "^(simd|isa|parallel|phases|box|bvh|traverse|overlap)" OR name MATCHES "_kernel$")
    list(APPEND violations "${header}: a header for kernels alone is public")
  endif()
  file(STRINGS ${ROOT}/include/${header} lines
       REGEX "intrin\\.h|<tbb/|SELVAGE_ISA|SELVAGE_INLINE|SELVAGE_DISPATCH|__AVX|__SSE|struct BvhNode|class Bvh ")
  foreach(line IN LISTS lines)
    list(APPEND violations "${header}: \"${line}\" belongs to kernels alone")
  endforeach()
endforeach()

file(READ ${ROOT}/include/selvage/version.h text)
string(REPLACE "." ";" numbers "${VERSION}")
list(GET numbers 0 major)
list(GET numbers 1 minor)
list(GET numbers 2 patch)
foreach(expected IN ITEMS "SELVAGE_VERSION_MAJOR ${major}\n" "SELVAGE_VERSION_MINOR ${minor}\n"
                          "SELVAGE_VERSION_PATCH ${patch}\n" "SELVAGE_VERSION \"${VERSION}\"\n")
  string(FIND "${text}" "#define ${expected}" place)
  if(place EQUAL -1)
    list(APPEND violations "selvage/version.h does not say ${expected}")
  endif()
endforeach()

if(violations)
  list(JOIN violations "\n  " text)
  message(FATAL_ERROR "\n  ${text}")
endif()
list(LENGTH headers count)
message(STATUS "${count} public headers")
