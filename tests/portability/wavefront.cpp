#include "tests/portability/wavefront.h"

#include "runtime/stages/invariant_division.h"

#include <algorithm>
#include <cstring>

#include "kernels/shared/tables.h"

namespace gradus::testing {

#define GRADUS_TEST_REAL(table, column, text) {#column, false},
#define GRADUS_TEST_UINT(table, column, text) {#column, true},
const std::vector<Column> ray_table = {GRADUS_RAY_COLUMNS(GRADUS_TEST_REAL, GRADUS_TEST_UINT)};
const std::vector<Column> shadow_table = {GRADUS_SHADOW_COLUMNS(GRADUS_TEST_REAL, GRADUS_TEST_UINT)};
const std::vector<Column> vertex_table = {GRADUS_VERTEX_COLUMNS(GRADUS_TEST_REAL, GRADUS_TEST_UINT)};
const std::vector<Column> tangent_table = {GRADUS_TANGENT_COLUMNS(GRADUS_TEST_REAL, GRADUS_TEST_UINT)};
const std::vector<Column> radiance_table = {GRADUS_RADIANCE_COLUMNS(GRADUS_TEST_REAL, GRADUS_TEST_UINT)};
const std::vector<Column> feature_table = {GRADUS_FEATURE_COLUMNS(GRADUS_TEST_REAL, GRADUS_TEST_UINT)};

Wavefront::Wavefront(Device &device, const Scene &scene, const TraitMap &traits, const SceneTables &scene_tables,
                     Precision precision)
    : precision_(precision) {
    const std::uint32_t pixels = scene.film.width * scene.film.height;
    const std::uint32_t paths = pixels * static_cast<std::uint32_t>(scene.settings.samples_per_pixel);
    const std::uint32_t bins = static_cast<std::uint32_t>(1 + 2 * scene_tables.kinds.size());
    tables = std::make_unique<BatchTables>(device, paths, paths, bins, traits, precision);
    scene_buffers_ = std::make_unique<SceneBuffers>(device, scene_tables, precision);

    std::vector<KernelRequest> requests = PartitionStage::requests();
    const std::size_t partition_count = requests.size();
    requests.push_back(FilmStage::request());
    for (const std::string name : {"camera", "classify", "surface", "escape", "connect", "emission"})
        requests.push_back({name, "kernels/stages/" + name + ".cl", name, {}});
    for (const std::string &kind : scene_tables.kinds)
        for (const std::string name : {"light_sample", "scatter", "feature"})
            requests.push_back({name + kind,
                                "kernels/stages/" + name + ".cl",
                                name,
                                {{"BSDF", kind}, {"BSDF_IS_DIRAC", bsdf_kind_is_dirac(kind) ? "1" : "0"}}});
    const std::vector<Kernel> built = KernelLibrary(device, traits, precision).build(requests);
    for (std::size_t i = 0; i < built.size(); ++i)
        kernels_[requests[i].name] = built[i];
    film = std::make_unique<FilmStage>(device, built[partition_count], *tables, scene.film.width, scene.film.height,
                                       traits, precision);
    partition_ = std::make_unique<PartitionStage>(
        std::vector<Kernel>(built.begin(), built.begin() + std::ptrdiff_t(partition_count)), *tables, bins);

    const InvariantDivision by_pixels = invariant_division(pixels), by_width = invariant_division(scene.film.width);
    const std::map<std::string, std::uint32_t> numbers = {{"first_row", 0},
                                                          {"first_slot", 0},
                                                          {"first_pixel", 0},
                                                          {"first_sample_low", 0},
                                                          {"first_sample_high", 0},
                                                          {"max_depth", 12},
                                                          {"roulette_depth", 2},
                                                          {"slots", tables->slots},
                                                          {"capacity", tables->capacity},
                                                          {"pixels", pixels},
                                                          {"pixels_multiplier", by_pixels.multiplier},
                                                          {"pixels_shift", by_pixels.shift},
                                                          {"width_multiplier", by_width.multiplier},
                                                          {"width_shift", by_width.shift},
                                                          {"crop_x", 0},
                                                          {"crop_y", 0},
                                                          {"crop_width", scene.film.width},
                                                          {"film_width", scene.film.width},
                                                          {"seed_low", 5},
                                                          {"seed_high", 0}};
    for (std::size_t i = partition_count + 1; i < requests.size(); ++i) {
        Kernel &kernel = kernels_.at(requests[i].name);
        scene_buffers_->bind(kernel);
        for (const Buffer *buffer : {&tables->ray, &tables->shadow, &tables->radiance, &tables->feature,
                                     &tables->tangent, &tables->bin, &tables->index})
            kernel.bind(*buffer);
        for (const auto &[name, value] : numbers)
            kernel.set(name, value);
    }
}

void Wavefront::run(const std::string &stage, const std::string &kind, std::uint32_t first, std::uint32_t count) {
    Kernel &kernel = kernels_.at(stage + kind);
    kernel.bind("vertex", tables->vertex[newest_]);
    kernel.bind("vertex_old", tables->vertex[1 - newest_]);
    kernel.set("first", first);
    kernel.set("count", count);
    kernel.launch(count);
}

void Wavefront::exchange_vertices() { newest_ = 1 - newest_; }

Content Wavefront::read(const Buffer &buffer, const std::vector<Column> &columns) const {
    const bool by_slot = &buffer == &tables->radiance || &buffer == &tables->feature;
    const std::size_t rows = by_slot ? tables->slots : tables->capacity, size = real_bytes(precision_);
    const auto view = buffer.map(Access::read);
    Content content;
    for (std::size_t c = 0; c < columns.size() && (c + 1) * rows * size <= buffer.bytes(); ++c) {
        std::vector<double> &values = content.values.emplace_back(rows);
        for (std::size_t row = 0; row < rows; ++row) {
            const char *place = view.as<char>() + (c * rows + row) * size;
            std::uint32_t number;
            float single;
            std::memcpy(&number, place, sizeof number);
            std::memcpy(&single, place, sizeof single);
            if (size == 8)
                std::memcpy(&values[row], place, sizeof(double));
            values[row] = columns[c].is_uint ? number : size == 8 ? values[row] : single;
        }
    }
    return content;
}

void Wavefront::write(const Buffer &buffer, const std::vector<Column> &columns, const Content &content) const {
    const std::size_t size = real_bytes(precision_);
    const auto view = buffer.map(Access::read_write);
    for (std::size_t c = 0; c < content.values.size(); ++c)
        for (std::size_t row = 0; row < content.values[c].size(); ++row) {
            char *place = view.as<char>() + (c * content.values[c].size() + row) * size;
            const double value = content.values[c][row];
            const float single = static_cast<float>(value);
            if (columns[c].is_uint) {
                const std::uint32_t number = static_cast<std::uint32_t>(value);
                std::memcpy(place, &number, sizeof number);
            } else if (size == 8) {
                std::memcpy(place, &value, sizeof value);
            } else {
                std::memcpy(place, &single, sizeof single);
            }
        }
}

std::vector<std::uint32_t> Wavefront::read_bins(std::uint32_t count) const {
    std::vector<std::uint32_t> bins(count);
    tables->bin.read(bins.data(), count * sizeof(std::uint32_t));
    return bins;
}

void Wavefront::write_bins(const std::vector<std::uint32_t> &bins) const {
    std::copy(bins.begin(), bins.end(), tables->bin.map(Access::write).as<std::uint32_t>());
}

} // namespace gradus::testing
