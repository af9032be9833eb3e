/* The C++ shim over OpenImageIO: reads a picture, encodes one into memory, lets no exception out.
 */
#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <cstdio>
#include <cstring>
#include <exception>
#include <memory>
#include <string>
#include <vector>

#include <fcntl.h>
#include <unistd.h>

extern "C" {
#include "wall/oiio.h"
}

namespace
{

int fail(const oiio_context *context, const std::string &text)
{
    std::snprintf(context->message, context->message_bytes, "%s", text.c_str());
    return 1;
}

/* What the library says, or a phrase where it says nothing. */
std::string said(const std::string &text, const char *otherwise)
{
    return text.empty() ? otherwise : text;
}

/* No thread pools: a picture is one file, and the process may fork. */
void set_up()
{
    OIIO::attribute("threads", 1);
    OIIO::attribute("exr_threads", -1);
}

bool is_srgb(const OIIO::ImageSpec &spec)
{
    bool integers = spec.format == OIIO::TypeDesc::UINT8 || spec.format == OIIO::TypeDesc::UINT16;
    return integers && spec.get_string_attribute("oiio:ColorSpace") != "Linear";
}

/* 0 of unsigned integers, which are a share of their most; OpenImageIO scales the others too. */
double unit_of(const OIIO::TypeDesc &format)
{
    switch (format.basetype) {
    case OIIO::TypeDesc::INT8:
        return 127;
    case OIIO::TypeDesc::INT16:
        return 32767;
    case OIIO::TypeDesc::INT32:
        return 2147483647;
    case OIIO::TypeDesc::HALF:
    case OIIO::TypeDesc::FLOAT:
    case OIIO::TypeDesc::DOUBLE:
        return 1;
    default:
        return 0;
    }
}

void copy_names(const OIIO::ImageSpec &spec, oiio_picture *picture)
{
    for (int c = 0; c < spec.nchannels; c++) {
        std::string name = c < int(spec.channelnames.size()) ? spec.channelnames[c] : "";
        std::snprintf(picture->names[c], OIIO_NAME_BYTES, "%s", name.c_str());
    }
}

int read_picture(const oiio_context *context, const char *path, uint64_t values_max,
                 int channels_max, oiio_picture *picture)
{
    set_up();
    OIIO::ImageSpec hints;
    hints.attribute("oiio:UnassociatedAlpha", 1); /* keep RGB as stored */
    auto input = OIIO::ImageInput::open(path, &hints);
    if (!input)
        return fail(context, said(OIIO::geterror(), "not a picture"));
    const OIIO::ImageSpec spec = input->spec();
    if (spec.deep || spec.depth > 1)
        return fail(context, "deep and volume pictures are not read");
    if (spec.width < 1 || spec.height < 1 || spec.nchannels < 1 || spec.nchannels > channels_max ||
        uint64_t(spec.width) * uint64_t(spec.height) > values_max / uint64_t(spec.nchannels))
        return fail(context, "size " + std::to_string(spec.width) + " x " +
                                 std::to_string(spec.height) + " x " +
                                 std::to_string(spec.nchannels) + " channels is above " +
                                 std::to_string(values_max) + " values or " +
                                 std::to_string(channels_max) + " channels");
    size_t count = size_t(spec.width) * size_t(spec.height) * size_t(spec.nchannels);
    std::unique_ptr<float[]> values(new float[count]); /* a cut-off file costs the caller nothing */
    if (!input->read_image(0, 0, 0, spec.nchannels, OIIO::TypeDesc::FLOAT, values.get()))
        return fail(context, said(input->geterror(), "cut off or damaged"));
    input->close();
    picture->width_px = spec.width;
    picture->height_px = spec.height;
    picture->channels_count = spec.nchannels;
    picture->alpha = spec.alpha_channel;
    picture->srgb = is_srgb(spec);
    picture->unit = unit_of(spec.format);
    picture->values = static_cast<float *>(context->allocate(context->user, count * sizeof(float)));
    std::memcpy(picture->values, values.get(), count * sizeof(float));
    picture->names = static_cast<char(*)[OIIO_NAME_BYTES]>(
        context->allocate(context->user, size_t(spec.nchannels) * OIIO_NAME_BYTES));
    copy_names(spec, picture);
    return 0;
}

OIIO::TypeDesc stored_type(bool exr, int bits)
{
    if (exr)
        return bits == 16 ? OIIO::TypeDesc::HALF : OIIO::TypeDesc::FLOAT;
    return bits == 8 ? OIIO::TypeDesc::UINT8 : OIIO::TypeDesc::UINT16;
}

int write_picture(const oiio_context *context, const char *ending, const oiio_picture *picture,
                  int bits, uint8_t **bytes, size_t *size)
{
    set_up();
    bool exr = std::strcmp(ending, "exr") == 0;
    OIIO::ImageSpec spec(picture->width_px, picture->height_px, picture->channels_count,
                         stored_type(exr, bits));
    spec.channelnames.assign(picture->names, picture->names + picture->channels_count);
    spec.alpha_channel = picture->alpha;
    spec.attribute("oiio:UnassociatedAlpha", 1);
    if (exr) {
        spec.attribute("DateTime", "1970:01:01 00:00:00"); /* else the writer puts in today's */
        spec.attribute("compression", "zip");
    } else if (picture->srgb) {
        spec.attribute("oiio:ColorSpace", "sRGB");
    }
    OIIO::Filesystem::IOVecOutput memory;
    auto output = OIIO::ImageOutput::create(std::string("picture.") + ending, &memory);
    if (!output)
        return fail(context, said(OIIO::geterror(), "this OpenImageIO writes no such format"));
    if (!output->open(std::string("picture.") + ending, spec) ||
        !output->write_image(OIIO::TypeDesc::FLOAT, picture->values) || !output->close())
        return fail(context, said(output->geterror(), "could not be encoded"));
    const std::vector<unsigned char> &buffer = memory.buffer();
    *size = buffer.size();
    *bytes = static_cast<uint8_t *>(context->allocate(context->user, *size));
    std::memcpy(*bytes, buffer.data(), *size);
    return 0;
}

/* libpng writes to stderr what its caller is told anyway. */
class silence
{
  public:
    silence() : kept(fcntl(STDERR_FILENO, F_DUPFD_CLOEXEC, 0))
    {
        int nothing = open("/dev/null", O_WRONLY | O_CLOEXEC);
        if (kept >= 0 && nothing >= 0)
            dup2(nothing, STDERR_FILENO);
        if (nothing >= 0)
            close(nothing);
    }
    ~silence()
    {
        if (kept >= 0) {
            dup2(kept, STDERR_FILENO);
            close(kept);
        }
    }
    silence(const silence &) = delete;
    silence &operator=(const silence &) = delete;

  private:
    int kept;
};

/* Every call behind one door: whatever is thrown becomes a message. */
template <class Call> int guarded(const oiio_context *context, Call call)
{
    silence quiet;
    try {
        return call();
    } catch (const std::exception &exception) {
        return fail(context, said(exception.what(), "OpenImageIO threw an exception"));
    } catch (...) {
        return fail(context, "OpenImageIO threw an exception");
    }
}

int guarded_read(const oiio_context *context, const char *path, uint64_t values_max,
                 int channels_max, oiio_picture *picture)
{
    return guarded(context,
                   [=] { return read_picture(context, path, values_max, channels_max, picture); });
}

int guarded_write(const oiio_context *context, const char *ending, const oiio_picture *picture,
                  int bits, uint8_t **bytes, size_t *size)
{
    return guarded(context,
                   [=] { return write_picture(context, ending, picture, bits, bytes, size); });
}

} // namespace

extern "C" {
extern const struct oiio_calls treeline_image_calls;
const struct oiio_calls treeline_image_calls = {OIIO_ABI, guarded_read, guarded_write};
}
