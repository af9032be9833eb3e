// What a caster leaves in a shadow map beside its depth: the head of each caster's fragment stage. LAYERS: to which
// depths behind the map's first one a sample is covered.
#ifdef LAYERS
layout(location = 0) out vec4 covered;
layout(binding = 5) uniform sampler2DArray first;
uniform int layer;
uniform float layer_depth;  // of a layer, in units of depth

void cover(float depth)
{
#if LAYERS == 1
    covered = vec4(1.0);
#else
    float behind = depth - texelFetch(first, ivec3(gl_FragCoord.xy, layer), 0).r;
    covered = vec4(lessThanEqual(vec4(behind), layer_depth * vec4(1.0, 2.0, 3.0, 4.0)));
#endif
}
#endif
