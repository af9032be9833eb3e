// Each pixel's ray through the trees of its tile, front to back. Voxels and closures: harness/bake/voxels.h.
uniform vec2 pixel_slope;   // a pixel's step across and up, per metre along the view
uniform vec2 corner_slope; // of the centre of the lower left pixel
uniform mat3 axes;          // right, up, forward
uniform ivec3 tiling;       // side of a tile (px), tiles in a row, the picture's height (px)
uniform vec2 depth_terms;   // depth along the view = y / (x + ndc z)
uniform vec4 limits;        // near (m), least transmittance, step (voxels), 1: leaves are lit on one side only

#pragma stage vertex
void main()
{
    gl_Position = vec4(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0, 0.0, 1.0);
}

#pragma stage fragment
layout(binding = 0) uniform usamplerBuffer cells;    // index or distance of each voxel
layout(binding = 1) uniform usamplerBuffer voxels;   // 16 bytes each
layout(binding = 2) uniform usamplerBuffer trees;    // four texels a tree, harness/bake/trees_gl.h
layout(binding = 3) uniform usamplerBuffer firsts;   // of each tile's entries
layout(binding = 4) uniform usamplerBuffer entries;  // trees, tile by tile
layout(binding = 5) uniform sampler2D depths;
layout(location = 0) out vec4 color;
#ifdef SHADOWS
layout(binding = 6) uniform usamplerBuffer passes;   // of the sun's light, what reaches a cell, 0..255
layout(binding = 7) uniform usamplerBuffer gains;    // of four corners over a tree the same, a byte each
layout(binding = 8) uniform usamplerBuffer volumes;  // four texels each, harness/bake/sunlight_gl.c
uniform vec2 light_terms;  // columns of gains; cells that bark takes its light nearer the sun
#endif
#ifdef COUNT
layout(std430, binding = 0) buffer counts_buffer { uint counts[]; };  // lookups of a row of pixels
#endif

// x' M y of a packed matrix: its 5 entries of 6 bits, each by its factor.
struct form {
    float base, xx, yy, xy, xz, yz;
};

form form_of(vec3 x, vec3 y)
{
#ifdef ISOTROPIC
    return form(dot(x, y) / 3.0, 0.0, 0.0, 0.0, 0.0, 0.0);
#else
    form f;
    float zz = x.z * y.z;
    f.xx = (x.x * y.x - zz) / 63.0;
    f.yy = (x.y * y.y - zz) / 63.0;
    f.xy = (x.x * y.y + x.y * y.x) / 62.0;
    f.xz = (x.x * y.z + x.z * y.x) / 62.0;
    f.yz = (x.y * y.z + x.z * y.y) / 62.0;
    f.base = zz - 31.0 * (f.xy + f.xz + f.yz);
    return f;
#endif
}

float value(form f, uint m)
{
#ifdef ISOTROPIC
    return f.base;
#else
    return f.base + f.xx * float(m & 63u) + f.yy * float(m >> 6 & 63u) + f.xy * float(m >> 12 & 63u) +
           f.xz * float(m >> 18 & 63u) + f.yz * float(m >> 24 & 63u);
#endif
}

// sqrt(1 - x x) + x asin(x) of x squared, 0..1; absolute error 5e-4.
float arc(float x2)
{
    return 0.99953635 + x2 * (0.51276042 + x2 * (-0.0092389264 + x2 * 0.066520270));
}

vec3 bytes(uint word)
{
    return vec3(word & 255u, word >> 8 & 255u, word >> 16 & 255u);
}

// What is left of 1 behind `span` voxels of it (a), and its radiance. raise: 1 / stretch^2 - 1; the light of a stretched
// tree is divided by the length of its normals before they are unit (harness/bake/march_job.c).
vec4 sample_voxel(uvec4 words, float span, form eye, form sun, form both, float raise, vec3 in_shade, vec3 in_sun,
                  float sides)
{
    float depth = uintBitsToFloat(words.x) * sqrt(max(value(eye, words.y), 0.0));
    float seen = max(value(eye, words.z), 1e-4), lit = max(value(sun, words.z), 1e-4);
    float cosine = value(both, words.z) * inversesqrt(seen * lit), root = sqrt(lit), toward = cosine * root;
    float one_sided = max(float(words.w >> 28) * (1.0 / 15.0), sides);
    float even = 0.63661977 * root * arc(min(cosine * cosine, 1.0));
    float diffuse = (even + 0.5 * one_sided * (toward - even)) / (0.75 + float(words.w >> 24 & 15u) * (1.0 / 60.0));
#ifdef STRETCHED
#ifdef ISOTROPIC
    diffuse *= inversesqrt(1.0 + raise / 3.0);
#else
    diffuse *= inversesqrt(1.0 + raise * float(words.z >> 6 & 63u) / 63.0);
#endif
#endif
#ifdef MASKED
    // The shadow mask in place of light, of what faces the sun.
    vec3 rgb = vec3(in_sun.r * clamp(1.0 + 0.5 * one_sided * (toward / even - 1.0), 0.0, 1.0), 1.0, 0.0);
#else
    vec3 rgb = bytes(words.w) * (in_shade + in_sun * max(diffuse, 0.0));
#endif
    return vec4(rgb, exp(-depth * span));
}

#ifdef SHADOWS
// A plant's volume of light as a ray goes through it.
struct volume {
    vec3 start, way;  // in its cells: where the ray begins; a voxel on
    vec3 size;
    int first_cell, first_gain;
};

volume volume_of(int tree, vec3 start, vec3 u, int first_gain)
{
    int at = 4 * int(texelFetch(trees, tree).w);
    vec4 x = uintBitsToFloat(texelFetch(volumes, at)), y = uintBitsToFloat(texelFetch(volumes, at + 1));
    vec4 z = uintBitsToFloat(texelFetch(volumes, at + 2));
    uvec4 size = texelFetch(volumes, at + 3);
    volume v;
    v.start = vec3(dot(x.xyz, start) + x.w, dot(y.xyz, start) + y.w, dot(z.xyz, start) + z.w);
    v.way = vec3(dot(x.xyz, u), dot(y.xyz, u), dot(z.xyz, u));
    v.size = vec3(size.xyz);
    v.first_cell = int(size.w);
    v.first_gain = first_gain;
    return v;
}

// Share of the sun's light so many voxels along the ray; bark: its share of what is there.
float sun_share(volume v, float along, float bark, vec2 terms)
{
    vec3 at = v.start + along * v.way;
    at.z -= max(4.0 * bark - 3.0, 0.0) * terms.y;
    at = clamp(at, vec3(0.0), v.size - vec3(0.001, 0.001, 1.001));
    vec3 cell = floor(at);
    int column = v.first_cell + (int(cell.y) * int(v.size.x) + int(cell.x)) * int(v.size.z) + int(cell.z);
    float pass = mix(float(texelFetch(passes, column).r), float(texelFetch(passes, column + 1).r), at.z - cell.z);
    vec2 over = min(at.xy * (terms.x - 1.0) / v.size.xy, vec2(terms.x - 1.001)), corner = floor(over);
    over -= corner;
    uint four = texelFetch(gains, v.first_gain + int(corner.y * terms.x + corner.x)).r;
    vec2 along_y = mix(vec2(four & 255u, four >> 16 & 255u), vec2(four >> 8 & 255u, four >> 24), over.x);
    return pass * mix(along_y.x, along_y.y, over.y) / 65025.0;
}
#endif

// Of what is behind the trees, along the view.
float depth_at(ivec2 pixel)
{
    float z = 2.0 * texelFetch(depths, pixel, 0).r - 1.0;
    return z < 1.0 ? depth_terms.y / (depth_terms.x + z) : 1e30;
}

// Of the tile's entries from `entry` to `end` the first tree whose pixels hold this one, or -1: each lane passes over
// the others by itself.
int next_tree(ivec2 at, inout int entry, int end)
{
    int tree = -1;
    do {
        int next = 4 * int(texelFetch(entries, min(entry, end - 1)).r);
        uvec3 bounds = texelFetch(trees, next).xyz;
        int row = at.y - int(bounds.x & 65535u);
        float across = clamp(float(4 * at.x + BIAS) - uintBitsToFloat(bounds.y) * float(row), 0.0, 65535.0);
        bool inside = row >= 0 && at.y <= int(bounds.x >> 16) && across >= float(bounds.z & 65535u) &&
                      across <= float(bounds.z >> 16);
        tree = tree < 0 && entry < end && inside ? next : tree;
        entry += tree < 0 ? 1 : 0;
    } while (tree < 0 && entry < end);
    return tree;
}

void main()
{
    vec2 pixel = floor(gl_FragCoord.xy);
    vec2 slope = corner_slope + pixel * pixel_slope;
    vec3 ray = axes * vec3(slope, 1.0);
    float stretch = length(ray);
    ray /= stretch;
    float depth = depth_at(ivec2(pixel)), above = depth_at(ivec2(pixel.x, min(int(pixel.y) + 2, tiling.z - 1)));

    ivec2 at = ivec2(int(pixel.x), tiling.z - 1 - int(pixel.y));
    int tile = at.y / tiling.x * tiling.y + at.x / tiling.x;
    int entry = int(texelFetch(firsts, tile).r), end = int(texelFetch(firsts, tile + 1).r);
    float left = 1.0;
    // Uniforms are read here: in a loop llvmpipe gathers them lane by lane each time.
    vec3 in_shade = ambient, in_sun = sun_radiance, to_sun = sun_direction, fog = fog_color;
#ifdef MASKED
    in_sun = vec3(1.0);
#endif
    float near = limits.x, least = limits.y, long_step = limits.z, short_step = min(limits.z, 1.0), sides = limits.w;
#ifdef SHADOWS
    vec2 terms = light_terms;
#endif
    vec3 sum = vec3(0.0);
#ifdef COUNT
#ifdef SHADOWS
    const uint voxel_lookups = 5u;
#else
    const uint voxel_lookups = 2u;
#endif
    uint lookups = 0u;  // a cell is one, a voxel two, its shadow three, as the CPU's march counts them
#endif
    // A software GL runs both sides of each branch, and the body of a loop once more than its test at the top allows:
    // loops are tested at their end, and what is not met has no share. What is read behind a loop must then be
    // carried by it, each from its own last value (llvmpipe 22 makes the others again, also for lanes that have left).
    int tree = next_tree(at, entry, end);
    do {
        int first = max(tree, 0);
        uvec4 looks = texelFetch(trees, first + 1);  // first cell, size, shares, albedo
        vec4 where = uintBitsToFloat(texelFetch(trees, first + 2));
#ifdef SHADOWS
        uvec4 last = texelFetch(trees, first + 3);
        vec2 turn = uintBitsToFloat(last.xy);
#else
        vec2 turn = uintBitsToFloat(texelFetch(trees, first + 3).xy);
#endif
        float clear = float(looks.z & 65535u) / 65535.0;
#ifdef SMOOTH
        float drawn = float(looks.z >> 16) / 65535.0;  // of the tree's optical depth
#else
        const float drawn = 1.0;
#endif
        float rise = 1.0, speed = stretch;  // 1 / the tree's stretch; in the plant, per metre along the view
#ifdef STRETCHED
        rise = length(turn);
        turn /= rise;
#endif
        vec3 u = rotate_y(ray, turn.x, -turn.y), l = rotate_y(to_sun, turn.x, -turn.y);
#ifdef STRETCHED
        u.y *= rise;
        l.y *= rise;
        speed *= length(u);
        u = normalize(u);
#endif
        form f_eye = form_of(u, u), f_sun = form_of(l, l), f_both = form_of(-u, l);
        vec3 size = vec3(looks.y & 1023u, looks.y >> 10 & 1023u, looks.y >> 20 & 1023u);
#ifdef MASKED
        const float white = 1.0;
#else
        vec3 white = vec3(looks.w & 1023u, looks.w >> 10 & 1023u, looks.w >> 20 & 1023u) / (1023.0 * 255.0);
#endif

        // The ray from where it enters the box, in voxels.
        float weight = 1.0, along = 0.0, span;
        vec3 start = vec3(0.0);
        if ((looks.y >> 30 & 1u) != 0u) {
            // Smaller than a pixel: spread over the four pixels around its middle, also where their centres see the
            // ground before its foot: two pixels farther up that is behind it.
            vec2 off = max(1.0 - abs(vec2(at) - where.xy), 0.0);
            weight = off.x * off.y * where.z;
            span = where.w < max(depth, above) ? 1.0 : 0.0;
        } else {
            vec3 slow = mix(u, vec3(1e-10), lessThan(abs(u), vec3(1e-10)));
            vec3 one = -where.xyz / slow, other = (size - where.xyz) / slow;
            vec3 low = min(one, other), high = max(one, other);
            float scale = speed * where.w;
            float from = max(max(low.x, near * scale), max(low.y, low.z));
            span = min(min(high.x, depth * scale), min(high.y, high.z)) - from;
            start = where.xyz + from * u;
        }
#ifdef SHADOWS
        volume light = volume_of(first, start, u, int(last.z));
        float lit = uintBitsToFloat(last.w);
#endif
        if (tree < 0)
            span = 0.0;
        float thick = (looks.y >> 31) != 0u ? SOLID : 1.0;  // the eye is in the tree's bark
        float leap = 1.0 / max(abs(u.x), max(abs(u.y), abs(u.z)));
        ivec3 grid = ivec3(size);
        uint octant = (u.x < 0.0 ? 4u : 0u) + (u.y < 0.0 ? 8u : 0u) + (u.z < 0.0 ? 16u : 0u);
        vec3 most = size - 0.5;
        vec3 gathered = vec3(0.0);
        float before = left, stride = short_step;  // from empty space on no voxel is jumped over
        do {
            // Through empty space.
            uint cell = 0u;
            float pace = 0.0, middle = 0.0;
            for (int probe = 0; probe < PROBES; probe++) {
                pace = clamp(span - along, 0.0, stride);
                middle = along + 0.5 * pace;
                ivec3 p = ivec3(clamp(start + middle * u, vec3(0.0), most));
#ifdef COUNT
                lookups += pace > 0.0 && cell < FULL ? 1u : 0u;  // else it finds the same again
#endif
                cell = texelFetch(cells, int(looks.x) + (p.z * grid.y + p.y) * grid.x + p.x).r;
                if (cell < FULL) {
                    along = max(along + stride, middle + float(int(cell >> octant & 15u)) * leap);
                    stride = short_step;
                }
            }
            bool empty = cell < FULL;
            uvec4 words = texelFetch(voxels, empty ? 0 : int(cell & ~FULL));
            vec3 sunny = in_sun;
#ifdef SHADOWS
            float shine = sun_share(light, middle, float(words.w >> 28) * (1.0 / 15.0), terms);
            sunny *= lit < 0.0 ? shine : lit;
#endif
            vec4 met = sample_voxel(words, empty ? 0.0 : drawn * thick * pace, f_eye,
                                    f_sun, f_both, rise * rise - 1.0, in_shade, sunny, sides);
#ifdef COUNT
            lookups += empty || pace == 0.0 ? 0u : voxel_lookups;
#endif
            along += empty ? 0.0 : stride;
            stride = empty ? stride : long_step;
            float share = min(left * (1.0 - met.a) * weight, left);
            left -= share;
            gathered += share * met.rgb;
        } while (along < span && left > least);
        sum += clear * white * gathered + (before - left) * (1.0 - clear) * fog;
        entry++;
        tree = next_tree(at, entry, end);
    } while (tree >= 0 && left > least);
    if (left <= least) {  // what was left would have been more of the same
        sum /= 1.0 - left;
        left = 0.0;
    }
#ifdef COUNT
    atomicAdd(counts[int(pixel.y)], lookups);
#endif
    color = vec4(sum, 1.0 - left);
}
