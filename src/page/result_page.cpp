#include "page/result_page.h"

#include "core/json.h"
#include "page/mesh_page.h"
#include "scene/reading/stored_result.h"

namespace selvage {

namespace {

namespace fs = std::filesystem;
void add_numbers(Page& page, const std::string& group, const Json& numbers) {
  if (!numbers.is_object()) return;
  for (const auto& [name, value] : numbers.items())
    if (value.is_number()) page.add_fact(group, name, value.dump());
}

}  // namespace

std::string print_result_page(const fs::path& path, const fs::path& after) {
  const StoredResult result(path, after);
  const std::string& kind = result.kind();
  Page page(kind, fs::path(result.text("mesh")).filename().string());
  for (const char* group : {"statistics", "seconds", "displacement", "before", "after", "defects"})
    if (result.has(group)) add_numbers(page, group, result.json()[group]);
  for (const char* fact : {"method", "to", "outcome"})
    if (result.has(fact) && result.json()[fact].is_string()) page.add_fact("result", fact, result.text(fact));
  for (const char* fact : {"free_step", "queries", "found", "no_path", "deepest"})
    if (result.has(fact)) page.add_fact("result", fact, result.json()[fact].dump());
  add_mesh(page, result.mesh, result.end_pose ? &*result.end_pose : nullptr, result.find_marks());
  return page.print();
}

}  // namespace selvage
