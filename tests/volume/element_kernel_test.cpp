#include "isochor/volume/element_kernel.h"

#include <gtest/gtest.h>

#include <boost/multiprecision/cpp_bin_float.hpp>
#include <cmath>
#include <numeric>
#include <random>

#include "isochor/base/tolerance.h"
#include "isochor/volume/element_fields.h"
#include "isochor/volume/element_integrals.h"
#include "isochor/volume/quadrature_choice.h"
#include "support/fine_quadrature.h"
#include "support/models.h"
#include "support/splines.h"
#include "support/worst.h"

namespace isochor::internal {
namespace {

std::vector<double> random_numbers(std::mt19937& random, size_t count) {
  std::vector<double> numbers(count);
  for (double& x : numbers) x = testing::uniform(random, -1, 1);
  return numbers;
}

Grid random_grid(std::mt19937& random, size_t count) {
  return {random_numbers(random, count), random_numbers(random, count),
          random_numbers(random, count)};
}

double inner(const std::vector<double>& a, const std::vector<double>& b) {
  return std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
}

// A patch with knots of both kinds and, when asked, weights.
PatchForm random_form(std::mt19937& random, int degree_u, int degree_v, bool rational) {
  const KnotVector u = testing::random_clamped(random, degree_u, 2);
  const KnotVector v = testing::random_unclamped(random, degree_v, 2);
  PatchForm form;
  form.u = std::make_shared<const SpanTable>(u, exact_gauss_points(degree_u) + 1);
  form.v = std::make_shared<const SpanTable>(v, exact_gauss_points(degree_v));
  form.points.resize(static_cast<size_t>(u.size()) * static_cast<size_t>(v.size()));
  std::iota(form.points.begin(), form.points.end(), 0);
  if (rational) form.weights = testing::random_weights(random, form.points.size());
  return form;
}

TEST(ElementKernel, EvaluatesTheSurfaceAtTheGaussPoints) {
  std::mt19937 random(401);
  for (const bool rational : {false, true}) {
    const PatchForm form = random_form(random, 3, 2, rational);
    const auto points = testing::random_points(random, form.points.size());
    const Surface surface(form.u->knots(), form.v->knots(), points, form.weights);
    ElementFields fields(form);
    const GaussRule in_u = gauss_legendre(form.u->gauss_points());
    const GaussRule in_v = gauss_legendre(form.v->gauss_points());
    Grid grid;
    for (int su = 0; su < form.u->spans(); ++su) {
      for (int sv = 0; sv < form.v->spans(); ++sv) {
        fields.place(su, sv);
        ASSERT_EQ(fields.grid_size(), in_u.nodes.size() * in_v.nodes.size());
        ASSERT_EQ(fields.block_size(), 12u);
        const auto at = [](const SpanTable& table, int s, double node) {
          const int span = table.knots().spans()[static_cast<size_t>(s)];
          return table.knots()[span] + node * (table.knots()[span + 1] - table.knots()[span]);
        };
        for (int axis = 0; axis < 3; ++axis) {
          fields.evaluate(points, axis, 0.0, grid);
          for (size_t g = 0; g < fields.grid_size(); ++g) {
            const double u = at(*form.u, su, in_u.nodes[g / in_v.nodes.size()]);
            const double v = at(*form.v, sv, in_v.nodes[g % in_v.nodes.size()]);
            const SurfaceDerivatives d = surface.derivatives(u, v, 1);
            EXPECT_NEAR(grid.value[g], d.s[axis], 1e-14);
            EXPECT_NEAR(grid.du[g], d.su[axis], 1e-12);
            EXPECT_NEAR(grid.dv[g], d.sv[axis], 1e-12);
          }
        }
      }
    }
  }
}

TEST(ElementKernel, AccumulateIsTheTransposeOfEvaluate) {
  std::mt19937 random(402);
  for (const auto& [du, dv] : {std::pair{1, 1}, std::pair{3, 2}, std::pair{1, 7}}) {
    const PatchForm form = random_form(random, du, dv, false);
    ElementKernel kernel(*form.u, *form.v);
    Coefficients block;
    block.value = random_numbers(random, kernel.block_size());
    kernel.difference(block);
    const Grid a = random_grid(random, kernel.grid_size(1, 0));
    Grid grid;
    kernel.evaluate(1, 0, block, grid);
    // Added to what is there.
    std::vector<double> back(kernel.block_size(), 3.0);
    kernel.accumulate(1, 0, a, back);
    for (double& x : back) x -= 3.0;
    const double forth = inner(a.value, grid.value) + inner(a.du, grid.du) + inner(a.dv, grid.dv);
    EXPECT_NEAR(inner(block.value, back), forth, 1e-11 * (1.0 + std::abs(forth)));
  }
}

TEST(ElementFields, ProjectIsTheTransposeOfEvaluateWithWeightsToo) {
  std::mt19937 random(403);
  for (const bool rational : {false, true}) {
    const PatchForm form = random_form(random, 2, 3, rational);
    ElementFields fields(form);
    fields.place(0, 1);
    const auto vectors = testing::random_points(random, form.points.size());
    Grid grid;
    fields.evaluate(vectors, 1, 0.0, grid);
    Grid a = random_grid(random, fields.grid_size());
    const double forth = inner(a.value, grid.value) + inner(a.du, grid.du) + inner(a.dv, grid.dv);
    const std::vector<double>& block = fields.project(a);
    double back = 0.0;
    for (size_t k = 0; k < block.size(); ++k) {
      back += block[k] * vectors[static_cast<size_t>(fields.point(k))].y();
    }
    EXPECT_NEAR(back, forth, 1e-12 * (1.0 + std::abs(forth)));
  }
}

// The majorant dominates what it bounds, term by term: functions, integrals, lines.
TEST(ElementFields, SizesDominate) {
  std::mt19937 random(404);
  for (const bool rational : {false, true}) {
    for (int round = 0; round < 10; ++round) {
      const PatchForm form = random_form(random, 1 + round % 4, 1 + round % 3, rational);
      const auto points = testing::random_points(random, form.points.size());
      const auto moves = testing::random_points(random, form.points.size());
      ElementFields plain(form);
      ElementFields sizes(form, true);
      plain.place(0, 0);
      sizes.place(0, 0);
      VectorGrid p, d, big_p, big_d;
      evaluate_points(plain, points, 0.25, p);
      evaluate_points(sizes, points, 0.25, big_p);
      evaluate_directions(plain, moves, d);
      evaluate_directions(sizes, moves, big_d);
      for (size_t axis = 0; axis < 3; ++axis) {
        for (size_t g = 0; g < plain.grid_size(); ++g) {
          EXPECT_LE(std::abs(p[axis].value[g]), big_p[axis].value[g] * (1 + 1e-14));
          EXPECT_LE(std::abs(p[axis].du[g]), big_p[axis].du[g] * (1 + 1e-14));
          EXPECT_LE(std::abs(d[axis].dv[g]), big_d[axis].dv[g] * (1 + 1e-14));
        }
      }
      EXPECT_LE(std::abs(element_value(plain, p)), element_value(sizes, big_p));
      const auto line = element_line(plain, p, d);
      const auto big_line = element_line(sizes, big_p, big_d);
      for (size_t k = 0; k < 3; ++k) EXPECT_LE(std::abs(line[k]), big_line[k]);
    }
  }
}

// The counted roundings hold at every Gauss point: functions and slopes against fifty digits, far
// from the origin too.
TEST(ElementFields, RoundoffsHoldAgainstFiftyDigits) {
  using Fifty = boost::multiprecision::cpp_bin_float_50;
  std::mt19937 random(409);
  testing::Worst value_part("value_over_roundoffs", 1.0);
  testing::Worst slope_part("slope_over_roundoffs", 1.0);
  const int count = 2;
  SpanCells eighths;
  for (int k = 0; k < 8; ++k) eighths.push_back({k / 8.0, (k + 1) / 8.0, count});
  for (const bool rational : {false, true}) {
    for (double far : {0.0, 100.0}) {
      PatchForm form = random_form(random, 3, 2, rational);
      for (auto* table : {&form.u, &form.v}) {
        const KnotVector knots = (*table)->knots();
        *table = std::make_shared<const SpanTable>(
            knots, std::vector<SpanCells>(knots.spans().size(), eighths));
      }
      auto points = testing::random_points(random, form.points.size());
      for (Vec3& p : points) p.x() += far;
      const auto us = testing::fine_nodes<Fifty>(form.u->knots(), count, 0);
      const auto vs = testing::fine_nodes<Fifty>(form.v->knots(), count, 0);
      const Roundoffs roundoffs(form);
      ElementFields plain(form);
      ElementFields sizes(form, true);
      plain.place(0, 1);
      sizes.place(0, 1);
      Grid grid;
      Grid size;
      const double origin = points[5].x();
      plain.evaluate(points, 0, origin, grid);
      sizes.evaluate(points, 0, origin, size);
      for (size_t g = 0; g < plain.grid_size(); ++g) {
        // The oracle runs through each cell the other way.
        const auto node = [&](size_t at) { return at / count * count + count - 1 - at % count; };
        const auto& u = us[node(g / plain.row_length())];
        const auto& v = vs[plain.row_length() + node(g % plain.row_length())];
        Fifty n[3] = {0, 0, 0};
        Fifty w[3] = {0, 0, 0};
        for (size_t i = 0; i < u.values.size(); ++i) {
          for (size_t j = 0; j < v.values.size(); ++j) {
            const size_t at = (u.first + i) * static_cast<size_t>(form.v_size()) + v.first + j;
            const Fifty weight = rational ? form.weights[at] : 1.0;
            const Fifty c = weight * (Fifty(points[at].x()) - origin);
            const Fifty b[3] = {u.values[i] * v.values[j], u.slopes[i] * v.values[j],
                                u.values[i] * v.slopes[j]};
            for (int k = 0; k < 3; ++k) n[k] += c * b[k];
            for (int k = 0; k < 3; ++k) w[k] += weight * b[k];
          }
        }
        const Fifty value = n[0] / w[0];
        const Fifty slopes[2] = {(n[1] - w[1] * value) / w[0], (n[2] - w[2] * value) / w[0]};
        const auto part = [](double computed, const Fifty& exact, double bound) {
          const Fifty error = abs(Fifty(computed) - exact) / bound;
          return error.convert_to<double>();
        };
        const double unit = 1.01 * kUnitRoundoff;
        EXPECT_TRUE(
            value_part.see(part(grid.value[g], value, roundoffs.value * unit * size.value[g])));
        EXPECT_TRUE(
            slope_part.see(part(grid.du[g], slopes[0], roundoffs.slope * unit * size.du[g])));
        EXPECT_TRUE(
            slope_part.see(part(grid.dv[g], slopes[1], roundoffs.slope * unit * size.dv[g])));
      }
    }
  }
}

TEST(ElementFields, LineIsTheTaylorPolynomialOfTheValue) {
  std::mt19937 random(405);
  const PatchForm form = random_form(random, 3, 2, true);
  const auto points = testing::random_points(random, form.points.size());
  const auto moves = testing::random_points(random, form.points.size());
  ElementFields fields(form);
  fields.place(1, 1);
  VectorGrid p, d;
  const auto value_at = [&](double s) {
    auto moved = points;
    for (size_t i = 0; i < moved.size(); ++i) moved[i] += s * moves[i];
    evaluate_points(fields, moved, 0.0, p);
    return element_value(fields, p);
  };
  const double at_rest = value_at(0.0);
  evaluate_directions(fields, moves, d);
  const auto line = element_line(fields, p, d);
  for (double s : {-2.0, 0.5, 1.0}) {
    EXPECT_NEAR(value_at(s) - at_rest, ((line[2] * s + line[1]) * s + line[0]) * s, 1e-12);
  }
}

TEST(ElementFields, WeightsAddUpToTheArea) {
  std::mt19937 random(406);
  const PatchForm form = random_form(random, 2, 4, false);
  ElementFields fields(form);
  double area = 0.0;
  for (int su = 0; su < form.u->spans(); ++su) {
    for (int sv = 0; sv < form.v->spans(); ++sv) {
      fields.place(su, sv);
      area += std::accumulate(fields.weights().begin(), fields.weights().end(), 0.0);
    }
  }
  const KnotVector& u = form.u->knots();
  const KnotVector& v = form.v->knots();
  EXPECT_NEAR(area, (u.end() - u.begin()) * (v.end() - v.begin()), 1e-14);
}

TEST(QuadratureChoice, TablesAreSharedAndTellRulesApart) {
  TableCache tables;
  const KnotVector knots = KnotVector::uniform(3, 4);
  const auto first = tables.get(knots, 5);
  EXPECT_EQ(tables.get(KnotVector(3, knots.knots()), 5), first);
  EXPECT_NE(tables.get(knots, 6), first);
  EXPECT_NE(tables.get(KnotVector::uniform(3, 5), 5), first);
  EXPECT_EQ(first->gauss_points(), 5);
}

// Cells cut in two change nothing but rounding, on any shape.
TEST(QuadratureChoice, ChosenCellsAreFineEnoughForOtherShapes) {
  std::mt19937 random(407);
  const auto cut = [](const std::vector<SpanCells>& spans) {
    std::vector<SpanCells> finer;
    for (const SpanCells& cells : spans) {
      finer.emplace_back();
      for (const Cell& cell : cells) {
        const double middle = 0.5 * (cell.begin + cell.end);
        finer.back().push_back({cell.begin, middle, cell.gauss_points});
        finer.back().push_back({middle, cell.end, cell.gauss_points});
      }
    }
    return finer;
  };
  for (int round = 0; round < 6; ++round) {
    TableCache tables;
    PatchForm form = random_form(random, 1 + round % 3, 2, true);
    choose_rules(form, tables);
    PatchForm finer = form;
    finer.u = tables.get(form.u->knots(), cut(form.u->cells()));
    finer.v = tables.get(form.v->knots(), cut(form.v->cells()));
    const auto points = testing::random_points(random, form.points.size());
    ElementFields coarse_fields(form);
    ElementFields fine_fields(finer);
    VectorGrid p;
    for (int su = 0; su < form.u->spans(); ++su) {
      for (int sv = 0; sv < form.v->spans(); ++sv) {
        coarse_fields.place(su, sv);
        fine_fields.place(su, sv);
        evaluate_points(coarse_fields, points, 0.0, p);
        const double coarse = element_value(coarse_fields, p);
        evaluate_points(fine_fields, points, 0.0, p);
        EXPECT_NEAR(coarse, element_value(fine_fields, p), 1e-14) << round;
      }
    }
  }
}

TEST(QuadratureChoice, DirectionsWithoutVariationKeepTheExactRule) {
  // Weights that change along v only.
  std::mt19937 random(408);
  TableCache tables;
  PatchForm form = random_form(random, 3, 2, true);
  form.u = tables.get(form.u->knots(), exact_gauss_points(3));
  const auto columns = static_cast<size_t>(form.v_size());
  for (size_t k = 0; k < form.weights.size(); ++k) form.weights[k] = k % columns == 1 ? 5.0 : 1.0;
  choose_rules(form, tables);
  EXPECT_EQ(form.u->gauss_points(), exact_gauss_points(3));
  EXPECT_GT(form.v->gauss_points(), exact_gauss_points(2));
}

}  // namespace
}  // namespace isochor::internal
