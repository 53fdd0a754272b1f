#pragma once

#include <cstdint>
#include <filesystem>
#include <set>
#include <string>
#include <string_view>

#include "archive/multipart.h"

namespace clipgs {

/// The files of one series as they come from an archive, in a folder: numbered, and checked. A file
/// that came whole is NUMBER.dcm, all else is removed.
class IncomingSeries {
 public:
  /// Takes over what is in the folder already, as far as it is of the series. `place`: what errors
  /// call the archive. Throws Error.
  IncomingSeries(std::filesystem::path folder, std::string series, std::string place);
  ~IncomingSeries();
  IncomingSeries(const IncomingSeries&) = delete;
  IncomingSeries& operator=(const IncomingSeries&) = delete;

  static constexpr std::uint64_t kMostBytes = std::uint64_t{4} << 30U;  ///< of one file

  /// The next file. Throws Error if the disk is full, and at its end if it is no DICOM, of another
  /// series or patient.
  void begin();
  void receive(std::string_view bytes);
  void end();
  /// The same, for one who has the parts of a message.
  PartReceiver receiver();

  const std::set<std::string>& instances() const { return instances_; }  ///< UIDs
  std::uint64_t bytes() const { return bytes_; }

 private:
  void take_over();
  void check(const std::filesystem::path& file);
  void close();

  std::filesystem::path folder_;
  std::string series_;
  std::string place_;
  std::set<std::string> instances_;
  std::string patient_;  ///< compared, and nothing else
  bool has_patient_ = false;
  std::uint64_t bytes_ = 0;
  size_t number_ = 0;
  int fd_ = -1;  ///< of the file that comes
  std::uint64_t size_ = 0;
};

}  // namespace clipgs
