// Shadow volumes, and the trees that cast them. TREES: triangles in the world with their light, TEXTURED:
// alpha-tested, FOG: with fog, SHADOWED: behind shadow_map.glsl; else boundaries of volumes, or, WHOLE, one triangle
// over the picture, which write nothing but the stencil.
#pragma stage vertex
#ifdef TREES
layout(location = 0) in vec3 position;
layout(location = 1) in vec4 normal;  // w: 1 leaf, 0 bark
layout(location = 2) in vec4 albedo;
#if defined(FOG) || defined(SHADOWED)
centroid out vec3 position_m;
#endif
centroid out vec3 shading_normal;
centroid out vec4 surface_albedo;  // w: 1 leaf, 0 bark
#ifdef TEXTURED
layout(location = 3) in vec2 uv;
sample out vec2 texture_uv;
#endif

void main()
{
#if defined(FOG) || defined(SHADOWED)
    position_m = position;
#endif
    shading_normal = normal.xyz;
    surface_albedo = vec4(albedo.rgb, normal.w);
#ifdef TEXTURED
    texture_uv = uv;
#endif
    gl_Position = view_projection * vec4(position, 1.0);
}
#elif defined(WHOLE)
uniform float depth;  // in clip space

void main()
{
    gl_Position = vec4(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0, depth, 1.0);
}
#else
layout(location = 0) in vec4 position;  // w: 1, or 0 at infinity; points, then the ends of their walls
uniform int points;
uniform bool endless;  // all ends are at infinity
uniform vec3 away;     // from the sun
uniform float deep_m;  // what is deeper is dropped; 0: nothing
uniform vec3 behind;   // volumes begin so far behind what casts: m, or m at a depth of 1 m; more, m at 1 m, by its square

void main()
{
    vec4 at = endless && gl_VertexID >= points ? vec4(away, 0.0) : position;
    // the very expression that surfaces are drawn with, so that a cap has its surface's depth
    vec4 near = view_projection * vec4(at.xyz, 1.0);
    if (behind.x > 0.0 && gl_VertexID < points)
        near = view_projection *
               vec4(at.xyz + away * (max(behind.x, behind.y * near.w) + behind.z * near.w * near.w), 1.0);
    gl_Position = at.w > 0.0 ? near : view_projection * vec4(at.xyz, 0.0);
    gl_ClipDistance[0] = deep_m > 0.0 ? deep_m * at.w - gl_Position.w : 0.0;
}
#endif

#pragma stage fragment
#ifdef TREES
layout(location = 0) out vec4 color;
#if defined(FOG) || defined(SHADOWED)
centroid in vec3 position_m;
#endif
centroid in vec3 shading_normal;
centroid in vec4 surface_albedo;
#ifdef TEXTURED
sample in vec2 texture_uv;
layout(binding = 0) uniform sampler2D picture;
#endif

void main()
{
    vec3 a = surface_albedo.rgb;
#ifdef TEXTURED
    vec4 texel = texture(picture, texture_uv);
    if (texel.a < 0.5)
        discard;
    a *= texel.rgb;
#endif
#ifdef SHADOWED
    sun_visibility = SHADOW_VISIBILITY(position_m, shading_normal);
#endif
    vec3 lit = surface_albedo.w > 0.5 ? shade_leaf(a, shading_normal, gl_FrontFacing)
                         : shade_bark(a, shading_normal, gl_FrontFacing);
#ifdef FOG
    lit = shade_fog(lit, position_m);
#endif
    color = vec4(lit, 1.0);
}
#else
void main()
{
}
#endif
