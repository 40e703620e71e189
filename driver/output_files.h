// The files that a command writes: checked before its work, written after it.
#pragma once

#include "runtime/film/image.h"

#include <nlohmann/json_fwd.hpp>

#include <functional>
#include <string>
#include <vector>

namespace gradus {

struct OutputFiles {
    std::string image;      ///< must end in .exr
    std::string statistics; ///< path of the JSON; "-": stdout; empty: none
    bool png = false;       ///< a PNG beside the image
};

/// Throws Error(ExitCode::usage) for names that do not fit and Error(ExitCode::output) for files that could not be
/// written.
void check_outputs(const OutputFiles &files);

/// Makes the folder where it is not there. Throws Error(ExitCode::output) where that fails or it takes no files.
void check_folder(const std::string &path);

/// Files that a command reads and writes, by what they are for ("--stats"). Throws Error(ExitCode::usage) where two
/// outputs are one file, or one is a file that is read, however their paths are written: by links, by folders and back.
/// Outputs that cannot be written throw Error(ExitCode::output). Empty paths and "-" are none.
struct NamedFile {
    std::string use, path;
};
void check_distinct(const std::vector<NamedFile> &outputs, const std::vector<std::string> &inputs);

/// Those of `files`.
std::vector<NamedFile> output_list(const OutputFiles &files);

/// The path of the picture beside an image: its extension replaced by .png.
std::string png_path(const std::string &image);

/// Writes the image, the picture where one is asked for, and the statistics, once the others are there. What cannot be
/// written takes nothing else with it: the disk of the image may be full, that of the statistics not. The first error
/// is thrown at the end; others are printed.
void write_outputs(const OutputFiles &files, const Image &image, const Image &picture,
                   const std::function<nlohmann::json()> &statistics);

/// Writes JSON to a file in one step, or to stdout where `path` is "-".
void write_json(const nlohmann::json &json, const std::string &path);
/// As it is written: indented, a line at the end.
std::string json_text(const nlohmann::json &json);

} // namespace gradus
