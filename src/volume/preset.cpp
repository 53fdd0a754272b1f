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

/// What a number may be, both ends included, and its unit in errors. docs/presets.md lists them.
struct Range {
  float low, high;
  const char* unit = "";
};
constexpr Range kAny = {-1e9f, 1e9f};
constexpr Range kShare = {0, 1};
/// Denser matter is opaque within hundredths of any voxel, and delta tracking takes a step per free
/// path: beyond, pictures would take for ever.
constexpr Range kExtinction = {0, 100, " 1/mm"};
constexpr Range kRoughness = {0.01f, 1};  // sharper lobes leave the range of floats
constexpr Range kPhase = {-0.99f, 0.99f};
constexpr Range kSurfaceStrength = {0, 1e6f};
constexpr Range kSteepness = {0, 1e9f, " per mm"};
constexpr Range kExposure = {Preset::kLeastExposure, Preset::kMostExposure};
constexpr Range kIntensity = {0, 1e4f};
constexpr Range kAngularRadius = {0, 89, " degrees"};
constexpr Range kDistance = {0, 1000, " half diagonals"};
constexpr Range kTurn = {-360, 360, " degrees"};
constexpr Range kPercentile = {0, 100};
constexpr Range kLabel = {-0x1p24f, 0x1p24f};
constexpr size_t kMostPoints = 1000;
constexpr size_t kMostLooks = 100000;
constexpr float kBrightest = 1e10f;  // radiance of a panorama
constexpr float kBlack = 1e-20f;     // less in all of it cannot be made bright

/// Reads one JSON object and refuses keys that nothing asked for: a misspelt key must not be
/// silently ignored. Errors name the file and the path of the key in it.
class Reader {
 public:
  Reader(const json& object, std::string file, std::string path = "")
      : object_(object), file_(std::move(file)), path_(std::move(path)) {
    if (!object_.is_object()) {
      throw Error("{}: expected an object {{...}}", where());
    }
  }

  /// Of the object that a key holds.
  Reader child(const std::string& key) { return {get(key), file_, path_of(key)}; }
  /// Of the objects that a key lists.
  std::vector<Reader> children(const std::string& key, size_t most) {
    const json& values = get(key);
    if (!values.is_array()) {
      fail(key, "must be a list");
    }
    if (values.size() > most) {
      fail(key, "holds {} entries, at most {}", values.size(), most);
    }
    std::vector<Reader> result;
    result.reserve(values.size());
    for (size_t i = 0; i < values.size(); ++i) {
      result.emplace_back(values[i], file_, fmt::format("{}[{}]", path_of(key), i));
    }
    return result;
  }

  const json* find(const std::string& key) {
    known_.insert(key);
    const auto it = object_.find(key);
    return it == object_.end() ? nullptr : &*it;
  }

  const json& get(const std::string& key) {
    const json* value = find(key);
    if (value == nullptr) {
      fail(key, "is missing");
    }
    return *value;
  }

  float number(const std::string& key, const Range& range) { return number(get(key), key, range); }
  float number(const std::string& key, const Range& range, float otherwise) {
    const json* value = find(key);
    return value == nullptr ? otherwise : number(*value, key, range);
  }

  std::string text(const std::string& key, const std::string& otherwise) {
    const json* value = find(key);
    if (value == nullptr) {
      return otherwise;
    }
    if (!value->is_string()) {
      fail(key, "must be a string");
    }
    return value->get<std::string>();
  }

  bool flag(const std::string& key, bool otherwise) {
    const json* value = find(key);
    if (value != nullptr && !value->is_boolean()) {
      fail(key, "must be true or false");
    }
    return value == nullptr ? otherwise : value->get<bool>();
  }

  Vec3 vector(const std::string& key, const Range& range) { return vector(get(key), key, range); }

  /// "#rrggbb" or [r, g, b] in 0…1, both sRGB, as linear RGB.
  Vec3 color(const std::string& key) {
    const json& value = get(key);
    const Vec3 srgb =
        value.is_string() ? parse_hex(value.get<std::string>(), key) : vector(value, key, kShare);
    return {linear_from_srgb(srgb.r), linear_from_srgb(srgb.g), linear_from_srgb(srgb.b)};
  }

  void refuse_unknown_keys() const {
    for (const auto& [key, value] : object_.items()) {
      if (!known_.contains(key)) {
        throw Error(
            "{}: unknown key \"{}\": misspelt, or made for a newer version of clipgs; known here: "
            "{}",
            where(), key, fmt::join(known_, ", "));
      }
    }
  }

  std::string where() const { return path_.empty() ? file_ : file_ + ": " + path_; }
  const std::string& file() const { return file_; }

  /// Throws Error: what of the key is wrong, e.g. "is 7, at most 5".
  template <typename... Args>
  [[noreturn]] void fail(const std::string& key, fmt::format_string<Args...> what,
                         Args&&... args) const {
    throw Error("{}: {} {}", file_, path_of(key), fmt::format(what, std::forward<Args>(args)...));
  }

 private:
  std::string path_of(const std::string& key) const {
    return path_.empty() ? key : path_ + "." + key;
  }

  float number(const json& value, const std::string& key, const Range& range) const {
    if (!value.is_number() || !std::isfinite(value.get<double>())) {
      fail(key, "must be a finite number");
    }
    const auto number = value.get<double>();
    if (number < static_cast<double>(range.low)) {
      fail(key, "is {:g}, at least {:g}{}", number, range.low, range.unit);
    }
    if (number > static_cast<double>(range.high)) {
      fail(key, "is {:g}, at most {:g}{}", number, range.high, range.unit);
    }
    return static_cast<float>(number);
  }

  Vec3 vector(const json& value, const std::string& key, const Range& range) const {
    if (!value.is_array() || value.size() != 3) {
      fail(key, "must be a list of three numbers");
    }
    return {number(value[0], key, range), number(value[1], key, range),
            number(value[2], key, range)};
  }

  Vec3 parse_hex(const std::string& text, const std::string& key) const {
    const bool hex = text.size() == 7 && text[0] == '#' &&
                     text.find_first_not_of("0123456789abcdefABCDEF", 1) == std::string::npos;
    if (!hex) {
      fail(key, R"(must be "#rrggbb" or [r, g, b])");
    }
    const auto channel = [&](size_t at) {
      return static_cast<float>(std::stoi(text.substr(at, 2), nullptr, 16)) / 255.0f;
    };
    return {channel(1), channel(3), channel(5)};
  }

  const json& object_;
  std::string file_;
  std::string path_;  // of the object in the file
  std::set<std::string> known_;
};

Modality parse_modality(const std::string& text, const std::string& where) {
  const std::optional<Modality> known = text == "any" ? Modality::kUnknown : modality_of_word(text);
  if (!known) {
    throw Error("{}: modality \"{}\" is none of {}, any", where, text, modality_words());
  }
  return *known;
}

ValueUnits parse_units(const std::string& text, const std::string& where) {
  if (text == "hu" || text == "stored") return ValueUnits::kStored;
  if (text == "percentile") return ValueUnits::kPercentile;
  if (text == "percentile-of-all") return ValueUnits::kPercentileOfAll;
  throw Error("{}: units \"{}\" are none of hu, stored, percentile, percentile-of-all", where,
              text);
}

ToneCurve parse_tone(const std::string& text, const std::string& where) {
  const std::optional<ToneCurve> known = tone_of_name(text);
  if (!known) {
    throw Error("{}: tone \"{}\" is none of {}", where, text, tone_names());
  }
  return *known;
}

/// `phase`: of a point that has none of its own.
TransferPoint parse_point(Reader reader, ValueUnits units, float phase) {
  TransferPoint point;
  point.value = reader.number("value", units == ValueUnits::kStored ? kAny : kPercentile);
  point.material.albedo = reader.color("color");
  point.material.extinction = reader.number("extinction", kExtinction);
  point.material.specular = reader.number("specular", kShare, 0);
  point.material.roughness = reader.number("roughness", kRoughness, 0.5f);
  point.material.phase = reader.number("phase", kPhase, phase);
  reader.refuse_unknown_keys();
  return point;
}

GradientOpacity parse_gradient_opacity(Reader reader) {
  const GradientOpacity result{reader.number("from", kSteepness), reader.number("to", kSteepness),
                               reader.number("floor", kShare, 0)};
  if (!result.valid()) {
    reader.fail("to", "is {:g}, which must be more than \"from\"", result.to);
  }
  reader.refuse_unknown_keys();
  return result;
}

/// A point of a boundary's curve. It has no extinction of its own.
TransferPoint parse_boundary_point(Reader reader, ValueUnits units) {
  TransferPoint point;
  point.value = reader.number("value", units == ValueUnits::kStored ? kAny : kPercentile);
  point.material.albedo = reader.color("color");
  point.material.specular = reader.number("specular", kShare, 0);
  point.material.roughness = reader.number("roughness", kRoughness, 0.5f);
  reader.refuse_unknown_keys();
  return point;
}

/// `plain`: the curve that says where matter is.
BoundaryLook parse_boundary(Reader reader, ValueUnits units, const TransferFunction& plain) {
  BoundaryLook result;
  result.range.from = reader.number("from", kSteepness);
  result.range.to = reader.number("to", kSteepness);
  if (result.range.to <= result.range.from) {
    reader.fail("to", "is {:g}, which must be more than \"from\"", result.range.to);
  }
  std::vector<TransferPoint> points;
  for (const Reader& entry : reader.children("points", kMostPoints)) {
    points.push_back(parse_boundary_point(entry, units));
    const float value = points.back().value;
    if (value < plain.min_value() || value > plain.max_value()) {
      entry.fail("value", "is {:g}, beyond those of the preset's \"points\", {:g} to {:g}", value,
                 plain.min_value(), plain.max_value());
    }
  }
  if (points.empty()) {
    reader.fail("points", "holds no entries, at least 1");
  }
  result.transfer = TransferFunction(std::move(points));
  reader.refuse_unknown_keys();
  return result;
}

/// {"color": ..., "intensity": ...} as linear radiance.
Vec3 parse_radiance(Reader& reader) {
  const float intensity = reader.number("intensity", kIntensity, 1);
  return reader.color("color") * intensity;
}

Vec3 parse_sky(Reader reader) {
  const Vec3 radiance = parse_radiance(reader);
  reader.refuse_unknown_keys();
  return radiance;
}

KeyLight parse_key(Reader reader) {
  KeyLight key;
  key.direction = reader.vector("direction", kAny);
  const float length = glm::length(key.direction);
  if (length < 1e-9f) {
    reader.fail("direction", "must not be zero");
  }
  key.direction /= length;
  key.radiance = parse_radiance(reader);
  key.angular_radius = reader.number("angular_radius_deg", kAngularRadius, 5) * kRadiansPerDegree;
  key.distance = reader.number("distance", kDistance, 0);
  if (key.distance != 0 && key.distance <= 1) {
    reader.fail("distance", "is {:g}, which must be more than 1 (or 0: infinitely far)",
                key.distance);
  }
  reader.refuse_unknown_keys();
  return key;
}

bool is_panorama(const std::filesystem::path& file) {
  return file.extension() == ".hdr" || file.extension() == ".pfm";
}

// What no light is; it would make every picture black, or all of it NaN.
void check_radiance(const Image& panorama, const std::filesystem::path& file) {
  const auto is_light = [](float v) { return v >= 0 && v <= kBrightest; };  // NaN is none
  const auto wrong = std::ranges::find_if_not(panorama.data, is_light);
  if (wrong != panorama.data.end()) {
    const auto pixel = static_cast<int>((wrong - panorama.data.begin()) / panorama.channels);
    throw Error(
        "{}: the radiance of pixel {}, {} (from the top left) is {:g}, but must be 0 to "
        "{:g}; mend it there, or write the panorama again",
        file.string(), pixel % panorama.width, pixel / panorama.width, *wrong, kBrightest);
  }
  if (std::ranges::max(panorama.data) < kBlack) {
    throw Error("{}: the panorama is black; give one that has light", file.string());
  }
}

Image read_panorama(const std::filesystem::path& file) {
  if (!is_panorama(file)) {
    throw Error("{}: no panorama; give a .hdr or .pfm file", file.string());
  }
  Image panorama = file.extension() == ".pfm" ? read_pfm(file) : read_hdr(file);
  check_radiance(panorama, file);
  if (panorama.width != 2 * panorama.height) {
    warn(
        fmt::format("{}: {} x {} pixels; a panorama of longitude over latitude is twice as wide "
                    "as high, and anything else is stretched",
                    file.string(), panorama.width, panorama.height));
  }
  return panorama;
}

// {"file": ..., "intensity": ..., "turn_deg": ...}; the file lies beside the rig's.
void parse_environment(Reader reader, LightRig& rig) {
  const std::filesystem::path file =
      std::filesystem::path(reader.file()).parent_path() / reader.text("file", "");
  const float intensity = reader.number("intensity", kIntensity, 1);
  rig.environment_turn = reader.number("turn_deg", kTurn, 0) * kRadiansPerDegree;
  reader.refuse_unknown_keys();
  Image panorama = read_panorama(file);
  for (float& value : panorama.data) {
    value *= intensity;
  }
  rig.environment = std::make_shared<const Image>(std::move(panorama));
}

LightRig parse_rig(Reader reader) {
  reader.text("title", "");
  reader.text("description", "");
  Reader sky = reader.child("sky");
  LightRig rig;
  rig.sky_top = parse_sky(sky.child("top"));
  rig.sky_horizon = parse_sky(sky.child("horizon"));
  rig.sky_bottom = parse_sky(sky.child("bottom"));
  sky.refuse_unknown_keys();
  for (const Reader& key : reader.children("keys", LightRig::kMostKeys)) {
    rig.keys.push_back(parse_key(key));
  }
  if (reader.find("environment") != nullptr) {
    parse_environment(reader.child("environment"), rig);
  }
  reader.refuse_unknown_keys();
  return rig;
}

json parse_json(const std::string& text, const std::string& where) {
  try {
    return json::parse(text, nullptr, true, /*ignore_comments=*/true);
  } catch (const json::parse_error& e) {
    throw Error("{}: not JSON (near byte {})", where, e.byte);
  } catch (const json::out_of_range&) {
    throw Error("{}: not JSON (a number is too large)", where);
  }
}

std::vector<std::string> names_of(std::span<const BuiltInFile> files) {
  std::vector<std::string> names;
  for (const BuiltInFile& file : files) {
    names.emplace_back(file.name);
  }
  std::ranges::sort(names);  // files come sorted with their ending: "skin-and-bone" before "skin"
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
  preset.surface_strength = reader.number("surface_strength", kSurfaceStrength);
  const float phase = reader.number("phase_g", kPhase, 0);
  if (reader.find("gradient_opacity") != nullptr) {
    preset.gradient_opacity = parse_gradient_opacity(reader.child("gradient_opacity"));
  }
  preset.exposure = reader.number("exposure", kExposure, 1);
  preset.tone = parse_tone(reader.text("tone", tone_name(ToneCurve::kSrgb)), where);

  std::vector<TransferPoint> points;
  for (const Reader& point : reader.children("points", kMostPoints)) {
    points.push_back(parse_point(point, preset.units, phase));
  }
  try {
    preset.transfer = TransferFunction(std::move(points));
  } catch (const Error& e) {
    throw Error("{}: {}", where, e.what());
  }
  if (reader.find("boundary") != nullptr) {
    preset.boundary = parse_boundary(reader.child("boundary"), preset.units, preset.transfer);
  }
  const json& lights = reader.get("lights");
  preset.rig =
      lights.is_string() ? load_rig(lights.get<std::string>()) : parse_rig(reader.child("lights"));
  reader.refuse_unknown_keys();
  return preset;
}

// A panorama alone. Files of this kind come in any unit: its mean is made `studio`'s.
LightRig rig_of_panorama(const std::filesystem::path& path) {
  constexpr double kMean = 0.6;
  Image panorama = read_panorama(path);
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
  const auto scale = static_cast<float>(kMean * weights / sum);
  for (float& value : panorama.data) {
    value *= scale;
  }
  LightRig rig{Vec3(0), Vec3(0), Vec3(0), {}};
  rig.environment = std::make_shared<const Image>(std::move(panorama));
  return rig;
}

std::pair<int, LabelLook> parse_label(Reader reader) {
  const float number = reader.number("label", kLabel);
  if (number != std::trunc(number)) {
    reader.fail("label", "must be a whole number");
  }
  LabelLook look;
  reader.text("name", "");  // for people
  if (reader.find("color") != nullptr) {
    look.albedo = reader.color("color");
  }
  look.opacity = reader.number("opacity", kShare, 1);
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
  return parse_label(Reader(object, fmt::format("label \"{}\"", text)));
}

LabelLooks load_label_table(const std::filesystem::path& path) {
  const std::string where = path.string();
  const json table = parse_json(read_text(path), where);
  Reader reader(table, where);
  LabelLooks looks;
  for (const Reader& entry : reader.children("labels", kMostLooks)) {
    const auto [number, look] = parse_label(entry);
    if (!looks.emplace(number, look).second) {
      throw Error("{}: label {} is there twice", where, number);
    }
  }
  reader.refuse_unknown_keys();
  return looks;
}

std::vector<std::string> rig_names() { return names_of(built_in_rigs()); }

LightRig load_rig(const std::string& name_or_path) {
  if (is_panorama(name_or_path)) {
    return rig_of_panorama(name_or_path);
  }
  const std::optional<Source> source = find_source(built_in_rigs(), "rig", name_or_path);
  if (!source) {
    throw Error("no light rig \"{}\": use one of {}, or the path of a .json, .hdr or .pfm file",
                name_or_path, fmt::join(rig_names(), ", "));
  }
  const json rig = parse_json(source->text, source->where);
  return parse_rig(Reader(rig, source->where));
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
  if (preset.units == ValueUnits::kStored) {
    return;
  }
  const Histogram h = histogram(volume);
  const float threshold = otsu_threshold(h);
  const auto resolved = [&](const TransferFunction& transfer) {
    std::vector<TransferPoint> points = transfer.points();
    for (TransferPoint& point : points) {
      point.value = h.quantile(point.value / 100,
                               preset.units == ValueUnits::kPercentile ? threshold : h.min);
    }
    return TransferFunction(std::move(points));
  };
  preset.transfer = resolved(preset.transfer);
  const float range = std::max(h.quantile(0.99f, threshold) - h.quantile(0.01f, threshold), 1e-6f);
  preset.surface_strength /= range;
  if (preset.gradient_opacity) {
    preset.gradient_opacity->from *= range;
    preset.gradient_opacity->to *= range;
  }
  if (preset.boundary) {
    preset.boundary->transfer = resolved(preset.boundary->transfer);
    preset.boundary->range.from *= range;
    preset.boundary->range.to *= range;
  }
  preset.units = ValueUnits::kStored;
}

}  // namespace clipgs
