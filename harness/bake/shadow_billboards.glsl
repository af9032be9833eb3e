// Trees that cast into a shadow map: quads that face the sun, behind impostor.glsl with CAST, and shadow_cover.glsl. The
// sun's rays are parallel: stretched with its tree, a picture from along a ray still is one.
uniform mat4 light;
uniform float texel_m;  // of the map

#pragma stage vertex
flat out vec3 layer_level;  // layer, level
out vec2 picture_place;
out vec3 plane_m;         // on the plane through the tree's centre
flat out vec3 toward_m;   // the sun, as far as the pictures' depths reach

void main()
{
    int number = int(order[gl_VertexID / 6]), corner = int[6](0, 1, 2, 0, 2, 3)[gl_VertexID % 6];
    tree t = tree_at(number);
    plant p = plants[int(t.turn.z)];
    vec3 v = to_tree(sun_direction, t);
    v.y = max(v.y, 0.0);
    v = normalize(v + vec3(0.0, 1e-6, 0.0));
    int chosen[VIEWS];
    float weights[VIEWS];
    choose(v, chosen, weights);
    int index = chosen[0] + int(p.shape.w);
    picture pic = pictures[index];
    vec3 right = swing(pic.right_s.xyz, pic.toward_area.xyz, v), up = swing(pic.up_t.xyz, pic.toward_area.xyz, v);
    float level = min(floor(log2(max(texel_m / (p.shape.z * t.place.w), 1.0)) + 0.5), float(last_level));
    float margin = margin_of(p, level);
    vec2 st = corner_of(pic.bounds.xy - margin, pic.bounds.zw + margin, corner);
    picture_place = (st - vec2(pic.right_s.w, pic.up_t.w)) / (p.shape.z * layer_px);
    layer_level = vec3(float(index), level, 0.0);
    vec3 tall = vec3(1.0, stretch, 1.0);
    plane_m = center_of(t, p) + t.place.w * rotate_y(tall * (st.x * right + st.y * up), t.turn.x, t.turn.y);
    toward_m = t.place.w * p.shape.y * rotate_y(tall * v, t.turn.x, t.turn.y);
    gl_Position = light * vec4(plane_m, 1.0);
}

#pragma stage fragment
flat in vec3 layer_level;
#ifdef LAYERS
sample in vec2 picture_place;  // each sample of a texel tests its own place
sample in vec3 plane_m;
#else
in vec2 picture_place;
in vec3 plane_m;
#endif
flat in vec3 toward_m;

void main()
{
    vec3 at = vec3(picture_place, layer_level.x);
    if (textureLod(albedo_map, at, layer_level.y).a < 0.5 || any(greaterThan(abs(picture_place - 0.5), vec2(0.5))))
        discard;
    vec4 clip = light * vec4(plane_m + toward_m * (2.0 * textureLod(depth_map, at, layer_level.y).r - 1.0), 1.0);
    float depth = clamp(0.5 + 0.5 * clip.z / clip.w, 0.0, 1.0);
#ifdef LAYERS
    cover(depth);
#else
    gl_FragDepth = depth;
#endif
}
