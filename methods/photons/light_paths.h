// Paths from the lights, for methods that gather photons: a second wavefront beside the camera's, with stages and
// tables of its own. It leaves a photon wherever a light path meets a surface that is rough enough (Jensen 1996).
//
// Random numbers go by seed, the light path's number and the dimension; photons come in the order of light paths and
// along each. So neither batches nor threads show in what is stored.
#pragma once

#include "methods/method.h"
#include "runtime/wavefront/wavefront.h"

#include <cstdint>
#include <optional>
#include <vector>

namespace gradus {

/// For an image of so many pixels a pass has as many light paths as leave so many photons, unless options say how many;
/// but where light hardly reaches a surface at most so many.
double photons_a_pass(std::uint64_t film_pixels);
double most_light_paths_a_pass(std::uint64_t film_pixels);

class LightPaths {
  public:
    /// Photons of depth 1, which lights send directly, are left out where the caller samples lights himself.
    enum class Direct { photons, left_out };

    /// Adds to the session the buffers `material_gathers` and `material_keeps` (kernels/shared/tables.h), by
    /// options.gather_roughness; the former is for who gathers. `consumers`: the stages that read photons; their
    /// kernels take `photon` and `photon_rows`, which is its stride and changes as it grows.
    LightPaths(Session &session, Stages &consumers, const Scene &scene, const RenderOptions &options, Direct direct);

    /// For the consumers' tables: `photon`, `photon_origin` and `photon_order`, which grow. With TRAIT_LIGHT_VERTICES,
    /// a trait of the method, also the vertices of all light paths (kernels/shared/light_vertex.h), which photons name;
    /// with TRAIT_LIGHT_STARTS those on lights too.
    TableList tables() const;
    /// To be called once these are allocated, before or after the consumers' stages are built.
    void attach(Tables &tables);

    /// Light paths a pass: those that the options ask for, or as many as store about five photons for each pixel of the
    /// film, at least 16384 and at most a million. How many that are is told by a pilot, the same for any batch, of
    /// light paths that no render reaches.
    std::uint32_t paths_a_pass();

    /// Traces the light paths of numbers first_path to first_path + count - 1 and stores their photons: in rows of
    /// `photon` that `photon_order` names, by light path and along each. Returns how many there are. Each bears the
    /// power that it would have if its light path were the only one: divide by `count`, or by all light paths of a
    /// render. Paths have at most max_depth - 1 edges, since the camera's side has one at least.
    std::uint32_t trace(std::uint64_t first_path, std::uint32_t count);

    /// Rows of `photon` that the last call of trace() wrote, those without a photon counted in.
    std::uint32_t rows() const { return rows_; }
    /// What all calls of trace() did, the pilot not counted in.
    std::uint64_t light_paths() const { return light_paths_; }
    std::uint64_t photons() const { return photons_; }
    /// What the stages took, the pilot's launches counted in, and how many rays were traced.
    std::vector<StageTime> times() const;
    std::uint64_t rays() const { return rays_; }

  private:
    void step_all(std::uint64_t first_path, std::uint32_t count);
    void scatter(const Hits &hits, std::uint32_t phase, std::size_t kind);
    /// The photons of `count` light paths. Returns how many there are.
    std::uint32_t put_in_order(std::uint32_t count);
    /// For so many rows of `photon`.
    void make_room(std::uint64_t rows);
    void bind_tables();
    void make_room_for_vertices(std::uint64_t records);

    Session &session_;
    Stages &consumers_;
    std::uint64_t wanted_;
    std::uint32_t first_depth_; ///< of photons: surfaces that their light has met
    BinLayout layout_;
    std::uint32_t paths_a_pass_ = 0;
    std::uint32_t rows_ = 0, vertices_ = 0; ///< rows of `photon` and records of vertices that trace() has left
    Stages stages_;
    Stage &emit_;
    Wavefront paths_;
    Stage &scatter_, &scatter_first_, &count_, &scan_, &place_, &order_;
    std::optional<Tables> own_;
    Tables *tables_ = nullptr;
    std::uint64_t light_paths_ = 0, photons_ = 0, rays_ = 0;
};

} // namespace gradus
