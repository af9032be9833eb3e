// What casts into a shadow map, with shadow_cover.glsl. TERRAIN: the ground, HEIGHTS: of numbered vertices, as in
// backdrop_levels.glsl; else triangles of plants, instanced. PRUNED, TEXTURED: as of triangles.glsl.
#pragma stage vertex
uniform mat4 light;
#ifdef HEIGHTS
layout(location = 0) in float height_m;
uniform int samples_x;
uniform vec2 last_sample, size_m;
#else
layout(location = 0) in vec3 position;
#endif
#ifndef TERRAIN
layout(location = 5) in vec4 place;
layout(location = 6) in vec4 turn;
layout(location = 8) in vec2 shape;
#endif
#ifdef TEXTURED
layout(location = 3) in vec2 uv;
out vec2 texture_uv;
#endif
#ifdef PRUNED
layout(location = 1) in vec4 normal;
layout(location = 2) in vec4 albedo;
layout(location = 4) in vec3 center;
layout(location = 7) in vec2 run;
uniform float elements;
#endif

void main()
{
#ifdef HEIGHTS
    vec2 at = vec2(float(gl_VertexID % samples_x), float(gl_VertexID / samples_x)) / last_sample;
    vec3 world = vec3((at.x - 0.5) * size_m.x, height_m, (at.y - 0.5) * size_m.y);
#else
    vec3 world = position;
#endif
#ifndef TERRAIN
    vec3 local = position;
#ifdef PRUNED
    float rank = float(gl_VertexID / 3) - run.x;
    rank += rank < 0.0 ? elements : 0.0;
    bool kept = normal.w > 0.5 || albedo.w < run.y;
    local = center + (position - center) * (kept ? turn.w : 0.0);
#endif
    world = place.xyz + place.w * rotate_y(vec3(local.x, local.y * shape.x, local.z), turn.x, turn.y);
#endif
#ifdef TEXTURED
    texture_uv = uv;
#endif
    gl_Position = light * vec4(world, 1.0);
}

#pragma stage fragment
#ifdef TEXTURED
in vec2 texture_uv;
layout(binding = 0) uniform sampler2D picture;
#endif

void main()
{
#ifdef TEXTURED
    if (texture(picture, texture_uv).a < 0.5)
        discard;
#endif
#ifdef LAYERS
    cover(gl_FragCoord.z);
#endif
}
