#include "picture/drawing/ink.h"

#include <array>

namespace selvage {

namespace {

using Polyline = std::vector<Eigen::Vector2f>;

/// A glyph on a grid: a small letter is 4 high, an ascender 6, a descender goes down to -2. Each word is a stroke:
/// first its kind ('-' a polyline as it stands, '(' with its inner corners rounded, 'o' closed with all corners
/// rounded), then its points as pairs of x and y, where y is 'z' for -1 and 'y' for -2.
struct Glyph {
  char letter;
  float width;
  const char* strokes;
};

constexpr std::array kGlyphs{
    Glyph{'a', 4, "o00044440 -4440"},
    Glyph{'b', 4, "o00044440 -0600"},
    Glyph{'c', 4, "(434404004041"},
    Glyph{'d', 4, "o00044440 -4640"},
    Glyph{'e', 4, "-0242 (424404004041"},
    Glyph{'f', 3, "(36161410 -0434"},
    Glyph{'g', 4, "o00044440 (44404y0y0z"},
    Glyph{'h', 4, "-0600 (0204444240"},
    Glyph{'i', 0, "-0400 -0606"},
    Glyph{'j', 2, "(24202y0y -2626"},
    Glyph{'k', 3.5f, "-0600 -0144 -1240"},
    Glyph{'l', 0, "-0600"},
    Glyph{'m', 6, "-0400 (0204343230 (3234646260"},
    Glyph{'n', 4, "-0400 (0204444240"},
    Glyph{'o', 4, "o00044440"},
    Glyph{'p', 4, "o00044440 -040y"},
    Glyph{'q', 4, "o00044440 -444y"},
    Glyph{'r', 2.5f, "-0400 (020434"},
    Glyph{'s', 3, "(3334040232300001"},
    Glyph{'t', 3, "(16121030 -0434"},
    Glyph{'u', 4, "(0402004042 -4440"},
    Glyph{'v', 4, "-042044"},
    Glyph{'w', 6, "-0410346064"},
    Glyph{'x', 4, "-0440 -0044"},
    Glyph{'y', 4, "-0420 -441y"},
    Glyph{'z', 3.5f, "-04440040"},
    Glyph{'0', 4, "o00064640"},
    Glyph{'1', 2, "-052620"},
    Glyph{'2', 4, "(0506464300 -0040"},
    Glyph{'3', 4, "(0506464313 (1343400001"},
    Glyph{'4', 4, "-360242 -3630"},
    Glyph{'5', 4, "-460603 (030444400001"},
    Glyph{'6', 4, "o00044440 (460602"},
    Glyph{'7', 4, "-064610"},
    Glyph{'8', 4, "o03064643 o00034340"},
    Glyph{'9', 4, "o02064642 (004044"},
    Glyph{'.', 0, "-0000"},
    Glyph{',', 1, "-100z"},
    Glyph{':', 0, "-0000 -0303"},
    Glyph{'-', 3, "-0232"},
    Glyph{'+', 4, "-0242 -2024"},
    Glyph{'=', 4, "-0141 -0343"},
    Glyph{'/', 3, "-0z36"},
    Glyph{'[', 1.5f, "-16060z1z"},
    Glyph{']', 1.5f, "-06161z0z"},
    Glyph{'(', 1.5f, "(1605001z"},
    Glyph{')', 1.5f, "(0615100z"},
    Glyph{' ', 1.5f, ""},
};

constexpr float kSpacing = 1.9f;
constexpr float kGridHeight = 4;  // of a small letter

const Glyph* find_glyph(char letter) {
  const char small = letter >= 'A' && letter <= 'Z' ? static_cast<char>(letter - 'A' + 'a') : letter;
  for (const Glyph& glyph : kGlyphs) {
    if (glyph.letter == small) return &glyph;
  }
  return nullptr;
}

float grid_y(char c) {
  return c == 'z' ? -1.f : c == 'y' ? -2.f : static_cast<float>(c - '0');
}

/// One round of Chaikin's corner cutting; an open line keeps its ends.
Polyline cut_corners(const Polyline& line, bool closed) {
  Polyline result;
  const std::size_t n = line.size(), last = closed ? n : n - 1;
  if (!closed) result.push_back(line.front());
  for (std::size_t i = 0; i < last; ++i) {
    const Eigen::Vector2f &a = line[i], &b = line[(i + 1) % n];
    if (closed || i > 0) result.push_back(0.75f * a + 0.25f * b);
    if (closed || i + 2 < n) result.push_back(0.25f * a + 0.75f * b);
  }
  if (!closed) result.push_back(line.back());
  return result;
}

Polyline read_stroke(std::string_view word) {
  Polyline line;
  for (std::size_t i = 1; i + 1 < word.size(); i += 2) line.emplace_back(word[i] - '0', grid_y(word[i + 1]));
  if (word[0] == '-') return line;
  const bool closed = word[0] == 'o';
  for (int round = 0; round < 3; ++round) line = cut_corners(line, closed);
  if (closed) line.push_back(line.front());
  return line;
}

template <typename Visit>
void for_each_word(std::string_view words, const Visit& visit) {
  while (!words.empty()) {
    const std::size_t end = std::min(words.find(' '), words.size());
    visit(words.substr(0, end));
    words.remove_prefix(std::min(end + 1, words.size()));
  }
}

}  // namespace

std::vector<Stroke> write_text(std::string_view text, const Eigen::Vector2f& start, float height, float radius) {
  const float scale = height / kGridHeight;
  float x = start[0];
  std::vector<Stroke> strokes;
  for (const char letter : text) {
    const Glyph* glyph = find_glyph(letter);
    if (glyph == nullptr) glyph = find_glyph(' ');
    for_each_word(glyph->strokes, [&](std::string_view word) {
      const Polyline line = read_stroke(word);
      const auto place = [&](const Eigen::Vector2f& p) {
        return Eigen::Vector2f(x + scale * p[0], start[1] - scale * p[1]);
      };
      for (std::size_t i = 0; i + 1 < line.size(); ++i) {
        strokes.push_back({place(line[i]), place(line[i + 1]), radius});
      }
    });
    x += scale * (glyph->width + kSpacing);
  }
  return strokes;
}

float text_width(std::string_view text, float height) {
  float width = 0;
  for (const char letter : text) {
    const Glyph* glyph = find_glyph(letter);
    width += (glyph ? glyph->width : 1.5f) + kSpacing;
  }
  return text.empty() ? 0 : (width - kSpacing) * height / kGridHeight;
}

}  // namespace selvage
