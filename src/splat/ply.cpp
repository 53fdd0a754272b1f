#include "splat/ply.h"

#include <bit>
#include <cmath>
#include <cstring>
#include <fmt/format.h>
#include <map>
#include <sstream>
#include <string_view>
#include <vector>

#include "core/error.h"
#include "core/file.h"
#include "core/parallel.h"

namespace clipgs {

static_assert(std::endian::native == std::endian::little, "PLY is read and written little-endian");

namespace {

constexpr size_t kMaxHeader = size_t{64} << 10;
constexpr size_t kMaxVertices = size_t{1} << 28;
constexpr size_t kPlyGrain = 8192;

struct Header {
  size_t vertices = 0;
  size_t stride = 0;                     // bytes a vertex
  size_t body = 0;                       // where the vertices begin
  std::map<std::string, size_t> floats;  // offset of each float property in a vertex
};

size_t scalar_size(const std::string& type) {
  static const std::map<std::string, size_t> kSizes = {
      {"char", 1},  {"uchar", 1},   {"int8", 1},   {"uint8", 1},  {"short", 2}, {"ushort", 2},
      {"int16", 2}, {"uint16", 2},  {"int", 4},    {"uint", 4},   {"int32", 4}, {"uint32", 4},
      {"float", 4}, {"float32", 4}, {"double", 8}, {"float64", 8}};
  const auto found = kSizes.find(type);
  return found == kSizes.end() ? 0 : found->second;
}

void parse_element(std::istringstream& words, const std::string& name, Header& header) {
  std::string element;
  words >> element;
  if (element != "vertex") {
    throw Error("{}: has an element '{}'; a Gaussian PLY has 'vertex' alone", name, element);
  }
  if (!(words >> header.vertices) || header.vertices > kMaxVertices) {
    throw Error("{}: its PLY header does not state a usable number of vertices", name);
  }
}

void parse_property(std::istringstream& words, const std::string& name, Header& header) {
  std::string type;
  std::string property;
  words >> type >> property;
  const size_t size = scalar_size(type);
  if (size == 0 || property.empty()) {
    throw Error("{}: PLY property '{} {}' is not a plain number; is it a Gaussian scene?", name,
                type, property);
  }
  if (type == "float" || type == "float32") {
    if (!header.floats.emplace(property, header.stride).second) {
      throw Error("{}: PLY property '{}' is stated twice", name, property);
    }
  }
  header.stride += size;
}

void parse_format(std::istringstream& words, const std::string& name) {
  std::string format;
  words >> format;
  if (format != "binary_little_endian") {
    throw Error("{}: is a PLY of format '{}'; save it as binary_little_endian", name, format);
  }
}

Header parse_header(std::span<const std::uint8_t> bytes, const std::string& name) {
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()),
                              std::min(bytes.size(), kMaxHeader));
  if (!text.starts_with("ply")) {
    throw Error("{}: is not a PLY file", name);
  }
  Header header;
  bool format_known = false;
  bool in_vertex = false;
  for (size_t begin = 0;;) {
    const size_t end = text.find('\n', begin);
    if (end == std::string_view::npos) {
      throw Error("{}: its PLY header has no end; the file is truncated or corrupt", name);
    }
    std::istringstream words{std::string(text.substr(begin, end - begin))};
    begin = end + 1;
    std::string keyword;
    words >> keyword;
    if (keyword == "end_header") {
      header.body = begin;
      break;
    }
    if (keyword == "format") {
      parse_format(words, name);
      format_known = true;
    } else if (keyword == "element") {
      if (in_vertex) {
        throw Error("{}: has more than one element; a Gaussian PLY has 'vertex' alone", name);
      }
      parse_element(words, name, header);
      in_vertex = true;
    } else if (keyword == "property" && in_vertex) {
      parse_property(words, name, header);
    }
  }
  if (!format_known || !in_vertex) {
    throw Error("{}: its PLY header states no format or no vertices", name);
  }
  return header;
}

/// Property name of each plane; f_rest and f_face are channel-major.
std::vector<std::string> plane_properties(int degree, bool face_colors) {
  std::vector<std::string> names = {"x",       "y",      "z",      "scale_0", "scale_1",
                                    "scale_2", "rot_0",  "rot_1",  "rot_2",   "rot_3",
                                    "opacity", "f_dc_0", "f_dc_1", "f_dc_2"};
  const int rest = sh_coefficients(degree) - 1;
  for (int k = 0; k < rest; ++k) {
    for (int channel = 0; channel < 3; ++channel) {
      names.push_back(fmt::format("f_rest_{}", channel * rest + k));
    }
  }
  for (int p = 0; face_colors && p < Gaussians::kFacePlanes; ++p) {
    names.push_back(fmt::format("f_face_{}", p % 3 * (Gaussians::kFacePlanes / 3) + p / 3));
  }
  return names;
}

int degree_of(const Header& header, const std::string& name) {
  int rest = 0;
  for (const auto& property : header.floats) {
    rest += property.first.starts_with("f_rest_") ? 1 : 0;
  }
  for (int degree = 0; degree <= kMaxShDegree; ++degree) {
    if (rest == 3 * (sh_coefficients(degree) - 1)) {
      return degree;
    }
  }
  throw Error("{}: has {} f_rest properties; 0, 9, 24 or 45 are possible (SH degree 0 to 3)", name,
              rest);
}

void require_finite(std::span<const float> values, const std::string& property,
                    const std::string& name) {
  for (size_t i = 0; i < values.size(); ++i) {
    if (!std::isfinite(values[i])) {
      throw Error("{}: {} of splat {} is not a finite number; the file is corrupt", name, property,
                  i);
    }
  }
}

/// One property of every vertex.
void read_property(const std::uint8_t* body, const Header& header, size_t offset,
                   std::span<float> values) {
  parallel_for(values.size(), kPlyGrain, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      std::memcpy(&values[i], body + i * header.stride + offset, sizeof(float));
    }
  });
}

/// The order in which 3DGS itself writes its properties, and then ours.
std::vector<std::string> written_order(int degree, bool face_colors) {
  std::vector<std::string> names = {"x", "y", "z", "nx", "ny", "nz", "f_dc_0", "f_dc_1", "f_dc_2"};
  for (int k = 0; k < 3 * (sh_coefficients(degree) - 1); ++k) {
    names.push_back(fmt::format("f_rest_{}", k));
  }
  for (const char* name :
       {"opacity", "scale_0", "scale_1", "scale_2", "rot_0", "rot_1", "rot_2", "rot_3"}) {
    names.emplace_back(name);
  }
  for (int p = 0; face_colors && p < Gaussians::kFacePlanes; ++p) {
    names.push_back(fmt::format("f_face_{}", p));
  }
  return names;
}

}  // namespace

Gaussians read_ply(std::span<const std::uint8_t> bytes, const std::string& name, PlyColumns* more) {
  const Header header = parse_header(bytes, name);
  const int degree = degree_of(header, name);
  const bool face_colors = header.floats.contains("f_face_0");
  const std::vector<std::string> properties = plane_properties(degree, face_colors);
  std::vector<size_t> offsets;
  for (const std::string& property : properties) {
    const auto found = header.floats.find(property);
    if (found == header.floats.end()) {
      throw Error("{}: has no float property '{}'; is it a Gaussian scene?", name, property);
    }
    offsets.push_back(found->second);
  }
  const size_t available = bytes.size() - header.body;
  if (available / header.stride < header.vertices) {
    throw Error("{}: is truncated: {} splats are announced, {} are there", name, header.vertices,
                available / header.stride);
  }
  Gaussians gaussians(header.vertices, degree, face_colors);
  const std::uint8_t* body = bytes.data() + header.body;
  for (size_t p = 0; p < offsets.size(); ++p) {
    const std::span<float> values(gaussians.plane(static_cast<int>(p)), header.vertices);
    read_property(body, header, offsets[p], values);
    require_finite(values, properties[p], name);
  }
  if (more != nullptr) {
    for (auto& [property, values] : *more) {
      const auto found = header.floats.find(property);
      values.assign(found == header.floats.end() ? 0 : header.vertices, 0.0f);
      if (!values.empty()) {
        read_property(body, header, found->second, values);
        require_finite(values, property, name);
      }
    }
  }
  return gaussians;
}

Gaussians read_ply(const std::filesystem::path& path, PlyColumns* more) {
  return read_ply(read_file(path), path.string(), more);
}

size_t ply_splat_bytes(int sh_degree) {
  return written_order(sh_degree, false).size() * sizeof(float);
}

void write_ply(const std::filesystem::path& path, const Gaussians& gaussians,
               const PlyColumns& more) {
  std::vector<std::string> order =
      written_order(gaussians.sh_degree(), gaussians.has_face_colors());
  for (const auto& column : more) {
    order.push_back(column.first);
  }
  const std::vector<std::string> planes =
      plane_properties(gaussians.sh_degree(), gaussians.has_face_colors());
  std::map<std::string, int> plane_of;
  for (size_t p = 0; p < planes.size(); ++p) {
    plane_of[planes[p]] = static_cast<int>(p);
  }
  std::string header =
      fmt::format("ply\nformat binary_little_endian 1.0\nelement vertex {}\n", gaussians.size());
  std::vector<const float*> columns;  // of each property; null: zero
  for (const std::string& property : order) {
    header += "property float " + property + "\n";
    const auto found = plane_of.find(property);
    const auto extra = more.find(property);
    columns.push_back(found != plane_of.end() ? gaussians.plane(found->second)
                      : extra != more.end()   ? extra->second.data()
                                              : nullptr);
  }
  header += "end_header\n";

  const size_t stride = order.size() * sizeof(float);
  std::vector<std::uint8_t> bytes(header.size() + gaussians.size() * stride);
  std::memcpy(bytes.data(), header.data(), header.size());
  std::uint8_t* body = bytes.data() + header.size();
  parallel_for(gaussians.size(), kPlyGrain, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      for (size_t c = 0; c < columns.size(); ++c) {
        const float value = columns[c] != nullptr ? columns[c][i] : 0.0f;
        std::memcpy(body + i * stride + c * sizeof(float), &value, sizeof(float));
      }
    }
  });
  write_file(path, bytes.data(), bytes.size());
}

}  // namespace clipgs
