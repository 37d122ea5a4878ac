/* volume/gdcm_bridge.cc - the one file that is not C: GDCM's codecs behind a
 * function that C can call.
 *
 * GDCM's parser is not used: as Debian builds it, it ends the process at many a
 * damaged file.  GDCM says what it dislikes on the program's standard error
 * unless told not to, for the whole process: it is told so before each use. */
#include "volume/gdcm_bridge.h"

#include <gdcmBitmap.h>
#include <gdcmFragment.h>
#include <gdcmSequenceOfFragments.h>
#include <gdcmTrace.h>

namespace {

void be_silent() {
    gdcm::Trace::DebugOff();
    gdcm::Trace::WarningOff();
    gdcm::Trace::ErrorOff();
}

/* Pixel data of one fragment. */
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

void describe(const gdcm_frame &frame, gdcm::Bitmap &image) {
    typedef unsigned short word;
    image.SetNumberOfDimensions(2);
    image.SetDimension(0, frame.columns);
    image.SetDimension(1, frame.rows);
    image.SetTransferSyntax(
        gdcm::TransferSyntax(gdcm::TransferSyntax::GetTSType(frame.syntax)));
    image.SetPhotometricInterpretation(
        gdcm::PhotometricInterpretation::GetPIType(frame.photometric));
    image.SetPixelFormat(gdcm::PixelFormat(
        static_cast<word>(frame.samples), static_cast<word>(frame.allocated),
        static_cast<word>(frame.stored), static_cast<word>(frame.high),
        frame.is_signed ? 1 : 0));
    if (frame.samples > 1)
        image.SetPlanarConfiguration(frame.planes ? 1 : 0);
}

} // namespace

extern "C" bool snow_gdcm_unpack(gdcm_frame *frame, const void *packed,
                                 size_t size, void *out, size_t room) {
    try {
        be_silent();
        gdcm::Bitmap image;
        describe(*frame, image);
        image.SetDataElement(wrap(packed, size));
        if (image.GetBufferLength() != room ||
            !image.GetBuffer(static_cast<char *>(out)))
            return false;
        const gdcm::PixelFormat &format = image.GetPixelFormat();
        if (image.GetBufferLength() != room ||
            format.GetBitsAllocated() != frame->allocated)
            return false;
        frame->stored = format.GetBitsStored();
        frame->high = format.GetHighBit();
        frame->is_signed = format.GetPixelRepresentation() != 0;
        if (frame->samples > 1)
            frame->planes = image.GetPlanarConfiguration() == 1;
        return true;
    } catch (...) {
        return false;
    }
}
