#include "isochor/volume/findings.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <sstream>

#include "isochor/base/tolerance.h"
#include "isochor/bspline/joins.h"
#include "isochor/volume/closing.h"

namespace isochor {
namespace {

// A face narrower, or an edge shorter, than this many tolerances is lost to other programs.
constexpr double kTinyTolerances = 4.0;
// Tolerances above this part of the diagonal hide real gaps.
constexpr double kLargeTolerance = 1e-4;
// Measured gaps beyond the tolerance by less than this part are rounding.
constexpr double kGapSlack = 1e-3;

std::string print(double value) {
  std::ostringstream text;
  text.precision(3);
  text << value;
  return text.str();
}

double length_of(const std::vector<Vec3>& points) {
  double length = 0.0;
  for (size_t k = 1; k < points.size(); ++k) length += (points[k] - points[k - 1]).norm();
  return length;
}

std::optional<Vec3> middle_of(const CheckedEdge& edge) {
  if (edge.points.empty()) return std::nullopt;
  return edge.points[edge.points.size() / 2];
}

class Collector {
 public:
  explicit Collector(const CheckedModel& model) : model_(model) {}

  std::vector<Finding> take() {
    for (const std::string& defect : model_.defects) {
      const std::string place = defect.substr(0, defect.find(": "));
      Finding finding{"invalid", Severity::kFault, place, {}, {}, {}, {}, -1, entity_of(place), {}};
      finding.text = defect + numbers_of(finding);
      add(std::move(finding));
    }
    for (const std::string& fault : model_.import_faults) {
      add({"import", Severity::kFault, "", {}, {}, {}, fault, -1, "", {}});
    }
    for (const std::string& warning : model_.import_warnings) {
      add({"import", Severity::kWarning, "", {}, {}, {}, warning, -1, "", {}});
    }
    for (size_t e = 0; e < model_.edges.size(); ++e) judge_edge(static_cast<int>(e));
    for (const CheckedFace& face : model_.faces) judge_face(face);
    for (const CheckedCrossing& crossing : model_.crossings) judge_crossing(crossing);
    judge_whole();
    std::stable_sort(found_.begin(), found_.end(), [](const Finding& a, const Finding& b) {
      if (a.severity != b.severity) return a.severity > b.severity;
      if (a.kind != b.kind) return false;
      return excess(a) > excess(b);
    });
    return std::move(found_);
  }

 private:
  static double excess(const Finding& f) {
    return f.value && f.limit && *f.limit > 0.0 ? *f.value / *f.limit : 0.0;
  }
  // " [#12; faces #3, #4]", for the text.
  static std::string numbers_of(const Finding& f) {
    std::string faces;
    for (const std::string& entity : f.face_entities) faces += (faces.empty() ? "" : ", ") + entity;
    if (!faces.empty()) faces = (f.face_entities.size() == 1 ? "face " : "faces ") + faces;
    if (f.entity.empty() && faces.empty()) return "";
    return " [" + f.entity + (f.entity.empty() || faces.empty() ? "" : "; ") + faces + "]";
  }
  // The number of the face that a place like "face:2" names.
  std::string entity_of(const std::string& place) const {
    for (const CheckedFace& face : model_.faces) {
      if (face.label == place || face.label.rfind(place + " ", 0) == 0) return face.entity;
    }
    return "";
  }
  void add(Finding finding) { found_.push_back(std::move(finding)); }

  void add_at_edge(int e, const char* kind, Severity severity, std::optional<double> value,
                   std::optional<double> limit, const std::string& text) {
    const CheckedEdge& edge = model_.edges[static_cast<size_t>(e)];
    const std::optional<Vec3> at = middle_of(edge);
    std::ostringstream where;
    where.precision(4);
    if (at) where << " at (" << at->transpose() << ")";
    Finding finding{kind, severity, edge.label, at, value, limit, {}, e, edge.entity, {}};
    for (int face : edge.faces) {
      const std::string& entity = model_.faces[static_cast<size_t>(face)].entity;
      if (!entity.empty()) finding.face_entities.push_back(entity);
    }
    finding.text = edge.label + where.str() + " " + text + numbers_of(finding);
    add(std::move(finding));
  }

  void judge_edge(int e) {
    const CheckedEdge& edge = model_.edges[static_cast<size_t>(e)];
    const std::string unit = " " + model_.unit;
    if (edge.uses == 1 && !model_.closed) {
      add_at_edge(e, "free edge", Severity::kFault, {}, {}, "belongs to one face only");
    }
    if (edge.uses > 2) {
      add_at_edge(e, "multiple edge", Severity::kFault, static_cast<double>(edge.uses), 2.0,
                  "is used by " + std::to_string(edge.uses) + " faces");
    }
    if (edge.tolerance > 0.0 && edge.gap > (1.0 + kGapSlack) * edge.tolerance) {
      add_at_edge(
          e, "gap", Severity::kWarning, edge.gap, edge.tolerance,
          "is open by " + print(edge.gap) + unit + ", its tolerance is " + print(edge.tolerance));
    }
    if (edge.length > 0.0 && edge.length <= kTinyTolerances * edge.tolerance) {
      add_at_edge(
          e, "tiny edge", Severity::kWarning, kTinyTolerances * edge.tolerance, edge.length,
          "is " + print(edge.length) + unit + " long, its tolerance is " + print(edge.tolerance));
    }
    if (edge.measured && edge.smoothness == Smoothness::kAlmost) {
      add_at_edge(e, "almost smooth", Severity::kNote, edge.angle_deg,
                  kSmoothAngle * kDegreesPerRadian,
                  "is smooth but for " + print(edge.angle_deg) + " degrees");
    }
    if (edge.measured && edge.angle_deg > kFolded) {
      add_at_edge(e, "fold", Severity::kNote, edge.angle_deg, kFolded,
                  "folds back by " + print(edge.angle_deg) +
                      " degrees: a knife edge, or a face turned round");
    }
  }

  void judge_face(const CheckedFace& face) {
    if (!(face.perimeter > 0.0)) return;
    const double width = 2.0 * face.area / face.perimeter;
    const double limit =
        kTinyTolerances * std::max(face.tolerance, kUnitRoundoff * model_.diagonal);
    if (width > limit) return;
    Finding finding{"tiny face", Severity::kWarning, face.label, {}, limit, width, {},
                    -1,          face.entity,        {}};
    finding.text = face.label + " is " + print(width) + " " + model_.unit +
                   " wide, its tolerance is " + print(face.tolerance) + numbers_of(finding);
    add(std::move(finding));
  }

  void judge_crossing(const CheckedCrossing& crossing) {
    const CheckedFace& a = model_.faces[static_cast<size_t>(crossing.face_a)];
    const CheckedFace& b = model_.faces[static_cast<size_t>(crossing.face_b)];
    const bool itself = crossing.face_a == crossing.face_b;
    std::ostringstream where;
    where.precision(4);
    where << " at (" << crossing.at.transpose() << ")";
    Finding finding{"self-intersection",
                    crossing.one_body ? Severity::kFault : Severity::kWarning,
                    itself ? a.label : a.label + " and " + b.label,
                    crossing.at,
                    crossing.depth,
                    crossing.limit,
                    {},
                    -1,
                    "",
                    {}};
    if (itself) {
      finding.entity = a.entity;
    } else {
      for (const CheckedFace* face : {&a, &b}) {
        if (!face->entity.empty()) finding.face_entities.push_back(face->entity);
      }
    }
    finding.text = finding.place + (itself ? " cuts through itself" : " cut through each other") +
                   where.str() + " by " + print(crossing.depth) + " " + model_.unit + " or more" +
                   (crossing.one_body ? "" : ", of two solids") + numbers_of(finding);
    add(std::move(finding));
  }

  void judge_whole() {
    const bool shown = std::any_of(model_.edges.begin(), model_.edges.end(),
                                   [](const CheckedEdge& edge) { return edge.uses != 2; });
    if (!model_.closed && !shown) {  // else the edges say so
      add({"open", Severity::kFault, "", {}, {}, {}, "open: " + model_.why_open, -1, "", {}});
    }
    if (model_.closed && model_.volume < 0.0) {
      add({"orientation",
           Severity::kFault,
           "",
           {},
           {},
           {},
           "oriented inwards: the volume is negative",
           -1,
           "",
           {}});
    }
    if (model_.closed && !(model_.volume_bound < std::abs(model_.volume))) {
      add({"volume",
           Severity::kFault,
           "",
           {},
           model_.volume_bound,
           std::abs(model_.volume),
           "the volume is not determined: " + print(model_.volume) + ", error at most " +
               print(model_.volume_bound),
           -1,
           "",
           {}});
    }
    double largest = 0.0;
    int at = -1;
    for (size_t e = 0; e < model_.edges.size(); ++e) {
      if (model_.edges[e].tolerance > largest) {
        largest = model_.edges[e].tolerance;
        at = static_cast<int>(e);
      }
    }
    const double limit = kLargeTolerance * model_.diagonal;
    if (largest > limit && at >= 0) {
      add_at_edge(at, "large tolerance", Severity::kWarning, largest, limit,
                  "has the tolerance " + print(largest) + " " + model_.unit + ", " +
                      print(largest / model_.diagonal) + " of the model's diagonal");
    }
  }

  static constexpr double kFolded = 175.0;  // degrees
  const CheckedModel& model_;
  std::vector<Finding> found_;
};

}  // namespace

const char* name_of(Severity severity) {
  switch (severity) {
    case Severity::kNote:
      return "note";
    case Severity::kWarning:
      return "warning";
    case Severity::kFault:
      return "fault";
  }
  return "?";
}

CheckedModel checked(const PatchModel& model) {
  CheckedModel result;
  result.unit = model.unit;
  result.diagonal = diagonal(model);
  const Closure closed = closure(model);
  result.closed = closed.closed;
  result.defects = closed.misoriented_sides;
  const auto points_along = [&](const SideRef& side) {
    Closure single;
    single.open = {side};
    return open_edges(model, single).front().points;
  };
  std::map<std::pair<int, Side>, int> uses;
  const std::vector<Join> joins = model.joins.empty() ? find_joins(model) : model.joins;
  for (const Join& join : joins) {
    ++uses[{join.a.patch, join.a.side}];
    ++uses[{join.b.patch, join.b.side}];
  }
  for (const Join& join : joins) {
    CheckedEdge edge;
    edge.label = label_of(model, join.a) + " and " + label_of(model, join.b);
    edge.points = points_along(join.a);
    edge.length = length_of(edge.points);
    edge.uses = 1 + std::max(uses[{join.a.patch, join.a.side}], uses[{join.b.patch, join.b.side}]);
    edge.measured = true;
    edge.gap = join.max_gap;
    edge.angle_deg = join.max_angle_rad * kDegreesPerRadian;
    edge.smoothness = join.smoothness;
    result.edges.push_back(std::move(edge));
  }
  for (const OpenEdge& open : open_edges(model, closed)) {
    CheckedEdge edge;
    edge.label = open.label;
    edge.points = open.points;
    edge.length = length_of(edge.points);
    edge.uses = 1;
    result.edges.push_back(std::move(edge));
  }
  for (const Patch& patch : model.patches)
    result.faces.push_back({label_of(patch), 0.0, 0.0, 0.0, ""});
  return result;
}

std::vector<Finding> findings_of(const CheckedModel& model) { return Collector(model).take(); }

std::vector<AngleBin> angle_histogram(const CheckedModel& model) {
  std::vector<AngleBin> bins = {{0.0, kSmoothAngle * kDegreesPerRadian},
                                {kSmoothAngle * kDegreesPerRadian, 0.1},
                                {0.1, 1.0},
                                {1.0, kAlmostSmoothAngle * kDegreesPerRadian},
                                {kAlmostSmoothAngle * kDegreesPerRadian, 30.0},
                                {30.0, 90.0},
                                {90.0, 180.0 + 1e-9}};
  for (const CheckedEdge& edge : model.edges) {
    if (!edge.measured || edge.uses != 2) continue;
    for (AngleBin& bin : bins) {
      if (bin.from <= edge.angle_deg && edge.angle_deg < bin.to) ++bin.edges;
    }
  }
  return bins;
}

}  // namespace isochor
