// Plain data as bytes: how results cross from a child process to its parent.
//
// The format is private to one run of one program: native byte order, no versions. Structs take
// part by a `transfer` function that lists their fields once, for both directions:
//   template <typename Io> void transfer(Io& io, EdgeFacts& f) { io(f.faces, f.length); }
//
// Laws:
//  (1) round trip: reading what was written gives the same bits, NaN payloads included;
//  (2) a reader never reads past its bytes: BytesError when they are too few.
#pragma once

#include <array>
#include <cstdint>
#include <cstring>
#include <optional>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "isochor/bspline/patch_model.h"
#include "isochor/exact/rational.h"

namespace isochor::internal {

// Bytes that end too early.
class BytesError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

class ByteWriter;
class ByteReader;

// How one type is written and read; the general case lists fields through `transfer`.
template <typename T, typename Enable = void>
struct Bytes;

class ByteWriter {
 public:
  template <typename... Fields>
  void operator()(const Fields&... fields) {
    (Bytes<Fields>::write(*this, fields), ...);
  }
  void raw(const void* data, size_t size) { bytes_.append(static_cast<const char*>(data), size); }
  std::string take() { return std::move(bytes_); }

 private:
  std::string bytes_;
};

class ByteReader {
 public:
  explicit ByteReader(std::string bytes) : bytes_(std::move(bytes)) {}
  template <typename... Fields>
  void operator()(Fields&... fields) {
    ((fields = Bytes<Fields>::read(*this)), ...);
  }
  void raw(void* data, size_t size);  // copies out the next bytes
  size_t left() const { return bytes_.size() - at_; }

 private:
  std::string bytes_;
  size_t at_ = 0;
};

template <typename T, typename Enable>
struct Bytes {
  // The one list of fields serves both directions, so writing needs a reference to non-const; the
  // writer only reads through it.
  static void write(ByteWriter& out, const T& value) { transfer(out, const_cast<T&>(value)); }
  static T read(ByteReader& in) {
    T value{};
    transfer(in, value);
    return value;
  }
};

template <typename T>
struct Bytes<T, std::enable_if_t<std::is_arithmetic_v<T> || std::is_enum_v<T>>> {
  static void write(ByteWriter& out, const T& value) { out.raw(&value, sizeof value); }
  static T read(ByteReader& in) {
    T value{};
    in.raw(&value, sizeof value);
    return value;
  }
};

template <typename T>
struct Bytes<std::vector<T>> {
  // Nothing but numbers, without gaps between them.
  static constexpr bool kPlain =
      std::is_same_v<T, double> || std::is_same_v<T, int> || std::is_same_v<T, Vec3>;
  static_assert(sizeof(Vec3) == 3 * sizeof(double));

  static void write(ByteWriter& out, const std::vector<T>& values) {
    out(static_cast<std::uint64_t>(values.size()));
    if constexpr (kPlain) {
      out.raw(values.data(), values.size() * sizeof(T));
    } else {
      for (const auto& value : values) Bytes<T>::write(out, value);
    }
  }
  static std::vector<T> read(ByteReader& in) {
    std::uint64_t size = 0;
    in(size);
    // Every element takes at least one byte: a damaged length must not allocate without bound.
    if (size > in.left()) throw BytesError("the bytes of a result end too early");
    std::vector<T> values;
    if constexpr (kPlain) {
      if (size * sizeof(T) > in.left()) throw BytesError("the bytes of a result end too early");
      values.resize(size);
      in.raw(values.data(), size * sizeof(T));
    } else {
      values.reserve(size);
      for (std::uint64_t k = 0; k < size; ++k) values.push_back(Bytes<T>::read(in));
    }
    return values;
  }
};

template <>
struct Bytes<std::string> {
  static void write(ByteWriter& out, const std::string& text) {
    out(static_cast<std::uint64_t>(text.size()));
    out.raw(text.data(), text.size());
  }
  static std::string read(ByteReader& in) {
    std::uint64_t size = 0;
    in(size);
    if (size > in.left()) throw BytesError("the bytes of a result end too early");
    std::string text(size, '\0');
    in.raw(text.data(), size);
    return text;
  }
};

// Two numbers where they fit, else decimal digits.
template <>
struct Bytes<Rational> {
  static void write(ByteWriter& out, const Rational& value) {
    const std::optional<long> above = value.numerator().to_long();
    const std::optional<long> below = value.denominator().to_long();
    const bool fits = above && below;
    out(fits);
    if (fits) {
      out(*above, *below);
    } else {
      out(value.to_string());
    }
  }
  static Rational read(ByteReader& in) {
    bool fits = false;
    in(fits);
    if (!fits) return Rational::parse(Bytes<std::string>::read(in));
    long above = 0;
    long below = 0;
    in(above, below);
    if (below <= 0) throw BytesError("a denominator is not positive");
    return below == 1 ? Rational(above) : Rational(Integer(above), Integer(below));
  }
};

template <typename T, size_t N>
struct Bytes<std::array<T, N>> {
  static void write(ByteWriter& out, const std::array<T, N>& values) {
    for (const auto& value : values) Bytes<T>::write(out, value);
  }
  static std::array<T, N> read(ByteReader& in) {
    std::array<T, N> values{};
    for (auto& value : values) value = Bytes<T>::read(in);
    return values;
  }
};

template <typename A, typename B>
struct Bytes<std::pair<A, B>> {
  static void write(ByteWriter& out, const std::pair<A, B>& value) {
    out(value.first, value.second);
  }
  static std::pair<A, B> read(ByteReader& in) {
    auto first = Bytes<A>::read(in);
    auto second = Bytes<B>::read(in);
    return {std::move(first), std::move(second)};
  }
};

template <typename T>
struct Bytes<std::optional<T>> {
  static void write(ByteWriter& out, const std::optional<T>& value) {
    out(value.has_value());
    if (value) out(*value);
  }
  static std::optional<T> read(ByteReader& in) {
    if (!Bytes<bool>::read(in)) return std::nullopt;
    return Bytes<T>::read(in);
  }
};

template <>
struct Bytes<Vec3> {
  static void write(ByteWriter& out, const Vec3& p) { out.raw(p.data(), 3 * sizeof(double)); }
  static Vec3 read(ByteReader& in) {
    Vec3 p;
    in.raw(p.data(), 3 * sizeof(double));
    return p;
  }
};

template <>
struct Bytes<KnotVector> {
  static void write(ByteWriter& out, const KnotVector& knots) {
    out(knots.degree(), knots.knots());
  }
  static KnotVector read(ByteReader& in) {
    const int degree = Bytes<int>::read(in);
    return KnotVector(degree, Bytes<std::vector<double>>::read(in));
  }
};

template <>
struct Bytes<Surface> {
  static void write(ByteWriter& out, const Surface& s) {
    out(s.u_knots(), s.v_knots(), s.poles(), s.weights());
  }
  static Surface read(ByteReader& in) {
    auto u_knots = Bytes<KnotVector>::read(in);
    auto v_knots = Bytes<KnotVector>::read(in);
    auto poles = Bytes<std::vector<Vec3>>::read(in);
    auto weights = Bytes<std::vector<double>>::read(in);
    return Surface(std::move(u_knots), std::move(v_knots), std::move(poles), std::move(weights));
  }
};

// One value as bytes, and back.
template <typename T>
std::string to_bytes(const T& value) {
  ByteWriter out;
  out(value);
  return out.take();
}
template <typename T>
T from_bytes(std::string bytes) {
  ByteReader in(std::move(bytes));
  return Bytes<T>::read(in);
}

}  // namespace isochor::internal
