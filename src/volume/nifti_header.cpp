#include "volume/nifti_header.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <string_view>

#include "core/error.h"

namespace clipgs {
namespace {

constexpr size_t kNifti1Bytes = 348;
constexpr size_t kNifti2Bytes = 540;
constexpr std::array kAxisNames{"x", "y", "z"};

/// The fields of either version that matter here, as stored.
struct Fields {
  std::array<double, 8> dim{};
  int datatype = 0;
  int bits = 0;
  std::array<double, 8> pixdim{};
  double voxel_offset = 0;
  double slope = 0;
  double intercept = 0;
  int units = 0;
  int qform_code = 0;
  int sform_code = 0;
  glm::dvec3 quaternion{0};  // b, c, d
  glm::dvec3 qoffset{0};
  std::array<glm::dvec4, 3> srow{};
  std::string_view description;
  std::string_view intent;
  glm::dvec2 shown{0};  // cal_min, cal_max
  std::string_view magic;
  size_t least_voxel_offset = 0;
  bool big_endian = false;
};

class Bytes {
 public:
  Bytes(std::span<const std::uint8_t> bytes, bool big_endian)
      : bytes_(bytes), big_endian_(big_endian) {}

  template <typename T>
  T get(size_t at) const {
    std::array<std::uint8_t, sizeof(T)> ordered;
    std::ranges::copy(bytes_.subspan(at, sizeof(T)), ordered.begin());
    if (big_endian_) {
      std::ranges::reverse(ordered);
    }
    return std::bit_cast<T>(ordered);
  }
  std::string_view text(size_t at, size_t length) const {
    return {reinterpret_cast<const char*>(&bytes_[at]), length};
  }
  template <typename T, size_t kCount>
  void get_all(size_t at, std::array<double, kCount>& to) const {
    for (size_t i = 0; i < kCount; ++i) {
      to[i] = static_cast<double>(get<T>(at + i * sizeof(T)));
    }
  }
  template <typename T, typename Vector>
  Vector get_vector(size_t at) const {
    Vector v;
    for (int i = 0; i < Vector::length(); ++i) {
      v[i] = static_cast<double>(get<T>(at + static_cast<size_t>(i) * sizeof(T)));
    }
    return v;
  }

 private:
  std::span<const std::uint8_t> bytes_;
  bool big_endian_;
};

/// The two versions have the same fields, of other widths at other places.
template <typename Real>
void read_placement(const Bytes& bytes, size_t quaternion_at, size_t qoffset_at, size_t srow_at,
                    Fields& fields) {
  fields.quaternion = bytes.get_vector<Real, glm::dvec3>(quaternion_at);
  fields.qoffset = bytes.get_vector<Real, glm::dvec3>(qoffset_at);
  for (size_t row = 0; row < 3; ++row) {
    fields.srow[row] = bytes.get_vector<Real, glm::dvec4>(srow_at + row * 4 * sizeof(Real));
  }
}

Fields read_version_1(const Bytes& bytes) {
  Fields fields;
  bytes.get_all<std::int16_t>(40, fields.dim);
  fields.datatype = bytes.get<std::int16_t>(70);
  fields.bits = bytes.get<std::int16_t>(72);
  bytes.get_all<float>(76, fields.pixdim);
  fields.voxel_offset = bytes.get<float>(108);
  fields.slope = bytes.get<float>(112);
  fields.intercept = bytes.get<float>(116);
  fields.units = bytes.get<std::uint8_t>(123);
  fields.shown = {bytes.get<float>(128), bytes.get<float>(124)};
  fields.description = bytes.text(148, 80);
  fields.intent = bytes.text(328, 16);
  fields.qform_code = bytes.get<std::int16_t>(252);
  fields.sform_code = bytes.get<std::int16_t>(254);
  read_placement<float>(bytes, 256, 268, 280, fields);
  fields.least_voxel_offset = kNifti1Bytes + 4;
  return fields;
}

Fields read_version_2(const Bytes& bytes) {
  Fields fields;
  fields.datatype = bytes.get<std::int16_t>(12);
  fields.bits = bytes.get<std::int16_t>(14);
  bytes.get_all<std::int64_t>(16, fields.dim);
  bytes.get_all<double>(104, fields.pixdim);
  fields.voxel_offset = static_cast<double>(bytes.get<std::int64_t>(168));
  fields.slope = bytes.get<double>(176);
  fields.intercept = bytes.get<double>(184);
  fields.shown = {bytes.get<double>(200), bytes.get<double>(192)};
  fields.description = bytes.text(240, 80);
  fields.intent = bytes.text(508, 16);
  fields.qform_code = bytes.get<std::int32_t>(344);
  fields.sform_code = bytes.get<std::int32_t>(348);
  read_placement<double>(bytes, 352, 376, 400, fields);
  fields.units = bytes.get<std::int32_t>(500);
  fields.least_voxel_offset = kNifti2Bytes + 4;
  return fields;
}

void require_header_bytes(std::span<const std::uint8_t> bytes, size_t needed,
                          const std::string& where) {
  if (bytes.size() < needed) {
    throw Error("{}: truncated or corrupt: {} of the {} bytes of a NIfTI header are missing", where,
                needed - bytes.size(), needed);
  }
}

Fields read_fields(std::span<const std::uint8_t> bytes, const std::string& where) {
  require_header_bytes(bytes, kNifti1Bytes, where);
  const auto says = [&](bool big_endian, size_t size) {
    return Bytes(bytes, big_endian).get<std::int32_t>(0) == static_cast<std::int32_t>(size);
  };
  const bool big_endian = says(true, kNifti1Bytes) || says(true, kNifti2Bytes);
  const Bytes ordered(bytes, big_endian);
  const auto magic_at = [&](size_t at) {
    return std::string_view(reinterpret_cast<const char*>(&bytes[at]), 4);
  };
  Fields fields;
  if (says(big_endian, kNifti1Bytes)) {
    fields = read_version_1(ordered);
    fields.magic = magic_at(344);
    if (fields.magic[0] != 'n') {
      throw Error(
          "{}: an ANALYZE 7.5 file, or a corrupt NIfTI one: it cannot say where left and right are;"
          " convert it to NIfTI",
          where);
    }
  } else if (says(big_endian, kNifti2Bytes)) {
    require_header_bytes(bytes, kNifti2Bytes, where);
    fields = read_version_2(ordered);
    fields.magic = magic_at(4);
  } else {
    throw Error("{}: no NIfTI file, or a corrupt one: its sizeof_hdr is {}, not 348 or 540", where,
                ordered.get<std::int32_t>(0));
  }
  fields.big_endian = big_endian;
  return fields;
}

/// Whether the voxels lie in a file of their own.
bool detached(const Fields& fields, const std::string& where) {
  const bool version_1 = fields.least_voxel_offset == kNifti1Bytes + 4;
  const std::string_view single = version_1 ? std::string_view("n+1\0", 4) : "n+2\0";
  const std::string_view pair = version_1 ? std::string_view("ni1\0", 4) : "ni2\0";
  if (fields.magic.substr(0, 3) == pair.substr(0, 3)) {
    return true;
  }
  if (fields.magic.substr(0, 3) != single.substr(0, 3)) {
    throw Error("{}: no NIfTI file, or a corrupt one: its magic is neither {} nor {}", where,
                single.substr(0, 3), pair.substr(0, 3));
  }
  return false;
}

struct StoredType {
  int code;
  int bits;
  ScalarType type;
  int channels;
};

constexpr std::array kTypes{
    StoredType{2, 8, ScalarType::kUint8, 1},      StoredType{4, 16, ScalarType::kInt16, 1},
    StoredType{8, 32, ScalarType::kInt32, 1},     StoredType{16, 32, ScalarType::kFloat32, 1},
    StoredType{64, 64, ScalarType::kFloat64, 1},  StoredType{128, 24, ScalarType::kUint8, 3},
    StoredType{256, 8, ScalarType::kInt8, 1},     StoredType{512, 16, ScalarType::kUint16, 1},
    StoredType{768, 32, ScalarType::kUint32, 1},  StoredType{1024, 64, ScalarType::kInt64, 1},
    StoredType{1280, 64, ScalarType::kUint64, 1}, StoredType{2304, 32, ScalarType::kUint8, 4}};

void set_type(const Fields& fields, ImageHeader& image, const std::string& where) {
  const auto* const type = std::ranges::find(kTypes, fields.datatype, &StoredType::code);
  if (type == kTypes.end()) {
    throw Error("{}: its datatype {} is none that can be shown; use integers, floats or RGB24",
                where, fields.datatype);
  }
  if (fields.bits != 0 && fields.bits != type->bits) {
    throw Error("{}: its bitpix {} does not go with its datatype {}; the header is corrupt", where,
                fields.bits, fields.datatype);
  }
  image.type = type->type;
  image.channels = type->channels;
  image.big_endian = fields.big_endian;
}

void set_rescale(const Fields& fields, ImageHeader& image, const std::string& where) {
  // 0 or NaN: "no slope" to the standard and to nibabel.
  if (fields.slope == 0 || std::isnan(fields.slope) || image.channels > 1) {
    return;
  }
  image.slope = finite(fields.slope, "scl_slope", where);
  image.intercept = finite(fields.intercept, "scl_inter", where);
}

void set_voxel_offset(const Fields& fields, bool in_own_file, ImageHeader& image,
                      const std::string& where) {
  constexpr double kMost = 1e12;
  const double least = in_own_file ? 0 : static_cast<double>(fields.least_voxel_offset);
  const double offset = fields.voxel_offset;
  const bool sane = offset >= least && offset <= kMost && offset == std::trunc(offset);
  if (!sane) {  // NaN too
    throw Error("{}: its vox_offset is {}; a whole number from {} on is needed", where, offset,
                least);
  }
  image.source.unpacked_offset = static_cast<std::uint64_t>(offset);
}

void set_dims(const Fields& fields, ImageHeader& image, const std::string& where) {
  const double axes = fields.dim[0];
  if (axes < 1 || axes > 7) {
    throw Error("{}: its dim[0] is {}, not 1 to 7; the header is corrupt", where, axes);
  }
  if (axes < 3) {
    throw Error("{}: a {}D image; a 3D volume is needed", where, axes);
  }
  if (axes >= 5 && fields.dim[5] > 1) {
    throw Error("{}: its dim[5] gives {} numbers a voxel; one number, or 8-bit RGB, is needed",
                where, fields.dim[5]);
  }
  set_sizes(image, std::span(fields.dim).subspan(1, static_cast<size_t>(axes)), "dim", where);
}

/// Millimetres of the unit that xyzt_units names in its three lowest bits.
double unit_of(const Fields& fields, ImageHeader& image, const std::string& where) {
  switch (fields.units & 7) {
    case 0:  // unknown
    case 2:
      return 1;
    case 1:
      return 1000;
    case 3:
      return 1e-3;
    default:
      break;
  }
  image.warnings.push_back(fmt::format(
      "{}: its xyzt_units name no unit of length ({}); taken as mm", where, fields.units & 7));
  return 1;
}

/// Steps between voxels and the centre of the first one, in the file's RAS and unit.
struct Placement {
  glm::dmat3 steps{1};
  glm::dvec3 origin{0};
};

/// pixdim[1…3] as lengths: the standard wants them positive.
glm::dvec3 voxel_size(const Fields& fields, ImageHeader& image, const std::string& where) {
  glm::dvec3 size;
  for (int axis = 0; axis < 3; ++axis) {
    const std::string name = fmt::format("pixdim[{}]", axis + 1);
    const double stored = finite(fields.pixdim[static_cast<size_t>(axis) + 1], name, where);
    size[axis] = std::abs(spacing_or_one(stored, name, image, where));
    if (stored < 0) {
      image.warnings.push_back(fmt::format(
          "{}: its {} is {}: the sign is left out, it turns no axis around", where, name, stored));
    }
  }
  return size;
}

Placement sform(const Fields& fields, const std::string& where) {
  Placement form;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 4; ++column) {
      const double value = finite(fields.srow[static_cast<size_t>(row)][column],
                                  fmt::format("srow_{}[{}]", kAxisNames[row], column), where);
      (column < 3 ? form.steps[column][row] : form.origin[row]) = value;
    }
  }
  return form;
}

/// nifti1.h, method 2: a is found from b, c and d; qfac (pixdim[0]) < 0 turns the third axis.
Placement qform(const Fields& fields, const glm::dvec3& size, const std::string& where) {
  Placement form;
  for (int i = 0; i < 3; ++i) {
    finite(fields.quaternion[i], fmt::format("quatern_{}", "bcd"[i]), where);
    form.origin[i] = finite(fields.qoffset[i], fmt::format("qoffset_{}", kAxisNames[i]), where);
  }
  const double sum = glm::dot(fields.quaternion, fields.quaternion);
  constexpr double kRounding = 1e-3;
  if (sum > 1 + kRounding) {
    throw Error(
        "{}: its quatern_b, quatern_c and quatern_d are no rotation, their squares add up to "
        "{:.6g}",
        where, sum);
  }
  const glm::dvec3& q = fields.quaternion;
  const glm::dquat turn =
      glm::normalize(glm::dquat(std::sqrt(std::max(0.0, 1 - sum)), q.x, q.y, q.z));
  form.steps = glm::mat3_cast(turn);
  for (int axis = 0; axis < 3; ++axis) {
    form.steps[axis] *= size[axis];
  }
  if (finite(fields.pixdim[0], "pixdim[0] (qfac)", where) < 0) {
    form.steps[2] = -form.steps[2];
  }
  return form;
}

/// The largest distance between where two forms put a corner of the volume.
double distance(const Placement& a, const Placement& b, const IVec3& dims) {
  double largest = 0;
  for (int corner = 0; corner < 8; ++corner) {
    const glm::dvec3 index(corner % 2 * (dims.x - 1), corner / 2 % 2 * (dims.y - 1),
                           corner / 4 * (dims.z - 1));
    largest =
        std::max(largest, glm::length(a.steps * index + a.origin - b.steps * index - b.origin));
  }
  return largest;
}

void warn_of_other_size(const Placement& form, const Fields& fields, ImageHeader& image,
                        const std::string& where) {
  constexpr double kWorthSaying = 0.01;
  for (int axis = 0; axis < 3; ++axis) {
    const double by_form = glm::length(form.steps[axis]);
    const double by_pixdim = std::abs(fields.pixdim[static_cast<size_t>(axis) + 1]);
    const bool differs = std::abs(by_form - by_pixdim) > kWorthSaying * by_form;
    if (by_pixdim != 0 && (differs || std::isnan(by_pixdim))) {
      image.warnings.push_back(
          fmt::format("{}: voxels are {:.6g} long by its srow_* and {:.6g} by its pixdim[{}]; the "
                      "srow_* are taken",
                      where, by_form, by_pixdim, axis + 1));
    }
  }
}

void require_code(int code, const char* field, const std::string& where) {
  constexpr int kLargest = 5;
  if (code < 0 || code > kLargest) {
    throw Error("{}: its {} is {}, not 0 to 5; the header is corrupt", where, field, code);
  }
}

const GeometryFields kSformFields{{"srow_*[0]", "srow_*[1]", "srow_*[2]"}, "srow_*", "srow_*[3]"};
const GeometryFields kPixdimFields{
    {"pixdim[1]", "pixdim[2]", "pixdim[3]"}, "quatern_*", "qoffset_*"};

/// Whether the form is of some sense but for its axes, which are not perpendicular.
bool sheared(const Placement& form) {
  constexpr double kLongest = 1e6;
  for (int axis = 0; axis < 3; ++axis) {
    const double length = glm::length(form.steps[axis]);
    if (length == 0 || length > kLongest) {
      return false;
    }
  }
  return glm::determinant(form.steps) != 0 && !perpendicular(form.steps);
}

/// A form, and the names of the fields that it comes from.
struct Named {
  Placement form;
  const GeometryFields& fields;
};

void warn_of_other_form(const Placement& by_sform, const Placement& by_qform, double unit,
                        ImageHeader& image, const std::string& where) {
  const double apart = distance(by_sform, by_qform, image.dims);
  const double voxel = std::min({glm::length(by_sform.steps[0]), glm::length(by_sform.steps[1]),
                                 glm::length(by_sform.steps[2])});
  if (apart > voxel / 2) {
    image.warnings.push_back(fmt::format(
        "{}: its sform and qform disagree by up to {:.4g} mm; the sform is taken, as the NIfTI "
        "standard has it: check left and right",
        where, apart * unit));
  }
}

/// Which form holds, by the standard, and what is to be said of the other one.
Named choose_form(const Fields& fields, double unit, ImageHeader& image, const std::string& where) {
  if (fields.sform_code > 0) {
    const Placement by_sform = sform(fields, where);
    if (fields.qform_code == 0) {
      warn_of_other_size(by_sform, fields, image, where);
      return {by_sform, kSformFields};
    }
    const Placement by_qform = qform(fields, voxel_size(fields, image, where), where);
    if (sheared(by_sform)) {
      image.warnings.push_back(fmt::format(
          "{}: the axes of its sform (srow_*) are not perpendicular; its qform is taken", where));
      return {by_qform, kPixdimFields};
    }
    warn_of_other_form(by_sform, by_qform, unit, image, where);
    return {by_sform, kSformFields};
  }
  const glm::dvec3 size = voxel_size(fields, image, where);
  if (fields.qform_code > 0) {
    return {qform(fields, size, where), kPixdimFields};
  }
  image.warnings.push_back(fmt::format(
      "{}: says nothing of the patient's orientation (sform_code and qform_code are 0): "
      "its axes are taken to run to the right, front and top; left and right may be "
      "the other way round",
      where));
  Placement form;
  for (int axis = 0; axis < 3; ++axis) {
    form.steps[axis] *= size[axis];
  }
  return {form, kPixdimFields};
}

void place(const Fields& fields, ImageHeader& image, const std::string& where) {
  require_code(fields.sform_code, "sform_code", where);
  require_code(fields.qform_code, "qform_code", where);
  const double unit = unit_of(fields, image, where);
  const auto [form, names] = choose_form(fields, unit, image, where);
  const glm::dvec3 lps(-1, -1, 1);
  glm::dmat3 steps;
  for (int axis = 0; axis < 3; ++axis) {
    steps[axis] = form.steps[axis] * lps * unit;
  }
  set_geometry(image, steps, form.origin * lps * unit, names, where);
}

/// Of texts without a fixed meaning. The values to be shown are 0 where the header gives none.
Hints hints_of(const Fields& fields) {
  constexpr double kFarthest = 1e9;
  Hints hints;
  for (const std::string_view text : {fields.description, fields.intent}) {
    hints.learn_modality(text);
    hints.learn_words(text);
  }
  const glm::dvec2& shown = fields.shown;
  if (shown.x < shown.y && shown.x > -kFarthest && shown.y < kFarthest) {
    hints.shown = Vec2(shown);
  }
  return hints;
}

}  // namespace

NiftiHeader parse_nifti_header(std::span<const std::uint8_t> bytes, const std::string& where) {
  const Fields fields = read_fields(bytes, where);
  NiftiHeader header;
  header.detached = detached(fields, where);
  set_type(fields, header.image, where);
  set_rescale(fields, header.image, where);
  set_voxel_offset(fields, header.detached, header.image, where);
  set_dims(fields, header.image, where);
  place(fields, header.image, where);
  header.image.hints = hints_of(fields);
  return header;
}

}  // namespace clipgs
