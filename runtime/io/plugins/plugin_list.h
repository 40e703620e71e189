// Every plugin that a scene file may name. A new one is a line here and a file <category>_<name>.cpp beside this one
// that defines the function <category>_<name>; plugin.h says what each category gives.
#pragma once

#define GRADUS_PLUGINS(PLUGIN)                                                                                         \
    PLUGIN(bsdf, conductor)                                                                                            \
    PLUGIN(bsdf, dielectric)                                                                                           \
    PLUGIN(bsdf, diffuse)                                                                                              \
    PLUGIN(bsdf, null)                                                                                                 \
    PLUGIN(bsdf, roughconductor)                                                                                       \
    PLUGIN(bsdf, roughdielectric)                                                                                      \
    PLUGIN(bsdf, twosided)                                                                                             \
    PLUGIN(emitter, area)                                                                                              \
    PLUGIN(emitter, constant)                                                                                          \
    PLUGIN(emitter, directional)                                                                                       \
    PLUGIN(emitter, point)                                                                                             \
    PLUGIN(film, hdrfilm)                                                                                              \
    PLUGIN(integrator, direct)                                                                                         \
    PLUGIN(integrator, path)                                                                                           \
    PLUGIN(rfilter, box)                                                                                               \
    PLUGIN(rfilter, gaussian)                                                                                          \
    PLUGIN(rfilter, tent)                                                                                              \
    PLUGIN(sensor, perspective)                                                                                        \
    PLUGIN(shape, cube)                                                                                                \
    PLUGIN(shape, obj)                                                                                                 \
    PLUGIN(shape, ply)                                                                                                 \
    PLUGIN(shape, rectangle)                                                                                           \
    PLUGIN(shape, serialized)                                                                                          \
    PLUGIN(shape, sphere)
