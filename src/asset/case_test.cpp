#include "asset/case.h"

#include <cmath>
#include <filesystem>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <webp/decode.h>

#include "asset/draw_case.h"
#include "asset/webp.h"
#include "core/error.h"
#include "core/file.h"
#include "core/parallel.h"
#include "core/random.h"
#include "section/test_section.h"
#include "splat/scene_file.h"
#include "splat/sh.h"
#include "splat/test_scene.h"

namespace clipgs {
namespace {

using nlohmann::json;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::StartsWith;
using ::testing::ThrowsMessage;

std::filesystem::path temporary(const std::string& name) {
  return std::filesystem::path(::testing::TempDir()) / ("clipgs_case_test_" + name);
}

Image gradient() {
  Image image(32, 24, 3);
  for (int y = 0; y < 24; ++y) {
    for (int x = 0; x < 32; ++x) {
      image.at(x, y)[0] = static_cast<float>(x) / 31;
      image.at(x, y)[1] = static_cast<float>(y) / 23;
    }
  }
  return image;
}

json meta_of(const Bytes& bytes) {
  const Bytes text = read_zip(bytes, "test").at("meta.json");
  return json::parse(text.begin(), text.end());
}

/// The case with another meta.json.
Bytes with_meta(const Bytes& bytes, const json& meta) {
  std::vector<ZipEntry> entries;
  for (const auto& [name, content] : read_zip(bytes, "test")) {
    if (name != "meta.json") {
      entries.push_back({name, content});
    }
  }
  const std::string text = meta.dump();
  entries.push_back({"meta.json", Bytes(text.begin(), text.end())});
  return write_zip(entries);
}

TEST(Case, RoundTripKeepsEveryField) {
  Scene written = random_scene(500, 2, 21);
  written.look = {"0123456789abcdef", "Bone", "Bone and contrast alone.", Modality::kMr,
                  BodyPart::kKnee};
  write_case(temporary("a.sog"), {written}, nullptr);
  const Scene read = read_case(temporary("a.sog")).scene;
  EXPECT_EQ(read.gaussians.size(), 500u);
  EXPECT_EQ(read.gaussians.sh_degree(), 2);
  EXPECT_EQ(read.sphere.center, written.sphere.center);
  EXPECT_EQ(read.sphere.radius, written.sphere.radius);
  EXPECT_EQ(read.bounds.min, written.bounds.min);
  EXPECT_EQ(read.bounds.max, written.bounds.max);
  EXPECT_EQ(read.axis, written.axis);
  EXPECT_EQ(read.extent, written.extent);
  EXPECT_EQ(read.title, written.title);
  EXPECT_EQ(read.preset, written.preset);
  EXPECT_EQ(read.created, written.created);
  EXPECT_EQ(read.look, written.look);
}

TEST(Case, SplatsComeBackWhereAndAsTheyWere) {
  // One splat a scene: codebooks and palette are exact, what is left is the change of frame.
  for (std::uint64_t seed = 1; seed < 20; ++seed) {
    const Scene written = random_scene(1, 3, seed);
    const Scene read = read_case(encode_case({written}, nullptr), "test.sog").scene;
    EXPECT_LT(glm::length(read.gaussians.mean(0) - written.gaussians.mean(0)), 1e-3f);
    const Vec3 d = fibonacci_sphere(static_cast<int>(seed), 20);
    EXPECT_LT(glm::length(sh_color(read.gaussians, 0, d) - sh_color(written.gaussians, 0, d)),
              1e-3f);
    const Mat3 a = read.gaussians.covariance(0);
    const Mat3 b = written.gaussians.covariance(0);
    const float size = std::max({b[0][0], b[1][1], b[2][2]});
    for (int c = 0; c < 3; ++c) {
      EXPECT_LT(glm::length(a[c] - b[c]), 0.03f * size);
    }
  }
}

TEST(Case, SceneSpaceIsThatOf3dgs) {
  const Scene scene = random_scene(1, 0, 3);
  const json meta = meta_of(encode_case({scene}, nullptr));
  const Vec3 ras = scene.gaussians.mean(0);
  const double x = -ras.x * 0.001;
  EXPECT_NEAR(meta["means"]["mins"][0].get<double>(), std::copysign(std::log1p(std::abs(x)), x),
              1e-7);
  const double y = -ras.z * 0.001;
  EXPECT_NEAR(meta["means"]["mins"][1].get<double>(), std::copysign(std::log1p(std::abs(y)), y),
              1e-7);
  EXPECT_EQ(meta["clipgs"]["world"]["scene_to_ras_mm"],
            json({{-1000, 0, 0, 0}, {0, 0, -1000, 0}, {0, -1000, 0, 0}, {0, 0, 0, 1}}));
  EXPECT_EQ(meta["clipgs"]["world"]["mm_per_unit"], 1000);
}

TEST(Case, OnlyKnownKeysAreWritten) {
  const auto keys_of = [](const json& object) {
    std::vector<std::string> keys;
    for (const auto& entry : object.items()) {
      keys.push_back(entry.key());
    }
    return keys;
  };
  Scene scene = random_scene(2, 0, 3);
  const json block = meta_of(encode_case({scene}, nullptr))["clipgs"];
  EXPECT_THAT(keys_of(block), ::testing::UnorderedElementsAre(
                                  "axis", "bounds", "checksums", "created", "extent", "generator",
                                  "preset", "sphere", "title", "version", "world"));
  scene.look = {"0123456789abcdef", "Bone", "Bone alone.", Modality::kCt, BodyPart::kHead};
  const json look = meta_of(encode_case({scene}, nullptr))["clipgs"]["look"];
  EXPECT_THAT(keys_of(look), ::testing::UnorderedElementsAre("volume", "title", "description",
                                                             "modality", "region"));
}

TEST(Case, WhatIsShownFirstComesFirst) {
  const Image picture(16, 16, 3);
  const Bytes bytes = encode_case({layered_scene(200, 2, 3), test::ball_section()}, &picture);
  const std::string text(bytes.begin(), bytes.end());
  size_t at = 0;
  for (const char* file :
       {"thumbnail.webp", "meta.json", "means_l.webp", "means_u.webp", "scales.webp", "quats.webp",
        "sh0.webp", "shN_centroids.webp", "shN_labels.webp", "layers.webp", "section.webp"}) {
    const size_t found = text.find(std::string("PK\3\4"), at);
    ASSERT_NE(found, std::string::npos) << file;
    EXPECT_EQ(text.substr(found + 30, std::string(file).size()), file);
    at = text.find(file, found) + 1;
  }
}

TEST(Case, SameBytesAtAnyThreadCount) {
  const Scene scene = layered_scene(3000, 3, 22);
  set_thread_count(1);
  const Bytes one = encode_case({scene}, nullptr);
  set_thread_count(2);
  const Bytes two = encode_case({scene}, nullptr);
  set_thread_count(0);
  EXPECT_EQ(one, two);
}

TEST(Case, PackingAgainLosesNothingMore) {
  const Scene once = read_case(encode_case({random_scene(800, 0, 23)}, nullptr), "once").scene;
  const Scene twice = read_case(encode_case({once}, nullptr), "twice").scene;
  for (size_t i = 0; i < 800; ++i) {
    EXPECT_LT(glm::length(once.gaussians.mean(i) - twice.gaussians.mean(i)), 2e-3f);
    EXPECT_NEAR(once.gaussians.opacity(i), twice.gaussians.opacity(i), 1e-6f);
    EXPECT_NEAR(once.gaussians.plane(Gaussians::kSh)[i], twice.gaussians.plane(Gaussians::kSh)[i],
                1e-6f);
  }
}

TEST(Case, InfoTellsWithoutDecoding) {
  const Image thumbnail = gradient();
  const Bytes bytes = encode_case({random_scene(300, 1, 24)}, &thumbnail);
  const CaseInfo info = read_case_info(bytes, "test.sog");
  EXPECT_EQ(info.splats, 300u);
  EXPECT_EQ(info.sh_degree, 1);
  EXPECT_EQ(info.bytes, bytes.size());
  EXPECT_EQ(info.scene.title, "Phantom – bone");
  EXPECT_THAT(info.generator, HasSubstr("clipgs"));
  const Texels picture = decode_webp(info.thumbnail, 32, 24, "thumbnail");
  EXPECT_NEAR(picture.rgba[4 * 31], 255, 24);
  EXPECT_NEAR(picture.rgba[4 * 23 * 32 + 1], 255, 24);
  const ByteSource source{bytes.size(), [&](std::uint64_t offset, std::span<std::uint8_t> out) {
                            std::copy_n(bytes.begin() + static_cast<std::ptrdiff_t>(offset),
                                        out.size(), out.begin());
                            return out.size();
                          }};
  const CaseInfo summary = read_case_summary(source, "test.sog");
  EXPECT_EQ(summary.splats, info.splats);
  EXPECT_EQ(summary.bytes, info.bytes);
  EXPECT_EQ(summary.scene.title, info.scene.title);
  EXPECT_EQ(summary.scene.look, info.scene.look);
  EXPECT_EQ(summary.generator, info.generator);
  EXPECT_EQ(summary.thumbnail, info.thumbnail);
}

TEST(Case, ThumbnailShowsTheScene) {
  const Image thumbnail = make_thumbnail({random_scene(2000, 0, 27)});
  EXPECT_EQ(thumbnail.width, 256);
  EXPECT_EQ(thumbnail.channels, 4);
  EXPECT_GT(thumbnail.at(128, 128)[3], 0.2f);
  EXPECT_EQ(thumbnail.at(2, 2)[3], 0.0f);
}

TEST(Case, PictureOfTheCaseIsThatOfTheScene) {
  const Scene written = random_scene(3000, 0, 29);
  const Scene read = read_case(encode_case({written}, nullptr), "test.sog").scene;
  const Image a = composite(make_thumbnail({written}), 0, 0, 0);
  const Image b = composite(make_thumbnail({read}), 0, 0, 0);
  double sum = 0;
  for (size_t i = 0; i < a.data.size(); ++i) {
    sum += std::pow(a.data[i] - b.data[i], 2);
  }
  const double psnr = -10 * std::log10(sum / static_cast<double>(a.data.size()));
  EXPECT_GT(psnr, 45);
}

TEST(Case, LoadCaseReadsBothFilesAndTheSectionBesideAScene) {
  const Scene scene = random_scene(30, 1, 28);
  write_case(temporary("either.sog"), {scene}, nullptr);
  write_scene(temporary("either.ply"), scene);
  std::filesystem::remove(section_path(temporary("either.ply")));
  EXPECT_EQ(load_case(temporary("either.sog")).scene.gaussians.size(), 30u);
  EXPECT_EQ(load_case(temporary("either.ply")).scene.title, scene.title);
  EXPECT_FALSE(load_case(temporary("either.ply")).section);
  write_section(section_path(temporary("either.ply")), test::ball_section());
  EXPECT_EQ(load_case(temporary("either.ply")).section->dims, test::ball_section().dims);
}

TEST(Case, HoldsItsSection) {
  const Section section = test::ball_section();
  const Bytes with = encode_case({random_scene(40, 0, 5), section}, nullptr);
  const Bytes without = encode_case({random_scene(40, 0, 5)}, nullptr);
  EXPECT_EQ(read_case(with, "test.sog").section->dims, section.dims);
  EXPECT_FALSE(read_case(without, "test.sog").section);
  const CaseInfo info = read_case_info(with, "test.sog");
  EXPECT_EQ(info.section->dims, section.dims);
  EXPECT_EQ(info.section->bytes, read_zip(with, "test").at("section.webp").size());
  EXPECT_FALSE(read_case_info(without, "test.sog").section);

  json meta = meta_of(with);
  meta["clipgs"]["section"]["spacing"][1] = -1;
  EXPECT_THAT([&] { read_case(with_meta(with, meta), "test.sog"); },
              ThrowsMessage<Error>(HasSubstr("test.sog: clipgs.section: \"spacing\"")));
}

TEST(Case, KeepsItsSectionAsWellAsItsSizeAllows) {
  const Section section = test::ball_section();
  const auto encode = [&](const CaseCoding& coding) {
    return encode_case({random_scene(40, 0, 5), section}, nullptr, coding);
  };
  const Bytes best = encode({});
  EXPECT_EQ(read_case(best, "test.sog").section->voxels, section.voxels);
  EXPECT_EQ(best, encode({.section_quality = kLossless}));
  EXPECT_EQ(encode({.section_quality = {}, .bytes = 0}), encode({.section_quality = 70}));
  EXPECT_NE(encode({.section_quality = {}, .bytes = 0}), best);
}

TEST(Case, KeepsColorsAsWellAsItsSizeAllows) {
  const Scene scene = random_scene(6000, 2, 5);
  const auto encode = [&](size_t bytes) {
    return encode_case({scene}, nullptr, {.section_quality = {}, .bytes = bytes});
  };
  const auto colors = [](const Bytes& bytes) {
    return meta_of(bytes).at("shN").at("count").get<int>();
  };
  const Bytes least = encode(0);
  EXPECT_LE(colors(least), 512);  // one for 16 splats
  const size_t room = least.size() + 100'000;
  const Bytes more = encode(room);
  EXPECT_LE(more.size(), room);
  EXPECT_GT(colors(more), colors(least));
  const Bytes most = encode(5'000'000);
  EXPECT_GT(colors(most), colors(more));
  const auto error = [&](const Bytes& bytes) {
    const Gaussians read = read_case(bytes, "test.sog").scene.gaussians;
    const auto power = [](const Gaussians& g) {
      double sum = 0;
      for (int p = Gaussians::kSh + 3; p < g.planes(); ++p) {
        for (size_t i = 0; i < g.size(); ++i) {
          sum += double{g.plane(p)[i]} * g.plane(p)[i];
        }
      }
      return sum;
    };
    return std::abs(power(read) -
                    power(scene.gaussians));  // a mean has less than what it stands for
  };
  EXPECT_LT(error(more), error(least));
  EXPECT_LT(error(most), error(more));
}

TEST(Case, KeepsStatesAndTheLayerOfEachSplat) {
  Scene scene = layered_scene(700, 1, 30);
  scene.states.count = 400;  // layers of more than a byte
  for (std::uint16_t& layer : scene.layers) {
    layer *= 2;
  }
  const Bytes bytes = encode_case({scene}, nullptr);
  const Scene read = read_case(bytes, "test.sog").scene;
  EXPECT_EQ(read.states.count, 400);
  EXPECT_EQ(read.states.first, 850.5f);
  EXPECT_EQ(read.states.spacing, 1);
  EXPECT_TRUE(read.states.keeps_below);
  ASSERT_EQ(read.layers.size(), 700u);
  for (size_t i = 0; i < 700; ++i) {  // a layer follows from the place, up to its rounding
    const float position = glm::dot(scene.axis, read.gaussians.mean(i));
    const float state = std::clamp(position - 850.5f, 0.0f, 199.0f);
    EXPECT_NEAR(read.layers[i] / 2, state, 0.51f);
  }
  EXPECT_TRUE(read_case_info(bytes, "test.sog").has_layers);

  scene.layers.clear();
  const Bytes without = encode_case({scene}, nullptr);
  EXPECT_EQ(read_case(without, "test.sog").scene.states.count, 400);
  EXPECT_TRUE(read_case(without, "test.sog").scene.layers.empty());
  EXPECT_FALSE(read_case_info(without, "test.sog").has_layers);
  EXPECT_FALSE(meta_of(without)["clipgs"]["states"].contains("file"));
}

TEST(Case, RefusesLayersThatAreWrong) {
  Scene scene = layered_scene(50, 0, 30);
  const Bytes whole = encode_case({scene}, nullptr);
  const auto refuses = [&](const char* key, const json& value, const char* message) {
    json meta = meta_of(whole);
    meta["clipgs"]["states"][key] = value;
    EXPECT_THAT([&] { read_case(with_meta(whole, meta), "test.sog"); },
                ThrowsMessage<Error>(::testing::AllOf(HasSubstr(message), HasSubstr("test.sog"),
                                                      ::testing::Not(HasSubstr("\n")))));
  };
  refuses("count", 20, "corrupt");
  refuses("count", 0, "count");
  refuses("spacing", 0, "spacing");
  refuses("keeps", "left", "keeps");
  refuses("file", 7, "file");
  refuses("file", "absent.webp", "absent.webp");
  refuses("file", "meta.json", "meta.json");
  scene.states.count = 20;
  EXPECT_THAT([&] { encode_case({scene}, nullptr); }, ThrowsMessage<Error>(HasSubstr("20 states")));
  scene.layers.pop_back();
  EXPECT_THROW(encode_case({scene}, nullptr), Error);
}

TEST(Case, RefusesOtherFilesInOneLine) {
  const auto refuses = [](const Bytes& bytes, const char* message) {
    EXPECT_THAT([&] { read_case(bytes, "test.sog"); },
                ThrowsMessage<Error>(::testing::AllOf(HasSubstr(message), HasSubstr("test.sog"),
                                                      ::testing::Not(HasSubstr("\n")))));
  };
  refuses({}, "truncated or corrupt");
  refuses(Bytes(1000, 0), "truncated or corrupt");
  refuses(write_zip({{"a.txt", {1}}}), "meta.json");
  refuses(write_zip({{"meta.json", {'{', '"'}}}), "not JSON");
  refuses(write_zip({{"meta.json", {'{', '}'}}}), "version");

  Scene scene = random_scene(50, 1, 25);
  scene.gaussians = random_faces(50, 1, 25);
  const Bytes whole = encode_case({scene}, nullptr);
  const json meta = meta_of(whole);
  const auto changed = [&](const char* pointer, const json& value) {
    json copy = meta;
    copy[json::json_pointer(pointer)] = value;
    return with_meta(whole, copy);
  };
  EXPECT_NO_THROW(read_case(with_meta(whole, meta), "test.sog"));
  refuses(changed("/version", 1), "version");
  refuses(changed("/count", -1), "count");
  refuses(changed("/count", 4000000), "× ");
  refuses(changed("/count", 1e300), "count");
  refuses(changed("/means/mins", {0, 0}), "mins");
  refuses(changed("/means/mins/0", 1e9), "mins");
  refuses(changed("/means/files/1", "absent.webp"), "absent.webp");
  refuses(changed("/scales/codebook/7", nullptr), "codebook");
  refuses(changed("/scales/codebook/7", 1e9), "codebook");
  refuses(changed("/shN/bands", 3), "× ");
  refuses(changed("/shN/bands", 4), "bands");
  refuses(changed("/shN/count", 1), "names entry");
  refuses(changed("/clipgs_faces/bands", 2), "bands");
  refuses(changed("/clipgs_faces/count", 1), "clipgs_faces");
  refuses(changed("/clipgs_faces/codebook", 1), "codebook");
  refuses(changed("/clipgs_faces/files/0", "absent.webp"), "absent.webp");
  refuses(changed("/quats/files/0", "sh0.webp"), "rotation");
  refuses(changed("/clipgs/version", 2), "newer clipgs");
  refuses(changed("/clipgs/axis", {0, 0, 0}), "axis");
  refuses(changed("/clipgs/world/scene_to_ras_mm/0/0", 0), "scene_to_ras_mm");
}

/// The case as programs wrote it that knew no checksums.
Bytes without_checksums(const Bytes& bytes) {
  json meta = meta_of(bytes);
  meta["clipgs"].erase("checksums");
  if (meta["clipgs"].contains("section")) {
    meta["clipgs"]["section"].erase("checksum");
  }
  return with_meta(bytes, meta);
}

/// The case with one bit of one texel of one of its images, which is whole and lossless, changed.
Bytes with_other_texel(const Bytes& bytes, const std::string& file) {
  std::vector<ZipEntry> entries;
  for (auto [name, content] : read_zip(bytes, "test")) {
    if (name == file) {
      int width = 0;
      int height = 0;
      WebPGetInfo(content.data(), content.size(), &width, &height);
      Texels texels = decode_webp(content, width, height, name);
      texels.rgba[0] ^= 1;
      content = encode_webp(texels);
    }
    entries.push_back({name, content});
  }
  return write_zip(entries);
}

// What a decoder that returns other texels would give: the archive's own checksums are good.
TEST(Case, OfAnotherProgramIsItsSplatsAlone) {
  const Scene scene = random_scene(50, 1, 25);
  json meta = meta_of(encode_case({scene, test::ball_section()}, nullptr));
  meta.erase("clipgs");
  ::testing::internal::CaptureStderr();
  const Case contents =
      read_case(with_meta(encode_case({scene, test::ball_section()}, nullptr), meta), "test.sog");
  EXPECT_THAT(::testing::internal::GetCapturedStderr(), HasSubstr("test.sog: says neither"));
  EXPECT_EQ(contents.scene.gaussians.size(), 50);
  EXPECT_GT(contents.scene.sphere.radius, 0);
  EXPECT_FALSE(contents.section);
}

TEST(Case, RefusesImagesThatDecodeToSomethingElse) {
  const Bytes whole = encode_case({layered_scene(60, 1, 26), test::ball_section()}, nullptr);
  int images = 0;
  for (const auto& [name, content] : read_zip(whole, "test")) {
    if (!name.ends_with(".webp")) {
      continue;
    }
    ++images;
    const Bytes other = with_other_texel(whole, name);
    EXPECT_THAT([&] { read_case(other, "test.sog"); },
                ThrowsMessage<Error>(
                    ::testing::AllOf(HasSubstr("test.sog: "), HasSubstr("its checksum differs"))))
        << name;
    EXPECT_NO_THROW(read_case(without_checksums(other), "test.sog")) << name;
  }
  EXPECT_EQ(images, 9);
}

TEST(Case, IsReadWithoutASectionThatIsBroken) {
  const Scene scene = random_scene(50, 1, 25);
  const Bytes whole = encode_case({scene, test::ball_section()}, nullptr);
  const auto is_left_out = [&](const std::string& key, const json& value, const char* message) {
    json meta = meta_of(whole);
    meta["clipgs"]["section"][json::json_pointer("/" + key)] = value;
    const Bytes bytes = with_meta(whole, meta);
    EXPECT_THAT(
        [&] { read_case(bytes, "test.sog"); },
        ThrowsMessage<Error>(AllOf(StartsWith("test.sog: clipgs.section"), HasSubstr(message))))
        << key;
    ::testing::internal::CaptureStderr();
    const Case contents = read_case(bytes, "test.sog", BrokenSection::kLeftOut);
    EXPECT_THAT(::testing::internal::GetCapturedStderr(),
                AllOf(StartsWith("warning: test.sog: clipgs.section"), HasSubstr(message)));
    EXPECT_FALSE(contents.section) << key;
    EXPECT_EQ(contents.scene.gaussians.size(), scene.gaussians.size());
  };
  is_left_out("version", 4, "newer clipgs");
  is_left_out("lights/tone", "agfa",
              "a tone curve \"agfa\" that this program does not know; use a newer clipgs");
  is_left_out("materials", json::object(), "materials");
  is_left_out("materials", nullptr, "materials");
  is_left_out("file", "gone.webp", "\"file\" is missing");
  is_left_out("checksum", "00000000", "checksum");

  json meta = meta_of(whole);
  meta["clipgs"]["section"]["version"] = 4;
  const CaseInfo info = read_case_info(with_meta(whole, meta), "test.sog");
  EXPECT_FALSE(info.section);
  EXPECT_THAT(info.section_problem, HasSubstr("newer clipgs"));
  meta["clipgs"]["section"]["version"] = 2;
  meta["clipgs"]["section"]["lights"]["tone"] = "agfa";
  EXPECT_THAT(read_case_info(with_meta(whole, meta), "test.sog").section_problem,
              HasSubstr("newer clipgs"));
}

TEST(Case, RefusesAnImageWhoseChecksumIsGoneOrNone) {
  const Bytes whole = encode_case({random_scene(50, 1, 25), test::ball_section()}, nullptr);
  const auto refuses = [&](const char* key, const json& value) {
    json meta = meta_of(whole);
    meta["clipgs"][json::json_pointer(key)] = value;
    EXPECT_THAT([&] { read_case(with_meta(whole, meta), "test.sog"); },
                ThrowsMessage<Error>(HasSubstr("its checksum differs")))
        << key;
  };
  refuses("/checksums", json::object());
  refuses("/checksums", 7);
  refuses("/checksums/quats.webp", 7);
  refuses("/section/checksum", "00000000");
}

TEST(Case, NewKeysAreIgnored) {
  const Bytes whole = encode_case({random_scene(50, 0, 25)}, nullptr);
  json meta = meta_of(whole);
  meta["clipgs"]["news"] = {{"files", {"news.webp"}}};
  meta["other"] = 1;
  EXPECT_EQ(read_case(with_meta(whole, meta), "test.sog").scene.gaussians.size(), 50u);
}

// Whatever is done to the bytes, a reader says no in one line or gives a whole scene.
void expect_error_or_scene(const Bytes& bytes, const std::string& what) {
  try {
    const Case read = read_case(bytes, "test.sog");
    for (const float value : read.scene.gaussians.data()) {
      ASSERT_TRUE(std::isfinite(value)) << what;
    }
  } catch (const Error& e) {
    EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos) << what;
  }
}

TEST(CaseFuzz, Truncations) {
  const Bytes whole = encode_case({layered_scene(60, 1, 26)}, nullptr);
  for (size_t size = 0; size < whole.size(); size += 1 + whole.size() / 400) {
    EXPECT_THROW(read_case(std::span(whole).first(size), "test.sog"), Error) << size;
  }
}

TEST(CaseFuzz, FlippedBytes) {
  const Bytes whole = encode_case({layered_scene(60, 1, 26)}, nullptr);
  Rng rng(1);
  for (int iteration = 0; iteration < 600; ++iteration) {
    Bytes bytes = whole;
    for (int flips = 0; flips < 1 + iteration % 4; ++flips) {
      bytes[rng.below(static_cast<std::uint32_t>(bytes.size()))] ^= 1U << rng.below(8);
    }
    expect_error_or_scene(bytes, "iteration " + std::to_string(iteration));
  }
}

// The same inside the entries, whose checksums are right again, and none of decoded images: this
// reaches the image decoder and the checks of meta.json and of what is decoded.
TEST(CaseFuzz, FlippedBytesUnderGoodChecksums) {
  const auto entries = read_zip(
      without_checksums(encode_case({layered_scene(60, 1, 26), test::ball_section()}, nullptr)),
      "test");
  Rng rng(2);
  for (int iteration = 0; iteration < 600; ++iteration) {
    std::vector<ZipEntry> changed;
    for (const auto& [name, content] : entries) {
      changed.push_back({name, content});
    }
    Bytes& content = changed[rng.below(static_cast<std::uint32_t>(changed.size()))].bytes;
    for (int flips = 0; flips < 1 + iteration % 4; ++flips) {
      content[rng.below(static_cast<std::uint32_t>(content.size()))] ^= 1U << rng.below(8);
    }
    if (iteration % 5 == 0) {
      content.resize(rng.below(static_cast<std::uint32_t>(content.size())));
    }
    expect_error_or_scene(write_zip(changed), "iteration " + std::to_string(iteration));
  }
}

}  // namespace
}  // namespace clipgs
