#include "isochor/volume/volume_form.h"

#include <algorithm>
#include <array>
#include <utility>

#include "isochor/base/error.h"
#include "isochor/volume/compensated_sum.h"
#include "isochor/volume/element_fields.h"

namespace isochor {

using internal::CompensatedSum;
using internal::ElementFields;
using internal::Grid;
using internal::PatchForm;
using internal::VectorGrid;

namespace {

// Where a point is used: patch, row, column.
struct Use {
  int patch;
  int i;
  int j;
};

// Points of Gauss per span on patches with weights.
constexpr int kRationalGaussPoints = 20;

// Tables are shared by all patches with the same knots and rule.
class TableCache {
 public:
  std::shared_ptr<const SpanTable> get(const KnotVector& knots, int gauss_points) {
    for (const auto& known : tables_) {
      if (known->gauss_points() == gauss_points && known->knots() == knots) return known;
    }
    tables_.push_back(std::make_shared<const SpanTable>(knots, gauss_points));
    return tables_.back();
  }

 private:
  std::vector<std::shared_ptr<const SpanTable>> tables_;
};

// x_u y_v - x_v y_u at Gauss point g.
double jacobian(const Grid& x, const Grid& y, size_t g) {
  return x.du[g] * y.dv[g] - x.dv[g] * y.du[g];
}

// The coordinate functions on the placed element. x and y are taken relative to the element's first
// point: only their derivatives matter, and those lose nothing then, however far the model is.
void evaluate_points(ElementFields& fields, const std::vector<Vec3>& points, VectorGrid& out) {
  const Vec3& reference = points[static_cast<size_t>(fields.point(0))];
  fields.evaluate(points, 0, reference.x(), out[0]);
  fields.evaluate(points, 1, reference.y(), out[1]);
  fields.evaluate(points, 2, 0.0, out[2]);
}

double element_value(const ElementFields& fields, const VectorGrid& p) {
  double sum = 0.0;
  for (size_t g = 0; g < fields.grid_size(); ++g) {
    sum += fields.weights()[g] * p[2].value[g] * jacobian(p[0], p[1], g);
  }
  return sum;
}

// The integrands of the three gradient columns, as coefficients of a function and its derivatives.
void gradient_integrands(const ElementFields& fields, const VectorGrid& p, VectorGrid& out) {
  for (Grid& grid : out) grid.resize(fields.grid_size());
  for (size_t g = 0; g < fields.grid_size(); ++g) {
    const double w = fields.weights()[g];
    const double wz = w * p[2].value[g];
    out[0].value[g] = 0.0;
    out[0].du[g] = wz * p[1].dv[g];
    out[0].dv[g] = -wz * p[1].du[g];
    out[1].value[g] = 0.0;
    out[1].du[g] = -wz * p[0].dv[g];
    out[1].dv[g] = wz * p[0].du[g];
    out[2].value[g] = w * jacobian(p[0], p[1], g);
    out[2].du[g] = 0.0;
    out[2].dv[g] = 0.0;
  }
}

// Walks over elements, keeping one workspace per patch change.
template <typename Visit>
void for_each_element(const std::vector<PatchForm>& patches, const std::vector<Element>& elements,
                      const Visit& visit) {
  std::unique_ptr<ElementFields> fields;
  int current = -1;
  for (const Element& element : elements) {
    if (element.patch != current) {
      current = element.patch;
      fields = std::make_unique<ElementFields>(patches[static_cast<size_t>(current)]);
    }
    fields->place(element.u_span, element.v_span);
    visit(patches[static_cast<size_t>(current)], *fields);
  }
}

}  // namespace

struct VolumeForm::Data {
  std::vector<PatchForm> patches;
  std::vector<std::vector<Use>> uses;  // per point
  std::vector<Element> elements;       // all of them
};

VolumeForm::VolumeForm(const PatchModel& model) {
  auto data = std::make_shared<Data>();
  data->uses.resize(model.points.size());
  TableCache tables;
  for (size_t q = 0; q < model.patches.size(); ++q) {
    const Patch& patch = model.patches[q];
    const auto rule = [&](const KnotVector& knots) {
      const int exact = exact_gauss_points(knots.degree());
      return tables.get(knots,
                        patch.weights.empty() ? exact : std::max(exact, kRationalGaussPoints));
    };
    PatchForm form;
    form.u = rule(patch.u_knots);
    form.v = rule(patch.v_knots);
    form.points = patch.points;
    form.weights = patch.weights;
    form.sign = patch.sign();
    for (int i = 0; i < patch.u_size(); ++i) {
      for (int j = 0; j < patch.v_size(); ++j) {
        const int id = patch.point(i, j);
        ISOCHOR_REQUIRE(0 <= id && static_cast<size_t>(id) < model.points.size(), id);
        data->uses[static_cast<size_t>(id)].push_back({static_cast<int>(q), i, j});
      }
    }
    for (int su = 0; su < form.u->spans(); ++su) {
      for (int sv = 0; sv < form.v->spans(); ++sv) {
        data->elements.push_back({static_cast<int>(q), su, sv});
      }
    }
    data->patches.push_back(std::move(form));
  }
  data_ = std::move(data);
}

int VolumeForm::point_count() const { return static_cast<int>(data_->uses.size()); }

Support VolumeForm::whole() const {
  Support support;
  for (int i = 0; i < point_count(); ++i) support.points.push_back(i);
  support.row_of = support.points;
  support.elements = data_->elements;
  return support;
}

Support VolumeForm::support_of(const std::vector<int>& moved_points) const {
  Support support;
  support.points = moved_points;
  std::sort(support.points.begin(), support.points.end());
  support.points.erase(std::unique(support.points.begin(), support.points.end()),
                       support.points.end());
  support.row_of.assign(data_->uses.size(), -1);
  for (size_t row = 0; row < support.points.size(); ++row) {
    const int id = support.points[row];
    ISOCHOR_REQUIRE(0 <= id && id < point_count(), id, point_count());
    support.row_of[static_cast<size_t>(id)] = static_cast<int>(row);
  }
  // Function i lives on span s when first(s) <= i <= first(s) + d.
  const auto lives = [](const SpanTable& table, int s, int i) {
    return table.first(s) <= i && i <= table.first(s) + table.degree();
  };
  std::vector<std::vector<char>> marked(data_->patches.size());
  for (int id : support.points) {
    for (const Use& use : data_->uses[static_cast<size_t>(id)]) {
      const PatchForm& patch = data_->patches[static_cast<size_t>(use.patch)];
      auto& marks = marked[static_cast<size_t>(use.patch)];
      marks.resize(static_cast<size_t>(patch.u->spans()) * patch.v->spans());
      for (int su = 0; su < patch.u->spans(); ++su) {
        if (!lives(*patch.u, su, use.i)) continue;
        for (int sv = 0; sv < patch.v->spans(); ++sv) {
          if (lives(*patch.v, sv, use.j))
            marks[static_cast<size_t>(su) * patch.v->spans() + sv] = 1;
        }
      }
    }
  }
  for (size_t q = 0; q < marked.size(); ++q) {
    const int columns = data_->patches[q].v->spans();
    for (size_t k = 0; k < marked[q].size(); ++k) {
      if (marked[q][k] == 0) continue;
      const int at = static_cast<int>(k);
      support.elements.push_back({static_cast<int>(q), at / columns, at % columns});
    }
  }
  return support;
}

double VolumeForm::value(const std::vector<Vec3>& points) const { return value(points, whole()); }

ValueAndGradient VolumeForm::value_and_gradient(const std::vector<Vec3>& points) const {
  return {value(points), gradient(points)};
}

std::vector<Vec3> VolumeForm::gradient(const std::vector<Vec3>& points) const {
  return gradient(points, whole());
}

double VolumeForm::value(const std::vector<Vec3>& points, const Support& support) const {
  ISOCHOR_REQUIRE(points.size() == data_->uses.size(), points.size(), data_->uses.size());
  CompensatedSum sum;
  VectorGrid p;
  for_each_element(data_->patches, support.elements,
                   [&](const PatchForm& patch, ElementFields& fields) {
                     evaluate_points(fields, points, p);
                     sum.add(patch.sign * element_value(fields, p));
                   });
  return sum.total();
}

std::vector<Vec3> VolumeForm::gradient(const std::vector<Vec3>& points,
                                       const Support& support) const {
  ISOCHOR_REQUIRE(points.size() == data_->uses.size(), points.size(), data_->uses.size());
  std::vector<Vec3> rows(support.points.size(), Vec3::Zero());
  VectorGrid p;
  VectorGrid integrands;
  for_each_element(
      data_->patches, support.elements, [&](const PatchForm& patch, ElementFields& fields) {
        evaluate_points(fields, points, p);
        gradient_integrands(fields, p, integrands);
        for (int axis = 0; axis < 3; ++axis) {
          const std::vector<double>& block = fields.project(integrands[static_cast<size_t>(axis)]);
          for (size_t k = 0; k < fields.block_size(); ++k) {
            const int row = support.row_of[static_cast<size_t>(fields.point(k))];
            if (row >= 0) rows[static_cast<size_t>(row)][axis] += patch.sign * block[k];
          }
        }
      });
  return rows;
}

LineCubic VolumeForm::line_cubic(const std::vector<Vec3>& points,
                                 const std::vector<Vec3>& directions,
                                 const Support& support) const {
  ISOCHOR_REQUIRE(points.size() == data_->uses.size(), points.size(), data_->uses.size());
  ISOCHOR_REQUIRE(directions.size() == points.size(), directions.size(), points.size());
  std::array<CompensatedSum, 3> sums;
  VectorGrid p;
  VectorGrid d;
  for_each_element(data_->patches, support.elements,
                   [&](const PatchForm& patch, ElementFields& fields) {
                     evaluate_points(fields, points, p);
                     for (int axis = 0; axis < 3; ++axis) {
                       fields.evaluate(directions, axis, 0.0, d[static_cast<size_t>(axis)]);
                     }
                     std::array<double, 3> element{};
                     for (size_t g = 0; g < fields.grid_size(); ++g) {
                       const double w = fields.weights()[g];
                       const double z = p[2].value[g];
                       const double dz = d[2].value[g];
                       const double j0 = jacobian(p[0], p[1], g);
                       const double j1 = jacobian(d[0], p[1], g) + jacobian(p[0], d[1], g);
                       const double j2 = jacobian(d[0], d[1], g);
                       element[0] += w * (dz * j0 + z * j1);
                       element[1] += w * (dz * j1 + z * j2);
                       element[2] += w * (dz * j2);
                     }
                     for (size_t k = 0; k < 3; ++k) sums[k].add(patch.sign * element[k]);
                   });
  return {sums[0].total(), sums[1].total(), sums[2].total()};
}

double VolumeForm::change(const std::vector<Vec3>& before, const std::vector<Vec3>& after,
                          const Support& support) const {
  ISOCHOR_REQUIRE(before.size() == after.size(), before.size(), after.size());
  std::vector<Vec3> moved(before.size(), Vec3::Zero());
  for (int id : support.points) {
    const auto i = static_cast<size_t>(id);
    moved[i] = after[i] - before[i];
  }
  return line_cubic(before, moved, support).change(1.0);
}

}  // namespace isochor
