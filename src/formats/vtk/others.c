/* formats/vtk/others.c - what VTK's XML files of other types are, and what to
 * do with them. */
#include "formats/vtk/vtk.h"

#include <string.h>

const char *snow_vtk_other(const char *type) {
    static const struct {
        const char *type, *advice;
    } others[] = {
        {"vtkNonOverlappingAMR",
         "is a VTK file of levels of refinement whose blocks do not overlap, "
         "which is not supported; write a vtkOverlappingAMR"},
        {"PRectilinearGrid",
         "is a VTK file that names the pieces of a rectilinear grid; write the "
         "grid to one .vtr, or resample it to image data (.vti)"},
        {"StructuredGrid",
         "is a VTK file of a structured grid, whose points may lie anywhere; "
         "resample it to image data (.vti) first"},
        {"PStructuredGrid",
         "is a VTK file that names the pieces of a structured grid, whose "
         "points may lie anywhere; resample it to image data (.vti) first"},
        {"UnstructuredGrid", "is a VTK file of an unstructured grid; resample "
                             "it to image data (.vti) first"},
        {"PUnstructuredGrid",
         "is a VTK file that names the pieces of an unstructured grid; "
         "resample it to image data (.vti) first"},
        {"PolyData", "is a VTK file of surfaces, which have no voxels; give a "
                     "file of image data (.vti)"},
        {"PPolyData", "is a VTK file that names the pieces of surfaces, which "
                      "have no voxels; give a file of image data (.vti)"},
    };
    for (size_t i = 0; type && i < sizeof others / sizeof *others; i++)
        if (!strcmp(type, others[i].type))
            return others[i].advice;
    return "is a VTK file, but not of image data or a rectilinear grid; "
           "resample it to image data (.vti) first";
}
