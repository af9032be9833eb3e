// A picture of trees that is drawn front to back (harness/bake/stack_front.h). CLOSE: depth 0 where it is saturated;
// else the picture itself.
#pragma stage vertex
void main()
{
    gl_Position = vec4(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0, -1.0, 1.0);
}

#pragma stage fragment
layout(binding = 0) uniform sampler2D trees;
#ifdef CLOSE
void main()
{
    if (texelFetch(trees, ivec2(gl_FragCoord.xy), 0).a < 1.0 - 1.0 / 256.0)
        discard;
}
#else
layout(location = 0) out vec4 color;

void main()
{
    color = texelFetch(trees, ivec2(gl_FragCoord.xy), 0);
}
#endif
