#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

#include "asset/zip.h"
#include "core/image.h"
#include "splat/scene.h"

namespace clipgs {

/// What a case says of itself, without decoding its splats.
struct CaseInfo {
  Scene scene;  ///< everything but the Gaussians
  size_t splats = 0;
  int sh_degree = 0;
  size_t bytes = 0;
  std::string generator;  ///< the program that wrote it, with its version
  Bytes thumbnail;        ///< WebP; empty if the case has none
};

/// A case (docs/format.md): a valid SOG with a `clipgs` block beside it. `thumbnail`: 3 or 4
/// channels, display sRGB, or null. The same scene gives the same bytes. Throws Error.
Bytes encode_case(const Scene& scene, const Image* thumbnail);
/// The same into a file, whole or not at all.
void write_case(const std::filesystem::path& path, const Scene& scene, const Image* thumbnail);

/// Reads a case into world space (RAS mm). Throws Error, as one line with `name` in it, on a file
/// that is no case, truncated or corrupt; nothing larger than its images warrant is allocated.
Scene read_case(std::span<const std::uint8_t> bytes, const std::string& name);
Scene read_case(const std::filesystem::path& path);

/// A scene from either of its files: a case, or a .ply with its JSON beside it. Throws Error.
Scene load_scene(const std::filesystem::path& path);

/// A picture of the whole scene for a list of cases: 256 × 256, RGBA, straight alpha.
Image make_thumbnail(const Scene& scene);

CaseInfo read_case_info(std::span<const std::uint8_t> bytes, const std::string& name);
CaseInfo read_case_info(const std::filesystem::path& path);

}  // namespace clipgs
