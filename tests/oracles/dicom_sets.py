"""Data sets of DICOM, made with pydicom: for oracle_dicom.py, oracle_seg.py."""
import oracle
from oracle import np

pydicom = oracle.need("pydicom", "pydicom.pixel_data_handlers.rle_handler")[0]
from pydicom.dataset import Dataset, FileMetaDataset
from pydicom.encaps import encapsulate
from pydicom.pixel_data_handlers.rle_handler import rle_encode_frame
from pydicom.sequence import Sequence
from pydicom.uid import (ExplicitVRBigEndian, ExplicitVRLittleEndian,
                         ImplicitVRLittleEndian, RLELossless, generate_uid)
oracle.need_modules()
RAS = np.diag([-1.0, -1, 1, 1])
CT = "1.2.840.10008.5.1.4.1.1.2"


def holds(**tags):
    """A data set of these values; lists of data sets are sequences."""
    data = Dataset()
    for name, value in tags.items():
        setattr(data, name, Sequence(value) if name.endswith("Sequence")
                else value)
    return data


def blank(syntax=ExplicitVRLittleEndian, **tags):
    """That of a file, which lacks its pixels."""
    data = holds(**{"SOPClassUID": CT, "SOPInstanceUID": generate_uid(),
                    "Modality": "CT", "PatientName": "Hidden^Person",
                    "PatientID": "HID-Quitzkow", "SamplesPerPixel": 1,
                    "PhotometricInterpretation": "MONOCHROME2", **tags})
    data.file_meta = FileMetaDataset()
    data.file_meta.MediaStorageSOPClassUID = data.SOPClassUID
    data.file_meta.MediaStorageSOPInstanceUID = data.SOPInstanceUID
    data.file_meta.TransferSyntaxUID = syntax
    data.is_little_endian = syntax != ExplicitVRBigEndian
    data.is_implicit_VR = syntax == ImplicitVRLittleEndian
    return data


def fill(data, pixels):
    """Stores pixels (y, x) or (frame, y, x), of a bit where that is enough."""
    if data.file_meta.TransferSyntaxUID == RLELossless:
        run_lengths(data, pixels)
    else:
        order = "<" if data.is_little_endian else ">"
        kept = pixels.astype(pixels.dtype.newbyteorder(order)) \
            if data.BitsAllocated > 1 else \
            np.packbits(pixels.astype(bool).ravel(), bitorder="little")
        data.PixelData = kept.tobytes()
        data.PixelData += b"\0" * (len(data.PixelData) % 2)
    data["PixelData"].VR = "OW" if data.BitsAllocated > 8 else "OB"
    return data


def packed(data, frames, syntax=RLELossless):
    """The same with pixels that are packed."""
    data.file_meta.TransferSyntaxUID = syntax
    data.PixelData = encapsulate(frames)
    data["PixelData"].is_undefined_length = True
    return data


def run_lengths(data, frames):
    return packed(data, [rle_encode_frame(frame) for frame in frames])


def write(path, data):
    data.save_as(path, write_like_original=False)


def grid(turn, spacing, origin):
    """The matrix from voxels to RAS, of rows along turn[0], down turn[1]."""
    lps = np.eye(4)
    lps[:3, :3] = np.stack([turn[0] * spacing[0], turn[1] * spacing[1],
                            np.cross(turn[0], turn[1]) * spacing[2]], 1)
    lps[:3, 3] = origin
    return RAS @ lps
