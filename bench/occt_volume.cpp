#include "occt_volume.h"

#include <BRepGProp.hxx>
#include <GProp_GProps.hxx>
#include <TopAbs_ShapeEnum.hxx>
#include <TopoDS_Shape.hxx>

#include "isochor/base/error.h"
#include "isochor/step/patch_document.h"

namespace isochor::bench {

struct OcctSolid::Shape {
  TopoDS_Shape shape;
};

OcctSolid::OcctSolid(const PatchModel& model)
    : shape_(new Shape{internal::patch_document(model, "bench").shape}) {
  if (shape_->shape.ShapeType() != TopAbs_SOLID) {
    throw InputError("bench", "model", "does not sew into one solid");
  }
}

OcctSolid::~OcctSolid() = default;

double OcctSolid::volume() const {
  GProp_GProps properties;
  BRepGProp::VolumeProperties(shape_->shape, properties);
  return properties.Mass();
}

double OcctSolid::volume(double eps) const {
  GProp_GProps properties;
  BRepGProp::VolumeProperties(shape_->shape, properties, eps);
  return properties.Mass();
}

}  // namespace isochor::bench
