#include "cli/program.h"

#include <nlohmann/json.hpp>

namespace selvage::testing {
namespace {

using View = ProgramTest;

const char* const kScene = R"({"selvage_scene": 1, "frames": 3, "substeps": 2,
  "bodies": [{"mesh": {"shape": "box", "size": [1, 1, 1], "cell": 0.5}, "translate": [0, 0, 0.05]}],
  "colliders": [{"plane": {"point": [0, 0, 0], "normal": [0, 0, 1]}}]})";

bool is_page(const fs::path& path, const std::string& kind) {
  const std::string text = read_text(path);
  return text.find("<!doctype html>") == 0 && text.find("\"kind\":\"" + kind + "\"") != std::string::npos &&
         text.find("<!--data-->") == std::string::npos;
}

TEST_F(View, WritesPagesOfRunsMeshesAndResults) {
  write_text(file("blocks.json"), kScene);
  run_well("simulate blocks.json -o run -q");
  EXPECT_TRUE(is_page(file("run/report.html"), "run"));
  EXPECT_NE(read_text(file("run/report.html")).find("\"processor\""), std::string::npos);
  EXPECT_NE(run_well("view run -o run.html").out.find("run.html: "), std::string::npos);
  EXPECT_TRUE(is_page(file("run.html"), "run"));
  run_well("make rod --length 8 --radius 0.2 --pose self-crossing -o rod.vtu -q");
  EXPECT_EQ(run("check rod.vtu --json pairs.json -q").status, 1);
  run_well("resolve rod.vtu -o free.vtu --json report.json -q");
  EXPECT_EQ(nlohmann::json::parse(read_text(file("report.json")))["output"], "free.vtu");
  const auto said = nlohmann::json::parse(run_well("view rod.vtu -o rod.html --json -").out);
  EXPECT_EQ(said["bytes"], fs::file_size(file("rod.html")));
  run_well("view pairs.json -o pairs.html -q");
  run_well("view report.json -o report.html -q");
  EXPECT_TRUE(is_page(file("rod.html"), "mesh"));
  EXPECT_TRUE(is_page(file("pairs.html"), "discrete"));
  EXPECT_TRUE(is_page(file("report.html"), "resolve"));
}

TEST_F(View, RefusesWithOneLine) {
  write_text(file("blocks.json"), kScene);
  run_well("simulate blocks.json -o run -q --no-report");
  EXPECT_FALSE(fs::exists(file("run/report.html")));
  expect_refused("view none -o a.html", 2, {"none"});
  expect_refused("view blocks.json -o a.html", 2, {"blocks.json", "no result of selvage"});
  expect_refused("view run -o run/topology.bin", 2, {"run/topology.bin"});
  expect_refused("view run -o nowhere/a.html", 2, {"nowhere"});
  expect_refused("view run -o a.html --after b.vtu", 2, {"--after", "no meaning"});
  run_well("make ball -o ball.vtu -q");
  expect_refused("view ball.vtu -o a.html --every 2", 2, {"--every", "frames of a run"});
  expect_refused("view ball.vtu -o a.html --no-marks", 2, {"--no-marks"});
  fs::create_directory(file("empty"));
  expect_refused("view empty -o a.html", 2, {"empty: holds no run", "simulate -o"});
  EXPECT_FALSE(fs::exists(file("a.html")));
}

TEST_F(View, ExportsRuns) {
  write_text(file("blocks.json"), kScene);
  run_well("simulate blocks.json -o run -q --no-report");
  EXPECT_NE(run_well("export run -o a.usda").out.find("a.usda: "), std::string::npos);
  run_well("export run -o a.pc2 -q --every 2");
  run_well("export run -o a.glb -q");
  for (const char* name : {"a.usda", "a.pc2", "a.obj", "a.glb"}) EXPECT_TRUE(fs::exists(file(name))) << name;
  expect_refused("export run -o a.abc", 2, {"a.abc", ".pc2, .glb or .usda"});
  expect_refused("export blocks.json -o b.glb", 2, {"holds no run"});
  expect_refused("export run -o -", 2, {"name a file"});
  EXPECT_FALSE(fs::exists(file("b.glb")));
}

}  // namespace
}  // namespace selvage::testing
