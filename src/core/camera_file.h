#pragma once

#include <filesystem>

#include "core/camera.h"
#include "core/json_reader.h"

namespace clipgs {

/// A camera from an object with the keys that a frame of a dataset's transforms.json has: w and h
/// (px, to 16384), fl_x and fl_y, cx and cy (px), and transform_matrix, the rigid camera-to-world
/// matrix in mm (x right, y up, z backward; four rows of four). Throws Error.
Camera read_camera(const JsonReader& reader);
/// The same from a file that holds one such object.
Camera read_camera(const std::filesystem::path& path);

}  // namespace clipgs
