// Triangles of plants, instanced. Variants:
// PRUNED: the elements of a far tree; they grow as they get fewer, and shrink away at the end of the run.
// SIFTED: triangles of any tree, in the world already.
// TEXTURED: alpha-tested. LEAF: leaf shading, else bark. LIT_AT_VERTICES: flat triangles of one colour, shaded before
// they are rasterised. FOG: with fog. SHADOWED: behind shadow_map.glsl.
#ifdef FOG
#define RADIANCE centroid
#else
#define RADIANCE flat
#endif
#pragma stage vertex
layout(location = 0) in vec3 position;
layout(location = 1) in vec4 normal;  // w: of pruned elements, 1 leaf, -1 needle, 0 bark; SIFTED: (the tree's first mean + leaf, + 8192 of a needle) / 32767
layout(location = 2) in vec4 albedo;  // w: SIFTED, 1 / growth; PRUNED, of bark, its width
#ifdef TEXTURED
layout(location = 3) in vec2 uv;
sample out vec2 texture_uv;
#endif
#ifndef SIFTED
layout(location = 5) in vec4 place;  // foot, m; scale
layout(location = 6) in vec4 turn;   // cosine, sine; elements of the run, their growth
layout(location = 8) in vec2 shape;  // stretch; the tree's first mean
#endif
// A rasteriser of small triangles spends much of its time on setting up what is interpolated: as little as may be.
#ifdef LIT_AT_VERTICES
RADIANCE out vec3 radiance;
#else
centroid out vec3 shading_normal;
centroid out vec3 surface_albedo;
#if defined(FOG) || defined(SHADOWED)
centroid out vec3 position_m;
#endif
#endif
#ifdef PRUNED
layout(location = 4) in vec3 center;
layout(location = 7) in vec2 run;  // its first element; the width from which on bark is drawn whole
uniform float elements;            // of the plant
uniform float taper;               // share of the run that is shrinking
#endif
uniform vec3 mean[2 * MEANS];  // bark and leaves of each species, lit, over the plant, of each step of stretch
#ifdef SHADOWED
uniform vec3 shaded_mean[2 * MEANS];  // the same out of the sun
#endif
uniform bool level_contrast;

void main()
{
    vec3 local = position;
#ifdef PRUNED
    float rank = float(gl_VertexID / 3) - run.x;
    rank += rank < 0.0 ? elements : 0.0;
    float keep = taper > 0.0 ? clamp((turn.z - rank - 0.5) / (taper * turn.z), 0.0, 1.0) : 1.0;
    bool leaf = abs(normal.w) > 0.5, thin = normal.w > 0.5;
    float grow = turn.w;
    keep = leaf || albedo.w < run.y ? keep : 0.0;
    local = center + (position - center) * (grow * keep);
#elif defined(SIFTED)
    int owner = int(round(normal.w * 32767.0));
    bool thin = (owner & 8193) == 1;
    owner &= 8191;
#elif defined(LEAF)
    const bool thin = true;
#else
    const bool thin = false;
#endif
#ifdef SIFTED
    vec3 world = position;
    vec3 n = normal.xyz;
#else
    vec3 world = place.xyz + place.w * rotate_y(vec3(local.x, local.y * shape.x, local.z), turn.x, turn.y);
    vec3 n = rotate_y(vec3(normal.x, normal.y / shape.x, normal.z), turn.x, turn.y);
#endif
#ifdef LIT_AT_VERTICES
    bool facing = dot(n, eye_m - world) >= 0.0;  // the same at every point of a flat triangle
#ifdef SHADOWED
    sun_visibility = shadow_visibility(world, n);
#endif
    vec3 lit = thin ? shade_leaf(albedo.rgb, n, facing) : shade_bark(albedo.rgb, n, facing);
    // One element stands for grow^2: the mean of so many varies grow times less (Cook et al. 2007, 3.3).
#if defined(PRUNED)
    int of = int(shape.y) + (leaf ? 1 : 0);
#ifdef SHADOWED
    vec3 others = mix(shaded_mean[of], mean[of], sun_visibility);
#else
    vec3 others = mean[of];
#endif
    if (level_contrast)
        lit = mix(others, lit, min(1.0, 1.0 / grow));
#elif defined(SIFTED)
    if (level_contrast && albedo.w < 1.0)
        lit = mix(mean[owner], lit, albedo.w);
#endif
    radiance = lit;
#ifdef FOG
    radiance = shade_fog(lit, world);
#endif
#else
    shading_normal = n;
    surface_albedo = albedo.rgb;
#if defined(FOG) || defined(SHADOWED)
    position_m = world;
#endif
#endif
#ifdef TEXTURED
    texture_uv = uv;
#endif
    gl_Position = view_projection * vec4(world, 1.0);
}

#pragma stage fragment
layout(location = 0) out vec4 color;
#if defined(LIT_AT_VERTICES)
RADIANCE in vec3 radiance;

void main()
{
    color = vec4(radiance, 1.0);
}
#else
centroid in vec3 shading_normal;
centroid in vec3 surface_albedo;
#if defined(FOG) || defined(SHADOWED)
centroid in vec3 position_m;
#endif
#ifdef TEXTURED
sample in vec2 texture_uv;  // each sample of a pixel tests its own texel
layout(binding = 0) uniform sampler2D picture;
#endif

void main()
{
    vec3 a = surface_albedo;
#ifdef TEXTURED
    vec4 texel = texture(picture, texture_uv);
    if (texel.a < 0.5)
        discard;
    a *= texel.rgb;
#endif
#ifdef SHADOWED
    sun_visibility = SHADOW_VISIBILITY(position_m, shading_normal);
#endif
#ifdef LEAF
    vec3 lit = shade_leaf(a, shading_normal, gl_FrontFacing);
#else
    vec3 lit = shade_bark(a, shading_normal, gl_FrontFacing);
#endif
#ifdef FOG
    lit = shade_fog(lit, position_m);
#endif
    color = vec4(lit, 1.0);
}
#endif
