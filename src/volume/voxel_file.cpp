#include "volume/voxel_file.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <string>

#include "core/error.h"
#include "volume/inflater.h"

namespace clipgs {
namespace {

namespace fs = std::filesystem;
using Encoding = VoxelSource::Encoding;

size_t voxels_of(const ImageHeader& header) {
  return static_cast<size_t>(header.dims.x) * header.dims.y * header.dims.z;
}

/// Collects the voxels of one frame out of the bytes of all.
class Frame {
 public:
  Frame(const ImageHeader& header, int frame)
      : header_(header), values_(header.channels == 1 ? voxels_of(header) : 0) {
    begin_ = header.frame_bytes() * static_cast<std::uint64_t>(frame);
    image_.dims = header.dims;
    image_.spacing = header.spacing;
    image_.direction = header.direction;
    image_.origin = header.origin;
    image_.eight_bit = size_of(header.type) == 1 && header.slope == 1 && header.intercept == 0 &&
                       header.channels == 1;
    if (header.channels > 1) {
      image_.rgb.reserve(3 * voxels_of(header));
    }
  }

  std::uint64_t begin() const { return begin_; }
  std::uint64_t end() const { return begin_ + header_.frame_bytes(); }

  /// Takes what belongs to the frame; `at` is the place of the first of `bytes` among all frames.
  void take(std::span<const std::uint8_t> bytes, std::uint64_t at) {
    const std::uint64_t first = std::max(at, begin());
    const std::uint64_t last = std::min(at + bytes.size(), end());
    if (first >= last) {
      return;
    }
    const auto mine = bytes.subspan(first - at, last - first);
    if (header_.channels == 1) {
      piece_.clear();
      append_scalars(mine, header_.type, header_.big_endian, header_.slope, header_.intercept,
                     piece_);
      values_.append(piece_);
      return;
    }
    // Pieces end anywhere, within a voxel too.
    const auto channels = static_cast<std::uint64_t>(header_.channels);
    std::uint64_t channel = (first - begin()) % channels;
    for (const std::uint8_t byte : mine) {
      if (channel < 3) {
        image_.rgb.push_back(byte);
      }
      channel = channel + 1 == channels ? 0 : channel + 1;
    }
  }

  /// A number of a text.
  void take_number(double number, std::uint64_t at) {
    const std::uint64_t first = begin_ / size_of(header_.type);
    const std::uint64_t last = end() / size_of(header_.type);
    if (at < first || at >= last) {
      return;
    }
    if (header_.channels == 1) {
      const auto value = static_cast<float>(number * header_.slope + header_.intercept);
      values_.append({&value, 1});
    } else if ((at - first) % static_cast<std::uint64_t>(header_.channels) < 3) {
      image_.rgb.push_back(static_cast<std::uint8_t>(number));
    }
  }

  StoredImage image() && {
    image_.values = values_.take();
    return std::move(image_);
  }

 private:
  const ImageHeader& header_;
  std::uint64_t begin_ = 0;
  StoredImage image_;  // but for its values
  ValuePacker values_;
  std::vector<float> piece_;
};

[[noreturn]] void throw_missing(const std::string& where, std::uint64_t missing,
                                std::uint64_t expected) {
  throw Error(
      "{}: truncated: {} of the {} bytes of voxels that its header promises are missing; copy or "
      "download it again",
      where, missing, expected);
}

[[noreturn]] void throw_missing_numbers(const std::string& where, std::uint64_t missing,
                                        std::uint64_t expected) {
  throw Error("{}: truncated: at least {} of the {} numbers that its header promises are missing",
              where, missing, expected);
}

/// One file of voxels.
struct Part {
  fs::path path;
  std::uint64_t begin = 0;  // place of its first byte among the voxels of all frames
  std::uint64_t bytes = 0;  // of voxels, unpacked
};

/// Leaves the stream after `source.lines` lines and `source.offset` bytes; returns that place.
std::uint64_t skip_header(std::ifstream& file, const VoxelSource& source,
                          std::uint64_t file_bytes) {
  file.seekg(static_cast<std::streamoff>(std::min(source.offset, file_bytes)));
  std::uint64_t lines = 0;
  std::uint64_t at = source.offset;
  for (char c = 0; lines < source.lines && file.get(c); ++at) {
    lines += c == '\n' ? 1 : 0;
  }
  file.clear();
  return std::min(at, file_bytes);
}

/// Where the voxels of a raw file begin.
std::uint64_t raw_start(const Part& part, std::uint64_t from, std::uint64_t file_bytes,
                        const VoxelSource& source) {
  return source.at_end ? file_bytes - std::min(part.bytes, file_bytes)
                       : std::min(from + source.unpacked_offset, file_bytes);
}

void read_raw(std::ifstream& file, const Part& part, std::uint64_t start, Frame& frame) {
  constexpr std::uint64_t kPiece = 1 << 20;
  std::vector<std::uint8_t> piece(kPiece);
  std::uint64_t at = std::max(part.begin, frame.begin());
  const std::uint64_t end = std::min(part.begin + part.bytes, frame.end());
  file.seekg(static_cast<std::streamoff>(start + (at - std::min(at, part.begin))));
  while (at < end) {
    const std::uint64_t count = std::min(kPiece, end - at);
    if (!file.read(reinterpret_cast<char*>(piece.data()), static_cast<std::streamsize>(count))) {
      throw Error("{}: cannot be read to its end", part.path.string());
    }
    frame.take(std::span(piece).first(count), at);
    at += count;
  }
}

[[noreturn]] void throw_bad_stream(Inflater::State state, const Part& part, std::uint64_t done) {
  const std::string where = part.path.string();
  switch (state) {
    case Inflater::State::kDamaged:
      throw Error(
          "{}: damaged: its packed data cannot be unpacked after {} of {} bytes of voxels ({} "
          "missing); copy or download it again",
          where, done, part.bytes, part.bytes - done);
    case Inflater::State::kMismatch:
      throw Error(
          "{}: damaged: its voxels do not match their checksum (CRC) or length; copy or download "
          "it again",
          where);
    case Inflater::State::kCutOff:
      if (done == part.bytes) {
        throw Error(
            "{}: truncated: the end of its packed data, with their checksum, is missing; copy or "
            "download it again",
            where);
      }
      break;
    case Inflater::State::kGoing:
    case Inflater::State::kWhole:
      break;
  }
  throw_missing(where, part.bytes - done, part.bytes);
}

constexpr std::uint64_t kBestDeflate = 1032;  // bytes out of one, at most

/// Whether that many bytes can come out of that many packed ones at all: a header that promises
/// more is corrupt, and must not make us wait or allocate for it.
bool can_hold(std::uint64_t packed, std::uint64_t unpacked) {
  return unpacked / kBestDeflate <= packed;
}

/// Unpacks to the very end: only there are the CRC and the length.
void read_packed(std::ifstream& file, const Part& part, std::uint64_t from,
                 std::uint64_t file_bytes, const VoxelSource& source, Frame& frame) {
  const std::string where = part.path.string();
  constexpr size_t kPiece = size_t{1} << 20;
  constexpr std::uint64_t kMostExtra = std::uint64_t{1} << 20;
  file.seekg(static_cast<std::streamoff>(from));
  Inflater inflater(file);
  std::vector<std::uint8_t> piece(kPiece);
  std::uint64_t skipped = 0;
  std::uint64_t done = 0;
  while (inflater.state() == Inflater::State::kGoing) {
    std::uint64_t wanted = done < part.bytes ? part.bytes - done : kPiece;
    if (skipped < source.unpacked_offset) {
      wanted = source.unpacked_offset - skipped;
    }
    const size_t count =
        inflater.read(std::span(piece).first(std::min<std::uint64_t>(kPiece, wanted)));
    if (skipped < source.unpacked_offset) {
      skipped += count;
      if (!can_hold(file_bytes - from, skipped)) {
        break;
      }
      continue;
    }
    if (done < part.bytes) {
      frame.take(std::span(piece).first(count), part.begin + done);
    }
    done += count;
    if (done > part.bytes + kMostExtra) {
      throw Error("{}: corrupt: it unpacks to more than the {} bytes of voxels of its header",
                  where, part.bytes);
    }
  }
  if (inflater.state() != Inflater::State::kWhole || done < part.bytes) {
    throw_bad_stream(inflater.state(), part, std::min(done, part.bytes));
  }
}

/// The numbers of a text; `from`: where they begin.
void read_text_numbers(std::ifstream& file, const Part& part, std::uint64_t from,
                       const ImageHeader& header, Frame& frame) {
  const std::string where = part.path.string();
  const std::uint64_t wanted = part.bytes / size_of(header.type);
  const std::uint64_t first = part.begin / size_of(header.type);
  file.seekg(static_cast<std::streamoff>(from + header.source.unpacked_offset));
  std::uint64_t count = 0;
  std::string word;
  while (count < wanted && file >> word) {
    double number = 0;
    word.erase(std::ranges::remove(word, ',').begin(), word.end());
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), number);
    if (error != std::errc() || end != word.data() + word.size()) {
      throw Error("{}: corrupt: voxel {} of its text is no number", where, count);
    }
    const bool fits = header.channels == 1 || (number >= 0 && number <= 255);
    if (!fits) {
      throw Error("{}: corrupt: a colour of its text is {}, not 0 to 255", where, number);
    }
    frame.take_number(number, first + count);
    ++count;
  }
  if (count < wanted) {
    throw_missing_numbers(where, wanted - count, wanted);
  }
}

/// An opened file of voxels.
struct OpenedPart {
  std::ifstream file;
  std::uint64_t bytes = 0;
  std::uint64_t from = 0;  // where the voxels begin, packed or not
};

OpenedPart open_part(const Part& part, const VoxelSource& source) {
  std::error_code ignored;
  if (!fs::is_regular_file(part.path, ignored)) {
    throw Error("{}: no such file: {} bytes of voxels are missing", part.path.string(), part.bytes);
  }
  OpenedPart opened;
  opened.file.open(part.path, std::ios::binary);
  if (!opened.file) {
    throw Error("{}: cannot be opened", part.path.string());
  }
  opened.bytes = fs::file_size(part.path);
  opened.from = skip_header(opened.file, source, opened.bytes);
  return opened;
}

/// Throws if the file is too small for its voxels, as far as its size tells: before anything is
/// allocated for them.
void require_size(const Part& part, const ImageHeader& header) {
  const OpenedPart opened = open_part(part, header.source);
  const std::uint64_t there = opened.bytes - opened.from;
  switch (header.source.encoding) {
    case Encoding::kRaw: {
      const std::uint64_t raw =
          opened.bytes - raw_start(part, opened.from, opened.bytes, header.source);
      if (raw < part.bytes) {
        throw_missing(part.path.string(), part.bytes - raw, part.bytes);
      }
      break;
    }
    case Encoding::kDeflate:
      if (!can_hold(there, part.bytes)) {
        throw Error(
            "{}: truncated or corrupt: its {} bytes cannot hold the {} bytes of voxels that its "
            "header promises: at least {} are missing",
            part.path.string(), there, part.bytes, part.bytes - there * kBestDeflate);
      }
      break;
    case Encoding::kText: {
      const std::uint64_t numbers = part.bytes / size_of(header.type);
      const std::uint64_t most = (there + 1) / 2;  // a digit and a blank
      if (most < numbers) {
        throw_missing_numbers(part.path.string(), numbers - most, numbers);
      }
      break;
    }
  }
}

void read_part(const Part& part, const ImageHeader& header, Frame& frame) {
  OpenedPart opened = open_part(part, header.source);
  switch (header.source.encoding) {
    case Encoding::kRaw:
      read_raw(opened.file, part, raw_start(part, opened.from, opened.bytes, header.source), frame);
      break;
    case Encoding::kDeflate:
      read_packed(opened.file, part, opened.from, opened.bytes, header.source, frame);
      break;
    case Encoding::kText:
      read_text_numbers(opened.file, part, opened.from, header, frame);
      break;
  }
}

}  // namespace

StoredImage read_voxels(const ImageHeader& header, const fs::path& path, int frame_index) {
  const std::vector<std::string>& names = header.source.files;
  const std::uint64_t parts = std::max<size_t>(1, names.size());
  const std::uint64_t bytes =
      header.frame_bytes() * static_cast<std::uint64_t>(header.frames) / parts;
  const size_t voxel_bytes = size_of(header.type) * static_cast<size_t>(header.channels);
  if (bytes * parts != header.frame_bytes() * static_cast<std::uint64_t>(header.frames) ||
      bytes % voxel_bytes != 0) {
    throw Error("{}: its voxels cannot be shared out evenly to the {} files it names",
                path.string(), parts);
  }
  const auto part = [&](std::uint64_t i) {
    return Part{names.empty() ? path : path.parent_path() / names[i], i * bytes, bytes};
  };
  for (std::uint64_t i = 0; i < parts; ++i) {
    require_size(part(i), header);
  }
  Frame frame(header, frame_index);
  for (std::uint64_t i = 0; i < parts; ++i) {
    read_part(part(i), header, frame);
  }
  return std::move(frame).image();
}

}  // namespace clipgs
