#pragma once

#include <filesystem>
#include <sys/types.h>

namespace clipgs {

/// A folder for temporary files (in TMPDIR) that nobody but its owner can look into, and that is
/// gone with the object, or with the process however that ends: another process waits for it.
/// Patients' data may lie in it.
class PrivateFolder {
 public:
  /// Throws Error.
  PrivateFolder();
  ~PrivateFolder();
  PrivateFolder(const PrivateFolder&) = delete;
  PrivateFolder& operator=(const PrivateFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
  int life_ = -1;  ///< closed with this process, which the other one sees
  pid_t sweeper_ = -1;
};

}  // namespace clipgs
