// Cones: gl_VertexID counts the corners of SIDES triangles about the trunk, an instance is a tree.
#pragma stage vertex
layout(location = 0) in vec4 foot;  // m; scale
uniform vec2 size_m;                // radius and height at scale 1
out vec3 position_m;
out vec3 normal;

void main()
{
    int corner = gl_VertexID % 3;  // the top, then two at the foot
    float turn = float(gl_VertexID / 3) + (corner == 0 ? 0.5 : float(corner - 1));
    float angle = 6.283185307 * turn / float(SIDES);
    vec3 around = vec3(sin(angle), 0.0, cos(angle));
    vec3 place = corner == 0 ? vec3(0.0, size_m.y, 0.0) : size_m.x * around;
    position_m = foot.xyz + foot.w * place;
    normal = size_m.y * around + vec3(0.0, size_m.x, 0.0);
    gl_Position = view_projection * vec4(position_m, 1.0);
}

#pragma stage fragment
layout(location = 0) out vec4 color;
uniform vec3 albedo;
in vec3 position_m;
in vec3 normal;

void main()
{
    color = vec4(shade_fog(shade_leaf(albedo, normal, gl_FrontFacing), position_m), 1.0);
}
