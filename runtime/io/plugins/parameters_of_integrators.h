// Parameters that several integrators have.
#pragma once

#include "runtime/io/declaration.h"

namespace gradus {

inline Parameter hide_emitters_parameter() {
    return {"hide_emitters", Takes::boolean, "false",
            "the camera sees no emitters: its rays pass surfaces that emit, behind holes of masks too (where Mitsuba "
            "3.9 shows them), but not behind glass, however thin"};
}

} // namespace gradus
