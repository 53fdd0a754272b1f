#include "cinema/picture.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "cinema/path_tracer.h"
#include "core/mask.h"
#include "core/parallel.h"
#include "core/progress.h"
#include "core/random.h"

namespace clipgs {
namespace {

constexpr int kTile = 16;
constexpr int kFirstRound = 8;   // samples of every pixel before any noise is known
constexpr double kGrowth = 4;    // a round adds at most this multiple of what a pixel has
constexpr int kNoiseRadius = 2;  // px: squared differences of halves are smoothed this far

struct PixelSums {
  std::array<Vec4, 2> halves{Vec4(0), Vec4(0)};  // radiance, hits
  int samples = 0;                               // in each half
};

struct FeatureSums {
  Vec3 albedo{0};
  Vec3 normal{0};
  float depth = 0;
};

// One picture in the making.
class Rendering {
 public:
  Rendering(const CinemaScene& scene, const Camera& camera, const Cut& cut,
            const PictureOptions& options)
      : tracer_(scene, camera, cut, options.max_bounces,
                {options.lens, options.floor, options.features}),
        transform_(scene.preset().display()),
        background_(options.floor ? 1.0f : 0.0f),  // shadows are black
        options_(options),
        width_(camera.width),
        height_(camera.height),
        sums_(static_cast<size_t>(width_) * static_cast<size_t>(height_)),
        features_(options.features ? sums_.size() : 0),
        wanted_(sums_.size(), 0) {}

  // Brings every pixel to wanted_ samples in each half.
  void trace() {
    const int tiles_x = (width_ + kTile - 1) / kTile;
    const int tiles_y = (height_ + kTile - 1) / kTile;
    parallel_for(static_cast<size_t>(tiles_x) * static_cast<size_t>(tiles_y), 1,
                 [&](size_t tile, size_t) {
                   const int column = static_cast<int>(tile) % tiles_x;
                   const int row = static_cast<int>(tile) / tiles_x;
                   trace_tile(column * kTile, row * kTile);
                 });
  }

  void want_everywhere(int samples) { std::ranges::fill(wanted_, samples); }

  // Shares out samples in proportion to each pixel's standard deviation, which is the best use of
  // them for the mean squared error. False if there is nothing left to do.
  bool plan() {
    const std::vector<float> deviation = deviations();
    double sum = 0;
    double matter = 0;
    double spent = 0;
    for (size_t i = 0; i < sums_.size(); ++i) {
      sum += deviation[i];
      matter += deviation[i] > 0 ? 1 : 0;
      spent += deviation[i] > 0 ? sums_[i].samples : 0;
    }
    const double budget = 0.5 * options_.spp * matter;
    if (sum <= 0 || spent >= 0.98 * budget) {
      return false;
    }
    // Half-samples a unit of deviation: what is left of the budget, or what the target needs.
    double density = budget / sum;
    if (options_.noise_db > 0) {
      const double now = error();
      const double target =
          std::min(mse_of(options_.noise_db), mask_share() * mse_of(options_.masked_noise_db));
      if (now <= target) {
        return false;
      }
      // At n = density·σ the squared error is Σσ²/n/N = Σσ/density/N.
      const double needed = sum / (target * static_cast<double>(sums_.size()));
      density = std::min(density, needed);
    }
    double added = 0;
    for (size_t i = 0; i < sums_.size(); ++i) {
      const double share = std::min(density * deviation[i], (1 + kGrowth) * sums_[i].samples);
      wanted_[i] = std::max(sums_[i].samples, static_cast<int>(std::lround(share)));
      added += wanted_[i] - sums_[i].samples;
    }
    // Estimates of the noise wander: a round always moves on by a tenth, or it would crawl.
    if (added < 0.1 * spent) {
      const double factor = 1 + std::min(0.15, (budget - spent) / std::max(spent, 1.0));
      for (size_t i = 0; i < sums_.size(); ++i) {
        if (deviation[i] > 0) {
          wanted_[i] = static_cast<int>(std::ceil(factor * sums_[i].samples));
        }
      }
    }
    return true;
  }

  // A little below that of the noise floor.
  static double mse_of(float noise_db) {
    return std::pow(10.0, -0.1 * (static_cast<double>(noise_db) + 0.05));
  }

  // Of the pixels; all of the error lies in these.
  double mask_share() const {
    const auto masked = std::ranges::count_if(sums_, [](const PixelSums& pixel) {
      return pixel.halves[0].w + pixel.halves[1].w >
             2 * kMaskAlpha * static_cast<float>(pixel.samples);
    });
    return static_cast<double>(masked) / static_cast<double>(sums_.size());
  }

  // Mean squared error of the displayed mean, over pixels and channels.
  double error() const {
    double sum = 0;
    for (const PixelSums& pixel : sums_) {
      sum += pixel_error(pixel);
    }
    return sum / static_cast<double>(sums_.size());
  }

  double share_done() const {
    double done = 0;
    double all = 0;
    for (const PixelSums& pixel : sums_) {
      if (pixel.halves[0].w + pixel.halves[1].w > 0) {
        done += 2.0 * pixel.samples;
        all += options_.spp;
      }
    }
    return all > 0 ? done / all : 1;
  }

  Picture picture() const {
    Picture picture;
    picture.half_a = Image(width_, height_, 4);
    picture.half_b = Image(width_, height_, 4);
    for (size_t i = 0; i < sums_.size(); ++i) {
      const float scale = 1.0f / static_cast<float>(std::max(1, sums_[i].samples));
      for (int c = 0; c < 4; ++c) {
        picture.half_a.data[4 * i + static_cast<size_t>(c)] = sums_[i].halves[0][c] * scale;
        picture.half_b.data[4 * i + static_cast<size_t>(c)] = sums_[i].halves[1][c] * scale;
      }
      picture.samples += 2.0 * sums_[i].samples;
    }
    if (options_.features) {
      picture.features_a = features(0);
      picture.features_b = features(1);
    }
    return picture;
  }

 private:
  Features features(size_t half) const {
    Features means{Image(width_, height_, 3), Image(width_, height_, 3), Image(width_, height_, 1)};
    for (size_t i = 0; i < sums_.size(); ++i) {
      const FeatureSums& sums = features_[i][half];
      const float scale = 1.0f / static_cast<float>(std::max(1, sums_[i].samples));
      for (int c = 0; c < 3; ++c) {
        means.albedo.data[3 * i + static_cast<size_t>(c)] = sums.albedo[c] * scale;
        means.normal.data[3 * i + static_cast<size_t>(c)] = sums.normal[c] * scale;
      }
      means.depth.data[i] = sums.depth / std::max(1.0f, sums_[i].halves[half].w);
    }
    return means;
  }

  // Neighbouring pixels together: the tracer works on many paths at once.
  void trace_tile(int x0, int y0) {
    struct Run {
      size_t pixel;
      size_t half;
      int count;
    };
    std::vector<Run> runs;
    std::vector<PathStart> starts;
    const auto flush = [&] {
      const std::vector<PathSample> samples = tracer_.trace(starts);
      auto sample = samples.begin();
      for (const Run& run : runs) {
        for (int i = 0; i < run.count; ++i, ++sample) {
          sums_[run.pixel].halves[run.half] += Vec4(sample->radiance, sample->alpha);
          if (options_.features) {
            FeatureSums& features = features_[run.pixel][run.half];
            features.albedo += sample->albedo;
            features.normal += sample->normal;
            features.depth += sample->depth;
          }
        }
      }
      runs.clear();
      starts.clear();
    };
    for (int y = y0; y < std::min(y0 + kTile, height_); ++y) {
      for (int x = x0; x < std::min(x0 + kTile, width_); ++x) {
        const size_t i =
            static_cast<size_t>(y) * static_cast<size_t>(width_) + static_cast<size_t>(x);
        const int done = sums_[i].samples;
        const int more = wanted_[i] - done;
        if (more <= 0) {
          continue;
        }
        for (size_t half = 0; half < 2; ++half) {
          const auto key =
              static_cast<std::uint32_t>(Rng::mix(Rng::mix(options_.seed) + 2 * i + half));
          runs.push_back({i, half, more});
          for (int s = 0; s < more; ++s) {
            const auto index = static_cast<std::uint32_t>(done + s);
            starts.push_back(
                {static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f, key, index});
          }
        }
        sums_[i].samples = wanted_[i];
        if (starts.size() >= PathBatch::kCapacity) {
          flush();
        }
      }
    }
    flush();
  }

  // Over the background, as displayed: alpha · sRGB(tone(exposure · radiance / alpha)) + …
  Vec3 shown(const Vec4& sum, int samples) const {
    const float alpha = sum.w / static_cast<float>(samples);
    Vec3 rgb((1 - alpha) * background_);
    if (sum.w > 0) {
      for (int c = 0; c < 3; ++c) {
        rgb[c] +=
            alpha * display_from_linear(transform_.exposure * sum[c] / sum.w, transform_.tone);
      }
    }
    return rgb;
  }

  // A quarter of the squared difference of the halves, mean over the channels.
  double pixel_error(const PixelSums& pixel) const {
    if (pixel.halves[0].w + pixel.halves[1].w == 0) {
      return 0;
    }
    const Vec3 difference =
        shown(pixel.halves[0], pixel.samples) - shown(pixel.halves[1], pixel.samples);
    return glm::dot(difference, difference) / 12.0;
  }

  // Standard deviation of one (half-)sample in each pixel, smoothed; 0 where no matter is near.
  std::vector<float> deviations() const {
    std::vector<float> variance(sums_.size());
    for (size_t i = 0; i < sums_.size(); ++i) {
      variance[i] = static_cast<float>(pixel_error(sums_[i]) * sums_[i].samples);
    }
    std::vector<float> result(sums_.size());
    parallel_for(static_cast<size_t>(height_), 8, [&](size_t begin, size_t end) {
      for (size_t row = begin; row < end; ++row) {
        const int y = static_cast<int>(row);
        for (int x = 0; x < width_; ++x) {
          double sum = 0;
          int count = 0;
          bool matter = false;
          for (int v = std::max(0, y - kNoiseRadius); v <= std::min(height_ - 1, y + kNoiseRadius);
               ++v) {
            for (int u = std::max(0, x - kNoiseRadius); u <= std::min(width_ - 1, x + kNoiseRadius);
                 ++u) {
              const size_t j =
                  static_cast<size_t>(v) * static_cast<size_t>(width_) + static_cast<size_t>(u);
              sum += variance[j];
              ++count;
              const bool beside = std::abs(u - x) <= 1 && std::abs(v - y) <= 1;
              matter = matter || (beside && sums_[j].halves[0].w + sums_[j].halves[1].w > 0);
            }
          }
          const size_t i = row * static_cast<size_t>(width_) + static_cast<size_t>(x);
          // A small floor keeps pixels whose first samples happened to agree in the running.
          result[i] = matter ? static_cast<float>(std::sqrt(sum / count)) + 0.01f : 0.0f;
        }
      }
    });
    return result;
  }

  PathTracer tracer_;
  DisplayTransform transform_;
  float background_;
  PictureOptions options_;
  int width_;
  int height_;
  std::vector<PixelSums> sums_;
  std::vector<std::array<FeatureSums, 2>> features_;  // empty unless wanted
  std::vector<int> wanted_;
};

}  // namespace

Image Picture::mean() const {
  Image image = half_a;
  for (size_t i = 0; i < image.data.size(); ++i) {
    image.data[i] = 0.5f * (half_a.data[i] + half_b.data[i]);
  }
  return image;
}

Image Picture::depth() const {
  Image depth(half_a.width, half_a.height, 1);
  for (size_t i = 0; i < depth.pixels(); ++i) {
    const float a = half_a.data[4 * i + 3];
    const float b = half_b.data[4 * i + 3];
    if (a + b > 0) {
      depth.data[i] = (a * features_a.depth.data[i] + b * features_b.depth.data[i]) / (a + b);
    }
  }
  return depth;
}

Picture render_picture(const CinemaScene& scene, const Camera& camera, const Cut& cut,
                       const PictureOptions& options) {
  Rendering rendering(scene, camera, cut, options);
  std::unique_ptr<Progress> progress;
  if (!options.progress.empty()) {
    progress = std::make_unique<Progress>(options.progress, 1000);
  }
  rendering.want_everywhere(std::clamp(options.spp / 2, 1, kFirstRound / 2));
  rendering.trace();
  while (rendering.plan()) {
    if (progress) {
      progress->update(static_cast<size_t>(1000 * std::min(1.0, rendering.share_done())));
    }
    rendering.trace();
  }
  if (progress) {
    progress->update(1000);
  }
  return rendering.picture();
}

Image render_depth(const CinemaScene& scene, const Camera& camera, const Cut& cut) {
  const PathTracer tracer(scene, camera, cut, 1);
  Image depth(camera.width, camera.height, 1);
  parallel_for(static_cast<size_t>(camera.height), 4, [&](size_t begin, size_t end) {
    for (size_t y = begin; y < end; ++y) {
      for (int x = 0; x < camera.width; ++x) {
        *depth.at(x, static_cast<int>(y)) =
            tracer.first_hit(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f);
      }
    }
  });
  return depth;
}

Image display(const Image& premultiplied, const DisplayTransform& transform) {
  Image image(premultiplied.width, premultiplied.height, 4);
  for (size_t i = 0; i < image.pixels(); ++i) {
    const float* in = &premultiplied.data[4 * i];
    float* out = &image.data[4 * i];
    if (in[3] > 0) {
      for (int c = 0; c < 3; ++c) {
        out[c] = display_from_linear(transform.exposure * in[c] / in[3], transform.tone);
      }
      out[3] = std::min(in[3], 1.0f);
    }
  }
  return image;
}

void fade(Image& straight, const Image& depth, const DepthCue& cue) {
  for (size_t i = 0; i < straight.pixels(); ++i) {
    straight.data[4 * i + 3] *= cue.kept(depth.data[i]);
  }
}

namespace {

// Of the pixels whose alpha exceeds `least_alpha`.
float noise_floor(const Picture& picture, const DisplayTransform& transform, float background,
                  float least_alpha) {
  const Image a = composite(display(picture.half_a, transform), background, background, background);
  const Image b = composite(display(picture.half_b, transform), background, background, background);
  double sum = 0;
  double count = 0;
  for (size_t i = 0; i < a.pixels(); ++i) {
    if (0.5f * (picture.half_a.data[4 * i + 3] + picture.half_b.data[4 * i + 3]) > least_alpha) {
      for (size_t c = 3 * i; c < 3 * i + 3; ++c) {
        const double difference = a.data[c] - b.data[c];
        sum += difference * difference;
      }
      count += 3;
    }
  }
  const double mse = 0.25 * sum / std::max(count, 1.0);
  return mse > 0 ? std::min(kNoNoise, static_cast<float>(-10.0 * std::log10(mse))) : kNoNoise;
}

}  // namespace

float noise_floor(const Picture& picture, const DisplayTransform& transform, float background) {
  return noise_floor(picture, transform, background, -1);
}

float masked_noise_floor(const Picture& picture, const DisplayTransform& transform) {
  return noise_floor(picture, transform, 0, kMaskAlpha);
}

}  // namespace clipgs
