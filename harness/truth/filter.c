/* Separable convolution of single planes; the inner loops run along a row, so that they vectorise.
 */
#include "truth/filter.h"

static int border_index(int index, int count, enum border border)
{
    if (border == BORDER_REPLICATE)
        return index < 0 ? 0 : index >= count ? count - 1 : index;
    int period = 2 * count, wrapped = index % period;
    wrapped += wrapped < 0 ? period : 0;
    return wrapped < count ? wrapped : period - 1 - wrapped;
}

/* out += weight in, count doubles. */
static void add_scaled(const double *restrict in, double weight, int count, double *restrict out)
{
    for (int x = 0; x < count; x++)
        out[x] += weight * in[x];
}

static double row_value(const double *row, int x, int width_px, const struct kernel *kernel)
{
    double sum = 0;
    for (int k = -kernel->radius_px; k <= kernel->radius_px; k++)
        sum += kernel->weights[k + kernel->radius_px] *
               row[border_index(x + k, width_px, kernel->border)];
    return sum;
}

static void filter_row(const double *row, int width_px, const struct kernel *kernel, double *out)
{
    int radius = kernel->radius_px, inner = width_px - 2 * radius;
    int left = inner > 0 ? radius : width_px;
    for (int x = 0; x < left; x++)
        out[x] = row_value(row, x, width_px, kernel);
    if (inner <= 0)
        return;
    for (int x = left; x < left + inner; x++)
        out[x] = 0;
    for (int k = 0; k <= 2 * radius; k++)
        add_scaled(row + k, kernel->weights[k], inner, out + left);
    for (int x = left + inner; x < width_px; x++)
        out[x] = row_value(row, x, width_px, kernel);
}

void filter_rows(const double *in, struct extent extent, const struct kernel *kernel, double *out)
{
#pragma omp parallel for
    for (int y = 0; y < extent.height_px; y++) {
        size_t start = (size_t)y * (size_t)extent.width_px;
        filter_row(in + start, extent.width_px, kernel, out + start);
    }
}

void filter_columns(const double *in, struct extent extent, const struct kernel *kernel,
                    double *out)
{
    size_t width = (size_t)extent.width_px;
#pragma omp parallel for
    for (int y = 0; y < extent.height_px; y++) {
        double *row = out + (size_t)y * width;
        for (size_t x = 0; x < width; x++)
            row[x] = 0;
        for (int k = -kernel->radius_px; k <= kernel->radius_px; k++) {
            int source = border_index(y + k, extent.height_px, kernel->border);
            add_scaled(in + (size_t)source * width, kernel->weights[k + kernel->radius_px],
                       extent.width_px, row);
        }
    }
}
