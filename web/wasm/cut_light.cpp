// What a cut opens, for the viewer: the same C++ as in the program (src/section/openings.h,
// src/light), compiled to WebAssembly and run in a worker of its own.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/image.h"
#include "section/openings.h"

#define EXPORT(name) __attribute__((export_name(#name)))

// Nothing catches: what would throw stops the module.
extern "C" {
void* __cxa_allocate_exception(std::size_t /*size*/) { __builtin_trap(); }
[[noreturn]] void __cxa_throw(void* /*what*/, void* /*type*/, void (* /*end*/)(void*)) {
  __builtin_trap();
}
/// What the C++ library says of what ends it: nobody would read that, and printing is a sixth of
/// the module.
[[noreturn]] void abort_message(const char* /*format*/, ...) { __builtin_trap(); }
}

namespace {

using namespace clipgs;

constexpr int kMostPlanes = 6;
constexpr int kMostKeys = LightRig::kMostKeys;

/// A section without its voxels, as the caller writes it before `prepare`: the fields of Section.
struct Description {
  float dims[3];
  float channels;
  float origin[3];
  float axes[9];
  float spacing[3];
  float source_spacing[3];
  float curve[256];
  float materials[256][12];  // extinction, specular, roughness, surface, interior, boundary
  float steep[2];            // from, to; 0, 0: the section has no such range
  float sky[9];              // top, horizon, bottom
  float key_count;
  float keys[kMostKeys][7];  // direction, radiance, angular radius
};

struct Light {
  Section section;
  std::unique_ptr<Openings> openings;
  std::vector<Vec3> solution;
  std::vector<std::uint8_t> texels;  // sRGB and A: [walls and splats, side, cells, RGBA]
  float scale = 1;                   // what 255 of them stands for
};

Description description;
float planes[kMostPlanes][4];  // each keeps plane·x − plane[3] >= 0
Light light;

Vec3 vec3(const float* v) { return {v[0], v[1], v[2]}; }

LightRig read_rig() {
  LightRig rig{vec3(description.sky), vec3(description.sky + 3), vec3(description.sky + 6), {}};
  const int count = std::clamp(static_cast<int>(description.key_count), 0, kMostKeys);
  for (int i = 0; i < count; ++i) {
    const float* key = description.keys[i];
    rig.keys.push_back({vec3(key), vec3(key + 3), key[6]});
  }
  return rig;
}

float brightest(const std::vector<Vec3>& solution) {
  float most = 1e-6f;
  for (const Vec3& light : solution) {
    most = std::max({most, light.r, light.g, light.b});
  }
  return most;
}

/// Writes the light of every patch at its place, each with 1 as its weight, for walls and then,
/// where patches are lit uncut, for splats on them.
const std::uint8_t* write_texels(const std::vector<Vec3>& solution) {
  const Patches& patches = light.openings->light().patches();
  const size_t cells = patches.grid().cells();
  light.scale = brightest(solution);
  light.texels.assign(2 * 4 * cells * Patches::kSides, 0);
  for (size_t i = 0; i < patches.count(); ++i) {
    const size_t at = static_cast<size_t>(patches.side_of(i)) * cells + patches.cell_of(i);
    std::uint8_t* texel = &light.texels[4 * at];
    for (int c = 0; c < 3; ++c) {
      texel[c] = static_cast<std::uint8_t>(
          std::lround(255 * srgb_from_linear(solution[i][c] / light.scale)));
    }
    texel[3] = 255;
    if (Openings::is_lit(light.openings->own_light()[i])) {
      std::copy_n(texel, 4, texel + 4 * cells * Patches::kSides);
    }
  }
  return light.texels.data();
}

}  // namespace

EXPORT(section_description) float* section_description() { return description.dims; }
EXPORT(cut_planes) float* cut_planes() { return planes[0]; }

/// Room for the section's voxels; what was there before is gone.
EXPORT(reserve) std::uint8_t* reserve(std::uint32_t bytes) {
  light = Light();
  light.section.voxels.resize(bytes);
  return light.section.voxels.data();
}

/// Finds the walls and their horizons. Returns 1 if there are any to draw, and 2 more if what is
/// kept has an outline.
EXPORT(prepare) int prepare() {
  Section& section = light.section;
  section.dims = IVec3(vec3(description.dims));
  section.channels = static_cast<int>(description.channels);
  section.origin = vec3(description.origin);
  for (int k = 0; k < 3; ++k) {
    section.direction[k] = vec3(description.axes + 3 * k);
  }
  section.spacing = vec3(description.spacing);
  section.source_spacing = vec3(description.source_spacing);
  section.curve = ValueCurve(std::vector<float>(description.curve, description.curve + 256));
  for (size_t code = 0; code < section.materials.size(); ++code) {
    const float* m = description.materials[code];
    section.materials[code] = {m[0], m[1], m[2], vec3(m + 3), vec3(m + 6), vec3(m + 9)};
  }
  if (description.steep[1] > 0) {
    section.steep = SteepRange{description.steep[0], description.steep[1]};
  }
  section.rig = read_rig();
  light.openings = std::make_unique<Openings>(section);
  section.voxels = {};  // the walls are known
  return (light.openings->drawn() ? 1 : 0) + (light.openings->outlined() ? 2 : 0);
}

EXPORT(blocks) const std::uint8_t* blocks() {
  return light.openings->empty_space().blocks().data();
}

/// Cells of the light along x, y and z, and their side, mm.
EXPORT(grid) const float* grid() {
  static std::array<float, 4> values;
  const PatchGrid& cells = light.openings->light().patches().grid();
  values = {static_cast<float>(cells.dims.x), static_cast<float>(cells.dims.y),
            static_cast<float>(cells.dims.z), cells.spacing};
  return values.data();
}

/// The light uncut under the section's own lights: sRGB of its share of scale(), and A, as [walls
/// and splats, side, z, y, x, RGBA].
EXPORT(own_light) const std::uint8_t* own_light() {
  return write_texels(light.openings->own_light());
}

/// The brightest of the light that was asked for last, linear.
EXPORT(scale) float scale() { return light.scale; }

/// Lights as the description has them now.
EXPORT(relight) void relight() {
  light.openings->set_rig(read_rig());
  light.solution.clear();
}

/// The light under `count` planes, laid out as own_light(). `quick`: a few bounces, from the
/// solution before, which is near where a plane has moved a little.
EXPORT(solve) const std::uint8_t* solve(int count, bool quick) {
  std::vector<Plane> cut;
  for (int i = 0; i < std::min(count, kMostPlanes); ++i) {
    cut.push_back({vec3(planes[i]), planes[i][3]});
  }
  light.solution = light.openings->solve(cut, quick ? light.solution : std::vector<Vec3>());
  return write_texels(light.solution);
}
