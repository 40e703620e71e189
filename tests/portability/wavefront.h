// The kernels of a wavefront in one precision, stage by stage, with tables that can be read and set: for comparing the
// double build with the float build on equal inputs.
#pragma once

#include "kernels/shared/tables.h"
#include "runtime/scene/scene_tables.h"
#include "runtime/stages/film_stage.h"
#include "runtime/stages/partition_stage.h"
#include "runtime/stages/scene_buffers.h"
#include "runtime/trace/tracer.h"

#include <map>
#include <string>
#include <vector>

namespace gradus::testing {

struct Column {
    std::string name;
    bool is_uint;
};

#define GRADUS_TEST_REAL(table, column, text) {#column, false},
#define GRADUS_TEST_UINT(table, column, text) {#column, true},
inline const std::vector<Column> ray_table = {GRADUS_RAY_COLUMNS(GRADUS_TEST_REAL, GRADUS_TEST_UINT)};
inline const std::vector<Column> shadow_table = {GRADUS_SHADOW_COLUMNS(GRADUS_TEST_REAL, GRADUS_TEST_UINT)};
inline const std::vector<Column> vertex_table = {GRADUS_VERTEX_COLUMNS(GRADUS_TEST_REAL, GRADUS_TEST_UINT)};
inline const std::vector<Column> tangent_table = {GRADUS_TANGENT_COLUMNS(GRADUS_TEST_REAL, GRADUS_TEST_UINT)};
inline const std::vector<Column> radiance_table = {GRADUS_RADIANCE_COLUMNS(GRADUS_TEST_REAL, GRADUS_TEST_UINT)};
inline const std::vector<Column> feature_table = {GRADUS_FEATURE_COLUMNS(GRADUS_TEST_REAL, GRADUS_TEST_UINT)};
#undef GRADUS_TEST_REAL
#undef GRADUS_TEST_UINT

/// The content of a table, all reals as double. Columns that the traits leave out are missing.
struct Content {
    std::vector<std::vector<double>> values;
};

class Wavefront {
  public:
    Wavefront(Device &device, const Scene &scene, const TraitMap &traits, const SceneTables &scene_tables,
              Precision precision);

    /// Launches a stage; `kind`: of the BSDF, empty where the stage has no variants.
    void run(const std::string &stage, const std::string &kind, std::uint32_t first, std::uint32_t count);
    /// `vertex` is the newest vertices, `vertex_old` the ones before; this exchanges them.
    void exchange_vertices();
    const std::vector<std::uint32_t> &partition(std::uint32_t count) { return partition_->run(count); }

    Content read(const Buffer &buffer, const std::vector<Column> &columns) const;
    void write(const Buffer &buffer, const std::vector<Column> &columns, const Content &content) const;
    std::vector<std::uint32_t> read_bins(std::uint32_t count) const;
    void write_bins(const std::vector<std::uint32_t> &bins) const;
    const Buffer &newest() const { return tables->vertex[newest_]; }

    std::unique_ptr<BatchTables> tables;
    std::unique_ptr<FilmStage> film;

  private:
    Precision precision_;
    std::unique_ptr<SceneBuffers> scene_buffers_;
    std::unique_ptr<PartitionStage> partition_;
    std::map<std::string, Kernel> kernels_;
    int newest_ = 0;
};

} // namespace gradus::testing
