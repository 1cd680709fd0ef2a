# cmake -DSCRATCH=<folder> -P check_includes_test.cmake: check_includes.cmake finds what it is there to find.

# expect(PASSES|FAILS FILE INCLUDE-LINE [MESSAGE]): the verdict on a repository of one file with one include.
function(expect verdict file line)
  file(REMOVE_RECURSE ${SCRATCH})
  file(WRITE ${SCRATCH}/${file} "#pragma once\n${line}\n")
  execute_process(COMMAND ${CMAKE_COMMAND} -DROOT=${SCRATCH} -P ${CMAKE_CURRENT_LIST_DIR}/check_includes.cmake
                  RESULT_VARIABLE status OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(verdict STREQUAL PASSES AND NOT status EQUAL 0)
    message(SEND_ERROR "${file} with '${line}' should pass, but:\n${output}")
  elseif(verdict STREQUAL FAILS AND (status EQUAL 0 OR NOT output MATCHES "${ARGN}"))
    message(SEND_ERROR "${file} with '${line}' should fail with '${ARGN}', but:\n${output}")
  endif()
endfunction()

expect(PASSES src/bvh/a.cpp [[#include "selvage/core/types.h"]])
expect(PASSES src/bvh/a.cpp [[#include "bvh/private.h"]])
expect(PASSES src/cli/a.cpp [[#include "selvage/boundary_path/boundary_path.h"]])
expect(PASSES include/selvage/mesh/a.h [[#include <vector>]])
expect(PASSES include/selvage/core/simd.h [[#include <immintrin.h>]])
expect(FAILS src/mesh/a.cpp [[#include "selvage/bvh/bvh.h"]] "mesh may not include bvh")
expect(FAILS src/core/a.h [[#  include "geometry/exact.h"]] "core may not include geometry")
expect(FAILS src/boundary_path/a.cpp [[#include "selvage/self_collision/a.h"]] "boundary_path may not include self_collision")
expect(FAILS include/selvage/bvh/a.h [[#include "mesh/private.h"]] "public header includes a private one")
expect(FAILS include/selvage/attic/a.h [[#include <vector>]] "attic is no floor")
expect(FAILS src/bvh/a.cpp [[#include "attic/a.h"]] "attic is no floor")
expect(FAILS src/bvh/a_kernel.cpp [[#include <immintrin.h>]] "intrinsics live in")
expect(FAILS src/bvh/a_kernel.cpp [[#include <emmintrin.h>]] "intrinsics live in")
file(REMOVE_RECURSE ${SCRATCH})
