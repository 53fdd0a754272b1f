#include "volume/voxel_values.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <unordered_map>
#include <utility>

namespace clipgs {
namespace {

constexpr size_t kGrain = size_t{1} << 20;
constexpr int kWhole = 1 << 16;
constexpr int kSlotBits = 18;  // four slots a value at most: few collisions

VoxelValues::Range together(const std::vector<VoxelValues::Range>& ranges) {
  VoxelValues::Range all = ranges.front();
  for (const VoxelValues::Range& range : ranges) {
    all = {std::min(all.min, range.min), std::max(all.max, range.max)};
  }
  return all;
}

}  // namespace

ValuePalette::ValuePalette() : whole_(2 * size_t{kWhole}, 0), slots_(size_t{1} << kSlotBits, 0) {}

std::uint32_t& ValuePalette::hashed_slot(float value) {
  const auto bits = std::bit_cast<std::uint32_t>(value);
  // Fibonacci hashing: the upper bits of the product are well mixed.
  size_t slot = (bits * 0x9e3779b9U) >> (32 - kSlotBits);
  while (slots_[slot] != 0 && std::bit_cast<std::uint32_t>(values_[slots_[slot] - 1]) != bits) {
    slot = (slot + 1) % slots_.size();
  }
  return slots_[slot];
}

bool ValuePalette::encode(std::span<const float> values, std::uint16_t* codes) {
  for (size_t i = 0; i < values.size(); ++i) {
    const float value = values[i];
    const bool small = std::abs(value) < static_cast<float>(kWhole);
    const int whole = small ? static_cast<int>(value) : 0;
    const bool is_whole = std::bit_cast<std::uint32_t>(static_cast<float>(whole)) ==
                          std::bit_cast<std::uint32_t>(value);
    std::uint32_t& slot =
        is_whole ? whole_[static_cast<size_t>(std::ptrdiff_t{whole} + kWhole)] : hashed_slot(value);
    if (slot == 0) {
      if (values_.size() == kMost) {
        return false;
      }
      values_.push_back(value);
      slot = static_cast<std::uint32_t>(values_.size());
    }
    codes[i] = static_cast<std::uint16_t>(slot - 1);
  }
  return true;
}

VoxelValues::VoxelValues(std::vector<float> values) : floats_(std::move(values)) {}

VoxelValues::VoxelValues(std::vector<std::uint16_t> codes, std::vector<float> meaning)
    : codes_(std::move(codes)), meaning_(std::move(meaning)) {}

bool operator==(const VoxelValues& a, const VoxelValues& b) {
  return std::ranges::equal(a.all(), b.all());
}

VoxelValues::Range VoxelValues::range() const {
  std::vector<Range> pieces((size() + kGrain - 1) / kGrain);
  parallel_for(size(), kGrain, [&](size_t begin, size_t end) {
    Range range{(*this)[begin], (*this)[begin]};
    const auto add = [&range](float value) {
      range = {std::min(range.min, value), std::max(range.max, value)};
    };
    if (packed()) {
      std::vector<std::uint8_t> occurs(meaning_.size());
      for (size_t i = begin; i < end; ++i) {
        occurs[codes_[i]] = 1;
      }
      for (size_t code = 0; code < occurs.size(); ++code) {
        add(occurs[code] != 0 ? meaning_[code] : range.min);
      }
    } else {
      for (size_t i = begin; i < end; ++i) {
        add(floats_[i]);
      }
    }
    pieces[begin / kGrain] = range;
  });
  return together(pieces);
}

std::vector<float>& VoxelValues::unpack() {
  if (packed()) {
    floats_.resize(codes_.size());
    parallel_for(codes_.size(), kGrain, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) {
        floats_[i] = meaning_[codes_[i]];
      }
    });
    codes_ = {};
    meaning_ = {};
  }
  return floats_;
}

void VoxelValues::pack() {
  if (packed() || floats_.empty()) {
    return;
  }
  ValuePalette palette;
  std::vector<std::uint16_t> codes;
  codes.reserve(floats_.size());
  // Piece by piece: memory that is not needed, where there are too many values, is not touched.
  for (size_t begin = 0; begin < floats_.size(); begin += kGrain) {
    const auto piece =
        std::span(floats_).subspan(begin).first(std::min(kGrain, floats_.size() - begin));
    codes.resize(begin + piece.size());
    if (!palette.encode(piece, &codes[begin])) {
      return;
    }
  }
  *this = VoxelValues(std::move(codes), palette.values());
}

std::optional<std::uint16_t> VoxelValues::code_for(float value) {
  const auto known = std::ranges::find(meaning_, value);
  if (known != meaning_.end()) {
    return static_cast<std::uint16_t>(known - meaning_.begin());
  }
  if (meaning_.size() < ValuePalette::kMost) {
    meaning_.push_back(value);
    return static_cast<std::uint16_t>(meaning_.size() - 1);
  }
  std::vector<bool> occurs(ValuePalette::kMost);
  for (const std::uint16_t code : codes_) {
    occurs[code] = true;
  }
  const auto spare = std::ranges::find(occurs, false);
  if (spare == occurs.end()) {
    return std::nullopt;
  }
  const auto code = static_cast<std::uint16_t>(spare - occurs.begin());
  meaning_[code] = value;
  return code;
}

void VoxelValues::set(std::span<const size_t> places, std::span<const float> values) {
  std::unordered_map<float, std::uint16_t> codes;
  for (size_t code = 0; code < meaning_.size(); ++code) {
    codes.emplace(meaning_[code], static_cast<std::uint16_t>(code));
  }
  for (size_t i = 0; i < places.size(); ++i) {
    if (packed()) {
      auto known = codes.find(values[i]);
      if (known == codes.end() && meaning_.size() < ValuePalette::kMost) {
        known = codes.emplace(values[i], static_cast<std::uint16_t>(meaning_.size())).first;
        meaning_.push_back(values[i]);
      }
      if (known != codes.end()) {
        codes_[places[i]] = known->second;
        continue;
      }
      unpack();
    }
    floats_[places[i]] = values[i];
  }
}

ValuePacker::ValuePacker(size_t count) : count_(count) { codes_.reserve(count); }

void ValuePacker::append(std::span<const float> values) {
  if (packed_) {
    const size_t before = codes_.size();
    codes_.resize(before + values.size());
    packed_ = palette_.encode(values, &codes_[before]);
    if (packed_) {
      return;
    }
    codes_.resize(before);
    floats_.reserve(count_);
    for (const std::uint16_t code : codes_) {
      floats_.push_back(palette_.values()[code]);
    }
    codes_ = {};
  }
  floats_.insert(floats_.end(), values.begin(), values.end());
}

VoxelValues ValuePacker::take() {
  return packed_ ? VoxelValues(std::move(codes_), palette_.values())
                 : VoxelValues(std::move(floats_));
}

}  // namespace clipgs
