// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#if __has_include(<embree4/rtcore.h>)
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

// Embree's queries in one form: 4 (Debian 13) takes arguments where 3 (Debian 12) takes a context. Only for caster.cpp.
namespace coslam::sim {

#if RTC_VERSION_MAJOR >= 4

inline void intersect_ray(RTCScene scene, RTCRayHit& query) { rtcIntersect1(scene, &query, nullptr); }

// Rays that lie close to each other.
inline void intersect_rays(const int* valid, RTCScene scene, RTCRayHit8& query) {
  RTCIntersectArguments arguments;
  rtcInitIntersectArguments(&arguments);
  arguments.flags = RTC_RAY_QUERY_FLAG_COHERENT;
  rtcIntersect8(valid, scene, &query, &arguments);
}

// Whether something is met: then ray.tfar is negative.
inline void occlude_ray(RTCScene scene, RTCRay& ray) { rtcOccluded1(scene, &ray, nullptr); }

#else

inline void intersect_ray(RTCScene scene, RTCRayHit& query) {
  RTCIntersectContext context{};
  rtcInitIntersectContext(&context);
  rtcIntersect1(scene, &context, &query);
}

// Rays that lie close to each other.
inline void intersect_rays(const int* valid, RTCScene scene, RTCRayHit8& query) {
  RTCIntersectContext context{};
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  rtcIntersect8(valid, scene, &context, &query);
}

// Whether something is met: then ray.tfar is negative.
inline void occlude_ray(RTCScene scene, RTCRay& ray) {
  RTCIntersectContext context{};
  rtcInitIntersectContext(&context);
  rtcOccluded1(scene, &context, &ray);
}

#endif

}  // namespace coslam::sim
