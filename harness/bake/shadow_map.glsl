// Receives a shadow map: shadow_visibility(). Stands before a receiver's stages. BIAS: 0 none, 1 constant, 2 by slope,
// 3 receiver plane, 4 along the normal. RADIUS: (2 RADIUS + 1)^2 taps. LINEAR: taps are bilinear. LAYERS: 0 a depth is
// solid, else the map holds the share of a texel that is covered to so many depths behind the first. SHARED: what is
// near is another's. ELSEWHERE: there is no map, all is another's.
#ifdef ELSEWHERE
uniform float shadow_lit;
#define SHADOW_VISIBILITY(position, normal) shadow_lit

float shadow_visibility(vec3 position_m, vec3 normal)
{
    return shadow_lit;
}

float shadow_visibility_within(vec3 position_m, float within_m)
{
    return shadow_lit;
}
#else
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
uniform vec3 shadow_share;      // SHARED: nearer than x m, deep, lit is what z is; from y m on the map says it

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

// For fragment stages: of what the pixel shows of a triangle.
#define SHADOW_VISIBILITY(position, normal) shadow_of_pixel(position, normal, dFdx(position), dFdy(position))

// The normal that a bias needs, of the triangle that is drawn: a smooth one may be flatter to the sun than the triangle
// is, which then shades itself. Where pixels are too small for float positions, the smooth normal.
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

// The filter about a place in the map: so many taps along its sides, and from tap to tap these steps.
struct ShadowFilter {
    ivec2 taps;
    mat2x3 steps;
};

// Taps a texel apart; slope: depth a texel, of the receiver's plane.
ShadowFilter shadow_filter_of(vec2 slope)
{
    return ShadowFilter(ivec2(2 * RADIUS + 1),
                        mat2x3(vec3(1.0 / shadow_size, 0.0, slope.x), vec3(0.0, 1.0 / shadow_size, slope.y)));
}

float shadow_filtered(int cascade, vec3 at, ShadowFilter f)
{
    vec3 first = at - f.steps * (0.5 * vec2(f.taps - 1));
    float sum = 0.0;
    for (int y = 0; y < f.taps.y; y++)
        for (int x = 0; x < f.taps.x; x++) {
            vec3 tap = first + f.steps * vec2(x, y);
            sum += shadow_tap(cascade, tap.xy, clamp(tap.z, 0.0, 1.0), shadow_texel[cascade].z);
        }
    return sum / float(f.taps.x * f.taps.y);
}

// Where a pixel reaches over more texels than the filter, taps stand all over the pixel, each at its own depth, two
// texels apart or, in large pixels, farther, since texels that no tap looks at make a finer map worse than a coarse
// one. right, down: a pixel's, m; of a surface that is seen along itself three times the other at most.
ShadowFilter shadow_spread(int cascade, vec3 position_m, vec3 right_m, vec3 down_m, ShadowFilter f)
{
    const float least = float(2 * RADIUS + 1), most = max(least, 8.0);
    vec2 along_m = vec2(length(right_m), length(down_m));
    vec2 kept = min(vec2(1.0), 3.0 * along_m.yx / max(along_m, 1e-20));
    vec3 at = shadow_place(cascade, position_m);
    mat2x3 pixel = mat2x3(shadow_place(cascade, position_m + kept.x * right_m) - at,
                          shadow_place(cascade, position_m + kept.y * down_m) - at);
    vec2 texels = vec2(length(pixel[0].xy), length(pixel[1].xy)) * shadow_size;
    if (max(texels.x, texels.y) <= least)
        return f;
    vec2 wanted = max(texels, vec2(least)) / max(texels, vec2(1e-6));  // not closer than a texel either way
    vec2 taps = clamp(ceil(0.5 * texels), least, most);
    return ShadowFilter(ivec2(taps), mat2x3(pixel[0] * (wanted.x / taps.x), pixel[1] * (wanted.y / taps.y)));
}

// Of a place that is known to within_m, among matter without a surface of its own: a slice's, a picture's.
float shadow_visibility_within(vec3 position_m, float within_m)
{
    int cascade = shadow_cascade(position_m);
    vec3 at = shadow_place(cascade, position_m + within_m * sun_direction);
    return shadow_is_outside(at) ? 1.0 : shadow_filtered(cascade, at - vec3(0.0, 0.0, shadow_step), shadow_filter_of(vec2(0.0)));
}

// right, down: a pixel's, m; 0: unknown
float shadow_of_map(vec3 position_m, vec3 normal, vec3 right_m, vec3 down_m)
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
    ShadowFilter f = shadow_filter_of(BIAS == 3 ? shadow_bias * slope : vec2(0.0));
#if RADIUS > 0
    f = shadow_spread(cascade, position_m, right_m, down_m, f);
#endif
    return shadow_filtered(cascade, at, f);
}

float shadow_shared(vec3 position_m, vec3 normal, vec3 right_m, vec3 down_m)
{
#ifdef SHARED
    float depth_m = dot(position_m - eye_m, shadow_forward);
    float share = clamp((depth_m - shadow_share.x) / (shadow_share.y - shadow_share.x), 0.0, 1.0);
    if (share <= 0.0)
        return shadow_share.z;
    return mix(shadow_share.z, shadow_of_map(position_m, normal, right_m, down_m), share);
#else
    return shadow_of_map(position_m, normal, right_m, down_m);
#endif
}

// normal need not be unit
float shadow_visibility(vec3 position_m, vec3 normal)
{
    return shadow_shared(position_m, normal, vec3(0.0), vec3(0.0));
}

float shadow_of_pixel(vec3 position_m, vec3 smooth_normal, vec3 right_m, vec3 down_m)
{
    return shadow_shared(position_m, shadow_facet(right_m, down_m, position_m, smooth_normal), right_m, down_m);
}
#endif
