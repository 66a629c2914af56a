// Validity and measures of a shape (ShapeFacts), taken with one ruler before and after an edit.
// Internal to `step`.
//
// Laws: (1) reading does not change the shape; (2) the same shape gives the same facts.
#pragma once

#include <TopoDS_Shape.hxx>

#include "isochor/step/document.h"
#include "isochor/step/solid_model.h"

namespace isochor::internal {

// Everything but names and colours. Defects name faces by their number.
// `integrals`: with area and volume, which cost the most.
ShapeFacts shape_facts(const TopoDS_Shape& shape, bool integrals = true);

// With the names and colours of the document.
ShapeFacts shape_facts(const Document& document, bool integrals = true);

}  // namespace isochor::internal
