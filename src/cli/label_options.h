#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "pipeline/section_step.h"

#include "volume/label_looks.h"
#include "volume/load.h"

namespace clipgs {

/// --label and --label-table.
struct LabelArguments {
  std::vector<std::string> looks;  ///< as parse_label() reads them
  std::string table;               ///< JSON file; empty: none
};

/// Adds --labels, --label and --label-table. `labels` and `loading` must outlive the parsing.
void add_label_options(CLI::App& command, LabelArguments& labels, LoadOptions& loading);

/// The looks of the volume's labels: those of the table, then those of --label; if neither is
/// given, a colour for every label. Warns of a --label that the volume does not have.
LabelLooks load_label_looks(const LabelArguments& labels, const Volume& volume);

/// With labels there is no section, for its faces are drawn from the volume's values, which know
/// nothing of labels. Says so in a warning.
void leave_section_to_splats(const LoadOptions& loading, SectionChoice& section);

}  // namespace clipgs
