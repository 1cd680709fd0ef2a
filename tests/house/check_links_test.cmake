# cmake -DSCRATCH=<folder> -P check_links_test.cmake: check_links.cmake finds what it is there to find.

include(${CMAKE_CURRENT_LIST_DIR}/expect_verdict.cmake)

# expect(PASSES|FAILS TEXT [MESSAGE]): the verdict on a repository with one more page of that text.
function(expect verdict text)
  file(REMOVE_RECURSE ${SCRATCH})
  file(WRITE ${SCRATCH}/README.md "# Name\n\nSee [the page](docs/page.md).\n")
  file(WRITE ${SCRATCH}/docs/page.md "# A page\n\n## What it's for: two `things`\n\n${text}\n")
  file(WRITE ${SCRATCH}/docs/images/drawn.svg "<svg/>\n")
  file(WRITE ${SCRATCH}/src/bvh/a.h "/// See ${mention}.\n")
  expect_verdict(check_links -DROOT=${SCRATCH} ${verdict} "'${text}'" ${ARGN})
endfunction()

set(mention docs/page.md)
expect(PASSES "plain text, [an address](https://example.org/none) and [the start](../README.md)")
expect(PASSES "![drawn](images/drawn.svg) and [here](#what-its-for-two-things)")
expect(PASSES "[there](../README.md#name); [twice](page.md#a-page), [a folder](images)")
expect(PASSES "```cpp\nauto f = [](none.md) {}\n```\nand `[x](none.md)`")
expect(FAILS "[gone](gone.md)" "docs/page.md: gone.md does not exist")
expect(FAILS "![gone](images/gone.svg)" "images/gone.svg does not exist")
expect(FAILS "[here](#elsewhere)" "no heading of that page makes #elsewhere")
expect(FAILS "[there](../README.md#names)" "no heading of that page makes #names")
expect(FAILS "first [good](page.md), then\n[bad](none.md)" "none.md does not exist")

set(mention docs/none.md)
expect(FAILS "text" "src/bvh/a.h: there is no docs/none.md")
file(REMOVE_RECURSE ${SCRATCH})
