#include "isochor/volume/quadrature_choice.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

#include "isochor/base/tolerance.h"
#include "isochor/volume/element_integrals.h"

namespace isochor::internal {
namespace {

// Integrals over all elements of a patch, and the sum of the absolute integrands.
struct Sample {
  std::vector<double> integrals;
  double size = 0.0;
};

Sample sample(const PatchForm& patch, const std::vector<Vec3>& points) {
  Sample result;
  ElementFields fields(patch);
  VectorGrid p;
  for (int su = 0; su < patch.u->spans(); ++su) {
    for (int sv = 0; sv < patch.v->spans(); ++sv) {
      fields.place(su, sv);
      evaluate_points(fields, points, 0.0, p);
      result.integrals.push_back(element_value(fields, p));
      for (size_t g = 0; g < fields.grid_size(); ++g) {
        result.size += fields.weights()[g] * std::abs(p[2].value[g]) *
                       (std::abs(p[0].du[g] * p[1].dv[g]) + std::abs(p[0].dv[g] * p[1].du[g]));
      }
    }
  }
  return result;
}

double difference(const Sample& a, const Sample& b) {
  double sum = 0.0;
  for (size_t k = 0; k < a.integrals.size(); ++k) sum += std::abs(a.integrals[k] - b.integrals[k]);
  return sum;
}

// Poles in [-1, 1]^3 that have nothing to do with each other.
std::vector<Vec3> scattered_points(size_t count) {
  std::minstd_rand random(1);
  const double top = static_cast<double>(std::minstd_rand::max());
  std::vector<Vec3> points(count);
  for (Vec3& p : points) {
    for (int axis = 0; axis < 3; ++axis) p[axis] = 2.0 * static_cast<double>(random()) / top - 1.0;
  }
  return points;
}

}  // namespace

std::shared_ptr<const SpanTable> TableCache::get(const KnotVector& knots, int gauss_points) {
  for (const auto& known : tables_) {
    if (known->gauss_points() == gauss_points && known->knots() == knots) return known;
  }
  tables_.push_back(std::make_shared<const SpanTable>(knots, gauss_points));
  return tables_.back();
}

int finer_rule(int gauss_points) {
  return std::min(kMaxGaussPoints, gauss_points + std::max(2, gauss_points / 4));
}

void choose_rules(PatchForm& chosen, TableCache& tables) {
  PatchForm patch = chosen;
  std::iota(patch.points.begin(), patch.points.end(), 0);
  const std::vector<Vec3> points = scattered_points(patch.points.size());
  const auto limit = [](const SpanTable& table) {
    return std::max(kMaxRationalGaussPoints, exact_gauss_points(table.degree()));
  };
  const auto finer = [&](const SpanTable& table) {
    const int next = std::min(finer_rule(table.gauss_points()), limit(table));
    return tables.get(table.knots(), next);
  };
  Sample current = sample(patch, points);
  for (bool raised = true; raised;) {
    raised = false;
    for (const auto direction : {&PatchForm::u, &PatchForm::v}) {
      if ((patch.*direction)->gauss_points() >= limit(*(patch.*direction))) continue;
      PatchForm next = patch;
      next.*direction = finer(*(patch.*direction));
      Sample refined = sample(next, points);
      if (difference(current, refined) <= kQuadratureNoise * refined.size) continue;
      patch = std::move(next);
      current = std::move(refined);
      raised = true;
    }
  }
  chosen.u = patch.u;
  chosen.v = patch.v;
}

}  // namespace isochor::internal
