// Slices of trees as quads (harness/bake/stack.h). TRILINEAR, STRAIGHT, ROUGH, INTERPOLATE, OBLIQUE, POWER, FOG: as
// stack_request and the scene have them. SHADOWED: behind shadow_map.glsl.

#pragma stage vertex
struct tree {
    vec4 base_layer;   // struct stack_tree of stack_bake.h
    vec4 u_step, v_count, w_level;
    vec4 leaf_power, bark_albedo;
    vec4 eye, toward_array;
};
layout(std430, binding = 0) readonly buffer trees_buffer { tree trees[]; };

flat out float level;
flat out vec3 leaf_light, bark_light;
flat out vec2 power_albedo;
#ifdef STRETCHED
flat out float rise;
#endif
#ifdef FACING
flat out vec3 to_eye, toward;
flat out vec2 slant;
#endif
#if defined(OBLIQUE) && !defined(FACING)
flat out float oblique;
#endif
#ifdef FOG
out vec3 away_m;
#endif
#ifdef SHADOWED
out vec3 world_m;
flat out float within_m;
#endif

struct quad {
    uint tree;
    float slice;
    uint low, high;  // left, bottom; right, top: half texels plus 1, 16 bits each
};
layout(std430, binding = 1) readonly buffer quads_buffer { quad quads[]; };
#ifdef BENT
struct bend {
    vec4 corners[8];
};
layout(std430, binding = 2) readonly buffer bends_buffer { bend bends[]; };
#endif
uniform int first_quad;
uniform vec2 layer_px;
out vec3 place;  // texture coordinates, layer

void main()
{
    quad q = quads[first_quad + gl_VertexID / 4];
    tree t = trees[q.tree];
    int corner = gl_VertexID & 3;
    uvec2 texels = uvec2(corner == 1 || corner == 2 ? q.high & 0xffffu : q.low & 0xffffu,
                         corner >= 2 ? q.high >> 16 : q.low >> 16);
    vec2 at = (vec2(texels) - 1.0) * 0.5 / layer_px;
    vec3 world = t.base_layer.xyz + at.x * t.u_step.xyz + at.y * t.v_count.xyz + (q.slice + 0.5) * t.w_level.xyz;
#ifdef BENT
    float depth = (q.slice + 0.5) / t.v_count.w;
    vec3 sides[4];
    for (int k = 0; k < 4; k++)
        sides[k] = mix(bends[q.tree].corners[k].xyz, bends[q.tree].corners[k + 4].xyz, depth);
    world += mix(mix(sides[0], sides[1], at.x), mix(sides[2], sides[3], at.x), at.y);
#endif
    place = vec3(at, t.base_layer.w + t.u_step.w * q.slice);
#ifdef FOG
    away_m = world - eye_m;
#endif
#ifdef SHADOWED
    world_m = world;
    within_m = 0.5 * abs(dot(t.w_level.xyz, sun_direction)) + length(t.u_step.xyz) / layer_px.x;
#endif
    gl_Position = view_projection * vec4(world, 1.0);
    level = t.w_level.w;
    leaf_light = t.leaf_power.xyz;
    bark_light = t.bark_albedo.xyz;
    power_albedo = vec2(t.leaf_power.w, t.bark_albedo.w);
#ifdef STRETCHED
    rise = t.eye.w;
#endif
#ifdef FACING
    to_eye = t.eye.xyz;
    toward = t.toward_array.xyz;
    slant = vec2(0.8 * (dot(to_eye, to_eye) - 1.0), length(to_eye));
#endif
#if defined(OBLIQUE) && !defined(FACING)
    oblique = min(length(t.eye.xyz) - 1.0, 1.0);
#endif
}

#pragma stage fragment
layout(binding = 0) uniform sampler2DArray color_map;   // albedo x coverage (STRAIGHT: albedo), coverage
layout(binding = 1) uniform sampler2DArray normal_map;  // 128 is 0; share of leaf; LIT, SHADOWED: colours in the shade
flat in float level;
flat in vec3 leaf_light, bark_light;
flat in vec2 power_albedo;
#ifdef STRETCHED
flat in float rise;  // of normals: 1 / stretch
#endif
#ifdef FACING
flat in vec3 to_eye, toward;
flat in vec2 slant;  // of to_eye: 0.8 times the square of its part across toward; its length, 1 / cosine
#endif
#if defined(OBLIQUE) && !defined(FACING)
flat in float oblique;  // 1 / cosine - 1
#endif
#ifdef FOG
in vec3 away_m;
#endif
#ifdef SHADOWED
in vec3 world_m;
flat in float within_m;  // that a place in a slice is known to
#endif
in vec3 place;
layout(location = 0) out vec4 color;

#ifdef TRILINEAR
#define FETCH(map, at) texture(map, at)
#else
#define FETCH(map, at) textureLod(map, at, level)
#endif

// Of a texel at a slice between two: INTERPOLATE mixes them (Rezk-Salama et al. 2000).
vec4 fetch_from(sampler2DArray map, vec3 at)
{
#ifdef INTERPOLATE
    vec3 below = vec3(at.xy, floor(at.z));
    return mix(FETCH(map, below), FETCH(map, below + vec3(0.0, 0.0, 1.0)), at.z - below.z);
#else
    return FETCH(map, at);
#endif
}

vec4 fetch_color(vec3 at)
{
    vec4 texel = fetch_from(color_map, at);
#ifdef STRAIGHT
    texel.rgb *= texel.a;
#endif
    return texel;
}

vec4 fetch_normal(vec3 at)
{
    vec4 texel = fetch_from(normal_map, at);
    return vec4(texel.xyz * (255.0 / 127.0) - 128.0 / 127.0, texel.w);
}

// Mean of |N.L| (two-sided leaves) or max(0, N.L) over the normals of a texel, of which the mean n is known. ROUGH: the
// square of N.L has the mean (n.L)^2 + (1 - n.n) / 4.5, which is right where all N are n and where they lie on all
// sides of a hemisphere; max(0, x) = (x + |x|) / 2.
//
// STRETCHED: a normal N of the plant is D N / |D N| in the tree, D = diag(1, 1 / stretch, 1). leaf_light and bark_light
// hold D L, so that N.(D L) = (D N).L; what is left is to divide by |D N|. Where normals scatter, about their mean in
// every direction alike, the mean of |D N|^2 is |D n|^2 + (1 - n.n) (2 + 1 / stretch^2) / 3, that of the scatter's share
// of ((D N).L)^2 grows by |D L|^2.
float light_of(vec4 n)
{
    vec3 light = mix(bark_light, leaf_light, n.w);
    float along = dot(n.xyz, light);
    float scatter = max(1.0 - dot(n.xyz, n.xyz), 0.0);
#ifdef STRETCHED
    vec3 tall = vec3(n.x, n.y * rise, n.z);
    float square = max(dot(tall, tall) + scatter * (2.0 + rise * rise) / 3.0, 1e-6);
    along *= inversesqrt(square);
    scatter *= dot(leaf_light, leaf_light) / square;
#endif
#ifdef ROUGH
    float size = sqrt(along * along + scatter / 4.5);
#else
    float size = abs(along);
#endif
    return mix(0.5 * (along + size), size, two_sided ? n.w : 0.0);
}

#ifdef FACING
// How much of its area a leaf turns to the eye, against what it turns to the front of the slices and they to the eye.
// Of normals that scatter, the root mean square. OBLIQUE: n is the mean of those seen from the front, each weighted by
// the area that it turns there. With S the mean of N N' over leaves, S toward is along n, and the area turned to e about
// sqrt(e'S e) (Heitz et al. 2015: SGGX); what n does not tell is taken as the same in all directions across toward. Its
// weight 0.8 (1 - n.n) is right where all N are n and where they are isotropic (n = 2/3 toward: 4/9); the area is then 1
// and 1 / cosine, the longer way through the slice.
float facing_of(vec4 n)
{
    float to_front = dot(n.xyz, toward), turned = dot(n.xyz, to_eye);
#ifdef OBLIQUE
    float scatter = max(1.0 - dot(n.xyz, n.xyz), 0.0);
    float area = sqrt((turned * turned + scatter * slant.x + 0.01) / (to_front * to_front + 0.01));
    return mix(slant.y, min(area, 5.0), n.w);
#else
    float scatter = max(1.0 - dot(n.xyz, n.xyz), 0.0) / 4.5 + 0.01;
    float area = sqrt((turned * turned + scatter * dot(to_eye, to_eye)) / (to_front * to_front + scatter));
    return mix(1.0, min(area, 3.0), n.w);
#endif
}
#endif

void main()
{
    vec4 texel = fetch_color(place);
#ifdef SHADOWED
    sun_visibility = shadow_visibility_within(world_m, within_m);
#ifdef LIT
    vec3 shaded = fetch_from(normal_map, place).rgb;
#ifdef STRAIGHT
    shaded *= texel.a;
#endif
    texel.rgb = mix(shaded, texel.rgb, sun_visibility);
#endif
#endif
#ifndef LIT
    vec4 normal = fetch_normal(place);
#endif
#ifdef FACING
    float area = facing_of(normal);
#ifdef OBLIQUE
    // A leaf that fills its texel cannot show more than all, and if it showed less where it turns away, a crown of such
    // leaves would be too thin: it stays as it is, and one that fills a part loses less by that.
    area = max(area, mix(area, 1.0, texel.a * texel.a));
#endif
    texel *= min(area, 1.0 / max(texel.a, 1e-6));
#endif
#if defined(OBLIQUE) && !defined(FACING)
    // (1 - a)^(q + 1), q in 0..1, by three terms of the series of (1 - a)^q
    texel *= 1.0 + oblique * (1.0 - texel.a) * (1.0 + 0.5 * (1.0 - oblique) * texel.a);
#endif
#ifdef POWER
    // the last 1/256 of transmittance is kept, so that what is opaque can fade, too
    float thin = 1.0 - pow(1.0 - min(texel.a, 0.996), power_albedo.x);
    texel *= thin / max(min(texel.a, 0.996), 1e-6);
#endif
#ifdef LIT
    color = vec4(texel.rgb * power_albedo.y, texel.a);
#else
    float lit = light_of(normal);
    color = vec4(texel.rgb * (lit * sun_visibility * sun_radiance + ambient) * power_albedo.y, texel.a);
#endif
#ifdef SHADOWED
    if (masked)
#ifdef LIT
        color.rgb = vec3(sun_visibility, 1.0, 0.0) * texel.a;
#else
        color.rgb = vec3(lit > 0.0 ? sun_visibility : 0.0, 1.0, 0.0) * texel.a;
#endif
#endif
#ifdef FOG
    color.rgb = mix(fog_color * color.a, color.rgb, exp(-fog_density * length(away_m)));
#endif
}
