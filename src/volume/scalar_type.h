#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace clipgs {

/// How a file stores one number.
enum class ScalarType {
  kInt8,
  kUint8,
  kInt16,
  kUint16,
  kInt32,
  kUint32,
  kInt64,
  kUint64,
  kFloat32,
  kFloat64
};

size_t size_of(ScalarType type);  ///< bytes

/// Appends slope·x + intercept of every stored number x. bytes.size() is a multiple of
/// size_of(type).
void append_scalars(std::span<const std::uint8_t> bytes, ScalarType type, bool big_endian,
                    double slope, double intercept, std::vector<float>& values);

}  // namespace clipgs
