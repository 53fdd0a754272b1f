#include "asset/draw_case.h"

#include "core/error.h"
#include "core/json_reader.h"
#include "section/relight.h"

namespace clipgs {

namespace {

constexpr const char* kVolumeName = "volume";
constexpr const char* kSplatsName = "splats";

/// The faces of the cut and of the volume's ends, premultiplied; empty if splats show them.
std::optional<Image> faces_of(const Case& contents, const Camera& camera, const Cut& cut,
                              const OpenedLight* light, const DrawOptions& options) {
  if (!contents.section || options.faces == FaceSource::kSplats) {
    return std::nullopt;
  }
  if (options.reference) {
    constexpr int kRays = 9;
    return draw_faces_reference(*contents.section, camera, cut, kRays);
  }
  FaceOptions face_options;
  face_options.style = options.style;
  face_options.light = light;
  return draw_faces(*contents.section, camera, cut, face_options);
}

/// The planes that a model can draw have this normal to within a part of a degree.
constexpr float kSameNormal = 0.99999f;

}  // namespace

FaceSource parse_face_source(const std::string& name) {
  if (name == kVolumeName) {
    return FaceSource::kVolume;
  }
  if (name == kSplatsName) {
    return FaceSource::kSplats;
  }
  throw Error("section \"{}\" does not exist; choose volume or splats", name);
}

const char* face_source_name(FaceSource source) {
  return source == FaceSource::kVolume ? kVolumeName : kSplatsName;
}

bool can_draw(const Case& contents, const Cut& cut, ClipOperator clip) {
  if (contents.model) {
    return cut.empty() || (cut.planes().size() == 1 &&
                           glm::dot(cut.planes()[0].normal, contents.model->normal) > kSameNormal);
  }
  return clip != ClipOperator::kLayers ||
         (!contents.scene.layers.empty() && switches_layers(contents.scene, cut));
}

Image draw_case(const Case& contents, const Camera& camera, const Cut& cut,
                const DrawOptions& options) {
  if (contents.model && !can_draw(contents, cut, options.clip)) {
    const Vec3& n = contents.model->normal;
    throw Error(
        "a neural model is cut by planes of normal {:g},{:g},{:g} alone; make a scene of it with "
        "clipgs bake to cut it at any angle",
        plain_zero(n.x), plain_zero(n.y), plain_zero(n.z));
  }
  const bool by_layers = !contents.model && options.clip == ClipOperator::kLayers;
  const LayerSwitch layers = by_layers ? switch_layers(contents.scene, cut) : LayerSwitch();
  // The splats of a scene that the section was in front of, and it draws the walls.
  std::optional<OpenedLight> light;
  if (contents.openings && contents.openings->drawn() && options.faces == FaceSource::kVolume) {
    light.emplace(*contents.openings, cut);
  }
  const std::optional<Image> faces =
      faces_of(contents, camera, cut, light ? &*light : nullptr, options);
  const auto draw = options.reference ? render_reference : render;
  if (contents.model) {
    UniaxialState state;
    make_state(contents.scene.gaussians, *contents.model,
               cut.empty() ? std::nullopt : std::optional(cut.planes()[0].offset), state);
    return draw(state.gaussians, camera, Cut(), options.clip, faces ? &*faces : nullptr, {}, {});
  }
  return draw(light ? relit(contents.scene.gaussians, *light, contents.section->tone)
                    : contents.scene.gaussians,
              camera, cut, options.clip, faces ? &*faces : nullptr, contents.scene.face_gain,
              layers);
}

Image make_thumbnail(const Case& contents) {
  constexpr int kSize = 256;
  const Camera camera = frame_sphere(contents.scene.sphere, View{30, 10, 1}, kSize, kSize);
  return draw_case(contents, camera, std::nullopt);
}

}  // namespace clipgs
