#include "core/memory.h"

#include <algorithm>
#include <fmt/format.h>
#include <fstream>
#include <limits>
#include <optional>
#include <string_view>

namespace clipgs {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kUnlimited = std::numeric_limits<std::uint64_t>::max();

/// The first number of a file; none for "max", or where there is no such file.
std::optional<std::uint64_t> number_in(const fs::path& path) {
  std::ifstream file(path);
  std::uint64_t number = 0;
  return file >> number ? std::optional(number) : std::nullopt;
}

/// The number after `key`, a word, of a file of lines "key number"; 0 if there is none.
std::uint64_t number_after(const fs::path& path, std::string_view key) {
  std::ifstream file(path);
  std::string word;
  std::uint64_t number = 0;
  while (file >> word) {
    if (word == key && file >> number) {
      return number;
    }
  }
  return 0;
}

/// What one control group leaves.
std::uint64_t left_in_group(const fs::path& group, const char* limit, const char* used) {
  const std::optional<std::uint64_t> most = number_in(group / limit);
  const std::optional<std::uint64_t> taken = number_in(group / used);
  if (!most || !taken) {
    return kUnlimited;
  }
  const fs::path stat = group / "memory.stat";
  const std::uint64_t cache =
      number_after(stat, "inactive_file") + number_after(stat, "active_file");
  const std::uint64_t held = *taken - std::min(*taken, cache);
  return *most - std::min(*most, held);
}

/// The least that the group at `path` below `tree` and those above it leave.
std::uint64_t left_in_groups(const fs::path& tree, const fs::path& path, const char* limit,
                             const char* used) {
  std::uint64_t least = left_in_group(tree, limit, used);
  fs::path group = tree;
  for (const fs::path& name : path.relative_path()) {
    group /= name;
    least = std::min(least, left_in_group(group, limit, used));
  }
  return least;
}

}  // namespace

std::uint64_t available_memory(const fs::path& root) {
  const fs::path meminfo = root / "proc/meminfo";
  const std::uint64_t kib =
      number_after(meminfo, "MemAvailable:") + number_after(meminfo, "SwapFree:");
  std::uint64_t least = kib > 0 ? kib * 1024 : kUnlimited;
  // Lines "0::/path" of version 2, "7:memory:/path" of version 1.
  std::ifstream groups(root / "proc/self/cgroup");
  const fs::path tree = root / "sys/fs/cgroup";
  for (std::string line; std::getline(groups, line);) {
    const size_t colon = line.find(':');
    const size_t second = line.find(':', colon + 1);
    if (colon == std::string::npos || second == std::string::npos) {
      continue;
    }
    const std::string_view kinds = std::string_view(line).substr(colon + 1, second - colon - 1);
    const fs::path path = line.substr(second + 1);
    if (kinds.empty()) {
      least = std::min(least, left_in_groups(tree, path, "memory.max", "memory.current"));
    } else if (kinds.find("memory") != std::string_view::npos) {
      least = std::min(least, left_in_groups(tree / "memory", path, "memory.limit_in_bytes",
                                             "memory.usage_in_bytes"));
    }
  }
  return least;
}

std::string gigabytes(std::uint64_t bytes) {
  return fmt::format("{:.1f} GB", static_cast<double>(bytes) / 1e9);
}

}  // namespace clipgs
