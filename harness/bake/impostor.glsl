// What impostors share: trees, pictures and light of the atlas (harness/bake/atlas.h), coverage, fog. A method adds its
// vertex stage. VIEWS pictures are mixed in a fragment; CORNERS is 3, 4 or 8. LAYOUT: of the pictures, where the nearest
// are chosen; 0 circle, 1 hemisphere, 2 octahedron. SHADOWED: behind shadow_map.glsl. CAST: before shadow_billboards.glsl.
uniform vec2 depth_terms;  // ndc z = x + y / distance along the view

#pragma stage vertex
struct tree {
    vec4 place;  // position, scale
    vec4 turn;   // cos, sin of the rotation, species, rotation as a step of sunlights
};

struct picture {
    vec4 right_s, up_t, toward_area;  // plane, corner of the layer
    vec4 bounds;                      // low, high
    vec4 depth_plane;
    vec2 hull[8];
    vec4 triangle[3];  // corner, how it moves with a margin
};

struct plant {
    vec4 shape;   // centre's height, radius, texel (m), first view
    vec4 albedo;  // scale
    vec4 light[15];
};

// Light from the sun on a picture of a tree that is turned by a step.
struct sunlight {
    vec4 factors;  // of the four channels
    vec4 rest;     // x: light without channels
};

layout(std430, binding = 0) readonly buffer trees_buffer { tree trees[]; };
layout(std430, binding = 1) readonly buffer order_buffer { uint order[]; };
layout(std430, binding = 2) readonly buffer pictures_buffer { picture pictures[]; };
layout(std430, binding = 3) readonly buffer plants_buffer { plant plants[]; };
layout(std430, binding = 4) readonly buffer sunlights_buffer { sunlight sunlights[]; };
#ifdef STRETCHED
layout(std430, binding = 5) readonly buffer stretches_buffer { float stretches[]; };
#endif

uniform int first_tree;
uniform vec2 layer_px;    // size of a layer
#ifdef LAYOUT
uniform int side;         // views on the circle, or along the square
#endif
uniform float pixel_m;    // metres across a pixel at a distance of 1 m
uniform int last_level;

out vec2 place[VIEWS];              // texture coordinates
flat out vec4 layer_weight[VIEWS];  // layer, weight, texels along its sides that fade at the border
flat out vec4 light_factors[VIEWS]; // of the four channels
flat out float light_rest[VIEWS];   // light without channels
flat out vec4 shared_terms;         // albedo scale, level, radius (m, world), quad's number
#ifdef FOG
out float clear_share;              // what the fog leaves
#endif
#ifdef SHADOWED
out vec3 plane_m;                   // where the picture's plane is in the world
flat out vec4 toward_texel;         // unit, that its depths are along; a texel's size, m
#endif

#ifdef STRETCHED
float stretch = 1.0;  // of the tree that was asked for last
#else
const float stretch = 1.0;
#endif

tree tree_at(int number)
{
#ifdef STRETCHED
    stretch = stretches[number];
#endif
    return trees[number];
}

// A way of the world in the axes and the height of the tree's plant: pictures stretch with the tree, so that one of them
// is seen along the way that it is a picture from.
vec3 to_tree(vec3 v, tree t)
{
    vec3 own = rotate_y(v, t.turn.x, -t.turn.y);
    return vec3(own.x, own.y / stretch, own.z);
}

vec3 center_of(tree t, plant p)
{
    return t.place.xyz + vec3(0.0, p.shape.x * t.place.w * stretch, 0.0);
}

// The level whose texels are as large as pixels at the tree's centre.
float level_of(tree t, plant p)
{
    float away = (view_projection * vec4(center_of(t, p), 1.0)).w;
    float level = log2(max(away * pixel_m / (p.shape.z * t.place.w), 1.0));
    return min(floor(level + 0.5), float(last_level));
}

// Half a texel of that level: as far as bilinear filtering carries coverage beyond a picture's edge.
float margin_of(plant p, float level)
{
    return 0.5 * exp2(level) * p.shape.z;
}

vec2 corner_of(vec2 low, vec2 high, int corner)
{
    return vec2(corner == 1 || corner == 2 ? high.x : low.x, corner >= 2 ? high.y : low.y);
}

// A margin along both axes is up to sqrt(2) of it across a side.
vec2 triangle_corner(picture pic, int corner, float margin)
{
    return pic.triangle[corner].xy + 1.4143 * margin * pic.triangle[corner].zw;
}

#ifdef LAYOUT
// The octahedral map of a unit direction on [0, side - 1]^2, as views_direction() in bake/views.c inverts it.
vec2 grid_of(vec3 v)
{
    vec2 square;
    if (LAYOUT == 1) {
        vec2 p = v.xz / (abs(v.x) + max(v.y, 0.0) + abs(v.z));
        square = vec2(p.x + p.y, p.x - p.y);
    } else {
        square = v.xz / (abs(v.x) + abs(v.y) + abs(v.z));
        if (v.y < 0.0)
            square = (1.0 - abs(square.yx)) * vec2(square.x < 0.0 ? -1.0 : 1.0, square.y < 0.0 ? -1.0 : 1.0);
    }
    return (clamp(square, -1.0, 1.0) * 0.5 + 0.5) * float(side - 1);
}

// The pictures to mix and their weights; the first is the heaviest.
void choose(vec3 v, out int chosen[VIEWS], out float weights[VIEWS])
{
    if (LAYOUT == 0) {
        float at = atan(v.x, v.z) * float(side) / 6.28318530718 + float(side);
        int near = int(floor(at + 0.5));
        float apart = at - float(near);
        chosen[0] = near % side;
        weights[0] = 1.0 - abs(apart);
#if VIEWS == 2
        chosen[1] = (near + (apart < 0.0 ? side - 1 : 1)) % side;
        weights[1] = abs(apart);
#endif
        return;
    }
    vec2 at = grid_of(v);
#if VIEWS == 3
    ivec2 cell = ivec2(min(floor(at), vec2(side - 2)));
    vec2 f = at - vec2(cell);
    bool beyond = f.x + f.y > 1.0;
    vec3 w = beyond ? vec3(f.x + f.y - 1.0, 1.0 - f.y, 1.0 - f.x) : vec3(1.0 - f.x - f.y, f.x, f.y);
    int corner = cell.x + cell.y * side;
    ivec3 c = ivec3(beyond ? corner + side + 1 : corner, corner + 1, corner + side);
    if (w.y > w.x && w.y >= w.z) {
        w = w.yxz;
        c = c.yxz;
    } else if (w.z > w.x) {
        w = w.zyx;
        c = c.zyx;
    }
    for (int k = 0; k < 3; k++) {
        chosen[k] = c[k];
        weights[k] = w[k];
    }
#else
    ivec2 cell = ivec2(floor(at + 0.5));
    chosen[0] = cell.x + cell.y * side;
    weights[0] = 1.0;
#endif
}

// x, perpendicular to unit a, turned the shortest way that takes a to b.
vec3 swing(vec3 x, vec3 a, vec3 b)
{
    return x - dot(b, x) / max(1.0 + dot(a, b), 1e-3) * (a + b);
}
#endif

#ifndef CAST
// Picture k of the quad: its light from the sun and its place st on the picture's plane.
void set_picture(int k, tree t, plant p, int index, vec2 st, float weight, float level)
{
    picture pic = pictures[index];
    sunlight sun = sunlights[index * SUN_STEPS + int(t.turn.w)];
    light_factors[k] = sun.factors;
    light_rest[k] = sun.rest.x;
    // The nearest texel of a minified picture ends sharply.
    vec2 fade = NEAREST == 1 && level > 0.0 ? vec2(1e6) : layer_px * exp2(-level);
    layer_weight[k] = vec4(float(index), weight, fade);
    place[k] = (st - vec2(pic.right_s.w, pic.up_t.w)) / (p.shape.z * layer_px);
}

// The quad's corner at `own` (m, plant's axes, from its centre); what is seen there lies depth_m nearer to the eye. The
// picture's depths are along toward.
void set_corner(tree t, plant p, vec3 own, vec3 toward, float depth_m, float level, uint number)
{
    own.y *= stretch;
    vec3 world = center_of(t, p) + t.place.w * rotate_y(own, t.turn.x, t.turn.y);
    float away = max(distance(world, eye_m), 1e-6);
    float share = clamp(depth_m * t.place.w / away, -1.0, 0.9);
    gl_Position = view_projection * vec4(world, 1.0);
    // Moving along the ray to the eye changes depth alone: z + share / (1 - share) * projection[3][2].
    if (gl_Position.w > 0.0 && gl_Position.z > -gl_Position.w)
        gl_Position.z = max(gl_Position.z + depth_terms.y * share / (1.0 - share),
                            -0.99999 * gl_Position.w);
#ifdef FOG
    clear_share = exp(-fog_density * away * (1.0 - share));
#endif
#ifdef SHADOWED
    plane_m = world;
    toward_texel = vec4(rotate_y(toward, t.turn.x, t.turn.y), exp2(level) * p.shape.z * t.place.w);
#endif
    shared_terms = vec4(p.albedo.x, level, p.shape.y * t.place.w, float(number));
}
#endif

#pragma stage fragment
layout(binding = 0) uniform sampler2DArray albedo_map;
layout(binding = 1) uniform sampler2DArray light_map;
layout(binding = 2) uniform sampler2DArray depth_map;
in vec2 place[VIEWS];
flat in vec4 layer_weight[VIEWS];
flat in vec4 light_factors[VIEWS];
flat in float light_rest[VIEWS];
flat in vec4 shared_terms;
#ifdef FOG
in float clear_share;
#endif
#ifdef SHADOWED
in vec3 plane_m;
flat in vec4 toward_texel;
#endif

#ifndef CAST
layout(location = 0) out vec4 color;

uint scramble(uint x)
{
    x ^= x >> 16;
    x *= 0x7feb352du;
    x ^= x >> 15;
    x *= 0x846ca68bu;
    return x ^ (x >> 16);
}

// Coverage as samples of a pixel: right in the mean, and independent from quad to quad, so that layers add up as
// they do in blending.
int sample_mask(float coverage)
{
    uint random = scramble(uint(gl_FragCoord.x) + (uint(gl_FragCoord.y) << 12) +
                           scramble(uint(shared_terms.w)));
    uint count = uint(min(4.0 * coverage + float(random >> 8) / 16777216.0, 4.0));
    uint mask = (1u << count) - 1u, turn = random & 3u;
    return int(((mask << turn) | (mask >> (4u - turn))) & 15u);
}

void main()
{
    vec3 radiance = vec3(0.0);
    float coverage = 0.0, depth = 0.0;
#ifdef SHADOWED
    vec3 sunlit = vec3(0.0);
    float turned = 0.0;  // coverage whose surface the sun can reach
#endif
    for (int k = 0; k < VIEWS; k++) {
        vec3 at = vec3(place[k], layer_weight[k].x);
        vec4 texel = textureLod(albedo_map, at, shared_terms.y);
        // Outside of a layer there is nothing, as with a border colour, with which llvmpipe filters slowly.
        vec2 inside = clamp((0.5 - abs(place[k] - 0.5)) * layer_weight[k].zw + 0.5, 0.0, 1.0);
#ifdef STRAIGHT
        texel.a *= inside.x * inside.y;
#else
        texel *= inside.x * inside.y;
#endif
        vec4 light = textureLod(light_map, at, shared_terms.y);
        float diffuse = light_rest[k] + dot(light, light_factors[k]);
        float weight = VIEWS == 1 ? 1.0 : layer_weight[k].y;
#ifdef STRAIGHT
        if (VIEWS > 1)
            texel.rgb *= texel.a;
#endif
#ifdef SHADOWED
        sunlit += weight * max(diffuse, 0.0) * texel.rgb;
        radiance += weight * texel.rgb * ambient;
        turned += diffuse > 0.0 ? weight * texel.a : 0.0;
#else
        radiance += weight * texel.rgb * (sun_radiance * max(diffuse, 0.0) + ambient);
#endif
        coverage += weight * texel.a;
#ifdef PICTURE_DEPTH
        depth += weight * texel.a * textureLod(depth_map, at, shared_terms.y).r;
#endif
    }
#ifdef ALPHA_TEST
    if (coverage < 0.5)
        discard;
#endif
#ifdef PICTURE_DEPTH
    float nearer = (2.0 * depth / max(coverage, 1e-6) - 1.0) * shared_terms.z;
#endif
#ifdef SHADOWED
    float visible = shadow_visibility_within(plane_m + toward_texel.xyz * nearer, toward_texel.w);
    radiance += visible * sun_radiance * sunlit;
#endif
    radiance *= shared_terms.x;
#ifdef SHADOWED
    if (masked)
        radiance = vec3(visible * turned, coverage, 0.0);
#ifdef STRAIGHT
    if (masked && VIEWS == 1)
        radiance /= max(coverage, 1e-6);
#endif
#endif
#ifdef STRAIGHT
    color = vec4(VIEWS > 1 ? radiance / max(coverage, 1e-6) : radiance, 1.0);
#else
    color = vec4(radiance, coverage);
#endif
#ifdef FOG
    color.rgb = mix(fog_color * color.a, color.rgb, clear_share);
#endif
#ifdef ALPHA_COVERAGE
    gl_SampleMask[0] = sample_mask(coverage);
#endif
#ifdef DEPTH
    float away = max(1.0 / gl_FragCoord.w - nearer, 1e-4);
    gl_FragDepth = clamp(0.5 + 0.5 * (depth_terms.x + depth_terms.y / away), 0.0, 1.0);
#endif
}
#endif
