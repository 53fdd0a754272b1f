#include "measure/build_notes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace clipgs {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

TEST(BuildNotes, SayWhatWarningsSayWithoutTheFile) {
  const std::string log =
      "[1/4] /data/Doe^John/ct: work is kept in case\n"
      "warning: /data/Doe^John/ct: took 312 ml of table, cushions and the like off\n"
      "dataset:  16 %  53 s left\n"
      "warning: /data/Doe^John/ct: softened the streaks of 1.25 ml of metal (2500 HU or more) in 3 "
      "slices; pictures look better for it, the data are not\n"
      "warning: /data/Doe^John/ct: took 312 ml of table, cushions and the like off\n"
      "warning: /data/Doe^John/ct: gantry tilted by 16.5 degrees: resampled to a regular grid\n"
      "warning: John Doe, something new\n";
  EXPECT_THAT(
      notes_of_log(log),
      ElementsAre("312 ml of table and cushions taken off", "streaks of 1.25 ml of metal softened",
                  "gantry tilted by 16.5 degrees, resampled", "another warning: see the log"));
  EXPECT_FALSE(note_of_warning("clipgs: took 3 ml of table"));
}

TEST(BuildNotes, ErrorsLoseWhatMayNamePatients) {
  EXPECT_EQ(without_names("clipgs: /data/John Doe/ct.nii.gz: ends after 3 of 9 bytes; copy it"),
            "clipgs: …: ends after 3 of 9 bytes; copy it");
  EXPECT_EQ(without_names("clipgs: ct/john/IM1: no DICOM"), "clipgs: …: no DICOM");
  EXPECT_EQ(without_names("no series \"1.2.3\": give a UID such as 1.2.840.10008.1"),
            "no series \"…\": give a UID such as …");
  EXPECT_EQ(without_names("was ended by SIGKILL, perhaps for want of memory"),
            "was ended by SIGKILL, perhaps for want of memory");
  EXPECT_EQ(without_names("512 x 512 x 9 voxels need 5.3 GB of memory"),
            "512 x 512 x 9 voxels need 5.3 GB of memory");
  EXPECT_THAT(without_names(std::string(9000, '/')), Not(HasSubstr("/")));
}

}  // namespace
}  // namespace clipgs
