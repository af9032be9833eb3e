// The sun through a forest and over its terrain, as harness/bake/shadow_light.h has it: SHADOW_VISIBILITY(). Stands
// before a receiver's stages. BENT: the terrain shades.
layout(binding = 6) uniform usamplerBuffer sun_map;     // a texel's four boxes: first depth 16 bits, length 8, optical 8
layout(binding = 5) uniform samplerBuffer sun_terrain;  // BENT: of each sample, the height below which it is dark
uniform mat3 sun_axes;         // right, up, down along the light
uniform vec3 sun_low;          // of the map, along them, m
uniform vec3 sun_per_m;        // texels and depths
uniform ivec2 sun_size;        // of the map
uniform vec3 sun_ground_m;     // the terrain along x and z; its lowest height
uniform ivec2 sun_samples;     // the terrain's

#define SHADOW_VISIBILITY(position, normal) sun_light_at(position)

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
