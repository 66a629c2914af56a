// Integrals over the kept region of a trimmed face, along its loops: see flux.h.
//
// A *kind* says what is integrated (flux_integrand.h): the flux of z, or the ten moments; or it is
// an integrand with lines of its own (section_integrand.h).
//
// Internal to the step layer (OpenCASCADE types).
#pragma once

#include <Geom_Surface.hxx>
#include <vector>

#include "isochor/step/face_loops.h"
#include "isochor/step/flux_integrand.h"
#include "isochor/step/section_integrand.h"
#include "isochor/step/trim_region.h"

namespace isochor::internal {

template <typename Kind>
struct RegionIntegrals {
  typename Kind::Sums sums;
  typename Kind::Sums errors;  // in its values: how much the last refinement changed
  bool closed = false;         // false: the loops do not close, the sums mean nothing
};

// Over the oriented surface, not the face. Instantiated for FluxKind and MomentKind.
template <typename Kind>
RegionIntegrals<Kind> integrate_region(const Handle(Geom_Surface) & surface,
                                       const std::vector<FaceLoop>& loops, TrimKind trim,
                                       const Kind& kind);
RegionIntegrals<SectionIntegrand> integrate_region(const Handle(Geom_Surface) & surface,
                                                   const std::vector<FaceLoop>& loops,
                                                   TrimKind trim, SectionIntegrand& integrand);

}  // namespace isochor::internal
