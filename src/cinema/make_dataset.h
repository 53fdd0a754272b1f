#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "cinema/dataset.h"
#include "cinema/scene.h"
#include "cinema/traced_volume.h"
#include "cinema/visible_matter.h"
#include "volume/preset.h"
#include "volume/volume.h"

namespace clipgs {

/// How many pictures a dataset holds, and how they are traced.
struct DatasetOptions {
  int size = 256;                   ///< pictures are size × size px
  int test_size = 0;                ///< … those of test and validation frames this; 0: size
  int train_frames = 600;           ///< about 40 % axis planes, 45 % oblique, 15 % uncut
  int test_frames = 30;             ///< of each test split
  int validation_frames = 15;       ///< of each validation split
  int uncut_frames = 0;             ///< of kTestUncut, and half as many of kValidationUncut
  int close_frames = 0;             ///< of kTestClose, and half as many of kValidationClose
  bool cut_views = false;           ///< those of plan_cut_views(), too
  int train_spp = 32;               ///< samples a pixel of a training picture, mean over matter
  float test_noise_db = 46;         ///< noise floor that test and validation pictures reach …
  float test_masked_noise_db = 40;  ///< … and that of its pixels that show matter …
  int test_spp = 4096;              ///< … unless this many samples a pixel are not enough
  int max_bounces = 6;              ///< vertices of a path
  size_t seed_points = 150000;
  std::uint64_t seed = 1;
  Vec3 axis{0, 0, 1};        ///< unit RAS direction of the axis planes
  bool one_sided = false;    ///< axis planes keep what is below them, along the axis, as a neural
                             ///< uniaxial model needs them; else the side that suits the view
  bool choose_views = true;  ///< training frames by what they show besides faces, or evenly spread
  float near_share = 0.5f;   ///< of the training frames are those of bring_near()
  bool upsample = true;      ///< pictures of finer voxels than were scanned (volume/upsample.h)
  bool denoise = false;      ///< training pictures only: what is measured by is never filtered
};

/// Cameras and planes of every frame, without pictures. Cameras spread evenly over the sphere, at
/// three distances (training) or the nominal one (tests); close-ups look from there through a lens
/// that magnifies two to four times; planes go through the visible matter, and
/// three times in four leave the side that the camera does not stand on, so that it sees the face.
/// Test and validation frames are held out (HeldOut): no plane of another split comes within 1 % of
/// the extent of theirs, no view within 5°.
std::vector<Frame> plan_frames(const VisibleMatter& matter, const DatasetOptions& options);

/// Views that XClipGS measures cuts by (arXiv 2608.07760), through the middle of the matter. Of
/// each axis of the patient's one plane, five views of its face, straight and 10° from that, and
/// five of its edge, 1.5° from the kept side; of five random normals, at least 20° from the axes
/// and each other, one of the face, 10° from straight, and two of the edge. `size`: px.
std::vector<Frame> plan_cut_views(const VisibleMatter& matter, int size, std::uint64_t seed);

/// Aims close-ups, which plan_frames() leaves at the whole body, at what they see: at a random
/// place of their face, or of the skin where they are uncut.
void aim_close_ups(const CinemaScene& scene, std::uint64_t seed, std::vector<Frame>& frames);

/// DatasetOptions::near_share where nothing else is asked for: none of pictures that teach a neural
/// model, or splats that fill the faces, which evenly spread views are for.
inline float usual_near_share(const DatasetOptions& options) {
  return options.one_sided || !options.choose_views ? 0.0f : DatasetOptions{}.near_share;
}

/// Magnifies a random `share` of the training frames twice, each at a random place: a quarter of
/// what its camera saw.
void bring_near(float share, std::uint64_t seed, std::vector<Frame>& frames);

/// The same with other training frames of the same kinds, chosen by what they show out of five
/// times as many. Test frames stay as they are.
std::vector<Frame> plan_frames(const CinemaScene& scene, const VisibleMatter& matter,
                               const DatasetOptions& options);

/// Makes the dataset in `folder`: seed points, pictures and, last, transforms.json, each beside the
/// claim of what it is made of (claims_of()). What is there of the same claim is kept, and a line
/// on standard error says so; pictures that an interrupted call left are gone on from; what is of
/// another claim is made again. One process at a time may work in a folder (FolderLock). Throws
/// Error.
Dataset make_dataset(const Volume& volume, const Preset& preset,
                     const std::filesystem::path& folder, const DatasetOptions& options);
/// The same of what has finer voxels for others, too, as `options.upsample` says.
Dataset make_dataset(TracedVolume& source, const Preset& preset,
                     const std::filesystem::path& folder, const DatasetOptions& options);

}  // namespace clipgs
