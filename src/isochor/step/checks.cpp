#include "isochor/step/checks.h"

#include <BRepBndLib.hxx>
#include <BRep_Tool.hxx>
#include <Bnd_Box.hxx>
#include <TopExp.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS.hxx>
#include <algorithm>
#include <cmath>
#include <cstdio>

namespace isochor::internal {
namespace {

// Rounding allowed when two lengths of one model are compared; relative to its diagonal.
constexpr double kLengthRounding = 1e-12;

// Volume and area after a round trip; relative. B-spline faces come back bit for bit and analytic
// ones move by a unit in the last place; the area is integrated to some six digits only.
constexpr double kSameVolume = 1e-8;
constexpr double kSameArea = 1e-5;

// Tolerances are stored with the digits of a double but read through a sum.
constexpr double kSameTolerance = 1e-9;

std::string first_defect(const ShapeFacts& facts) {
  return facts.defects.empty() ? "" : " (" + facts.defects.front() + ")";
}

std::string changed(const std::string& what, double from, double to) {
  return what + " changed from " + number_text(from) + " to " + number_text(to);
}

std::string changed(const std::string& what, int from, int to) {
  return what + " changed from " + std::to_string(from) + " to " + std::to_string(to);
}

std::string grew(const std::string& what, double from, double to, double allowed) {
  if (to <= from + allowed) return "";
  return what + " grew from " + number_text(from) + " by " + number_text(to - from);
}

// Loose faces get shells of their own in some formats, so open shells and their edges do not count.
std::string different_topology(const ShapeFacts& a, const ShapeFacts& b) {
  if (a.solids != b.solids) return changed("the number of solids", a.solids, b.solids);
  if (a.solids > 0 && a.closed_shells != b.closed_shells) {
    return changed("the number of closed shells", a.closed_shells, b.closed_shells);
  }
  if (a.closed != b.closed) return b.closed ? "an open shape was closed" : "it is no longer closed";
  if (a.closed && a.shells != b.shells) return changed("the number of shells", a.shells, b.shells);
  return "";
}

// Measures that are not known (infinite) are not compared.
std::string different_measure(const std::string& what, double a, double b, double allowed) {
  if (!std::isfinite(a) || !std::isfinite(b) || !std::isfinite(allowed)) return "";
  if (std::abs(a - b) <= allowed) return "";
  return changed(what, a, b) + " (by " + number_text(b - a) + ")";
}

// A name that is missing afterwards; readers may add names of their own.
std::string lost_name(std::vector<std::string> before, std::vector<std::string> after) {
  std::sort(before.begin(), before.end());
  std::sort(after.begin(), after.end());
  std::vector<std::string> lost;
  std::set_difference(before.begin(), before.end(), after.begin(), after.end(),
                      std::back_inserter(lost));
  return lost.empty() ? "" : lost.front();
}

}  // namespace

std::string number_text(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g", value);
  return text;
}

std::string objection_to_rebuilt(const ShapeFacts& before, const ShapeFacts& rebuilt,
                                 double trim_tolerance) {
  if (!before.valid) return "the input is not a valid solid" + first_defect(before);
  if (!rebuilt.valid) return "the edited shape is not valid" + first_defect(rebuilt);
  std::string text = different_topology(before, rebuilt);
  const double rounding = kLengthRounding * before.diagonal;
  if (text.empty()) {
    text = grew("the largest tolerance", std::max(before.max_tolerance, trim_tolerance),
                rebuilt.max_tolerance, 0.0);
  }
  if (text.empty()) {
    text = grew("the largest gap between an edge and its faces",
                std::max(before.max_edge_gap, trim_tolerance), rebuilt.max_edge_gap, rounding);
  }
  if (text.empty()) {
    text = grew("the largest gap at a vertex", std::max(before.max_vertex_gap, trim_tolerance),
                rebuilt.max_vertex_gap, rounding);
  }
  return text;
}

std::string objection_to_gaps(const TopoDS_Shape& before, const TopoDS_Shape& rebuilt) {
  TopTools_IndexedMapOfShape old_edges, new_edges;
  TopExp::MapShapes(before, TopAbs_EDGE, old_edges);
  TopExp::MapShapes(rebuilt, TopAbs_EDGE, new_edges);
  if (old_edges.Extent() != new_edges.Extent()) {
    return changed("the number of edges", old_edges.Extent(), new_edges.Extent());
  }
  const Gaps old_gaps = measure_gaps(before), new_gaps = measure_gaps(rebuilt);
  Bnd_Box box;
  BRepBndLib::Add(before, box);
  const double rounding = kLengthRounding * std::sqrt(box.SquareExtent());
  for (size_t k = 0; k < new_gaps.edges.size(); ++k) {
    const double own = BRep_Tool::Tolerance(TopoDS::Edge(new_edges(static_cast<int>(k) + 1)));
    const std::string text = grew("the gap along edge " + std::to_string(k + 1),
                                  std::max(old_gaps.edges[k], own), new_gaps.edges[k], rounding);
    if (!text.empty()) return text;
  }
  return "";
}

std::string tolerance_growth(const ShapeFacts& written, const ShapeFacts& reread, double allowed) {
  const double before = std::max(written.max_tolerance, allowed);
  const std::string text =
      grew("the largest tolerance", before, reread.max_tolerance, kSameTolerance * before);
  return text.empty() ? "" : "after reading the file back, " + text;
}

GapGrowth gap_growth(const ShapeFacts& written, const ShapeFacts& reread) {
  GapGrowth growth;
  const double rounding = kLengthRounding * written.diagonal;
  const auto compare = [&](const std::string& what, double from, double to) {
    const std::string text = grew(what, from, to, rounding);
    if (text.empty()) return;
    const bool inside = to <= written.max_tolerance + rounding;
    std::string& place = inside ? growth.inside : growth.beyond;
    if (place.empty()) {
      place = "after reading the file back, " + text + (inside ? ", inside" : ", beyond") +
              " the tolerance of " + number_text(written.max_tolerance);
    }
  };
  compare("the largest gap between an edge and its faces", written.max_edge_gap,
          reread.max_edge_gap);
  compare("the largest gap at a vertex", written.max_vertex_gap, reread.max_vertex_gap);
  return growth;
}

std::string objection_to_reread(const ShapeFacts& written, const ShapeFacts& reread, bool labels) {
  if (written.valid && !reread.valid) {
    return "the file reads back as an invalid shape" + first_defect(reread);
  }
  std::string text = different_topology(written, reread);
  if (text.empty()) {
    text = different_measure("the area", written.area, reread.area, kSameArea * written.area);
  }
  if (text.empty()) {
    // Faces that meet within a tolerance enclose a volume only up to that times their area.
    const double slack =
        written.area * (written.max_tolerance + kLengthRounding * written.diagonal);
    text = different_measure("the volume", written.volume, reread.volume,
                             written.volume_bound + reread.volume_bound +
                                 kSameVolume * std::abs(written.volume) + slack);
  }
  if (text.empty() && labels) {
    const std::string lost = lost_name(written.names, reread.names);
    if (!lost.empty()) text = "the name '" + lost + "' was lost";
    if (text.empty() && reread.coloured < written.coloured) {
      text = changed("the number of coloured parts", written.coloured, reread.coloured);
    }
  }
  return text.empty() ? "" : "after reading the file back, " + text;
}

}  // namespace isochor::internal
