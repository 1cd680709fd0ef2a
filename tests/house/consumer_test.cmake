# Installs the built library to an empty prefix. A project that knows nothing but that prefix is built by each compiler
# of COMPILERS, with flags that applications use; all its programs print the same, to the last bit.

function(run)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE status OUTPUT_VARIABLE output ERROR_VARIABLE errors)
  if(NOT status EQUAL 0)
    message(FATAL_ERROR "${ARGN}\n${output}${errors}")
  endif()
  set(output "${output}" PARENT_SCOPE)
endfunction()

file(REMOVE_RECURSE ${SCRATCH})
run(${CMAKE_COMMAND} --install ${BUILD} --prefix ${SCRATCH}/prefix)
run(${CMAKE_COMMAND} -DROOT=${SCRATCH}/prefix -DVERSION=${VERSION}
    -P ${CMAKE_CURRENT_LIST_DIR}/check_public_headers.cmake)

set(number 0)
foreach(compiler IN LISTS COMPILERS)
  math(EXPR number "${number} + 1")
  set(build ${SCRATCH}/build_${number})
  run(${CMAKE_COMMAND} -S ${SOURCE} -B ${build} -G ${GENERATOR} -DCMAKE_PREFIX_PATH=${SCRATCH}/prefix
      -DCMAKE_CXX_COMPILER=${compiler} -DCMAKE_CXX_COMPILER_LAUNCHER=${LAUNCHER} -DCMAKE_BUILD_TYPE=None)
  run(${CMAKE_COMMAND} --build ${build})
  foreach(program IN ITEMS native avx2 fast)
    run(${build}/${program})
    if(NOT DEFINED expected)
      set(expected "${output}")
      message(STATUS "${expected}")
    elseif(NOT output STREQUAL expected)
      message(FATAL_ERROR "${compiler}, ${program}:\n${output}differs from\n${expected}")
    endif()
  endforeach()

  # Fast arithmetic has to be asked for: it ends exactness where numbers are denormal.
  execute_process(COMMAND ${compiler} -std=c++20 -ffast-math -fsyntax-only -I ${SCRATCH}/prefix/include
                          ${SOURCE}/main.cpp RESULT_VARIABLE status ERROR_VARIABLE errors)
  if(status EQUAL 0 OR NOT errors MATCHES "-ffast-math")
    message(FATAL_ERROR "${compiler} takes -ffast-math without a word:\n${errors}")
  endif()
endforeach()
