// The cursor that all readers share: tokens, numbers, counts, and where an error is said to be.
#include "io/format_cursor.h"

#include "io/format_samples.h"

namespace selvage::format {
namespace {

template <typename Action>
std::string error_when(Action action) {
  try {
    action();
  } catch (const Error& error) {
    return error.what();
  }
  return {};
}

Cursor cursor_of(std::string_view text, char comment = '\0') {
  return Cursor({text, "f"}, comment);
}

TEST(Cursor, TokensAcrossLinesAndComments) {
  Cursor cursor = cursor_of("one\ttwo # not this\n\r\n three#nor this\n", '#');
  EXPECT_EQ(cursor.token(), "one");
  EXPECT_EQ(cursor.peek(), "two");
  EXPECT_EQ(cursor.token(), "two");
  EXPECT_EQ(cursor.token(), "three");
  EXPECT_EQ(cursor.token(), "");
  EXPECT_EQ(cursor.remaining(), 0u);
}

TEST(Cursor, WithoutCommentCharacterNothingIsAComment) {
  Cursor cursor = cursor_of("a #b");
  EXPECT_EQ(cursor.token(), "a");
  EXPECT_EQ(cursor.token(), "#b");
}

TEST(Cursor, BoundToLinesTokensEndWithTheLine) {
  Cursor cursor = cursor_of("a b # c\n\n  \n# d\n e", '#');
  cursor.bind_to_lines(true);
  EXPECT_EQ(cursor.token(), "a");
  EXPECT_EQ(cursor.token(), "b");
  EXPECT_EQ(cursor.token(), "");
  EXPECT_TRUE(cursor.next_filled_line());
  EXPECT_EQ(cursor.token(), "e");
  EXPECT_FALSE(cursor.next_filled_line());
}

TEST(Cursor, JoinsLinesAtABackslashOnRequest) {
  Cursor cursor = cursor_of("a \\\n b \\\r\n c \\ d\n");
  cursor.bind_to_lines(true);
  cursor.join_lines_at_backslash();
  for (const char* expected : {"a", "b", "c", "\\", "d", ""}) EXPECT_EQ(cursor.token(), expected);
}

TEST(Cursor, LinesWithoutTheirEnds) {
  Cursor cursor = cursor_of("first line \r\n\nlast");
  EXPECT_EQ(cursor.line(), "first line");
  EXPECT_EQ(cursor.line(), "");
  EXPECT_EQ(cursor.line(), "last");
  EXPECT_EQ(cursor.line(), "");
}

TEST(Cursor, WholeNumbers) {
  Cursor cursor = cursor_of("0 -7 +12 9223372036854775807 -9223372036854775808");
  EXPECT_EQ(cursor.integer("n"), 0);
  EXPECT_EQ(cursor.integer("n"), -7);
  EXPECT_EQ(cursor.integer("n"), 12);
  EXPECT_EQ(cursor.integer("n"), std::numeric_limits<std::int64_t>::max());
  EXPECT_EQ(cursor.integer("n"), std::numeric_limits<std::int64_t>::min());
  for (const char* bad : {"1.5", "x", "1x", "--1", "+", "", "9223372036854775808", "1e3", "0x10"}) {
    EXPECT_NE(error_when([&] { cursor_of(bad).integer("a number"); }), "") << bad;
  }
}

TEST(Cursor, RealNumbers) {
  const std::pair<const char*, double> cases[] = {{"0", 0.0},
                                                  {"+1.5", 1.5},
                                                  {"-2e3", -2000.0},
                                                  {".5", 0.5},
                                                  {"5.", 5.0},
                                                  {"1E-2", 0.01},
                                                  {"4.9406564584124654e-324", 4.9406564584124654e-324},
                                                  {"1e-400", 0.0},
                                                  {"0.1000000000000000055511151231257827021181583404541015625", 0.1}};
  for (const auto& [text, value] : cases) EXPECT_EQ(cursor_of(text).real("x"), value) << text;
  EXPECT_EQ(cursor_of("1e400").real("x"), std::numeric_limits<double>::infinity());
  EXPECT_EQ(cursor_of("-1e400").real("x"), -std::numeric_limits<double>::infinity());
  EXPECT_TRUE(std::isnan(cursor_of("nan").real("x")));
  for (const char* bad : {"", "-", "e5", "1,5", "1e", "1.5f", "0x1p3", "one"}) {
    EXPECT_NE(error_when([&] { cursor_of(bad).real("a number"); }), "") << bad;
  }
}

TEST(Cursor, CoordinatesMustBeFinite) {
  EXPECT_EQ(cursor_of("1 2 3").point(), Vec3(1, 2, 3));
  for (const char* bad : {"1 2 nan", "inf 2 3", "1 -inf 3", "1 1e400 3"}) {
    EXPECT_NE(error_when([&] { cursor_of(bad).point(); }).find("not finite"), std::string::npos) << bad;
  }
  for (const std::endian order : {std::endian::little, std::endian::big}) {
    const std::string bytes = packed<double>({1, 2, 3}, order) + packed<double>({1, NAN, 3}, order);
    Cursor cursor = cursor_of(bytes);
    cursor.enter_binary(order);
    EXPECT_EQ(cursor.binary_point<double>(), Vec3(1, 2, 3));
    EXPECT_TRUE(
        error_when([&] { cursor.binary_point<double>(); }).starts_with("f: byte 24: a coordinate is not finite"));
  }
}

TEST(Cursor, ErrorsNameTheLineOfWhatWasReadLast) {
  Cursor cursor = cursor_of("a\nb\n\n c d\n");
  EXPECT_EQ(error_when([&] { cursor.fail("wrong"); }), "f:1: wrong");
  cursor.token();
  cursor.token();
  EXPECT_EQ(error_when([&] { cursor.fail("wrong", "mend it"); }), "f:2: wrong; mend it");
  cursor.token();
  EXPECT_EQ(error_when([&] { cursor.integer("a number"); }),
            "f:4: expected a number, found 'd'; mend the file or export it again");
  cursor.token();
  EXPECT_EQ(error_when([&] { cursor.integer("a number"); }),
            "f:5: expected a number, found the end of the file; the file is cut short; export it again");
  cursor.move_to(0);
  EXPECT_TRUE(error_when([&] { cursor.fail("wrong"); }).starts_with("f:1:"));
}

TEST(Cursor, FoundTextIsShortAndPrintable) {
  EXPECT_EQ(quote("abc"), "'abc'");
  EXPECT_EQ(quote("a\x01z\xff"), "'a?z?'");
  EXPECT_EQ(quote(std::string(100, 'x')), "'" + std::string(24, 'x') + "...'");
}

TEST(Cursor, CountsThatTheFileCannotHold) {
  EXPECT_EQ(cursor_of("2 1 1").count("things", 2), 2);
  EXPECT_NE(
      error_when([] { cursor_of("4 1 1").count("things", 2); }).find("4 things are announced, but only 4 bytes follow"),
      std::string::npos);
  EXPECT_NE(error_when([] { cursor_of("-1 1").count("things", 2); }).find("the number of things is negative: -1"),
            std::string::npos);
  EXPECT_NE(error_when([] { cursor_of("3000000000").count("things", 0); }).find("3000000000 things are too many"),
            std::string::npos);
  Cursor binary = cursor_of("12345678");
  binary.enter_binary(std::endian::little);
  EXPECT_EQ(error_when([&] { binary.check_count(2, "things", 4); }), "");
  EXPECT_NE(error_when([&] { binary.check_count(3, "things", 4); }), "");
}

TEST(Cursor, BinaryNumbersOfBothByteOrders) {
  for (const std::endian order : {std::endian::little, std::endian::big}) {
    const std::string bytes =
        packed<std::int16_t>({-2}, order) + packed<std::uint32_t>({0x01020304}, order) + packed<float>({1.5f}, order);
    Cursor cursor = cursor_of(bytes);
    cursor.enter_binary(order);
    EXPECT_EQ(cursor.binary<std::int16_t>("n"), -2);
    EXPECT_EQ(cursor.binary<std::uint32_t>("n"), 0x01020304u);
    EXPECT_EQ(cursor.binary<float>("n"), 1.5f);
    EXPECT_EQ(
        error_when([&] { cursor.binary<double>("a double"); }),
        "f: byte 10: expected a double (8 bytes), but only 0 bytes follow; the file is cut short; export it again");
  }
  EXPECT_EQ(swap_bytes<std::uint16_t>(0x0102), 0x0201);
}

TEST(Cursor, MovesNoFurtherThanTheEnd) {
  Cursor cursor = cursor_of("abc");
  cursor.move_to(100);
  EXPECT_EQ(cursor.position(), 3u);
  EXPECT_EQ(cursor.token(), "");
  cursor.next_line();
  EXPECT_EQ(cursor.remaining(), 0u);
}

}  // namespace
}  // namespace selvage::format
