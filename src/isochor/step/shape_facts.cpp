#include "isochor/step/shape_facts.h"

#include <BRepBndLib.hxx>
#include <BRepCheck.hxx>
#include <BRepCheck_Analyzer.hxx>
#include <BRepCheck_ListIteratorOfListOfStatus.hxx>
#include <BRepCheck_Result.hxx>
#include <BRep_Tool.hxx>
#include <Bnd_Box.hxx>
#include <TDF_ChildIterator.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopTools_ShapeMapHasher.hxx>
#include <TopoDS.hxx>
#include <XCAFDoc_ColorTool.hxx>
#include <XCAFDoc_DocumentTool.hxx>
#include <XCAFDoc_ShapeTool.hxx>
#include <algorithm>
#include <cctype>
#include <set>
#include <sstream>

#include "isochor/step/flux.h"
#include "isochor/step/gaps.h"

namespace isochor::internal {
namespace {

constexpr size_t kListedDefects = 20;

// "BRepCheck_InvalidCurveOnSurface" becomes "invalid curve on surface".
std::string words_of(BRepCheck_Status status) {
  std::ostringstream printed;
  BRepCheck::Print(status, printed);
  std::string name = printed.str();
  name = name.substr(name.find('_') + 1);
  std::string words;
  for (char c : name) {
    if (std::isspace(static_cast<unsigned char>(c))) continue;
    const bool upper = std::isupper(static_cast<unsigned char>(c));
    if (upper && !words.empty() && words.back() != ' ') words += ' ';
    words += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  }
  return words;
}

// Collects what the analyser found, once per place.
class DefectList {
 public:
  DefectList(const BRepCheck_Analyzer& analyser, const TopoDS_Shape& shape) : analyser_(analyser) {
    TopTools_IndexedMapOfShape faces;
    TopExp::MapShapes(shape, TopAbs_FACE, faces);
    for (int k = 1; k <= faces.Extent(); ++k) {
      const std::string where = "face:" + std::to_string(k);
      const size_t others = found_.size();
      for (const auto kind : {TopAbs_WIRE, TopAbs_EDGE, TopAbs_VERTEX}) {
        for (TopExp_Explorer it(faces(k), kind); it.More(); it.Next()) {
          add(it.Current(), where);
        }
      }
      // A face whose outline is bad is called unorientable besides; the outline is the news.
      outline_is_bad_ = found_.size() > others;
      add(faces(k), where);
      outline_is_bad_ = false;
    }
    for (const auto kind : {TopAbs_SHELL, TopAbs_SOLID}) {
      for (TopExp_Explorer it(shape, kind); it.More(); it.Next()) {
        add(it.Current(), kind == TopAbs_SHELL ? "shell" : "solid");
      }
    }
  }

  std::vector<std::string> take() {
    if (found_.size() > kListedDefects) {
      const size_t more = found_.size() - kListedDefects;
      found_.resize(kListedDefects);
      found_.push_back(std::to_string(more) + " more");
    }
    return std::move(found_);
  }

 private:
  // A vertex may be good in itself and not lie on its edge: contexts count too.
  void add(const TopoDS_Shape& part, const std::string& where) {
    const Handle(BRepCheck_Result)& result = analyser_.Result(part);
    if (result.IsNull()) return;
    add(result->Status(), part, where);
    for (result->InitContextIterator(); result->MoreShapeInContext();
         result->NextShapeInContext()) {
      add(result->StatusOnShape(), part, where);
    }
  }

  void add(const BRepCheck_ListOfStatus& statuses, const TopoDS_Shape& part,
           const std::string& where) {
    for (BRepCheck_ListIteratorOfListOfStatus it(statuses); it.More(); it.Next()) {
      if (it.Value() == BRepCheck_NoError) continue;
      if (it.Value() == BRepCheck_UnorientableShape && outline_is_bad_) continue;
      static constexpr const char* kParts[] = {"compound", "compound", "solid", "shell",
                                               "face",     "outline",  "edge",  "vertex"};
      const std::string kind = kParts[part.ShapeType()];
      // "face:1: edge: ...", but not "face:1: face: ...".
      const bool itself = part.ShapeType() <= TopAbs_FACE;
      const std::string text = where + ": " + (itself ? "" : kind + ": ") + words_of(it.Value());
      if (seen_.insert(text).second) found_.push_back(text);
    }
  }

  const BRepCheck_Analyzer& analyser_;
  std::vector<std::string> found_;
  std::set<std::string> seen_;
  bool outline_is_bad_ = false;
};

// How often the faces of one shell use each edge, in either sense.
struct EdgeUses {
  TopTools_IndexedMapOfShape edges;
  std::vector<std::pair<int, int>> uses;  // forward, reversed

  void add(const TopoDS_Shape& faces) {
    for (TopExp_Explorer it(faces, TopAbs_EDGE); it.More(); it.Next()) {
      const auto& edge = TopoDS::Edge(it.Current());
      if (BRep_Tool::Degenerated(edge)) continue;
      const auto index = static_cast<size_t>(edges.Add(edge));
      uses.resize(std::max(uses.size(), index));
      if (edge.Orientation() == TopAbs_FORWARD) ++uses[index - 1].first;
      if (edge.Orientation() == TopAbs_REVERSED) ++uses[index - 1].second;
    }
  }

  void count(ShapeFacts& facts) const {
    for (const auto& [forward, reversed] : uses) {
      if (forward + reversed == 1) ++facts.free_edges;
      if (forward + reversed > 2) ++facts.multiple_edges;
      facts.closed = facts.closed && forward == 1 && reversed == 1;
    }
  }
};

void count_topology(const TopoDS_Shape& shape, ShapeFacts& facts) {
  TopTools_IndexedMapOfShape solids, shells;
  TopExp::MapShapes(shape, TopAbs_SOLID, solids);
  TopExp::MapShapes(shape, TopAbs_SHELL, shells);
  facts.solids = solids.Extent();
  facts.shells = shells.Extent();
  facts.closed = facts.shells > 0;
  for (int k = 1; k <= shells.Extent(); ++k) {
    facts.closed_shells += BRep_Tool::IsClosed(shells(k)) ? 1 : 0;
    EdgeUses uses;
    uses.add(shells(k));
    uses.count(facts);
  }
  EdgeUses loose;
  for (TopExp_Explorer it(shape, TopAbs_FACE, TopAbs_SHELL); it.More(); it.Next()) {
    loose.add(it.Current());
    facts.closed = false;
  }
  loose.count(facts);
  facts.closed = facts.closed && facts.closed_shells == facts.shells;
}

void measure_tolerances(const TopoDS_Shape& shape, ShapeFacts& facts) {
  TopTools_IndexedMapOfShape parts;
  TopExp::MapShapes(shape, parts);
  for (int k = 1; k <= parts.Extent(); ++k) {
    double tolerance = 0.0;
    if (parts(k).ShapeType() == TopAbs_FACE) {
      tolerance = BRep_Tool::Tolerance(TopoDS::Face(parts(k)));
    } else if (parts(k).ShapeType() == TopAbs_EDGE) {
      tolerance = BRep_Tool::Tolerance(TopoDS::Edge(parts(k)));
    } else if (parts(k).ShapeType() == TopAbs_VERTEX) {
      tolerance = BRep_Tool::Tolerance(TopoDS::Vertex(parts(k)));
    }
    facts.max_tolerance = std::max(facts.max_tolerance, tolerance);
  }
}

double diagonal_of(const TopoDS_Shape& shape) {
  Bnd_Box box;
  BRepBndLib::Add(shape, box, Standard_False);
  return box.IsVoid() ? 0.0 : std::sqrt(box.SquareExtent());
}

// Names and colours belong to labels, in the order of the file.
void collect_labels(const TDF_Label& label, const Handle(XCAFDoc_ColorTool) & colours,
                    ShapeFacts& facts) {
  if (XCAFDoc_ShapeTool::IsShape(label)) {
    const std::string name = label_name(label);
    if (!name.empty()) facts.names.push_back(name);
    const bool coloured = colours->IsSet(label, XCAFDoc_ColorGen) ||
                          colours->IsSet(label, XCAFDoc_ColorSurf) ||
                          colours->IsSet(label, XCAFDoc_ColorCurv);
    facts.coloured += coloured ? 1 : 0;
  }
  for (TDF_ChildIterator it(label); it.More(); it.Next()) {
    collect_labels(it.Value(), colours, facts);
  }
}

}  // namespace

ShapeFacts shape_facts(const TopoDS_Shape& shape, bool integrals) {
  ShapeFacts facts;
  const BRepCheck_Analyzer analyser(shape);
  facts.valid = analyser.IsValid();
  if (!facts.valid) facts.defects = DefectList(analyser, shape).take();
  count_topology(shape, facts);
  measure_tolerances(shape, facts);
  const Gaps gaps = measure_gaps(shape);
  for (double gap : gaps.edges) facts.max_edge_gap = std::max(facts.max_edge_gap, gap);
  for (double gap : gaps.vertices) facts.max_vertex_gap = std::max(facts.max_vertex_gap, gap);
  facts.diagonal = diagonal_of(shape);
  if (!integrals) return facts;
  const ShapeIntegrals sums = integrate_shape(shape);
  facts.area = sums.area;
  facts.volume = sums.volume;
  facts.volume_bound = sums.bound;
  return facts;
}

ShapeFacts shape_facts(const Document& document, bool integrals) {
  ShapeFacts facts = shape_facts(document.shape, integrals);
  if (!document.xde.IsNull()) {
    collect_labels(XCAFDoc_DocumentTool::ShapesLabel(document.xde->Main()),
                   XCAFDoc_DocumentTool::ColorTool(document.xde->Main()), facts);
  }
  return facts;
}

}  // namespace isochor::internal
