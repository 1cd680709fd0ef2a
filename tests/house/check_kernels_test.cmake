# cmake -DSCRATCH=<folder> -P check_kernels_test.cmake: check_kernels.cmake finds what it is there to find. The objects
# here are texts, and nm prints them.

include(${CMAKE_CURRENT_LIST_DIR}/expect_verdict.cmake)

file(REMOVE_RECURSE ${SCRATCH})
file(WRITE ${SCRATCH}/nm "#!/bin/sh\nfor object; do :; done\nexec cat \"$object\"\n")
file(CHMOD ${SCRATCH}/nm PERMISSIONS OWNER_READ OWNER_EXECUTE)

# expect(PASSES|FAILS ISA SYMBOL): the verdict on kernels of all instruction sets, where that of ISA defines
# one more symbol.
function(expect verdict changed symbol)
  set(list "")
  foreach(isa IN ITEMS baseline avx2 avx512)
    string(LENGTH ${isa} length)
    set(object ${SCRATCH}/kernel_${isa}.dir/kernel.o)
    file(WRITE ${object} "0000 T _ZN7selvage${length}${isa}6searchEv\n")
    if(isa STREQUAL changed)
      file(APPEND ${object} "0000 W ${symbol}\n")
    endif()
    string(APPEND list "${object}\n")
  endforeach()
  file(WRITE ${SCRATCH}/list.txt "${list}")
  expect_verdict(check_kernels "-DNM=${SCRATCH}/nm;-DLIST=${SCRATCH}/list.txt" ${verdict} "${symbol} for ${changed}"
                 ${symbol})
endfunction()

expect(PASSES avx2 _ZN7selvage4avx29TraversalILi3EE6followEv)
expect(PASSES avx2 _ZNSt6vectorIiN7selvage4avx215KernelAllocatorIiEEE9push_backEi)
expect(PASSES avx512 DW.ref.__gxx_personality_v0)
foreach(isa IN ITEMS baseline avx2 avx512)
  expect(FAILS ${isa} _ZNSt6vectorIiSaIiEE17_M_realloc_insertEi)
  expect(FAILS ${isa} _ZN5Eigen8internal11evaluateAnyEv)
  expect(FAILS ${isa} _ZN5boost14multiprecision6numberEv)
  expect(FAILS ${isa} _ZN7selvage5sharedEv)
endforeach()
expect(FAILS avx2 _ZN7selvage6avx5126searchEv)
file(REMOVE_RECURSE ${SCRATCH})
