#include "asset/zip.h"

#include <cstring>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/error.h"

namespace clipgs {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

std::vector<ZipEntry> two_entries() {
  Bytes large(100000);
  for (size_t i = 0; i < large.size(); ++i) {
    large[i] = static_cast<std::uint8_t>(i * i >> 7);
  }
  return {{"data.webp", large}, {"empty", {}}, {"meta.json", {'{', '}'}}};
}

std::uint32_t get(const Bytes& bytes, size_t offset, size_t size) {
  std::uint32_t value = 0;
  std::memcpy(&value, bytes.data() + offset, size);
  return value;
}

/// Goes by the central directory alone, as a browser's reader does, and believes the local headers
/// only for the length of their names.
std::map<std::string, Bytes> read_as_a_browser(const Bytes& zip) {
  const size_t end = zip.size() - 22;
  EXPECT_EQ(get(zip, end, 4), 0x06054b50u);
  const size_t count = get(zip, end + 10, 2);
  size_t at = get(zip, end + 16, 4);
  std::map<std::string, Bytes> entries;
  for (size_t k = 0; k < count; ++k) {
    EXPECT_EQ(get(zip, at, 4), 0x02014b50u);
    EXPECT_EQ(get(zip, at + 8, 2) & 8u, 0u) << "no data descriptors";
    EXPECT_EQ(get(zip, at + 10, 2), 0u) << "stored";
    const size_t size = get(zip, at + 20, 4);
    const size_t name = get(zip, at + 28, 2);
    const size_t local = get(zip, at + 42, 4);
    EXPECT_EQ(get(zip, local, 4), 0x04034b50u);
    EXPECT_EQ(get(zip, local + 18, 4), size);
    const auto* text = reinterpret_cast<const char*>(zip.data()) + at + 46;
    const size_t begin = local + 30 + get(zip, local + 26, 2) + get(zip, local + 28, 2);
    entries[std::string(text, name)] =
        Bytes(zip.begin() + static_cast<std::ptrdiff_t>(begin),
              zip.begin() + static_cast<std::ptrdiff_t>(begin + size));
    at += 46 + name + get(zip, at + 30, 2) + get(zip, at + 32, 2);
  }
  EXPECT_EQ(at, end);
  return entries;
}

TEST(Zip, IsReadByTheLibraryAndByACentralDirectoryReader) {
  const std::vector<ZipEntry> entries = two_entries();
  const Bytes zip = write_zip(entries);
  const auto read = read_zip(zip, "test.sog");
  const auto browser = read_as_a_browser(zip);
  ASSERT_EQ(read.size(), entries.size());
  for (const ZipEntry& entry : entries) {
    EXPECT_EQ(read.at(entry.name), entry.bytes);
    EXPECT_EQ(browser.at(entry.name), entry.bytes);
  }
}

TEST(Zip, SameEntriesSameBytes) { EXPECT_EQ(write_zip(two_entries()), write_zip(two_entries())); }

TEST(Zip, ReadsDeflatedEntriesOfOtherWriters) {
  // 50 times the letter a, made by Python's zipfile.
  const Bytes zip = {
      0x50, 0x4b, 3,    4,    0x14, 0,    0,    0,    8,    0,    0, 0,    0x21, 0,    0x7d, 0xba,
      0xd7, 0x47, 6,    0,    0,    0,    0x32, 0,    0,    0,    1, 0,    0,    0,    0x6d, 0x4b,
      0x4c, 0x24, 0x15, 0,    0,    0x50, 0x4b, 1,    2,    0x14, 3, 0x14, 0,    0,    0,    8,
      0,    0,    0,    0x21, 0,    0x7d, 0xba, 0xd7, 0x47, 6,    0, 0,    0,    0x32, 0,    0,
      0,    1,    0,    0,    0,    0,    0,    0,    0,    0,    0, 0,    0,    0x80, 1,    0,
      0,    0,    0,    0x6d, 0x50, 0x4b, 5,    6,    0,    0,    0, 0,    1,    0,    1,    0,
      0x2f, 0,    0,    0,    0x25, 0,    0,    0,    0,    0};
  EXPECT_EQ(read_zip(zip, "test.sog").at("m"), Bytes(50, 'a'));
}

TEST(Zip, RefusesEveryTruncation) {
  const Bytes zip = write_zip({{"a", {1, 2, 3}}, {"b", {4}}});
  for (size_t size = 0; size < zip.size(); ++size) {
    EXPECT_THAT([&] { read_zip(std::span(zip).first(size), "test.sog"); },
                ThrowsMessage<Error>(HasSubstr("test.sog")))
        << size;
  }
}

TEST(Zip, RefusesAWrongChecksum) {
  Bytes zip = write_zip({{"a", {1, 2, 3}}});
  zip[30 + 1 + 1] ^= 1;  // local header, name, second byte
  EXPECT_THAT([&] { read_zip(zip, "test.sog"); },
              ThrowsMessage<Error>(HasSubstr("truncated or corrupt")));
}

TEST(Zip, RefusesTheSameNameTwice) {
  EXPECT_THAT([] { read_zip(write_zip({{"a", {1}}, {"a", {2}}}), "test.sog"); },
              ThrowsMessage<Error>(HasSubstr("twice")));
}

/// Counts what is read of a ZIP in memory in memory.
struct CountedZip {
  explicit CountedZip(Bytes zip) : bytes(std::move(zip)) {
    source.size = bytes.size();
    source.read = [this](std::uint64_t offset, std::span<std::uint8_t> out) {
      read += out.size();
      std::copy_n(bytes.begin() + static_cast<std::ptrdiff_t>(offset), out.size(), out.begin());
      return out.size();
    };
  }
  CountedZip(const CountedZip&) = delete;
  CountedZip& operator=(const CountedZip&) = delete;

  Bytes bytes;
  ByteSource source;
  size_t read = 0;
};

TEST(Zip, ReadsInPartsWhatIsWantedAndNoMore) {
  const std::vector<ZipEntry> entries = {{"large", Bytes(10'000'000, 7)}, {"a", {1, 2, 3}}};
  CountedZip zip(write_zip(entries));
  EXPECT_EQ(list_zip(zip.source, "test.sog"),
            (std::map<std::string, size_t>{{"a", 3}, {"large", 10'000'000}}));
  const auto read = read_zip(zip.source, "test.sog", {"a", "absent"});
  EXPECT_EQ(read, (std::map<std::string, Bytes>{{"a", {1, 2, 3}}}));
  EXPECT_LT(zip.read, 500'000U);
  EXPECT_THAT([&] { read_zip(zip.source, "test.sog", {"large"}); },
              ThrowsMessage<Error>(HasSubstr("more than 4 MiB")));
}

TEST(Zip, ReadsInPartsWhatReadingTheWholeGives) {
  const Bytes bytes = write_zip(two_entries());
  const CountedZip zip(bytes);
  std::set<std::string> all;
  for (const auto& [name, size] : list_zip(zip.source, "test.sog")) {
    all.insert(name);
  }
  EXPECT_EQ(read_zip(zip.source, "test.sog", all), read_zip(bytes, "test.sog"));
}

TEST(Zip, RefusesInPartsEveryTruncationAndAWrongChecksum) {
  Bytes bytes = write_zip({{"a", {1, 2, 3}}, {"b", {4}}});
  for (size_t size = 0; size < bytes.size(); ++size) {
    const CountedZip zip(Bytes(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size)));
    EXPECT_THAT([&] { list_zip(zip.source, "test.sog"); },
                ThrowsMessage<Error>(HasSubstr("test.sog")))
        << size;
  }
  bytes[30 + 1 + 1] ^= 1;  // local header, name, second byte
  const CountedZip zip(bytes);
  EXPECT_THAT([&] { read_zip(zip.source, "test.sog", {"a"}); },
              ThrowsMessage<Error>(HasSubstr("truncated or corrupt")));
}

TEST(Zip, ADirectoryWithoutEndIsNotReadToItsEnd) {
  const Bytes one = write_zip({{"a", {1, 2, 3}}});
  const size_t directory = 30 + 1 + 3;
  const size_t length = 46 + 1;
  constexpr size_t kFiles = 400'000;  // entries: 19 MB
  Bytes bytes(one.begin(), one.begin() + directory);
  bytes.reserve(bytes.size() + kFiles * length + 22);
  for (size_t i = 0; i < kFiles; ++i) {
    bytes.insert(bytes.end(), one.begin() + directory, one.begin() + directory + length);
  }
  Bytes end(one.begin() + directory + length, one.end());
  const auto put = [&](size_t at, std::uint32_t value) {
    for (size_t i = 0; i < 4; ++i) {
      end[at + i] = static_cast<std::uint8_t>(value >> (8 * i));
    }
  };
  put(12, static_cast<std::uint32_t>(kFiles * length));
  bytes.insert(bytes.end(), end.begin(), end.end());
  CountedZip zip(std::move(bytes));
  EXPECT_THAT([&] { list_zip(zip.source, "test.sog"); },
              ThrowsMessage<Error>(HasSubstr("test.sog")));
  EXPECT_LE(zip.read, size_t{12} << 20);
}

TEST(Zip, RefusesTooManyEntries) {
  const std::vector<ZipEntry> entries(300, ZipEntry{"a", {}});
  EXPECT_THROW(write_zip(entries), Error);
}

}  // namespace
}  // namespace clipgs
