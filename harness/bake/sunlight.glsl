// The sun through a forest and over its terrain, as harness/bake/shadow_light.h has it: SHADOW_VISIBILITY(). Stands
// before a receiver's stages. BENT: the terrain shades.
layout(binding = 6) uniform usamplerBuffer sun_map;     // a texel's four boxes: first depth 16 bits, length 8, optical 8
layout(binding = 5) uniform samplerBuffer sun_terrain;  // BENT: of each sample, the height below which it is dark
layout(binding = 7) uniform sampler2D sun_above;        // shares of the sun on the ground; beyond it is lit
uniform vec3 sun_above_place;  // its low corner along x and z, m; cells a metre, 0: there is none
uniform vec2 sun_above_size;   // cells
uniform mat3 sun_axes;         // right, up, down along the light
uniform vec3 sun_low;          // of the map, along them, m
uniform vec3 sun_per_m;        // texels and depths
uniform ivec2 sun_size;        // of the map
uniform vec3 sun_ground_m;     // the terrain along x and z; its lowest height
uniform ivec2 sun_samples;     // the terrain's

#define SHADOW_VISIBILITY(position, normal) \
    sun_on_ground(position, dFdx((position).xz), dFdy((position).xz))

// Optical depth of a texel above a depth.
float sun_hidden(ivec2 texel, float depth)
{
    if (any(lessThan(texel, ivec2(0))) || any(greaterThanEqual(texel, sun_size)))
        return 0.0;
    uvec4 boxes = texelFetch(sun_map, texel.y * sun_size.x + texel.x);
    vec4 share = (depth - vec4(boxes & 65535u)) / max(vec4(boxes >> 16 & 255u), 1.0);
    return dot(vec4(boxes >> 24), clamp(share, 0.0, 1.0)) / 32.0;
}

float sun_through_trees(vec3 position_m)
{
    vec3 place = (position_m * sun_axes - sun_low) * sun_per_m;
    vec2 at = place.xy - 0.5, low = floor(at), share = at - low;
    if (!(all(greaterThan(at, vec2(-1.0))) && all(lessThan(at, vec2(sun_size)))))
        return 1.0;
    vec4 hidden;
    for (int corner = 0; corner < 4; corner++)
        hidden[corner] = sun_hidden(ivec2(low) + ivec2(corner & 1, corner >> 1), place.z);
    vec4 pass = exp(-hidden);
    vec2 across = mix(pass.xz, pass.yw, share.x);
    return mix(across.x, across.y, share.y);
}

#ifdef BENT
bool sun_is_behind_terrain(vec3 position_m)
{
    vec2 last = vec2(sun_samples - 1);
    vec2 at = clamp((position_m.xz / sun_ground_m.xy + 0.5) * last, vec2(0.0), last);
    ivec2 low = min(ivec2(at), sun_samples - 2);
    vec2 share = at - vec2(low);
    int first = low.y * sun_samples.x + low.x;
    vec2 near = vec2(texelFetch(sun_terrain, first).r, texelFetch(sun_terrain, first + 1).r);
    first += sun_samples.x;
    vec2 far = vec2(texelFetch(sun_terrain, first).r, texelFetch(sun_terrain, first + 1).r);
    vec2 along = mix(near, far, share.y);
    return position_m.y < mix(along.x, along.y, share.x);
}
#endif

// A sun below the horizon shines from below the terrain's lowest height, past its borders.
bool sun_is_underground(vec3 position_m)
{
    vec2 there = position_m.xz + (sun_ground_m.z - position_m.y) / sun_direction.y * sun_direction.xz;
    return all(lessThanEqual(abs(there), 0.5 * sun_ground_m.xy));
}

float sun_light_at(vec3 position_m)
{
    if (sun_direction.y < 0.0) {
        if (sun_is_underground(position_m))
            return 0.0;
#ifdef BENT
    } else if (sun_is_behind_terrain(position_m)) {
        return 0.0;
#endif
    }
    return sun_through_trees(position_m);
}

// Mean over a pixel's footprint, as shadow_ground_at() has it: places along it, each from the level that is as wide.
// right, down: what the place is moved by, one pixel on, along x and z.
float sun_on_ground(vec3 position_m, vec2 right_m, vec2 down_m)
{
    const float places_max = 16.0, blended = 0.7;
    vec2 at = (position_m.xz - sun_above_place.xy) * sun_above_place.z;
    vec2 way = (dot(right_m, right_m) > dot(down_m, down_m) ? right_m : down_m) * sun_above_place.z;
    vec2 reach = (abs(right_m) + abs(down_m)) * sun_above_place.z;
    if (sun_above_place.z == 0.0 || any(lessThan(at + reach, vec2(0.0))) ||
        any(greaterThan(at - reach, sun_above_size)))
        return sun_light_at(position_m);
    float cells = max(length(way), 1e-6);
    float wide = abs(determinant(mat2(right_m, down_m))) * sun_above_place.z * sun_above_place.z / cells;
    float places = clamp(ceil(cells / max(wide, 1.0)), 1.0, places_max);
    float level = log2(blended * max(wide, cells / places) + 1e-6), sum = 0.0;
    vec2 size = vec2(textureSize(sun_above, 0));
    if (places == 1.0 && level <= -1.0)
        return sun_light_at(position_m);
    if (places == 1.0) {
        float mean = textureLod(sun_above, at / size, max(level, 0.0)).r;
        return level < 0.0 ? mix(sun_light_at(position_m), mean, 1.0 + level) : mean;
    }
    // nothing shades the four cells that hold all of it
    if (textureLod(sun_above, at / size, max(ceil(log2(cells + 2.0 * wide)), 0.0)).r == 1.0)
        return 1.0;
    level = floor(max(level, 0.0) + 0.5);
    for (float place = 0.5; place < places; place++)
        sum += textureLod(sun_above, (at + way * (place / places - 0.5)) / size, level).r;
    return sum / places;
}
