#include "asset/sog.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>
#include <numbers>
#include <tbb/parallel_sort.h>

#include "asset/checksum.h"
#include "asset/codebook.h"
#include "asset/palette.h"
#include "core/error.h"
#include "core/json_reader.h"
#include "core/parallel.h"
#include "core/version.h"
#include "splat/scene_file.h"

namespace clipgs {

using nlohmann::json;

namespace {

constexpr int kSogVersion = 2;
constexpr int kMaxCode = 65535;
constexpr size_t kSogGrain = 8192;
constexpr int kCentroidsPerRow = 64;
constexpr const char* kShKey = "shN";
constexpr const char* kFaceKey = "clipgs_faces";  // ours, as shN
constexpr std::uint8_t kFirstRotationTag = 252;
// Limits beyond which floats would overflow in a renderer.
constexpr float kMaxLogMean = 20;  // ln(|x| + 1), x in metres
constexpr float kMaxLogScale = 60;
constexpr float kMaxSh = 1000;
// Of palettes of colours.
constexpr size_t kMostSplatsPerCentroid = 16;
constexpr size_t kFewestSplatsPerCentroid = 2;
// Between them, splats weigh in a palette by what is seen of them, m²; both far from what occurs.
constexpr float kLeastArea = 1e-18f;
constexpr float kLargestArea = 1e6f;

int image_width(size_t count) {
  return 4 * static_cast<int>(std::ceil(std::sqrt(static_cast<double>(count)) / 4));
}

int image_height(size_t count) {
  const auto row_group = 4 * static_cast<size_t>(image_width(count));
  return 4 * static_cast<int>((count + row_group - 1) / row_group);
}

std::uint8_t byte_from_unit(double value) {
  return static_cast<std::uint8_t>(std::lround(255 * std::clamp(value, 0.0, 1.0)));
}

double log_from_position(double x) { return std::copysign(std::log1p(std::abs(x)), x); }
double position_from_log(double v) { return std::copysign(std::expm1(std::abs(v)), v); }

// ---- writing ------------------------------------------------------------------------------------

void require_writable_values(const Gaussians& g) {
  if (g.size() == 0 || g.size() > kMaxSplats) {
    throw Error("a case holds 1 to {} splats, this scene has {}", kMaxSplats, g.size());
  }
  for (int p = 0; p < g.planes(); ++p) {
    for (size_t i = 0; i < g.size(); ++i) {
      const float value = g.plane(p)[i];
      if (!std::isfinite(value) ||
          (p < Gaussians::kLogScale && std::abs(log_from_position(value)) > kMaxLogMean)) {
        throw Error("parameter {} of splat {} is {}: the scene cannot be packed; train it again", p,
                    i, value);
      }
    }
  }
}

/// Every third bit of the result is one of `v`'s ten.
std::uint32_t spread_bits(std::uint32_t v) {
  v = (v | (v << 16)) & 0x030000ff;
  v = (v | (v << 8)) & 0x0300f00f;
  v = (v | (v << 4)) & 0x030c30c3;
  return (v | (v << 2)) & 0x09249249;
}

/// Morton order of the means; equal codes go by the parameters themselves, so that the order of the
/// input never shows.
std::vector<size_t> morton_order(const Gaussians& g) {
  Box box;
  for (size_t i = 0; i < g.size(); ++i) {
    box.add(g.mean(i));
  }
  const Vec3 size = box.size();
  const float side = std::max({size.x, size.y, size.z, std::numeric_limits<float>::min()});
  std::vector<std::uint32_t> codes(g.size());
  std::vector<size_t> order(g.size());
  for (size_t i = 0; i < g.size(); ++i) {
    const Vec3 unit = (g.mean(i) - box.min) / side;
    std::uint32_t code = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const float cell = std::clamp(unit[axis] * 1024, 0.0f, 1023.0f);
      code |= spread_bits(static_cast<std::uint32_t>(cell)) << axis;
    }
    codes[i] = code;
    order[i] = i;
  }
  tbb::parallel_sort(order.begin(), order.end(), [&](size_t a, size_t b) {
    if (codes[a] != codes[b]) {
      return codes[a] < codes[b];
    }
    for (int p = 0; p < g.planes(); ++p) {
      if (g.plane(p)[a] != g.plane(p)[b]) {
        return g.plane(p)[a] < g.plane(p)[b];
      }
    }
    return a < b;  // alike in all but what lies beside the SOG: its layers
  });
  return order;
}

json to_json(const std::array<float, 256>& values) {
  json result = json::array();
  for (const float value : values) {
    result.push_back(json_number(value));
  }
  return result;
}

/// RGB coefficients of every splat that lie in successive planes and are kept as a palette.
struct ColorSets {
  int first;  // plane
  size_t coefficients;
  int bands;
  std::string key;
};

/// The images of a SOG while it is made.
struct Writer {
  const Gaussians& g;
  json& meta;
  std::vector<std::pair<std::string, Texels>> images;

  Texels texels() const { return splat_texels(g.size()); }

  void add_means() {
    Texels low = texels();
    Texels high = texels();
    json mins = json::array();
    json maxs = json::array();
    for (int axis = 0; axis < 3; ++axis) {
      const float* x = g.plane(Gaussians::kMean + axis);
      const auto [least, most] = std::minmax_element(x, x + g.size());
      const double min = log_from_position(*least);
      const double range = log_from_position(*most) - min;
      mins.push_back(min);
      maxs.push_back(min + range);
      for (size_t i = 0; i < g.size(); ++i) {
        const double unit = range > 0 ? (log_from_position(x[i]) - min) / range : 0;
        const auto code = static_cast<int>(std::lround(kMaxCode * std::clamp(unit, 0.0, 1.0)));
        low.rgba[4 * i + axis] = static_cast<std::uint8_t>(code);
        high.rgba[4 * i + axis] = static_cast<std::uint8_t>(code >> 8);
      }
    }
    meta["means"] = {{"mins", mins}, {"maxs", maxs}, {"files", {"means_l.webp", "means_u.webp"}}};
    images.emplace_back("means_l.webp", std::move(low));
    images.emplace_back("means_u.webp", std::move(high));
  }

  void add_rotations() {
    Texels image = texels();
    for (size_t i = 0; i < g.size(); ++i) {
      const Quat q = g.rotation(i);
      const std::array<float, 4> wxyz = {q.w, q.x, q.y, q.z};
      size_t largest = 0;
      for (size_t c = 1; c < 4; ++c) {
        if (std::abs(wxyz[c]) > std::abs(wxyz[largest])) {
          largest = c;
        }
      }
      const double sign = wxyz[largest] < 0 ? -1 : 1;
      size_t channel = 0;
      for (size_t c = 0; c < 4; ++c) {
        if (c != largest) {
          image.rgba[4 * i + channel++] =
              byte_from_unit(0.5 * (sign * wxyz[c] * std::numbers::sqrt2 + 1));
        }
      }
      image.rgba[4 * i + 3] = static_cast<std::uint8_t>(kFirstRotationTag + largest);
    }
    meta["quats"] = {{"files", {"quats.webp"}}};
    images.emplace_back("quats.webp", std::move(image));
  }

  /// Three planes from `first` through one codebook, as RGB.
  Texels quantise(int first, float limit, const char* key, const char* file) {
    std::vector<float> samples(g.plane(first), g.plane(first) + 3 * g.size());
    for (float& sample : samples) {
      sample = std::clamp(sample, -limit, limit);
    }
    const Codebook codebook = fit_codebook(samples);
    Texels image = texels();
    parallel_for(g.size(), kSogGrain, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) {
        for (size_t c = 0; c < 3; ++c) {
          image.rgba[4 * i + c] = codebook.nearest(samples[c * g.size() + i]);
        }
      }
    });
    meta[key] = {{"codebook", to_json(codebook.values)}, {"files", {file}}};
    return image;
  }

  void add_scales() {
    images.emplace_back("scales.webp",
                        quantise(Gaussians::kLogScale, kMaxLogScale, "scales", "scales.webp"));
  }

  void add_colors() {
    Texels image = quantise(Gaussians::kSh, kMaxSh, "sh0", "sh0.webp");
    for (size_t i = 0; i < g.size(); ++i) {
      image.rgba[4 * i + 3] = byte_from_unit(g.opacity(i));
    }
    images.emplace_back("sh0.webp", std::move(image));
  }

  /// A palette of at most `size` whole sets of coefficients; an error counts by the splat's weight.
  void add_color_sets(const ColorSets& sets, size_t size, const std::vector<float>& weights) {
    const size_t dimension = 3 * sets.coefficients;
    std::vector<float> points(g.size() * dimension);
    for (size_t d = 0; d < dimension; ++d) {
      const float* plane = g.plane(sets.first + static_cast<int>(d));
      for (size_t i = 0; i < g.size(); ++i) {
        points[i * dimension + d] = std::clamp(plane[i], -kMaxSh, kMaxSh);
      }
    }
    const Palette palette = fit_palette(points, weights, dimension, size);
    const Codebook codebook = fit_codebook(palette.centroids);

    const auto rows = static_cast<int>((palette.size() + kCentroidsPerRow - 1) / kCentroidsPerRow);
    Texels centroids(kCentroidsPerRow * static_cast<int>(sets.coefficients), rows);
    for (size_t k = 0; k < palette.size() * sets.coefficients; ++k) {
      for (size_t c = 0; c < 3; ++c) {
        centroids.rgba[4 * k + c] = codebook.nearest(palette.centroids[3 * k + c]);
      }
    }
    Texels labels = texels();
    for (size_t i = 0; i < g.size(); ++i) {
      labels.rgba[4 * i] = static_cast<std::uint8_t>(palette.labels[i]);
      labels.rgba[4 * i + 1] = static_cast<std::uint8_t>(palette.labels[i] >> 8);
    }
    const std::string centroids_file = sets.key + "_centroids.webp";
    const std::string labels_file = sets.key + "_labels.webp";
    meta[sets.key] = {{"count", palette.size()},
                      {"bands", sets.bands},
                      {"codebook", to_json(codebook.values)},
                      {"files", {centroids_file, labels_file}}};
    images.emplace_back(centroids_file, std::move(centroids));
    images.emplace_back(labels_file, std::move(labels));
  }

  /// How much of an error of each splat's colour is seen: its area where it is broadest, times its
  /// opacity.
  std::vector<float> seen_areas() const {
    std::vector<float> areas(g.size());
    for (size_t i = 0; i < g.size(); ++i) {
      const Vec3 scale = g.scale(i);
      const float thickness = std::min({scale.x, scale.y, scale.z});
      const float area = scale.x * scale.y * scale.z / thickness * g.opacity(i);
      areas[i] = area > kLeastArea ? std::min(area, kLargestArea) : kLeastArea;
    }
    return areas;
  }

  /// Encodes the images so far, states their checksums and forgets them.
  std::vector<ZipEntry> encode() {
    std::vector<ZipEntry> files(images.size());
    for (const auto& [name, texels] : images) {
      state_checksum(meta, name, texels.rgba);
    }
    parallel_for(images.size(), 1, [&](size_t begin, size_t end) {
      for (size_t k = begin; k < end; ++k) {
        files[k] = {images[k].first, encode_webp(images[k].second)};
      }
    });
    images.clear();
    return files;
  }
};

/// A power of two of centroids that leaves each no more splats than that, if a palette may be so
/// large.
size_t palette_size(size_t splats, size_t splats_per_centroid) {
  size_t size = 64;
  while (size < kMaxPaletteSize && splats_per_centroid * size < splats) {
    size *= 2;
  }
  return size;
}

/// What palettes of that size hardly take less than: fitting one to see takes seconds.
size_t fewest_bytes(const std::vector<ColorSets>& all_sets, size_t splats, size_t size) {
  constexpr double kLeastOfRaw = 0.75;
  double raw = 0;
  for (const ColorSets& sets : all_sets) {
    raw += static_cast<double>(splats) * std::log2(size) / 8 +
           static_cast<double>(size * 3 * sets.coefficients);
  }
  return static_cast<size_t>(kLeastOfRaw * raw);
}

// ---- reading ------------------------------------------------------------------------------------

/// Reads values of meta.json, with errors that say which.
class MetaReader {
 public:
  MetaReader(const json& meta, std::string name) : meta_(meta), name_(std::move(name)) {
    if (!meta_.is_object()) {
      fail("version");
    }
  }

  SogSummary summary() const {
    integer(meta_, "version", kSogVersion, kSogVersion);
    SogSummary result;
    result.count = static_cast<size_t>(integer(meta_, "count", 1, kMaxSplats));
    if (meta_.contains(kShKey)) {
      result.sh_degree = integer(section(kShKey), "bands", 1, kMaxShDegree);
    }
    result.face_colors = meta_.contains(kFaceKey);
    if (result.face_colors) {
      integer(section(kFaceKey), "bands", Gaussians::kFaceDegree, Gaussians::kFaceDegree);
    }
    return result;
  }

  const std::string& name() const { return name_; }
  const json& meta() const { return meta_; }

  [[noreturn]] void fail(const char* key) const {
    throw Error("{}: \"{}\" of meta.json is missing or out of range; the file is corrupt or no SOG",
                name_, key);
  }

  int integer(const json& object, const char* key, int min, int max) const {
    const auto found = object.find(key);
    if (found == object.end() || !found->is_number_integer()) {
      fail(key);
    }
    const auto value = found->get<std::int64_t>();
    if (value < min || value > max) {
      fail(key);
    }
    return static_cast<int>(value);
  }

  const json& section(const char* key) const {
    const auto found = meta_.find(key);
    if (found == meta_.end() || !found->is_object()) {
      fail(key);
    }
    return *found;
  }

  /// `size` numbers within ±limit.
  std::vector<float> numbers(const json& object, const char* key, size_t size, float limit) const {
    const auto found = object.find(key);
    if (found == object.end() || !found->is_array() || found->size() != size) {
      fail(key);
    }
    std::vector<float> values;
    for (const json& value : *found) {
      // Negated, so that NaN fails as well.
      if (!value.is_number() || !(std::abs(value.get<double>()) <= limit)) {
        fail(key);
      }
      values.push_back(value.get<float>());
    }
    return values;
  }

 private:
  const json& meta_;
  std::string name_;
};

class Decoder {
 public:
  Decoder(const json& meta, const std::map<std::string, Bytes>& files, const std::string& name)
      : meta_(meta, name), files_(files), summary_(meta_.summary()), count_(summary_.count) {}

  Gaussians decode() const {
    // Decoded before the Gaussians are allocated: a count that is not backed by images of its size
    // costs nothing.
    const Texels low = image("means", 0);
    const Texels high = image("means", 1);
    const Texels rotations = image("quats", 0);
    const Texels scales = image("scales", 0);
    const Texels colors = image("sh0", 0);
    Gaussians g(count_, summary_.sh_degree, summary_.face_colors);
    decode_means(low, high, g);
    decode_rotations(rotations, g);
    decode_codes(scales, codebook("scales", kMaxLogScale), Gaussians::kLogScale, g);
    decode_codes(colors, codebook("sh0", kMaxSh), Gaussians::kSh, g);
    decode_opacities(colors, g);
    if (summary_.sh_degree > 0) {
      decode_color_sets(kShKey, static_cast<size_t>(sh_coefficients(summary_.sh_degree)) - 1,
                        Gaussians::kSh + 3, g);
    }
    if (summary_.face_colors) {
      decode_color_sets(kFaceKey, sh_coefficients(Gaussians::kFaceDegree), g.face(), g);
    }
    return g;
  }

 private:
  std::vector<float> codebook(const char* key, float limit) const {
    return meta_.numbers(meta_.section(key), "codebook", 256, limit);
  }

  Texels image(const char* key, size_t index) const {
    return image(key, index, image_width(count_), image_height(count_));
  }

  Texels image(const char* key, size_t index, int width, int height) const {
    const json& object = meta_.section(key);
    const auto list = object.find("files");
    if (list == object.end() || !list->is_array() || index >= list->size() ||
        !(*list)[index].is_string()) {
      meta_.fail(key);
    }
    const std::string file = (*list)[index].get<std::string>();
    const auto found = files_.find(file);
    if (found == files_.end()) {
      throw Error("{}: has no file \"{}\"; it is incomplete", meta_.name(), file);
    }
    Texels texels = decode_webp(found->second, width, height, meta_.name() + ": " + file);
    require_stated_checksum(meta_.meta(), file, texels.rgba, meta_.name());
    return texels;
  }

  void decode_means(const Texels& low, const Texels& high, Gaussians& g) const {
    const std::vector<float> mins = meta_.numbers(meta_.section("means"), "mins", 3, kMaxLogMean);
    const std::vector<float> maxs = meta_.numbers(meta_.section("means"), "maxs", 3, kMaxLogMean);
    parallel_for(count_, kSogGrain, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) {
        for (size_t axis = 0; axis < 3; ++axis) {
          const int code = low.rgba[4 * i + axis] | (high.rgba[4 * i + axis] << 8);
          const double min = mins[axis];
          const double v = min + (maxs[axis] - min) * code / kMaxCode;
          g.plane(Gaussians::kMean + static_cast<int>(axis))[i] =
              static_cast<float>(position_from_log(v));
        }
      }
    });
  }

  void decode_rotations(const Texels& image, Gaussians& g) const {
    for (size_t i = 0; i < count_; ++i) {
      const std::uint8_t* texel = &image.rgba[4 * i];
      if (texel[3] < kFirstRotationTag) {
        throw Error("{}: the rotation of splat {} is not one; the file is corrupt", meta_.name(),
                    i);
      }
      const int largest = texel[3] - kFirstRotationTag;
      double rest = 1;
      int channel = 0;
      for (int c = 0; c < 4; ++c) {
        if (c != largest) {
          const double value = (texel[channel++] / 255.0 - 0.5) * std::numbers::sqrt2;
          g.plane(Gaussians::kRotation + c)[i] = static_cast<float>(value);
          rest -= value * value;
        }
      }
      g.plane(Gaussians::kRotation + largest)[i] =
          static_cast<float>(std::sqrt(std::max(rest, 0.0)));
    }
  }

  void decode_codes(const Texels& image, const std::vector<float>& values, int first,
                    Gaussians& g) const {
    for (int c = 0; c < 3; ++c) {
      float* plane = g.plane(first + c);
      for (size_t i = 0; i < count_; ++i) {
        plane[i] = values[image.rgba[4 * i + c]];
      }
    }
  }

  /// The ends are a quarter of a step inside (0, 1): a logit is finite.
  void decode_opacities(const Texels& colors, Gaussians& g) const {
    for (size_t i = 0; i < count_; ++i) {
      const double code = std::clamp<double>(colors.rgba[4 * i + 3], 0.25, 254.75);
      g.plane(Gaussians::kOpacity)[i] = static_cast<float>(std::log(code / (255 - code)));
    }
  }

  void decode_color_sets(const char* key, size_t coefficients, int first, Gaussians& g) const {
    const auto palette =
        static_cast<size_t>(meta_.integer(meta_.section(key), "count", 1, kMaxPaletteSize));
    const auto rows = static_cast<int>((palette + kCentroidsPerRow - 1) / kCentroidsPerRow);
    const Texels centroids = image(key, 0, kCentroidsPerRow * static_cast<int>(coefficients), rows);
    const Texels labels = image(key, 1);
    const std::vector<float> values = codebook(key, kMaxSh);
    for (size_t i = 0; i < count_; ++i) {
      const auto label = static_cast<size_t>(labels.rgba[4 * i] | (labels.rgba[4 * i + 1] << 8));
      if (label >= palette) {
        throw Error("{}: splat {} names entry {} of the {} of {}; the file is corrupt",
                    meta_.name(), i, label, palette, key);
      }
      for (size_t k = 0; k < coefficients; ++k) {
        const std::uint8_t* texel = &centroids.rgba[4 * (label * coefficients + k)];
        for (size_t c = 0; c < 3; ++c) {
          g.plane(first + static_cast<int>(3 * k + c))[i] = values[texel[c]];
        }
      }
    }
  }

  MetaReader meta_;
  const std::map<std::string, Bytes>& files_;
  SogSummary summary_;
  size_t count_;
};

}  // namespace

Texels splat_texels(size_t count) { return {image_width(count), image_height(count)}; }

json encode_sog(const Gaussians& gaussians, std::vector<ZipEntry>& files,
                std::vector<size_t>* order, const SogRoom& room) {
  require_writable_values(gaussians);
  std::vector<size_t> morton = morton_order(gaussians);
  const Gaussians ordered = gaussians.gather(morton);
  if (order != nullptr) {
    *order = std::move(morton);
  }
  json meta = {{"version", kSogVersion},
               {"asset", {{"generator", fmt::format("clipgs {}", program_version())}}},
               {"count", ordered.size()}};
  Writer writer{ordered, meta, {}};
  writer.add_means();
  writer.add_scales();
  writer.add_rotations();
  writer.add_colors();
  std::vector<ZipEntry> encoded = writer.encode();
  const size_t taken = total_bytes(encoded);
  std::ranges::move(encoded, std::back_inserter(files));

  std::vector<ColorSets> all_sets;
  if (ordered.sh_degree() > 0) {
    all_sets.push_back({Gaussians::kSh + 3,
                        static_cast<size_t>(sh_coefficients(ordered.sh_degree())) - 1,
                        ordered.sh_degree(), kShKey});
  }
  if (ordered.has_face_colors()) {
    all_sets.push_back({ordered.face(), sh_coefficients(Gaussians::kFaceDegree),
                        Gaussians::kFaceDegree, kFaceKey});
  }
  const std::vector<float> weights = writer.seen_areas();
  const size_t least = palette_size(ordered.size(), kMostSplatsPerCentroid);
  const size_t bytes = room ? room(taken + fewest_bytes(all_sets, ordered.size(), least)) : 0;
  size_t size = palette_size(ordered.size(), kFewestSplatsPerCentroid);
  while (size > least && taken + fewest_bytes(all_sets, ordered.size(), size) > bytes) {
    size /= 2;
  }
  do {
    for (const ColorSets& sets : all_sets) {
      writer.add_color_sets(sets, size, weights);
    }
    encoded = writer.encode();
    size /= 2;
  } while (size >= least && taken + total_bytes(encoded) > bytes);
  std::ranges::move(encoded, std::back_inserter(files));
  return meta;
}

SogSummary sog_summary(const json& meta, const std::string& name) {
  return MetaReader(meta, name).summary();
}

Gaussians decode_sog(const json& meta, const std::map<std::string, Bytes>& files,
                     const std::string& name) {
  return Decoder(meta, files, name).decode();
}

}  // namespace clipgs
