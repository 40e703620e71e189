// Embree 3 or 4, whichever the project was built with (GRADUS_EMBREE), and queries of rays, which are all that these
// versions ask for in other ways.
#pragma once

#if GRADUS_EMBREE == 3
#include <embree3/rtcore.h>
#else
#include <embree4/rtcore.h>
#endif

#include <limits>

namespace gradus {

/// Ends the rays of a packet before they begin whose lane of `valid` is not -1. On processors without AVX-512, where
/// Embree 3.13 has no packets of 16 itself, it does not look at `valid` and traces all rays of some length.
template <class Ray>
void end_invalid_rays(const int *valid, Ray &rays) {
    for (int lane = 0; lane < 16; ++lane)
        rays.tfar[lane] = valid[lane] != 0 ? rays.tfar[lane] : -std::numeric_limits<float>::infinity();
}

#if GRADUS_EMBREE == 3

/// What queries of like rays share.
struct RayQuery {
    RTCIntersectContext context; ///< first: filters are given its address

    /// `beams`: packets of rays that go the same way are tested as one beam.
    explicit RayQuery(bool beams) {
        rtcInitIntersectContext(&context);
        context.flags = beams ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
    }
};

inline void intersect(RTCScene scene, RayQuery &query, RTCRayHit &ray) { rtcIntersect1(scene, &query.context, &ray); }
/// Of the packet's rays those whose lane of `valid` is -1. The others' ends are lost.
inline void intersect(const int *valid, RTCScene scene, RayQuery &query, RTCRayHit16 &rays) {
    end_invalid_rays(valid, rays.ray);
    rtcIntersect16(valid, scene, &query.context, &rays);
}
inline void occlude(RTCScene scene, RayQuery &query, RTCRay &ray) { rtcOccluded1(scene, &query.context, &ray); }
inline void occlude(const int *valid, RTCScene scene, RayQuery &query, RTCRay16 &rays) {
    end_invalid_rays(valid, rays);
    rtcOccluded16(valid, scene, &query.context, &rays);
}

#else

struct RayQuery {
    RTCRayQueryContext context;
    RTCIntersectArguments intersecting;
    RTCOccludedArguments occluding;

    explicit RayQuery(bool beams) {
        rtcInitRayQueryContext(&context);
        rtcInitIntersectArguments(&intersecting);
        rtcInitOccludedArguments(&occluding);
        intersecting.flags = occluding.flags = beams ? RTC_RAY_QUERY_FLAG_COHERENT : RTC_RAY_QUERY_FLAG_INCOHERENT;
        intersecting.context = occluding.context = &context;
    }
    RayQuery(const RayQuery &) = delete;
    RayQuery &operator=(const RayQuery &) = delete;
};

inline void intersect(RTCScene scene, RayQuery &query, RTCRayHit &ray) {
    rtcIntersect1(scene, &ray, &query.intersecting);
}
inline void intersect(const int *valid, RTCScene scene, RayQuery &query, RTCRayHit16 &rays) {
    end_invalid_rays(valid, rays.ray);
    rtcIntersect16(valid, scene, &rays, &query.intersecting);
}
inline void occlude(RTCScene scene, RayQuery &query, RTCRay &ray) { rtcOccluded1(scene, &ray, &query.occluding); }
inline void occlude(const int *valid, RTCScene scene, RayQuery &query, RTCRay16 &rays) {
    end_invalid_rays(valid, rays);
    rtcOccluded16(valid, scene, &rays, &query.occluding);
}

#endif

} // namespace gradus
