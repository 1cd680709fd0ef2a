#pragma once

#include <cstdint>
#include <span>
#include <string_view>

namespace selvage {

/// 64-bit FNV-1a of bytes: tells scenes apart; no defence against forgery.
class Fingerprint {
 public:
  void add(std::string_view bytes) {
    for (const char c : bytes) value_ = (value_ ^ static_cast<unsigned char>(c)) * 0x100000001b3;
  }
  template <typename T>
  void add(std::span<const T> items) {
    add(std::string_view(reinterpret_cast<const char*>(items.data()), items.size_bytes()));
  }
  std::uint64_t value() const { return value_; }

 private:
  std::uint64_t value_ = 0xcbf29ce484222325;
};

}  // namespace selvage
