#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace clipgs::fuzz {

using Bytes = std::vector<std::uint8_t>;

// Every fuzz target (NAME_fuzz.cpp) defines these two; fuzz_main.cpp makes a libFuzzer program of
// them.

/// Small valid inputs to start from.
std::vector<Bytes> seeds();

/// Reads `input` as the program would. May throw Error; any other end is a finding.
void read(std::span<const std::uint8_t> input);

/// A folder of this process, in memory where the system has such a place, for readers that take
/// paths. Made when first asked for, removed when the program ends.
const std::filesystem::path& scratch_folder();

/// Writes the input as a file of this name in the scratch folder.
std::filesystem::path as_file(std::span<const std::uint8_t> input, std::string_view name);

Bytes bytes_of(std::string_view text);
std::string text_of(std::span<const std::uint8_t> input);

}  // namespace clipgs::fuzz
