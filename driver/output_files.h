// The files that a command writes: checked before its work, written after it.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include <string>

namespace gradus {

struct OutputFiles {
    std::string image;      ///< must end in .exr
    std::string statistics; ///< path of the JSON; "-": stdout; empty: none
    bool png = false;       ///< a PNG beside the image
};

/// Throws Error(ExitCode::usage) for names that do not fit and Error(ExitCode::output) for files that could not be
/// written.
void check_outputs(const OutputFiles &files);

/// The path of the picture beside an image: its extension replaced by .png.
std::string png_path(const std::string &image);

/// Writes JSON to a file in one step, or to stdout where `path` is "-".
void write_json(const nlohmann::json &json, const std::string &path);

} // namespace gradus
