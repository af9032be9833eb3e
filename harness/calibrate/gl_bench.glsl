// A shape's corners (in px of a cell) are stretched, and put at each instance's place. TEXTURED, TESTED; SAMPLES, LOOKUPS:
// so many in each fragment.
uniform vec2 cell_px, to_ndc;
uniform float depth;
uniform float texel;
uniform vec4 color;

#pragma stage vertex
layout(location = 0) in vec2 corner;
layout(location = 1) in vec2 place_px;
#ifdef TEXTURED
out vec2 uv;
#endif
void main()
{
    vec2 px = corner * cell_px + place_px;
#ifdef TEXTURED
    uv = px * texel;
#endif
    gl_Position = vec4(px * to_ndc - 1.0, depth, 1.0);
}

#pragma stage fragment
layout(binding = 0) uniform sampler2DArray pictures;
layout(binding = 1) uniform usamplerBuffer words;  // 65,536, each its place
layout(location = 0) out vec4 result;
#ifdef TEXTURED
in vec2 uv;
#endif
void main()
{
#ifdef SAMPLES
    result = vec4(0.0);
    for (int i = 0; i < SAMPLES; i++)  // a texel farther each
        result += textureLod(pictures, vec3(uv + vec2(float(i) * texel, 0.0), 1.0), 0.0);
    result *= color / float(SAMPLES);
#elif defined(LOOKUPS)
    // A Weyl sequence's upper bits choose the word: no fetch waits for the one before.
    uvec2 pixel = uvec2(gl_FragCoord.xy);
    uint at = pixel.x + (pixel.y << 13), sum = 0u;
    for (int i = 0; i < LOOKUPS; i++) {
        at += 0x9e3779b9u;
        sum += texelFetch(words, int(at >> 16)).r;
    }
    result = vec4(float(sum)) * color;
#elif defined(TEXTURED)
    result = texture(pictures, vec3(uv, 1.0)) * color;
#else
    result = color;
#endif
#ifdef TESTED
    if (result.a < 0.5)
        discard;
#endif
}
