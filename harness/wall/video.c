/* Runs ffmpeg on a folder of numbered frames. */
#include "wall/video.h"

#include "wall/program.h"

#include <stdio.h>

static const double timeout_seconds = 600;

enum status video_write(const char *folder, const char *name, int frames_per_second,
                        struct error *error)
{
    char rate[16];
    snprintf(rate, sizeof rate, "%d", frames_per_second);
    /* Sides of odd length are padded by a pixel: H.264 in 4:2:0 has none. */
    const char *const arguments[] = {"ffmpeg",
                                     "-nostdin",
                                     "-y",
                                     "-loglevel",
                                     "error",
                                     "-framerate",
                                     rate,
                                     "-i",
                                     "frame-%05d.png",
                                     "-vf",
                                     "pad=ceil(iw/2)*2:ceil(ih/2)*2",
                                     "-c:v",
                                     "libx264",
                                     "-pix_fmt",
                                     "yuv420p",
                                     "-crf",
                                     "16",
                                     name,
                                     NULL};
    return program_run(folder, arguments, timeout_seconds, "ffmpeg", error);
}
