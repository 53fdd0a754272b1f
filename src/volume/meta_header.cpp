#include "volume/meta_header.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <map>

#include "core/error.h"
#include "core/letter_case.h"
#include "volume/header_text.h"

namespace clipgs {
namespace {

constexpr std::int64_t kMostBytes = std::int64_t{1} << 40;

/// The header's "Name = value" lines; ElementDataFile, the last, may be followed by names.
struct Fields {
  std::map<std::string, std::string> by_name;
  std::vector<std::string> listed_files;
  size_t length = 0;

  /// Value of the first of these names that the header has.
  const std::string* find(std::initializer_list<const char*> names) const {
    for (const char* name : names) {
      const auto found = by_name.find(name);
      if (found != by_name.end()) {
        return &found->second;
      }
    }
    return nullptr;
  }
};

Fields read_fields(std::span<const std::uint8_t> bytes, const std::string& where) {
  Fields fields;
  Lines lines(bytes);
  std::string_view line;
  const auto next = [&] {
    if (lines.next(line)) {
      return true;
    }
    const bool last = !fields.by_name.empty() && lines.rest() != line && !lines.rest().empty();
    line = lines.rest();
    return last;
  };
  bool ended = false;
  while (!ended && next()) {
    if (trimmed(line).empty()) {
      continue;
    }
    const size_t equals = line.find('=');
    if (equals == std::string_view::npos) {
      throw Error("{}: no MetaImage file, or a corrupt one: \"{}\" is no line of its header", where,
                  printable(line));
    }
    const std::string name(trimmed(line.substr(0, equals)));
    if (!fields.by_name.emplace(name, trimmed(line.substr(equals + 1))).second) {
      throw Error("{}: corrupt: the header gives {} twice", where, printable(name));
    }
    ended = name == "ElementDataFile";
  }
  if (!ended) {
    throw Error("{}: truncated or corrupt: its header has no ElementDataFile", where);
  }
  fields.length = lines.position();
  if (fields.by_name["ElementDataFile"].starts_with("LIST")) {
    while (lines.next(line)) {
      fields.listed_files.emplace_back(trimmed(line));
    }
    fields.listed_files.emplace_back(trimmed(lines.rest()));
    std::erase(fields.listed_files, "");
  }
  return fields;
}

bool is_true(const Fields& fields, std::initializer_list<const char*> names, bool otherwise,
             const std::string& where) {
  const std::string* text = fields.find(names);
  if (text == nullptr) {
    return otherwise;
  }
  const std::string value = lower_case(*text);
  const bool yes = value == "true" || value == "t" || value == "1";
  if (!yes && value != "false" && value != "f" && value != "0") {
    throw Error("{}: its {} is \"{}\", neither True nor False", where, *names.begin(),
                printable(*text));
  }
  return yes;
}

void set_type(const Fields& fields, ImageHeader& image, const std::string& where) {
  static const std::map<std::string_view, ScalarType> types{
      {"MET_CHAR", ScalarType::kInt8},       {"MET_UCHAR", ScalarType::kUint8},
      {"MET_SHORT", ScalarType::kInt16},     {"MET_USHORT", ScalarType::kUint16},
      {"MET_INT", ScalarType::kInt32},       {"MET_UINT", ScalarType::kUint32},
      {"MET_LONG", ScalarType::kInt32},      {"MET_ULONG", ScalarType::kUint32},
      {"MET_LONG_LONG", ScalarType::kInt64}, {"MET_ULONG_LONG", ScalarType::kUint64},
      {"MET_FLOAT", ScalarType::kFloat32},   {"MET_DOUBLE", ScalarType::kFloat64}};
  const std::string* text = fields.find({"ElementType"});
  if (text == nullptr) {
    throw Error("{}: corrupt: its header gives no ElementType", where);
  }
  std::string name = *text;
  if (name.ends_with("_ARRAY")) {
    name.resize(name.size() - 6);
  }
  const auto found = types.find(name);
  if (found == types.end()) {
    throw Error("{}: its ElementType \"{}\" is none that can be shown; use integers or floats",
                where, printable(name));
  }
  image.type = found->second;
  image.big_endian =
      is_true(fields, {"BinaryDataByteOrderMSB", "ElementByteOrderMSB"}, false, where);
}

void set_source(const Fields& fields, ImageHeader& image, const std::string& where) {
  VoxelSource& source = image.source;
  if (is_true(fields, {"CompressedData"}, false, where)) {
    source.encoding = VoxelSource::Encoding::kDeflate;
  } else if (!is_true(fields, {"BinaryData"}, true, where)) {
    source.encoding = VoxelSource::Encoding::kText;
  }
  const std::string file = *fields.find({"ElementDataFile"});
  const std::vector<std::string> parts = words(file);
  if (file == "LOCAL" || file == "Local" || file == "local") {
    source.offset = fields.length;
  } else if (file.starts_with("LIST")) {
    source.files = fields.listed_files;
  } else if (file.find('%') != std::string::npos && parts.size() >= 3) {
    constexpr std::int64_t kLargest = 1 << 30;
    const auto number = [&](size_t i) {
      return whole_number(parts[i], -kLargest, kLargest, "ElementDataFile", where);
    };
    source.files =
        numbered_names(parts[0], number(1), number(2), parts.size() > 3 ? number(3) : 1, where);
  } else {
    source.files = {file};
  }
  const bool local = source.offset > 0;
  if (!local && (source.files.empty() || source.files[0].empty())) {
    throw Error("{}: corrupt: its ElementDataFile names no file", where);
  }
  if (const std::string* text = fields.find({"HeaderSize"})) {
    const std::int64_t size = whole_number(*text, -1, kMostBytes, "HeaderSize", where);
    source.at_end = size == -1 && source.encoding == VoxelSource::Encoding::kRaw;
    if (local && size > 0 && static_cast<std::uint64_t>(size) < source.offset) {
      throw Error("{}: corrupt: its HeaderSize of {} bytes ends within the header", where, size);
    }
    source.offset = size > 0 ? static_cast<std::uint64_t>(size) : source.offset;
  }
}

void set_rescale(const Fields& fields, ImageHeader& image, const std::string& where) {
  const auto number = [&](const char* name, double otherwise) {
    const std::string* text = fields.find({name});
    return text == nullptr ? otherwise : finite_numbers(*text, 1, name, where)[0];
  };
  const double slope = number("ElementToIntensityFunctionSlope", 1);
  const double intercept = number("ElementToIntensityFunctionOffset", 0);
  if (slope != 0 && image.channels == 1) {
    image.slope = slope;
    image.intercept = intercept;
  }
}

double unit_of(const Fields& fields, ImageHeader& image, const std::string& where) {
  const std::string* text = fields.find({"DistanceUnits"});
  if (text == nullptr || *text == "?") {
    return 1;
  }
  const double unit = millimetres_of(*text);
  if (unit > 0) {
    return unit;
  }
  image.warnings.push_back(fmt::format(
      "{}: its DistanceUnits \"{}\" are no unit of length; taken as mm", where, printable(*text)));
  return 1;
}

glm::dvec3 spacing_of(const Fields& fields, size_t axes, ImageHeader& image,
                      const std::string& where) {
  const std::string* text = fields.find({"ElementSpacing", "ElementSize"});
  if (text == nullptr) {
    image.warnings.push_back(
        fmt::format("{}: gives no ElementSpacing: voxels of 1 mm are assumed", where));
    return glm::dvec3(1);
  }
  const std::vector<double> stored = finite_numbers(*text, axes, "ElementSpacing", where);
  glm::dvec3 spacing;
  for (int axis = 0; axis < 3; ++axis) {
    // Below 0 it turns the axis round.
    spacing[axis] = spacing_or_one(stored[static_cast<size_t>(axis)],
                                   fmt::format("ElementSpacing[{}]", axis), image, where);
  }
  return spacing;
}

/// The axes' directions: a row of the file's TransformMatrix for each.
glm::dmat3 directions_of(const Fields& fields, size_t axes, ImageHeader& image,
                         const std::string& where) {
  glm::dmat3 directions(1);
  const std::string* text = fields.find({"TransformMatrix", "Rotation", "Orientation"});
  if (text == nullptr) {
    image.warnings.push_back(
        fmt::format("{}: says nothing of the patient's orientation (no TransformMatrix): its axes "
                    "are taken to run to the left, back and top; left and right may be the other "
                    "way round",
                    where));
    return directions;
  }
  constexpr double kRounding = 1e-2;
  const std::vector<double> stored = finite_numbers(*text, axes * axes, "TransformMatrix", where);
  for (size_t axis = 0; axis < 3; ++axis) {
    const double* row = &stored[axis * axes];
    glm::dvec3& direction = directions[static_cast<int>(axis)];
    direction = {row[0], row[1], row[2]};
    const double length = glm::length(direction);
    if (!(std::abs(length - 1) < kRounding)) {
      throw Error("{}: the direction {} of its TransformMatrix is {} long, not 1", where, axis + 1,
                  length);
    }
    direction /= length;
  }
  return directions;
}

void place(const Fields& fields, size_t axes, ImageHeader& image, const std::string& where) {
  const double unit = unit_of(fields, image, where);
  const glm::dvec3 spacing = spacing_of(fields, axes, image, where) * unit;
  glm::dmat3 steps = directions_of(fields, axes, image, where);
  for (int axis = 0; axis < 3; ++axis) {
    steps[axis] *= spacing[axis];
  }
  glm::dvec3 origin(0);
  if (const std::string* text = fields.find({"Offset", "Position", "Origin"})) {
    const std::vector<double> stored = finite_numbers(*text, axes, "Offset", where);
    origin = glm::dvec3(stored[0], stored[1], stored[2]) * unit;
  }
  set_geometry(image, steps, origin,
               {{"ElementSpacing[0]", "ElementSpacing[1]", "ElementSpacing[2]"},
                "TransformMatrix",
                "Offset"},
               where);
}

}  // namespace

ImageHeader parse_meta_header(std::span<const std::uint8_t> bytes, const std::string& where) {
  const Fields fields = read_fields(bytes, where);
  const std::string* kind = fields.find({"ObjectType"});
  if (kind != nullptr && lower_case(*kind) != "image") {
    throw Error("{}: its ObjectType is \"{}\", not Image", where, printable(*kind));
  }
  const std::string* dimensions = fields.find({"NDims"});
  const std::string* sizes = fields.find({"DimSize"});
  if (dimensions == nullptr || sizes == nullptr) {
    throw Error("{}: corrupt: its header gives no NDims or no DimSize", where);
  }
  const auto axes = static_cast<size_t>(whole_number(*dimensions, 1, 10, "NDims", where));
  if (axes < 3) {
    throw Error("{}: a {}D image; a 3D volume is needed", where, axes);
  }
  ImageHeader image;
  set_type(fields, image, where);
  set_source(fields, image, where);
  const std::string* channels = fields.find({"ElementNumberOfChannels"});
  set_channels(image,
               channels == nullptr ? 1
                                   : static_cast<double>(whole_number(
                                         *channels, 1, 1 << 16, "ElementNumberOfChannels", where)),
               where);
  set_rescale(fields, image, where);
  set_sizes(image, finite_numbers(*sizes, axes, "DimSize", where), "DimSize", where);
  place(fields, axes, image, where);
  if (const std::string* modality = fields.find({"Modality"})) {
    image.hints.learn_modality(*modality);
  }
  return image;
}

}  // namespace clipgs
