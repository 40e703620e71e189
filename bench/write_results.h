// The figures of a benchmark as a file.
#pragma once

#include "runtime/error.h"

#include <nlohmann/json.hpp>

#include <fstream>
#include <string>

namespace gradus::bench {

/// Nothing where the path is empty.
inline void write_results(const nlohmann::json &results, const std::string &path) {
    if (path.empty())
        return;
    std::ofstream file(path);
    file << results.dump(2) << "\n";
    if (!file.flush())
        throw Error(ExitCode::output, "cannot write " + path);
}

} // namespace gradus::bench
