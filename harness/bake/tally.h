/* What a method with OpenGL tells of its own work, in draws that are counted; in all others these
 * do nothing. */
#ifndef TREELINE_BAKE_TALLY_H
#define TREELINE_BAKE_TALLY_H

#include "method/method.h"

/* Around what is drawn with as many texels a fragment: fragments as the driver counts them, times
 * those. nearest: of one texel each, which is a lookup. No statistics may be counted meanwhile. */
void tally_texels_begin(struct workspace *workspace);
void tally_texels_end(struct workspace *workspace, uint64_t a_fragment, bool nearest);

/* Counters that a shader adds to: a row of 32-bit words at this binding of shader storage, all
 * zero, so many that none overflows. */
GLuint tally_words_begin(struct workspace *workspace, GLuint binding, size_t words);
/* Their sum, once all that was drawn is done; the counters are gone. */
uint64_t tally_words_end(struct workspace *workspace, GLuint buffer, GLuint binding, size_t words);

#endif
