// Pictures of a plant for the atlas: colour, kind, normal and depth of the sample that is seen. Orthographic.
uniform vec3 plane_right, plane_up, plane_toward;
uniform vec3 center_m;
uniform vec4 window;     // clip = (s, t) * window.xy + window.zw
uniform float radius_m;  // depths lie in [-radius_m, radius_m]
uniform vec3 material_albedo;
uniform float kind;      // 1 leaf, 2 bark or needle
uniform bool has_color, has_texture;

#pragma stage vertex
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec3 color;
layout(location = 3) in vec2 uv;
out vec3 plane_normal, tint;
out vec2 texture_uv;
out float depth;

void main()
{
    vec3 p = position - center_m;
    plane_normal = vec3(dot(normal, plane_right), dot(normal, plane_up), dot(normal, plane_toward));
    tint = has_color ? color * material_albedo : material_albedo;
    texture_uv = uv;
    depth = dot(p, plane_toward);
    vec2 st = vec2(dot(p, plane_right), dot(p, plane_up));
    gl_Position = vec4(st * window.xy + window.zw, -0.999 * depth / radius_m, 1.0);
}

#pragma stage fragment
layout(binding = 0) uniform sampler2D leaf_texture;
in vec3 plane_normal, tint;
in vec2 texture_uv;
in float depth;
layout(location = 0) out vec4 color_kind;
layout(location = 1) out vec4 normal_depth;

void main()
{
    vec4 texel = has_texture ? textureLod(leaf_texture, texture_uv, 0.0) : vec4(1.0);
    if (texel.a < 0.5)
        discard;
    vec3 n = normalize(plane_normal);
    color_kind = vec4(tint * texel.rgb, kind);
    normal_depth = vec4(gl_FrontFacing ? n : -n, depth);
}
