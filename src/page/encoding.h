#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace selvage {

/// Integers as bytes that deflate well: of each the difference to the one `stride` places before (0 before the first),
/// as 2|d| or 2|d|-1 for negative ones; all lowest bytes first, then the next ones, up to the fourth.
std::string pack_integers(std::span<const std::int32_t> values, std::size_t stride);

/// The same for 16-bit numbers, whose differences to `before` are taken modulo 2^16.
/// @param before  as many as there are values
std::string pack_differences(std::span<const std::uint16_t> values, std::span<const std::uint16_t> before);

/// Bytes in the zlib format.
std::string deflate_bytes(std::string_view bytes);

/// Bytes as base64 text, padded.
std::string print_base64(std::string_view bytes);

}  // namespace selvage
