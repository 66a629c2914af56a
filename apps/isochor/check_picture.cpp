#include "check_picture.h"

#include <array>
#include <set>

#include "isochor/picture/edit_picture.h"
#include "model_picture.h"
#include "terminal.h"

namespace isochor::app {
namespace {

// What an edge is drawn as. Later ones are drawn over earlier ones.
struct EdgeClass {
  const char* word;
  std::array<double, 3> colour;
  double width;
};
constexpr size_t kClasses = 5;
const std::array<EdgeClass, kClasses> kEdgeClasses = {
    {{"blue: smooth", {0.16, 0.42, 0.80}, 1.4},
     {"black: sharp", {0.13, 0.14, 0.16}, 1.6},
     {"orange: almost smooth", {0.93, 0.55, 0.05}, 3.2},
     {"magenta: with a finding", {0.72, 0.10, 0.68}, 4.0},
     {"red: free", {0.86, 0.10, 0.10}, 4.4}}};

constexpr double kStarArm = 0.03;  // of the diagonal

size_t class_of(const CheckedEdge& edge, bool marked) {
  if (edge.uses == 1) return 4;
  if (marked || edge.uses > 2) return 3;
  if (!edge.measured) return 1;
  if (edge.smoothness == Smoothness::kSharp) return 1;
  return edge.smoothness == Smoothness::kAlmost ? 2 : 0;
}

// A star at every place where faces cut through each other.
LineSet stars_at(const CheckedModel& subject) {
  LineSet stars;
  stars.colour = {0.05, 0.55, 0.20};
  stars.width = 4.0;
  const double arm = kStarArm * subject.diagonal;
  for (const CheckedCrossing& crossing : subject.crossings) {
    for (const Vec3 axis : {Vec3::UnitX(), Vec3::UnitY(), Vec3::UnitZ()}) {
      stars.add({crossing.at - arm * axis, crossing.at + arm * axis});
    }
  }
  return stars;
}

}  // namespace

Image draw_check(const LoadedModel& loaded, const CheckedModel& subject,
                 const std::vector<Finding>& findings, const Common& common) {
  std::vector<char> marked(subject.edges.size(), 0);
  int faults = 0;
  int warnings = 0;
  for (const Finding& finding : findings) {
    faults += finding.severity == Severity::kFault ? 1 : 0;
    warnings += finding.severity == Severity::kWarning ? 1 : 0;
    const bool edge = finding.edge >= 0 && finding.kind != "almost smooth";
    if (edge && finding.kind != "large tolerance") marked[static_cast<size_t>(finding.edge)] = 1;
  }
  // Faces that cut through each other show by their edges; the place itself may be hidden.
  std::set<int> crossing;
  for (const CheckedCrossing& c : subject.crossings) crossing.insert({c.face_a, c.face_b});
  for (size_t e = 0; e < subject.edges.size(); ++e) {
    for (int face : subject.edges[e].faces) {
      if (crossing.count(face) > 0) marked[e] = 1;
    }
  }
  ModelPictureInput input;
  input.mesh = mesh_of(loaded, common).mesh;
  input.lines.resize(kClasses);
  std::array<int, kClasses> counts{};
  for (size_t k = 0; k < kClasses; ++k) {
    input.lines[k].colour = kEdgeClasses[k].colour;
    input.lines[k].width = kEdgeClasses[k].width;
  }
  for (size_t e = 0; e < subject.edges.size(); ++e) {
    if (subject.edges[e].points.size() < 2) continue;
    const size_t k = class_of(subject.edges[e], marked[e] != 0);
    input.lines[k].add(subject.edges[e].points);
    ++counts[k];
  }
  if (!subject.crossings.empty()) input.lines.push_back(stars_at(subject));
  input.title = "check of " + loaded.path;
  input.caption.push_back(format("%d faults, %d warnings", faults, warnings));
  std::string legend;
  for (size_t k = 0; k < kClasses; ++k) {
    if (counts[k] == 0) continue;
    legend += (legend.empty() ? "edges: " : "   ") + std::string(kEdgeClasses[k].word) + " " +
              std::to_string(counts[k]);
  }
  if (!subject.crossings.empty()) {
    legend +=
        "   green stars: faces cut through each other " + std::to_string(subject.crossings.size());
  }
  if (!legend.empty()) input.caption.push_back(legend);
  constexpr size_t kListed = 4;
  for (size_t k = 0; k < findings.size() && k < kListed; ++k) {
    input.caption.push_back(findings[k].text);
  }
  return model_picture(input);
}

}  // namespace isochor::app
