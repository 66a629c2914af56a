#include "isochor/step/surgical_properties.h"

#include <algorithm>

namespace isochor::internal {
namespace {

constexpr std::string_view kValidation = "geometric validation property";

bool is_validation(const Part21File& file, const Part21Instance& instance) {
  if (instance.keyword != "PROPERTY_DEFINITION") return false;
  const auto record = file.record(instance, "PROPERTY_DEFINITION");
  return record.arguments.size() == 3 && record.arguments[0].is(Part21Kind::kString) &&
         file.string_of(record.arguments[0]) == kValidation;
}

class Updater {
 public:
  Updater(const Part21File& file, const Part21References& references, const MeasureChange& change,
          Part21Edit& edit)
      : file_(file), references_(references), change_(change), edit_(edit) {}

  // Whether the definition of a property leads to an edited part or to an assembly.
  bool concerned(const Part21Instance& property, const std::set<std::uint64_t>& faces) {
    if (change_.known) return true;
    if (above_.empty()) climb(faces);
    const Part21Instance* at = definition(property, "PROPERTY_DEFINITION", 2);
    if (at != nullptr && at->keyword == "SHAPE_ASPECT") at = definition(*at, "SHAPE_ASPECT", 2);
    if (at == nullptr || at->keyword != "PRODUCT_DEFINITION_SHAPE") return true;
    if (above_.count(at->number) > 0) return true;
    const Part21Instance* product = definition(*at, "PRODUCT_DEFINITION_SHAPE", 2);
    for (const Part21Use& use : references_.to(product == nullptr ? 0 : product->number)) {
      const Part21Instance& by = file_.instances()[use.user];
      if (by.keyword == "NEXT_ASSEMBLY_USAGE_OCCURRENCE" &&
          definition(by, by.keyword, 3) == product) {
        return true;
      }
    }
    return false;
  }

  void update(const Part21Instance& property) {
    for (const Part21Use& use : references_.to(property.number)) {
      const Part21Instance& by = file_.instances()[use.user];
      if (by.keyword != "PROPERTY_DEFINITION_REPRESENTATION") continue;
      const Part21Instance* representation = definition(by, by.keyword, 1);
      const bool done = change_.known && representation != nullptr && recompute(*representation);
      if (done) {
        ++recomputed_;
      } else if (references_.to(by.number).size() == 0) {
        edit_.remove(by);
        ++dropped_;
      } else {
        ++stale_;
      }
    }
  }

  void report(std::vector<std::string>& notices) const {
    const auto note = [&](int count, const std::string& what) {
      if (count == 0) return;
      notices.push_back(std::to_string(count) + " stated volumes, areas or centroids (" +
                        std::string(kValidation) + ") " + what);
    };
    note(recomputed_, "were recomputed");
    note(dropped_, "of edited parts were dropped");
    note(stale_, "may no longer hold");
  }

 private:
  const Part21Instance* definition(const Part21Instance& from, std::string_view keyword,
                                   size_t k) const {
    const auto record = file_.record(from, keyword);
    if (k >= record.arguments.size() || !record.arguments[k].is(Part21Kind::kReference)) {
      return nullptr;
    }
    return file_.find(record.arguments[k].reference);
  }

  // Everything that names an edited face, and the shapes of products that these represent.
  void climb(const std::set<std::uint64_t>& faces) {
    std::vector<std::uint64_t> waiting(faces.begin(), faces.end());
    above_ = faces;
    const auto reach = [&](std::uint64_t number) {
      if (above_.insert(number).second) waiting.push_back(number);
    };
    while (!waiting.empty()) {
      const std::uint64_t number = waiting.back();
      waiting.pop_back();
      for (const Part21Use& use : references_.to(number)) {
        const Part21Instance& by = file_.instances()[use.user];
        reach(by.number);
        if (by.keyword != "SHAPE_DEFINITION_REPRESENTATION") continue;
        const Part21Instance* shape = definition(by, by.keyword, 0);
        if (shape != nullptr) above_.insert(shape->number);
      }
    }
  }

  bool recompute(const Part21Instance& representation) {
    if (representation.complex()) return false;
    bool all = true;
    const auto record = file_.record(representation, representation.keyword);
    if (record.arguments.size() < 2) return false;
    for (const auto& item : record.arguments[1].items) {
      const Part21Instance& instance = file_.follow(representation, item);
      all = (instance.keyword == "CARTESIAN_POINT" ? shift(instance) : scale(instance)) && all;
    }
    return all && !record.arguments[1].items.empty();
  }

  bool scale(const Part21Instance& instance) {
    for (const auto& part : file_.records(instance)) {
      for (const auto& value : part.arguments) {
        const bool volume = value.word == "VOLUME_MEASURE", area = value.word == "AREA_MEASURE";
        if (!value.is(Part21Kind::kTyped) || (!volume && !area) || value.items.size() != 1 ||
            !value.items[0].numeric()) {
          continue;
        }
        put(instance, value.items[0],
            value.items[0].number * (volume ? change_.volume_factor : change_.area_factor));
        return true;
      }
    }
    return false;
  }

  bool shift(const Part21Instance& point) {
    const auto record = file_.record(point, "CARTESIAN_POINT");
    if (record.arguments.size() != 2 || record.arguments[1].items.size() != 3) return false;
    for (size_t k = 0; k < 3; ++k) {
      const Part21Value& value = record.arguments[1].items[k];
      if (!value.numeric()) return false;
      put(point, value, value.number + change_.centroid_shift[static_cast<int>(k)]);
    }
    return true;
  }

  void put(const Part21Instance& instance, const Part21Value& old, double value) {
    if (value != old.number) edit_.replace(instance, old.span, step_real(value));
  }

  const Part21File& file_;
  const Part21References& references_;
  const MeasureChange& change_;
  Part21Edit& edit_;
  std::set<std::uint64_t> above_;
  int recomputed_ = 0, dropped_ = 0, stale_ = 0;
};

}  // namespace

bool states_measures(const Part21File& file) {
  return file.text().find(kValidation) != std::string::npos;
}

void update_measures(const Part21File& file, const Part21References& references,
                     const std::set<std::uint64_t>& faces, const MeasureChange& change,
                     Part21Edit& edit, std::vector<std::string>& notices) {
  Updater updater(file, references, change, edit);
  size_t triangles = 0;
  for (const auto& instance : file.instances()) {
    if (is_validation(file, instance) && updater.concerned(instance, faces)) {
      updater.update(instance);
    }
    if (instance.keyword.rfind("TESSELLATED_S", 0) == 0) ++triangles;
  }
  updater.report(notices);
  if (triangles > 0) {
    notices.push_back("the file also has triangles (" + std::to_string(triangles) +
                      " tessellated solids or shells); they still show the shape before the edit");
  }
}

}  // namespace isochor::internal
