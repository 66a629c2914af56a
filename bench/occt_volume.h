// OpenCASCADE's volume of the same model: what users of that library call.
#pragma once

#include <memory>

#include "isochor/bspline/patch_model.h"

namespace isochor::bench {

class OcctSolid {
 public:
  // Sews the patches into a solid. Throws InputError when they do not close.
  explicit OcctSolid(const PatchModel& model);
  ~OcctSolid();
  OcctSolid(const OcctSolid&) = delete;
  OcctSolid& operator=(const OcctSolid&) = delete;

  double volume() const;            // BRepGProp::VolumeProperties without a tolerance
  double volume(double eps) const;  // the same, adaptive, with Eps

 private:
  struct Shape;
  std::unique_ptr<Shape> shape_;
};

}  // namespace isochor::bench
