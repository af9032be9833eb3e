/* Moments of normals and their principal components in the metric of the light they reflect. */
#include "bake/atlas_light.h"

#include <math.h>
#include <string.h>

enum { N = LIGHT_MOMENTS };

/* Coefficients of D on the nine moments for one L. */
static void response(const float sun[3], double b[N])
{
    for (int i = 0; i < 3; i++) {
        b[i] = 3.0 / 16 + 15.0 / 16 * sun[i] * sun[i];
        b[6 + i] = 0.5 * sun[i];
    }
    b[3] = 15.0 / 8 * sun[0] * sun[1];
    b[4] = 15.0 / 8 * sun[0] * sun[2];
    b[5] = 15.0 / 8 * sun[1] * sun[2];
}

void light_moments_add(float moments[N], const float normal[3], int one_sided, float weight)
{
    float w = one_sided ? 0.5f * weight : weight, n = one_sided ? weight : 0;
    float x = normal[0], y = normal[1], z = normal[2];
    const float products[N] = {w * x * x, w * y * y, w * z * z, w * x * y, w * x * z,
                               w * y * z, n * x,     n * y,     n * z};
    for (int i = 0; i < N; i++)
        moments[i] += products[i];
}

void light_sums_add(struct light_sums *sums, const float moments[N], double weight)
{
    sums->weight += weight;
    for (int i = 0; i < N; i++) {
        sums->first[i] += weight * moments[i];
        for (int j = 0; j <= i; j++)
            sums->second[i][j] += weight * moments[i] * moments[j];
    }
}

/* G = mean over the sphere of b b', by a Fibonacci lattice, and its Cholesky factor G = C C'. */
static void metric_factor(double c[N][N])
{
    enum { DIRECTIONS = 1024 };
    double g[N][N] = {{0}};
    for (int k = 0; k < DIRECTIONS; k++) {
        double y = 1 - (2.0 * k + 1) / DIRECTIONS, r = sqrt(1 - y * y);
        double angle = k * M_PI * (3 - sqrt(5));
        const float sun[3] = {(float)(r * cos(angle)), (float)y, (float)(r * sin(angle))};
        double b[N];
        response(sun, b);
        for (int i = 0; i < N; i++)
            for (int j = 0; j < N; j++)
                g[i][j] += b[i] * b[j] / DIRECTIONS;
    }
    for (int i = 0; i < N; i++)
        for (int j = 0; j <= i; j++) {
            double sum = g[i][j];
            for (int k = 0; k < j; k++)
                sum -= c[i][k] * c[j][k];
            c[i][j] = i == j ? sqrt(sum) : sum / c[j][j];
        }
}

/* One Jacobi rotation that makes a[p][q] zero; the rotations are collected in the columns of v. */
static void rotate(double a[N][N], double v[N][N], int p, int q)
{
    if (fabs(a[p][q]) < 1e-300)
        return;
    double theta = (a[q][q] - a[p][p]) / (2 * a[p][q]);
    double t = copysign(1, theta) / (fabs(theta) + sqrt(theta * theta + 1));
    double c = 1 / sqrt(t * t + 1), s = t * c;
    for (int k = 0; k < N; k++) {
        double x = a[k][p], y = a[k][q];
        a[k][p] = c * x - s * y;
        a[k][q] = s * x + c * y;
    }
    for (int k = 0; k < N; k++) {
        double x = a[p][k], y = a[q][k];
        a[p][k] = c * x - s * y;
        a[q][k] = s * x + c * y;
        x = v[k][p], y = v[k][q];
        v[k][p] = c * x - s * y;
        v[k][q] = s * x + c * y;
    }
}

/* Eigenvalues of the symmetric a are left on its diagonal, eigenvectors in the columns of v (cyclic
 * Jacobi, Golub and Van Loan, Matrix Computations, 8.5). */
static void eigen(double a[N][N], double v[N][N])
{
    memset(v, 0, sizeof(double[N][N]));
    for (int i = 0; i < N; i++)
        v[i][i] = 1;
    for (int sweep = 0; sweep < 20; sweep++)
        for (int p = 0; p < N; p++)
            for (int q = p + 1; q < N; q++)
                rotate(a, v, p, q);
}

/* Covariance of C'(moments). */
static void covariance_in_metric(const struct light_sums *sums, double c[N][N], double a[N][N])
{
    double covariance[N][N], half[N][N];
    for (int i = 0; i < N; i++)
        for (int j = 0; j < N; j++) {
            double second = i >= j ? sums->second[i][j] : sums->second[j][i];
            covariance[i][j] =
                (second - sums->first[i] * sums->first[j] / sums->weight) / sums->weight;
        }
    for (int i = 0; i < N; i++)
        for (int j = 0; j < N; j++) {
            half[i][j] = 0;
            for (int k = 0; k < N; k++)
                half[i][j] += c[k][i] * covariance[k][j];
        }
    for (int i = 0; i < N; i++)
        for (int j = 0; j < N; j++) {
            a[i][j] = 0;
            for (int k = 0; k < N; k++)
                a[i][j] += half[i][k] * c[k][j];
        }
}

/* A row of moments becomes a row of shader terms (1, xx, yy, zz, xy, xz, yz, x, y, z). */
static void row_add(float row[12], const double moments[N], double factor)
{
    row[0] += (float)(factor * 3.0 / 16 * (moments[0] + moments[1] + moments[2]));
    for (int i = 0; i < 3; i++) {
        row[1 + i] += (float)(factor * 15.0 / 16 * moments[i]);
        row[4 + i] += (float)(factor * 15.0 / 8 * moments[3 + i]);
        row[7 + i] += (float)(factor * 0.5 * moments[6 + i]);
    }
}

/* Channel k holds the component along the k-th longest axis, with four standard deviations to
 * either side. */
static void channels_fit(double a[N][N], double v[N][N], double c[N][N], struct light_basis *basis)
{
    for (int k = 0; k < LIGHT_CHANNELS; k++) {
        int longest = 0;
        for (int i = 1; i < N; i++)
            if (a[i][i] > a[longest][longest])
                longest = i;
        double range = 8 * sqrt(fmax(a[longest][longest], 1e-8)), axis[N];
        a[longest][longest] = -1;
        for (int i = N - 1; i >= 0; i--) { /* axis = C'^-1 v, so that D = b . axis */
            axis[i] = v[i][longest];
            for (int j = i + 1; j < N; j++)
                axis[i] -= c[j][i] * axis[j];
            axis[i] /= c[i][i];
        }
        for (int i = 0; i < N; i++) {
            double sum = 0;
            for (int j = 0; j < N; j++)
                sum += c[i][j] * v[j][longest];
            basis->encode[k][i] = (float)(sum / range);
        }
        row_add(basis->row[k + 1], axis, range);
        row_add(basis->row[0], axis, -0.5 * range);
    }
}

void light_basis_fit(const struct light_sums *sums, struct light_basis *basis)
{
    memset(basis, 0, sizeof *basis);
    if (!(sums->weight > 0))
        return;
    double c[N][N] = {{0}}, a[N][N], v[N][N], mean[N];
    metric_factor(c);
    covariance_in_metric(sums, c, a);
    eigen(a, v);
    for (int i = 0; i < N; i++) {
        mean[i] = sums->first[i] / sums->weight;
        basis->mean[i] = (float)mean[i];
    }
    row_add(basis->row[0], mean, 1);
    channels_fit(a, v, c, basis);
}

void light_encode(const struct light_basis *basis, const float moments[N],
                  float channels[LIGHT_CHANNELS])
{
    for (int k = 0; k < LIGHT_CHANNELS; k++) {
        float sum = 0.5f;
        for (int i = 0; i < N; i++)
            sum += basis->encode[k][i] * (moments[i] - basis->mean[i]);
        channels[k] = fminf(fmaxf(sum, 0), 1);
    }
}
