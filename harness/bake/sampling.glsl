// 2 x 2 texels of 4 samples into a pixel: 16 places in it.
#pragma stage vertex
void main()
{
    gl_Position = vec4(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0, 0.0, 1.0);
}

#pragma stage fragment
layout(binding = 0) uniform sampler2DMS samples;
layout(location = 0) out vec4 color;

void main()
{
    ivec2 at = 2 * ivec2(gl_FragCoord.xy);
    vec4 sum = vec4(0.0);
    for (int i = 0; i < 16; i++)
        sum += texelFetch(samples, at + ivec2(i & 1, i >> 1 & 1), i >> 2);
    color = sum / 16.0;
}
