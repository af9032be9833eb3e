/* Programs: one text with all stages, the shared shading chunk in front, errors with name, stage
 * and line. */
#include "wall/gl_load.h"

#include "shade.glsl.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const struct stage {
    const char *word;
    GLenum type;
} stages[] = {{"vertex", GL_VERTEX_SHADER},
              {"fragment", GL_FRAGMENT_SHADER},
              {"geometry", GL_GEOMETRY_SHADER},
              {"tess_control", GL_TESS_CONTROL_SHADER},
              {"tess_evaluation", GL_TESS_EVALUATION_SHADER},
              {"compute", GL_COMPUTE_SHADER}};
enum { STAGES_COUNT = sizeof stages / sizeof *stages };

/* The next line "#pragma stage WORD" at or behind text; *word is set to WORD. NULL: none. */
static const char *find_stage(const char *text, const char **word)
{
    static const char pragma[] = "#pragma stage ";
    for (const char *at = text; (at = strstr(at, pragma)); at += sizeof pragma - 1)
        if (at == text || at[-1] == '\n') {
            *word = at + sizeof pragma - 1 + strspn(at + sizeof pragma - 1, " ");
            return at;
        }
    return NULL;
}

static const struct stage *stage_from_word(const char *word)
{
    size_t length = strcspn(word, " \r\n");
    for (size_t i = 0; i < STAGES_COUNT; i++)
        if (strlen(stages[i].word) == length && !strncmp(stages[i].word, word, length))
            return &stages[i];
    return NULL;
}

static int line_number(const char *source, const char *at)
{
    int line = 1;
    for (; source < at; source++)
        line += *source == '\n';
    return line;
}

/* "NAME VALUE" lines as "#define NAME VALUE" lines. */
static char *define_lines(struct arena *arena, const char *defines)
{
    char *text = arena_strdup(arena, "");
    while (defines && *defines) {
        int length = (int)strcspn(defines, "\n");
        if (length > 0)
            text = arena_printf(arena, "%s#define %.*s\n", text, length, defines);
        defines += length + (defines[length] == '\n');
    }
    return text;
}

/* Lines of the shared chunk begin here (drivers disagree about a string's number in #line). */
enum { SHADE_LINE = 1000000 };

/* Driver's first error: Mesa "0:12(5): error: text", NVIDIA "0(12) : error C1: text", else its
 * first line. */
static enum status log_error(const char *name, const char *stage, const char *text,
                             struct error *error)
{
    const char *at = strstr(text, "error");
    while (at && at > text && at[-1] != '\n')
        at--;
    at = at ? at : text;
    int string = -1, line = 0;
    if (sscanf(at, "%d:%d", &string, &line) != 2)
        sscanf(at, "%d(%d)", &string, &line);
    const char *message = strstr(at, "error");
    const char *colon = message ? strchr(message, ':') : NULL;
    message = colon ? colon + 1 + strspn(colon + 1, " ") : at;
    int length = (int)strcspn(message, "\n");
    const char *file = line > SHADE_LINE ? " of shade.glsl" : "";
    line -= line > SHADE_LINE ? SHADE_LINE : 0;
    if (line > 0)
        return error_set(error, STATUS_GL, "%s: %s shader, line %d%s: %.*s", name, stage, line,
                         file, length, message);
    return error_set(error, STATUS_GL, "%s: %s: %.*s", name, stage, length, message);
}

static enum status attach(struct gl *gl, GLuint program, const char *name,
                          const struct stage *stage, const char *const *texts, GLsizei texts_count,
                          struct error *error)
{
    GLuint shader = gl->CreateShader(stage->type);
    GLint compiled = 0;
    gl->ShaderSource(shader, texts_count, (const GLchar *const *)texts, NULL);
    gl->CompileShader(shader);
    gl->GetShaderiv(shader, GL_COMPILE_STATUS, &compiled);
    gl->AttachShader(program, shader);
    gl->DeleteShader(shader); /* lives as long as the program */
    if (compiled)
        return STATUS_OK;
    char text[4096] = "";
    gl->GetShaderInfoLog(shader, sizeof text, NULL, text);
    return log_error(name, stage->word, text, error);
}

static enum status attach_all(struct gl *gl, GLuint program, const char *name, const char *source,
                              const char *defines, struct arena *arena, struct error *error)
{
    const char *word, *at = find_stage(source, &word);
    if (!at)
        return error_set(error, STATUS_GL, "%s: no line '#pragma stage vertex' or alike", name);
    const char *common = arena_printf(arena, "#line 1\n%.*s\n", (int)(at - source), source);
    const char *defined = define_lines(arena, defines);
    while (at) {
        const struct stage *stage = stage_from_word(word);
        if (!stage)
            return error_set(error, STATUS_GL, "%s, line %d: unknown stage '%.*s'", name,
                             line_number(source, at), (int)strcspn(word, "\r\n"), word);
        const char *body = at + strcspn(at, "\n");
        const char *end = find_stage(body, &word);
        int length = end ? (int)(end - body) : (int)strlen(body);
        /* body begins with the line break of the pragma's own line */
        const char *own =
            arena_printf(arena, "#line %d%.*s\n", line_number(source, at) + 1, length, body);
        const char *texts[] = {
            "#version 450 core\n", defined, "#line 1000001\n", shade_glsl, "\n", common, own};
        enum status status =
            attach(gl, program, name, stage, texts, sizeof texts / sizeof *texts, error);
        if (status != STATUS_OK)
            return status;
        at = end;
    }
    return STATUS_OK;
}

enum status gl_program(struct gl *gl, const char *name, const char *source, const char *defines,
                       GLuint *program, struct error *error)
{
    struct arena *arena = arena_create(0); /* for the texts */
    GLuint made = gl->CreateProgram();
    enum status status = attach_all(gl, made, name, source, defines, arena, error);
    arena_destroy(arena);
    if (status == STATUS_OK) {
        GLint linked = 0;
        gl->LinkProgram(made);
        gl->GetProgramiv(made, GL_LINK_STATUS, &linked);
        if (!linked) {
            char text[4096] = "";
            gl->GetProgramInfoLog(made, sizeof text, NULL, text);
            status = log_error(name, "link", text, error);
        }
    }
    if (status != STATUS_OK) {
        gl->DeleteProgram(made);
        *program = 0;
        return status;
    }
    *program = gl_books_add(gl, GL_KIND_PROGRAM, made, 0);
    return STATUS_OK;
}

GLint gl_uniform(struct gl *gl, GLuint program, const char *name)
{
    return gl->GetUniformLocation(program, name);
}
