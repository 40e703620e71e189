// What methods that trace paths from the camera share: the stages of the path tracer and how they are launched.
#pragma once

#include "runtime/scene/roughness.h"
#include "runtime/wavefront/wavefront.h"

#include <cstdint>
#include <vector>

namespace gradus {

StageDeclaration camera_stage();
/// Rays of the camera end at its far plane; to run after each trace of rays some of which are the camera's.
StageDeclaration far_clip_stage(const Session &session);
StageDeclaration connect_stage();
StageDeclaration escape_stage(const Session &session);
StageDeclaration emission_stage(const Session &session);
/// `with_offsets`: for paths with offset paths that are not connected (gradient_path_tracer.h).
StageDeclaration shade_stage(bool with_offsets);

/// The lists, one after the other.
TableList joined(TableList a, const TableList &b);
TableRows table_rows(const Session &session, std::uint32_t batch, std::uint32_t slots);

/// Begins what paths of the pass there is room for: those of the pixels from `first_pixel` on, which is in sample
/// `first_sample` of the image. Returns the slot of the first; the others follow.
std::uint32_t begin_camera_paths(Stage &camera, Wavefront &paths, std::uint32_t first_pixel,
                                 std::uint64_t first_sample);
/// Runs a stage that reads the rows of before by the index, on those that take the new rows of the range.
void run_on_places(Stage &stage, const Hits &hits, Range rows);
/// The new vertices of one BSDF kind.
void run_shade(Stage &shade, const Hits &hits, Range rows, std::size_t kind);

/// By material record, the kind with what `kind` in kernels/shared/tables.h says of it. Which surfaces are rough from
/// this roughness on is_rough tells of shifts, gathers_photons of photons (runtime/scene/roughness.h).
std::vector<std::uint32_t> material_kinds(const Scene &scene, double threshold,
                                          bool (*counts_as_rough)(const Bsdf &, double));

/// `counted` with what session and stages know: rays, seconds by stage and of compiling, memory. `more`: what other
/// stages took.
Statistics collected(Statistics counted, const Session &session, const Stages &stages,
                     const std::vector<StageTime> &more = {});

} // namespace gradus
