// What an OpenEXR file declares, read before OpenEXR does: it allocates by what a header says, whatever the file holds.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace gradus {

struct ExrSize {
    std::uint64_t bytes = 0;  ///< of all parts' pixels as floats
    std::uint64_t blocks = 0; ///< of scanlines or tiles at least; each has 8 bytes in the file's table of offsets
    bool is_whole =
        true; ///< false: the headers end early, an attribute is longer than the file, or a channel of no known type

    /// Whether a file of so many bytes can hold it.
    bool fits(std::uint64_t file_bytes) const { return is_whole && blocks <= file_bytes / 8; }
};

/// Sums over all parts. Nothing for what is no OpenEXR file. Sums that are too large for 64 bits are the largest
/// number.
std::optional<ExrSize> exr_size(const std::string &path);

} // namespace gradus
