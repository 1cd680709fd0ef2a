# For the tests of the checks: include(expect_verdict.cmake), then expect_verdict() after laying out a repository.

cmake_policy(VERSION 3.25)

# expect_verdict(CHECK OPTIONS PASSES|FAILS SUBJECT [MESSAGE]): what `cmake OPTIONS -P CHECK.cmake` says of SUBJECT. A
# failure must also say MESSAGE, a regular expression.
function(expect_verdict check options verdict subject)
  execute_process(COMMAND ${CMAKE_COMMAND} ${options} -P ${CMAKE_CURRENT_LIST_DIR}/${check}.cmake
                  RESULT_VARIABLE status OUTPUT_VARIABLE output ERROR_VARIABLE output)
  string(REGEX REPLACE "[ \n]+" " " output "${output}")
  if(verdict STREQUAL PASSES AND NOT status EQUAL 0)
    message(SEND_ERROR "${subject} should pass, but:\n${output}")
  elseif(verdict STREQUAL FAILS AND (status EQUAL 0 OR NOT output MATCHES "${ARGN}"))
    message(SEND_ERROR "${subject} should fail with '${ARGN}', but:\n${output}")
  elseif(NOT verdict MATCHES "^(PASSES|FAILS)$")
    message(SEND_ERROR "${verdict} is no verdict")
  endif()
endfunction()
