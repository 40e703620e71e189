// Spheres as Embree traces them: it asks for the hits of packets with each sphere. Its own spheres test one ray of a
// packet after the other; here sixteen rays are tested at once.
#pragma once

#include "runtime/trace/embree.h"

namespace gradus {

/// What the geometry's user data has for each of its primitives; units and frame of the scene.
struct TracedSphere {
    float center[3], radius;
};

/// Makes a geometry of `count` spheres, which stay where they are as long as it lives.
RTCGeometry new_sphere_geometry(RTCDevice device, const TracedSphere *spheres, unsigned count);

} // namespace gradus
