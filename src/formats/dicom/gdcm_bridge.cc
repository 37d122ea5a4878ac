/* formats/dicom/gdcm_bridge.cc - the only C++ file: GDCM's codecs behind a C
 * function.
 *
 * GDCM's parser is not used: as Debian builds it, it ends the process at many
 * damaged files.  Nor is its selection of codecs, which runs another program,
 * pvrg-jpeg, with a temporary file when JPEG fails.  GDCM prints warnings to
 * standard error unless switched off for the whole process, which is done
 * before each use. */
#include "formats/dicom/gdcm_bridge.h"

#include <cstring>
#include <gdcmFragment.h>
#include <gdcmJPEG2000Codec.h>
#include <gdcmJPEGCodec.h>
#include <gdcmJPEGLSCodec.h>
#include <gdcmSequenceOfFragments.h>
#include <gdcmTrace.h>
#include <gdcmTransferSyntax.h>

namespace {

void be_silent() {
    gdcm::Trace::DebugOff();
    gdcm::Trace::WarningOff();
    gdcm::Trace::ErrorOff();
}

/* The pixel data of one fragment. */
gdcm::DataElement wrap(const void *packed, size_t size) {
    gdcm::SmartPointer<gdcm::SequenceOfFragments> fragments =
        new gdcm::SequenceOfFragments;
    gdcm::Fragment fragment;
    fragment.SetByteValue(static_cast<const char *>(packed),
                          static_cast<uint32_t>(size));
    fragments->AddFragment(fragment);
    gdcm::DataElement element(gdcm::Tag(0x7fe0, 0x0010));
    element.SetVR(gdcm::VR::OB);
    element.SetValue(*fragments);
    return element;
}

/* GDCM asserts a known one, with as many samples. */
gdcm::PhotometricInterpretation photometric_of(const gdcm_frame &frame) {
    typedef gdcm::PhotometricInterpretation kind;
    kind::PIType type = kind::GetPIType(frame.photometric);
    if (type == kind::PI_END ||
        kind(type).GetSamplesPerPixel() != frame.samples)
        type = frame.samples == 3 ? kind::RGB : kind::MONOCHROME2;
    return kind(type);
}

/* A codec gets the image's description, and may change it to what it finds.
 * Words of 8 bits must all be stored: otherwise it ends the process. */
void describe(const gdcm_frame &frame, gdcm::ImageCodec &codec) {
    typedef unsigned short word;
    const unsigned sizes[3] = {frame.columns, frame.rows, 1};
    codec.SetNumberOfDimensions(2);
    codec.SetDimensions(sizes);
    codec.SetPhotometricInterpretation(photometric_of(frame));
    const bool byte = frame.allocated == 8;
    codec.SetPixelFormat(gdcm::PixelFormat(
        static_cast<word>(frame.samples), static_cast<word>(frame.allocated),
        static_cast<word>(byte ? 8 : frame.stored),
        static_cast<word>(byte ? 7 : frame.high), frame.is_signed ? 1 : 0));
    codec.SetPlanarConfiguration(frame.samples > 1 && frame.planes ? 1 : 0);
    codec.SetNeedOverlayCleanup(false);
}

/* Of GDCM's three copies of libjpeg one reads these bits.  Another would print
 * a line, and GDCM would go on with the right one. */
struct jpeg_codec : gdcm::JPEGCodec {
    void prepare(const gdcm_frame &frame) {
        SetBitSample(frame.packed_bits);
    }
};

void prepare(const gdcm_frame &frame, jpeg_codec &codec) {
    codec.prepare(frame);
}

void prepare(const gdcm_frame &, gdcm::ImageCodec &) {
}

template <class Codec>
bool decode(gdcm_frame &frame, const gdcm::DataElement &packed, char *out,
            size_t capacity) {
    Codec codec;
    gdcm::DataElement made;
    describe(frame, codec);
    prepare(frame, codec);
    if (!codec.Decode(packed, made))
        return false;
    const gdcm::ByteValue *value = made.GetByteValue();
    const gdcm::PixelFormat &format = codec.GetPixelFormat();
    /* GDCM makes an odd number of bytes even. */
    const size_t length = value ? static_cast<uint32_t>(value->GetLength()) : 0;
    if ((length != capacity && length != capacity + capacity % 2) ||
        format.GetBitsAllocated() != frame.allocated)
        return false;
    std::memcpy(out, value->GetPointer(), capacity);
    const bool is_signed = format.GetPixelRepresentation() != 0;
    if (frame.allocated != 8 || format.GetBitsStored() != 8 ||
        is_signed != frame.is_signed) {
        frame.stored = format.GetBitsStored();
        frame.high = format.GetHighBit();
        frame.is_signed = is_signed;
    }
    if (frame.samples > 1)
        frame.planes = codec.GetPlanarConfiguration() == 1;
    return true;
}

} // namespace

extern "C" bool snow_gdcm_unpack(gdcm_frame *frame, const void *packed,
                                 size_t size, void *out, size_t capacity) {
    try {
        be_silent();
        gdcm::TransferSyntax syntax(
            gdcm::TransferSyntax::GetTSType(frame->syntax));
        gdcm::DataElement element = wrap(packed, size);
        char *to = static_cast<char *>(out);
        if (gdcm::JPEGLSCodec().CanDecode(syntax))
            return decode<gdcm::JPEGLSCodec>(*frame, element, to, capacity);
        if (gdcm::JPEG2000Codec().CanDecode(syntax))
            return decode<gdcm::JPEG2000Codec>(*frame, element, to, capacity);
        return gdcm::JPEGCodec().CanDecode(syntax) &&
               decode<jpeg_codec>(*frame, element, to, capacity);
    } catch (...) {
        return false;
    }
}
