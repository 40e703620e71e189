// The stages that gradient-domain path tracing has beside the path tracer's, which take offset paths along.
#pragma once

#include "runtime/wavefront/session.h"
#include "runtime/wavefront/stage.h"

namespace gradus {

/// Shifts base paths whose vertices, those of their offset paths among them, are of whatever kinds.
StageDeclaration shift_stage(const Session &session);
/// The same where they are all of one kind among several.
StageDeclaration shift_alike_stage(const Session &session);
/// Evaluates the BSDFs that `shift` asks for.
StageDeclaration evaluate_stage(const Session &session);
/// Weighs light that was sampled at vertices of offset paths. at_first: AT_FIRST of its kernel, "1u" or "0u".
StageDeclaration weigh_stage(const char *name, const char *at_first, bool is_wanted);
/// Adds light that base and offset paths have met; escaped: "1" for those that left the scene, else "0".
StageDeclaration gradient_emission_stage(const char *name, const char *escaped, bool is_wanted);
/// Brings offset paths to new rows; apart: "1" where they have vertices of their own, else "0".
StageDeclaration advance_stage(const char *name, const char *apart, bool is_wanted, bool has_textures = false);
/// Counts what became of shifts.
StageDeclaration count_stage();

} // namespace gradus
