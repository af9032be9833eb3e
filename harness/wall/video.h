/* Videos through ffmpeg, a foreign program that may be absent. */
#ifndef TREELINE_WALL_VIDEO_H
#define TREELINE_WALL_VIDEO_H

#include "base/error.h"

/* FOLDER/NAME (.mp4, H.264) of FOLDER/frame-%05d.png, from 1, at so many frames a second.
 * STATUS_UNAVAILABLE without ffmpeg. */
enum status video_write(const char *folder, const char *name, int frames_per_second,
                        struct error *error);

#endif
