#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/geometry.h"
#include "core/tone.h"
#include "section/value_curve.h"
#include "volume/light_rig.h"
#include "volume/steep_range.h"
#include "volume/volume.h"
#include "volume/volume_size.h"

namespace clipgs {

struct Preset;

/// What an exposed face shows of matter with one code.
struct FaceMaterial {
  float extinction = 0;  ///< σ_t, 1/mm
  float specular = 0;    ///< weight of the gloss, 0…1
  float roughness = 0.5f;
  Vec3 surface{0};   ///< reflectance of matter at the face, linear RGB, gloss not counted
  Vec3 interior{0};  ///< … of matter seen through the face, beyond `Section::surface_depth`
  Vec3 boundary{0};  ///< … of walls where values are steep; of sections with `Section::steep` alone
};

FaceMaterial mix(const FaceMaterial& a, const FaceMaterial& b, float t);

/// The compact volume that exposed faces are drawn from, and how they are lit (method.md §8).
///
///   voxels  [nz, ny, nx] u8     codes of `curve`, or
///           [nz, ny, nx, 3] u8  sRGB for photographs, whose code is their luminance
///
/// The first voxel's centre is a corner of the box that is drawn, the last one's the opposite.
/// Air around the body has code 0 and everything else codes from kFirstInside, so that neither
/// interpolation nor lossy coding makes the one look like the other.
struct Section {
  static constexpr int kFirstInside = 16;
  static constexpr size_t kErrorBands = 16;

  IVec3 dims{0};
  Vec3 spacing{1};    ///< mm between voxel centres
  Mat3 direction{1};  ///< columns: unit RAS directions of the index axes (a rotation)
  Vec3 origin{0};     ///< RAS mm of the centre of voxel (0, 0, 0)
  int channels = 1;   ///< 1 or 3
  std::vector<std::uint8_t> voxels;

  Modality modality = Modality::kUnknown;
  ValueCurve curve;  ///< code → HU for CT, stored units otherwise
  /// Rms of |value read back − volume's value| for codes 16k … 16k + 15, value units.
  std::array<float, kErrorBands> value_errors{};
  Vec3 source_spacing{1};  ///< mm between the voxels that were scanned

  std::array<FaceMaterial, ValueCurve::kCodes> materials{};
  /// Where walls look as the preset's boundary does (BoundaryLook); nothing: as `surface` says.
  std::optional<SteepRange> steep;
  LightRig rig;
  float exposure = 1;
  ToneCurve tone = ToneCurve::kSrgb;

  size_t voxel_count() const { return static_cast<size_t>(dims.x) * dims.y * dims.z; }
  size_t offset(int x, int y, int z) const {
    return (static_cast<size_t>(z) * dims.y + y) * dims.x + x;
  }
  Vec3 index_from_world(const Vec3& world) const {
    return ((world - origin) * direction) / spacing;
  }
  Vec3 world_from_index(const Vec3& index) const { return origin + direction * (index * spacing); }
  /// Trilinear at an index in [0, dims − 1]; beyond, the nearest: a value in the first channel, or
  /// sRGB in 0…255 for photographs. Values are interpolated, not codes: the curve bends, and bone
  /// and skin would end elsewhere than in the volume.
  Vec3 sample(const Vec3& index) const {
    return channels == 1 ? Vec3(trilinear(index, 0, curve.values()), 0, 0)
                         : Vec3(trilinear(index, 0, kIdentity), trilinear(index, 1, kIdentity),
                                trilinear(index, 2, kIdentity));
  }
  /// Value of what `sample` returned: photographs are loaded with Rec. 709 luma as theirs.
  float value(const Vec3& sampled) const {
    return channels == 1 ? sampled.x : glm::dot(sampled, Vec3(0.2126f, 0.7152f, 0.0722f));
  }
  /// Trilinear code, which tells the body from the air around it.
  float code(const Vec3& index) const {
    return channels == 1 ? trilinear(index, 0, kIdentity) : value(sample(index));
  }
  /// A value, and its rms error.
  struct Reading {
    float value = 0;
    float error = 0;
  };
  /// What is at a point (RAS mm); nothing outside the box and in the air around the body.
  std::optional<Reading> read(const Vec3& world) const;
  /// Index into `value_errors`.
  static size_t error_band(float code) {
    return std::min(static_cast<size_t>(code) * kErrorBands / ValueCurve::kCodes, kErrorBands - 1);
  }
  /// Code of one voxel.
  float code_at(const IVec3& voxel) const;
  /// The sides of the box at which matter ends only because the volume does, as planes that keep
  /// the inside: they are faces as those of a cut are.
  std::vector<Plane> ends() const;
  /// Half a mean scanned voxel, mm: matter less deep than this is lit as the face
  /// itself.
  float surface_depth() const { return 0.5f * mean_spacing(source_spacing); }

 private:
  static const std::array<float, ValueCurve::kCodes> kIdentity;

  /// Interpolates what `meaning` says of the eight codes of a channel around `index`.
  float trilinear(const Vec3& index, size_t channel,
                  const std::array<float, ValueCurve::kCodes>& meaning) const {
    const Vec3 at = glm::clamp(index, Vec3(0), Vec3(dims - 1));
    const IVec3 low = glm::min(IVec3(at), glm::max(dims - 2, IVec3(0)));
    const IVec3 step = glm::min(IVec3(1), dims - 1 - low);
    const Vec3 t = at - Vec3(low);
    const size_t x = static_cast<size_t>(step.x) * channels;
    const size_t y = static_cast<size_t>(step.y) * dims.x * channels;
    const size_t z = static_cast<size_t>(step.z) * dims.x * dims.y * channels;
    const std::uint8_t* v = &voxels[offset(low.x, low.y, low.z) * channels + channel];
    const auto along_x = [&](size_t row) {
      return glm::mix(meaning[v[row]], meaning[v[row + x]], t.x);
    };
    return glm::mix(glm::mix(along_x(0), along_x(y), t.y),
                    glm::mix(along_x(z), along_x(z + y), t.y), t.z);
  }
};

/// Gradient of the values at an index, value units per mm along RAS: central differences over a
/// voxel of the traced volume, as the path tracer takes them.
Vec3 gradient_at(const Section& section, const Vec3& index);

/// Linear albedo of a photograph's colour as Section::sample() returns it.
Vec3 photo_albedo(const Vec3& sampled);

/// How fine a section is.
struct SectionOptions {
  int size = 384;  ///< as many voxels as a cube of such a side has, at most
};

/// The part of a volume that `preset` shows, of the voxels that pictures are traced of, so that
/// surfaces end in both alike; air around the body is left out. Where `traced` is finer than
/// `scanned` (upsample()) and all of it is too much, voxels in between are left out first.
/// Values are those that are read (Volume::readings()): what was taken out of `scanned` for the
/// pictures' sake is given back, and `value_errors` are told of its voxels.
/// Reflectances start as the preset's albedo; fit_reflectance() makes them right. Throws Error if
/// nothing is visible or the size is out of range.
Section make_section(const Volume& traced, const Volume& scanned, const Preset& preset,
                     const SectionOptions& options);
/// The same of a volume that is traced as it was scanned.
Section make_section(const Volume& volume, const Preset& preset, const SectionOptions& options);

/// Bytes of memory that making a section of such a volume takes beside it and the traced one, at
/// most.
std::uint64_t section_memory(const VolumeSize& scanned, const SectionOptions& options);
/// Bytes that a section of it holds, at most, when it is made.
std::uint64_t held_section_memory(const VolumeSize& scanned, const SectionOptions& options);

/// The same section with as many voxels as a cube of that side has, at most; as it is if it has no
/// more.
/// Its value_errors grow by what the voxels that are left do not tell. Throws Error if the size is
/// out of range.
Section resize_section(const Section& section, int size);

}  // namespace clipgs
