// One quad (or triangle, or fan of 8) a tree that faces the eye. LAYOUT: 0 circle, 1 hemisphere, 2 octahedron.
uniform int side;  // views on the circle, or along the square

#pragma stage vertex
// The octahedral map of a unit direction on [0, side - 1]^2, as views_direction() in bake/views.c inverts it.
vec2 grid_of(vec3 v)
{
    vec2 square;
    if (LAYOUT == 1) {
        vec2 p = v.xz / (abs(v.x) + max(v.y, 0.0) + abs(v.z));
        square = vec2(p.x + p.y, p.x - p.y);
    } else {
        square = v.xz / (abs(v.x) + abs(v.y) + abs(v.z));
        if (v.y < 0.0)
            square = (1.0 - abs(square.yx)) * vec2(square.x < 0.0 ? -1.0 : 1.0, square.y < 0.0 ? -1.0 : 1.0);
    }
    return (clamp(square, -1.0, 1.0) * 0.5 + 0.5) * float(side - 1);
}

// The pictures to mix and their weights; the first is the heaviest.
void choose(vec3 v, out int chosen[VIEWS], out float weights[VIEWS])
{
    if (LAYOUT == 0) {
        float at = atan(v.x, v.z) * float(side) / 6.28318530718 + float(side);
        int near = int(floor(at + 0.5));
        float apart = at - float(near);
        chosen[0] = near % side;
        weights[0] = 1.0 - abs(apart);
#if VIEWS == 2
        chosen[1] = (near + (apart < 0.0 ? side - 1 : 1)) % side;
        weights[1] = abs(apart);
#endif
        return;
    }
    vec2 at = grid_of(v);
#if VIEWS == 3
    ivec2 cell = ivec2(min(floor(at), vec2(side - 2)));
    vec2 f = at - vec2(cell);
    bool beyond = f.x + f.y > 1.0;
    vec3 w = beyond ? vec3(f.x + f.y - 1.0, 1.0 - f.y, 1.0 - f.x) : vec3(1.0 - f.x - f.y, f.x, f.y);
    int corner = cell.x + cell.y * side;
    ivec3 c = ivec3(beyond ? corner + side + 1 : corner, corner + 1, corner + side);
    if (w.y > w.x && w.y >= w.z) {
        w = w.yxz;
        c = c.yxz;
    } else if (w.z > w.x) {
        w = w.zyx;
        c = c.zyx;
    }
    for (int k = 0; k < 3; k++) {
        chosen[k] = c[k];
        weights[k] = w[k];
    }
#else
    ivec2 cell = ivec2(floor(at + 0.5));
    chosen[0] = cell.x + cell.y * side;
    weights[0] = 1.0;
#endif
}

// x, perpendicular to unit a, turned the shortest way that takes a to b.
vec3 swing(vec3 x, vec3 a, vec3 b)
{
    return x - dot(b, x) / max(1.0 + dot(a, b), 1e-3) * (a + b);
}

void main()
{
    int number = int(order[first_tree + gl_VertexID / CORNERS]), corner = gl_VertexID % CORNERS;
    tree t = trees[number];
    plant p = plants[int(t.turn.z)];
    vec3 v = to_tree(eye_m - center_of(t, p), t);
    if (LAYOUT == 0 || (LAYOUT == 1 && v.y < 0.0))
        v.y = 0.0;
    float away = length(v);
    v = away > 1e-6 ? v / away : vec3(0.0, 0.0, 1.0);

    int chosen[VIEWS];
    float weights[VIEWS];
    choose(v, chosen, weights);
    vec3 right[VIEWS], up[VIEWS];
    for (int k = 0; k < VIEWS; k++) {
        chosen[k] += int(p.shape.w);
        picture pic = pictures[chosen[k]];
        right[k] = swing(pic.right_s.xyz, pic.toward_area.xyz, v);
        up[k] = swing(pic.up_t.xyz, pic.toward_area.xyz, v);
    }

    // The corner on the first picture's plane, around what all of them cover.
    picture first = pictures[chosen[0]];
    float level = level_of(t, p), margin = margin_of(p, level);
    vec2 st;
#if CORNERS == 4
    vec2 low = first.bounds.xy, high = first.bounds.zw;
    for (int k = 1; k < VIEWS; k++) {
        vec4 other = pictures[chosen[k]].bounds;
        for (int i = 0; i < 4; i++) {
            vec2 at = corner_of(other.xy, other.zw, i);
            vec3 own = at.x * right[k] + at.y * up[k];
            vec2 here = vec2(dot(own, right[0]), dot(own, up[0]));
            low = min(low, here);
            high = max(high, here);
        }
    }
    st = corner_of(low - margin, high + margin, corner);
#elif CORNERS == 3
    st = triangle_corner(first, corner, margin);
#else
    st = first.hull[corner];
    st += margin * sign(st - 0.5 * (first.bounds.xy + first.bounds.zw));
#endif
    vec3 own = st.x * right[0] + st.y * up[0];
    for (int k = 0; k < VIEWS; k++)
        set_picture(k, t, p, chosen[k], vec2(dot(own, right[k]), dot(own, up[k])), weights[k],
                    level);
    float depth_m = first.depth_plane.x + first.depth_plane.y * st.x + first.depth_plane.z * st.y;
    set_corner(t, p, own, depth_m, level, uint(number));
}
