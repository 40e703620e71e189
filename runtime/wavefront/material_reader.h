// Reads the textures of what rays have met, class by class of materials.
#pragma once

#include "runtime/wavefront/grouping.h"
#include "runtime/wavefront/session.h"
#include "runtime/wavefront/stage.h"

#include <cstdint>
#include <optional>

namespace gradus {

class MaterialReader {
  public:
    /// Declares its stages; where no material has a texture, a blend or a map, none.
    MaterialReader(const Session &session, Stages &stages, bool of_light_paths);

    bool is_wanted() const { return grouping_.has_value(); }
    TableList tables() const { return is_wanted() ? grouping_->tables() : TableList(); }
    /// To be called once they are allocated.
    void attach(Tables &tables);

    /// Reads textures and chooses the parts of blends where `planes` times `rows` rows of `rays`, a table of table_rows
    /// rows, have met something, into the same rows of `surface`.
    void read(const Buffer &rays, std::uint32_t rows, std::uint32_t planes, std::uint32_t table_rows,
              const Buffer &surface);

  private:
    const Session &session_;
    Stage *group_ = nullptr, *material_ = nullptr;
    std::optional<Grouping> grouping_;
};

} // namespace gradus
