#pragma once

#include <CLI/CLI.hpp>

namespace clipgs {

// Each adds one subcommand; its callback does the work and throws Error on failure.
// One file per command: src/cli/<name>_command.cpp; manual_command.cpp has what tells of all of
// them.
void add_archive_command(CLI::App& app);
void add_bake_command(CLI::App& app);
void add_build_command(CLI::App& app);
void add_cinema_command(CLI::App& app);
void add_completion_command(CLI::App& app);
void add_dataset_command(CLI::App& app);
void add_eval_command(CLI::App& app);
void add_export_command(CLI::App& app);
void add_fetch_command(CLI::App& app);
void add_info_command(CLI::App& app);
void add_looks_command(CLI::App& app);
void add_man_command(CLI::App& app);
void add_overview_command(CLI::App& app);
void add_pack_command(CLI::App& app);
void add_phantom_command(CLI::App& app);
void add_refine_command(CLI::App& app);
void add_render_command(CLI::App& app);
void add_serve_command(CLI::App& app);
void add_study_command(CLI::App& app);
void add_token_command(CLI::App& app);
void add_train_command(CLI::App& app);
void add_unpack_command(CLI::App& app);
void add_view_command(CLI::App& app);

}  // namespace clipgs
