// Double cones: gl_VertexID counts the corners of 2 SIDES triangles about the trunk, upper and lower by turns; an
// instance is a tree.
#pragma stage vertex
layout(location = 0) in vec4 foot;  // m; scale
uniform vec2 size_m;                // radius and height at scale 1
out vec3 position_m;
out vec3 normal;

void main()
{
    int corner = gl_VertexID % 3;  // an end, then two about the middle
    bool upper = gl_VertexID / 3 % 2 == 0;
    float turn = float(gl_VertexID / 6) + (corner == 0 ? 0.5 : float((corner == 2) == upper));
    float angle = 6.283185307 * turn / float(SIDES);
    vec3 around = vec3(sin(angle), 0.0, cos(angle));
    vec3 place = vec3(0.0, corner > 0 ? 0.5 * size_m.y : upper ? size_m.y : 0.0, 0.0);
    place += corner > 0 ? size_m.x * around : vec3(0.0);
    position_m = foot.xyz + foot.w * place;
    normal = 0.5 * size_m.y * around + vec3(0.0, upper ? size_m.x : -size_m.x, 0.0);
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
