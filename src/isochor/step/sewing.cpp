#include "isochor/step/sewing.h"

#include <BRepAdaptor_Curve.hxx>
#include <BRepBndLib.hxx>
#include <BRepBuilderAPI_Sewing.hxx>
#include <BRepCheck_Analyzer.hxx>
#include <BRepGProp.hxx>
#include <BRepLib.hxx>
#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <Bnd_Box.hxx>
#include <GProp_GProps.hxx>
#include <Standard_Failure.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_DataMapOfShapeInteger.hxx>
#include <TopTools_IndexedDataMapOfShapeListOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Compound.hxx>
#include <algorithm>
#include <array>
#include <cmath>

#include "isochor/base/tolerance.h"
#include "isochor/step/child_progress.h"
#include "isochor/step/sewing_labels.h"

namespace isochor::internal {
namespace {

double diagonal_of(const TopoDS_Shape& shape) {
  Bnd_Box box;
  BRepBndLib::Add(shape, box, Standard_False);
  return box.IsVoid() ? 0.0 : std::sqrt(box.SquareExtent());
}

// Where an edge runs, by its ends and its middle; with a face that uses it.
struct EdgeRun {
  TopoDS_Face face;
  bool free = false;  // no other face does
  std::array<gp_Pnt, 3> places;

  EdgeRun(const TopoDS_Edge& edge, TopoDS_Face by, bool alone) : face(std::move(by)), free(alone) {
    const BRepAdaptor_Curve curve(edge);
    const double a = curve.FirstParameter(), b = curve.LastParameter();
    places = {curve.Value(a), curve.Value(0.5 * (a + b)), curve.Value(b)};
  }

  double x() const { return places[1].X(); }

  // As short as the tolerance, as far as the middle tells.
  bool within(double tolerance) const { return places[0].Distance(places[1]) <= tolerance; }

  bool along(const EdgeRun& other, double tolerance) const {
    const auto near = [&](int k, int l) {
      return places[static_cast<size_t>(k)].Distance(other.places[static_cast<size_t>(l)]) <=
             tolerance;
    };
    return near(1, 1) && ((near(0, 0) && near(2, 2)) || (near(0, 2) && near(2, 0)));
  }
};

// Calls use(edge, face, free) for every edge that has a length; `free`: one face uses it, once.
template <typename Use>
void for_each_edge(const TopoDS_Shape& shape, const Use& use) {
  TopTools_IndexedDataMapOfShapeListOfShape faces_of;
  TopExp::MapShapesAndAncestors(shape, TopAbs_EDGE, TopAbs_FACE, faces_of);
  for (int k = 1; k <= faces_of.Extent(); ++k) {
    const TopoDS_Edge& edge = TopoDS::Edge(faces_of.FindKey(k));
    if (BRep_Tool::Degenerated(edge) || faces_of(k).IsEmpty()) continue;
    const TopoDS_Face& face = TopoDS::Face(faces_of(k).First());
    use(edge, face, faces_of(k).Extent() == 1 && !BRep_Tool::IsClosed(edge, face));
  }
}

int free_edges(const TopoDS_Shape& shape) {
  int count = 0;
  for_each_edge(shape, [&](const TopoDS_Edge&, const TopoDS_Face&, bool free) { count += free; });
  return count;
}

double largest_tolerance(const TopoDS_Shape& shape) {
  double largest = 0.0;
  for (TopExp_Explorer it(shape, TopAbs_EDGE); it.More(); it.Next()) {
    largest = std::max(largest, BRep_Tool::Tolerance(TopoDS::Edge(it.Current())));
  }
  for (TopExp_Explorer it(shape, TopAbs_VERTEX); it.More(); it.Next()) {
    largest = std::max(largest, BRep_Tool::Tolerance(TopoDS::Vertex(it.Current())));
  }
  return largest;
}

// A strip no wider than the tolerance.
bool has_no_area(const TopoDS_Face& face, double tolerance) {
  GProp_GProps area, length;
  BRepGProp::SurfaceProperties(face, area);
  BRepGProp::LinearProperties(face, length);
  return std::abs(area.Mass()) <= 0.5 * tolerance * length.Mass();
}

// Whether a free edge runs within the tolerance of a shared one, or of two other free ones: three
// faces that have an area, or more, meet there.
bool third_face(const TopoDS_Shape& shape, double tolerance) {
  std::vector<EdgeRun> runs;
  for_each_edge(shape, [&](const TopoDS_Edge& edge, const TopoDS_Face& face, bool free) {
    EdgeRun run(edge, face, free);
    if (!run.within(tolerance)) runs.push_back(std::move(run));
  });
  std::sort(runs.begin(), runs.end(),
            [](const EdgeRun& a, const EdgeRun& b) { return a.x() < b.x(); });
  const auto sum_along = [&](const EdgeRun& own, const auto& faces) {
    const auto first = std::lower_bound(runs.begin(), runs.end(), own.x() - tolerance,
                                        [](const EdgeRun& run, double x) { return run.x() < x; });
    int sum = 0;
    for (auto it = first; it != runs.end() && it->x() <= own.x() + tolerance; ++it) {
      if (it->along(own, tolerance)) sum += faces(*it);
    }
    return sum;
  };
  const auto faces = [](const EdgeRun& run) { return run.free ? 1 : 2; };
  const auto faces_with_area = [&](const EdgeRun& run) {
    return run.free && has_no_area(run.face, tolerance) ? 0 : faces(run);
  };
  return std::any_of(runs.begin(), runs.end(), [&](const EdgeRun& run) {
    return run.free && sum_along(run, faces) >= 3 && sum_along(run, faces_with_area) >= 3;
  });
}

std::string handle_of(int face) { return "face:" + std::to_string(face + 1); }

class Sewer {
 public:
  explicit Sewer(Document& document)
      : document_(document), tolerance_(kCoincident * diagonal_of(document.shape)) {}

  void run(int free_before) {
    account_.tolerance = tolerance_;
    account_.free_edges_before = free_before;
    if (!(tolerance_ > 0.0)) return;
    account_.declined = objection_to_structure();
    if (account_.declined.empty() && !sew_faces()) return;
    if (account_.declined.empty()) account_.declined = objection();
    if (account_.declined.empty()) {
      adopt();
    } else {
      const std::string why = account_.declined;
      account_ = {};
      account_.declined = why;
    }
    document_.account.sewing = account_;
    const auto lines = account_.lines();
    document_.notices.insert(document_.notices.end(), lines.begin(), lines.end());
  }

 private:
  struct NumberedFace {
    int number = -1;  // of the file, from 0
    TopoDS_Face face;
  };
  using Group = std::vector<NumberedFace>;  // of one shell

  std::string objection_to_structure() const {
    if (is_assembly(document_)) return "the faces belong to the parts of an assembly";
    TopTools_DataMapOfShapeInteger seen;
    for (int f = 0; f < document_.face_count(); ++f) {
      const TopoDS_Shape own = document_.face(f).Located(TopLoc_Location());
      if (seen.IsBound(own)) {
        return handle_of(seen.Find(own)) + " and " + handle_of(f) + " are one face in two places";
      }
      seen.Bind(own, f);
    }
    // Sewing takes long; this would decline it afterwards.
    if (third_face(document_.shape, tolerance_)) return kThirdFace;
    return "";
  }

  // False when nothing is gained.
  bool sew_faces() {
    BRepBuilderAPI_Sewing sewing(tolerance_);
    TopTools_IndexedMapOfShape kept;
    for (int f = 0; f < document_.face_count(); ++f) {
      if (has_no_area(document_.face(f), tolerance_)) {
        account_.dropped.push_back(handle_of(f));
      } else {
        sewing.Add(document_.face(f));
        kept.Add(document_.face(f));
      }
    }
    if (kept.IsEmpty()) return false;
    sewing.Perform();
    const TopoDS_Shape sewn = sewing.SewedShape();
    if (sewn.IsNull() || free_edges(sewn) >= account_.free_edges_before) return false;
    TopTools_DataMapOfShapeInteger numbers;
    for (int f = 0; f < document_.face_count(); ++f) {
      TopoDS_Shape now = document_.face(f);
      if (!kept.Contains(now)) continue;
      if (sewing.IsModified(now)) now = sewing.Modified(now);
      if (now.IsNull() || now.ShapeType() != TopAbs_FACE || numbers.IsBound(now)) {
        account_.declined = handle_of(f) + " would be cut or removed";
        return true;
      }
      numbers.Bind(now, f);
    }
    group(sewn, numbers);
    if (account_.declined.empty()) build();
    return true;
  }

  // The faces of each shell in the order of the file, shells by their first faces.
  void group(const TopoDS_Shape& sewn, const TopTools_DataMapOfShapeInteger& numbers) {
    int found = 0;
    const auto add = [&](const TopoDS_Shape& face, Group& to) {
      if (!numbers.IsBound(face)) return;
      to.push_back({numbers.Find(face), TopoDS::Face(face)});
      ++found;
    };
    for (TopExp_Explorer it(sewn, TopAbs_SHELL); it.More(); it.Next()) {
      Group shell;
      for (TopExp_Explorer at(it.Current(), TopAbs_FACE); at.More(); at.Next()) {
        add(at.Current(), shell);
      }
      groups_.push_back(std::move(shell));
    }
    for (TopExp_Explorer it(sewn, TopAbs_FACE, TopAbs_SHELL); it.More(); it.Next()) {
      groups_.emplace_back();
      add(it.Current(), groups_.back());
    }
    groups_.erase(std::remove_if(groups_.begin(), groups_.end(),
                                 [](const Group& shell) { return shell.empty(); }),
                  groups_.end());
    if (found != numbers.Extent()) {
      account_.declined = std::to_string(numbers.Extent() - found) + " faces would be removed";
      return;
    }
    const auto before = [](const NumberedFace& a, const NumberedFace& b) {
      return a.number < b.number;
    };
    for (Group& shell : groups_) std::sort(shell.begin(), shell.end(), before);
    std::sort(groups_.begin(), groups_.end(),
              [](const Group& a, const Group& b) { return a[0].number < b[0].number; });
    for (size_t k = 1; k < groups_.size(); ++k) {
      if (groups_[k].front().number > groups_[k - 1].back().number) continue;
      account_.declined = "the file mixes the faces of several shells (" +
                          handle_of(groups_[k].front().number) + " comes before " +
                          handle_of(groups_[k - 1].back().number) +
                          "), and sewn faces would be numbered anew";
      return;
    }
  }

  // Closed shells become solids; everything goes into one compound (or is the one part).
  void build() {
    BRep_Builder builder;
    std::vector<TopoDS_Shape> parts;
    for (const Group& group : groups_) {
      TopoDS_Shell shell;
      builder.MakeShell(shell);
      for (const NumberedFace& face : group) builder.Add(shell, face.face);
      const bool closed = BRep_Tool::IsClosed(shell);
      shell.Closed(closed);
      ++account_.shells;
      if (!closed) {
        parts.push_back(shell);
        continue;
      }
      ++account_.solids;
      TopoDS_Solid solid;
      builder.MakeSolid(solid);
      builder.Add(solid, shell);
      BRepLib::OrientClosedSolid(solid);
      parts.push_back(solid);
    }
    shape_ = parts.front();
    if (parts.size() == 1) return;
    TopoDS_Compound compound;
    builder.MakeCompound(compound);
    for (const TopoDS_Shape& part : parts) builder.Add(compound, part);
    shape_ = compound;
  }

  std::string objection() {
    account_.free_edges_after = free_edges(shape_);
    // Edges that only a large tolerance holds together are not one edge.
    const double allowed = std::max(largest_tolerance(document_.shape), 2.0 * tolerance_);
    if (largest_tolerance(shape_) > allowed) return "only a larger tolerance would join the edges";
    if (third_face(shape_, 2.0 * tolerance_)) return kThirdFace;
    for (const Group& group : groups_) {
      for (const NumberedFace& face : group) {
        TopLoc_Location was, is;
        const auto before = BRep_Tool::Surface(document_.face(face.number), was);
        if (before != BRep_Tool::Surface(face.face, is) || was != is) {
          return handle_of(face.number) + " would get another surface";
        }
      }
    }
    return BRepCheck_Analyzer(shape_).IsValid() ? "" : "the sewn shape would not be valid";
  }

  // The faces as they stand in the new shape are in the order of the file.
  void adopt() {
    account_.done = true;
    TopTools_IndexedMapOfShape faces;
    TopExp::MapShapes(shape_, TopAbs_FACE, faces);
    std::vector<SewnFace> pairs;
    int place = 0;
    for (const Group& group : groups_) {
      for (const NumberedFace& face : group) {
        const TopoDS_Face own = document_.face(face.number);
        const TopoDS_Shape& now = faces(++place);
        if (now.Orientation() != own.Orientation()) {
          account_.turned.push_back(handle_of(face.number));
        }
        document_.origins.Bind(now, own);
        pairs.emplace_back(own, now);
      }
    }
    account_.faces = faces.Extent();
    relabel(document_, shape_, pairs);
    document_.shape = shape_;
    index_document(document_);
  }

  static constexpr const char* kThirdFace = "three or more faces meet along an edge";

  Document& document_;
  double tolerance_;
  TopoDS_Shape shape_;
  std::vector<Group> groups_;
  SewingAccount account_;
};

}  // namespace

void sew(Document& document) {
  TopExp_Explorer solid(document.shape, TopAbs_SOLID);
  if (solid.More()) return;
  const int free = free_edges(document.shape);
  if (free == 0) return;
  tell_progress(1.0, "sewing");
  try {
    Sewer(document).run(free);
  } catch (const Standard_Failure& e) {
    document.account.sewing = {};
    document.account.sewing.declined = std::string("OpenCASCADE failed: ") + e.GetMessageString();
    document.notices.push_back(document.account.sewing.lines().front());
  }
}

}  // namespace isochor::internal
