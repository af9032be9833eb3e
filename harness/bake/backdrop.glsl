// Sky and terrain. SKY: one triangle over the picture; else the terrain's mesh. SMOOTH: seen from above, and bent so
// little that N.L may be interpolated instead of N. FOG: with fog. COLORS: of each vertex.
// SHADOWED: behind shadow_map.glsl or sunlight.glsl. SKYLINE: in the shadow of horizon maps.
#if defined(FOG) || defined(SKYLINE) || defined(SHADOWED)
#define PLACED
#endif
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
#ifdef PLACED
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
#ifdef PLACED
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
#ifdef PLACED
in vec3 position_m;
#endif
#ifdef SMOOTH
uniform vec3 in_sun, in_shade;  // albedo times the sun's and the sky's light
in float cosine;
#else
in vec3 shading_normal;
#endif

#ifdef SKYLINE
uniform vec2 terrain_m;       // size along x and z
uniform float sun_layer;      // azimuth, in layers of the maps
uniform float sun_tangent;    // of the elevation
layout(binding = 0) uniform sampler2DArray skylines;

// The horizon of the two nearest azimuths, mixed, or of the nearest where layers are whole (Max 1988).
bool in_shadow()
{
    vec3 size = vec3(textureSize(skylines, 0));
    vec2 at = ((position_m.xz / terrain_m + 0.5) * (size.xy - 1.0) + 0.5) / size.xy;
    float low = floor(sun_layer);
    float horizon = mix(texture(skylines, vec3(at, low)).r, texture(skylines, vec3(at, mod(low + 1.0, size.z))).r,
                        sun_layer - low);
    return sun_tangent < horizon;
}
#endif

void main()
{
#ifdef SKYLINE
    sun_visibility = in_shadow() ? 0.0 : 1.0;
#endif
#ifdef SHADOWED
    sun_visibility *= SHADOW_VISIBILITY(position_m, shading_normal);
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
