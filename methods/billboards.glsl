// One quad (or triangle, or fan of 8) a tree that faces the eye. LAYOUT: 0 circle, 1 hemisphere, 2 octahedron.
#pragma stage vertex
void main()
{
    int number = int(order[first_tree + gl_VertexID / CORNERS]), corner = gl_VertexID % CORNERS;
    tree t = tree_at(number);
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
    set_corner(t, p, own, v, depth_m, level, uint(number));
}
