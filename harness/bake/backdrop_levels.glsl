// A terrain by levels of detail: vertices from their number and height, normals and colours from textures of the full
// grid, so that they do not change with the level. FOG: with fog. COLORS: of each vertex. SHADOWED: behind
// shadow_map.glsl or sunlight.glsl.
#pragma stage vertex
layout(location = 0) in float height_m;
uniform int samples_x;
uniform vec2 last_sample;  // the number of the last one along x and z
uniform vec2 size_m;
out vec2 place;  // 0..1 over the terrain
out vec3 position_m;

void main()
{
    place = vec2(float(gl_VertexID % samples_x), float(gl_VertexID / samples_x)) / last_sample;
    position_m = vec3((place.x - 0.5) * size_m.x, height_m, (place.y - 0.5) * size_m.y);
    gl_Position = view_projection * vec4(position_m, 1.0);
}

#pragma stage fragment
layout(location = 0) out vec4 color;
layout(binding = 0) uniform sampler2D normals;
#ifdef COLORS
layout(binding = 1) uniform sampler2D colors;
#endif
uniform vec3 albedo;
uniform vec2 last_sample;
in vec2 place;
in vec3 position_m;

void main()
{
    vec2 texel = (place * last_sample + 0.5) / (last_sample + 1.0);  // samples stand in texels' middles
    vec3 normal = texture(normals, texel).xyz;
#ifdef SHADOWED
    sun_visibility = SHADOW_VISIBILITY(position_m, normal);
#endif
    // a mean of normals is shorter than 1, and so is the mean of their light
    vec3 radiance = shade_lit(albedo, max(0.0, dot(gl_FrontFacing ? normal : -normal, sun_direction)));
#ifdef COLORS
    radiance *= masked ? vec3(1.0) : texture(colors, texel).rgb;
#endif
#ifdef FOG
    radiance = shade_fog(radiance, position_m);
#endif
    color = vec4(radiance, 0.0);
}
