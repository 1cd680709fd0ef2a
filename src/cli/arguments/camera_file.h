#pragma once

#include "picture/camera_path.h"

#include <filesystem>

namespace selvage::cli {

/// Reads a way of the camera: lines `frame,X,Y,Z,X,Y,Z`, the eye and the point in the middle of the picture [m], or
/// with an eighth number, the angle between the lowest and the highest ray [degrees]. Frames ascend. Blank lines, those
/// that begin with # and a first line of words are skipped.
/// @param up  the direction that is shown upwards
/// @throws Error  when the file cannot be read or a line is wrong; it names the line
std::vector<CameraKey> read_camera_file(const std::filesystem::path& path, const Vec3& up);

}  // namespace selvage::cli
