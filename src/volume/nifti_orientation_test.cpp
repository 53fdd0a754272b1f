#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/error.h"
#include "core/random.h"
#include "volume/load.h"
#include "volume/nifti_header.h"
#include "volume/orient.h"
#include "volume/test_folder.h"

namespace clipgs {
namespace {

using Bytes = std::vector<std::uint8_t>;
using Row = std::array<double, 4>;
using Affine = std::array<Row, 3>;  // of voxel indices to RAS

constexpr std::array<int, 3> kDims{6, 5, 4};
constexpr std::array<double, 3> kSpacing{10, 12, 15};
constexpr Row kOrigin{-31, 17, 60, 0};
constexpr std::array<std::array<int, 3>, 3> kCorners{{{0, 0, 0}, {5, 0, 3}, {0, 4, 3}}};

/// A marker's value; everything else is 0 to 6.
double marker(size_t corner) { return 1000.0 * static_cast<double>(corner + 1); }

// A writer and a reader of NIfTI by the standard's text alone (nifti1.h, nifti2.h), which share
// nothing with the program's.

/// Where a version of NIfTI has its fields, and how wide they are.
struct Layout {
  bool second = false;
  bool big_endian = false;
  size_t header() const { return second ? 540 : 348; }
  size_t real() const { return second ? 8 : 4; }
  size_t pixdim() const { return second ? 104 : 76; }
  size_t quaternion() const { return second ? 352 : 256; }
  size_t qoffset() const { return second ? 376 : 268; }
  size_t srow() const { return second ? 400 : 280; }
  size_t qform_code() const { return second ? 344 : 252; }
  size_t sform_code() const { return second ? 348 : 254; }
  size_t code_bytes() const { return second ? 4 : 2; }
  size_t units() const { return second ? 500 : 123; }
  size_t voxels() const { return header() + 4; }
};

std::uint64_t integer_at(const Bytes& bytes, size_t at, size_t size, bool big_endian) {
  std::uint64_t number = 0;
  for (size_t i = 0; i < size; ++i) {
    number |= std::uint64_t{bytes[at + (big_endian ? size - 1 - i : i)]} << (8 * i);
  }
  return number;
}

void put_integer(Bytes& bytes, size_t at, size_t size, bool big_endian, std::uint64_t number) {
  for (size_t i = 0; i < size; ++i) {
    bytes[at + (big_endian ? size - 1 - i : i)] = static_cast<std::uint8_t>(number >> (8 * i));
  }
}

double real_at(const Bytes& bytes, const Layout& layout, size_t at) {
  const std::uint64_t bits = integer_at(bytes, at, layout.real(), layout.big_endian);
  return layout.second ? std::bit_cast<double>(bits)
                       : std::bit_cast<float>(static_cast<std::uint32_t>(bits));
}

void put_real(Bytes& bytes, const Layout& layout, size_t at, double number) {
  const std::uint64_t bits = layout.second
                                 ? std::bit_cast<std::uint64_t>(number)
                                 : std::bit_cast<std::uint32_t>(static_cast<float>(number));
  put_integer(bytes, at, layout.real(), layout.big_endian, bits);
}

/// Method 2 of the standard: the rotation of a quaternion (a, b, c, d), its formula in nifti1.h.
Affine rotation(double b, double c, double d) {
  const double a = std::sqrt(std::max(0.0, 1 - (b * b + c * c + d * d)));
  return {{{a * a + b * b - c * c - d * d, 2 * b * c - 2 * a * d, 2 * b * d + 2 * a * c, 0},
           {2 * b * c + 2 * a * d, a * a + c * c - b * b - d * d, 2 * c * d - 2 * a * b, 0},
           {2 * b * d - 2 * a * c, 2 * c * d + 2 * a * b, a * a + d * d - c * c - b * b, 0}}};
}

/// Where the markers are, RAS mm: the sform if sform_code > 0, else the qform.
std::array<Row, 3> marker_positions(const Bytes& bytes, const Layout& layout) {
  const auto real = [&](size_t at, size_t i) {
    return real_at(bytes, layout, at + i * layout.real());
  };
  Affine affine{};
  if (integer_at(bytes, layout.sform_code(), layout.code_bytes(), layout.big_endian) > 0) {
    for (size_t row = 0; row < 3; ++row) {
      for (size_t column = 0; column < 4; ++column) {
        affine[row][column] = real(layout.srow(), 4 * row + column);
      }
    }
  } else {
    affine = rotation(real(layout.quaternion(), 0), real(layout.quaternion(), 1),
                      real(layout.quaternion(), 2));
    const double qfac = real(layout.pixdim(), 0) < 0 ? -1 : 1;
    for (size_t row = 0; row < 3; ++row) {
      for (size_t column = 0; column < 3; ++column) {
        affine[row][column] *=
            std::abs(real(layout.pixdim(), column + 1)) * (column == 2 ? qfac : 1);
      }
      affine[row][3] = real(layout.qoffset(), row);
    }
  }
  std::array<Row, 3> positions{};
  size_t at = layout.voxels();
  for (int k = 0; k < kDims[2]; ++k) {
    for (int j = 0; j < kDims[1]; ++j) {
      for (int i = 0; i < kDims[0]; ++i, at += 2) {
        const std::uint64_t value = integer_at(bytes, at, 2, layout.big_endian);
        for (size_t corner = 0; corner < 3; ++corner) {
          for (size_t row = 0; row < 3 && value == marker(corner); ++row) {
            positions[corner][row] =
                affine[row][0] * i + affine[row][1] * j + affine[row][2] * k + affine[row][3];
          }
        }
      }
    }
  }
  return positions;
}

/// One of the 48 ways a grid can lie along the patient's axes.
struct Orientation {
  std::array<size_t, 3> world{0, 1, 2};  // the patient's axis that each index axis runs along
  std::array<int, 3> sign{1, 1, 1};

  Affine affine() const {
    Affine result{};
    for (size_t axis = 0; axis < 3; ++axis) {
      result[world[axis]][axis] = sign[axis] * kSpacing[axis];
      result[axis][3] = kOrigin[axis];
    }
    return result;
  }
  bool mirrored() const {
    const bool odd = (world[0] > world[1]) != ((world[1] > world[2]) != (world[0] > world[2]));
    return odd != (sign[0] * sign[1] * sign[2] < 0);
  }
};

std::vector<Orientation> all_orientations() {
  std::vector<Orientation> all;
  Orientation orientation;
  do {
    for (int signs = 0; signs < 8; ++signs) {
      orientation.sign = {signs & 1 ? -1 : 1, signs & 2 ? -1 : 1, signs & 4 ? -1 : 1};
      all.push_back(orientation);
    }
  } while (std::ranges::next_permutation(orientation.world).found);
  return all;
}

/// b, c and d of the rotation that turns the index axes so, the third one the other way if the grid
/// is mirrored (qfac −1). Rotations by right angles have few quaternions: all are tried.
std::array<double, 3> quaternion(const Orientation& orientation) {
  const double half = std::sqrt(0.5);
  const std::array<double, 7> parts{0, 0.5, -0.5, half, -half, 1, -1};
  for (const double b : parts) {
    for (const double c : parts) {
      for (const double d : parts) {
        const Affine turned = rotation(b, c, d);
        double difference = std::max(0.0, b * b + c * c + d * d - 1);
        for (size_t row = 0; row < 3; ++row) {
          for (size_t axis = 0; axis < 3; ++axis) {
            const double flip = axis == 2 && orientation.mirrored() ? -1 : 1;
            difference += std::abs(flip * turned[row][axis] -
                                   orientation.affine()[row][axis] / kSpacing[axis]);
          }
        }
        if (difference < 1e-6) {
          return {b, c, d};
        }
      }
    }
  }
  ADD_FAILURE() << "no quaternion";
  return {};
}

enum class Forms {
  kSform,
  kQform,
  kBoth,
  kDisagreeing,  // the qform says another of the 48
  kQfac,         // the qform with the sign of qfac turned round
  kSformNegativePixdim,
  kQformNegativePixdim,
  kBothNegativePixdim
};
constexpr std::array kAllForms{Forms::kSform,
                               Forms::kQform,
                               Forms::kBoth,
                               Forms::kDisagreeing,
                               Forms::kQfac,
                               Forms::kSformNegativePixdim,
                               Forms::kQformNegativePixdim,
                               Forms::kBothNegativePixdim};

Bytes nifti_file(const Layout& layout, const Orientation& orientation, const Orientation& other,
                 Forms forms) {
  const bool sform =
      forms != Forms::kQform && forms != Forms::kQfac && forms != Forms::kQformNegativePixdim;
  const bool qform = forms != Forms::kSform && forms != Forms::kSformNegativePixdim;
  const bool negative = forms >= Forms::kSformNegativePixdim;
  const Orientation& of_qform = forms == Forms::kDisagreeing ? other : orientation;

  Bytes bytes(layout.voxels() + 2 * 6 * 5 * 4, 0);
  const auto put = [&](size_t at, size_t size, std::uint64_t number) {
    put_integer(bytes, at, size, layout.big_endian, number);
  };
  const auto real = [&](size_t at, size_t i, double number) {
    put_real(bytes, layout, at + i * layout.real(), number);
  };
  put(0, 4, layout.header());
  const size_t size_bytes = layout.second ? 8 : 2;
  const size_t dim = layout.second ? 16 : 40;
  put(dim, size_bytes, 3);
  for (size_t axis = 0; axis < 3; ++axis) {
    put(dim + (axis + 1) * size_bytes, size_bytes, static_cast<std::uint64_t>(kDims[axis]));
    real(layout.pixdim(), axis + 1, negative ? -kSpacing[axis] : kSpacing[axis]);
    real(layout.qoffset(), axis, kOrigin[axis]);
    real(layout.quaternion(), axis, quaternion(of_qform)[axis]);
    for (size_t column = 0; column < 4; ++column) {
      real(layout.srow(), 4 * axis + column, orientation.affine()[axis][column]);
    }
  }
  const bool turned = of_qform.mirrored() != (forms == Forms::kQfac);
  real(layout.pixdim(), 0, turned ? -1 : 1);
  put(layout.second ? 12 : 70, 2, 4);   // INT16
  put(layout.second ? 14 : 72, 2, 16);  // bits of it
  if (layout.second) {
    put(168, 8, layout.voxels());
  } else {
    put_real(bytes, layout, 108, static_cast<double>(layout.voxels()));
  }
  put(layout.units(), layout.second ? 4 : 1, 2);
  put(layout.qform_code(), layout.code_bytes(), qform ? 1 : 0);
  put(layout.sform_code(), layout.code_bytes(), sform ? 1 : 0);
  const std::string magic = layout.second ? "n+2" : "n+1";
  std::ranges::copy(magic, bytes.begin() + (layout.second ? 4 : 344));
  const auto voxel = [&](const std::array<int, 3>& at) {
    return layout.voxels() + 2 * static_cast<size_t>(at[0] + 6 * (at[1] + 5 * at[2]));
  };
  for (size_t i = 0; i < 120; ++i) {
    put(layout.voxels() + 2 * i, 2, i % 7);
  }
  for (size_t corner = 0; corner < 3; ++corner) {
    put(voxel(kCorners[corner]), 2, static_cast<std::uint64_t>(marker(corner)));
  }
  return bytes;
}

/// RAS mm of the voxel with this value.
Vec3 position_of(const Volume& volume, float value) {
  for (int z = 0; z < volume.dims.z; ++z) {
    for (int y = 0; y < volume.dims.y; ++y) {
      for (int x = 0; x < volume.dims.x; ++x) {
        if (volume.at(x, y, z) == value) {
          return volume.world_from_index(Vec3(x, y, z));
        }
      }
    }
  }
  ADD_FAILURE() << "no voxel has " << value;
  return Vec3(0);
}

class NiftiOrientation : public testing::TestWithParam<Layout> {};

TEST_P(NiftiOrientation, MarkersLieWhereTheStandardPutsThem) {
  const TestFolder folder;
  const std::vector<Orientation> orientations = all_orientations();
  ASSERT_EQ(orientations.size(), 48);
  for (size_t i = 0; i < orientations.size(); ++i) {
    for (const Forms forms : kAllForms) {
      const Bytes bytes =
          nifti_file(GetParam(), orientations[i], orientations[(i + 17) % 48], forms);
      write_plainly(folder / "v.nii", bytes);
      testing::internal::CaptureStderr();
      const Volume volume = load_volume(folder / "v.nii");
      const std::string said = testing::internal::GetCapturedStderr();
      const std::array<Row, 3> expected = marker_positions(bytes, GetParam());
      for (size_t corner = 0; corner < 3; ++corner) {
        const Vec3 there(expected[corner][0], expected[corner][1], expected[corner][2]);
        const Vec3 loaded = position_of(volume, static_cast<float>(marker(corner)));
        EXPECT_LT(glm::length(loaded - there), 1e-3f)
            << "orientation " << i << " forms " << static_cast<int>(forms) << " corner " << corner;
      }
      EXPECT_GT(volume.direction[0].x, 0.99f);
      EXPECT_GT(volume.direction[1].y, 0.99f);
      EXPECT_GT(volume.direction[2].z, 0.99f);
      EXPECT_EQ(said.find("disagree") != std::string::npos, forms == Forms::kDisagreeing) << said;
      const bool uses_pixdim =
          forms == Forms::kQformNegativePixdim || forms == Forms::kBothNegativePixdim;
      EXPECT_EQ(said.find("pixdim[1] is -10") != std::string::npos, uses_pixdim) << said;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Layouts, NiftiOrientation,
                         testing::Values(Layout{false, false}, Layout{false, true},
                                         Layout{true, false}, Layout{true, true}),
                         [](const auto& layout) {
                           return fmt::format("nifti{}{}", layout.param.second ? 2 : 1,
                                              layout.param.big_endian ? "big" : "little");
                         });

const Layout kFirst;

ImageHeader parsed(const Bytes& bytes) { return parse_nifti_header(bytes, "v.nii").image; }

Bytes plain_file(Forms forms) { return nifti_file(kFirst, Orientation{}, Orientation{}, forms); }

TEST(NiftiHeader, UnitsScaleEveryLength) {
  const std::vector<std::pair<int, double>> units{{0, 1}, {1, 1000}, {2, 1}, {3, 1e-3}};
  for (const Forms forms : {Forms::kSform, Forms::kQform}) {
    for (const auto& [code, mm] : units) {
      Bytes bytes = plain_file(forms);
      bytes[123] = static_cast<std::uint8_t>(code | 8);  // and seconds
      const ImageHeader header = parsed(bytes);
      EXPECT_NEAR(header.spacing.y, 12 * mm, 1e-6 * mm);
      EXPECT_NEAR(header.origin.x, 31 * mm, 1e-6 * mm);  // LPS
    }
  }
  Bytes bytes = plain_file(Forms::kSform);
  bytes[123] = 6;
  EXPECT_THAT(parsed(bytes).warnings, testing::ElementsAre(testing::HasSubstr("xyzt_units")));
}

TEST(NiftiHeader, SizesNoBodyHasAreSaidByTheirField) {
  Bytes bytes = plain_file(Forms::kSform);
  EXPECT_THAT(parsed(bytes).warnings, testing::IsEmpty());
  bytes[123] = 1;
  EXPECT_THAT(parsed(bytes).warnings,
              testing::ElementsAre(testing::AllOf(testing::HasSubstr("srow_*"),
                                                  testing::HasSubstr("too large for a body"))));
  bytes[123] = 3;
  EXPECT_THAT(parsed(bytes).warnings, testing::ElementsAre(testing::HasSubstr("small for a body")));
  bytes = plain_file(Forms::kQform);
  bytes[123] = 1;
  EXPECT_THAT(parsed(bytes).warnings, testing::ElementsAre(testing::HasSubstr("pixdim[")));
}

TEST(NiftiHeader, ASpacingOfZeroIsSaidByItsField) {
  Bytes bytes = plain_file(Forms::kQform);
  put_real(bytes, kFirst, 84, 0);
  EXPECT_EQ(parsed(bytes).spacing.y, 1);
  EXPECT_THAT(parsed(bytes).warnings, testing::ElementsAre(testing::HasSubstr("pixdim[2] is 0")));
}

TEST(NiftiHeader, WithoutAFormTheOrientationIsAGuess) {
  Bytes bytes = plain_file(Forms::kSform);
  put_integer(bytes, 254, 2, false, 0);
  EXPECT_EQ(parsed(bytes).direction[0], glm::dvec3(-1, 0, 0));  // to the right
  EXPECT_THAT(parsed(bytes).warnings,
              testing::ElementsAre(testing::HasSubstr("left and right may be")));
}

TEST(NiftiHeader, AShearedSformYieldsToTheQform) {
  Bytes bytes = plain_file(Forms::kBoth);
  put_real(bytes, kFirst, 284, 5);
  EXPECT_EQ(parsed(bytes).direction[1], glm::dvec3(0, -1, 0));
  EXPECT_THAT(parsed(bytes).warnings,
              testing::ElementsAre(testing::HasSubstr("not perpendicular")));
  bytes = plain_file(Forms::kSform);
  put_real(bytes, kFirst, 284, 5);
  EXPECT_THAT(error_of([&] { parsed(bytes); }), testing::HasSubstr("not perpendicular"));
}

TEST(NiftiHeader, AnSformOfAnotherVoxelSizeIsSaid) {
  Bytes bytes = plain_file(Forms::kSform);
  put_real(bytes, kFirst, 80, 11);
  EXPECT_EQ(parsed(bytes).spacing.x, 10);
  EXPECT_THAT(parsed(bytes).warnings,
              testing::ElementsAre(testing::HasSubstr("10 long by its srow_* and 11")));
}

TEST(NiftiHeader, ColoursAndRescaledValues) {
  Bytes bytes = plain_file(Forms::kSform);
  put_real(bytes, kFirst, 112, 0.5);
  put_real(bytes, kFirst, 116, -100);
  EXPECT_EQ(parsed(bytes).slope, 0.5);
  EXPECT_EQ(parsed(bytes).intercept, -100);
  for (const double none : {0.0, std::nan("")}) {
    put_real(bytes, kFirst, 112, none);
    EXPECT_EQ(parsed(bytes).slope, 1);
    EXPECT_EQ(parsed(bytes).intercept, 0);
  }
  put_integer(bytes, 70, 2, false, 128);  // RGB24
  EXPECT_THAT(error_of([&] { parsed(bytes); }), testing::HasSubstr("bitpix 16"));
  put_integer(bytes, 72, 2, false, 24);
  EXPECT_EQ(parsed(bytes).channels, 3);
}

TEST(NiftiHeader, AnalyzeIsRefused) {
  Bytes bytes = plain_file(Forms::kSform);
  bytes[344] = 0;
  EXPECT_THAT(error_of([&] { parsed(bytes); }), testing::HasSubstr("ANALYZE"));
}

TEST(Orient, AnyRotationOrMirroringKeepsEveryVoxelInItsPlace) {
  Rng rng(5);
  StoredImage stored;
  stored.dims = {2, 3, 4};
  stored.spacing = {1, 2, 3};
  stored.origin = {5, -6, 7};
  std::vector<float> values;
  for (int i = 0; i < 24; ++i) {
    values.push_back(static_cast<float>(i));
  }
  stored.values = values;
  for (int trial = 0; trial < 3000; ++trial) {
    glm::dvec4 q;
    for (int i = 0; i < 4; ++i) {
      q[i] = rng.uniform() - 0.5;
    }
    stored.direction = glm::mat3_cast(glm::normalize(glm::dquat(q.w, q.x, q.y, q.z)));
    if (trial % 2 == 1) {
      stored.direction[trial % 3] *= -1.0;
    }
    const Volume volume = oriented(stored, "v");
    EXPECT_GT(glm::determinant(volume.direction), 0.99f);
    for (int i = 0; i < 24; ++i) {
      const glm::dvec3 index(i % 2, i / 2 % 3, i / 6);
      const glm::dvec3 lps = stored.origin + stored.direction * (index * stored.spacing);
      const Vec3 world = position_of(volume, static_cast<float>(i));
      EXPECT_LT(glm::length(glm::dvec3(world) - lps * glm::dvec3(-1, -1, 1)), 1e-4);
    }
  }
}

}  // namespace
}  // namespace clipgs
