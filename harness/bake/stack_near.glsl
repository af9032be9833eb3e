// The mix of two pictures of a tree (harness/bake/stack_near.h).
#pragma stage vertex
void main()
{
    gl_Position = vec4(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0, 0.0, 1.0);
}

#pragma stage fragment
layout(binding = 0) uniform sampler2D slices;
layout(binding = 1) uniform sampler2D triangles;
uniform float share;  // of triangles
layout(location = 0) out vec4 color;

void main()
{
    ivec2 at = ivec2(gl_FragCoord.xy);
    color = mix(texelFetch(slices, at, 0), texelFetch(triangles, at, 0), share);
}
