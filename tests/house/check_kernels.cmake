# cmake -DNM=<nm> -DLIST=<file of object paths> -P check_kernels.cmake: a kernel compiled for an instruction set defines
# nothing outside its own namespace, nothing of std, Eigen or boost above all. An inline function that it shared with
# other files could be the copy that the linker keeps for all of them, and would be an illegal instruction on an older
# processor.

file(STRINGS ${LIST} objects)
list(LENGTH objects count)
set(violations "")
foreach(isa IN ITEMS baseline avx2 avx512)
  set(kernels ${objects})
  list(FILTER kernels INCLUDE REGEX "_${isa}\\.dir/")
  if(NOT kernels)
    list(APPEND violations "no kernel object for ${isa} in ${LIST}")
  endif()
endforeach()
foreach(object IN LISTS objects)
  string(REGEX MATCH "_(baseline|avx2|avx512)\\.dir/" isa "${object}")
  set(isa "${CMAKE_MATCH_1}")
  string(LENGTH "${isa}" length)
  execute_process(COMMAND ${NM} --defined-only --extern-only ${object} OUTPUT_VARIABLE symbols COMMAND_ERROR_IS_FATAL ANY)
  string(REGEX MATCHALL "[^\n]+" symbols "${symbols}")
  # Mangled names carry the namespace with its length, as 4avx2; a template of std made for a type of the namespace
  # alone carries it too. DW.ref is data.
  list(FILTER symbols EXCLUDE REGEX "${length}${isa}|DW\\.ref\\.")
  foreach(symbol IN LISTS symbols)
    list(APPEND violations "${object}: ${symbol}")
  endforeach()
endforeach()
if(violations)
  list(JOIN violations "\n  " text)
  message(FATAL_ERROR "\n  ${text}\nkeep it inside namespace SELVAGE_ISA, or make it inline away")
endif()
message(STATUS "${count} kernel objects keep to themselves")
