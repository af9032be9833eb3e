// Receives a shadow map: shadow_visibility(). Stands before a receiver's stages. BIAS: 0 none, 1 constant, 2 by slope,
// 3 receiver plane, 4 along the normal. RADIUS: (2 RADIUS + 1)^2 taps. LINEAR: taps are bilinear. LAYERS: 0 a depth is
// solid, else the map holds the share of a texel that is covered to so many depths behind the first.
layout(binding = 6) uniform sampler2DArrayShadow shadow_maps;
#if LAYERS > 0
layout(binding = 5) uniform sampler2DArray shadow_first;
layout(binding = 4) uniform sampler2DArray shadow_layers;
#endif
uniform mat4 shadow_matrix[4];  // to texture space
uniform vec3 shadow_texel[4];   // across, along, m; range of depth, m
uniform vec4 shadow_ends;       // of the cascades, depth along the view, m
uniform vec3 shadow_forward;
uniform int shadow_cascades;
uniform float shadow_bias;      // times what the closed form asks for
uniform float shadow_size;      // texels a side
uniform float shadow_step;      // of stored depths
uniform float shadow_layer_m;

vec3 shadow_place(int cascade, vec3 position_m)
{
    vec4 at = shadow_matrix[cascade] * vec4(position_m, 1.0);
    return at.xyz / at.w;
}

#if LAYERS > 0
float shadow_tap(int cascade, vec2 uv, float depth, float range_m)
{
    ivec3 at = ivec3(clamp(ivec2(uv * shadow_size), ivec2(0), ivec2(shadow_size) - 1), cascade);
    float behind = (depth - texelFetch(shadow_first, at, 0).r) * range_m;
    if (behind <= 0.0)
        return 1.0;
    vec4 covered = texelFetch(shadow_layers, at, 0);
#if LAYERS == 1
    return 1.0 - covered.r;
#else
    float layer = min(behind / shadow_layer_m, 4.0);
    float low = layer < 1.0 ? 0.0 : covered[int(layer) - 1];
    return 1.0 - mix(low, covered[min(int(layer), 3)], fract(layer));
#endif
}
#else
float shadow_tap(int cascade, vec2 uv, float depth, float range_m)
{
    return texture(shadow_maps, vec4(uv, float(cascade), depth));
}
#endif

// The normal that a bias needs, of the triangle that is drawn: a smooth one may be flatter to the sun than the triangle
// is, which then shades itself. For fragment stages; where pixels are too small for float positions, the smooth normal.
#define SHADOW_FACET(position, smooth_normal) shadow_facet(dFdx(position), dFdy(position), position, smooth_normal)
vec3 shadow_facet(vec3 right, vec3 down, vec3 position, vec3 smooth_normal)
{
    vec3 facet = cross(right, down);
    float least = 4e-5 * length(position);
    return length(facet) > least * max(length(right), length(down)) ? facet : smooth_normal;
}

int shadow_cascade(vec3 position_m)
{
    float depth_m = dot(position_m - eye_m, shadow_forward);
    int cascade = 0;
    while (cascade < shadow_cascades - 1 && depth_m > shadow_ends[cascade])
        cascade++;
    return cascade;
}

bool shadow_is_outside(vec3 at)
{
    return any(lessThan(at.xy, vec2(0.0))) || any(greaterThan(at.xy, vec2(1.0)));
}

// The filter about a place in the map; slope: depth a texel, of the receiver's plane.
float shadow_filter(int cascade, vec3 at, vec2 slope)
{
    float sum = 0.0;
    for (int y = -RADIUS; y <= RADIUS; y++)
        for (int x = -RADIUS; x <= RADIUS; x++) {
            float depth = at.z + slope.x * float(x) + slope.y * float(y);
            sum += shadow_tap(cascade, at.xy + vec2(x, y) / shadow_size, clamp(depth, 0.0, 1.0), shadow_texel[cascade].z);
        }
    return sum / float((2 * RADIUS + 1) * (2 * RADIUS + 1));
}

// Of a place that is known to within_m, among matter without a surface of its own: a slice's, a picture's.
float shadow_visibility_within(vec3 position_m, float within_m)
{
    int cascade = shadow_cascade(position_m);
    vec3 at = shadow_place(cascade, position_m + within_m * sun_direction);
    return shadow_is_outside(at) ? 1.0 : shadow_filter(cascade, at - vec3(0.0, 0.0, shadow_step), vec2(0.0));
}

// normal need not be unit
float shadow_visibility(vec3 position_m, vec3 normal)
{
    int cascade = shadow_cascade(position_m);
    const float reach = float(RADIUS) + (LINEAR == 1 ? 1.0 : 0.5);
    vec3 texel = shadow_texel[cascade];
    vec3 n = normalize(normal);
    float cosine = dot(n, sun_direction);
    float sine = sqrt(max(0.0, 1.0 - cosine * cosine));
    float side = cosine < 0.0 ? -1.0 : 1.0;
#if BIAS == 4
    position_m += side * n * (shadow_bias * reach * 1.4142136 * max(texel.x, texel.y) * sine);
#endif
    vec3 at = shadow_place(cascade, position_m);
    if (shadow_is_outside(at))
        return 1.0;
    float bias = BIAS == 0 ? 0.0 : shadow_step;
    vec2 slope = vec2(0.0);  // depth a texel, of the receiver's plane
#if BIAS == 1
    bias += shadow_bias * reach * 1.4142136 * max(texel.x, texel.y) / texel.z;  // enough for 45 degrees
#elif BIAS == 2 || BIAS == 3
    vec3 first = abs(n.y) < 0.9 ? normalize(vec3(n.z, 0.0, -n.x)) : normalize(vec3(0.0, -n.z, n.y));
    float pace = texel.x;
    vec3 a = (shadow_place(cascade, position_m + pace * first) - at) * vec3(vec2(shadow_size), 1.0);
    vec3 b = (shadow_place(cascade, position_m + pace * cross(n, first)) - at) * vec3(vec2(shadow_size), 1.0);
    float area = a.x * b.y - a.y * b.x;
    slope = abs(area) > 1e-6 ? vec2(b.y * a.z - a.y * b.z, a.x * b.z - b.x * a.z) / area : vec2(0.0);
    vec2 most = 20.0 * texel.xy / texel.z;  // 87 degrees; steeper is as good as unlit
    slope = clamp(slope, -most, most);
    float within = BIAS == 3 ? reach - float(RADIUS) : reach;
    bias += shadow_bias * within * (abs(slope.x) + abs(slope.y));
#endif
    at.z -= bias;
    return shadow_filter(cascade, at, BIAS == 3 ? shadow_bias * slope : vec2(0.0));
}
