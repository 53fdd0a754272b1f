#include "cli/quality.h"

#include <array>
#include <fmt/format.h>
#include <utility>

namespace clipgs {

namespace {

// Many pictures of few samples teach more than few clean ones: every picture shows other planes,
// and noise averages out over them. What limits their number is the memory that training holds them
// in. Test pictures are few: they cost as much as ten others, and nothing is made of them.
constexpr std::array kQualities = {
    Quality{"draft", 192, 600, 2, 4, 40000, 2000, 1},
    Quality{"standard", 256, 1000, 4, 4, 40000, 2500, 1},
    Quality{"high", 512, 3000, 8, 12, 150000, 24000, 2},
};

}  // namespace

const Quality& find_quality(const std::string& name) {
  for (const Quality& quality : kQualities) {
    if (name == quality.name) {
      return quality;
    }
  }
  throw CLI::ValidationError("--quality",
                             fmt::format("\"{}\" is not instant, draft, standard or high", name));
}

void add_step_quality(CLI::App& command, const std::string& what,
                      std::function<void(const Quality&)> take) {
  command
      .add_option_function<std::string>(
          "--quality",
          [take = std::move(take)](const std::string& name) { take(find_quality(name)); },
          what + ", as clipgs build has it: draft, standard or high (default: what each says)")
      ->check(CLI::IsMember({"draft", "standard", "high"}));
}

}  // namespace clipgs
