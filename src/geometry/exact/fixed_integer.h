#pragma once

#include <array>
#include <cmath>
#include <cstdint>

namespace selvage {

/// Signed integer of so many 64-bit words, the lowest first, in two's complement. A product has the words of both
/// factors, and so never overflows; a sum has those of its terms and wraps around: whoever adds knows the bound.
template <int Words>
class FixedInt {
 public:
  FixedInt() = default;
  explicit FixedInt(std::int64_t value) {
    words_.fill(value < 0 ? ~std::uint64_t{0} : 0);
    words_[0] = static_cast<std::uint64_t>(value);
  }
  /// The same number in more words, or its lowest words.
  template <int Other>
  explicit FixedInt(const FixedInt<Other>& other) {
    for (int i = 0; i < Words; ++i) words_[i] = i < Other ? other.word(i) : other.filling();
  }

  std::uint64_t word(int i) const { return words_[i]; }
  /// The value of all words beyond the highest.
  std::uint64_t filling() const { return words_[Words - 1] >> 63 != 0 ? ~std::uint64_t{0} : 0; }

  /// -1, 0 or 1.
  int sign() const {
    std::uint64_t any = 0;
    for (const std::uint64_t word : words_) any |= word;
    return filling() != 0 ? -1 : any != 0;
  }
  bool operator==(const FixedInt& other) const { return words_ == other.words_; }

  FixedInt& operator+=(const FixedInt& other) {
    Twice carry = 0;
    for (int i = 0; i < Words; ++i) {
      carry += Twice{words_[i]} + other.words_[i];
      words_[i] = static_cast<std::uint64_t>(carry);
      carry >>= 64;
    }
    return *this;
  }
  FixedInt& operator-=(const FixedInt& other) { return subtract_shifted<0>(other.words_, ~std::uint64_t{0}); }
  FixedInt operator+(const FixedInt& other) const { return FixedInt(*this) += other; }
  FixedInt operator-(const FixedInt& other) const { return FixedInt(*this) -= other; }

  template <int Other>
  FixedInt<Words + Other> operator*(const FixedInt<Other>& other) const {
    FixedInt<Words + Other> product;
    for (int i = 0; i < Words; ++i) {
      Twice carry = 0;
      for (int j = 0; j < Other; ++j) {
        carry += Twice{words_[i]} * other.words_[j] + product.words_[i + j];
        product.words_[i + j] = static_cast<std::uint64_t>(carry);
        carry >>= 64;
      }
      product.words_[i + Other] = static_cast<std::uint64_t>(carry);
    }
    // As numbers without a sign, negative ones are too large by a power of two.
    product.template subtract_shifted<Words>(other.words_, filling());
    product.template subtract_shifted<Other>(words_, other.filling());
    return product;
  }

  FixedInt& operator<<=(unsigned bits) {
    const int whole = static_cast<int>(bits / 64), rest = static_cast<int>(bits % 64);
    for (int i = Words - 1; i >= 0; --i) {
      const std::uint64_t high = i >= whole ? words_[i - whole] : 0, low = i > whole ? words_[i - whole - 1] : 0;
      words_[i] = rest == 0 ? high : high << rest | low >> (64 - rest);
    }
    return *this;
  }

  /// To some units in the last place.
  explicit operator double() const {
    const FixedInt magnitude = filling() != 0 ? FixedInt() - *this : *this;
    double result = 0;
    for (int i = Words - 1; i >= 0; --i) result = 0x1p64 * result + static_cast<double>(magnitude.words_[i]);
    return filling() != 0 ? -result : result;
  }

 private:
  template <int>
  friend class FixedInt;
  __extension__ using Twice = unsigned __int128;

  /// Subtracts what `mask` leaves of a number that is shifted by so many words.
  template <int Shift, std::size_t Count>
  FixedInt& subtract_shifted(const std::array<std::uint64_t, Count>& other, std::uint64_t mask) {
    std::uint64_t borrow = 0;
    for (int i = Shift; i < Words; ++i) {
      const Twice difference = Twice{words_[i]} - (other[i - Shift] & mask) - borrow;
      words_[i] = static_cast<std::uint64_t>(difference);
      borrow = static_cast<std::uint64_t>(difference >> 64) & 1;
    }
    return *this;
  }

  std::array<std::uint64_t, Words> words_{};
};

}  // namespace selvage
