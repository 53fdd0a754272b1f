// Compiled once per instruction set by Highway; the best one is chosen at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "cinema/path_kernel.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, as Highway demands:
#include <algorithm>
#include <bit>
#include <memory>

#include "cinema/lanes-inl.h"
#include "cinema/path_draws.h"
#include "cinema/path_kernel.h"
#include "cinema/scatter-inl.h"
#include "core/geometry.h"

HWY_BEFORE_NAMESPACE();
namespace clipgs {  // NOLINT(modernize-concat-nested-namespaces): the inner one is a macro
namespace HWY_NAMESPACE {
namespace {

using namespace lanes;  // NOLINT(google-build-using-namespace): of this file's own instruction set

constexpr float kFar = 1e30f;
constexpr float kNothing = 1e-30f;  // majorant of an empty cell: depths are divided by it
constexpr size_t kPadded = PathBatch::kPadded;
using Channel = std::array<float, kPadded>;
using Channels = std::array<Channel, 3>;

HWY_INLINE Float3 load(const Channels& from, size_t at) {
  return {lanes::load(&from[0][at]), lanes::load(&from[1][at]), lanes::load(&from[2][at])};
}
HWY_INLINE Float3 gather(const Channels& from, Int at) {
  return {lanes::gather(from[0].data(), at), lanes::gather(from[1].data(), at),
          lanes::gather(from[2].data(), at)};
}
HWY_INLINE void store(Float3 a, Channels& to, size_t at) {
  lanes::store(a.x, &to[0][at]);
  lanes::store(a.y, &to[1][at]);
  lanes::store(a.z, &to[2][at]);
}
HWY_INLINE void pack(Float3 a, Mask where, Channels& to, size_t at) {
  lanes::pack(a.x, where, &to[0][at]);
  lanes::pack(a.y, where, &to[1][at]);
  lanes::pack(a.z, where, &to[2][at]);
}
HWY_INLINE void scatter(Float3 a, Channels& to, Int at) {
  hn::ScatterIndex(a.x.v, FloatTag(), to[0].data(), at.v);
  hn::ScatterIndex(a.y.v, FloatTag(), to[1].data(), at.v);
  hn::ScatterIndex(a.z.v, FloatTag(), to[2].data(), at.v);
}

/// Optical depth to the next collision for uniform u in [0, 1).
HWY_INLINE Float free_path(Float u) { return -log(Float(1) - u); }

HWY_INLINE Uint hash(Uint x) {
  x = (x ^ shift_right<16>(x)) * Uint(path_draws::kHash1);
  x = (x ^ shift_right<15>(x)) * Uint(path_draws::kHash2);
  return x ^ shift_right<16>(x);
}

// See path_draws.h.
HWY_INLINE Uint permute(Uint x, Uint seed) {
  x = (x ^ (x * Uint(path_draws::kPermute[0]))) + seed;
  x = x * (shift_right<16>(seed) | Uint(1U));
  x = x ^ (x * Uint(path_draws::kPermute[1]));
  return x ^ (x * Uint(path_draws::kPermute[2]));
}
template <int kBits>
HWY_INLINE Uint fold(Uint x, std::uint32_t where) {
  return x ^ shift_right<kBits>(x & Uint(where));
}
HWY_INLINE Uint sobol2(Uint index) {
  index = fold<2>(fold<1>(index, 0xaaaaaaaaU), 0xccccccccU);
  return fold<16>(fold<8>(fold<4>(index, 0xf0f0f0f0U), 0xff00ff00U), 0xffff0000U);
}

/// PCG-RXS-M-XS-32 (O'Neill 2014): the next number in [0, 1) of the lanes of `where`.
HWY_INLINE Float next_random(Uint& state, Mask where) {
  const Uint old = state;
  state = select(where, old * Uint(747796405U) + Uint(2891336453U), old);
  const Uint word = ((old >> (shift_right<28>(old) + Uint(4U))) ^ old) * Uint(277803737U);
  return to_unit(shift_right<22>(word) ^ word);
}

struct Float2 {
  Float u, v;
};

/// See path_draws::draw. A function of its own: inlined a dozen times it takes compilers minutes.
HWY_NOINLINE Float2 sobol_pair(Uint key, Uint index, std::uint32_t pair) {
  const Uint seed = hash(key + Uint((pair + 1) * path_draws::kGolden));
  const Uint at = reverse_bits(permute(reverse_bits(index), seed));
  const auto scrambled = [seed](Uint fraction, std::uint32_t salt) HWY_ATTR {
    return to_unit(reverse_bits(permute(fraction, hash(seed + Uint(salt)))));
  };
  return {scrambled(at, 1), scrambled(sobol2(at), 2)};
}

/// The random numbers of a vertex of paths.
struct Draws {
  Uint key, index, rng;
  int bounce;

  /// A dimension of the even sequence.
  HWY_INLINE Float even(path_draws::Dimension dimension) const {
    const Float2 both = even_pair(dimension);
    return dimension % 2 == 0 ? both.u : both.v;
  }
  /// This dimension and the other one of its pair.
  HWY_INLINE Float2 even_pair(path_draws::Dimension dimension) const {
    return sobol_pair(key, index, dimension / 2);
  }
  HWY_INLINE Float next(Mask where) { return next_random(rng, where); }
  /// Even at the first vertex, any number later.
  HWY_INLINE Float first(path_draws::Dimension dimension, Mask where) {
    return bounce == 0 ? even(dimension) : next(where);
  }
  HWY_INLINE Float2 pair(path_draws::Dimension first_of_pair, Mask where) {
    if (bounce == 0) {
      return even_pair(first_of_pair);
    }
    const Float u = next(where);
    return {u, next(where)};
  }
};

/// Rays to be tracked and where they met matter.
struct Rays {
  size_t count = 0;
  Channels origin;     // voxel space
  Channels direction;  // grid frame, unit
  Channel density;     // probability of the direction where the path turned, 1/sr
  Channel depth;       // in: optical depth of the first tentative collision
  std::array<std::uint32_t, kPadded> rng;
  std::array<std::uint32_t, kPadded> path;   // index into the batch
  Channels weight;                           // of the light that comes from there
  Channel t;                                 // out: mm to the collision, −1 where there is none
  Channel code;                              // out: of the matter that was met
  std::array<std::uint32_t, kPadded> label;  // out: index of its label, if there are labels
};

struct Clipped {
  Float begin, end;  // mm
};

struct Material {
  Float3 albedo;
  Float specular, roughness, phase;
};

/// One of several lights, chosen in proportion to its largest channel as they are offered.
struct Reservoir {
  Float pick;  // uniform in [0, 1): decides, and is stretched to be uniform again
  Float total, weight;
  Float3 light, towards;

  HWY_INLINE explicit Reservoir(Float u)
      : pick(u), total(0), weight(0), light(Vec3(0)), towards(Vec3(0, 0, 1)) {}
  HWY_INLINE void offer(Float3 there, Float3 more) {
    const Float strength = largest(more);
    total = total + strength;
    const Float share = strength / max(total, Float(1e-30f));
    const Mask takes = pick < share;
    pick = select(takes, pick / max(share, Float(1e-30f)),
                  (pick - share) / max(Float(1) - share, Float(1e-30f)));
    weight = select(takes, strength, weight);
    light = select(takes, more, light);
    towards = select(takes, there, towards);
  }
};

/// A point of a light as a vertex sees it.
struct LightSample {
  Float3 towards;     // unit vector
  Float3 irradiance;  // of what faces there
};

struct Vertex {
  Float3 voxel;   // where light leaves from, voxel space
  Float3 before;  // direction of the path up to here, grid frame
  Float3 normal;  // of a surface, towards the viewer
  Material material;
  Mask surface;
};

struct Workspace {
  Rays rays;
  Rays shadows;
  std::array<std::uint32_t, kPadded> hits;
};

class Kernel {
 public:
  Kernel(const PathView& view, PathBatch& batch, Workspace& workspace)
      : view_(view),
        scene_(*view.scene),
        grid_(scene_.grid()),
        labels_(scene_.labels()),
        thinning_(scene_.preset().gradient_opacity ? &*scene_.preset().gradient_opacity : nullptr),
        boundary_(scene_.preset().boundary ? &*scene_.preset().boundary : nullptr),
        majorants_(scene_.majorants()),
        lights_(scene_.lights()),
        batch_(batch),
        rays_(workspace.rays),
        shadows_(workspace.shadows),
        hits_(workspace.hits) {}

  void trace() {
    start_paths();
    track(rays_);
    if (view_.has_floor) {
      catch_shadows(FloorLight::kKeys);
      catch_shadows(FloorLight::kSky);
    }
    for (int bounce = 0;; ++bounce) {
      const size_t hits = find_hits(bounce);
      if (hits == 0 || bounce == view_.max_bounces) {
        return;
      }
      shade(bounce, hits);
      track(shadows_);
      add_unshadowed();
      track(rays_);
    }
  }

 private:
  // --- the volume

  /// Places from the middle of the grid, of voxels counted along the axes from the border's first
  /// one. Sums and products overflow on the way, modulo 2^32, but their end fits: grids have at
  /// most 2^32 voxels.
  HWY_INLINE Int from_middle(Int x, Int y, Int z) const {
    const Int stride_y(static_cast<std::int32_t>(grid_.stride_y()));
    const Int stride_z(static_cast<std::int32_t>(grid_.stride_z()));
    const Int middle(static_cast<std::int32_t>(static_cast<std::uint32_t>(grid_.middle())));
    return z * stride_z + y * stride_y + (x - middle);
  }

  /// Trilinear code at positions in [-1, dims].
  HWY_INLINE Float sample(Float3 voxel) const {
    const Float px = voxel.x + Float(1);  // positive, so that truncation is floor
    const Float py = voxel.y + Float(1);
    const Float pz = voxel.z + Float(1);
    const Int ix = truncate(px);
    const Int iy = truncate(py);
    const Int iz = truncate(pz);
    const std::uint16_t* const codes = grid_.middle_code();
    const Int at = from_middle(ix, iy, iz);
    const Float fx = px - to_float(ix);
    const Float fy = py - to_float(iy);
    const Float fz = pz - to_float(iz);
    const Float near0 = along_x(gather_pair(codes, at), fx);
    const Float near1 = along_x(gather_pair(codes + grid_.stride_y(), at), fx);
    const Float far0 = along_x(gather_pair(codes + grid_.stride_z(), at), fx);
    const Float far1 = along_x(gather_pair(codes + grid_.stride_z() + grid_.stride_y(), at), fx);
    const Float near = near0 + fy * (near1 - near0);
    const Float far = far0 + fy * (far1 - far0);
    return near + fz * (far - near);
  }
  static HWY_INLINE Float along_x(Uint pair, Float f) {
    const Float left = to_float(as_int(pair) & Int(0xffff));
    const Float right = to_float(as_int(shift_right<16>(pair)));
    return left + f * (right - left);
  }

  /// Of the values, per mm, in the grid frame.
  HWY_INLINE Float3 gradient(Float3 p) const {
    const Float one(1);
    const Float3 difference(sample({p.x + one, p.y, p.z}) - sample({p.x - one, p.y, p.z}),
                            sample({p.x, p.y + one, p.z}) - sample({p.x, p.y - one, p.z}),
                            sample({p.x, p.y, p.z + one}) - sample({p.x, p.y, p.z - one}));
    return difference * Float3(0.5f * scene_.gradient_scale());
  }

  /// Of the extinction, for the steepness of the values.
  HWY_NOINLINE Float gradient_factor(Float3 p) const {
    const GradientOpacity& g = *thinning_;
    return Float(g.floor) + Float(1 - g.floor) * rise(gradient(p), g.from, g.to);
  }
  /// 0 where a gradient is `from` or less, 1 from `to` on, linear between.
  static HWY_INLINE Float rise(Float3 slope, float from, float to) {
    const Float steepness = sqrt(dot(slope, slope));
    return min(max((steepness - Float(from)) * Float(1 / (to - from)), Float(0)), Float(1));
  }
  /// gradient(), for presets with a boundary's look: inlined once more it would slow down all
  /// others.
  HWY_NOINLINE Float3 gradient_of_boundary(Float3 p) const { return gradient(p); }

  HWY_INLINE Int entry(Float code) const {
    const Float t = code * Float(scene_.entry_scale()) + Float(scene_.entry_offset());
    return truncate(min(max(t, Float(0)), Float(TransferFunction::kTableSize - 1)));
  }

  static HWY_INLINE Material look_up(const MaterialTables& tables, Int at) {
    Material m;
    m.albedo = {lanes::gather(tables.albedo[0].data(), at),
                lanes::gather(tables.albedo[1].data(), at),
                lanes::gather(tables.albedo[2].data(), at)};
    m.specular = lanes::gather(tables.specular.data(), at);
    m.roughness = lanes::gather(tables.roughness.data(), at);
    m.phase = lanes::gather(tables.phase.data(), at);
    return m;
  }
  /// `boundary`: share of the boundary's look, if the preset has one.
  HWY_INLINE Material material(Float code, Float3 voxel, Float boundary) const {
    const Int at = entry(code);
    Material m = look_up(scene_.materials(), at);
    if (boundary_ != nullptr) {
      const Material steep = look_up(*scene_.boundary_materials(), at);
      m.albedo = m.albedo + boundary * (steep.albedo - m.albedo);
      m.specular = m.specular + boundary * (steep.specular - m.specular);
      m.roughness = m.roughness + boundary * (steep.roughness - m.roughness);
    }
    if (scene_.has_photo()) {
      m.albedo = m.albedo * photo(voxel);
    }
    return m;
  }

  /// The label of one of the eight voxels about the position, drawn with its trilinear weight:
  /// edges are smooth in the mean.
  HWY_INLINE Int draw_label(Float3 voxel, Uint& rng, Mask where) const {
    const Int ix = truncate(voxel.x + Float(1) + next_random(rng, where));
    const Int iy = truncate(voxel.y + Float(1) + next_random(rng, where));
    const Int iz = truncate(voxel.z + Float(1) + next_random(rng, where));
    return gather_byte(labels_->middle_label(), from_middle(ix, iy, iz));
  }
  /// The albedo of the label, where it has one.
  HWY_INLINE Float3 label_albedo(Int label, Float3 otherwise) const {
    const LabelGrid::Looks& looks = labels_->looks();
    const Float3 own(lanes::gather(looks.albedo[0].data(), label),
                     lanes::gather(looks.albedo[1].data(), label),
                     lanes::gather(looks.albedo[2].data(), label));
    return select(lanes::gather(looks.has_albedo.data(), label) > Float(0), own, otherwise);
  }

  HWY_INLINE Float3 photo(Float3 voxel) const {
    std::array<std::array<float, kMost>, 3> at;
    store(voxel.x, at[0].data());
    store(voxel.y, at[1].data());
    store(voxel.z, at[2].data());
    for (size_t i = 0; i < lanes::count(); ++i) {
      const Vec3 color = scene_.photo({at[0][i], at[1][i], at[2][i]});
      at[0][i] = color.x;
      at[1][i] = color.y;
      at[2][i] = color.z;
    }
    return {lanes::load(at[0].data()), lanes::load(at[1].data()), lanes::load(at[2].data())};
  }

  // --- tracking

  /// What the occupied box and the kept half spaces leave of rays; begin >= end if nothing.
  HWY_INLINE Clipped clip(Float3 origin, Float3 step, Float3 inverse) const {
    Clipped c{0, kFar};
    slab(origin.x, inverse.x, view_.box_min.x, view_.box_max.x, c);
    slab(origin.y, inverse.y, view_.box_min.y, view_.box_max.y, c);
    slab(origin.z, inverse.z, view_.box_min.z, view_.box_max.z, c);
    for (size_t i = 0; i < view_.plane_count; ++i) {
      const BlockFace& face = view_.faces[i];
      const Float3 gradient(face.gradient);
      const Float slope = -dot(gradient, step);
      const Float depth = Float(face.offset) - dot(gradient, origin);
      const Float meets = -depth / slope;
      c.begin = select(slope > Float(0), max(c.begin, meets), c.begin);
      c.end = select(slope < Float(0), min(c.end, meets), c.end);
      const Mask outside = ~(slope > Float(0)) & ~(slope < Float(0)) & (depth < Float(0));
      c.end = select(outside, Float(-1), c.end);
    }
    return c;
  }
  static HWY_INLINE void slab(Float origin, Float inverse, float low, float high, Clipped& c) {
    const Float a = (Float(low) - origin) * inverse;
    const Float b = (Float(high) - origin) * inverse;
    c.begin = max(c.begin, min(a, b));
    c.end = min(c.end, max(a, b));
  }

  /// Millimetres along a ray per unit of voxel space; finite.
  static HWY_INLINE Float inverse_of(Float step) {
    return Float(1) / select(abs(step) > Float(1e-20f), step, Float(1e-20f));
  }

  /// Rays on their way, one a lane. A lane whose ray is done takes the next of the queue.
  struct Convoy {
    std::array<std::int32_t, kMost> slots{};
    std::uint32_t owned = 0;  // lanes whose ray's result is not written yet
    Mask active, hit;
    Float3 origin, step, inverse;  // voxel space; voxels per mm; mm per voxel
    Float t;                       // mm
    Float end, last;               // of the macrocell, of the ray, mm
    Float depth;                   // optical depth to the next tentative collision
    Float majorant, code;
    Int label;  // of the last tentative collision, if there are labels
    Uint rng;

    HWY_INLINE Convoy() {
      active = hit = none();
      origin = step = inverse = Float3(Vec3(0));
      t = end = last = depth = code = Float(0);
      majorant = Float(1);
      label = Int(0);
      rng = Uint(0U);
    }
  };

  /// Delta tracking: the first real collision of every ray after `depth` of tentative ones. See
  /// MajorantGrid::walk for the way through the cells.
  HWY_NOINLINE void track(Rays& rays) const {
    Convoy one;
    Convoy two;
    size_t next_ray = 0;
    bool more_one = true;
    bool more_two = true;
    while (more_one || more_two) {
      more_one = more_one && advance(one, rays, next_ray);
      more_two = more_two && advance(two, rays, next_ray);
    }
  }
  HWY_INLINE bool advance(Convoy& c, Rays& rays, size_t& next_ray) const {
    const size_t width = lanes::count();
    const size_t spare = std::max<size_t>(1, width / 4);  // idle lanes that are waited for
    const size_t running = how_many(c.active);
    if (running == 0 || (next_ray < rays.count && running + spare <= width)) {
      write_results(c, rays);
      if (running == 0 && next_ray >= rays.count) {
        return false;
      }
      take_rays(c, rays, next_ray);
    }
    advance(c);
    return true;
  }

  /// Gives the queue's next rays to the lanes that have none.
  HWY_INLINE void take_rays(Convoy& c, const Rays& rays, size_t& next_ray) const {
    std::uint32_t taken = 0;
    for (size_t lane = 0; lane < lanes::count() && next_ray < rays.count; ++lane) {
      if ((c.owned >> lane & 1U) == 0) {
        c.slots[lane] = static_cast<std::int32_t>(next_ray++);
        taken |= 1U << lane;
      }
    }
    c.owned |= taken;
    const Mask fresh = mask_of(taken);
    // What a ray alone determines is computed anew for all lanes.
    const Int slot = lanes::load(c.slots.data());
    c.origin = gather(rays.origin, slot);
    c.step = gather(rays.direction, slot) * Float3(scene_.inverse_spacing());
    c.inverse = {inverse_of(c.step.x), inverse_of(c.step.y), inverse_of(c.step.z)};
    const Clipped kept = clip(c.origin, c.step, c.inverse);
    c.last = kept.end;
    // A ray starts as if it came out of an empty cell.
    c.t = select(fresh, kept.begin, c.t);
    c.end = select(fresh, kept.begin, c.end);
    c.majorant = select(fresh, Float(kNothing), c.majorant);
    c.depth = select(fresh, lanes::gather(rays.depth.data(), slot), c.depth);
    c.rng = select(fresh, lanes::gather(rays.rng.data(), slot), c.rng);
    c.hit = c.hit & ~fresh;
    c.active = c.active | fresh;
  }

  /// Takes every lane to its next event: into another cell, or to a tentative collision.
  HWY_INLINE void advance(Convoy& c) const {
    const Float stop = min(c.end, c.last);
    const Float tentative = c.t + c.depth / c.majorant;
    const Mask collides = c.active & (tentative < stop);
    const Mask crosses = c.active & ~(tentative < stop);
    c.active = c.active & ~(crosses & (c.end >= c.last));
    // Rounding must not make it negative: an empty cell would throw the ray far back.
    const Float spent = c.majorant * max(c.end - c.t, Float(0));
    c.depth = select(crosses, max(c.depth - spent, Float(0)), c.depth);
    c.t = select(collides, tentative, select(crosses, max(c.t, c.end), c.t));

    const Float3 voxel(or_zero(c.active, c.origin + c.t * c.step));
    const Int ix = truncate(voxel.x);
    const Int iy = truncate(voxel.y);
    const Int iz = truncate(voxel.z);
    const MajorantGrid::Cells& cells = majorants_.cells();
    static_assert(MajorantGrid::kCell == 2);
    const Int at = shift_right<1>(iz) * Int(cells.stride_z) +
                   shift_right<1>(iy) * Int(cells.stride_y) + shift_right<1>(ix);
    const Uint cell = lanes::gather(cells.words.data(), at);
    const Float bound = as_float(as_int(cell) & Int(MajorantGrid::kBoundBits));
    const Int bit = (ix & Int(1)) | shift_left<1>(iy & Int(1)) | shift_left<2>(iz & Int(1));
    const Mask matter = collides & equal(as_int(cell >> as_uint(bit)) & Int(1), Int(1));

    // Where a ray leaves the cells that it has come to, or the eight voxels about it if they are
    // air: free paths have no memory, so that it may start anew from there.
    const Mask empty = bound <= Float(0);
    const Float hop = select(empty, -bound, Float(1)) * Float(MajorantGrid::kCell);
    const Float ahead = select(collides, Float(1), hop);
    const Float behind = select(collides, Float(0), Float(MajorantGrid::kCell) - hop);
    const Int low = select(collides, Int(-1), Int(-MajorantGrid::kCell));  // as a mask of bits
    const Float leaves = min(min(leave(ix & low, ahead, behind, c.origin.x, c.inverse.x),
                                 leave(iy & low, ahead, behind, c.origin.y, c.inverse.y)),
                             leave(iz & low, ahead, behind, c.origin.z, c.inverse.z));
    c.t = select(collides & ~matter, max(c.t, leaves), c.t);
    c.end = select(crosses, max(c.t, leaves) + Float(majorants_.nudge()), c.end);
    c.majorant = select(crosses, select(empty, Float(kNothing), bound), c.majorant);

    if (any(matter)) {
      const Float value = sample(or_zero(matter, voxel));
      Float extinction = lanes::gather(scene_.materials().extinction.data(), entry(value));
      if (labels_ != nullptr) {
        c.label = select(matter, draw_label(or_zero(matter, voxel), c.rng, matter), c.label);
        extinction = extinction * lanes::gather(labels_->looks().opacity.data(), c.label);
      }
      const Float level = next_random(c.rng, matter) * c.majorant;
      Mask real = matter & (level < extinction);
      if (thinning_ != nullptr && any(real)) {  // its six samples only where they may matter
        real = real & (level < extinction * gradient_factor(or_zero(real, voxel)));
      }
      c.code = select(real, value, c.code);
      c.hit = c.hit | real;
      c.active = c.active & ~real;
    }
    const Mask again = collides & c.active;
    c.depth = select(again, free_path(next_random(c.rng, again)), c.depth);
  }

  /// Where a ray leaves an interval of voxels, mm: `ahead` of `low` if it runs upwards, else
  /// `behind`.
  static HWY_INLINE Float leave(Int low, Float ahead, Float behind, Float origin, Float inverse) {
    const Float side = to_float(low) + select(inverse > Float(0), ahead, behind);
    return (side - origin) * inverse;
  }

  /// Lane i of the mask is bit i.
  static HWY_INLINE Mask mask_of(std::uint32_t bits) {
    const Uint lane = hn::Iota(UintTag(), 0);
    return equal(as_int(Uint(bits) >> lane) & Int(1), Int(1));
  }

  /// Writes what the rays of idle lanes met.
  HWY_INLINE void write_results(Convoy& c, Rays& rays) const {
    std::array<float, kMost> ts;
    std::array<float, kMost> codes;
    std::array<std::uint32_t, kMost> states;
    std::array<std::uint32_t, kMost> labels;
    store(select(c.hit, c.t, Float(-1)), ts.data());
    store(c.code, codes.data());
    store(c.rng, states.data());
    store(as_uint(c.label), labels.data());
    const std::uint32_t done = c.owned & ~bits(c.active);
    for (std::uint32_t left = done; left != 0; left &= left - 1) {
      const auto lane = static_cast<size_t>(std::countr_zero(left));
      const auto slot = static_cast<size_t>(c.slots[lane]);
      rays.t[slot] = ts[lane];
      rays.code[slot] = codes[lane];
      rays.rng[slot] = states[lane];
      if (labels_ != nullptr) {
        rays.label[slot] = labels[lane];
      }
    }
    c.owned &= ~done;
  }

  // --- paths

  /// The rays of the camera; nothing is known of any path yet.
  void start_paths() {
    for (size_t i = 0; i < batch_.count; i += lanes::count()) {
      const Uint key = lanes::load(&batch_.key[i]);
      const Uint index = lanes::load(&batch_.index[i]);
      const Draws draws{key, index, Uint(0U), 0};
      const Float2 within = draws.even_pair(path_draws::kPixelX);
      const Float column = lanes::load(&batch_.x[i]) + within.u;
      const Float row = lanes::load(&batch_.y[i]) + within.v;
      const Float x = (column - Float(view_.center.x + 0.5f)) / Float(view_.focal.x);
      const Float y = (row - Float(view_.center.y + 0.5f)) / Float(view_.focal.y);
      Float3 origin(view_.camera_voxel);
      Float3 through = x * Float3(view_.right) + y * Float3(view_.down) + Float3(view_.forward);
      if (view_.lens_radius > 0) {
        // Every ray of a pixel meets the others where the pinhole's meets the plane of the focus.
        const Float2 on_lens = draws.even_pair(path_draws::kLensU);
        const Float r = Float(view_.lens_radius) * sqrt(on_lens.u);
        const Float3 offset =
            cylinder(r, on_lens.v, Float(0), view_.right, view_.down, view_.forward);
        origin = origin + offset * Float3(scene_.inverse_spacing());
        through = Float(view_.lens_focus) * through - offset;
      }
      store(origin, rays_.origin, i);
      store(normalize(through), rays_.direction, i);
      store(free_path(draws.even(path_draws::kDistance)), &rays_.depth[i]);
      store(hash(key + hash(index + Uint(path_draws::kGolden))), &rays_.rng[i]);
      store(Uint(hn::Iota(UintTag(), static_cast<std::uint32_t>(i))), &rays_.path[i]);
      store(Float3(Vec3(1)), rays_.weight, i);
      store(Float3(Vec3(0)), batch_.radiance, i);
      store(Float(0), &batch_.alpha[i]);
    }
    if (view_.features) {
      clear_features();
    }
    rays_.count = batch_.count;
  }

  void clear_features() {
    for (size_t i = 0; i < batch_.count; i += lanes::count()) {
      store(Float3(Vec3(0)), batch_.albedo, i);
      store(Float3(Vec3(0)), batch_.normal, i);
      store(Float(0), &batch_.depth[i]);
    }
  }

  /// Lists the rays that met matter; those that left it meet the sky (which the camera does not
  /// see).
  size_t find_hits(int bounce) {
    size_t hits = 0;
    for (size_t i = 0; i < rays_.count; i += lanes::count()) {
      const Mask valid = first(std::min(lanes::count(), rays_.count - i));
      const Mask hit = valid & (lanes::load(&rays_.t[i]) >= Float(0));
      const Uint at = hn::Iota(UintTag(), static_cast<std::uint32_t>(i));
      lanes::pack(at, hit, &hits_[hits]);
      hits += how_many(hit);
      if (bounce > 0) {
        const Float3 light = sky_of_path(load(rays_.direction, i), lanes::load(&rays_.density[i]));
        add(load(rays_.weight, i) * light, path_of(rays_, i, valid & ~hit));
      }
    }
    if (hits > 0) {  // the last lanes must find some hit
      std::fill_n(&hits_[hits], lanes::count(), hits_[hits - 1]);
    }
    return hits;
  }

  /// Of the rays from `i`, those of `where`; others write where nobody reads.
  static HWY_INLINE Int path_of(const Rays& rays, size_t i, Mask where) {
    return select(where, as_int(lanes::load(&rays.path[i])), Int(PathBatch::kCapacity));
  }
  HWY_INLINE void add(Float3 light, Int path) {
    scatter(gather(batch_.radiance, path) + light, batch_.radiance, path);
  }

  void add_unshadowed() {
    for (size_t i = 0; i < shadows_.count; i += lanes::count()) {
      const Mask valid = first(std::min(lanes::count(), shadows_.count - i));
      const Mask lit = valid & (lanes::load(&shadows_.t[i]) < Float(0));
      add(load(shadows_.weight, i), path_of(shadows_, i, lit));
    }
  }

  enum class FloorLight { kKeys, kSky };

  /// Camera rays that met nothing but the floor: a ray to a light, and where matter absorbs it,
  /// that light's share of all is added to alpha.
  void catch_shadows(FloorLight which) {
    shadows_.count = 0;
    for (size_t i = 0; i < rays_.count; i += lanes::count()) {
      const Mask missed =
          first(std::min(lanes::count(), rays_.count - i)) & (lanes::load(&rays_.t[i]) < Float(0));
      const Int path = as_int(lanes::load(&rays_.path[i]));
      Draws draws{lanes::load(&batch_.key[i]), lanes::load(&batch_.index[i]),
                  lanes::load(&rays_.rng[i]), 0};
      Float fade;
      const Vertex vertex = floor_vertex(i, fade);
      const Mask met = missed & (fade > Float(0));
      if (!any(met)) {
        continue;
      }
      // Luminance in shares of all that a free floor receives.
      const Float3 throughput = fade / floor_light(vertex.voxel) * Float3(kLuminance);
      if (which == FloorLight::kKeys) {
        light(vertex, throughput, path, draws, met);
      } else {
        const Float2 turn = draws.even_pair(path_draws::kAngle);
        const Float3 towards = sample_cosine(vertex.normal, turn.u, turn.v);
        const Float3 light = sky_of_path(towards, density(vertex, towards, true));
        cast_shadow(vertex.voxel, towards, throughput * light, path, draws, met);
      }
    }
    track(shadows_);
    for (size_t i = 0; i < shadows_.count; i += lanes::count()) {
      const Mask valid = first(std::min(lanes::count(), shadows_.count - i));
      const Mask dark = valid & (lanes::load(&shadows_.t[i]) >= Float(0));
      const Int path = path_of(shadows_, i, dark);
      const Float3 share = load(shadows_.weight, i);
      const Float alpha = lanes::gather(batch_.alpha.data(), path) + share.x + share.y + share.z;
      hn::ScatterIndex(alpha.v, FloatTag(), batch_.alpha.data(), path.v);
    }
  }

  /// Where the camera's rays from `i` meet the floor: white, and without an edge. `fade` is 0 where
  /// they do not.
  HWY_INLINE Vertex floor_vertex(size_t i, Float& fade) const {
    const Float3 up(view_.floor_up);
    const Float3 direction = load(rays_.direction, i);
    const Float3 origin = load(rays_.origin, i) * Float3(scene_.volume().spacing);
    const Float slope = dot(up, direction);
    const Float distance = dot(up, Float3(view_.floor_middle) - origin) / min(slope, Float(-1e-6f));
    const Float3 point = origin + distance * direction;
    const Float3 away = Float(1 / view_.floor_radius) * (point - Float3(view_.floor_middle));
    const Float inside = max(Float(0), Float(1) - dot(away, away));
    fade = or_zero((slope < Float(0)) & (distance > Float(0)), inside * inside);
    Vertex vertex;
    vertex.voxel = point * Float3(scene_.inverse_spacing());
    vertex.before = direction;
    vertex.normal = up;
    vertex.material = {Float3(Vec3(1)), Float(0), Float(1), Float(0)};
    vertex.surface = first(lanes::count());
    return vertex;
  }

  /// Luminance of a white floor that nothing shadows.
  HWY_INLINE Float floor_light(Float3 voxel) const {
    Float light(view_.floor_light);
    for (const Lights::Key& key : lights_.keys()) {
      if (key.near) {
        const LightSample lamp = illuminate(key, voxel, {Float(0), Float(0)});
        const Float cosine = max(Float(0), dot(Float3(view_.floor_up), lamp.towards));
        light = light + cosine * Float(1 / kPi) * dot(Float3(kLuminance), lamp.irradiance);
      }
    }
    return max(light, Float(1e-6f));
  }

  HWY_INLINE Float3 sky(Float3 direction) const {
    const EnvironmentMap* const map = lights_.environment();
    const Float3 light = gradient_sky(direction);
    return map == nullptr ? light : light + texel_radiance(*map, texel(direction));
  }

  /// What a path that leaves the volume meets. The environment was looked for at its last vertex
  /// too: the balance heuristic (Veach 1995) shares it out between the two ways to find it.
  HWY_INLINE Float3 sky_of_path(Float3 direction, Float density) const {
    const EnvironmentMap* const map = lights_.environment();
    const Float3 light = gradient_sky(direction);
    if (map == nullptr) {
      return light;
    }
    const Int at = texel(direction);
    const Float share = density / (density + texel_density(*map, at, direction));
    return light + share * texel_radiance(*map, at);
  }

  static HWY_INLINE Float sum_of(Float3 v) { return abs(v.x) + abs(v.y) + abs(v.z); }
  /// Between the square of the map and the octahedron seen from above, either way: the lower half
  /// lies outside of the upper one.
  static HWY_INLINE void fold_outwards(Float& x, Float& y, Mask below) {
    const Float folded_x = copy_sign(Float(1) - abs(y), x);
    const Float folded_y = copy_sign(Float(1) - abs(x), y);
    x = select(below, folded_x, x);
    y = select(below, folded_y, y);
  }
  static HWY_INLINE Int texel(Float3 direction) {
    const Float scale = Float(1) / sum_of(direction);
    Float u = scale * direction.x;
    Float v = scale * direction.y;
    fold_outwards(u, v, direction.z < Float(0));
    constexpr float kHalf = 0.5f * EnvironmentMap::kSide;
    const Int last(EnvironmentMap::kSide - 1);
    const Int i = min(max(truncate(u * Float(kHalf) + Float(kHalf)), Int(0)), last);
    const Int j = min(max(truncate(v * Float(kHalf) + Float(kHalf)), Int(0)), last);
    return j * Int(EnvironmentMap::kSide) + i;
  }
  static HWY_INLINE Float3 texel_radiance(const EnvironmentMap& map, Int at) {
    const auto& radiance = map.tables().radiance;
    return {lanes::gather(radiance[0].data(), at), lanes::gather(radiance[1].data(), at),
            lanes::gather(radiance[2].data(), at)};
  }
  static HWY_INLINE Float texel_density(const EnvironmentMap& map, Int at, Float3 direction) {
    const Float sum = sum_of(direction);
    return lanes::gather(map.tables().density.data(), at) / (sum * sum * sum);
  }
  /// A direction in proportion to the map's radiance; `at` is its texel.
  static HWY_INLINE Float3 sample_environment(const EnvironmentMap& map, Float pick, Float u,
                                              Float v, Int& at) {
    constexpr int kTexels = EnvironmentMap::kSide * EnvironmentMap::kSide;
    const Float scaled = pick * Float(kTexels);
    at = min(truncate(scaled), Int(kTexels - 1));  // a pick just below 1 may have been rounded up
    const Mask kept = (scaled - to_float(at)) < lanes::gather(map.tables().keep.data(), at);
    at = select(kept, at, lanes::gather(map.tables().alias.data(), at));
    static_assert(EnvironmentMap::kSide == 1 << 8);
    constexpr float kStep = 2.0f / EnvironmentMap::kSide;
    Float x = (to_float(at & Int(EnvironmentMap::kSide - 1)) + u) * Float(kStep) - Float(1);
    Float y = (to_float(shift_right<8>(at)) + v) * Float(kStep) - Float(1);
    const Float z = Float(1) - abs(x) - abs(y);
    fold_outwards(x, y, z < Float(0));
    return normalize({x, y, z});
  }

  HWY_INLINE Float3 gradient_sky(Float3 direction) const {
    const Lights::Sky& sky = lights_.gradient();
    const Float up = dot(Float3(sky.up), direction);
    const Mask above = up >= Float(0);
    return Float3(sky.horizon) + abs(up) * select(above, Float3(sky.to_top), Float3(sky.to_bottom));
  }

  /// Scatters the paths that hits_ lists: every one sends a ray to a light and goes on.
  void shade(int bounce, size_t hits) {
    shadows_.count = 0;
    size_t kept = 0;
    for (size_t i = 0; i < hits; i += lanes::count()) {
      Mask valid = first(std::min(lanes::count(), hits - i));
      const Int at = as_int(lanes::load(&hits_[i]));
      const Int path =
          select(valid, as_int(lanes::gather(rays_.path.data(), at)), Int(PathBatch::kCapacity));
      Draws draws{lanes::gather(batch_.key.data(), path), lanes::gather(batch_.index.data(), path),
                  lanes::gather(rays_.rng.data(), at), bounce};
      Float3 throughput = gather(rays_.weight, at);
      const Float3 direction = gather(rays_.direction, at);
      const Float3 voxel =
          gather(rays_.origin, at) +
          lanes::gather(rays_.t.data(), at) * (direction * Float3(scene_.inverse_spacing()));
      Float3 slope(Vec3(0));  // of the values, if the look asks for it
      Float boundary(0);
      if (boundary_ != nullptr) {
        slope = gradient_of_boundary(voxel);
        boundary = rise(slope, boundary_->range.from, boundary_->range.to);
        if (bounce == 0) {
          boundary = or_zero(~is_behind_face(voxel, direction), boundary);
        }
      }
      Material material = this->material(lanes::gather(rays_.code.data(), at), voxel, boundary);
      if (labels_ != nullptr) {
        material.albedo =
            label_albedo(as_int(lanes::gather(rays_.label.data(), at)), material.albedo);
      }
      if (bounce == 0) {
        if (view_.features) {
          scatter(material.albedo, batch_.albedo, path);
          hn::ScatterIndex(lanes::gather(rays_.t.data(), at).v, FloatTag(), batch_.depth.data(),
                           path.v);
        }
        hn::ScatterIndex(Float(1).v, FloatTag(), batch_.alpha.data(), path.v);
        valid = valid & ~shade_faces(voxel, direction, material, draws, path);
        if (!any(valid)) {
          continue;
        }
      }
      const Vertex vertex = vertex_at(voxel, boundary_ != nullptr ? slope : gradient(voxel),
                                      direction, material, draws, valid);
      if (bounce == 0 && view_.features) {
        scatter(vertex.normal, batch_.normal, select(valid, path, Int(PathBatch::kCapacity)));
      }
      light(vertex, throughput, path, draws, valid);
      const Float3 onwards = turn(vertex, draws, valid, throughput);
      if (bounce > 0) {
        // Dim paths end.
        const Float survival = min(Float(1), largest(throughput));
        valid = valid & (draws.next(valid) < survival);
        throughput = (Float(1) / survival) * throughput;
      }
      // In place: what is written lies before all that is still to be read.
      pack(vertex.voxel, valid, rays_.origin, kept);
      pack(onwards, valid, rays_.direction, kept);
      pack(throughput, valid, rays_.weight, kept);
      if (lights_.environment() != nullptr) {
        lanes::pack(density(vertex, onwards, bounce == 0), valid, &rays_.density[kept]);
      }
      lanes::pack(free_path(draws.first(path_draws::kDistance2, valid)), valid, &rays_.depth[kept]);
      lanes::pack(draws.rng, valid, &rays_.rng[kept]);
      lanes::pack(as_uint(path), valid, &rays_.path[kept]);
      kept += how_many(valid);
    }
    rays_.count = kept;
  }

  /// Where camera rays met freshly cut matter. Kept matter is convex about its faces, so a point of
  /// a face sees its whole hemisphere free: its diffuse light is known, and only the highlight is
  /// sampled. Such paths end; returns which they are.
  HWY_INLINE Mask shade_faces(Float3 voxel, Float3 direction, const Material& material,
                              const Draws& draws, Int path) {
    // Matter hardly below a face, seen from outside: near an edge, of the face that the ray passed
    // last.
    Float nearest(kFar);
    Mask met = none();
    Float3 normal(Vec3(0));
    Float3 white(Vec3(0));
    for (size_t i = 0; i < view_.face_count; ++i) {
      const BlockFace& face = view_.faces[i];
      const Float depth = Float(face.offset) - dot(Float3(face.gradient), voxel);
      const Float slope = -dot(direction, Float3(face.outward));
      const Mask passed =
          (depth < Float(view_.face_depth)) & (slope > Float(0)) & (depth < nearest * slope);
      nearest = select(passed, depth / slope, nearest);
      normal = select(passed, Float3(face.outward), normal);
      white = select(passed, Float3(face.radiance), white);
      met = met | passed;
    }
    if (!any(met)) {
      return met;
    }
    const Int met_path = select(met, path, Int(PathBatch::kCapacity));
    if (view_.features) {
      scatter(normal, batch_.normal, met_path);
    }
    for (const Lights::Key& key : lights_.keys()) {
      if (key.near) {
        const LightSample light = illuminate(key, voxel, draws.even_pair(path_draws::kDiscU));
        const Float cosine = max(Float(0), dot(normal, light.towards));
        white = white + cosine * Float(1 / kPi) * light.irradiance;
      }
    }
    Float3 radiance = (Float(1) - material.specular) * (material.albedo * white);
    if (any(met & (material.specular > Float(0)))) {
      Float weight;
      const Float2 turn = draws.even_pair(path_draws::kAngle);
      const Float3 in = ggx::sample(normal, -direction, material.roughness, turn.u, turn.v, weight);
      Float3 highlight = weight * sky(in);
      const Float2 on_disc = draws.even_pair(path_draws::kDiscU);
      for (const Lights::Key& key : lights_.keys()) {
        const LightSample light = illuminate(key, voxel, on_disc);
        highlight =
            highlight +
            ggx::evaluate(normal, -direction, light.towards, material.roughness) * light.irradiance;
      }
      radiance = radiance + or_zero(material.specular > Float(0), material.specular * highlight);
    }
    add(radiance, met_path);
    return met;
  }

  /// Whether a camera ray came to a place through matter that begins at a face, and not far: see
  /// BoundaryLook::kFaceVoxels.
  HWY_NOINLINE Mask is_behind_face(Float3 voxel, Float3 direction) const {
    Float nearest(kFar);  // mm back to the face that was passed last
    for (size_t i = 0; i < view_.face_count; ++i) {
      const BlockFace& face = view_.faces[i];
      const Float depth = Float(face.offset) - dot(Float3(face.gradient), voxel);
      const Float slope = -dot(direction, Float3(face.outward));
      const Mask nearer = (slope > Float(0)) & (depth < nearest * slope);
      nearest = select(nearer, depth / slope, nearest);
    }
    const Mask near = nearest < Float(view_.face_reach);
    if (!any(near)) {
      return near;
    }
    const Float3 entered = voxel - nearest * (direction * Float3(scene_.inverse_spacing()));
    const Int at = entry(sample(or_zero(near, entered)));
    return near & (lanes::gather(scene_.materials().extinction.data(), at) > Float(0));
  }

  /// Lights::Key::sample.
  HWY_INLINE LightSample illuminate(const Lights::Key& key, Float3 voxel, Float2 on_disc) const {
    const auto [u, v] = on_disc;
    if (key.near) {
      const Float3 point = Float3(key.position) + cylinder(Float(key.radius) * sqrt(u), v, Float(0),
                                                           key.tangent, key.bitangent, Vec3(0));
      const Float3 way = point - voxel * Float3(scene_.volume().spacing);
      const Float inverse = Float(1) / sqrt(dot(way, way));
      const Float3 towards = inverse * way;
      const Float cosine = max(Float(0), dot(towards, Float3(key.direction)));
      return {towards, cosine * inverse * inverse * Float3(key.intensity)};
    }
    const Float cosine = Float(1) - u * Float(key.one_minus_cos);
    const Float sine = sqrt(max(Float(0), Float(1) - cosine * cosine));
    return {cylinder(sine, v, cosine, key.tangent, key.bitangent, key.direction),
            Float3(key.irradiance)};
  }

  HWY_INLINE Vertex vertex_at(Float3 voxel, Float3 slope, Float3 direction,
                              const Material& material, Draws& draws, Mask valid) const {
    Vertex vertex;
    vertex.voxel = voxel;
    vertex.before = direction;
    vertex.material = material;
    // Surface or phase: P = 1 − exp(−k·‖∇v‖).
    const Float steepness = sqrt(dot(slope, slope));
    const Float u = draws.first(path_draws::kSurface, valid);
    vertex.surface = Float(scene_.preset().surface_strength) * steepness > free_path(u);
    const Float3 normal = or_zero(vertex.surface, (Float(-1) / steepness) * slope);
    vertex.normal = select(dot(normal, direction) > Float(0), -normal, normal);
    // The boundary is blurred over about a voxel and would shadow itself: light leaves from above.
    vertex.voxel = voxel + vertex.normal * Float3(scene_.lift());
    Material& m = vertex.material;
    if (draws.bounce > 0) {
      // Highlights of later vertices would only be noise: the lobe's energy is spread evenly.
      const Float3 even = (Float(1) - m.specular) * m.albedo + m.specular * Float3(Vec3(1));
      m.albedo = select(vertex.surface, even, m.albedo);
      m.specular = Float(0);
    }
    m.specular = or_zero(vertex.surface, m.specular);
    return vertex;
  }

  /// What one steradian of unit radiance from `towards` adds to the light that leaves the vertex.
  static HWY_INLINE Float3 scattered(const Vertex& vertex, Float3 towards, bool first) {
    const Material& m = vertex.material;
    const Float cosine = max(Float(0), dot(vertex.normal, towards));
    const Float diffuse = select(vertex.surface, (Float(1) - m.specular) * cosine * Float(1 / kPi),
                                 henyey_greenstein(dot(vertex.before, towards), m.phase));
    Float3 sum = diffuse * m.albedo;
    const Mask glossy = m.specular > Float(0);
    if (first && any(glossy)) {
      const Float lobe = ggx::evaluate(vertex.normal, -vertex.before, towards, m.roughness);
      sum = sum + or_zero(glossy, m.specular * lobe) * Float3(Vec3(1));
    }
    return sum;
  }

  /// Probability density of the directions that `turn` draws, 1/sr.
  static HWY_INLINE Float density(const Vertex& vertex, Float3 towards, bool first) {
    const Material& m = vertex.material;
    const Float cosine = max(Float(0), dot(vertex.normal, towards));
    Float surface = (Float(1) - m.specular) * cosine * Float(1 / kPi);
    if (first && any(m.specular > Float(0))) {
      surface =
          surface + m.specular * ggx::density(vertex.normal, -vertex.before, towards, m.roughness);
    }
    return select(vertex.surface, surface, henyey_greenstein(dot(vertex.before, towards), m.phase));
  }

  /// Next-event estimation: one key or the environment, chosen by what each would give unshadowed.
  HWY_NOINLINE void light(const Vertex& vertex, Float3 throughput, Int path, Draws& draws,
                          Mask valid) {
    const EnvironmentMap* const map = lights_.environment();
    if (lights_.keys().empty() && map == nullptr) {
      return;
    }
    const bool first = draws.bounce == 0;
    const Float2 on_disc = draws.pair(path_draws::kDiscU, valid);
    Reservoir reservoir(draws.first(path_draws::kKey, valid));
    for (const Lights::Key& key : lights_.keys()) {
      const LightSample sample = illuminate(key, vertex.voxel, on_disc);
      reservoir.offer(sample.towards, scattered(vertex, sample.towards, first) * sample.irradiance);
    }
    if (map != nullptr) {
      // Several directions, one from each part of the table: most lie where the vertex does not
      // look, and to offer them costs little beside the one shadow ray.
      constexpr int kOffers = 4;
      const Float texel = draws.first(path_draws::kTexel, valid);
      for (int i = 0; i < kOffers; ++i) {
        Int at;
        const Float part = (texel + Float(static_cast<float>(i))) * Float(1.0f / kOffers);
        const Float3 there = sample_environment(*map, part, on_disc.u, on_disc.v, at);
        // 1/density, times the balance heuristic's density / (density + the path's own).
        const Float weight = Float(1.0f / kOffers) /
                             (texel_density(*map, at, there) + density(vertex, there, first));
        reservoir.offer(there,
                        weight * (scattered(vertex, there, first) * texel_radiance(*map, at)));
      }
    }
    cast_shadow(vertex.voxel, reservoir.towards,
                reservoir.total / reservoir.weight * (throughput * reservoir.light), path, draws,
                valid & (reservoir.weight > Float(0)));
  }

  /// Asks whether matter lies between a point and what gives it this light.
  HWY_INLINE void cast_shadow(Float3 voxel, Float3 towards, Float3 light, Int path, Draws& draws,
                              Mask lit) {
    const size_t at = shadows_.count;
    pack(voxel, lit, shadows_.origin, at);
    pack(towards, lit, shadows_.direction, at);
    pack(light, lit, shadows_.weight, at);
    lanes::pack(free_path(draws.next(lit)), lit, &shadows_.depth[at]);
    // A sequence of its own, so that path and shadow can be tracked in any order.
    lanes::pack(hash(draws.rng ^ Uint(path_draws::kGolden)), lit, &shadows_.rng[at]);
    lanes::pack(as_uint(path), lit, &shadows_.path[at]);
    shadows_.count += how_many(lit);
  }

  /// A new direction; `throughput` is multiplied by what the vertex lets through that way.
  HWY_INLINE Float3 turn(const Vertex& vertex, Draws& draws, Mask valid, Float3& throughput) const {
    const Material& m = vertex.material;
    const auto [u, v] = draws.bounce == 1 ? draws.even_pair(path_draws::kAngle2)
                                          : draws.pair(path_draws::kAngle, valid);
    Float3 direction = select(vertex.surface, sample_cosine(vertex.normal, u, v),
                              sample_henyey_greenstein(vertex.before, m.phase, u, v));
    Float3 factor = m.albedo;
    if (draws.bounce == 0) {
      const Mask glossy = draws.even(path_draws::kLobe) < m.specular;
      if (any(glossy)) {
        Float weight;
        const Float3 mirrored =
            ggx::sample(vertex.normal, -vertex.before, m.roughness, u, v, weight);
        direction = select(glossy, mirrored, direction);
        factor = select(glossy, {weight, weight, weight}, factor);
      }
    }
    throughput = throughput * factor;
    return direction;
  }

  const PathView& view_;
  const CinemaScene& scene_;
  const VoxelGrid& grid_;
  const LabelGrid* labels_;          // null: none
  const GradientOpacity* thinning_;  // null: none
  const BoundaryLook* boundary_;     // null: none
  const MajorantGrid& majorants_;
  const Lights& lights_;
  PathBatch& batch_;
  Rays& rays_;
  Rays& shadows_;
  std::array<std::uint32_t, kPadded>& hits_;  // rays that met matter
};

void trace(const PathView& view, PathBatch& batch) {
  // Allocated once a thread: the kernel would have to clear fresh pages for every batch.
  static thread_local const auto workspace = std::make_unique<Workspace>();
  Kernel(view, batch, *workspace).trace();
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace clipgs
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace clipgs {

HWY_EXPORT(trace);

void trace_paths(const PathView& view, PathBatch& batch) {
  HWY_DYNAMIC_DISPATCH(trace)(view, batch);
}

}  // namespace clipgs
#endif
