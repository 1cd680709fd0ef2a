# cmake -DPROGRAM=<example> -DSOURCE=<its source> -P check_output.cmake: the program prints what the comment at the end
# of its source says, line by line.

file(READ ${SOURCE} text)
if(NOT text MATCHES "\n// Prints:\n(.*)$")
  message(FATAL_ERROR "${SOURCE} does not end with a comment '// Prints:' and what the program prints")
endif()
string(REGEX REPLACE "\n// " "\n" expected "\n${CMAKE_MATCH_1}")
execute_process(COMMAND ${PROGRAM} RESULT_VARIABLE status OUTPUT_VARIABLE output ERROR_VARIABLE errors)
if(NOT status EQUAL 0 OR NOT errors STREQUAL "")
  message(FATAL_ERROR "${PROGRAM} ends with ${status}\n${output}${errors}")
endif()
if(NOT "\n${output}" STREQUAL expected)
  message(FATAL_ERROR "${PROGRAM} prints\n${output}instead of${expected}")
endif()
