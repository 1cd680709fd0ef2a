#include "cli/arguments/numbers.h"
#include "cli/arguments/points_file.h"
#include "cli/arguments/pose_argument.h"
#include "cli/program.h"
#include "selvage/core/error.h"

namespace selvage::cli {
namespace {

TEST(Numbers, WholeTextMustBeTheNumber) {
  EXPECT_EQ(read_number<double>("1.5"), 1.5);
  EXPECT_EQ(read_number<double>("-2e-3"), -2e-3);
  EXPECT_EQ(read_number<double>("+7"), 7);
  EXPECT_EQ(read_number<int>("-12"), -12);
  for (const char* text : {"", " 1", "1 ", "1x", "x", "+", "-", "1,5", "--1", "0x10"}) {
    EXPECT_FALSE(read_number<double>(text)) << text;
  }
  EXPECT_FALSE(read_number<double>("1e999"));
  EXPECT_FALSE(read_number<int>("1.0"));
  EXPECT_FALSE(read_number<int>("99999999999"));
  EXPECT_FALSE(read_number<unsigned>("-1"));
}

TEST(Numbers, TrimTakesBlanksFromBothEnds) {
  EXPECT_EQ(trim("  a b\t\r"), "a b");
  EXPECT_EQ(trim(" \t "), "");
  EXPECT_EQ(trim(""), "");
}

TEST(PoseArgument, NameAlone) {
  const PoseArgument pose = parse_pose("twist");
  EXPECT_EQ(pose.name, "twist");
  EXPECT_FALSE(pose.options.axis || pose.options.turns || pose.options.angle || pose.options.crossings ||
               pose.options.core || pose.options.offset);
}

TEST(PoseArgument, EveryOption) {
  const PoseArgument pose = parse_pose("p,axis=y,turns=1.5,angle=-2,crossings=3,core=0.25,dx=1,dz=-3");
  EXPECT_EQ(pose.options.axis, 1);
  EXPECT_EQ(pose.options.turns, 1.5);
  EXPECT_EQ(pose.options.angle, -2);
  EXPECT_EQ(pose.options.crossings, 3);
  EXPECT_EQ(pose.options.core, 0.25);
  ASSERT_TRUE(pose.options.offset);
  EXPECT_EQ(*pose.options.offset, Vec3(1, 0, -3));
}

TEST(PoseArgument, AxesByLetterOrNumber) {
  for (const auto& [text, axis] : {std::pair("x", 0), {"y", 1}, {"z", 2}, {"0", 0}, {"1", 1}, {"2", 2}}) {
    EXPECT_EQ(parse_pose(std::string("bend,axis=") + text).options.axis, axis);
  }
}

TEST(PoseArgument, WhatIsNoOptionIsRefused) {
  for (const char* text : {"bend,", "bend,,turns=1", "bend,turns", "bend,turns=", "bend,turns=1.5.2", "bend,axis=",
                           "bend,axis=xy", "bend,axis=3", "bend,crossings=1.5", "bend,d=1", "bend,dw=1", "bend,=1"}) {
    EXPECT_THROW(parse_pose(text), Error) << text;
  }
}

class PointsFileTest : public ::testing::Test {
 protected:
  std::vector<AskedPoint> read(const std::string& text, Index elements = 10) const {
    testing::write_text(path_, text);
    return read_points(path_, elements);
  }

  test::TemporaryFolder folder_;
  std::filesystem::path path_ = folder_ / "points.csv";
};

TEST_F(PointsFileTest, PlainLines) {
  const auto points = read("1,2,3\n4,5,6,7\n");
  ASSERT_EQ(points.size(), 2u);
  EXPECT_EQ(points[0].point, Vec3(1, 2, 3));
  EXPECT_EQ(points[0].element, kNone);
  EXPECT_EQ(points[0].line, 1);
  EXPECT_EQ(points[1].point, Vec3(4, 5, 6));
  EXPECT_EQ(points[1].element, 7);
  EXPECT_EQ(points[1].line, 2);
}

TEST_F(PointsFileTest, CoordinatesAreTakenBitForBit) {
  const auto points = read("0.1,4.9406564584124654e-324,-1.7976931348623157e308");
  EXPECT_EQ(points[0].point, Vec3(0.1, 4.9406564584124654e-324, -1.7976931348623157e308));
}

TEST_F(PointsFileTest, OneHeaderAndCommentsAnywhere) {
  const auto points = read("# c\n\nx,y,z,element\r\n#x\n1,2,3\r\n\n# end");
  ASSERT_EQ(points.size(), 1u);
  EXPECT_EQ(points[0].line, 5);
  EXPECT_THROW(read("1,2,3\nx,y,z\n"), Error);
}

TEST_F(PointsFileTest, ErrorsNameTheLine) {
  for (const auto& [text, line] : {std::pair("1,2,3\n1,2\n", 2),
                                   {"1,2,3,4,5\n", 1},
                                   {"x,y,z\n\n1,two,3\n", 3},
                                   {"1,2,nan\n", 1},
                                   {"1,2,3,10\n", 1},
                                   {"1,2,3,-1\n", 1},
                                   {"1,,3\n", 1}}) {
    try {
      read(text);
      FAIL() << text;
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find(path_.string() + ":" + std::to_string(line) + ": "), std::string::npos)
          << error.what();
    }
  }
}

TEST_F(PointsFileTest, NoPointsAndNoFile) {
  EXPECT_THROW(read(""), Error);
  EXPECT_THROW(read("x,y,z\n"), Error);
  EXPECT_THROW(read_points(path_.string() + ".none", 1), Error);
}

}  // namespace
}  // namespace selvage::cli
