/* Counts of fragments, and counters of shaders. */
#include "bake/tally.h"

void tally_texels_begin(struct workspace *workspace)
{
    if (workspace->counted)
        gl_statistics_begin(workspace->gl);
}

void tally_texels_end(struct workspace *workspace, uint64_t a_fragment, bool nearest)
{
    if (!workspace->counted)
        return;
    uint64_t texels = a_fragment * gl_statistics_end(workspace->gl).fragments;
    *(nearest ? &workspace->tally.lookups : &workspace->tally.samples) += texels;
}

GLuint tally_words_begin(struct workspace *workspace, GLuint binding, size_t words)
{
    struct arena *scratch = arena_create(0);
    const uint32_t *zeros = ARENA_ARRAY(scratch, uint32_t, words);
    GLuint buffer = gl_buffer(workspace->gl, (GLsizeiptr)(words * sizeof *zeros), zeros, 0);
    workspace->gl->BindBufferBase(GL_SHADER_STORAGE_BUFFER, binding, buffer);
    arena_destroy(scratch);
    return buffer;
}

uint64_t tally_words_end(struct workspace *workspace, GLuint buffer, GLuint binding, size_t words)
{
    struct gl *gl = workspace->gl;
    struct arena *scratch = arena_create(0);
    uint32_t *counts = ARENA_ARRAY(scratch, uint32_t, words);
    uint64_t sum = 0;
    gl->MemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
    gl->GetNamedBufferSubData(buffer, 0, (GLsizeiptr)(words * sizeof *counts), counts);
    for (size_t i = 0; i < words; i++)
        sum += counts[i];
    gl->BindBufferBase(GL_SHADER_STORAGE_BUFFER, binding, 0);
    gl_delete_buffer(gl, buffer);
    arena_destroy(scratch);
    return sum;
}
