#include "asset/glb.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <fmt/format.h>
#include <limits>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/json_reader.h"
#include "core/version.h"
#include "splat/similarity.h"
#include "splat/y_up.h"

namespace clipgs {

using nlohmann::json;

namespace {

constexpr std::uint32_t kMagic = 0x46546c67;      // "glTF"
constexpr std::uint32_t kJsonChunk = 0x4e4f534a;  // "JSON"
constexpr std::uint32_t kBinaryChunk = 0x004e4942;
constexpr int kFloat = 5126;
constexpr int kByte = 5121;
constexpr int kVertices = 34962;  // what a buffer view is for
constexpr size_t kAligned = 4;
constexpr const char* kExtension = "KHR_gaussian_splatting";

/// The binary part, and what says where its attributes are.
class Attributes {
 public:
  explicit Attributes(size_t count) : count_(count) {}

  /// One of `components` floats a splat: value(i, component).
  template <typename Value>
  json& add(const std::string& name, size_t components, const Value& value) {
    constexpr std::array kTypes = {"", "SCALAR", "", "VEC3", "VEC4"};
    json& accessor = begin(name, kFloat, kTypes[components]);
    for (size_t i = 0; i < count_; ++i) {
      for (size_t c = 0; c < components; ++c) {
        const float number = value(i, c);
        const auto* const raw = reinterpret_cast<const std::uint8_t*>(&number);
        bytes.insert(bytes.end(), raw, raw + sizeof(float));
      }
    }
    end();
    return accessor;
  }

  /// The colours of points, RGBA, bytes.
  template <typename Value>
  void add_colors(const Value& value) {
    begin("COLOR_0", kByte, "VEC4")["normalized"] = true;
    for (size_t i = 0; i < count_; ++i) {
      for (size_t c = 0; c < 4; ++c) {
        const float level = std::clamp(value(i, c), 0.0f, 1.0f);
        bytes.push_back(static_cast<std::uint8_t>(std::lround(255 * level)));
      }
    }
    end();
  }

  Bytes bytes;
  json views = json::array();
  json accessors = json::array();
  json names = json::object();

 private:
  json& begin(const std::string& name, int component, const char* type) {
    names[name] = accessors.size();
    views.push_back({{"buffer", 0}, {"byteOffset", bytes.size()}, {"target", kVertices}});
    accessors.push_back({{"bufferView", accessors.size()},
                         {"componentType", component},
                         {"count", count_},
                         {"type", type}});
    return accessors.back();
  }
  void end() {
    const auto begin = views.back()["byteOffset"].get<size_t>();
    views.back()["byteLength"] = bytes.size() - begin;
  }

  size_t count_;
};

void add_places(const Gaussians& gaussians, Attributes& attributes) {
  json& places = attributes.add("POSITION", 3, [&](size_t i, size_t c) {
    return gaussians.plane(Gaussians::kMean + static_cast<int>(c))[i];
  });
  Vec3 low(std::numeric_limits<float>::max());
  Vec3 high(std::numeric_limits<float>::lowest());
  for (size_t i = 0; i < gaussians.size(); ++i) {
    low = glm::min(low, gaussians.mean(i));
    high = glm::max(high, gaussians.mean(i));
  }
  places["min"] = json_vector(low);
  places["max"] = json_vector(high);
}

std::string attribute(const std::string& name) { return std::string(kExtension) + ":" + name; }

Attributes attributes_of(const Gaussians& gaussians) {
  Attributes attributes(gaussians.size());
  add_places(gaussians, attributes);
  attributes.add_colors([&](size_t i, size_t c) {
    return c == 3 ? gaussians.opacity(i)
                  : 0.5f + kShBand0 * gaussians.plane(Gaussians::kSh + static_cast<int>(c))[i];
  });
  attributes.add(attribute("ROTATION"), 4, [&](size_t i, size_t c) {
    const Quat q = gaussians.rotation(i);
    return std::array{q.x, q.y, q.z, q.w}[c];
  });
  attributes.add(attribute("SCALE"), 3,
                 [&](size_t i, size_t c) { return gaussians.scale(i)[static_cast<int>(c)]; });
  attributes.add(attribute("OPACITY"), 1, [&](size_t i, size_t) { return gaussians.opacity(i); });
  for (int degree = 0, k = 0; degree <= gaussians.sh_degree(); ++degree) {
    for (int m = 0; m < 2 * degree + 1; ++m, ++k) {
      attributes.add(attribute(fmt::format("SH_DEGREE_{}_COEF_{}", degree, m)), 3,
                     [&](size_t i, size_t c) {
                       return gaussians.plane(Gaussians::kSh + 3 * k + static_cast<int>(c))[i];
                     });
    }
  }
  return attributes;
}

void append(Bytes& file, std::uint32_t value) {
  const auto* const raw = reinterpret_cast<const std::uint8_t*>(&value);
  file.insert(file.end(), raw, raw + sizeof(value));
}

void append_chunk(Bytes& file, std::uint32_t type, Bytes content, std::uint8_t padding) {
  content.resize((content.size() + kAligned - 1) / kAligned * kAligned, padding);
  append(file, static_cast<std::uint32_t>(content.size()));
  append(file, type);
  file.insert(file.end(), content.begin(), content.end());
}

}  // namespace

Bytes encode_glb(const Gaussians& scene) {
  Attributes attributes = attributes_of(transform(scene, y_up()));
  if (attributes.bytes.size() > std::numeric_limits<std::uint32_t>::max() / 2) {
    throw Error("a glTF of {} splats would be too large; export as .ply", scene.size());
  }
  const json splats = {{"kernel", "ellipse"},
                       {"colorSpace", "srgb_rec709_display"},
                       {"sortingMethod", "cameraDistance"},
                       {"projection", "perspective"}};
  const json primitive = {{"attributes", attributes.names},
                          {"mode", 0},  // points
                          {"extensions", {{kExtension, splats}}}};
  const json document = {
      {"asset", {{"version", "2.0"}, {"generator", fmt::format("clipgs {}", program_version())}}},
      {"extensionsUsed", {kExtension}},
      {"scene", 0},
      {"scenes", {{{"nodes", {0}}}}},
      {"nodes", {{{"mesh", 0}}}},
      {"meshes", {{{"primitives", {primitive}}}}},
      {"accessors", attributes.accessors},
      {"bufferViews", attributes.views},
      {"buffers", {{{"byteLength", attributes.bytes.size()}}}}};
  const std::string text = document.dump();
  Bytes file;
  constexpr std::uint32_t kVersion = 2;
  append(file, kMagic);
  append(file, kVersion);
  append(file, 0);  // the length, known at the end
  append_chunk(file, kJsonChunk, Bytes(text.begin(), text.end()), ' ');
  append_chunk(file, kBinaryChunk, std::move(attributes.bytes), 0);
  const auto length = static_cast<std::uint32_t>(file.size());
  std::memcpy(&file[8], &length, sizeof(length));
  return file;
}

}  // namespace clipgs
