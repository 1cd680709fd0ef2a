# cmake -DROOT=<repository> -DSCRATCH=<folder> -P check_papers_test.cmake: check_papers.cmake finds what it is there to
# find.

include(${CMAKE_CURRENT_LIST_DIR}/expect_verdict.cmake)

# The page with nothing in its third cells, so that rows can be tried one by one.
file(READ ${ROOT}/docs/papers.md text)
string(REGEX REPLACE "\n\\| ([A-Z][^|\n]*) \\| ([^|\n]+) \\| [^|\n]+ \\|[^\n]*" "\n| \\1 | \\2 | no code | |" text "${text}")

# expect(PASSES|FAILS ROW [MESSAGE]): the verdict on the page with another row for definition 1.
function(expect verdict row)
  file(REMOVE_RECURSE ${SCRATCH})
  file(WRITE ${SCRATCH}/src/bvh/a.h "struct Traversal {};\nvoid traverse(int steps);\n")
  file(WRITE ${SCRATCH}/src/bvh/b.cpp "int main() { return 0; }\n")
  string(REGEX REPLACE "\n\\| Definition 1 [^\n]*" "\n${row}" page "${text}")
  file(WRITE ${SCRATCH}/docs/papers.md "${page}")
  expect_verdict(check_papers -DROOT=${SCRATCH} ${verdict} "'${row}'" ${ARGN})
endfunction()

expect(PASSES "| Definition 1 | what | no code | |")
expect(PASSES "| Definition 1 | what | not yet | why, [there](a.md) |")
expect(PASSES "| Definition 1 | what | `src/bvh/a.h` | |")
expect(PASSES "| Definition 1 | what | `src/bvh/a.h`: `Traversal` | |")
expect(PASSES "| Definition 1 | what | `src/bvh/a.h`: `Traversal`, `traverse`; `src/bvh/b.cpp`: `main` | `src/bvh` |")
expect(FAILS "| Definition 1 | what | `src/bvh/c.h`: `Traversal` | |" "there is no file src/bvh/c.h")
expect(FAILS "| Definition 1 | what | `src/bvh` | |" "there is no file src/bvh")
expect(FAILS "| Definition 1 | what | `src/bvh/a.h`: `travers` | |" "src/bvh/a.h holds no travers")
expect(FAILS "| Definition 1 | what | `src/bvh/a.h`: `Traversal`; `src/bvh/b.cpp`: `Traversal` | |" "src/bvh/b.cpp holds no Traversal")
expect(FAILS "| Definition 1 | what | `src/bvh/a.h`: Traversal | |" "is no reference of the form")
expect(FAILS "| Definition 1 | what | somewhere | |" "is no reference of the form")
expect(FAILS "| Definition 1 | what | no code |" "a row has four cells")
expect(FAILS "| Definition 1 | what | no code | see `src/attic/a.h` |" "there is no src/attic/a.h")
expect(FAILS "| Definition 5 | what | no code | |" "\"Definition 5\" is no item of this table")
expect(FAILS "| Definition 2 | what | no code | |" "\"Definition 2\" is no item of this table, or has a row already")
expect(FAILS "" "Definition 1 has no row")
file(REMOVE_RECURSE ${SCRATCH})
