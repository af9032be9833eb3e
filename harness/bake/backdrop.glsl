// Sky and terrain. SKY: one triangle over the picture; else the terrain's mesh. SMOOTH: seen from above, and bent so
// little that N.L may be interpolated instead of N. FOG: with fog. COLORS: of each vertex.
// SHADOWED: behind shadow_map.glsl.
#pragma stage vertex
#ifdef SKY
uniform vec3 corner_rays[3];  // directions through (-1,-1), (3,-1), (-1,3) in clip space, not unit
out vec3 ray;

void main()
{
    vec2 corner = vec2(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0);
    ray = corner_rays[gl_VertexID];
    gl_Position = vec4(corner, 1.0, 1.0);  // at the far end: only where no terrain is
}
#else
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
#ifdef COLORS
layout(location = 2) in vec3 color_in;
out vec3 tint;
#endif
#if defined(FOG) || defined(SHADOWED)
out vec3 position_m;
#endif
#ifdef SMOOTH
out float cosine;
#else
out vec3 shading_normal;
#endif

void main()
{
#ifdef COLORS
    tint = color_in;
#endif
#if defined(FOG) || defined(SHADOWED)
    position_m = position;
#endif
#ifdef SMOOTH
    cosine = dot(normal, sun_direction);
#else
    shading_normal = normal;
#endif
    gl_Position = view_projection * vec4(position, 1.0);
}
#endif

#pragma stage fragment
layout(location = 0) out vec4 color;
#ifdef SKY
uniform vec3 zenith, horizon, ground;
in vec3 ray;

// sky_radiance() of harness/scene/scene.h
void main()
{
    float y = normalize(ray).y;
    color = vec4(y >= 0.0 ? mix(horizon, zenith, sqrt(y))
                          : mix(horizon, ground, min(1.0, -8.0 * y)), 0.0);
}
#else
uniform vec3 albedo;
#ifdef COLORS
in vec3 tint;
#endif
#if defined(FOG) || defined(SHADOWED)
in vec3 position_m;
#endif
#ifdef SMOOTH
uniform vec3 in_sun, in_shade;  // albedo times the sun's and the sky's light
in float cosine;
#else
in vec3 shading_normal;
#endif

void main()
{
#ifdef SHADOWED
    sun_visibility = shadow_visibility(position_m, shading_normal);
#endif
#ifdef SMOOTH
    vec3 radiance = in_shade + in_sun * max(0.0, cosine);
#else
    vec3 radiance = shade_bark(albedo, shading_normal, gl_FrontFacing);
#endif
#ifdef COLORS
    radiance *= masked ? vec3(1.0) : tint;
#endif
#ifdef FOG
    radiance = shade_fog(radiance, position_m);
#endif
    color = vec4(radiance, 0.0);
}
#endif
