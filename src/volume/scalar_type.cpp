#include "volume/scalar_type.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>

namespace clipgs {
namespace {

static_assert(std::endian::native == std::endian::little);

template <typename T>
T stored_at(const std::uint8_t* bytes, bool big_endian) {
  std::array<std::uint8_t, sizeof(T)> ordered;
  std::copy_n(bytes, sizeof(T), ordered.begin());
  if (big_endian) {
    std::ranges::reverse(ordered);
  }
  return std::bit_cast<T>(ordered);
}

template <typename T>
void append_as(std::span<const std::uint8_t> bytes, bool big_endian, double slope, double intercept,
               std::vector<float>& values) {
  const bool plain = slope == 1 && intercept == 0;
  for (size_t at = 0; at + sizeof(T) <= bytes.size(); at += sizeof(T)) {
    const T x = stored_at<T>(&bytes[at], big_endian);
    values.push_back(plain ? static_cast<float>(x)
                           : static_cast<float>(static_cast<double>(x) * slope + intercept));
  }
}

}  // namespace

size_t size_of(ScalarType type) {
  switch (type) {
    case ScalarType::kInt8:
    case ScalarType::kUint8:
      return 1;
    case ScalarType::kInt16:
    case ScalarType::kUint16:
      return 2;
    case ScalarType::kInt32:
    case ScalarType::kUint32:
    case ScalarType::kFloat32:
      return 4;
    case ScalarType::kInt64:
    case ScalarType::kUint64:
    case ScalarType::kFloat64:
      break;
  }
  return 8;
}

void append_scalars(std::span<const std::uint8_t> bytes, ScalarType type, bool big_endian,
                    double slope, double intercept, std::vector<float>& values) {
  const auto append = [&]<typename T>(T /*type*/) {
    append_as<T>(bytes, big_endian, slope, intercept, values);
  };
  switch (type) {
    case ScalarType::kInt8:
      append(std::int8_t{});
      break;
    case ScalarType::kUint8:
      append(std::uint8_t{});
      break;
    case ScalarType::kInt16:
      append(std::int16_t{});
      break;
    case ScalarType::kUint16:
      append(std::uint16_t{});
      break;
    case ScalarType::kInt32:
      append(std::int32_t{});
      break;
    case ScalarType::kUint32:
      append(std::uint32_t{});
      break;
    case ScalarType::kInt64:
      append(std::int64_t{});
      break;
    case ScalarType::kUint64:
      append(std::uint64_t{});
      break;
    case ScalarType::kFloat32:
      append(float{});
      break;
    case ScalarType::kFloat64:
      append(double{});
      break;
  }
}

}  // namespace clipgs
