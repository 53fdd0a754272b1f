#include "asset/section_file.h"

#include <cmath>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "asset/checksum.h"
#include "asset/section_slices.h"
#include "core/error.h"
#include "core/file.h"
#include "core/json_reader.h"
#include "section/error_bands.h"
#include "volume/preset.h"

namespace clipgs {

using nlohmann::json;

namespace {

// What readers of an earlier version alone would miss.
constexpr int kPlainVersion = 1;
constexpr int kTonedVersion = 2;  // has a "tone"
constexpr int kVideoVersion = 3;  // may have one, and its slices are frames
constexpr int kMaxSide = 1024;
constexpr float kMostReflectance = 100;
constexpr std::uintmax_t kMaxFile = std::uintmax_t{1} << 30;
constexpr const char* kVoxelsFile = "section.voxels";
constexpr const char* kSectionMetaFile = "section.json";
constexpr const char* kChecksum = "checksum";

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
  if (version != kPlainVersion && version != kTonedVersion && version != kVideoVersion) {
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

/// Of what holds the section's voxels what `files` has of each file: its content, its size.
template <typename What>
const What& find_voxels(const JsonReader& reader, const std::map<std::string, What>& files) {
  const auto found = files.find(reader.text("file"));
  if (found == files.end()) {
    reader.fail("file");
  }
  return found->second;
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
  CodedSlices coded = encode_slices(section, quality, saving);
  const ErrorBands errors = coding_errors(section, coded.voxels);
  json object = describe(section, coded.voxels, errors.on_top_of(section.value_errors));
  object.update(coded.keys);
  if (coded.video) {
    object["version"] = kVideoVersion;
  }
  files.push_back(std::move(coded.file));
  return object;
}

Section decode_section(const json& object, const std::map<std::string, Bytes>& files,
                       const std::string& name) {
  const JsonReader reader(object, name);
  Section section = read_description(reader, name);
  section.voxels =
      decode_slices(reader, find_voxels(reader, files), section.dims, section.channels, name);
  require_checksum(object.value(kChecksum, json()), section.voxels, name);
  return section;
}

SectionInfo section_info(const json& object, const std::map<std::string, size_t>& sizes,
                         const std::string& name) {
  const JsonReader reader(object, name);
  require_version(reader, name);
  return {read_dims(reader), find_voxels(reader, sizes), read_tone(reader.child("lights"), name)};
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
