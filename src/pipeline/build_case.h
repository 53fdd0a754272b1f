#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "pipeline/section_step.h"

#include "asset/case.h"
#include "cinema/make_dataset.h"
#include "core/lock.h"
#include "train/trainer.h"
#include "volume/preset.h"
#include "volume/volume.h"

namespace clipgs {

/// What a build makes of a volume and a look.
struct BuildOptions {
  DatasetOptions pictures;  ///< views, points and side follow from what is below
  SectionChoice section;
  TrainOptions training;    ///< of the explicit scene; the papers' way shares its steps and seed
  bool papers_way = false;  ///< a neural model, baked into layers, that are refined
  std::string title;        ///< of the case; empty: the usual one of its look
};

/// The instant case of a build, into its file, unless that holds it or a finished case already.
/// Throws Error.
void build_instant_first(const Volume& volume, const Preset& preset, const BuildOptions& options,
                         const FolderLock& work, const std::filesystem::path& output);

/// Is given a case that is not finished yet.
using CaseWatcher = std::function<void(Case)>;

/// All that goes into the case, made in steps whose results stay in the folder: dataset/, model.ply
/// (of the papers' way) and scene.ply. Each keeps the claim of what it is made of beside it (Step):
/// what is there of the same claim is kept, what a killed build left is gone on from, and what
/// depends on a change is made again, with a line on standard error that says why. The volume is
/// let go of before training. Throws Error.
/// `show` is given what is worth looking at meanwhile, each better than the one before.
Case build_contents(Volume volume, const Preset& preset, const BuildOptions& options,
                    const FolderLock& work, const CaseWatcher& show = {});

/// The same into a file, which is left alone if it is what was written last of the same. Where it
/// does not hold a finished case yet, it is an instant one (make_instant_case()) as soon as may be,
/// then one of the section that the finished case will have, then what training has come to
/// (method.md §13). Throws Error.
void build_case(Volume volume, const Preset& preset, const BuildOptions& options,
                const FolderLock& work, const std::filesystem::path& output);

}  // namespace clipgs
