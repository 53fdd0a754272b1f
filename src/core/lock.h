#pragma once

#include <filesystem>
#include <string>

namespace clipgs {

/// A lock file, held by flock(2) as long as the object lives: it vanishes with the process, however
/// that ends, and says in its text who holds it. Other machines respect it where the file system's
/// locks reach them, as NFS's do from version 4 on; on a file system without locks there is a
/// warning, and nothing is locked.
class FileLock {
 public:
  /// `place`: what the lock stands for, and `remedy`: what else one may do, in the error. Throws
  /// Error if another holds it, that says which process, of which machine, since when.
  FileLock(std::filesystem::path file, const std::filesystem::path& place,
           const std::string& remedy);
  ~FileLock();
  FileLock(const FileLock&) = delete;
  FileLock& operator=(const FileLock&) = delete;

 private:
  bool take(const std::filesystem::path& place, const std::string& remedy);

  std::filesystem::path file_;
  int fd_ = -1;
};

/// One process at a time works in a folder, which is created if it is missing and, if nothing came
/// of the work, removed again. What killed processes left in it is swept (sweep_leftovers()).
class FolderLock {
 public:
  explicit FolderLock(const std::filesystem::path& folder,
                      const std::string& remedy = "choose another folder");
  const std::filesystem::path& folder() const { return created_.folder; }

 private:
  struct Created {
    explicit Created(const std::filesystem::path& path);
    ~Created();
    Created(const Created&) = delete;
    Created& operator=(const Created&) = delete;

    std::filesystem::path folder;
    bool is_new = false;
  };

  Created created_;  // outlives the lock file in it
  FileLock lock_;
};

}  // namespace clipgs
