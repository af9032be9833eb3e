// Strips along the borders of a flat terrain, where a pixel is sky and terrain by their shares of it.
#pragma stage vertex
uniform vec3 ends[8];      // of each border, m
uniform vec2 inward[4];    // across it on the screen, unit, px
uniform vec2 size_px;
out vec3 position_m;
flat out vec2 across;
noperspective out float inside_px;  // how far the pixel's centre is inside

void main()
{
    const float reach = 1.5;  // px; a pixel's corner is 0.71 from its centre
    int border = gl_VertexID / 6, corner = int[6](0, 1, 2, 2, 1, 3)[gl_VertexID % 6];
    position_m = ends[2 * border + (corner & 1)];
    across = inward[border];
    inside_px = corner < 2 ? -reach : reach;
    vec4 at = view_projection * vec4(position_m, 1.0);
    gl_Position = vec4(at.xy + across * inside_px * 2.0 / size_px * at.w, 0.0, at.w);
}

#pragma stage fragment
layout(location = 0) out vec4 color;
uniform vec3 albedo;
uniform vec3 zenith, horizon, ground;

// sky_radiance() of harness/scene/scene.h
vec3 sky_radiance(vec3 direction)
{
    float y = normalize(direction).y;
    return y >= 0.0 ? mix(horizon, zenith, sqrt(y)) : mix(horizon, ground, min(1.0, -8.0 * y));
}

in vec3 position_m;
uniform vec3 first_ray, ray_x, ray_y;  // through the picture's corner at (0, 0) px, and a pixel's step
flat in vec2 across;
noperspective in float inside_px;

void main()
{
    vec3 terrain = shade_fog(shade_bark(albedo, vec3(0.0, 1.0, 0.0), true), position_m);
    vec3 sky = sky_radiance(first_ray + gl_FragCoord.x * ray_x + gl_FragCoord.y * ray_y);
    // the share of a square that a half plane covers: a trapezoid, integrated
    float a = max(abs(across.x), abs(across.y)), b = min(abs(across.x), abs(across.y));
    float corner = max(0.5 * (a + b) - abs(inside_px), 0.0);
    float share = abs(inside_px) <= 0.5 * (a - b) ? 0.5 + inside_px / a : corner * corner / max(2.0 * a * b, 1e-6);
    share = inside_px > 0.5 * (a - b) ? 1.0 - share : share;
    color = vec4(mix(sky, terrain, share), 0.0);
}
