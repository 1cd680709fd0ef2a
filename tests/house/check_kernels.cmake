# cmake -DNM=<nm> -DLIST=<file of object paths> -P check_kernels.cmake: a kernel compiled for AVX2 or AVX-512 defines
# nothing outside its own namespace. An inline function that it shared with other files could be the copy that the
# linker keeps for all of them, and would be an illegal instruction on an older processor.

file(STRINGS ${LIST} objects)
list(FILTER objects INCLUDE REGEX "_(avx2|avx512)\\.dir/")
list(LENGTH objects count)
if(count EQUAL 0)
  message(FATAL_ERROR "no kernel object in ${LIST}")
endif()
set(violations "")
foreach(object IN LISTS objects)
  execute_process(COMMAND ${NM} --defined-only --extern-only ${object} OUTPUT_VARIABLE symbols COMMAND_ERROR_IS_FATAL ANY)
  string(REGEX MATCHALL "[^\n]+" symbols "${symbols}")
  # Mangled names carry the namespace as 4avx2 or 6avx512; DW.ref is data.
  list(FILTER symbols EXCLUDE REGEX "4avx2|6avx512|DW\\.ref\\.")
  foreach(symbol IN LISTS symbols)
    list(APPEND violations "${object}: ${symbol}")
  endforeach()
endforeach()
if(violations)
  list(JOIN violations "\n  " text)
  message(FATAL_ERROR "\n  ${text}\nkeep it inside namespace SELVAGE_ISA, or make it inline away")
endif()
message(STATUS "${count} kernel objects keep to themselves")
