#pragma once

#include <filesystem>
#include <string>

#include "asset/case.h"
#include "core/file.h"
#include "core/image.h"

namespace clipgs::test {

/// A scene of 20 splats with that title.
inline Scene small_scene(const std::string& title) {
  Scene scene;
  scene.gaussians = Gaussians(20, 0);
  for (size_t i = 0; i < scene.gaussians.size(); ++i) {
    scene.gaussians.plane(Gaussians::kMean)[i] = static_cast<float>(i);
    scene.gaussians.plane(Gaussians::kRotation)[i] = 1;
  }
  scene.sphere = {Vec3(10, 0, 0), 12};
  scene.bounds = {Vec3(0, -1, -1), Vec3(20, 1, 1)};
  scene.extent = {-1, 1};
  scene.title = title;
  scene.preset = "bone";
  return scene;
}

/// A case of it, with a thumbnail.
inline void write_small_case(const std::filesystem::path& path, const std::string& title) {
  const Image thumbnail(32, 32, 3);
  write_case(path, {small_scene(title)}, &thumbnail);
}

/// A case with `room` more bytes in it that nobody decodes.
inline void write_large_case(const std::filesystem::path& path, size_t room) {
  std::vector<ZipEntry> entries = {{"padding", Bytes(room)}};
  for (const auto& [name, bytes] :
       read_zip(encode_case({small_scene("Large")}, nullptr), "large")) {
    entries.push_back({name, bytes});
  }
  const Bytes zip = write_zip(entries);
  write_file(path, zip.data(), zip.size());
}

}  // namespace clipgs::test
