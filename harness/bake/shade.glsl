// Light and fog as harness/scene/effects.h defines them. gl_program puts this before every shader.
uniform mat4 view_projection;
uniform vec3 eye_m;
uniform vec3 sun_direction;  // unit, toward the sun
uniform vec3 sun_radiance;
uniform vec3 ambient;        // 0 without EFFECT_AMBIENT
uniform vec3 fog_color;
uniform float fog_density;   // 1/m, 0 without EFFECT_FOG
uniform bool two_sided;      // EFFECT_TWO_SIDED
uniform bool masked;         // the shadow mask in place of light

float sun_visibility = 1.0;  // S; a shader that knows better sets it before it shades

// a (sun D S + ambient), or the mask's surface
vec3 shade_lit(vec3 albedo, float d)
{
    if (masked)
        return vec3(d > 0.0 ? sun_visibility : 0.0, 1.0, 0.0);
    return albedo * (sun_radiance * (d * sun_visibility) + ambient);
}

// Bark and terrain; normal need not be unit; facing: geometric normal . to-eye >= 0.
vec3 shade_bark(vec3 albedo, vec3 normal, bool facing)
{
    vec3 n = normalize(facing ? normal : -normal);
    return shade_lit(albedo, max(0.0, dot(n, sun_direction)));
}

vec3 shade_leaf(vec3 albedo, vec3 normal, bool facing)
{
    float d = dot(normalize(normal), sun_direction);
    d = two_sided ? abs(d) : max(0.0, facing ? d : -d);
    return shade_lit(albedo, d);
}

vec3 shade_fog(vec3 radiance, vec3 position_m)
{
    if (fog_density <= 0.0)
        return radiance;
    return mix(fog_color, radiance, exp(-fog_density * distance(position_m, eye_m)));
}

// R_y(angle) as instance_matrix() in scene.h has it.
vec3 rotate_y(vec3 v, float c, float s)
{
    return vec3(v.x * c + v.z * s, v.y, -v.x * s + v.z * c);
}
