#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "cinema/make_dataset.h"

namespace clipgs {

/// --test-size, --uncut-frames, --close-frames and --cut-views: what a dataset is measured by
/// besides cuts of whole bodies at the size of training pictures; and how clean all test pictures
/// are. `options` must outlive the parsing.
inline void add_test_picture_options(CLI::App& command, DatasetOptions& options,
                                     const std::string& group) {
  command
      .add_option("--test-size", options.test_size,
                  "Side of test and validation pictures, px (default: that of all)")
      ->check(CLI::Range(16, 4096))
      ->group(group);
  command
      .add_option("--uncut-frames", options.uncut_frames,
                  "Test pictures of the uncut body besides, and half as many to validate by")
      ->check(CLI::Range(0, 10000))
      ->group(group);
  command
      .add_option(
          "--close-frames", options.close_frames,
          "Test pictures close up besides, of faces and of the uncut body in turn, magnified "
          "2, 3 and 4 times; half as many to validate by")
      ->check(CLI::Range(0, 10000))
      ->group(group);
  command
      .add_flag("--cut-views", options.cut_views,
                "The 45 test views besides that XClipGS measures cuts by: faces seen from before, "
                "edges along the plane")
      ->group(group);
  command.add_option("--test-noise-db", options.test_noise_db, "Noise floor of test pictures, dB")
      ->check(CLI::Range(10.0, 80.0))
      ->capture_default_str()
      ->group(group);
  command
      .add_option("--test-masked-noise-db", options.test_masked_noise_db,
                  "The same, of their pixels that show matter alone (0: any)")
      ->check(CLI::Range(0.0, 80.0))
      ->capture_default_str()
      ->group(group);
}

}  // namespace clipgs
