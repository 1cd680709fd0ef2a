"""The directives of the documentation say what the sources say."""

import pathlib
import sys

import pytest

pytest.importorskip("sphinx")
sys.path.insert(0, str(pathlib.Path(__file__).parents[2] / "docs" / "extensions"))

from selvage_reference import SceneSchema  # noqa: E402

READER = """
constexpr std::array<std::string_view, 2> kKinds{"soft", "stiff"};

Thing read_thing(const JsonValue& value) {
  JsonObject object(value);
  if (const auto v = object.find("kind")) thing.kind = v->choice(kKinds);
  if (const auto v = object.find("size")) thing.size = v->number(kPositive);
  if (const auto v = object.find("share")) thing.share = v->number({0, 0.5});
  thing.count = static_cast<int>(object.get("count").integer(1, 1'000));
  const auto modulus = object.find("modulus"), ratio = object.find("ratio");
  if (modulus) thing.modulus = modulus->number(kNotNegative);
  if (ratio) thing.ratio = ratio->any_number();
  if (const auto v = object.find("motion")) thing.motion = read_motion(*v);
  if (const auto v = find_of_solver(object, "newton", SolverKind::kNewton, scene)) thing.steps = 3;
  for (const char* key : {"note", "title"})
    if (const auto v = object.find(key)) v->text();
  const auto [kind, chosen] = object.get_one_of(kKinds);
"""


def test_the_schema_has_each_member_with_its_values():
    assert SceneSchema.members(READER, READER) == [
        ("kind", "", "one of soft, stiff"),
        ("size", "", "a number above 0"),
        ("share", "", "a number from 0 to 0.5"),
        ("count", "required", "a whole number from 1 to 1,000"),
        ("modulus", "", "a number from 0"),
        ("ratio", "", "a number"),
        ("motion", "", "motion"),
        ("newton", "", "an object"),
        ("note", "", "text"),
        ("title", "", "text"),
        ("soft", "one of soft, stiff", "an object"),
        ("stiff", "one of soft, stiff", "an object"),
    ]
