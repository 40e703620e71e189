// Reads a scene's XML with the files that it includes and replaces its $parameters: text in, a tree of elements out.
#pragma once

#include "runtime/io/diagnostics.h"
#include "runtime/io/element.h"

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace gradus {

struct Document {
    Element root;                                      ///< the <scene>, includes spliced in
    std::vector<std::filesystem::path> search_folders; ///< where the files it names are looked for, in order
};

/// `parameters` go before the <default>s of the file. A <default> counts for the whole scene, whichever file and
/// line it stands in; of several for one name the first counts. Throws Error (ExitCode::scene).
Document read_document(const std::string &path, const std::map<std::string, std::string> &parameters,
                       Diagnostics &diagnostics);

} // namespace gradus
