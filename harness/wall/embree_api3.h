/* What Embree 3 spells its own way. */
#ifndef TREELINE_WALL_EMBREE_API3_H
#define TREELINE_WALL_EMBREE_API3_H

#include <embree3/rtcore.h>

static inline void api_intersect16(const int *valid, RTCScene scene, struct RTCRayHit16 *packet,
                                   bool coherent)
{
    struct RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    if (coherent)
        context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    rtcIntersect16(valid, scene, &context, packet);
}

static inline void api_occluded16(const int *valid, RTCScene scene, struct RTCRay16 *packet)
{
    struct RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcOccluded16(valid, scene, &context, packet);
}

#endif
