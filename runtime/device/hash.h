// A hash for naming what is cached and for seeing that it is whole. Not one against forgery.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace gradus {

struct Hash128 {
    std::uint64_t low = 0, high = 0;
    bool operator==(const Hash128 &) const = default;
};

/// MurmurHash3 for x64, 128 bits. The same on every machine with this order of bytes.
Hash128 hash128(std::string_view bytes, std::uint64_t seed = 0);

/// 32 hexadecimal digits.
std::string hexadecimal(const Hash128 &hash);

} // namespace gradus
