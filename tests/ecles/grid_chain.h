// Chains of random edits on a grid, judged without the code under test: residuals in integers,
// optima by the exact solver.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <functional>
#include <optional>
#include <random>
#include <utility>
#include <vector>

#include "isochor/ecles/grid_editor.h"
#include "isochor/ecles/least_change.h"
#include "support/spline_edits.h"

namespace isochor {

inline constexpr int kChainSeed = 20170411;

// Constraints with right side zero that hold at the start must hold for ever.
inline void expect_constraints(const GridEditor& editor) {
  for (int c = 0; c < editor.components(); ++c)
    for (int i = 0; i < editor.matrix().rows(); ++i)
      ASSERT_TRUE(editor.row_value(c, i).is_zero()) << "component " << c << ", row " << i;
}

inline std::vector<std::vector<Rational>> values_of(const GridEditor& editor,
                                                    const std::vector<int>& parameters) {
  std::vector<std::vector<Rational>> result(static_cast<size_t>(editor.components()));
  for (int c = 0; c < editor.components(); ++c)
    for (const int j : parameters) result[static_cast<size_t>(c)].push_back(editor.value(c, j));
  return result;
}

inline std::vector<std::vector<Rational>> derived_values(const GridEditor& editor,
                                                         const Selection& selection) {
  return values_of(editor, selection.derived);
}

inline std::vector<std::vector<Rational>> moved_anchors(const GridEditor& editor,
                                                        const Selection& selection,
                                                        const Rational& move) {
  auto result = values_of(editor, selection.anchors);
  for (auto& component : result)
    for (Rational& value : component) value += move;
  return result;
}

inline std::vector<std::vector<double>> rounded(const std::vector<std::vector<Rational>>& values) {
  std::vector<std::vector<double>> result;
  for (const auto& component : values) {
    result.emplace_back();
    for (const Rational& value : component) result.back().push_back(value.to_double());
  }
  return result;
}

// The spline at rest: every control point where it belongs, in units of 1 / (5 2^bits).
inline GridEditor spline_editor(const testing::SplineEdits& spline, unsigned bits) {
  std::vector<std::vector<Rational>> values(2);
  for (int c = 0; c < 2; ++c)
    for (int p = 0; p < spline.spline().points(); ++p)
      values[static_cast<size_t>(c)].push_back(spline.place(p, c));
  return {ConstraintMatrix(spline.spline().points(), spline.spline().rows()), 5, bits, values};
}

inline Selection spline_selection(const testing::SplineEdits& spline,
                                  const std::vector<int>& anchors, int radius) {
  return {anchors, spline.derived(anchors, spline.neighbourhood(anchors, radius))};
}

// The selection, and how far its anchors and hints may go, in model units.
struct Choice {
  Selection selection;
  double reach = 0.0;
};
using Chooser = std::function<Choice(std::mt19937&)>;

inline Chooser spline_chooser(const testing::SplineEdits& spline) {
  return [&spline](std::mt19937& random) {
    std::vector<int> anchors;
    const size_t count = 1 + random() % 2;
    while (anchors.size() < count) {
      const int p = static_cast<int>(random() % static_cast<unsigned>(spline.spline().points()));
      if (anchors.empty() || anchors[0] != p) anchors.push_back(p);
    }
    return Choice{spline_selection(spline, anchors, static_cast<int>(random() % 3)), 5.0};
  };
}

// Rows of three to five random parameters with coefficients up to `size`; every parameter starts
// at zero.
class RandomGrid {
 public:
  RandomGrid(int parameters, int rows, long size, std::mt19937& random) : parameters_(parameters) {
    std::uniform_int_distribution<long> entry(-size, size);
    std::uniform_int_distribution<int> near(0, 11);
    for (int i = 0; i < rows; ++i) {
      RationalTerms terms;
      const int start = static_cast<int>(random() % static_cast<unsigned>(parameters));
      for (size_t k = 0; k < 3 + random() % 3; ++k)
        terms.emplace_back((start + near(random)) % parameters, Rational(entry(random)));
      rows_.push_back(terms);
    }
  }

  GridEditor editor(unsigned bits) const {
    return {ConstraintMatrix(parameters_, rows_),
            1,
            bits,
            {std::vector<Rational>(static_cast<size_t>(parameters_))}};
  }

  // One or two anchors and a window of parameters around the first.
  Chooser chooser() const {
    return [n = parameters_](std::mt19937& random) {
      Choice choice{{}, 100.0};
      const int first = static_cast<int>(random() % static_cast<unsigned>(n));
      const int width = 6 + static_cast<int>(random() % 40);
      choice.selection.anchors.push_back(first);
      if (random() % 2 == 0) choice.selection.anchors.push_back((first + 1 + width / 2) % n);
      for (int k = 1; k < width; ++k) {
        const int j = (first + k) % n;
        if (j != choice.selection.anchors.back()) choice.selection.derived.push_back(j);
      }
      return choice;
    };
  }

 private:
  int parameters_;
  std::vector<RationalTerms> rows_;
};

struct ChainResult {
  int edits = 0;       // done
  int unsolvable = 0;  // choices that are not strongly solvable: drawn again
  int sampled = 0;     // edits compared with the exact optimum
  int too_large = 0;   // loose parameters, or refused for their numbers: not made
  unsigned long largest_bits = 0;
  double largest_distance = 0.0;  // from the exact optimum, model units
  double largest_share = 0.0;     // of the bound a priori
  double largest_bound = 0.0;
  double largest_deviation = 0.0;  // of an anchor from its target
};

inline void print(const ChainResult& result, const char* name) {
  std::printf(
      "%s: %d edits (%d choices not strongly solvable, %d too large), residual zero after each; "
      "largest number %lu bits; %d compared with the exact optimum: largest distance %.3g, largest "
      "bound %.3g, largest share of its bound %.3g; largest deviation of an anchor %.3g\n",
      name, result.edits, result.unsolvable, result.too_large, result.largest_bits, result.sampled,
      result.largest_distance, result.largest_bound, result.largest_share,
      result.largest_deviation);
}

// The exact optimum for the anchors used, and the largest distance from it.
inline double distance_from_optimum(const GridEditor& editor, const Selection& selection,
                                    const std::vector<int>& independent,
                                    const std::vector<std::vector<double>>& hints) {
  const LeastChange exact(editor.matrix(), selection.derived, independent);
  const std::vector<Rational> zero(static_cast<size_t>(editor.matrix().rows()));
  double largest = 0.0;
  for (int c = 0; c < editor.components(); ++c) {
    std::vector<Rational> values;
    for (int j = 0; j < editor.matrix().parameters(); ++j) values.push_back(editor.value(c, j));
    for (size_t k = 0; k < selection.derived.size(); ++k)
      values[static_cast<size_t>(selection.derived[k])] =
          Rational(hints[static_cast<size_t>(c)][k]);
    const std::vector<Rational> optimum = exact.solve(zero, values);
    for (size_t k = 0; k < optimum.size(); ++k)
      largest = std::max(
          largest, (editor.value(c, selection.derived[k]) - optimum[k]).abs().enclosure().high);
  }
  return largest;
}

// `wanted` random edits, each from the result of the one before; every `every`-th is compared.
// Choices that cannot be made are drawn again, as many as `wanted` of them.
inline ChainResult run_chain(GridEditor& editor, const Chooser& choose, int wanted, int every,
                             std::mt19937& random) {
  ChainResult result;
  std::uniform_real_distribution<double> share(-1.0, 1.0);
  for (int draw = 0; draw < 2 * wanted && result.edits < wanted; ++draw) {
    const auto [selection, reach] = choose(random);
    const Analysis analysis = analyse(editor.matrix(), selection);
    if (!analysis.strongly_solvable()) {
      ++result.unsolvable;
      continue;
    }
    if (!editor.initialize(selection, analysis).loose.empty()) {
      ++result.too_large;
      continue;
    }
    // Targets and hints stay around the state of rest, so that the chain does not drift away.
    auto targets = values_of(editor, selection.anchors);
    auto hints = rounded(derived_values(editor, selection));
    const bool hinted = random() % 2 == 0;
    for (auto& component : targets)
      for (Rational& value : component)
        value = Rational(value.to_double() * 0.999 + reach * share(random));
    for (auto& component : hints)
      for (double& value : component)
        if (hinted) value += 0.1 * reach * share(random);
    const GridUpdate update = editor.update(targets, hints);
    if (update.outcome == GridUpdate::Outcome::kTooLarge) {
      ++result.too_large;
      continue;
    }
    EXPECT_EQ(update.outcome, GridUpdate::Outcome::kDone) << update.reason;
    expect_constraints(editor);
    if (::testing::Test::HasFatalFailure()) return result;
    ++result.edits;
    for (int c = 0; c < editor.components(); ++c)
      for (int j = 0; j < editor.matrix().parameters(); ++j) {
        const Integer number(editor.number(c, j));
        result.largest_bits = std::max(result.largest_bits, number.bits() + 1);  // with the sign
      }
    result.largest_deviation = std::max(result.largest_deviation, update.deviation);
    EXPECT_LE(update.distance, update.bound * (1 + 1e-9));
    if (result.edits % every != 0) continue;
    ++result.sampled;
    const double distance = distance_from_optimum(editor, selection, analysis.independent, hints);
    EXPECT_LE(distance, update.distance);
    EXPECT_LE(distance, update.bound);
    result.largest_distance = std::max(result.largest_distance, distance);
    result.largest_bound = std::max(result.largest_bound, update.bound);
    result.largest_share = std::max(result.largest_share, distance / update.bound);
  }
  return result;
}

// y^T R_ED is an integer vector, y^T R_EA z is not: no grid solution, whatever the algorithm.
inline void expect_proof(const ConstraintMatrix& matrix, const Selection& selection,
                         const GridObstacle& obstacle, const Rational& move) {
  EXPECT_FALSE(obstacle.restricted);
  Rational value;
  std::vector<Rational> sums(static_cast<size_t>(matrix.parameters()));
  for (size_t i = 0; i < obstacle.rows.size(); ++i)
    for (const ConstraintTerm& term : matrix.row(obstacle.rows[i]))
      sums[static_cast<size_t>(term.parameter)] +=
          obstacle.multipliers[i] * Rational(term.coefficient);
  for (const int j : selection.derived)
    EXPECT_EQ(sums[static_cast<size_t>(j)].denominator(), Integer(1));
  for (const int j : selection.anchors) value -= sums[static_cast<size_t>(j)] * move;
  EXPECT_NE(value.denominator(), Integer(1));
  EXPECT_EQ(value, obstacle.value);
}

}  // namespace isochor
