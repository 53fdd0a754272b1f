#pragma once

#include <CLI/CLI.hpp>

#include "pipeline/section_step.h"

namespace clipgs {

/// --section-size and --no-section, of the commands that make or pack a section. `choice` must
/// outlive the parsing.
void add_section_options(CLI::App& command, SectionChoice& choice);
/// --section-quality and --max-mb, of those that pack.
void add_section_coding(CLI::App& command, SectionChoice& choice);

}  // namespace clipgs
