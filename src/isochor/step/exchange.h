// OpenCASCADE's STEP and IGES readers and its writers, each with full digits. Internal to `step`.
#pragma once

#include <Interface_InterfaceModel.hxx>
#include <string>

#include "isochor/step/document.h"

namespace isochor::internal {

// An empty document for names, colours and structure.
Handle(TDocStd_Document) new_xde();

// Makes OpenCASCADE's memory unit and the unit written to files the same, so that no coordinate is
// scaled. To be called after a reader or writer exists: their first use resets the parameters.
void work_in(const LengthUnit& unit, const Handle(TDocStd_Document) & xde);

// Fill `xde`, `session`, `unit`, `schema` and `notices`. Throw InputError when nothing comes out.
void read_step(Document& document);
void read_iges(Document& document);

// Notices about entities that could not be understood or were repaired on the way.
void note_checks(Document& document);

}  // namespace isochor::internal
