#include "asset/section_file.h"

#include <cmath>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "asset/checksum.h"
#include "asset/webp.h"
#include "core/error.h"
#include "core/file.h"
#include "core/json_reader.h"
#include "section/error_bands.h"
#include "volume/preset.h"

namespace clipgs {

using nlohmann::json;

namespace {

constexpr int kPlainVersion = 1;
constexpr int kTonedVersion = 2;  // has a "tone", which readers of version 1 alone would miss
constexpr int kMaxSide = 1024;
constexpr float kMostReflectance = 100;
constexpr int kMaxImage = 16383;
constexpr int kSectionBlock =
    16;  // side of the blocks that lossy WebP codes: slices do not share one
constexpr std::uintmax_t kMaxFile = std::uintmax_t{1} << 30;
constexpr const char* kImageFile = "section.webp";
constexpr const char* kVoxelsFile = "section.voxels";
constexpr const char* kSectionMetaFile = "section.json";
constexpr const char* kChecksum = "checksum";

/// How slices lie in the image: row by row, each padded to whole blocks by its last voxels.
struct Mosaic {
  int tile_width;
  int tile_height;
  int columns;
  int rows;

  explicit Mosaic(const IVec3& dims)
      : tile_width(whole_blocks(dims.x)), tile_height(whole_blocks(dims.y)) {
    const double square = std::sqrt(static_cast<double>(dims.z) * tile_height / tile_width);
    columns = std::clamp(static_cast<int>(std::ceil(square)), 1,
                         std::min(dims.z, kMaxImage / tile_width));
    rows = (dims.z + columns - 1) / columns;
  }
  int width() const { return columns * tile_width; }
  int height() const { return rows * tile_height; }

  /// Texel of voxel (x, y) of slice z; x and y may lie in the padding.
  size_t texel(int x, int y, int z) const {
    const size_t row = static_cast<size_t>(z / columns) * tile_height + y;
    return row * width() + static_cast<size_t>(z % columns) * tile_width + x;
  }

 private:
  static int whole_blocks(int n) { return (n + kSectionBlock - 1) / kSectionBlock * kSectionBlock; }
};

Texels to_texels(const Section& section, const Mosaic& mosaic) {
  Texels texels(mosaic.width(), mosaic.height());
  for (int z = 0; z < section.dims.z; ++z) {
    for (int y = 0; y < mosaic.tile_height; ++y) {
      for (int x = 0; x < mosaic.tile_width; ++x) {
        const int from_x = std::min(x, section.dims.x - 1);
        const int from_y = std::min(y, section.dims.y - 1);
        const size_t voxel = section.offset(from_x, from_y, z) * section.channels;
        std::uint8_t* to = &texels.rgba[4 * mosaic.texel(x, y, z)];
        for (int c = 0; c < 3; ++c) {
          to[c] = section.voxels[voxel + (section.channels == 3 ? c : 0)];
        }
      }
    }
  }
  return texels;
}

/// By itself: texels take four times as much as voxels, and decoding takes as much again.
Bytes encode_image(const Section& section, const Mosaic& mosaic, float quality, Saving saving) {
  const Texels texels = to_texels(section, mosaic);
  return quality >= kLossless ? encode_webp(texels, saving)
                              : encode_webp_data(texels, quality, saving);
}

std::vector<std::uint8_t> to_voxels(const Texels& texels, const Mosaic& mosaic, const IVec3& dims,
                                    int channels) {
  std::vector<std::uint8_t> voxels(static_cast<size_t>(dims.x) * dims.y * dims.z * channels);
  std::uint8_t* to = voxels.data();
  for (int z = 0; z < dims.z; ++z) {
    for (int y = 0; y < dims.y; ++y) {
      for (int x = 0; x < dims.x; ++x) {
        const std::uint8_t* from = &texels.rgba[4 * mosaic.texel(x, y, z)];
        for (int c = 0; c < channels; ++c) {
          *to++ = from[c];
        }
      }
    }
  }
  return voxels;
}

/// By how much coding moved the values.
ErrorBands coding_errors(const Section& section, const std::vector<std::uint8_t>& decoded) {
  ErrorBands errors;
  if (section.channels == 1) {
    // A code stands for its value: there are no more than 256² pairs.
    const auto& values = section.curve.values();
    for (size_t i = 0; i < decoded.size(); ++i) {
      const std::uint8_t code = decoded[i];
      if (code >= Section::kFirstInside) {
        errors.add(code, values[code] - values[section.voxels[i]]);
      }
    }
    return errors;
  }
  const auto value = [&](const std::vector<std::uint8_t>& voxels, size_t i) {
    return section.value(Vec3(voxels[i], voxels[i + 1], voxels[i + 2]));
  };
  for (size_t i = 0; i < decoded.size(); i += section.channels) {
    const float told = value(decoded, i);
    const float code = section.curve.code(told);
    if (code >= Section::kFirstInside) {
      errors.add(code, told - value(section.voxels, i));
    }
  }
  return errors;
}

/// Four significant digits are more than a table of colours needs.
json short_number(float value) {
  return std::strtod(fmt::format("{:.4g}", value).c_str(), nullptr);
}

template <typename Get>
json table(const Section& section, const Get& get) {
  json list = json::array();
  for (const FaceMaterial& material : section.materials) {
    list.push_back(short_number(get(material)));
  }
  return list;
}

json materials_json(const Section& section) {
  json result = {{"extinction", table(section, [](const auto& m) { return m.extinction; })},
                 {"specular", table(section, [](const auto& m) { return m.specular; })},
                 {"roughness", table(section, [](const auto& m) { return m.roughness; })}};
  for (int c = 0; c < 3; ++c) {
    const std::string channel(1, "rgb"[c]);
    result["surface_" + channel] = table(section, [&](const auto& m) { return m.surface[c]; });
    result["interior_" + channel] = table(section, [&](const auto& m) { return m.interior[c]; });
  }
  return result;
}

/// What walls look like where values are steep.
json boundary_json(const Section& section) {
  json result = {{"from", json_number(section.steep->from)},
                 {"to", json_number(section.steep->to)}};
  for (int c = 0; c < 3; ++c) {
    result[std::string(1, "rgb"[c])] = table(section, [&](const auto& m) { return m.boundary[c]; });
  }
  return result;
}

json lights_json(const Section& section) {
  json keys = json::array();
  for (const KeyLight& key : section.rig.keys) {
    keys.push_back({{"direction", json_vector(key.direction)},
                    {"radiance", json_vector(key.radiance)},
                    {"angular_radius", json_number(key.angular_radius)}});
  }
  json lights = {{"sky_top", json_vector(section.rig.sky_top)},
                 {"sky_horizon", json_vector(section.rig.sky_horizon)},
                 {"sky_bottom", json_vector(section.rig.sky_bottom)},
                 {"keys", keys},
                 {"exposure", json_number(section.exposure)}};
  if (section.tone != ToneCurve::kSrgb) {
    lights["tone"] = tone_name(section.tone);
  }
  return lights;
}

Vec3 not_negative(const JsonReader& reader, const char* key) {
  const Vec3 value = reader.vector<3>(key);
  if (glm::any(glm::lessThan(value, Vec3(0)))) {
    reader.fail(key);
  }
  return value;
}

Vec3 positive(const JsonReader& reader, const char* key) {
  const Vec3 value = reader.vector<3>(key);
  if (!glm::all(glm::greaterThan(value, Vec3(0)))) {
    reader.fail(key);
  }
  return value;
}

void read_lights(const JsonReader& reader, Section& section) {
  section.rig.sky_top = not_negative(reader, "sky_top");
  section.rig.sky_horizon = not_negative(reader, "sky_horizon");
  section.rig.sky_bottom = not_negative(reader, "sky_bottom");
  for (const JsonReader& key : reader.children("keys", LightRig::kMostKeys)) {
    KeyLight light;
    light.direction = glm::normalize(key.unit_vector("direction"));
    light.radiance = not_negative(key, "radiance");
    light.angular_radius = key.number("angular_radius");
    if (light.angular_radius < 0 || light.angular_radius > 1.6f) {
      key.fail("angular_radius");
    }
    section.rig.keys.push_back(light);
  }
  section.exposure = reader.number("exposure");
  if (!(section.exposure > 0)) {
    reader.fail("exposure");
  }
}

/// Places a table's values, 0…`high`, among the section's materials.
template <typename Place>
void read_table(const JsonReader& reader, const std::string& key, float high, Section& section,
                const Place& place) {
  const std::vector<float> values = reader.numbers(key.c_str(), ValueCurve::kCodes);
  for (size_t i = 0; i < values.size(); ++i) {
    if (values[i] < 0 || values[i] > high) {
      reader.fail(key.c_str());
    }
    place(section.materials[i]) = values[i];
  }
}

void read_materials(const JsonReader& reader, Section& section) {
  const auto fill = [&](const std::string& key, float high, const auto& place) {
    read_table(reader, key, high, section, place);
  };
  constexpr float kMostExtinction = 1e6f;
  fill("extinction", kMostExtinction, [](FaceMaterial& m) -> float& { return m.extinction; });
  fill("specular", 1, [](FaceMaterial& m) -> float& { return m.specular; });
  fill("roughness", 1, [](FaceMaterial& m) -> float& { return m.roughness; });
  for (int c = 0; c < 3; ++c) {
    const std::string channel(1, "rgb"[c]);
    fill("surface_" + channel, kMostReflectance,
         [c](FaceMaterial& m) -> float& { return m.surface[c]; });
    fill("interior_" + channel, kMostReflectance,
         [c](FaceMaterial& m) -> float& { return m.interior[c]; });
  }
}

void read_boundary(const JsonReader& reader, Section& section) {
  section.steep = SteepRange{reader.number("from"), reader.number("to")};
  if (section.steep->from < 0 || !(section.steep->to > section.steep->from)) {
    reader.fail("to");
  }
  for (int c = 0; c < 3; ++c) {
    read_table(reader, std::string(1, "rgb"[c]), kMostReflectance, section,
               [c](FaceMaterial& m) -> float& { return m.boundary[c]; });
  }
}

IVec3 read_dims(const JsonReader& reader) {
  const Vec3 dims = reader.vector<3>("dims");
  for (int k = 0; k < 3; ++k) {
    if (dims[k] < 1 || dims[k] > kMaxSide || dims[k] != std::floor(dims[k])) {
      reader.fail("dims");
    }
  }
  return IVec3(dims);
}

void require_version(const JsonReader& reader, const std::string& name) {
  const float version = reader.number("version");
  if (version != kPlainVersion && version != kTonedVersion) {
    throw Error("{}: is of a version this program does not know; use a newer clipgs", name);
  }
}

/// Absent in sections that are displayed by the sRGB curve alone.
ToneCurve read_tone(const JsonReader& lights, const std::string& name) {
  const std::string tone = lights.has("tone") ? lights.text("tone") : tone_name(ToneCurve::kSrgb);
  const std::optional<ToneCurve> known = tone_of_name(tone);
  if (!known) {
    throw Error(
        "{}: is shown by a tone curve \"{}\" that this program does not know; use a newer "
        "clipgs",
        name, tone);
  }
  return *known;
}

/// Of the section's image what `files` has of each file: its content, its size.
template <typename What>
const What& find_image(const JsonReader& reader, const std::map<std::string, What>& files) {
  const auto image = files.find(reader.text("file"));
  if (image == files.end()) {
    reader.fail("file");
  }
  return image->second;
}

void read_grid(const JsonReader& reader, Section& section) {
  section.dims = read_dims(reader);
  section.spacing = positive(reader, "spacing");
  section.origin = reader.vector<3>("origin");
  section.source_spacing = positive(reader, "source_spacing");
  for (int k = 0; k < 3; ++k) {
    constexpr std::array kNames = {"axis_x", "axis_y", "axis_z"};
    section.direction[k] = glm::normalize(reader.unit_vector(kNames[static_cast<size_t>(k)]));
  }
  if (std::abs(glm::determinant(section.direction) - 1) > 1e-2f) {
    reader.fail("axis_z");
  }
}

/// All but the voxels, where these are to be read back as `voxels` and miss values by so much.
json describe(const Section& section, const std::vector<std::uint8_t>& voxels,
              const std::array<float, Section::kErrorBands>& rms) {
  json errors = json::array();
  for (const float error : rms) {
    errors.push_back(short_number(error));
  }
  json curve = json::array();
  for (const float value : section.curve.values()) {
    curve.push_back(json_number(value));
  }
  json object = {{"version", section.tone == ToneCurve::kSrgb ? kPlainVersion : kTonedVersion},
                 {kChecksum, checksum(voxels)},
                 {"dims", {section.dims.x, section.dims.y, section.dims.z}},
                 {"channels", section.channels},
                 {"spacing", json_vector(section.spacing)},
                 {"origin", json_vector(section.origin)},
                 {"axis_x", json_vector(section.direction[0])},
                 {"axis_y", json_vector(section.direction[1])},
                 {"axis_z", json_vector(section.direction[2])},
                 {"source_spacing", json_vector(section.source_spacing)},
                 {"modality", modality_name(section.modality)},
                 {"curve", curve},
                 {"value_errors", errors},
                 {"materials", materials_json(section)},
                 {"lights", lights_json(section)}};
  if (section.steep) {
    object["boundary"] = boundary_json(section);
  }
  return object;
}

/// All but the voxels.
Section read_description(const JsonReader& reader, const std::string& name) {
  require_version(reader, name);
  Section section;
  read_grid(reader, section);
  section.channels = reader.integer("channels", 1, 3);
  if (section.channels == 2) {
    reader.fail("channels");
  }
  const std::string modality = reader.text("modality");
  for (const Modality known : kModalities) {
    section.modality = modality == modality_name(known) ? known : section.modality;
  }
  try {
    section.curve = ValueCurve(reader.numbers("curve", ValueCurve::kCodes));
  } catch (const Error&) {
    reader.fail("curve");
  }
  const std::vector<float> errors = reader.numbers("value_errors", Section::kErrorBands);
  for (size_t i = 0; i < errors.size(); ++i) {
    if (errors[i] < 0) {
      reader.fail("value_errors");
    }
    section.value_errors[i] = errors[i];
  }
  read_materials(reader.child("materials"), section);
  if (reader.has("boundary")) {
    read_boundary(reader.child("boundary"), section);
  }
  read_lights(reader.child("lights"), section);
  section.tone = read_tone(reader.child("lights"), name);
  return section;
}

}  // namespace

json encode_section(const Section& section, float quality, std::vector<ZipEntry>& files,
                    Saving saving) {
  const Mosaic mosaic(section.dims);
  if (mosaic.width() > kMaxImage || mosaic.height() > kMaxImage) {
    throw Error("a section of {} × {} × {} voxels does not fit into an image; make it smaller",
                section.dims.x, section.dims.y, section.dims.z);
  }
  Bytes image = encode_image(section, mosaic, quality, saving);
  const std::vector<std::uint8_t> decoded =
      to_voxels(decode_webp(image, mosaic.width(), mosaic.height(), kImageFile), mosaic,
                section.dims, section.channels);
  json object =
      describe(section, decoded, coding_errors(section, decoded).on_top_of(section.value_errors));
  object["file"] = kImageFile;
  object["tile"] = {mosaic.tile_width, mosaic.tile_height};
  object["columns"] = mosaic.columns;
  files.push_back({kImageFile, std::move(image)});
  return object;
}

Section decode_section(const json& object, const std::map<std::string, Bytes>& files,
                       const std::string& name) {
  const JsonReader reader(object, name);
  Section section = read_description(reader, name);
  const Mosaic mosaic(section.dims);
  if (reader.integer("columns", 1, kMaxImage) != mosaic.columns) {
    reader.fail("columns");
  }
  if (reader.vector<2>("tile") != Vec2(mosaic.tile_width, mosaic.tile_height)) {
    reader.fail("tile");
  }
  const Texels texels =
      decode_webp(find_image(reader, files), mosaic.width(), mosaic.height(), name + ": its image");
  section.voxels = to_voxels(texels, mosaic, section.dims, section.channels);
  require_checksum(object.value(kChecksum, json()), section.voxels, name);
  return section;
}

SectionInfo section_info(const json& object, const std::map<std::string, size_t>& sizes,
                         const std::string& name) {
  const JsonReader reader(object, name);
  require_version(reader, name);
  return {read_dims(reader), find_image(reader, sizes), read_tone(reader.child("lights"), name)};
}

std::filesystem::path section_path(std::filesystem::path scene) {
  return scene.replace_extension(".section.zip");
}

void write_section(const std::filesystem::path& path, const Section& section) {
  const std::string text = describe(section, section.voxels, section.value_errors).dump();
  const Bytes bytes = write_zip(
      {{kVoxelsFile, section.voxels}, {kSectionMetaFile, Bytes(text.begin(), text.end())}});
  write_file(path, bytes.data(), bytes.size());
}

Section read_section(const std::filesystem::path& path) {
  const std::string name = path.string();
  std::map<std::string, Bytes> files = read_zip(read_file(path, kMaxFile), name);
  const auto meta = files.find(kSectionMetaFile);
  const auto voxels = files.find(kVoxelsFile);
  if (meta == files.end() || voxels == files.end()) {
    throw Error("{}: has no {} or no {}; make it again", name, kSectionMetaFile, kVoxelsFile);
  }
  const json object = json::parse(meta->second.begin(), meta->second.end(), nullptr, false);
  const JsonReader reader(object, name);
  Section section = read_description(reader, name);
  if (voxels->second.size() != section.voxel_count() * section.channels) {
    throw Error("{}: its {} is {} bytes long, not {}; make it again", name, kVoxelsFile,
                voxels->second.size(), section.voxel_count() * section.channels);
  }
  section.voxels = std::move(voxels->second);
  require_checksum(object.value(kChecksum, json()), section.voxels, name);
  return section;
}

}  // namespace clipgs
