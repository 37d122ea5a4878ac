/* volume/gdcm_bridge.cc - the one file that is not C: GDCM behind functions
 * that C can call.
 *
 * Each catches all exceptions.  GDCM says what it dislikes on the program's
 * standard error unless told not to, for the whole process: it is told so
 * before each use. */
#include "volume/gdcm_bridge.h"

#include <cstring>
#include <gdcmPixmapReader.h>
#include <gdcmSequenceOfItems.h>
#include <gdcmTrace.h>
#include <istream>
#include <memory>
#include <streambuf>

namespace {

/* What is asked for at once of the file: a header is mostly one such piece. */
const size_t PIECE = 16384;

const uint32_t SHARED_GROUPS = 0x52009229, FRAME_GROUPS = 0x52009230;
const uint32_t PIXELS = 0x7fe00010;

/* A stream over the bytes of the C side. */
class bytes_buffer : public std::streambuf {
  public:
    explicit bytes_buffer(const gdcm_bytes &from) : bytes(from) {
    }

  protected:
    int_type underflow() override {
        begin += static_cast<uint64_t>(egptr() - eback());
        size_t got = bytes.read(bytes.user, begin, piece, PIECE);
        setg(piece, piece, piece + got);
        return got ? traits_type::to_int_type(*gptr()) : traits_type::eof();
    }

    /* What is longer than a piece goes where it belongs at once. */
    std::streamsize xsgetn(char *to, std::streamsize count) override {
        std::streamsize held = egptr() - gptr();
        if (count <= held || count < static_cast<std::streamsize>(PIECE))
            return std::streambuf::xsgetn(to, count);
        uint64_t at = place();
        size_t got = bytes.read(bytes.user, at, to, static_cast<size_t>(count));
        move_to(at + got);
        return static_cast<std::streamsize>(got);
    }

    pos_type seekoff(off_type off, std::ios_base::seekdir from,
                     std::ios_base::openmode) override {
        off_type base = from == std::ios_base::beg ? 0
                        : from == std::ios_base::cur
                            ? static_cast<off_type>(place())
                            : static_cast<off_type>(bytes.size);
        off_type at = base + off;
        if (at < 0 || at > static_cast<off_type>(bytes.size))
            return pos_type(off_type(-1));
        move_to(static_cast<uint64_t>(at));
        return pos_type(at);
    }

    pos_type seekpos(pos_type at, std::ios_base::openmode mode) override {
        return seekoff(off_type(at), std::ios_base::beg, mode);
    }

  private:
    uint64_t place() const {
        return begin + static_cast<uint64_t>(gptr() - eback());
    }

    /* Within the piece that is there when it can be: GDCM goes to and fro. */
    void move_to(uint64_t at) {
        uint64_t end = begin + static_cast<uint64_t>(egptr() - eback());
        if (at >= begin && at <= end) {
            setg(eback(), eback() + (at - begin), egptr());
            return;
        }
        begin = at;
        setg(piece, piece, piece);
    }

    gdcm_bytes bytes;
    uint64_t begin = 0; /* of the piece in the file */
    char piece[PIECE];
};

gdcm::Tag tag_of(uint32_t number) {
    return gdcm::Tag(static_cast<uint16_t>(number >> 16),
                     static_cast<uint16_t>(number & 0xffff));
}

typedef gdcm::SmartPointer<gdcm::SequenceOfItems> items;

items items_of(const gdcm::DataSet &set, const gdcm::Tag &tag) {
    if (!set.FindDataElement(tag))
        return items();
    return set.GetDataElement(tag).GetValueAsSQ();
}

/* The first item of a sequence in a data set. */
items sequence_in(const gdcm::DataSet &set, const gdcm::Tag &tag) {
    items found = items_of(set, tag);
    return found && found->GetNumberOfItems() ? found : items();
}

} // namespace

struct gdcm_file {
    explicit gdcm_file(const gdcm_bytes &bytes)
        : buffer(bytes), stream(&buffer) {
    }

    bytes_buffer buffer;
    std::istream stream;
    gdcm::PixmapReader reader;
    /* Looked up once: a sequence of GDCM may be parsed anew at each look. */
    items frames, shared;
};

namespace {

/* The first of the places where a sequence is looked for. */
items find_sequence(gdcm_file *file, const gdcm_place &place) {
    gdcm::Tag tag = tag_of(place.sequence);
    items found;
    if (file->frames && place.frame >= 0 &&
        static_cast<uint64_t>(place.frame) < file->frames->GetNumberOfItems())
        found = sequence_in(
            file->frames
                ->GetItem(static_cast<gdcm::SequenceOfItems::SizeType>(
                    place.frame + 1))
                .GetNestedDataSet(),
            tag);
    if (!found && file->shared)
        found = sequence_in(file->shared->GetItem(1).GetNestedDataSet(), tag);
    if (!found)
        found = sequence_in(file->reader.GetFile().GetDataSet(), tag);
    return found;
}

size_t copy_value(const gdcm::DataSet &set, const gdcm::Tag &tag, void *out,
                  size_t room) {
    if (!set.FindDataElement(tag))
        return 0;
    const gdcm::ByteValue *value = set.GetDataElement(tag).GetByteValue();
    if (!value || !value->GetPointer())
        return 0;
    size_t length = static_cast<uint32_t>(value->GetLength());
    if (length > room)
        length = room;
    std::memcpy(out, value->GetPointer(), length);
    return length;
}

/* Pixels that are not packed must be there in full. */
bool are_all_there(const gdcm::Bitmap &image) {
    const gdcm::ByteValue *value = image.GetDataElement().GetByteValue();
    return !value ||
           static_cast<uint32_t>(value->GetLength()) >= image.GetBufferLength();
}

} // namespace

extern "C" gdcm_file *snow_gdcm_open(const gdcm_bytes *bytes, bool pixels) {
    try {
        gdcm::Trace::DebugOff();
        gdcm::Trace::WarningOff();
        gdcm::Trace::ErrorOff();
        std::unique_ptr<gdcm_file> file(new gdcm_file(*bytes));
        gdcm::PixmapReader &reader = file->reader;
        reader.SetStream(file->stream);
        if (pixels ? !reader.Read() : !reader.ReadUpToTag(tag_of(PIXELS)))
            return nullptr;
        const gdcm::DataSet &set = reader.GetFile().GetDataSet();
        file->frames = items_of(set, tag_of(FRAME_GROUPS));
        file->shared = sequence_in(set, tag_of(SHARED_GROUPS));
        return file.release();
    } catch (...) {
        return nullptr;
    }
}

extern "C" void snow_gdcm_close(gdcm_file *file) {
    try {
        delete file;
    } catch (...) {
        return;
    }
}

extern "C" size_t snow_gdcm_value(gdcm_file *file, gdcm_place place, void *out,
                                  size_t room) {
    try {
        gdcm::Tag tag = tag_of(place.tag);
        if (tag.GetGroup() == 2)
            return copy_value(file->reader.GetFile().GetHeader(), tag, out,
                              room);
        if (!place.sequence)
            return copy_value(file->reader.GetFile().GetDataSet(), tag, out,
                              room);
        items sequence = find_sequence(file, place);
        return sequence ? copy_value(sequence->GetItem(1).GetNestedDataSet(),
                                     tag, out, room)
                        : 0;
    } catch (...) {
        return 0;
    }
}

extern "C" bool snow_gdcm_describe(gdcm_file *file, gdcm_pixels *out) {
    try {
        const gdcm::Bitmap &image = file->reader.GetPixmap();
        const gdcm::PixelFormat &format = image.GetPixelFormat();
        gdcm_pixels pixels = {};
        if (image.IsEmpty() || image.GetDataElement().IsEmpty())
            return false;
        pixels.columns = image.GetDimension(0);
        pixels.rows = image.GetDimension(1);
        pixels.frames =
            image.GetNumberOfDimensions() > 2 ? image.GetDimension(2) : 1;
        pixels.samples = format.GetSamplesPerPixel();
        pixels.planes = image.GetPlanarConfiguration() == 1;
        pixels.allocated = format.GetBitsAllocated();
        pixels.stored = format.GetBitsStored();
        pixels.high = format.GetHighBit();
        pixels.is_signed = format.GetPixelRepresentation() != 0;
        pixels.bytes = image.GetBufferLength();
        const char *name = image.GetPhotometricInterpretation().GetString();
        if (name)
            std::strncpy(pixels.photometric, name,
                         sizeof pixels.photometric - 1);
        *out = pixels;
        return true;
    } catch (...) {
        return false;
    }
}

extern "C" bool snow_gdcm_decode(gdcm_file *file, void *out) {
    try {
        const gdcm::Bitmap &image = file->reader.GetPixmap();
        return are_all_there(image) &&
               image.GetBuffer(static_cast<char *>(out));
    } catch (...) {
        return false;
    }
}
