#include "cli/label_options.h"

#include <algorithm>
#include <fmt/ranges.h>

#include "core/error.h"

namespace clipgs {
namespace {

/// CLI11's checks return what is wrong; nothing if all is well.
std::string why_no_label(const std::string& text) {
  try {
    parse_label(text);
    return "";
  } catch (const Error& error) {
    return error.what();
  }
}

}  // namespace

void add_label_options(CLI::App& command, LabelArguments& labels, LoadOptions& loading) {
  CLI::Option* const file = command.add_option(
      "--labels", loading.labels,
      "Segmentation of the volume: NIfTI, NRRD or MetaImage of whole numbers in the same patient "
      "space, on any grid. Every label gets a colour unless --label or --label-table say more");
  command
      .add_option("--label", labels.looks,
                  "Look of label N: N=#rrggbb, N=OPACITY (0..1), N=#rrggbb,OPACITY or N=hidden; 0 "
                  "is what has no label; may be given again")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)
      ->check(why_no_label, "N=LOOK")
      ->needs(file);
  command
      .add_option("--label-table", labels.table,
                  "JSON file of labels' names, colours and opacities (docs/presets.md)")
      ->needs(file);
}

LabelLooks load_label_looks(const LabelArguments& labels, const Volume& volume) {
  if (labels.looks.empty() && labels.table.empty()) {
    return label_palette(volume.label_numbers);
  }
  LabelLooks looks = labels.table.empty() ? LabelLooks() : load_label_table(labels.table);
  for (const std::string& text : labels.looks) {
    const auto [number, look] = parse_label(text);
    looks[number] = look;
    if (std::ranges::find(volume.label_numbers, number) == volume.label_numbers.end()) {
      warn(fmt::format("--label {}: there is no label {}, only {}", text, number,
                       fmt::join(volume.label_numbers, ", ")));
    }
  }
  return looks;
}

void leave_section_to_splats(const LoadOptions& loading, SectionChoice& section) {
  if (!loading.labels.empty() && !section.none) {
    warn(
        "no section: faces drawn from the volume's data do not know labels; splats fill the cut "
        "faces instead (give --no-section to agree)");
    section.none = true;
  }
}

}  // namespace clipgs
