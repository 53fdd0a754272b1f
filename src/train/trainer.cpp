#include "train/trainer.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <fmt/format.h>
#include <numeric>

#include "core/digest.h"
#include "core/error.h"
#include "core/parallel.h"
#include "core/progress.h"
#include "core/random.h"
#include "section/faces.h"
#include "section/openings.h"
#include "splat/overdraw.h"
#include "train/densification.h"
#include "train/seeding.h"
#include "train/training_claim.h"

namespace clipgs {

namespace {

// Independent random streams of a training run.
enum Stream : std::uint64_t {
  kEpochOrder = 1,
  kBackground,
  kRelocation,
  kGrowth,
  kNoise,
  kAdjustment
};

std::vector<std::uint8_t> to_bytes(const Image& image) {
  std::vector<std::uint8_t> bytes(image.data.size());
  for (size_t i = 0; i < bytes.size(); ++i) {
    bytes[i] = static_cast<std::uint8_t>(std::lround(255 * image.data[i]));
  }
  return bytes;
}

/// The mean of `scale` × `scale` pixels each, as an image.
void from_bytes(const std::vector<std::uint8_t>& bytes, const Camera& camera, int scale,
                Image& out) {
  const int width = camera.width / scale;
  const int height = camera.height / scale;
  if (out.width != width || out.height != height) {
    out = Image(width, height, 4);
  }
  const float norm = 1.0f / static_cast<float>(scale * scale * 255);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      int sum[4] = {0, 0, 0, 0};
      for (int sy = 0; sy < scale; ++sy) {
        for (int sx = 0; sx < scale; ++sx) {
          const size_t row = static_cast<size_t>(y) * scale + sy;
          const size_t column = static_cast<size_t>(x) * scale + sx;
          const std::uint8_t* in = &bytes[(row * camera.width + column) * 4];
          for (int c = 0; c < 4; ++c) {
            sum[c] += in[c];
          }
        }
      }
      for (int c = 0; c < 4; ++c) {
        out.at(x, y)[c] = static_cast<float>(sum[c]) * norm;
      }
    }
  }
}

bool is_along(const Plane& plane, const Vec3& normal) {
  return glm::dot(plane.normal, normal) > 0.9999f;
}

/// The axis, or its opposite: whichever is the normal of more training planes.
Vec3 uniaxial_normal(const std::vector<const Frame*>& frames, const Dataset& dataset) {
  size_t above = 0;
  size_t below = 0;
  for (const Frame* frame : frames) {
    above += frame->plane && is_along(*frame->plane, dataset.axis) ? 1 : 0;
    below += frame->plane && is_along(*frame->plane, -dataset.axis) ? 1 : 0;
  }
  if (above + below == 0) {
    throw Error("{}: has no training frames that are cut across its axis; make the dataset again",
                dataset.folder.string());
  }
  return above > below ? dataset.axis : -dataset.axis;
}

/// The side of a pixel at the middle of the matter, mm, in the median of the frames.
float typical_pixel(const std::vector<const Frame*>& frames, const Sphere& sphere) {
  std::vector<float> sides;
  sides.reserve(frames.size());
  for (const Frame* frame : frames) {
    sides.push_back(glm::distance(frame->camera.position, sphere.center) / frame->camera.fx);
  }
  const auto middle = sides.begin() + static_cast<std::ptrdiff_t>(sides.size() / 2);
  std::ranges::nth_element(sides, middle);
  return *middle;
}

}  // namespace

TrainOptions refine_options() {
  TrainOptions options;
  options.budget = 0;
  options.steps = 6000;
  options.mean_rate = 5e-4f;
  options.coarse_share = 0;
  options.least_pixels = 0;  // halves would have to find their place in steps that are too small
  return options;
}

Trainer::Trainer(const Dataset& dataset, const TrainOptions& options, const Section* section,
                 const Scene* start)
    : options_(options), extent_(dataset.sphere.radius), has_section_(section != nullptr) {
  std::vector<const Frame*> frames = dataset.split(Split::kTrain);
  Vec3 normal(0);
  if (options.uniaxial) {
    normal = uniaxial_normal(frames, dataset);
    std::erase_if(frames, [&](const Frame* frame) {
      return frame->plane && !is_along(*frame->plane, normal);
    });
  }
  if (frames.empty()) {
    throw Error("{}: has no training frames; make the dataset again", dataset.folder.string());
  }
  load_views(dataset, frames, section);
  pixel_ = typical_pixel(frames, dataset.sphere);
  gaussians_ = start != nullptr ? start->gaussians
                                : start_from_points(load_seed_points(dataset.folder),
                                                    std::min(options_.start, options_.budget),
                                                    options_.sh_degree, options_.seed);
  if (!options.uniaxial && section == nullptr) {
    gaussians_ = gaussians_.reshaped(gaussians_.sh_degree(), true);
  }
  options_.sh_degree = gaussians_.sh_degree();
  options_.budget = std::max(options_.budget, gaussians_.size());
  if (options.uniaxial) {
    uniaxial_.emplace(*options.uniaxial, normal, dataset.sphere,
                      dataset.extent.y - dataset.extent.x, gaussians_,
                      Rng::mix(options_.seed) ^ kAdjustment);
  }
  if (start != nullptr) {
    gain_.value = start->face_gain;
  }
  gradients_ = gaussians_.like(gaussians_.size());
  adam_ = Adam(gaussians_);
  last_reached_.assign(gaussians_.size(), 0);
  need_.assign(gaussians_.size(), 0);
  claim_ = claim_of(options_);
  claim_["pictures"] = digest_of_views();
  claim_["section"] = has_section_;  // its looks count with the views
  claim_["start"] = digest_of_start(dataset);
}

/// What the pictures show, cameras and planes with them.
std::string Trainer::digest_of_views() const {
  std::vector<std::string> digests(views_.size());
  parallel_for(views_.size(), 1, [&](size_t i, size_t) {
    const View& view = views_[i];
    const auto& [width, height, fx, fy, cx, cy, rotation, position] = view.camera;
    Digest digest;
    digest.add(width).add(height).add(fx).add(fy).add(cx).add(cy).add(position);
    for (int k = 0; k < 3; ++k) {
      digest.add(rotation[k]);
    }
    digest.add(view.plane.has_value());
    if (view.plane) {
      digest.add(view.plane->normal).add(view.plane->offset);
    }
    digests[i] = digest.add(view.rgba).add(view.faces).hex();
  });
  Digest all;
  for (const std::string& digest : digests) {
    all.add(digest);
  }
  return all.hex();
}

/// What the run begins with: the Gaussians, and the matter's place.
std::string Trainer::digest_of_start(const Dataset& dataset) const {
  Digest digest;
  digest.add(dataset.sphere.center)
      .add(dataset.sphere.radius)
      .add(dataset.axis)
      .add(dataset.extent);
  digest.add(gaussians_.sh_degree()).add(gaussians_.has_face_colors()).add(gaussians_.data());
  for (const Vec3& coefficient : gain_.value.coefficients) {
    digest.add(coefficient);
  }
  return digest.hex();
}

void Trainer::load_views(const Dataset& dataset, const std::vector<const Frame*>& frames,
                         const Section* section) {
  views_.resize(frames.size());
  std::optional<Openings> openings;
  if (section != nullptr) {
    openings.emplace(*section);
  }
  const auto load = [&](size_t i) {
    View& view = views_[i];
    view.camera = frames[i]->camera;
    view.plane = frames[i]->plane;
    view.rgba = to_bytes(premultiplied(dataset.load(*frames[i])));
    if (section != nullptr) {
      FaceOptions options;
      std::optional<OpenedLight> light;
      if (view.plane && openings->drawn()) {
        options.light = &light.emplace(*openings, view.plane);
      }
      const Image faces = draw_faces(*section, view.camera, view.plane, options);
      // Most uncut views show none: nothing is kept for them, and nothing put in front.
      if (std::ranges::any_of(faces.data, [](float v) { return v > 0; })) {
        view.faces = to_bytes(faces);
      }
    }
  };
  Progress progress("loading", frames.size());
  constexpr size_t kBatch = 32;
  for (size_t begin = 0; begin < frames.size(); begin += kBatch) {
    const size_t count = std::min(kBatch, frames.size() - begin);
    parallel_for(count, 1, [&](size_t i, size_t) { load(begin + i); });
    progress.update(begin + count);
  }
}

const Trainer::View& Trainer::next_view() {
  const size_t epoch = step_ / views_.size();
  const size_t within = step_ % views_.size();
  if (within == 0 || order_.empty()) {
    order_.resize(views_.size());
    std::iota(order_.begin(), order_.end(), 0U);
    Rng rng(options_.seed, Rng::mix(epoch) ^ kEpochOrder);
    for (size_t i = order_.size(); i > 1; --i) {
      std::swap(order_[i - 1], order_[rng.below(static_cast<std::uint32_t>(i))]);
    }
  }
  return views_[order_[within]];
}

const Image& Trainer::draw(const View& view, const Camera& camera) {
  const Image* front = view.faces.empty() ? nullptr : &front_;
  if (uniaxial_) {
    // The truncation cuts, not the rasterizer.
    const std::optional<float> offset =
        view.plane ? std::optional(view.plane->offset) : std::nullopt;
    return rasterizer_.forward(uniaxial_->forward(gaussians_, offset), camera, std::nullopt, {},
                               front);
  }
  RasterOptions raster;
  raster.clip = options_.clip;
  raster.face_gain = gain_.value;
  raster.kept_share = raster.clip == ClipOperator::kExact;
  return rasterizer_.forward(gaussians_, camera, view.plane, raster, front);
}

void Trainer::backward() {
  if (uniaxial_) {
    uniaxial_->backward(rasterizer_, image_gradient_, gradients_);
  } else {
    rasterizer_.backward(gaussians_, image_gradient_, gradients_);
  }
}

const std::vector<std::uint32_t>& Trainer::reached() const {
  return uniaxial_ ? uniaxial_->reached() : rasterizer_.reached();
}

double Trainer::step() {
  const View& view = next_view();
  const auto steps = static_cast<float>(options_.steps);
  const float progress = static_cast<float>(step_) / steps;
  const int scale = progress < options_.coarse_share ? 2 : 1;
  from_bytes(view.rgba, view.camera, scale, target_);
  if (!view.faces.empty()) {
    from_bytes(view.faces, view.camera, scale, front_);
  }

  // Without truncation nothing else cuts: then it acts from the start.
  if (uniaxial_ && options_.uniaxial &&
      (progress >= options_.uniaxial->coarse_share ||
       options_.uniaxial->truncation == Truncation::kNone)) {
    uniaxial_->start_adjusting();
  }
  const Image& image = draw(view, shrunk(view.camera, scale));
  Rng rng(options_.seed, Rng::mix(step_) ^ kBackground);
  const Vec3 background(rng.uniform(), rng.uniform(), rng.uniform());
  const double loss = loss_.evaluate(image, target_, background, options_.loss, image_gradient_);
  backward();
  add_overdraw_penalty();

  const float relative_rate = options_.mean_rate * std::pow(0.01f, progress);
  const float decay = std::pow(options_.rate_decay, progress);
  LearningRates rates;
  rates.mean = relative_rate * extent_;
  rates.log_scale *= decay;
  rates.rotation *= decay;
  rates.opacity *= decay;
  rates.sh0 *= decay;
  rates.sh_rest *= decay;
  rates.face *= decay;
  adam_.step(reached(), gradients_, rates, gaussians_);
  if (uniaxial_) {
    uniaxial_->step(decay);
  } else {
    learn_gain(view, decay * options_.gain_rate);
  }

  ++step_;
  note_reached();
  if (progress < options_.relocate_until) {
    if (step_ % options_.relocate_every == 0) {
      densify();
    }
    add_noise(gaussians_, relative_rate / extent_, options_.seed, Rng::mix(step_) ^ kNoise);
  }
  return loss;
}

/// One step of Adam along ∂L/∂cₖ = ∂L/∂g·g·Yₖ(n).
void Trainer::learn_gain(const View& view, float rate) {
  if (!view.plane || rate == 0) {
    return;
  }
  std::array<float, FaceGain::kCoefficients> basis;
  sh_basis(FaceGain::kDegree, view.plane->normal, basis.data());
  const Vec3 of_exponent = rasterizer_.gain_gradient() * gain_.value.at(view.plane->normal);
  const float corrected = rate * Adam::correction(++gain_.updates);
  for (size_t k = 0; k < basis.size(); ++k) {
    gain_.value.coefficients[k] -=
        Adam::advance(basis[k] * of_exponent, corrected, gain_.first.coefficients[k],
                      gain_.second.coefficients[k]);
  }
}

void Trainer::add_overdraw_penalty() {
  const std::vector<std::uint32_t>& list = reached();
  parallel_for(list.size(), 4096, [&](size_t begin, size_t end) {
    for (size_t k = begin; k < end; ++k) {
      add_overdraw_gradient(gaussians_, list[k], extent_, options_.overdraw_penalty, gradients_);
    }
  });
}

/// When pictures asked for each Gaussian, and how much the loss pulled at it: |∂L/∂μ| times its
/// largest deviation.
void Trainer::note_reached() {
  for (const std::uint32_t i : reached()) {
    last_reached_[i] = static_cast<std::uint32_t>(step_);
    const Vec3 scale = gaussians_.scale(i);
    need_[i] += glm::length(gradients_.mean(i)) * std::max({scale.x, scale.y, scale.z});
  }
}

/// Gaussians that are worth more elsewhere are made transparent, and moved like others that have
/// died: those that cover next to nothing of a pixel, and behind a section those that no picture
/// needs, for the inside of what is solid is never seen.
void Trainer::retire_useless() {
  constexpr float kTransparent = -12;  // logit
  const float least_cover = options_.least_pixels * pixel_ * pixel_;
  for (size_t i = 0; i < gaussians_.size(); ++i) {
    const bool is_idle = has_section_ && last_reached_[i] + options_.idle_steps < step_;
    if (is_idle || mean_cover(gaussians_, i) < least_cover) {
      gaussians_.plane(Gaussians::kOpacity)[i] = kTransparent;
      last_reached_[i] = static_cast<std::uint32_t>(step_);
    }
  }
}

void Trainer::densify() {
  retire_useless();
  const Rng relocation(options_.seed, Rng::mix(step_) ^ kRelocation);
  const Rng growth(options_.seed, Rng::mix(step_) ^ kGrowth);
  for (const Copies& made : {relocate_dead(gaussians_, adam_, need_, relocation),
                             grow(gaussians_, adam_, need_, options_.budget, growth)}) {
    if (uniaxial_) {
      uniaxial_->copied(made.targets, made.sources);
    }
  }
  if (gradients_.size() != gaussians_.size()) {
    gradients_ = gaussians_.like(gaussians_.size());
    last_reached_.resize(gaussians_.size(), static_cast<std::uint32_t>(step_));
  }
  constexpr float kMemory = 0.9f;  // what was needed long ago is so no more
  for (float& need : need_) {
    need *= kMemory;
  }
}

Scene scene_of(const Dataset& dataset) {
  Scene scene;
  scene.sphere = dataset.sphere;
  scene.bounds = dataset.bounds;
  scene.axis = dataset.axis;
  scene.extent = dataset.extent;
  scene.preset = dataset.preset;
  scene.look = dataset.look;
  return scene;
}

namespace {

// Of the steps: when a scene on its way is worth looking at. After an eighth it is not: a chest
// that shows its section beside placed splats is better.
constexpr std::array kMoments = {0.25f, 0.5f};

/// Steps to the end, from `checkpoint` if it is there. `watch` is told after every step.
void run(Trainer& trainer, size_t steps, const std::filesystem::path& checkpoint, const char* name,
         const std::function<void()>& watch = {}) {
  if (!checkpoint.empty()) {
    trainer.load_checkpoint(checkpoint);
  }
  using Clock = std::chrono::steady_clock;
  constexpr auto kSaveEvery = std::chrono::minutes(2);
  auto last_save = Clock::now();
  Progress progress(name, steps);
  double smoothed = 0;
  while (trainer.steps_done() < steps) {
    const double loss = trainer.step();
    smoothed = smoothed == 0 ? loss : 0.98 * smoothed + 0.02 * loss;
    progress.update(trainer.steps_done(), fmt::format("loss {:.4f}", smoothed));
    if (!checkpoint.empty() && Clock::now() - last_save > kSaveEvery) {
      trainer.save_checkpoint(checkpoint);
      last_save = Clock::now();
    }
    if (watch) {
      watch();
    }
  }
}

}  // namespace

Scene train(const Dataset& dataset, const TrainOptions& options,
            const std::filesystem::path& checkpoint, const Section* section,
            const SceneWatcher& watch) {
  Trainer trainer(dataset, options, section);
  const auto scene_of_now = [&] {
    Scene scene = scene_of(dataset);
    scene.gaussians = trainer.gaussians();
    scene.face_gain = trainer.face_gain();
    scene.trained = static_cast<float>(trainer.steps_done()) / static_cast<float>(options.steps);
    return scene;
  };
  run(trainer, options.steps, checkpoint, "training", [&] {
    const bool is_moment = std::ranges::any_of(kMoments, [&](float share) {
      return trainer.steps_done() == static_cast<size_t>(share * static_cast<float>(options.steps));
    });
    if (watch && is_moment) {
      watch(scene_of_now());
    }
  });
  return scene_of_now();
}

UniaxialModel train_model(const Dataset& dataset, const TrainOptions& options,
                          const std::filesystem::path& checkpoint, const Section* section) {
  Trainer trainer(dataset, options, section);
  run(trainer, options.steps, checkpoint, "training");
  UniaxialModel model{scene_of(dataset), *trainer.uniaxial()};
  model.scene.gaussians = trainer.gaussians();
  return model;
}

Scene refine(const Scene& scene, const Dataset& dataset, const TrainOptions& options,
             const std::filesystem::path& checkpoint, const Section* section) {
  Trainer trainer(dataset, options, section, &scene);
  run(trainer, options.steps, checkpoint, "refining");
  Scene refined = scene;
  refined.gaussians = trainer.gaussians();
  refined.face_gain = trainer.face_gain();
  refined.placed = false;
  refined.trained = 1;
  if (!scene.layers.empty()) {
    refined.layers.resize(refined.gaussians.size());
    for (size_t i = 0; i < refined.layers.size(); ++i) {
      const float position = glm::dot(scene.axis, refined.gaussians.mean(i));
      refined.layers[i] = static_cast<std::uint16_t>(scene.states.nearest_slab(position));
    }
  }
  return refined;
}

}  // namespace clipgs
