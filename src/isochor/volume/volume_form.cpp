#include "isochor/volume/volume_form.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <utility>

#include "isochor/base/error.h"
#include "isochor/base/parallel.h"
#include "isochor/base/tolerance.h"
#include "isochor/volume/compensated_sum.h"
#include "isochor/volume/element_integrals.h"
#include "isochor/volume/precise_volume.h"
#include "isochor/volume/quadrature_choice.h"
#include "isochor/volume/rim.h"

namespace isochor {

using internal::CompensatedSum;
using internal::ElementFields;
using internal::PatchForm;
using internal::Rim;
using internal::RimElement;
using internal::TableCache;
using internal::VectorGrid;

namespace {

// Where a point is used: patch, row, column.
struct Use {
  int patch;
  int i;
  int j;
};

// Walks over elements, one workspace per run of elements of a patch.
template <typename Visit>
void for_each_element(const std::vector<PatchForm>& patches, const std::vector<Element>& elements,
                      bool sizes, const Visit& visit) {
  std::unique_ptr<ElementFields> fields;
  int current = -1;
  for (const Element& element : elements) {
    const PatchForm& patch = patches[static_cast<size_t>(element.patch)];
    if (patch.points.empty()) continue;
    if (element.patch != current) {
      current = element.patch;
      fields = std::make_unique<ElementFields>(patch, sizes);
    }
    fields->place(element.u_span, element.v_span);
    visit(patch, *fields);
  }
}

// A patch with the tables that make it exact; weights that are all equal are left out.
PatchForm polynomial_form(const Patch& patch, TableCache& tables) {
  PatchForm form;
  form.u = tables.get(patch.u_knots, exact_gauss_points(patch.u_knots.degree()));
  form.v = tables.get(patch.v_knots, exact_gauss_points(patch.v_knots.degree()));
  form.points = patch.points;
  const auto& w = patch.weights;
  if (std::any_of(w.begin(), w.end(), [&](double each) { return each != w[0]; })) form.weights = w;
  form.sign = patch.sign();
  return form;
}

// Where heights are measured from: zero unless the model is far from it.
double local_height(const std::vector<Vec3>& points) {
  if (points.empty()) return 0.0;
  const auto lower = [](const Vec3& a, const Vec3& b) { return a.z() < b.z(); };
  const auto [low, high] = std::minmax_element(points.begin(), points.end(), lower);
  const double middle = 0.5 * (low->z() + high->z());
  return std::abs(middle) > high->z() - low->z() ? middle : 0.0;
}

}  // namespace

struct VolumeForm::Data {
  std::vector<PatchForm> patches;
  std::vector<std::vector<Use>> uses;                    // per point
  std::vector<Element> elements;                         // all of them
  std::vector<Element> rational;                         // those of patches with weights
  PatchModel polynomial;                                 // the other patches
  std::unique_ptr<const VolumeContraction> contraction;  // of the other patches
  int threads = 1;
  double height = 0.0;
  Rim rim, rational_rim;  // of all patches and of those with weights, only when height is not zero

  // The integral of (z - height) dx dy over each element, in order; `sizes`: its error bound.
  std::vector<double> element_values(const std::vector<Vec3>& points,
                                     const std::vector<Element>& chosen, bool sizes) const;
  // The same for the change along a line at s = 1.
  std::vector<double> element_changes(const std::vector<Vec3>& points,
                                      const std::vector<Vec3>& directions,
                                      const std::vector<Element>& chosen, bool sizes) const;
  // Adds the rows of the gradient that the elements contribute.
  void add_gradient(const std::vector<Vec3>& points, const std::vector<Element>& chosen,
                    const std::vector<int>& row_of, std::vector<Vec3>& rows) const;
  std::vector<Element> rational_among(const std::vector<Element>& chosen) const;
  void find_rims(const PatchModel& model);
  void require_fits(const std::vector<Vec3>& points) const {
    ISOCHOR_REQUIRE(points.size() == uses.size(), points.size(), uses.size());
  }
};

namespace {

double total(const std::vector<double>& terms) {
  CompensatedSum sum;
  for (double term : terms) sum.add(term);
  return sum.total();
}

// Displacements of the support's points; zero elsewhere.
std::vector<Vec3> displacements(const std::vector<Vec3>& before, const std::vector<Vec3>& after,
                                const Support& support) {
  ISOCHOR_REQUIRE(before.size() == after.size(), before.size(), after.size());
  std::vector<Vec3> moved(before.size(), Vec3::Zero());
  for (int id : support.points) {
    const auto i = static_cast<size_t>(id);
    moved[i] = after[i] - before[i];
  }
  return moved;
}

// What patches without weights and patches with weights come to.
Bounded sum_of(const PreciseNumber& exact, const Bounded& rational) {
  const Bounded rounded = exact.rounded();
  const double sum = rounded.value + rational.value;
  // The last sums and products of the second part, and this sum: four roundings at most.
  return {sum, 1.01 * (rounded.bound + rational.bound) +
                   4.0 * kUnitRoundoff * (std::abs(sum) + std::abs(rational.value))};
}

}  // namespace

void VolumeForm::Data::find_rims(const PatchModel& model) {
  const double x_origin = model.points.front().x();
  rim = Rim(model, patches, x_origin);
  if (rational.empty()) return;
  PatchModel with_weights;
  std::vector<PatchForm> forms;
  for (size_t q = 0; q < patches.size(); ++q) {
    if (!patches[q].rational()) continue;
    with_weights.patches.push_back(model.patches[q]);
    forms.push_back(patches[q]);
  }
  rational_rim = Rim(with_weights, forms, x_origin);
}

VolumeForm::VolumeForm(const PatchModel& model, int threads, const FluxField& field) {
  if (const FluxFrame frame(field); !frame.plain()) {
    PatchModel turned = model;
    turned.points = frame.points(model.points);
    *this = VolumeForm(turned, threads);
    frame_ = frame;
    return;
  }
  auto data = std::make_shared<Data>();
  data->uses.resize(model.points.size());
  TableCache tables;
  for (size_t q = 0; q < model.patches.size(); ++q) {
    const Patch& patch = model.patches[q];
    internal::require_poles(patch, model.points.size());
    for (int i = 0; i < patch.u_size(); ++i) {
      for (int j = 0; j < patch.v_size(); ++j) {
        const auto id = static_cast<size_t>(patch.point(i, j));
        data->uses[id].push_back({static_cast<int>(q), i, j});
      }
    }
    PatchForm form = polynomial_form(patch, tables);
    if (form.rational()) {
      choose_rules(form, tables);
    } else {
      data->polynomial.patches.push_back(patch);
    }
    for (int su = 0; su < form.u->spans(); ++su) {
      for (int sv = 0; sv < form.v->spans(); ++sv) {
        data->elements.push_back({static_cast<int>(q), su, sv});
        if (form.rational()) data->rational.push_back(data->elements.back());
      }
    }
    data->patches.push_back(std::move(form));
  }
  data->threads = threads;
  data->polynomial.points = model.points;
  data->contraction = std::make_unique<const VolumeContraction>(data->polynomial);
  data->polynomial.points.clear();
  data->height = local_height(model.points);
  if (data->height != 0.0) data->find_rims(model);
  data_ = std::move(data);
}

int VolumeForm::point_count() const { return static_cast<int>(data_->uses.size()); }

std::pair<int, int> VolumeForm::gauss_points(int patch) const {
  ISOCHOR_REQUIRE(0 <= patch && static_cast<size_t>(patch) < data_->patches.size(), patch);
  const PatchForm& form = data_->patches[static_cast<size_t>(patch)];
  return {form.u->gauss_points(), form.v->gauss_points()};
}

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

std::vector<double> VolumeForm::Data::element_values(const std::vector<Vec3>& points,
                                                     const std::vector<Element>& chosen,
                                                     bool sizes) const {
  require_fits(points);
  std::vector<double> values;
  VectorGrid p;
  for_each_element(patches, chosen, sizes, [&](const PatchForm& patch, ElementFields& fields) {
    evaluate_points(fields, points, height, p);
    const double value = element_value(fields, p);
    values.push_back(sizes
                         ? rounding_factor(patch) * value + value_remainder(fields, points, height)
                         : patch.sign * value);
  });
  return values;
}

std::vector<double> VolumeForm::Data::element_changes(const std::vector<Vec3>& points,
                                                      const std::vector<Vec3>& directions,
                                                      const std::vector<Element>& chosen,
                                                      bool sizes) const {
  require_fits(points);
  require_fits(directions);
  std::vector<double> values;
  VectorGrid p;
  VectorGrid d;
  for_each_element(patches, chosen, sizes, [&](const PatchForm& patch, ElementFields& fields) {
    evaluate_points(fields, points, height, p);
    evaluate_directions(fields, directions, d);
    const auto line = element_line(fields, p, d);
    const double change = line[0] + line[1] + line[2];
    values.push_back(sizes ? rounding_factor(patch) * change +
                                 change_remainder(fields, points, height, directions)
                           : patch.sign * change);
  });
  return values;
}

void VolumeForm::Data::add_gradient(const std::vector<Vec3>& points,
                                    const std::vector<Element>& chosen,
                                    const std::vector<int>& row_of, std::vector<Vec3>& rows) const {
  VectorGrid p;
  VectorGrid integrands;
  for_each_element(patches, chosen, false, [&](const PatchForm& patch, ElementFields& fields) {
    evaluate_points(fields, points, height, p);
    gradient_integrands(fields, p, integrands);
    for (int axis = 0; axis < 3; ++axis) {
      const std::vector<double>& block = fields.project(integrands[static_cast<size_t>(axis)]);
      for (size_t k = 0; k < fields.block_size(); ++k) {
        const int row = row_of[static_cast<size_t>(fields.point(k))];
        if (row >= 0) rows[static_cast<size_t>(row)][axis] += patch.sign * block[k];
      }
    }
  });
}

std::vector<Element> VolumeForm::Data::rational_among(const std::vector<Element>& chosen) const {
  std::vector<Element> result;
  if (rational.empty()) return result;
  std::copy_if(chosen.begin(), chosen.end(), std::back_inserter(result), [&](const Element& each) {
    return patches[static_cast<size_t>(each.patch)].rational();
  });
  return result;
}

double VolumeForm::value(const std::vector<Vec3>& points) const {
  if (!frame_.plain()) return local().value(frame_.points(points));
  const Data& data = *data_;
  data.require_fits(points);
  double sum = data.contraction->value(points, data.height, data.threads);
  sum += total(data.element_values(points, data.rational, false));
  if (data.height != 0.0) sum += data.height * data.rim.area(points, data.rim.elements());
  return sum;
}

ValueAndGradient VolumeForm::value_and_gradient(const std::vector<Vec3>& points) const {
  if (!frame_.plain()) {
    ValueAndGradient turned = local().value_and_gradient(frame_.points(points));
    frame_.pull_back(turned.gradient);
    return turned;
  }
  const Data& data = *data_;
  data.require_fits(points);
  ValueAndGradient result = data.contraction->value_and_gradient(points, data.height, data.threads);
  if (data.rational.empty() && data.height == 0.0) return result;
  result.value += total(data.element_values(points, data.rational, false));
  const std::vector<int> all = whole().row_of;
  data.add_gradient(points, data.rational, all, result.gradient);
  if (data.height != 0.0) {
    const auto elements = data.rim.elements();
    result.value += data.height * data.rim.area(points, elements);
    data.rim.add_area_gradient(points, elements, all, data.height, result.gradient);
  }
  return result;
}

std::vector<Vec3> VolumeForm::gradient(const std::vector<Vec3>& points) const {
  return value_and_gradient(points).gradient;
}

double VolumeForm::value(const std::vector<Vec3>& points, const Support& support) const {
  if (!frame_.plain()) return local().value(frame_.points(points), support);
  const double local = total(data_->element_values(points, support.elements, false));
  if (data_->height == 0.0) return local;
  return local + data_->height * data_->rim.area(points, data_->rim.elements_of(support.row_of));
}

std::vector<Vec3> VolumeForm::gradient(const std::vector<Vec3>& points,
                                       const Support& support) const {
  if (!frame_.plain()) {
    std::vector<Vec3> turned = local().gradient(frame_.points(points), support);
    frame_.pull_back(turned);
    return turned;
  }
  const Data& data = *data_;
  data.require_fits(points);
  std::vector<Vec3> rows(support.points.size(), Vec3::Zero());
  data.contraction->add_gradient(points, support.row_of, data.height, rows);
  data.add_gradient(points, data.rational_among(support.elements), support.row_of, rows);
  if (data.height != 0.0) {
    data.rim.add_area_gradient(points, data.rim.elements_of(support.row_of), support.row_of,
                               data.height, rows);
  }
  return rows;
}

LineCubic VolumeForm::line_cubic(const std::vector<Vec3>& points,
                                 const std::vector<Vec3>& directions,
                                 const Support& support) const {
  if (!frame_.plain()) {
    return local().line_cubic(frame_.points(points), frame_.directions(directions), support);
  }
  data_->require_fits(points);
  data_->require_fits(directions);
  std::array<CompensatedSum, 3> sums;
  VectorGrid p;
  VectorGrid d;
  for_each_element(data_->patches, support.elements, false,
                   [&](const PatchForm& patch, ElementFields& fields) {
                     evaluate_points(fields, points, data_->height, p);
                     evaluate_directions(fields, directions, d);
                     const auto line = element_line(fields, p, d);
                     for (size_t k = 0; k < 3; ++k) sums[k].add(patch.sign * line[k]);
                   });
  if (data_->height != 0.0) {
    const auto rim = data_->rim.elements_of(support.row_of);
    const auto line = data_->rim.area_line(points, directions, rim);
    for (size_t k = 0; k < 2; ++k) sums[k].add(data_->height * line[k]);
  }
  return {sums[0].total(), sums[1].total(), sums[2].total()};
}

double VolumeForm::change(const std::vector<Vec3>& before, const std::vector<Vec3>& after,
                          const Support& support) const {
  return line_cubic(before, displacements(before, after, support), support).change(1.0);
}

Bounded VolumeForm::bounded_value(const std::vector<Vec3>& points) const {
  if (!frame_.plain()) {
    Bounded turned = local().bounded_value(frame_.points(points));
    turned.bound += frame_bound(points, whole().points);
    return turned;
  }
  const Data& data = *data_;
  data.require_fits(points);
  const std::vector<Patch>& patches = data.polynomial.patches;
  std::vector<PreciseNumber> parts(patches.size());
  run_tasks(static_cast<int>(parts.size()), data.threads, [&](int q) {
    const auto at = static_cast<size_t>(q);
    parts[at] = precise_flux(patches[at], points);
  });
  PreciseNumber exact;
  for (const PreciseNumber& part : parts) exact = exact + part;
  if (data.rational.empty()) return exact.rounded();
  double bound = total(data.element_values(points, data.rational, true));
  double sum = total(data.element_values(points, data.rational, false));
  if (data.height != 0.0) {
    const Rim& rim = data.rational_rim;
    const double area = rim.area(points, rim.elements());
    sum += data.height * area;
    bound +=
        std::abs(data.height) * (rim.rounding_factor() * rim.area(points, rim.elements(), true) +
                                 rim.area_remainder(points, rim.elements()));
  }
  return sum_of(exact, {sum, bound});
}

Bounded VolumeForm::bounded_change(const std::vector<Vec3>& before, const std::vector<Vec3>& after,
                                   const Support& support) const {
  if (!frame_.plain()) {
    Bounded turned = local().bounded_change(frame_.points(before), frame_.points(after), support);
    turned.bound += frame_bound(before, support.points) + frame_bound(after, support.points);
    return turned;
  }
  const Data& data = *data_;
  data.require_fits(before);
  data.require_fits(after);
  PreciseNumber exact;
  for (const Patch& patch : data.polynomial.patches) {
    exact = exact + precise_flux_change(patch, before, after);
  }
  const std::vector<Element> rational = data.rational_among(support.elements);
  if (rational.empty()) return exact.rounded();
  const auto moved = displacements(before, after, support);
  double bound = total(data.element_changes(before, moved, rational, true));
  double sum = total(data.element_changes(before, moved, rational, false));
  if (data.height != 0.0) {
    const Rim& rim = data.rational_rim;
    const auto elements = rim.elements_of(support.row_of);
    const auto line = rim.area_line(before, moved, elements);
    const auto sizes = rim.area_line(before, moved, elements, true);
    sum += data.height * (line[0] + line[1]);
    bound += std::abs(data.height) * (rim.rounding_factor() * (sizes[0] + sizes[1]) +
                                      rim.change_remainder(before, moved, elements));
  }
  return sum_of(exact, {sum, bound});
}

Bounded VolumeForm::quadrature_value(const std::vector<Vec3>& points) const {
  if (!frame_.plain()) {
    Bounded turned = local().quadrature_value(frame_.points(points));
    turned.bound += frame_bound(points, whole().points);
    return turned;
  }
  const Data& data = *data_;
  double bound = total(data.element_values(points, data.elements, true));
  double sum = total(data.element_values(points, data.elements, false));
  if (data.height != 0.0) {
    const auto elements = data.rim.elements();
    sum += data.height * data.rim.area(points, elements);
    bound += std::abs(data.height) *
             (data.rim.rounding_factor() * data.rim.area(points, elements, true) +
              data.rim.area_remainder(points, elements));
  }
  return {sum, bound + 3.0 * kUnitRoundoff * std::abs(sum)};
}

}  // namespace isochor
