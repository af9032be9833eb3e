// Vertical planes that cross in a tree's axis. HALVES: each plane is two half planes, sent from the farthest to the
// nearest, which is the painter's order about a common axis; else whole planes, the one that faces the eye most last.
uniform int planes;

#pragma stage vertex
// Which half plane is the order-th farthest of 2 planes, for the horizontal direction to the eye: half plane j points to
// azimuth pi j / planes + pi / 2.
int half_plane(vec3 v, int order)
{
    float at = (atan(v.x, v.z) / 3.14159265359 - 0.5) * float(planes) + 2.0 * float(planes);
    int nearest = int(floor(at + 0.5)), rank = 2 * planes - 1 - order;
    int side = at < float(nearest) ? -1 : 1;
    int away = (rank + 1) / 2 * (rank % 2 == 1 ? side : -side);
    return (nearest + away + 2 * planes) % (2 * planes);
}

// Which plane faces the eye the order-th least; plane j's normal points to azimuth pi j / planes.
int whole_plane(vec3 v, int order)
{
    float at = atan(v.x, v.z) / 3.14159265359 * float(planes) + 2.0 * float(planes);
    int nearest = int(floor(at + 0.5)), rank = planes - 1 - order;
    int side = at < float(nearest) ? -1 : 1;
    int away = (rank + 1) / 2 * (rank % 2 == 1 ? side : -side);
    return (nearest + away + planes) % planes;
}

void main()
{
    int quads = HALVES == 1 ? 2 * planes : planes;
    int fan = gl_VertexID / CORNERS, corner = gl_VertexID % CORNERS;
    int number = int(order[first_tree + fan / quads]);
    tree t = tree_at(number);
    plant p = plants[int(t.turn.z)];
    vec3 v = to_tree(eye_m - center_of(t, p), t);
    int j = HALVES == 1 ? half_plane(v, fan % quads) : whole_plane(v, fan % quads);

    // The picture of the side that the eye is on; from behind it runs the other way.
    int plane = j % planes;
    bool front = dot(pictures[int(p.shape.w) + plane].toward_area.xyz, v) >= 0.0;
    int index = int(p.shape.w) + (front ? plane : planes + plane);
    picture pic = pictures[index];
    float level = level_of(t, p), margin = margin_of(p, level);
#if CORNERS == 4
    vec2 low = pic.bounds.xy - margin, high = pic.bounds.zw + margin;
    if (HALVES == 1) {
        bool positive = (j < planes) == front; // this half lies where the picture's s is positive
        low.x = positive ? max(low.x, 0.0) : low.x;
        high.x = positive ? high.x : min(high.x, 0.0);
        low.x = min(low.x, high.x);
    }
    vec2 st = corner_of(low, high, corner);
#elif CORNERS == 3
    vec2 st = triangle_corner(pic, corner, margin);
#else
    vec2 st = pic.hull[corner];
    st += margin * sign(st - 0.5 * (pic.bounds.xy + pic.bounds.zw));
#endif
    vec3 own = st.x * pic.right_s.xyz + st.y * pic.up_t.xyz;
    set_picture(0, t, p, index, st, 1.0, level);
    set_corner(t, p, own, pic.toward_area.xyz, 0.0, level, uint(number * quads + fan % quads));
}
