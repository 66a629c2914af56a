#include "isochor/step/sewing_labels.h"

#include <Quantity_ColorRGBA.hxx>
#include <StepRepr_NextAssemblyUsageOccurrence.hxx>
#include <TColStd_HSequenceOfExtendedString.hxx>
#include <TDF_LabelSequence.hxx>
#include <TDataStd_Name.hxx>
#include <TopExp_Explorer.hxx>
#include <XCAFDoc_ColorTool.hxx>
#include <XCAFDoc_DocumentTool.hxx>
#include <XCAFDoc_LayerTool.hxx>
#include <XCAFDoc_ShapeTool.hxx>

#include "isochor/step/exchange.h"

namespace isochor::internal {
namespace {

// Labels of shapes that are stored once; several roots of one representation are such parts.
std::vector<TDF_Label> part_labels(const Document& document) {
  TDF_LabelSequence labels;
  XCAFDoc_DocumentTool::ShapeTool(document.xde->Main())->GetShapes(labels);
  std::vector<TDF_Label> parts;
  for (const TDF_Label& label : labels) {
    if (!XCAFDoc_ShapeTool::IsSimpleShape(label) || XCAFDoc_ShapeTool::IsSubShape(label)) continue;
    parts.push_back(label);
  }
  return parts;
}

void set_name(const TDF_Label& at, const std::string& name) {
  if (name.empty()) return;
  TDataStd_Name::Set(at, TCollection_ExtendedString(name.c_str(), Standard_True));
}

// What a label says of a shape.
struct Looks {
  std::string name;
  bool coloured = false;
  Quantity_ColorRGBA colour;
  Handle(TColStd_HSequenceOfExtendedString) layers;

  bool empty() const { return name.empty() && !coloured && (layers.IsNull() || layers->IsEmpty()); }
};

class OldLooks {
 public:
  explicit OldLooks(const Document& document)
      : document_(document),
        colours_(XCAFDoc_DocumentTool::ColorTool(document.xde->Main())),
        layers_(XCAFDoc_DocumentTool::LayerTool(document.xde->Main())),
        parts_(part_labels(document)) {}

  // A face without a name takes that of its part when it is the only one there.
  Looks of(const TopoDS_Shape& face) const {
    Looks looks = stated(face);
    looks.name = document_.name_of(face);
    for (const TDF_Label& label : parts_) {
      const TopoDS_Shape shape = XCAFDoc_ShapeTool::GetShape(label);
      int faces = 0;
      bool found = false;
      for (TopExp_Explorer it(shape, TopAbs_FACE); it.More(); it.Next(), ++faces) {
        found = found || it.Current().IsPartner(face);
      }
      if (!found) continue;
      const Looks part = stated(shape);
      if (looks.name.empty() && faces == 1) looks.name = label_name(label);
      if (!looks.coloured) {
        looks.coloured = part.coloured;
        looks.colour = part.colour;
      }
      if (looks.layers.IsNull() || looks.layers->IsEmpty()) looks.layers = part.layers;
    }
    return looks;
  }

  // Of the file's only root.
  std::string title() const {
    TDF_LabelSequence labels;
    XCAFDoc_DocumentTool::ShapeTool(document_.xde->Main())->GetFreeShapes(labels);
    return labels.Size() == 1 ? label_name(labels.First()) : "";
  }

 private:
  Looks stated(const TopoDS_Shape& shape) const {
    Looks looks;
    looks.coloured = colours_->GetColor(shape, XCAFDoc_ColorSurf, looks.colour) ||
                     colours_->GetColor(shape, XCAFDoc_ColorGen, looks.colour);
    layers_->GetLayers(shape, looks.layers);
    return looks;
  }

  const Document& document_;
  Handle(XCAFDoc_ColorTool) colours_;
  Handle(XCAFDoc_LayerTool) layers_;
  std::vector<TDF_Label> parts_;
};

}  // namespace

bool is_assembly(const Document& document) {
  if (document.session.IsNull() || document.session->Model().IsNull()) return false;
  const Handle(Interface_InterfaceModel) model = document.session->Model();
  for (int k = 1; k <= model->NbEntities(); ++k) {
    if (model->Value(k)->IsKind(STANDARD_TYPE(StepRepr_NextAssemblyUsageOccurrence))) return true;
  }
  return false;
}

void relabel(Document& document, const TopoDS_Shape& shape, const std::vector<SewnFace>& faces) {
  if (document.xde.IsNull()) return;
  const OldLooks old(document);
  const Handle(TDocStd_Document) xde = new_xde();
  work_in(document.unit, xde);
  const auto shapes = XCAFDoc_DocumentTool::ShapeTool(xde->Main());
  const auto colours = XCAFDoc_DocumentTool::ColorTool(xde->Main());
  const auto layers = XCAFDoc_DocumentTool::LayerTool(xde->Main());
  const TDF_Label part = shapes->AddShape(shape, Standard_False);
  set_name(part, old.title());
  for (const auto& [own, sewn] : faces) {
    const Looks looks = old.of(own);
    if (looks.empty()) continue;
    const TDF_Label label = shapes->AddSubShape(part, sewn);
    if (label.IsNull()) continue;
    set_name(label, looks.name);
    if (looks.coloured) colours->SetColor(label, looks.colour, XCAFDoc_ColorSurf);
    if (looks.layers.IsNull()) continue;
    for (const TCollection_ExtendedString& layer : *looks.layers) layers->SetLayer(label, layer);
  }
  document.xde = xde;
}

}  // namespace isochor::internal
