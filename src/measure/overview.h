#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "asset/webp.h"
#include "core/image.h"

namespace clipgs {

/// The figures that cases of a batch are compared by.
enum class Figure { kFaces, kUncut, kCuts, kNoiseFloor, kSplats, kBytes, kMinutes, kCount };
constexpr size_t kFigures = static_cast<size_t>(Figure::kCount);

/// One case of a folder, and what a batch noted of it: a list of what is allowed, for what is
/// noted names files.
struct OverviewEntry {
  enum class State { kFailed, kUnfinished, kDone };

  std::string name;  ///< of its file, or in the batch's table
  State state = State::kDone;
  std::string title, region, preset, created;  ///< as the case says; empty of one that failed
  std::optional<double> figures[kFigures];
  std::string failure;             ///< the step and its last line, without names
  std::vector<std::string> notes;  ///< of its warnings
  bool has_report = false;         ///< overview/NAME.html
  Bytes thumbnail;                 ///< WebP; empty if there is none

  /// Why it stands out, the farthest first, and how far: "faces 24.1 dB, of others 31.2".
  std::vector<std::string> reasons;
  double score = 0;  ///< robust standard deviations; 0: it does not
};

/// Every *.sog of the folder and what `batch.json` names beside them, with figures of NAME.figures
/// (clipgs eval --json) and records of NAME.clipgs-work/batch, both where they are there: those
/// that failed first, then those that are not finished, then by how far they stand out. Throws
/// Error if the folder cannot be read.
std::vector<OverviewEntry> gather_overview(const std::filesystem::path& folder);

}  // namespace clipgs
