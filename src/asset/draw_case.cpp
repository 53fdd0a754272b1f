#include "asset/draw_case.h"

#include <algorithm>

#include "core/error.h"
#include "core/json_reader.h"
#include "section/outline.h"
#include "section/relight.h"
#include "section/surface.h"
#include "section/tint.h"

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

/// Where the section says that matter ends; nothing if that is left to the splats. The other
/// operators end what a plane cuts in ways of their own.
std::optional<Outline> outline_of(const Case& contents, const Camera& camera, const Cut& cut,
                                  const DrawOptions& options) {
  const bool by_plane = cut.empty() || options.clip == ClipOperator::kExact;
  const bool has_outline = contents.openings && contents.openings->outlined();
  if (!has_outline || contents.model || options.faces == FaceSource::kSplats || !by_plane) {
    return std::nullopt;
  }
  return std::make_optional<Outline>(*contents.section, contents.openings->empty_space(), camera,
                                     cut);
}

/// What `faces` shows after a depth cue, or, `covering`, how much of it is left: of premultiplied
/// colours, or of their alpha. It hides as much as ever of what lies behind.
Image faded(const Image& faces, const Image& distances, const DepthCue& cue, bool covering) {
  Image out = faces;
  for (size_t i = 0; i < out.pixels(); ++i) {
    float* const pixel = &out.data[4 * i];
    const float kept = cue.kept(distances.data[i]);
    for (int c = 0; c < 3; ++c) {
      pixel[c] = kept * (covering ? pixel[3] : pixel[c]);
    }
  }
  return out;
}

/// The same Gaussians, all of them white.
Gaussians whitened(const Gaussians& gaussians) {
  constexpr float kWhite = 0.5f / kShBand0;  // colour = 0.5 + Y₀·c₀
  Gaussians white = gaussians.reshaped(0, false);
  std::fill_n(white.plane(Gaussians::kSh), 3 * white.size(), kWhite);
  return white;
}

/// Draws as draw_case() says, by draw(gaussians, gain, front, surface), where `surface` says
/// whether the section's is drawn. With a cue twice: how a splat hides what is behind it must not
/// change, so what is left of the covering has a picture of its own, in which all is white. Over
/// any background the result then fades towards that.
template <typename Draw>
Image draw_cued(const Gaussians& gaussians, const FaceGain& gain, const std::optional<Image>& faces,
                const std::optional<Image>& distances, const DepthCue& cue, const Draw& draw) {
  if (cue.strength == 0) {
    return draw(gaussians, gain, faces, true);
  }
  const auto front = [&](bool covering) {
    return faces ? std::optional(faded(*faces, *distances, cue, covering)) : std::nullopt;
  };
  Image picture = draw(gaussians, gain, front(false), true);
  const Image covering = draw(whitened(gaussians), FaceGain(), front(true), false);
  for (size_t i = 0; i < picture.pixels(); ++i) {
    float* const pixel = &picture.data[4 * i];
    const float kept = covering.data[4 * i];
    for (int c = 0; c < 3; ++c) {
      pixel[c] = kept > 0 ? std::min(1.0f, pixel[c] / kept) : 0.0f;
    }
    pixel[3] *= kept;
  }
  return picture;
}

/// Faces alone: straight alpha again.
Image straight(const Image& premultiplied_picture) {
  Image picture = premultiplied_picture;
  for (size_t i = 0; i < picture.pixels(); ++i) {
    float* const pixel = &picture.data[4 * i];
    for (int c = 0; pixel[3] > 0 && c < 3; ++c) {
      pixel[c] = std::min(1.0f, pixel[c] / pixel[3]);
    }
  }
  return picture;
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

bool draws_surface(const Case& contents) {
  // Of photographs, brightness does not tell which way a surface faces.
  return contents.openings && contents.openings->drawn() && contents.section->channels == 1;
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
  if (faces && !options.body && !cut.empty()) {
    return straight(*faces);
  }
  const std::optional<Image> distances =
      faces && options.cue.strength > 0
          ? std::optional(face_distances(*contents.section, camera, cut))
          : std::nullopt;
  const std::optional<Outline> outline = outline_of(contents, camera, cut, options);
  const std::optional<Image> surface =
      outline && light && draws_surface(contents)
          ? std::optional(draw_surface(*contents.section, camera, cut, *light, options.cue))
          : std::nullopt;
  const auto draw = [&](const Gaussians& gaussians, const FaceGain& gain, const Cut& kept,
                        const LayerSwitch& switched) {
    return draw_cued(
        gaussians, gain, faces, distances, options.cue,
        [&](const Gaussians& shown, const FaceGain& by, const auto& front, bool on_surface) {
          const bool surface_alone = contents.scene.placed && surface && on_surface;
          Image picture = (options.reference ? render_reference : render)(
              surface_alone ? shown.like(0) : shown, camera, kept, options.clip,
              front ? &*front : nullptr, by, switched, options.cue);
          if (outline) {
            const std::optional<Image> colors =
                surface && on_surface
                    ? std::optional(tinted(premultiplied(picture), front ? &*front : nullptr,
                                           *surface, tint_block(*contents.section, camera)))
                    : std::nullopt;
            draw_outline(picture, front ? &*front : nullptr, *outline, colors ? &*colors : nullptr,
                         options.style.grey > 0);
          }
          return picture;
        });
  };
  if (contents.model) {
    UniaxialState state;
    make_state(contents.scene.gaussians, *contents.model,
               cut.empty() ? std::nullopt : std::optional(cut.planes()[0].offset), state);
    return draw(state.gaussians, {}, Cut(), {});
  }
  return draw(light ? relit(contents.scene.gaussians, *light, contents.section->tone)
                    : contents.scene.gaussians,
              contents.scene.face_gain, cut, layers);
}

Image make_thumbnail(const Case& contents) {
  constexpr int kSize = 256;
  const Camera camera = frame_sphere(contents.scene.sphere, View{30, 10, 1}, kSize, kSize);
  return draw_case(contents, camera, std::nullopt);
}

}  // namespace clipgs
