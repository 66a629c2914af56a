#include "isochor/step/import_faces.h"

#include <StepData_StepModel.hxx>
#include <TopExp.hxx>
#include <TransferBRep.hxx>
#include <Transfer_TransientProcess.hxx>
#include <XSControl_TransferReader.hxx>
#include <unordered_map>
#include <unordered_set>

#include "isochor/step/import_text.h"

namespace isochor::internal {
namespace {

using Shapes = std::unordered_set<const void*>;  // by what located copies share

Shapes shapes_of(const TopoDS_Shape& shape, TopAbs_ShapeEnum kind) {
  if (shape.ShapeType() == kind) return {shape.TShape().get()};
  TopTools_IndexedMapOfShape parts;
  TopExp::MapShapes(shape, kind, parts);
  Shapes found;
  for (int k = 1; k <= parts.Extent(); ++k) found.insert(parts(k).TShape().get());
  return found;
}

// Finds the entities of the model by their numbers in the file.
class NumberedEntities {
 public:
  explicit NumberedEntities(const StepData_StepModel& model) : model_(model) {}

  // `place`: of the instance in the file, from 0; null when there is none of that number. The model
  // keeps the order of the file, so its place is the first guess.
  Handle(Standard_Transient) find(int number, size_t place) {
    const int guess = static_cast<int>(place) + 1;
    if (guess <= model_.NbEntities() && model_.IdentLabel(model_.Value(guess)) == number) {
      return model_.Value(guess);
    }
    if (entities_.empty()) {
      for (int k = 1; k <= model_.NbEntities(); ++k) {
        entities_.emplace(model_.IdentLabel(model_.Value(k)), model_.Value(k));
      }
    }
    const auto found = entities_.find(number);
    return found == entities_.end() ? Handle(Standard_Transient)() : found->second;
  }

 private:
  const StepData_StepModel& model_;
  std::unordered_map<int, Handle(Standard_Transient)> entities_;
};

// Looks for each stated face among those returned.
void compare(const Document& document, const StatedShapes& stated, const Shapes& returned,
             ImportAccount& account) {
  const auto model = Handle(StepData_StepModel)::DownCast(document.session->Model());
  const auto process = document.session->TransferReader()->TransientProcess();
  if (model.IsNull() || process.IsNull()) return;
  NumberedEntities entities(*model);
  Shapes claimed;
  for (const StatedFace& face : stated.faces) {
    const auto entity = entities.find(static_cast<int>(face.number), face.place);
    bool found = false;
    if (!entity.IsNull()) {
      const TopoDS_Shape result = TransferBRep::ShapeResult(process, entity);
      if (!result.IsNull()) {
        for (const void* part : shapes_of(result, TopAbs_FACE)) {
          if (returned.count(part) == 0) continue;
          claimed.insert(part);
          found = true;
        }
      }
    }
    if (!found) account.lost.push_back(face.text);
  }
  account.added_faces = static_cast<int>(returned.size() - claimed.size());
}

}  // namespace

void account_for_import(Document& document) {
  ImportAccount& account = document.account;
  const Shapes faces = shapes_of(document.shape, TopAbs_FACE);
  account.read = {static_cast<int>(shapes_of(document.shape, TopAbs_SOLID).size()),
                  static_cast<int>(shapes_of(document.shape, TopAbs_SHELL).size()),
                  static_cast<int>(faces.size())};
  if (document.format != FileFormat::kStep) return;
  const StatedShapes stated = stated_shapes(document.path);
  account.has_text = true;
  account.entities = stated.entities;
  account.stated = stated.counts;
  account.broken = stated.broken;
  account.unused = stated.unused;
  if (stated.readable) {
    compare(document, stated, faces, account);
  } else if (account.read.faces < account.stated.faces) {
    account.lost.assign(static_cast<size_t>(account.stated.faces - account.read.faces),
                        "one of unknown number");
  }
}

}  // namespace isochor::internal
