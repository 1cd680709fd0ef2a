#include "picture/composing/palette.h"

#include <algorithm>

namespace selvage {

Rgb body_colour(Index body) {
  // Vermilion is left to what is marked.
  constexpr std::array<std::array<std::uint8_t, 3>, 8> kPalette{{{0x00, 0x72, 0xb2},
                                                                 {0xe6, 0x9f, 0x00},
                                                                 {0x00, 0x9e, 0x73},
                                                                 {0xcc, 0x79, 0xa7},
                                                                 {0x56, 0xb4, 0xe9},
                                                                 {0xf0, 0xe4, 0x42},
                                                                 {0x3c, 0x3c, 0x3c},
                                                                 {0xb8, 0xb8, 0xb8}}};
  const auto number = static_cast<std::size_t>(body);
  std::array<std::uint8_t, 3> colour = kPalette[number % kPalette.size()];
  const std::size_t round = number / kPalette.size() % 3;
  for (std::uint8_t& c : colour) {
    if (round == 1) c = static_cast<std::uint8_t>(c + 0.45 * (255 - c));
    if (round == 2) c = static_cast<std::uint8_t>(0.62 * c);
  }
  return from_srgb(colour[0], colour[1], colour[2]);
}

Rgb cap_colour(Index body) {
  return mix(body_colour(body), Rgb::Ones(), 0.2f);
}

Rgb value_colour(float value) {
  static const std::array<Rgb, 5> stops{from_srgb(0x00, 0x22, 0x4e), from_srgb(0x3b, 0x4d, 0x6e),
                                        from_srgb(0x7c, 0x7b, 0x78), from_srgb(0xbc, 0xae, 0x6c),
                                        from_srgb(0xfe, 0xe8, 0x38)};
  const float place = std::clamp(value, 0.f, 1.f) * (stops.size() - 1);
  const auto low = std::min<std::size_t>(static_cast<std::size_t>(place), stops.size() - 2);
  return mix(stops[low], stops[low + 1], place - static_cast<float>(low));
}

Rgb contact_colour(Index kind) {
  constexpr std::array<std::array<std::uint8_t, 3>, 9> kColours{{{0xc8, 0xc8, 0xc8},
                                                                 {0xd5, 0x5e, 0x00},
                                                                 {0xe0, 0xe0, 0xb0},
                                                                 {0xf0, 0xe4, 0x42},
                                                                 {0xcc, 0x79, 0xa7},
                                                                 {0x00, 0x72, 0xb2},
                                                                 {0x00, 0x9e, 0x73},
                                                                 {0x56, 0xb4, 0xe9},
                                                                 {0x3c, 0x3c, 0x3c}}};
  const auto& [red, green, blue] = kColours[static_cast<std::size_t>(kind)];
  return from_srgb(red, green, blue);
}

Rgb collider_colour() {
  return from_oklab(0.94f, -0.001f, -0.004f);
}

}  // namespace selvage
