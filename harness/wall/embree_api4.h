/* What Embree 4 spells its own way. */
#ifndef TREELINE_WALL_EMBREE_API4_H
#define TREELINE_WALL_EMBREE_API4_H

#include <embree4/rtcore.h>

static inline void api_intersect16(const int *valid, RTCScene scene, struct RTCRayHit16 *packet,
                                   bool coherent)
{
    struct RTCIntersectArguments arguments;
    rtcInitIntersectArguments(&arguments);
    if (coherent)
        arguments.flags = RTC_RAY_QUERY_FLAG_COHERENT;
    rtcIntersect16(valid, scene, packet, &arguments);
}

static inline void api_occluded16(const int *valid, RTCScene scene, struct RTCRay16 *packet)
{
    struct RTCOccludedArguments arguments;
    rtcInitOccludedArguments(&arguments);
    rtcOccluded16(valid, scene, packet, &arguments);
}

#endif
