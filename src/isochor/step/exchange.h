// OpenCASCADE's STEP and IGES readers and its writers, each with full digits. Internal to `step`.
#pragma once

#include <Interface_InterfaceModel.hxx>
#include <string>

#include "isochor/step/document.h"
#include "isochor/step/file_surface.h"

namespace isochor::internal {

// An empty document for names, colours and structure.
Handle(TDocStd_Document) new_xde();

// Makes OpenCASCADE's memory unit and the unit written to files the same, so that no coordinate is
// scaled. To be called after a reader or writer exists: their first use resets the parameters.
void work_in(const LengthUnit& unit, const Handle(TDocStd_Document) & xde);

// Fill `xde`, `session`, `unit`, `schema` and `notices`. Throw InputError when nothing comes out.
void read_step(Document& document);
void read_iges(Document& document);

// Gives a document that has only a shape (BREP) the structure that STEP and IGES writers need.
void require_xde(Document& document);

struct WriteSettings {
  // Parameter curves of STEP edges. Some solids survive a round trip only without them.
  bool parameter_curves = true;
  // Volumes, areas and centroids that a STEP file states; they do not outlive an edit.
  bool stated_measures = true;
  // Faces whose surfaces get the input file's own numbers back (STEP only).
  FileSurfaces surfaces;
};

// Writes to `path` itself, with all digits and in the document's unit; the format goes by the
// extension. Throws InputError when the writer fails or the disk is full.
void write_document(Document& document, const std::string& path,
                    const WriteSettings& settings = {});

// Notices about entities that could not be understood or were repaired on the way.
void note_checks(Document& document);

}  // namespace isochor::internal
