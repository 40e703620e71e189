// Prints a hash of the sums of splats, made with a number of threads: splat_digest SPLATS THREADS.
#include "tests/wavefront/splat_fixture.h"

#include <cstdlib>
#include <iostream>

int main(int, char **argv) {
    using namespace gradus;
    using namespace gradus::testing;
    Device device("", std::atoi(argv[2]));
    std::cerr << device.description().name << ", " << device.description().compute_units << " compute units\n";
    const std::vector<SplatRow> rows = random_splats(std::size_t(std::atoi(argv[1])), 64 * 64);
    for (const Splats::Order order : {Splats::Order::rows, Splats::Order::paths}) {
        SplatFilm film(device, 64, std::uint32_t(rows.size()), order);
        film.add(rows);
        const std::vector<std::uint32_t> bits = film.bits();
        std::uint64_t hash = 1469598103934665603u; // FNV-1a
        for (const std::uint32_t word : bits)
            hash = (hash ^ word) * 1099511628211u;
        std::cout << hash << "\n";
    }
}
