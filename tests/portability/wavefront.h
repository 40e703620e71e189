// The kernels of a wavefront in one precision, stage by stage, with tables that can be read and set: for comparing the
// double build with the float build on equal inputs.
#pragma once

#include "runtime/scene/scene_tables.h"
#include "runtime/stages/film_stage.h"
#include "runtime/stages/partition_stage.h"
#include "runtime/stages/scene_buffers.h"
#include "runtime/trace/tracer.h"

#include <map>
#include <memory>
#include <string>
#include <vector>

namespace gradus::testing {

struct Column {
    std::string name;
    bool is_uint;
};

/// The columns of kernels/shared/tables.h, whose short macro names are not for headers.
extern const std::vector<Column> ray_table, shadow_table, vertex_table, tangent_table, radiance_table, feature_table;

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
