#include "runtime/device/hash.h"

#include <fmt/format.h>

#include <bit>
#include <cstring>

namespace gradus {

namespace {

constexpr std::uint64_t first_factor = 0x87C37B91114253D5, second_factor = 0x4CF5AD432745937F;

std::uint64_t first_mix(std::uint64_t word) { return std::rotl(word * first_factor, 31) * second_factor; }
std::uint64_t second_mix(std::uint64_t word) { return std::rotl(word * second_factor, 33) * first_factor; }

std::uint64_t avalanche(std::uint64_t word) {
    word = (word ^ (word >> 33)) * 0xFF51AFD7ED558CCD;
    word = (word ^ (word >> 33)) * 0xC4CEB9FE1A85EC53;
    return word ^ (word >> 33);
}

} // namespace

Hash128 hash128(std::string_view bytes, std::uint64_t seed) {
    std::uint64_t low = seed, high = seed;
    const std::size_t whole = bytes.size() / 16 * 16;
    for (std::size_t i = 0; i < whole; i += 16) {
        std::uint64_t words[2];
        std::memcpy(words, bytes.data() + i, 16);
        low = (std::rotl(low ^ first_mix(words[0]), 27) + high) * 5 + 0x52DCE729;
        high = (std::rotl(high ^ second_mix(words[1]), 31) + low) * 5 + 0x38495AB5;
    }
    std::uint64_t rest[2] = {0, 0};
    if (bytes.size() > whole)
        std::memcpy(rest, bytes.data() + whole, bytes.size() - whole);
    low ^= first_mix(rest[0]) ^ bytes.size();
    high ^= second_mix(rest[1]) ^ bytes.size();
    low += high;
    high += low;
    low = avalanche(low);
    high = avalanche(high);
    low += high;
    high += low;
    return {low, high};
}

std::string hexadecimal(const Hash128 &hash) { return fmt::format("{:016x}{:016x}", hash.high, hash.low); }

} // namespace gradus
