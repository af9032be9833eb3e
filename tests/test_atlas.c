/* The atlas: directions, light from moments, mip-maps, outlines, and pictures of shapes with known
 * areas. */
#include "testing_tree.h"

#include "bake/atlas.h"
#include "bake/atlas_bake.h"

#include <stdio.h>

static float dot3(const float a[3], const float b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void random_direction(struct random *random, float v[3])
{
    float y = 2 * random_float(random) - 1, angle = 6.2831853f * random_float(random);
    float r = sqrtf(fmaxf(0, 1 - y * y));
    v[0] = r * sinf(angle), v[1] = y, v[2] = r * cosf(angle);
}

/* D of a unit L from the moments: |N.L| by its best quadratic, max(0, N.L) half of it and half N.L.
 */
static float light_of_moments(const float moments[LIGHT_MOMENTS], const float sun[3])
{
    double sum = 0, mixed = 0;
    for (int i = 0; i < 3; i++)
        sum += (3 + 15 * (double)sun[i] * sun[i]) / 16 * moments[i] + 0.5 * sun[i] * moments[6 + i];
    mixed += (double)sun[0] * sun[1] * moments[3] + (double)sun[0] * sun[2] * moments[4];
    mixed += (double)sun[1] * sun[2] * moments[5];
    return (float)(sum + 15.0 / 8 * mixed);
}

/* The same from channels, as the shaders compute it. */
static float light_decode(const struct light_basis *basis, const float channels[LIGHT_CHANNELS],
                          const float sun[3])
{
    float x = sun[0], y = sun[1], z = sun[2];
    const float q[LIGHT_TERMS] = {1, x * x, y * y, z * z, x * y, x * z, y * z, x, y, z};
    float sum = 0;
    for (int k = 0; k <= LIGHT_CHANNELS; k++) {
        float factor = k ? channels[k - 1] : 1;
        for (int i = 0; i < LIGHT_TERMS; i++)
            sum += factor * basis->row[k][i] * q[i];
    }
    return sum;
}

/* The largest angle from a random direction (above the horizon when upper) to the nearest picture,
 * rad. */
static double largest_gap(enum views_layout layout, size_t side, bool upper)
{
    struct random random = random_seed(1, 1);
    double worst = 0;
    for (int k = 0; k < 2000; k++) {
        float v[3], d[3], nearest = -1;
        random_direction(&random, v);
        v[1] = upper ? fabsf(v[1]) : v[1];
        for (size_t i = 0; i < views_count(layout, side); i++) {
            views_direction(layout, side, i, d);
            assert_true(fabsf(dot3(d, d) - 1) < 1e-5f);
            nearest = fmaxf(nearest, dot3(v, d));
        }
        worst = fmax(worst, acos(fmin(nearest, 1)));
    }
    return worst;
}

static void test_views__directions_cover_what_the_layout_promises(void **state)
{
    (void)state;
    float d[3];
    views_direction(VIEWS_CIRCLE, 8, 2, d); /* a quarter turn from +z toward +x */
    assert_true(fabsf(d[0] - 1) < 1e-6f && fabsf(d[1]) < 1e-6f && fabsf(d[2]) < 1e-6f);
    views_direction(VIEWS_PLANES, 3, 4, d); /* the back of plane 1 */
    float front[3];
    views_direction(VIEWS_PLANES, 3, 1, front);
    assert_true(dot3(d, front) < -0.99999f);
    /* n x n points over half or all of the sphere: about sqrt(2 pi) / n and sqrt(4 pi) / n apart */
    assert_true(largest_gap(VIEWS_HEMISPHERE, 9, true) < 2.5066 / 8);
    assert_true(largest_gap(VIEWS_OCTAHEDRON, 17, false) < 3.5449 / 16);
    for (size_t i = 0; i < 81; i++) {
        views_direction(VIEWS_HEMISPHERE, 9, i, d);
        assert_true(d[1] >= -1e-6f);
    }
    assert_int_equal(views_side(VIEWS_OCTAHEDRON, 63), 7);
    assert_int_equal(views_side(VIEWS_OCTAHEDRON, 64), 8);
    assert_int_equal(views_side(VIEWS_HEMISPHERE, 1), 2);
    assert_int_equal(views_side(VIEWS_CIRCLE, 5), 5);
}

static void test_views__planes_are_right_handed_and_upright(void **state)
{
    (void)state;
    struct random random = random_seed(2, 1);
    for (int k = 0; k < 200; k++) {
        float v[3] = {0, k % 2 ? 1 : -1, 0}, right[3], up[3];
        if (k > 1)
            random_direction(&random, v);
        views_plane(v, right, up);
        float cross[3] = {right[1] * up[2] - right[2] * up[1], right[2] * up[0] - right[0] * up[2],
                          right[0] * up[1] - right[1] * up[0]};
        assert_true(dot3(cross, v) > 0.9999f && fabsf(dot3(right, right) - 1) < 1e-4f);
        assert_true(right[1] == 0 && up[1] >= 0);
    }
}

/* The moments against the diffuse terms themselves, averaged over many normals. */
static void test_light__moments_give_the_mean_diffuse_term(void **state)
{
    (void)state;
    struct random random = random_seed(3, 1);
    for (int trial = 0; trial < 40; trial++) {
        enum { NORMALS = 4000 };
        float moments[LIGHT_MOMENTS] = {0}, sun[3], bias[3];
        bool one_sided = trial % 2;
        double truth = 0;
        random_direction(&random, sun);
        random_direction(&random, bias);
        for (int k = 0; k < NORMALS; k++) {
            float n[3]; /* a broad lobe: what a texel full of leaves holds */
            random_direction(&random, n);
            if (dot3(n, bias) < 0)
                for (int i = 0; i < 3; i++)
                    n[i] = -n[i];
            light_moments_add(moments, n, one_sided, 1.0f / NORMALS);
            float d = dot3(n, sun);
            truth += (one_sided ? fmaxf(d, 0) : fabsf(d)) / NORMALS;
        }
        if (fabs(light_of_moments(moments, sun) - truth) > 0.03)
            fail_msg("trial %d: %g instead of %g", trial, light_of_moments(moments, sun), truth);
    }
}

static void test_light__a_single_normal_errs_by_three_sixteenths_at_most(void **state)
{
    (void)state;
    double mean = 0, worst = 0;
    enum { STEPS = 1000 };
    for (int k = 0; k < STEPS; k++) {
        float x = 2 * ((float)k + 0.5f) / STEPS - 1, moments[LIGHT_MOMENTS] = {0};
        const float normal[3] = {0, 1, 0}, sun[3] = {sqrtf(1 - x * x), x, 0};
        light_moments_add(moments, normal, 0, 1);
        double error = light_of_moments(moments, sun) - fabsf(x);
        mean += error / STEPS;
        worst = fmax(worst, fabs(error));
    }
    assert_true(fabs(mean) < 1e-3); /* energy is kept over all directions */
    assert_true(worst <= 3.0 / 16 + 1e-6 && worst > 0.18);
}

static void test_light__four_channels_hold_nearly_all_of_a_plants_light(void **state)
{
    (void)state;
    enum { TEXELS = 3000 };
    static float moments[TEXELS][LIGHT_MOMENTS];
    struct random random = random_seed(4, 1);
    struct light_sums sums = {0};
    struct light_basis basis;
    memset(moments, 0, sizeof moments);
    for (int k = 0; k < TEXELS; k++) {
        for (int leaf = 0; leaf < 6; leaf++) { /* facing the eye, some of bark */
            float n[3];
            random_direction(&random, n);
            n[2] = fabsf(n[2]);
            light_moments_add(moments[k], n, k % 5 == 0, 1 / 6.0f);
        }
        light_sums_add(&sums, moments[k], 1);
    }
    light_basis_fit(&sums, &basis);
    double error = 0, spread = 0, bias = 0;
    for (int k = 0; k < TEXELS; k++) {
        float channels[LIGHT_CHANNELS], sun[3];
        random_direction(&random, sun);
        light_encode(&basis, moments[k], channels);
        double truth = light_of_moments(moments[k], sun);
        double off = light_decode(&basis, channels, sun) - truth;
        double plain = light_of_moments(basis.mean, sun) - truth;
        error += off * off, spread += plain * plain, bias += off;
    }
    assert_true(error < 0.35 * spread);
    assert_true(sqrt(error / TEXELS) < 0.08 && fabs(bias / TEXELS) < 0.005);
}

static void test_light__an_empty_plant_answers_zero(void **state)
{
    (void)state;
    struct light_sums sums = {0};
    struct light_basis basis;
    const float sun[3] = {0, 1, 0}, channels[LIGHT_CHANNELS] = {0.5f, 0.5f, 0.5f, 0.5f};
    light_basis_fit(&sums, &basis);
    assert_true(light_decode(&basis, channels, sun) == 0);
}

static void random_texels(float *texels, size_t count, double density)
{
    struct random random = random_seed(5, 1);
    for (size_t i = 0; i < count; i++) {
        float *texel = texels + TEXEL_FLOATS * i;
        float alpha = random_float(&random) < density ? random_float(&random) : 0;
        for (int k = 0; k < 3; k++)
            texel[k] = alpha * random_float(&random);
        texel[3] = alpha;
        for (int k = 4; k < TEXEL_FLOATS; k++)
            texel[k] = random_float(&random);
    }
}

/* Sum over texels of channel k, times their weight in light. */
static double light_sum(const float *texels, size_t count, int k)
{
    double sum = 0;
    for (size_t i = 0; i < count; i++) {
        const float *t = texels + TEXEL_FLOATS * i;
        sum += (t[0] + t[1] + t[2] + 1e-4 * t[3]) * t[k];
    }
    return sum / (double)count;
}

static void test_mips__halving_keeps_coverage_colour_and_light(void **state)
{
    (void)state;
    enum { W = 32, H = 64 };
    static float fine[W * H * TEXEL_FLOATS], coarse[W * H / 4 * TEXEL_FLOATS];
    random_texels(fine, W * H, 0.4);
    atlas_halve(fine, W, H, coarse);
    for (int k = 0; k < TEXEL_FLOATS; k++) {
        double a = 0, b = 0;
        for (int i = 0; k < 4 && i < W * H; i++)
            a += fine[TEXEL_FLOATS * i + k] / (W * H);
        for (int i = 0; k < 4 && i < W * H / 4; i++)
            b += coarse[TEXEL_FLOATS * i + k] / (W * H / 4.0);
        if (k >= 4) {
            a = light_sum(fine, W * H, k);
            b = light_sum(coarse, W * H / 4, k);
        }
        assert_true(fabs(a - b) < 1e-4);
    }
    static float line[4 * TEXEL_FLOATS], point[2 * TEXEL_FLOATS];
    random_texels(line, 4, 1);
    atlas_halve(line, 1, 4, point);
    assert_true(fabsf(point[3] - 0.5f * (line[3] + line[TEXEL_FLOATS + 3])) < 1e-6f);
}

static void test_mips__the_alpha_test_passes_as_much_as_is_covered(void **state)
{
    (void)state;
    enum { W = 32, H = 32 };
    static float texels[W * H * TEXEL_FLOATS];
    static const double densities[] = {0.4, 0.6, 0.8, 1};
    for (int d = 0; d < 4; d++) {
        random_texels(texels, W * H, densities[d]);
        float scale = atlas_test_scale(texels, W, H, false);
        double wanted = 0;
        size_t passed = 0, points = 0;
        for (int i = 0; i < W * H; i++)
            wanted += texels[TEXEL_FLOATS * i + 3] / (W * H);
        for (float y = 0.03f; y < H - 1; y += 0.31f) /* bilinear, as a magnified texture is seen */
            for (float x = 0.03f; x < W - 1; x += 0.31f) {
                int i = (int)x, j = (int)y;
                float a[4], u = x - (float)i, v = y - (float)j;
                for (int k = 0; k < 4; k++)
                    a[k] =
                        fminf(1, scale * texels[TEXEL_FLOATS * ((j + k / 2) * W + i + k % 2) + 3]);
                passed +=
                    (1 - v) * ((1 - u) * a[0] + u * a[1]) + v * ((1 - u) * a[2] + u * a[3]) >= 0.5f;
                points++;
            }
        double share = (double)passed / (double)points;
        if (fabs(share - wanted) > 0.06 * wanted + 0.005)
            fail_msg("density %g: %g passes, %g is covered", densities[d], share, wanted);
        scale = atlas_test_scale(texels, W, H, true);
        for (int i = passed = 0; i < W * H; i++)
            passed += scale * texels[TEXEL_FLOATS * i + 3] >= 0.5f;
        if (fabs((double)passed / (W * H) - wanted) > 0.01)
            fail_msg("density %g: %zu nearest texels pass", densities[d], passed);
    }
    memset(texels, 0, sizeof texels);
    assert_true(atlas_test_scale(texels, W, H, false) == 1);
}

/* Every corner of a covered texel lies within the triangle, which touches the picture with each
 * side, and moves out by 1/4 when told so. */
static void triangle_holds(const struct atlas_view *view, const uint8_t (*albedo)[4], int width,
                           int height, float texel)
{
    for (int i = 0; i < 3; i++) {
        const float *a = view->triangle[i], *b = view->triangle[(i + 1) % 3];
        float u[2] = {b[0] - a[0], b[1] - a[1]}, least = INFINITY;
        float length = hypotf(u[0], u[1]);
        for (int k = 0; k < 4 * width * height; k++) {
            int x = k / 4 % width, y = k / 4 / width;
            float s = view->origin_s + texel * (float)(x + k % 2);
            float t = view->origin_t + texel * (float)(y + k / 2 % 2);
            if (albedo[y * width + x][3])
                least = fminf(least, (u[0] * (t - a[1]) - u[1] * (s - a[0])) / length);
        }
        assert_true(fabsf(least) < 1e-4f * length);
        float at[2] = {a[0] + 0.25f * a[2], a[1] + 0.25f * a[3]};
        float to[2] = {b[0] + 0.25f * b[2], b[1] + 0.25f * b[3]};
        float out = -(u[0] * (at[1] - a[1]) - u[1] * (at[0] - a[0])) / length;
        float end = -(u[0] * (to[1] - a[1]) - u[1] * (to[0] - a[0])) / length;
        assert_true(fabsf(out - 0.25f) < 1e-3f && fabsf(end - 0.25f) < 1e-3f);
    }
}

/* A rectangle has no three sides that make a triangle, the ellipse on a stem has. */
static void test_outline__the_triangle_holds_a_rectangle(void **state)
{
    (void)state;
    enum { W = 32, H = 48 };
    static uint8_t albedo[W * H][4];
    static uint16_t depth[W * H];
    struct arena *arena = arena_create(0);
    for (int y = 8; y < 40; y++)
        for (int x = 4; x < 20; x++)
            albedo[y * W + x][3] = 255;
    struct atlas_view view = {.origin_s = 1, .origin_t = -2};
    atlas_outline(arena, (const uint8_t(*)[4])albedo, depth, W, H, 0.5f, 10, &view);
    triangle_holds(&view, (const uint8_t(*)[4])albedo, W, H, 0.5f);
    arena_destroy(arena);
}

static void test_outline__the_polygon_holds_the_picture_tightly(void **state)
{
    (void)state;
    enum { W = 64, H = 96 };
    static uint8_t albedo[W * H][4];
    static uint16_t depth[W * H];
    struct arena *arena = arena_create(0);
    memset(albedo, 0, sizeof albedo);
    size_t covered = 0;
    for (int y = 0; y < H; y++)
        for (int x = 0; x < W; x++) {
            double u = (x - 30) / 20.0, v = (y - 50) / 40.0; /* a tall ellipse on a stem */
            bool in = u * u + v * v < 1 || (y < 20 && abs(x - 30) < 3);
            albedo[y * W + x][3] = in ? 255 : 0;
            /* a tilted plane: depth = 0.2 + 0.1 s - 0.05 t, radius 10, texel 0.1 */
            double z = 0.2 + 0.1 * (0.1 * (x + 0.5) - 3) - 0.05 * (0.1 * (y + 0.5) - 5);
            depth[y * W + x] = (uint16_t)lrint((z / 10 + 1) * 0.5 * 65535);
            covered += in;
        }
    struct atlas_view view = {.origin_s = -3, .origin_t = -5};
    atlas_outline(arena, (const uint8_t(*)[4])albedo, depth, W, H, 0.1f, 10, &view);
    double area = 0;
    for (int i = 0; i < ATLAS_HULL; i++) {
        const float *a = view.hull[i], *b = view.hull[(i + 1) % ATLAS_HULL];
        area += 0.5 * (a[0] * b[1] - a[1] * b[0]);
        for (int k = 0; k < 4 * W * H; k++) {
            int x = k / 4 % W, y = k / 4 / W;
            if (!albedo[y * W + x][3])
                continue;
            float s = -3 + 0.1f * (float)(x + k % 2), t = -5 + 0.1f * (float)(y + k / 2 % 2);
            assert_true((b[0] - a[0]) * (t - a[1]) - (b[1] - a[1]) * (s - a[0]) > -1e-3f);
        }
    }
    triangle_holds(&view, (const uint8_t(*)[4])albedo, W, H, 0.1f);
    double box = (view.high[0] - view.low[0]) * (view.high[1] - view.low[1]);
    assert_true(area < 0.88 * box && area > 0.01 * (double)covered);
    assert_true(fabsf(view.low[1] + 5) < 1e-5f && fabsf(view.high[0] - view.low[0] - 3.9f) < 0.11f);
    assert_true(fabsf(view.covered_m2 - 0.01f * (float)covered) < 1e-3f);
    assert_true(fabsf(view.depth_plane[0] - 0.2f) < 1e-3f);
    assert_true(fabsf(view.depth_plane[1] - 0.1f) < 1e-3f);
    assert_true(fabsf(view.depth_plane[2] + 0.05f) < 1e-3f);
    memset(albedo, 0, sizeof albedo); /* nothing to see: a polygon of no area */
    atlas_outline(arena, (const uint8_t(*)[4])albedo, depth, W, H, 0.1f, 10, &view);
    for (int i = 0; i < ATLAS_HULL; i++)
        assert_true(view.hull[i][0] == 0 && view.hull[i][1] == 0);
    arena_destroy(arena);
}

/* A ball of bark about (0, 1, 0). */
static struct mesh *ball(struct arena *arena, int rings)
{
    struct mesh *mesh = tree_mesh(arena, (uint32_t)(4 * rings * rings));
    mesh->triangles_count = mesh->vertices_count = 0;
    static const float white[3] = {1, 1, 1};
    for (int i = 0; i < rings; i++)
        for (int j = 0; j < 2 * rings; j++) {
            float p[4][3];
            for (int k = 0; k < 4; k++) {
                double polar = M_PI * (i + (k == 1 || k == 2)) / rings;
                double angle = M_PI * (j + (k >= 2)) / rings;
                p[k][0] = (float)(sin(polar) * sin(angle));
                p[k][1] = (float)(1 + cos(polar));
                p[k][2] = (float)(sin(polar) * cos(angle));
            }
            float low[3][3], high[3][3];
            for (int k = 0; k < 3; k++)
                for (int axis = 0; axis < 3; axis++) {
                    low[k][axis] = p[k][axis];
                    high[k][axis] = p[k ? k + 1 : 0][axis];
                }
            if (i + 1 < rings)
                tree_triangle(mesh, (const float(*)[3])low, white);
            if (i > 0)
                tree_triangle(mesh, (const float(*)[3])high, white);
        }
    for (size_t i = 0; i < mesh->vertices_count; i++)
        for (int axis = 0; axis < 3; axis++)
            mesh->normals[i][axis] = mesh->positions[i][axis] - (axis == 1);
    mesh->parts_count = 1;
    mesh->parts[0].triangles_count = (uint32_t)mesh->triangles_count;
    for (int k = 0; k < 3; k++)
        mesh->materials[0].albedo[k] = 0.5f;
    mesh_bounds(mesh);
    return mesh;
}

struct oven {
    struct arena *arena;
    struct error error;
    struct workspace workspace;
};

static struct oven oven_open(unsigned effects)
{
    struct oven oven = {.arena = arena_create(0)};
    struct gl *gl;
    if (gl_context_create(NULL, 2, &gl, &oven.error) != STATUS_OK)
        fail_msg("%s", oven.error.text);
    oven.workspace = (struct workspace){.arena = oven.arena, .gl = gl, .effects = effects};
    return oven;
}

static void oven_close(struct oven *oven)
{
    gl_context_destroy(oven->workspace.gl);
    arena_destroy(oven->arena);
}

/* A Lambert ball seen from every side: a disc of area pi; lit from the eye its mean diffuse term is
 * 2/3, from the side 1/3 (half the disc) times 4 / (3 pi) ... by quadrature over the disc. */
static void test_bake__a_ball_is_a_disc_with_a_balls_light(void **state)
{
    (void)state;
    struct oven oven = oven_open(EFFECT_TWO_SIDED);
    struct atlas_request request = {
        .layout = VIEWS_HEMISPHERE, .side = 3, .resolution_px = 64, .samples = 4};
    struct atlas_plant plant = {0};
    oven.workspace.error = &oven.error;
    if (atlas_bake(&oven.workspace, oven.arena, ball(oven.arena, 32), &request, true, &plant) !=
        STATUS_OK)
        fail_msg("%s", oven.error.text);
    assert_int_equal(plant.views_count, 9);
    size_t pixels = (size_t)plant.width_px * (size_t)plant.height_px;
    static const float suns[3][3] = {{0, 0, 1}, {1, 0, 0}, {0.6f, 0.64f, 0.48f}};
    for (size_t i = 0; i < plant.views_count; i++) {
        assert_true(fabs(plant.views[i].covered_m2 - M_PI) < 0.01 * M_PI);
        assert_true(fabsf(plant.views[i].depth_plane[0] - 0.6667f) <
                    0.02f); /* mean of sqrt(1-r^2) */
        for (int s = 0; s < 3; s++) {
            double light = 0, weight = 0, truth = 0, points = 0;
            for (size_t k = i * pixels; k < (i + 1) * pixels; k++) {
                float channels[LIGHT_CHANNELS];
                for (int c = 0; c < LIGHT_CHANNELS; c++)
                    channels[c] = plant.channels[k][c] / 255.0f;
                weight += plant.albedo[k][3];
                light += plant.albedo[k][3] * light_decode(&plant.light, channels, suns[s]);
            }
            for (double x = -0.995; x < 1; x += 0.01)
                for (double y = -0.995; y < 1; y += 0.01)
                    if (x * x + y * y < 1) {
                        double z = sqrt(1 - x * x - y * y);
                        truth += fmax(0, x * suns[s][0] + y * suns[s][1] + z * suns[s][2]);
                        points++;
                    }
            if (fabs(light / weight - truth / points) > 0.02)
                fail_msg("view %zu, sun %d: %g instead of %g", i, s, light / weight,
                         truth / points);
        }
    }
    oven_close(&oven);
}

/* A leaf of 2 m x 2 m whose texture is opaque on one half: alpha 0.5 on is leaf, below is nothing.
 */
static void test_bake__a_leafs_texture_cuts_it(void **state)
{
    (void)state;
    struct oven oven = oven_open(EFFECT_TWO_SIDED);
    oven.workspace.error = &oven.error;
    struct mesh *mesh = tree_mesh(oven.arena, 2);
    mesh->triangles_count = mesh->vertices_count = 0;
    static const float white[3] = {1, 1, 1};
    static const float low[3][3] = {{-1, 0, 0}, {1, 0, 0}, {1, 2, 0}};
    static const float high[3][3] = {{-1, 0, 0}, {1, 2, 0}, {-1, 2, 0}};
    tree_triangle(mesh, low, white);
    tree_triangle(mesh, high, white);
    mesh->uvs = arena_alloc(oven.arena, 6, sizeof *mesh->uvs);
    for (int i = 0; i < 6; i++) {
        mesh->uvs[i][0] = 0.5f + 0.5f * mesh->positions[i][0];
        mesh->uvs[i][1] = 0.5f * mesh->positions[i][1];
    }
    float rgba[4 * 4 * 4];
    for (int i = 0; i < 16; i++) {
        const float texel[4] = {0.2f, 0.4f, 0.1f, i / 4 < 2 ? 0.9f : 0.1f}; /* the lower half */
        memcpy(rgba + 4 * i, texel, sizeof texel);
    }
    struct texture texture = {4, 4, rgba};
    mesh->materials[0].texture = &texture;
    mesh->materials[0].kind = MATERIAL_LEAF;
    for (int k = 0; k < 3; k++)
        mesh->materials[0].albedo[k] = 1;
    mesh->parts_count = 1;
    mesh->parts[0].triangles_count = 2;
    mesh_bounds(mesh);
    struct atlas_request request = {
        .layout = VIEWS_CIRCLE, .side = 2, .resolution_px = 64, .samples = 4};
    struct atlas_plant plant = {0};
    assert_int_equal(atlas_bake(&oven.workspace, oven.arena, mesh, &request, true, &plant),
                     STATUS_OK);
    for (int i = 0; i < 2; i++) {
        const struct atlas_view *view = &plant.views[i];
        /* bilinear alpha wraps: it passes 1/2 midway between rows, at the middle and at the border
         */
        assert_true(fabsf(view->covered_m2 - 2) < 0.08f);
        assert_true(view->low[1] < -0.9f && view->high[1] < 0.2f);
    }
    size_t middle = (size_t)(plant.height_px / 4 * plant.width_px + plant.width_px / 2);
    assert_int_equal(plant.albedo[middle][3], 255);
    assert_true(fabsf(plant.albedo[middle][1] / 255.0f * plant.albedo_scale - 0.4f) < 0.01f);
    assert_true(fabsf(plant.albedo[middle][2] / 255.0f * plant.albedo_scale - 0.1f) < 0.01f);
    oven_close(&oven);
}

static void test_atlas__the_cache_gives_the_same_pictures(void **state)
{
    (void)state;
    char folder[] = "/tmp/treeline-atlas-XXXXXX", command[64];
    assert_non_null(mkdtemp(folder));
    float *pictures[3];
    const char *kept = getenv("TREELINE_CACHE");
    char *before = kept ? strdup(kept) : NULL;
    for (int k = 0; k < 3; k++) { /* cold, warm, off */
        setenv("TREELINE_CACHE", k < 2 ? folder : "off", 1);
        struct arena *arena = arena_create(0);
        struct plant *plant = plant_from_mesh(arena, "lopsided", tree_mesh(arena, 100));
        struct scene *scene = tree_scene(arena, plant, 1, 1);
        struct view view = tree_view(scene, 0.4f, 0.2f, 300, 9);
        struct frame *frame =
            tree_draw(arena, tree_method("billboards"), "resolution=64", scene, 0, &view, NULL);
        pictures[k] = malloc(TREE_PIXELS * 16);
        memcpy(pictures[k], frame->rgba, TREE_PIXELS * 16);
        arena_destroy(arena);
    }
    if (before)
        setenv("TREELINE_CACHE", before, 1);
    else
        unsetenv("TREELINE_CACHE");
    snprintf(command, sizeof command, "ls %s/* | grep -q atlas", folder);
    assert_int_equal(system(command), 0);
    assert_memory_equal(pictures[0], pictures[1], TREE_PIXELS * 16);
    assert_memory_equal(pictures[0], pictures[2], TREE_PIXELS * 16);
    snprintf(command, sizeof command, "rm -r %s", folder);
    assert_int_equal(system(command), 0);
    for (int k = 0; k < 3; k++)
        free(pictures[k]);
    free(before);
}

static void test_atlas__too_many_pictures_are_refused_by_number(void **state)
{
    (void)state;
    struct oven oven = oven_open(0);
    oven.workspace.error = &oven.error;
    struct plant *plant = plant_from_mesh(oven.arena, "lopsided", tree_mesh(oven.arena, 4));
    struct scene *scene = tree_scene(oven.arena, plant, 1, 1);
    struct atlas_request request = {
        .layout = VIEWS_CIRCLE, .side = 4096, .resolution_px = 8, .samples = 1};
    struct atlas *atlas;
    setenv("TREELINE_CACHE", "off", 1);
    enum status status = atlas_build(&oven.workspace, scene, &request, &atlas);
    unsetenv("TREELINE_CACHE");
    assert_int_equal(status, STATUS_INVALID);
    assert_non_null(strstr(oven.error.text, "4096 pictures"));
    oven_close(&oven);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_views__directions_cover_what_the_layout_promises),
        cmocka_unit_test(test_views__planes_are_right_handed_and_upright),
        cmocka_unit_test(test_light__moments_give_the_mean_diffuse_term),
        cmocka_unit_test(test_light__a_single_normal_errs_by_three_sixteenths_at_most),
        cmocka_unit_test(test_light__four_channels_hold_nearly_all_of_a_plants_light),
        cmocka_unit_test(test_light__an_empty_plant_answers_zero),
        cmocka_unit_test(test_mips__halving_keeps_coverage_colour_and_light),
        cmocka_unit_test(test_mips__the_alpha_test_passes_as_much_as_is_covered),
        cmocka_unit_test(test_outline__the_polygon_holds_the_picture_tightly),
        cmocka_unit_test(test_outline__the_triangle_holds_a_rectangle),
        cmocka_unit_test(test_bake__a_ball_is_a_disc_with_a_balls_light),
        cmocka_unit_test(test_bake__a_leafs_texture_cuts_it),
        cmocka_unit_test(test_atlas__the_cache_gives_the_same_pictures),
        cmocka_unit_test(test_atlas__too_many_pictures_are_refused_by_number),
    };
    return cmocka_run_group_tests_name("atlas", tests, NULL, NULL);
}
