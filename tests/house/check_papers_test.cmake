# cmake -DROOT=<repository> -DSCRATCH=<folder> -P check_papers_test.cmake: check_papers.cmake finds what it is there to
# find.

# The page with nothing in its third cells, so that rows can be tried one by one.
file(READ ${ROOT}/docs/papers.md text)
string(REGEX REPLACE "\n\\| ([A-Z][^|\n]*) \\| ([^|\n]+) \\| [^|\n]+ \\|[^\n]*" "\n| \\1 | \\2 | no code | |" text "${text}")

# expect(PASSES|FAILS ROW [MESSAGE]): the verdict on the page with another row for definition 1.
function(expect verdict row)
  file(REMOVE_RECURSE ${SCRATCH})
  file(WRITE ${SCRATCH}/src/bvh/a.h "struct Walk {};\nvoid walk_along(int steps);\n")
  file(WRITE ${SCRATCH}/src/bvh/b.cpp "int main() { return 0; }\n")
  string(REGEX REPLACE "\n\\| Definition 1 [^\n]*" "\n${row}" page "${text}")
  file(WRITE ${SCRATCH}/docs/papers.md "${page}")
  execute_process(COMMAND ${CMAKE_COMMAND} -DROOT=${SCRATCH} -P ${CMAKE_CURRENT_LIST_DIR}/check_papers.cmake
                  RESULT_VARIABLE status OUTPUT_VARIABLE output ERROR_VARIABLE output)
  string(REGEX REPLACE "[ \n]+" " " output "${output}")
  if(verdict STREQUAL PASSES AND NOT status EQUAL 0)
    message(SEND_ERROR "'${row}' should pass, but:\n${output}")
  elseif(verdict STREQUAL FAILS AND (status EQUAL 0 OR NOT output MATCHES "${ARGN}"))
    message(SEND_ERROR "'${row}' should fail with '${ARGN}', but:\n${output}")
  endif()
endfunction()

expect(PASSES "| Definition 1 | what | no code | |")
expect(PASSES "| Definition 1 | what | not yet | why, [there](a.md) |")
expect(PASSES "| Definition 1 | what | `src/bvh/a.h` | |")
expect(PASSES "| Definition 1 | what | `src/bvh/a.h`: `Walk` | |")
expect(PASSES "| Definition 1 | what | `src/bvh/a.h`: `Walk`, `walk_along`; `src/bvh/b.cpp`: `main` | `src/bvh` |")
expect(FAILS "| Definition 1 | what | `src/bvh/c.h`: `Walk` | |" "there is no file src/bvh/c.h")
expect(FAILS "| Definition 1 | what | `src/bvh` | |" "there is no file src/bvh")
expect(FAILS "| Definition 1 | what | `src/bvh/a.h`: `walk` | |" "src/bvh/a.h holds no walk")
expect(FAILS "| Definition 1 | what | `src/bvh/a.h`: `Walk`; `src/bvh/b.cpp`: `Walk` | |" "src/bvh/b.cpp holds no Walk")
expect(FAILS "| Definition 1 | what | `src/bvh/a.h`: Walk | |" "is no reference of the form")
expect(FAILS "| Definition 1 | what | somewhere | |" "is no reference of the form")
expect(FAILS "| Definition 1 | what | no code |" "a row has four cells")
expect(FAILS "| Definition 1 | what | no code | see `src/attic/a.h` |" "there is no src/attic/a.h")
expect(FAILS "| Definition 5 | what | no code | |" "\"Definition 5\" is no item of this table")
expect(FAILS "| Definition 2 | what | no code | |" "\"Definition 2\" is no item of this table, or has a row already")
expect(FAILS "" "Definition 1 has no row")
file(REMOVE_RECURSE ${SCRATCH})
