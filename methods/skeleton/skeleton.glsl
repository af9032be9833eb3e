// Double cones: gl_VertexID counts the corners of 2 SIDES triangles about the trunk, upper and lower by turns; an
// instance is a tree.
#pragma stage vertex
layout(location = 0) in vec3 foot;    // m
layout(location = 1) in vec2 scales;  // of width and height
uniform vec2 size_m;                  // radius and height at scale and stretch 1
out vec3 position_m;
out vec3 normal;

void main()
{
    int corner = gl_VertexID % 3;  // an end, then two about the middle
    bool upper = gl_VertexID / 3 % 2 == 0;
    float turn = float(gl_VertexID / 6) + (corner == 0 ? 0.5 : float((corner == 2) == upper));
    float angle = 6.283185307 * turn / float(SIDES);
    vec3 around = vec3(sin(angle), 0.0, cos(angle));
    vec2 size = scales * size_m;
    vec3 place = vec3(0.0, corner > 0 ? 0.5 * size.y : upper ? size.y : 0.0, 0.0);
    place += corner > 0 ? size.x * around : vec3(0.0);
    position_m = foot + place;
    normal = 0.5 * size.y * around + vec3(0.0, upper ? size.x : -size.x, 0.0);
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
