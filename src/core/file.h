#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace clipgs {

/// The whole file. Throws Error if it cannot be read or is longer than `limit` bytes.
std::vector<std::uint8_t> read_file(const std::filesystem::path& path,
                                    std::uintmax_t limit = std::uintmax_t{4} << 30);
std::string read_text(const std::filesystem::path& path);

/// Writes the file whole or not at all: a temporary beside it, fsync, rename. A full disk or a
/// killed process leaves the old file (or none), never half of the new one. A symbolic link stays,
/// and what it leads to is written. Throws Error, also if what is there is no regular file.
void write_file(const std::filesystem::path& path, const void* data, size_t size);
void write_text(const std::filesystem::path& path, std::string_view text);

/// Checks, before hours of work, that write_file can write `path`, and sweeps what it may have left
/// there. Throws Error.
void require_writable(const std::filesystem::path& path);

/// Removes the temporaries, NAME.clipgs-PROCESS.part, that killed processes left in the folder, of
/// files whose names begin with `prefix`. Those that a living process holds (flock(2)) stay.
void sweep_leftovers(const std::filesystem::path& folder, const std::string& prefix = "");

/// Checks, before `bytes` are written into the folder, that its disk has room for them. Throws
/// Error.
void require_free_space(const std::filesystem::path& folder, std::uintmax_t bytes);

/// As std::filesystem::temp_directory_path() (TMPDIR), which hides a folder that is not there.
std::filesystem::path temporary_folder();

/// Creates the folder and its parents. Throws Error.
void create_folder(const std::filesystem::path& path);

}  // namespace clipgs
