/* One ray against one frustum with flat ends, in double precision. */
#include "wall/embree_cones.h"

#include <math.h>

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* The frustum, and the ray from the point of it that is nearest to the frustum's first end. */
struct meeting {
    double axis[3], height, radius[2], slope; /* slope: of the radius along the axis */
    double from[3], along[3];
    double from_axis, along_axis; /* their parts along the axis */
    double near, far;             /* from that point on */
    double best;                  /* the nearest hit so far, far when there is none */
    int face;                     /* 0, 1: an end; 2: the side; -1: none */
};

static void meet(struct meeting *m, double at, int face)
{
    if (at > m->near && at < m->best) {
        m->best = at;
        m->face = face;
    }
}

static void meet_side(struct meeting *m)
{
    double k = m->slope, radius = m->radius[0] + k * m->from_axis;
    double a = dot(m->along, m->along) - m->along_axis * m->along_axis * (1 + k * k);
    double b = dot(m->from, m->along) - m->from_axis * m->along_axis - k * m->along_axis * radius;
    double c = dot(m->from, m->from) - m->from_axis * m->from_axis - radius * radius;
    double root = b * b - a * c;
    if (root < 0 || a == 0)
        return;
    root = sqrt(root);
    for (int sign = -1; sign <= 1; sign += 2) {
        double at = (-b + sign * root) / a, height = m->from_axis + at * m->along_axis;
        if (height >= 0 && height <= m->height)
            meet(m, at, 2);
    }
}

static void meet_ends(struct meeting *m)
{
    for (int end = 0; end < 2 && m->along_axis != 0; end++) {
        double height = end * m->height, at = (height - m->from_axis) / m->along_axis, square = 0;
        for (int i = 0; i < 3; i++) {
            double out = m->from[i] + at * m->along[i] - height * m->axis[i];
            square += out * out;
        }
        if (square <= m->radius[end] * m->radius[end])
            meet(m, at, end);
    }
}

bool embree_cone_hit(const float ends[8], const float origin[3], const float direction[3],
                     float near, float far, float *distance, float normal[3])
{
    struct meeting m = {.radius = {(double)ends[3], (double)ends[7]}, .face = -1};
    for (int i = 0; i < 3; i++) {
        m.axis[i] = (double)ends[4 + i] - (double)ends[i];
        m.from[i] = (double)origin[i] - (double)ends[i];
        m.along[i] = (double)direction[i];
    }
    m.height = sqrt(dot(m.axis, m.axis));
    double nearest = -dot(m.from, m.along) / dot(m.along, m.along);
    for (int i = 0; i < 3; i++) {
        m.axis[i] /= m.height;
        m.from[i] += nearest * m.along[i];
    }
    m.slope = (m.radius[1] - m.radius[0]) / m.height;
    m.from_axis = dot(m.from, m.axis);
    m.along_axis = dot(m.along, m.axis);
    m.near = (double)near - nearest;
    m.best = m.far = (double)far - nearest;
    meet_side(&m);
    meet_ends(&m);
    if (m.face < 0)
        return false;
    double height = m.from_axis + m.best * m.along_axis;
    double lean = height + m.slope * (m.radius[0] + m.slope * height);
    for (int i = 0; i < 3; i++)
        normal[i] = (float)(m.face == 2 ? m.from[i] + m.best * m.along[i] - lean * m.axis[i]
                                        : (2 * m.face - 1) * m.axis[i]);
    *distance = (float)(m.best + nearest);
    return true;
}
