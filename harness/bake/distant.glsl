// The picture of distant trees over the backdrop (harness/bake/distant.h).
#pragma stage vertex
void main()
{
    gl_Position = vec4(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0, 0.0, 1.0);
}

#pragma stage fragment
layout(binding = 0) uniform sampler2D trees;  // row 0 on top; radiance, premultiplied, coverage
uniform int height_px;
layout(location = 0) out vec4 color;

void main()
{
    color = texelFetch(trees, ivec2(gl_FragCoord.x, height_px - 1 - int(gl_FragCoord.y)), 0);
}
