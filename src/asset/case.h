#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include "asset/section_file.h"
#include "asset/webp.h"
#include "asset/zip.h"
#include "core/image.h"
#include "section/openings.h"
#include "splat/scene.h"
#include "train/uniaxial_model.h"

namespace clipgs {

/// A scene, and the volume that the faces of a cut are drawn from, if it has one. A neural model
/// counts as one too, with what it learnt beside its Gaussians; only scenes are packed.
struct Case {
  Case() = default;
  Case(Scene what, std::optional<Section> faces = std::nullopt)  // NOLINT: a scene is a case
      : scene(std::move(what)), section(std::move(faces)) {}

  Scene scene;
  std::optional<Section> section;
  std::optional<UniaxialParameters> model;
  /// Of the section; null: what a cut opens is left to the splats. See prepare_openings().
  std::shared_ptr<const Openings> openings;
};

/// Makes what draws the walls that a cut opens, and lets shadows follow the cut, if the case has a
/// section: a second or so, once.
void prepare_openings(Case& contents);

/// Shows the case under another light rig. Throws Error if it cannot be: without a section, of
/// translucent matter, or by a panorama or near lamps.
void relight(Case& contents, const LightRig& rig);

/// What a case says of itself, without decoding its images.
struct CaseInfo {
  Scene scene;  ///< everything but the Gaussians and their layers
  size_t splats = 0;
  int sh_degree = 0;
  std::optional<SectionInfo> section;
  std::string section_problem;  ///< what is wrong with the section that it should have, or nothing
  bool has_layers = false;
  bool has_face_colors = false;
  size_t bytes = 0;
  std::string generator;  ///< the program that wrote it, with its version
  Bytes thumbnail;        ///< WebP; empty if the case has none
};

/// How much a case may lose, and take. What `bytes` leave room for goes to the section's image
/// first, then to more colours (encode_sog).
struct CaseCoding {
  std::optional<float> section_quality;  ///< of its image, to kLossless; none: the best that fits
  size_t bytes = 5'000'000;              ///< the case should take no more; it does where it must
  Saving saving = Saving::kBytes;        ///< of coding the section
};

/// A case (docs/format.md): a valid SOG with a `clipgs` block beside it. `thumbnail`: 3 or 4
/// channels, display sRGB, or null. The same case gives the same bytes. Throws Error.
Bytes encode_case(const Case& contents, const Image* thumbnail, const CaseCoding& coding = {});
/// The same into a file, whole or not at all.
void write_case(const std::filesystem::path& path, const Case& contents, const Image* thumbnail,
                const CaseCoding& coding = {});

/// What becomes of a case whose section is broken, or of a later version.
enum class BrokenSection {
  kRefused,  ///< Error
  kLeftOut,  ///< warn(); the case is read without: hollow where it is cut, its splats show it
};

/// Reads a case into world space (RAS mm). Throws Error, as one line with `name` in it, on a file
/// that is no case, truncated or corrupt; nothing larger than its images warrant is allocated.
Case read_case(std::span<const std::uint8_t> bytes, const std::string& name,
               BrokenSection broken = BrokenSection::kRefused);
Case read_case(const std::filesystem::path& path, BrokenSection broken = BrokenSection::kRefused);

/// From either of its files: a case, or the .ply of a scene with what lies beside it: its JSON and,
/// perhaps, its section (section_path()) or its model (is_model()). Splats of other programs, and
/// those of clipgs export, are a case, too, see scene_of_splats(): .sog, .ply and .spz. Throws
/// Error.
Case load_case(const std::filesystem::path& path, BrokenSection broken = BrokenSection::kRefused);

CaseInfo read_case_info(std::span<const std::uint8_t> bytes, const std::string& name);
CaseInfo read_case_info(const std::filesystem::path& path);

/// The same from the directory of the ZIP, meta.json and the thumbnail alone, as for an index of
/// many cases: what is broken elsewhere in the file is not noticed, and a file of any size takes
/// little memory.
CaseInfo read_case_summary(const ByteSource& source, const std::string& name);

}  // namespace clipgs
