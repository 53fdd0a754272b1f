// Compiled once per instruction set by Highway; the best one is chosen at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "splat/tile_kernel.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, as Highway demands:
#include <algorithm>
#include <cmath>
#include <hwy/contrib/math/math-inl.h>
#include <hwy/highway.h>

#include "splat/clip.h"
#include "splat/tile_kernel.h"

HWY_BEFORE_NAMESPACE();
namespace clipgs {  // NOLINT(modernize-concat-nested-namespaces): the inner one is a macro
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using D = hn::CappedTag<float, kTileSize>;
using V = hn::Vec<D>;

/// The part of a tile that a splat's box touches: rows [y_begin, y_end), columns likewise in steps
/// of a whole vector.
struct Window {
  int y_begin, y_end, x_begin, x_end;
};

/// First and one-past-last pixel index of the tile whose centre lies within center ± extent.
HWY_INLINE void pixel_range(float center, float extent, float origin, int& begin, int& end) {
  const float first = std::ceil(center - extent - 0.5f - origin);
  const float last = std::floor(center + extent - 0.5f - origin);
  begin = static_cast<int>(std::clamp(first, 0.0f, static_cast<float>(kTileSize)));
  end = static_cast<int>(std::clamp(last + 1.0f, 0.0f, static_cast<float>(kTileSize)));
}

HWY_INLINE Window window_of(const Splat& s, float x0, float y0) {
  const int lanes = static_cast<int>(hn::Lanes(D()));
  Window w;
  pixel_range(s.y, s.extent_y, y0, w.y_begin, w.y_end);
  pixel_range(s.x, s.extent_x, x0, w.x_begin, w.x_end);
  w.x_begin = w.x_begin / lanes * lanes;
  return w;
}

/// Φ(z) by the logistic approximation.
HWY_INLINE V normal_cdf(V z) {
  const D d;
  const V cubic = hn::MulAdd(hn::Set(d, kCdfCubic), hn::Mul(z, z), hn::Set(d, kCdfLinear));
  // Below −80 Φ is 0 to single precision, and Exp would overflow.
  const V u = hn::Max(hn::Mul(z, cubic), hn::Set(d, -80.0f));
  return hn::Div(hn::Set(d, 1.0f), hn::Add(hn::Set(d, 1.0f), hn::Exp(d, hn::Neg(u))));
}

/// α before the clamp at one vector of pixels; `z` and `cdf` are set for clipped splats.
template <bool kClipped>
HWY_INLINE V alpha_at(const Splat& s, V dx, float dy, V& z, V& cdf) {
  const D d;
  const V power = hn::MulAdd(dx, hn::MulAdd(hn::Set(d, s.qa), dx, hn::Set(d, s.qb * dy)),
                             hn::Set(d, s.qc * dy * dy));
  // NOLINTNEXTLINE(misc-const-correctness): only where kClipped is false
  V alpha = hn::Mul(hn::Set(d, s.opacity), hn::Exp(d, power));
  if constexpr (kClipped) {
    z = hn::MulAdd(hn::Set(d, s.zx), dx, hn::Set(d, s.z0 + s.zy * dy));
    cdf = normal_cdf(z);
    alpha = hn::Mul(alpha, cdf);
  }
  return alpha;
}

HWY_INLINE V pixel_dx(int x, float x0, const Splat& s) {
  const D d;
  return hn::Sub(hn::Iota(d, static_cast<float>(x)), hn::Set(d, s.x - x0 - 0.5f));
}

/// What all planes leave: `cdf` is that of the first.
HWY_INLINE V share_of_planes(V cdf, const PlaneCut* more, std::uint32_t count, V dx, float dy) {
  const D d;
  const V one = hn::Set(d, 1.0f);
  V product = one;
  V last = cdf;
  for (std::uint32_t k = 0; k < count; ++k) {
    const PlaneCut& cut = more[k];
    const V next = normal_cdf(hn::MulAdd(hn::Set(d, cut.zx), dx, hn::Set(d, cut.z0 + cut.zy * dy)));
    if (cut.opposite) {
      last = hn::Max(hn::Sub(hn::Add(last, next), one), hn::Zero(d));
    } else {
      product = hn::Mul(product, last);
      last = next;
    }
  }
  return hn::Mul(product, last);
}

/// How many planes cut a splat, as far as it makes other code.
enum class Planes { kNone, kOne, kMany };

template <Planes kPlanes>
void blend(const Splat& s, const PlaneCut* more, float x0, float y0, const TileLimits& limits,
           Tile& tile) {
  const D d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const Window w = window_of(s, x0, y0);
  for (int y = w.y_begin; y < w.y_end; ++y) {
    const float dy = y0 + static_cast<float>(y) + 0.5f - s.y;
    for (int x = w.x_begin; x < w.x_end; x += lanes) {
      V z, cdf;
      const V dx = pixel_dx(x, x0, s);
      V alpha = alpha_at < kPlanes == Planes::kOne > (s, dx, dy, z, cdf);
      if constexpr (kPlanes == Planes::kMany) {
        const V first = normal_cdf(hn::MulAdd(hn::Set(d, s.zx), dx, hn::Set(d, s.z0 + s.zy * dy)));
        alpha = hn::Mul(alpha, share_of_planes(first, more, s.clipped - 1, dx, dy));
      }
      alpha = hn::Min(alpha, hn::Set(d, limits.alpha_max));
      const int at = y * kTileSize + x;
      const V t = hn::Load(d, tile.t + at);
      const auto used = hn::And(hn::Ge(alpha, hn::Set(d, limits.alpha_min)),
                                hn::Ge(t, hn::Set(d, limits.transmittance_min)));
      alpha = hn::IfThenElseZero(used, alpha);
      const V weight = hn::Mul(alpha, t);
      hn::Store(hn::MulAdd(weight, hn::Set(d, s.r), hn::Load(d, tile.r + at)), d, tile.r + at);
      hn::Store(hn::MulAdd(weight, hn::Set(d, s.g), hn::Load(d, tile.g + at)), d, tile.g + at);
      hn::Store(hn::MulAdd(weight, hn::Set(d, s.b), hn::Load(d, tile.b + at)), d, tile.b + at);
      hn::Store(hn::Sub(t, weight), d, tile.t + at);
    }
  }
}

bool all_finished(const Tile& tile, float transmittance_min) {
  const D d;
  V most = hn::Zero(d);
  for (int i = 0; i < kTilePixels; i += static_cast<int>(hn::Lanes(d))) {
    most = hn::Max(most, hn::Load(d, tile.t + i));
  }
  return hn::GetLane(hn::MaxOfLanes(d, most)) < transmittance_min;
}

size_t forward(const Splat* splats, const MoreCuts& more, const std::uint32_t* list, size_t count,
               float x0, float y0, const TileLimits& limits, Tile& tile) {
  constexpr size_t kCheckEvery = 16;
  if (all_finished(tile, limits.transmittance_min)) {
    return 0;
  }
  for (size_t k = 0; k < count; ++k) {
    const Splat& s = splats[list[k]];
    if (s.clipped == 0) {
      blend<Planes::kNone>(s, nullptr, x0, y0, limits, tile);
    } else if (s.clipped == 1) {
      blend<Planes::kOne>(s, nullptr, x0, y0, limits, tile);
    } else {
      blend<Planes::kMany>(s, more.cuts + list[k] * more.stride, x0, y0, limits, tile);
    }
    if (k % kCheckEvery == kCheckEvery - 1 && all_finished(tile, limits.transmittance_min)) {
      return k + 1;
    }
  }
  return count;
}

/// Running state of the backward pass, which walks front to back like the forward pass: the
/// transmittance in front of the current splat, and what is left behind it of g·C − g_α·T_final.
struct alignas(64) Walk {
  float t[kTilePixels];
  float rest[kTilePixels];
};

template <bool kClipped>
void blend_backward(const Splat& s, float x0, float y0, const TileLimits& limits,
                    const Tile& gradient, Walk& walk, SplatGradient& out) {
  const D d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const V one = hn::Set(d, 1.0f);
  V h0 = hn::Zero(d), hx = h0, hy = h0, hxx = h0, hxy = h0, hyy = h0;
  V red = h0, green = h0, blue = h0, e0 = h0, ex = h0, ey = h0;
  const Window w = window_of(s, x0, y0);
  for (int y = w.y_begin; y < w.y_end; ++y) {
    const float dy_scalar = y0 + static_cast<float>(y) + 0.5f - s.y;
    const V dy = hn::Set(d, dy_scalar);
    for (int x = w.x_begin; x < w.x_end; x += lanes) {
      V z, cdf;
      const V dx = pixel_dx(x, x0, s);
      const V raw = alpha_at<kClipped>(s, dx, dy_scalar, z, cdf);
      V alpha = hn::Min(raw, hn::Set(d, limits.alpha_max));
      const int at = y * kTileSize + x;
      const V t = hn::Load(d, walk.t + at);
      const auto used = hn::And(hn::Ge(alpha, hn::Set(d, limits.alpha_min)),
                                hn::Ge(t, hn::Set(d, limits.transmittance_min)));
      if (hn::AllFalse(d, used)) {
        continue;
      }
      alpha = hn::IfThenElseZero(used, alpha);
      const V weight = hn::Mul(alpha, t);
      const V gr = hn::Load(d, gradient.r + at);
      const V gg = hn::Load(d, gradient.g + at);
      const V gb = hn::Load(d, gradient.b + at);
      red = hn::MulAdd(weight, gr, red);
      green = hn::MulAdd(weight, gg, green);
      blue = hn::MulAdd(weight, gb, blue);
      const V u = hn::MulAdd(gr, hn::Set(d, s.r),
                             hn::MulAdd(gg, hn::Set(d, s.g), hn::Mul(gb, hn::Set(d, s.b))));
      const V rest = hn::NegMulAdd(weight, u, hn::Load(d, walk.rest + at));
      hn::Store(rest, d, walk.rest + at);
      hn::Store(hn::Sub(t, weight), d, walk.t + at);
      const V g_alpha = hn::Sub(hn::Mul(t, u), hn::Div(rest, hn::Sub(one, alpha)));
      // A clamped α does not move with the parameters.
      const auto moves = hn::And(used, hn::Lt(raw, hn::Set(d, limits.alpha_max)));
      const V h = hn::IfThenElseZero(moves, hn::Mul(g_alpha, alpha));
      const V h_dx = hn::Mul(h, dx);
      const V h_dy = hn::Mul(h, dy);
      h0 = hn::Add(h0, h);
      hx = hn::Add(hx, h_dx);
      hy = hn::Add(hy, h_dy);
      hxx = hn::MulAdd(h_dx, dx, hxx);
      hxy = hn::MulAdd(h_dx, dy, hxy);
      hyy = hn::MulAdd(h_dy, dy, hyy);
      if constexpr (kClipped) {
        // ∂ln Φ/∂z = u'(z)·(1 − Φ) for the logistic form Φ = 1/(1 + exp(−u)).
        const V slope =
            hn::MulAdd(hn::Set(d, 3 * kCdfCubic), hn::Mul(z, z), hn::Set(d, kCdfLinear));
        const V e = hn::Mul(h, hn::Mul(slope, hn::Sub(one, cdf)));
        e0 = hn::Add(e0, e);
        ex = hn::MulAdd(e, dx, ex);
        ey = hn::MulAdd(e, dy, ey);
      }
    }
  }
  const auto sum = [&](V v) { return hn::GetLane(hn::SumOfLanes(d, v)); };
  out = {sum(h0),  sum(hx),    sum(hy),   sum(hxx), sum(hxy), sum(hyy),
         sum(red), sum(green), sum(blue), 0,        0,        0};
  if constexpr (kClipped) {
    out.e = sum(e0);
    out.ex = sum(ex);
    out.ey = sum(ey);
  }
}

void backward(const Splat* splats, const std::uint32_t* list, const std::uint32_t* slots,
              size_t count, float x0, float y0, const TileLimits& limits, const Tile& before,
              const Tile& after, const Tile& gradient, SplatGradient* out) {
  Walk walk;
  for (int i = 0; i < kTilePixels; ++i) {
    walk.t[i] = before.t[i];
    walk.rest[i] = gradient.r[i] * (after.r[i] - before.r[i]) +
                   gradient.g[i] * (after.g[i] - before.g[i]) +
                   gradient.b[i] * (after.b[i] - before.b[i]) - gradient.t[i] * after.t[i];
  }
  for (size_t k = 0; k < count; ++k) {
    const Splat& s = splats[list[k]];
    if (s.clipped != 0) {
      blend_backward<true>(s, x0, y0, limits, gradient, walk, out[slots[k]]);
    } else {
      blend_backward<false>(s, x0, y0, limits, gradient, walk, out[slots[k]]);
    }
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace clipgs
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace clipgs {

HWY_EXPORT(forward);
HWY_EXPORT(backward);

size_t tile_forward(const Splat* splats, const MoreCuts& more, const std::uint32_t* list,
                    size_t count, float x0, float y0, const TileLimits& limits, Tile& tile) {
  return HWY_DYNAMIC_DISPATCH(forward)(splats, more, list, count, x0, y0, limits, tile);
}

void tile_backward(const Splat* splats, const std::uint32_t* list, const std::uint32_t* slots,
                   size_t count, float x0, float y0, const TileLimits& limits, const Tile& before,
                   const Tile& after, const Tile& gradient, SplatGradient* out) {
  HWY_DYNAMIC_DISPATCH(backward)(splats, list, slots, count, x0, y0, limits, before, after,
                                 gradient, out);
}

}  // namespace clipgs
#endif
