#include "volume/dicom_archive.h"

#include <algorithm>
#include <archive.h>
#include <archive_entry.h>
#include <array>
#include <memory>
#include <sstream>
#include <string_view>

#include "core/error.h"
#include "core/progress.h"
#include "volume/inflater.h"

namespace clipgs {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kLargestFile = std::uint64_t{4} << 30;  // as read_file() has it
constexpr size_t kBlock = size_t{64} << 10;

struct Closer {
  void operator()(archive* a) const { archive_read_free(a); }
};

}  // namespace

bool begins_dicom(std::span<const std::uint8_t> head) {
  constexpr size_t kPreamble = 128;
  constexpr std::string_view kMagic = "DICM";
  std::array<std::uint8_t, kPreamble + kMagic.size()> begin{};
  if (begins_gzip(head)) {
    std::istringstream stream(std::string(head.begin(), head.end()));
    if (Inflater(stream).read(begin) < begin.size()) {
      return false;
    }
  } else if (head.size() < begin.size()) {
    return false;
  } else {
    std::ranges::copy(head.first(begin.size()), begin.begin());
  }
  return std::ranges::equal(std::span(begin).subspan(kPreamble), kMagic);
}

std::uint64_t most_unpacked(std::uint64_t packed) {
  constexpr std::uint64_t kAlwaysFine = std::uint64_t{16} << 20;
  constexpr std::uint64_t kNeverFine = std::uint64_t{64} << 30;
  constexpr std::uint64_t kBestPacking = 100;
  return std::min(kNeverFine, kAlwaysFine + kBestPacking * std::min(packed, kNeverFine));
}

/// Goes through the archive once.
class DicomArchive::Reader {
 public:
  explicit Reader(const fs::path& path)
      : name_(path.string()), size_(fs::file_size(path)), archive_(archive_read_new()) {
    // The seekable reader alone: it goes by the central directory, as everything else does.
    if (archive_ == nullptr || archive_read_support_format_zip_seekable(a()) != ARCHIVE_OK ||
        archive_read_open_filename(a(), path.c_str(), kBlock) != ARCHIVE_OK) {
      fail();
    }
  }

  void unpack(std::vector<Member>& members, NamelessFile& file) {
    Progress progress("unpacking", size_);
    archive_entry* entry = nullptr;
    for (size_t number = 1; next(entry); ++number) {
      if (archive_entry_filetype(entry) == AE_IFREG && !is_directory_file(entry)) {
        unpack_entry(entry, number, members, file);
      }
      progress.update(static_cast<size_t>(std::clamp<la_int64_t>(archive_filter_bytes(a(), -1), 0,
                                                                 static_cast<la_int64_t>(size_))));
    }
  }

 private:
  archive* a() const { return archive_.get(); }

  [[noreturn]] void fail() const {
    const char* reason = archive_ == nullptr ? nullptr : archive_error_string(a());
    throw Error("{}: a truncated or corrupt ZIP ({}); copy it again", name_,
                reason != nullptr ? reason : "not a ZIP");
  }

  bool next(archive_entry*& entry) const {
    const int status = archive_read_next_header(a(), &entry);
    // A warning is about a name that is no text; names do not matter.
    if (status != ARCHIVE_OK && status != ARCHIVE_WARN && status != ARCHIVE_EOF) {
      fail();
    }
    return status != ARCHIVE_EOF;
  }

  static fs::path path_of(archive_entry* entry) {
    const char* path = archive_entry_pathname(entry);
    return path == nullptr ? "" : path;
  }

  static bool is_directory_file(archive_entry* entry) {
    return path_of(entry).filename() == "DICOMDIR";
  }

  enum class State { kGoing, kWhole, kDamaged };

  /// Appends a piece of the current file.
  State read_piece(std::vector<std::uint8_t>& bytes) const {
    const void* block = nullptr;
    size_t size = 0;
    la_int64_t offset = 0;
    const int status = archive_read_data_block(a(), &block, &size, &offset);
    if (status == ARCHIVE_EOF) {
      return State::kWhole;
    }
    if (status == ARCHIVE_FATAL) {
      fail();
    }
    if (status == ARCHIVE_OK || status == ARCHIVE_WARN) {  // a wrong checksum warns, at the end
      const auto* begin = static_cast<const std::uint8_t*>(block);
      bytes.insert(bytes.end(), begin, begin + size);
    }
    return status == ARCHIVE_OK ? State::kGoing : State::kDamaged;
  }

  void unpack_entry(archive_entry* entry, size_t number, std::vector<Member>& members,
                    NamelessFile& file) {
    if (archive_entry_is_data_encrypted(entry) != 0) {
      throw Error("{}: is locked with a password; unpack it and give its folder", name_);
    }
    std::vector<std::uint8_t> bytes;
    State state = State::kGoing;
    while (state == State::kGoing && bytes.size() < kDicomHead) {
      state = read_piece(bytes);
    }
    // What is damaged before it can be told counts as DICOM.
    const auto head = std::span(bytes).first(std::min(bytes.size(), kDicomHead));
    if (!begins_dicom(head) && (state != State::kDamaged || bytes.size() >= kDicomHead)) {
      return;  // the next header passes over the rest
    }
    Member member{number, path_of(entry).parent_path().string(), file.size(), 0, false};
    for (;;) {
      file.append(bytes);
      member.size += bytes.size();
      if (member.size > kLargestFile || file.size() > most_unpacked(size_)) {
        throw Error(
            "{}: unpacks to more than DICOM does ({} MiB and no end); if you trust it, unpack it "
            "and give its folder",
            name_, file.size() >> 20);
      }
      if (state != State::kGoing) {
        break;
      }
      bytes.clear();
      state = read_piece(bytes);
    }
    member.damaged = state == State::kDamaged;
    members.push_back(std::move(member));
  }

  std::string name_;
  std::uint64_t size_;
  std::unique_ptr<archive, Closer> archive_;
};

DicomArchive::DicomArchive(const fs::path& path) { Reader(path).unpack(members_, unpacked_); }

std::vector<std::uint8_t> DicomArchive::read(size_t member, const std::string& name) const {
  const Member& m = members_[member];
  if (m.damaged) {
    throw Error("{}: truncated or corrupt: its checksum is wrong", name);
  }
  return unpacked_.read(m.offset, m.size);
}

}  // namespace clipgs
