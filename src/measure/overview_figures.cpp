#include "measure/overview_figures.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <utility>

#include "measure/outliers.h"

namespace clipgs {

namespace {

using Json = nlohmann::json;

// A deviation of half a decibel, or of a fifth, stands out nowhere.
constexpr double kDecibels = 0.5;
constexpr double kShare = 0.2;

constexpr std::array<FigureKind, kFigures> kKinds = {{
    {"Faces, dB", "faces",
     "Masked PSNR of cut faces, mean of cuts along the axis and oblique ones.", " dB", 1, 1, -1,
     false, kDecibels},
    {"Uncut, dB", "uncut", "Masked PSNR of the whole body, uncut.", " dB", 1, 1, -1, false,
     kDecibels},
    {"Cuts, dB", "cuts", "Masked PSNR of cut bodies, mean of both kinds of cuts.", " dB", 1, 1, -1,
     false, kDecibels},
    {"Noise floor, dB", "noise floor",
     "How well the path-traced truth knows itself; no PSNR above it can be trusted.", " dB", 1, 1,
     -1, false, kDecibels},
    {"Gaussians, 1000", "Gaussians", "In the case, thousands.", " thousand", 1, 1e-3, 0, true,
     kShare},
    {"MB", "size", "Of the case's file.", " MB", 2, 1e-6, 0, true, kShare},
    {"Minutes", "time", "Of all steps together, repeated ones too.", " min", 1, 1, 1, true, kShare},
}};

std::optional<double> number_in(const Json& object, const char* key) {
  const auto found = object.find(key);
  return found != object.end() && found->is_number() ? std::optional(found->get<double>())
                                                     : std::nullopt;
}

std::string text_in(const Json& object, const char* key) {
  const auto found = object.find(key);
  return found != object.end() && found->is_string() ? found->get<std::string>() : "";
}

/// The rows of the first scene against the truth that draw faces as the viewer does.
std::vector<Json> leading_rows(const Json& rows) {
  std::vector<Json> volume;
  std::vector<Json> splats;
  for (const Json& row : rows) {
    const bool own = row.is_object() && text_in(row, "subject") == text_in(rows[0], "subject") &&
                     text_in(row, "against") == "truth" && text_in(row, "clip") == "exact";
    if (own) {
      (text_in(row, "section") == "volume" ? volume : splats).push_back(row);
    }
  }
  return volume.empty() ? splats : volume;
}

/// Of those rows' splits that are named; nothing where none has it.
std::optional<double> mean_of(const std::vector<Json>& rows,
                              std::initializer_list<const char*> splits, const char* key) {
  double sum = 0;
  int count = 0;
  for (const Json& row : rows) {
    const std::string split = text_in(row, "split");
    const std::optional<double> value = number_in(row, key);
    if (value && std::ranges::any_of(splits, [&](const char* one) { return split == one; })) {
      sum += *value;
      ++count;
    }
  }
  return count > 0 ? std::optional(sum / count) : std::nullopt;
}

std::optional<double> least_in(const Json& object) {
  std::optional<double> least;
  for (const Json& value : object) {
    if (value.is_number()) {
      least = std::min(least.value_or(value.get<double>()), value.get<double>());
    }
  }
  return least;
}

/// What is compared; nothing for what has no logarithm and needs one.
std::optional<double> compared(const FigureKind& kind, const std::optional<double>& value) {
  if (!value || !kind.is_ratio) {
    return value;
  }
  return *value > 0 ? std::optional(std::log(*value)) : std::nullopt;
}

}  // namespace

const FigureKind& figure_kind(size_t which) { return kKinds.at(which); }

std::string figure_text(size_t which, const std::optional<double>& value) {
  const FigureKind& kind = kKinds.at(which);
  return value ? fmt::format("{:.{}f}{}", *value * kind.scale, kind.decimals, kind.unit) : "–";
}

void add_measured(const Json& evaluation, OverviewEntry& entry) {
  const auto rows = evaluation.is_object() ? evaluation.find("rows") : evaluation.end();
  if (rows == evaluation.end() || !rows->is_array() || rows->empty() || !(*rows)[0].is_object()) {
    return;
  }
  const std::vector<Json> leading = leading_rows(*rows);
  figure(entry, Figure::kFaces) = mean_of(leading, {"test_axis", "test_oblique"}, "psnr_face");
  figure(entry, Figure::kCuts) = mean_of(leading, {"test_axis", "test_oblique"}, "psnr_masked");
  figure(entry, Figure::kUncut) = mean_of(leading, {"test_uncut"}, "psnr_masked");
  const auto floors = evaluation.find("masked_noise_floor_db");
  if (floors != evaluation.end() && floors->is_object()) {
    figure(entry, Figure::kNoiseFloor) = least_in(*floors);
  }
}

void say_what_stands_out(std::vector<OverviewEntry>& entries) {
  std::vector<std::vector<std::pair<double, std::string>>> reasons(entries.size());
  for (size_t which = 0; which < kFigures; ++which) {
    const FigureKind& kind = kKinds.at(which);
    std::vector<std::optional<double>> values;
    std::vector<std::optional<double>> shown;
    for (const OverviewEntry& entry : entries) {
      // What is not finished has figures of its first versions.
      const bool counts = entry.state == OverviewEntry::State::kDone;
      shown.push_back(counts ? entry.figures[which] : std::nullopt);
      values.push_back(compared(kind, shown.back()));
    }
    const std::vector<std::optional<double>> scores = robust_scores(values, kind.least);
    const std::string usual = figure_text(which, median_of(shown));
    for (size_t i = 0; i < entries.size(); ++i) {
      const double score = scores[i].value_or(0);
      const double bad = kind.worse == 0 ? std::abs(score) : kind.worse * score;
      if (bad > kStandsOut) {
        reasons[i].emplace_back(bad,
                                fmt::format("{} {}, where the median is {}", kind.in_words,
                                            figure_text(which, entries[i].figures[which]), usual));
      }
    }
  }
  for (size_t i = 0; i < entries.size(); ++i) {
    std::ranges::stable_sort(reasons[i], std::ranges::greater{},
                             &std::pair<double, std::string>::first);
    for (const auto& [score, reason] : reasons[i]) {
      entries[i].score = std::max(entries[i].score, score);
      entries[i].reasons.push_back(reason);
    }
  }
}

}  // namespace clipgs
