// Trainer's checkpoint: its claim, a header, then the raw float arrays (docs/format.md).
#include <algorithm>
#include <cmath>
#include <cstring>
#include <span>

#include "core/error.h"
#include "core/file.h"
#include "train/trainer.h"

namespace clipgs {

namespace {

constexpr char kMagic[8] = {'C', 'L', 'I', 'P', 'G', 'S', 'T', '6'};

struct Start {
  char magic[8];
  std::uint64_t claim;  // bytes of its JSON, which follow
};

struct Header {
  std::uint64_t step;                         // done
  std::uint64_t size;                         // Gaussians
  std::uint64_t uniaxial;                     // numbers of the learner at the end of the file
  float gain[3][FaceGain::kCoefficients][3];  // value, first and second moments
  float gain_updates;
};

void append(std::vector<std::uint8_t>& bytes, const void* data, size_t size) {
  const auto* p = static_cast<const std::uint8_t*>(data);
  bytes.insert(bytes.end(), p, p + size);
}

/// Training makes no others, and could not go on from them.
bool all_finite(std::span<const float> numbers) {
  return std::ranges::all_of(numbers, [](float number) { return std::isfinite(number); });
}

}  // namespace

void Trainer::save_checkpoint(const std::filesystem::path& path) {
  const std::string claim = claim_.dump();
  Start start{};
  std::memcpy(start.magic, kMagic, sizeof kMagic);
  start.claim = claim.size();
  Header header{};
  header.step = step_;
  header.size = gaussians_.size();
  const std::vector<float> uniaxial = uniaxial_ ? uniaxial_->save() : std::vector<float>();
  header.uniaxial = uniaxial.size();
  const FaceGain* const gains[] = {&gain_.value, &gain_.first, &gain_.second};
  for (size_t g = 0; g < 3; ++g) {
    std::memcpy(header.gain[g], gains[g]->coefficients.data(), sizeof header.gain[g]);
  }
  header.gain_updates = gain_.updates;
  std::vector<std::uint8_t> bytes;
  append(bytes, &start, sizeof start);
  append(bytes, claim.data(), claim.size());
  append(bytes, &header, sizeof header);
  for (const Gaussians* cloud : {&gaussians_, &adam_.first(), &adam_.second()}) {
    append(bytes, cloud->data().data(), cloud->data().size() * sizeof(float));
  }
  for (const std::vector<std::uint32_t>* counts : {&adam_.updates(), &last_reached_}) {
    append(bytes, counts->data(), counts->size() * sizeof(std::uint32_t));
  }
  append(bytes, need_.data(), need_.size() * sizeof(float));
  append(bytes, uniaxial.data(), uniaxial.size() * sizeof(float));
  write_file(path, bytes.data(), bytes.size());
}

bool Trainer::load_checkpoint(const std::filesystem::path& path) {
  if (!std::filesystem::exists(path)) {
    return false;
  }
  const std::vector<std::uint8_t> bytes = read_file(path);
  const auto corrupt = [&] {
    return Error("{}: is truncated or corrupt; delete it to train from the start", path.string());
  };
  Start start{};
  if (bytes.size() < sizeof start) {
    throw corrupt();
  }
  std::memcpy(&start, bytes.data(), sizeof start);
  if (std::memcmp(start.magic, kMagic, sizeof kMagic) != 0) {
    throw Error("{}: is no checkpoint of this version; delete it to train from the start",
                path.string());
  }
  if (start.claim > bytes.size() - sizeof start) {
    throw corrupt();
  }
  const auto* const text = bytes.data() + sizeof start;
  const Claim claim = Claim::parse(text, text + start.claim, nullptr, false);
  if (!claim.is_object()) {
    throw corrupt();
  }
  if (const std::string changed = changes(claim, claim_); !changed.empty()) {
    throw Error("{}: is of another run: {}; delete it to train from the start, or go on as it was",
                path.string(), changed);
  }
  const size_t begin = sizeof start + start.claim;
  Header header{};
  if (bytes.size() < begin + sizeof header) {
    throw corrupt();
  }
  std::memcpy(&header, bytes.data() + begin, sizeof header);
  const auto planes = static_cast<size_t>(gaussians_.planes());
  const size_t per_gaussian = (3 * planes + 1) * sizeof(float) + 2 * sizeof(std::uint32_t);
  if (header.size > options_.budget || header.uniaxial > bytes.size() ||
      (header.uniaxial > 0) != uniaxial_.has_value() ||
      bytes.size() !=
          begin + sizeof header + header.size * per_gaussian + header.uniaxial * sizeof(float)) {
    throw corrupt();
  }
  if (uniaxial_) {
    std::vector<float> numbers(header.uniaxial);
    std::memcpy(numbers.data(), bytes.data() + bytes.size() - numbers.size() * sizeof(float),
                numbers.size() * sizeof(float));
    if (!all_finite(numbers) || !uniaxial_->load(numbers, header.size)) {
      throw corrupt();
    }
  }
  FaceGain* const gains[] = {&gain_.value, &gain_.first, &gain_.second};
  for (size_t g = 0; g < 3; ++g) {
    std::memcpy(gains[g]->coefficients.data(), header.gain[g], sizeof header.gain[g]);
    if (!all_finite({&header.gain[g][0][0], sizeof header.gain[g] / sizeof(float)})) {
      throw corrupt();
    }
  }
  gain_.updates = header.gain_updates;
  step_ = header.step;
  gaussians_ = gaussians_.like(header.size);
  gradients_ = gaussians_;
  adam_ = Adam(gaussians_);
  const std::uint8_t* at = bytes.data() + begin + sizeof header;
  for (Gaussians* cloud : {&gaussians_, &adam_.first(), &adam_.second()}) {
    std::memcpy(cloud->data().data(), at, cloud->data().size() * sizeof(float));
    at += cloud->data().size() * sizeof(float);
    if (!all_finite(cloud->data())) {
      throw corrupt();
    }
  }
  last_reached_.resize(header.size);
  for (std::vector<std::uint32_t>* counts : {&adam_.updates(), &last_reached_}) {
    std::memcpy(counts->data(), at, counts->size() * sizeof(std::uint32_t));
    at += counts->size() * sizeof(std::uint32_t);
  }
  need_.resize(header.size);
  std::memcpy(need_.data(), at, need_.size() * sizeof(float));
  order_.clear();
  return true;
}

}  // namespace clipgs
