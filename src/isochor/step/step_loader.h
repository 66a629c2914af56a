// Reads a STEP file into OpenCASCADE's reader with our own scanner. Internal to `step` (OpenCASCADE
// types).
#pragma once

#include <STEPControl_Reader.hxx>
#include <string>

namespace isochor::internal {

// As reader.ReadFile does, from the text whose ISO-10303-21 stands at `start`. What our scanner
// declines, OpenCASCADE's reads. `text` is used up.
IFSelect_ReturnStatus load_step(STEPControl_Reader& reader, const std::string& path,
                                std::string text, size_t start);

}  // namespace isochor::internal
