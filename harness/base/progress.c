/* The progress bar. */
#include "base/progress.h"

#include "base/clock.h"

#include <math.h>
#include <pthread.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

struct progress {
    char title[64];
    double total, done, started_seconds, drawn_seconds;
    bool quiet, terminal, drawn;
    pthread_mutex_t mutex;
};

struct progress *progress_start(const char *title, double total, _Bool quiet)
{
    struct progress *progress = calloc(1, sizeof *progress);
    if (!progress)
        return NULL;
    snprintf(progress->title, sizeof progress->title, "%s", title);
    progress->total = total > 0 ? total : 1;
    progress->started_seconds = progress->drawn_seconds = clock_wall_seconds();
    progress->terminal = isatty(STDERR_FILENO);
    progress->quiet = quiet;
    pthread_mutex_init(&progress->mutex, NULL);
    return progress;
}

static void duration_print(double seconds, char *text, size_t size)
{
    long s = lround(seconds);
    if (s >= 3600)
        snprintf(text, size, "%ld h %02ld min", s / 3600, s % 3600 / 60);
    else if (s >= 60)
        snprintf(text, size, "%ld min %02ld s", s / 60, s % 60);
    else
        snprintf(text, size, "%ld s", s);
}

static void draw(struct progress *progress, const char *label, double now)
{
    double share = fmin(1, fmax(0, progress->done / progress->total));
    double spent = now - progress->started_seconds;
    char left[48] = "";
    if (share > 0 && share < 1) {
        char time[32];
        duration_print(spent / share - spent, time, sizeof time);
        snprintf(left, sizeof left, ", %s left", time);
    }
    if (progress->terminal) {
        char bar[21];
        int full = (int)(share * 20);
        memset(bar, '-', 20);
        memset(bar, '#', (size_t)full);
        bar[20] = 0;
        fprintf(stderr, "\r\033[K%s [%s] %3.0f %%%s  %.60s", progress->title, bar, 100 * share,
                left, label ? label : "");
    } else {
        fprintf(stderr, "%s: %.0f %%%s%s%s\n", progress->title, 100 * share, left,
                label ? ", " : "", label ? label : "");
    }
    progress->drawn_seconds = now;
    progress->drawn = true;
    fflush(stderr);
}

void progress_update(struct progress *progress, double done, const char *label)
{
    if (!progress || progress->quiet)
        return;
    pthread_mutex_lock(&progress->mutex);
    progress->done = done;
    double now = clock_wall_seconds();
    double pause = progress->terminal ? 0.1 : 10;
    if (now - progress->drawn_seconds >= pause || (progress->terminal && !progress->drawn))
        draw(progress, label, now);
    pthread_mutex_unlock(&progress->mutex);
}

void progress_end(struct progress *progress)
{
    if (!progress)
        return;
    if (progress->terminal && progress->drawn)
        fputs("\r\033[K", stderr);
    pthread_mutex_destroy(&progress->mutex);
    free(progress);
}
