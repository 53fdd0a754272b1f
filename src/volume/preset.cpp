#include "volume/preset.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>
#include <numbers>
#include <optional>
#include <set>
#include <span>
#include <sstream>
#include <string_view>

#include "core/error.h"
#include "core/file.h"
#include "core/image.h"
#include "volume/built_in_files.h"
#include "volume/histogram.h"

namespace clipgs {
namespace {

using nlohmann::json;

constexpr float kRadiansPerDegree = 0.017453293f;

/// Reads one JSON object and refuses keys that nothing asked for: a misspelt key must not be
/// silently ignored.
class Reader {
 public:
  Reader(const json& object, std::string where) : object_(object), where_(std::move(where)) {
    if (!object_.is_object()) {
      throw Error("{}: expected an object {{...}}", where_);
    }
  }

  const json* find(const std::string& key) {
    known_.insert(key);
    const auto it = object_.find(key);
    return it == object_.end() ? nullptr : &*it;
  }

  const json& get(const std::string& key) {
    const json* value = find(key);
    if (value == nullptr) {
      throw Error("{}: \"{}\" is missing", where_, key);
    }
    return *value;
  }

  const json& list(const std::string& key) {
    const json& value = get(key);
    if (!value.is_array()) {
      throw Error("{}: \"{}\" must be a list", where_, key);
    }
    return value;
  }

  float number(const std::string& key) { return number(get(key), key); }
  float number(const std::string& key, float otherwise) {
    const json* value = find(key);
    return value == nullptr ? otherwise : number(*value, key);
  }

  std::string text(const std::string& key, const std::string& otherwise) {
    const json* value = find(key);
    if (value == nullptr) {
      return otherwise;
    }
    if (!value->is_string()) {
      throw Error("{}: \"{}\" must be a string", where_, key);
    }
    return value->get<std::string>();
  }

  bool flag(const std::string& key, bool otherwise) {
    const json* value = find(key);
    if (value != nullptr && !value->is_boolean()) {
      throw Error("{}: \"{}\" must be true or false", where_, key);
    }
    return value == nullptr ? otherwise : value->get<bool>();
  }

  Vec3 vector(const std::string& key) { return vector(get(key), key); }

  /// "#rrggbb" or [r, g, b] in 0…1, both sRGB, as linear RGB.
  Vec3 color(const std::string& key) {
    const json& value = get(key);
    Vec3 srgb;
    if (value.is_string()) {
      srgb = parse_hex(value.get<std::string>(), key);
    } else {
      srgb = vector(value, key);
    }
    if (glm::any(glm::lessThan(srgb, Vec3(0))) || glm::any(glm::greaterThan(srgb, Vec3(1)))) {
      throw Error("{}: \"{}\" must lie in 0..1", where_, key);
    }
    return {linear_from_srgb(srgb.r), linear_from_srgb(srgb.g), linear_from_srgb(srgb.b)};
  }

  void refuse_unknown_keys() const {
    for (const auto& [key, value] : object_.items()) {
      if (!known_.contains(key)) {
        throw Error("{}: unknown key \"{}\"; known here: {}", where_, key, fmt::join(known_, ", "));
      }
    }
  }

  const std::string& where() const { return where_; }

 private:
  float number(const json& value, const std::string& key) const {
    if (!value.is_number() || !std::isfinite(value.get<float>())) {
      throw Error("{}: \"{}\" must be a finite number", where_, key);
    }
    return value.get<float>();
  }

  Vec3 vector(const json& value, const std::string& key) const {
    if (!value.is_array() || value.size() != 3) {
      throw Error("{}: \"{}\" must be a list of three numbers", where_, key);
    }
    return {number(value[0], key), number(value[1], key), number(value[2], key)};
  }

  Vec3 parse_hex(const std::string& text, const std::string& key) const {
    const bool hex = text.size() == 7 && text[0] == '#' &&
                     text.find_first_not_of("0123456789abcdefABCDEF", 1) == std::string::npos;
    if (!hex) {
      throw Error(R"({}: "{}" must be "#rrggbb" or [r, g, b])", where_, key);
    }
    const auto channel = [&](size_t at) {
      return static_cast<float>(std::stoi(text.substr(at, 2), nullptr, 16)) / 255.0f;
    };
    return {channel(1), channel(3), channel(5)};
  }

  const json& object_;
  std::string where_;
  std::set<std::string> known_;
};

Modality parse_modality(const std::string& text, const std::string& where) {
  if (text == "ct") return Modality::kCt;
  if (text == "mr") return Modality::kMr;
  if (text == "photo") return Modality::kPhoto;
  if (text == "any") return Modality::kUnknown;
  throw Error("{}: modality \"{}\" is none of ct, mr, photo, any", where, text);
}

ValueUnits parse_units(const std::string& text, const std::string& where) {
  if (text == "hu" || text == "stored") return ValueUnits::kStored;
  if (text == "percentile") return ValueUnits::kPercentile;
  throw Error("{}: units \"{}\" are none of hu, stored, percentile", where, text);
}

/// `phase`: of a point that has none of its own.
TransferPoint parse_point(const json& object, const std::string& where, float phase) {
  Reader reader(object, where);
  TransferPoint point;
  point.value = reader.number("value");
  point.material.albedo = reader.color("color");
  point.material.extinction = reader.number("extinction");
  point.material.specular = reader.number("specular", 0);
  point.material.roughness = reader.number("roughness", 0.5f);
  point.material.phase = reader.number("phase", phase);
  reader.refuse_unknown_keys();
  return point;
}

GradientOpacity parse_gradient_opacity(const json& object, const std::string& where) {
  Reader reader(object, where);
  const GradientOpacity result{reader.number("from"), reader.number("to"),
                               reader.number("floor", 0)};
  if (!result.valid()) {
    throw Error("{}: needs 0 <= from < to, and floor in 0..1", where);
  }
  reader.refuse_unknown_keys();
  return result;
}

/// {"color": ..., "intensity": ...} as linear radiance.
Vec3 parse_radiance(Reader& reader) {
  const float intensity = reader.number("intensity", 1);
  if (intensity < 0) {
    throw Error("{}: \"intensity\" must not be negative", reader.where());
  }
  return reader.color("color") * intensity;
}

Vec3 parse_sky(const json& object, const std::string& where) {
  Reader reader(object, where);
  const Vec3 radiance = parse_radiance(reader);
  reader.refuse_unknown_keys();
  return radiance;
}

KeyLight parse_key(const json& object, const std::string& where) {
  Reader reader(object, where);
  KeyLight key;
  key.direction = reader.vector("direction");
  const float length = glm::length(key.direction);
  if (length == 0) {
    throw Error("{}: \"direction\" must not be zero", where);
  }
  key.direction /= length;
  key.radiance = parse_radiance(reader);
  const float degrees = reader.number("angular_radius_deg", 5);
  if (degrees < 0 || degrees > 89) {
    throw Error("{}: \"angular_radius_deg\" must lie in 0..89", where);
  }
  key.angular_radius = degrees * kRadiansPerDegree;
  key.distance = reader.number("distance", 0);
  if (key.distance != 0 && key.distance <= 1) {
    throw Error("{}: \"distance\" must be greater than 1 (or 0: infinitely far)", where);
  }
  reader.refuse_unknown_keys();
  return key;
}

// {"file": ..., "intensity": ..., "turn_deg": ...}; the file lies beside the rig's.
void parse_environment(const json& object, const std::string& where, LightRig& rig) {
  Reader reader(object, where + ": environment");
  const std::filesystem::path file =
      std::filesystem::path(where).parent_path() / reader.text("file", "");
  const float intensity = reader.number("intensity", 1);
  if (intensity < 0) {
    throw Error("{}: \"intensity\" must not be negative", reader.where());
  }
  rig.environment_turn = reader.number("turn_deg", 0) * kRadiansPerDegree;
  reader.refuse_unknown_keys();
  Image panorama = read_hdr(file);
  for (float& value : panorama.data) {
    value *= intensity;
  }
  rig.environment = std::make_shared<const Image>(std::move(panorama));
}

LightRig parse_rig(const json& object, const std::string& where) {
  Reader reader(object, where);
  reader.text("title", "");
  reader.text("description", "");
  Reader sky(reader.get("sky"), where + ": sky");
  LightRig rig;
  rig.sky_top = parse_sky(sky.get("top"), where + ": sky top");
  rig.sky_horizon = parse_sky(sky.get("horizon"), where + ": sky horizon");
  rig.sky_bottom = parse_sky(sky.get("bottom"), where + ": sky bottom");
  sky.refuse_unknown_keys();
  const json& keys = reader.list("keys");
  for (size_t i = 0; i < keys.size(); ++i) {
    rig.keys.push_back(parse_key(keys[i], fmt::format("{}: key light {}", where, i + 1)));
  }
  if (object.contains("environment")) {
    parse_environment(reader.get("environment"), where, rig);
  }
  reader.refuse_unknown_keys();
  return rig;
}

json parse_json(const std::string& text, const std::string& where) {
  try {
    return json::parse(text, nullptr, true, /*ignore_comments=*/true);
  } catch (const json::parse_error& e) {
    throw Error("{}: not JSON (near byte {})", where, e.byte);
  }
}

std::vector<std::string> names_of(std::span<const BuiltInFile> files) {
  std::vector<std::string> names;
  for (const BuiltInFile& file : files) {
    names.emplace_back(file.name);
  }
  return names;
}

/// A file's text, and its name in errors.
struct Source {
  std::string text;
  std::string where;
};

/// One of the built-in files by name, or a JSON file by path; `kind` names it in errors.
std::optional<Source> find_source(std::span<const BuiltInFile> files, const std::string& kind,
                                  const std::string& name_or_path) {
  for (const BuiltInFile& file : files) {
    if (file.name == name_or_path) {
      return Source{std::string(file.json), fmt::format("{} {}", kind, name_or_path)};
    }
  }
  const std::filesystem::path path(name_or_path);
  std::error_code ignored;
  if (path.extension() == ".json" && std::filesystem::is_regular_file(path, ignored)) {
    return Source{read_text(path), name_or_path};
  }
  return std::nullopt;
}

Preset read_preset(const json& object, const std::string& name, const std::string& where) {
  Reader reader(object, where);
  Preset preset;
  preset.name = name;
  preset.title = reader.text("title", name);
  preset.description = reader.text("description", "");
  preset.modality = parse_modality(reader.text("modality", "any"), where);
  preset.units = parse_units(reader.text("units", "hu"), where);
  preset.surface_strength = reader.number("surface_strength");
  const float phase = reader.number("phase_g", 0);
  if (const json* const found = reader.find("gradient_opacity")) {
    preset.gradient_opacity = parse_gradient_opacity(*found, where + ": gradient_opacity");
  }
  preset.exposure = reader.number("exposure", 1);
  if (preset.surface_strength < 0 || preset.exposure <= 0 || std::abs(phase) >= 1) {
    throw Error("{}: surface_strength must be >= 0, exposure > 0 and |phase_g| < 1", where);
  }

  std::vector<TransferPoint> points;
  const json& list = reader.list("points");
  for (size_t i = 0; i < list.size(); ++i) {
    points.push_back(parse_point(list[i], fmt::format("{}: point {}", where, i + 1), phase));
    const float value = points.back().value;
    if (preset.units == ValueUnits::kPercentile && (value < 0 || value > 100)) {
      throw Error("{}: point {}: a percentile must lie in 0..100", where, i + 1);
    }
  }
  try {
    preset.transfer = TransferFunction(std::move(points));
  } catch (const Error& e) {
    throw Error("{}: {}", where, e.what());
  }
  const json& lights = reader.get("lights");
  preset.rig = lights.is_string() ? load_rig(lights.get<std::string>())
                                  : parse_rig(lights, where + ": lights");
  reader.refuse_unknown_keys();
  return preset;
}

// A panorama alone. Files of this kind come in any unit: its mean is made `studio`'s.
LightRig rig_of_panorama(const std::filesystem::path& path) {
  constexpr double kMean = 0.6;
  Image panorama = read_hdr(path);
  double sum = 0;
  double weights = 0;
  for (int y = 0; y < panorama.height; ++y) {
    const double weight = std::sin(std::numbers::pi * (y + 0.5) / panorama.height);
    for (int x = 0; x < panorama.width; ++x) {
      const float* pixel = panorama.at(x, y);
      sum += weight * static_cast<double>(pixel[0] + pixel[1] + pixel[2]) / 3;
      weights += weight;
    }
  }
  if (sum <= 0) {
    throw Error("{}: the panorama is black", path.string());
  }
  const auto scale = static_cast<float>(kMean * weights / sum);
  for (float& value : panorama.data) {
    value *= scale;
  }
  LightRig rig{Vec3(0), Vec3(0), Vec3(0), {}};
  rig.environment = std::make_shared<const Image>(std::move(panorama));
  return rig;
}

std::pair<int, LabelLook> parse_label(const json& object, const std::string& where) {
  Reader reader(object, where);
  const float number = reader.number("label");
  if (number != std::trunc(number) || std::abs(number) > 0x1p24f) {
    throw Error("{}: \"label\" must be a whole number", where);
  }
  LabelLook look;
  reader.text("name", "");  // for people
  if (reader.find("color") != nullptr) {
    look.albedo = reader.color("color");
  }
  look.opacity = reader.number("opacity", 1);
  if (look.opacity < 0 || look.opacity > 1) {
    throw Error("{}: \"opacity\" must lie in 0..1", where);
  }
  if (!reader.flag("visible", true)) {
    look.opacity = 0;
  }
  reader.refuse_unknown_keys();
  return {static_cast<int>(number), look};
}

/// A number that is all of the text.
template <typename Number>
std::optional<Number> parse_number(std::string_view text) {
  Number number{};
  const char* const begin = text.data();
  const char* const end = begin + text.size();
  const auto [stop, error] = std::from_chars(begin, end, number);
  return error == std::errc() && stop == end ? std::optional(number) : std::nullopt;
}

}  // namespace

std::pair<int, LabelLook> parse_label(const std::string& text) {
  const size_t equals = std::min(text.find('='), text.size());
  const std::optional<int> number = parse_number<int>(std::string_view(text).substr(0, equals));
  json object = {{"label", number.value_or(0)}};
  bool understood = number && equals < text.size();
  std::istringstream parts(text.substr(std::min(equals + 1, text.size())));
  for (std::string part; understood && std::getline(parts, part, ',');) {
    const std::optional<float> opacity = parse_number<float>(part);
    const char* const key = part == "hidden"        ? "visible"
                            : part.starts_with('#') ? "color"
                                                    : "opacity";
    understood = !object.contains(key) && (opacity || key != std::string_view("opacity"));
    object[key] = part == "hidden" ? json(false) : opacity ? json(*opacity) : json(part);
  }
  if (!understood || object.size() == 1) {
    throw Error("label \"{}\": write N=#rrggbb, N=OPACITY, N=#rrggbb,OPACITY or N=hidden", text);
  }
  return parse_label(object, fmt::format("label \"{}\"", text));
}

LabelLooks load_label_table(const std::filesystem::path& path) {
  const std::string where = path.string();
  const json table = parse_json(read_text(path), where);
  Reader reader(table, where);
  const json& list = reader.list("labels");
  LabelLooks looks;
  for (size_t i = 0; i < list.size(); ++i) {
    const auto [number, look] = parse_label(list[i], fmt::format("{}: entry {}", where, i + 1));
    if (!looks.emplace(number, look).second) {
      throw Error("{}: label {} is there twice", where, number);
    }
  }
  reader.refuse_unknown_keys();
  return looks;
}

std::vector<std::string> rig_names() { return names_of(built_in_rigs()); }

LightRig load_rig(const std::string& name_or_path) {
  if (std::filesystem::path(name_or_path).extension() == ".hdr") {
    return rig_of_panorama(name_or_path);
  }
  const std::optional<Source> source = find_source(built_in_rigs(), "rig", name_or_path);
  if (!source) {
    throw Error("no light rig \"{}\": use one of {}, or the path of a .json or .hdr file",
                name_or_path, fmt::join(rig_names(), ", "));
  }
  return parse_rig(parse_json(source->text, source->where), source->where);
}

Preset parse_preset(const std::string& text, const std::string& name, const std::string& where) {
  return read_preset(parse_json(text, where), name, where);
}

std::vector<std::string> preset_names() { return names_of(built_in_presets()); }

Preset load_preset(const std::string& name_or_path) {
  const std::optional<Source> source = find_source(built_in_presets(), "preset", name_or_path);
  if (!source) {
    throw Error("no preset \"{}\": use auto, one of {}, or the path of a .json file", name_or_path,
                fmt::join(preset_names(), ", "));
  }
  return parse_preset(source->text, std::filesystem::path(name_or_path).stem().string(),
                      source->where);
}

Preset load_preset(const std::string& name, const Volume& volume) {
  if (name == "auto") {
    return choose_preset(volume);
  }
  Preset preset = load_preset(name);
  resolve_percentiles(preset, volume);
  return preset;
}

void resolve_percentiles(Preset& preset, const Volume& volume) {
  if (preset.units != ValueUnits::kPercentile) {
    return;
  }
  const Histogram h = histogram(volume);
  const float threshold = otsu_threshold(h);
  std::vector<TransferPoint> points = preset.transfer.points();
  for (TransferPoint& point : points) {
    point.value = h.quantile(point.value / 100, threshold);
  }
  preset.transfer = TransferFunction(std::move(points));
  const float range = h.quantile(0.99f, threshold) - h.quantile(0.01f, threshold);
  preset.surface_strength /= std::max(range, 1e-6f);
  if (preset.gradient_opacity) {
    preset.gradient_opacity->from *= std::max(range, 1e-6f);
    preset.gradient_opacity->to *= std::max(range, 1e-6f);
  }
  preset.units = ValueUnits::kStored;
}

}  // namespace clipgs
