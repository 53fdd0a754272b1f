// Which splats to draw and in what order, far to near. Compiled to WebAssembly and run in a worker.
//
// Keeps of each Gaussian what culling and sorting need, as a structure of arrays (48 bytes): the
// mean, the covariance, the opacity, its layer and how far it can be seen. The decoding is that of
// shaders/packed.glsl, the projection's limits those of shaders/gaussian.glsl.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>

#define EXPORT(name) __attribute__((export_name(#name)))

namespace {

constexpr float kAlphaMin = 1.0f / 255.0f;
constexpr float kClipSigma = 3.0f;
constexpr float kBlurDeviation = 0.31622777f;  // √0.1 px
constexpr std::uint32_t kBuckets = 1U << 16;
constexpr int kMaxPlanes = 6;

enum Clip : std::uint32_t { kNone = 0, kHard = 1, kSoft = 2, kExact = 3, kLayers = 4 };

/// How to decode the packed scene; written by the caller before `unpack`.
struct Decoding {
  float mean_min[3];  // in SOG's logarithmic domain
  float mean_max[3];
  float scales[256];  // standard deviations, scene units
};

/// What is looked at; written by the caller before `cull_and_sort`. Scene space and units.
struct View {
  float rotation[9];  // scene → camera, row by row; x right, y down, z forward
  float position[3];
  float tan_min[2];  // the frustum: x/z and y/z of its left and top, right and bottom sides
  float tan_max[2];
  float pixel_angle;  // largest tangent that one pixel spans: 1/focal length
  float near;
  float least_pixels;  // splats that reach no farther are left out
  float plane_count;
  float slab;                   // by layers: those are off …
  float layer_sign;             // … where layer_sign·(layer − slab) > 0
  float planes[kMaxPlanes][4];  // each keeps plane·x − plane[3] >= 0
};

struct Scene {
  std::uint32_t count = 0;
  std::uint32_t* packed = nullptr;  // [count, 4]; freed by unpack
  float* x = nullptr;
  float* y = nullptr;
  float* z = nullptr;
  float* covariance[6] = {};  // xx xy xz yy yz zz
  float* opacity = nullptr;
  float* reach = nullptr;          // √(2 ln(255 α)): sigmas that are visible; negative: none
  float* size = nullptr;           // largest standard deviation
  std::int32_t* layers = nullptr;  // written by the caller; looked at by kLayers alone
  float* depth = nullptr;          // scratch: camera z, or negative where culled
  std::uint32_t* kept = nullptr;   // scratch
  std::uint32_t* order = nullptr;  // the result
  void* block = nullptr;
};

Decoding decoding;
View view;
Clip clip = kNone;
Scene scene;
std::uint32_t histogram[kBuckets];

constexpr int kArrays = 16;  // of 4 bytes each, as `reserve` lays them out

void release() {
  std::free(scene.packed);
  std::free(scene.block);
  scene = Scene();
}

float decode_mean(float v) { return std::copysign(std::exp(std::fabs(v)) - 1.0f, v); }

/// Columns of the rotation matrix of SOG's three bytes and number of the component left out.
void decode_rotation(std::uint32_t quat, float r[3][3]) {
  constexpr float kRoot2 = 1.41421356f;
  float c[3];
  for (int i = 0; i < 3; ++i) {
    c[i] = (static_cast<float>((quat >> (8 * i)) & 255U) / 255.0f - 0.5f) * kRoot2;
  }
  const float m = std::sqrt(std::max(0.0f, 1.0f - c[0] * c[0] - c[1] * c[1] - c[2] * c[2]));
  float q[4];
  for (std::uint32_t i = 0, k = 0; i < 4; ++i) {
    q[i] = i == (quat >> 24) ? m : c[k++];
  }
  const float w = q[0], x = q[1], y = q[2], z = q[3];
  r[0][0] = 1 - 2 * (y * y + z * z), r[0][1] = 2 * (x * y + w * z), r[0][2] = 2 * (x * z - w * y);
  r[1][0] = 2 * (x * y - w * z), r[1][1] = 1 - 2 * (x * x + z * z), r[1][2] = 2 * (y * z + w * x);
  r[2][0] = 2 * (x * z + w * y), r[2][1] = 2 * (y * z - w * x), r[2][2] = 1 - 2 * (x * x + y * y);
}

void unpack_splat(std::uint32_t i) {
  const std::uint32_t* p = scene.packed + 4 * std::size_t{i};
  const float mean[3] = {static_cast<float>(p[0] & 0xffffU), static_cast<float>(p[0] >> 16),
                         static_cast<float>(p[1] & 0xffffU)};
  float* const out[3] = {scene.x, scene.y, scene.z};
  for (int k = 0; k < 3; ++k) {
    const float share = mean[k] / 65535.0f;
    out[k][i] =
        decode_mean(decoding.mean_min[k] + share * (decoding.mean_max[k] - decoding.mean_min[k]));
  }
  float r[3][3];
  decode_rotation(p[2], r);
  float s[3];
  for (int k = 0; k < 3; ++k) {
    s[k] = decoding.scales[(p[3] >> (8 * k)) & 255U];
  }
  for (int a = 0, n = 0; a < 3; ++a) {
    for (int b = a; b < 3; ++b, ++n) {
      float sum = 0;
      for (int k = 0; k < 3; ++k) {
        sum += r[k][a] * r[k][b] * s[k] * s[k];
      }
      scene.covariance[n][i] = sum;
    }
  }
  const float opacity = static_cast<float>(p[3] >> 24) / 255.0f;
  scene.opacity[i] = opacity;
  scene.reach[i] = opacity < kAlphaMin ? -1.0f : std::sqrt(2.0f * std::log(opacity / kAlphaMin));
  scene.size[i] = std::max(s[0], std::max(s[1], s[2]));
}

/// Writes the depth of every splat, −1 for those outside the picture. Without branches, so that the
/// compiler turns it into SIMD.
void cull_unseen() {
  const View v = view;
  const float* const r = v.rotation;
  // |J's row| ≤ √(1 + l²)/z with l inside 1.3 times the frustum.
  const float lx = 1.3f * std::max(std::fabs(v.tan_min[0]), std::fabs(v.tan_max[0]));
  const float ly = 1.3f * std::max(std::fabs(v.tan_min[1]), std::fabs(v.tan_max[1]));
  const float stretch_x = std::sqrt(1.0f + lx * lx);
  const float stretch_y = std::sqrt(1.0f + ly * ly);
  const float blur = kBlurDeviation * v.pixel_angle;
  const float least = v.least_pixels * v.pixel_angle;
  for (std::uint32_t i = 0; i < scene.count; ++i) {
    const float x = scene.x[i] - v.position[0];
    const float y = scene.y[i] - v.position[1];
    const float z = scene.z[i] - v.position[2];
    const float tx = r[0] * x + r[1] * y + r[2] * z;
    const float ty = r[3] * x + r[4] * y + r[5] * z;
    const float tz = r[6] * x + r[7] * y + r[8] * z;
    const float reach = scene.reach[i];
    const float spread = reach * scene.size[i];
    const float half_x = spread * stretch_x + reach * blur * tz;  // extent × z
    const float half_y = spread * stretch_y + reach * blur * tz;
    const bool keep = (reach >= 0.0f) & (spread >= least * tz) & (tz > v.near) &
                      (tx + half_x >= v.tan_min[0] * tz) & (tx - half_x <= v.tan_max[0] * tz) &
                      (ty + half_y >= v.tan_min[1] * tz) & (ty - half_y <= v.tan_max[1] * tz);
    scene.depth[i] = keep ? tz : -1.0f;
  }
}

/// Writes the depth −1 for the splats that a plane removes. Without branches too.
void cull_removed(const float* plane) {
  // The operators differ in where a splat ends: d ≥ −cut·s_n is kept, and opacity·w ≥ 1/255.
  const float cut = clip == kExact ? kClipSigma : clip == kSoft ? 1.0f : 0.0f;
  const bool fades = clip == kSoft;
  const float nx = plane[0], ny = plane[1], nz = plane[2], offset = plane[3];
  for (std::uint32_t i = 0; i < scene.count; ++i) {
    const float d = nx * scene.x[i] + ny * scene.y[i] + nz * scene.z[i] - offset;
    const float variance =
        nx * nx * scene.covariance[0][i] + ny * ny * scene.covariance[3][i] +
        nz * nz * scene.covariance[5][i] +
        2.0f * (nx * ny * scene.covariance[1][i] + nx * nz * scene.covariance[2][i] +
                ny * nz * scene.covariance[4][i]);
    const float deviation = std::sqrt(variance);
    // soft: α·(½ + d/(2 s_n)) ≥ 1/255, multiplied by 2 s_n
    const bool visible = scene.opacity[i] * (deviation + d) >= 2.0f * kAlphaMin * deviation;
    const bool keep = (d >= -cut * deviation) & (!fades | visible);
    scene.depth[i] = keep ? scene.depth[i] : -1.0f;
  }
}

/// Writes the depth −1 for the splats whose layer is off.
void cull_layers() {
  const auto slab = static_cast<std::int32_t>(view.slab);
  const auto sign = static_cast<std::int32_t>(view.layer_sign);
  for (std::uint32_t i = 0; i < scene.count; ++i) {
    scene.depth[i] = sign * (scene.layers[i] - slab) <= 0 ? scene.depth[i] : -1.0f;
  }
}

}  // namespace

extern "C" {

/// Room for `count` splats; frees the scene before. Returns 0 when memory is out.
EXPORT(reserve) int reserve(std::uint32_t count) {
  release();
  scene.packed = static_cast<std::uint32_t*>(std::malloc(std::size_t{count} * 16));
  scene.block = std::malloc(std::size_t{count} * kArrays * 4);
  if (scene.packed == nullptr || scene.block == nullptr) {
    release();
    return 0;
  }
  scene.count = count;
  auto* next = static_cast<float*>(scene.block);
  const auto take = [&] {
    float* array = next;
    next += count;
    return array;
  };
  scene.x = take();
  scene.y = take();
  scene.z = take();
  for (float*& plane : scene.covariance) {
    plane = take();
  }
  scene.opacity = take();
  scene.reach = take();
  scene.size = take();
  scene.layers = reinterpret_cast<std::int32_t*>(take());
  scene.depth = take();
  scene.kept = reinterpret_cast<std::uint32_t*>(take());
  scene.order = reinterpret_cast<std::uint32_t*>(take());
  return 1;
}

EXPORT(packed_scene) std::uint32_t* packed_scene() { return scene.packed; }
EXPORT(scene_layers) std::int32_t* scene_layers() { return scene.layers; }
EXPORT(decoding_floats) Decoding* decoding_floats() { return &decoding; }
EXPORT(view_floats) View* view_floats() { return &view; }
EXPORT(draw_order) std::uint32_t* draw_order() { return scene.order; }

/// Decodes what was written to `packed_scene` and `decoding_floats`.
EXPORT(unpack) void unpack() {
  for (std::uint32_t i = 0; i < scene.count; ++i) {
    unpack_splat(i);
  }
  std::free(scene.packed);
  scene.packed = nullptr;
}

/// Writes the indices of the splats that `view_floats` may show, cut by operator `clip_operator`
/// (0 none, 1 hard, 2 soft, 3 exact, 4 layers), far to near, to `draw_order`; returns how many.
EXPORT(cull_and_sort) std::uint32_t cull_and_sort(std::uint32_t clip_operator) {
  clip = static_cast<Clip>(clip_operator);
  cull_unseen();
  if (clip == kLayers) {
    cull_layers();
  }
  const bool by_planes = clip != kNone && clip != kLayers;
  for (int i = 0; by_planes && i < static_cast<int>(view.plane_count); ++i) {
    cull_removed(view.planes[i]);
  }
  float nearest = INFINITY;
  float farthest = 0;
  std::uint32_t count = 0;
  for (std::uint32_t i = 0; i < scene.count; ++i) {
    const float depth = scene.depth[i];
    scene.kept[count] = i;
    if (depth >= 0.0f) {
      ++count;
      nearest = std::min(nearest, depth);
      farthest = std::max(farthest, depth);
    }
  }
  if (count == 0) {
    return 0;
  }
  // A stable counting sort over 2¹⁶ depths between the nearest and the farthest.
  const float scale = farthest > nearest ? (kBuckets - 1) / (farthest - nearest) : 0.0f;
  const auto bucket = [&](std::uint32_t i) {
    return static_cast<std::uint32_t>((farthest - scene.depth[i]) * scale);
  };
  std::fill(histogram, histogram + kBuckets, 0U);
  for (std::uint32_t k = 0; k < count; ++k) {
    ++histogram[bucket(scene.kept[k])];
  }
  std::uint32_t begin = 0;
  for (std::uint32_t& entry : histogram) {
    const std::uint32_t n = entry;
    entry = begin;
    begin += n;
  }
  for (std::uint32_t k = 0; k < count; ++k) {
    const std::uint32_t i = scene.kept[k];
    scene.order[histogram[bucket(i)]++] = i;
  }
  return count;
}

}  // extern "C"
