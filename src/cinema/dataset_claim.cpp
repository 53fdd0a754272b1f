#include "cinema/dataset_claim.h"

#include <algorithm>

#include "core/digest.h"
#include "core/json_reader.h"

namespace clipgs {
namespace {

// Raised whenever the same input gives other pictures, or other points, so that old ones are not
// taken for new.
constexpr int kPicturesRevision = 8;
constexpr int kPointsRevision = 2;

constexpr const char* kVolumeKey = "volume";

// Structured bindings name every member of what is hashed: whoever adds one finds that nothing
// compiles here, and decides.

/// Of the numbers, however they are kept.
std::string digest_of_values(const VoxelValues& values) {
  constexpr size_t kPiece = size_t{1} << 24;
  Digest digest;
  for (size_t begin = 0; begin < values.size(); begin += kPiece) {
    std::vector<float> piece(std::min(kPiece, values.size() - begin));
    parallel_for(piece.size(), size_t{1} << 16, [&](size_t first, size_t last) {
      for (size_t i = first; i < last; ++i) {
        piece[i] = values[begin + i];
      }
    });
    digest.add(piece);
  }
  return digest.hex();
}

std::string digest_of_voxels(const Volume& volume) {
  [[maybe_unused]] const auto& [dims, spacing, direction, origin, upsampling, modality, part,
                                values, scanned, rgb, labels, label_numbers, hints, defaced] =
      volume;
  Digest digest;
  digest.add(dims).add(spacing).add(origin).add(upsampling).add(modality);
  for (int k = 0; k < 3; ++k) {
    digest.add(direction[k]);
  }
  if (!scanned.empty()) {
    digest.add(digest_of_values(scanned));
  }
  return digest.add(digest_of_values(values)).add(rgb).hex();
}

std::string digest_of_labels(const Volume& volume) {
  return Digest().add(volume.labels).add(volume.label_numbers).hex();
}

std::string digest_of_looks(const Volume& volume, const Preset& preset) {
  Digest digest;
  for (const LabelLook& look : looks_of_labels(volume, preset.labels)) {
    const auto& [albedo, opacity] = look;
    digest.add(albedo.has_value()).add(albedo.value_or(Vec3(0))).add(opacity);
  }
  return digest.hex();
}

std::string digest_of_lights(const LightRig& rig) {
  const auto& [sky_top, sky_horizon, sky_bottom, keys, environment, turn] = rig;
  Digest digest;
  digest.add(sky_top).add(sky_horizon).add(sky_bottom).add(keys.size()).add(turn);
  for (const KeyLight& key : keys) {
    const auto& [direction, radiance, angular_radius, distance] = key;
    digest.add(direction).add(radiance).add(angular_radius).add(distance);
  }
  if (environment) {
    const auto& [width, height, channels, data] = *environment;
    digest.add(width).add(height).add(channels).add(data);
  }
  return digest.hex();
}

void add_points(Digest& digest, const TransferFunction& transfer) {
  for (const TransferPoint& point : transfer.points()) {
    const auto& [value, material] = point;
    const auto& [albedo, extinction, specular, roughness, phase] = material;
    digest.add(value).add(albedo).add(extinction).add(specular).add(roughness).add(phase);
  }
}

/// All of a preset but what has a name of its own in the claim.
std::string digest_of_preset(const Preset& preset) {
  [[maybe_unused]] const auto& [name, title, description, modality, units, transfer,
                                surface_strength, gradient_opacity, boundary, rig, exposure, tone,
                                labels] = preset;
  Digest digest;
  digest.add(name).add(units).add(surface_strength).add(gradient_opacity.has_value());
  if (gradient_opacity) {
    const auto& [from, to, floor] = *gradient_opacity;
    digest.add(from).add(to).add(floor);
  }
  add_points(digest, transfer);
  if (boundary) {  // presets without keep their digest
    const auto& [range, steep] = *boundary;
    const auto& [from, to] = range;
    digest.add(from).add(to);
    add_points(digest, steep);
  }
  return digest.hex();
}

/// What points and pictures have in common.
Claim claim_of_look(const Volume& volume, const Preset& preset) {
  Claim claim = {{kVolumeKey, digest_of_voxels(volume)},
                 {"labels", digest_of_labels(volume)},
                 {"labels'_looks", digest_of_looks(volume, preset)},
                 {"preset", digest_of_preset(preset)},
                 {"lights", digest_of_lights(preset.rig)},
                 {"exposure", json_number(preset.exposure)}};
  if (preset.tone != ToneCurve::kSrgb) {  // which claims of before there were others do not name
    claim["tone"] = tone_name(preset.tone);
  }
  return claim;
}

}  // namespace

DatasetClaims claims_of(const Volume& volume, const Preset& preset, const DatasetOptions& options) {
  const auto& [size, test_size, train_frames, test_frames, validation_frames, uncut_frames,
               close_frames, cut_views, train_spp, test_noise_db, test_masked_noise_db, test_spp,
               max_bounces, seed_points, seed, axis, one_sided, choose_views, near_share, upsample,
               denoise] = options;
  const Claim look = claim_of_look(volume, preset);
  DatasetClaims claims{claim_of_step("pictures", kPicturesRevision),
                       claim_of_step("points", kPointsRevision)};
  claims.pictures.update(look);
  claims.pictures.update({{"size", size},
                          {"train_frames", train_frames},
                          {"test_frames", test_frames},
                          {"validation_frames", validation_frames},
                          {"train_spp", train_spp},
                          {"test_noise", json_number(test_noise_db)},
                          {"test_masked_noise", json_number(test_masked_noise_db)},
                          {"test_spp", test_spp},
                          {"bounces", max_bounces},
                          {"seed", seed},
                          {"axis", json_vector(axis)},
                          {"side_of_axis_planes", one_sided ? "one" : "any"},
                          {"voxels", upsample ? "upsampled" : "as scanned"},
                          {"choice_of_views", choose_views ? "need" : "spiral"},
                          {"denoising", denoise}});
  // What claims of before there was such a thing do not name.
  for (const auto& [name, value] : {std::pair("test_size", test_size == size ? 0 : test_size),
                                    {"uncut_frames", uncut_frames},
                                    {"close_frames", close_frames},
                                    {"cut_views", cut_views ? 1 : 0}}) {
    if (value != 0) {
      claims.pictures[name] = value;
    }
  }
  if (near_share != 0) {
    claims.pictures["share_of_near_views"] = json_number(near_share);
  }
  claims.points.update(look);
  claims.points.update({{"number_of_points", seed_points}, {"seed", seed}});
  return claims;
}

VolumeLook look_of(const DatasetClaims& claims, const Volume& volume, const Preset& preset) {
  VolumeLook look = make_volume_look(claims.pictures.at(kVolumeKey).get<std::string>(),
                                     preset.title, preset.description);
  look.modality = volume.modality;
  look.part = volume.part;
  look.defaced = volume.defaced;
  return look;
}

}  // namespace clipgs
