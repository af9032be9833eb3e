/* Pictures of a trial beside the reference: coverage, and where there may be none. */
#include "conform/trial.h"

#include <math.h>

/* RMS difference of the mean coverage of boxes of 8 x 8 pixels. */
static double blurred_difference(const struct frame *a, const struct frame *b)
{
    enum { BOX = 8 };
    double sum = 0, count = 0;
    for (int y = 0; y + BOX <= a->height_px; y += BOX)
        for (int x = 0; x + BOX <= a->width_px; x += BOX) {
            double difference = 0;
            for (int i = 0; i < BOX * BOX; i++) {
                size_t pixel = (size_t)(y + i / BOX) * (size_t)a->width_px + (size_t)(x + i % BOX);
                difference += (double)a->rgba[4 * pixel + 3] - (double)b->rgba[4 * pixel + 3];
            }
            sum += pow(difference / (BOX * BOX), 2);
            count++;
        }
    return count > 0 ? sqrt(sum / count) : 0;
}

enum status trial_liken(struct trial *trial, const struct frame *frame, const struct view *view,
                        struct likeness *likeness)
{
    struct frame *reference;
    enum status status = trial_reference(trial, view, trial->workspace.effects, &reference);
    if (status)
        return status;
    likeness->pictures++;
    likeness->coverage += frame_coverage(frame);
    likeness->reference += frame_coverage(reference);
    likeness->blurred += blurred_difference(frame, reference);
    return STATUS_OK;
}

enum status likeness_covers(struct subject *subject, const struct likeness *likeness, double more)
{
    double drawn = likeness->coverage / (double)likeness->pictures;
    double wanted = likeness->reference / (double)likeness->pictures;
    subject_note(subject, "coverage %.3g, reference %.3g", drawn, wanted);
    if (!(fabs(drawn - wanted) <= wanted / 6 + more))
        return subject_fail(subject, "coverage is %.3g, the reference's %.3g", drawn, wanted);
    return STATUS_OK;
}

enum status trial_covers(struct trial *trial, const struct frame *frame, const struct view *view)
{
    struct likeness likeness = {0};
    enum status status = trial_liken(trial, frame, view, &likeness);
    return status ? status : likeness_covers(trial->subject, &likeness, 0);
}

enum status trial_bounded(struct trial *trial, const struct frame *frame, const struct view *view)
{
    const struct instance *tree = trial->scene->instances;
    float focal_px = 0.5f * (float)view->height_px / tanf(0.5f * view->fov_y_rad), middle[3];
    float reach_m = tree->scale * (float)(0.65 * WORLD_TREE_M), distance2 = 0;
    for (int i = 0; i < 3; i++) {
        middle[i] = tree->position_m[i] - view->eye_m[i];
        middle[i] += i == 1 ? tree->scale * (float)(0.5 * WORLD_TREE_M) : 0;
        distance2 += middle[i] * middle[i];
    }
    reach_m += 2 * sqrtf(distance2) / focal_px;
    for (int y = 0; y < frame->height_px; y++)
        for (int x = 0; x < frame->width_px; x++) {
            float ray[3], along = 0;
            view_ray(view, (float)x + 0.5f, (float)y + 0.5f, ray);
            for (int i = 0; i < 3; i++)
                along += ray[i] * middle[i];
            float alpha = frame->rgba[4 * ((size_t)y * (size_t)frame->width_px + (size_t)x) + 3];
            if (alpha > 0.01f && distance2 - along * along > reach_m * reach_m)
                return subject_fail(trial->subject,
                                    "pixel %d, %d has coverage %.3g, far from the only tree", x, y,
                                    (double)alpha);
        }
    return STATUS_OK;
}
