#include "asset/section_codings.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

#include "asset/section_file.h"
#include "asset/section_slices.h"

namespace clipgs {

namespace {

constexpr std::array kQualities = {kLossless, 97.0f, 94.0f, 90.0f, 85.0f, 80.0f, 75.0f, 70.0f};
// One slice of so many is coded to see what all take, which is wrong by up to 15 % of four volumes
// (images; a video tells each slice by its neighbours, so that it is one run of slices, wrong by up
// to 40 %), but by much the same from quality to quality.
constexpr int kSliceOf = 8;
// What takes no more is kept as it is; beyond, nobody sees what the next quality loses.
constexpr size_t kLosslessBytes = 500'000;
constexpr double kSure = 0.9;

CodedSection code_section(const Section& section, float quality, Saving saving) {
  std::vector<ZipEntry> files;
  nlohmann::json block = encode_section(section, quality, files, saving);
  return {std::move(block), std::move(files.front())};
}

/// Every kSliceOf-th slice, or, for a video, as many in the middle.
Section sample_of(const Section& section, bool video) {
  Section sample = section;
  const size_t slice = static_cast<size_t>(section.dims.x) * section.dims.y * section.channels;
  sample.dims.z = (section.dims.z + kSliceOf - 1) / kSliceOf;
  const int first = video ? (section.dims.z - sample.dims.z) / 2 : 0;
  const int step = video ? 1 : kSliceOf;
  std::vector<std::uint8_t> voxels;
  voxels.reserve(sample.dims.z * slice);
  for (int k = 0; k < sample.dims.z; ++k) {
    const auto z = static_cast<size_t>(first) + static_cast<size_t>(k) * static_cast<size_t>(step);
    const auto begin = section.voxels.begin() + static_cast<std::ptrdiff_t>(z * slice);
    voxels.insert(voxels.end(), begin, begin + static_cast<std::ptrdiff_t>(slice));
  }
  sample.voxels = std::move(voxels);  // and with them goes the memory of all others
  return sample;
}

}  // namespace

size_t CodedSection::bytes() const { return file.bytes.size() + block.dump().size(); }

SectionCodings::SectionCodings(const Section& section, std::optional<float> given, Saving saving)
    : section_(section), given_(given), saving_(saving) {
  if (given_) {
    coming_ = std::async(std::launch::async, code_section, std::cref(section_), *given_, saving_);
  } else {
    sample_ = sample_of(section, is_video(section, kQualities[1], saving));
  }
}

const CodedSection& SectionCodings::best(size_t room) {
  if (given_) {
    if (coming_.valid()) {
      coded_.emplace(*given_, coming_.get());
    }
    return by(*given_);
  }
  const auto room_for = [room](size_t i) {
    return kQualities[i] < kLossless ? room : std::min(room, kLosslessBytes);
  };
  const auto fits = [&](size_t i) { return by(kQualities[i]).bytes() <= room_for(i); };
  size_t low = 0;  // what is before seems too large
  size_t index = kQualities.size() - 1;
  while (low < index) {
    const size_t middle = (low + index) / 2;
    if (estimate(middle) <= room_for(middle)) {
      index = middle;
    } else {
      low = middle + 1;
    }
  }
  while (index + 1 < kQualities.size() && !fits(index)) {
    ++index;
  }
  // By how much the sample is wrong about one quality it is wrong about the next.
  const double wrong =
      static_cast<double>(by(kQualities[index]).bytes()) / static_cast<double>(estimate(index));
  const auto may_fit = [&](size_t i) {
    return kSure * wrong * static_cast<double>(estimate(i)) <= static_cast<double>(room_for(i));
  };
  while (index > 0 && may_fit(index - 1) && fits(index - 1)) {
    --index;
  }
  return by(kQualities[index]);
}

size_t SectionCodings::estimate(size_t index) {
  const auto known = estimates_.find(index);
  if (known != estimates_.end()) {
    return known->second;
  }
  const CodedSection coded = code_section(sample_, kQualities[index], saving_);
  const double share = static_cast<double>(section_.dims.z) / sample_.dims.z;
  const size_t table = coded.bytes() - coded.file.bytes.size();
  const size_t bytes =
      table + static_cast<size_t>(share * static_cast<double>(coded.file.bytes.size()));
  return estimates_.emplace(index, bytes).first->second;
}

const CodedSection& SectionCodings::by(float quality) {
  const auto known = coded_.find(quality);
  return known != coded_.end()
             ? known->second
             : coded_.emplace(quality, code_section(section_, quality, saving_)).first->second;
}

}  // namespace clipgs
