// Base64 and the blocks of VTK XML arrays, plain and compressed, whole and damaged.
#include "io/format_bytes.h"

#include "io/format_encoders.h"

namespace selvage::format {
namespace {

std::string decode(std::string_view text, std::size_t size) {
  ByteStream stream(text, true);
  std::string bytes;
  return stream.read(size, bytes) ? bytes : "refused";
}

TEST(ByteStream, KnownBase64) {
  EXPECT_EQ(decode("", 0), "");
  EXPECT_EQ(decode("Zg==", 1), "f");
  EXPECT_EQ(decode("Zm8=", 2), "fo");
  EXPECT_EQ(decode("Zm9v", 3), "foo");
  EXPECT_EQ(decode("Zm9vYg==", 4), "foob");
  EXPECT_EQ(decode("Zm9vYmE=", 5), "fooba");
  EXPECT_EQ(decode("Zm9vYmFy", 6), "foobar");
  EXPECT_EQ(decode("+/+/", 3), "\xfb\xff\xbf");
}

TEST(ByteStream, WhiteSpaceAndSeveralPaddedRuns) {
  EXPECT_EQ(decode(" \n Zm9v\r\nYmFy ", 6), "foobar");
  EXPECT_EQ(decode("Zg==Zm8=Zm9v", 6), "ffofoo");
}

TEST(ByteStream, RefusesWhatIsNoBase64OrCutShort) {
  for (const char* bad : {"Z", "Zg", "Zg=", "====", "Z===", "Zm9*", "Zm9v!"})
    EXPECT_EQ(decode(bad, 4), "refused") << bad;
  EXPECT_EQ(decode("Zm9v", 4), "refused");
  EXPECT_EQ(decode("Zm9v", std::size_t{1} << 60), "refused");
}

TEST(ByteStream, ReadsInPiecesOfAnySize) {
  std::mt19937 random(3);
  std::string bytes;
  for (int i = 0; i < 1000; ++i) bytes.push_back(static_cast<char>(random()));
  const std::string text = encode_base64(bytes);
  for (const bool base64 : {false, true}) {
    ByteStream stream(base64 ? text : bytes, base64);
    std::string found;
    while (found.size() < bytes.size()) {
      ASSERT_TRUE(stream.read(std::min<std::size_t>(random() % 8, bytes.size() - found.size()), found));
      ASSERT_GE(found.size() + stream.remaining(), bytes.size());
    }
    EXPECT_EQ(found, bytes);
    EXPECT_FALSE(stream.read(1, found));
  }
}

TEST(Blocks, EveryLayoutGivesTheBytesBack) {
  std::string bytes;
  for (int i = 0; i < 500; ++i) bytes += std::to_string(i * i % 97);
  for (const std::size_t header : {4u, 8u}) {
    for (const std::endian order : {std::endian::little, std::endian::big}) {
      const bool swap = order != std::endian::native;
      for (const bool base64 : {false, true}) {
        const auto expect_bytes = [&](const std::string& stored, bool compressed) {
          ByteStream stream(stored, base64);
          std::string found, problem;
          EXPECT_TRUE(read_blocks(stream, {header, swap, compressed}, found, problem)) << problem;
          EXPECT_EQ(found, bytes);
        };
        expect_bytes(encode_plain(bytes, {header, order, base64}), false);
        for (const std::size_t block :
             {std::size_t{1}, std::size_t{100}, bytes.size() / 2, bytes.size(), bytes.size() + 1}) {
          expect_bytes(encode_compressed(bytes, {header, order, base64}, block), true);
        }
      }
    }
  }
}

TEST(Blocks, EmptyArrays) {
  for (const bool compressed : {false, true}) {
    const std::string zero(8, '\0');
    ByteStream stream(zero, false);
    std::string found, problem;
    EXPECT_TRUE(read_blocks(stream, {8, false, compressed}, found, problem));
    EXPECT_TRUE(found.empty());
  }
}

TEST(Blocks, CutOrDamagedBytesAreRefusedOrReadAsTheyWere) {
  std::string bytes;
  for (int i = 0; i < 200; ++i) bytes.push_back(static_cast<char>(i * i % 251));
  const std::string whole = encode_compressed(bytes, {4, std::endian::little, false}, 64);
  const BlockLayout layout{4, std::endian::native != std::endian::little, true};
  for (std::size_t size = 0; size < whole.size(); ++size) {
    ByteStream stream(std::string_view(whole).substr(0, size), false);
    std::string found, problem;
    EXPECT_FALSE(read_blocks(stream, layout, found, problem)) << size;
    EXPECT_FALSE(problem.empty());
  }
  int refused = 0;
  for (const int mask : {0x01, 0x04, 0x55, 0x80, 0xff}) {
    for (std::size_t at = 0; at < whole.size(); ++at) {
      std::string damaged = whole;
      damaged[at] = static_cast<char>(damaged[at] ^ mask);
      ByteStream stream(damaged, false);
      std::string found, problem;
      const bool taken = read_blocks(stream, layout, found, problem);
      // A header of no blocks is an array of no values: it is for the reader of the array to see that some are missing.
      const bool no_blocks = at == 0 && (4 ^ mask) == 0;
      EXPECT_TRUE(!taken || found == (no_blocks ? "" : bytes)) << at << ", mask " << mask;
      EXPECT_LE(found.capacity(), std::size_t{1} << 20) << at;
      refused += !taken;
    }
  }
  EXPECT_GT(refused, 4 * static_cast<int>(whole.size()));
}

}  // namespace
}  // namespace selvage::format
