#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace clipgs {

/// A file without a name in the system's folder for temporary files (TMPDIR): nobody else finds it,
/// and it is gone with the process, however that ends. Patients' data may lie in it.
class NamelessFile {
 public:
  NamelessFile();
  ~NamelessFile();
  NamelessFile(const NamelessFile&) = delete;
  NamelessFile& operator=(const NamelessFile&) = delete;

  /// Throws Error if the disk is full.
  void append(std::span<const std::uint8_t> bytes);
  /// Throws Error if it is shorter. May be called from several threads.
  std::vector<std::uint8_t> read(std::uint64_t offset, size_t size) const;
  std::uint64_t size() const { return size_; }

 private:
  int file_ = -1;
  std::uint64_t size_ = 0;
};

}  // namespace clipgs
