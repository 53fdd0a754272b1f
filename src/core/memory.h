#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace clipgs {

/// Bytes of memory that can still be taken: what the kernel calls available, and free swap space
/// (/proc/meminfo), or less where a control group that the process is in (a container's limit,
/// cgroup v1 or v2) leaves less; caches that give way count as free. `root` stands for "/". Without
/// any of these files: no limit is known, and the largest number comes back.
std::uint64_t available_memory(const std::filesystem::path& root = "/");

/// "5.1 GB": decimal, as disks and files are counted.
std::string gigabytes(std::uint64_t bytes);

}  // namespace clipgs
