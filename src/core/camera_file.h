#pragma once

#include <filesystem>

#include "core/camera.h"

namespace clipgs {

/// Reads a camera from a JSON file with the keys that a frame of a dataset's transforms.json has: w
/// and h (px), fl_x and fl_y, cx and cy (px), and transform_matrix, the rigid camera-to-world
/// matrix in mm (x right, y up, z backward; four rows of four). Throws Error.
Camera read_camera(const std::filesystem::path& path);

}  // namespace clipgs
