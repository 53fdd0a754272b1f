// Trainer's checkpoint: a header, then the raw float arrays (docs/format.md).
#include <cstring>
#include <span>

#include "core/error.h"
#include "core/file.h"
#include "train/trainer.h"

namespace clipgs {

namespace {

constexpr char kMagic[8] = {'C', 'L', 'I', 'P', 'G', 'S', 'T', '5'};

struct Header {
  char magic[8];
  std::uint64_t steps;  // of the whole run
  std::uint64_t step;   // done
  std::uint64_t seed;
  std::uint64_t budget;
  std::uint64_t size;  // Gaussians
  std::int32_t sh_degree;
  std::int32_t clip;
  std::uint64_t views;
  std::uint64_t has_section;
  std::uint64_t uniaxial;                     // numbers of the learner at the end of the file
  float gain[3][FaceGain::kCoefficients][3];  // value, first and second moments
  float gain_updates;
  std::uint32_t face_colors;
};

void append(std::vector<std::uint8_t>& bytes, const void* data, size_t size) {
  const auto* p = static_cast<const std::uint8_t*>(data);
  bytes.insert(bytes.end(), p, p + size);
}

}  // namespace

void Trainer::save_checkpoint(const std::filesystem::path& path) {
  Header header{};
  std::memcpy(header.magic, kMagic, sizeof kMagic);
  header.steps = options_.steps;
  header.step = step_;
  header.seed = options_.seed;
  header.budget = options_.budget;
  header.size = gaussians_.size();
  header.sh_degree = options_.sh_degree;
  header.clip = static_cast<std::int32_t>(options_.clip);
  header.views = views_.size();
  header.has_section = has_section_ ? 1 : 0;
  const std::vector<float> uniaxial = uniaxial_ ? uniaxial_->save() : std::vector<float>();
  header.uniaxial = uniaxial.size();
  const FaceGain* const gains[] = {&gain_.value, &gain_.first, &gain_.second};
  for (size_t g = 0; g < 3; ++g) {
    std::memcpy(header.gain[g], gains[g]->coefficients.data(), sizeof header.gain[g]);
  }
  header.gain_updates = gain_.updates;
  header.face_colors = gaussians_.has_face_colors() ? 1 : 0;
  std::vector<std::uint8_t> bytes;
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
  Header header{};
  if (bytes.size() < sizeof header) {
    throw Error("{}: is truncated; delete it to train from the start", path.string());
  }
  std::memcpy(&header, bytes.data(), sizeof header);
  if (std::memcmp(header.magic, kMagic, sizeof kMagic) != 0) {
    throw Error("{}: is not a checkpoint; delete it to train from the start", path.string());
  }
  if (header.steps != options_.steps || header.seed != options_.seed ||
      header.budget != options_.budget || header.sh_degree != options_.sh_degree ||
      header.clip != static_cast<std::int32_t>(options_.clip) || header.views != views_.size() ||
      header.has_section != (has_section_ ? 1U : 0U) ||
      header.face_colors != (gaussians_.has_face_colors() ? 1U : 0U) ||
      (header.uniaxial > 0) != uniaxial_.has_value()) {
    throw Error("{}: was written with other options; delete it, or give the ones it had",
                path.string());
  }
  const auto planes = static_cast<size_t>(gaussians_.planes());
  const size_t per_gaussian = (3 * planes + 1) * sizeof(float) + 2 * sizeof(std::uint32_t);
  const auto corrupt = [&] {
    return Error("{}: is truncated or corrupt; delete it to train from the start", path.string());
  };
  if (header.size > options_.budget || header.uniaxial > bytes.size() ||
      bytes.size() !=
          sizeof header + header.size * per_gaussian + header.uniaxial * sizeof(float)) {
    throw corrupt();
  }
  if (uniaxial_) {
    std::vector<float> numbers(header.uniaxial);
    std::memcpy(numbers.data(), bytes.data() + bytes.size() - numbers.size() * sizeof(float),
                numbers.size() * sizeof(float));
    if (!uniaxial_->load(numbers, header.size)) {
      throw Error(
          "{}: was written with other options, or is corrupt; delete it, or give the ones "
          "it had",
          path.string());
    }
  }
  FaceGain* const gains[] = {&gain_.value, &gain_.first, &gain_.second};
  for (size_t g = 0; g < 3; ++g) {
    std::memcpy(gains[g]->coefficients.data(), header.gain[g], sizeof header.gain[g]);
  }
  gain_.updates = header.gain_updates;
  step_ = header.step;
  gaussians_ = gaussians_.like(header.size);
  gradients_ = gaussians_;
  adam_ = Adam(gaussians_);
  const std::uint8_t* at = bytes.data() + sizeof header;
  for (Gaussians* cloud : {&gaussians_, &adam_.first(), &adam_.second()}) {
    std::memcpy(cloud->data().data(), at, cloud->data().size() * sizeof(float));
    at += cloud->data().size() * sizeof(float);
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
