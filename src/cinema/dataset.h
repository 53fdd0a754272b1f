#pragma once

#include <array>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/camera.h"
#include "core/image.h"
#include "core/tone.h"
#include "core/volume_look.h"

namespace clipgs {

/// What pictures are for: learning, the figures of tables, and choices between methods, which must
/// not be made on the tables' pictures.
enum class Split {
  kTrain,
  kTestAxis,     ///< cut across the axis
  kTestOblique,  ///< cut by any plane
  kTestUncut,
  kTestClose,       ///< two to four times as near: a face of a cut, or the skin of the uncut body
  kTestCutAxis,     ///< XClipGS's views of cuts across each axis (plan_cut_views()) …
  kTestCutOblique,  ///< … and of oblique ones
  kValidationAxis,
  kValidationOblique,
  kValidationUncut,
  kValidationClose
};
inline constexpr std::array kTestSplits{Split::kTestAxis,    Split::kTestOblique,
                                        Split::kTestUncut,   Split::kTestClose,
                                        Split::kTestCutAxis, Split::kTestCutOblique};
inline constexpr std::array kValidationSplits{Split::kValidationAxis, Split::kValidationOblique,
                                              Split::kValidationUncut, Split::kValidationClose};
inline constexpr std::array kSplits{
    Split::kTrain,           Split::kTestAxis,       Split::kTestOblique,
    Split::kTestUncut,       Split::kTestClose,      Split::kTestCutAxis,
    Split::kTestCutOblique,  Split::kValidationAxis, Split::kValidationOblique,
    Split::kValidationUncut, Split::kValidationClose};
/// "train", "test_axis", "validation_oblique" and so on.
const char* split_name(Split split);
/// Whether its pictures are measured by what the cut does (measure/cut_face.h).
inline bool is_cut_view(Split split) {
  return split == Split::kTestCutAxis || split == Split::kTestCutOblique;
}

/// One picture of the dataset.
struct Frame {
  Camera camera;
  std::optional<Plane> plane;
  Split split = Split::kTrain;
  std::string file;  ///< PNG, relative to the folder: 8-bit sRGB RGBA, straight alpha
  // Of test and validation frames only, and the uncut ones of those that are cut:
  std::string uncut_file;        ///< the same view without the plane ("leak" needs it); of cut
                                 ///< views (is_cut_view()) as clean as the picture itself
  std::string depth_file;        ///< first-hit depth, 16-bit grey PNG: mm = value·depth_scale
  std::string uncut_depth_file;  ///< … without the plane

  int shrink = 1;  ///< the files have so many times the camera's pixels along each side

  float noise_db = 0;         ///< noise floor of the picture over black, dB
  float masked_noise_db = 0;  ///< … of its pixels that show matter, dB
};

/// A cinematic dataset on disk: transforms.json (NeRF/Nerfstudio convention plus our keys), PNGs,
/// and points.ply (seed points sampled from the volume). See docs/format.md.
struct Dataset {
  std::filesystem::path folder;
  std::vector<Frame> frames;
  Vec3 axis{0, 0, 1};
  Vec2 extent{0};           ///< interval of axis·x over the visible matter, mm
  Sphere sphere;            ///< bounding sphere of the visible matter
  Box bounds;               ///< bounding box of the visible matter
  float voxel_mm = 1;       ///< spacing of the source volume (geometric mean)
  std::vector<Plane> ends;  ///< the sides of the volume, as planes that keep the inside
  std::string preset;
  VolumeLook look;
  ToneCurve tone = ToneCurve::kSrgb;  ///< of the pictures
  float depth_scale = 0;              ///< mm per unit of the depth pictures' 16-bit values

  std::vector<const Frame*> split(Split which) const;
  Image load(const Frame& frame) const;
};

/// A point of matter to start a Gaussian from (points.ply: x y z, nx ny nz, red green blue,
/// spacing).
struct SeedPoint {
  Vec3 position;  ///< mm
  Vec3 color;     ///< display sRGB estimate
  float spacing;  ///< mm: distance to its neighbours, the start of its size
};

/// Reads and checks transforms.json. Throws Error.
Dataset load_dataset(const std::filesystem::path& folder);
std::vector<SeedPoint> load_seed_points(const std::filesystem::path& folder);

}  // namespace clipgs
