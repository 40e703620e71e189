// Reads a scene's XML with the files that it includes and replaces its $parameters: text in, a tree of elements out.
#pragma once

#include "runtime/io/diagnostics.h"
#include "runtime/io/element.h"
#include "runtime/io/file_search.h"
#include "runtime/io/load_options.h"

#include <filesystem>
#include <string>
#include <vector>

namespace gradus {

struct Document {
    Element root;                                      ///< the <scene>, includes spliced in
    std::vector<std::filesystem::path> search_folders; ///< where the files it names are looked for, in order
};

/// The options' parameters go before the <default>s of the file. A <default> counts for the whole scene, whichever file
/// and line it stands in; of several for one name the first counts. Throws Error (ExitCode::scene).
Document read_document(const std::string &path, const LoadOptions &options, FileFinder &finder,
                       Diagnostics &diagnostics);

} // namespace gradus
