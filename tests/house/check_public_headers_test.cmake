# cmake -DSCRATCH=<folder> -P check_public_headers_test.cmake: check_public_headers.cmake finds what it is there to find.

include(${CMAKE_CURRENT_LIST_DIR}/expect_verdict.cmake)

# expect(PASSES|FAILS VERSION HEADER LINE [MESSAGE]): the verdict on one public header beside selvage.h and version.h.
function(expect verdict version header line)
  file(REMOVE_RECURSE ${SCRATCH})
  set(folder ${SCRATCH}/include/selvage)
  file(WRITE ${folder}/selvage.h "#include \"selvage/mesh/a.h\"\n#include \"selvage/version.h\"\n")
  file(WRITE ${folder}/version.h "#define SELVAGE_VERSION_MAJOR 1\n#define SELVAGE_VERSION_MINOR 2\n"
             "#define SELVAGE_VERSION_PATCH 3\n#define SELVAGE_VERSION \"1.2.3\"\n")
  file(WRITE ${folder}/${header} "#pragma once\n${line}\n")
  expect_verdict(check_public_headers "-DROOT=${SCRATCH};-DVERSION=${version}" ${verdict} "${header} with '${line}'"
                 ${ARGN})
endfunction()

expect(PASSES 1.2.3 mesh/a.h "#include <vector>")
expect(FAILS 1.2.3 mesh/b.h "#include <vector>" "does not include selvage/mesh/b.h")
expect(FAILS 1.2.4 mesh/a.h "#include <vector>" "does not say SELVAGE_VERSION_PATCH 4")
expect(FAILS 1.2.3 mesh/a.h "#include <immintrin.h>" "belongs to kernels alone")
expect(FAILS 1.2.3 mesh/a.h "#include <tbb/parallel_for.h>" "belongs to kernels alone")
expect(FAILS 1.2.3 mesh/a.h "inline namespace SELVAGE_ISA {" "belongs to kernels alone")
expect(FAILS 1.2.3 bvh/traverse.h "" "a header for kernels alone is public")
expect(FAILS 1.2.3 mesh/a_kernel.h "" "a header for kernels alone is public")
file(REMOVE_RECURSE ${SCRATCH})
