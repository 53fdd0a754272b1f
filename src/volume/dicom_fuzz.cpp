// libFuzzer's entry to DICOM: the input is one image in a folder with two good ones of its series,
// as it is or packed by gzip, or an archive of images.
#include <archive.h>
#include <archive_entry.h>
#include <stdexcept>
#include <zlib.h>

#include "core/file.h"
#include "core/fuzz.h"
#include "volume/dicom_fixture.h"
#include "volume/load.h"

namespace clipgs::fuzz {

namespace {

FixtureSlice slice(int number) {
  FixtureSlice result;
  result.instance = number;
  result.columns = 6;
  result.rows = 5;
  result.position.z = number;
  for (int i = 0; i < result.columns * result.rows; ++i) {
    result.pixels.push_back(static_cast<std::int16_t>(100 * i + number));
  }
  return result;
}

Bytes gzipped(const Bytes& bytes) {
  const auto path = scratch_folder() / "seed.gz";
  const gzFile file = gzopen(path.c_str(), "wb");
  gzwrite(file, bytes.data(), static_cast<unsigned>(bytes.size()));
  gzclose(file);
  return read_file(path);
}

Bytes frames(bool rle) {
  const auto path = scratch_folder() / "seed.dcm";
  write_frames(path, {slice(1), slice(2)}, {.defined_lengths = rle, .rle = rle});
  return read_file(path);
}

/// Stored, so that mutations reach the images.
Bytes zipped(const std::vector<Bytes>& files) {
  const auto path = scratch_folder() / "seed.zip";
  archive* zip = archive_write_new();
  archive_write_set_format_zip(zip);
  archive_write_zip_set_compression_store(zip);
  if (archive_write_open_filename(zip, path.c_str()) != ARCHIVE_OK) {
    throw std::runtime_error("cannot write " + path.string());
  }
  for (size_t i = 0; i < files.size(); ++i) {
    archive_entry* entry = archive_entry_new();
    archive_entry_set_pathname(entry, ("IM/" + std::to_string(i)).c_str());
    archive_entry_set_filetype(entry, AE_IFREG);
    archive_entry_set_size(entry, static_cast<la_int64_t>(files[i].size()));
    archive_write_header(zip, entry);
    archive_write_data(zip, files[i].data(), files[i].size());
    archive_entry_free(entry);
  }
  archive_write_free(zip);
  return read_file(path);
}

}  // namespace

std::vector<Bytes> seeds() {
  std::filesystem::create_directories(scratch_folder() / "series");
  for (int number = 1; number <= 3; ++number) {
    write_dicom(scratch_folder() / "series" / std::to_string(number), slice(number));
  }
  const auto image = [](int number) {
    return read_file(scratch_folder() / "series" / std::to_string(number));
  };
  return {image(3), gzipped(image(3)), zipped({image(1), image(2)}), frames(false), frames(true)};
}

void read(std::span<const std::uint8_t> input) {
  if (input.size() > 2 && input[0] == 'P' && input[1] == 'K') {
    load_volume(as_file(input, "input.zip"));
  } else {
    as_file(input, "series/3");
    load_volume(scratch_folder() / "series");
  }
}

}  // namespace clipgs::fuzz
