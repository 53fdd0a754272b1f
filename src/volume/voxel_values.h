#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <ranges>
#include <span>
#include <utility>
#include <vector>

#include "core/parallel.h"

namespace clipgs {

/// The different values of a volume, numbered in the order in which they are met.
class ValuePalette {
 public:
  static constexpr size_t kMost = size_t{1} << 16;

  ValuePalette();
  /// Writes the number of each value; false once there are more than kMost different ones (told
  /// apart by their bits), with `codes` unfinished.
  bool encode(std::span<const float> values, std::uint16_t* codes);
  const std::vector<float>& values() const { return values_; }

 private:
  std::uint32_t& hashed_slot(float value);

  std::vector<float> values_;
  // Code + 1, or 0: of whole numbers from −kWhole, as nearly every scan has them (a hash scatters
  // them over the cache), and a hash table of the others.
  std::vector<std::uint32_t> whole_, slots_;
};

/// The values of voxels: 16-bit codes and a table of what they mean if no more than 65536 different
/// values occur, as in nearly every scan, else floats. Either way each value is exactly the float
/// that it was made from; the codes take half the memory.
class VoxelValues {
 public:
  /// The least and the greatest value.
  struct Range {
    float min = 0;
    float max = 0;
  };

  VoxelValues() = default;
  /// As floats, 4 bytes each; pack() makes them smaller.
  VoxelValues(std::vector<float> values);  // NOLINT(*-explicit-*)
  /// The value of a voxel is meaning[code].
  VoxelValues(std::vector<std::uint16_t> codes, std::vector<float> meaning);

  size_t size() const { return packed() ? codes_.size() : floats_.size(); }
  bool empty() const { return size() == 0; }
  float operator[](size_t i) const { return packed() ? meaning_[codes_[i]] : floats_[i]; }
  /// All in order.
  auto all() const {
    return std::views::iota(size_t{0}, size()) |
           std::views::transform([this](size_t i) { return (*this)[i]; });
  }
  friend bool operator==(const VoxelValues& a, const VoxelValues& b);
  /// The least and the largest. There is at least one value, and none is NaN.
  Range range() const;

  /// Replaces every value x by change(x), which depends on x alone and may run on many threads.
  template <typename Change>
  void transform(const Change& change);
  /// Sets the values of the voxels i where `where(i)`, which may run on many threads.
  template <typename Where>
  void set_where(float value, const Where& where);
  /// Sets the values of some voxels, one each.
  void set(std::span<const size_t> places, std::span<const float> values);
  /// Replaces what is stored, one element a voxel, by rearrange(it).
  template <typename Rearrange>
  void rearrange(const Rearrange& rearrange);
  /// As floats that can be changed one by one.
  std::vector<float>& unpack();
  /// As codes if the values are few enough, else as they are.
  void pack();

  bool packed() const { return !meaning_.empty(); }
  /// For what goes through all of them fast: empty if not packed() …
  const std::vector<std::uint16_t>& codes() const { return codes_; }
  const std::vector<float>& meaning() const { return meaning_; }
  /// … and empty if packed().
  const std::vector<float>& floats() const { return floats_; }

 private:
  // A code of this value; not there if all 65536 are taken by others.
  std::optional<std::uint16_t> code_for(float value);

  std::vector<float> floats_;
  std::vector<std::uint16_t> codes_;
  std::vector<float> meaning_;  // all codes that occur lie within
};

/// Collects values piece by piece, packed from the start, so that no more memory than for the
/// result is taken.
class ValuePacker {
 public:
  /// `count` values in all.
  explicit ValuePacker(size_t count);
  void append(std::span<const float> values);
  VoxelValues take();

 private:
  size_t count_;
  ValuePalette palette_;
  bool packed_ = true;
  std::vector<std::uint16_t> codes_;
  std::vector<float> floats_;  // if not packed_
};

template <typename Change>
void VoxelValues::transform(const Change& change) {
  std::vector<float>& values = packed() ? meaning_ : floats_;
  parallel_for(values.size(), size_t{1} << 16, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      values[i] = change(values[i]);
    }
  });
}

template <typename Rearrange>
void VoxelValues::rearrange(const Rearrange& rearrange) {
  if (packed()) {
    codes_ = rearrange(std::move(codes_));
  } else {
    floats_ = rearrange(std::move(floats_));
  }
}

template <typename Where>
void VoxelValues::set_where(float value, const Where& where) {
  const auto set = [&](auto& places, auto to) {
    parallel_for(places.size(), size_t{1} << 16, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) {
        places[i] = where(i) ? to : places[i];
      }
    });
  };
  const std::optional<std::uint16_t> code = packed() ? code_for(value) : std::nullopt;
  if (code) {
    set(codes_, *code);
  } else {
    set(unpack(), value);
  }
}

}  // namespace clipgs
