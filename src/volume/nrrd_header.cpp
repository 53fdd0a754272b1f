#include "volume/nrrd_header.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "core/error.h"
#include "core/letter_case.h"
#include "volume/header_text.h"

namespace clipgs {
namespace {

constexpr std::int64_t kMostBytes = std::int64_t{1} << 40;

/// The header's lines by field, and the names that follow "data file: LIST".
struct Fields {
  std::map<std::string, std::string> by_name;
  std::vector<std::string> listed_files;
  Hints hints;
  size_t length = 0;  // of the header, with the empty line at its end

  const std::string* find(const std::string& name) const {
    const auto found = by_name.find(name);
    return found == by_name.end() ? nullptr : &found->second;
  }
};

/// Some fields may be written in two ways.
std::string field_name(std::string_view text) {
  using Names = std::pair<std::string_view, std::string_view>;
  constexpr std::array kSame{Names{"datafile", "data file"}, Names{"lineskip", "line skip"},
                             Names{"byteskip", "byte skip"}};
  const std::string name = lower_case(trimmed(text));
  const auto* const same =
      std::ranges::find(kSame, std::string_view(name), [](const Names& n) { return n.first; });
  return same == kSame.end() ? name : std::string(same->second);
}

bool is_list(const Fields& fields) {
  const std::string* file = fields.find("data file");
  return file != nullptr && (*file == "LIST" || file->starts_with("LIST "));
}

/// A key of somebody's own, as viewers and converters of DICOM write them ("modality",
/// "DICOM_0008_0060_Modality", "0018|0015").
void learn_key(std::string_view line, size_t colon, Hints& hints) {
  std::string key = lower_case(trimmed(line.substr(0, colon)));
  std::ranges::replace(key, '|', '_');
  const std::string_view value = line.substr(colon + 2);
  const auto is = [&](std::string_view name, std::string_view tag) {
    return key == name || key.find(tag) != std::string::npos;
  };
  if (is("modality", "0008_0060")) {
    hints.learn_modality(value);
  } else if (is("bodypartexamined", "0018_0015")) {
    hints.learn_part(value);
  } else if (is("seriesdescription", "0008_103e")) {
    hints.learn_words(value);
  } else if (is("contrastbolusagent", "0018_0010")) {
    hints.learn_agent(value);
  }
}

/// One line; false at the empty line that ends the header.
bool take_line(std::string_view line, Fields& fields, const std::string& where) {
  if (is_list(fields)) {
    if (!trimmed(line).empty()) {
      fields.listed_files.emplace_back(trimmed(line));
    }
    return true;
  }
  if (line.empty()) {
    return false;
  }
  if (line.starts_with('#')) {
    return true;
  }
  const size_t colon = line.find(':');
  if (colon == std::string_view::npos) {
    throw Error("{}: corrupt: the header's line \"{}\" is no field", where, printable(line));
  }
  if (line.substr(colon).starts_with(":=")) {
    learn_key(line, colon, fields.hints);
    return true;
  }
  const std::string name = field_name(line.substr(0, colon));
  if (!fields.by_name.emplace(name, trimmed(line.substr(colon + 1))).second) {
    throw Error("{}: corrupt: the header gives \"{}\" twice", where, printable(name));
  }
  return true;
}

Fields read_fields(std::span<const std::uint8_t> bytes, const std::string& where) {
  Lines lines(bytes);
  std::string_view line;
  const bool nrrd = lines.next(line) && line.starts_with("NRRD000") && line.size() == 8 &&
                    line[7] >= '1' && line[7] <= '9';
  if (!nrrd) {
    throw Error("{}: no NRRD file, or a corrupt one: it does not begin with NRRD000", where);
  }
  Fields fields;
  bool going = true;
  while (going && lines.next(line)) {
    going = take_line(line, fields, where);
  }
  if (going && !trimmed(lines.rest()).empty()) {  // a header of its own may lack the last newline
    take_line(lines.rest(), fields, where);
  }
  fields.length = lines.position();
  if (going && fields.find("data file") == nullptr) {
    throw Error("{}: truncated or corrupt: its header does not end", where);
  }
  return fields;
}

const std::string& require(const Fields& fields, const std::string& name,
                           const std::string& where) {
  const std::string* value = fields.find(name);
  if (value == nullptr) {
    throw Error("{}: corrupt: its header gives no \"{}\"", where, name);
  }
  return *value;
}

void set_type(const Fields& fields, ImageHeader& image, const std::string& where) {
  static const std::map<std::string_view, ScalarType> types{
      {"signed char", ScalarType::kInt8},
      {"char", ScalarType::kInt8},
      {"int8", ScalarType::kInt8},
      {"int8_t", ScalarType::kInt8},
      {"uchar", ScalarType::kUint8},
      {"unsigned char", ScalarType::kUint8},
      {"uint8", ScalarType::kUint8},
      {"uint8_t", ScalarType::kUint8},
      {"short", ScalarType::kInt16},
      {"short int", ScalarType::kInt16},
      {"signed short", ScalarType::kInt16},
      {"signed short int", ScalarType::kInt16},
      {"int16", ScalarType::kInt16},
      {"int16_t", ScalarType::kInt16},
      {"ushort", ScalarType::kUint16},
      {"unsigned short", ScalarType::kUint16},
      {"unsigned short int", ScalarType::kUint16},
      {"uint16", ScalarType::kUint16},
      {"uint16_t", ScalarType::kUint16},
      {"int", ScalarType::kInt32},
      {"signed int", ScalarType::kInt32},
      {"int32", ScalarType::kInt32},
      {"int32_t", ScalarType::kInt32},
      {"uint", ScalarType::kUint32},
      {"unsigned int", ScalarType::kUint32},
      {"uint32", ScalarType::kUint32},
      {"uint32_t", ScalarType::kUint32},
      {"longlong", ScalarType::kInt64},
      {"long long", ScalarType::kInt64},
      {"long long int", ScalarType::kInt64},
      {"signed long long", ScalarType::kInt64},
      {"signed long long int", ScalarType::kInt64},
      {"int64", ScalarType::kInt64},
      {"int64_t", ScalarType::kInt64},
      {"ulonglong", ScalarType::kUint64},
      {"unsigned long long", ScalarType::kUint64},
      {"unsigned long long int", ScalarType::kUint64},
      {"uint64", ScalarType::kUint64},
      {"uint64_t", ScalarType::kUint64},
      {"float", ScalarType::kFloat32},
      {"double", ScalarType::kFloat64}};
  const std::string name = lower_case(require(fields, "type", where));
  const auto found = types.find(name);
  if (found == types.end()) {
    throw Error("{}: its type \"{}\" is none that can be shown; use integers or floats", where,
                printable(name));
  }
  image.type = found->second;
}

void set_source(const Fields& fields, ImageHeader& image, const std::string& where) {
  VoxelSource& source = image.source;
  const std::string encoding = lower_case(require(fields, "encoding", where));
  if (encoding == "raw") {
    source.encoding = VoxelSource::Encoding::kRaw;
  } else if (encoding == "gzip" || encoding == "gz") {
    source.encoding = VoxelSource::Encoding::kDeflate;
  } else if (encoding == "txt" || encoding == "text" || encoding == "ascii") {
    source.encoding = VoxelSource::Encoding::kText;
  } else {
    throw Error("{}: its encoding \"{}\" is not supported; write it with raw or gzip", where,
                printable(encoding));
  }
  if (const std::string* skip = fields.find("line skip")) {
    source.lines =
        static_cast<std::uint64_t>(whole_number(*skip, 0, kMostBytes, "line skip", where));
  }
  if (const std::string* skip = fields.find("byte skip")) {
    const bool raw = source.encoding == VoxelSource::Encoding::kRaw;
    const std::int64_t bytes = whole_number(*skip, raw ? -1 : 0, kMostBytes, "byte skip", where);
    source.at_end = bytes == -1;
    source.unpacked_offset = source.at_end ? 0 : static_cast<std::uint64_t>(bytes);
  }
  if (size_of(image.type) > 1 && source.encoding != VoxelSource::Encoding::kText) {
    const std::string endian = lower_case(require(fields, "endian", where));
    if (endian != "little" && endian != "big") {
      throw Error("{}: its endian is \"{}\", neither little nor big", where, printable(endian));
    }
    image.big_endian = endian == "big";
  }
}

void set_files(const Fields& fields, ImageHeader& image, const std::string& where) {
  const std::string* file = fields.find("data file");
  VoxelSource& source = image.source;
  if (file == nullptr) {
    source.offset = fields.length;
    return;
  }
  const std::vector<std::string> parts = words(*file);
  if (is_list(fields)) {
    source.files = fields.listed_files;
  } else if (file->find('%') != std::string::npos && parts.size() >= 4) {
    constexpr std::int64_t kLargest = 1 << 30;
    const auto number = [&](size_t i) {
      return whole_number(parts[i], -kLargest, kLargest, "data file", where);
    };
    source.files = numbered_names(parts[0], number(1), number(2), number(3), where);
  } else {
    source.files = {*file};
  }
  if (source.files.empty() || source.files[0].empty()) {
    throw Error("{}: corrupt: its header names no data file", where);
  }
}

using Steps = std::vector<std::vector<double>>;  // an axis without a direction has none

/// "(1,0,0) none (0,1,0)": a vector for every axis.
Steps vectors(std::string_view text, const std::string& field, const std::string& where) {
  Steps found;
  while (!(text = trimmed(text)).empty()) {
    if (text.starts_with("none")) {
      found.emplace_back();
      text.remove_prefix(4);
      continue;
    }
    const size_t end = text.find(')');
    if (!text.starts_with('(') || end == std::string_view::npos) {
      throw Error("{}: corrupt: its {} holds \"{}\", neither a vector nor none", where, field,
                  printable(text));
    }
    std::string inside(text.substr(1, end - 1));
    std::ranges::replace(inside, ',', ' ');
    found.push_back(finite_numbers(inside, 3, field, where));
    text.remove_prefix(end + 1);
  }
  return found;
}

/// Which of the file's axes are the three of space; the others count colours or frames.
struct Axes {
  size_t first = 0;  // 1: the fastest axis is no axis of space
  size_t count = 0;  // of all axes
};

bool spatial_kind(const std::string& kind) {
  return kind == "domain" || kind == "space" || kind == "???" || kind == "none";
}

Axes find_axes(const Fields& fields, const Steps& directions, std::size_t count,
               const std::string& where) {
  std::vector<std::string> kinds;
  if (const std::string* text = fields.find("kinds")) {
    kinds = words(lower_case(*text));
    if (kinds.size() != count) {
      throw Error("{}: its kinds name {} axes, not {}; the header is corrupt", where, kinds.size(),
                  count);
    }
  }
  const auto spatial = [&](size_t axis) {
    return !directions.empty() ? !directions[axis].empty()
                               : kinds.empty() || spatial_kind(kinds[axis]);
  };
  const size_t first = spatial(0) ? 0 : 1;
  if (first == 1 && !kinds.empty() && (kinds[0] == "list" || kinds[0] == "time")) {
    throw Error(
        "{}: a {} of volumes (its first axis is of that kind); store the volume to show as a 3D "
        "file",
        where, kinds[0] == "list" ? "list" : "series");
  }
  for (size_t axis = first; axis < first + 3; ++axis) {
    if (axis >= count || !spatial(axis)) {
      throw Error(
          "{}: its space directions or kinds do not give three axes of space in a row; a 3D volume "
          "is needed",
          where);
    }
  }
  return {first, count};
}

/// The sign that turns the file's world into LPS.
glm::dvec3 to_lps(const Fields& fields, ImageHeader& image, const std::string& where) {
  const std::string* named = fields.find("space");
  const std::string space = named == nullptr ? "" : lower_case(*named);
  if (space == "right-anterior-superior" || space == "ras") {
    return {-1, -1, 1};
  }
  if (space == "left-anterior-superior" || space == "las") {
    return {1, -1, 1};
  }
  if (space.find("time") != std::string::npos) {
    throw Error("{}: its space \"{}\" has four axes; store it with three", where, printable(space));
  }
  if (space != "left-posterior-superior" && space != "lps") {
    image.warnings.push_back(fmt::format(
        "{}: says nothing of the patient's orientation (no \"space\" of left, right, ...): its "
        "axes "
        "are taken to run to the left, back and top; left and right may be the other way round",
        where));
  }
  return {1, 1, 1};
}

/// Millimetres of the unit of every axis of space, mm where the header gives none.
std::array<double, 3> units(const Fields& fields, const Axes& axes, ImageHeader& image,
                            const std::string& where) {
  std::array<double, 3> units{1, 1, 1};
  const bool of_space = fields.find("space units") != nullptr;
  const std::string field = of_space ? "space units" : "units";
  const std::string* text = fields.find(field);
  if (text == nullptr) {
    return units;
  }
  std::string plain = *text;
  std::ranges::replace(plain, '"', ' ');
  std::vector<std::string> names = words(plain);
  if (!of_space && names.size() == axes.count) {
    names.erase(names.begin(), names.begin() + static_cast<std::ptrdiff_t>(axes.first));
  }
  for (size_t axis = 0; axis < 3; ++axis) {
    const double unit = axis < names.size() ? millimetres_of(names[axis]) : 0;
    if (unit > 0) {
      units[axis] = unit;
    } else if (axis < names.size() && names[axis] != "none" && names[axis] != "???") {
      image.warnings.push_back(fmt::format("{}: its {} give \"{}\", no unit of length; taken as mm",
                                           where, field, printable(names[axis])));
    }
  }
  return units;
}

/// Without directions: spacings along the axes of the file.
glm::dmat3 steps_of_spacings(const Fields& fields, const Axes& axes, ImageHeader& image,
                             const std::string& where) {
  glm::dmat3 steps(1);
  const std::string* text = fields.find("spacings");
  if (text == nullptr) {
    image.warnings.push_back(fmt::format(
        R"({}: gives neither "spacings" nor "space directions": voxels of 1 mm are assumed)",
        where));
    return steps;
  }
  const std::vector<double> spacings = numbers(*text, "spacings", where);
  if (spacings.size() != axes.count) {
    throw Error("{}: its spacings give {} numbers, not {}; the header is corrupt", where,
                spacings.size(), axes.count);
  }
  for (int axis = 0; axis < 3; ++axis) {
    const std::string name = fmt::format("spacings[{}]", axis);
    const double spacing = finite(spacings[axes.first + static_cast<size_t>(axis)], name, where);
    steps[axis][axis] = spacing_or_one(spacing, name, image, where);  // below 0: turned round
  }
  return steps;
}

void place(const Fields& fields, const Steps& directions, const Axes& axes, ImageHeader& image,
           const std::string& where) {
  const glm::dvec3 sign = to_lps(fields, image, where);
  const std::array<double, 3> unit = units(fields, axes, image, where);
  const glm::dvec3 scale = sign * glm::dvec3(unit[0], unit[1], unit[2]);
  glm::dvec3 origin(0);
  if (const std::string* text = fields.find("space origin")) {
    const Steps found = vectors(*text, "space origin", where);
    if (found.size() != 1 || found[0].empty()) {
      throw Error("{}: its space origin is not one vector; the header is corrupt", where);
    }
    origin = glm::dvec3(found[0][0], found[0][1], found[0][2]) * scale;
  }
  if (directions.empty()) {
    glm::dmat3 steps = steps_of_spacings(fields, axes, image, where);
    for (int axis = 0; axis < 3; ++axis) {
      steps[axis] *= sign[axis] * unit[static_cast<size_t>(axis)];
    }
    if (fields.find("space") != nullptr) {
      image.warnings.push_back(fmt::format(
          R"({}: names a "space" but gives no "space directions": its axes are taken to run along those of the space)",
          where));
    }
    set_geometry(image, steps, origin,
                 {{"spacings[0]", "spacings[1]", "spacings[2]"}, "spacings", "space origin"},
                 where);
    return;
  }
  glm::dmat3 steps;
  GeometryFields names{{}, "space directions", "space origin"};
  for (int axis = 0; axis < 3; ++axis) {
    const size_t stored = axes.first + static_cast<size_t>(axis);
    const std::vector<double>& d = directions[stored];
    steps[axis] = glm::dvec3(d[0], d[1], d[2]) * scale;
    names.spacing[static_cast<size_t>(axis)] = fmt::format("space directions[{}]", stored);
  }
  set_geometry(image, steps, origin, names, where);
}

}  // namespace

ImageHeader parse_nrrd_header(std::span<const std::uint8_t> bytes, const std::string& where) {
  const Fields fields = read_fields(bytes, where);
  ImageHeader image;
  set_type(fields, image, where);
  set_source(fields, image, where);
  set_files(fields, image, where);
  const auto count = static_cast<size_t>(
      whole_number(require(fields, "dimension", where), 1, 16, "dimension", where));
  if (count < 3) {
    throw Error("{}: a {}D image; a 3D volume is needed", where, count);
  }
  const std::vector<double> sizes =
      finite_numbers(require(fields, "sizes", where), count, "sizes", where);
  Steps directions;
  if (const std::string* text = fields.find("space directions")) {
    directions = vectors(*text, "space directions", where);
    if (directions.size() != count) {
      throw Error("{}: its space directions name {} axes, not {}; the header is corrupt", where,
                  directions.size(), count);
    }
  }
  const Axes axes = find_axes(fields, directions, count, where);
  set_channels(image, axes.first == 0 ? 1 : sizes[0], where);
  set_sizes(image, std::span(sizes).subspan(axes.first), "sizes", where);
  place(fields, directions, axes, image, where);
  image.hints = fields.hints;
  return image;
}

}  // namespace clipgs
