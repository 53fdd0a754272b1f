#include "asset/layers.h"

#include <nlohmann/json.hpp>

#include "asset/checksum.h"
#include "asset/sog.h"
#include "core/error.h"

namespace clipgs {

std::string encode_layers(const Scene& scene, std::span<const size_t> order,
                          std::vector<ZipEntry>& files, nlohmann::json& meta) {
  if (scene.layers.size() != order.size()) {
    throw Error("the scene has {} layers for {} splats; bake it again", scene.layers.size(),
                order.size());
  }
  Texels image = splat_texels(order.size());
  for (size_t i = 0; i < order.size(); ++i) {
    const std::uint16_t layer = scene.layers[order[i]];
    if (layer >= scene.states.count) {
      throw Error("layer of splat {} is {}, but the scene has {} states; bake it again", order[i],
                  layer, scene.states.count);
    }
    image.rgba[4 * i] = static_cast<std::uint8_t>(layer);
    image.rgba[4 * i + 1] = static_cast<std::uint8_t>(layer >> 8);
  }
  files.push_back({"layers.webp", encode_webp(image)});
  state_checksum(meta, files.back().name, image.rgba);
  return files.back().name;
}

std::vector<std::uint16_t> decode_layers(const std::string& file,
                                         const std::map<std::string, Bytes>& files,
                                         const nlohmann::json& meta, const Scene& scene,
                                         const std::string& name) {
  const auto found = files.find(file);
  if (found == files.end()) {
    throw Error("{}: has no file \"{}\"; it is incomplete", name, file);
  }
  const size_t count = scene.gaussians.size();
  const Texels size = splat_texels(count);
  const Texels image = decode_webp(found->second, size.width, size.height, name + ": " + file);
  require_stated_checksum(meta, file, image.rgba, name);
  std::vector<std::uint16_t> layers(count);
  for (size_t i = 0; i < count; ++i) {
    const int layer = image.rgba[4 * i] | (image.rgba[4 * i + 1] << 8);
    if (layer >= scene.states.count) {
      throw Error("{}: layer of splat {} is {}, but the scene has {} states; the file is corrupt",
                  name, i, layer, scene.states.count);
    }
    layers[i] = static_cast<std::uint16_t>(layer);
  }
  return layers;
}

}  // namespace clipgs
