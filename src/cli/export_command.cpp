#include <fmt/format.h>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "asset/case.h"
#include "asset/filled.h"
#include "asset/glb.h"
#include "asset/sog.h"
#include "asset/spz.h"
#include "cli/arguments.h"
#include "cli/commands.h"
#include "cli/cut_options.h"
#include "core/error.h"
#include "core/file.h"
#include "splat/ply.h"
#include "splat/similarity.h"

namespace clipgs {

namespace {

struct ExportArguments {
  std::string input;
  std::string output;
  std::string format;  // "": as the output ends
  CutArguments cut;
  size_t fill = 60000;
  int spz_version = kSpzVersion;
};

/// SOG without what is clipgs's own.
Bytes encode_plain_sog(const Gaussians& gaussians) {
  std::vector<ZipEntry> files;
  nlohmann::json meta = encode_sog(gaussians, files);
  meta.erase("clipgs");
  const std::string text = meta.dump();
  files.insert(files.begin(), {"meta.json", Bytes(text.begin(), text.end())});
  return write_zip(files);
}

void write_splats(const ExportArguments& arguments, const std::string& format,
                  const Gaussians& gaussians) {
  if (format == "ply") {
    write_ply(arguments.output, gaussians);
    return;
  }
  const Bytes bytes = format == "spz"   ? encode_spz(gaussians, arguments.spz_version)
                      : format == "glb" ? encode_glb(gaussians)
                                        : encode_plain_sog(gaussians);
  write_file(arguments.output, bytes.data(), bytes.size());
}

/// ply, spz, glb or sog.
std::string format_of(const ExportArguments& arguments) {
  const std::string ending = std::filesystem::path(arguments.output).extension().string();
  const std::string format = ending.empty() ? "" : ending.substr(1);
  if (!arguments.format.empty() && arguments.format != format) {
    throw Error("{} does not end in .{}, as --format says; change one of them", arguments.output,
                arguments.format);
  }
  return format;
}

void run_export(const ExportArguments& arguments) {
  const std::string format = format_of(arguments);
  require_writable(arguments.output);
  Case contents = load_case(arguments.input);
  prepare_openings(contents);
  const Cut cut = parse_cut(arguments.cut);
  warn_if_plane_misses(cut, contents.scene.bounds);
  const Gaussians gaussians =
      transform(filled_splats(contents, cut, arguments.fill), scene_to_world().inverse());
  if (gaussians.size() == 0) {
    throw Error("the cut leaves nothing to export; move its plane");
  }
  write_splats(arguments, format, gaussians);
  fmt::print("{}: {} splats, {:.2f} MB\n", arguments.output, gaussians.size(),
             1e-6 * static_cast<double>(std::filesystem::file_size(arguments.output)));
}

}  // namespace

void add_export_command(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("export", "Write a case, uncut or cut, as splats for other programs");
  const auto arguments = std::make_shared<ExportArguments>();
  command->add_option("case", arguments->input, "Case (.sog) or scene (.ply)")->required();
  command
      ->add_option("-o,--output", arguments->output,
                   "File to write: .ply (3D Gaussian Splatting), .spz (version 4), .glb (glTF with "
                   "KHR_gaussian_splatting) or .sog (without what is clipgs's own)")
      ->required()
      ->check(ends_in({".ply", ".spz", ".glb", ".sog"}));
  command->add_option("--format", arguments->format, "The same, where it is to be checked")
      ->check(CLI::IsMember({"ply", "spz", "glb", "sog"}));
  add_cut_options(*command, arguments->cut);
  command
      ->add_option(
          "--fill", arguments->fill,
          "Splats, about, that fill faces, those of a cut and where the volume ends, and "
          "up to four times as many for skin and walls: clipgs draws these from the volume")
      ->check(CLI::Range(100, 2'000'000))
      ->capture_default_str();
  command
      ->add_option("--spz-version", arguments->spz_version,
                   "Of .spz: 4, or 3 for programs that do not read that yet")
      ->check(CLI::Range(kOldSpzVersion, kSpzVersion))
      ->capture_default_str();
  command->footer(
      "Example: clipgs export case.sog -o case.spz\n"
      "         clipgs export case.sog -o cut.glb --plane 0,0,-1,-40");
  command->callback([arguments] { run_export(*arguments); });
}

}  // namespace clipgs
